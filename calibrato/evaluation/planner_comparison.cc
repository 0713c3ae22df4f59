#include "calibrato/evaluation/planner_comparison.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrato/evaluation/method_row.h"

namespace calibrato {
namespace {

constexpr const char* kHandcrafted = "handcrafted";

struct Losses {
  double mean = 0.0;
  double least = 0.0;
  double largest = 0.0;
};

// Over the repetitions, less the handcrafted motion's.
Losses LossesOf(const PlannerComparison& task, const PlannerRun& run) {
  std::vector<double> losses;
  for (const MotionDesign& design : run.designs) {
    losses.push_back(design.loss - task.handcrafted_loss);
  }
  const auto [least, largest] = std::minmax_element(losses.begin(), losses.end());
  return {Mean(losses), *least, *largest};
}

Value RowValue(const PlannerComparison& task, size_t k) {
  const auto& [run, trials] = task.rows[k];
  const Rng draws =
      Rng(task.setting.seed).Stream("planners " + TaskName(task.setting.task)).Stream("row", k);
  Value row =
      MethodRow(task.setting, run.method + ", " + std::to_string(run.budget), trials, draws);
  const Losses losses = LossesOf(task, run);
  double evaluations = 0.0;
  for (const MotionDesign& design : run.designs) {
    evaluations += static_cast<double>(design.num_information_evaluations) /
                   static_cast<double>(run.designs.size());
  }
  const Figures own = FiguresOf(trials, &Trial::relative_error);
  const Figures theirs = FiguresOf(task.handcrafted, &Trial::relative_error);
  row.Set("method", run.method)
      .Set("budget", run.budget)
      .Set("information_evaluations", evaluations)
      .Set("expected_loss", losses.mean)
      .Set("expected_loss_range", PairValue({losses.least, losses.largest}))
      .Set("ratio_to_handcrafted", FiniteValue(PairedRatio(own, theirs)))
      .Set("ratio_to_handcrafted_ci95",
           PairValue(BootstrapRatio(own, theirs, draws.Stream("ratio"))));
  return row;
}

}  // namespace

PlannerComparison ComparePlanners(const ContestSetting& setting, const MotionDesignProblem& problem,
                                  const std::vector<PlannerRun>& runs) {
  const std::vector<Rig> rigs = RigsUnderTrial(setting);
  const Rig scene = PlanningScene(setting);
  std::vector<Contestant> contestants = {
      FixedContestant(kHandcrafted, HandcraftedMotion(setting.task), setting.carrier, scene)};
  for (const PlannerRun& run : runs) {
    Contestant& contestant = contestants.emplace_back(Contestant{run.method, {}, false});
    for (const MotionDesign& design : run.designs) {
      contestant.motions.push_back(MakeExecutable(design.motion, setting.carrier, scene));
    }
  }
  PlannerComparison comparison;
  comparison.setting = setting;
  const TimedMotion& handcrafted = *contestants.front().motions.front().timed;
  Motion executed = handcrafted.motion;
  for (size_t i = 0; i < executed.loops.size(); ++i) {
    executed.loops[i].duration_s = handcrafted.loop_duration_s[i];
  }
  comparison.handcrafted_loss = ExpectLoss(problem, executed).value;
  ContestTrials trials = RunContest(setting, rigs, contestants);
  comparison.handcrafted = std::move(trials.front());
  for (size_t k = 0; k < runs.size(); ++k) {
    comparison.rows.push_back({runs[k], std::move(trials[k + 1])});
  }
  return comparison;
}

Value ToValue(const std::vector<PlannerComparison>& tasks) {
  Value rows = Value::Array();
  for (const PlannerComparison& task : tasks) {
    for (size_t k = 0; k < task.rows.size(); ++k) rows.Append(RowValue(task, k));
    rows.Append(MethodRow(task.setting, kHandcrafted, task.handcrafted,
                          Rng(task.setting.seed).Stream("planners handcrafted")));
  }
  return Value::Object().Set("kind", "planners").Set("rows", std::move(rows));
}

std::vector<Chart> ChartsOf(const std::vector<PlannerComparison>& tasks) {
  std::vector<Chart> charts;
  for (const PlannerComparison& task : tasks) {
    Chart chart;
    chart.title = "Expected sigma over the handcrafted motion's, " + TaskName(task.setting.task);
    chart.note = "Mean over repetitions, with the least and the largest.";
    chart.x_title = "information evaluations, logarithmic";
    chart.y_title = "ratio, logarithmic";
    chart.is_x_logarithmic = true;
    chart.is_y_logarithmic = true;
    for (const PlannerComparison::Row& row : task.rows) {
      auto series = std::find_if(chart.series.begin(), chart.series.end(),
                                 [&](const auto& one) { return one.name == row.run.method; });
      if (series == chart.series.end()) {
        series = chart.series.insert(series, ChartSeries{row.run.method, {}, {}, {}, {}});
      }
      const Losses losses = LossesOf(task, row.run);
      series->x.push_back(static_cast<double>(row.run.budget));
      series->y.push_back(std::exp(losses.mean));
      series->low.push_back(std::exp(losses.least));
      series->high.push_back(std::exp(losses.largest));
    }
    charts.push_back(std::move(chart));
  }
  return charts;
}

}  // namespace calibrato
