#include "calibrato/calibration/expected_extrinsics.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "calibrato/calibration/arrowhead.h"
#include "calibrato/calibration/planned_frame.h"
#include "calibrato/geometry/pose_spline.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/geometry/spline_basis.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix3Xd = Eigen::Matrix3Xd;

constexpr int kOrder = 6;
constexpr double kKnotSpacing = 0.1;  // [s]
constexpr double kBiasPiece = 5.0;    // [s]
constexpr double kWeakPrior = 1e-6;   // Information of a trajectory's coefficient [1/rad^2, 1/m^2].
constexpr int kBlockPoints = kOrder - 1;
constexpr int kBlockSize = 6 * kBlockPoints;
// Border: T_c_i, time offset, two directions of gravity, then six biases a piece.
constexpr int kTimeOffset = 6;
constexpr int kGravity = 7;
constexpr int kBiases = 9;
// A local row: order control points of [phi, d], then T_c_i, time offset, gravity, the biases of
// one piece.
constexpr int kLocalBorder = 6 * kOrder;
constexpr int kLocalSize = kLocalBorder + kBiases + 6;
using LocalMatrix = Eigen::Matrix<double, kLocalSize, kLocalSize>;
using LocalRows = Eigen::Matrix<double, 6, kLocalSize>;

// Where in time, and the weights of phi and d there on the control points `first` ..
struct Support {
  int first = 0;
  int bias_piece = 0;
  std::array<double, kOrder> value;
  std::array<double, kOrder> first_derivative;
  std::array<double, kOrder> second_derivative;
  std::array<double, kOrder> third_derivative;
};

class Layout {
 public:
  /// @param num_parameters  Of the camera, behind the biases in the border; 0 where it is known.
  explicit Layout(double duration_s, int num_parameters = 0)
      : num_parameters_(num_parameters),
        num_segments_(std::max(1, NumSegments(duration_s, kKnotSpacing))),
        num_pieces_(std::max(1, static_cast<int>(std::ceil(duration_s / kBiasPiece - 1e-9)))) {}

  int num_points() const { return num_segments_ + kOrder - 1; }
  int num_blocks() const { return (num_points() + kBlockPoints - 1) / kBlockPoints + 1; }
  int num_pieces() const { return num_pieces_; }
  int num_parameters() const { return num_parameters_; }
  int border_size() const { return parameter_column() + num_parameters_; }
  int parameter_column() const { return kBiases + 6 * num_pieces_; }
  int bias_column(int piece) const { return kBiases + 6 * piece; }

  Support At(double t_s) const {
    Support support;
    const int segment =
        std::clamp(static_cast<int>(std::floor(t_s / kKnotSpacing)), 0, num_segments_ - 1);
    const auto basis = CumulativeBasis<kOrder>(t_s / kKnotSpacing - segment);
    support.first = segment;
    support.bias_piece =
        std::clamp(static_cast<int>(std::floor(t_s / kBiasPiece)), 0, num_pieces_ - 1);
    // The ordinary basis is the difference of two neighbours of the cumulative one.
    const auto ordinary = [](const std::array<double, kOrder>& cumulative, double scale) {
      std::array<double, kOrder> weights;
      for (size_t j = 0; j < kOrder; ++j) {
        weights[j] = scale * (cumulative[j] - (j + 1 < kOrder ? cumulative[j + 1] : 0.0));
      }
      return weights;
    };
    constexpr double kRate = 1.0 / kKnotSpacing;
    support.value = ordinary(basis.value, 1.0);
    support.first_derivative = ordinary(basis.first, kRate);
    support.second_derivative = ordinary(basis.second, kRate * kRate);
    support.third_derivative = ordinary(basis.third, kRate * kRate * kRate);
    return support;
  }

 private:
  int num_parameters_;
  int num_segments_;
  int num_pieces_;
};

