#include "calibrato/rendering/render_board.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "calibrato/geometry/rpy.h"

namespace calibrato {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Camera Lens(std::string_view model, std::initializer_list<double> parameters) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(parameters.size()));
  std::copy(parameters.begin(), parameters.end(), values.begin());
  return {CameraModel(model, values), {640, 480}, "", std::nullopt};
}

Camera Ordinary() {
  return Lens("pinhole-radtan", {420.0, 418.5, 322.3, 238.6, -0.25, 0.06, 4e-4, -3e-4});
}
// 190 degrees from left to right.
Camera Fisheye() {
  return Lens("pinhole-equi", {190.0, 191.0, 321.2, 239.1, 0.01, -0.01, 0.0, 0.0});
}
// Sees 122 degrees off its axis at the left and right edge.
Camera Backward() { return Lens("pinhole-equi", {150.0, 150.0, 319.7, 240.2, 0.0, 0.0, 0.0, 0.0}); }

// A board whose point `target_g` is `distance_m` away on the ray through a pixel, turned.
Rigid3 Pose(const Camera& camera, const Vector2d& pixel, double distance_m, const Vector3d& rpy,
            const Vector3d& target_g) {
  Rigid3 T_c_g;
  Eigen::Matrix3d facing;  // x down, y to the right, z towards the camera
  facing << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
  T_c_g.R = RotationFromRpy(rpy) * facing;
  T_c_g.t = distance_m * camera.model.Unproject(pixel)->normalized() - T_c_g.R * target_g;
  return T_c_g;
}

// Light of one point of the scene, by ways other than the renderer's: a ray, and sides counted.
double Light(const BoardPattern& pattern, const Camera& camera, const Rigid3& T_g_c,
             const Scene& scene, const Vector2d& pixel) {
  const auto ray = camera.model.Unproject(pixel);
  if (!ray) return scene.background;
  const Vector3d direction = T_g_c.R * *ray;
  const double distance = -T_g_c.t.z() / direction.z();
  if (!(distance > 0.0)) return scene.background;
  const Vector2d p = (T_g_c.t + distance * direction).head<2>();
  if (!pattern.sheet.contains(p)) return scene.background;
  for (const BoardPattern::Disc& disc : pattern.discs) {
    if ((p - disc.centre).norm() < disc.radius_m) return scene.black;
  }
  bool is_black = false;
  for (const BoardPattern::Outline& outline : pattern.outlines) {
    for (size_t k = 0; k < outline.size(); ++k) {
      const Vector2d& a = outline[k];
      const Vector2d& b = outline[(k + 1) % outline.size()];
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) is_black = !is_black;
    }
  }
  return is_black ? scene.black : scene.white;
}

// The mean over a pixel's area by very many points (the additive sequence of Roberts's R2).
double BruteForce(const BoardPattern& pattern, const Camera& camera, const Rigid3& T_c_g,
                  const Scene& scene, const Vector2d& centre) {
  constexpr int kSamples = 1 << 16;
  constexpr double kPlastic = 1.32471795724474602596;
  const Rigid3 T_g_c = T_c_g.Inverse();
  double sum = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const double x = std::fmod(0.5 + k / kPlastic, 1.0) - 0.5;
    const double y = std::fmod(0.5 + k / (kPlastic * kPlastic), 1.0) - 0.5;
    sum += Light(pattern, camera, T_g_c, scene, centre + Vector2d(x, y));
  }
  return sum / kSamples;
}

struct Situation {
  std::string name;
  Board board;
  Camera camera;
  Rigid3 T_c_g;
};

