#include "calibrato/recording/corner_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/test_folder.h"
#include "calibrato/sensors/board.h"

namespace calibrato {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kHeader = "#timestamp [ns],tag_id,tag_corner,u [px],v [px],x [m],y [m],z [m]\n";
const std::string kBareHeader = "#timestamp [ns],tag_id,u [px],v [px]\n";

class CornerListTest : public testing::Test {
 protected:
  std::vector<BoardView> Read(const std::string& content,
                              const std::optional<Eigen::Matrix3Xd>& points_g = {}) const {
    return ReadCornerList(folder_.Write("cam0_corners.csv", content), points_g);
  }
  std::string ErrorOf(const std::string& content,
                      const std::optional<Eigen::Matrix3Xd>& points_g = {}) const {
    try {
      Read(content, points_g);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  TestFolder folder_;
};

TEST_F(CornerListTest, GroupsRowsByStampAndSortsViewsByTimeAndCornersByNumber) {
  const std::vector<BoardView> views = Read(kHeader +
                                            "20,3,0,1.5,2.5,0.1,0.2,0.3\n"
                                            "10,1,0,5,6,0,0,0\n"
                                            "20,2,0,3.5,4.5,0.4,0.5,0.6\n"
                                            "10,0,0,7,8,0,0,0\n");
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[0].stamp, Time::FromNanoseconds(10));
  EXPECT_EQ(views[0].name, "10");
  EXPECT_THAT(views[0].corner_ids, ElementsAre(0, 1));
  EXPECT_EQ(views[0].pixels.col(0), Eigen::Vector2d(7.0, 8.0));
  EXPECT_EQ(views[1].stamp, Time::FromNanoseconds(20));
  EXPECT_THAT(views[1].corner_ids, ElementsAre(2, 3));
  EXPECT_EQ(views[1].pixels.col(1), Eigen::Vector2d(1.5, 2.5));
  EXPECT_EQ(views[1].points_g.col(0), Eigen::Vector3d(0.4, 0.5, 0.6));
}

TEST_F(CornerListTest, MatchesColumnsByNameWhereverTheyStand) {
  const std::vector<BoardView> views = Read(
      "\xef\xbb\xbf# recorded on a Monday, in the hall\r\n"
      "v [px] , u,extra , z [m],y [m],x [m], tag_id ,timestamp [ns]\r\n"
      "\r\n"
      " 2.0 , 1.0 , word ,0.3,0.2,0.1, 5 ,1404733405732800000\r\n"
      "# a comment, later on\r\n");
  ASSERT_EQ(views.size(), 1u);
  EXPECT_EQ(views[0].stamp.nanoseconds(), 1404733405732800000);
  EXPECT_THAT(views[0].corner_ids, ElementsAre(5));
  EXPECT_EQ(views[0].pixels.col(0), Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(views[0].points_g.col(0), Eigen::Vector3d(0.1, 0.2, 0.3));
}

TEST_F(CornerListTest, NumbersTheFourCornersOfATagOneAfterTheOther) {
  const std::vector<BoardView> views = Read(kHeader +
                                            "1,0,1,1,1,0,0,0\n"
                                            "1,2,0,1,1,0,0,0\n"
                                            "1,2,3,1,1,0,0,0\n");
  EXPECT_THAT(views.at(0).corner_ids, ElementsAre(1, 8, 11));
}

TEST_F(CornerListTest, TakesPointsFromTheBoardWhereTheFileHasNone) {
  const Eigen::Matrix3Xd points_g = BoardPoints(Checkerboard{3, 4, 0.1, 0.2});
  const std::vector<BoardView> views = Read(kBareHeader + "1,5,10,20\n", points_g);
  EXPECT_EQ(views.at(0).points_g.col(0), Eigen::Vector3d(0.1, 0.2, 0.0));
  EXPECT_THAT(ErrorOf(kBareHeader + "1,5,10,20\n"), HasSubstr("give the board with --target"));
}

TEST_F(CornerListTest, HoldsTheFilesPointsAgainstTheBoardToOnePercentOfItsDiagonal) {
  // The diagonal of 0.3 m by 0.4 m is 0.5 m, 1 % of it 5 mm.
  const Eigen::Matrix3Xd points_g = BoardPoints(Checkerboard{2, 2, 0.3, 0.4});
  const std::vector<BoardView> views = Read(kHeader + "1,3,0,10,20,0.3,0.4049,0\n", points_g);
  EXPECT_EQ(views.at(0).points_g.col(0), Eigen::Vector3d(0.3, 0.4049, 0.0));
  EXPECT_THAT(ErrorOf(kHeader + "1,3,0,10,20,0.3,0.4051,0\n", points_g),
              AllOf(HasSubstr("line 2"), HasSubstr("corner 3"), HasSubstr("--target")));
}

TEST_F(CornerListTest, NamesLineAndColumnOfWhatIsWrong) {
  EXPECT_THAT(
      ErrorOf(kHeader + "1,0,0,1,1,0,0,0\n1,1,0,1,nan,0,0,0\n"),
      AllOf(HasSubstr("cam0_corners.csv line 3"), HasSubstr("column v"), HasSubstr("found 'nan'")));
  EXPECT_THAT(ErrorOf(kHeader + "1,0,0,inf,1,0,0,0\n"), HasSubstr("column u"));
  EXPECT_THAT(ErrorOf(kHeader + "1,0,0,1e999,1,0,0,0\n"), HasSubstr("column u"));
  EXPECT_THAT(ErrorOf(kHeader + "1.5,0,0,1,1,0,0,0\n"), HasSubstr("column timestamp"));
  EXPECT_THAT(ErrorOf(kHeader + "9223372036854775808,0,0,1,1,0,0,0\n"),
              HasSubstr("column timestamp"));
  EXPECT_THAT(ErrorOf(kHeader + "-1,0,0,1,1,0,0,0\n"), HasSubstr("column timestamp"));
  EXPECT_THAT(ErrorOf(kHeader + "1,-1,0,1,1,0,0,0\n"), HasSubstr("column tag_id"));
  EXPECT_THAT(ErrorOf(kHeader + "1,0,4,1,1,0,0,0\n"), HasSubstr("column tag_corner"));
  EXPECT_THAT(ErrorOf(kHeader + "1,0,0,1,,0,0,0\n"), HasSubstr("column v"));
  EXPECT_THAT(ErrorOf(kHeader + "1,0,0,1,1x,0,0,0\n"), HasSubstr("found '1x'"));
  EXPECT_THAT(ErrorOf(kHeader + "1,0,0,1,1,0,0\n"), HasSubstr("expected 8 fields, found 7"));
  EXPECT_THAT(ErrorOf(kBareHeader + "1,12,0,0\n", BoardPoints(Checkerboard{3, 4, 0.1, 0.1})),
              AllOf(HasSubstr("line 2"), HasSubstr("12 corners")));
}

TEST_F(CornerListTest, NamesAMissingColumnAndOneThatMayBeMeant) {
  EXPECT_THAT(ErrorOf("#timestamp [ns],tag,u [px],v [px]\n1,0,1,1\n"),
              AllOf(HasSubstr("column tag_id"), HasSubstr("missing")));
  EXPECT_THAT(ErrorOf("#timestamps [ns],tag_id,u [px],v [px]\n1,0,1,1\n"),
              HasSubstr("rename the column 'timestamps'"));
  EXPECT_THAT(ErrorOf("#timestamp [ns],tag_id,u,v,x,y\n1,0,1,1,0,0\n"), HasSubstr("column z"));
  EXPECT_THAT(ErrorOf("1,0,0,1,1,0,0,0\n"), HasSubstr("column timestamp"));
  EXPECT_THAT(ErrorOf("#timestamp,tag_id,u,v,u\n"), HasSubstr("stands twice"));
}

TEST_F(CornerListTest, RefusesOtherUnits) {
  EXPECT_THAT(ErrorOf("#timestamp [s],tag_id,u [px],v [px]\n1,0,1,1\n"),
              AllOf(HasSubstr("in [s]"), HasSubstr("[ns]")));
  EXPECT_THAT(ErrorOf("#timestamp [ns],tag_id,u,v,x [mm],y [mm],z [mm]\n1,0,1,1,0,0,0\n"),
              HasSubstr("in [mm]"));
}

TEST_F(CornerListTest, RefusesACornerThatStandsTwiceInAView) {
  EXPECT_THAT(ErrorOf(kHeader + "1,7,0,1,1,0,0,0\n2,7,0,1,1,0,0,0\n1,7,0,2,2,0,0,0\n"),
              AllOf(HasSubstr("line 4"), HasSubstr("corner 7"), HasSubstr("line 2")));
}

TEST_F(CornerListTest, RefusesAListWithoutRows) {
  EXPECT_THAT(ErrorOf(""), HasSubstr("the file is empty"));
  EXPECT_THAT(ErrorOf(kHeader), HasSubstr("no rows"));
}

std::vector<BoardView> TwoViews() {
  std::vector<BoardView> views(2);
  for (size_t k = 0; k < 2; ++k) {
    views[k].stamp = Time::FromNanoseconds(1404733405732800000 + static_cast<int64_t>(k));
    views[k].name = std::to_string(views[k].stamp.nanoseconds());
    views[k].corner_ids = {0, 5, 6};
    views[k].pixels = Eigen::Matrix2Xd::Constant(2, 3, 1.0 / 3.0 + static_cast<double>(k));
    views[k].points_g = Eigen::Matrix3Xd::Constant(3, 3, -1e-7 / 3.0);
  }
  return views;
}

void ExpectSame(const std::vector<BoardView>& views, const std::vector<BoardView>& expected) {
  ASSERT_EQ(views.size(), expected.size());
  for (size_t k = 0; k < views.size(); ++k) {
    EXPECT_EQ(views[k].stamp, expected[k].stamp);
    EXPECT_EQ(views[k].name, expected[k].name);
    EXPECT_EQ(views[k].corner_ids, expected[k].corner_ids);
    EXPECT_EQ(views[k].pixels, expected[k].pixels);
    EXPECT_EQ(views[k].points_g, expected[k].points_g);
  }
}

TEST_F(CornerListTest, ReadsBackWhatItWroteToTheLastBit) {
  ExpectSame(Read(CornerListText(TwoViews())), TwoViews());
  ExpectSame(Read(CornerListText(TwoViews(), 4)), TwoViews());
  ExpectSame(
      ReadCornerList(folder_.WriteGzip("cam0_corners.csv.gz", CornerListText(TwoViews())), {}),
      TwoViews());
}

TEST_F(CornerListTest, WritesTagsOfFourCornersAsSuch) {
  const std::string text = CornerListText(TwoViews(), 4);
  EXPECT_THAT(text, HasSubstr("1404733405732800000,1,1,"));  // corner 5 = 1 * 4 + 1
  EXPECT_THAT(text, HasSubstr("1404733405732800000,1,2,"));
}

TEST(CornerListData, ReadsARecordingOfFortySeconds) {
  const char* data = std::getenv("CALIBRATO_DATA");
  if (data == nullptr) GTEST_SKIP() << "set CALIBRATO_DATA to the folder of the data sets";
  const std::vector<BoardView> views =
      ReadCornerList(std::string(data) + "/euroc_imu_april/cam0_corners.csv", {});
  Eigen::Index num_corners = 0;
  for (size_t k = 0; k < views.size(); ++k) {
    num_corners += views[k].num_corners();
    EXPECT_TRUE(views[k].pixels.allFinite());
    EXPECT_LT(views[k].corner_ids.back(), 36 * 4);
    if (k > 0) {
      EXPECT_LT(views[k - 1].stamp, views[k].stamp);
    }
  }
  EXPECT_EQ(num_corners, 105672);
  EXPECT_EQ(views.size(), 801u);
}

}  // namespace
}  // namespace calibrato
