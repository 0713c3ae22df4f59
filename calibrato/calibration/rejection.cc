#include "calibrato/calibration/rejection.h"

namespace calibrato {

std::string ViewRejectionName(ViewRejection reason) {
  switch (reason) {
    case ViewRejection::kTooFewCorners:
      return "too few corners";
    case ViewRejection::kNoPose:
      return "no pose of the board explains it";
    case ViewRejection::kDoesNotFit:
      return "does not fit";
  }
  return "";
}

}  // namespace calibrato
