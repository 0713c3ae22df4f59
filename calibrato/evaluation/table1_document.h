#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/evaluation/table1.h"

namespace calibrato {

/// {"kind": "table1", "rows": [..]} as in docs/formats.md section 3, the tables one after the
/// other. Every figure stands beside its n and seed.
[[nodiscard]] Value ToValue(const std::vector<Table1>& tables, const std::string& kind = "table1");

/// What the report draws: errors of every rig, motions of the camera in the arm's base frame, what
/// the camera saw.
[[nodiscard]] Value Table1Plots(const std::vector<Table1>& tables);

/// Every trial on a line: what the tables are made of.
[[nodiscard]] std::string TrialsCsv(const std::vector<Table1>& tables);

/// The table in plain text, for the terminal.
[[nodiscard]] std::string Table1Text(const Table1& table);

}  // namespace calibrato
