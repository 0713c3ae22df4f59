#include "calibrato/diagnosis/stream_check.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibrato/calibration/camera_imu_start.h"
#include "calibrato/calibration/rate_alignment.h"
#include "calibrato/diagnosis/rotation_speed.h"
#include "calibrato/diagnosis/stream_defects.h"
#include "calibrato/diagnosis/upper_median.h"

namespace calibrato {
namespace {

constexpr size_t kMinViews = 10;
constexpr double kMaxRateError = 0.1;
constexpr double kMinOverlap = 0.9;
constexpr double kMaxOffset = 0.1;  // [s]
// What the solve looks for, and half a step of the comparison [s].
constexpr double kLargestOffset = CameraImuOptions{}.max_time_offset_s + 0.005;
constexpr double kLongestPause = 10.0;  // [s]
constexpr double kSureCorrelation = 0.8;
constexpr double kNoCorrelation = 0.4;
constexpr double kUnitTolerance = 0.2;
constexpr double kNoTurn = 0.01;       // Of an axis [rad/s], root mean square.
constexpr double kNoMotion = 0.05;     // Of the specific force [m/s^2], likewise.
constexpr double kFastestHand = 10.0;  // Median rate [rad/s] that no hand holds.

bool IsNear(double value, double expected) {
  return value >= (1.0 - kUnitTolerance) * expected && value <= (1.0 + kUnitTolerance) * expected;
}

double MedianNorm(const std::vector<VectorSample>& samples) {
  std::vector<double> norms;
  norms.reserve(samples.size());
  for (const VectorSample& sample : samples) norms.push_back(sample.value.norm());
  return UpperMedian(std::move(norms));
}

// The times between the first and the last of something.
struct Span {
  Time begin;
  Time end;
  double length_s() const { return (end - begin).seconds(); }
};

Span SpanOf(const std::vector<VectorSample>& samples) {
  return {samples.front().stamp, samples.back().stamp};
}

// Negative if they have no part in common.
double OverlapSeconds(const Span& a, const Span& b) {
  return (std::min(a.end, b.end) - std::max(a.begin, b.begin)).seconds();
}

// Whether the camera's views lie in time at all.
bool HasStamps(const CheckedCamera& camera) {
  return camera.views.size() >= 2 && camera.views.front().stamp < camera.views.back().stamp;
}

class Findings {
 public:
  explicit Findings(std::vector<Finding>* findings) : findings_(findings) {}
  void Fail(const std::string& what, const std::string& remedy) {
    findings_->push_back({Severity::kFail, what, remedy});
  }
  void Inconclusive(const std::string& what, const std::string& remedy) {
    findings_->push_back({Severity::kInconclusive, what, remedy});
  }
  void Warn(const std::string& what, const std::string& remedy) {
    findings_->push_back({Severity::kWarn, what, remedy});
  }