// Adds local matrices to the arrowhead: those of one segment are summed first, since each addition
// to the system touches all of two blocks and the border.
class Assembly {
 public:
  Assembly(const Layout& layout, ArrowheadSystem* system)
      : layout_(layout),
        system_(*system),
        parameters_(MatrixXd::Zero(layout.num_parameters(), kLocalSize)) {}

  // The local matrix to add to, at this support.
  LocalMatrix& At(const Support& support) {
    if (support.first != first_ || support.bias_piece != bias_piece_) {
      Flush();
      first_ = support.first;
      bias_piece_ = support.bias_piece;
    }
    return sum_;
  }
  // What couples the camera's parameters (rows) to the columns of the latest support.
  MatrixXd& Parameters() { return parameters_; }

  void Flush() {
    if (first_ < 0) return;
    const int block = first_ / kBlockPoints;
    const int offset = 6 * (first_ % kBlockPoints);
    MatrixXd local = MatrixXd::Zero(system_.local_size(), system_.local_size());
    const auto column = [&](int i) {
      if (i < kLocalBorder) return offset + i;
      const int border = i - kLocalBorder;
      return 2 * kBlockSize +
             (border < kBiases ? border : layout_.bias_column(bias_piece_) + border - kBiases);
    };
    for (int i = 0; i < kLocalSize; ++i) {
      for (int j = 0; j <= i; ++j) local(column(i), column(j)) = sum_(i, j);
      for (int k = 0; k < layout_.num_parameters(); ++k) {
        local(2 * kBlockSize + layout_.parameter_column() + k, column(i)) = parameters_(k, i);
      }
    }
    system_.Add(block, local);
    sum_.setZero();
    parameters_.setZero();
    first_ = -1;
  }

 private:
  const Layout& layout_;
  ArrowheadSystem& system_;
  LocalMatrix sum_ = LocalMatrix::Zero();
  MatrixXd parameters_;
  int first_ = -1;
  int bias_piece_ = -1;
};

struct SampleWeights {
  double gyro;   // Of one second [1 / (rad/s)^2]
  double accel;  // [1 / (m/s^2)^2]
};

SampleWeights WeightsOf(const ImuNoise& noise) {
  return {1.0 / (noise.gyro_noise_density * noise.gyro_noise_density),
          1.0 / (noise.accel_noise_density * noise.accel_noise_density)};
}

// Rows: rates 3, forces 3, whitened.
LocalRows ImuRows(const PlannedImuInstant& instant, const Support& support,
                  const Eigen::Matrix<double, 3, 2>& gravity, const SampleWeights& weights) {
  LocalRows rows = LocalRows::Zero();
  const Matrix3d omega = Hat(instant.omega_i);
  const Matrix3d force = Hat(instant.force_i);
  const Matrix3d R_i_g = instant.R_g_i.transpose();
  for (int j = 0; j < kOrder; ++j) {
    const auto k = static_cast<size_t>(j);
    auto by_point = rows.middleCols<6>(6 * j);
    by_point.topLeftCorner<3, 3>() =
        support.first_derivative[k] * Matrix3d::Identity() + support.value[k] * omega;
    by_point.bottomLeftCorner<3, 3>() = support.value[k] * force;
    by_point.bottomRightCorner<3, 3>() = support.second_derivative[k] * R_i_g;
  }
  rows.block<3, 2>(3, kLocalBorder + kGravity) = -R_i_g * gravity;
  rows.topRightCorner<6, 6>().setIdentity();
  rows.topRows<3>() *= std::sqrt(instant.duration_s * weights.gyro);
  rows.bottomRows<3>() *= std::sqrt(instant.duration_s * weights.accel);
  return rows;
}

