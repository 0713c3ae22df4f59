#include "calibrato/rendering/lens_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace calibrato {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kLargestRim = std::numbers::pi - 1e-6;  // [rad]
constexpr double kMaxSideLength = 64.0;  // [px], so that no bend between samples is overlooked
constexpr int kMaxDepth = 40;

double AngleOffAxis(const Vector3d& p_c) { return std::atan2(p_c.head<2>().norm(), p_c.z()); }

// A direction turned about the camera's centre to `angle` off the axis.
Vector3d AtAngle(const Vector3d& p_c, double angle) {
  const double radius = p_c.head<2>().norm();
  const Vector2d azimuth = radius > 0.0 ? Vector2d(p_c.head<2>() / radius) : Vector2d(1.0, 0.0);
  Vector3d turned;
  turned << std::sin(angle) * azimuth, std::cos(angle);
  return turned;
}

// A little more than the largest angle that the image's edge sees.
double RimAngle(const Camera& camera) {
  constexpr int kStep = 8;  // [px]
  double largest = 0.0;
  const auto look = [&](double u, double v) {
    const std::optional<Vector3d> ray = camera.model.Unproject({u, v});
    largest = std::max(largest, ray ? AngleOffAxis(*ray) : kLargestRim);
  };
  const double right = camera.resolution.width - 0.5;
  const double bottom = camera.resolution.height - 0.5;
  for (double u = -0.5; u < right + kStep; u += kStep) {
    look(std::min(u, right), -0.5);
    look(std::min(u, right), bottom);
  }
  for (double v = -0.5; v < bottom + kStep; v += kStep) {
    look(-0.5, std::min(v, bottom));
    look(right, std::min(v, bottom));
  }
  return std::min(1.05 * largest + 0.02, kLargestRim);
}

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

LensOutline::LensOutline(const Camera& camera, const LensField& residual, const Rigid3& T_c_g)
    : camera_(camera),
      residual_(residual),
      T_c_g_(T_c_g),
      rim_angle_(RimAngle(camera)),
      rim_cotangent_(std::cos(rim_angle_) / std::sin(rim_angle_)) {
  const Rigid3 T_g_c = T_c_g.Inverse();
  const Vector3d backward = -T_g_c.R.col(2);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  behind_ = backward.z() < 0.0
                ? Vector2d((T_g_c.t - T_g_c.t.z() / backward.z() * backward).head<2>())
                : Vector2d(kNan, kNan);
}

LensOutline::LensOutline(const Camera& camera, const LensField& residual,
                         const std::function<Rigid3(double row)>& pose_of_row)
    : LensOutline(camera, residual, pose_of_row(0.5 * (camera.resolution.height - 1))) {
  pose_of_row_ = pose_of_row;
}

Vector2d LensOutline::PixelOf(const Vector3d& p_c) const {
  const Vector2d pixel = ModelledPixelOf(p_c);
  return pixel + residual_.At(pixel);
}

Vector2d LensOutline::ModelledPixelOf(const Vector3d& p_c) const {
  const bool is_within = p_c.z() >= rim_cotangent_ * p_c.head<2>().norm();
  const Vector3d direction = is_within ? p_c : AtAngle(p_c, rim_angle_);
  if (const std::optional<Vector2d> pixel = camera_.model.Project(direction)) return *pixel;
  // Outside the model's domain: its rim, in the same direction from the axis.
  double inside = 0.0;
  double outside = AngleOffAxis(direction);
  Vector2d rim = Vector2d::Zero();
  while (outside - inside > 1e-14) {
    const double angle = 0.5 * (inside + outside);
    if (angle == inside || angle == outside) break;
    const std::optional<Vector2d> pixel = camera_.model.Project(AtAngle(direction, angle));
    (pixel ? inside : outside) = angle;
    if (pixel) rim = *pixel;
  }
  return rim;
}

Vector3d LensOutline::InCamera(const Vector2d& p_g) const {
  const Vector3d p(p_g.x(), p_g.y(), 0.0);
  Vector3d p_c = T_c_g_ * p;
  if (!pose_of_row_) return p_c;
  // Each pass leaves as much of the error as a point moves, in rows, while one row is read.
  constexpr int kMaxPasses = 50;
  constexpr double kConverged = 1e-6;  // [px]
  const double height = camera_.resolution.height;
  double row = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMaxPasses; ++i) {
    const double before = row;
    row = std::clamp(PixelOf(p_c).y(), -height, 2.0 * height);
    if (std::abs(row - before) < kConverged) break;
    p_c = pose_of_row_(row) * p;
  }
  return p_c;
}

LensOutline::Sample LensOutline::At(const Curve& curve, double t) const {
  const Vector3d p_c = curve(t);
  return {t, p_c, PixelOf(p_c)};
}

