#pragma once

#include "calibrato/base/value.h"

namespace calibrato {

/// One document of each kind, with every member that the page draws, of plausible numbers.
Value CameraDocumentForTest();
Value CameraImuDocumentForTest();
Value CheckDocumentForTest();
Value CameraImuDiffDocumentForTest();
Value MergeDocumentForTest();
Value NoiseDocumentForTest();
Value LearnDocumentForTest();
Value Table1DocumentForTest();
Value ParetoDocumentForTest();
Value DryRunDocumentForTest();

}  // namespace calibrato
