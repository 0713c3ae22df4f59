#include "calibrato/recording/recording_folder.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/recording/corner_list.h"
#include "calibrato/recording/image_list.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 7> kImageExtensions = {".png", ".jpg",  ".jpeg", ".bmp",
                                                              ".tif", ".tiff", ".pgm"};
constexpr int kMaxCameras = 100;
constexpr size_t kMaxImageBytes = size_t{1} << 30;

std::string CameraName(int index) { return "cam" + std::to_string(index); }

bool IsFile(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool IsFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool IsImage(const std::string& name) {
  std::string extension = fs::path(name).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kImageExtensions.begin(), kImageExtensions.end(), extension) !=
         kImageExtensions.end();
}

std::vector<std::string> ListImages(const fs::path& folder, const std::string& glob = "*") {
  std::vector<std::string> names = ListFiles(folder.string(), glob);
  std::erase_if(names, [](const std::string& name) { return !IsImage(name); });
  return names;
}

// Ten digits or more: "0001" numbers a photo, 1403636579763555584 is a time.
std::optional<Time> StampOf(const std::string& name) {
  const std::string stem = fs::path(name).stem().string();
  int64_t stamp = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), stamp);
  const bool is_number = error == std::errc() && end == stem.data() + stem.size() && stamp >= 0;
  if (!is_number || stem.size() < 10) return std::nullopt;
  return Time::FromNanoseconds(stamp);
}

// One image on disk, not yet read.
struct ImageFile {
  std::string name;
  std::string path;
  Time stamp;
};

class ImageFiles : public ImageReader {
 public:
  ImageFiles(std::vector<std::string> paths, std::string encoding)
      : paths_(std::move(paths)), encoding_(std::move(encoding)) {}
  StoredImage Read(size_t k) const override {
    return {EncodedFile{ReadFile(paths_.at(k), kMaxImageBytes), encoding_}, paths_[k]};
  }

 private:
  std::vector<std::string> paths_;
  std::string encoding_;
};

CameraImages Images(std::vector<ImageFile> files, const std::string& encoding) {
  CameraImages images;
  std::vector<std::string> paths;
  for (ImageFile& file : files) {
    images.list.push_back({std::move(file.name), file.stamp});
    paths.push_back(std::move(file.path));
  }
  images.reader = std::make_shared<const ImageFiles>(std::move(paths), encoding);
  return images;
}

struct Photos {
  std::vector<ImageFile> files;
  std::optional<std::string> unstamped;  ///< The first without a stamp.
};

void SortByStamp(const fs::path& folder, std::vector<ImageFile>* files) {
  std::stable_sort(files->begin(), files->end(),
                   [](const ImageFile& a, const ImageFile& b) { return a.stamp < b.stamp; });
  const auto twin =
      std::adjacent_find(files->begin(), files->end(),
                         [](const ImageFile& a, const ImageFile& b) { return a.stamp == b.stamp; });
  if (twin != files->end()) {
    throw InputError({"two images of one stamp", folder.string(),
                      twin->name + " and " + std::next(twin)->name, "remove one of them"});
  }
}

Photos PhotosOf(const fs::path& folder, const std::vector<std::string>& names) {
  Photos photos;
  for (const std::string& name : names) {
    const std::optional<Time> stamp = StampOf(name);
    if (!stamp && !photos.unstamped) photos.unstamped = name;
    photos.files.push_back({name, (folder / name).string(), stamp.value_or(Time())});
  }
  if (photos.unstamped) {
    for (ImageFile& file : photos.files) file.stamp = Time();
    return photos;
  }
  SortByStamp(folder, &photos.files);
  return photos;
}

// The images that EuRoC's data.csv lists.
std::vector<ImageFile> ListedImages(const fs::path& list, const fs::path& folder) {
  std::vector<ImageFile> files;
  for (ListedImage& image : ReadImageList(list.string())) {
    const fs::path path = folder / image.name;
    if (!IsFile(path)) {
      throw InputError({"listed image is missing", path.string(), "it stands in " + list.string(),
                        "add it or remove its line"});
    }
    files.push_back({std::move(image.name), path.string(), image.stamp});
  }
  SortByStamp(folder, &files);
  return files;
}

// How many of cam0, cam1, .. are there, up to the first that is missing; one behind a gap is
// an error, since cameras are counted everywhere from 0.
template <typename IsThere>
int CountCameras(const std::string& path, const std::string& suffix, const IsThere& is_there) {
  int count = 0;
  while (count < kMaxCameras && is_there(count)) ++count;
  for (int i = count + 1; i < kMaxCameras; ++i) {
    if (!is_there(i)) continue;
    throw InputError(
        {"camera missing", path,
         "there is " + CameraName(i) + suffix + ", but no " + CameraName(count) + suffix,
         "rename the cameras so that they count from cam0"});
  }
  return count;
}

