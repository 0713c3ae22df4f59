#include "calibrato/evaluation/table1_document.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <utility>

#include "calibrato/evaluation/chart.h"
#include "calibrato/evaluation/method_row.h"
#include "calibrato/evaluation/motion_drawing.h"
#include "calibrato/evaluation/paper_figures.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

// With no more digits than a picture shows; pages hold thousands of these.
Value FourDigits(double x) {
  if (!std::isfinite(x)) return {};
  char text[40];
  std::snprintf(text, sizeof(text), "%.4g", x);
  return std::strtod(text, nullptr);
}

Value PlotOf(const Table1& table, const Table1Row& row) {
  Value plot = SettingValue(table.options.setting);
  plot.Set("policy", row.policy);
  return plot;
}

void SetComparison(const std::string& name, const std::string& interval_key,
                   const Comparison& comparison, Value* row) {
  row->Set("ratio_to_" + name, FiniteValue(comparison.ratio))
      .Set(interval_key, PairValue(comparison.ci95))
      .Set("probability_as_" + name, FiniteValue(comparison.adjusted_probability));
}

void SetPaperFigures(Task task, const std::string& policy, Value* value) {
  const std::optional<PaperFigures> theirs = FiguresOfPaper(task, policy);
  value->Set("paper_mean_error_percent", theirs ? Value(theirs->mean_error_percent) : Value())
      .Set("paper_path_length_m", theirs ? Value(theirs->path_length_m) : Value())
      .Set("paper_a_optimality",
           theirs && theirs->a_optimality ? Value(*theirs->a_optimality) : Value());
}

Value RowValue(const Table1& table, size_t k) {
  const Table1Row& row = table.rows[k];
  const ContestSetting& setting = table.options.setting;
  Value value = MethodRow(setting, row.policy, row.trials,
                          Rng(setting.seed).Stream(TaskName(setting.task)).Stream("row", k));
  SetComparison("handcrafted", "ratio_ci95", row.to_handcrafted, &value);
  SetComparison("random", "ratio_to_random_ci95", row.to_random, &value);
  SetComparison("best_simple_rival", "ratio_to_best_simple_rival_ci95", row.to_best_simple_rival,
                &value);
  value.Set("best_simple_rival", table.best_simple_rival).Set("scale", row.scale);
  SetPaperFigures(setting.task, row.policy, &value);
  return value;
}

Value MotionPlot(const Table1& table, const Table1Row& row) {
  Value plot = MotionDrawing(row.example, PlanningScene(table.options.setting));
  const Value setting = PlotOf(table, row);
  for (const auto& [key, value] : setting.members()) plot.Set(key, value);
  return plot;
}

// Evenly thinned: more points than this tell the eye nothing.
Value CoveragePlot(const Table1& table, const Table1Row& row) {
  constexpr Eigen::Index kMostPoints = 1500;
  Eigen::Index num_corners = 0;
  for (const BoardView& view : row.example_views) num_corners += view.num_corners();
  const Eigen::Index stride = num_corners / kMostPoints + 1;
  Value pixels = Value::Array();
  const auto rounded = [](double x) { return std::round(10.0 * x) / 10.0; };
  Eigen::Index k_of_all = 0;
  for (const BoardView& view : row.example_views) {
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      if (k_of_all++ % stride != 0) continue;
      Value pixel = Value::Array();
      pixel.Append(rounded(view.pixels(0, k))).Append(rounded(view.pixels(1, k)));
      pixels.Append(std::move(pixel));
    }
  }
  Value plot = PlotOf(table, row);
  plot.Set("pixels", std::move(pixels));
  return plot;
}

}  // namespace

Value ToValue(const std::vector<Table1>& tables, const std::string& kind) {
  Value rows = Value::Array();
  for (const Table1& table : tables) {
    for (size_t k = 0; k < table.rows.size(); ++k) rows.Append(RowValue(table, k));
  }
  Value value = Value::Object();
  value.Set("kind", kind).Set("rows", std::move(rows));
  return value;
}

