#include "calibrato/calibration/camera_imu_linearisation.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "calibrato/base/parallel.h"
#include "calibrato/calibration/imu_reading.h"
#include "calibrato/calibration/view_fit.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Depth = PoseSpline::Depth;

// Blocks in a round: it bounds the memory of their local matrices.
constexpr int kBlocksInARound = 32;
// Rows of samples that are gathered before their product is taken.
constexpr Index kRowsInABatch = 48;
constexpr double kWeakAcceleration = 1e4;  // [m/s^2] and [rad/s^2]

double LossOf(double squared, double scale, double* root_weight) {
  if (scale == 0.0) {
    *root_weight = 1.0;
    return squared;
  }
  const double ratio = squared / (scale * scale);
  *root_weight = 1.0 / std::sqrt(1.0 + ratio);
  return scale * scale * std::log1p(ratio);
}

// Rows of a few columns of a block's local matrix, gathered, then multiplied and added to it.
class RowBatch {
 public:
  explicit RowBatch(Index max_columns) : rows_(kRowsInABatch, max_columns) {}

  // What the columns stand for; set anew when they change, after Flush().
  std::vector<int> columns;

  bool IsFull(Index num_rows) const { return used_ + num_rows > kRowsInABatch; }
  auto NewRows(Index num_rows) {
    used_ += num_rows;
    return rows_.block(used_ - num_rows, 0, num_rows, static_cast<Index>(columns.size()));
  }
  void Flush(MatrixXd* local) {
    if (used_ == 0) return;
    const auto n = static_cast<Index>(columns.size());
    const auto J = rows_.topLeftCorner(used_, n);
    product_.setZero(n, n);
    product_.selfadjointView<Eigen::Lower>().rankUpdate(J.transpose());
    ScatterLower(product_, columns, local);
    used_ = 0;
  }
  static void ScatterLower(const MatrixXd& product, const std::vector<int>& columns,
                           MatrixXd* local) {
    const auto n = static_cast<Index>(columns.size());
    for (Index j = 0; j < n; ++j) {
      const int column = columns[static_cast<size_t>(j)];
      for (Index i = j; i < n; ++i) {
        const int row = columns[static_cast<size_t>(i)];
        (*local)(std::max(row, column), std::min(row, column)) += product(i, j);
      }
    }
  }

 private:
  MatrixXd rows_;
  MatrixXd product_;
  Index used_ = 0;
};

// Of each camera, in order of when they were exposed on the spline.
using Views = std::vector<std::vector<CameraImuMeasurements::View>>;

// Their time there; of a sample, that of its stamp.
double SplineTime(const CameraImuMeasurements::View& view, const CameraCalibrationState& camera) {
  return view.time_s + camera.time_offset_s + camera.line_delay_s * view.row_px;
}

Views InOrderOfExposure(Views views, const CameraImuState& state) {
  for (size_t n = 0; n < views.size(); ++n) {
    const CameraCalibrationState& camera = state.cameras[n];
    if (camera.line_delay_s == 0.0) continue;
    std::stable_sort(views[n].begin(), views[n].end(), [&](const auto& a, const auto& b) {
      return SplineTime(a, camera) < SplineTime(b, camera);
    });
  }
  return views;
}

// Everything that sees blocks c and c + 1.
class BlockLinearisation {
 public:
  BlockLinearisation(const CameraImuState& state, const CameraImuLayout& layout,
                     const CameraImuMeasurements& measurements, const Views& views,
                     const CameraImuWeights& weights, int c, MatrixXd* local)
      : state_(state),
        layout_(layout),
        measurements_(measurements),
        views_(views),
        weights_(weights),
        c_(c),
        order_(state.T_g_i.order()),
        residual_column_(2 * layout.block_size + layout.border_size),
        local_(*local) {
    local_.setZero(residual_column_ + 1, residual_column_ + 1);
  }

  // The cost; nothing where a corner does not project.
  std::optional<double> Run() {
    for (size_t n = 0; n < measurements_.imus.size(); ++n) AddImu(n);
    for (size_t n = 0; n < measurements_.imus.size(); ++n) AddRandomWalks(n);
    AddWeakPrior();
    for (size_t n = 0; n < measurements_.cameras.size(); ++n) {
      if (!AddViews(n)) return std::nullopt;
    }
    return cost_;
  }