std::optional<fs::path> CornerListOf(const fs::path& folder, int camera) {
  const fs::path plain = folder / (CameraName(camera) + "_corners.csv");
  const fs::path packed = plain.string() + ".gz";
  if (IsFile(plain) && IsFile(packed)) {
    throw InputError({"two corner lists of one camera", folder.string(),
                      plain.filename().string() + " and " + packed.filename().string(),
                      "remove one of them"});
  }
  if (IsFile(plain)) return plain;
  if (IsFile(packed)) return packed;
  return std::nullopt;
}

Resolution ResolutionFromValue(const Value& value) {
  constexpr int64_t kMaxSide = 100'000;
  if (value.elements().size() != 2) {
    value.Fail("malformed resolution", "expected [width, height]", "for example [752, 480]");
  }
  return {static_cast<int>(value.elements()[0].AsInt(1, kMaxSide)),
          static_cast<int>(value.elements()[1].AsInt(1, kMaxSide))};
}

// Of a camera chain only the resolution is read: lenses that this program does not know are no
// reason to refuse a list of corners.
std::optional<Resolution> ResolutionInFiles(const fs::path& folder, int camera) {
  const std::string name = CameraName(camera);
  for (const fs::path& file :
       {folder / (name + "_sensor.yaml"), folder / name / "sensor.yaml", folder / "sensor.yaml"}) {
    if (!IsFile(file)) continue;
    const Value sensor = ReadYaml(file.string());
    if (const Value* resolution = sensor.Find("resolution"))
      return ResolutionFromValue(*resolution);
  }
  const fs::path chain_file = folder / "camchain.yaml";
  if (!IsFile(chain_file)) return std::nullopt;
  const Value chain = ReadYaml(chain_file.string());
  const Value* entry = chain.Find(name);
  const Value* resolution = entry == nullptr ? nullptr : entry->Find("resolution");
  if (resolution == nullptr) return std::nullopt;
  return ResolutionFromValue(*resolution);
}

// What a camera's images are mosaics of, if they are. Other programs write this file in dialects of
// YAML; that is no reason to refuse their images.
std::string EncodingInFiles(const fs::path& folder, const std::string& name) {
  const fs::path file = folder / name / "sensor.yaml";
  if (!IsFile(file)) return "";
  try {
    const Value sensor = ReadYaml(file.string());
    const Value* encoding = sensor.Find("encoding");
    return encoding == nullptr ? "" : encoding->AsString();
  } catch (const InputError&) {
    return "";
  }
}

int CountCornerLists(const std::string& path) {
  return CountCameras(path, "_corners.csv",
                      [&](int i) { return CornerListOf(path, i).has_value(); });
}

