#include "calibrato/motion/arm.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <numbers>
#include <string>
#include <vector>

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

// Six joints, a link of 0.2 m behind each, and a tool.
std::string Urdf() {
  std::string urdf = "<robot name='six'><link name='link0'/>";
  for (int i = 1; i <= 6; ++i) {
    const std::string k = std::to_string(i);
    urdf += "<link name='link" + k + "'/><joint name='joint" + k +
            "' type='revolute'><parent link='link" + std::to_string(i - 1) +
            "'/><child link='link" + k + "'/><origin xyz='0 0 0.2'/>" +
            (i % 2 == 0 ? "<axis xyz='0 1 0'/>" : "<axis xyz='0 0 1'/>") +
            "<limit lower='-2' upper='2' velocity='1' effort='1'/></joint>";
  }
  return urdf +
         "<link name='tool'/><joint name='mount' type='fixed'><parent link='link6'/>"
         "<child link='tool'/><origin xyz='0 0 0.1'/></joint></robot>";
}

std::string Yaml() {
  return "name: six\nurdf: six.urdf\nbase_link: link0\ntool_link: tool\n"
         "start_joints_rad: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]\n"
         "max_acceleration_rad_s2: [1, 1, 1, 1, 1, 1]\nmax_jerk_rad_s3: [9, 9, 9, 9, 9, 9]\n";
}

// The text with `before`, which must be in it, replaced where it first stands.
std::string With(std::string text, const std::string& before, const std::string& after) {
  const size_t place = text.find(before);
  EXPECT_NE(place, std::string::npos) << before;
  return text.replace(place, before.size(), after);
}

class ReadArmTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "calibrato-arm-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] Arm Read(const std::string& urdf, const std::string& yaml) {
    std::ofstream(folder_ / "six.urdf") << urdf;
    std::ofstream(folder_ / "six.yaml") << yaml;
    warnings_.clear();
    return ReadArm((folder_ / "six.yaml").string(), &warnings_);
  }
  void ExpectRefused(const std::string& urdf, const std::string& yaml, const std::string& why) {
    try {
      (void)Read(urdf, yaml);
      ADD_FAILURE() << "read, though " << why;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  }

  std::filesystem::path folder_;
  std::vector<std::string> warnings_;
};

TEST_F(ReadArmTest, RefusesWhatIsNoArm) {
  EXPECT_EQ(Read(Urdf(), Yaml()).num_joints(), 6);
  ExpectRefused("<robot", Yaml(), "cannot read the URDF");
  ExpectRefused(Urdf(), With(Yaml(), "tool_link: tool", "tool_link: hand"), "no such link");
  ExpectRefused(Urdf(), With(Yaml(), "tool_link: tool", "tool_link: link5"), "too few joints");
  ExpectRefused(Urdf(), With(With(Yaml(), "link0", "tool"), "tool_link: tool", "tool_link: link3"),
                "link3 does not hang on tool");
  ExpectRefused(With(Urdf(), "joint4' type='revolute'", "joint4' type='prismatic'"), Yaml(),
                "only joints that turn are planned for");
  // The parser refuses a revolute joint without limits by itself.
  const std::string limit = "<limit lower='-2' upper='2' velocity='1' effort='1'/>";
  ExpectRefused(With(With(Urdf(), "'revolute'", "'continuous'"), limit, ""), Yaml(),
                "it has no limits");
  ExpectRefused(With(Urdf(), "lower='-2'", "lower='2'"), Yaml(), "its limits leave no room");
  ExpectRefused(With(Urdf(), "<axis xyz='0 0 1'/>", "<axis xyz='0 0 0'/>"), Yaml(),
                "its axis is 0 0 0");
  const std::string more =
      "<joint name='joint7' type='revolute'><parent link='link6'/><child link='link7'/>" + limit +
      "</joint><joint name='joint8' type='revolute'><parent link='link7'/><child link='tool'/>" +
      limit + "</joint><link name='link7'/></robot>";
  ExpectRefused(With(With(Urdf(), "'link6'/><child link='tool'", "'link5'/><child link='spare'"),
                     "</robot>", "<link name='spare'/>" + more),
                Yaml(), "it is the eighth between the two links");
}

TEST_F(ReadArmTest, RefusesJointsInACircle) {
  // joint6 hangs link6 on link5, and a joint of its own hangs link5 on the tool.
  const std::string circle = With(Urdf(), "<child link='link5'/>", "<child link='spare'/>");
  ExpectRefused(With(circle, "</robot>",
                     "<link name='spare'/><joint name='back' type='fixed'><parent link='tool'/>"
                     "<child link='link5'/></joint></robot>"),
                Yaml(), "joints lead in a circle");
}