std::vector<Situation> Situations() {
  const Checkerboard checkerboard{6, 7, 0.06, 0.06};
  const Vector3d middle = BoardCentre(checkerboard);
  const Vector3d tilted(0.6, 0.3, 0.4);
  std::vector<Situation> situations;
  const auto add = [&](const std::string& name, const Board& board, const Camera& camera,
                       const Vector2d& pixel, double distance_m, const Vector3d& rpy) {
    situations.push_back(
        {name, board, camera, Pose(camera, pixel, distance_m, rpy, BoardCentre(board))});
  };
  add("oblique, ordinary lens", checkerboard, Ordinary(), {350.0, 220.0}, 0.6, tilted);
  add("at the fisheye's edge", checkerboard, Fisheye(), {40.0, 100.0}, 0.3, {0.5, -0.9, 1.2});
  add("discs", CircleGrid{5, 4, 0.05, true}, Ordinary(), {300.0, 200.0}, 0.5, tilted);
  add("a tag", AprilGrid{1, 2, 0.1, 0.3}, Ordinary(), {300.0, 250.0}, 0.4, tilted);
  add("double sphere", checkerboard, Lens("ds-none", {-0.2, 0.6, 200.0, 201.0, 320.0, 240.0}),
      {120.0, 320.0}, 0.25, tilted);
  add("omni", checkerboard,
      Lens("omni-radtan", {0.9, 400.0, 401.0, 320.0, 240.0, -0.1, 0.02, 1e-3, 1e-3}),
      {500.0, 320.0}, 0.3, tilted);
  // The camera almost in the board's plane, a part of the board behind it.
  Situation grazing{"beside the camera", checkerboard, Ordinary(), {}};
  grazing.T_c_g.R = RotationFromRpy({-1.45, 0.1, 0.05}) *
                    Pose(Ordinary(), {320.0, 240.0}, 1.0, Vector3d::Zero(), middle).R;
  grazing.T_c_g.t = Vector3d(0.0, 0.08, 0.0) - grazing.T_c_g.R * middle;
  situations.push_back(grazing);
  // The camera looks away from the board, 0.1 m behind it, and sees what is beside its back.
  Situation back{"behind the camera", checkerboard, Backward(), {}};
  back.T_c_g.R = RotationFromRpy({0.05, std::acos(-1.0) - 0.1, 0.3}) *
                 Pose(Ordinary(), {320.0, 240.0}, 1.0, Vector3d::Zero(), middle).R;
  back.T_c_g.t = Vector3d(0.02, 0.01, -0.08) - back.T_c_g.R * middle;
  situations.push_back(back);
  // ... through a lens whose image is a circle within the image.
  back.name = "behind the camera, image circle";
  back.camera = Lens("pinhole-equi", {72.0, 72.0, 319.7, 240.2, 0.0, 0.0, 0.0, 0.0});
  situations.push_back(back);
  return situations;
}

TEST(RenderBoard, GivesTheMeanOverEachPixel) {
  const Scene scene;
  const double contrast = scene.white - scene.black;
  for (const Situation& s : Situations()) {
    const BoardPattern pattern = PatternOf(s.board);
    const Exposure exposure = RenderBoard(pattern, s.camera, s.T_c_g, scene);
    // Pixels of all kinds, and as many of those that an edge crosses.
    Rng rng(7);
    double largest = 0.0;
    int num_crossed = 0;
    for (int k = 0; k < 5000 && num_crossed < 5; ++k) {
      const auto u = static_cast<int>(rng.UniformIndex(640));
      const auto v = static_cast<int>(rng.UniformIndex(480));
      const double level = exposure.pixels[v * 640 + u];
      const auto is_near = [&](double pure) { return std::abs(level - pure) < 1e-3; };
      const bool is_crossed =
          !is_near(scene.black) && !is_near(scene.white) && !is_near(scene.background);
      if (!is_crossed && k > 3) continue;
      if (is_crossed) ++num_crossed;
      const double expected = BruteForce(pattern, s.camera, s.T_c_g, scene, Vector2d(u, v));
      largest = std::max(largest, std::abs(level - expected) / contrast);
      EXPECT_NEAR(level, expected, 1e-3 * contrast) << s.name << " at " << u << ", " << v;
    }
    EXPECT_EQ(num_crossed, 5) << s.name;
    RecordProperty(s.name, std::to_string(largest));
  }
}