 private:
  // The range of a list that falls into this block. @param time_of  Of an item, on the spline [s].
  template <typename T, typename TimeOf>
  std::pair<size_t, size_t> RangeOf(const std::vector<T>& list, const TimeOf& time_of) const {
    // By the segment, not by the time: at a block's boundary rounding might part the two.
    const auto first_in = [&](int block) {
      const int segment = block * layout_.points_per_block;
      const auto found = std::partition_point(list.begin(), list.end(), [&](const T& item) {
        return state_.T_g_i.SegmentAt(time_of(item)) < segment;
      });
      return static_cast<size_t>(found - list.begin());
    };
    return {first_in(c_), first_in(c_ + 1)};
  }

  int BorderColumn(int column) const { return 2 * layout_.block_size + column; }

  void AppendPointColumns(int first, bool rotations, std::vector<int>* columns) const {
    for (int j = 0; j < order_; ++j) {
      const int column = layout_.PointColumn(c_, first + j) + (rotations ? 0 : 3);
      columns->insert(columns->end(), {column, column + 1, column + 2});
    }
  }

  // Columns of samples of one sensor: rotations, translations, its bias at both knots, then border
  // and residual.
  void SetSampleColumns(size_t n, int first, bool accel, RowBatch* batch) const {
    std::vector<int>& columns = batch->columns;
    columns.clear();
    AppendPointColumns(first, true, &columns);
    if (TouchesTranslations(n, accel)) AppendPointColumns(first, false, &columns);
    for (int knot = 0; knot < 2; ++knot) {
      const int column = layout_.BiasColumn(static_cast<int>(n), knot) + (accel ? 3 : 0);
      columns.insert(columns.end(), {column, column + 1, column + 2});
    }
    const auto add_border = [&](int column, int size) {
      for (int i = 0; i < size; ++i) columns.push_back(BorderColumn(column + i));
    };
    const CameraImuLayout::Imu& imu = layout_.imus[n];
    if (TouchesTranslations(n, accel)) add_border(layout_.gravity, 2);
    if (imu.intrinsics >= 0) add_border(imu.intrinsics, imu.num_intrinsics);
    if (imu.pose >= 0) {
      add_border(imu.pose, 6);
      add_border(imu.time_offset, 1);
    }
    columns.push_back(residual_column_);
  }

  // A gyroscope feels forces only where its g-sensitivity is estimated.
  bool TouchesTranslations(size_t n, bool accel) const {
    return accel || layout_.imus[n].num_intrinsics > 0;
  }

  void AddImu(size_t n) {
    const CameraImuMeasurements::Imu& samples = measurements_.imus[n];
    const ImuCalibrationState& imu = state_.imus[n];
    const double offset = imu.time_offset_s;
    const auto time_of = [&](const auto& sample) { return sample.time_s + offset; };
    auto [g, g_end] = RangeOf(samples.gyro, time_of);
    auto [a, a_end] = RangeOf(samples.accel, time_of);
    const bool is_further = n > 0;
    const bool has_lever = is_further || !imu.intrinsics.lever_arms_i.isZero(0.0) ||
                           layout_.imus[n].num_intrinsics > 24;
    const Depth depth = has_lever ? Depth::kAcceleration : Depth::kRate;
    RowBatch gyro(6 * kMaxSplineOrder + 16 + 30);
    RowBatch accel(6 * kMaxSplineOrder + 16 + 30);
    SplineJacobians J;
    int segment = -1;
    while (g < g_end || a < a_end) {
      // Usually both sensors share their stamps, and one evaluation of the spline.
      const bool take_gyro =
          g < g_end && !(a < a_end && samples.accel[a].time_s < samples.gyro[g].time_s);
      const double time = take_gyro ? samples.gyro[g].time_s : samples.accel[a].time_s;
      const bool take_accel = a < a_end && samples.accel[a].time_s == time;
      const double t = time + offset;
      const SplinePoint point = state_.T_g_i.At(t, depth, &J);
      if (J.first != segment) {
        segment = J.first;
        gyro.Flush(&local_);
        accel.Flush(&local_);
        SetSampleColumns(n, segment, false, &gyro);
        SetSampleColumns(n, segment, true, &accel);
      }
      if (take_gyro) AddSample(n, t, samples.gyro[g++].value, false, point, J, depth, &gyro);
      if (take_accel) AddSample(n, t, samples.accel[a++].value, true, point, J, depth, &accel);
    }
    gyro.Flush(&local_);
    accel.Flush(&local_);
  }

