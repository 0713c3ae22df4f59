#include "calibrato/calibration/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "calibrato/base/parallel.h"
#include "calibrato/calibration/start_values.h"
#include "calibrato/calibration/synthetic_views_for_test.h"
#include "calibrato/calibration/view_fit.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};
const Board kBoard = Checkerboard{6, 7, 0.03, 0.03};

CameraModel Lens() {
  Eigen::VectorXd parameters(9);
  parameters << 585.0, 590.0, 322.0, 236.0, -0.2, 0.05, 0.001, -0.002, 0.02;
  return {"pinhole-radtan5", parameters};
}

struct Problem {
  std::vector<BoardView> views;
  BundleAdjustmentState start;
};

Problem MakeProblem(int num_views, double noise, uint64_t seed) {
  Rng rng(seed);
  Problem problem{SyntheticViews(Lens(), kImage, kBoard, num_views, noise, rng), {}};
  // Two percent off, and without distortion.
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(9);
  parameters.head<4>() << 600.0, 600.0, 319.5, 239.5;
  problem.start.models = {CameraModel("pinhole-radtan5", parameters)};
  for (const BoardView& view : problem.views) {
    problem.start.T_c0_g.push_back(StartView(problem.start.models[0], view).T_c_g);
  }
  return problem;
}

TEST(AdjustBundle, RecoversTheTruthWithoutNoise) {
  const Problem problem = MakeProblem(15, 0.0, 1);
  const auto result = AdjustBundle(problem.start, ViewsOfOneCamera(problem.views), {});
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_LT((result.state.models[0].parameters() - Lens().parameters()).norm(), 1e-6);
  EXPECT_LT(result.cost_px2, 1e-14);
}

// The gradient of the whole problem by differences, as an oracle that knows nothing of elimination.
TEST(AdjustBundle, EndsWhereTheGradientVanishes) {
  const Problem problem = MakeProblem(8, 0.3, 2);
  const auto result = AdjustBundle(problem.start, ViewsOfOneCamera(problem.views), {});
  const auto cost = [&](const Eigen::VectorXd& parameters, const std::vector<Rigid3>& poses) {
    double sum = 0.0;
    for (size_t v = 0; v < problem.views.size(); ++v) {
      sum += ReprojectionResiduals(CameraModel("pinhole-radtan5", parameters), problem.views[v],
                                   poses[v])
                 .squaredNorm();
    }
    return sum;
  };
  const Eigen::VectorXd estimate = result.state.models[0].parameters();
  const double least = cost(estimate, result.state.T_c0_g);
  EXPECT_NEAR(least, result.cost_px2, 1e-9);
  for (Eigen::Index i = 0; i < estimate.size(); ++i) {
    for (const double sign : {-1.0, 1.0}) {
      Eigen::VectorXd moved = estimate;
      moved(i) += sign * 1e-5 * std::max(1.0, std::abs(estimate(i)));
      EXPECT_GT(cost(moved, result.state.T_c0_g), least) << i;
    }
  }
  for (int i = 0; i < 6; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      std::vector<Rigid3> poses = result.state.T_c0_g;
      Eigen::Matrix<double, 6, 1> delta = Eigen::Matrix<double, 6, 1>::Zero();
      delta(i) = sign * 1e-5;
      poses[3] = poses[3].Perturbed(delta);
      EXPECT_GT(cost(estimate, poses), least) << i;
    }
  }
}

TEST(AdjustBundle, HoldsFixedParameters) {
  const Problem problem = MakeProblem(10, 0.1, 3);
  BundleAdjustmentOptions options;
  options.fixed_parameters = {{false, false, true, false, false, false, true, true, false}};
  const auto result = AdjustBundle(problem.start, ViewsOfOneCamera(problem.views), options);
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_EQ(result.state.models[0].parameters()(2), problem.start.models[0].parameters()(2));
  EXPECT_EQ(result.state.models[0].parameters()(6), 0.0);
  EXPECT_EQ(result.state.models[0].parameters()(7), 0.0);
  EXPECT_NE(result.state.models[0].parameters()(8), 0.0);
}

