#include "calibrato/evaluation/outside_estimator.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/evaluation/outside_program.h"

namespace calibrato {
namespace {

OutsideEstimator Shell(const std::string& script, double timeout_s = 20.0) {
  return {"shell", {"/bin/sh", "-c", script, "sh", "{bag}", "{out}"}, timeout_s};
}

OutsideResult Try(const OutsideEstimator& estimator) {
  const ProgramFolder folder;
  return RunOutsideEstimator(estimator, {"/a.bag", "/t.yaml", "/c.yaml", "/i.yaml"}, folder.path());
}

TEST(OutsideEstimator, ItsFileIsRead) {
  const OutsideResult made =
      Try(Shell("test $1 = /a.bag && printf 'cam0:\\n  T_cam_imu:\\n  - [0.0, -1.0, 0.0, 0.06]\\n"
                "  - [1.0, 0.0, 0.0, 0.0]\\n  - [0.0, 0.0, 1.0, -0.1]\\n  - [0.0, 0.0, 0.0, 1.0]\\n"
                "  timeshift_cam_imu: 0.007\\n' > $2/camchain-imucam.yaml"));
  EXPECT_EQ(made.failure, "");
  EXPECT_EQ(made.time_offset_s, 0.007);
  EXPECT_EQ(made.T_c_i.t, Eigen::Vector3d(0.06, 0.0, -0.1));
  EXPECT_EQ(made.T_c_i.R(1, 0), 1.0);
}

TEST(OutsideEstimator, SaysHowItCameToNothing) {
  EXPECT_EQ(Try(Shell("exit 3")).failure, "exit code 3");
  EXPECT_EQ(Try(Shell("kill -SEGV $$")).failure, "killed by signal 11");
  EXPECT_EQ(Try(Shell("true")).failure, "left no camchain-imucam.yaml");
  EXPECT_EQ(Try({"none", {"/no/such/program"}, 5.0}).failure, "cannot be started");
  EXPECT_EQ(Try(Shell("echo 'cam0: {T_cam_imu: [[1, 2]]}' > $2/camchain-imucam.yaml")).failure,
            "left a camchain-imucam.yaml that says nothing of T_cam_imu");
  EXPECT_EQ(Try(Shell("echo '{' > $2/camchain-imucam.yaml")).failure,
            "left a camchain-imucam.yaml that says nothing of T_cam_imu");
}

TEST(OutsideEstimator, WhatHangsIsKilledWithItsChildren) {
  const ProgramFolder folder;
  const OutsideResult made = RunOutsideEstimator(
      Shell("(sleep 1; touch " + folder.PathOf("alive") + ") & sleep 100", 0.2), {}, folder.path());
  EXPECT_EQ(made.failure, "no end after 0.2 s");
  EXPECT_LT(made.seconds, 50.0);
  EXPECT_TRUE(RunOutsideProgram({"sleep", "1.5"}, folder.path(), 10.0).is_success);
  EXPECT_FALSE(std::filesystem::exists(folder.PathOf("alive")));
}

TEST(OutsideEstimator, ItsFileIsCheckedWithLineAndKey) {
  const auto error = [](const std::string& text) {
    return InputErrorOf([&] {
      static_cast<void>(OutsideEstimatorFromValue(ParseYaml(text, "kalibr.yaml"), nullptr));
    });
  };
  EXPECT_NE(error("name: kalibr\n").find("command"), std::string::npos);
  EXPECT_NE(error("name: kalibr\ncommand: []\n").find("kalibr.yaml line 2, key command"),
            std::string::npos);
  EXPECT_NE(error("name: kalibr\ncommand: [run, '{bags}']\n").find("{bags}"), std::string::npos);
  EXPECT_NE(error("name: kalibr\ncommand: [run]\ntimeout_s: -1\n").find("timeout_s"),
            std::string::npos);
  const OutsideEstimator read = OutsideEstimatorFromValue(
      ParseYaml("name: kalibr\ncommand: [run, '{bag}', 'to={out}']\ntimeout_s: 60\n", "k.yaml"),
      nullptr);
  EXPECT_EQ(read.command.size(), 3U);
  EXPECT_EQ(read.timeout_s, 60.0);
}

}  // namespace
}  // namespace calibrato
