#pragma once

#include <Eigen/Core>
#include <functional>

#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/lens_residual.h"

namespace calibrato {

/// What a lens makes of curves on a board: their images, as chains of straight sides that are
/// nowhere further from the true curve than kMaxChordError. Every camera model serves, through its
/// Project alone, so that a drawn corner lies exactly where the model says (and, if the lens has a
/// residual, by that beside it).
///
/// Parts of a board may lie behind the camera or outside the model's domain. They are moved, around
/// the camera's centre and away from the opposite of the optical axis, to the rim of what can be
/// seen: a continuous map that fixes all that can be seen and sends the rest to the rim. So the
/// image of a closed curve is closed, and encloses what can be seen of its inside; but if the very
/// opposite of the optical axis is inside, it encloses everything within the rim once too seldom
/// (behind(), AddRim).
class LensOutline {
 public:
  static constexpr double kMaxChordError = 1e-4;  ///< [px]

  /// @pre The camera is on the board's front side.
  /// @param residual  What the lens adds to what its model says; lives as long as the outline.
  LensOutline(const Camera& camera, const LensField& residual, const Rigid3& T_c_g);

  /// Through a rolling shutter: each row of the image sees the board at a pose of its own. A point
  /// lies where the row that it falls on sees it.
  /// @param pose_of_row  T_c_g at the instant of an image row [px], from -height to 2 * height; it
  /// changes by much less than a row from one row to the next.
  LensOutline(const Camera& camera, const LensField& residual,
              const std::function<Rigid3(double row)>& pose_of_row);

  /// Takes the ends of a side [px].
  using Sink = std::function<void(const Eigen::Vector2d& from, const Eigen::Vector2d& to)>;
  /// A straight side of an outline in the plane z = 0 of the board [m].
  void AddLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Sink& sink) const;
  /// A full circle, anticlockwise on the board.
  void AddCircle(const Eigen::Vector2d& centre, double radius_m, const Sink& sink) const;

  /// Where the opposite of the optical axis meets the board; NaN if nowhere.
  const Eigen::Vector2d& behind() const { return behind_; }
  /// The rim of what can be seen, anticlockwise in the image.
  void AddRim(const Sink& sink) const;

 private:
  struct Sample {
    double t;
    Eigen::Vector3d p_c;
    Eigen::Vector2d pixel;
  };
  using Curve = std::function<Eigen::Vector3d(double t)>;  // in the camera frame

  Eigen::Vector3d InCamera(const Eigen::Vector2d& p_g) const;
  Sample At(const Curve& curve, double t) const;
  void AddClosed(const Curve& curve, const Sink& sink) const;
  void Divide(const Curve& curve, const Sample& first, const Sample& middle, const Sample& last,
              int depth, const Sink& sink) const;
  bool IsStraight(const Sample* samples) const;
  bool IsOutside(const Sample* samples) const;
  Eigen::Vector2d PixelOf(const Eigen::Vector3d& p_c) const;
  Eigen::Vector2d ModelledPixelOf(const Eigen::Vector3d& p_c) const;

  const Camera& camera_;
  const LensField& residual_;
  Rigid3 T_c_g_;                               // at the image's middle row
  std::function<Rigid3(double)> pose_of_row_;  // empty: the same for all
  double rim_angle_;  // [rad] off the optical axis; all that is in the image is within
  double rim_cotangent_;
  Eigen::Vector2d behind_;
};

}  // namespace calibrato
