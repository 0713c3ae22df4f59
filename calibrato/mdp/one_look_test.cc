#include "calibrato/mdp/one_look.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/rng.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

// What camera 0 sees of the paper's board from this pose, with noise.
BoardView Seen(const Rig& rig, const Rigid3& T_c0_g, double noise_px, Rng& rng) {
  BoardView view;
  view.points_g = BoardPoints(rig.board);
  view.pixels.resize(2, view.points_g.cols());
  for (Eigen::Index k = 0; k < view.points_g.cols(); ++k) {
    view.corner_ids.push_back(static_cast<int>(k));
    view.pixels.col(k) = rig.cameras[0].model.Project(T_c0_g * view.points_g.col(k)).value();
    for (int i = 0; i < 2; ++i) view.pixels(i, k) += noise_px * rng.Normal();
  }
  return view;
}

Rigid3 BaseInArm() { return LoopPoseAt(BasePose(), LoopCoefficients::Zero(), 0.0); }

Rigid3 TrueLook(const Rig& rig) {
  return (ArmBaseInWorld() * BaseInArm() * rig.T_e_c0).Inverse() * rig.T_w_g;
}

TEST(OneLook, FindsTheBoardAndPutsItThere) {
  const Rig rig = PaperRig();
  Rng rng(3);
  const Rigid3 truth = TrueLook(rig);
  const auto look = LookAtBoard(rig.cameras[0].model, Seen(rig, truth, 0.0, rng));
  ASSERT_TRUE(look.has_value());
  EXPECT_LT(truth.DifferenceTo(look->T_c0_g).norm(), 1e-7);
  EXPECT_EQ(look->num_corners, 42);
  Rig elsewhere = rig;
  elsewhere.T_w_g.t += Eigen::Vector3d(0.3, 0.2, 0.1);
  const Rig placed = WithBoardAsSeen(elsewhere, BaseInArm(), look->T_c0_g);
  EXPECT_LT(rig.T_w_g.DifferenceTo(placed.T_w_g).norm(), 1e-7);
}

// Errors of many looks against what each of them states: a chi-square variable of six dimensions
// has that mean. Residuals tell the noise, of which the look knows nothing.
TEST(OneLook, StatesItsOwnError) {
  const Rig rig = PaperRig();
  const Rigid3 truth = TrueLook(rig);
  Rng rng(4);
  constexpr int kNumLooks = 200;
  double rotation = 0.0;
  double translation = 0.0;
  for (int i = 0; i < kNumLooks; ++i) {
    const auto look = LookAtBoard(rig.cameras[0].model, Seen(rig, truth, 0.3, rng));
    ASSERT_TRUE(look.has_value());
    EXPECT_NEAR(look->reprojection_rms_px, 0.3 * std::sqrt(2.0), 0.15);
    const Eigen::Matrix<double, 6, 1> error = truth.DifferenceTo(look->T_c0_g);
    rotation += std::pow(error.head<3>().norm() / look->rotation_sigma_rad, 2);
    translation += std::pow(error.tail<3>().norm() / look->translation_sigma_m, 2);
  }
  // Each sum is dominated by one or two directions: standard deviation of a mean about 0.1.
  EXPECT_NEAR(rotation / kNumLooks, 1.0, 0.35);
  EXPECT_NEAR(translation / kNumLooks, 1.0, 0.35);
}

TEST(OneLook, IsNoneOfPointsOnALine) {
  const Rig rig = PaperRig();
  Rng rng(5);
  const BoardView whole = Seen(rig, TrueLook(rig), 0.0, rng);
  BoardView line = whole;
  line.corner_ids.resize(7);
  line.pixels = whole.pixels.leftCols(7);
  line.points_g = whole.points_g.leftCols(7);
  EXPECT_FALSE(LookAtBoard(rig.cameras[0].model, line).has_value());
}

}  // namespace
}  // namespace calibrato
