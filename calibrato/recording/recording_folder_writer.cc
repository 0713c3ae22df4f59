#include "calibrato/recording/recording_folder_writer.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/base/progress.h"
#include "calibrato/recording/encoded_image.h"
#include "calibrato/recording/imu_list.h"
#include "calibrato/recording/new_file.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

// A folder under a temporary name, gone unless it is given its own.
class NewFolder {
 public:
  explicit NewFolder(const std::string& path)
      : path_(path), temporary_(path_.string() + ".tmp-" + std::to_string(getpid())) {
    MakeFolder("");
  }
  ~NewFolder() {
    std::error_code ignored;
    fs::remove_all(temporary_, ignored);
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  void MakeFolder(const std::string& name) const {
    std::error_code error;
    fs::create_directories(temporary_ / name, error);
    if (error) Fail(error);
  }
  void Write(const std::string& name, std::string_view content) const {
    NewFile file((temporary_ / name).string());
    file.Append(content);
    file.Commit(false);
  }
  // What stood there is removed only after the new folder has taken its place.
  void Commit() const {
    const fs::path old = path_.string() + ".old-" + std::to_string(getpid());
    std::error_code error;
    const bool is_replaced = fs::exists(fs::symlink_status(path_, error));
    if (is_replaced) fs::rename(path_, old, error);
    if (error && is_replaced) Fail(error);
    fs::rename(temporary_, path_, error);
    if (error) {
      std::error_code ignored;
      if (is_replaced) fs::rename(old, path_, ignored);
      Fail(error);
    }
    fs::remove_all(old, error);
  }

 private:
  [[noreturn]] void Fail(const std::error_code& error) const {
    throw InputError({"cannot write folder", path_.string(), error.message(),
                      "choose another path or free some space"});
  }
  fs::path path_;
  fs::path temporary_;
};

// Ten digits or more make a name a stamp (recording/recording_folder.h).
std::string NameOf(Time stamp) {
  constexpr size_t kMinDigits = 10;
  const std::string digits = std::to_string(stamp.nanoseconds());
  return std::string(kMinDigits - std::min(kMinDigits, digits.size()), '0') + digits;
}

void WriteCamera(const CameraImages& images, const std::string& name, const NewFolder& folder,
                 Progress* progress) {
  folder.MakeFolder(name);
  std::string mosaic;
  for (size_t k = 0; k < images.list.size(); ++k) {
    const StoredImage image = images.reader->Read(k);
    const std::string stem = name + "/" + NameOf(images.list[k].stamp);
    std::string encoding;
    if (const auto* file = std::get_if<EncodedFile>(&image.content)) {
      const std::string extension = ImageExtension(file->bytes);
      if (extension.empty()) {
        throw InputError({"cannot convert image", image.where,
                          "it is not an image that calibrato reads",
                          "record PNG, JPEG or raw images"});
      }
      encoding = file->encoding;
      folder.Write(stem + "." + extension, file->bytes);
    } else {
      const auto& pixels = std::get<RawPixels>(image.content);
      encoding = pixels.encoding;
      folder.Write(stem + ".png", PngOf(pixels, image.where));
    }
    if (IsMosaic(encoding)) mosaic = encoding;
    progress->Advance();
  }
  if (!mosaic.empty()) {
    folder.Write(name + "/sensor.yaml", "sensor_type: camera\nencoding: " + mosaic + "\n");
  }
}

}  // namespace

bool HasCommonStamps(const ImuStream& stream) {
  return std::equal(
      stream.gyro.begin(), stream.gyro.end(), stream.accel.begin(), stream.accel.end(),
      [](const VectorSample& a, const VectorSample& b) { return a.stamp == b.stamp; });
}

void WriteRecordingFolder(const Recording& recording, const std::string& path) {
  const NewFolder folder(path);
  size_t num_images = 0;
  for (const CameraRecording& camera : recording.cameras) {
    num_images += std::get<CameraImages>(camera.data).list.size();
  }
  Progress progress("writing", static_cast<int64_t>(num_images));
  for (size_t n = 0; n < recording.cameras.size(); ++n) {
    WriteCamera(std::get<CameraImages>(recording.cameras[n].data), "cam" + std::to_string(n),
                folder, &progress);
  }
  for (size_t n = 0; n < recording.imus.size(); ++n) {
    const ImuStream& stream = recording.imus[n].stream;
    const std::string number = std::to_string(n);
    if (HasCommonStamps(stream)) {
      folder.Write("imu" + number + ".csv", ImuListText(stream));
    } else {
      folder.Write("gyro" + number + ".csv", GyroListText(stream.gyro));
      folder.Write("accel" + number + ".csv", AccelListText(stream.accel));
    }
  }
  folder.Commit();
}

}  // namespace calibrato
