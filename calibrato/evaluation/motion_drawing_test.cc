#include "calibrato/evaluation/motion_drawing.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "calibrato/motion/panda.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

Eigen::Vector3d PointIn(const Value& numbers, size_t first) {
  const auto& elements = numbers.elements();
  return {elements[first].AsDouble(), elements[first + 1].AsDouble(),
          elements[first + 2].AsDouble()};
}

TEST(MotionDrawing, TheCameraIsPlayedWhereThePathHasIt) {
  const Rig rig = PaperRig();
  const ExecutableMotion motion =
      MakeExecutable(HandcraftedMotion(Task::kExtrinsic), Carrier::kFree, rig);
  const Value drawing = MotionDrawing(motion, rig);
  const Value& played = drawing.At("played");
  const auto& poses = played.At("camera_b").elements();
  const double step_s = played.At("step_s").AsDouble();
  ASSERT_EQ(poses.size(), 151U);
  EXPECT_NEAR(step_s, 0.1, 1e-12);
  EXPECT_TRUE(played.At("arm_b").elements().empty());
  for (const size_t k : {size_t{0}, size_t{33}, poses.size() - 1}) {
    const Rigid3 T_b_c0 = motion.path.at(static_cast<double>(k) * step_s).T_b_e * rig.T_e_c0;
    EXPECT_LT((PointIn(poses[k], 0) - T_b_c0.t).norm(), 1e-4);
    const auto& q = poses[k].elements();
    const Eigen::Quaterniond rotation(q[6].AsDouble(), q[3].AsDouble(), q[4].AsDouble(),
                                      q[5].AsDouble());
    EXPECT_LT(rotation.angularDistance(Eigen::Quaterniond(T_b_c0.R)), 5e-4);
  }
  EXPECT_EQ(drawing.At("loops").elements().size(), 3U);
}

TEST(MotionDrawing, TheArmReachesFromItsFootToTheFlange) {
  const Rig rig = PaperRig();
  const ExecutableMotion motion =
      MakeExecutable(HandcraftedMotion(Task::kExtrinsic), Carrier::kArm, rig);
  const Value drawing = MotionDrawing(motion, rig);
  const Value& played = drawing.At("played");
  const auto& rows = played.At("arm_b").elements();
  ASSERT_EQ(rows.size(), played.At("camera_b").elements().size());
  // Shoulder, elbow, forearm, wrist: the lengths of the links, whatever the joints.
  const double step_s = played.At("step_s").AsDouble();
  for (size_t k = 0; k < rows.size(); k += 40) {
    ASSERT_EQ(rows[k].elements().size(), 21U);
    EXPECT_EQ(PointIn(rows[k], 0), Eigen::Vector3d::Zero());
    EXPECT_NEAR(PointIn(rows[k], 3).norm(), 0.333, 2e-4);
    EXPECT_NEAR((PointIn(rows[k], 6) - PointIn(rows[k], 3)).norm(), 0.316, 2e-4);
    EXPECT_NEAR((PointIn(rows[k], 9) - PointIn(rows[k], 6)).norm(), 0.0825, 2e-4);
    const Rigid3 flange = motion.path.at(static_cast<double>(k) * step_s).T_b_e;
    EXPECT_LT((PointIn(rows[k], 18) - flange.t).norm(), 2e-4);
  }
}

TEST(MotionDrawing, TheBoardIsOutlinedWhereItStands) {
  const Rig rig = PaperRig();
  const Value drawn = BoardOutline(rig);
  const auto& outline = drawn.elements();
  ASSERT_EQ(outline.size(), 4U);
  const double width = (PointIn(outline[1], 0) - PointIn(outline[0], 0)).norm();
  const double height = (PointIn(outline[2], 0) - PointIn(outline[1], 0)).norm();
  const auto& board = std::get<Checkerboard>(rig.board);
  EXPECT_NEAR(width * height,
              (board.columns - 1) * (board.rows - 1) * board.column_spacing_m * board.row_spacing_m,
              1e-4);
}

}  // namespace
}  // namespace calibrato
