#include "calibrato/detection/saddle_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace calibrato {
namespace {

// Farther from the corner than this an edge adds little, and lens and board bend.
constexpr double kMaxReach = 7.0;  // [px]
// Farther from both edges than this the picture is flat.
constexpr double kMaxDistanceFromEdge = 3.5;  // [px]
constexpr double kMinWidth = 1.8;             // [px] from the corner to the window's side
constexpr int kMinPixels = 20;
constexpr int kMaxIterations = 25;
constexpr double kNearlyConvergedStep = 0.2;  // [px]
constexpr double kConvergedStep = 0.003;      // [px]
// Where edges are sharper than pixels a step may leave half of the way still to go, so that it is
// worth while to go on.
constexpr double kFinestStep = 3e-4;       // [px]
constexpr double kMinContrast = 6.0;       // [grey levels]
constexpr double kMaxMisfit = 0.3;         // root mean square residual over half the contrast
constexpr double kMaxDeviation = 0.3;      // [px]
constexpr double kMinAngle = 0.2;          // [rad] between the edges
constexpr double kMaxTurn = 0.35;          // [rad] of an edge against its arm
constexpr double kStartBlur = 0.8;         // [px]
constexpr double kMinBlur = 0.05;          // [px]
constexpr double kMaxBlur = 4.0;           // [px]
constexpr double kLightScale = kMaxReach;  // makes the light's two parameters of order 1

// c (2), angles of the edges (2), log of the blur, m, a, light (2).
constexpr int kNumParameters = 9;
using Parameters = Eigen::Matrix<double, kNumParameters, 1>;
using Normal = Eigen::Matrix<double, kNumParameters, kNumParameters>;

struct Pixel {
  double u;  // relative to the window's centre [px]
  double v;
  double value;
};

// erf(t), its integral t erf(t) + exp(-t^2) / sqrt(pi), and its slope, from a table: exp would take
// half of the fit's time. Linear interpolation leaves an error of 3e-5.
class ErrorFunction {
 public:
  struct Value {
    double integral;
    double erf;
    double slope;
  };
  ErrorFunction() {
    for (int k = 0; k <= kSize; ++k) {
      const double t = (k - kSize / 2) / kSteps;
      const double bell = std::numbers::inv_sqrtpi * std::exp(-t * t);
      values_[static_cast<size_t>(k)] = {t * std::erf(t) + bell, std::erf(t), 2.0 * bell};
    }
  }
  Value At(double t) const {
    const double position = std::clamp(t * kSteps + kSize / 2, 0.0, kSize - 1e-9);
    const auto k = static_cast<size_t>(position);
    const double share = position - static_cast<double>(k);
    const Value& low = values_[k];
    const Value& high = values_[k + 1];
    const double beyond_table = std::max(0.0, std::abs(t) - kSize / (2.0 * kSteps));
    return {low.integral + share * (high.integral - low.integral) + beyond_table,
            low.erf + share * (high.erf - low.erf), low.slope + share * (high.slope - low.slope)};
  }

 private:
  static constexpr int kSize = 512;
  static constexpr double kSteps = 64.0;  // in a unit of t
  std::array<Value, kSize + 1> values_;
};

// One blurred edge at a pixel.
struct Edge {
  double value;    // E, -1 to 1
  double slope;    // its derivative by d
  double by_blur;  // and by the logarithm of the blur
  double along;    // from the corner, along the edge
};

// The mean of the blurred edge over a pixel. Seen along the edge a pixel's square is a trapezoid:
// its wider side is integrated over, its narrower one is as much blur as its variance. So the edge
// between two pixels of a row is exact, and so is where its place leaves no trace but one pixel's
// grey.
class BlurredEdge {
 public:
  BlurredEdge(double angle, double blur) : cos_(std::cos(angle)), sin_(std::sin(angle)) {
    half_width_ = 0.5 * std::max(std::abs(cos_), std::abs(sin_));
    const double other_half = 0.5 * std::min(std::abs(cos_), std::abs(sin_));
    const double stddev = std::sqrt(blur * blur + other_half * other_half / 3.0);
    scale_ = 1.0 / (std::numbers::sqrt2 * stddev);
    per_scale_and_width_ = 0.5 / (scale_ * half_width_);
    blur_slope_ = 0.25 / half_width_ * std::numbers::sqrt2 * blur * blur / stddev;
  }