  void AddSample(size_t n, double t, const Vector3d& measured, bool is_accel,
                 const SplinePoint& point, const SplineJacobians& J, Depth depth, RowBatch* batch) {
    const ImuCalibrationState& imu = state_.imus[n];
    const CameraImuLayout::Imu& columns = layout_.imus[n];
    ImuMotion motion{point.T_a_b.R, point.omega_b, point.alpha_b, point.acceleration_a};
    FrameMotionJacobians further;
    if (n > 0) {
      further = JacobiansMotionOfFrame(motion, imu.T_i_imu);
      motion = MotionOfFrame(motion, imu.T_i_imu);
    }
    ImuReading reading;
    (is_accel ? LineariseAccel : LineariseGyro)(motion, state_.gravity_g, imu.intrinsics,
                                                columns.intrinsics >= 0, &reading);
    const double u = t / state_.block_duration_s() - c_;
    const ImuBias& before = imu.biases[static_cast<size_t>(c_)];
    const ImuBias& after = imu.biases[static_cast<size_t>(c_) + 1];
    const Vector3d bias = is_accel ? Vector3d((1.0 - u) * before.accel + u * after.accel)
                                   : Vector3d((1.0 - u) * before.gyro + u * after.gyro);
    const double stddev = is_accel ? weights_.imus[n].accel_stddev : weights_.imus[n].gyro_stddev;
    const Vector3d residual = (reading.value + bias - measured) / stddev;
    double root_weight;
    cost_ += LossOf(residual.squaredNorm(), weights_.loss_scale, &root_weight);
    const double scale = root_weight / stddev;

    if (batch->IsFull(3)) batch->Flush(&local_);
    auto rows = batch->NewRows(3);
    JacobianMotion J_motion = scale * reading.J_motion;
    Eigen::Matrix<double, 3, 6> J_pose;
    Vector3d J_time;
    if (n > 0) {
      const SplineJerk jerk = state_.T_g_i.JerkAt(t);
      J_pose = J_motion * further.J_pose;
      J_motion = (J_motion * further.J_motion).eval();
      Eigen::Matrix<double, 12, 1> motion_rate;
      motion_rate << point.T_a_b.R * point.omega_b, point.alpha_b, jerk.angular_b, jerk.linear_a;
      const Vector3d bias_rate =
          (is_accel ? after.accel - before.accel : after.gyro - before.gyro) /
          state_.block_duration_s();
      J_time = J_motion * motion_rate + scale * bias_rate;
    }

    Index column = 0;
    const Index rotations = 3 * order_;
    auto J_rotations = rows.middleCols(column, rotations);
    const bool touches_translations = TouchesTranslations(n, is_accel);
    if (touches_translations) {
      J_rotations.noalias() = J_motion.leftCols<3>() * J.J_theta.leftCols(rotations);
      if (!is_accel || depth == Depth::kAcceleration) {
        J_rotations.noalias() += J_motion.middleCols<3>(3) * J.J_omega.leftCols(rotations);
      }
    } else {
      J_rotations.noalias() = J_motion.middleCols<3>(3) * J.J_omega.leftCols(rotations);
    }
    if (depth == Depth::kAcceleration) {
      J_rotations.noalias() += J_motion.middleCols<3>(6) * J.J_alpha.leftCols(rotations);
    }
    column += rotations;
    if (touches_translations) {
      for (int j = 0; j < order_; ++j) {
        rows.middleCols<3>(column) =
            J.weight_acceleration[static_cast<size_t>(j)] * J_motion.rightCols<3>();
        column += 3;
      }
    }
    for (const double share : {1.0 - u, u}) {
      rows.middleCols<3>(column) = share * scale * Matrix3d::Identity();
      column += 3;
    }
    if (touches_translations) {
      rows.middleCols<2>(column) = scale * reading.J_gravity * J_gravity_tangent_;
      column += 2;
    }
    if (columns.intrinsics >= 0) {
      rows.middleCols(column, columns.num_intrinsics) =
          scale * reading.J_intrinsics.leftCols(columns.num_intrinsics);
      column += columns.num_intrinsics;
    }
    if (n > 0) {
      rows.middleCols<6>(column) = J_pose;
      rows.col(column + 6) = J_time;
      column += 7;
    }
    rows.col(column) = root_weight * residual;
  }

