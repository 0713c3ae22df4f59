#include "calibrato/simulation/rig_distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/rpy.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/sensors/effects.h"

namespace calibrato {
namespace {

TEST(DrawRig, FollowsTable4) {
  constexpr int kNumRigs = 4000;
  Rng rng(1);
  Eigen::Matrix<double, 7, 1> sum = Eigen::Matrix<double, 7, 1>::Zero();
  Eigen::Matrix<double, 7, 1> sum_of_squares = sum;
  for (int i = 0; i < kNumRigs; ++i) {
    const Rig rig = DrawRig(RigDistribution::kPaperUndistorted, rng);
    Eigen::Matrix<double, 7, 1> x;
    x << 2.0 * std::atan(320.0 / rig.cameras[0].model.focal_and_centre()(0)), rig.T_c0_i.t,
        RpyFromRotation(rig.T_c0_i.R);
    sum += x;
    sum_of_squares += x.cwiseAbs2();
  }
  const Eigen::Matrix<double, 7, 1> mean = sum / kNumRigs;
  const Eigen::Matrix<double, 7, 1> stddev =
      (sum_of_squares / kNumRigs - mean.cwiseAbs2()).cwiseSqrt();
  Eigen::Matrix<double, 7, 1> expected_mean;
  Eigen::Matrix<double, 7, 1> expected_stddev;
  expected_mean << 1.0, 0.06, 0.0, -0.10, 0.0, 0.0, 1.5708;
  expected_stddev << 0.05, 0.01, 0.01, 0.01, 0.1, 0.1, 0.1;
  for (int i = 0; i < 7; ++i) {
    // Four standard errors of the mean, and of the standard deviation.
    EXPECT_NEAR(mean(i), expected_mean(i), 4.0 * expected_stddev(i) / std::sqrt(kNumRigs)) << i;
    EXPECT_NEAR(stddev(i), expected_stddev(i), 4.0 * expected_stddev(i) / std::sqrt(2.0 * kNumRigs))
        << i;
  }
}

TEST(DrawRig, DistortedLensesSeeTheWholeImage) {
  Rng rng(2);
  double sum_of_squares = 0.0;
  for (int i = 0; i < 300; ++i) {
    const Rig rig = DrawRig(RigDistribution::kPaper, rng);
    EXPECT_TRUE(CoversImage(rig.cameras[0].model, rig.cameras[0].resolution));
    sum_of_squares += std::pow(rig.cameras[0].model.parameters()(4), 2);
  }
  EXPECT_NEAR(std::sqrt(sum_of_squares / 300), 0.1, 0.02);
}

TEST(DrawRig, UndistortedLensesDoNotDistort) {
  Rng rng(3);
  const Rig rig = DrawRig(RigDistribution::kPaperUndistorted, rng);
  EXPECT_EQ(rig.cameras[0].model.parameters().tail<5>().norm(), 0.0);
}

TEST(RigDistribution, NamesRoundTrip) {
  for (const char* name : {"paper", "paper-undistorted", "broad", "paper-real", "broad-real"}) {
    EXPECT_EQ(RigDistributionName(RigDistributionFromName(name)), name);
  }
  EXPECT_THROW((void)RigDistributionFromName("papers"), InputError);
}

// n draws, uniform in +-half_width: within it, and mean and variance within four standard errors.
void ExpectUniform(const std::vector<double>& draws, double middle, double half_width) {
  const auto n = static_cast<double>(draws.size());
  double sum = 0.0;
  double squares = 0.0;
  for (const double x : draws) {
    EXPECT_LE(std::abs(x - middle), half_width * (1.0 + 1e-9));
    sum += x - middle;
    squares += (x - middle) * (x - middle);
  }
  const double variance = half_width * half_width / 3.0;
  EXPECT_NEAR(sum / n, 0.0, 4.0 * std::sqrt(variance / n));
  // Of the square of a uniform variable the variance is 4/45 half_width^4.
  EXPECT_NEAR(squares / n, variance, 4.0 * half_width * half_width * std::sqrt(4.0 / 45.0 / n));
}

std::vector<Rig> DrawBroad(int num_rigs, uint64_t seed) {
  Rng rng(seed);
  std::vector<Rig> rigs;
  for (int i = 0; i < num_rigs; ++i) rigs.push_back(DrawRig(RigDistribution::kBroad, rng));
  return rigs;
}

TEST(DrawRig, BroadLensesAreOfAllAnglesAndAQuarterAreFisheyes) {
  constexpr int kNumRigs = 1000;
  std::vector<double> pinholes;
  std::vector<double> fisheyes;
  for (const Rig& rig : DrawBroad(kNumRigs, 4)) {
    const Camera& camera = rig.cameras[0];
    EXPECT_TRUE(CoversImage(camera.model, camera.resolution));
    const double f = camera.model.focal_and_centre()(0);
    if (camera.model.name() == "pinhole-equi") {
      fisheyes.push_back(640.0 / f);
    } else {
      EXPECT_EQ(camera.model.name(), "pinhole-radtan5");
      pinholes.push_back(2.0 * std::atan(320.0 / f));
    }
  }
  const auto num_fisheyes = static_cast<double>(fisheyes.size());
  EXPECT_NEAR(num_fisheyes, 0.25 * kNumRigs, 4.0 * std::sqrt(0.1875 * kNumRigs));
  ExpectUniform(pinholes, 1.15, 0.45);
  ExpectUniform(fisheyes, 2.0, 0.4);
}

TEST(DrawRig, BroadScenesHaveBothBoardsAndAreMovedAsFarAsStated) {
  constexpr int kNumRigs = 1000;
  const Rig paper = PaperRig();
  const Eigen::Vector3d papers_middle_w = paper.T_w_g * BoardCentre(paper.board);
  std::vector<double> board_shifts;
  std::vector<double> board_turns;
  std::vector<double> mount_shifts;
  std::vector<double> mount_turns;
  int num_tags = 0;
  for (const Rig& rig : DrawBroad(kNumRigs, 5)) {
    num_tags += std::holds_alternative<AprilGrid>(rig.board) ? 1 : 0;
    const Eigen::Vector3d board = rig.T_w_g * BoardCentre(rig.board) - papers_middle_w;
    const Eigen::Vector3d mount = rig.T_e_c0.t - paper.T_e_c0.t;
    const Eigen::Vector3d turn = RpyFromRotation(paper.T_w_g.R.transpose() * rig.T_w_g.R);
    const Eigen::Vector3d twist = RpyFromRotation(paper.T_e_c0.R.transpose() * rig.T_e_c0.R);
    for (int i = 0; i < 3; ++i) {
      board_shifts.push_back(board(i));
      board_turns.push_back(turn(i));
      mount_shifts.push_back(mount(i));
      mount_turns.push_back(twist(i));
    }
  }
  EXPECT_NEAR(num_tags, 0.5 * kNumRigs, 4.0 * std::sqrt(0.25 * kNumRigs));
  ExpectUniform(board_shifts, 0.0, 0.05);
  ExpectUniform(board_turns, 0.0, 10.0 * std::numbers::pi / 180.0);
  ExpectUniform(mount_shifts, 0.0, 0.02);
  ExpectUniform(mount_turns, 0.0, 5.0 * std::numbers::pi / 180.0);
}

TEST(DrawRig, BroadImusAreOfAllGradesAndOffsets) {
  constexpr int kNumRigs = 2000;
  const ImuNoise paper;
  std::vector<double> offsets;
  double log_sum = 0.0;
  double least = 100.0;
  double most = 0.0;
  for (const Rig& rig : DrawBroad(kNumRigs, 6)) {
    const double ratio = rig.imu_noise.gyro_noise_density / paper.gyro_noise_density;
    least = std::min(least, ratio);
    most = std::max(most, ratio);
    log_sum += std::log10(ratio);
    offsets.push_back(rig.time_offset_i_c.seconds());
    EXPECT_EQ(rig.imu_noise.rate_hz, 200.0);
  }
  EXPECT_GE(least, 0.5);
  EXPECT_LE(most, 20.0);
  // The logarithm of the grade is uniform in 0 .. 1, of the figure's own factor in -0.30 .. 0.30.
  EXPECT_NEAR(log_sum / kNumRigs, 0.5,
              4.0 * std::sqrt((1.0 / 12.0 + std::pow(0.30103, 2) / 3.0) / kNumRigs));
  ExpectUniform(offsets, 0.0, 0.02);
}

TEST(DrawRig, RealRigsAreThoseOfTheirDistributionWithAllEffects) {
  Rng a(7);
  Rng b(7);
  for (const auto& [plain, real] :
       {std::pair(RigDistribution::kPaper, RigDistribution::kPaperReal),
        std::pair(RigDistribution::kBroad, RigDistribution::kBroadReal)}) {
    Rig expected = DrawRig(plain, a);
    SwitchOnEffects("all", &expected);
    const Rig rig = DrawRig(real, b);
    expected.lens_residual.seed = rig.lens_residual.seed;
    EXPECT_EQ(ToYaml(ToValue(rig)), ToYaml(ToValue(expected)));
    // Each has a lens of its own.
    EXPECT_NE(rig.lens_residual.seed, DrawRig(real, b).lens_residual.seed);
    a = b = Rng(8);
  }
}

// In the direction of the paper's: the pixel (312.55, 228.02) is not its centre's, which is within
// a pixel of it.
TEST(BasePoseBeforeBoard, HasTheBoardWhereThePapersSceneHasIt) {
  for (const Rig& rig : DrawBroad(50, 9)) {
    const BasePose base = BasePoseBeforeBoard(rig);
    EXPECT_EQ(base.xyz_m, BasePose().xyz_m);
    const auto direction = [](const Rig& of, const BasePose& at) -> Eigen::Vector3d {
      const Rigid3 T_w_c =
          ArmBaseInWorld() * LoopPoseAt(at, LoopCoefficients::Zero(), 0.0) * of.T_e_c0;
      return (T_w_c.Inverse() * (of.T_w_g * BoardCentre(of.board))).normalized();
    };
    EXPECT_LT((direction(rig, base) - direction(PaperRig(), BasePose())).norm(), 1e-9);
  }
}

TEST(BasePoseBeforeBoard, IsThePapersInThePapersScene) {
  Rng rng(10);
  for (const auto distribution : {RigDistribution::kPaper, RigDistribution::kPaperReal}) {
    EXPECT_EQ(BasePoseBeforeBoard(DrawRig(distribution, rng)), BasePose());
  }
}

// Both carriers make the handcrafted extrinsic motion before boards of all kinds: scaled by little.
TEST(BasePoseBeforeBoard, CarriersMoveAroundIt) {
  int number = 0;
  for (const Rig& rig : DrawBroad(10, 11)) {
    Motion motion = HandcraftedMotion(Task::kExtrinsic);
    motion.base_pose = BasePoseBeforeBoard(rig);
    motion.carrier = number++ % 5 == 0 ? Carrier::kArm : Carrier::kFree;
    EXPECT_GE(PlanScaledToFit(motion, rig).scale, 0.5);
  }
}

TEST(BasePoseBeforeBoard, RefusesABoardInTheCamera) {
  Rig rig = PaperRig();
  const Rigid3 T_w_c =
      ArmBaseInWorld() * LoopPoseAt({}, LoopCoefficients::Zero(), 0.0) * rig.T_e_c0;
  rig.T_w_g.t = T_w_c.t - rig.T_w_g.R * BoardCentre(rig.board);
  EXPECT_THROW((void)BasePoseBeforeBoard(rig), InputError);
}

TEST(PriorMean, IsTheCameraOfOneRadian) {
  EXPECT_LT((PriorMeanIntrinsics() - Eigen::Vector4d(585.7561, 585.7561, 320.5, 240.5)).norm(),
            1e-4);
}

}  // namespace
}  // namespace calibrato
