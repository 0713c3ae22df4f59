#include "calibrato/rendering/render_board.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "calibrato/rendering/blur.h"
#include "calibrato/rendering/coverage.h"
#include "calibrato/rendering/lens_outline.h"

namespace calibrato {
namespace {

using Eigen::Vector2d;

// Sums the light of the scene over a raster of `fineness` cells a pixel and direction.
class SceneSum {
 public:
  SceneSum(const Camera& camera, const Rigid3& T_c_g, int fineness)
      : outline_(camera, T_c_g),
        fineness_(fineness),
        sum_({camera.resolution.width * fineness, camera.resolution.height * fineness}) {}

  // Adds light [grey levels] where the corners wind anticlockwise around.
  void AddPolygon(const BoardPattern::Outline& corners, double light) {
    const LensOutline::Sink sink = SideSink(light);
    for (size_t k = 0; k < corners.size(); ++k) {
      outline_.AddLine(corners[k], corners[(k + 1) % corners.size()], sink);
    }
    within_rim_ += light * WindingNumber(corners, outline_.behind());
  }

  void AddDisc(const BoardPattern::Disc& disc, double light) {
    outline_.AddCircle(disc.centre, disc.radius_m, SideSink(light));
    if ((outline_.behind() - disc.centre).norm() < disc.radius_m) within_rim_ += light;
  }

  std::vector<float> Finish(double background) && {
    if (within_rim_ != 0.0) outline_.AddRim(SideSink(within_rim_));
    return std::move(sum_).Finish(background);
  }

 private:
  // From pixels, whose centres are whole numbers, to cells.
  LensOutline::Sink SideSink(double light) {
    return [this, light](const Vector2d& from, const Vector2d& to) {
      const auto cell = [this](const Vector2d& pixel) -> Vector2d {
        return fineness_ * (pixel.array() + 0.5);
      };
      sum_.AddSide(cell(from), cell(to), light);
    };
  }

  // How often a polygon runs anticlockwise around a point; 0 for a NaN.
  static int WindingNumber(const BoardPattern::Outline& corners, const Vector2d& point) {
    int turns = 0;
    for (size_t k = 0; k < corners.size(); ++k) {
      const Vector2d a = corners[k] - point;
      const Vector2d b = corners[(k + 1) % corners.size()] - point;
      const double side = a.x() * b.y() - a.y() * b.x();
      if (a.y() <= 0.0 && b.y() > 0.0 && side > 0.0) ++turns;
      if (a.y() > 0.0 && b.y() <= 0.0 && side < 0.0) --turns;
    }
    return turns;
  }

  LensOutline outline_;
  int fineness_;
  CoverageSum sum_;
  double within_rim_ = 0.0;
};

void ApplyLighting(const Scene& scene, Exposure* exposure) {
  if (scene.lighting_gradient.isZero(0.0) && scene.vignetting == 0.0) return;
  const Resolution size = exposure->resolution;
  float* pixel = exposure->pixels.data();
  for (int v = 0; v < size.height; ++v) {
    const double y = (2.0 * v + 1.0) / size.height - 1.0;
    for (int u = 0; u < size.width; ++u) {
      const double x = (2.0 * u + 1.0) / size.width - 1.0;
      const double factor = (1.0 + scene.lighting_gradient.dot(Vector2d(x, y))) *
                            (1.0 - 0.5 * scene.vignetting * (x * x + y * y));
      *pixel++ *= static_cast<float>(std::max(factor, 0.0));
    }
  }
}

uint8_t Rounded(float level) {
  return static_cast<uint8_t>(std::clamp(level, 0.0F, 255.0F) + 0.5F);
}

}  // namespace

Exposure RenderBoard(const BoardPattern& pattern, const Camera& camera, const Rigid3& T_c_g,
                     const Scene& scene) {
  assert(scene.blur_px >= 0.0);
  const int fineness = CellsPerPixel(scene.blur_px);
  SceneSum sum(camera, T_c_g, fineness);
  const bool is_before_the_board = T_c_g.Inverse().t.z() > 0.0;
  if (is_before_the_board) {
    const Vector2d low = pattern.sheet.min();
    const Vector2d high = pattern.sheet.max();
    sum.AddPolygon({low, {high.x(), low.y()}, high, {low.x(), high.y()}},
                   scene.white - scene.background);
    const double ink = scene.black - scene.white;
    for (const BoardPattern::Outline& outline : pattern.outlines) sum.AddPolygon(outline, ink);
    for (const BoardPattern::Disc& disc : pattern.discs) sum.AddDisc(disc, ink);
  }
  Exposure exposure{camera.resolution, std::move(sum).Finish(scene.background)};
  if (scene.blur_px > 0.0) {
    exposure.pixels = Blurred(exposure.pixels, camera.resolution, fineness, scene.blur_px);
  }
  ApplyLighting(scene, &exposure);
  return exposure;
}

GreyImage Digitised(const Exposure& exposure) {
  GreyImage image{exposure.resolution, std::vector<uint8_t>(exposure.pixels.size())};
  std::transform(exposure.pixels.begin(), exposure.pixels.end(), image.pixels.begin(), Rounded);
  return image;
}

GreyImage Digitised(const Exposure& exposure, const SensorNoise& noise, Rng& rng) {
  GreyImage image{exposure.resolution, std::vector<uint8_t>(exposure.pixels.size())};
  const double read_variance = noise.read_noise * noise.read_noise;
  const auto sensed = [&](float level) {
    const double variance = read_variance + noise.shot_noise * std::max(level, 0.0F);
    return Rounded(static_cast<float>(level + std::sqrt(variance) * rng.Normal()));
  };
  std::transform(exposure.pixels.begin(), exposure.pixels.end(), image.pixels.begin(), sensed);
  return image;
}

}  // namespace calibrato