std::vector<CameraRecording> CornerLists(const std::string& path, int num_cameras,
                                         const RecordingOptions& options) {
  std::vector<CameraRecording> cameras;
  for (int i = 0; i < num_cameras; ++i) {
    CameraRecording camera;
    camera.name = CameraName(i);
    camera.resolution = options.resolution ? options.resolution : ResolutionInFiles(path, i);
    camera.data = ReadCornerList(CornerListOf(path, i)->string(), options.board_points_g);
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

std::vector<CameraRecording> CameraFolders(const std::string& path) {
  const int num_cameras =
      CountCameras(path, "/", [&](int i) { return IsFolder(fs::path(path) / CameraName(i)); });
  std::vector<CameraRecording> cameras;
  for (int i = 0; i < num_cameras; ++i) {
    const std::string name = CameraName(i);
    fs::path folder = fs::path(path) / name / "data";
    if (!IsFolder(folder)) folder = fs::path(path) / name;
    const std::vector<std::string> names = ListImages(folder);
    if (names.empty()) {
      throw InputError({"no images", folder.string(),
                        "looked for files that end in png, jpg, jpeg, bmp, tif, tiff or pgm",
                        "put the images there or remove the folder " + name});
    }
    Photos photos = PhotosOf(folder, names);
    const bool some_have_stamps = std::any_of(
        names.begin(), names.end(), [](const std::string& n) { return StampOf(n).has_value(); });
    const fs::path list = fs::path(path) / name / "data.csv";
    if (photos.unstamped && IsFile(list)) {
      photos.files = ListedImages(list, folder);
    } else if (photos.unstamped && some_have_stamps) {
      throw InputError({"image without a stamp", (folder / *photos.unstamped).string(),
                        "the names of others are their stamps in nanoseconds",
                        "rename it or move it away"});
    }
    cameras.push_back(
        {name, Images(std::move(photos.files), EncodingInFiles(path, name)), std::nullopt});
  }
  return cameras;
}

std::vector<CameraRecording> GlobbedPhotos(const std::string& path,
                                           const std::vector<std::string>& globs) {
  std::vector<CameraRecording> cameras;
  for (const std::string& glob : globs) {
    const fs::path folder = fs::path(path) / fs::path(glob).parent_path();
    const std::vector<std::string> names = ListImages(folder, fs::path(glob).filename().string());
    if (names.empty()) {
      const std::vector<std::string> all = ListImages(folder);
      throw InputError({"no image matches '" + glob + "'", folder.string(),
                        "of the " + std::to_string(all.size()) + " images there" +
                            (all.empty() ? "" : ", for example " + all.front()),
                        all.empty() && IsFolder(fs::path(path) / CameraName(0))
                            ? "leave --images out, the images of cam0/ are found without it"
                            : "put the pattern in quotes and compare it with their names"});
    }
    cameras.push_back({glob, Images(PhotosOf(folder, names).files, ""), std::nullopt});
  }
  return cameras;
}

void CheckPairs(const std::string& path, const std::vector<CameraRecording>& cameras) {
  const auto files = [](const CameraRecording& camera) -> const std::vector<RecordedImage>& {
    return std::get<CameraImages>(camera.data).list;
  };
  const auto has_stamps = [&](const CameraRecording& camera) {
    return files(camera).back().stamp != Time();
  };
  const CameraRecording& first = cameras.front();
  for (const CameraRecording& camera : cameras) {
    if (has_stamps(camera) != has_stamps(first)) {
      throw InputError(
          {"images can't be paired", path,
           "only one of " + first.name + " and " + camera.name + " has stamps for names",
           "name the images of both by their stamps in nanoseconds, or neither"});
    }
    if (!has_stamps(first) && files(camera).size() != files(first).size()) {
      throw InputError({"images can't be paired", path,
                        first.name + " has " + std::to_string(files(first).size()) +
                            " images without stamps, " + camera.name + " has " +
                            std::to_string(files(camera).size()),
                        "leave out those that only one camera took"});
    }
  }
}

// The folder itself, or EuRoC's mav0 in it.
std::string RootOf(const std::string& path, const RecordingOptions& options) {
  const fs::path inner = fs::path(path) / "mav0";
  const bool has_cameras =
      CornerListOf(path, 0).has_value() || IsFolder(fs::path(path) / CameraName(0));
  return !has_cameras && options.image_globs.empty() && IsFolder(inner) ? inner.string() : path;
}

}  // namespace

bool HoldsCameras(const std::string& folder) {
  const std::string root = RootOf(folder, {});
  return CornerListOf(root, 0).has_value() || IsFolder(fs::path(root) / CameraName(0)) ||
         !ListImages(root).empty();
}

Recording OpenRecordingFolder(const std::string& given_path, const RecordingOptions& options) {
  const std::string path = RootOf(given_path, options);
  const std::vector<std::string> images = ListImages(path);  // throws unless a folder
  Recording recording{given_path, {}, {}, {}};
  if (options.with_imus) recording.imus = OpenImuRecordings(path);
  if (!options.with_cameras) return recording;
  if (const int num_lists = CountCornerLists(path); num_lists > 0) {
    if (!options.image_globs.empty()) {
      throw InputError({"no image matches '" + options.image_globs.front() + "'", path,
                        "the folder holds lists of corners, and " + std::to_string(images.size()) +
                            " images beside them",
                        "leave --images out or move the photos to a folder of their own"});
    }
    recording.cameras = CornerLists(path, num_lists, options);
    return recording;
  }
  if (!options.image_globs.empty()) {
    recording.cameras = GlobbedPhotos(path, options.image_globs);
  } else {
    recording.cameras = CameraFolders(path);
    if (recording.cameras.empty() && !images.empty()) {
      recording.cameras.push_back(
          {CameraName(0), Images(PhotosOf(path, images).files, ""), std::nullopt});
    }
  }
  if (recording.cameras.empty()) {
    if (options.cameras_may_be_missing && !recording.imus.empty()) return recording;
    throw InputError({"no recording", path,
                      "found neither cam0_corners.csv[.gz] nor images in cam0/data, cam0 or the "
                      "folder itself (png, jpg, jpeg, bmp, tif, tiff, pgm), nor a bag or a video "
                      "cam0.mp4",
                      "name the folder that holds one of these"});
  }
  CheckPairs(path, recording.cameras);
  return recording;
}

}  // namespace calibrato
