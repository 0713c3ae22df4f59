#pragma once

#include <string>

#include "calibrato/base/value.h"
#include "calibrato/guide/guide_session.h"

namespace calibrato {

/// What the command does around a session.
struct GuidePhase {
  std::string phase = "capturing";  ///< "capturing", "calibrating", "done", "failed"
  std::string words;                ///< What went wrong, or what came of it; may be empty.
  bool has_report = false;
  double frame_to_hint_ms = 0.0;  ///< Median over the last frames.
};

/// What the page asks for ten times a second (docs/guide.md, "The page").
[[nodiscard]] Value GuideDocument(const GuideSnapshot& snapshot, const GuidePhase& phase,
                                  Resolution resolution);

}  // namespace calibrato
