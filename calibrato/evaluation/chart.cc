#include "calibrato/evaluation/chart.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace calibrato {
namespace {

// No picture shows more digits, and pages hold thousands of numbers.
Value ShortNumbers(const std::vector<double>& numbers) {
  Value array = Value::Array();
  for (const double x : numbers) {
    char text[40];
    std::snprintf(text, sizeof(text), "%.5g", x);
    array.Append(std::isfinite(x) ? Value(std::strtod(text, nullptr)) : Value());
  }
  return array;
}

std::string KindName(Chart::Kind kind) {
  if (kind == Chart::Kind::kLines) return "lines";
  return kind == Chart::Kind::kDots ? "dots" : "boxes";
}

}  // namespace

Value ToValue(const Chart& chart) {
  Value all = Value::Array();
  for (const ChartSeries& series : chart.series) {
    Value value = Value::Object();
    value.Set("name", series.name)
        .Set("x", ShortNumbers(series.x))
        .Set("y", ShortNumbers(series.y))
        .Set("low", ShortNumbers(series.low))
        .Set("high", ShortNumbers(series.high));
    all.Append(std::move(value));
  }
  Value value = Value::Object();
  value.Set("kind", KindName(chart.kind))
      .Set("title", chart.title)
      .Set("note", chart.note)
      .Set("x_title", chart.x_title)
      .Set("y_title", chart.y_title)
      .Set("is_x_logarithmic", chart.is_x_logarithmic)
      .Set("is_y_logarithmic", chart.is_y_logarithmic)
      .Set("series", std::move(all));
  return value;
}

std::string CsvText(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string ChartCsv(const Chart& chart) {
  const auto cell = [](const std::vector<double>& numbers, size_t i) -> std::string {
    return i < numbers.size() && std::isfinite(numbers[i]) ? FormatNumber(numbers[i]) : "";
  };
  std::string text = "series,x,y,low,high\n";
  for (const ChartSeries& series : chart.series) {
    for (size_t i = 0; i < series.y.size(); ++i) {
      text += CsvText(series.name) + "," + cell(series.x, i) + "," + cell(series.y, i) + "," +
              cell(series.low, i) + "," + cell(series.high, i) + "\n";
    }
  }
  return text;
}

Value ToValue(const std::vector<Column>& columns) {
  Value all = Value::Array();
  for (const Column& column : columns) {
    Value value = Value::Object();
    value.Set("key", column.key)
        .Set("name", column.name)
        .Set("unit", column.unit)
        .Set("interval_key", column.interval_key);
    all.Append(std::move(value));
  }
  return all;
}

}  // namespace calibrato
