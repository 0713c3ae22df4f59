// `calibrato guide`, as its users run it.

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

// Starts a command with its stderr in a file that can be read while it runs.
Arguments WithStderrIn(const std::string& path) {
  return {"sh", "-c", "exec \"$0\" \"$@\" 2> '" + path + "'"};
}

// Of the address that the command says to open; 0 before it does.
int PortIn(const std::string& stderr_text) {
  const std::string before = "open http://127.0.0.1:";
  const size_t at = stderr_text.find(before);
  if (at == std::string::npos || stderr_text.find('\n', at) == std::string::npos) return 0;
  return std::atoi(stderr_text.c_str() + at + before.size());
}

std::string Ask(int port, const std::string& target) {
  const int connection = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  const std::string request = "GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n";
  std::string answer;
  if (connect(connection, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
      send(connection, request.data(), request.size(), MSG_NOSIGNAL) > 0) {
    char buffer[4096];
    for (ssize_t size = 0; (size = recv(connection, buffer, sizeof buffer, 0)) > 0;) {
      answer.append(buffer, static_cast<size_t>(size));
    }
  }
  close(connection);
  return answer;
}

// Without empty lines.
std::vector<std::string> Rows(const std::string& text) {
  std::vector<std::string> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) rows.push_back(line);
  }
  return rows;
}

// A simulated recording of corners and an IMU, to be played again.
class GuideCommand : public testing::Test {
 protected:
  GuideCommand() {
    const Ended made =
        RunProgram({"simulate", "--rig", scratch_.Write("rig.yaml", RigYaml()), "--motion",
                    scratch_.Write("motion.yaml", MotionYaml(0.05)), "--out", recorded_});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    Value chain = Value::Object();
    chain.Set("cam0", ReadYaml(scratch_.Path("rig.yaml")).At("cameras").At("cam0"));
    (void)scratch_.Write("camchain.yaml", ToYaml(chain));
  }

