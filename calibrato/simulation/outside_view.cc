#include "calibrato/simulation/outside_view.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calibrato/rendering/render_board.h"
#include "calibrato/simulation/scene_view.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

// Behind the arm and to its side, so that arm and board's front are seen.
Rigid3 BystanderInWorld() {
  const Vector3d eye(0.75, 1.75, 1.25);
  const Vector3d target(-1.0, -0.15, 0.32);
  Rigid3 T_w_c;
  T_w_c.R.col(2) = (target - eye).normalized();
  T_w_c.R.col(0) = T_w_c.R.col(2).cross(Vector3d::UnitZ()).normalized();
  T_w_c.R.col(1) = T_w_c.R.col(2).cross(T_w_c.R.col(0));
  T_w_c.t = eye;
  return T_w_c;
}

constexpr double kHalfWidthTangent = 0.62;

Camera Pinhole() {
  const auto [width, height] = OutsideView::kResolution;
  const double f = 0.5 * width / kHalfWidthTangent;
  return {CameraModel("pinhole-none", Eigen::Vector4d(f, f, 0.5 * (width - 1), 0.5 * (height - 1))),
          OutsideView::kResolution, "", std::nullopt};
}

}  // namespace

class OutsideView::Parts {
 public:
  explicit Parts(const Rig& rig)
      : scene_(rig), view_(scene_, gl_), T_c_g_(T_w_c_.Inverse() * rig.T_w_g) {
    const Rigid3 T_c_g = T_c_g_;
    board_ = RenderBoardLayer(PatternOf(rig.board), camera_, {[T_c_g](double) { return T_c_g; }},
                              Scene());
  }

  RgbImage Draw(const CarrierPath& path, double t_s) {
    const auto [width, height] = kResolution;
    const PinholeView pinhole{kResolution, kHalfWidthTangent, kHalfWidthTangent * height / width};
    const std::optional<JointVector> joints =
        path.joints ? std::optional(path.joints(t_s)) : std::nullopt;
    const SceneImage scene =
        view_.Draw(T_w_c_, pinhole, joints, {.shows_housings = true, .has_shadows = true});
    RgbImage image{kResolution, scene.rgb};
    const Vector3d normal = T_c_g_.R.col(2);
    const double offset = normal.dot(T_c_g_.t);
    for (size_t k = 0; k < scene.depth.size(); ++k) {
      const float coverage = board_.coverage[k];
      if (coverage == 0.0F) continue;
      const int u = static_cast<int>(k) % width;
      const int v = static_cast<int>(k) / width;
      const Vector3d ray((2.0 * u + 1.0 - width) / width * kHalfWidthTangent,
                         (2.0 * v + 1.0 - height) / width * kHalfWidthTangent, 1.0);
      constexpr double kTolerance = 0.02;  // [m]
      if (scene.depth[k] < offset / normal.dot(ray) - kTolerance) continue;
      for (size_t channel = 0; channel < 3; ++channel) {
        uint8_t& pixel = image.pixels[3 * k + channel];
        pixel = static_cast<uint8_t>(
            std::lround(board_.light.pixels[k] + (1.0F - coverage) * static_cast<float>(pixel)));
      }
    }
    return image;
  }

 private:
  HeadlessGl gl_;
  ArmScene scene_;
  SceneView view_;
  Camera camera_ = Pinhole();
  Rigid3 T_w_c_ = BystanderInWorld();
  Rigid3 T_c_g_;
  BoardLayer board_;
};

OutsideView::OutsideView(const Rig& rig) : parts_(std::make_unique<Parts>(rig)) {}
OutsideView::~OutsideView() = default;

RgbImage OutsideView::Draw(const CarrierPath& path, double t_s) const {
  return parts_->Draw(path, t_s);
}

RgbImage SideBySide(const RgbImage& left, const GreyImage& right) {
  const int height = left.resolution.height;
  const double scale = std::max(1.0, static_cast<double>(right.resolution.height) / height);
  const int right_width = static_cast<int>(right.resolution.width / scale);
  const int top = (height - static_cast<int>(right.resolution.height / scale)) / 2;
  const int width = left.resolution.width + right_width;
  RgbImage both{{width, height}, std::vector<uint8_t>(3UL * width * height, 0)};
  for (int v = 0; v < height; ++v) {
    uint8_t* row = both.pixels.data() + 3UL * width * v;
    std::copy_n(left.pixels.data() + 3UL * left.resolution.width * v, 3 * left.resolution.width,
                row);
    const int from_v = static_cast<int>((v - top) * scale);
    if (v < top || from_v >= right.resolution.height) continue;
    for (int u = 0; u < right_width; ++u) {
      const uint8_t grey =
          right.pixels[1UL * right.resolution.width * from_v + static_cast<size_t>(u * scale)];
      std::fill_n(row + 3L * (left.resolution.width + u), 3, grey);
    }
  }
  return both;
}

}  // namespace calibrato
