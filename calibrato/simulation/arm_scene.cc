#include "calibrato/simulation/arm_scene.h"

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <mutex>
#include <string>

#include "calibrato/base/input_error.h"
#include "calibrato/motion/arm_clearance.h"
#include "calibrato/motion/carrier.h"

// Compiled in by arm_scene.s.in.
extern "C" {
extern const char calibrato_arm_scene[];
extern const char calibrato_arm_scene_end[];
}

namespace calibrato {
namespace {

using Eigen::Vector3d;

constexpr const char* kFileName = "scene.xml";

std::string OneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

InputError BadScene(const std::string& why) {
  return InputError({"bad scene of the arm", "models/panda.xml", why,
                     "take the file as it comes with calibrato"});
}

// Else MuJoCo writes warnings into a file where it runs, and at an error waits for a key and ends
// the program. What it warns of while the arm moves it counts as well (arm_execution.cc).
void TakeOverWarningsAndErrors() {
  static std::once_flag done;
  std::call_once(done, [] {
    mju_user_warning = [](const char*) {};
    mju_user_error = [](const char* what) {
      throw InputError({"MuJoCo gives up", "", OneLine(what), "--fidelity fast does without it"});
    };
  });
}

mjModel* Compiled(std::string_view xml) {
  // MuJoCo keeps the file that it read last for all threads.
  static std::mutex reading;
  const std::scoped_lock alone(reading);
  if (xml.empty()) throw BadScene("it is empty");
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  if (mj_makeEmptyFileVFS(files.get(), kFileName, static_cast<int>(xml.size())) != 0) {
    throw BadScene("it is too large");
  }
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), kFileName)], xml.data(), xml.size());
  std::array<char, 500> error{};
  mjModel* model = mj_loadXML(kFileName, files.get(), error.data(), static_cast<int>(error.size()));
  mj_deleteVFS(files.get());
  if (model == nullptr) {
    throw BadScene(OneLine(error.data()));
  }
  return model;
}

int IdOf(const mjModel* model, mjtObj type, const char* name) {
  const int id = mj_name2id(model, type, name);
  if (id < 0) throw BadScene(std::string("nothing in it is called '") + name + "'");
  return id;
}

void SetPose(const Rigid3& T, double* position, double* quaternion) {
  std::copy_n(T.t.data(), 3, position);
  const std::array<double, 4> q = MujocoQuaternion(T.R);
  std::copy(q.begin(), q.end(), quaternion);
}

void SetBox(const mjModel* model, const char* name, const Box& box) {
  const int body = IdOf(model, mjOBJ_BODY, name);
  const int geom = IdOf(model, mjOBJ_GEOM, name);
  SetPose(ArmBaseInWorld() * box.T_b_box, model->body_pos + 3 * body, model->body_quat + 4 * body);
  std::copy_n(box.half_size.data(), 3, model->geom_size + 3 * geom);
  model->geom_rbound[geom] = box.half_size.norm();
}

void PlaceRig(const Rig& rig, const mjModel* model) {
  for (const NamedBox& thing : SurroundingsOf(rig)) {
    if (thing.name != "table") SetBox(model, thing.name.c_str(), thing.box);
  }
  // A capsule along z of its body, longer at its far end; the second size is half its length.
  const int finger = IdOf(model, mjOBJ_GEOM, "right finger");
  model->geom_pos[3 * finger + 2] += 0.5 * rig.finger_reach_m;
  model->geom_size[3 * finger + 1] += 0.5 * rig.finger_reach_m;
  model->geom_rbound[finger] += 0.5 * rig.finger_reach_m;
  const Rigid3 T_e_i = rig.T_e_c0 * rig.T_c0_i;
  // What lay on its body's own frame when the file was compiled would stay there, but for the flag.
  const int imu = IdOf(model, mjOBJ_SITE, "imu");
  SetPose(T_e_i, model->site_pos + 3 * imu, model->site_quat + 4 * imu);
  model->site_sameframe[imu] = 0;
  const auto set_housing = [&](int geom, const Rigid3& T_e_housing) {
    SetPose(T_e_housing, model->geom_pos + 3 * geom, model->geom_quat + 4 * geom);
    model->geom_sameframe[geom] = 0;
  };
  set_housing(IdOf(model, mjOBJ_GEOM, "imu housing"), T_e_i);
  // Behind the lens.
  const int camera_housing = IdOf(model, mjOBJ_GEOM, "camera housing");
  const double depth = model->geom_size[3 * camera_housing + 2];
  set_housing(camera_housing, rig.T_e_c0 * Rigid3{Eigen::Matrix3d::Identity(), {0.0, 0.0, -depth}});
}

}  // namespace

std::string_view ArmSceneXml() {
  return {calibrato_arm_scene, static_cast<size_t>(calibrato_arm_scene_end - calibrato_arm_scene)};
}

ArmScene::ArmScene(const Rig& rig, std::string_view xml) {
  TakeOverWarningsAndErrors();
  model_ = Compiled(xml);
  try {
    for (int i = 1; i <= 7; ++i) {
      const std::string number = std::to_string(i);
      if (IdOf(model_, mjOBJ_JOINT, ("joint" + number).c_str()) != i - 1 ||
          IdOf(model_, mjOBJ_ACTUATOR, ("motor" + number).c_str()) != i - 1) {
        throw BadScene("its joints and motors must be joint1, motor1 .. joint7, motor7 in order");
      }
    }
    for (const char* name : {"gyroscope", "accelerometer"}) {
      (void)IdOf(model_, mjOBJ_SENSOR, name);
    }
    (void)IdOf(model_, mjOBJ_BODY, "flange");
    if (model_->nq != 7 || model_->nu != 7) throw BadScene("it must have seven joints");
    PlaceRig(rig, model_);
    data_ = mj_makeData(model_);
  } catch (...) {
    mj_deleteModel(model_);
    throw;
  }
}

ArmScene::~ArmScene() {
  mj_deleteData(data_);
  mj_deleteModel(model_);
}

std::array<double, 4> MujocoQuaternion(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return {q.w(), q.x(), q.y(), q.z()};
}

Eigen::Matrix3d FromMujocoMatrix(const double* rows) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows);
}

}  // namespace calibrato
