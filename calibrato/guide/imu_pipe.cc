#include "calibrato/guide/imu_pipe.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

constexpr int kPollMs = 100;
constexpr size_t kLongestLine = 4096;

}  // namespace

std::optional<ImuSample> ParseImuLine(std::string_view line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  const char* at = line.data();
  const char* const end = line.data() + line.size();
  int64_t stamp = 0;
  auto read = std::from_chars(at, end, stamp);
  if (read.ec != std::errc() || stamp < 0) return std::nullopt;
  at = read.ptr;
  double values[6];
  for (double& value : values) {
    if (at == end || *at != ',') return std::nullopt;
    ++at;
    while (at != end && *at == ' ') ++at;
    read = std::from_chars(at, end, value);
    if (read.ec != std::errc()) return std::nullopt;
    at = read.ptr;
  }
  if (at != end) return std::nullopt;
  const Time time = Time::FromNanoseconds(stamp);
  return ImuSample{{time, {values[0], values[1], values[2]}},
                   {time, {values[3], values[4], values[5]}}};
}

ImuPipe::ImuPipe(const std::string& path, std::function<void(const ImuSample&)> on_sample,
                 std::function<void()> on_bad_line)
    : on_sample_(std::move(on_sample)), on_bad_line_(std::move(on_bad_line)) {
  // Read and write, so that a pipe can be opened, and stays open, without its writer.
  fd_ = path == "-" ? dup(STDIN_FILENO) : open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) {
    throw InputError({"cannot open the IMU's pipe", path, std::generic_category().message(errno),
                      "make it by mkfifo, and let the IMU's driver write to it"});
  }
  thread_ = std::thread([this] { Read(); });
}

ImuPipe::~ImuPipe() {
  stop_ = true;
  thread_.join();
  close(fd_);
}

void ImuPipe::Read() {
  std::string pending;
  char buffer[8192];
  while (!stop_) {
    pollfd waiting{fd_, POLLIN, 0};
    if (poll(&waiting, 1, kPollMs) <= 0) continue;
    const ssize_t size = read(fd_, buffer, sizeof buffer);
    if (size < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (size <= 0) return;
    pending.append(buffer, static_cast<size_t>(size));
    size_t begin = 0;
    for (size_t end = pending.find('\n'); end != std::string::npos;
         end = pending.find('\n', begin)) {
      TakeLine(std::string_view(pending).substr(begin, end - begin));
      begin = end + 1;
    }
    pending.erase(0, begin);
    if (pending.size() > kLongestLine) {
      pending.clear();
      on_bad_line_();
    }
  }
}

void ImuPipe::TakeLine(std::string_view line) {
  const bool is_words = line.empty() || line.front() == '#' ||
                        std::isalpha(static_cast<unsigned char>(line.front())) != 0;
  if (is_words) return;
  if (const auto sample = ParseImuLine(line)) {
    on_sample_(*sample);
  } else {
    on_bad_line_();
  }
}

}  // namespace calibrato
