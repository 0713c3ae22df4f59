#include "calibrato/evaluation/filter_calibration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "calibrato/calibration/plane_pose.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

constexpr int kSize = 24;
using Covariance = Eigen::Matrix<double, kSize, kSize>;
using Error = Eigen::Matrix<double, kSize, 1>;

// Where each error stands.
constexpr int kTheta = 0;
constexpr int kPosition = 3;
constexpr int kVelocity = 6;
constexpr int kGyroBias = 9;
constexpr int kAccelBias = 12;
constexpr int kGravity = 15;
constexpr int kExtrinsics = 18;

// What is believed of biases before any data [rad/s], [m/s^2], and of the velocity at rest [m/s].
constexpr double kGyroBiasSigma = 0.01;
constexpr double kAccelBiasSigma = 0.1;
constexpr double kVelocitySigma = 0.01;
// Of the first pose, found from the corners alone [rad], [m].
constexpr double kFirstRotationSigma = 0.005;
constexpr double kFirstTranslationSigma = 0.005;

struct State {
  Rigid3 T_g_i;
  Eigen::Vector3d velocity_g = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d gravity_g = Eigen::Vector3d::Zero();
  Rigid3 T_c_i;
};

// A turn of the attitude turns velocity and gravity along: what is known of them is known in the
// IMU's frame, and a guess of T_c_i that is 0.1 rad off turns all three alike, exactly so and not
// to first order only (the right-invariant error of Barrau and Bonnabel, "The invariant extended
// Kalman filter as a stable observer", IEEE Transactions on Automatic Control 2017).
State Corrected(const State& state, const Error& error) {
  const Eigen::Matrix3d turn = ExpSo3(error.segment<3>(kTheta));
  State corrected = state;
  corrected.T_g_i = state.T_g_i.Perturbed(error.segment<6>(kTheta));
  corrected.velocity_g = turn * (state.velocity_g + error.segment<3>(kVelocity));
  corrected.gyro_bias += error.segment<3>(kGyroBias);
  corrected.accel_bias += error.segment<3>(kAccelBias);
  corrected.gravity_g = turn * (state.gravity_g + error.segment<3>(kGravity));
  corrected.T_c_i = state.T_c_i.Perturbed(error.segment<6>(kExtrinsics));
  return corrected;
}

// The error that leads from one state to another.
Error Difference(const State& to, const State& from) {
  const Eigen::Matrix3d back = from.T_g_i.R * to.T_g_i.R.transpose();
  Error error;
  error << to.T_g_i.DifferenceTo(from.T_g_i), back * to.velocity_g - from.velocity_g,
      to.gyro_bias - from.gyro_bias, to.accel_bias - from.accel_bias,
      back * to.gravity_g - from.gravity_g, to.T_c_i.DifferenceTo(from.T_c_i);
  return error;
}

struct Filter {
  State state;
  Covariance covariance = Covariance::Zero();
};

std::optional<Filter> FirstState(const FilterProblem& problem) {
  const std::optional<Rigid3> T_c_g = PoseFromView(problem.camera, problem.views.front());
  if (!T_c_g) return std::nullopt;
  Filter filter;
  State& state = filter.state;
  state.T_c_i = problem.T_c_i_guess;
  const Rigid3 T_g_c = T_c_g->Inverse();
  state.T_g_i = T_g_c * state.T_c_i;
  constexpr size_t kNumSamplesAtRest = 10;
  const size_t num_samples = std::min(kNumSamplesAtRest, problem.imu.accel.size());
  Eigen::Vector3d force_i = Eigen::Vector3d::Zero();
  for (size_t k = 0; k < num_samples; ++k) {
    force_i += problem.imu.accel[k].value / static_cast<double>(num_samples);
  }
  state.gravity_g = -(state.T_g_i.R * force_i).normalized() * kStandardGravity;

  // What is not known apart: first pose of the camera, T_c_i, velocity, biases, noise at rest. Pose
  // of the IMU and gravity follow from these, and share their errors.
  Eigen::Matrix<double, kSize, kSize> J = Covariance::Zero();  // Columns: T_g_c, -, v, .., T_c_i.
  J.block<6, 6>(kTheta, kTheta) = JacobianProductFirst(T_g_c, state.T_c_i);
  J.block<6, 6>(kTheta, kExtrinsics) = JacobianProductSecond(T_g_c);
  J.block<3, 3>(kVelocity, kVelocity).setIdentity();
  J.block<3, 3>(kGyroBias, kGyroBias).setIdentity();
  J.block<3, 3>(kAccelBias, kAccelBias).setIdentity();
  J.block<6, 6>(kExtrinsics, kExtrinsics).setIdentity();
  // Gravity is the mean force at rest, less bias and noise; how large it is, is known.
  const Eigen::Vector3d down = state.gravity_g.normalized();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - down * down.transpose();
  J.block<3, 3>(kGravity, kAccelBias) = across * state.T_g_i.R;
  J.block<3, 3>(kGravity, kGravity) = across;
  const double force_sigma =
      problem.noise.accel_noise_density *
      std::sqrt(problem.noise.rate_hz / static_cast<double>(std::max<size_t>(1, num_samples)));
  Error sigma;
  sigma << Eigen::Vector3d::Constant(kFirstRotationSigma),
      Eigen::Vector3d::Constant(kFirstTranslationSigma), Eigen::Vector3d::Constant(kVelocitySigma),
      Eigen::Vector3d::Constant(kGyroBiasSigma), Eigen::Vector3d::Constant(kAccelBiasSigma),
      Eigen::Vector3d::Constant(force_sigma),
      Eigen::Vector3d::Constant(problem.guess_rotation_sigma),
      Eigen::Vector3d::Constant(problem.guess_translation_sigma);
  filter.covariance = J * sigma.cwiseAbs2().asDiagonal() * J.transpose();
  return filter;
}

