#include "calibrato/guide/guide_session.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/calibration/planned_frame.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/guide/capture.h"
#include "calibrato/guide/guide_document.h"
#include "calibrato/guide/imu_pipe.h"

namespace calibrato {
namespace {

GuideProblem ProblemOf(const SyntheticCameraImu& truth) {
  GuideProblem problem;
  problem.points = PlannedView(truth.board);
  problem.resolution = truth.resolution;
  problem.known_camera = truth.model;
  problem.imu = truth.imu_noise;
  return problem;
}

Recording RecordingOf(const SyntheticCameraImu& truth) {
  Rng rng(4);
  const CameraImuProblem problem = truth.Problem(rng);
  Recording recording;
  recording.path = "synthetic";
  recording.cameras.push_back({"cam0", problem.cameras[0].views, truth.resolution});
  recording.imus.push_back({});
  recording.imus.back().stream = problem.imus[0].stream;
  return recording;
}

// Frames of a recording, until its plug is pulled.
class Unplugged : public FrameSource {
 public:
  Unplugged(const SyntheticCameraImu& truth, int num_frames, bool throws)
      : replay_(OpenReplaySource(RecordingOf(truth), 0.0, {})),
        num_left_(num_frames),
        throws_(throws) {}
  std::optional<CapturedFrame> Next(const ImuSink& sink,
                                    const std::function<bool()>& stop) override {
    if (num_left_-- > 0) return replay_->Next(sink, stop);
    if (throws_) throw InputError({"cannot read frame", "device", "no such device", ""});
    return std::nullopt;
  }
  Resolution resolution() const override { return replay_->resolution(); }
  std::string end_words() const override { return "the camera is gone"; }

