#pragma once

#include <Eigen/Core>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "calibrato/calibration/coverage_range.h"
#include "calibrato/guide/gesture.h"
#include "calibrato/guide/gesture_choice.h"
#include "calibrato/guide/live_estimate.h"
#include "calibrato/motion/motion.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

struct GuideOptions {
  HandLimits hand;
  double solve_period_s = 2.0;    ///< Between two solves, by the camera's clock > 0.
  double max_duration_s = 600.0;  ///< Then it ends, whatever is reached > 0.
  /// Its loops are asked for, in their order and again (motion_gestures.h), instead of what is
  /// expected to tell most.
  std::optional<Motion> motion{};
};

/// All that a page shows of a session at one moment.
struct GuideSnapshot {
  double elapsed_s = 0.0;  ///< By the camera's clock, from the first frame on.
  int num_frames = 0;
  int num_views = 0;  ///< Frames with the board.
  int num_imu_samples = 0;
  int num_dropped_frames = 0;      ///< That came faster than they could be taken.
  std::optional<BoardView> view;   ///< Of the latest frame.
  std::optional<Gesture> gesture;  ///< To make now ...
  double gesture_left_s = 0.0;     ///< ... for so long ...
  std::string next_words;          ///< ... and then this; empty if not known yet.
  /// Where the board should be seen right now: its four outer corners, around [px]. Empty where
  /// they are out of view, or nothing is asked for.
  std::vector<Eigen::Vector2d> ghost;
  /// From where the board's middle is seen to where it should go next [px]; empty or two points.
  std::vector<Eigen::Vector2d> arrow;
  std::vector<ParameterProgress> progress;
  bool is_measured = false;  ///< Else progress is a guess before data.
  Coverage coverage;
  std::vector<std::string> warnings;  ///< Of the last seconds.
  double time_left_s = 0.0;           ///< 0 where it is not known.
  std::optional<std::string> ended;   ///< Why, in words, once it has.
};

/// Guides a person through a recording: frames and IMU samples in, what to do next out. A frame is
/// searched for the board by whoever hands it over; solves and the choice of gestures run on a
/// thread of the session's own, every few seconds, on all the data so far: a hint never waits for
/// them. A gesture in which too many frames were without the board, or blurred, gives way to
/// others. It ends by itself when all that is wanted is reached, when more would not help, or when
/// its time is over. Its clock is that of the frames, with the board or without.
class GuideSession {
 public:
  GuideSession(const Board& board, GuideProblem problem, GuideOptions options);
  ~GuideSession();
  GuideSession(const GuideSession&) = delete;
  GuideSession& operator=(const GuideSession&) = delete;

  /// One frame, in order of time. Those that do not ascend are left out, with a warning.
  /// @return false where it was left out.
  bool AddFrame(Time stamp, const GreyImage& image);
  /// The same of a frame that was searched already.
  bool AddView(Time stamp, std::optional<BoardView> view);
  /// Samples in order of time; not finite or not ascending ones are left out, with a warning.
  /// @return false where it was left out.
  bool AddGyro(const VectorSample& sample);
  bool AddAccel(const VectorSample& sample);
  /// Shown for the next seconds, once however often it is given.
  void AddWarning(const std::string& words);
  /// Frames that the camera had and nobody could take: counted, and warned of.
  void AddDroppedFrames(int number);

  /// Ends it, for a reason of the caller's: "the camera is gone". The first reason stands.
  void End(const std::string& why);
  [[nodiscard]] bool has_ended() const;

  [[nodiscard]] GuideSnapshot Snapshot() const;
  /// Waits until a solve has taken in all data so far: for tests and replays without a clock.
  void WaitForSolve();

 private:
  struct Warning {
    std::string words;
    double at_s = 0.0;
  };
  void Warn(const std::string& words);
  bool AddSample(const VectorSample& sample, std::vector<VectorSample>* samples,
                 const char* sensor);
  // Frames of a gesture, the way to it included.
  struct FrameCount {
    int good = 0;  // With the board, and sharp.
    int all = 0;
  };
  // What the hand did so far, as far as a plan goes by it.
  struct Experience {
    double pace = 1.0;     // Of the hand, slowed down where images blur.
    size_t num_taken = 0;  // Gestures.
    int last_loop = 0;     // Of the motion, from 1; 0 before the first.
    // Of gestures in which too many frames were lost when they were asked for last, by name.
    std::map<std::string, FrameCount> lost;
  };
  void JudgeGesture();
  void TakeNextGesture();
  [[nodiscard]] GuidePlan PlanFrom(const LiveEstimate& estimate, const Rigid3& T_c_g,
                                   const Experience& experience, double rate_hz) const;
  bool AddSearchedView(Time stamp, std::optional<BoardView> view, bool is_sharp);
  void SolveAgainAndAgain();

  const Board board_;
  const GuideProblem problem_;
  const GuideOptions options_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  GuideData data_;
  LiveEstimate estimate_;
  GuidePlan plan_;
  bool has_new_plan_ = false;
  size_t next_in_plan_ = 0;
  std::optional<BoardView> start_;  // The first view: gestures are made around it.
  std::optional<BoardView> latest_;
  CoverageRange coverage_;
  std::optional<Gesture> gesture_;
  double gesture_begin_s_ = 0.0;
  FrameCount frames_in_gesture_;
  Experience experience_;
  std::optional<Time> first_stamp_;
  Time last_stamp_;
  double last_seen_s_ = 0.0;
  int num_frames_ = 0;
  int num_dropped_frames_ = 0;
  double dropped_at_s_ = 0.0;
  size_t samples_at_last_check_ = 0;
  double last_check_s_ = 0.0;
  std::vector<Warning> warnings_;
  std::optional<std::string> ended_;
  std::optional<double> solving_until_s_;  // What the latest solve takes in, done or not ...
  std::optional<double> solved_until_s_;   // ... and the latest that is done.
  bool stop_ = false;
  bool wants_solve_ = false;
  std::thread solver_;
};

}  // namespace calibrato