  void AddRandomWalks(size_t n) {
    const auto imu = static_cast<int>(n);
    const CameraImuWeights::Imu& weights = weights_.imus[n];
    const ImuBias& before = state_.imus[n].biases[static_cast<size_t>(c_)];
    const ImuBias& after = state_.imus[n].biases[static_cast<size_t>(c_) + 1];
    const double root_duration = std::sqrt(state_.block_duration_s());
    for (const bool accel : {false, true}) {
      const double scale = 1.0 / ((accel ? weights.accel_walk : weights.gyro_walk) * root_duration);
      const Vector3d residual =
          scale * (accel ? after.accel - before.accel : after.gyro - before.gyro);
      for (int axis = 0; axis < 3; ++axis) {
        const int offset = (accel ? 3 : 0) + axis;
        const int b = layout_.BiasColumn(imu, 0) + offset;
        const int e = layout_.BiasColumn(imu, 1) + offset;
        local_(b, b) += scale * scale;
        local_(e, e) += scale * scale;
        local_(e, b) -= scale * scale;
        local_(residual_column_, b) -= scale * residual(axis);
        local_(residual_column_, e) += scale * residual(axis);
      }
      AddCost(residual.squaredNorm());
    }
  }

  void AddWeakPrior() {
    RowBatch batch(6 * kMaxSplineOrder + 1);
    SplineJacobians J;
    const double scale = 1.0 / kWeakAcceleration;
    const Index rotations = 3 * order_;
    for (int i = 0; i < layout_.points_per_block; ++i) {
      // Not at a knot and not midway between two: one of them is blind to points that alternate.
      const double t = (c_ * layout_.points_per_block + i + 0.25) * state_.T_g_i.spacing_s();
      const SplinePoint point = state_.T_g_i.At(t, Depth::kAcceleration, &J);
      batch.columns.clear();
      AppendPointColumns(J.first, true, &batch.columns);
      AppendPointColumns(J.first, false, &batch.columns);
      batch.columns.push_back(residual_column_);
      auto rows = batch.NewRows(6);
      rows.setZero();
      rows.topLeftCorner(3, rotations) = scale * J.J_alpha.leftCols(rotations);
      for (int j = 0; j < order_; ++j) {
        rows.block<3, 3>(3, rotations + 3 * j) =
            scale * J.weight_acceleration[static_cast<size_t>(j)] * Matrix3d::Identity();
      }
      rows.col(2 * rotations) << scale * point.alpha_b, scale * point.acceleration_a;
      cost_ += rows.col(2 * rotations).squaredNorm();
      batch.Flush(&local_);
    }
  }