void Propagate(const Eigen::Vector3d& rate, const Eigen::Vector3d& force, double dt,
               const ImuNoise& noise, Filter* filter) {
  State& state = filter->state;
  const Eigen::Vector3d omega = rate - state.gyro_bias;
  const Eigen::Matrix3d R_middle = state.T_g_i.R * ExpSo3(0.5 * dt * omega);
  const Eigen::Vector3d force_g = R_middle * (force - state.accel_bias);
  const Eigen::Vector3d acceleration_g = force_g + state.gravity_g;

  const Eigen::Vector3d velocity_after_g = state.velocity_g + dt * acceleration_g;

  Covariance F = Covariance::Identity();
  F.block<3, 3>(kTheta, kGyroBias) = -dt * R_middle;
  F.block<3, 3>(kVelocity, kGyroBias) = -dt * Hat(velocity_after_g) * R_middle;
  F.block<3, 3>(kGravity, kGyroBias) = -dt * Hat(state.gravity_g) * R_middle;
  F.block<3, 3>(kVelocity, kAccelBias) = -dt * R_middle;
  F.block<3, 3>(kVelocity, kGravity) = dt * Eigen::Matrix3d::Identity();
  F.block<3, 3>(kPosition, kVelocity) = dt * Eigen::Matrix3d::Identity();
  F.block<3, 3>(kPosition, kTheta) =
      -dt * Hat(state.velocity_g) - 0.5 * dt * dt * Hat(acceleration_g);
  F.block<3, 3>(kPosition, kAccelBias) = -0.5 * dt * dt * R_middle;
  F.block<3, 3>(kPosition, kGravity) = 0.5 * dt * dt * Eigen::Matrix3d::Identity();
  // Noise of the samples enters as a bias that lasts as long as they do.
  Eigen::Matrix<double, kSize, 3> by_rate = F.middleCols<3>(kGyroBias);
  Eigen::Matrix<double, kSize, 3> by_force = F.middleCols<3>(kAccelBias);
  by_rate.middleRows<3>(kGyroBias).setZero();
  by_force.middleRows<3>(kAccelBias).setZero();
  const auto square = [](double x) { return x * x; };
  filter->covariance = F * filter->covariance * F.transpose() +
                       square(noise.gyro_noise_density) / dt * by_rate * by_rate.transpose() +
                       square(noise.accel_noise_density) / dt * by_force * by_force.transpose();
  filter->covariance.diagonal().segment<3>(kGyroBias).array() +=
      square(noise.gyro_random_walk) * dt;
  filter->covariance.diagonal().segment<3>(kAccelBias).array() +=
      square(noise.accel_random_walk) * dt;

  state.T_g_i.t += dt * state.velocity_g + 0.5 * dt * dt * acceleration_g;
  state.velocity_g += dt * acceleration_g;
  state.T_g_i.R = state.T_g_i.R * ExpSo3(dt * omega);
}

Eigen::Matrix<double, 2, 3> ProjectionJacobian(const CameraModel& camera,
                                               const Eigen::Vector3d& p_c) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix<double, 2, 3> J = Eigen::Matrix<double, 2, 3>::Zero();
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
    const auto above = camera.Project(p_c + step);
    const auto below = camera.Project(p_c - step);
    if (above && below) J.col(k) = (*above - *below) / (2.0 * kStep);
  }
  return J;
}

