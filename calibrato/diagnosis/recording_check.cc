#include "calibrato/diagnosis/recording_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrato/calibration/plane_pose.h"
#include "calibrato/diagnosis/detection_findings.h"
#include "calibrato/diagnosis/image_parts.h"
#include "calibrato/diagnosis/recording_findings.h"
#include "calibrato/diagnosis/upper_median.h"

namespace calibrato {
namespace {

constexpr double kSeldom = 0.5;
// Of the speeds of rotation, below which nothing says that camera and IMU were on one body.
constexpr double kNoCorrelation = 0.4;
constexpr size_t kViewsForALens = kMinViews;

std::vector<Time> StampsOfViews(const std::vector<BoardView>& views) {
  std::vector<Time> stamps;
  stamps.reserve(views.size());
  for (const BoardView& view : views) stamps.push_back(view.stamp);
  return stamps;
}

void Append(std::vector<Finding> more, std::vector<Finding>* findings) {
  for (Finding& finding : more) findings->push_back(std::move(finding));
}

// Findings that do not say what they are about, said of a camera.
std::vector<Finding> Of(const std::string& name, std::vector<Finding> findings) {
  for (Finding& finding : findings) finding.what = name + ": " + finding.what;
  return findings;
}

bool IsStamped(const CameraToCheck& camera) {
  return std::any_of(camera.stamps.begin(), camera.stamps.end(),
                     [](Time stamp) { return stamp != Time(); });
}

CheckedBoard BoardOf(const CameraToCheck& camera) {
  CheckedBoard board;
  board.camera = camera.name;
  const StreamTiming seen = TimingOf(StampsOfViews(camera.views));
  board.num_images =
      camera.views.size() + (camera.has_images ? camera.stamps_without_board.size()
                                               : seen.num_missing - seen.num_missing_in_pauses);
  board.longest_away_s = seen.longest_gap_s;
  if (!camera.resolution) return board;
  board.coverage = CoverageOf(camera.views, *camera.resolution);
  board.uncovered_parts = UncoveredParts(camera.views, *camera.resolution);
  return board;
}

std::vector<Finding> FindingsOnBoard(const CameraToCheck& camera, const CheckedBoard& board) {
  const auto share = static_cast<double>(camera.views.size()) /
                     static_cast<double>(std::max<size_t>(1, board.num_images));
  if (camera.views.empty() || share >= kSeldom) return {};
  return {
      {Severity::kWarn,
       camera.name + Format(": the board is in %zu of %zu images only; the longest time without "
                            "it is %.1f s",
                            camera.views.size(), board.num_images, board.longest_away_s),
       "keep the whole board in the image, and move gently enough for sharp images"}};
}

// Of cameras alone, which need fewer views than cameras with an IMU.
std::vector<Finding> FindingsOnFewViews(const std::vector<CameraToCheck>& cameras) {
  std::vector<Finding> findings;
  for (const CameraToCheck& camera : cameras) {
    if (!camera.was_searched || camera.views.size() >= static_cast<size_t>(kMinViews)) continue;
    findings.push_back({Severity::kFail,
                        camera.name + Format(" saw the board in %zu images only, %d are needed",
                                             camera.views.size(), kMinViews),
                        "check --target and the light, and hold the board into the image"});
  }
  return findings;
}

// How far a camera went along the axes of the board.
std::optional<Eigen::Vector3d> TravelOf(const CameraModel& model,
                                        const std::vector<BoardView>& views) {
  std::optional<Eigen::Vector3d> low;
  std::optional<Eigen::Vector3d> high;
  for (const BoardView& view : views) {
    const auto T_c_g = PoseFromView(model, view);
    if (!T_c_g) continue;
    const Eigen::Vector3d position = T_c_g->Inverse().t;
    low = low ? Eigen::Vector3d(low->cwiseMin(position)) : position;
    high = high ? Eigen::Vector3d(high->cwiseMax(position)) : position;
  }
  if (!low) return std::nullopt;
  return *high - *low;
}

Eigen::Vector3d SpreadOf(const std::vector<VectorSample>& samples) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const VectorSample& sample : samples) sum += sample.value;
  const auto n = static_cast<double>(std::max<size_t>(1, samples.size()));
  Eigen::Vector3d squared = Eigen::Vector3d::Zero();
  for (const VectorSample& sample : samples) squared += (sample.value - sum / n).cwiseAbs2();
  return (squared / n).cwiseSqrt();
}

