#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string_view>

#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/rig.h"

// MuJoCo's, whose headers stay in the sources.
struct mjModel_;
struct mjData_;

namespace calibrato {

/// models/panda.xml, as compiled in: arm, table, board on its stand, room.
[[nodiscard]] std::string_view ArmSceneXml();

/// MuJoCo's model of the arm before a board: board, stand, camera and IMU are where the rig has
/// them. World w as everywhere: z up, the arm's base at the origin, turned by pi.
class ArmScene {
 public:
  /// @param xml  MJCF with the bodies, joints and sensors of models/panda.xml.
  /// @throws InputError if it can't be compiled, or lacks one of those names.
  explicit ArmScene(const Rig& rig, std::string_view xml = ArmSceneXml());
  ~ArmScene();
  ArmScene(const ArmScene&) = delete;
  ArmScene& operator=(const ArmScene&) = delete;

  [[nodiscard]] mjModel_* model() const { return model_; }
  [[nodiscard]] mjData_* data() const { return data_; }

 private:
  mjModel_* model_ = nullptr;
  mjData_* data_ = nullptr;
};

/// MuJoCo's quaternions have the scalar first.
[[nodiscard]] std::array<double, 4> MujocoQuaternion(const Eigen::Matrix3d& R);
/// ... and MuJoCo's rows, R_a_b of nine numbers, row by row.
[[nodiscard]] Eigen::Matrix3d FromMujocoMatrix(const double* rows);

}  // namespace calibrato