// The perturbation of a frame's pose T_c_g.
LocalRows FrameRows(const PlannedFrame& frame, const Support& support, const Rigid3& T_c_i) {
  LocalRows rows = LocalRows::Zero();
  const Matrix3d lever = -Hat(frame.T_c_g.t - T_c_i.t);  // psi x m = -[m]x psi
  const auto set = [&](int column, const Vector3d& psi, const Vector3d& d) {
    rows.col(column) << psi, lever * psi - frame.T_c_g.R * d;
  };
  for (int j = 0; j < kOrder; ++j) {
    const double value = support.value[static_cast<size_t>(j)];
    for (int k = 0; k < 3; ++k) {
      set(6 * j + k, -value * T_c_i.R.col(k), Vector3d::Zero());
      set(6 * j + 3 + k, Vector3d::Zero(), value * Vector3d::Unit(k));
    }
  }
  for (int k = 0; k < 3; ++k) set(kLocalBorder + k, Vector3d::Unit(k), Vector3d::Zero());
  rows.block<3, 3>(3, kLocalBorder + 3).setIdentity();
  set(kLocalBorder + kTimeOffset, -T_c_i.R * frame.omega_i, frame.velocity_g);
  return rows;
}

void AddWalks(const Layout& layout, const ImuNoise& noise, ArrowheadSystem* system) {
  const int m = layout.border_size();
  MatrixXd border = MatrixXd::Zero(m + 1, m + 1);
  const auto add = [&](int row, double walk) {
    const double information = 1.0 / (walk * walk * kBiasPiece);
    border(row, row) += information;
    border(row + 6, row + 6) += information;
    border(row + 6, row) -= information;
  };
  for (int piece = 0; piece + 1 < layout.num_pieces(); ++piece) {
    for (int k = 0; k < 3; ++k) {
      add(layout.bias_column(piece) + k, noise.gyro_random_walk);
      add(layout.bias_column(piece) + 3 + k, noise.accel_random_walk);
    }
  }
  system->AddToBorder(border);
}

void AddWeakPrior(ArrowheadSystem* system) {
  MatrixXd local = MatrixXd::Zero(system->local_size(), system->local_size());
  local.diagonal().head(kBlockSize).setConstant(kWeakPrior);
  for (int c = 0; c + 1 < system->num_blocks(); ++c) {
    if (c + 2 == system->num_blocks()) {
      local.diagonal().segment(kBlockSize, kBlockSize).setConstant(kWeakPrior);
    }
    system->Add(c, local);
  }
}

// Rows of X at a support.
Matrix3Xd Weighted(const MatrixXd& X, const Support& support, int first_row,
                   const std::array<double, kOrder>& weights) {
  Matrix3Xd sum = Matrix3Xd::Zero(3, X.cols());
  for (int j = 0; j < kOrder; ++j) {
    sum += weights[static_cast<size_t>(j)] * X.middleRows<3>(6 * (support.first + j) + first_row);
  }
  return sum;
}

Vector3d SumOfCrosses(const Matrix3Xd& a, const Matrix3Xd& b) {
  Vector3d sum = Vector3d::Zero();
  for (Eigen::Index k = 0; k < a.cols(); ++k) sum += Vector3d(a.col(k)).cross(Vector3d(b.col(k)));
  return sum;
}

Matrix3Xd CrossEach(const Vector3d& a, const Matrix3Xd& b) { return Hat(a) * b; }