// The sum of a row of pixels across an edge tells where in this row the edge is, on average.
TEST(RenderBoard, PutsEdgesWhereTheLensDoes) {
  const Camera camera = Ordinary();
  const BoardPattern pattern = PatternOf(Checkerboard{6, 7, 0.06, 0.06});
  BoardPattern blank;
  blank.sheet = pattern.sheet;
  Scene scene;
  scene.background = 0.0;
  scene.white = 1.0;
  double largest = 0.0;
  for (const double roll : {0.0, 0.1, 0.35}) {
    const Rigid3 T_c_g = Pose(camera, {330.0, 235.0}, 0.7, {0.3, 0.4, roll}, {0.15, 0.18, 0.0});
    const Exposure exposure = RenderBoard(blank, camera, T_c_g, scene);
    // The left edge of the sheet, y at its smallest, densely.
    std::map<int, std::pair<double, double>> edges;  // row -> (integral of u dv, of dv)
    constexpr int kSteps = 400'000;
    Vector2d last = Vector2d::Zero();
    for (int k = 0; k <= kSteps; ++k) {
      const double x = blank.sheet.min().x() + blank.sheet.sizes().x() * k / kSteps;
      const Vector2d pixel = *camera.model.Project(T_c_g * Vector3d(x, blank.sheet.min().y(), 0.0));
      const int row = static_cast<int>(std::lround(pixel.y()));
      if (k > 0) {
        const double dv = pixel.y() - last.y();
        edges[row].first += 0.5 * (pixel.x() + last.x()) * dv;
        edges[row].second += dv;
      }
      last = pixel;
    }
    int num_rows = 0;
    for (const auto& [row, edge] : edges) {
      if (row < 0 || row >= 480 || edge.second < 1.0 - 1e-2) continue;
      const double u_edge = edge.first / edge.second;
      if (u_edge < 2.0) continue;
      // White from the edge to the sheet's middle, which is right of it in every row taken.
      const int end = static_cast<int>(u_edge) + 40;
      double white = 0.0;
      for (int u = 0; u < end; ++u) white += exposure.pixels[row * 640 + u];
      if (exposure.pixels[row * 640 + end - 1] < 1.0F) continue;
      largest = std::max(largest, std::abs(end - 0.5 - white - u_edge));
      ++num_rows;
    }
    EXPECT_GT(num_rows, 150);
  }
  RecordProperty("largest_error_px", std::to_string(largest));
  EXPECT_LT(largest, 3e-4);
}

TEST(RenderBoard, FillsTheImageWithASheetAroundIt) {
  BoardPattern wide;
  wide.sheet = Eigen::AlignedBox2d(Vector2d(-5.0, -5.0), Vector2d(5.0, 5.0));
  const Camera camera = Ordinary();
  const Exposure exposure = RenderBoard(
      wide, camera, Pose(camera, {320.0, 240.0}, 1.0, {0.1, 0.1, 0.0}, Vector3d::Zero()), {});
  for (const float level : exposure.pixels) ASSERT_NEAR(level, 225.0, 1e-3);
}

TEST(RenderBoard, ShowsNothingFromBehind) {
  const Camera camera = Ordinary();
  const Board board = Checkerboard{6, 7, 0.06, 0.06};
  Rigid3 T_c_g = Pose(camera, {320.0, 240.0}, 0.6, Vector3d::Zero(), BoardCentre(board));
  T_c_g.R.col(0) = -T_c_g.R.col(0);
  T_c_g.R.col(2) = -T_c_g.R.col(2);
  const Exposure exposure = RenderBoard(PatternOf(board), camera, T_c_g, {});
  for (const float level : exposure.pixels) ASSERT_EQ(level, 110.0F);
}

TEST(RenderBoard, DarkensCornersAndOneSide) {
  Scene scene;
  scene.vignetting = 0.4;
  scene.lighting_gradient = {0.1, 0.0};
  const Camera camera = Ordinary();
  Rigid3 away;
  away.t = {0.0, 0.0, 1.0};  // seen from behind: background alone
  const Exposure exposure = RenderBoard({}, camera, away, scene);
  const double edge = 639.0 / 640.0;
  const double corner = 1.0 - 0.2 * (edge * edge + 479.0 / 480.0 * 479.0 / 480.0);
  EXPECT_NEAR(exposure.pixels[0], 110.0 * (1.0 - 0.1 * edge) * corner, 1e-4);
  EXPECT_NEAR(exposure.pixels[639], 110.0 * (1.0 + 0.1 * edge) * corner, 1e-4);
}

