#pragma once

#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/evaluation/chart.h"
#include "calibrato/evaluation/table1.h"

namespace calibrato {

// The paper's Figure 5: how the error of the extrinsics is distributed over rigs, from the trials
// of Table 1's extrinsic task. The paper has 9 rigs.

/// {"kind": "figure5", "rows": [..]}: the rows of MethodRow with "quantiles_percent": {"q05",
/// "q25", "q50", "q75", "q95"} of the relative error.
[[nodiscard]] Value Figure5Value(const Table1& extrinsic);

/// Of relative, rotation, translation and time offset error.
[[nodiscard]] std::vector<Chart> Figure5Charts(const Table1& extrinsic);

}  // namespace calibrato