// Minus the derivatives of |whitened rows * X|^2 by the instant.
PlannedMotionGradient::Imu ImuGradient(const PlannedImuInstant& instant, const Support& support,
                                       const Eigen::Matrix<double, 3, 2>& gravity,
                                       const SampleWeights& weights, const Layout& layout,
                                       const MatrixXd& X) {
  const auto border = X.bottomRows(layout.border_size());
  const auto bias = border.middleRows<6>(layout.bias_column(support.bias_piece));
  const Matrix3Xd phi = Weighted(X, support, 0, support.value);
  const Matrix3Xd rates = Weighted(X, support, 0, support.first_derivative) +
                          CrossEach(instant.omega_i, phi) + bias.topRows<3>();
  const Matrix3Xd accelerations =
      instant.R_g_i.transpose() * (Weighted(X, support, 3, support.second_derivative) -
                                   gravity * border.middleRows<2>(kGravity));
  const Matrix3Xd forces = CrossEach(instant.force_i, phi) + accelerations + bias.bottomRows<3>();
  // By time: the perturbation goes on, the instant's own motion stays.
  const Matrix3Xd phi_first = Weighted(X, support, 0, support.first_derivative);
  const Matrix3Xd rates_by_time =
      Weighted(X, support, 0, support.second_derivative) + CrossEach(instant.omega_i, phi_first);
  const Matrix3Xd forces_by_time =
      CrossEach(instant.force_i, phi_first) +
      instant.R_g_i.transpose() * Weighted(X, support, 3, support.third_derivative);
  const double gyro = -2.0 * instant.duration_s * weights.gyro;
  const double accel = -2.0 * instant.duration_s * weights.accel;
  return {
      .R_g_i = accel * SumOfCrosses(forces, accelerations),
      .omega_i = gyro * SumOfCrosses(phi, rates),
      .force_i = accel * SumOfCrosses(phi, forces),
      .duration_s = -weights.gyro * rates.squaredNorm() - weights.accel * forces.squaredNorm(),
      .t_s = gyro * rates.cwiseProduct(rates_by_time).sum() +
             accel * forces.cwiseProduct(forces_by_time).sum(),
  };
}

PlannedMotionGradient::Frame FrameGradient(const PlannedFrame& frame, const Support& support,
                                           const PlannedRig& rig, const Layout& layout,
                                           const Matrix6d& information, const MatrixXd& X) {
  const auto border = X.bottomRows(layout.border_size());
  const auto time = border.row(kTimeOffset);
  const Matrix3d& R_c_i = rig.T_c_i.R;
  const Vector3d m = frame.T_c_g.t - rig.T_c_i.t;
  const Matrix3Xd phi = Weighted(X, support, 0, support.value) + frame.omega_i * time;
  const Matrix3Xd shift =
      frame.T_c_g.R * (Weighted(X, support, 3, support.value) + frame.velocity_g * time);
  const Matrix3Xd psi = border.topRows<3>() - R_c_i * phi;
  Eigen::Matrix<double, 6, Eigen::Dynamic> z(6, X.cols());
  z << psi, -CrossEach(m, psi) - shift + border.middleRows<3>(3);
  const Eigen::Matrix<double, 6, Eigen::Dynamic> Fz = information * z;
  const Matrix3Xd turn = Fz.topRows<3>();
  const Matrix3Xd push = Fz.bottomRows<3>();

  PlannedMotionGradient::Frame gradient;
  gradient.weight = -z.cwiseProduct(Fz).sum();
  // How the pose's information changes with the pose ...
  const double variance = rig.corner_noise_px * rig.corner_noise_px;
  const Matrix6d zz = z * z.transpose() / variance;
  gradient.T_c_g = -GradientByPose(
      [&](const Rigid3& T_c_g) -> std::optional<double> {
        const auto pose = PoseInformationOfFrame(rig.camera, rig.points, T_c_g);
        if (!pose) return std::nullopt;
        return pose->cwiseProduct(zz).sum();
      },
      frame.T_c_g);
  // ... and what the pose's perturbation is made of.
  gradient.T_c_g.head<3>() += 2.0 * SumOfCrosses(shift, push);
  gradient.T_c_g.tail<3>() -= 2.0 * SumOfCrosses(push, psi);
  const Matrix3Xd by_psi = turn + CrossEach(m, push);
  gradient.omega_i = 2.0 * R_c_i.transpose() * (by_psi * time.transpose());
  gradient.velocity_g = 2.0 * frame.T_c_g.R.transpose() * (push * time.transpose());
  const Matrix3Xd psi_by_time = -R_c_i * Weighted(X, support, 0, support.first_derivative);
  const Matrix3Xd shift_by_time = frame.T_c_g.R * Weighted(X, support, 3, support.first_derivative);
  gradient.t_s = -2.0 * frame.weight *
                 (turn.cwiseProduct(psi_by_time).sum() +
                  push.cwiseProduct(-CrossEach(m, psi_by_time) - shift_by_time).sum());
  gradient.T_c_g *= frame.weight;
  gradient.omega_i *= frame.weight;
  gradient.velocity_g *= frame.weight;
  return gradient;
}

