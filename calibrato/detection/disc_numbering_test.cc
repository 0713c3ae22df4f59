#include "calibrato/detection/disc_numbering.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "calibrato/detection/draw_discs.h"

namespace calibrato {
namespace {

struct Scene {
  ObliqueView view;
  Eigen::Matrix2Xd board;
  std::vector<DarkBlob> blobs;  // blob k is disc k
  std::vector<Eigen::Vector2d> points;
  DiscNumbering truth;

  Scene() : board(BoardPoints(view.board).topRows<2>()) {
    const Eigen::Matrix2Xd pixels = DrawnCentres(view.board, view.lens, view.T_c_g);
    const double radius = DrawnRadius(view.board);
    for (Eigen::Index k = 0; k < board.cols(); ++k) {
      // Half axes along the board's axes, as the lens shows them.
      Eigen::Matrix2d axes;
      for (int i = 0; i < 2; ++i) {
        Eigen::Vector3d p_g(board(0, k), board(1, k), 0.0);
        p_g(i) += radius;
        axes.col(i) = view.lens.Project(view.T_c_g * p_g).value() - pixels.col(k);
      }
      Add({pixels.col(k), std::numbers::pi * std::abs(axes.determinant())});
    }
    truth.resize(blobs.size());
    std::iota(truth.begin(), truth.end(), 0);
  }

  void Add(const DarkBlob& blob) {
    blobs.push_back(blob);
    points.push_back(blob.pixel);
  }

  MendedNumbering Mend(const DiscNumbering& numbering) const {
    return Mended(numbering, board, blobs, PointIndex(points), view.resolution);
  }
};

TEST(MendedNumbering, LeavesWhatIsRight) {
  const Scene scene;
  EXPECT_EQ(scene.Mend(scene.truth).numbering, scene.truth);
}

TEST(MendedNumbering, PutsDiscsRightThatWereTakenForTheirNeighbours) {
  const Scene scene;
  // At each of the four corners of the board: a corner's disc for the next in its column, and that
  // one for the one after.
  for (const auto& [corner, next, after] :
       {std::array{0, 4, 8}, {3, 7, 11}, {24, 20, 16}, {27, 23, 19}}) {
    DiscNumbering numbering = scene.truth;
    numbering[static_cast<size_t>(corner)] = next;
    numbering[static_cast<size_t>(next)] = after;
    numbering[static_cast<size_t>(after)] = -1;
    EXPECT_EQ(scene.Mend(numbering).numbering, scene.truth) << corner;
  }
}

TEST(MendedNumbering, PutsInDiscsThatWereNotReached) {
  const Scene scene;
  DiscNumbering numbering = scene.truth;
  numbering[3] = numbering[7] = numbering[24] = -1;
  EXPECT_EQ(scene.Mend(numbering).numbering, scene.truth);
}

TEST(MendedNumbering, TakesNothingElseForADiscThatIsNotThere) {
  Scene scene;
  DiscNumbering numbering = scene.truth;
  numbering[7] = -1;
  scene.points[7] = scene.blobs[7].pixel += Eigen::Vector2d(8.0, 8.0);  // a third of a step
  EXPECT_EQ(scene.Mend(numbering).numbering, numbering);
  scene.points[7] = scene.blobs[7].pixel -= Eigen::Vector2d(8.0, 8.0);
  scene.blobs[7].area *= 0.4;
  EXPECT_EQ(scene.Mend(numbering).numbering, numbering);
  EXPECT_EQ(scene.Mend(numbering).num_near_border, 0);
}

TEST(MendedNumbering, KnowsWhichDiscsTheBorderCuts) {
  Scene scene;
  DiscNumbering numbering = scene.truth;
  Eigen::Index rightmost = 0;
  DrawnCentres(scene.view.board, scene.view.lens, scene.view.T_c_g).row(0).maxCoeff(&rightmost);
  const auto k = static_cast<size_t>(rightmost);
  numbering[k] = -1;
  // A narrower image: the rightmost disc is cut in its middle, and so is no blob.
  scene.view.resolution.width = static_cast<int>(std::lround(scene.points[k].x()));
  scene.blobs[k].area = 0.0;
  const MendedNumbering mended = scene.Mend(numbering);
  EXPECT_EQ(mended.numbering, numbering);
  EXPECT_EQ(mended.num_near_border, 1);
}

TEST(MendedNumbering, DoesNotJudgeByTooFew) {
  const Scene scene;
  DiscNumbering numbering(scene.truth.size(), -1);
  for (const size_t k : {0, 5, 10, 15, 20, 25, 3}) numbering[k] = static_cast<int>(k + 1);
  EXPECT_EQ(scene.Mend(numbering).numbering, numbering);
}

}  // namespace
}  // namespace calibrato
