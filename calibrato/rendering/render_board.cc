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

// A part of an image.
struct Window {
  int left;
  int top;
  Resolution size;
};

// Sums light over a window, in `fineness` cells a pixel and direction.
class SceneSum {
 public:
  SceneSum(const Window& window, int fineness)
      : origin_(window.left, window.top),
        fineness_(fineness),
        sum_({window.size.width * fineness, window.size.height * fineness}) {}

  // Adds light [grey levels] on the sheet, and more (or less) of it where there is ink.
  void AddBoard(const LensOutline& outline, const BoardPattern& pattern, double sheet, double ink) {
    double within_rim = AddSheet(outline, pattern, sheet);
    for (const BoardPattern::Outline& corners : pattern.outlines) {
      within_rim += AddPolygon(outline, corners, ink);
    }
    for (const BoardPattern::Disc& disc : pattern.discs) {
      outline.AddCircle(disc.centre, disc.radius_m, SideSink(ink));
      if ((outline.behind() - disc.centre).norm() < disc.radius_m) within_rim += ink;
    }
    AddRim(outline, within_rim);
  }

  void AddSheetAlone(const LensOutline& outline, const BoardPattern& pattern, double light) {
    AddRim(outline, AddSheet(outline, pattern, light));
  }

  std::vector<float> Finish(double background) && { return std::move(sum_).Finish(background); }

 private:
  // Where the corners wind anticlockwise around. @return What is missing within the rim.
  double AddPolygon(const LensOutline& outline, const BoardPattern::Outline& corners,
                    double light) {
    const LensOutline::Sink sink = SideSink(light);
    for (size_t k = 0; k < corners.size(); ++k) {
      outline.AddLine(corners[k], corners[(k + 1) % corners.size()], sink);
    }
    return light * WindingNumber(corners, outline.behind());
  }

  double AddSheet(const LensOutline& outline, const BoardPattern& pattern, double light) {
    const Vector2d low = pattern.sheet.min();
    const Vector2d high = pattern.sheet.max();
    return AddPolygon(outline, {low, {high.x(), low.y()}, high, {low.x(), high.y()}}, light);
  }

  void AddRim(const LensOutline& outline, double light) {
    if (light != 0.0) outline.AddRim(SideSink(light));
  }

  // From pixels, whose centres are whole numbers, to cells.
  LensOutline::Sink SideSink(double light) {
    return [this, light](const Vector2d& from, const Vector2d& to) {
      const auto cell = [this](const Vector2d& pixel) -> Vector2d {
        return fineness_ * ((pixel - origin_).array() + 0.5);
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

  Vector2d origin_;
  int fineness_;
  CoverageSum sum_;
};

Window WholeOf(Resolution resolution) { return {0, 0, resolution}; }

// What the sheet may cover at any of the outlines, and as much around it as blur spreads.
Window WindowOf(const BoardPattern& pattern, const std::vector<LensOutline>& outlines,
                const Camera& camera, double blur_px) {
  const Vector2d low = pattern.sheet.min();
  const Vector2d high = pattern.sheet.max();
  const BoardPattern::Outline sheet = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  Eigen::AlignedBox2d extent;
  for (const LensOutline& outline : outlines) {
    // Of a sheet that goes around the back of the camera anything may be in the image.
    if (pattern.sheet.contains(outline.behind())) return WholeOf(camera.resolution);
    for (size_t k = 0; k < sheet.size(); ++k) {
      outline.AddLine(sheet[k], sheet[(k + 1) % sheet.size()],
                      [&](const Vector2d& from, const Vector2d& to) {
                        extent.extend(from);
                        extent.extend(to);
                      });
    }
  }
  const double margin = 2.0 + 6.0 * blur_px;
  const auto [width, height] = camera.resolution;
  const auto clamped = [](double x, int size) {
    return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(size)));
  };
  const int left = clamped(std::floor(extent.min().x() - margin), width - 1);
  const int top = clamped(std::floor(extent.min().y() - margin), height - 1);
  const int right = std::max(clamped(std::ceil(extent.max().x() + margin), width), left + 1);
  const int bottom = std::max(clamped(std::ceil(extent.max().y() + margin), height), top + 1);
  return {left, top, {right - left, bottom - top}};
}

// An image that is 0 outside of the window.
std::vector<float> InWhole(const std::vector<float>& pixels, const Window& window,
                           Resolution resolution) {
  std::vector<float> whole(1UL * resolution.width * resolution.height, 0.0F);
  for (int v = 0; v < window.size.height; ++v) {
    std::copy_n(pixels.begin() + 1L * window.size.width * v, window.size.width,
                whole.begin() + 1L * resolution.width * (window.top + v) + window.left);
  }
  return whole;
}

bool IsBeforeTheBoard(const Rigid3& T_c_g) { return T_c_g.Inverse().t.z() > 0.0; }

// The mean over each pixel, blurred by the lens.
std::vector<float> Pixels(std::vector<float> cells, Resolution resolution, int fineness,
                          double blur_px) {
  if (blur_px == 0.0) return cells;
  return Blurred(cells, resolution, fineness, blur_px);
}

uint8_t Rounded(float level) {
  return static_cast<uint8_t>(std::clamp(level, 0.0F, 255.0F) + 0.5F);
}

}  // namespace

Exposure RenderBoard(const BoardPattern& pattern, const Camera& camera, const Rigid3& T_c_g,
                     const Scene& scene) {
  assert(scene.blur_px >= 0.0);
  const int fineness = CellsPerPixel(scene.blur_px);
  SceneSum sum(WholeOf(camera.resolution), fineness);
  if (IsBeforeTheBoard(T_c_g)) {
    sum.AddBoard(LensOutline(camera, scene.lens_residual, T_c_g), pattern,
                 scene.white - scene.background, scene.black - scene.white);
  }
  Exposure exposure{camera.resolution, Pixels(std::move(sum).Finish(scene.background),
                                              camera.resolution, fineness, scene.blur_px)};
  ApplyLighting(scene, &exposure);
  return exposure;
}

BoardLayer RenderBoardLayer(const BoardPattern& pattern, const Camera& camera,
                            const std::vector<PoseOfRow>& instants, const Scene& scene) {
  assert(!instants.empty() && scene.blur_px >= 0.0);
  const int fineness = CellsPerPixel(scene.blur_px);
  std::vector<LensOutline> outlines;
  for (const PoseOfRow& pose_of_row : instants) {
    if (!IsBeforeTheBoard(pose_of_row(0.5 * (camera.resolution.height - 1)))) continue;
    outlines.emplace_back(camera, scene.lens_residual, pose_of_row);
  }
  const size_t num_pixels = 1UL * camera.resolution.width * camera.resolution.height;
  if (outlines.empty()) {
    return {{camera.resolution, std::vector<float>(num_pixels)}, std::vector<float>(num_pixels)};
  }
  const Window window = WindowOf(pattern, outlines, camera, scene.blur_px);
  const double share = 1.0 / static_cast<double>(instants.size());
  SceneSum light(window, fineness);
  SceneSum coverage(window, fineness);
  for (const LensOutline& outline : outlines) {
    light.AddBoard(outline, pattern, share * scene.white, share * (scene.black - scene.white));
    coverage.AddSheetAlone(outline, pattern, share);
  }
  const auto pixels = [&](SceneSum sum) {
    return InWhole(Pixels(std::move(sum).Finish(0.0), window.size, fineness, scene.blur_px), window,
                   camera.resolution);
  };
  return {{camera.resolution, pixels(std::move(light))}, pixels(std::move(coverage))};
}

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