TEST(Digitised, AddsNoiseOfTheStatedVariance) {
  Exposure exposure{{400, 300}, std::vector<float>(120'000, 100.0F)};
  for (size_t k = 60'000; k < 120'000; ++k) exposure.pixels[k] = 200.0F;
  Rng rng(3);
  const GreyImage image = Digitised(exposure, {2.0, 0.05}, rng);
  const auto check = [&](size_t begin, double level) {
    double sum = 0.0;
    double squares = 0.0;
    for (size_t k = begin; k < begin + 60'000; ++k) {
      const double d = image.pixels[k] - level;
      sum += d;
      squares += d * d;
    }
    const double variance = 4.0 + 0.05 * level + 1.0 / 12.0;  // the last: rounding
    EXPECT_NEAR(sum / 60'000, 0.0, 4.0 * std::sqrt(variance / 60'000));
    EXPECT_NEAR(squares / 60'000, variance, 4.0 * variance * std::sqrt(2.0 / 60'000));
  };
  check(0, 100.0);
  check(60'000, 200.0);
}

TEST(Digitised, RoundsAndClips) {
  const Exposure exposure{{4, 1}, {-3.0F, 12.4F, 12.6F, 300.0F}};
  EXPECT_EQ(Digitised(exposure).pixels, (std::vector<uint8_t>{0, 12, 13, 255}));
}

using Tags = std::map<int, std::vector<cv::Point2f>>;

Tags DetectTags(const cv::Mat& image) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = 2;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(image,
                           cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11),
                           corners, ids, parameters);
  Tags tags;
  for (size_t k = 0; k < ids.size(); ++k) tags[ids[k]] = corners[k];
  return tags;
}

TEST(RenderBoard, ShowsTagsThatAnotherDetectorReads) {
  const AprilGrid board{6, 6, 0.088, 0.3};
  const Camera camera = Ordinary();
  const Rigid3 T_c_g = Pose(camera, {320.0, 240.0}, 0.9, {0.2, 0.2, 1.4}, BoardCentre(board));
  GreyImage image = Digitised(RenderBoard(PatternOf(board), camera, T_c_g, {}));
  const Tags tags = DetectTags(cv::Mat(480, 640, CV_8UC1, image.pixels.data()));
  ASSERT_EQ(tags.size(), 36U);
  // Tags are about 50 px wide, OpenCV's corners right to 3 px. It gives them clockwise from what
  // it holds for the upper left: our lower right.
  constexpr int kOurs[] = {1, 0, 3, 2};
  const Eigen::Matrix3Xd points = BoardPoints(board);
  for (const auto& [id, corners] : tags) {
    for (int k = 0; k < 4; ++k) {
      const Vector2d expected = *camera.model.Project(T_c_g * points.col(4 * id + kOurs[k]));
      EXPECT_LT((Vector2d(corners[k].x, corners[k].y) - expected).norm(), 5.0) << id;
    }
  }
}

// ... and on photos of real AprilGrids of six columns the same corner is the lower right, that is,
// nearest to where the next tag and away from where the next row is.
TEST(AprilGridTag, IsTurnedAsOnRealBoards) {
  const char* data = std::getenv("CALIBRATO_DATA");
  if (data == nullptr) GTEST_SKIP() << "CALIBRATO_DATA names no folder with aprilgrid_photos";
  int num_compared = 0;
  for (const char* name : {"EuRoC", "TUM_VI", "r45", "right"}) {
    const Tags tags = DetectTags(
        cv::imread(std::string(data) + "/aprilgrid_photos/" + name + ".png", cv::IMREAD_GRAYSCALE));
    for (const auto& [id, corners] : tags) {
      const auto right = tags.find(id + 1);
      const auto up = tags.find(id + 6);
      if (id % 6 == 5 || right == tags.end() || up == tags.end()) continue;
      const cv::Point2f x = right->second[1] - corners[1];
      const cv::Point2f y = up->second[1] - corners[1];
      EXPECT_GT(x.dot(corners[0] - corners[1]),
                0.9 * cv::norm(x) * cv::norm(corners[0] - corners[1]));
      EXPECT_GT(y.dot(corners[2] - corners[1]),
                0.9 * cv::norm(y) * cv::norm(corners[2] - corners[1]));
      ++num_compared;
    }
  }
  EXPECT_GT(num_compared, 40);
}

