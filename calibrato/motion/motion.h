#pragma once

#include <string>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/base/value.h"
#include "calibrato/motion/looped_trajectory.h"

namespace calibrato {

enum class Carrier {
  kFree,  ///< A hand or a gantry.
  kArm,   ///< Franka Panda.
};
[[nodiscard]] std::string CarrierName(Carrier carrier);          ///< "free", "arm"
[[nodiscard]] Carrier CarrierFromName(const std::string& name);  ///< @throws InputError

/// How time is laid along a loop.
enum class Timing {
  kQuintic,  ///< A fifth-degree phase of the wished duration, stretched as far as limits need.
  kOptimal,  ///< As fast as the carrier's limits allow (optimal_timing.h), whatever was wished.
};
[[nodiscard]] std::string TimingName(Timing timing);           ///< "quintic", "optimal"
[[nodiscard]] Timing TimingFromName(const std::string& name);  ///< @throws InputError

enum class Task {
  kIntrinsic,  ///< The camera.
  kExtrinsic,  ///< Camera and IMU, the camera being known.
  kJoint,      ///< Both in one motion.
};
[[nodiscard]] std::string TaskName(Task task);             ///< "intrinsic", ..
[[nodiscard]] Task TaskFromName(const std::string& name);  ///< @throws InputError
[[nodiscard]] int NumLoops(Task task);                     ///< 4 intrinsic, 3 extrinsic, 4 joint.

struct Loop {
  LoopCoefficients coefficients = LoopCoefficients::Zero();  ///< After scaling, [m] and [rad].
  double duration_s = 5.0;  ///< > 0. Wished for; a carrier may need longer.
};

/// A calibration motion: loops through one base pose, one after the other.
struct Motion {
  Carrier carrier = Carrier::kFree;
  Timing timing = Timing::kQuintic;
  BasePose base_pose;
  std::vector<Loop> loops;
  Value provenance;  ///< Where it comes from, for people: method, seed, ... null if unknown.
};

/// MOTION.yaml (docs/formats.md section 3). @throws InputError with line and key: unless there are
/// 1 to 1000 loops of 36 finite coefficients (|x| <= 10) and positive durations. Unknown keys are
/// appended to warnings (may be null).
[[nodiscard]] Motion MotionFromValue(const Value& value, std::vector<std::string>* warnings);
[[nodiscard]] Value ToValue(const Motion& motion);

/// The paper's Eq. 2 with C = 1 m/rad over the closed loops, theta_j = 2 pi j / 62, j = 0 .. 62
/// [m].
[[nodiscard]] double PathLength(const Motion& motion);
[[nodiscard]] double PathLength(const LoopCoefficients& coefficients);

/// The length as the original code summed it, and so the only one to set beside the paper's column:
/// theta_j = 0.1 j; translation over way-points 1 .. 62, rotation over 0 .. 62; not closed [m].
[[nodiscard]] double PathLengthOriginal(const Motion& motion);

/// The paper's rivals. Handcrafted: as in the original implementation (four loops for the intrinsic
/// and joint tasks, with coefficients of 0.102; three for the extrinsic). Random: coefficients
/// uniform in
/// +-0.02 before scaling.
[[nodiscard]] Motion HandcraftedMotion(Task task);
[[nodiscard]] Motion RandomMotion(Task task, Rng& rng);

}  // namespace calibrato
