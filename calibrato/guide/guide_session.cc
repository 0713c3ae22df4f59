#include "calibrato/guide/guide_session.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "calibrato/calibration/plane_pose.h"
#include "calibrato/detection/detect.h"
#include "calibrato/diagnosis/image_quality.h"
#include "calibrato/guide/motion_gestures.h"

namespace calibrato {
namespace {

constexpr double kWay = 1.5;               // From one gesture to the next [s].
constexpr double kWarningLasts = 3.0;      // [s]
constexpr double kLost = 1.0;              // Without the board, before it is said [s].
constexpr double kSilence = 1.0;           // Of an IMU [s].
constexpr double kGap = 0.5;               // Between two frames [s].
constexpr double kBlurred = 5.0;           // Width of an edge [px] ...
constexpr double kUnscaledWidth = 1280.0;  // ... of images up to this width [px].
constexpr double kFullPixel = 250.0;
constexpr double kLowContrast = 40.0;
constexpr double kGoodShare = 0.6;  // Of the frames of a gesture; with less, it was too fast.
constexpr double kSlower = 0.75;
constexpr double kSlowest = 0.3;
constexpr double kShortestSession = 15.0;  // Before it says that more would not help [s].

double SecondsSince(const std::optional<Time>& first, Time stamp) {
  return first ? (stamp - *first).seconds() : 0.0;
}

Eigen::Vector3d MiddleOf(const BoardView& points) {
  return 0.5 * (points.points_g.rowwise().minCoeff() + points.points_g.rowwise().maxCoeff());
}

// The board's four outer corners as a camera there sees them; empty where one is out of view.
std::vector<Eigen::Vector2d> OutlineFrom(const CameraModel& camera, const BoardView& points,
                                         const Rigid3& T_c_g) {
  const Eigen::Vector3d low = points.points_g.rowwise().minCoeff();
  const Eigen::Vector3d high = points.points_g.rowwise().maxCoeff();
  std::vector<Eigen::Vector2d> outline;
  for (const Eigen::Vector3d& corner : {low, Eigen::Vector3d(high.x(), low.y(), 0.0), high,
                                        Eigen::Vector3d(low.x(), high.y(), 0.0)}) {
    const auto pixel = camera.Project(T_c_g * corner);
    if (!pixel) return {};
    outline.push_back(*pixel);
  }
  return outline;
}

}  // namespace

GuideSession::GuideSession(const Board& board, GuideProblem problem, GuideOptions options)
    : board_(board),
      problem_(std::move(problem)),
      options_(std::move(options)),
      estimate_(GuessBefore(problem_)) {
  solver_ = std::thread([this] { SolveAgainAndAgain(); });
}

GuideSession::~GuideSession() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  solver_.join();
}

bool GuideSession::AddFrame(Time stamp, const GreyImage& image) {
  std::optional<BoardView> view = DetectBoard(image, board_);
  bool is_sharp = true;
  std::vector<std::string> faults;
  if (view) {
    if (const auto sharpness = SharpnessOf(image, *view, board_)) {
      const double scale = std::max(1.0, image.resolution.width / kUnscaledWidth);
      is_sharp = sharpness->edge_width_px <= kBlurred * scale;
      if (!is_sharp) faults.emplace_back("blurred: move slower, or shorten the exposure");
      if (sharpness->white >= kFullPixel) {
        faults.emplace_back("white paper is saturated: shorten the exposure, or dim the light");
      }
      if (sharpness->white - sharpness->black < kLowContrast) {
        faults.emplace_back("hardly any contrast on the board: more light");
      }
    }
  }
  {
    const std::lock_guard lock(mutex_);
    for (const std::string& fault : faults) Warn(fault);
  }
  return AddSearchedView(stamp, std::move(view), is_sharp);
}

bool GuideSession::AddView(Time stamp, std::optional<BoardView> view) {
  return AddSearchedView(stamp, std::move(view), true);
}

bool GuideSession::AddSearchedView(Time stamp, std::optional<BoardView> view, bool is_sharp) {
  const std::lock_guard lock(mutex_);
  if (ended_) return false;
  if (first_stamp_ && stamp <= last_stamp_) {
    Warn("a frame's stamp did not ascend: it was left out");
    return false;
  }
  if (first_stamp_ && (stamp - last_stamp_).seconds() > kGap) Warn("frames were missing");
  if (!first_stamp_) first_stamp_ = stamp;
  last_stamp_ = stamp;
  ++num_frames_;
  ++frames_in_gesture_.all;
  const double now_s = SecondsSince(first_stamp_, stamp);
  latest_.reset();
  if (view) {
    view->stamp = stamp;
    view->name = std::to_string(stamp.nanoseconds());
    latest_ = view;
    last_seen_s_ = now_s;
    if (is_sharp) ++frames_in_gesture_.good;
    if (!start_) start_ = *view;
    coverage_.Add(ViewParametersOf(*view, problem_.resolution));
    data_.views.push_back(std::move(*view));
  } else if (now_s - last_seen_s_ > kLost) {
    Warn("the board is not seen");
  }
  if (problem_.imu && now_s - last_check_s_ > kSilence) {
    if (data_.imu.gyro.size() == samples_at_last_check_) Warn("the IMU is silent");
    samples_at_last_check_ = data_.imu.gyro.size();
    last_check_s_ = now_s;
  }
  if (!gesture_ || now_s - gesture_begin_s_ > gesture_->duration_s + kWay) TakeNextGesture();
  if (now_s >= options_.max_duration_s) ended_ = "the time is over";
  if (!solving_until_s_ || now_s - *solving_until_s_ >= options_.solve_period_s) {
    wants_solve_ = start_.has_value();
    if (wants_solve_) changed_.notify_all();
  }
  return true;
}

