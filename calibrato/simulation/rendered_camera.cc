#include "calibrato/simulation/rendered_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "calibrato/base/progress.h"
#include "calibrato/rendering/blur.h"
#include "calibrato/rendering/render_board.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/headless_gl.h"
#include "calibrato/simulation/scene_view.h"
#include "calibrato/simulation/swaying_board.h"

namespace calibrato {
namespace {

using Eigen::Vector3f;

constexpr double kMaxTangent = 3.7;  // 75 degrees
constexpr float kUnseen = 110.0F;    // where neither board nor scene has a ray [grey levels]
constexpr double kMaxStep = 0.5;     // between two instants of an exposure [px]
constexpr int kMaxInstants = 32;
constexpr int kMaxSceneInstants = 5;
constexpr float kOnTheHand = 0.25F;       // nearer things turn with the camera [m]
constexpr double kDepthTolerance = 0.01;  // [m]

// The ray of each pixel, to depth 1; NaN where there is none before the camera, within 75 degrees.
std::vector<Vector3f> RaysOf(const Camera& camera) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Vector3f> rays;
  rays.reserve(1UL * camera.resolution.width * camera.resolution.height);
  for (int v = 0; v < camera.resolution.height; ++v) {
    for (int u = 0; u < camera.resolution.width; ++u) {
      const auto ray = camera.model.Unproject({u, v});
      const bool is_seen = ray && ray->z() > 0.0 && ray->head<2>().norm() < kMaxTangent * ray->z();
      rays.push_back(is_seen ? Vector3f((*ray / ray->z()).cast<float>())
                             : Vector3f(kNan, kNan, kNan));
    }
  }
  return rays;
}

// Wide enough for all rays and a little turn, as fine as the lens in its middle.
PinholeView ViewOf(const std::vector<Vector3f>& rays, const Camera& camera) {
  constexpr double kMargin = 1.05;
  constexpr int kMaxWidth = 1280;
  constexpr int kMaxHeight = 960;
  double x = 0.1;
  double y = 0.1;
  for (const Vector3f& ray : rays) {
    if (std::isnan(ray.x())) continue;
    x = std::max<double>(x, std::abs(ray.x()));
    y = std::max<double>(y, std::abs(ray.y()));
  }
  x = std::min(kMargin * x + 0.02, kMaxTangent);
  y = std::min(kMargin * y + 0.02, kMaxTangent);
  const double focal =
      std::min({camera.model.focal_and_centre()[0], 0.5 * kMaxWidth / x, 0.5 * kMaxHeight / y});
  PinholeView view;
  view.resolution = {std::max(static_cast<int>(2.0 * focal * x), 16),
                     std::max(static_cast<int>(2.0 * focal * y), 16)};
  // Whole pixels, square ones.
  view.half_width_tangent = x;
  view.half_height_tangent = x * view.resolution.height / view.resolution.width;
  return view;
}

// What a pinhole image shows in a direction.
class PinholeSampler {
 public:
  PinholeSampler(const SceneImage& image, const PinholeView& view)
      : image_(image),
        scale_x_(static_cast<float>(0.5 * view.resolution.width / view.half_width_tangent)),
        scale_y_(static_cast<float>(0.5 * view.resolution.height / view.half_height_tangent)) {
    grey_.reserve(image.depth.size());
    for (size_t k = 0; k < image.depth.size(); ++k) {
      // Luminance.
      grey_.push_back(0.299F * image.rgb[3 * k] + 0.587F * image.rgb[3 * k + 1] +
                      0.114F * image.rgb[3 * k + 2]);
    }
  }

  [[nodiscard]] float DepthAt(const Vector3f& ray) const {
    const auto [width, height] = image_.resolution;
    const int u = std::clamp(static_cast<int>(X(ray) + 0.5F), 0, width - 1);
    const int v = std::clamp(static_cast<int>(Y(ray) + 0.5F), 0, height - 1);
    return image_.depth[1UL * width * v + u];
  }

  // Between the four nearest pixels.
  [[nodiscard]] float GreyAt(const Vector3f& ray) const {
    const auto [width, height] = image_.resolution;
    const float x = std::clamp(X(ray), 0.0F, static_cast<float>(width) - 1.001F);
    const float y = std::clamp(Y(ray), 0.0F, static_cast<float>(height) - 1.001F);
    const int u = static_cast<int>(x);
    const int v = static_cast<int>(y);
    const float a = x - static_cast<float>(u);
    const float b = y - static_cast<float>(v);
    const float* pixel = grey_.data() + 1UL * width * v + u;
    return (1.0F - b) * ((1.0F - a) * pixel[0] + a * pixel[1]) +
           b * ((1.0F - a) * pixel[width] + a * pixel[width + 1]);
  }

 private:
  [[nodiscard]] float X(const Vector3f& ray) const {
    return scale_x_ * ray.x() / ray.z() + 0.5F * static_cast<float>(image_.resolution.width - 1);
  }
  [[nodiscard]] float Y(const Vector3f& ray) const {
    return scale_y_ * ray.y() / ray.z() + 0.5F * static_cast<float>(image_.resolution.height - 1);
  }

