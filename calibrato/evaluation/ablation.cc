#include "calibrato/evaluation/ablation.h"

#include <cassert>
#include <limits>
#include <utility>

#include "calibrato/evaluation/method_row.h"

namespace calibrato {
namespace {

constexpr const char* kHandcrafted = "handcrafted";

using MethodTrials = std::vector<std::vector<Trial>>;

Rng DrawsOf(const Ablation& task, size_t row) {
  return Rng(task.setting.seed)
      .Stream("ablation " + TaskName(task.setting.task))
      .Stream("row", row);
}

void SetRatio(const std::string& rival, const MethodTrials& own, const MethodTrials& theirs,
              const Rng& rng, Value* row) {
  if (own.empty() || theirs.empty()) return;
  const Figures numerator = FiguresOf(own, &Trial::relative_error);
  const Figures denominator = FiguresOf(theirs, &Trial::relative_error);
  const std::string key = "ratio_to_" + rival;
  row->Set(key, FiniteValue(PairedRatio(numerator, denominator)))
      .Set(key + "_ci95", PairValue(BootstrapRatio(numerator, denominator, rng.Stream(key))));
}

// Of each row to be as the baseline; NaN for itself and for those without trials.
std::vector<double> Probabilities(const Ablation& task) {
  std::vector<double> probabilities;
  const MethodTrials& baseline = task.rows.front().trials;
  for (size_t k = 0; k < task.rows.size(); ++k) {
    const MethodTrials& own = task.rows[k].trials;
    probabilities.push_back(
        k == 0 || own.empty() || baseline.empty()
            ? std::numeric_limits<double>::quiet_NaN()
            : PairedPermutationProbability(FiguresOf(own, &Trial::relative_error),
                                           FiguresOf(baseline, &Trial::relative_error),
                                           DrawsOf(task, k).Stream("permutation")));
  }
  return HolmAdjusted(probabilities);
}

Value RowValue(const Ablation& task, size_t k, double probability) {
  const auto& [variant, trials] = task.rows[k];
  const Rng draws = DrawsOf(task, k);
  Value row = trials.empty() ? SettingValue(task.setting).Set("policy", variant.name)
                             : MethodRow(task.setting, variant.name, trials, draws);
  row.Set("episodes", variant.num_episodes)
      .Set("calibrations", variant.num_calibrations)
      .Set("termination", variant.termination);
  if (k > 0) SetRatio("baseline", trials, task.rows.front().trials, draws, &row);
  SetRatio(kHandcrafted, trials, task.handcrafted, draws, &row);
  row.Set("probability_as_baseline", FiniteValue(probability));
  return row;
}

}  // namespace

Ablation EvaluateAblation(const ContestSetting& setting,
                          const std::vector<AblationVariant>& variants) {
  assert(!variants.empty());
  const std::vector<Rig> rigs = RigsUnderTrial(setting);
  const Rig scene = PlanningScene(setting);
  std::vector<Contestant> contestants = {
      FixedContestant(kHandcrafted, HandcraftedMotion(setting.task), setting.carrier, scene)};
  for (const AblationVariant& variant : variants) {
    if (!variant.motion) continue;
    contestants.push_back(FixedContestant(variant.name, *variant.motion, setting.carrier, scene));
  }
  ContestTrials trials = RunContest(setting, rigs, contestants);
  Ablation ablation{setting, {}, std::move(trials.front())};
  size_t next = 1;
  for (const AblationVariant& variant : variants) {
    ablation.rows.push_back({variant, {}});
    if (variant.motion) ablation.rows.back().trials = std::move(trials[next++]);
  }
  return ablation;
}

Value ToValue(const std::vector<Ablation>& tasks) {
  Value rows = Value::Array();
  for (const Ablation& task : tasks) {
    const std::vector<double> probabilities = Probabilities(task);
    for (size_t k = 0; k < task.rows.size(); ++k) {
      rows.Append(RowValue(task, k, probabilities[k]));
    }
    Value handcrafted =
        MethodRow(task.setting, kHandcrafted, task.handcrafted, DrawsOf(task, task.rows.size()));
    SetRatio("baseline", task.handcrafted, task.rows.front().trials,
             DrawsOf(task, task.rows.size()), &handcrafted);
    rows.Append(std::move(handcrafted));
  }
  return Value::Object().Set("kind", "ablation").Set("rows", std::move(rows));
}

std::vector<Chart> ChartsOf(const std::vector<Ablation>& tasks) {
  std::vector<Chart> charts;
  for (const Ablation& task : tasks) {
    Chart chart;
    chart.kind = Chart::Kind::kDots;
    chart.title = "Error over the baseline's, " + TaskName(task.setting.task);
    chart.note = "Ratio of the mean errors with its 95 % interval, against the path.";
    chart.x_title = "path [m]";
    chart.y_title = "ratio, logarithmic";
    chart.is_y_logarithmic = true;
    const Value document = ToValue(std::vector<Ablation>{task});
    for (const Value& row : document.At("rows").elements()) {
      const Value* const ratio = row.Find("ratio_to_baseline");
      if (ratio == nullptr) continue;
      const std::vector<double> interval = row.At("ratio_to_baseline_ci95").AsDoubles(2);
      chart.series.push_back({row.At("policy").AsString(),
                              {row.At("path_length_m").AsDouble()},
                              {ratio->AsDouble()},
                              {interval[0]},
                              {interval[1]}});
    }
    charts.push_back(std::move(chart));
  }
  return charts;
}

}  // namespace calibrato
