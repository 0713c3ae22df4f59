#include "calibrato/diagnosis/camera_diagnosis.h"

#include <gtest/gtest.h>

#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};
const Board kBoard = Checkerboard{6, 7, 0.062, 0.062};

CameraModel Lens(double k1 = -0.2) {
  Eigen::VectorXd parameters(8);
  parameters << 585.0, 590.0, 322.0, 236.0, k1, 0.05, 0.0, 0.0;
  return {"pinhole-radtan", parameters};
}

CameraProblem MakeProblem(int num_views, double noise, uint64_t seed) {
  Rng rng(seed);
  CameraProblem problem;
  problem.resolution = kImage;
  problem.views = SyntheticViews(Lens(), kImage, kBoard, num_views, noise, rng);
  return problem;
}

// Views from these poses, with noise.
CameraProblem ProblemFrom(const std::vector<Rigid3>& poses, Rng rng) {
  CameraProblem problem;
  problem.resolution = kImage;
  for (const Rigid3& T_c_g : poses) {
    BoardView view;
    view.name = "photo" + std::to_string(problem.views.size());
    view.points_g = BoardPoints(kBoard);
    view.pixels.resize(2, view.points_g.cols());
    for (Eigen::Index k = 0; k < view.points_g.cols(); ++k) {
      view.corner_ids.push_back(static_cast<int>(k));
      view.pixels.col(k) = *Lens().Project(T_c_g * view.points_g.col(k)) +
                           0.1 * Eigen::Vector2d(rng.Normal(), rng.Normal());
    }
    problem.views.push_back(view);
  }
  return problem;
}

// The board's middle at a place in the camera, turned by `tilt` from facing it.
Rigid3 Pose(const Eigen::Vector3d& middle_c, const Eigen::Vector3d& tilt) {
  const Eigen::Matrix3d R = ExpSo3(tilt) * ExpSo3({3.14159265, 0.0, 0.0});
  return {R, middle_c - R * BoardCentre(kBoard)};
}

CameraDiagnosis Diagnose(const CameraProblem& problem) {
  return DiagnoseCamera(problem, CalibrateCamera(problem));
}

const Finding* Find(const CameraDiagnosis& diagnosis, const std::string& words) {
  for (const Finding& finding : diagnosis.findings) {
    if (finding.what.find(words) != std::string::npos) return &finding;
  }
  return nullptr;
}

std::string Text(const CameraDiagnosis& diagnosis) { return ToJson(ToValue(diagnosis.findings)); }

TEST(DiagnoseCamera, PassesGoodData) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const CameraDiagnosis diagnosis = Diagnose(MakeProblem(60, 0.1, seed));
    EXPECT_EQ(VerdictOf(diagnosis.findings), Verdict::kPass) << Text(diagnosis);
    EXPECT_TRUE(diagnosis.split && diagnosis.residual_field && diagnosis.board_shape);
  }
}

TEST(DiagnoseCamera, FailsWithTwoViews) {
  const CameraDiagnosis diagnosis = Diagnose(MakeProblem(2, 0.1, 2));
  EXPECT_EQ(VerdictOf(diagnosis.findings), Verdict::kFail);
  EXPECT_TRUE(Find(diagnosis, "only 2 views")) << Text(diagnosis);
}

TEST(DiagnoseCamera, CountsWhyViewsFitNoLens) {
  CameraProblem problem = MakeProblem(5, 0.1, 14);
  Rng rng(15);
  for (const size_t v : {0U, 2U}) {
    for (double& x : problem.views[v].pixels.reshaped()) x = rng.Uniform(0.0, 400.0);
  }
  BoardView& few = problem.views[4];
  few.corner_ids.resize(3);
  few.pixels = few.pixels.leftCols<3>().eval();
  few.points_g = few.points_g.leftCols<3>().eval();
  const CameraDiagnosis diagnosis = Diagnose(problem);
  EXPECT_EQ(VerdictOf(diagnosis.findings), Verdict::kFail);
  EXPECT_TRUE(Find(diagnosis, "only 2 of 5 views fit one lens")) << Text(diagnosis);
  EXPECT_TRUE(Find(diagnosis, "1 left out as 'too few corners'")) << Text(diagnosis);
  EXPECT_TRUE(Find(diagnosis, "2 left out as '")) << Text(diagnosis);
}

