#include "calibrato/evaluation/figure5.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "calibrato/evaluation/method_row.h"

namespace calibrato {
namespace {

// Linear between the order statistics.
double Quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<size_t>(at);
  const size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

Value Quantiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  Value quantiles = Value::Object();
  for (const auto& [key, share] :
       {std::pair{"q05", 0.05}, {"q25", 0.25}, {"q50", 0.5}, {"q75", 0.75}, {"q95", 0.95}}) {
    quantiles.Set(key, 100.0 * Quantile(values, share));
  }
  return quantiles;
}

Chart BoxChart(const Table1& table, const std::string& title, const std::string& y_title,
               double Trial::*figure, double factor) {
  Chart chart;
  chart.kind = Chart::Kind::kBoxes;
  chart.title = title;
  chart.note = "The box holds the middle half of the rigs, its line is the median.";
  chart.y_title = y_title;
  chart.is_y_logarithmic = true;
  for (const Table1Row& row : table.rows) {
    ChartSeries series{row.policy, {}, {}, {}, {}};
    for (const double value : Existing(FiguresOf(row.trials, figure))) {
      series.y.push_back(factor * value);
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace

Value Figure5Value(const Table1& extrinsic) {
  const ContestSetting& setting = extrinsic.options.setting;
  Value rows = Value::Array();
  for (size_t k = 0; k < extrinsic.rows.size(); ++k) {
    const Table1Row& made = extrinsic.rows[k];
    Value row =
        MethodRow(setting, made.policy, made.trials, Rng(setting.seed).Stream("figure 5 row", k));
    row.Set("quantiles_percent",
            Quantiles(Existing(FiguresOf(made.trials, &Trial::relative_error))));
    rows.Append(std::move(row));
  }
  Value value = Value::Object();
  value.Set("kind", "figure5").Set("rows", std::move(rows));
  return value;
}

std::vector<Chart> Figure5Charts(const Table1& extrinsic) {
  return {BoxChart(extrinsic, "Relative error of the extrinsics: the paper's Figure 5",
                   "error [%], logarithmic", &Trial::relative_error, 100.0),
          BoxChart(extrinsic, "Error of the rotation", "error [mrad], logarithmic",
                   &Trial::rotation_error_rad, 1e3),
          BoxChart(extrinsic, "Error of the translation", "error [mm], logarithmic",
                   &Trial::translation_error_m, 1e3),
          BoxChart(extrinsic, "Error of the time offset", "error [ms], logarithmic",
                   &Trial::time_offset_error_s, 1e3)};
}

}  // namespace calibrato
