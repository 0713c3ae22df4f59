#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/guide/frame_source.h"
#include "calibrato/guide/guide_session.h"
#include "calibrato/recording/growing_recording.h"

namespace calibrato {

/// The latest frame and how fast hints are: written by the capture, read by the page.
class LatestFrame {
 public:
  void Set(const GreyImage& image);
  /// As JPEG; empty before the first, and of recordings without images.
  [[nodiscard]] std::string Jpeg() const;
  void AddLatency(double ms);
  /// Median of the last hundred frames, from the arrival of a frame to what the page is told [ms].
  [[nodiscard]] double MedianLatencyMs() const;

 private:
  mutable std::mutex mutex_;
  std::optional<GreyImage> image_;
  std::vector<double> latencies_ms_;
  size_t next_latency_ = 0;
};

/// Takes frames until the session ends, hint first, then written to the recording before the next
/// is asked for; what the session leaves out is not written. When the source ends or fails, or the
/// disk is full, the session ends with the reason: what was written stays.
/// @param recording  Null for none.
/// @param interrupted  Asked before each frame, and while a replay waits for one.
void Capture(FrameSource& source, GuideSession* session, GrowingRecording* recording,
             LatestFrame* latest, const std::function<bool()>& interrupted);

}  // namespace calibrato
