#include "calibrato/evaluation/method_row.h"

#include <cmath>
#include <map>
#include <utility>

namespace calibrato {
namespace {

constexpr double kPercent = 100.0;

using Trials = std::vector<std::vector<Trial>>;

double MeanOf(const Trials& trials, double Trial::*figure) {
  return Mean(Existing(FiguresOf(trials, figure)));
}

double MeanNumFrames(const Trials& trials) {
  std::vector<double> counts;
  for (const std::vector<Trial>& member : trials) {
    for (const Trial& trial : member) counts.push_back(trial.num_frames);
  }
  return Mean(counts);
}

void SetFigures(const Trials& trials, const Rng& rng, Value* row) {
  Value medians = Value::Object();
  Value intervals = Value::Object();
  for (const NamedFigure& named : kTrialFigures) {
    const Figures figures = FiguresOf(trials, named.figure);
    const std::vector<double> existing = Existing(figures);
    row->Set(named.key, FiniteValue(Mean(existing)));
    if (existing.empty()) continue;
    medians.Set(named.key, Median(existing));
    intervals.Set(named.key, PairValue(BootstrapMean(figures, rng.Stream(named.key))));
  }
  row->Set("medians", std::move(medians)).Set("intervals", std::move(intervals));
}

void SetFailures(const Trials& trials, double num_trials, Value* row) {
  std::map<std::string, int> counts;
  for (const std::vector<Trial>& member : trials) {
    for (const Trial& trial : member) {
      if (!trial.failure.empty()) ++counts[trial.failure];
    }
  }
  Value reasons = Value::Object();
  for (const auto& [reason, count] : counts) reasons.Set(reason, count);
  row->Set("failures", NumFailures(trials))
      .Set("failure_rate", NumFailures(trials) / num_trials)
      .Set("failure_reasons", std::move(reasons));
}

}  // namespace

Value PairValue(const Interval& interval, double factor) {
  Value value = Value::Array();
  value.Append(factor * interval.low).Append(factor * interval.high);
  return value;
}

Value FiniteValue(double x) { return std::isfinite(x) ? Value(x) : Value(); }

Value SettingValue(const ContestSetting& setting) {
  Value value = Value::Object();
  value.Set("task", TaskName(setting.task))
      .Set("carrier", CarrierName(setting.carrier))
      .Set("fidelity", FidelityName(setting.fidelity))
      .Set("rigs", RigsName(setting))
      .Set("seed", static_cast<int64_t>(setting.seed));
  return value;
}

Value MethodRow(const ContestSetting& setting, const std::string& policy, const Trials& trials,
                const Rng& rng) {
  const Figures errors = FiguresOf(trials, &Trial::relative_error);
  const int dimension = NeesDimension(setting.task);
  const ConsistencyTest consistency =
      TestConsistency(Existing(FiguresOf(trials, &Trial::nees)), dimension);
  const size_t num_trials = trials.empty() ? 0 : trials.size() * trials.front().size();
  Value row = SettingValue(setting);
  row.Set("policy", policy)
      .Set("n", num_trials)
      .Set("num_training_seeds", trials.size())
      .Set("mean_error_percent", FiniteValue(kPercent * Mean(Existing(errors))))
      .Set("ci95", PairValue(BootstrapMean(errors, rng.Stream("mean error")), kPercent))
      .Set("median_error_percent", FiniteValue(kPercent * Median(Existing(errors))))
      .Set("path_length_m", FiniteValue(MeanOf(trials, &Trial::path_length_m)))
      .Set("path_length_original_m", FiniteValue(MeanOf(trials, &Trial::path_length_original_m)))
      .Set("motion_s", FiniteValue(MeanOf(trials, &Trial::motion_s)))
      .Set("num_frames", MeanNumFrames(trials));
  SetFigures(trials, rng, &row);
  row.Set("error_over_bound", FiniteValue(std::sqrt(consistency.mean_nees / dimension)))
      .Set("mean_nees", FiniteValue(consistency.mean_nees))
      .Set("mean_nees_expected", PairValue(consistency.expected))
      .Set("nees_probability", FiniteValue(consistency.probability));
  SetFailures(trials, static_cast<double>(num_trials), &row);
  return row;
}

}  // namespace calibrato
