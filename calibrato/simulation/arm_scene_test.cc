#include "calibrato/simulation/arm_scene.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "calibrato/base/input_error.h"
#include "calibrato/base/rng.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/motion/arm_clearance.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/panda_dynamics.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

JointVector DrawWithinLimits(Rng& rng) {
  JointVector q;
  for (int i = 0; i < 7; ++i) {
    q[i] = Limits().lower[i] + (Limits().upper[i] - Limits().lower[i]) * rng.Uniform();
  }
  return q;
}

JointVector DrawNormal(double stddev, Rng& rng) {
  JointVector x;
  for (double& value : x) value = stddev * rng.Normal();
  return x;
}

Rigid3 PoseOf(const double* position, const double* rows) {
  return {FromMujocoMatrix(rows), Eigen::Map<const Vector3d>(position)};
}

TEST(ArmScene, StandsWhereOurKinematicsSay) {
  const Rig rig = PaperRig();
  const ArmScene scene(rig);
  const mjModel* model = scene.model();
  mjData* data = scene.data();
  Rng rng(1);
  const int flange = mj_name2id(model, mjOBJ_BODY, "flange");
  const int imu = mj_name2id(model, mjOBJ_SITE, "imu");
  for (int i = 0; i < 20; ++i) {
    const JointVector q = DrawWithinLimits(rng);
    Eigen::Map<JointVector>(data->qpos) = q;
    mj_kinematics(model, data);
    const Rigid3 T_w_e = ArmBaseInWorld() * PandaPose(q, nullptr);
    EXPECT_LT(PoseOf(data->xpos + 3 * flange, data->xmat + 9 * flange).DifferenceTo(T_w_e).norm(),
              1e-9);
    EXPECT_LT(PoseOf(data->site_xpos + 3 * imu, data->site_xmat + 9 * imu)
                  .DifferenceTo(T_w_e * rig.T_e_c0 * rig.T_c0_i)
                  .norm(),
              1e-9);
  }
}

TEST(ArmScene, NeedsTheTorquesThatOurDynamicsSay) {
  const ArmScene scene(PaperRig());
  mjModel* model = scene.model();
  mjData* data = scene.data();
  model->opt.disableflags |= mjDSBL_CONSTRAINT;
  Rng rng(2);
  for (int i = 0; i < 20; ++i) {
    const JointVector q = DrawWithinLimits(rng);
    const JointVector velocity = DrawNormal(1.0, rng);
    const JointVector acceleration = DrawNormal(3.0, rng);
    Eigen::Map<JointVector>(data->qpos) = q;
    Eigen::Map<JointVector>(data->qvel) = velocity;
    Eigen::Map<JointVector>(data->qacc) = acceleration;
    mj_inverse(model, data);
    const JointVector expected = PandaTorque(q, velocity, acceleration);
    EXPECT_LT((Eigen::Map<const JointVector>(data->qfrc_inverse) - expected).norm(),
              1e-7 * expected.norm());
  }
}

TEST(ArmScene, TouchesTheThingsAroundItWhereOurShapesSay) {
  // The board within reach, so that it is touched too.
  Rig rig = PaperRig();
  rig.T_w_g.t.x() += 1.45;
  const ArmScene scene(rig);
  const mjModel* model = scene.model();
  mjData* data = scene.data();
  const std::vector<NamedBox> things = SurroundingsOf(rig);
  Rng rng(3);
  int num_touching = 0;
  for (int i = 0; i < 5000; ++i) {
    const JointVector q = DrawWithinLimits(rng);
    Eigen::Map<JointVector>(data->qpos) = q;
    mj_kinematics(model, data);
    mj_comPos(model, data);
    mj_collision(model, data);
    double depth = 0.0;
    for (int k = 0; k < data->ncon; ++k) depth = std::max(depth, -data->contact[k].dist);
    const PandaAxes axes = AxesOf(q);
    double least = 1.0;
    bool is_pierced = false;  // MuJoCo overlooks some lines that go right through a thin box
    for (const ArmPart& part : ArmParts()) {
      const Rigid3& T = part.link == 8 ? axes.T_b_e : axes.T_b_link[part.link - 1];
      const Capsule capsule{T * part.capsule.a, T * part.capsule.b, part.capsule.radius_m};
      for (const NamedBox& thing : things) {
        const double distance = Distance(capsule, thing.box);
        least = std::min(least, distance);
        is_pierced |= distance + capsule.radius_m < 0.0;
      }
    }
    constexpr double kUndecided = 1e-4;
    if (std::abs(least) > kUndecided && !is_pierced) {
      EXPECT_EQ(depth > 0.0, least < 0.0) << least;
    }
    num_touching += depth > 0.0 && !is_pierced ? 1 : 0;
  }
  EXPECT_GT(num_touching, 100);
  EXPECT_LT(num_touching, 4900);
}

TEST(ArmScene, MotorsEndWhereTheDataSheetSays) {
  const ArmScene scene(PaperRig());
  const mjModel* model = scene.model();
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(model->jnt_range[2 * i], Limits().lower[i]);
    EXPECT_EQ(model->jnt_range[2 * i + 1], Limits().upper[i]);
    EXPECT_EQ(model->actuator_ctrlrange[2 * i], -Limits().torque[i]);
    EXPECT_EQ(model->actuator_ctrlrange[2 * i + 1], Limits().torque[i]);
  }
}

TEST(ArmScene, RefusesAFileThatIsCorruptOrLacksAPart) {
  const std::string xml(ArmSceneXml());
  const auto expect_refused = [](const std::string& text, const std::string& why) {
    try {
      const ArmScene scene(PaperRig(), text);
      FAIL() << why;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  };
  expect_refused(xml.substr(0, xml.size() / 2), "models/panda.xml");
  expect_refused("", "empty");
  std::string renamed = xml;
  renamed.replace(renamed.find("name=\"gyroscope\""), 16, "name=\"something\"");
  expect_refused(renamed, "'gyroscope'");
}

TEST(MujocoQuaternion, HasTheScalarFirst) {
  const Eigen::Matrix3d R = ExpSo3({0.0, 0.0, 1.0});
  const std::array<double, 4> q = MujocoQuaternion(R);
  EXPECT_NEAR(q[0], std::cos(0.5), 1e-15);
  EXPECT_NEAR(q[3], std::sin(0.5), 1e-15);
  std::array<double, 9> rows{};
  mju_quat2Mat(rows.data(), q.data());
  EXPECT_LT((FromMujocoMatrix(rows.data()) - R).norm(), 1e-15);
}

}  // namespace
}  // namespace calibrato