  bool AddViews(size_t n) {
    const CameraCalibrationState& camera = state_.cameras[n];
    const CameraImuLayout::Camera& camera_columns = layout_.cameras[n];
    const auto& views = views_[n];
    const auto time_of = [&](const auto& view) { return SplineTime(view, camera); };
    const auto [begin, end] = RangeOf(views, time_of);
    const Index num_parameters = camera_columns.parameters >= 0 ? camera.model.num_parameters() : 0;
    const Index num_time = camera_columns.time_offset >= 0 ? 1 : 0;
    const Index num_line = camera_columns.line_delay >= 0 ? 1 : 0;
    const Index num_scale = layout_.board_scale >= 0 ? 1 : 0;
    const double inverse_variance = 1.0 / (weights_.corner_noise_px * weights_.corner_noise_px);
    ViewRowsOptions options;
    options.parameters = num_parameters > 0;
    options.loss_scale_px = weights_.loss_scale * weights_.corner_noise_px;
    ViewRows view_rows;
    SplineJacobians J;
    // Columns that move the board's pose in the camera: points, T_c_i, time offset, line delay,
    // size of the board.
    const Index rotations = 3 * order_;
    const Index movers = 2 * rotations + 6 + num_time + num_line + num_scale;
    MatrixXd J_pose(6, movers);
    MatrixXd product(movers + num_parameters + 1, movers + num_parameters + 1);
    std::vector<int> columns;
    for (size_t v = begin; v < end; ++v) {
      const double t = SplineTime(views[v], camera);
      const SplinePoint point = state_.T_g_i.At(t, Depth::kPose, &J);
      const Rigid3 T_i_g = point.T_a_b.Inverse();
      const Rigid3 T_c_g = camera.T_c_i * T_i_g;
      // A board twice as large looks as one of the stated size at half the distance.
      const Rigid3 T_seen{T_c_g.R, T_c_g.t / state_.board_scale};
      if (!LineariseView(camera.model, *views[v].view, T_seen, options, &view_rows)) return false;
      cost_ += inverse_variance * view_rows.cost_px2;

      // T_c_g = T_c_i T_g_i^-1: a turn dtheta and a shift dt of T_g_i turn it by -R_c_g dtheta and
      // shift it by -R_c_g ([t_g_i]x dtheta + dt).
      const Matrix3d& R_c_g = T_c_g.R;
      const Matrix3d shift_of_turn = R_c_g * Hat(point.T_a_b.t);
      J_pose.setZero();
      J_pose.topLeftCorner(3, rotations).noalias() = -R_c_g * J.J_theta.leftCols(rotations);
      J_pose.bottomLeftCorner(3, rotations).noalias() =
          -shift_of_turn * J.J_theta.leftCols(rotations);
      for (int j = 0; j < order_; ++j) {
        J_pose.block<3, 3>(3, rotations + 3 * j) = -J.weight[static_cast<size_t>(j)] * R_c_g;
      }
      J_pose.middleCols<6>(2 * rotations) = JacobianProductFirst(camera.T_c_i, T_i_g);
      Index column = 2 * rotations + 6;
      if (num_time + num_line > 0) {
        const Vector3d omega_g = point.T_a_b.R * point.omega_b;
        Eigen::Matrix<double, 6, 1> pose_rate;
        pose_rate << -R_c_g * omega_g, -shift_of_turn * omega_g - R_c_g * point.velocity_a;
        if (num_time > 0) J_pose.col(column++) = pose_rate;
        if (num_line > 0) J_pose.col(column++) = views[v].row_px * pose_rate;
      }
      if (num_scale > 0) {
        J_pose.bottomRows<3>().leftCols(column) /= state_.board_scale;
        J_pose.col(column).tail<3>() = -T_seen.t / state_.board_scale;
      }

      columns.clear();
      AppendPointColumns(J.first, true, &columns);
      AppendPointColumns(J.first, false, &columns);
      for (int i = 0; i < 6; ++i) columns.push_back(BorderColumn(camera_columns.pose + i));
      if (num_time > 0) columns.push_back(BorderColumn(camera_columns.time_offset));
      if (num_line > 0) columns.push_back(BorderColumn(camera_columns.line_delay));
      if (num_scale > 0) columns.push_back(BorderColumn(layout_.board_scale));
      for (int i = 0; i < num_parameters; ++i) {
        columns.push_back(BorderColumn(camera_columns.parameters + i));
      }
      columns.push_back(residual_column_);

      const MatrixXd normal = inverse_variance * (view_rows.rows.transpose() * view_rows.rows);
      const Index rest = num_parameters + 1;
      product.topLeftCorner(movers, movers).noalias() =
          J_pose.transpose() * (normal.topLeftCorner<6, 6>() * J_pose);
      product.bottomLeftCorner(rest, movers).noalias() = normal.bottomLeftCorner(rest, 6) * J_pose;
      product.bottomRightCorner(rest, rest) = normal.bottomRightCorner(rest, rest);
      RowBatch::ScatterLower(product, columns, &local_);
    }
    return true;
  }

  void AddCost(double squared) {
    cost_ += squared;
    local_(residual_column_, residual_column_) += squared;
  }

  const CameraImuState& state_;
  const CameraImuLayout& layout_;
  const CameraImuMeasurements& measurements_;
  const Views& views_;
  const CameraImuWeights& weights_;
  const int c_;
  const int order_;
  const int residual_column_;
  MatrixXd& local_;
  double cost_ = 0.0;
  // d gravity / d (its turn about the tangent's axes): turn x gravity.
  const Eigen::Matrix<double, 3, 2> J_gravity_tangent_ =
      -Hat(state_.gravity_g) * GravityTangent(state_.gravity_g);
};