// Of all corners of a view: measured - predicted, and its derivative by the error. False if the
// state sees no such corners.
bool Linearise(const CameraModel& camera, const BoardView& view, const State& state,
               Eigen::VectorXd* residual, Eigen::MatrixXd* H) {
  const Eigen::Index n = view.num_corners();
  residual->resize(2 * n);
  H->setZero(2 * n, kSize);
  const Eigen::Matrix3d R_i_g = state.T_g_i.R.transpose();
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Vector3d from_imu_g = view.points_g.col(k) - state.T_g_i.t;
    const Eigen::Vector3d p_i = R_i_g * from_imu_g;
    const Eigen::Vector3d p_c = state.T_c_i * p_i;
    const std::optional<Eigen::Vector2d> pixel = camera.Project(p_c);
    if (!pixel) return false;
    residual->segment<2>(2 * k) = view.pixels.col(k) - *pixel;
    const Eigen::Matrix<double, 2, 3> J = ProjectionJacobian(camera, p_c);
    const Eigen::Matrix<double, 2, 3> J_p_i = J * state.T_c_i.R;
    H->block<2, 3>(2 * k, kTheta) = J_p_i * R_i_g * Hat(from_imu_g);
    H->block<2, 3>(2 * k, kPosition) = -J_p_i * R_i_g;
    H->block<2, 6>(2 * k, kExtrinsics) = J * JacobianTransformedPointPose(state.T_c_i, p_i);
  }
  return true;
}

// The iterated update: linearised anew at its own result, so that the first images, which move the
// guess most, are not linearised far off (Bell and Cathey 1993).
bool Update(const FilterProblem& problem, const BoardView& view, Filter* filter) {
  constexpr int kMaxIterations = 10;
  constexpr double kSmallStep = 1e-10;
  const double variance = problem.corner_noise_px * problem.corner_noise_px;
  const State before = filter->state;
  State state = before;
  Eigen::VectorXd residual;
  Eigen::MatrixXd H;
  Eigen::MatrixXd gain;
  for (int i = 0; i < kMaxIterations; ++i) {
    if (!Linearise(problem.camera, view, state, &residual, &H)) return false;
    const Eigen::MatrixXd PHt = filter->covariance * H.transpose();
    Eigen::MatrixXd S = H * PHt;
    S.diagonal().array() += variance;
    gain = S.ldlt().solve(PHt.transpose()).transpose();
    const Error moved = Difference(state, before);
    const Error error = gain * (residual + H * moved);
    const State next = Corrected(before, error);
    const double step = Difference(next, state).norm();
    state = next;
    if (!(step > kSmallStep)) break;
  }
  filter->state = state;
  const Covariance left = Covariance::Identity() - gain * H;
  const Covariance updated =
      left * filter->covariance * left.transpose() + variance * gain * gain.transpose();
  filter->covariance = 0.5 * (updated + updated.transpose());
  return filter->covariance.allFinite();
}

}  // namespace

std::optional<FilterCalibration> CalibrateByFilter(const FilterProblem& problem) {
  if (problem.views.empty() || problem.imu.gyro.size() < 2 ||
      problem.imu.gyro.size() != problem.imu.accel.size()) {
    return std::nullopt;
  }
  std::optional<Filter> filter = FirstState(problem);
  if (!filter) return std::nullopt;
  const ImuStream& imu = problem.imu;
  Time now = problem.views.front().stamp;
  size_t next = 0;
  for (const BoardView& view : problem.views) {
    // A sample holds until the next one.
    while (now < view.stamp) {
      while (next + 1 < imu.gyro.size() && imu.gyro[next + 1].stamp <= now) ++next;
      const bool is_last = next + 1 >= imu.gyro.size();
      const Time until =
          is_last ? view.stamp : std::min(view.stamp, std::max(imu.gyro[next + 1].stamp, now));
      // Between two samples, the mean of both: second order in the interval.
      const size_t after = is_last ? next : next + 1;
      Propagate(0.5 * (imu.gyro[next].value + imu.gyro[after].value),
                0.5 * (imu.accel[next].value + imu.accel[after].value), (until - now).seconds(),
                problem.noise, &*filter);
      now = until;
    }
    if (!Update(problem, view, &*filter)) return std::nullopt;
  }
  const State& state = filter->state;
  if (!state.T_c_i.R.allFinite() || !state.T_c_i.t.allFinite()) return std::nullopt;
  return FilterCalibration{state.T_c_i, filter->covariance.block<6, 6>(kExtrinsics, kExtrinsics)};
}

}  // namespace calibrato