 private:
  std::vector<Finding>* findings_;
};

void CheckSamples(const std::string& sensor, const StreamDefects& defects, const char* unit,
                  Findings* findings) {
  const auto share = [&](size_t count) {
    return Format("%zu of %zu samples", count, defects.num_samples);
  };
  if (defects.num_not_finite > 0) {
    findings->Warn(sensor + ": " + share(defects.num_not_finite) + " are not finite numbers",
                   "they are left out; look at the program that recorded them");
  }
  if (defects.num_out_of_order > 0) {
    findings->Warn(sensor + ": " + share(defects.num_out_of_order) +
                       " have a stamp earlier than the one before",
                   "they are sorted; take stamps when the sensor measures, not when a message "
                   "arrives");
  }
  if (defects.num_duplicates > 0) {
    findings->Warn(
        sensor + ": " + share(defects.num_duplicates) + " repeat the stamp of another",
        "the first of each is kept; check that every sample gets a stamp of its own, with "
        "nanoseconds enough to tell them apart");
  }
  if (defects.num_gaps > 0) {
    findings->Warn(
        sensor + Format(": %zu gap%s, the longest %.3f s after the stamp %lld", defects.num_gaps,
                        defects.num_gaps == 1 ? "" : "s", defects.longest_gap_s,
                        static_cast<long long>(defects.longest_gap_begin.nanoseconds())),
        "the motion there is known from images alone; record to a faster disk, or over "
        "a cable that loses nothing");
  }
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = sensor + " " + "xyz"[axis];
    if (defects.is_constant[axis]) {
      findings->Warn(name + " never changes", "check the driver, and the columns of the file");
    } else if (defects.num_saturated[axis] > 0) {
      findings->Warn(
          name + ": " + share(defects.num_saturated[axis]) +
              Format(" stand at the end of its range, %.4g %s", defects.saturated_at[axis], unit),
          "they are left out; move more gently there, or set the sensor to a wider range");
    }
  }
}

void CheckRate(const std::string& sensor, const StreamDefects& defects, double expected_hz,
               Findings* findings) {
  if (!(defects.median_period_s > 0.0)) return;
  const double rate_hz = 1.0 / defects.median_period_s;
  if (std::abs(rate_hz / expected_hz - 1.0) <= kMaxRateError) return;
  findings->Warn(
      sensor + Format(": samples come at %.4g Hz, the YAML says %.4g Hz", rate_hz, expected_hz),
      Format("set update_rate: %.1f, or else noise is weighted wrongly", rate_hz));
}

void CheckOverlap(const std::string& camera_name, const Span& camera, const std::string& imu_name,
                  const Span& imu, Findings* findings) {
  const double overlap_s = OverlapSeconds(camera, imu);
  const std::string both = imu_name + " and " + camera_name;
  if (!(overlap_s > 0.0)) {
    findings->Fail(
        both + Format(" have no time in common: %s begins %.3f s %s %s, and they last "
                      "%.3f s and %.3f s",
                      imu_name.c_str(), std::abs((imu.begin - camera.begin).seconds()),
                      imu.begin < camera.begin ? "before" : "after", camera_name.c_str(),
                      imu.length_s(), camera.length_s()),
        Format("give both stamps of one clock; if they began together, add %.3f s to the "
               "stamps of %s",
               (imu.begin - camera.begin).seconds(), camera_name.c_str()));
  } else if (overlap_s < kMinOverlap * camera.length_s()) {
    findings->Warn(both + Format(" share %.1f s, of the %.1f s of %s", overlap_s, camera.length_s(),
                                 camera_name.c_str()),
                   "images without IMU samples are of little use: start the IMU first and stop it "
                   "last, and check that both stamps are of one clock");
  }
}

// Sizes alone, of one IMU. @return False if its columns are swapped.
bool CheckSizes(const std::string& name, const ImuStream& stream, double gravity,
                Findings* findings) {
  const double rate = MedianNorm(stream.gyro);
  const double force = MedianNorm(stream.accel);
  if (IsNear(rate, gravity) && force < 0.5 * gravity) {
    findings->Fail(name + Format(": the gyroscope's columns read %.3g, as gravity does, and the "
                                 "accelerometer's %.3g",
                                 rate, force),
                   "swap the columns of gyroscope and accelerometer: Kalibr's order is stamp, "
                   "rates, forces");
    return false;
  }
  const std::string what =
      name + Format(" accelerometer: the specific force is %.4g m/s^2 (median), gravity is %.4g",
                    force, gravity);
  if (IsNear(force, gravity)) return true;
  if (IsNear(force, 1.0)) {
    findings->Fail(what + ": it is in g", "multiply the accelerometer's columns by 9.80665");
  } else if (IsNear(force, 1000.0)) {
    findings->Fail(what + ": it is in thousandths of g or in cm/s^2",
                   "multiply the accelerometer's columns by 0.00980665 or by 0.01");
  } else if (force < 0.5 * gravity) {
    findings->Fail(what + ": gravity was taken out of it",
                   "record the raw accelerometer, not the linear acceleration that a phone makes "
                   "of it");
  } else {
    findings->Fail(what, "check the accelerometer's unit and range; it should be in m/s^2");
  }
  return true;
}

// How samples vary about their mean, less white noise, which shows in the differences of
// neighbours: of motion, those are small.
Eigen::Matrix3d VariationOf(const std::vector<VectorSample>& samples) {
  const auto n = static_cast<double>(samples.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const VectorSample& sample : samples) mean += sample.value / n;
  Eigen::Matrix3d variation = Eigen::Matrix3d::Zero();
  for (size_t k = 0; k < samples.size(); ++k) {
    const Eigen::Vector3d from_mean = samples[k].value - mean;
    variation += from_mean * from_mean.transpose() / n;
    if (k == 0) continue;
    const Eigen::Vector3d change = samples[k].value - samples[k - 1].value;
    variation -= change * change.transpose() / (2.0 * (n - 1.0));
  }
  return variation;
}

// Whether the rig turned, and about more than one axis: of its rates the bias is left out.
void CheckMotion(const std::string& name, const ImuStream& stream, Findings* findings) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> turning(VariationOf(stream.gyro));
  const Eigen::Vector3d rates = turning.eigenvalues().cwiseMax(0.0).cwiseSqrt();  // Ascending.
  const std::string remedy =
      "turn the rig to and fro about all three axes, by 20 degrees and more and about once a "
      "second, with the board in view";
  if (!(rates(2) >= kNoTurn)) {
    const double forces = std::sqrt(std::max(0.0, VariationOf(stream.accel).trace()));
    findings->Fail(
        !(forces >= kNoMotion)
            ? name + Format(" did not move: its rates vary by %.2g rad/s and its forces by %.2g "
                            "m/s^2",
                            rates(2), forces)
            : name + Format(" moved but did not turn: its rates vary by %.2g rad/s; without "
                            "rotation nothing shows how the sensors are mounted to each other",
                            rates(2)),
        remedy);
  } else if (!(rates(1) >= kNoTurn)) {
    Eigen::Vector3d axis = turning.eigenvectors().col(2);
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis(largest) < 0.0) axis = -axis;
    // Adding zero makes a zero of a negative one.
    axis = (axis * 100.0).array().round() / 100.0 + 0.0;
    findings->Inconclusive(
        name +
            Format(" turned about one axis only, [%.2g %.2g %.2g] in its frame (%.2g rad/s about "
                   "it, %.2g at right angles): the rotation about it and the translation along "
                   "it do not show",
                   axis.x(), axis.y(), axis.z(), rates(2), rates(1)),
        remedy);
  }
}