TEST(DiagnoseCamera, SaysAtWhatAParameterIsHeld) {
  CameraProblem problem = MakeProblem(40, 0.1, 16);
  HoldParameters({"fv", "pu", "k2"}, &problem);
  const CameraDiagnosis diagnosis = Diagnose(problem);
  EXPECT_TRUE(Find(diagnosis, "fv is held at 589")) << Text(diagnosis);
  EXPECT_TRUE(Find(diagnosis, "pu is held at 319.5, the middle of the image")) << Text(diagnosis);
  EXPECT_FALSE(Find(diagnosis, "k2 is held")) << Text(diagnosis);
}

// Nearly frontal views do not tell the focal length: to hold what they say makes it no better
// known.
TEST(DiagnoseCamera, FailsWhereAFocalLengthIsHeldAtAVagueEstimate) {
  std::vector<Rigid3> poses;
  Rng rng(18);
  for (int k = 0; k < 12; ++k) {
    const Eigen::Vector3d tilt(rng.Uniform(-0.03, 0.03), rng.Uniform(-0.03, 0.03),
                               rng.Uniform(-0.4, 0.4));
    poses.push_back(
        Pose({rng.Uniform(-0.2, 0.2), rng.Uniform(-0.15, 0.15), rng.Uniform(0.8, 1.4)}, tilt));
  }
  CameraProblem problem = ProblemFrom(poses, Rng(19));
  ASSERT_TRUE(Find(Diagnose(problem), "the focal length is known to"));
  HoldParameters({"fu"}, &problem);
  const CameraDiagnosis held = Diagnose(problem);
  EXPECT_EQ(VerdictOf(held.findings), Verdict::kFail) << Text(held);
  const Finding* finding = Find(held, "fu is held at what these views say");
  ASSERT_TRUE(finding) << Text(held);
  EXPECT_EQ(finding->severity, Severity::kFail);
  EXPECT_NE(finding->remedy.find("--fix fu=VALUE"), std::string::npos) << finding->remedy;
  // With its value known there is nothing vague.
  HoldParameters({"fu=585"}, &problem);
  EXPECT_FALSE(Find(Diagnose(problem), "fu is held"));
}

TEST(DiagnoseCamera, FailsWhereTheFocalLengthIsVague) {
  const CameraDiagnosis diagnosis = Diagnose(MakeProblem(3, 8.0, 3));
  EXPECT_EQ(VerdictOf(diagnosis.findings), Verdict::kFail);
  EXPECT_TRUE(Find(diagnosis, "focal length")) << Text(diagnosis);
}

TEST(DiagnoseCamera, WarnsWhereTheBoardStayedInOnePlace) {
  CameraProblem problem = MakeProblem(60, 0.1, 4);
  std::erase_if(problem.views, [](const BoardView& view) {
    return std::abs(view.pixels.row(0).mean() - 320.0) > 60.0;
  });
  ASSERT_GT(problem.views.size(), 6U);
  const CameraDiagnosis diagnosis = Diagnose(problem);
  EXPECT_EQ(VerdictOf(diagnosis.findings), Verdict::kWarn);
  EXPECT_TRUE(Find(diagnosis, "from left to right")) << Text(diagnosis);
}

TEST(DiagnoseCamera, NamesThePartOfTheImageThatWasNeverCovered) {
  CameraProblem problem = MakeProblem(80, 0.1, 6);
  std::erase_if(problem.views, [](const BoardView& view) {
    const auto is_top_left =
        view.pixels.row(0).array() < 215.0 && view.pixels.row(1).array() < 162.0;
    return is_top_left.any();
  });
  const CameraDiagnosis diagnosis = Diagnose(problem);
  EXPECT_TRUE(Find(diagnosis, "the top left of the image was never covered")) << Text(diagnosis);
}

