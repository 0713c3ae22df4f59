#include "calibrato/calibration/coverage_range.h"

namespace calibrato {
namespace {

constexpr double kWantedX = 0.7;
constexpr double kWantedY = 0.7;
constexpr double kWantedSize = 0.4;
constexpr double kWantedSkew = 0.5;

}  // namespace

void CoverageRange::Add(const ViewParameters& view) {
  const Values values(view.x, view.y, view.size, view.skew);
  // The lowest size and skew count as 0.
  const Values lowest(view.x, view.y, 0.0, 0.0);
  low_ = is_empty_ ? lowest : low_.min(lowest);
  high_ = is_empty_ ? values : high_.max(values);
  is_empty_ = false;
}

Coverage CoverageRange::coverage() const {
  const Values wanted(kWantedX, kWantedY, kWantedSize, kWantedSkew);
  const Values progress = ((high_ - low_) / wanted).min(1.0);
  return {progress(0), progress(1), progress(2), progress(3)};
}

}  // namespace calibrato
