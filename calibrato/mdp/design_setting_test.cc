#include "calibrato/mdp/design_setting.h"

#include <gtest/gtest.h>

#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

TEST(AsEstimated, AddsTheDistortionThatIsEstimated) {
  Rig rig = PaperRig();
  const Eigen::Vector4d intrinsics = rig.cameras[0].model.focal_and_centre();
  Eigen::VectorXd radtan(8);
  radtan << intrinsics, 0.1, -0.2, 1e-3, 2e-3;
  rig.cameras[0].model = CameraModel("pinhole-radtan", radtan);
  const CameraModel estimated = AsEstimated(rig).cameras[0].model;
  EXPECT_EQ(estimated.name(), "pinhole-radtan5");
  // The same lens: the same pixels.
  const Eigen::Vector3d point(0.2, -0.3, 1.0);
  EXPECT_EQ(*estimated.Project(point), *rig.cameras[0].model.Project(point));

  Eigen::VectorXd fisheye(8);
  fisheye << intrinsics, 0.01, 0.0, 0.0, 0.0;
  rig.cameras[0].model = CameraModel("pinhole-equi", fisheye);
  EXPECT_EQ(AsEstimated(rig).cameras[0].model.parameters(), fisheye);
}

TEST(BelievedRigs, BeginWithTheNominalOne) {
  const std::vector<Rig> rigs = BelievedRigs(RigDistribution::kPaper, 3, Rng(5));
  ASSERT_EQ(rigs.size(), 4U);
  EXPECT_EQ(rigs[0].cameras[0].model.focal_and_centre(),
            PaperRig().cameras[0].model.focal_and_centre());
  for (const Rig& rig : rigs) EXPECT_EQ(rig.cameras[0].model.name(), "pinhole-radtan5");
  EXPECT_NE(rigs[1].cameras[0].model.parameters(), rigs[2].cameras[0].model.parameters());
}

TEST(BelievedRigs, StandBeforeTheBoardOfTheNominalOne) {
  Rig nominal = PaperRig();
  nominal.T_w_g.t += Eigen::Vector3d(0.1, -0.2, 0.05);
  nominal.T_e_c0.t.x() += 0.03;
  const Eigen::Vector3d middle_w = nominal.T_w_g * BoardCentre(nominal.board);
  const auto rigs = BelievedRigs(RigDistribution::kBroad, 3, Rng(5), nominal);
  for (const Rig& rig : rigs) {
    EXPECT_LT((rig.T_w_g * BoardCentre(rig.board) - middle_w).norm(), 1e-12);
    EXPECT_EQ(rig.T_e_c0.t, nominal.T_e_c0.t);
  }
}

// Numbers of the paper, and the stretching of its first loop by 2 rad/s.
TEST(BudgetOf, IsThatOfTheExecution) {
  const MotionBudget budget = BudgetOf(HandcraftedMotion(Task::kIntrinsic), PaperRig());
  EXPECT_NEAR(budget.path_m, 11.3641, 1e-3);
  EXPECT_GT(budget.duration_s, 20.5);
  EXPECT_LT(budget.duration_s, 22.0);
}

}  // namespace
}  // namespace calibrato
