#include "calibrato/recording/topic_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrato/base/input_error_testing.h"

namespace calibrato {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

using Names = std::vector<std::string>;

Names Images(const Names& topics, const Names& globs = {}) {
  return ChooseImageTopics("a.bag", topics, globs);
}

std::string ErrorOf(const Names& topics, const Names& globs = {}) {
  return InputErrorOf([&] { static_cast<void>(Images(topics, globs)); });
}

TEST(ChooseImageTopics, TakesTheOnlyOneOrAllThatDifferInNumbers) {
  EXPECT_THAT(Images({"/camera/image_raw"}), ElementsAre("/camera/image_raw"));
  EXPECT_THAT(Images({"/cam10/image", "/cam2/image", "/cam1/image"}),
              ElementsAre("/cam1/image", "/cam2/image", "/cam10/image"));
}

TEST(ChooseImageTopics, ListsTheTopicsWhereThereIsAChoice) {
  EXPECT_THAT(ErrorOf({"/left", "/right", "/right/compressed"}),
              AllOf(HasSubstr("a.bag"), HasSubstr("/left, /right, /right/compressed"),
                    HasSubstr("--images")));
  EXPECT_THAT(ErrorOf({}), AllOf(HasSubstr("no images"), HasSubstr("CompressedImage")));
}

TEST(ChooseImageTopics, FollowsTheGlobsInTheirOrder) {
  const Names topics = {"/left", "/right", "/right/compressed"};
  EXPECT_THAT(Images(topics, {"/right/*", "/l*"}), ElementsAre("/right/compressed", "/left"));
  EXPECT_THAT(ErrorOf(topics, {"/front"}),
              AllOf(HasSubstr("no image topic fits '/front'"), HasSubstr("/left")));
  EXPECT_THAT(ErrorOf(topics, {"/r*"}), HasSubstr("several image topics fit '/r*'"));
}

TEST(ChooseImuTopics, MayFindNone) { EXPECT_TRUE(ChooseImuTopics("a.bag", {}, {}).empty()); }

TEST(ChooseImuTopics, PairsTheSensorsOfOneImu) {
  const auto imus = ChooseImuTopics("a.bag", {"/camera/accel/sample", "/camera/gyro/sample"}, {});
  ASSERT_EQ(imus.size(), 1U);
  EXPECT_EQ(imus[0].gyro, "/camera/gyro/sample");
  EXPECT_EQ(imus[0].accel, "/camera/accel/sample");
  const auto whole = ChooseImuTopics("a.bag", {"/imu0", "/imu1"}, {"/imu1"});
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_EQ(whole[0].gyro, "/imu1");
  EXPECT_EQ(whole[0].accel, "/imu1");
  EXPECT_THAT(InputErrorOf([] {
                static_cast<void>(ChooseImuTopics("a.bag", {"/imu/data", "/mavros/imu"}, {}));
              }),
              AllOf(HasSubstr("/imu/data"), HasSubstr("--imu-topic")));
}

}  // namespace
}  // namespace calibrato
