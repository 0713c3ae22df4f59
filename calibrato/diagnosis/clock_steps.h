#pragma once

#include <string>
#include <vector>

#include "calibrato/diagnosis/finding.h"
#include "calibrato/diagnosis/rotation_speed.h"
#include "calibrato/diagnosis/stream_check.h"
#include "calibrato/sensors/imu.h"

namespace calibrato {

/// How far an IMU's clock is ahead of a camera's, piece by piece of the recording.
struct ClockOffset {
  Time begin;  ///< On the camera's clock.
  Time end;
  SpeedComparison comparison;
};

/// The offset of each piece of the recording in which the rig turned enough to tell: by the speeds
/// of both (rotation_speed.h), to a hundredth of a second. Pieces have forty of the camera's
/// intervals and last 4 s at least. Where speeds repeat themselves, so that several offsets fit a
/// piece alike, it is the one nearest to that of the last sure piece: clocks that run on are no
/// step.
/// @param camera  In order of time. @param gyro  Finite and ascending.
/// @param centre_s  Likewise for the first piece: the offset of the recording as a whole.
[[nodiscard]] std::vector<ClockOffset> ClockOffsets(const std::vector<RotationSpeed>& camera,
                                                    const std::vector<VectorSample>& gyro,
                                                    double centre_s);

/// fail: from one piece to the next the offset changes by more than 50 ms, and both are sure
/// (correlation of 0.9 or more): one of the two clocks was set, or lost time. The offset before
/// then fits the later piece clearly worse (CompareSpeeds).
[[nodiscard]] std::vector<Finding> FindingsOnClockSteps(const std::string& camera,
                                                        const std::string& imu,
                                                        const std::vector<ClockOffset>& offsets);

/// What CheckStreams leaves open of a recording that is to be solved: jitter, bursts and steps of
/// the IMUs' stamps (stream_timing.h), and steps of their clocks against the cameras'.
[[nodiscard]] std::vector<Finding> CheckClocks(const std::vector<CheckedCamera>& cameras,
                                               const std::vector<CheckedImu>& imus);

}  // namespace calibrato