// A grey world behind a layer is the image that RenderBoard makes at once.
TEST(RenderBoardLayer, OverGreyIsTheBoardBeforeGrey) {
  const BoardPattern pattern = PatternOf(Checkerboard{6, 7, 0.06, 0.06});
  for (const double blur_px : {0.0, 0.8}) {
    for (const Camera& camera : {Ordinary(), Backward()}) {
      Scene scene;
      scene.blur_px = blur_px;
      const Rigid3 T_c_g = Pose(camera, {350.0, 200.0}, 0.7, {0.3, -0.2, 0.5}, {0.15, 0.18, 0.0});
      const Exposure whole = RenderBoard(pattern, camera, T_c_g, scene);
      const BoardLayer layer =
          RenderBoardLayer(pattern, camera, {[&](double) { return T_c_g; }}, scene);
      double worst = 0.0;
      for (size_t k = 0; k < whole.pixels.size(); ++k) {
        const double pixel = layer.light.pixels[k] + (1.0 - layer.coverage[k]) * scene.background;
        worst = std::max(worst, std::abs(pixel - whole.pixels[k]));
      }
      EXPECT_LT(worst, 0.01);
    }
  }
}

TEST(RenderBoardLayer, OfSeveralInstantsIsTheirMean) {
  const BoardPattern pattern = PatternOf(Checkerboard{6, 7, 0.06, 0.06});
  const Camera camera = Ordinary();
  std::vector<PoseOfRow> instants;
  std::vector<float> mean(640 * 480, 0.0F);
  for (int i = 0; i < 4; ++i) {
    const Rigid3 T_c_g =
        Pose(camera, {300.0 + 2.0 * i, 200.0}, 0.7, {0.3, 0.01 * i, 0.5}, {0.15, 0.18, 0.0});
    instants.emplace_back([T_c_g](double) { return T_c_g; });
    const Exposure one = RenderBoard(pattern, camera, T_c_g, Scene());
    for (size_t k = 0; k < mean.size(); ++k) mean[k] += 0.25F * one.pixels[k];
  }
  const BoardLayer layer = RenderBoardLayer(pattern, camera, instants, Scene());
  double worst = 0.0;
  for (size_t k = 0; k < mean.size(); ++k) {
    const double pixel = layer.light.pixels[k] + (1.0 - layer.coverage[k]) * Scene().background;
    worst = std::max(worst, std::abs(pixel - mean[k]));
  }
  EXPECT_LT(worst, 0.01);
}

// Through a rolling shutter each row is that of the still image at the row's own pose.
TEST(RenderBoardLayer, RollingShutterShowsEachRowAtItsOwnPose) {
  const BoardPattern pattern = PatternOf(Checkerboard{6, 7, 0.06, 0.06});
  const Camera camera = Ordinary();
  const PoseOfRow pose_of_row = [&](double row) {
    // 30 px to the right and 10 px down from the first row to the last, and a turn.
    const double share = row / 480.0;
    return Pose(camera, {300.0 + 30.0 * share, 220.0 + 10.0 * share}, 0.7, {0.3, 0.05 * share, 0.5},
                {0.15, 0.18, 0.0});
  };
  const BoardLayer rolling = RenderBoardLayer(pattern, camera, {pose_of_row}, Scene());
  for (const int row : {150, 200, 250, 300}) {
    const Rigid3 T_c_g = pose_of_row(row);
    const BoardLayer still =
        RenderBoardLayer(pattern, camera, {[&](double) { return T_c_g; }}, Scene());
    double worst = 0.0;
    double contrast = 0.0;
    for (int u = 0; u < 640; ++u) {
      const size_t k = 640 * static_cast<size_t>(row) + u;
      worst = std::max<double>(worst, std::abs(rolling.light.pixels[k] - still.light.pixels[k]));
      contrast = std::max<double>(contrast, still.light.pixels[k]);
    }
    EXPECT_GT(contrast, 200.0);
    // Within a row the shutter goes on: half a row's way, 0.03 px, of a contrast of 200.
    EXPECT_LT(worst, 8.0) << row;
  }
}

}  // namespace
}  // namespace calibrato
