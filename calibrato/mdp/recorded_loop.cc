#include "calibrato/mdp/recorded_loop.h"

#include <utility>

#include "calibrato/detection/detect.h"
#include "calibrato/recording/photo.h"
#include "calibrato/simulation/simulated_run.h"

namespace calibrato {
namespace {

std::vector<BoardView> Detected(const SimulatedRun& run, const Rig& rig) {
  ImageSource images;
  for (const StampedPng& image : run.images) {
    images.names.push_back(std::to_string(image.stamp.nanoseconds()));
    images.stamps.push_back(image.stamp);
  }
  if (images.names.empty()) return {};
  images.load = [&](size_t k) { return DecodePhoto({run.images[k].png, ""}, images.names[k]); };
  return SearchForBoards(images, rig.board).views;
}

// Without a simulation of the IMU where nobody asks for it.
SimulatedRun FastRun(const Rig& rig, const TimedMotion& motion, Time start, const Rng& rng) {
  SimulatedRun run;
  Rng noise = rng;
  run.frames = SimulateFrames(rig, motion, start, noise);
  return run;
}

}  // namespace

RecordedLoop RecordLoop(const Rig& rig, const TimedMotion& motion, Fidelity fidelity, Time start,
                        const Rng& rng, bool want_imu) {
  SimulatedRun run = fidelity == Fidelity::kFast && !want_imu
                         ? FastRun(rig, motion, start, rng)
                         : SimulateRun(rig, motion, fidelity, start, rng);
  RecordedLoop loop;
  loop.num_frames = run.frames.num_frames;
  loop.views = fidelity == Fidelity::kRendered ? Detected(run, rig) : std::move(run.frames.views);
  // The last frame is at most a period before the end, jitter aside.
  const double period_s = 1.0 / rig.camera_rate_hz;
  loop.last_frame_has_board = !loop.views.empty() && (loop.views.back().stamp - start).seconds() >
                                                         motion.duration_s() - 1.25 * period_s;
  if (want_imu) loop.imu = std::move(run.imu.stream);
  return loop;
}

}  // namespace calibrato
