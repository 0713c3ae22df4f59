#include "calibrato/calibration/camera_rig_calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/calibration/synthetic_rig_for_test.h"
#include "calibrato/sensors/board_symmetry.h"

namespace calibrato {
namespace {

const Board kBoard = Checkerboard{6, 7, 0.03, 0.03};

// Three cameras side by side, turned a little outwards, of different lenses.
SyntheticRig Trinocular() {
  Eigen::VectorXd radtan(8);
  radtan << 460.0, 458.0, 322.0, 236.0, -0.2, 0.05, 0.001, -0.002;
  Eigen::VectorXd equi(8);
  equi << 300.0, 301.0, 318.0, 241.0, 0.01, -0.005, 0.002, 0.001;
  Eigen::VectorXd plain(4);
  plain << 420.0, 421.0, 325.0, 238.0;
  return {{CameraModel("pinhole-radtan", radtan), CameraModel("pinhole-equi", equi),
           CameraModel("pinhole-none", plain)},
          {{ExpSo3({0.01, 0.15, -0.02}), {-0.11, 0.003, 0.002}},
           {ExpSo3({-0.02, 0.1, 0.03}), {-0.09, -0.004, 0.006}}}};
}

CameraRigProblem MakeProblem(double noise, uint64_t seed, int num_frames = 30) {
  Rng rng(seed);
  return MakeRigProblem(Trinocular(), kBoard, num_frames, noise, rng);
}

// Estimate less truth, in the order of the covariance's names.
Eigen::VectorXd ErrorOf(const CameraRigCalibration& result, const SyntheticRig& truth) {
  Eigen::VectorXd error(result.covariance.rows());
  Eigen::Index next = 0;
  for (size_t c = 0; c < truth.models.size(); ++c) {
    const Eigen::VectorXd difference =
        result.cameras[c].model->parameters() - truth.models[c].parameters();
    error.segment(next, difference.size()) = difference;
    next += difference.size();
    if (c == 0) continue;
    error.segment<6>(next) = result.T_cn_cnm1[c - 1]->DifferenceTo(truth.T_cn_cnm1[c - 1]);
    next += 6;
  }
  EXPECT_EQ(next, error.size());
  return error;
}

TEST(CalibrateCameraRig, RecoversLensesAndRelationsWithoutNoise) {
  const CameraRigCalibration result = CalibrateCameraRig(MakeProblem(0.0, 1));
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_LT(ErrorOf(result, Trinocular()).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(CalibrateCameraRig, NamesFollowTheFormats) {
  const CameraRigCalibration result = CalibrateCameraRig(MakeProblem(0.2, 2));
  ASSERT_EQ(result.covariance_names.size(), 8U + 8U + 6U + 4U + 6U);
  EXPECT_EQ(result.covariance_names.front(), "cam0.fu");
  EXPECT_EQ(result.covariance_names[8], "cam1.fu");
  EXPECT_EQ(result.covariance_names[16], "cam1.rot_x");
  EXPECT_EQ(result.covariance_names[19], "cam1.pos_x");
  EXPECT_EQ(result.covariance_names.back(), "cam2.pos_z");
  EXPECT_EQ(result.covariance.rows(), 32);
}

TEST(CalibrateCameraRig, ErrorsAreAsLargeAsTheCovarianceSays) {
  double sum = 0.0;
  constexpr int kNumRigs = 30;
  for (uint64_t seed = 0; seed < kNumRigs; ++seed) {
    const CameraRigCalibration result = CalibrateCameraRig(MakeProblem(0.2, 100 + seed, 20));
    ASSERT_EQ(result.termination, Termination::kConverged);
    const Eigen::VectorXd error = ErrorOf(result, Trinocular());
    sum += error.dot(result.covariance.ldlt().solve(error));
  }
  // Chi-square of 32 x 30 = 960 degrees of freedom: 99.9 % lie within 960 +- 144.
  EXPECT_NEAR(sum, 960.0, 150.0);
}

TEST(CalibrateCameraRig, TogetherTheyKnowMoreThanAlone) {
  const CameraRigProblem problem = MakeProblem(0.2, 3);
  const CameraRigCalibration result = CalibrateCameraRig(problem);
  for (size_t c = 0; c < 3; ++c) {
    const CameraCalibration alone = CalibrateCamera(problem.cameras[c]);
    EXPECT_LT(result.cameras[c].covariance(0, 0), alone.covariance(0, 0)) << c;
  }
}

TEST(CalibrateCameraRig, FramesThatAreNotSimultaneousAreFoundAndDoNoHarm) {
  CameraRigProblem problem = MakeProblem(0.2, 4);
  // The views of camera 1 in five frames are taken from others.
  for (const size_t v : {2U, 7U, 12U, 15U, 20U}) {
    std::swap(problem.cameras[1].views[v], problem.cameras[1].views[v + 1]);
  }
  const CameraRigCalibration result = CalibrateCameraRig(problem);
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_EQ(result.num_separated_views, 10);
  const Eigen::VectorXd error = ErrorOf(result, Trinocular());
  EXPECT_LT(error.dot(result.covariance.ldlt().solve(error)), 62.5);  // 99.9 % of chi-square, 32
  for (const CameraCalibration& camera : result.cameras) {
    EXPECT_TRUE(camera.rejected_views.empty());
  }
}

TEST(CalibrateCameraRig, CamerasWithoutSharedFramesAreCalibratedOnTheirOwn) {
  CameraRigProblem problem = MakeProblem(0.2, 5);
  for (int& frame : problem.frame_of_view[2]) frame += 1000;
  const CameraRigCalibration result = CalibrateCameraRig(problem);
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_TRUE(result.T_cn_cnm1[0]);
  EXPECT_FALSE(result.T_cn_cnm1[1]);
  EXPECT_EQ(result.num_shared_frames[1], 0);
  const CameraCalibration alone = CalibrateCamera(problem.cameras[2]);
  EXPECT_LT((result.cameras[2].model->parameters() - alone.model->parameters()).norm(), 1e-9);
  EXPECT_EQ(result.covariance.rows(), 8 + 8 + 6 + 4);
  EXPECT_EQ(result.covariance_names.back(), "cam2.pv");
  EXPECT_EQ(result.covariance(25, 0), 0.0);
}

// Camera 1 sees nothing together with the others, which are related all the same.
TEST(CalibrateCameraRig, RelatesACameraToAnEarlierOneThanItsNeighbour) {
  const CameraRigProblem together = MakeProblem(0.2, 5);
  CameraRigProblem problem = together;
  for (int& frame : problem.frame_of_view[1]) frame += 1000;
  const CameraRigCalibration result = CalibrateCameraRig(problem);
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_FALSE(result.T_cn_cnm1[0]);
  EXPECT_FALSE(result.T_cn_cnm1[1]);
  EXPECT_FALSE(result.earlier_relations[0]);
  ASSERT_TRUE(result.earlier_relations[1]);
  EXPECT_EQ(result.earlier_relations[1]->camera, 0);
  const SyntheticRig truth = Trinocular();
  const Rigid3 T_c2_c0 = truth.T_cn_cnm1[1] * truth.T_cn_cnm1[0];
  EXPECT_LT(result.earlier_relations[1]->T_cn_camera.DifferenceTo(T_c2_c0).norm(), 5e-3);
  // cam0 and cam2 with their relation, then cam1 on its own.
  ASSERT_EQ(result.covariance_names.size(), 8U + 4U + 6U + 8U);
  EXPECT_EQ(result.covariance_names[8], "cam2.fu");
  EXPECT_EQ(result.covariance_names[12], "cam2.from_cam0.rot_x");
  EXPECT_EQ(result.covariance_names[17], "cam2.from_cam0.pos_z");
  EXPECT_EQ(result.covariance_names[18], "cam1.fu");
  EXPECT_FALSE(CalibrateCameraRig(together).earlier_relations[1]);
}

TEST(CalibrateCameraRig, RefusesOneBendingForCamerasThatAreNotRelated) {
  CameraRigProblem problem = MakeProblem(0.2, 5);
  problem.estimate_bending = true;
  for (int& frame : problem.frame_of_view[1]) frame += 1000;
  const std::string message = InputErrorOf([&] { (void)CalibrateCameraRig(problem); });
  EXPECT_NE(message.find("cam0, cam2 | cam1"), std::string::npos) << message;
  // One that can't be calibrated has no part in it.
  problem.cameras[1].views.clear();
  problem.frame_of_view[1].clear();
  EXPECT_TRUE(CalibrateCameraRig(problem).bending);
}

TEST(CalibrateCameraRig, RefusesTheBendingOfABoardThatLooksTheSameAfterAQuarterTurn) {
  const auto refused = [](const Board& board) {
    Rng rng(21);
    CameraRigProblem problem = MakeRigProblem(Trinocular(), board, 30, 0.2, rng);
    problem.board = board;
    problem.estimate_bending = true;
    return InputErrorOf([&] { (void)CalibrateCameraRig(problem); });
  };
  const std::string checkerboard = refused(Checkerboard{6, 6, 0.03, 0.03});
  EXPECT_NE(checkerboard.find("odd sum"), std::string::npos) << checkerboard;
  const std::string circles = refused(CircleGrid{5, 5, 0.03, false});
  EXPECT_NE(circles.find("asymmetric"), std::string::npos) << circles;
  // Half a turn leaves the bending as it is.
  EXPECT_EQ(refused(Checkerboard{5, 7, 0.03, 0.03}), "");
}

// The views of cameras 1 and 2 numbered from any of the board's sides, frame by frame.
CameraRigProblem NumberedAtWill(const Board& board, uint64_t seed, int num_frames) {
  Rng rng(seed);
  CameraRigProblem problem = MakeRigProblem(Trinocular(), board, num_frames, 0.2, rng);
  problem.board = board;
  const std::vector<BoardTurn> turns = BoardTurns(board);
  for (size_t c = 1; c < problem.cameras.size(); ++c) {
    for (BoardView& view : problem.cameras[c].views) {
      const auto side =
          static_cast<size_t>(rng.Uniform() * (static_cast<double>(turns.size()) + 1.0));
      if (side == turns.size()) continue;
      view = Renumbered(view, turns[side].numbering, BoardPoints(board));
    }
  }
  return problem;
}

TEST(CalibrateCameraRig, NumbersABoardThatLooksTheSameFromSeveralSidesAlikeForAllCameras) {
  for (const Board& board :
       {Board(Checkerboard{6, 8, 0.03, 0.03}), Board(CircleGrid{6, 6, 0.03, false}),
        Board(CircleGrid{6, 4, 0.02, true})}) {
    SCOPED_TRACE(Describe(board));
    const CameraRigCalibration result = CalibrateCameraRig(NumberedAtWill(board, 10, 30));
    EXPECT_EQ(result.termination, Termination::kConverged);
    EXPECT_EQ(result.num_separated_views, 0);
    EXPECT_TRUE(result.groups_of_unknown_side.empty());
    ASSERT_TRUE(result.T_cn_cnm1[0] && result.T_cn_cnm1[1]);
    const Eigen::VectorXd error = ErrorOf(result, Trinocular());
    EXPECT_LT(error.dot(result.covariance.ldlt().solve(error)), 62.5);  // 99.9 % of chi-square, 32
    for (const CameraCalibration& camera : result.cameras) {
      EXPECT_TRUE(camera.rejected_views.empty());
      EXPECT_TRUE(camera.rejected_corners.empty());
    }
  }
}

TEST(CalibrateCameraRig, SaysWhereTheSidesOfTheBoardCannotBeTold) {
  // The cameras share one frame: each side of the board would do.
  CameraRigProblem problem = NumberedAtWill(Checkerboard{6, 8, 0.03, 0.03}, 11, 30);
  const std::vector<int>& frames = problem.frame_of_view[0];
  int shared = -1;
  for (int& frame : problem.frame_of_view[1]) {
    const bool is_shared = std::find(frames.begin(), frames.end(), frame) != frames.end();
    if (is_shared && shared < 0) shared = frame;
    if (frame != shared) frame += 1000;
  }
  std::sort(problem.frame_of_view[1].begin(), problem.frame_of_view[1].end());
  ASSERT_GE(shared, 0);
  problem.cameras.pop_back();
  problem.frame_of_view.pop_back();
  // In the order of the frames: the shared one first.
  std::vector<BoardView>& views = problem.cameras[1].views;
  const auto found = std::find_if(views.begin(), views.end(), [&](const BoardView& view) {
    return view.name == std::to_string(shared);
  });
  std::rotate(views.begin(), found, found + 1);
  const CameraRigCalibration result = CalibrateCameraRig(problem);
  ASSERT_EQ(result.groups_of_unknown_side.size(), 1U);
  EXPECT_EQ(result.groups_of_unknown_side[0], (std::vector<int>{0, 1}));
  // The cameras are turned by 0.15 rad, not by half a turn more.
  ASSERT_TRUE(result.T_cn_cnm1[0]);
  EXPECT_LT(LogSo3(result.T_cn_cnm1[0]->R).norm(), 0.5);
}

TEST(CalibrateCameraRig, ACameraWithoutViewsDoesNotStopTheOthers) {
  CameraRigProblem problem = MakeProblem(0.2, 6);
  problem.cameras[1].views.clear();
  problem.frame_of_view[1].clear();
  const CameraRigCalibration result = CalibrateCameraRig(problem);
  EXPECT_EQ(result.termination, Termination::kNoStart);
  EXPECT_FALSE(result.cameras[1].model);
  EXPECT_EQ(result.cameras[0].termination, Termination::kConverged);
  EXPECT_EQ(result.cameras[2].termination, Termination::kConverged);
}

TEST(CalibrateCameraRig, AHeldParameterStaysAndHasNoVariance) {
  CameraRigProblem problem = MakeProblem(0.2, 7);
  HoldParameters({"k2"}, &problem.cameras[1]);
  const CameraRigCalibration result = CalibrateCameraRig(problem);
  EXPECT_EQ(result.cameras[1].model->parameters()(5), 0.0);
  EXPECT_EQ(result.covariance(13, 13), 0.0);
  EXPECT_GT(result.covariance(12, 12), 0.0);
}

// A board of a metre, bent by a millimetre or not at all.
CameraRigCalibration CalibratedWithBending(double bend_m, uint64_t seed) {
  Eigen::VectorXd parameters(8);
  parameters << 585.0, 590.0, 322.0, 236.0, -0.2, 0.05, 0.001, -0.002;
  Rng rng(seed);
  const CameraModel lens("pinhole-radtan", parameters);
  const Board board = Checkerboard{10, 8, 0.1, 0.1};
  CameraRigProblem problem;
  problem.estimate_bending = true;
  problem.cameras.resize(1);
  problem.cameras[0].resolution = {640, 480};
  const Eigen::Matrix3Xd flat = BoardPoints(board);
  const Eigen::Vector3d centre = BoardCentre(board);
  for (int v = 0; v < 40; ++v) {
    const Eigen::Vector3d tilt(rng.Uniform(-0.7, 0.7), rng.Uniform(-0.7, 0.7), rng.Uniform(-3, 3));
    const Eigen::Matrix3d R = ExpSo3(tilt) * ExpSo3({3.14159265, 0.0, 0.0});
    const Rigid3 T{
        R, Eigen::Vector3d(rng.Uniform(-0.2, 0.2), rng.Uniform(-0.2, 0.2), 1.8) - R * centre};
    BoardView view;
    view.name = std::to_string(v);
    view.points_g = flat;
    view.pixels.resize(2, flat.cols());
    for (Eigen::Index k = 0; k < flat.cols(); ++k) {
      view.corner_ids.push_back(static_cast<int>(k));
      Eigen::Vector3d point = flat.col(k);
      // Over its length of 0.9 m the board stands out by bend_m in the middle.
      point.z() = bend_m * (1.0 - std::pow((point.x() - centre.x()) / 0.45, 2));
      const auto pixel = lens.Project(T * point);
      view.pixels.col(k) = *pixel + Eigen::Vector2d(rng.Normal(0.0, 0.1), rng.Normal(0.0, 0.1));
    }
    problem.cameras[0].views.push_back(view);
  }
  problem.frame_of_view.emplace_back();
  for (int v = 0; v < 40; ++v) problem.frame_of_view[0].push_back(v);
  return CalibrateCameraRig(problem);
}

TEST(CalibrateCameraRig, FindsABoardBentByAMillimetre) {
  const CameraRigCalibration bent = CalibratedWithBending(1e-3, 8);
  ASSERT_TRUE(bent.bending);
  const double a = bent.bending->bending.coefficients(0);
  const double sigma = std::sqrt(bent.bending->covariance(0, 0));
  EXPECT_NEAR(a, -1e-3 / (0.45 * 0.45), 4.0 * sigma);
  EXPECT_GT(std::abs(a), 10.0 * sigma);
  EXPECT_NEAR(bent.bending->depth_m, 1e-3, 2e-4);
  EXPECT_EQ(bent.covariance_names.back(), "board.bending_yy");
}

TEST(CalibrateCameraRig, FindsAFlatBoardFlat) {
  const CameraRigCalibration flat = CalibratedWithBending(0.0, 9);
  ASSERT_TRUE(flat.bending);
  const Eigen::Vector3d& estimate = flat.bending->bending.coefficients;
  EXPECT_LT(estimate.dot(flat.bending->covariance.ldlt().solve(estimate)), 16.3);  // 99.9 %
}

}  // namespace
}  // namespace calibrato
