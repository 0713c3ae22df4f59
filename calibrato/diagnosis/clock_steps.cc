#include "calibrato/diagnosis/clock_steps.h"

#include <cmath>
#include <utility>

#include "calibrato/diagnosis/stream_defects.h"
#include "calibrato/diagnosis/stream_timing.h"

namespace calibrato {
namespace {

constexpr size_t kIntervals = 40;
constexpr double kLeastPiece = 4.0;  // [s]
constexpr double kSure = 0.9;
constexpr double kStep = 0.05;  // [s]

void Append(std::vector<Finding> more, std::vector<Finding>* findings) {
  for (Finding& finding : more) findings->push_back(std::move(finding));
}

}  // namespace

std::vector<ClockOffset> ClockOffsets(const std::vector<RotationSpeed>& camera,
                                      const std::vector<VectorSample>& gyro, double centre_s) {
  std::vector<ClockOffset> offsets;
  std::vector<RotationSpeed> piece;
  double expected_s = centre_s;
  for (const RotationSpeed& interval : camera) {
    piece.push_back(interval);
    const Time begin = piece.front().begin;
    if (piece.size() < kIntervals || (interval.end - begin).seconds() < kLeastPiece) continue;
    if (const auto comparison = CompareSpeeds(piece, gyro, expected_s)) {
      offsets.push_back({begin, interval.end, *comparison});
      if (comparison->correlation >= kSure) expected_s = comparison->time_offset_s;
    }
    piece.clear();
  }
  return offsets;
}

std::vector<Finding> FindingsOnClockSteps(const std::string& camera, const std::string& imu,
                                          const std::vector<ClockOffset>& offsets) {
  std::vector<Finding> findings;
  const ClockOffset* before = nullptr;
  for (const ClockOffset& offset : offsets) {
    if (offset.comparison.correlation < kSure) continue;
    if (before != nullptr) {
      const double step_s = offset.comparison.time_offset_s - before->comparison.time_offset_s;
      if (std::abs(step_s) > kStep) {
        findings.push_back(
            {Severity::kFail,
             Format("the clocks of %s and %s moved against each other: %s is ahead by %.2f s until "
                    "%.1f s after the first image, by %.2f s from %.1f s on",
                    imu.c_str(), camera.c_str(), imu.c_str(), before->comparison.time_offset_s,
                    (before->end - offsets.front().begin).seconds(),
                    offset.comparison.time_offset_s,
                    (offset.begin - offsets.front().begin).seconds()),
             "a clock was set, or samples were lost without a gap in their stamps: calibrate one "
             "side of it alone, by --from and --to, or record again"});
      }
    }
    before = &offset;
  }
  return findings;
}

std::vector<Finding> CheckClocks(const std::vector<CheckedCamera>& cameras,
                                 const std::vector<CheckedImu>& imus) {
  std::vector<Finding> findings;
  for (const CheckedImu& imu : imus) {
    const std::string& name = imu.recording.name;
    for (const auto& [sensor, samples] :
         {std::pair(" gyroscope", &imu.recording.stream.gyro),
          std::pair(" accelerometer", &imu.recording.stream.accel)}) {
      Append(FindingsOnTiming(name + sensor, TimingOf(StampsOf(*samples))), &findings);
    }
    const std::vector<VectorSample> gyro = Mended(imu.recording.stream.gyro);
    for (const CheckedCamera& camera : cameras) {
      if (!camera.model || camera.views.size() < 2) continue;
      const std::vector<RotationSpeed> speeds = RotationSpeeds(*camera.model, camera.views);
      const auto whole = CompareSpeeds(speeds, gyro);
      if (!whole) continue;
      Append(
          FindingsOnClockSteps(camera.name, name, ClockOffsets(speeds, gyro, whole->time_offset_s)),
          &findings);
    }
  }
  return findings;
}

}  // namespace calibrato
