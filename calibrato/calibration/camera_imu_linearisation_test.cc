#include "calibrato/calibration/camera_imu_linearisation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/parallel.h"
#include "calibrato/base/rng.h"
#include "calibrato/calibration/camera_imu_measurements.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/calibration/view_fit.h"

namespace calibrato {
namespace {

using Eigen::VectorXd;

VectorXd RandomVector(Eigen::Index size, double scale, Rng& rng) {
  VectorXd vector(size);
  for (double& entry : vector) entry = scale * rng.Normal();
  return vector;
}

// Everything that the estimator knows, at once: two cameras, one with parameters of unknown value
// and one with a prior, two IMUs with the largest model, a board of unknown size. Measurements
// agree with the state exactly.
struct Whole {
  CameraImuProblem problem;
  CameraImuState state;
  CameraImuLayout layout;
  CameraImuWeights weights;
  CameraImuMeasurements measurements;

  explicit Whole(int order, bool rolling_shutters = false)
      : problem(MakeProblem(rolling_shutters)),
        state(MakeState(problem, order)),
        layout(problem, order) {
    Rng rng(5);
    // Away from all that is zero or the identity.
    VectorXd delta = VectorXd::Zero(state.num_blocks() * layout.block_size + layout.border_size);
    delta.tail(layout.border_size) = RandomVector(layout.border_size, 0.01, rng);
    delta.segment(layout.block_size * state.num_blocks() + layout.cameras[0].parameters, 8) *= 0.1;
    for (const CameraImuLayout::Camera& camera : layout.cameras) {
      if (!rolling_shutters) continue;
      delta(layout.block_size * state.num_blocks() + camera.line_delay) *= 0.01;
    }
    state = *Perturbed(state, layout, delta);
    for (size_t n = 0; n < problem.cameras.size(); ++n) {
      problem.cameras[n].model = state.cameras[n].model;
    }
    // When a row is exposed depends on where the corner is; it hardly moves after the first time.
    for (int round = 0; round < 8; ++round) {
      const CameraImuResiduals residuals = ResidualsOf(problem, state);
      for (size_t n = 0; n < problem.cameras.size(); ++n) {
        for (size_t v = 0; v < problem.cameras[n].views.size(); ++v) {
          const Eigen::Matrix2Xd& errors = residuals.corners_px[n][v];
          problem.cameras[n].views[v].pixels +=
              errors.array().isFinite().select(errors.array(), 0.0).matrix();
        }
      }
    }
    const CameraImuResiduals residuals = ResidualsOf(problem, state);
    for (size_t n = 0; n < problem.imus.size(); ++n) {
      ImuStream& stream = problem.imus[n].stream;
      for (size_t k = 0; k < stream.gyro.size(); ++k) {
        stream.gyro[k].value += residuals.gyro[n][k];
        stream.accel[k].value += residuals.accel[n][k];
      }
    }
    weights = {0.5, {{0.01, 0.05, 1e-3, 1e-2}, {0.02, 0.03, 2e-3, 2e-2}}, 0.0};
    measurements = MeasurementsOf(problem, state, SelectionOfFinite(ResidualsOf(problem, state)));
  }

  static CameraImuProblem MakeProblem(bool rolling_shutters) {
    SyntheticCameraImu truth;
    truth.duration_s = 1.2;
    truth.T_c_i.push_back({truth.T_c_i[0].R, {-0.05, 0.01, 0.02}});
    truth.time_offset_s.push_back(-0.011);
    Rng rng(3);
    CameraImuProblem problem = truth.Problem(rng);
    problem.cameras[0].intrinsics = IntrinsicsKnowledge::kUnknown;
    problem.cameras[1].intrinsics = IntrinsicsKnowledge::kPrior;
    problem.cameras[1].intrinsics_covariance =
        VectorXd::LinSpaced(8, 0.5, 1.0).asDiagonal().toDenseMatrix();
    problem.imus[0].model = ImuModelKind::kScaleMisalignmentSizeEffect;
    problem.imus.push_back(problem.imus[0]);
    problem.imus[1].model = ImuModelKind::kScaleMisalignment;
    problem.estimate_line_delays = rolling_shutters;
    problem.estimate_board_scale = true;
    // Accelerometers of their own stamps.
    for (VectorSample& sample : problem.imus[1].stream.accel) {
      sample.stamp = sample.stamp + Duration::FromSeconds(0.0021);
    }
    return problem;
  }

