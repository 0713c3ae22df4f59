#include "calibrato/simulation/scene_view.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cassert>
#include <mutex>
#include <shared_mutex>

namespace calibrato {
namespace {

// Making a context looks all of OpenGL's functions up anew, for all threads: nobody draws
// meanwhile.
std::shared_mutex functions_of_opengl;

constexpr int kMaxGeoms = 300;
constexpr double kNear = 0.01;  // [m]
constexpr double kFar = 10.0;   // [m]

// The groups of models/panda.xml.
constexpr int kHousings = 1;
constexpr int kArm = 2;
constexpr int kBoard = 3;

// MuJoCo's cameras look along forward, with up to the top.
void SetCamera(const Rigid3& T_w_c, const PinholeView& view, mjvGLCamera* camera) {
  for (int i = 0; i < 3; ++i) {
    camera->pos[i] = static_cast<float>(T_w_c.t[i]);
    camera->forward[i] = static_cast<float>(T_w_c.R(i, 2));
    camera->up[i] = static_cast<float>(-T_w_c.R(i, 1));
  }
  // Its width follows from the viewport, whose sides are as the tangents.
  camera->frustum_center = 0.0F;
  camera->frustum_top = static_cast<float>(kNear * view.half_height_tangent);
  camera->frustum_bottom = -camera->frustum_top;
  camera->frustum_near = static_cast<float>(kNear);
  camera->frustum_far = static_cast<float>(kFar);
}

}  // namespace

struct SceneView::Parts {
  const ArmScene& scene;
  const HeadlessGl& gl;
  mjvScene drawn;
  mjrContext context;
};

SceneView::SceneView(const ArmScene& scene, const HeadlessGl& gl)
    : parts_(new Parts{scene, gl, {}, {}}) {
  const std::unique_lock alone(functions_of_opengl);
  gl.MakeCurrent();
  mjv_defaultScene(&parts_->drawn);
  mjv_makeScene(scene.model(), &parts_->drawn, kMaxGeoms);
  mjr_defaultContext(&parts_->context);
  mjr_makeContext(scene.model(), &parts_->context, mjFONTSCALE_100);
  mjr_setBuffer(mjFB_OFFSCREEN, &parts_->context);
}

SceneView::~SceneView() {
  const std::unique_lock alone(functions_of_opengl);
  parts_->gl.MakeCurrent();
  mjr_freeContext(&parts_->context);
  mjv_freeScene(&parts_->drawn);
}

SceneImage SceneView::Draw(const Rigid3& T_w_c, const PinholeView& view,
                           const std::optional<JointVector>& joints,
                           const SceneViewOptions& options) {
  const mjModel* model = parts_->scene.model();
  mjData* data = parts_->scene.data();
  const auto [width, height] = view.resolution;
  assert(width <= model->vis.global.offwidth && height <= model->vis.global.offheight);
  if (joints) Eigen::Map<JointVector>(data->qpos) = *joints;
  mj_kinematics(model, data);
  mj_camlight(model, data);

  mjvOption option;
  mjv_defaultOption(&option);
  option.geomgroup[kHousings] = options.shows_housings ? 1 : 0;
  option.geomgroup[kArm] = joints ? 1 : 0;
  option.geomgroup[kBoard] = 0;
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  mjvScene* drawn = &parts_->drawn;
  mjv_updateScene(model, data, &option, nullptr, &camera, mjCAT_ALL, drawn);
  for (mjvGLCamera& eye : drawn->camera) SetCamera(T_w_c, view, &eye);
  const std::shared_lock with_others(functions_of_opengl);
  parts_->gl.MakeCurrent();
  drawn->flags[mjRND_SHADOW] = options.has_shadows ? 1 : 0;
  drawn->flags[mjRND_REFLECTION] = 0;
  const mjrRect viewport{0, 0, width, height};
  mjr_render(viewport, drawn, &parts_->context);

  SceneImage image{view.resolution, std::vector<uint8_t>(3UL * width * height),
                   std::vector<float>(1UL * width * height)};
  mjr_readPixels(image.rgb.data(), image.depth.data(), viewport, &parts_->context);
  // OpenGL's rows run upwards, and its depth is not linear.
  for (int low = 0, high = height - 1; low < high; ++low, --high) {
    std::swap_ranges(image.rgb.begin() + 3L * width * low,
                     image.rgb.begin() + 3L * width * (low + 1),
                     image.rgb.begin() + 3L * width * high);
    std::swap_ranges(image.depth.begin() + 1L * width * low,
                     image.depth.begin() + 1L * width * (low + 1),
                     image.depth.begin() + 1L * width * high);
  }
  for (float& depth : image.depth) {
    depth = static_cast<float>(kNear * kFar / (kFar - depth * (kFar - kNear)));
  }
  return image;
}

}  // namespace calibrato
