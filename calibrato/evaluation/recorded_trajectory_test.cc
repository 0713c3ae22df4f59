#include "calibrato/evaluation/recorded_trajectory.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/evaluation/trial.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/fast_simulation.h"

namespace calibrato {
namespace {

// A TUM file of poses at 50 Hz.
std::string TumText(double duration_s, const std::function<Rigid3(double t_s)>& T_g_c0) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (int i = 0; i <= static_cast<int>(50 * duration_s); ++i) {
    const Rigid3 pose = T_g_c0(i / 50.0);
    const Eigen::Quaterniond q(pose.R);
    char line[300];
    std::snprintf(line, sizeof(line), "%.6f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                  1305031102.0 + i / 50.0, pose.t.x(), pose.t.y(), pose.t.z(), q.x(), q.y(), q.z(),
                  q.w());
    text += line;
  }
  return text;
}

// About the camera's pose at the start of the paper's motions.
Rigid3 Swaying(double t_s) {
  const Rigid3 base =
      BoardInCamera(PaperRig(), LoopPoseAt({}, LoopCoefficients::Zero(), 0.0)).Inverse();
  Eigen::Matrix<double, 6, 1> delta;
  delta << 0.2 * std::sin(2.0 * t_s), 0.15 * std::sin(3.0 * t_s), 0.3 * std::sin(2.5 * t_s),
      0.05 * std::sin(3.5 * t_s), 0.05 * std::sin(2.2 * t_s), 0.1 * std::sin(1.7 * t_s);
  return base.Perturbed(delta);
}

TEST(RecordedTrajectory, ThePathGoesThroughThePoses) {
  const RecordedTrajectory trajectory = ParseTumTrajectory(TumText(6.0, Swaying), "hand.txt");
  ASSERT_EQ(trajectory.t_s.size(), 301U);
  const Rig rig = PaperRig();
  const CarrierPath path = PathAlong(trajectory, rig);
  EXPECT_NEAR(path.duration_s, 6.0, 1e-5);
  for (double t_s = 0.5; t_s < 5.5; t_s += 0.1) {
    const Rigid3 T_g_c0 = BoardInCamera(rig, path.at(t_s).T_b_e).Inverse();
    const Eigen::Matrix<double, 6, 1> error = T_g_c0.DifferenceTo(Swaying(t_s));
    EXPECT_LT(error.head<3>().norm(), 1e-3);
    EXPECT_LT(error.tail<3>().norm(), 1e-3);
  }
}

TEST(RecordedTrajectory, ItsVelocitiesAndAccelerationsAreItsPathsDerivatives) {
  const CarrierPath path =
      PathAlong(ParseTumTrajectory(TumText(4.0, Swaying), "hand.txt"), PaperRig());
  constexpr double kStep = 1e-4;
  for (double t_s = 0.3; t_s < 3.7; t_s += 0.17) {
    const CarrierState before = path.at(t_s - kStep);
    const CarrierState state = path.at(t_s);
    const CarrierState after = path.at(t_s + kStep);
    const Eigen::Vector3d velocity = (after.T_b_e.t - before.T_b_e.t) / (2.0 * kStep);
    EXPECT_LT((velocity - state.velocity_b).norm(), 1e-5);
    const Eigen::Vector3d acceleration = (after.velocity_b - before.velocity_b) / (2.0 * kStep);
    EXPECT_LT((acceleration - state.acceleration_b).norm(), 1e-4);
    const Eigen::Vector3d omega =
        LogSo3(after.T_b_e.R * before.T_b_e.R.transpose()) / (2.0 * kStep);
    EXPECT_LT((omega - state.angular_velocity_b).norm(), 1e-5);
    const Eigen::Vector3d alpha =
        (after.angular_velocity_b - before.angular_velocity_b) / (2.0 * kStep);
    EXPECT_LT((alpha - state.angular_acceleration_b).norm(), 1e-4);
  }
}

TEST(RecordedTrajectory, IsJudgedLikeAnyMotion) {
  const ExecutableMotion motion =
      MakeExecutable(ParseTumTrajectory(TumText(8.0, Swaying), "hand.txt"), PaperRig());
  EXPECT_GT(motion.path_length_m, 5.0);
  EXPECT_TRUE(std::isnan(motion.path_length_original_m));
  for (const Task task : {Task::kIntrinsic, Task::kExtrinsic}) {
    const Trial trial = RunTrial(task, PaperRig(), motion, Fidelity::kFast, Rng(3));
    EXPECT_EQ(trial.failure, "");
    EXPECT_GT(trial.num_frames, 60);
    EXPECT_LT(trial.relative_error, 0.02);
  }
}

TEST(RecordedTrajectory, TheLengthOfAStraightPathIsItsOwn) {
  const auto straight = [](double t_s) {
    Rigid3 pose = Swaying(0.0);
    pose.t.x() += 0.1 * t_s;
    return pose;
  };
  const CarrierPath path =
      PathAlong(ParseTumTrajectory(TumText(3.0, straight), "hand.txt"), PaperRig());
  EXPECT_NEAR(PathLength(path), 0.3, 0.01);
}

TEST(RecordedTrajectory, RefusesMalformedFilesWithTheLine) {
  const auto refused = [](const std::string& text, const std::vector<std::string>& words) {
    const std::string error =
        InputErrorOf([&] { static_cast<void>(ParseTumTrajectory(text, "hand.txt")); });
    for (const std::string& word : words) {
      EXPECT_NE(error.find(word), std::string::npos) << word << " in: " << error;
    }
  };
  const std::string pose = " 0 0 1 0 0 0 1\n";
  refused("# nothing\n", {"hand.txt", "one second"});
  refused("0" + pose + "0.1 0 0 1\n", {"hand.txt line 2", "8 numbers", "found 4"});
  refused("0" + pose + "0.1 0 0 one 0 0 0 1\n", {"line 2", "'one'"});
  refused("0" + pose + "0" + pose, {"line 2", "does not come after"});
  refused("0" + pose + "0.5" + pose, {"line 2", "0.2 s"});
  refused("0 0 0 1 0 0 0 2\n", {"line 1", "norm is 2"});
  refused("0 0 0 nan 0 0 0 1\n", {"line 1", "'nan'"});
}

}  // namespace
}  // namespace calibrato
