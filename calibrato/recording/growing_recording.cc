#include "calibrato/recording/growing_recording.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/recording/corner_list.h"
#include "calibrato/recording/encoded_image.h"
#include "calibrato/recording/imu_list.h"
#include "calibrato/recording/new_file.h"
#include "calibrato/recording/photo.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Fail(const std::string& path, int error) {
  throw InputError(
      {"cannot write recording", path, std::generic_category().message(error),
       error == ENOSPC ? "free some space or choose another disk" : "choose another path"});
}

// A process that is killed leaves a write half done where the file's pages meet, and nowhere else.
constexpr size_t kPageBytes = 4096;

// Rows to be appended at this place of a file, with empty lines before those that would lie on two
// pages: readers pass over them.
std::string WithinPages(std::string_view rows, size_t place) {
  std::string padded;
  while (!rows.empty()) {
    const std::string_view row = rows.substr(0, rows.find('\n') + 1);
    const size_t room = kPageBytes - (place + padded.size()) % kPageBytes;
    if (row.size() > room) padded.append(room, '\n');
    padded += row;
    rows.remove_prefix(row.size());
  }
  return padded;
}

// Ten digits or more make a name a stamp (recording/recording_folder.h).
std::string NameOf(Time stamp) {
  constexpr size_t kMinDigits = 10;
  const std::string digits = std::to_string(stamp.nanoseconds());
  return std::string(kMinDigits - std::min(kMinDigits, digits.size()), '0') + digits;
}

}  // namespace

GrowingRecording::GrowingRecording(std::string path, Resolution resolution, int corners_per_tag)
    : path_(std::move(path)), corners_per_tag_(corners_per_tag) {
  std::error_code error;
  if (fs::exists(path_, error) && !(fs::is_directory(path_, error) && fs::is_empty(path_, error))) {
    throw InputError(
        {"a recording exists already", path_, "it is not overwritten", "choose another folder"});
  }
  fs::create_directories(path_, error);
  if (error) Fail(path_, error.value());
  Value size = Value::Array();
  size.Append(resolution.width).Append(resolution.height);
  Value sensor = Value::Object();
  sensor.Set("resolution", std::move(size));
  WriteFileAtomically(path_ + "/sensor.yaml", ToYaml(sensor));
}

GrowingRecording::~GrowingRecording() {
  for (const auto& [name, fd] : lists_) close(fd);
}

void GrowingRecording::AddImage(Time stamp, const GreyImage& image) {
  AddImageFile(stamp, EncodePng(image));
}

void GrowingRecording::AddImageFile(Time stamp, std::string_view bytes) {
  std::error_code error;
  fs::create_directories(path_ + "/cam0", error);
  if (error) Fail(path_ + "/cam0", error.value());
  NewFile file(path_ + "/cam0/" + NameOf(stamp) + "." + ImageExtension(bytes));
  file.Append(bytes);
  file.Commit(false);
}

void GrowingRecording::AddView(const BoardView& view) {
  AppendRows("cam0_corners.csv", CornerListText({view}, corners_per_tag_));
}

void GrowingRecording::AddImu(const VectorSample& gyro, const VectorSample& accel) {
  AppendRows("imu0.csv", ImuListText({{gyro}, {accel}}));
}

void GrowingRecording::AddGyro(const VectorSample& gyro) {
  AppendRows("gyro0.csv", GyroListText({gyro}));
}

void GrowingRecording::AddAccel(const VectorSample& accel) {
  AppendRows("accel0.csv", AccelListText({accel}));
}

void GrowingRecording::AppendRows(const std::string& name, std::string_view rows_with_header) {
  const std::lock_guard lock(mutex_);
  const std::string path = path_ + "/" + name;
  const auto known = lists_.find(name);
  std::string_view rows = rows_with_header;
  if (known != lists_.end()) rows.remove_prefix(rows.find('\n') + 1);
  const int fd = known != lists_.end()
                     ? known->second
                     : open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
  if (fd < 0) Fail(path, errno);
  lists_[name] = fd;
  const off_t before = lseek(fd, 0, SEEK_END);
  auto end = static_cast<size_t>(before);
  const std::string padded = WithinPages(rows, end);
  for (std::string_view left = padded; !left.empty();) {
    const ssize_t size =
        write(fd, left.data(), std::min(left.size(), kPageBytes - end % kPageBytes));
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) {
      const int error = errno;
      if (before == 0) {  // A list without rows would make the whole folder unreadable ...
        close(fd);
        lists_.erase(name);
        unlink(path.c_str());
        Fail(path, error);
      }
      // ... and half a row the list.
      if (ftruncate(fd, before) != 0) Fail(path, errno);
      Fail(path, error);
    }
    end += static_cast<size_t>(size);
    left.remove_prefix(static_cast<size_t>(size));
  }
}

}  // namespace calibrato
