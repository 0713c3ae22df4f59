#include "calibrato/sensors/lens_residual.h"

#include <cassert>
#include <cmath>
#include <numbers>

#include "calibrato/base/rng.h"

namespace calibrato {

LensResidual LensResidualFromValue(const Value& value, std::vector<std::string>* warnings) {
  if (warnings != nullptr) {
    const std::vector<std::string> unknown = value.UnknownKeys({"rms_px", "seed"});
    warnings->insert(warnings->end(), unknown.begin(), unknown.end());
  }
  constexpr double kMost = 10.0;
  constexpr int64_t kMaxSeed = 1'000'000'000;
  LensResidual residual;
  if (const Value* x = value.Find("rms_px")) {
    residual.rms_px = x->AsNonNegative();
    if (!(residual.rms_px <= kMost)) {
      x->Fail("too large a residual of the lens", "the most is 10 px", "choose another model");
    }
  }
  if (const Value* x = value.Find("seed")) residual.seed = x->AsInt(0, kMaxSeed);
  return residual;
}

Value ToValue(const LensResidual& residual) {
  Value value = Value::Object();
  value.Set("rms_px", residual.rms_px).Set("seed", residual.seed);
  return value;
}

LensField::LensField(const LensResidual& residual, Resolution resolution)
    : is_zero_(residual.rms_px == 0.0), resolution_(resolution) {
  assert(residual.rms_px >= 0.0 && residual.seed >= 0);
  const Rng rng = Rng(static_cast<uint64_t>(residual.seed)).Stream("lens residual");
  uint64_t axis = 0;
  for (Coefficients* coefficients : {&u_, &v_}) {
    Rng draws = rng.Stream("axis", axis++);
    double mean_square = 0.0;
    for (int i = 0; i < kNumWaves; ++i) {
      for (int j = 0; j < kNumWaves; ++j) {
        if (i + j < 2 || i + j >= kNumWaves) continue;
        const double c = draws.Normal();
        (*coefficients)(i, j) = c;
        // The mean of a squared cosine over whole half waves; that of a constant is 1.
        mean_square += c * c * (i == 0 ? 1.0 : 0.5) * (j == 0 ? 1.0 : 0.5);
      }
    }
    *coefficients *= residual.rms_px / std::sqrt(mean_square);
  }
}

Eigen::Vector2d LensField::At(const Eigen::Vector2d& pixel) const {
  if (is_zero_) return Eigen::Vector2d::Zero();
  const double x = std::numbers::pi * (pixel.x() + 0.5) / resolution_.width;
  const double y = std::numbers::pi * (pixel.y() + 0.5) / resolution_.height;
  Eigen::Matrix<double, kNumWaves, 1> along_x;
  Eigen::Matrix<double, kNumWaves, 1> along_y;
  for (int i = 0; i < kNumWaves; ++i) {
    along_x[i] = std::cos(i * x);
    along_y[i] = std::cos(i * y);
  }
  return {along_x.dot(u_ * along_y), along_x.dot(v_ * along_y)};
}

}  // namespace calibrato