  static CameraImuState MakeState(const CameraImuProblem& problem, int order) {
    SyntheticCameraImu truth;
    const double spacing = 1.0 / (3 * (order - 1));
    CameraImuState state{
        truth.epoch + Duration::FromSeconds(0.1),
        SplineAlong([&](double t) { return truth.PoseAt(t + 0.1); }, order, spacing, 1.0),
        truth.gravity_g,
        {},
        {}};
    state.cameras = {{problem.cameras[0].model, truth.T_c_i[0], 0.0073},
                     {problem.cameras[1].model, {truth.T_c_i[0].R, {-0.05, 0.01, 0.02}}, -0.011}};
    const std::vector<ImuBias> biases(static_cast<size_t>(state.num_blocks()),
                                      {truth.gyro_bias, truth.accel_bias});
    state.imus = {{{}, {}, 0.0, biases},
                  {{}, {Eigen::Matrix3d::Identity(), {0.1, 0.02, -0.05}}, 0.004, biases}};
    return state;
  }

  ArrowheadSystem System() const {
    return {state.num_blocks(), layout.block_size, layout.border_size};
  }
  double CostAt(const CameraImuState& at, double loss_scale = 0.0) const {
    ArrowheadSystem system = System();
    CameraImuWeights of = weights;
    of.loss_scale = loss_scale;
    return Linearise(problem, at, layout, measurements, of, &system).value();
  }
};

// Where all residuals are zero the cost is x'H x for small x.
TEST(CameraImuLinearisation, NormalEquationsAreTheCostsCurvature) {
  for (int order = kMinSplineOrder; order <= kMaxSplineOrder; ++order) {
    const Whole whole(order, order == kMaxSplineOrder);
    ArrowheadSystem system = whole.System();
    const double least = Linearise(whole.problem, whole.state, whole.layout, whole.measurements,
                                   whole.weights, &system)
                             .value();
    const Eigen::MatrixXd H = system.Dense();
    Rng rng(1);
    // Each unknown in units of its own curvature, so that none hides behind another.
    const VectorXd unit = H.diagonal().cwiseSqrt().cwiseInverse();
    for (int trial = 0; trial < 40; ++trial) {
      const VectorXd x = unit.cwiseProduct(RandomVector(H.rows(), 1e-2, rng));
      const double high = whole.CostAt(*Perturbed(whole.state, whole.layout, x));
      const double low = whole.CostAt(*Perturbed(whole.state, whole.layout, -x));
      const double expected = x.dot(H * x);
      EXPECT_NEAR(0.5 * (high + low) - least, expected, 2e-3 * expected) << order;
    }
  }
}

// Anywhere, and with a loss, the gradient is half the cost's.
TEST(CameraImuLinearisation, GradientIsThatOfTheCost) {
  for (const double loss_scale : {0.0, 1.0}) {
    Whole whole(6, loss_scale == 0.0);
    Rng rng(2);
    ArrowheadSystem system = whole.System();
    (void)Linearise(whole.problem, whole.state, whole.layout, whole.measurements, whole.weights,
                    &system);
    const VectorXd unit = system.Diagonal().cwiseSqrt().cwiseInverse();
    const CameraImuState state = *Perturbed(whole.state, whole.layout,
                                            unit.cwiseProduct(RandomVector(unit.size(), 1.0, rng)));
    CameraImuWeights weights = whole.weights;
    weights.loss_scale = loss_scale;
    (void)Linearise(whole.problem, state, whole.layout, whole.measurements, weights, &system);
    const VectorXd gradient = system.Gradient();
    const double scale = gradient.cwiseProduct(unit).cwiseAbs().maxCoeff();
    // All of the calibration, and every eleventh of trajectory and biases: blocks have 42.
    const Eigen::Index border = unit.size() - whole.layout.border_size;
    for (Eigen::Index i = 0; i < unit.size(); i += i < border ? 11 : 1) {
      const double step = 1e-3 * unit(i);
      const VectorXd x = step * VectorXd::Unit(unit.size(), i);
      const double numeric = 0.25 *
                             (whole.CostAt(*Perturbed(state, whole.layout, x), loss_scale) -
                              whole.CostAt(*Perturbed(state, whole.layout, -x), loss_scale)) /
                             step;
      EXPECT_NEAR(gradient(i) * unit(i), numeric * unit(i), 1e-4 * scale) << i;
    }
  }
}

TEST(CameraImuLinearisation, IsTheSameToTheBitForAnyNumberOfThreads) {
  const Whole whole(5, true);
  const auto run = [&](int num_threads) {
    SetNumThreads(num_threads);
    ArrowheadSystem system = whole.System();
    (void)Linearise(whole.problem, whole.state, whole.layout, whole.measurements, whole.weights,
                    &system);
    SetNumThreads(0);
    return system.Dense();
  };
  EXPECT_EQ(run(1), run(4));
}

TEST(CameraImuLinearisation, RefusesAStateFromWhichACornerDoesNotProject) {
  Whole whole(6);
  ArrowheadSystem system = whole.System();
  whole.state.cameras[0].T_c_i.t.z() -= 5.0;
  EXPECT_FALSE(Linearise(whole.problem, whole.state, whole.layout, whole.measurements,
                         whole.weights, &system)
                   .has_value());
}

}  // namespace
}  // namespace calibrato
