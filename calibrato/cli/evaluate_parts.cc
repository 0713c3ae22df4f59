#include "calibrato/cli/evaluate_parts.h"

#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/cli/parse.h"
#include "calibrato/evaluation/chart.h"
#include "calibrato/evaluation/figure4.h"
#include "calibrato/evaluation/figure5.h"
#include "calibrato/evaluation/figure7.h"
#include "calibrato/evaluation/four_rows.h"
#include "calibrato/evaluation/outside_estimator.h"
#include "calibrato/evaluation/pareto.h"
#include "calibrato/evaluation/rivals.h"
#include "calibrato/evaluation/table1.h"
#include "calibrato/evaluation/table1_document.h"

namespace calibrato {
namespace {

// Which the paper's figure shows.
Task OnlyTask(const EvaluateOptions& options, Task only, const std::string& what) {
  if (!options.task.empty() && TaskFromName(options.task) != only) {
    throw InputError({"no " + what + " of task " + options.task, "",
                      "the paper has it for the " + TaskName(only) + " task", "leave out --task"});
  }
  return only;
}

const std::vector<Column> kErrorColumns = {{"policy", "motion", "", ""},
                                           {"n", "rigs", "", ""},
                                           {"mean_error_percent", "mean error", "%", "ci95"},
                                           {"median_error_percent", "median error", "%", ""},
                                           {"prediction_error_px", "prediction error", "px", ""},
                                           {"path_length_m", "path", "m", ""},
                                           {"motion_s", "time", "s", ""},
                                           {"num_frames", "frames", "", ""},
                                           {"error_over_bound", "error over bound", "", ""},
                                           {"failures", "failed", "", ""}};

std::vector<Column> WithFirst(const Column& first, std::vector<Column> columns) {
  columns.insert(columns.begin() + 1, first);
  return columns;
}

// One line a row, of those columns that are numbers.
std::string RowsText(const Value& result, const std::vector<Column>& columns) {
  std::string text;
  char cell[64];
  for (const Column& column : columns) {
    const std::string unit = column.unit.empty() ? "" : " [" + column.unit + "]";
    std::snprintf(cell, sizeof(cell), column.key == "policy" ? "%-24s" : "%20s",
                  (column.name + unit).c_str());
    text += cell;
  }
  text += "\n";
  for (const Value& row : result.At("rows").elements()) {
    for (const Column& column : columns) {
      const Value* value = row.Find(column.key);
      if (column.key == "policy") {
        std::snprintf(cell, sizeof(cell), "%-24s", row.At("policy").AsString().c_str());
      } else if (value == nullptr || column.key == "estimator") {
        std::snprintf(cell, sizeof(cell), "%20s",
                      value == nullptr ? "-" : value->AsString().c_str());
      } else {
        std::snprintf(cell, sizeof(cell), "%20.4g", value->AsDouble());
      }
      text += cell;
    }
    text += "\n";
  }
  return text;
}

// A table and charts beside it.
EvaluationPart PartWithCharts(const std::string& title, Value result,
                              const std::vector<Column>& columns,
                              const std::vector<Chart>& charts) {
  EvaluationPart part;
  part.title = title;
  part.result = std::move(result);
  part.text = RowsText(part.result, columns);
  const std::string kind = part.result.At("kind").AsString();
  Value drawn = Value::Array();
  for (size_t k = 0; k < charts.size(); ++k) {
    drawn.Append(ToValue(charts[k]));
    part.files[kind + (charts.size() == 1 ? "" : "-" + std::to_string(k + 1)) + ".csv"] =
        ChartCsv(charts[k]);
  }
  part.plots = Value::Object();
  part.plots.Set("columns", ToValue(columns)).Set("charts", std::move(drawn));
  return part;
}

EvaluationPart MakeTable(const std::string& kind, const std::string& title,
                         const EvaluateOptions& options, const GlobalOptions& global,
                         const NumRigs& num_rigs) {
  const std::vector<MotionUnderTrial> motions = ReadMotionsUnderTrial(options);
  EvaluationPart part;
  part.title = title;
  std::vector<Table1> tables;
  for (const Task task : TasksOf(options)) {
    tables.push_back(EvaluateTable1({SettingOf(options, global, task, num_rigs), motions}));
    part.text += Table1Text(tables.back());
  }
  part.result = ToValue(tables, kind);
  part.plots = Table1Plots(tables);
  part.files["trials.csv"] = TrialsCsv(tables);
  return part;
}

}  // namespace

EvaluationPart MakeTable1(const EvaluateOptions& options, const GlobalOptions& global,
                          const NumRigs& num_rigs) {
  return MakeTable("table1", "Table 1", options, global, num_rigs);
}

EvaluationPart MakeTable6(const EvaluateOptions& options, const GlobalOptions& global,
                          const NumRigs& num_rigs) {
  return MakeTable("table6", "Table 6", options, global, num_rigs);
}

EvaluationPart MakeFigure4(const EvaluateOptions& options, const GlobalOptions& global,
                           const NumRigs& num_rigs) {
  const ContestSetting setting =
      SettingOf(options, global, OnlyTask(options, Task::kIntrinsic, "figure 4"), num_rigs);
  if (setting.fixed_rig) {
    throw InputError(
        {"figure 4 varies the rigs' field of view", "", "--rig-file names one rig", "use --rigs"});
  }
  const Figure4 figure = EvaluateFigure4(setting, ReadMotionsUnderTrial(options));
  const std::vector<Column> columns =
      WithFirst({"hfov_rad", "field of view", "rad", ""}, kErrorColumns);
  return PartWithCharts("Figure 4", ToValue(figure), columns, ChartsOf(figure));
}

EvaluationPart MakeFigure5(const EvaluateOptions& options, const GlobalOptions& global,
                           const NumRigs& num_rigs) {
  const ContestSetting setting =
      SettingOf(options, global, OnlyTask(options, Task::kExtrinsic, "figure 5"), num_rigs);
  const Table1 table = EvaluateTable1({setting, ReadMotionsUnderTrial(options)});
  return PartWithCharts("Figure 5", Figure5Value(table), kErrorColumns, Figure5Charts(table));
}

EvaluationPart MakeFigure7(const EvaluateOptions& options, const GlobalOptions& global,
                           const NumRigs& num_rigs) {
  const ContestSetting setting =
      SettingOf(options, global, OnlyTask(options, Task::kExtrinsic, "figure 7"), num_rigs);
  const Figure7 figure = EvaluateFigure7(setting, ReadMotionsUnderTrial(options));
  const std::vector<Column> columns = {
      {"policy", "motion", "", ""},
      {"member", "of its name", "", ""},
      {"reprojection_rms_px", "reprojection", "px", ""},
      {"gyro_rms_normalised", "gyroscope residuals over noise", "", ""},
      {"accel_rms_normalised", "accelerometer residuals over noise", "", ""},
      {"gyro_bias_error_rad_s", "gyroscope bias error", "rad/s", ""},
      {"accel_bias_error_m_s2", "accelerometer bias error", "m/s²", ""}};
  return PartWithCharts("Figure 7", ToValue(figure), columns, ChartsOf(figure));
}

EvaluationPart MakePareto(const EvaluateOptions& options, const GlobalOptions& global,
                          const NumRigs& num_rigs) {
  const std::vector<MotionUnderTrial> motions = ReadMotionsUnderTrial(options);
  std::vector<Pareto> tasks;
  for (const Task task : TasksOf(options)) {
    tasks.push_back(EvaluatePareto(SettingOf(options, global, task, num_rigs), motions));
  }
  std::vector<Column> columns = WithFirst({"num_loops", "loops", "", ""}, kErrorColumns);
  columns = WithFirst({"scale", "scale", "", ""}, std::move(columns));
  return PartWithCharts("Error against budget", ToValue(tasks), columns, ChartsOf(tasks));
}

EvaluationPart MakeRows(const EvaluateOptions& options, const GlobalOptions& global,
                        const NumRigs& num_rigs) {
  const std::vector<MotionUnderTrial> motions = ReadMotionsUnderTrial(options);
  std::vector<FourRows> tasks;
  std::map<std::string, double> seconds;
  for (const Task task : TasksOf(options)) {
    tasks.push_back(EvaluateFourRows(SettingOf(options, global, task, num_rigs), motions));
    for (const auto& [row, cpu_s] : tasks.back().seconds) {
      seconds[TaskName(task) + ", " + row + ", cpu_s"] = cpu_s;
    }
  }
  std::vector<Column> columns = kErrorColumns;
  const std::vector<Column> ratios = {
      {"ratio_to_handcrafted", "over handcrafted", "", "ratio_to_handcrafted_ci95"},
      {"ratio_to_robust", "over robust", "", "ratio_to_robust_ci95"},
      {"ratio_to_oracle", "over the oracle's", "", "ratio_to_oracle_ci95"}};
  columns.insert(columns.begin() + 3, ratios.begin(), ratios.end());
  const std::vector<Column> budgets = {
      {"episodes", "episodes before", "", ""},
      {"design_information_evaluations", "evaluations before", "", ""},
      {"information_evaluations_of_rig", "evaluations a rig", "", ""}};
  columns.insert(columns.end() - 1, budgets.begin(), budgets.end());
  EvaluationPart part =
      PartWithCharts("Why learn at all", ToValue(tasks), columns, ChartsOf(tasks));
  part.seconds = std::move(seconds);
  return part;
}

EvaluationPart PartOfAblation(const std::vector<Ablation>& tasks) {
  std::vector<Column> columns = kErrorColumns;
  const std::vector<Column> ratios = {
      {"ratio_to_baseline", "over the baseline's", "", "ratio_to_baseline_ci95"},
      {"ratio_to_handcrafted", "over handcrafted", "", "ratio_to_handcrafted_ci95"},
      {"probability_as_baseline", "by chance", "", ""}};
  columns.insert(columns.begin() + 3, ratios.begin(), ratios.end());
  columns.insert(columns.end() - 1, {"episodes", "episodes", "", ""});
  return PartWithCharts("What each difference costs", ToValue(tasks), columns, ChartsOf(tasks));
}

EvaluationPart PartOfPlanners(const std::vector<PlannerComparison>& tasks) {
  std::vector<Column> columns = kErrorColumns;
  const std::vector<Column> of_planners = {
      {"information_evaluations", "evaluations", "", ""},
      {"expected_loss", "expected loss less handcrafted's", "", "expected_loss_range"},
      {"ratio_to_handcrafted", "over handcrafted", "", "ratio_to_handcrafted_ci95"}};
  columns.insert(columns.begin() + 1, of_planners.begin(), of_planners.end());
  return PartWithCharts("Planners compared", ToValue(tasks), columns, ChartsOf(tasks));
}

ExitCode CommitPart(const EvaluationPart& part, const std::string& folder,
                    const GlobalOptions& global, Stopwatch* stopwatch, OutputFolder* out) {
  for (const auto& [name, seconds] : part.seconds) stopwatch->Add(name, seconds);
  for (const auto& [name, content] : part.files) out->Add(name, content);
  out->Add(part.result.At("kind").AsString() + ".json", ToJson(part.result));
  CommitResult(part.title, part.result, Value::Object().Set("plots", part.plots), stopwatch, out);
  if (global.json) {
    std::fputs(ToJson(part.result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%sreport: %s/report.html\n", part.text.c_str(), folder.c_str());
  }
  return kDone;
}

EvaluationPart MakeRivals(const EvaluateOptions& options, const GlobalOptions& global,
                          const NumRigs& num_rigs) {
  const std::vector<MotionUnderTrial> motions = ReadMotionsUnderTrial(options);
  std::vector<OutsideEstimator> outside;
  for (const std::string& path : options.outside) {
    std::vector<std::string> warnings;
    outside.push_back(OutsideEstimatorFromValue(ReadYaml(path), &warnings));
    PrintWarnings(warnings);
  }
  std::vector<Rivals> tasks;
  std::map<std::string, double> seconds;
  for (const Task task : TasksOf(options)) {
    tasks.push_back(
        EvaluateRivals(SettingOf(options, global, task, num_rigs), motions,
                       task == Task::kExtrinsic ? outside : std::vector<OutsideEstimator>()));
    for (const auto& [estimator, spent] : tasks.back().seconds) {
      seconds[TaskName(task) + "_" + estimator + "_s"] = spent;
    }
  }
  EvaluationPart part =
      PartWithCharts("Estimators compared", ToValue(tasks),
                     WithFirst({"estimator", "estimator", "", ""}, kErrorColumns), ChartsOf(tasks));
  part.seconds = std::move(seconds);
  return part;
}

}  // namespace calibrato
