#include "calibrato/motion/arm.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <numbers>
#include <string>

#include "calibrato/base/input_error.h"
#include "calibrato/base/rng.h"
#include "calibrato/motion/arm_file.h"

namespace calibrato {
namespace {

constexpr double kRight = 0.5 * std::numbers::pi;

Arm Example(const std::string& name) { return ReadArm("examples/arms/" + name + ".yaml", nullptr); }

JointVector Drawn(const Arm& arm, double reach, Rng& rng) {
  JointVector q = arm.start;
  for (int i = 0; i < arm.num_joints(); ++i) q[i] += rng.Uniform(-reach, reach);
  return q.cwiseMax(arm.limits.lower).cwiseMin(arm.limits.upper);
}

// By the maker's parameters in KDL: another table and another library's way of chaining it.
TEST(Arm, UR5eStandsWhereItsMakersParametersHaveIt) {
  const std::array<std::array<double, 3>, 6> rows = {{{0.0, kRight, 0.1625},
                                                      {-0.425, 0.0, 0.0},
                                                      {-0.3922, 0.0, 0.0},
                                                      {0.0, kRight, 0.1333},
                                                      {0.0, -kRight, 0.0997},
                                                      {0.0, 0.0, 0.0996}}};  // a, alpha, d
  KDL::Chain chain;
  for (const auto& [a, alpha, d] : rows) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(a, alpha, d, 0.0)));
  }
  KDL::ChainFkSolverPos_recursive solver(chain);
  const Arm arm = Example("ur5e");
  Rng rng(5);
  for (int trial = 0; trial < 50; ++trial) {
    const JointVector q = Drawn(arm, 3.0, rng);
    KDL::JntArray joints(6);
    for (unsigned i = 0; i < 6; ++i) joints(i) = q[i];
    KDL::Frame wanted;
    ASSERT_GE(solver.JntToCart(joints, wanted), 0);
    const Rigid3 T_b_e = PoseOf(arm, q, nullptr);
    for (int row = 0; row < 3; ++row) {
      EXPECT_NEAR(T_b_e.t[row], wanted.p[row], 1e-9);
      for (int column = 0; column < 3; ++column) {
        EXPECT_NEAR(T_b_e.R(row, column), wanted.M(row, column), 1e-9);
      }
    }
  }
}

// Stretched out at joint angles of zero, the xArm 6 holds its flange where its maker's drawing has
// it: 207 mm before the base's axis and 112 mm above the table.
TEST(Arm, XArmStandsAsDrawnAtZero) {
  const Arm arm = Example("xarm6");
  const Rigid3 T_b_e = PoseOf(arm, JointVector::Zero(), nullptr);
  EXPECT_NEAR(T_b_e.t.x(), 0.2065, 1e-3);
  EXPECT_NEAR(T_b_e.t.y(), 0.0, 1e-9);
  EXPECT_NEAR(T_b_e.t.z(), 0.1120, 1e-3);
  EXPECT_NEAR(PoseOf(Example("xarm7"), JointVector::Zero(), nullptr).t.x(), 0.206, 1e-3);
}

TEST(Arm, JacobianIsTheDerivativeOfThePose) {
  for (const std::string name : {"ur5e", "xarm6", "xarm7"}) {
    const Arm arm = Example(name);
    Rng rng(6);
    const JointVector q = Drawn(arm, 0.5, rng);
    JointJacobian J;
    const Rigid3 T_b_e = PoseOf(arm, q, &J);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 7; ++i) {
      const Rigid3 moved = PoseOf(arm, q + kStep * JointVector::Unit(i), nullptr);
      const Eigen::Matrix<double, 6, 1> slope = moved.DifferenceTo(T_b_e) / kStep;
      EXPECT_LT((slope - J.col(i)).norm(), 1e-5) << name << " joint " << i + 1;
    }
  }
}

TEST(Arm, InverseFindsThePoseAgainAndAllPosturesReachIt) {
  for (const std::string name : {"ur5e", "xarm6", "xarm7"}) {
    const Arm arm = Example(name);
    const JointRange range{arm.limits.lower, arm.limits.upper};
    Rng rng(7);
    for (int trial = 0; trial < 5; ++trial) {
      const JointVector q = Drawn(arm, 0.3, rng);
      const Rigid3 T_b_e = PoseOf(arm, q, nullptr);
      const auto found = InverseNear(arm, T_b_e, arm.start, arm.start);
      ASSERT_TRUE(found.has_value()) << name;
      EXPECT_LT(T_b_e.DifferenceTo(PoseOf(arm, *found, nullptr)).norm(), 1e-8);
      if (arm.num_joints() == 6) {
        EXPECT_LT((*found - q).norm(), 1e-6) << name;
      }
    }
    const Rigid3 T_b_e = PoseOf(arm, arm.start, nullptr);
    const std::vector<JointVector> postures = PosturesAt(arm, T_b_e, range);
    ASSERT_GE(postures.size(), 2U) << name;
    EXPECT_LT((postures.front() - arm.start).norm(), 1e-6) << name;
    for (const JointVector& q : postures) {
      EXPECT_LT(T_b_e.DifferenceTo(PoseOf(arm, q, nullptr)).norm(), 1e-8) << name;
      EXPECT_LE(JointLimitExcess(q, range), 0.0) << name;
    }
  }
  // Both elbows, both wrists and, over the shoulder, both sides.
  const Arm ur = Example("ur5e");
  EXPECT_GE(
      PosturesAt(ur, PoseOf(ur, ur.start, nullptr), {ur.limits.lower, ur.limits.upper}).size(), 4U);
}

TEST(ReadArm, RefusesWhatIsNoArm) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / "calibrato-arm-test";
  fs::create_directories(folder);
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder / name) << text;
    return (folder / name).string();
  };
  const std::string yaml =
      "name: two\nurdf: two.urdf\nbase_link: base\ntool_link: tool\nstart_joints_rad: [0]\n"
      "max_acceleration_rad_s2: [1]\nmax_jerk_rad_s3: [1]\n";
  write("two.urdf",
        "<robot name='two'><link name='base'/><link name='tool'/><joint name='j' type='revolute'>"
        "<parent link='base'/><child link='tool'/><axis xyz='0 0 1'/>"
        "<limit lower='-1' upper='1' velocity='1' effort='1'/></joint></robot>");
  EXPECT_THROW((void)ReadArm(write("two.yaml", yaml), nullptr), InputError);
  std::string elsewhere = yaml;
  elsewhere.replace(elsewhere.find("tool_link: tool"), 15, "tool_link: hand");
  EXPECT_THROW((void)ReadArm(write("hand.yaml", elsewhere), nullptr), InputError);
  write("two.urdf", "<robot");
  EXPECT_THROW((void)ReadArm(write("two.yaml", yaml), nullptr), InputError);
  EXPECT_THROW((void)ReadArm((folder / "none.yaml").string(), nullptr), InputError);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace calibrato
