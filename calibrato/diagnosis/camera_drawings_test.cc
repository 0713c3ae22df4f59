#include "calibrato/diagnosis/camera_drawings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

CameraModel Fisheye() {
  return {"pinhole-equi", (Eigen::VectorXd(8) << 200, 200, 319.5, 239.5, 0, 0, 0, 0).finished()};
}

// A board of 3 x 4 corners, at this distance, turned about y of the camera by this angle.
BoardView ViewOf(const CameraModel& model, double distance_m, double angle_rad) {
  BoardView view;
  view.name = "view at " + std::to_string(distance_m);
  view.points_g.resize(3, 12);
  view.pixels.resize(2, 12);
  for (int k = 0; k < 12; ++k) {
    view.points_g.col(k) = Eigen::Vector3d(0.1 * (k / 4), 0.1 * (k % 4), 0.0);
    const Eigen::Vector3d p_c = ExpSo3(Eigen::Vector3d(0, angle_rad, 0)) *
                                (view.points_g.col(k) + Eigen::Vector3d(0.05, -0.1, distance_m));
    view.pixels.col(k) = model.Project(p_c).value();
  }
  return view;
}

std::vector<Eigen::Vector2d> Points(const Value& pairs) {
  std::vector<Eigen::Vector2d> points;
  for (const Value& pair : pairs.elements()) {
    const std::vector<double> numbers = pair.AsDoubles(2);
    points.emplace_back(numbers[0], numbers[1]);
  }
  return points;
}

// An omni lens of xi = 1 and gamma = 400 sees an angle at 400 sin / (cos + 1) = 400 tan(angle / 2):
// its focal length in the middle is 200, where a pinhole sees the angle at 200 tan(angle).
TEST(DistortionCurve, OfAnOmniLensBeginsWithThePinholeOfItsMiddle) {
  const CameraModel omni("omni-none", (Eigen::VectorXd(5) << 1, 400, 400, 319.5, 239.5).finished());
  const Value curve = DistortionCurve(omni, {640, 480});
  const std::vector<double> radius = curve.At("radius_px").AsDoubles();
  const std::vector<double> shift = curve.At("shift_px").AsDoubles();
  ASSERT_EQ(radius.size(), 61U);
  EXPECT_NEAR(radius.back(), std::hypot(319.5, 239.5), 1e-2);
  for (size_t i = 0; i < radius.size(); ++i) {
    const double angle = std::atan(radius[i] / 200.0);
    EXPECT_NEAR(shift[i], 400.0 * std::tan(0.5 * angle) - radius[i], 2e-2) << i;
  }
}

TEST(LensCurve, OfAnEquidistantLensIsALine) {
  const Value curve = LensCurve(Fisheye(), {640, 480});
  const std::vector<double> angles = curve.At("angle_rad").AsDoubles();
  const std::vector<double> radii = curve.At("radius_px").AsDoubles();
  ASSERT_EQ(angles.size(), radii.size());
  EXPECT_NEAR(radii.back(), std::hypot(319.5, 239.5), 0.01);
  for (size_t i = 0; i < angles.size(); ++i) EXPECT_NEAR(radii[i], 200.0 * angles[i], 0.01);
}

TEST(StraightenedView, MakesTheLinesOfABoardStraightAlsoBesideAWideLens) {
  // 80 degrees off the axis: a pinhole that looks ahead would see it five times as far out.
  const BoardView view = ViewOf(Fisheye(), 0.4, 1.4);
  const Value drawn = StraightenedView(Fisheye(), {view});
  const auto straight = Points(drawn.At("straightened"));
  const auto seen = Points(drawn.At("pixels"));
  ASSERT_EQ(straight.size(), 12u);
  ASSERT_EQ(drawn.At("lines").size(), 7u);
  double bent = 0.0;
  for (const Value& line : drawn.At("lines").elements()) {
    const std::vector<double> indices = line.AsDoubles();
    const auto at = [&](const auto& points, size_t i) { return points[size_t(indices[i])]; };
    // Twice the area of the triangle over its base is how far the second point lies off the line
    // from the first to the last.
    const auto off = [&](const auto& points) {
      const Eigen::Vector2d base = at(points, indices.size() - 1) - at(points, 0);
      const Eigen::Vector2d side = at(points, 1) - at(points, 0);
      return std::abs(base.x() * side.y() - base.y() * side.x()) / base.norm();
    };
    EXPECT_LT(off(straight), 0.02);  // Of rounding.
    bent = std::max(bent, off(seen));
  }
  EXPECT_GT(bent, 1.0);
}

TEST(StraightenedView, IsTheViewInWhichTheBoardIsLargest) {
  const Value drawn =
      StraightenedView(Fisheye(), {ViewOf(Fisheye(), 0.8, 0.0), ViewOf(Fisheye(), 0.5, 0.2)});
  EXPECT_EQ(drawn.At("name").AsString(), ViewOf(Fisheye(), 0.5, 0.2).name);
  EXPECT_TRUE(StraightenedView(Fisheye(), {}).IsNull());
}

TEST(RejectedCornerMarks, SaysWhereAndByHowMuch) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Value marks = RejectedCornerMarks(
      {{"left01.jpg", 3, {10.0, 20.0}, {1.5, -2.0}}, {"left02.jpg", 4, {1.0, 2.0}, {kNan, kNan}}});
  ASSERT_EQ(marks.size(), 2u);
  EXPECT_EQ(marks.elements()[0].At("view").AsString(), "left01.jpg");
  EXPECT_EQ(Points(Value::Array().Append(marks.elements()[0].At("residual")))[0],
            Eigen::Vector2d(1.5, -2.0));
  const Value& unseen = marks.elements()[1].At("residual");
  EXPECT_EQ(ToJsonLine(unseen).find_first_of("0123456789"), std::string::npos);
}

}  // namespace
}  // namespace calibrato