bool GuideSession::AddGyro(const VectorSample& sample) {
  const std::lock_guard lock(mutex_);
  return AddSample(sample, &data_.imu.gyro, "gyroscope");
}

bool GuideSession::AddAccel(const VectorSample& sample) {
  const std::lock_guard lock(mutex_);
  return AddSample(sample, &data_.imu.accel, "accelerometer");
}

void GuideSession::AddWarning(const std::string& words) {
  const std::lock_guard lock(mutex_);
  Warn(words);
}

void GuideSession::AddDroppedFrames(int number) {
  const std::lock_guard lock(mutex_);
  num_dropped_frames_ += number;
  dropped_at_s_ = SecondsSince(first_stamp_, last_stamp_);
}

bool GuideSession::AddSample(const VectorSample& sample, std::vector<VectorSample>* samples,
                             const char* sensor) {
  if (ended_) return false;
  if (!sample.value.allFinite()) {
    Warn(std::string("the ") + sensor + " gave a sample that is no number");
    return false;
  }
  if (!samples->empty() && sample.stamp <= samples->back().stamp) {
    Warn(std::string("a stamp of the ") + sensor + " did not ascend");
    return false;
  }
  samples->push_back(sample);
  return true;
}

void GuideSession::Warn(const std::string& words) {
  const double now_s = SecondsSince(first_stamp_, last_stamp_);
  std::erase_if(warnings_, [&](const Warning& old) {
    return old.words == words || now_s - old.at_s > kWarningLasts;
  });
  warnings_.push_back({words, now_s});
}

// Little is learned without the board, or blurred; and from the same data follows the same plan.
// So a gesture that went wrong is asked for slower, and later than others.
void GuideSession::JudgeGesture() {
  const FrameCount frames = frames_in_gesture_;
  frames_in_gesture_ = {};
  if (!gesture_ || frames.all == 0) return;
  if (frames.good >= kGoodShare * frames.all) {
    experience_.lost.erase(gesture_->name);
    return;
  }
  FrameCount& lost = experience_.lost[gesture_->name];
  lost.good += frames.good;
  lost.all += frames.all;
  experience_.pace = std::max(kSlowest, kSlower * experience_.pace);
  Warn("too many frames were lost: slower");
}

// From the newest plan; where it is older than the gesture that ends, its next.
void GuideSession::TakeNextGesture() {
  JudgeGesture();
  if (has_new_plan_) next_in_plan_ = 0;
  has_new_plan_ = false;
  gesture_.reset();
  if (next_in_plan_ >= plan_.gestures.size()) return;
  gesture_ = plan_.gestures[next_in_plan_++];
  ++experience_.num_taken;
  experience_.last_loop = gesture_->loop_number;
  gesture_begin_s_ = SecondsSince(first_stamp_, last_stamp_);
}

GuidePlan GuideSession::PlanFrom(const LiveEstimate& estimate, const Rigid3& T_c_g,
                                 const Experience& experience, double rate_hz) const {
  GestureSetting setting{estimate.camera, problem_.resolution, problem_.points,
                         FacingBoard(problem_.points, T_c_g.Inverse()), options_.hand};
  const double pace = experience.pace;
  setting.hand.speed *= pace;
  setting.hand.acceleration *= pace * pace;
  setting.hand.angular_speed *= pace;
  setting.hand.angular_acceleration *= pace * pace;
  GesturePlanOptions plan{rate_hz, kWay, 40};
  // Above 0 even without a good frame: where all go wrong, each has its turn again.
  for (const auto& [name, frames] : experience.lost) {
    plan.trust[name] = (1.0 + frames.good) / (1.0 + frames.all);
  }
  if (options_.motion) {
    const std::vector<Gesture> loops = GesturesOfMotion(setting, *options_.motion);
    // Which loops fit may change: on with the first of them after the one that was made last.
    const auto next = std::ranges::find_if(
        loops, [&](const Gesture& loop) { return loop.loop_number > experience.last_loop; });
    const auto first = static_cast<size_t>(next - loops.begin());
    if (!loops.empty()) return PlanInOrder(problem_, estimate, loops, first, plan);
  }
  return PlanGestures(problem_, estimate, GesturesFor(setting), plan);
}