  Edge At(double u, double v) const {
    static const ErrorFunction error_function;
    const double distance = cos_ * v - sin_ * u;
    const ErrorFunction::Value high = error_function.At((distance + half_width_) * scale_);
    const ErrorFunction::Value low = error_function.At((distance - half_width_) * scale_);
    return {per_scale_and_width_ * (high.integral - low.integral),
            0.5 / half_width_ * (high.erf - low.erf), blur_slope_ * (high.slope - low.slope),
            cos_ * u + sin_ * v};
  }
  // Of the unit vector to the edge's left.
  double normal_u() const { return -sin_; }
  double normal_v() const { return cos_; }

 private:
  double cos_;
  double sin_;
  double half_width_;  // of a pixel, across the edge [px]
  double scale_;
  double per_scale_and_width_;
  double blur_slope_;
};

// The pixels of the window, or nothing where it reaches out of the image.
std::optional<std::vector<Pixel>> PixelsOf(const GreyImage& image, const SaddleWindow& window) {
  const auto& [width, height] = image.resolution;
  const Eigen::Vector2d extent = window.arms.cwiseAbs().rowwise().sum().cwiseMin(kMaxReach);
  const Eigen::Vector2d low = window.centre - extent;
  const Eigen::Vector2d high = window.centre + extent;
  if (!(low.minCoeff() >= 0.0 && high.x() <= width - 1 && high.y() <= height - 1)) {
    return std::nullopt;
  }
  const Eigen::Matrix2d to_arms = window.arms.inverse();
  const double length_1 = window.arms.col(0).norm();
  const double length_2 = window.arms.col(1).norm();
  const double area = std::abs(window.arms.determinant());
  std::vector<Pixel> pixels;
  for (int v = static_cast<int>(std::ceil(low.y())); v <= high.y(); ++v) {
    for (int u = static_cast<int>(std::ceil(low.x())); u <= high.x(); ++u) {
      const Eigen::Vector2d x = Eigen::Vector2d(u, v) - window.centre;
      if (x.squaredNorm() > kMaxReach * kMaxReach) continue;
      const Eigen::Vector2d share = (to_arms * x).cwiseAbs();
      if (share.maxCoeff() > 1.0 || share.minCoeff() > window.band) continue;
      // The first edge is where the second share vanishes.
      if (std::min(share.y() * area / length_1, share.x() * area / length_2) >
          kMaxDistanceFromEdge) {
        continue;
      }
      pixels.push_back(
          {x.x(), x.y(),
           static_cast<double>(image.pixels[static_cast<size_t>(v) * static_cast<size_t>(width) +
                                            static_cast<size_t>(u)])});
    }
  }
  return pixels;
}

// One step of Gauss and Newton.
struct Step {
  Normal normal = Normal::Zero();  // lower triangle
  Parameters gradient = Parameters::Zero();
  Eigen::Matrix<double, kNumParameters, 2> gradient_by_curvature =
      Eigen::Matrix<double, kNumParameters, 2>::Zero();
  double squared_residuals = 0.0;
  double weights = 0.0;
};

Step Linearise(const std::vector<Pixel>& pixels, const Parameters& parameters,
               double outlier_scale) {
  const double blur = std::exp(parameters(4));
  const BlurredEdge edge_1(parameters(2), blur);
  const BlurredEdge edge_2(parameters(3), blur);
  const double m = parameters(5);
  const double a = parameters(6);
  // Plain arrays, which the compiler keeps in registers.
  double normal[kNumParameters][kNumParameters] = {};
  double gradient[kNumParameters] = {};
  double by_curvature[2][kNumParameters] = {};
  Step step;
  for (const Pixel& pixel : pixels) {
    const double u = pixel.u - parameters(0);
    const double v = pixel.v - parameters(1);
    const Edge e1 = edge_1.At(u, v);
    const Edge e2 = edge_2.At(u, v);
    const double light_u = pixel.u / kLightScale;
    const double light_v = pixel.v / kLightScale;
    const double light = 1.0 + parameters(7) * light_u + parameters(8) * light_v;
    const double plain = m + a * e1.value * e2.value;
    const double slope_1 = light * a * e1.slope * e2.value;
    const double slope_2 = light * a * e2.slope * e1.value;
    const double J[kNumParameters] = {-slope_1 * edge_1.normal_u() - slope_2 * edge_2.normal_u(),
                                      -slope_1 * edge_1.normal_v() - slope_2 * edge_2.normal_v(),
                                      -slope_1 * e1.along,
                                      -slope_2 * e2.along,
                                      light * a * (e1.by_blur * e2.value + e2.by_blur * e1.value),
                                      light,
                                      light * e1.value * e2.value,
                                      plain * light_u,
                                      plain * light_v};
    const double residual = light * plain - pixel.value;
    const double relative = residual / outlier_scale;
    const double weight = 1.0 / (1.0 + relative * relative);
    const double weighted_residual = weight * residual;
    const double bend_1 = -0.5 * weight * slope_1 * e1.along * e1.along;
    const double bend_2 = -0.5 * weight * slope_2 * e2.along * e2.along;
    for (int column = 0; column < kNumParameters; ++column) {
      const double scaled = weight * J[column];
      for (int row = 0; row < kNumParameters; ++row) normal[column][row] += scaled * J[row];
    }
    for (int row = 0; row < kNumParameters; ++row) {
      gradient[row] += weighted_residual * J[row];
      by_curvature[0][row] += bend_1 * J[row];
      by_curvature[1][row] += bend_2 * J[row];
    }
    step.squared_residuals += weighted_residual * residual;
    step.weights += weight;
  }
  for (int row = 0; row < kNumParameters; ++row) {
    for (int column = 0; column < kNumParameters; ++column) {
      step.normal(row, column) = normal[column][row];
    }
    step.gradient(row) = gradient[row];
    step.gradient_by_curvature.row(row) << by_curvature[0][row], by_curvature[1][row];
  }
  return step;
}

// With the corner and its edges as the window has them.
Parameters StartValues(const std::vector<Pixel>& pixels, const SaddleWindow& window) {
  Parameters parameters = Parameters::Zero();
  parameters(2) = std::atan2(window.arms(1, 0), window.arms(0, 0));
  parameters(3) = std::atan2(window.arms(1, 1), window.arms(0, 1));
  parameters(4) = std::log(kStartBlur);
  const BlurredEdge edge_1(parameters(2), kStartBlur);
  const BlurredEdge edge_2(parameters(3), kStartBlur);
  double sum_b = 0.0;
  double sum_bb = 0.0;
  double sum_i = 0.0;
  double sum_ib = 0.0;
  for (const Pixel& pixel : pixels) {
    const double b = edge_1.At(pixel.u, pixel.v).value * edge_2.At(pixel.u, pixel.v).value;
    sum_b += b;
    sum_bb += b * b;
    sum_i += pixel.value;
    sum_ib += pixel.value * b;
  }
  const auto n = static_cast<double>(pixels.size());
  parameters(6) = (n * sum_ib - sum_i * sum_b) / (n * sum_bb - sum_b * sum_b);
  parameters(5) = (sum_i - parameters(6) * sum_b) / n;
  return parameters;
}

}  // namespace

