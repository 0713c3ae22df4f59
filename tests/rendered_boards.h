#pragma once

#include <optional>
#include <string>

#include "calibrato/base/rng.h"
#include "calibrato/rendering/render_board.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/camera_chain.h"

namespace calibrato {

/// A camera of 640 x 480 pixels: "pinhole-radtan" with a barrel distortion, or "pinhole-equi" of
/// 150 degrees.
[[nodiscard]] Camera CameraForTest(const std::string& model);

/// Where boards are held: their middle at a pixel, at a distance, tilted against the line of sight
/// and rolled [rad]. At no tilt and no roll the board faces the camera, its x to the right, y up.
struct BoardPlace {
  Eigen::Vector2d pixel{320.0, 240.0};
  double distance_m = 1.0;
  double tilt = 0.0;
  double tilt_axis = 0.0;
  double roll = 0.0;
};
[[nodiscard]] Rigid3 PoseOf(const Board& board, const Camera& camera, const BoardPlace& place);

/// The images of the board's points; (-1000, -1000) where the lens does not see one.
[[nodiscard]] Eigen::Matrix2Xd TruthOf(const Board& board, const Camera& camera,
                                       const Rigid3& T_c_g);

/// A sharp lens, uneven light.
[[nodiscard]] Scene SceneForTest();

/// Without noise.
[[nodiscard]] GreyImage ImageOf(const Board& board, const Camera& camera, const Rigid3& T_c_g);

}  // namespace calibrato
