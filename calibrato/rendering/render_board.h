#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/rendering/board_pattern.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/lens_residual.h"

namespace calibrato {

/// What surrounds the board and how it is lit. Grey levels are linear in light, 255 is a full
/// pixel.
struct Scene {
  double black = 25.0;        ///< Ink [grey levels] >= 0.
  double white = 225.0;       ///< Paper [grey levels] >= 0.
  double background = 110.0;  ///< All around the sheet, and where the lens sees nothing.
  /// Relative change of brightness from the image's middle to its right and to its lower edge.
  Eigen::Vector2d lighting_gradient = Eigen::Vector2d::Zero();
  /// Relative loss of brightness from the image's middle to its corners, as the square of the
  /// distance: 0 to 1.
  double vignetting = 0.0;
  /// Standard deviation of the lens's point spread function, a round Gaussian [px] >= 0.
  double blur_px = 0.0;
  LensField lens_residual;  ///< What the lens adds to what the camera's model says.
};

/// The light on each pixel, before noise and rounding.
struct Exposure {
  Resolution resolution;
  std::vector<float> pixels;  ///< width * height [grey levels], row by row.
};

/// The image of a board through any lens, so exact that detectors can be judged by it: corner k is
/// at camera.model.Project(T_c_g * BoardPoints(board).col(k)), plus the lens's residual there.
///
/// Each pixel is the mean of the scene over the pixel's area. It is computed from the areas that
/// the outlines of everything black cut out of each pixel, in closed form, the outlines being
/// within 1e-4 px of where the lens puts them; so it is within 1e-4 of the contrast per side that
/// crosses the pixel. Blur is a Gaussian, on top of the pixel's area, within 5e-3 of the contrast,
/// symmetric about every pixel and every edge, so that it moves none.
///
/// All models serve, also where they see behind themselves. Parts outside the model's domain are
/// not seen. From behind there is no board, only background.
/// @param pattern  PatternOf(board), made once for many images.
/// @param T_c_g  Board to camera.
[[nodiscard]] Exposure RenderBoard(const BoardPattern& pattern, const Camera& camera,
                                   const Rigid3& T_c_g, const Scene& scene);

/// A board without what surrounds it, to be laid over an image of the rest:
///
///     pixel = light + (1 - coverage) * (what is behind the board)
struct BoardLayer {
  Exposure light;               ///< Of the board [grey levels].
  std::vector<float> coverage;  ///< How much of each pixel the sheet covers, 0 to 1.
};

/// The board's pose T_c_g by the image row that is exposed (LensOutline).
using PoseOfRow = std::function<Rigid3(double row)>;

/// The mean over several instants of one exposure, each as exact as RenderBoard's image.
/// @param instants  At least one: poses evenly spread over the exposure, at the middles of its
/// parts.
/// @param scene  Its black, white, blur_px and lens_residual; light and background are the caller's
/// to add.
[[nodiscard]] BoardLayer RenderBoardLayer(const BoardPattern& pattern, const Camera& camera,
                                          const std::vector<PoseOfRow>& instants,
                                          const Scene& scene);

/// Light that varies over the image, and the lens's loss of it: `scene`'s gradient and vignetting.
void ApplyLighting(const Scene& scene, Exposure* exposure);

/// A sensor's noise: variance = read_noise^2 + shot_noise * (grey level).
struct SensorNoise {
  double read_noise = 0.0;  ///< Standard deviation in the dark [grey levels] >= 0.
  double shot_noise = 0.0;  ///< Variance per grey level [grey levels] >= 0; about 255 / full well.
};

/// Rounds to the nearest of 0 .. 255.
[[nodiscard]] GreyImage Digitised(const Exposure& exposure);
/// ... after noise, drawn for every pixel in its order.
[[nodiscard]] GreyImage Digitised(const Exposure& exposure, const SensorNoise& noise, Rng& rng);

}  // namespace calibrato
