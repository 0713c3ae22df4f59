#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "calibrato/motion/panda.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/simulation/arm_scene.h"
#include "calibrato/simulation/headless_gl.h"

namespace calibrato {

/// An ideal camera without distortion, its axis through the middle of its image.
struct PinholeView {
  Resolution resolution;           ///< At most 1280 x 960 px.
  double half_width_tangent = 1;   ///< Of the angle from the axis to the right edge.
  double half_height_tangent = 1;  ///< ... to the lower edge.
};

/// The scene without the board, as MuJoCo draws it.
struct SceneImage {
  Resolution resolution;
  std::vector<uint8_t> rgb;  ///< 3 * width * height, row by row from the top left.
  std::vector<float> depth;  ///< Along the optical axis [m]; 10 where nothing is nearer.
};

struct SceneViewOptions {
  bool shows_housings = false;  ///< Of camera and IMU.
  bool has_shadows = false;
};

/// Draws the scene of the arm. Several may draw at once, on threads of their own.
class SceneView {
 public:
  /// @param gl  Lives longer than the view.
  SceneView(const ArmScene& scene, const HeadlessGl& gl);
  ~SceneView();
  SceneView(const SceneView&) = delete;
  SceneView& operator=(const SceneView&) = delete;

  /// @param T_w_c  Of a camera whose z axis looks forward, x to the right, y down.
  /// @param joints  Of the arm; without them the arm is not there.
  [[nodiscard]] SceneImage Draw(const Rigid3& T_w_c, const PinholeView& view,
                                const std::optional<JointVector>& joints,
                                const SceneViewOptions& options = {});

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace calibrato
