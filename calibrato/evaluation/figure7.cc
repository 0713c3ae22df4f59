#include "calibrato/evaluation/figure7.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/evaluation/method_row.h"
#include "calibrato/mdp/extrinsic_problem.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/imu_simulation.h"
#include "calibrato/simulation/simulated_run.h"

namespace calibrato {
namespace {

constexpr Time kStart = Time::FromNanoseconds(1'000'000'000'000);
// More points than this tell the eye nothing.
constexpr size_t kMostPoints = 600;

struct Recorded {
  std::vector<BoardView> views;
  SimulatedImu imu;
};

Recorded Record(const Rig& rig, const ExecutableMotion& motion, Fidelity fidelity,
                const Rng& noise) {
  if (motion.timed) {
    SimulatedRun run = SimulateRun(rig, *motion.timed, fidelity, kStart, noise);
    return {std::move(run.frames.views), std::move(run.imu)};
  }
  Rng frame_noise = noise.Stream("simulate");
  Rng imu_noise = noise.Stream("simulate imu");
  return {SimulateFrames(rig, motion.path, kStart, frame_noise).views,
          SimulateImu(rig, motion.path, kStart, imu_noise)};
}

EstimatorOutput Estimate(const std::string& policy, size_t member, const Rig& rig,
                         Recorded recorded) {
  EstimatorOutput output;
  output.policy = policy;
  output.member = member;
  output.true_gyro_bias = recorded.imu.mean_gyro_bias;
  output.true_accel_bias = recorded.imu.mean_accel_bias;
  const CameraImuProblem problem =
      ExtrinsicProblem(rig, std::move(recorded.views), std::move(recorded.imu.stream));
  output.calibration = CalibrateCameraImu(problem);
  if (!output.calibration.state) return output;
  const ImuStream& stream = problem.imus.front().stream;
  for (const VectorSample& sample : stream.gyro) {
    output.gyro_time_s.push_back(TimeOfSample(*output.calibration.state, 0, sample.stamp));
  }
  for (const VectorSample& sample : stream.accel) {
    output.accel_time_s.push_back(TimeOfSample(*output.calibration.state, 0, sample.stamp));
  }
  return output;
}

// Residuals of corners that took part, a column each.
std::vector<Eigen::Vector2d> CornerResiduals(const CameraImuCalibration& calibration) {
  std::vector<Eigen::Vector2d> residuals;
  const auto& views = calibration.residuals.corners_px.front();
  for (size_t v = 0; v < views.size(); ++v) {
    for (Eigen::Index k = 0; k < views[v].cols(); ++k) {
      const bool is_inlier = calibration.inliers.corners.front()[v][static_cast<size_t>(k)];
      if (is_inlier && views[v].col(k).allFinite()) residuals.emplace_back(views[v].col(k));
    }
  }
  return residuals;
}

double RootMeanSquare(const std::vector<Eigen::Vector3d>& residuals,
                      const std::vector<bool>& inliers) {
  double sum = 0.0;
  int count = 0;
  for (size_t i = 0; i < residuals.size(); ++i) {
    if (!inliers[i] || !residuals[i].allFinite()) continue;
    sum += residuals[i].squaredNorm();
    count += 3;
  }
  return std::sqrt(sum / count);
}

void SetReprojection(const CameraImuCalibration& calibration, Value* row) {
  const std::vector<Eigen::Vector2d> residuals = CornerResiduals(calibration);
  const auto n = static_cast<double>(residuals.size());
  Eigen::Array2d mean = Eigen::Array2d::Zero();
  for (const Eigen::Vector2d& r : residuals) mean += r.array() / n;
  Eigen::Array2d square = Eigen::Array2d::Zero();
  Eigen::Array2d cube = Eigen::Array2d::Zero();
  for (const Eigen::Vector2d& r : residuals) {
    square += (r.array() - mean).square() / n;
    cube += (r.array() - mean).cube() / n;
  }
  row->Set("reprojection_rms_px", calibration.reprojection_rms_px)
      .Set("reprojection_mean_px", Value::Numbers(mean))
      .Set("reprojection_skewness", Value::Numbers(Eigen::Array2d(cube / square.pow(1.5))));
}

Value RowOf(const Figure7& figure, const EstimatorOutput& output, const Rig& rig) {
  const CameraImuCalibration& calibration = output.calibration;
  Value row = SettingValue(figure.setting);
  row.Set("policy", output.policy)
      .Set("member", static_cast<int64_t>(output.member))
      .Set("n", 1)
      .Set("termination", TerminationName(calibration.termination));
  if (!calibration.state) return row;
  SetReprojection(calibration, &row);
  const ImuNoise& noise = rig.imu_noise;
  const double root_rate = std::sqrt(noise.rate_hz);
  const double gyro =
      RootMeanSquare(calibration.residuals.gyro.front(), calibration.inliers.gyro.front());
  const double accel =
      RootMeanSquare(calibration.residuals.accel.front(), calibration.inliers.accel.front());
  const ImuBias bias = MeanBias(calibration.state->imus.front());
  row.Set("gyro_rms_rad_s", gyro)
      .Set("gyro_rms_normalised", gyro / (noise.gyro_noise_density * root_rate))
      .Set("accel_rms_m_s2", accel)
      .Set("accel_rms_normalised", accel / (noise.accel_noise_density * root_rate))
      .Set("gyro_bias_error_rad_s", (bias.gyro - output.true_gyro_bias).norm())
      .Set("accel_bias_error_m_s2", (bias.accel - output.true_accel_bias).norm());
  return row;
}

// As legends call it.
std::string NameOf(const EstimatorOutput& output) {
  return output.member == 1 ? output.policy
                            : output.policy + " (" + std::to_string(output.member) + ")";
}

ChartSeries NormsOverTime(const std::string& name, const std::vector<double>& time_s,
                          const std::vector<Eigen::Vector3d>& residuals) {
  // The largest of each stretch of time, so that nothing that stands out is lost.
  ChartSeries series{name, {}, {}, {}, {}};
  const size_t stride = std::max<size_t>(1, residuals.size() / kMostPoints);
  for (size_t i = 0; i < residuals.size(); i += stride) {
    double largest = -1.0;
    for (size_t k = i; k < std::min(i + stride, residuals.size()); ++k) {
      if (residuals[k].allFinite()) largest = std::max(largest, residuals[k].norm());
    }
    // A stretch in which the estimator used no sample has no largest one.
    if (largest < 0.0) continue;
    series.x.push_back(time_s[i]);
    series.y.push_back(largest);
  }
  return series;
}

ChartSeries BiasError(const EstimatorOutput& output, bool is_gyro) {
  const CameraImuState& state = *output.calibration.state;
  ChartSeries series{NameOf(output), {}, {}, {}, {}};
  const std::vector<ImuBias>& biases = state.imus.front().biases;
  for (size_t k = 0; k < biases.size(); ++k) {
    series.x.push_back(static_cast<double>(k) * state.block_duration_s());
    series.y.push_back(is_gyro ? (biases[k].gyro - output.true_gyro_bias).norm()
                               : (biases[k].accel - output.true_accel_bias).norm());
  }
  return series;
}

Chart Named(Chart::Kind kind, const std::string& title, const std::string& note,
            const std::string& x_title, const std::string& y_title) {
  Chart chart;
  chart.kind = kind;
  chart.title = title;
  chart.note = note;
  chart.x_title = x_title;
  chart.y_title = y_title;
  return chart;
}

}  // namespace

Figure7 EvaluateFigure7(const ContestSetting& setting,
                        const std::vector<MotionUnderTrial>& motions) {
  if (setting.fidelity == Fidelity::kRendered) {
    throw InputError({"figure 7 has no fidelity rendered", "",
                      "it shows the estimator's residuals of corners as they were simulated",
                      "use --fidelity fast, or physical with --carrier arm"});
  }
  Figure7 figure{setting, {}};
  const Rig scene = PlanningScene(setting);
  std::vector<Contestant> contestants = {
      FixedContestant("handcrafted", HandcraftedMotion(Task::kExtrinsic), setting.carrier, scene)};
  for (Contestant& brought :
       BroughtContestants(motions, Task::kExtrinsic, setting.carrier, scene)) {
    contestants.push_back(std::move(brought));
  }
  const Rng noise = Rng(setting.seed).Stream("figure 7");
  for (const Contestant& contestant : contestants) {
    for (size_t m = 0; m < contestant.num_members(); ++m) {
      figure.outputs.push_back(
          Estimate(contestant.policy, m + 1, scene,
                   Record(scene, contestant.motions[m], setting.fidelity, noise)));
    }
  }
  return figure;
}

Value ToValue(const Figure7& figure) {
  const Rig scene = PlanningScene(figure.setting);
  Value rows = Value::Array();
  for (const EstimatorOutput& output : figure.outputs) rows.Append(RowOf(figure, output, scene));
  Value value = Value::Object();
  value.Set("kind", "figure7").Set("rows", std::move(rows));
  return value;
}

std::vector<Chart> ChartsOf(const Figure7& figure) {
  const std::string note = "Largest of each stretch of time; one recording of each motion.";
  Chart corners = Named(Chart::Kind::kDots, "Reprojection errors", "Corners, evenly thinned out.",
                        "u [px]", "v [px]");
  Chart gyro = Named(Chart::Kind::kLines, "Residuals of the angular rate", note, "time [s]",
                     "residual [rad/s]");
  Chart accel = Named(Chart::Kind::kLines, "Residuals of the specific force", note, "time [s]",
                      "residual [m/s²]");
  Chart gyro_bias = Named(Chart::Kind::kLines, "Gyroscope bias: distance to its true mean",
                          "The true bias wanders about its mean.", "time [s]", "distance [rad/s]");
  Chart accel_bias = Named(Chart::Kind::kLines, "Accelerometer bias: distance to its true mean",
                           "The true bias wanders about its mean.", "time [s]", "distance [m/s²]");
  for (const EstimatorOutput& output : figure.outputs) {
    const CameraImuCalibration& calibration = output.calibration;
    if (!calibration.state) continue;
    const std::vector<Eigen::Vector2d> residuals = CornerResiduals(calibration);
    ChartSeries dots{NameOf(output), {}, {}, {}, {}};
    const size_t stride = std::max<size_t>(1, residuals.size() / kMostPoints);
    for (size_t i = 0; i < residuals.size(); i += stride) {
      dots.x.push_back(residuals[i].x());
      dots.y.push_back(residuals[i].y());
    }
    corners.series.push_back(std::move(dots));
    gyro.series.push_back(
        NormsOverTime(NameOf(output), output.gyro_time_s, calibration.residuals.gyro.front()));
    accel.series.push_back(
        NormsOverTime(NameOf(output), output.accel_time_s, calibration.residuals.accel.front()));
    gyro_bias.series.push_back(BiasError(output, true));
    accel_bias.series.push_back(BiasError(output, false));
  }
  return {corners, gyro, accel, gyro_bias, accel_bias};
}

}  // namespace calibrato
