// Detected corners against where the renderer put them: two rooms that share nothing but the camera
// models.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/parallel.h"
#include "calibrato/base/rng.h"
#include "calibrato/detection/detect.h"
#include "rendered_boards.h"

namespace calibrato {
namespace {

struct Case {
  std::string name;
  Board board;
  std::string model;
  bool is_found_in_parts;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

struct Errors {
  bool is_tried = false;
  bool is_found = false;
  Eigen::Matrix2Xd errors;
};

// About 20 to 60 px from corner to corner, anywhere in the image, tilted by up to 60 degrees.
Errors TryOneView(const Case& c, size_t index) {
  Rng rng = Rng(20).Stream("view", index);
  const Camera camera = CameraForTest(c.model);
  const Eigen::Matrix3Xd points_g = BoardPoints(c.board);
  const double size = (points_g.rowwise().maxCoeff() - points_g.rowwise().minCoeff()).norm();
  BoardPlace place;
  place.pixel = {rng.Uniform(120.0, 520.0), rng.Uniform(100.0, 380.0)};
  place.distance_m =
      size * (c.model == "pinhole-equi" ? rng.Uniform(0.9, 1.4) : rng.Uniform(0.9, 1.6));
  place.tilt = rng.Uniform(0.0, std::numbers::pi / 3.0);
  place.tilt_axis = rng.Uniform(0.0, 2.0 * std::numbers::pi);
  place.roll = rng.Uniform(0.0, 2.0 * std::numbers::pi);
  const Rigid3 T_c_g = PoseOf(c.board, camera, place);
  const Eigen::Matrix2Xd truth = TruthOf(c.board, camera, T_c_g);
  constexpr double kMargin = 10.0;
  const auto num_inside =
      ((truth.row(0).array() >= kMargin) && (truth.row(0).array() <= 639.0 - kMargin) &&
       (truth.row(1).array() >= kMargin) && (truth.row(1).array() <= 479.0 - kMargin))
          .count();
  Errors result;
  result.is_tried =
      c.is_found_in_parts ? 3 * num_inside >= truth.cols() : num_inside == truth.cols();
  if (!result.is_tried) return result;
  const std::optional<BoardView> view = DetectBoard(ImageOf(c.board, camera, T_c_g), c.board);
  result.is_found = view.has_value();
  if (!view) return result;
  result.errors = view->pixels - truth(Eigen::all, view->corner_ids);
  return result;
}

class DetectionAccuracy : public testing::TestWithParam<Case> {};

TEST_P(DetectionAccuracy, IsUnbiasedToAFiftiethOfAPixel) {
  const size_t num_views = FullSample() ? 1500 : 40;  // about a third of them in full view
  const std::vector<Errors> views =
      ParallelMap<Errors>(num_views, [](size_t index) { return TryOneView(GetParam(), index); });
  Eigen::Index num_corners = 0;
  int num_tried = 0;
  int num_found = 0;
  double worst = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  for (const Errors& view : views) {
    num_tried += view.is_tried ? 1 : 0;
    num_found += view.is_found ? 1 : 0;
    if (!view.is_found) continue;
    num_corners += view.errors.cols();
    sum += view.errors.rowwise().sum();
    squares += view.errors.rowwise().squaredNorm();
    worst = std::max(worst, view.errors.colwise().norm().maxCoeff());
  }
  const auto n = static_cast<double>(num_corners);
  const Eigen::Vector2d mean = sum / n;
  const Eigen::Vector2d deviation = (squares / n - mean.cwiseAbs2()).cwiseSqrt();
  RecordProperty("corners", static_cast<int>(num_corners));
  RecordProperty("summary", std::to_string(num_found) + " of " + std::to_string(num_tried) +
                                " views, mean " + std::to_string(mean.x()) + " " +
                                std::to_string(mean.y()) + ", standard deviation " +
                                std::to_string(deviation.x()) + " " +
                                std::to_string(deviation.y()) + ", worst " + std::to_string(worst));
  ASSERT_GT(num_corners, 300);
  EXPECT_GE(num_found, 0.9 * num_tried);
  EXPECT_LE(mean.cwiseAbs().maxCoeff(), 0.02);
  // Asked for are 0.05 px; docs/detection.md has what is achieved.
  EXPECT_LE(deviation.maxCoeff(), 0.01);
  EXPECT_LE(worst, 0.2);
}

// The symmetric grid of circles is left out: it may be numbered from its other side.
INSTANTIATE_TEST_SUITE_P(
    OnRenderedImages, DetectionAccuracy,
    testing::Values(
        Case{"CheckerboardRadtan", Checkerboard{6, 7, 0.06, 0.06}, "pinhole-radtan", false},
        Case{"CheckerboardFisheye", Checkerboard{6, 7, 0.06, 0.06}, "pinhole-equi", false},
        Case{"AprilGridRadtan", AprilGrid{5, 4, 0.088, 0.3}, "pinhole-radtan", true},
        Case{"AprilGridFisheye", AprilGrid{5, 4, 0.088, 0.3}, "pinhole-equi", true},
        Case{"CharucoRadtan", Charuco{6, 8, 0.06, 0.045, "DICT_5X5_100"}, "pinhole-radtan", true},
        Case{"CharucoFisheye", Charuco{5, 6, 0.06, 0.042, "DICT_4X4_50"}, "pinhole-equi", true},
        Case{"CirclesRadtan", CircleGrid{11, 4, 0.03, true}, "pinhole-radtan", false},
        Case{"CirclesFisheye", CircleGrid{7, 4, 0.03, true}, "pinhole-equi", false}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace calibrato