TEST(AdjustBundle, SaysWhenItWasStopped) {
  const Problem problem = MakeProblem(10, 0.1, 4);
  BundleAdjustmentOptions options;
  options.max_iterations = 1;
  EXPECT_EQ(AdjustBundle(problem.start, ViewsOfOneCamera(problem.views), options).termination,
            Termination::kIterationLimit);
}

TEST(AdjustBundle, IsTheSameToTheBitForAnyNumberOfThreads) {
  const Problem problem = MakeProblem(150, 0.2, 5);
  SetNumThreads(1);
  const auto one = AdjustBundle(problem.start, ViewsOfOneCamera(problem.views), {});
  SetNumThreads(4);
  const auto four = AdjustBundle(problem.start, ViewsOfOneCamera(problem.views), {});
  SetNumThreads(0);
  EXPECT_EQ(one.state.models[0].parameters(), four.state.models[0].parameters());
  EXPECT_EQ(one.cost_px2, four.cost_px2);
}

// The whole Jacobian by differences, all poses in it, inverted densely: the marginal block must be
// the inverse of the eliminated information.
TEST(CameraInformation, IsTheInverseOfTheDenseMarginalCovariance) {
  const Problem problem = MakeProblem(4, 0.1, 6);
  const auto state = AdjustBundle(problem.start, ViewsOfOneCamera(problem.views), {}).state;
  const int num_parameters = 9;
  const int num_columns = num_parameters + 6 * 4;
  const int rows_per_view = 2 * 42;
  const auto residuals = [&](const Eigen::VectorXd& delta) {
    Eigen::VectorXd r(rows_per_view * 4);
    const CameraModel model("pinhole-radtan5",
                            state.models[0].parameters() + delta.head(num_parameters));
    for (int v = 0; v < 4; ++v) {
      const Rigid3 T =
          state.T_c0_g[static_cast<size_t>(v)].Perturbed(delta.segment<6>(num_parameters + 6 * v));
      const Eigen::Matrix2Xd e =
          ReprojectionResiduals(model, problem.views[static_cast<size_t>(v)], T);
      r.segment(rows_per_view * v, rows_per_view) = e.reshaped();
    }
    return r;
  };
  Eigen::MatrixXd J(rows_per_view * 4, num_columns);
  for (int i = 0; i < num_columns; ++i) {
    Eigen::VectorXd delta = Eigen::VectorXd::Zero(num_columns);
    const double step = i < 4 ? 1e-3 : 1e-6;
    delta(i) = step;
    J.col(i) = (residuals(delta) - residuals(-delta)) / (2.0 * step);
  }
  const Eigen::MatrixXd covariance =
      (J.transpose() * J).inverse().topLeftCorner(num_parameters, num_parameters);
  const Eigen::MatrixXd information =
      CameraInformation(state.models[0], state.T_c0_g, problem.views, {});
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd expected = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::MatrixXd actual =
      scale.asDiagonal() * Eigen::MatrixXd(information.inverse()) * scale.asDiagonal();
  EXPECT_LT((actual - expected).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(CameraInformation, AddsOverViews) {
  const Problem problem = MakeProblem(6, 0.1, 7);
  const auto state = AdjustBundle(problem.start, ViewsOfOneCamera(problem.views), {}).state;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(9, 9);
  for (size_t v = 0; v < 6; ++v) {
    sum += CameraInformation(state.models[0], {state.T_c0_g[v]}, {problem.views[v]}, {});
  }
  const Eigen::MatrixXd whole = CameraInformation(state.models[0], state.T_c0_g, problem.views, {});
  EXPECT_LT((sum - whole).norm(), 1e-10 * whole.norm());
}

}  // namespace
}  // namespace calibrato
