#include "calibrato/recording/imu_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ImuRecordingTest : public testing::Test {
 protected:
  std::string ErrorOf() {
    return InputErrorOf([&] { (void)OpenImuRecordings(folder_.path()); });
  }
  TestFolder folder_;
};

const std::string kBoth = "5,1,2,3,4,5,6\n";
const std::string kOne = "5,1,2,3\n6,1,2,3\n";

TEST_F(ImuRecordingTest, FindsEveryForm) {
  EXPECT_TRUE(OpenImuRecordings(folder_.path()).empty());
  folder_.Write("imu0.csv", kBoth);
  folder_.Write("imu1/data.csv", kBoth);
  folder_.Write("gyro2.csv", kOne);
  folder_.WriteGzip("accel2.csv.gz", kOne + "7,1,2,3\n");
  folder_.WriteGzip("imu3.csv.gz", kBoth);
  const std::vector<ImuRecording> imus = OpenImuRecordings(folder_.path());
  ASSERT_EQ(imus.size(), 4U);
  EXPECT_EQ(imus[1].name, "imu1");
  EXPECT_EQ(imus[1].stream.accel[0].value, Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_EQ(imus[2].stream.gyro.size(), 2U);
  EXPECT_EQ(imus[2].stream.accel.size(), 3U);
}

TEST_F(ImuRecordingTest, RefusesWhatIsAmbiguousOrHalf) {
  folder_.Write("imu0.csv", kBoth);
  folder_.Write("imu0/data.csv", kBoth);
  EXPECT_THAT(ErrorOf(), HasSubstr("two lists of one IMU"));
  TestFolder half;
  half.Write("accel0.csv", kOne);
  EXPECT_THAT(InputErrorOf([&] { (void)OpenImuRecordings(half.path()); }),
              AllOf(HasSubstr("half an IMU"), HasSubstr("no gyro0.csv")));
  TestFolder gap;
  gap.Write("imu0.csv", kBoth);
  gap.Write("imu2.csv", kBoth);
  EXPECT_THAT(InputErrorOf([&] { (void)OpenImuRecordings(gap.path()); }),
              HasSubstr("there is imu2, but no imu1"));
}

TEST(EurocImuApril, HasEightThousandSamples) {
  const char* data = std::getenv("CALIBRATO_DATA");
  if (data == nullptr) GTEST_SKIP() << "CALIBRATO_DATA is not set";
  const std::vector<ImuRecording> imus = OpenImuRecordings(std::string(data) + "/euroc_imu_april");
  ASSERT_EQ(imus.size(), 1U);
  const std::vector<VectorSample>& gyro = imus[0].stream.gyro;
  EXPECT_NEAR(static_cast<double>(gyro.size()), 8000.0, 20.0);
  EXPECT_EQ(gyro[0].stamp.nanoseconds(), 1404733405747800064);
  EXPECT_EQ(gyro[0].value, Eigen::Vector3d(0.014661, -0.028623, 0.125664));
}

}  // namespace
}  // namespace calibrato