  const SceneImage& image_;
  std::vector<float> grey_;
  float scale_x_;
  float scale_y_;
};

// Where the camera is while a row is exposed, around one instant of the first row's exposure, from
// one height above the image to one below it: parabolas through three rows, one after the other.
// For the 4 ms of one, an arm that swings at 30 Hz is near enough to it.
PoseOfRow PosesOfRows(const std::function<Rigid3(double t_s)>& pose_at, double t_s,
                      double line_delay_s, int height) {
  if (line_delay_s == 0.0) return [first = pose_at(t_s)](double) { return first; };
  constexpr double kMaxPiece = 0.004;  // [s]
  struct Piece {
    Rigid3 middle;
    Eigen::Matrix<double, 6, 1> slope;
    Eigen::Matrix<double, 6, 1> bend;
  };
  const double first_row = -height;
  const int num_pieces = static_cast<int>(std::ceil(3.0 * height * line_delay_s / kMaxPiece));
  const double rows = 3.0 * height / num_pieces;
  const auto pieces = std::make_shared<std::vector<Piece>>();
  const auto pose_of = [&](double row) { return pose_at(t_s + line_delay_s * row); };
  Rigid3 first = pose_of(first_row);
  for (int i = 0; i < num_pieces; ++i) {
    const Rigid3 middle = pose_of(first_row + (i + 0.5) * rows);
    const Rigid3 last = pose_of(first_row + (i + 1.0) * rows);
    const Eigen::Matrix<double, 6, 1> before = first.DifferenceTo(middle);
    const Eigen::Matrix<double, 6, 1> after = last.DifferenceTo(middle);
    pieces->push_back({middle, 0.5 * (after - before), 0.5 * (after + before)});
    first = last;
  }
  return [pieces, first_row, rows](double row) {
    const double position = (row - first_row) / rows;
    const auto last = static_cast<int>(pieces->size()) - 1;
    const int i = std::clamp(static_cast<int>(position), 0, last);
    const Piece& piece = (*pieces)[static_cast<size_t>(i)];
    const double s = 2.0 * (position - i) - 1.0;
    return piece.middle.Perturbed(s * piece.slope + s * s * piece.bend);
  };
}

}  // namespace

class RenderedCamera::Parts {
 public:
  explicit Parts(const Rig& rig)
      : rig_(rig),
        camera_(rig_.cameras.front()),
        scene_(rig),
        view_(scene_, gl_),
        rays_(RaysOf(camera_)),
        pinhole_(ViewOf(rays_, camera_)),
        pattern_(PatternOf(rig.board)),
        points_g_(BoardPoints(rig.board)) {
    const ImageDisturbances& images = rig.image_disturbances;
    look_.lighting_gradient = images.lighting_gradient;
    look_.vignetting = images.vignetting;
    look_.blur_px = images.defocus_px;
    look_.lens_residual = LensField(rig.lens_residual, camera_.resolution);
  }

  GreyImage Take(const CarrierPath& path, const FrameExposure& exposed, Rng& noise) {
    const ImageDisturbances& images = rig_.image_disturbances;
    const std::function<Rigid3(double)> camera_at = [&](double t) {
      return ArmBaseInWorld() * path.at(t).T_b_e * rig_.T_e_c0;
    };
    const std::function<Rigid3(double)> board_at = [&](double t) {
      return BoardInCamera(rig_, path, t);
    };
    const int height = camera_.resolution.height;
    const int num_instants = NumInstants(board_at, exposed);
    const auto instant = [&](int i, int n) {
      return exposed.middle_s + exposed.length_s * ((i + 0.5) / n - 0.5);
    };
    std::vector<PoseOfRow> board;
    for (int i = 0; i < num_instants; ++i) {
      board.push_back(PosesOfRows(board_at, instant(i, num_instants), images.line_delay_s, height));
    }
    const BoardLayer layer = RenderBoardLayer(pattern_, camera_, board, look_);

    std::vector<PoseOfRow> camera;
    const int num_scene_instants = std::min(num_instants, kMaxSceneInstants);
    for (int i = 0; i < num_scene_instants; ++i) {
      camera.push_back(
          PosesOfRows(camera_at, instant(i, num_scene_instants), images.line_delay_s, height));
    }
    const double middle_s = exposed.middle_s + 0.5 * height * images.line_delay_s;
    const Rigid3 T_w_c = camera_at(middle_s);
    const std::optional<JointVector> joints =
        path.joints ? std::optional(path.joints(middle_s)) : std::nullopt;
    const SceneImage scene = view_.Draw(T_w_c, pinhole_, joints);
    Exposure exposure = Composed(layer, scene, T_w_c, camera, board_at(middle_s));
    ApplyLighting(look_, &exposure);
    return Digitised(exposure, {images.read_noise, images.shot_noise}, noise);
  }

  [[nodiscard]] double exposure_s() const { return rig_.exposure_s; }