void GuideSession::End(const std::string& why) {
  const std::lock_guard lock(mutex_);
  if (!ended_) ended_ = why;
}

bool GuideSession::has_ended() const {
  const std::lock_guard lock(mutex_);
  return ended_.has_value();
}

void GuideSession::WaitForSolve() {
  std::unique_lock lock(mutex_);
  if (!start_) return;
  const double until_s = SecondsSince(first_stamp_, last_stamp_);
  wants_solve_ = true;
  changed_.notify_all();
  changed_.wait(lock, [&] { return solved_until_s_ && *solved_until_s_ >= until_s; });
}

void GuideSession::SolveAgainAndAgain() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return stop_ || wants_solve_; });
    if (stop_) return;
    wants_solve_ = false;
    const double now_s = SecondsSince(first_stamp_, last_stamp_);
    solving_until_s_ = now_s;
    const double rate_hz = now_s > 1.0 ? num_frames_ / now_s : 20.0;
    GuideData data = data_;
    BoardView start = *start_;
    const Experience experience = experience_;
    lock.unlock();
    LiveEstimate estimate = GuessBefore(problem_);
    GuidePlan plan;
    std::string fault;
    try {
      estimate = EstimateSoFar(problem_, data);
      if (const auto T_c_g = PoseFromView(estimate.camera, start)) {
        plan = PlanFrom(estimate, *T_c_g, experience, rate_hz);
      }
    } catch (const std::exception& error) {  // Of data; the recording goes on.
      fault = error.what();
    }
    lock.lock();
    if (!fault.empty()) Warn(fault);
    estimate_ = std::move(estimate);
    plan_ = std::move(plan);
    has_new_plan_ = true;
    if (options_.motion && !plan_.is_in_order && !plan_.gestures.empty()) {
      Warn("no loop of the policy fits into view and reach: other gestures are chosen");
    }
    // What was taken meanwhile was the beginning of this plan's order.
    if (plan_.is_in_order) {
      has_new_plan_ = false;
      next_in_plan_ = experience_.num_taken - experience.num_taken;
    }
    solved_until_s_ = now_s;
    const bool is_measured = (problem_.known_camera || estimate_.camera_is_measured) &&
                             (!problem_.imu || estimate_.extrinsics_are_measured);
    if (!ended_ && is_measured && plan_.is_reached) ended_ = "all that is wanted is reached";
    if (!ended_ && is_measured && !plan_.more_helps && now_s > kShortestSession) {
      ended_ = "more would not help";
    }
    changed_.notify_all();
  }
}

GuideSnapshot GuideSession::Snapshot() const {
  const std::lock_guard lock(mutex_);
  GuideSnapshot snapshot;
  const double now_s = SecondsSince(first_stamp_, last_stamp_);
  snapshot.elapsed_s = now_s;
  snapshot.num_frames = num_frames_;
  snapshot.num_views = static_cast<int>(data_.views.size());
  snapshot.num_imu_samples = static_cast<int>(data_.imu.gyro.size());
  snapshot.view = latest_;
  snapshot.progress = estimate_.progress;
  snapshot.is_measured =
      problem_.imu ? estimate_.extrinsics_are_measured : estimate_.camera_is_measured;
  snapshot.coverage = coverage_.coverage();
  for (const Warning& warning : warnings_) {
    if (now_s - warning.at_s <= kWarningLasts) snapshot.warnings.push_back(warning.words);
  }
  snapshot.num_dropped_frames = num_dropped_frames_;
  // A few are no loss: where more are left out than looked at, it is worth a word.
  if (num_dropped_frames_ > num_frames_ && now_s - dropped_at_s_ <= kWarningLasts) {
    snapshot.warnings.push_back("frames come faster than this machine takes them: " +
                                std::to_string(num_dropped_frames_) + " were left out");
  }
  snapshot.time_left_s = plan_.time_left_s;
  snapshot.ended = ended_;
  if (next_in_plan_ < plan_.gestures.size())
    snapshot.next_words = plan_.gestures[next_in_plan_].words;
  if (!gesture_ || ended_) return snapshot;
  snapshot.gesture = gesture_;
  const double t_s = now_s - gesture_begin_s_ - kWay;  // The way there comes first.
  snapshot.gesture_left_s = std::max(0.0, gesture_->duration_s - std::max(0.0, t_s));
  snapshot.ghost = OutlineFrom(estimate_.camera, problem_.points, PoseAt(*gesture_, t_s).Inverse());
  const double ahead_s = t_s < 0.0 ? t_s : t_s + 0.25 * gesture_->period_s;
  const auto to =
      estimate_.camera.Project(PoseAt(*gesture_, ahead_s).Inverse() * MiddleOf(problem_.points));
  if (latest_ && to) snapshot.arrow = {latest_->pixels.rowwise().mean(), *to};
  return snapshot;
}

}  // namespace calibrato
