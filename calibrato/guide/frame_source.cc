#include "calibrato/guide/frame_source.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>
#include <variant>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/live_camera.h"
#include "calibrato/recording/photo.h"
#include "calibrato/recording/stored_image.h"

namespace calibrato {
namespace {

class CameraSource : public FrameSource {
 public:
  explicit CameraSource(const std::string& device) : camera_(device), first_(camera_.Next()) {
    if (!first_) {
      throw InputError({"no image from camera", device, "it was opened, but gives no frames",
                        "see whether another program has it"});
    }
    resolution_ = first_->image.resolution;
  }

  std::optional<CapturedFrame> Next(const ImuSink& /*sink*/,
                                    const std::function<bool()>& /*stop*/) override {
    ++num_asked_;
    std::optional<LiveCamera::Frame> frame = first_ ? std::exchange(first_, {}) : camera_.Next();
    if (!frame) return std::nullopt;
    CapturedFrame captured;
    captured.stamp = frame->stamp;
    // Between the first one, which told the size, and the next, nobody was ready for frames.
    if (num_asked_ > 2) captured.num_dropped = frame->num_dropped;
    captured.image = std::move(frame->image);
    return captured;
  }
  Resolution resolution() const override { return resolution_; }
  std::string end_words() const override { return "the camera is gone"; }

 private:
  LiveCamera camera_;
  std::optional<LiveCamera::Frame> first_;
  int num_asked_ = 0;
  Resolution resolution_;
};

class ReplaySource : public FrameSource {
 public:
  ReplaySource(Recording recording, double speed, std::optional<Resolution> resolution)
      : recording_(std::move(recording)), speed_(speed) {
    const CameraRecording& camera = recording_.cameras.front();
    if (const auto* images = std::get_if<CameraImages>(&camera.data)) {
      resolution_ = GreyOf(images->reader->Read(0)).resolution;
      num_frames_ = images->list.size();
      first_ = images->list.front().stamp;
      last_ = images->list.back().stamp;
    } else {
      const auto& views = std::get<std::vector<BoardView>>(camera.data);
      if (!camera.resolution && !resolution) {
        throw InputError({"image size unknown", recording_.path,
                          "a list of corners does not say how large its images were",
                          "give --cameras, or write sensor.yaml with resolution: [640, 480]"});
      }
      resolution_ = camera.resolution ? *camera.resolution : *resolution;
      num_frames_ = views.size();
      first_ = views.front().stamp;
      last_ = views.back().stamp;
    }
    if (num_frames_ > 1 && first_ == last_) {
      throw InputError({"cannot replay", recording_.path, "its images have no stamps",
                        "replay a recording, not a folder of photos"});
    }
    if (!recording_.imus.empty()) {
      const ImuStream& stream = recording_.imus.front().stream;
      has_common_stamps_ = std::ranges::equal(stream.gyro, stream.accel, {}, &VectorSample::stamp,
                                              &VectorSample::stamp);
    }
  }

  std::optional<CapturedFrame> Next(const ImuSink& sink,
                                    const std::function<bool()>& stop) override {
    const size_t k = next_++;
    if (k >= num_frames_) return std::nullopt;
    const CameraRecording& camera = recording_.cameras.front();
    CapturedFrame frame;
    if (const auto* images = std::get_if<CameraImages>(&camera.data)) {
      frame.stamp = images->list[k].stamp;
      const StoredImage stored = images->reader->Read(k);
      frame.image = GreyOf(stored);
      // A mosaic's file alone would not say that it is one.
      const auto* file = std::get_if<EncodedFile>(&stored.content);
      if (file != nullptr && file->encoding.empty()) frame.file = file->bytes;
    } else {
      frame.view = std::get<std::vector<BoardView>>(camera.data)[k];
      frame.stamp = frame.view->stamp;
    }
    WaitUntil(frame.stamp, stop);
    if (!recording_.imus.empty()) HandOver(recording_.imus.front().stream, frame.stamp, sink);
    return frame;
  }
  Resolution resolution() const override { return resolution_; }
  std::string end_words() const override { return "the recording is over"; }

 private:
  using Clock = std::chrono::steady_clock;

  void WaitUntil(Time stamp, const std::function<bool()>& stop) {
    constexpr std::chrono::milliseconds kSlice{100};
    if (!begin_) begin_ = Clock::now();
    if (!(speed_ > 0.0)) return;
    const Clock::time_point due =
        *begin_ + std::chrono::nanoseconds(static_cast<int64_t>(
                      static_cast<double>((stamp - first_).nanoseconds()) / speed_));
    while (Clock::now() < due && !stop()) {
      std::this_thread::sleep_until(std::min(due, Clock::now() + kSlice));
    }
  }

  void HandOver(const ImuStream& stream, Time until, const ImuSink& sink) {
    const auto is_next = [&](const std::vector<VectorSample>& samples, size_t k) {
      return k < samples.size() && samples[k].stamp <= until;
    };
    if (has_common_stamps_) {
      while (is_next(stream.gyro, next_gyro_)) {
        sink.both(stream.gyro[next_gyro_++], stream.accel[next_accel_++]);
      }
      return;
    }
    while (is_next(stream.gyro, next_gyro_)) sink.gyro(stream.gyro[next_gyro_++]);
    while (is_next(stream.accel, next_accel_)) sink.accel(stream.accel[next_accel_++]);
  }

  Recording recording_;
  double speed_;
  Resolution resolution_;
  Time first_;
  Time last_;
  size_t num_frames_ = 0;
  size_t next_ = 0;
  bool has_common_stamps_ = false;  // Of all IMU samples: a recording keeps one list, or two.
  size_t next_gyro_ = 0;
  size_t next_accel_ = 0;
  std::optional<Clock::time_point> begin_;
};

}  // namespace

std::unique_ptr<FrameSource> OpenCameraSource(const std::string& device) {
  return std::make_unique<CameraSource>(device);
}

std::unique_ptr<FrameSource> OpenReplaySource(Recording recording, double speed,
                                              std::optional<Resolution> resolution) {
  return std::make_unique<ReplaySource>(std::move(recording), speed, resolution);
}

}  // namespace calibrato
