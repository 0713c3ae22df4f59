#include "calibrato/diagnosis/camera_diagnosis.h"

#include <gtest/gtest.h>

#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {
namespace {

CameraProblem MakeProblem(int num_views, double noise, uint64_t seed) {
  Eigen::VectorXd parameters(8);
  parameters << 585.0, 590.0, 322.0, 236.0, -0.2, 0.05, 0.0, 0.0;
  Rng rng(seed);
  CameraProblem problem;
  problem.resolution = {640, 480};
  problem.views = SyntheticViews(CameraModel("pinhole-radtan", parameters), problem.resolution,
                                 Checkerboard{6, 7, 0.055, 0.055}, num_views, noise, rng);
  return problem;
}

std::vector<Finding> Diagnose(const CameraProblem& problem) {
  return DiagnoseCamera(problem, CalibrateCamera(problem));
}

bool Mentions(const std::vector<Finding>& findings, const std::string& words) {
  for (const Finding& finding : findings) {
    if (finding.what.find(words) != std::string::npos) return true;
  }
  return false;
}

TEST(DiagnoseCamera, PassesGoodData) {
  const auto findings = Diagnose(MakeProblem(60, 0.1, 1));
  EXPECT_EQ(VerdictOf(findings), Verdict::kPass) << (findings.empty() ? "" : findings[0].what);
}

TEST(DiagnoseCamera, FailsWithTwoViews) {
  const auto findings = Diagnose(MakeProblem(2, 0.1, 2));
  EXPECT_EQ(VerdictOf(findings), Verdict::kFail);
  EXPECT_TRUE(Mentions(findings, "only 2 views"));
}

TEST(DiagnoseCamera, FailsWhereTheFocalLengthIsVague) {
  const auto findings = Diagnose(MakeProblem(3, 8.0, 3));
  EXPECT_EQ(VerdictOf(findings), Verdict::kFail);
  EXPECT_TRUE(Mentions(findings, "focal length"));
}

TEST(DiagnoseCamera, WarnsWhereTheBoardStayedInOnePlace) {
  CameraProblem problem = MakeProblem(60, 0.1, 4);
  std::erase_if(problem.views, [](const BoardView& view) {
    return std::abs(view.pixels.row(0).mean() - 320.0) > 60.0;
  });
  ASSERT_GT(problem.views.size(), 6U);
  const auto findings = Diagnose(problem);
  EXPECT_EQ(VerdictOf(findings), Verdict::kWarn);
  EXPECT_TRUE(Mentions(findings, "from left to right"));
}

TEST(DiagnoseCamera, WarnsWhereTheHalvesDisagree) {
  // Every second view comes from a camera whose centre is 10 px away.
  CameraProblem problem = MakeProblem(40, 0.1, 5);
  for (size_t v = 0; v < problem.views.size(); v += 2) {
    problem.views[v].pixels.row(0).array() += 10.0;
  }
  const auto findings = Diagnose(problem);
  EXPECT_TRUE(Mentions(findings, "halves of the views disagree about pu"))
      << ToJson(ToValue(findings));
}

TEST(Verdict, IsTheWorstFinding) {
  EXPECT_EQ(VerdictOf({}), Verdict::kPass);
  EXPECT_EQ(VerdictOf({{Severity::kInfo, "", ""}}), Verdict::kPass);
  EXPECT_EQ(VerdictOf({{Severity::kWarn, "", ""}, {Severity::kInfo, "", ""}}), Verdict::kWarn);
  EXPECT_EQ(VerdictOf({{Severity::kWarn, "", ""}, {Severity::kFail, "", ""}}), Verdict::kFail);
}

}  // namespace
}  // namespace calibrato