// Five samples, a quarter of a piece apart, after which the piece will be four sides: is each of
// these close to the curve? The curve is taken for a parabola over its chord, whose quarters
// deviate 16 times less than the whole; the samples at the quarters tell whether it is one.
bool LensOutline::IsStraight(const Sample* samples) const {
  const Vector2d& origin = samples[0].pixel;
  const Vector2d chord = samples[4].pixel - origin;
  const double length = chord.norm();
  if (length > kMaxSideLength) return false;
  if (length < kMaxChordError) {
    return std::all_of(samples, samples + 5, [&](const Sample& sample) {
      return (sample.pixel - origin).norm() <= kMaxChordError;
    });
  }
  double along[5];   // the chord, from 0 to 1
  double across[5];  // [px]
  for (int k = 0; k < 5; ++k) {
    const Vector2d from_origin = samples[k].pixel - origin;
    along[k] = chord.dot(from_origin) / (length * length);
    across[k] = Cross(chord, from_origin) / length;
  }
  const bool is_even = along[1] > 0.1 && along[1] < along[2] && along[2] < along[3] &&
                       along[3] < 0.9 && std::abs(along[2] - 0.5) < 0.2;
  return is_even && std::abs(across[2]) <= 16.0 * kMaxChordError &&
         std::abs(across[1] - 0.75 * across[2]) <= kMaxChordError &&
         std::abs(across[3] - 0.75 * across[2]) <= kMaxChordError;
}

// On one side of the image, so that all but the ends is without effect.
bool LensOutline::IsOutside(const Sample* samples) const {
  constexpr double kSmallTurn = 0.9;  // cosine: what turns little does not come and go unseen
  const Vector3d& first = samples[0].p_c;
  const Vector3d& last = samples[4].p_c;
  if (first.dot(last) < kSmallTurn * first.norm() * last.norm()) return false;
  constexpr double kMargin = 2.0;  // [px]
  const auto all = [&](auto is_beyond) { return std::all_of(samples, samples + 5, is_beyond); };
  return all([](const Sample& s) { return s.pixel.x() < -kMargin; }) ||
         all([](const Sample& s) { return s.pixel.y() < -kMargin; }) ||
         all([&](const Sample& s) { return s.pixel.x() > camera_.resolution.width + kMargin; }) ||
         all([&](const Sample& s) { return s.pixel.y() > camera_.resolution.height + kMargin; });
}

void LensOutline::Divide(const Curve& curve, const Sample& first, const Sample& middle,
                         const Sample& last, int depth, const Sink& sink) const {
  const Sample samples[5] = {first, At(curve, 0.5 * (first.t + middle.t)), middle,
                             At(curve, 0.5 * (middle.t + last.t)), last};
  if (depth == kMaxDepth || IsStraight(samples) || IsOutside(samples)) {
    for (int k = 0; k < 4; ++k) sink(samples[k].pixel, samples[k + 1].pixel);
    return;
  }
  Divide(curve, first, samples[1], middle, depth + 1, sink);
  Divide(curve, middle, samples[3], last, depth + 1, sink);
}

void LensOutline::AddLine(const Vector2d& from, const Vector2d& to, const Sink& sink) const {
  // Both ends are what neighbouring sides have, to the last bit.
  const Curve line = [&](double t) {
    return InCamera(t == 1.0 ? to : Vector2d(from + t * (to - from)));
  };
  Divide(line, At(line, 0.0), At(line, 0.5), At(line, 1.0), 0, sink);
}

// A curve over t from 0 to 1, the same at both.
void LensOutline::AddClosed(const Curve& curve, const Sink& sink) const {
  constexpr int kParts = 8;
  const Sample start = At(curve, 0.0);
  Sample first = start;
  for (int part = 0; part < kParts; ++part) {
    Sample last = start;
    if (part + 1 < kParts) last = At(curve, (part + 1.0) / kParts);
    last.t = (part + 1.0) / kParts;
    Divide(curve, first, At(curve, (part + 0.5) / kParts), last, 0, sink);
    first = last;
  }
}

void LensOutline::AddCircle(const Vector2d& centre, double radius_m, const Sink& sink) const {
  AddClosed(
      [&](double t) {
        const double angle = 2.0 * std::numbers::pi * t;
        return InCamera(centre + radius_m * Vector2d(std::cos(angle), std::sin(angle)));
      },
      sink);
}

void LensOutline::AddRim(const Sink& sink) const {
  AddClosed(
      [&](double t) {
        const double azimuth = -2.0 * std::numbers::pi * t;  // v points down
        return AtAngle({std::cos(azimuth), std::sin(azimuth), 0.0}, rim_angle_);
      },
      sink);
}

}  // namespace calibrato