// Held parameters have no variance in a camera's result; here one that is as good as none.
constexpr double kVarianceOfHeld = 1e-18;

// The priors on camera parameters: (x - x0)' covariance^-1 (x - x0).
double AddCameraPriors(const CameraImuProblem& problem, const CameraImuState& state,
                       const CameraImuLayout& layout, ArrowheadSystem* system) {
  double cost = 0.0;
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    const CameraImuCamera& camera = problem.cameras[n];
    if (camera.intrinsics != IntrinsicsKnowledge::kPrior) continue;
    MatrixXd covariance = camera.intrinsics_covariance;
    for (Index i = 0; i < covariance.rows(); ++i) {
      if (covariance(i, i) == 0.0) covariance(i, i) = kVarianceOfHeld;
    }
    const Eigen::LLT<MatrixXd> llt(covariance);
    assert(llt.info() == Eigen::Success);
    const Index size = covariance.rows();
    MatrixXd rows(size, size + 1);  // L^-1 [I, x - x0]
    rows << MatrixXd::Identity(size, size),
        state.cameras[n].model.parameters() - camera.model.parameters();
    llt.matrixL().solveInPlace(rows);
    cost += rows.col(size).squaredNorm();
    MatrixXd whole = MatrixXd::Zero(size, layout.border_size + 1);
    whole.middleCols(layout.cameras[n].parameters, size) = rows.leftCols(size);
    whole.col(layout.border_size) = rows.col(size);
    system->AddToBorder(whole.transpose() * whole);
  }
  return cost;
}

// What earlier recordings say: x' information x with x the difference to their estimate.
double AddCalibrationPrior(const CalibrationPrior& prior, const CameraImuState& state,
                           const CameraImuLayout& layout, ArrowheadSystem* system) {
  const int size = layout.border_size;
  assert(prior.information_matrix.rows() == size);
  // The difference changes with the step as the identity does, to first order, but for gravity,
  // whose axes depend on where it points.
  MatrixXd J = MatrixXd::Identity(size, size);
  J.block<2, 2>(layout.gravity, layout.gravity) =
      GravityTangent(prior.estimate.gravity_g).transpose() * GravityTangent(state.gravity_g);
  const Eigen::VectorXd difference = CalibrationDifference(state, prior.estimate, layout);
  MatrixXd whole(size + 1, size + 1);
  const MatrixXd weighted = prior.information_matrix * J;
  whole.topLeftCorner(size, size) = J.transpose() * weighted;
  whole.bottomLeftCorner(1, size) = difference.transpose() * weighted;
  whole.topRightCorner(size, 1) = whole.bottomLeftCorner(1, size).transpose();
  whole(size, size) = difference.dot(prior.information_matrix * difference);
  system->AddToBorder(whole);
  return whole(size, size);
}

}  // namespace

std::optional<double> Linearise(const CameraImuProblem& problem, const CameraImuState& state,
                                const CameraImuLayout& layout,
                                const CameraImuMeasurements& measurements,
                                const CameraImuWeights& weights, ArrowheadSystem* system) {
  system->SetZero();
  // What was known of the lenses beforehand is part of what the earlier recordings say.
  double cost = problem.prior ? AddCalibrationPrior(*problem.prior, state, layout, system)
                              : AddCameraPriors(problem, state, layout, system);
  const int num_tasks = state.num_blocks() - 1;
  const Views views = InOrderOfExposure(measurements.cameras, state);
  std::vector<MatrixXd> locals(static_cast<size_t>(std::min(num_tasks, kBlocksInARound)));
  std::vector<std::optional<double>> costs(locals.size());
  for (int first = 0; first < num_tasks; first += kBlocksInARound) {
    const auto count = static_cast<size_t>(std::min(kBlocksInARound, num_tasks - first));
    ParallelFor(count, [&](size_t i) {
      BlockLinearisation block(state, layout, measurements, views, weights,
                               first + static_cast<int>(i), &locals[i]);
      costs[i] = block.Run();
    });
    for (size_t i = 0; i < count; ++i) {
      if (!costs[i]) return std::nullopt;
      cost += *costs[i];
      system->Add(first + static_cast<int>(i), locals[i]);
    }
  }
  return cost;
}

}  // namespace calibrato
