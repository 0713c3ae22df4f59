#include "calibrato/recording/imu_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

class ImuListTest : public testing::Test {
 protected:
  ImuStream Read(const std::string& content) {
    return ReadImuList(folder_.Write("imu0.csv", content));
  }
  std::string ErrorOf(const std::string& content) {
    return InputErrorOf([&] { (void)Read(content); });
  }
  void ExpectKalibrsOrder(const std::string& content) {
    const ImuStream stream = Read(content);
    ASSERT_EQ(stream.gyro.size(), 1U) << content;
    ASSERT_EQ(stream.accel.size(), 1U);
    EXPECT_EQ(stream.gyro[0].stamp, Time::FromNanoseconds(1404733405747800064)) << content;
    EXPECT_EQ(stream.accel[0].stamp, stream.gyro[0].stamp);
    EXPECT_EQ(stream.gyro[0].value, Vector3d(0.25, -0.5, 1.0)) << content;
    EXPECT_EQ(stream.accel[0].value, Vector3d(9.5, 0.125, -3e-1)) << content;
  }
  TestFolder folder_;
};

const std::string kRow = "1404733405747800064,0.25,-0.5,1,9.5,0.125,-3e-1\n";

TEST_F(ImuListTest, ReadsTheHeadersThatThereAre) {
  ExpectKalibrsOrder(kRow);
  ExpectKalibrsOrder("timestamp,omega_x,omega_y,omega_z,alpha_x,alpha_y,alpha_z\n" + kRow);
  ExpectKalibrsOrder(
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n" +
      kRow);
  ExpectKalibrsOrder(
      "# a comment, and another\n#timestamp [ns],w_x [rad/s],w_y [rad/s],w_z [rad/s],"
      "a_x [m/s^2],a_y [m/s^2],a_z [m/s^2]\n\n" +
      kRow);
  ExpectKalibrsOrder("nothing,that,we,know,of,at,all\r\n" + kRow);
  ExpectKalibrsOrder("\xef\xbb\xbftimestamp,gx,gy,gz,ax,ay,az\n" + kRow);
}

TEST_F(ImuListTest, MatchesColumnsByNameInAnyOrder) {
  const ImuStream stream = Read(
      "temperature,accel_z,accel_x,accel_y,time,gyro_y,gyro_z,gyro_x\n"
      "36.6,3,1,2,77,20,30,10\n");
  EXPECT_EQ(stream.gyro[0].stamp, Time::FromNanoseconds(77));
  EXPECT_EQ(stream.gyro[0].value, Vector3d(10.0, 20.0, 30.0));
  EXPECT_EQ(stream.accel[0].value, Vector3d(1.0, 2.0, 3.0));
}

TEST_F(ImuListTest, OneSensorHasAListOfItsOwn) {
  const std::string gyro = folder_.WriteGzip("gyro0.csv.gz", "#timestamp [ns],x,y,z\n5,1,2,3\n");
  EXPECT_EQ(ReadGyroList(gyro)[0].value, Vector3d(1.0, 2.0, 3.0));
  const std::string accel = folder_.Write("accel0.csv", "t,a_z,a_y,a_x\n5,1,2,3\n");
  EXPECT_EQ(ReadAccelList(accel)[0].value, Vector3d(3.0, 2.0, 1.0));
  EXPECT_EQ(ReadAccelList(folder_.Write("b.csv", "5,1,2,3\n"))[0].value, Vector3d(1.0, 2.0, 3.0));
}

TEST_F(ImuListTest, KeepsWhatIsNoNumberAndTheOrderOfTheFile) {
  const ImuStream stream = Read("7,1,2,3,4,5,6\n5,nan,2,3,4,5,inf\n5,1,2,3,4,5,6\n");
  ASSERT_EQ(stream.gyro.size(), 3U);
  EXPECT_EQ(stream.gyro[0].stamp, Time::FromNanoseconds(7));
  EXPECT_EQ(stream.gyro[1].stamp, stream.gyro[2].stamp);
  EXPECT_TRUE(std::isnan(stream.gyro[1].value.x()));
  EXPECT_TRUE(std::isinf(stream.accel[1].value.z()));
}

TEST_F(ImuListTest, RoundTrip) {
  const std::string text =
      "#timestamp [ns],w_x [rad/s],w_y [rad/s],w_z [rad/s],a_x [m/s^2],a_y [m/s^2],a_z [m/s^2]\n"
      "1404733405747800064,0.1,0.2,0.30000000000000004,9.80665,1e-20,-3.5\n";
  EXPECT_EQ(ImuListText(Read(text)), text);
  const std::string broken = text + "1404733405752800064,nan,0.5,inf,-inf,1,2\n";
  EXPECT_EQ(ImuListText(Read(broken)), broken);
}

TEST_F(ImuListTest, ErrorsNameFileAndLine) {
  EXPECT_THAT(ErrorOf(kRow + "140473340,1,2,3,4,5\n"),
              AllOf(HasSubstr("imu0.csv line 2"), HasSubstr("expected 7 fields, found 6")));
  EXPECT_THAT(ErrorOf(kRow + kRow + "5,1,2,x,4,5,6\n"),
              AllOf(HasSubstr("line 3"), HasSubstr("column w_z"), HasSubstr("'x'")));
  EXPECT_THAT(ErrorOf("5,1,2,,4,5,6\n"), AllOf(HasSubstr("line 1"), HasSubstr("column w_z")));
  EXPECT_THAT(ErrorOf("1404733405.7478,1,2,3,4,5,6\n"),
              AllOf(HasSubstr("line 1"), HasSubstr("without a point")));
  EXPECT_THAT(ErrorOf("-5,1,2,3,4,5,6\n"), HasSubstr("'-5'"));
  EXPECT_THAT(ErrorOf("#timestamp,w_x [deg/s],w_y,w_z,a_x,a_y,a_z\n" + kRow),
              AllOf(HasSubstr("line 1"), HasSubstr("[deg/s]"), HasSubstr("convert it to [rad/s]")));
  EXPECT_THAT(ErrorOf("#timestamp,w_x,w_y,w_z,a_x [g],a_y,a_z\n" + kRow), HasSubstr("[g]"));
  EXPECT_THAT(ErrorOf("#timestamp [s],w_x,w_y,w_z,a_x,a_y,a_z\n" + kRow), HasSubstr("[ns]"));
  EXPECT_THAT(ErrorOf("timestamp,w_x,w_y,w_zz,a_x,a_y,a_z\n" + kRow),
              AllOf(HasSubstr("the column w_z is missing"), HasSubstr("rename the column 'w_zz'")));
  EXPECT_THAT(ErrorOf("timestamp,w_x,w_y,w_z,w_x,a_x,a_y,a_z\n"), HasSubstr("stands twice"));
  EXPECT_THAT(ErrorOf("timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n"), HasSubstr("no rows"));
  EXPECT_THAT(ErrorOf(""), HasSubstr("no rows"));
}

}  // namespace
}  // namespace calibrato
