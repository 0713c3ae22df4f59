#pragma once

#include <map>
#include <string>
#include <vector>

#include "calibrato/guide/gesture.h"
#include "calibrato/guide/live_estimate.h"

namespace calibrato {

/// What a gesture would add to what is known, at these rates of frames and with the noise found so
/// far. Frames count where the board is in the image; the way to the gesture does not.
/// @return Information on what LayoutOf names.
[[nodiscard]] Eigen::MatrixXd ExpectFromGesture(const GuideProblem& problem,
                                                const LiveEstimate& estimate,
                                                const Gesture& gesture, double camera_rate_hz);

/// What to do next.
struct GuidePlan {
  /// The gestures to make, in their order, until all that is wanted is reached. Of PlanGestures
  /// each is the one that adds most a second to what is known with those before it. Empty where
  /// nothing is left to do.
  std::vector<Gesture> gestures;
  double time_left_s = 0.0;  ///< Of all of them, the ways between them included.
  bool is_reached = false;   ///< All that is wanted.
  bool is_in_order = false;  ///< Of a motion that was chosen beforehand.
  /// False where half a minute of these gestures would leave every sigma that is not reached
  /// within 5 % of what it is: what is wanted is more than these gestures can give.
  bool more_helps = true;
};

struct GesturePlanOptions {
  double camera_rate_hz = 20.0;
  double way_s = 1.5;     ///< From one gesture to the next, with reading what it is.
  int max_gestures = 40;  ///< Where what is wanted is far away.
  /// By name, what to count on of what a gesture would gain, in (0, 1]; 1 for any other. Below it,
  /// the gesture comes after others of the same gain; sigmas are expected as if it went well.
  std::map<std::string, double> trust{};
};

/// Ranks the gestures by expected information and trust and goes on with the best, again and again.
[[nodiscard]] GuidePlan PlanGestures(const GuideProblem& problem, const LiveEstimate& estimate,
                                     const std::vector<Gesture>& gestures,
                                     const GesturePlanOptions& options);

/// The gestures of a motion that was chosen beforehand, in their order from one of them on, again
/// and again until what is wanted is reached, with the same judgement of when and whether.
/// @param first  Taken modulo their number.
[[nodiscard]] GuidePlan PlanInOrder(const GuideProblem& problem, const LiveEstimate& estimate,
                                    const std::vector<Gesture>& gestures, size_t first,
                                    const GesturePlanOptions& options);

}  // namespace calibrato