TEST(DiagnoseCamera, DoesNotTakeAViewThatDoesNotFitForCover) {
  CameraProblem problem = MakeProblem(80, 0.1, 6);
  std::erase_if(problem.views, [](const BoardView& view) {
    const auto is_top_left =
        view.pixels.row(0).array() < 215.0 && view.pixels.row(1).array() < 162.0;
    return is_top_left.any();
  });
  BoardView wrong = problem.views.front();
  Rng rng(17);
  for (Eigen::Index k = 0; k < wrong.num_corners(); ++k) {
    wrong.pixels.col(k) << rng.Uniform(0.0, 200.0), rng.Uniform(0.0, 150.0);
  }
  problem.views.push_back(wrong);
  const CameraDiagnosis diagnosis = Diagnose(problem);
  const std::string left_out = "1 of " + std::to_string(problem.views.size()) + " views";
  EXPECT_TRUE(Find(diagnosis, left_out)) << Text(diagnosis);
  EXPECT_TRUE(Find(diagnosis, "the top left of the image was never covered")) << Text(diagnosis);
}

TEST(DiagnoseCamera, SaysThatTheBoardWasNeverTilted) {
  std::vector<Rigid3> poses;
  for (const double x : {-0.3, 0.0, 0.3}) {
    for (const double y : {-0.2, 0.0, 0.2}) {
      const double angle = 0.05 * static_cast<double>(poses.size() % 3);
      // Towards the camera's middle, so that the line of sight is the normal.
      poses.push_back(Pose({x, y, 1.0}, {angle - y, x, 0.0}));
    }
  }
  const CameraDiagnosis diagnosis = Diagnose(ProblemFrom(poses, Rng(7)));
  const Finding* finding = Find(diagnosis, "fronto-parallel");
  ASSERT_TRUE(finding) << Text(diagnosis);
  EXPECT_NE(finding->remedy.find("tilt the board"), std::string::npos);
  EXPECT_TRUE(Find(diagnosis, "about the same distance")) << Text(diagnosis);
}

TEST(DiagnoseCamera, WarnsWhereTheHalvesDisagree) {
  // In every second run of neighbours the camera's centre is 10 px away.
  CameraProblem problem = MakeProblem(40, 0.1, 5);
  for (size_t v = 0; v < problem.views.size(); ++v) {
    if ((v / 4) % 2 == 0) problem.views[v].pixels.row(0).array() += 10.0;
  }
  problem.reject_outliers = false;
  const CameraDiagnosis diagnosis = Diagnose(problem);
  EXPECT_TRUE(Find(diagnosis, "halves of the views disagree about pu")) << Text(diagnosis);
  EXPECT_EQ(VerdictOf(diagnosis.findings), Verdict::kWarn);
}

TEST(DiagnoseCamera, NamesTheModelThatFitsTheLens) {
  Rng rng(8);
  CameraProblem problem;
  problem.model = "pinhole-none";
  problem.resolution = kImage;
  problem.views = SyntheticViews(Lens(-0.25), kImage, kBoard, 40, 0.1, rng);
  const CameraDiagnosis diagnosis = Diagnose(problem);
  const Finding* finding = Find(diagnosis, "pinhole-none does not fit this lens");
  ASSERT_TRUE(finding) << Text(diagnosis);
  EXPECT_NE(finding->remedy.find("pinhole-radtan,"), std::string::npos) << finding->remedy;
  EXPECT_EQ(VerdictOf(diagnosis.findings), Verdict::kWarn);
}

TEST(DiagnoseCamera, AccusesABentBoard) {
  // 4 mm over a board of 0.48 m.
  Rng rng(9);
  CameraProblem problem = MakeProblem(40, 0.1, 9);
  const CameraCalibration truth = CalibrateCamera(problem);
  const Eigen::Vector3d middle = BoardCentre(kBoard);
  for (size_t v = 0; v < problem.views.size(); ++v) {
    BoardView& view = problem.views[v];
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      Eigen::Vector3d point_g = view.points_g.col(k);
      point_g.z() += 0.11 * std::pow(point_g.y() - middle.y(), 2);
      view.pixels.col(k) = *Lens().Project(truth.T_c_g[v] * point_g) +
                           0.1 * Eigen::Vector2d(rng.Normal(), rng.Normal());
    }
  }
  const CameraDiagnosis diagnosis = Diagnose(problem);
  EXPECT_TRUE(Find(diagnosis, "the board is not flat")) << Text(diagnosis);
  EXPECT_NEAR(diagnosis.board_shape->bending.depth_m, 0.11 * std::pow(0.186, 2), 3e-4);
}

