#include "calibrato/recording/video.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <list>
#include <map>
#include <mutex>
#include <opencv2/videoio.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/recording/comma_separated.h"
#include "calibrato/recording/encoded_image.h"
#include "calibrato/recording/file_kind.h"
#include "calibrato/recording/stamped_rows.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Fail(const std::string& path, const std::string& why) {
  throw InputError({"cannot read video", path, why, "copy it again, or convert it by ffmpeg"});
}

cv::VideoCapture Open(const std::string& path) {
  cv::VideoCapture capture;
  // An absolute path: FFmpeg takes some names for protocols.
  if (!capture.open(fs::absolute(path).string(), cv::CAP_FFMPEG)) {
    Fail(path, "it holds no video that FFmpeg decodes");
  }
  capture.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
  const double num_pixels =
      capture.get(cv::CAP_PROP_FRAME_WIDTH) * capture.get(cv::CAP_PROP_FRAME_HEIGHT);
  if (!(num_pixels > 0) || !(num_pixels <= static_cast<double>(kMaxImagePixels))) {
    Fail(path, "its frames have no pixels, or more than 100 megapixels");
  }
  return capture;
}

// Headers only estimate the number of frames.
size_t CountFrames(const std::string& path) {
  cv::VideoCapture capture = Open(path);
  size_t count = 0;
  while (capture.grab()) ++count;
  if (count == 0) Fail(path, "it has no frames");
  return count;
}

// Threads ask for frames in runs of their own: each run is served by a decoder of its own, which
// only moves forward.
class VideoFrames : public ImageReader {
 public:
  explicit VideoFrames(std::string path) : path_(std::move(path)) {}

  StoredImage Read(size_t k) const override {
    const std::lock_guard lock(mutex_);
    Decoder& decoder = DecoderFor(k);
    while (decoder.next < k) {
      if (!decoder.capture.grab()) FailFrame(k);
      ++decoder.next;
    }
    cv::Mat frame;
    if (!decoder.capture.read(frame) || frame.type() != CV_8UC3) FailFrame(k);
    ++decoder.next;
    const size_t row_bytes = frame.elemSize() * static_cast<size_t>(frame.cols);
    RawPixels pixels{{frame.cols, frame.rows}, "bgr8", false, row_bytes, {}};
    for (int v = 0; v < frame.rows; ++v) {
      pixels.bytes.append(reinterpret_cast<const char*>(frame.ptr(v)), row_bytes);
    }
    return {std::move(pixels), Where(k)};
  }

 private:
  struct Decoder {
    cv::VideoCapture capture;
    size_t next = 0;  // the number of the frame that it gives next
  };

  std::string Where(size_t k) const { return path_ + ", frame " + std::to_string(k); }
  [[noreturn]] void FailFrame(size_t k) const { Fail(Where(k), "it cannot be decoded"); }

  // The nearest behind; a new one where that is far, and takes the place of the least used.
  Decoder& DecoderFor(size_t k) const {
    constexpr size_t kFar = 64;
    constexpr size_t kMaxDecoders = 8;
    auto best = decoders_.end();
    for (auto it = decoders_.begin(); it != decoders_.end(); ++it) {
      if (it->next <= k && (best == decoders_.end() || it->next > best->next)) best = it;
    }
    const bool is_far = best == decoders_.end() || k - best->next > kFar;
    if (is_far && (best == decoders_.end() || decoders_.size() < kMaxDecoders)) {
      decoders_.push_front({Open(path_), 0});
      if (decoders_.size() > kMaxDecoders) decoders_.pop_back();
    } else {
      decoders_.splice(decoders_.begin(), decoders_, best);
    }
    return decoders_.front();
  }

  std::string path_;
  mutable std::mutex mutex_;
  mutable std::list<Decoder> decoders_;  // the last used first
};

