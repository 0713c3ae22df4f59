#include "calibrato/guide/capture.h"

#include <algorithm>
#include <chrono>
#include <exception>

#include "calibrato/recording/photo.h"

namespace calibrato {

void LatestFrame::Set(const GreyImage& image) {
  const std::lock_guard lock(mutex_);
  image_ = image;
}

std::string LatestFrame::Jpeg() const {
  std::optional<GreyImage> image;
  {
    const std::lock_guard lock(mutex_);
    image = image_;
  }
  return image ? EncodeJpeg(*image) : "";
}

void LatestFrame::AddLatency(double ms) {
  constexpr size_t kFrames = 100;
  const std::lock_guard lock(mutex_);
  if (latencies_ms_.size() < kFrames) {
    latencies_ms_.push_back(ms);
  } else {
    latencies_ms_[next_latency_++ % kFrames] = ms;
  }
}

double LatestFrame::MedianLatencyMs() const {
  std::vector<double> sorted;
  {
    const std::lock_guard lock(mutex_);
    sorted = latencies_ms_;
  }
  if (sorted.empty()) return 0.0;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

void Capture(FrameSource& source, GuideSession* session, GrowingRecording* recording,
             LatestFrame* latest, const std::function<bool()>& interrupted) {
  using Clock = std::chrono::steady_clock;
  const FrameSource::ImuSink sink{[&](const VectorSample& gyro, const VectorSample& accel) {
                                    const bool has_gyro = session->AddGyro(gyro);
                                    const bool has_accel = session->AddAccel(accel);
                                    if (recording != nullptr && has_gyro && has_accel) {
                                      recording->AddImu(gyro, accel);
                                    }
                                  },
                                  [&](const VectorSample& gyro) {
                                    const bool is_taken = session->AddGyro(gyro);
                                    if (recording != nullptr && is_taken) recording->AddGyro(gyro);
                                  },
                                  [&](const VectorSample& accel) {
                                    const bool is_taken = session->AddAccel(accel);
                                    if (recording != nullptr && is_taken) {
                                      recording->AddAccel(accel);
                                    }
                                  }};
  const auto stop = [&] { return interrupted() || session->has_ended(); };
  try {
    while (!session->has_ended()) {
      if (interrupted()) {
        session->End("interrupted");
        return;
      }
      const std::optional<CapturedFrame> frame = source.Next(sink, stop);
      if (!frame) {
        session->End(source.end_words());
        return;
      }
      const Clock::time_point arrived = Clock::now();
      if (frame->num_dropped > 0) session->AddDroppedFrames(frame->num_dropped);
      if (frame->image) latest->Set(*frame->image);
      const bool is_taken = frame->image ? session->AddFrame(frame->stamp, *frame->image)
                                         : session->AddView(frame->stamp, frame->view);
      static_cast<void>(session->Snapshot());
      latest->AddLatency(std::chrono::duration<double, std::milli>(Clock::now() - arrived).count());
      if (recording == nullptr || !is_taken) continue;
      if (!frame->file.empty()) {
        recording->AddImageFile(frame->stamp, frame->file);
      } else if (frame->image) {
        recording->AddImage(frame->stamp, *frame->image);
      } else if (frame->view) {
        recording->AddView(*frame->view);
      }
    }
  } catch (const std::exception& error) {
    session->End(error.what());
  }
}

}  // namespace calibrato