constexpr const char* kDegreesRemedy = "multiply the gyroscope's columns by 0.0174532925";

// Against the board's motion, where it can be had.
std::optional<SpeedComparison> SpeedsAgainst(const CheckedCamera& camera,
                                             const std::vector<VectorSample>& gyro) {
  if (!camera.model) return std::nullopt;
  const std::vector<RotationSpeed> board = RotationSpeeds(*camera.model, camera.views);
  const Span views{camera.views.front().stamp, camera.views.back().stamp};
  const bool is_apart = !(OverlapSeconds(views, SpanOf(gyro)) > 0.0);
  const double centre_s = is_apart ? (gyro.front().stamp - views.begin).seconds() : 0.0;
  return CompareSpeeds(board, gyro, centre_s);
}

// The gyroscope's unit, by a camera that turns with it.
void CheckScale(const std::string& camera_name, const std::string& imu_name, double scale,
                bool is_saturated, Findings* findings) {
  const std::string what = imu_name + Format(
                                          " gyroscope: it turns %.3g times as fast as the "
                                          "board in %s",
                                          scale, camera_name.c_str());
  if (IsNear(scale, 180.0 / std::numbers::pi)) {
    findings->Fail(what + ": it is in deg/s", kDegreesRemedy);
  } else if (!IsNear(scale, 1.0) && !is_saturated) {
    // Without its fastest samples a gyroscope seems slower than it is.
    findings->Warn(what, "check the gyroscope's unit and range, and the camera's intrinsics");
  }
}

void CheckClocks(const std::string& camera_name, const std::string& imu_name, double offset_s,
                 Findings* findings) {
  if (!(std::abs(offset_s) > kMaxOffset)) return;
  const std::string what =
      Format("the clock of %s is %.2f s %s that of %s", imu_name.c_str(), std::abs(offset_s),
             offset_s > 0.0 ? "ahead of" : "behind", camera_name.c_str());
  if (std::abs(offset_s) > kLargestOffset) {
    findings->Fail(what, Format("add %.2f s to the stamps of %s; offsets of up to 1 s are "
                                "estimated, larger ones are not",
                                offset_s, camera_name.c_str()));
  } else {
    findings->Warn(what, Format("offsets of up to 1 s are estimated; to be rid of it, add %.2f s "
                                "to the stamps of %s",
                                offset_s, camera_name.c_str()));
  }
}

// The IMU against each of the cameras; its unit against the first that can tell.
void CheckSpeeds(const std::vector<CheckedCamera>& cameras, const std::string& imu_name,
                 const std::vector<VectorSample>& gyro, bool is_saturated, Findings* findings) {
  bool is_compared = false;
  bool has_known_scale = false;
  for (const CheckedCamera& camera : cameras) {
    if (!HasStamps(camera)) continue;
    const auto speeds = SpeedsAgainst(camera, gyro);
    if (!speeds) continue;
    is_compared = true;
    if (speeds->correlation >= kSureCorrelation) {
      if (!has_known_scale) {
        CheckScale(camera.name, imu_name, speeds->scale, is_saturated, findings);
      }
      has_known_scale = true;
      CheckClocks(camera.name, imu_name, speeds->time_offset_s, findings);
    } else if (speeds->correlation < kNoCorrelation) {
      findings->Warn(Format("%s and %s do not turn at the same times (correlation %.2f at best)",
                            imu_name.c_str(), camera.name.c_str(), speeds->correlation),
                     "check that both are on one rigid body, that the board stands still, and that "
                     "their clocks are less than 3 s apart");
    }
  }
  const double rate = MedianNorm(gyro);
  if (!is_compared && rate > kFastestHand) {
    findings->Fail(imu_name + Format(" gyroscope: it reads %.3g rad/s (median), faster than a "
                                     "hand turns: it may be in deg/s",
                                     rate),
                   kDegreesRemedy);
  }
}