TEST_F(ReadArmTest, RefusesNumbersThatAreNone) {
  for (const std::string number : {"0.1", "0.2", "0.3", "0.4", "0.5", "0.6"}) {
    ExpectRefused(Urdf(), With(Yaml(), number, ".nan"), "start_joints_rad");
    ExpectRefused(Urdf(), With(Yaml(), number, "2.5"), "a joint is beyond its limit");
  }
  for (const std::string bad : {"0", "-1", ".nan"}) {
    for (const std::string numbers : {"[1, 1, 1, 1, 1, #]", "[#, 1, 1, 1, 1, 1]"}) {
      ExpectRefused(Urdf(), With(Yaml(), "[1, 1, 1, 1, 1, 1]", With(numbers, "#", bad)),
                    "max_acceleration_rad_s2");
    }
  }
}

TEST_F(ReadArmTest, RefusesShapesWithoutSizeAndCapsulesOfOtherLinks) {
  for (const std::string shape :
       {"sphere radius='0'", "sphere radius='-0.1'", "cylinder radius='-0.1' length='0.2'",
        "cylinder radius='0.1' length='0'", "box size='0.1 0 0.1'", "box size='0.1 0.1 -0.1'"}) {
    ExpectRefused(With(Urdf(), "<link name='link3'/>",
                       "<link name='link3'><collision><geometry><" + shape +
                           "/></geometry></collision></link>"),
                  Yaml(), "bad shape of link link3");
  }
  ExpectRefused(Urdf(),
                Yaml() + "capsules:\n  - {link: cart, a: [0, 0, 0], b: [0, 0, 1], radius_m: 0.1}\n",
                "cart is neither of the arm nor fixed to it");
}

TEST_F(ReadArmTest, KeepsTheBaseAndWhatIsFixedToTheArm) {
  const std::string sphere =
      "<collision><origin xyz='0.01 0 0'/><geometry><sphere radius='0.05'/></geometry></collision>";
  std::string urdf =
      With(Urdf(), "<link name='link0'/>", "<link name='link0'>" + sphere + "</link>");
  urdf = With(urdf, "</robot>",
              "<link name='gripper'>" + sphere +
                  "</link><joint name='screws' type='fixed'><parent link='tool'/>"
                  "<child link='gripper'/><origin xyz='0 0 0.07'/></joint>"
                  "<link name='cable'>" +
                  sphere +
                  "</link><joint name='clip' type='fixed'><parent link='link3'/>"
                  "<child link='cable'/><origin xyz='0 0.1 0'/></joint>"
                  "<link name='finger'>" +
                  sphere +
                  "</link><joint name='slide' type='prismatic'><parent link='gripper'/>"
                  "<child link='finger'/><axis xyz='1 0 0'/>"
                  "<limit lower='0' upper='0.1' velocity='1' effort='1'/></joint></robot>");
  const Arm arm = Read(
      urdf, Yaml() + "capsules:\n  - {link: link0, a: [0, 0, 0], b: [0, 0, 0.1], radius_m: 0.2}\n");
  const auto part = [&](const std::string& name) {
    const auto found = std::ranges::find(arm.parts, name, &ArmPart::name);
    EXPECT_NE(found, arm.parts.end()) << name;
    return found != arm.parts.end() ? *found : ArmPart{};
  };
  EXPECT_EQ(arm.parts.size(), 4U);
  EXPECT_EQ(part("link0").link, 0);
  EXPECT_EQ(arm.parts.back().link, 0);
  EXPECT_EQ(arm.parts.back().capsule.radius_m, 0.2);
  EXPECT_EQ(part("cable").link, 3);
  EXPECT_LT((part("cable").capsule.a - Eigen::Vector3d(0.01, 0.1, 0.0)).norm(), 1e-12);
  // 0.1 m to the tool and 0.07 m on from there.
  EXPECT_EQ(part("gripper").link, 6);
  EXPECT_LT((part("gripper").capsule.b - Eigen::Vector3d(0.01, 0.0, 0.17)).norm(), 1e-12);
  EXPECT_TRUE(std::ranges::any_of(warnings_, [](const std::string& warning) {
    return warning.find("link finger hangs on joint slide") != std::string::npos;
  }));
}

}  // namespace
}  // namespace calibrato
