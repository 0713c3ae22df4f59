#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/evaluation/chart.h"
#include "calibrato/evaluation/contest.h"
#include "calibrato/evaluation/contestant.h"

namespace calibrato {

/// The horizontal fields of view of the paper's Figure 4 [rad].
inline constexpr double kFigure4FieldsOfView[] = {0.8, 0.9, 1.0, 1.1, 1.2};

/// The rigs of the setting with another field of view. A lens that can't have it with its
/// distortion is drawn anew.
/// @pre no fixed rig
[[nodiscard]] std::vector<Rig> RigsWithFieldOfView(const ContestSetting& setting, double hfov_rad);

struct Figure4Point {
  double hfov_rad = 0.0;
  std::string policy;
  std::vector<std::vector<Trial>> trials;  ///< [member][rig]
};

/// The paper's Figure 4: the error of the intrinsics against the field of view, for `random`,
/// `handcrafted` and what was brought. All motions were planned for 1 rad; the same noise serves
/// every field of view.
struct Figure4 {
  ContestSetting setting;
  std::vector<Figure4Point> points;  ///< By field of view, then by policy.
};
[[nodiscard]] Figure4 EvaluateFigure4(const ContestSetting& setting,
                                      const std::vector<MotionUnderTrial>& motions);

/// {"kind": "figure4", "rows": [..]}: the rows of MethodRow with "hfov_rad".
[[nodiscard]] Value ToValue(const Figure4& figure);
[[nodiscard]] std::vector<Chart> ChartsOf(const Figure4& figure);

}  // namespace calibrato