std::variant<SaddleFit, SaddleFlaw> FitSaddle(const GreyImage& image, const SaddleWindow& window) {
  const double area = std::abs(window.arms.determinant());
  const double longest = window.arms.colwise().norm().maxCoeff();
  if (!(area >= kMinWidth * longest)) return SaddleFlaw::kBadFit;
  std::optional<std::vector<Pixel>> pixels = PixelsOf(image, window);
  if (!pixels) return SaddleFlaw::kNearBorder;
  if (pixels->size() < kMinPixels) return SaddleFlaw::kBadFit;

  const Parameters start = StartValues(*pixels, window);
  Parameters parameters = start;
  const double max_shift = std::min(kMaxReach, area / longest);
  SaddleWindow centred = window;
  bool is_centred = false;
  double outlier_scale = 1e9;
  double moved = std::numeric_limits<double>::infinity();  // since the window is centred
  Step step;
  for (int i = 0; i < kMaxIterations && !(moved < kFinestStep); ++i) {
    step = Linearise(*pixels, parameters, outlier_scale);
    // A little damping: where the light, the blur or an angle can't be told it stays.
    Normal damped = step.normal;
    damped.diagonal() *= 1.0 + 1e-6;
    damped.diagonal().array() += 1e-9;
    Parameters change = -damped.selfadjointView<Eigen::Lower>().ldlt().solve(step.gradient);
    change.head<2>() = change.head<2>().cwiseMin(2.0).cwiseMax(-2.0);
    change.segment<3>(2) = change.segment<3>(2).cwiseMin(0.4).cwiseMax(-0.4);
    parameters += change;
    parameters(4) = std::clamp(parameters(4), std::log(kMinBlur), std::log(kMaxBlur));
    const Eigen::Vector2d shift = centred.centre + parameters.head<2>() - window.centre;
    if (!(shift.norm() <= max_shift)) return SaddleFlaw::kBadFit;
    const double half_contrast = std::abs(parameters(6));
    outlier_scale =
        std::max(3.0 * std::sqrt(step.squared_residuals / step.weights), 0.05 * half_contrast);
    const double change_px = change.head<2>().cwiseAbs().maxCoeff();
    if (!is_centred && change_px < kNearlyConvergedStep) {
      // Only about the corner itself are the model's errors the same on all sides.
      is_centred = true;
      centred.centre += parameters.head<2>();
      parameters.head<2>().setZero();
      pixels = PixelsOf(image, centred);
      if (!pixels) return SaddleFlaw::kNearBorder;
      if (pixels->size() < kMinPixels) return SaddleFlaw::kBadFit;
      continue;
    }
    if (is_centred) moved = change_px;
  }

  const double half_contrast = std::abs(parameters(6));
  const double variance = step.squared_residuals / step.weights;
  const double angle = std::abs(std::remainder(parameters(2) - parameters(3), std::numbers::pi));
  // An edge of something else.
  const double turn =
      std::max(std::abs(std::remainder(parameters(2) - start(2), std::numbers::pi)),
               std::abs(std::remainder(parameters(3) - start(3), std::numbers::pi)));
  if (!(moved < kConvergedStep) || !(turn <= kMaxTurn) || !(2.0 * half_contrast >= kMinContrast) ||
      !(variance <= kMaxMisfit * kMaxMisfit * half_contrast * half_contrast) ||
      !(angle >= kMinAngle)) {
    return SaddleFlaw::kBadFit;
  }
  Normal covariance = step.normal;
  covariance.diagonal().array() += 1e-9;
  covariance = covariance.selfadjointView<Eigen::Lower>().ldlt().solve(Normal::Identity()).eval();
  if (!(variance * covariance.diagonal().head<2>().maxCoeff() <= kMaxDeviation * kMaxDeviation)) {
    return SaddleFlaw::kBadFit;
  }
  SaddleFit fit;
  fit.pixel = centred.centre + parameters.head<2>();
  fit.J_pixel_curvature = -covariance.topRows<2>() * step.gradient_by_curvature;
  fit.contrast = 2.0 * half_contrast;
  // Between the arms d1 has the sign of their cross product, d2 the opposite one: their product is
  // negative, and so is E E.
  fit.is_dark_between = parameters(6) > 0.0;
  return fit;
}

}  // namespace calibrato
