#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"

namespace calibrato {

/// A picture of a result as plain numbers: what the report draws, and what whoever wants to draw it
/// elsewhere reads.
struct ChartSeries {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> low;   ///< Of an interval about y; as many as y, or empty.
  std::vector<double> high;  ///< Likewise.
};

struct Chart {
  enum class Kind {
    kLines,  ///< Points in the order of x, joined.
    kDots,   ///< Points, not joined.
    kBoxes,  ///< The distribution of each series' y; x is empty.
  };
  Kind kind = Kind::kLines;
  std::string title;
  std::string note;
  std::string x_title;  ///< With its unit: "path [m]".
  std::string y_title;
  bool is_x_logarithmic = false;
  bool is_y_logarithmic = false;
  std::vector<ChartSeries> series;
};

/// {"kind": "lines", "title", "note", "x_title", "y_title", "is_x_logarithmic", "is_y_logarithmic",
/// "series": [{"name", "x", "y", "low", "high"}]}; numbers with five digits.
[[nodiscard]] Value ToValue(const Chart& chart);

/// Long form, a line for each point: series,x,y,low,high.
[[nodiscard]] std::string ChartCsv(const Chart& chart);

/// A column of a table of rows for the report: {"key", "name", "unit", "interval_key"}.
struct Column {
  std::string key;
  std::string name;
  std::string unit;          ///< May be empty.
  std::string interval_key;  ///< Of [low, high] below the number; may be empty.
};
[[nodiscard]] Value ToValue(const std::vector<Column>& columns);

/// "a, b" in quotes where a comma-separated list needs them.
[[nodiscard]] std::string CsvText(const std::string& text);

}  // namespace calibrato
