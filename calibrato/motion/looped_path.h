#pragma once

#include <array>
#include <vector>

#include "calibrato/motion/panda.h"
#include "calibrato/motion/way_point.h"

namespace calibrato {

/// Something at every way-point of a motion: poses, joint angles, ... All loops start and end at
/// one place, which is kept once.
template <typename T>
struct LoopedPath {
  static constexpr int kNumInner = kNumWayPoints - 1;
  using Loop = std::array<T, kNumInner>;

  T start;
  std::vector<Loop> loops;  ///< Way-points 1 to 61 of each.

  /// @param way_point  0 (the start) to 62 (the start again).
  const T& At(size_t loop, int way_point) const {
    return way_point == 0 || way_point == kNumWayPoints ? start : loops[loop][way_point - 1];
  }
};

using PosePath = LoopedPath<Rigid3>;        ///< T_b_e
using JointPath = LoopedPath<JointVector>;  ///< [rad]

}  // namespace calibrato
