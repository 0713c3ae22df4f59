#include "calibrato/calibration/camera_imu_layout.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

constexpr std::array<const char*, 6> kPoseNames = {"rot_x", "rot_y", "rot_z",
                                                   "pos_x", "pos_y", "pos_z"};
constexpr std::array<const char*, 6> kLowerTriangleNames = {"xx", "yx", "yy", "zx", "zy", "zz"};
constexpr std::array<const char*, 9> kMatrixNames = {"xx", "xy", "xz", "yx", "yy",
                                                     "yz", "zx", "zy", "zz"};
constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"};

std::vector<std::string> ImuIntrinsicsNames(ImuModelKind kind) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& prefix, const auto& suffixes) {
    for (const char* suffix : suffixes) names.push_back(prefix + suffix);
  };
  if (kind == ImuModelKind::kCalibrated) return names;
  add("M_accel_", kLowerTriangleNames);
  add("M_gyro_", kLowerTriangleNames);
  add("R_gyro_i_", kAxisNames);
  add("g_sensitivity_", kMatrixNames);
  if (kind == ImuModelKind::kScaleMisalignment) return names;
  add("lever_arm_y_", kAxisNames);
  add("lever_arm_z_", kAxisNames);
  return names;
}

void PerturbLowerTriangle(const Eigen::VectorXd& delta, Eigen::Matrix3d* M) {
  int k = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column <= row; ++column) (*M)(row, column) += delta(k++);
  }
}

Eigen::VectorXd LowerTriangle(const Eigen::Matrix3d& M) {
  return (Eigen::VectorXd(6) << M(0, 0), M(1, 0), M(1, 1), M(2, 0), M(2, 1), M(2, 2)).finished();
}

Eigen::VectorXd ImuIntrinsicsDifference(const ImuIntrinsics& to, const ImuIntrinsics& from,
                                        int num_intrinsics) {
  Eigen::VectorXd delta(30);
  delta << LowerTriangle(to.M_accel - from.M_accel), LowerTriangle(to.M_gyro - from.M_gyro),
      LogSo3(to.R_gyro_i * from.R_gyro_i.transpose()),
      (to.g_sensitivity - from.g_sensitivity).reshaped<Eigen::RowMajor>(),
      to.lever_arms_i.col(1) - from.lever_arms_i.col(1),
      to.lever_arms_i.col(2) - from.lever_arms_i.col(2);
  return delta.head(num_intrinsics);
}

void PerturbImuIntrinsics(const Eigen::VectorXd& delta, ImuIntrinsics* intrinsics) {
  if (delta.size() == 0) return;
  PerturbLowerTriangle(delta.segment<6>(0), &intrinsics->M_accel);
  PerturbLowerTriangle(delta.segment<6>(6), &intrinsics->M_gyro);
  intrinsics->R_gyro_i = ExpSo3(delta.segment<3>(12)) * intrinsics->R_gyro_i;
  intrinsics->g_sensitivity += delta.segment<9>(15).reshaped<Eigen::RowMajor>(3, 3);
  if (delta.size() == 24) return;
  intrinsics->lever_arms_i.col(1) += delta.segment<3>(24);
  intrinsics->lever_arms_i.col(2) += delta.segment<3>(27);
}

}  // namespace

int NumImuIntrinsics(ImuModelKind kind) {
  return static_cast<int>(ImuIntrinsicsNames(kind).size());
}

CameraImuLayout::CameraImuLayout(const CameraImuProblem& problem, int spline_order) {
  const auto add = [&](const std::string& sensor, const auto& unknowns) {
    const int first = border_size;
    for (const auto& unknown : unknowns) names.push_back(sensor + "." + std::string(unknown));
    border_size = static_cast<int>(names.size());
    return first;
  };
  using Names = std::vector<std::string>;
  for (size_t c = 0; c < problem.cameras.size(); ++c) {
    const CameraImuCamera& of = problem.cameras[c];
    const std::string sensor = "cam" + std::to_string(c);
    Camera& camera = cameras.emplace_back();
    camera.pose = add(sensor, kPoseNames);
    if (problem.estimate_time_offsets) camera.time_offset = add(sensor, Names{"time_offset"});
    if (problem.estimate_line_delays) camera.line_delay = add(sensor, Names{"line_delay"});
    if (of.intrinsics != IntrinsicsKnowledge::kExact) {
      camera.parameters = add(sensor, CameraModel::ParameterNames(of.model.name()));
    }
  }
  gravity = border_size;
  names.insert(names.end(), {"gravity_1", "gravity_2"});
  border_size += 2;
  if (problem.estimate_board_scale) {
    names.emplace_back("board_scale");
    board_scale = border_size++;
  }
  for (size_t i = 0; i < problem.imus.size(); ++i) {
    const std::string sensor = "imu" + std::to_string(i);
    Imu& imu = imus.emplace_back();
    if (i > 0) {
      imu.pose = add(sensor, kPoseNames);
      imu.time_offset = add(sensor, Names{"time_offset"});
    }
    const Names intrinsics = ImuIntrinsicsNames(problem.imus[i].model);
    imu.num_intrinsics = static_cast<int>(intrinsics.size());
    if (!intrinsics.empty()) imu.intrinsics = add(sensor, intrinsics);
  }
  points_per_block = spline_order - 1;
  block_size = 6 * points_per_block + 6 * static_cast<int>(imus.size());
}

int CameraImuLayout::PointColumn(int c, int control_point) const {
  const int point = control_point - c * points_per_block;
  assert(point >= 0 && point < 2 * points_per_block);
  return point / points_per_block * block_size + 6 * (point % points_per_block);
}

int CameraImuLayout::BiasColumn(int imu, int knot) const {
  return knot * block_size + 6 * points_per_block + 6 * imu;
}

