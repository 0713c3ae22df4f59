#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>

#include "calibrato/report/documents_for_test.h"

namespace calibrato {
namespace {

Value Numbers(std::initializer_list<double> numbers) {
  Value array = Value::Array();
  for (const double x : numbers) array.Append(x);
  return array;
}

Value Row(const std::string& policy, double scale, double mean) {
  Value row = Value::Object();
  row.Set("task", "extrinsic")
      .Set("carrier", "free")
      .Set("fidelity", "fast")
      .Set("policy", policy)
      .Set("n", 20)
      .Set("scale", scale)
      .Set("mean_error_percent", mean)
      .Set("ci95", Numbers({0.9 * mean, 1.1 * mean}))
      .Set("failures", scale < 0.5 ? 3 : 0);
  return row;
}

Value ColumnValue(const std::string& key, const std::string& name, const std::string& unit,
                  const std::string& interval_key) {
  Value column = Value::Object();
  column.Set("key", key).Set("name", name).Set("unit", unit).Set("interval_key", interval_key);
  return column;
}

Value Series(const std::string& name, double factor) {
  Value series = Value::Object();
  series.Set("name", name)
      .Set("x", Numbers({1.0, 2.0, 4.0}))
      .Set("y", Numbers({4.0 * factor, 2.0 * factor, factor}))
      .Set("low", Numbers({3.5 * factor, 1.8 * factor, 0.9 * factor}))
      .Set("high", Numbers({4.5 * factor, 2.2 * factor, 1.1 * factor}));
  return series;
}

Value ChartValue(const std::string& kind, const std::string& title) {
  Value chart = Value::Object();
  chart.Set("kind", kind)
      .Set("title", title)
      .Set("note", "Mean error with its 95 % interval.")
      .Set("x_title", "path [m]")
      .Set("y_title", "error [%]")
      .Set("is_x_logarithmic", kind == "lines")
      .Set("is_y_logarithmic", true)
      .Set("series", Value::Array()
                         .Append(Series("handcrafted, scaled", 0.2))
                         .Append(Series("learned, cut", 0.1)));
  return chart;
}

}  // namespace

Value ParetoDocumentForTest() {
  Value rows = Value::Array();
  rows.Append(Row("handcrafted", 1.0, 0.2))
      .Append(Row("handcrafted", 0.25, 0.8))
      .Append(Row("learned", 1.0, 0.1));
  Value columns = Value::Array();
  columns.Append(ColumnValue("policy", "motion", "", ""))
      .Append(ColumnValue("scale", "scale", "", ""))
      .Append(ColumnValue("mean_error_percent", "mean error", "%", "ci95"))
      .Append(ColumnValue("failures", "failed", "", ""));
  Value plots = Value::Object();
  plots.Set("columns", std::move(columns))
      .Set("charts", Value::Array()
                         .Append(ChartValue("lines", "Extrinsic error against path"))
                         .Append(ChartValue("dots", "Reprojection errors"))
                         .Append(ChartValue("boxes", "Errors over rigs")));
  Value document = Value::Object();
  document.Set("kind", "pareto").Set("rows", std::move(rows)).Set("plots", std::move(plots));
  return document;
}

Value DryRunDocumentForTest() {
  const auto quantity = [](const char* name, const char* unit, double largest) {
    Value times = Value::Array();
    Value values = Value::Array();
    Value shares = Value::Array();
    for (int joint = 0; joint < 2; ++joint) {
      Value value = Value::Array();
      Value share = Value::Array();
      for (int k = 0; k < 40; ++k) {
        const double x = largest * std::sin(0.3 * k + joint);
        if (joint == 0) times.Append(0.1 * k);
        value.Append(2.0 * x);
        share.Append(x);
      }
      values.Append(std::move(value));
      shares.Append(std::move(share));
    }
    return Value::Object()
        .Set("name", name)
        .Set("unit", unit)
        .Set("largest_share", largest)
        .Set("joint", 2)
        .Set("t_s", std::move(times))
        .Set("values", std::move(values))
        .Set("shares", std::move(shares));
  };
  Value joints = Value::Object();
  joints.Set("names", Value::Array().Append("shoulder <pan>").Append("elbow"))
      .Set("quantities", Value::Array()
                             .Append(quantity("velocity", "rad/s", 0.4))
                             .Append(quantity("jerk", "rad/s^3", 1.3)));
  return Value::Object()
      .Set("kind", "dry-run")
      .Set("arm", "UR5e")
      .Set("motion_s", 3.9)
      .Set("scale", 0.9)
      .Set("joints", std::move(joints));
}

}  // namespace calibrato