std::vector<Time> ListedStamps(const std::string& path) {
  std::vector<Time> stamps;
  ForEachStampedRow(path, [&](const StampedRow& row) {
    if (row.stamp_ns < 0) {
      throw InputError({"malformed list of stamps", row.where,
                        "expected whole nanoseconds, found " + Quoted(row.fields.front()),
                        "correct the line or remove it"});
    }
    const Time time = Time::FromNanoseconds(row.stamp_ns);
    if (!stamps.empty() && !(time > stamps.back())) {
      throw InputError({"malformed list of stamps", row.where, "the stamp does not ascend",
                        "give one row for each frame, in their order"});
    }
    stamps.push_back(time);
  });
  return stamps;
}

std::vector<Time> StampsAtRate(const std::string& path, size_t count, double rate_hz) {
  constexpr double kMaxRateHz = 1e6;
  constexpr double kLongest_s = 1e9;
  if (!(rate_hz > 0) || !(rate_hz <= kMaxRateHz) ||
      !(static_cast<double>(count) / rate_hz < kLongest_s)) {
    throw InputError({"frame rate of " + FormatNumber(rate_hz) + " Hz", path,
                      "there is no such rate", "give --frame-rate, or a list of stamps beside it"});
  }
  std::vector<Time> stamps;
  for (size_t k = 0; k < count; ++k) {
    stamps.push_back(Time() + Duration::FromSeconds(static_cast<double>(k) / rate_hz));
  }
  return stamps;
}

// "cam3" -> 3
std::optional<int> CameraNumber(const std::string& stem) {
  if (!stem.starts_with("cam")) return std::nullopt;
  int number = -1;
  const char* const end = stem.data() + stem.size();
  const auto [last, error] = std::from_chars(stem.data() + 3, end, number);
  if (error != std::errc() || last != end || number < 0) return std::nullopt;
  return number;
}

}  // namespace

CameraImages OpenVideo(const std::string& path, const RecordingOptions& options,
                       std::vector<std::string>* warnings) {
  const size_t count = CountFrames(path);
  const std::string list = fs::path(path).replace_extension(".csv").string();
  std::error_code error;
  std::vector<Time> stamps;
  if (fs::is_regular_file(list, error)) {
    stamps = ListedStamps(list);
    if (stamps.size() != count) {
      throw InputError({"stamps and frames do not fit", list,
                        "it has " + std::to_string(stamps.size()) + " stamps, the video " +
                            std::to_string(count) + " frames",
                        "give one row for each frame, or remove the list"});
    }
  } else {
    const double rate_hz =
        options.frame_rate_hz ? *options.frame_rate_hz : Open(path).get(cv::CAP_PROP_FPS);
    stamps = StampsAtRate(path, count, rate_hz);
    if (!options.frame_rate_hz) {
      warnings->push_back(path + ": its frames are taken to follow each other at " +
                          FormatNumber(rate_hz) + " Hz, as the file says; phones vary");
    }
  }
  CameraImages images;
  for (size_t k = 0; k < count; ++k) images.list.push_back({std::to_string(k), stamps[k]});
  images.reader = std::make_shared<const VideoFrames>(path);
  return images;
}

std::vector<std::string> VideosOfFolder(const std::string& folder) {
  std::map<int, std::string> videos;
  for (const std::string& name : ListFiles(folder, "cam*")) {
    const std::optional<int> number = CameraNumber(fs::path(name).stem().string());
    const std::string path = (fs::path(folder) / name).string();
    std::error_code error;
    if (!number || !fs::is_regular_file(path, error)) continue;
    if (KindOfFile(path) != FileKind::kVideo) continue;
    if (!videos.try_emplace(*number, path).second) {
      throw InputError({"two videos of one camera", folder, videos.at(*number) + " and " + path,
                        "remove one of them"});
    }
  }
  std::vector<std::string> paths;
  for (const auto& [number, path] : videos) {
    if (number != static_cast<int>(paths.size())) {
      throw InputError({"camera missing", folder,
                        "there is " + path + ", but no video cam" + std::to_string(paths.size()),
                        "rename the videos so that they count from cam0"});
    }
    paths.push_back(path);
  }
  return paths;
}

}  // namespace calibrato