Eigen::Matrix<double, 3, 2> GravityTangent(const Eigen::Vector3d& gravity_g) {
  const Eigen::Vector3d down = gravity_g.normalized();
  Eigen::Index flattest = 0;
  down.cwiseAbs().minCoeff(&flattest);
  Eigen::Matrix<double, 3, 2> tangent;
  tangent.col(0) = down.cross(Eigen::Vector3d::Unit(flattest)).normalized();
  tangent.col(1) = down.cross(tangent.col(0));
  return tangent;
}

std::optional<CameraImuState> Perturbed(const CameraImuState& state, const CameraImuLayout& layout,
                                        const Eigen::VectorXd& delta) {
  const int num_blocks = state.num_blocks();
  const int points = 6 * layout.points_per_block;
  assert(delta.size() == num_blocks * layout.block_size + layout.border_size);
  const auto border = delta.tail(layout.border_size);

  CameraImuState next = state;
  for (size_t c = 0; c < next.cameras.size(); ++c) {
    CameraCalibrationState& camera = next.cameras[c];
    const CameraImuLayout::Camera& columns = layout.cameras[c];
    camera.T_c_i = camera.T_c_i.Perturbed(border.segment<6>(columns.pose));
    camera.T_c_i.R = NearestRotation(camera.T_c_i.R);
    if (columns.time_offset >= 0) camera.time_offset_s += border(columns.time_offset);
    if (columns.line_delay >= 0) camera.line_delay_s += border(columns.line_delay);
    if (columns.parameters >= 0) {
      const Eigen::VectorXd parameters =
          camera.model.parameters() +
          border.segment(columns.parameters, camera.model.num_parameters());
      const int focal = CameraModel::FocalIndex(camera.model.name());
      if (!(parameters.segment<2>(focal).minCoeff() > 0.0)) return std::nullopt;
      camera.model = CameraModel(camera.model.name(), parameters);
    }
  }
  if (layout.board_scale >= 0) {
    next.board_scale += border(layout.board_scale);
    if (!(next.board_scale > 0.0)) return std::nullopt;
  }
  next.gravity_g =
      ExpSo3(GravityTangent(state.gravity_g) * border.segment<2>(layout.gravity)) * state.gravity_g;
  for (size_t i = 0; i < next.imus.size(); ++i) {
    ImuCalibrationState& imu = next.imus[i];
    const CameraImuLayout::Imu& columns = layout.imus[i];
    if (columns.pose >= 0) {
      imu.T_i_imu = imu.T_i_imu.Perturbed(border.segment<6>(columns.pose));
      imu.T_i_imu.R = NearestRotation(imu.T_i_imu.R);
      imu.time_offset_s += border(columns.time_offset);
    }
    if (columns.intrinsics >= 0) {
      PerturbImuIntrinsics(border.segment(columns.intrinsics, columns.num_intrinsics),
                           &imu.intrinsics);
    }
  }

  Eigen::VectorXd trajectory(6 * state.T_g_i.num_control_points());
  for (int block = 0; block < num_blocks; ++block) {
    trajectory.segment(block * points, points) = delta.segment(block * layout.block_size, points);
    for (size_t i = 0; i < next.imus.size(); ++i) {
      const Eigen::Index first =
          block * layout.block_size + points + 6 * static_cast<Eigen::Index>(i);
      ImuBias& bias = next.imus[i].biases[static_cast<size_t>(block)];
      bias.gyro += delta.segment<3>(first);
      bias.accel += delta.segment<3>(first + 3);
    }
  }
  next.T_g_i.Perturb(trajectory);
  return next;
}

Eigen::VectorXd CalibrationDifference(const CameraImuState& to, const CameraImuState& from,
                                      const CameraImuLayout& layout) {
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(layout.border_size);
  for (size_t c = 0; c < from.cameras.size(); ++c) {
    const CameraImuLayout::Camera& columns = layout.cameras[c];
    const CameraCalibrationState& a = from.cameras[c];
    const CameraCalibrationState& b = to.cameras[c];
    delta.segment<6>(columns.pose) = b.T_c_i.DifferenceTo(a.T_c_i);
    if (columns.time_offset >= 0) delta(columns.time_offset) = b.time_offset_s - a.time_offset_s;
    if (columns.line_delay >= 0) delta(columns.line_delay) = b.line_delay_s - a.line_delay_s;
    if (columns.parameters >= 0) {
      delta.segment(columns.parameters, a.model.num_parameters()) =
          b.model.parameters() - a.model.parameters();
    }
  }
  if (layout.board_scale >= 0) delta(layout.board_scale) = to.board_scale - from.board_scale;
  const Eigen::Vector3d axis = from.gravity_g.cross(to.gravity_g);
  const double sine = axis.norm();
  if (sine > 0.0) {
    const double angle = std::atan2(sine, from.gravity_g.dot(to.gravity_g));
    delta.segment<2>(layout.gravity) =
        GravityTangent(from.gravity_g).transpose() * (angle / sine * axis);
  }
  for (size_t i = 0; i < from.imus.size(); ++i) {
    const CameraImuLayout::Imu& columns = layout.imus[i];
    const ImuCalibrationState& a = from.imus[i];
    const ImuCalibrationState& b = to.imus[i];
    if (columns.pose >= 0) {
      delta.segment<6>(columns.pose) = b.T_i_imu.DifferenceTo(a.T_i_imu);
      delta(columns.time_offset) = b.time_offset_s - a.time_offset_s;
    }
    if (columns.intrinsics >= 0) {
      delta.segment(columns.intrinsics, columns.num_intrinsics) =
          ImuIntrinsicsDifference(b.intrinsics, a.intrinsics, columns.num_intrinsics);
    }
  }
  return delta;
}

}  // namespace calibrato
