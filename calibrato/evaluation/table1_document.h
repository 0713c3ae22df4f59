#pragma once

#include <string>

#include "calibrato/base/value.h"
#include "calibrato/evaluation/table1.h"

namespace calibrato {

/// {"kind": "table1", "rows": [..]} as in docs/formats.md section 3. Every figure stands beside its
/// n and seed.
[[nodiscard]] Value ToValue(const Table1& table);

/// What the report draws: errors of every rig, motions of the camera in the arm's base frame, what
/// the camera saw.
[[nodiscard]] Value Table1Plots(const Table1& table);

/// The table in plain text, for the terminal.
[[nodiscard]] std::string Table1Text(const Table1& table);

}  // namespace calibrato