// The normal equations, and of each frame the information on its pose.
ArrowheadSystem Assemble(const PlannedRig& rig, const PlannedMotion& motion, const Layout& layout,
                         std::vector<Matrix6d>* information) {
  const Eigen::Matrix<double, 3, 2> gravity =
      rig.gravity_g.norm() * GravityDirections(rig.gravity_g);
  const SampleWeights weights = WeightsOf(rig.noise);
  ArrowheadSystem system(layout.num_blocks(), kBlockSize, layout.border_size());
  Assembly assembly(layout, &system);
  for (const PlannedImuInstant& instant : motion.imu) {
    const Support support = layout.At(instant.t_s);
    const LocalRows rows = ImuRows(instant, support, gravity, weights);
    assembly.At(support).selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  }
  information->assign(motion.frames.size(), Matrix6d::Zero());
  MatrixXd parameters = MatrixXd::Zero(layout.num_parameters(), layout.num_parameters());
  const double variance = rig.corner_noise_px * rig.corner_noise_px;
  for (size_t i = 0; i < motion.frames.size(); ++i) {
    const PlannedFrame& frame = motion.frames[i];
    if (!(frame.weight > 0.0)) continue;
    const Support support = layout.At(frame.t_s);
    const LocalRows rows = FrameRows(frame, support, rig.T_c_i);
    if (layout.num_parameters() > 0) {
      const auto joint = JointInformationOfFrame(rig.camera, rig.points, frame.T_c_g);
      if (!joint) continue;
      const Eigen::Index n = layout.num_parameters();
      (*information)[i] = joint->topLeftCorner<6, 6>() / variance;
      const double weight = frame.weight / variance;
      LocalMatrix& sum = assembly.At(support);
      sum += frame.weight * (rows.transpose() * ((*information)[i] * rows));
      assembly.Parameters() += weight * (joint->bottomLeftCorner(n, 6) * rows);
      parameters += weight * joint->bottomRightCorner(n, n);
      continue;
    }
    const auto pose = PoseInformationOfFrame(rig.camera, rig.points, frame.T_c_g);
    if (!pose) continue;
    (*information)[i] = *pose / variance;
    assembly.At(support) += frame.weight * (rows.transpose() * ((*information)[i] * rows));
  }
  assembly.Flush();
  if (layout.num_parameters() > 0) {
    MatrixXd border = MatrixXd::Zero(layout.border_size() + 1, layout.border_size() + 1);
    border.block(layout.parameter_column(), layout.parameter_column(), layout.num_parameters(),
                 layout.num_parameters()) = parameters;
    system.AddToBorder(border);
  }
  AddWalks(layout, rig.noise, &system);
  AddWeakPrior(&system);
  return system;
}

}  // namespace

