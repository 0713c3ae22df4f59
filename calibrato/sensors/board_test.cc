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

TEST(Board, ReadsKalibrsTargetFile) {
  std::vector<std::string> warnings;
  EXPECT_EQ(std::get<Checkerboard>(BoardFromValue(ParseYaml(kYaml, "board.yaml"), &warnings)),
            (Checkerboard{6, 7, 0.06, 0.05}));
  EXPECT_TRUE(warnings.empty());
}

TEST(Board, RoundTrip) {
  const Board board = Checkerboard{9, 6, 0.025, 0.0251};
  EXPECT_EQ(BoardFromValue(ParseYaml(ToYaml(ToValue(board)), "x"), nullptr), board);
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
