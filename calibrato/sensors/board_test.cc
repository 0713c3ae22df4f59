#include "calibrato/sensors/board.h"

#include <gtest/gtest.h>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

const char* const kYaml =
    "target_type: 'checkerboard'\n"
    "targetCols: 7\n"
    "targetRows: 6\n"
    "rowSpacingMeters: 0.06\n"
    "colSpacingMeters: 0.05\n";

std::string ErrorOf(const std::string& yaml) {
  try {
    (void)BoardFromValue(ParseYaml(yaml, "board.yaml"), nullptr);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Board, RowsRunAlongXAndColumnsAlongY) {
  const Eigen::Matrix3Xd points = BoardPoints(Checkerboard{6, 7, 0.06, 0.05});
  ASSERT_EQ(points.cols(), 42);
  // Corner (2, 3) has the number 2 * 7 + 3.
  EXPECT_LT((points.col(17) - Eigen::Vector3d(0.12, 0.15, 0.0)).norm(), 1e-15);
  EXPECT_LT((BoardCentre(Checkerboard{6, 7, 0.06, 0.05}) - Eigen::Vector3d(0.15, 0.15, 0.0)).norm(),
            1e-15);
}

TEST(Board, TagsOfAnAprilGridAreCountedFromTheLowerLeftAndTheirCornersAnticlockwise) {
  const Board board = AprilGrid{2, 3, 0.1, 0.3};
  const Eigen::Matrix3Xd points = BoardPoints(board);
  ASSERT_EQ(points.cols(), 24);
  // Tag (1, 2) has the number 5; the pitch is 0.13 m.
  EXPECT_LT((points.col(20) - Eigen::Vector3d(0.26, 0.13, 0.0)).norm(), 1e-15);
  EXPECT_LT((points.col(21) - Eigen::Vector3d(0.36, 0.13, 0.0)).norm(), 1e-15);
  EXPECT_LT((points.col(22) - Eigen::Vector3d(0.36, 0.23, 0.0)).norm(), 1e-15);
  EXPECT_LT((points.col(23) - Eigen::Vector3d(0.26, 0.23, 0.0)).norm(), 1e-15);
  EXPECT_EQ(PointsPerTag(board), 4);
}

TEST(Board, CirclesStandAsKalibrAndOpenCvPutThem) {
  const Eigen::Matrix3Xd symmetric = BoardPoints(CircleGrid{4, 5, 0.02, false});
  EXPECT_LT((symmetric.col(2 * 5 + 3) - Eigen::Vector3d(0.04, 0.06, 0.0)).norm(), 1e-15);
  const Eigen::Matrix3Xd asymmetric = BoardPoints(CircleGrid{11, 4, 0.02, true});
  EXPECT_LT((asymmetric.col(2 * 4 + 3) - Eigen::Vector3d(0.12, 0.04, 0.0)).norm(), 1e-15);
  EXPECT_LT((asymmetric.col(3 * 4 + 1) - Eigen::Vector3d(0.06, 0.06, 0.0)).norm(), 1e-15);
}

TEST(Board, CornersOfACharucoBoardAreThoseInside) {
  const Eigen::Matrix3Xd points = BoardPoints(Charuco{6, 8, 0.04, 0.03, "DICT_5X5_100"});
  ASSERT_EQ(points.cols(), 35);
  EXPECT_LT((points.col(2 * 7 + 3) - Eigen::Vector3d(0.08, 0.12, 0.0)).norm(), 1e-15);
}

TEST(Board, NeighboursAreOneStepApart) {
  const auto expect_steps = [](const Board& board, size_t count, double step_m) {
    const Eigen::Matrix3Xd points = BoardPoints(board);
    const auto pairs = NeighbouringPoints(board);
    EXPECT_EQ(pairs.size(), count) << Describe(board);
    for (const auto& [a, b] : pairs) {
      EXPECT_NEAR((points.col(b) - points.col(a)).norm(), step_m, 1e-12) << Describe(board);
    }
  };
  expect_steps(Checkerboard{6, 7, 0.06, 0.05}, 36, 0.05);
  expect_steps(AprilGrid{2, 3, 0.1, 0.3}, 12, 0.1);
  expect_steps(CircleGrid{4, 5, 0.02, false}, 16, 0.02);
  expect_steps(CircleGrid{11, 4, 0.02, true}, 33, 0.04);
  expect_steps(Charuco{6, 8, 0.04, 0.03, "DICT_5X5_100"}, 30, 0.04);
}

TEST(Board, ReadsKalibrsTargetFile) {
  std::vector<std::string> warnings;
  EXPECT_EQ(std::get<Checkerboard>(BoardFromValue(ParseYaml(kYaml, "board.yaml"), &warnings)),
            (Checkerboard{6, 7, 0.06, 0.05}));
  EXPECT_TRUE(warnings.empty());
}

TEST(Board, ReadsKalibrsOtherTargets) {
  const auto read = [](const std::string& yaml) {
    std::vector<std::string> warnings;
    Board board = BoardFromValue(ParseYaml(yaml, "board.yaml"), &warnings);
    EXPECT_TRUE(warnings.empty()) << warnings[0];
    return board;
  };
  EXPECT_EQ(
      read("target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\n"),
      Board(AprilGrid{5, 6, 0.088, 0.3}));
  const std::string circles =
      "target_type: 'circlegrid'\ntargetCols: 4\ntargetRows: 11\nspacingMeters: 0.02\n";
  EXPECT_EQ(read(circles), Board(CircleGrid{11, 4, 0.02, false}));
  EXPECT_EQ(read(circles + "asymmetricGrid: true\n"), Board(CircleGrid{11, 4, 0.02, true}));
}

TEST(Board, RoundTrip) {
  for (const Board& board :
       {Board(Checkerboard{9, 6, 0.025, 0.0251}), Board(AprilGrid{6, 7, 0.088, 0.3}),
        Board(CircleGrid{11, 4, 0.02, true}), Board(CircleGrid{4, 5, 0.03, false}),
        Board(Charuco{6, 8, 0.04, 0.03, "DICT_APRILTAG_36h11"})}) {
    EXPECT_EQ(BoardFromValue(ParseYaml(ToYaml(ToValue(board)), "x"), nullptr), board)
        << Describe(board);
  }
}

TEST(Board, MoreTagsThanThereAreIsAnErrorWithItsLine) {
  const std::string error = ErrorOf(
      "target_type: 'aprilgrid'\ntagCols: 25\ntagRows: 24\ntagSize: 0.088\ntagSpacing: 0.3\n");
  EXPECT_NE(error.find("line 2"), std::string::npos) << error;
  EXPECT_NE(error.find("587"), std::string::npos) << error;
}

TEST(Board, MarkersMustFitAndBeKnownAndSuffice) {
  const auto error_of = [](const std::string& marker, const std::string& dictionary) {
    return ErrorOf(
        "target_type: 'charuco'\ntargetCols: 11\ntargetRows: 10\nsquareSizeMeters: 0.04\n"
        "markerSizeMeters: " +
        marker + "\ndictionary: '" + dictionary + "'\n");
  };
  EXPECT_EQ(error_of("0.03", "DICT_5X5_100"), "");
  EXPECT_NE(error_of("0.04", "DICT_5X5_100").find("line 5"), std::string::npos);
  EXPECT_NE(error_of("0.03", "dict_5x5_100").find("did you mean DICT_5X5_100"), std::string::npos);
  EXPECT_NE(error_of("0.03", "DICT_5X5_50").find("55 markers"), std::string::npos);
}

TEST(Board, ATypoIsAnErrorWithLineAndKeyAndTheNearestKey) {
  const std::string error = ErrorOf(
      "target_type: 'checkerboard'\ntargetCol: 7\ntargetRows: 6\nrowSpacingMeters: 0.06\n"
      "colSpacingMeters: 0.06\n");
  EXPECT_NE(error.find("targetCols"), std::string::npos) << error;
  EXPECT_NE(error.find("board.yaml"), std::string::npos) << error;
  EXPECT_NE(error.find("did you mean"), std::string::npos) << error;
}

TEST(Board, AWrongTypeIsAnErrorWithItsLine) {
  const std::string error = ErrorOf(
      "target_type: 'checkerboard'\ntargetCols: six\ntargetRows: 6\nrowSpacingMeters: 0.06\n"
      "colSpacingMeters: 0.06\n");
  EXPECT_NE(error.find("line 2"), std::string::npos) << error;
  EXPECT_NE(error.find("six"), std::string::npos) << error;
}

TEST(Board, ANegativeSizeIsAnErrorWithItsLine) {
  const std::string error = ErrorOf(
      "target_type: 'checkerboard'\ntargetCols: 7\ntargetRows: 6\nrowSpacingMeters: -0.06\n"
      "colSpacingMeters: 0.06\n");
  EXPECT_NE(error.find("line 4"), std::string::npos) << error;
  EXPECT_NE(error.find("rowSpacingMeters"), std::string::npos) << error;
}

TEST(Board, ASizeThatNoBoardHasIsAnErrorWithItsLine) {
  const auto error_of = [](const std::string& spacing) {
    return ErrorOf("target_type: 'checkerboard'\ntargetCols: 7\ntargetRows: 6\nrowSpacingMeters: " +
                   spacing + "\ncolSpacingMeters: 0.06\n");
  };
  for (const char* spacing : {"1e-308", "1e-7", "0", "1001", "1e300"}) {
    const std::string error = error_of(spacing);
    EXPECT_NE(error.find("line 4"), std::string::npos) << error;
    EXPECT_NE(error.find("rowSpacingMeters"), std::string::npos) << error;
  }
  EXPECT_EQ(error_of("1e-6"), "");
  EXPECT_EQ(error_of("1000"), "");
  const std::string gap = ErrorOf(
      "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 1e-308\n");
  EXPECT_NE(gap.find("line 5"), std::string::npos) << gap;
}

TEST(Board, AnUnknownBoardSaysWhichAreKnown) {
  EXPECT_NE(ErrorOf("target_type: 'dartboard'\n").find("checkerboard"), std::string::npos);
}

TEST(Board, AnUnknownKeyIsAWarningThatNamesTheNearest) {
  std::vector<std::string> warnings;
  (void)BoardFromValue(ParseYaml(std::string(kYaml) + "targetcols: 8\n", "board.yaml"), &warnings);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("targetCols"), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace calibrato
