#include "calibrato/calibration/rig_adjustment.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "calibrato/calibration/common_numbering.h"
#include "calibrato/calibration/synthetic_rig_for_test.h"
#include "calibrato/sensors/board_symmetry.h"

namespace calibrato {
namespace {

// Two cameras side by side, fitted each on its own.
struct FittedPair {
  CameraRigProblem problem;
  std::vector<CameraFit> fits;

  explicit FittedPair(uint64_t seed, const Board& board = Checkerboard{6, 7, 0.03, 0.03}) {
    Eigen::VectorXd parameters(8);
    parameters << 460.0, 458.0, 322.0, 236.0, -0.2, 0.05, 0.001, -0.002;
    const CameraModel lens("pinhole-radtan", parameters);
    Rng rng(seed);
    problem = MakeRigProblem({{lens, lens}, {{ExpSo3({0.01, 0.1, -0.02}), {-0.11, 0.003, 0.002}}}},
                             board, 30, 0.2, rng);
    for (const CameraProblem& camera : problem.cameras) fits.push_back(FitCamera(camera, 200));
  }

  // The place of a view of camera 1 whose frame camera 0 saw too.
  size_t SharedView() const {
    const std::vector<int>& other = problem.frame_of_view[0];
    size_t v = 0;
    while (std::find(other.begin(), other.end(), problem.frame_of_view[1][v]) == other.end()) ++v;
    return v;
  }

  RigAdjustment Adjust() {
    const std::vector<CameraGroup> groups = RelateCameras(fits, problem.frame_of_view);
    return AdjustRig(problem, groups.front(), 200, &fits);
  }

  void LeaveOut(size_t v) {
    ViewInliers& view = fits[1].views[v];
    view.corners.assign(view.corners.size(), false);
    view.reason = ViewRejection::kDoesNotFit;
  }
};

TEST(AdjustRig, TakesAViewThatFitsItsFrameBackIntoIt) {
  FittedPair pair(1);
  const size_t v = pair.SharedView();
  pair.LeaveOut(v);
  const RigAdjustment adjustment = pair.Adjust();
  EXPECT_EQ(adjustment.termination, Termination::kConverged);
  EXPECT_EQ(adjustment.num_separated_views, 0);
  EXPECT_GT(pair.fits[1].views[v].count(), 0);
  // Together with the other camera's view of the frame: at one pose of the board.
  const int frame = pair.problem.frame_of_view[1][v];
  size_t other = 0;
  while (pair.problem.frame_of_view[0][other] != frame) ++other;
  const Rigid3 T_c1_g = adjustment.group.T_to_from(1, 0) * pair.fits[0].views[other].T_c_g;
  EXPECT_LT(T_c1_g.DifferenceTo(pair.fits[1].views[v].T_c_g).norm(), 1e-12);
}

// The board looks the same upside down, and camera 1 took the view from the other side than camera
// 0 did, and left it out.
TEST(AdjustRig, TakesAViewBackThatWasNumberedFromAnotherSide) {
  const Board board = Checkerboard{6, 8, 0.03, 0.03};
  const std::vector<BoardTurn> turns = BoardTurns(board);
  for (const bool is_turned : {false, true}) {
    FittedPair pair(5, board);
    pair.problem.board = board;
    const size_t v = pair.SharedView();
    BoardView& view = pair.problem.cameras[1].views[v];
    if (is_turned) {
      view = Renumbered(view, turns.front().numbering, BoardPoints(board));
      pair.fits[1].views[v].T_c_g = pair.fits[1].views[v].T_c_g * turns.front().T_g_turned;
    }
    pair.LeaveOut(v);
    const std::vector<CameraGroup> groups =
        RelateCameras(pair.fits, pair.problem.frame_of_view, turns);
    NumberAlike(groups.front(), turns, &pair.problem, &pair.fits);
    const RigAdjustment adjustment = AdjustRig(pair.problem, groups.front(), 200, &pair.fits);
    EXPECT_EQ(adjustment.num_separated_views, 0);
    EXPECT_EQ(pair.fits[1].views[v].count(), view.num_corners());
  }
}

TEST(AdjustRig, SettlesThoughAViewNeverFits) {
  FittedPair pair(2);
  const size_t v = pair.SharedView();
  Eigen::Matrix2Xd& pixels = pair.problem.cameras[1].views[v].pixels;
  Rng rng(3);
  for (double& x : pixels.reshaped()) x += 40.0 * rng.Normal();
  pair.LeaveOut(v);
  const RigAdjustment adjustment = pair.Adjust();
  EXPECT_EQ(pair.fits[1].views[v].count(), 0);
  EXPECT_EQ(adjustment.num_rounds, 1);
}

TEST(AdjustRig, SeparatesOneOfTwoViewsThatDoNotBelongTogether) {
  FittedPair pair(4);
  const size_t v = pair.SharedView();
  // What camera 1 saw in another frame, taken for this one's.
  pair.problem.cameras[1].views[v] = pair.problem.cameras[1].views[v + 1];
  pair.fits[1] = FitCamera(pair.problem.cameras[1], 200);
  const RigAdjustment adjustment = pair.Adjust();
  EXPECT_EQ(adjustment.num_separated_views, 1);
  EXPECT_GT(pair.fits[1].views[v].count(), 0);
}

}  // namespace
}  // namespace calibrato