  Arguments Guide(const Arguments& more) const {
    Arguments arguments = {"guide",
                           "--replay",
                           recorded_,
                           "--target",
                           recorded_ + "/target.yaml",
                           "--cameras",
                           scratch_.Path("camchain.yaml"),
                           "--imu",
                           recorded_ + "/imu.yaml",
                           "--out",
                           out_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  // What the page of a running command is told once there is a hint.
  static std::string StateWithHint(const std::string& err, int* port) {
    std::string state;
    for (int k = 0; k < 600 && state.find("\"hint\"") == std::string::npos; ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      if (*port == 0) *port = PortIn(ContentOf(err));
      if (*port != 0) state = Ask(*port, "/state");
    }
    return state;
  }

  ScratchFolder scratch_;
  std::string recorded_ = scratch_.Path("recorded");
  std::string out_ = scratch_.Path("out");
};

TEST_F(GuideCommand, KeepsARecordingAndCalibratesIt) {
  const Ended ended = RunProgram(Guide({"--speed", "0", "--want", "time-ms=1e-6"}));
  EXPECT_THAT(ended.exit_code, AnyOf(0, 1)) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("open http://127.0.0.1:"));
  EXPECT_THAT(ended.out, AllOf(HasSubstr("the recording is over"), HasSubstr("report: ")));
  // What was kept is what was played.
  EXPECT_EQ(Rows(ContentOf(out_ + "/cam0_corners.csv")),
            Rows(ContentOf(recorded_ + "/cam0_corners.csv")));
  EXPECT_GT(ContentOf(out_ + "/imu0.csv").size(), 10'000U);
  const Value result = ReadJson(out_ + "/calibration/result.json");
  EXPECT_EQ(result.At("kind").AsString(), "camera-imu");
  EXPECT_EQ(result.At("termination").AsString(), "converged");
  // The folder is a recording for other commands too.
  const Ended again =
      RunProgram({"calibrate", "camera-imu", out_, "--target", recorded_ + "/target.yaml",
                  "--cameras", scratch_.Path("camchain.yaml"), "--imu", recorded_ + "/imu.yaml",
                  "--out", scratch_.Path("again")});
  EXPECT_THAT(again.exit_code, AnyOf(0, 1)) << again.err;
  EXPECT_EQ(ContentOf(scratch_.Path("again/result.json")),
            ContentOf(out_ + "/calibration/result.json"));
}

TEST_F(GuideCommand, ShowsItsStateWhileItRuns) {
  const std::string err = scratch_.Path("stderr");
  RunningProgram program(Guide({"--port", "0", "--speed", "0.1", "--want", "time-ms=1e-6"}),
                         std::nullopt, WithStderrIn(err));
  int port = 0;
  const std::string state = StateWithHint(err, &port);
  EXPECT_THAT(state, AllOf(HasSubstr("\"phase\": \"capturing\""), HasSubstr("\"words\": "),
                           HasSubstr("\"ghost\": [["), HasSubstr("\"rot_x\"")));
  EXPECT_THAT(Ask(port, "/"), HasSubstr("<title>calibrato guide</title>"));
  EXPECT_THAT(Ask(port, "/../recorded/rig.yaml"), HasSubstr("404"));
  program.Signal(SIGINT);
  const Ended ended = program.Wait();
  EXPECT_EQ(ended.signal, 0);
  EXPECT_THAT(ended.out, HasSubstr("interrupted after"));
}

TEST_F(GuideCommand, AsksForTheMotionOfAPolicy) {
  const std::string policy = scratch_.Path("policy");
  fs::create_directory(policy);
  fs::copy_file(scratch_.Path("motion.yaml"), policy + "/motion.yaml");
  const std::string err = scratch_.Path("stderr");
  RunningProgram program(
      Guide({"--policy", policy, "--port", "0", "--speed", "0.1", "--want", "time-ms=1e-6"}),
      std::nullopt, WithStderrIn(err));
  int port = 0;
  EXPECT_THAT(StateWithHint(err, &port), HasSubstr("\"name\": \"loop 1\""));
  program.Signal(SIGINT);
  EXPECT_EQ(program.Wait().signal, 0);
}

TEST_F(GuideCommand, KilledInTheMiddleKeepsWhatWasThere) {
  RunningProgram program(Guide({"--speed", "0.3", "--want", "time-ms=1e-6"}));
  for (int k = 0; k < 600 && ContentOf(out_ + "/cam0_corners.csv").size() < 30'000; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  program.Signal(SIGKILL);
  EXPECT_EQ(program.Wait().signal, SIGKILL);
  const Ended check = RunProgram({"check", out_, "--target", recorded_ + "/target.yaml"});
  EXPECT_THAT(check.exit_code, AnyOf(0, 1)) << check.err;
  EXPECT_THAT(check.out, HasSubstr("imu0 gyroscope"));
}

TEST_F(GuideCommand, OnAFullDiskKeepsWhatWasThere) {
  const Ended ended = RunProgram(Guide({"--speed", "0"}), 60'000);
  EXPECT_EQ(ended.signal, 0);
  EXPECT_EQ(ended.exit_code, 1) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("cannot write recording"));
  const Ended check = RunProgram({"check", out_, "--target", recorded_ + "/target.yaml"});
  EXPECT_THAT(check.exit_code, AnyOf(0, 1)) << check.err;
  EXPECT_THAT(check.out, HasSubstr("imu0 gyroscope"));
}

TEST_F(GuideCommand, RefusesWhatDoesNotGoTogether) {
  const std::string target = recorded_ + "/target.yaml";
  for (const Arguments& arguments :
       {Arguments{"guide", "--target", target, "--out", out_},
        Arguments{"guide", "--target", target, "--out", out_, "--camera", "0", "--replay",
                  recorded_},
        Arguments{"guide", "--target", target, "--out", out_, "--camera", "/nowhere/video9"},
        Arguments{"guide", "--target", target, "--out", out_, "--replay", recorded_, "--cameras",
                  scratch_.Path("camchain.yaml")},
        Guide({"--no-imu"}), Guide({"--want", "time-ms=nan"}), Guide({"--speed", "nan"}),
        Guide({"--speed", "0.001"}), Guide({"--model", "pinhole-radtam"}),
        Guide({"--host", "192.0.2.1"}), Guide({"--imu-pipe", "/dev/null"}),
        Guide({"--policy", "/nowhere"})}) {
    const Ended ended = RunProgram(arguments);
    EXPECT_EQ(ended.exit_code, 2) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("error: "));
    EXPECT_FALSE(fs::exists(out_)) << ended.err;
  }
}

TEST_F(GuideCommand, RefusesSeveralCamerasOrIMUsBeforeItRecords) {
  Value chain = ReadYaml(scratch_.Path("camchain.yaml"));
  chain.Set("cam1", ReadYaml(scratch_.Path("camchain.yaml")).At("cam0"));
  Value imus = Value::Object();
  for (const char* name : {"imu0", "imu1"}) {
    imus.Set(name, ReadYaml(scratch_.Path("rig.yaml")).At("imu"));
  }
  const auto refusal = [&](const std::string& cameras, const std::string& imu) {
    const Ended ended =
        RunProgram({"guide", "--replay", recorded_, "--target", recorded_ + "/target.yaml",
                    "--cameras", cameras, "--imu", imu, "--out", out_});
    EXPECT_EQ(ended.exit_code, 2) << ended.err;
    EXPECT_FALSE(fs::exists(out_)) << ended.err;
    return ended.err;
  };
  EXPECT_THAT(refusal(scratch_.Write("two.yaml", ToYaml(chain)), recorded_ + "/imu.yaml"),
              HasSubstr("several cameras"));
  EXPECT_THAT(refusal(scratch_.Path("camchain.yaml"), scratch_.Write("imus.yaml", ToYaml(imus))),
              HasSubstr("several IMUs"));
}

}  // namespace
}  // namespace calibrato