 private:
  // As many as the fastest corner needs.
  int NumInstants(const std::function<Rigid3(double)>& board_at,
                  const FrameExposure& exposed) const {
    if (exposed.length_s == 0.0) return 1;
    const Rigid3 first = board_at(exposed.middle_s - 0.5 * exposed.length_s);
    const Rigid3 last = board_at(exposed.middle_s + 0.5 * exposed.length_s);
    double farthest = 0.0;
    for (Eigen::Index k = 0; k < points_g_.cols(); ++k) {
      const auto a = camera_.model.Project(first * points_g_.col(k));
      const auto b = camera_.model.Project(last * points_g_.col(k));
      if (a && b) farthest = std::max(farthest, (*b - *a).norm());
    }
    return std::clamp(static_cast<int>(std::ceil(farthest / kMaxStep)), 1, kMaxInstants);
  }

  // The scene through the lens, the mean over the exposure.
  std::vector<float> Background(const PinholeSampler& scene, const Rigid3& T_w_c,
                                const std::vector<PoseOfRow>& camera) const {
    std::vector<float> background(rays_.size(), 0.0F);
    const float share = 1.0F / static_cast<float>(camera.size());
    const int width = camera_.resolution.width;
    for (const PoseOfRow& pose_of_row : camera) {
      for (int v = 0; v < camera_.resolution.height; ++v) {
        const Eigen::Matrix3f turn = (T_w_c.R.transpose() * pose_of_row(v).R).cast<float>();
        for (int u = 0; u < width; ++u) {
          const size_t k = 1UL * width * v + u;
          const Vector3f& ray = rays_[k];
          if (std::isnan(ray.x())) {
            background[k] += share * kUnseen;
          } else if (scene.DepthAt(ray) < kOnTheHand) {
            background[k] += share * scene.GreyAt(ray);
          } else {
            background[k] += share * scene.GreyAt(turn * ray);
          }
        }
      }
    }
    if (look_.blur_px > 0.0) {
      background = Blurred(background, camera_.resolution, 1, look_.blur_px);
    }
    return background;
  }

  // The board over the background, but for what is before the board.
  Exposure Composed(const BoardLayer& layer, const SceneImage& image, const Rigid3& T_w_c,
                    const std::vector<PoseOfRow>& camera, const Rigid3& T_c_g) const {
    const PinholeSampler scene(image, pinhole_);
    const std::vector<float> background = Background(scene, T_w_c, camera);
    const Vector3f normal = T_c_g.R.col(2).cast<float>();
    const float offset = static_cast<float>(T_c_g.R.col(2).dot(T_c_g.t));
    Exposure exposure{camera_.resolution, std::vector<float>(rays_.size())};
    for (size_t k = 0; k < rays_.size(); ++k) {
      bool is_hidden = false;
      if (layer.coverage[k] > 0.0F && !std::isnan(rays_[k].x())) {
        const float board_depth = offset / normal.dot(rays_[k]);
        is_hidden = scene.DepthAt(rays_[k]) < board_depth - static_cast<float>(kDepthTolerance);
      }
      exposure.pixels[k] = is_hidden
                               ? background[k]
                               : layer.light.pixels[k] + (1.0F - layer.coverage[k]) * background[k];
    }
    return exposure;
  }

  Rig rig_;
  const Camera& camera_;
  HeadlessGl gl_;  // before the view, which draws with it
  ArmScene scene_;
  SceneView view_;
  std::vector<Vector3f> rays_;
  PinholeView pinhole_;
  BoardPattern pattern_;
  Eigen::Matrix3Xd points_g_;
  Scene look_;
};

RenderedCamera::RenderedCamera(const Rig& rig) : parts_(std::make_unique<Parts>(rig)) {}
RenderedCamera::~RenderedCamera() = default;

GreyImage RenderedCamera::Take(const CarrierPath& path, double t_s, Rng& noise) const {
  return parts_->Take(path, {t_s, parts_->exposure_s()}, noise);
}

GreyImage RenderedCamera::Take(const CarrierPath& path, const FrameExposure& exposure,
                               Rng& noise) const {
  return parts_->Take(path, exposure, noise);
}

int SimulateImages(const Rig& rig, const CarrierPath& path, Time start, const Rng& rng,
                   const std::function<void(SimulatedImage)>& sink) {
  const RenderedCamera camera(rig);
  const Duration end = Duration::FromSeconds(path.duration_s);
  int num_dropped = 0;
  Progress progress("rendering",
                    static_cast<int64_t>(std::ceil(path.duration_s * rig.camera_rate_hz)));
  for (int64_t k = 0;; ++k) {
    const Duration elapsed = Duration::FromSeconds(static_cast<double>(k) / rig.camera_rate_hz);
    if (!(elapsed < end)) break;
    progress.Advance();
    Rng noise = rng.Stream("image", static_cast<uint64_t>(k));
    // Drawn for every setting alike.
    const bool is_dropped = noise.Uniform() < rig.image_disturbances.drop_probability;
    const double jitter_s = StampJitter(rig, noise.Normal());
    if (is_dropped) {
      ++num_dropped;
      continue;
    }
    const FrameExposure exposure = ExposureOfFrame(rig, elapsed.seconds());
    sink({start + elapsed + Duration::FromSeconds(jitter_s), exposure.middle_s,
          camera.Take(path, exposure, noise)});
  }
  return num_dropped;
}

}  // namespace calibrato