std::optional<ExpectedExtrinsics> ExpectExtrinsics(const PlannedRig& rig,
                                                   const PlannedMotion& motion,
                                                   DesignCriterion criterion, bool want_gradient) {
  assert(motion.duration_s > 0.0 && rig.corner_noise_px > 0.0);
  const Layout layout(motion.duration_s);
  const Eigen::Matrix<double, 3, 2> gravity =
      rig.gravity_g.norm() * GravityDirections(rig.gravity_g);
  const SampleWeights weights = WeightsOf(rig.noise);
  std::vector<Matrix6d> information;
  const ArrowheadSystem system = Assemble(rig, motion, layout, &information);
  const auto factor = ArrowheadCholesky::Factor(system, 0.0);
  if (!factor) return std::nullopt;
  const Eigen::LLT<MatrixXd> border(factor->BorderInformation());
  if (border.info() != Eigen::Success) return std::nullopt;
  const MatrixXd covariance =
      border.solve(MatrixXd::Identity(layout.border_size(), layout.border_size()));
  Eigen::Vector<double, 6> unit;
  unit << Vector3d::Constant(1e-3), Vector3d::Constant(1e-3);
  const CriterionValue value = EvaluateCriterion(criterion, covariance.topLeftCorner<6, 6>(), unit);
  ExpectedExtrinsics expected;
  expected.covariance = covariance.topLeftCorner<7, 7>();
  expected.criterion = value.value;
  if (!std::isfinite(value.value)) return std::nullopt;
  if (!want_gradient) return expected;

  MatrixXd wanted = MatrixXd::Zero(system.num_unknowns(), value.root.cols());
  wanted.middleRows(system.num_blocks() * system.block_size(), 6) = value.root;
  const MatrixXd X = factor->Solve(wanted);
  for (const PlannedImuInstant& instant : motion.imu) {
    expected.gradient.imu.push_back(
        ImuGradient(instant, layout.At(instant.t_s), gravity, weights, layout, X));
  }
  for (size_t i = 0; i < motion.frames.size(); ++i) {
    const PlannedFrame& frame = motion.frames[i];
    expected.gradient.frames.push_back(
        FrameGradient(frame, layout.At(frame.t_s), rig, layout, information[i], X));
  }
  return expected;
}

Eigen::Matrix<double, 3, 2> GravityDirections(const Vector3d& gravity_g) {
  const Vector3d u = gravity_g.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> directions;
  directions << u, gravity_g.normalized().cross(u);
  return directions;
}

MatrixXd ExtrinsicInformationOf(const PlannedRig& rig, const PlannedMotion& motion,
                                bool camera_is_known) {
  constexpr double kGyroBias = 0.1;   // [rad/s]
  constexpr double kAccelBias = 1.0;  // [m/s^2]
  // A motion that leaves a direction of the border open has a singular border, which can't be
  // factored: a little is added to it before, and taken away from the result, which it changes by
  // no more than rounding.
  constexpr double kLift = 1e-9;       // Of a diagonal element ...
  constexpr double kLeastLift = 1e-6;  // ... and where that is nothing.
  const int n = camera_is_known ? 0 : rig.camera.num_parameters();
  const Layout layout(motion.duration_s, n);
  std::vector<Matrix6d> information;
  ArrowheadSystem system = Assemble(rig, motion, layout, &information);
  const int m = layout.border_size();
  MatrixXd lift = MatrixXd::Zero(m + 1, m + 1);
  lift.diagonal().head(m) = (kLift * system.BorderBlock().diagonal()).cwiseMax(kLeastLift);
  system.AddToBorder(lift);
  const MatrixXd nothing = MatrixXd::Zero(kBiases + n, kBiases + n);
  const auto factor = ArrowheadCholesky::Factor(system, 0.0);
  if (!factor) return nothing;
  const MatrixXd border = factor->BorderInformation() - lift.topLeftCorner(m, m);
  std::vector<int> kept;
  for (int k = 0; k < kBiases; ++k) kept.push_back(k);
  for (int k = 0; k < n; ++k) kept.push_back(layout.parameter_column() + k);
  std::vector<int> left_out;
  for (int k = kBiases; k < layout.parameter_column(); ++k) left_out.push_back(k);
  MatrixXd biases = border(left_out, left_out);
  biases.diagonal().head<3>().array() += 1.0 / (kGyroBias * kGyroBias);
  biases.diagonal().segment<3>(3).array() += 1.0 / (kAccelBias * kAccelBias);
  const Eigen::LLT<MatrixXd> known(biases);
  if (known.info() != Eigen::Success) return nothing;
  const MatrixXd coupling = border(left_out, kept);
  const MatrixXd left = border(kept, kept) - coupling.transpose() * known.solve(coupling);
  return 0.5 * (left + left.transpose());
}

}  // namespace calibrato
