#pragma once

#include <Eigen/Core>

#include "calibrato/calibration/coverage.h"

namespace calibrato {

/// CoverageOf, view by view: what a live page shows after each.
class CoverageRange {
 public:
  void Add(const ViewParameters& view);
  /// All zero without views.
  [[nodiscard]] Coverage coverage() const;

 private:
  using Values = Eigen::Array4d;  // x, y, size, skew.
  bool is_empty_ = true;
  Values low_ = Values::Zero();
  Values high_ = Values::Zero();
};

}  // namespace calibrato