 private:
  std::unique_ptr<FrameSource> replay_;
  int num_left_;
  bool throws_;
};

FrameSource::ImuSink SinkOf(GuideSession* session) {
  return {[session](const VectorSample& gyro, const VectorSample& accel) {
            session->AddGyro(gyro);
            session->AddAccel(accel);
          },
          {},
          {}};
}

TEST(GuideSession, AsksForGesturesAndEndsWhenAllIsReached) {
  SyntheticCameraImu truth;
  truth.duration_s = 12.0;
  GuideSession session(truth.board, ProblemOf(truth), {});
  EXPECT_FALSE(session.Snapshot().is_measured);
  const auto source = OpenReplaySource(RecordingOf(truth), 0.0, {});
  const FrameSource::ImuSink sink = SinkOf(&session);
  bool has_hint = false;
  for (int k = 0; auto frame = source->Next(sink, [] { return false; }); ++k) {
    session.AddView(frame->stamp, frame->view);
    if (k % 40 == 0) session.WaitForSolve();
    const GuideSnapshot snapshot = session.Snapshot();
    if (!snapshot.gesture) continue;
    has_hint = true;
    EXPECT_FALSE(snapshot.gesture->words.empty());
    EXPECT_EQ(snapshot.ghost.size(), 4U);
    EXPECT_GE(snapshot.gesture_left_s, 0.0);
    const Value document = GuideDocument(snapshot, {}, truth.resolution);
    EXPECT_EQ(ParseJson(ToJson(document), "state").At("hint").At("words").AsString(),
              snapshot.gesture->words);
  }
  EXPECT_TRUE(has_hint);
  const GuideSnapshot last = session.Snapshot();
  EXPECT_TRUE(last.is_measured);
  ASSERT_TRUE(last.ended);
  EXPECT_EQ(*last.ended, "all that is wanted is reached");
  EXPECT_LT(last.elapsed_s, 11.9);
}

// At a gesture's place the board may never be seen: the hand does not get it right, or a table's
// edge is before it. From the same data follows the same plan; so others have to have their turn.
TEST(GuideSession, AsksForOtherGesturesWhereTheBoardIsNotSeen) {
  const SyntheticCameraImu truth;
  GuideOptions options;
  options.solve_period_s = std::numeric_limits<double>::infinity();  // Only when waited for.
  GuideSession session(truth.board, ProblemOf(truth), options);
  Rng rng(4);
  const BoardView view = truth.Problem(rng).cameras[0].views[0];
  constexpr double kRate = 10.0;
  std::vector<std::string> names;
  double left_s = 0.0;
  for (int k = 0; k < 40 * kRate; ++k) {
    const Time stamp = Time::FromNanoseconds(1) + Duration::FromSeconds(k / kRate);
    session.AddView(stamp, k < 2 ? std::optional(view) : std::nullopt);
    if (k % 20 == 0) session.WaitForSolve();
    const GuideSnapshot snapshot = session.Snapshot();
    if (!snapshot.gesture) continue;
    // Less time is left of the same hint with each frame.
    if (snapshot.gesture_left_s > left_s) names.push_back(snapshot.gesture->name);
    left_s = snapshot.gesture_left_s;
  }
  ASSERT_GE(names.size(), 8U);
  for (size_t k = 2; k < names.size(); ++k) {
    // Once more at most: the plan may be older than the gesture's end.
    EXPECT_FALSE(names[k] == names[k - 1] && names[k] == names[k - 2]) << k << " " << names[k];
  }
  std::sort(names.begin(), names.end());
  EXPECT_GE(std::unique(names.begin(), names.end()) - names.begin(), 5);
  EXPECT_FALSE(session.has_ended());
}

// Loop after loop, whatever would tell more, and again from the first.
TEST(GuideSession, AsksForTheLoopsOfAMotionInTheirOrder) {
  SyntheticCameraImu truth;
  truth.duration_s = 25.0;
  GuideOptions options;
  options.motion = HandcraftedMotion(Task::kExtrinsic);
  for (Loop& loop : options.motion->loops) loop.duration_s = 3.0;
  GuideProblem problem = ProblemOf(truth);
  problem.wanted = {1e-9, 1e-9, 1e-9, 1e-9};  // Never reached.
  GuideSession session(truth.board, problem, options);
  const auto source = OpenReplaySource(RecordingOf(truth), 0.0, {});
  const FrameSource::ImuSink sink = SinkOf(&session);
  std::vector<std::string> names;
  for (int k = 0; auto frame = source->Next(sink, [] { return false; }); ++k) {
    session.AddView(frame->stamp, frame->view);
    if (k % 20 == 0) session.WaitForSolve();
    const auto gesture = session.Snapshot().gesture;
    if (gesture && (names.empty() || names.back() != gesture->name)) names.push_back(gesture->name);
  }
  ASSERT_GE(names.size(), 4U);
  for (size_t k = 0; k < names.size(); ++k) {
    EXPECT_EQ(names[k], "loop " + std::to_string(k % 3 + 1));
  }
}

TEST(GuideSession, ChoosesGesturesAndSaysSoWhereNoLoopFits) {
  SyntheticCameraImu truth;
  truth.duration_s = 6.0;
  GuideOptions options;
  options.motion = HandcraftedMotion(Task::kExtrinsic);
  for (Loop& loop : options.motion->loops) loop.coefficients *= 1000.0;
  GuideProblem problem = ProblemOf(truth);
  problem.wanted = {1e-9, 1e-9, 1e-9, 1e-9};  // Never reached.
  GuideSession session(truth.board, problem, options);
  const auto source = OpenReplaySource(RecordingOf(truth), 0.0, {});
  const FrameSource::ImuSink sink = SinkOf(&session);
  bool is_said = false;
  for (int k = 0; auto frame = source->Next(sink, [] { return false; }); ++k) {
    session.AddView(frame->stamp, frame->view);
    if (k % 20 == 0) session.WaitForSolve();
    const GuideSnapshot snapshot = session.Snapshot();
    if (snapshot.gesture) {
      EXPECT_EQ(snapshot.gesture->loop_number, 0);
    }
    for (const std::string& warning : snapshot.warnings) {
      is_said = is_said || warning.find("no loop of the policy fits") != std::string::npos;
    }
  }
  EXPECT_TRUE(is_said);
}

TEST(GuideSession, CountsFramesThatCameTooFast) {
  const SyntheticCameraImu truth;
  GuideSession session(truth.board, ProblemOf(truth), {});
  EXPECT_TRUE(session.Snapshot().warnings.empty());
  session.AddDroppedFrames(3);
  session.AddDroppedFrames(2);
  const GuideSnapshot snapshot = session.Snapshot();
  EXPECT_EQ(snapshot.num_dropped_frames, 5);
  ASSERT_EQ(snapshot.warnings.size(), 1U);
  EXPECT_NE(snapshot.warnings[0].find("5 were left out"), std::string::npos);
}

TEST(GuideSession, WarnsOfStampsSilenceAndALostBoard) {
  const SyntheticCameraImu truth;
  GuideSession session(truth.board, ProblemOf(truth), {});
  Rng rng(4);
  const BoardView view = truth.Problem(rng).cameras[0].views[0];
  const auto at = [](double t_s) { return Time::FromNanoseconds(1) + Duration::FromSeconds(t_s); };
  EXPECT_TRUE(session.AddView(at(0.1), view));
  EXPECT_FALSE(session.AddView(at(0.1), view));
  EXPECT_EQ(session.Snapshot().warnings.at(0), "a frame's stamp did not ascend: it was left out");
  for (double t = 0.2; t < 1.4; t += 0.1) session.AddView(at(t), std::nullopt);
  const auto warnings = session.Snapshot().warnings;
  EXPECT_NE(std::find(warnings.begin(), warnings.end(), "the board is not seen"), warnings.end());
  EXPECT_NE(std::find(warnings.begin(), warnings.end(), "the IMU is silent"), warnings.end());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(session.AddGyro({at(1.0), {0.0, nan, 0.0}}));
  EXPECT_EQ(session.Snapshot().warnings.back(), "the gyroscope gave a sample that is no number");
  EXPECT_EQ(session.Snapshot().num_imu_samples, 0);
  for (int k = 0; k < 3; ++k) session.AddWarning("a line is no sample");
  const auto with_line = session.Snapshot().warnings;
  EXPECT_EQ(std::count(with_line.begin(), with_line.end(), "a line is no sample"), 1);
  // Warnings pass.
  for (double t = 1.5; t < 6.0; t += 0.1) session.AddView(at(t), view);
  const auto later = session.Snapshot().warnings;
  EXPECT_EQ(std::find(later.begin(), later.end(), "the board is not seen"), later.end());
}

TEST(Capture, KeepsWhatWasRecordedWhenTheCameraGoes) {
  const SyntheticCameraImu truth;
  for (const bool throws : {false, true}) {
    const std::string path =
        std::filesystem::temp_directory_path() / ("calibrato_capture_" + std::to_string(getpid()));
    std::filesystem::remove_all(path);
    GuideSession session(truth.board, ProblemOf(truth), {});
    Unplugged source(truth, 30, throws);
    LatestFrame latest;
    {
      GrowingRecording recording(path, truth.resolution, 1);
      Capture(source, &session, &recording, &latest, [] { return false; });
    }
    ASSERT_TRUE(session.Snapshot().ended);
    EXPECT_NE(session.Snapshot().ended->find(throws ? "no such device" : "the camera is gone"),
              std::string::npos);
    const Recording read = OpenRecording(path, {});
    EXPECT_EQ(std::get<std::vector<BoardView>>(read.cameras[0].data).size(), 30U);
    EXPECT_GT(read.imus[0].stream.gyro.size(), 200U);
    std::filesystem::remove_all(path);
  }
}

// Plays a recording through a session without a clock, and reads what was kept of it.
Recording KeptOf(const SyntheticCameraImu& truth, const Recording& played) {
  const std::string path =
      std::filesystem::temp_directory_path() / ("calibrato_kept_" + std::to_string(getpid()));
  std::filesystem::remove_all(path);
  GuideProblem problem = ProblemOf(truth);
  problem.wanted.time_offset_s = 1e-12;  // Never reached: it goes on to the end.
  GuideSession session(truth.board, problem, {});
  LatestFrame latest;
  {
    GrowingRecording recording(path, truth.resolution, 1);
    const auto source = OpenReplaySource(played, 0.0, {});
    Capture(*source, &session, &recording, &latest, [] { return false; });
  }
  EXPECT_EQ(session.Snapshot().ended, "the recording is over");
  Recording kept = OpenRecording(path, {});
  EXPECT_EQ(std::filesystem::exists(path + "/imu0.csv"),
            !std::filesystem::exists(path + "/gyro0.csv"));
  std::filesystem::remove_all(path);
  return kept;
}

TEST(OpenReplaySource, WaitsInSlicesThatAStopEnds) {
  const SyntheticCameraImu truth;
  Recording played = RecordingOf(truth);
  played.imus.clear();
  const auto source = OpenReplaySource(std::move(played), 0.01, {});
  int num_asked = 0;
  const auto stop = [&] { return ++num_asked == 3; };
  ASSERT_TRUE(source->Next({}, stop));
  EXPECT_EQ(num_asked, 0);  // The first is due at once, the second five seconds later.
  ASSERT_TRUE(source->Next({}, stop));
  EXPECT_EQ(num_asked, 3);
}

TEST(Capture, KeepsSensorsOfDifferentRatesInListsOfTheirOwn) {
  SyntheticCameraImu truth;
  truth.duration_s = 4.0;
  Recording played = RecordingOf(truth);
  std::vector<VectorSample>& accel = played.imus[0].stream.accel;
  for (size_t k = 0; 2 * k < accel.size(); ++k) accel[k] = accel[2 * k];
  accel.resize((accel.size() + 1) / 2);
  const ImuStream kept = KeptOf(truth, played).imus.at(0).stream;
  // All but those after the last frame.
  ASSERT_GT(kept.accel.size(), 300U);
  EXPECT_GT(kept.gyro.size(), 2 * kept.accel.size() - 2);
  for (size_t k = 0; k < kept.accel.size(); ++k) {
    EXPECT_EQ(kept.accel[k].stamp, accel[k].stamp);
    EXPECT_EQ(kept.gyro.at(k).stamp, played.imus[0].stream.gyro[k].stamp);
  }
}

TEST(Capture, DoesNotKeepSamplesThatWereLeftOut) {
  SyntheticCameraImu truth;
  truth.duration_s = 4.0;
  Recording played = RecordingOf(truth);
  ImuStream& stream = played.imus[0].stream;
  stream.gyro[7].value.y() = std::numeric_limits<double>::quiet_NaN();
  stream.gyro[11].stamp = stream.accel[11].stamp = stream.gyro[10].stamp;
  const ImuStream kept = KeptOf(truth, played).imus.at(0).stream;
  ASSERT_GT(kept.gyro.size(), 300U);
  EXPECT_EQ(kept.gyro[6].stamp, stream.gyro[6].stamp);
  EXPECT_EQ(kept.gyro[7].stamp, stream.gyro[8].stamp);
  EXPECT_EQ(kept.gyro[9].stamp, stream.gyro[10].stamp);
  EXPECT_EQ(kept.gyro[10].stamp, stream.gyro[12].stamp);
}

TEST(ParseImuLine, TakesLinesOfListsAndNothingElse) {
  const auto sample = ParseImuLine("1700000000000000001,0.1,-0.2,3e-1,0,9.8,-1.5\r");
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->gyro.stamp.nanoseconds(), 1700000000000000001);
  EXPECT_EQ(sample->gyro.value, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_EQ(sample->accel.value, Eigen::Vector3d(0.0, 9.8, -1.5));
  for (const char* line : {"", "1", "1,2,3,4,5,6", "1,2,3,4,5,6,7,8", "x,1,2,3,4,5,6",
                           "-1,1,2,3,4,5,6", "1.5,1,2,3,4,5,6", "1,1,2,3,4,5,six"}) {
    EXPECT_FALSE(ParseImuLine(line)) << line;
  }
}

}  // namespace
}  // namespace calibrato
