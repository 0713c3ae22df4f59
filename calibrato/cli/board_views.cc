#include "calibrato/cli/board_views.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <map>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/base/progress.h"
#include "calibrato/calibration/frame_matching.h"
#include "calibrato/detection/detect.h"

namespace calibrato {
namespace {

// One image of a recording, or the corners of one.
struct Entry {
  Time stamp;
  int frame = 0;
};

std::vector<Time> StampsOf(const CameraRecording& camera) {
  std::vector<Time> stamps;
  if (const auto* views = std::get_if<std::vector<BoardView>>(&camera.data)) {
    for (const BoardView& view : *views) stamps.push_back(view.stamp);
  } else {
    for (const RecordedImage& image : std::get<CameraImages>(camera.data).list) {
      stamps.push_back(image.stamp);
    }
  }
  return stamps;
}

// [camera][image]: stamps and frames.
std::vector<std::vector<Entry>> EntriesOf(const Recording& recording, bool* is_stamped) {
  std::vector<std::vector<BoardView>> stamped;
  *is_stamped = false;
  for (const CameraRecording& camera : recording.cameras) {
    stamped.emplace_back();
    for (const Time stamp : StampsOf(camera)) {
      stamped.back().emplace_back();
      stamped.back().back().stamp = stamp;
      if (stamp != Time()) *is_stamped = true;
    }
  }
  std::vector<std::vector<int>> frames(stamped.size());
  if (*is_stamped) frames = FramesByStamp(stamped, DefaultStampTolerance(stamped));
  std::vector<std::vector<Entry>> entries(stamped.size());
  for (size_t c = 0; c < stamped.size(); ++c) {
    for (size_t k = 0; k < stamped[c].size(); ++k) {
      entries[c].push_back({stamped[c][k].stamp, *is_stamped ? frames[c][k] : static_cast<int>(k)});
    }
  }
  return entries;
}

// One frame in so many of those that several cameras share, and of each camera's own. Counted
// together, cameras that take turns would lose one of them altogether.
std::vector<std::vector<bool>> Thinned(const std::vector<std::vector<Entry>>& entries, int every) {
  std::map<int, int> num_cameras;
  for (const auto& camera : entries) {
    for (const Entry& entry : camera) ++num_cameras[entry.frame];
  }
  std::map<int, int> place;  // Of a shared frame among those.
  for (const auto& [frame, count] : num_cameras) {
    if (count > 1) place.emplace(frame, static_cast<int>(place.size()));
  }
  std::vector<std::vector<bool>> kept;
  for (const auto& camera : entries) {
    int own = 0;
    auto& of_camera = kept.emplace_back();
    for (const Entry& entry : camera) {
      const auto shared = place.find(entry.frame);
      of_camera.push_back((shared != place.end() ? shared->second : own++) % every == 0);
    }
  }
  return kept;
}

// Which images lie in the window.
std::vector<std::vector<bool>> Inside(const std::vector<std::vector<Entry>>& entries,
                                      bool is_stamped, const std::string& path,
                                      const RecordingWindow& window) {
  if (window.every < 1) {
    throw InputError({"--every " + std::to_string(window.every), "",
                      "at least every first frame is used", "give 1 or more"});
  }
  if ((window.from_s || window.to_s) && !is_stamped) {
    throw InputError({"photos without stamps have no time", path, "--from and --to need one",
                      "leave them out, or choose photos by --images"});
  }
  Time first = Time::FromNanoseconds(INT64_MAX);
  for (const auto& camera : entries) {
    if (!camera.empty()) first = std::min(first, camera.front().stamp);
  }
  const std::vector<std::vector<bool>> thinned = Thinned(entries, window.every);
  std::vector<std::vector<bool>> inside(entries.size());
  bool any = false;
  for (size_t c = 0; c < entries.size(); ++c) {
    for (size_t k = 0; k < entries[c].size(); ++k) {
      const double time = (entries[c][k].stamp - first).seconds();
      inside[c].push_back(thinned[c][k] && !(window.from_s > time) &&
                          !(window.to_s && *window.to_s < time));
      any = any || inside[c].back();
    }
  }
  if (!any) {
    throw InputError({"no images left", path, "none lies between --from and --to",
                      "choose times [s] from the recording's first image on"});
  }
  return inside;
}

CameraViews ListedViews(const CameraRecording& camera, const std::vector<Entry>& entries,
                        const std::vector<bool>& inside) {
  if (!camera.resolution) {
    throw InputError({"unknown image size", camera.name, "a list of corners does not tell it",
                      "give --resolution WIDTHxHEIGHT or a sensor.yaml"});
  }
  const auto& views = std::get<std::vector<BoardView>>(camera.data);
  CameraViews found;
  found.resolution = *camera.resolution;
  for (size_t k = 0; k < views.size(); ++k) {
    if (!inside[k]) continue;
    found.views.push_back(views[k]);
    found.frame_of_view.push_back(entries[k].frame);
  }
  return found;
}

// Of a camera whose images all lie before --from, after --to, or between those of --every.
CameraViews ViewsOutsideWindow(const CameraRecording& camera) {
  const auto& images = std::get<CameraImages>(camera.data);
  CameraViews none;
  if (camera.resolution) {
    none.resolution = *camera.resolution;
  } else if (!images.list.empty()) {
    none.resolution = GreyOf(images.reader->Read(0)).resolution;
  }
  none.no_board = {"no board found", camera.name, "none of its images lies in the window",
                   "choose --from and --to so that each camera has images between them"};
  return none;
}

CameraViews DetectedViews(const CameraRecording& camera, const std::vector<Entry>& entries,
                          const std::vector<bool>& inside, const std::optional<Board>& board,
                          Progress* progress) {
  if (!board) {
    throw InputError({"no board given", camera.name, "images are searched for a known board",
                      "give --target board.yaml"});
  }
  const auto& images = std::get<CameraImages>(camera.data);
  ImageSource source;
  std::vector<size_t> numbers;
  std::map<std::string, int> frames;
  for (size_t k = 0; k < images.list.size(); ++k) {
    if (!inside[k]) continue;
    source.names.push_back(images.list[k].name);
    source.stamps.push_back(images.list[k].stamp);
    numbers.push_back(k);
    frames[images.list[k].name] = entries[k].frame;
  }
  if (source.names.empty()) return ViewsOutsideWindow(camera);
  // A few are loaded again where the board is in none.
  std::vector<std::atomic<bool>> is_counted(numbers.size());
  source.load = [&](size_t k) {
    if (!is_counted[k].exchange(true)) progress->Advance();
    return GreyOf(images.reader->Read(numbers[k]));
  };
  Detections detections = SearchForBoards(source, *board);
  CameraViews found{std::move(detections.views),   {},
                    detections.resolution,         std::move(detections.images_without_board),
                    detections.rejected,           detections.is_numbered_by_continuity,
                    std::move(detections.no_board)};
  for (const BoardView& view : found.views) found.frame_of_view.push_back(frames.at(view.name));
  return found;
}

}  // namespace

std::vector<CameraViews> FindBoardViewsOfAny(const Recording& recording,
                                             const std::optional<Board>& board,
                                             const RecordingWindow& window) {
  bool is_stamped = false;
  const auto entries = EntriesOf(recording, &is_stamped);
  const auto inside = Inside(entries, is_stamped, recording.path, window);
  int64_t num_images = 0;
  for (size_t c = 0; c < inside.size(); ++c) {
    if (!std::holds_alternative<CameraImages>(recording.cameras[c].data)) continue;
    num_images += std::count(inside[c].begin(), inside[c].end(), true);
  }
  Progress progress("finding the board", num_images);
  std::vector<CameraViews> found;
  for (size_t c = 0; c < recording.cameras.size(); ++c) {
    const CameraRecording& camera = recording.cameras[c];
    found.push_back(std::holds_alternative<CameraImages>(camera.data)
                        ? DetectedViews(camera, entries[c], inside[c], board, &progress)
                        : ListedViews(camera, entries[c], inside[c]));
  }
  const bool is_anywhere = std::any_of(found.begin(), found.end(),
                                       [](const CameraViews& camera) { return !camera.no_board; });
  if (!is_anywhere && !found.empty()) throw InputError(*found.front().no_board);
  return found;
}

std::vector<CameraViews> FindBoardViews(const Recording& recording,
                                        const std::optional<Board>& board,
                                        const RecordingWindow& window) {
  std::vector<CameraViews> found = FindBoardViewsOfAny(recording, board, window);
  for (const CameraViews& camera : found) {
    if (camera.no_board) throw InputError(*camera.no_board);
  }
  return found;
}

}  // namespace calibrato