TEST(DiagnoseCamera, AccusesABoardWhoseTargetFileIsWrong) {
  CameraProblem problem = MakeProblem(40, 0.1, 10);
  for (BoardView& view : problem.views) view.points_g.row(1) *= 0.97;  // 3.1 % too short.
  const CameraDiagnosis diagnosis = Diagnose(problem);
  EXPECT_FALSE(Find(diagnosis, "not flat")) << Text(diagnosis);
  EXPECT_TRUE(Find(diagnosis, "along y its points are")) << Text(diagnosis);
  EXPECT_NEAR(diagnosis.board_shape->stretch->stretch, 0.031, 3e-3);
}

TEST(DiagnoseCamera, NamesViewsThatWereLeftOut) {
  CameraProblem problem = MakeProblem(40, 0.1, 11);
  // Two rows taken for each other.
  Eigen::Matrix2Xd& pixels = problem.views[3].pixels;
  const Eigen::Matrix2Xd row = pixels.leftCols<7>();
  pixels.leftCols<7>() = pixels.middleCols<7>(21).eval();
  pixels.middleCols<7>(21) = row;
  problem.views[3].name = "left03.jpg";
  const CameraDiagnosis diagnosis = Diagnose(problem);
  EXPECT_TRUE(Find(diagnosis, "left03.jpg") || Find(diagnosis, "outliers")) << Text(diagnosis);
  EXPECT_EQ(VerdictOf(diagnosis.findings), Verdict::kPass) << Text(diagnosis);
}

TEST(DiagnoseCamera, TellsMotionBlurByTheBoardsSpeed) {
  CameraProblem problem = MakeProblem(60, 0.1, 12);
  Rng rng(13);
  Time stamp = Time::FromNanoseconds(1);
  for (size_t v = 0; v < problem.views.size(); ++v) {
    // Each image either soon after the one before it or long after, and then without blur.
    const bool is_fast = rng.Uniform() < 0.5;
    stamp = stamp + Duration::FromSeconds(is_fast ? 0.1 : 2.0);
    problem.views[v].stamp = stamp;
    if (!is_fast) continue;
    for (double& x : problem.views[v].pixels.reshaped()) x += 0.2 * rng.Normal();
  }
  const CameraDiagnosis diagnosis = Diagnose(problem);
  EXPECT_TRUE(Find(diagnosis, "while the board moves fast")) << Text(diagnosis);
}

TEST(DiagnoseCamera, SaysTheWorstFirst) {
  const CameraDiagnosis diagnosis = Diagnose(MakeProblem(3, 8.0, 3));
  for (size_t i = 1; i < diagnosis.findings.size(); ++i) {
    EXPECT_GE(diagnosis.findings[i - 1].severity, diagnosis.findings[i].severity);
  }
}

TEST(Verdict, IsTheWorstFinding) {
  EXPECT_EQ(VerdictOf({}), Verdict::kPass);
  EXPECT_EQ(VerdictOf({{Severity::kInfo, "", ""}}), Verdict::kPass);
  EXPECT_EQ(VerdictOf({{Severity::kWarn, "", ""}, {Severity::kInfo, "", ""}}), Verdict::kWarn);
  EXPECT_EQ(VerdictOf({{Severity::kWarn, "", ""}, {Severity::kFail, "", ""}}), Verdict::kFail);
}

TEST(Format, IsThatOfPrintf) {
  EXPECT_EQ(Format("%d views, %.2f px", 7, 0.125), "7 views, 0.12 px");
  EXPECT_EQ(Format("%s", std::string(300, 'x').c_str()).size(), 300U);
}

}  // namespace
}  // namespace calibrato