CheckedMotion MotionOf(const std::string& imu, const ImuStream& stream) {
  std::vector<double> forces;
  for (const VectorSample& sample : stream.accel) forces.push_back(sample.value.norm());
  return {imu, SpreadOf(stream.gyro), SpreadOf(stream.accel), UpperMedian(std::move(forces)),
          NoiseAtRest(stream)};
}

// Stamps and what stands beside them.
void CheckEachStream(const RecordingToCheck& recording, RecordingCheck* check) {
  for (const CameraToCheck& camera : recording.cameras) {
    if (!IsStamped(camera)) continue;
    CheckedStream stream{camera.name, TimingOf(camera.stamps), std::nullopt};
    if (camera.has_images) {
      Append(FindingsOnTiming(camera.name, stream.timing), &check->findings);
      Append(FindingsOnMissingImages(camera.name, stream.timing), &check->findings);
    }
    check->streams.push_back(std::move(stream));
  }
  for (const CheckedImu& imu : recording.imus) {
    for (const auto& [sensor, samples] :
         {std::pair(" gyroscope", &imu.recording.stream.gyro),
          std::pair(" accelerometer", &imu.recording.stream.accel)}) {
      const std::string name = imu.recording.name + sensor;
      check->streams.push_back({name, TimingOf(StampsOf(*samples)), FindDefects(*samples)});
      Append(FindingsOnTiming(name, check->streams.back().timing), &check->findings);
    }
  }
}

// The lens of a camera, where it is known, or can be had from the views.
std::optional<CameraModel> CheckLens(const CameraToCheck& camera, RecordingCheck* check) {
  if (camera.model || !camera.resolution || camera.views.size() < kViewsForALens) {
    return camera.model;
  }
  CameraProblem problem;
  problem.resolution = *camera.resolution;
  problem.views = camera.views;
  const CameraCalibration calibration = CalibrateCamera(problem);
  Append(Of(camera.name, FindingsOnBoardPoses(problem, calibration)), &check->findings);
  std::vector<ExpectedSigma> expected = ExpectedIntrinsics(camera.name, problem, calibration);
  Append(FindingsOnExpectedSigmas(expected), &check->findings);
  for (ExpectedSigma& parameter : expected) check->expected.push_back(std::move(parameter));
  return calibration.model;
}

// The views of a camera, or, where none were searched for, its stamps alone.
CheckedCamera ForStreams(const CameraToCheck& camera, std::optional<CameraModel> model) {
  if (camera.was_searched) return {camera.name, camera.views, std::move(model)};
  CheckedCamera stamps_alone{camera.name, {}, std::nullopt};
  for (const Time stamp : camera.stamps) {
    stamps_alone.views.emplace_back();
    stamps_alone.views.back().stamp = stamp;
  }
  return stamps_alone;
}

void CompareClocks(const std::vector<CheckedCamera>& cameras,
                   const std::vector<CheckedMotion>& imus, const std::vector<ImuStream>& mended,
                   RecordingCheck* check) {
  for (const CheckedCamera& camera : cameras) {
    if (!camera.model || camera.views.size() < 2) continue;
    const std::vector<RotationSpeed> speeds = RotationSpeeds(*camera.model, camera.views);
    for (size_t n = 0; n < imus.size(); ++n) {
      const auto comparison = CompareSpeeds(speeds, mended[n].gyro);
      if (!comparison) continue;
      CheckedClock clock{imus[n].imu, camera.name, *comparison,
                         ClockOffsets(speeds, mended[n].gyro, comparison->time_offset_s)};
      Append(FindingsOnClockSteps(camera.name, imus[n].imu, clock.offsets), &check->findings);
      check->clocks.push_back(std::move(clock));
    }
  }
}