Value Table1Plots(const std::vector<Table1>& tables) {
  Value errors = Value::Array();
  Value motions = Value::Array();
  Value coverage = Value::Array();
  for (const Table1& table : tables) {
    for (const Table1Row& row : table.rows) {
      Value of_rigs = Value::Array();
      for (const std::vector<Trial>& member : row.trials) {
        for (const Trial& trial : member) of_rigs.Append(FourDigits(trial.relative_error));
      }
      Value entry = PlotOf(table, row);
      entry.Set("relative_error", std::move(of_rigs));
      errors.Append(std::move(entry));
      motions.Append(MotionPlot(table, row));
      coverage.Append(CoveragePlot(table, row));
    }
  }
  const Rig scene = tables.empty() ? PaperRig() : PlanningScene(tables.front().options.setting);
  const Resolution resolution = scene.cameras.front().resolution;
  Value size = Value::Array();
  size.Append(resolution.width).Append(resolution.height);
  Value plots = Value::Object();
  plots.Set("errors", std::move(errors))
      .Set("motions", std::move(motions))
      .Set("coverage", std::move(coverage))
      .Set("resolution", std::move(size))
      .Set("board_outline_b", BoardOutline(scene));
  return plots;
}

std::string TrialsCsv(const std::vector<Table1>& tables) {
  std::string text =
      "task,policy,training_seed,rig,failure,relative_error,path_length_m,"
      "path_length_original_m,motion_s,num_frames,nees";
  for (const NamedFigure& named : kTrialFigures) text += std::string(",") + named.key;
  text += "\n";
  const auto cell = [](double x) { return std::isfinite(x) ? "," + FormatNumber(x) : ","; };
  for (const Table1& table : tables) {
    for (const Table1Row& row : table.rows) {
      for (size_t m = 0; m < row.trials.size(); ++m) {
        for (size_t i = 0; i < row.trials[m].size(); ++i) {
          const Trial& trial = row.trials[m][i];
          text += TaskName(table.options.setting.task) + "," + CsvText(row.policy) + "," +
                  std::to_string(m) + "," + std::to_string(i) + "," + CsvText(trial.failure) +
                  cell(trial.relative_error) + cell(trial.path_length_m) +
                  cell(trial.path_length_original_m) + cell(trial.motion_s) + "," +
                  std::to_string(trial.num_frames) + cell(trial.nees);
          for (const NamedFigure& named : kTrialFigures) text += cell(trial.*named.figure);
          text += "\n";
        }
      }
    }
  }
  return text;
}

std::string Table1Text(const Table1& table) {
  const ContestSetting& setting = table.options.setting;
  char line[300];
  std::snprintf(line, sizeof(line),
                "%s task, carrier %s, rigs %s, fidelity %s, n = %d, seed %llu; best simple rival: "
                "%s\n%-30s %-24s %8s %-21s %8s %8s %6s %6s\n",
                TaskName(setting.task).c_str(), CarrierName(setting.carrier).c_str(),
                RigsName(setting).c_str(), FidelityName(setting.fidelity).c_str(), setting.num_rigs,
                static_cast<unsigned long long>(setting.seed), table.best_simple_rival.c_str(),
                "policy", "mean error [%] (95 %)", "median", "over handcrafted", "path [m]",
                "time [s]", "bound", "failed");
  std::string text = line;
  for (const Table1Row& row : table.rows) {
    char mean[64];
    char ratio[64];
    std::snprintf(mean, sizeof(mean), "%.4f (%.4f, %.4f)", 100.0 * row.mean_error,
                  100.0 * row.mean_error_ci95.low, 100.0 * row.mean_error_ci95.high);
    std::snprintf(ratio, sizeof(ratio), "%.3f (%.3f, %.3f)", row.to_handcrafted.ratio,
                  row.to_handcrafted.ci95.low, row.to_handcrafted.ci95.high);
    std::snprintf(line, sizeof(line), "%-30s %-24s %8.4f %-21s %8.3f %8.2f %6.3f %6d\n",
                  row.policy.c_str(), mean, 100.0 * row.median_error, ratio,
                  row.MeanOf(&Trial::path_length_m), row.MeanOf(&Trial::motion_s),
                  std::sqrt(row.consistency.mean_nees / NeesDimension(setting.task)),
                  row.num_failures);
    text += line;
  }
  return text;
}

}  // namespace calibrato