// How far apart in time its views are.
void CheckIntervals(const CheckedCamera& camera, Findings* findings) {
  if (!HasStamps(camera)) {
    findings->Fail(camera.name + ": its images have no stamps, or all the same",
                   "name each file by its stamp in nanoseconds (1600000000050000000.png), or list "
                   "stamps and files in data.csv beside them");
    return;
  }
  std::vector<double> intervals_s;
  size_t num_short = 0;
  for (size_t v = 1; v < camera.views.size(); ++v) {
    intervals_s.push_back((camera.views[v].stamp - camera.views[v - 1].stamp).seconds());
    if (intervals_s.back() > 0.0 && intervals_s.back() <= kLongestViewInterval) ++num_short;
  }
  if (num_short >= kMinRateIntervals) return;
  findings->Fail(camera.name + Format(": its views are %.2g s apart (median); over more than %.1f "
                                      "s they do not show how the rig turned",
                                      UpperMedian(intervals_s), kLongestViewInterval),
                 "record 10 images a second or more, with the board in view; leave out --every");
}

void CheckImu(const CheckedImu& imu, const std::vector<CheckedCamera>& cameras, double gravity,
              Findings* findings) {
  const std::string& name = imu.recording.name;
  const StreamDefects gyro = FindDefects(imu.recording.stream.gyro);
  const StreamDefects accel = FindDefects(imu.recording.stream.accel);
  const ImuStream stream = Mended(imu.recording.stream);
  CheckSamples(name + " gyroscope", gyro, "rad/s", findings);
  CheckSamples(name + " accelerometer", accel, "m/s^2", findings);
  if (stream.gyro.size() < 2 || stream.accel.size() < 2) {
    findings->Fail(name + " has no samples that can be used", "record the IMU again");
    return;
  }
  if (imu.noise) {
    CheckRate(name + " gyroscope", gyro, imu.noise->rate_hz, findings);
    CheckRate(name + " accelerometer", accel, imu.noise->rate_hz, findings);
  }
  const double pause_s = std::min(gyro.longest_gap_s, accel.longest_gap_s);
  if (pause_s > kLongestPause) {
    findings->Fail(name + Format(" recorded nothing for %.1f s, from %.3f s on", pause_s,
                                 (gyro.longest_gap_begin - stream.gyro.front().stamp).seconds()),
                   "calibrate what lies before and after on its own, by --to and --from; a clock "
                   "that was set while recording looks like that too");
    return;
  }
  const bool columns_are_right = CheckSizes(name, stream, gravity, findings);
  if (columns_are_right) CheckMotion(name, stream, findings);
  for (const CheckedCamera& camera : cameras) {
    if (!HasStamps(camera)) continue;
    const Span views{camera.views.front().stamp, camera.views.back().stamp};
    for (const auto& [sensor, samples] :
         {std::pair(" gyroscope", &stream.gyro), std::pair(" accelerometer", &stream.accel)}) {
      CheckOverlap(camera.name, views, name + sensor, SpanOf(*samples), findings);
    }
  }
  const bool is_saturated =
      gyro.num_saturated[0] + gyro.num_saturated[1] + gyro.num_saturated[2] > 0;
  if (columns_are_right) CheckSpeeds(cameras, name, stream.gyro, is_saturated, findings);
}

}  // namespace

std::vector<Finding> CheckStreams(const std::vector<CheckedCamera>& cameras,
                                  const std::vector<CheckedImu>& imus, double gravity) {
  std::vector<Finding> list;
  Findings findings(&list);
  for (const CheckedCamera& camera : cameras) {
    if (camera.views.empty()) {
      findings.Fail(camera.name + " never saw the board",
                    "check --target and the light, and hold the board into the image");
    } else if (camera.views.size() < kMinViews) {
      findings.Fail(camera.name + Format(" saw the board in %zu images only, %zu are needed",
                                         camera.views.size(), kMinViews),
                    "record 30 s at 10 Hz or more, with the board in the image");
    } else {
      CheckIntervals(camera, &findings);
    }
  }
  for (const CheckedImu& imu : imus) CheckImu(imu, cameras, gravity, &findings);
  return list;
}

}  // namespace calibrato