void CheckExtrinsics(const RecordingToCheck& recording, const std::vector<CheckedCamera>& cameras,
                     const std::vector<ImuStream>& mended, RecordingCheck* check) {
  if (VerdictOf(check->findings) == Verdict::kFail || mended.empty() || cameras.empty()) return;
  // Start values would be found in noise.
  bool moved_together = true;
  for (const CheckedClock& clock : check->clocks) {
    if (clock.comparison.correlation >= kNoCorrelation) continue;
    moved_together = false;
    check->findings.push_back(
        {Severity::kInconclusive,
         clock.camera + Format(": it did not turn with %s (correlation %.2f): of where they are "
                               "from each other nothing can be said",
                               clock.imu.c_str(), clock.comparison.correlation),
         "mount both on one rigid body, keep the board still, and turn about all axes"});
  }
  if (!moved_together) return;
  CameraImuProblem problem;
  problem.gravity = recording.gravity;
  for (const CheckedCamera& camera : cameras) {
    if (!camera.model || camera.views.empty()) return;
    problem.cameras.push_back({*camera.model, camera.views, IntrinsicsKnowledge::kExact, {}});
  }
  for (size_t n = 0; n < mended.size(); ++n) {
    if (!recording.imus[n].noise) return;
    problem.imus.push_back({mended[n], *recording.imus[n].noise, ImuModelKind::kCalibrated});
  }
  std::vector<ExpectedSigma> expected = ExpectedExtrinsics(problem);
  Append(FindingsOnExpectedSigmas(expected), &check->findings);
  for (ExpectedSigma& parameter : expected) check->expected.push_back(std::move(parameter));
}

}  // namespace

Verdict RecordingCheck::VerdictOn(const std::string& name) const {
  std::vector<Finding> about;
  for (const Finding& finding : findings) {
    const std::string& what = finding.what;
    if (!what.starts_with(name)) continue;
    // "imu0 gyroscope" is about imu0, "imu01" is not.
    const char next = what.size() > name.size() ? what[name.size()] : ' ';
    if (next == ' ' || next == ':' || next == '.') about.push_back(finding);
  }
  return VerdictOf(about);
}

RecordingCheck CheckRecording(const RecordingToCheck& recording) {
  RecordingCheck check;
  CheckEachStream(recording, &check);
  std::vector<CheckedCamera> cameras;
  for (const CameraToCheck& camera : recording.cameras) {
    Append(camera.search_findings, &check.findings);
    Append(Of(camera.name, FindingsOnDetection(camera.rejected)), &check.findings);
    if (camera.resolution) {
      Append(FindingsOnImages(camera.name, camera.images, *camera.resolution), &check.findings);
    }
    if (!camera.was_searched) {
      if (IsStamped(camera) && camera.search_findings.empty()) {
        cameras.push_back(ForStreams(camera, std::nullopt));
      }
      continue;
    }
    CheckedBoard board = BoardOf(camera);
    Append(FindingsOnBoard(camera, board), &check.findings);
    const std::optional<CameraModel> model = CheckLens(camera, &check);
    if (model) board.travel_m = TravelOf(*model, camera.views);
    check.boards.push_back(std::move(board));
    if (IsStamped(camera)) cameras.push_back(ForStreams(camera, model));
  }
  std::vector<ImuStream> mended;
  for (const CheckedImu& imu : recording.imus) {
    mended.push_back(Mended(imu.recording.stream));
    check.motions.push_back(MotionOf(imu.recording.name, mended.back()));
    const std::optional<RestNoise>& rest = check.motions.back().rest;
    if (rest && imu.noise) {
      Append(FindingsOnRestNoise(imu.recording.name, *rest, *imu.noise), &check.findings);
    }
  }
  if (recording.imus.empty()) {
    Append(FindingsOnFewViews(recording.cameras), &check.findings);
  } else {
    Append(CheckStreams(cameras, recording.imus, recording.gravity), &check.findings);
  }
  CompareClocks(cameras, check.motions, mended, &check);
  CheckExtrinsics(recording, cameras, mended, &check);
  std::stable_sort(check.findings.begin(), check.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return check;
}

}  // namespace calibrato
