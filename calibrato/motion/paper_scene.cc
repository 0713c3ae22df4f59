#include "calibrato/motion/paper_scene.h"

#include <cmath>
#include <numbers>

#include "calibrato/geometry/rpy.h"

namespace calibrato {

double FocalLengthFromFieldOfView(double hfov_rad, int width) {
  return 0.5 * width / std::tan(0.5 * hfov_rad);
}

Rig PaperRig() {
  constexpr Resolution kResolution{640, 480};
  const double f = FocalLengthFromFieldOfView(1.0, kResolution.width);
  Rig rig;
  // The principal point is one pixel off the image's middle, as the original's truth has it.
  rig.cameras.push_back({CameraModel("pinhole-none", Eigen::Vector4d(f, f, 320.5, 240.5)),
                         kResolution, "/cam0/image_raw", std::nullopt});

  // The camera sits on the left finger, 0.1 m along it; the hand is link 8 turned by -45 degrees.
  const Rigid3 T_e_hand{RotationFromRpy({0.0, 0.0, -std::numbers::pi / 4.0}),
                        Eigen::Vector3d::Zero()};
  const Rigid3 T_hand_finger{Eigen::Matrix3d::Identity(), {0.0, 0.03, 0.0584}};
  Rigid3 T_finger_c0;
  T_finger_c0.R << 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0;  // x_c = -y_f, y_c = x_f
  T_finger_c0.t << 0.0, 0.0, 0.1;
  rig.T_e_c0 = T_e_hand * T_hand_finger * T_finger_c0;
  rig.T_c0_i = {RotationFromRpy({0.0, 0.0, 1.5708}), {0.06, 0.0, -0.1}};

  // The board's model m has its origin in the middle of the inner corners and seven of them along
  // its x; it was pitched by 1.57, not by pi / 2.
  rig.board = Checkerboard{6, 7, 0.06, 0.06};
  const Rigid3 T_w_m{RotationFromRpy({0.0, 1.57, 0.0}), {-2.0, -0.35, 0.5}};
  Rigid3 T_m_g;
  T_m_g.R << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;  // x_g = y_m, y_g = -x_m
  T_m_g.t = -(T_m_g.R * BoardCentre(rig.board));
  rig.T_w_g = T_w_m * T_m_g;
  return rig;
}

}  // namespace calibrato
