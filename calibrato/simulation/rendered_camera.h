#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/base/time.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/rig.h"
#include "calibrato/simulation/frame_exposure.h"

namespace calibrato {

/// Camera 0 of a rig in the scene: fidelity `rendered`.
///
/// The board is drawn by room `rendering`, exact to 1e-3 px at every instant of the exposure; an
/// exposure is the mean of instants at most half a pixel apart (32 at the most). Behind it, and
/// before it where it is nearer, stands what MuJoCo draws of the room and the arm: one image at the
/// middle of the exposure, turned for the other instants, and seen through the lens where its rays
/// are within 75 degrees of the axis. Then come defocus, light and vignetting, noise, rounding.
///
/// Not modelled: shadows on the board, highlights, what the arm's parallax blurs, colours; a
/// residual of the lens in what is not the board.
///
/// Each camera draws by itself: several may be used at once, each on one thread.
class RenderedCamera {
 public:
  /// @throws InputError if nothing can be drawn without a screen (HeadlessGl).
  explicit RenderedCamera(const Rig& rig);
  ~RenderedCamera();
  RenderedCamera(const RenderedCamera&) = delete;
  RenderedCamera& operator=(const RenderedCamera&) = delete;

  /// @param t_s  The middle of the exposure of the first row, since the motion began.
  [[nodiscard]] GreyImage Take(const CarrierPath& path, double t_s, Rng& noise) const;
  /// ... exposed for another time than the rig's.
  [[nodiscard]] GreyImage Take(const CarrierPath& path, const FrameExposure& exposure,
                               Rng& noise) const;

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

/// One frame of a simulated recording.
struct SimulatedImage {
  Time stamp;        ///< On the camera's clock, with its jitter.
  double t_s = 0.0;  ///< The true middle of the exposure of the first row, since the start.
  GreyImage image;
};

/// Takes frames at start + k / rate while the motion lasts, its end excluded, and hands each to
/// `sink`, in order. Each frame has a random stream of its own.
/// @return How many frames were dropped (ImageDisturbances::drop_probability).
int SimulateImages(const Rig& rig, const CarrierPath& path, Time start, const Rng& rng,
                   const std::function<void(SimulatedImage)>& sink);

}  // namespace calibrato
