#include "calibrato/evaluation/pareto.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "calibrato/base/parallel.h"
#include "calibrato/evaluation/method_row.h"
#include "calibrato/motion/expert_motion.h"

namespace calibrato {
namespace {

constexpr double kScales[] = {0.75, 0.5, 0.25};
constexpr int kMostCuts = 6;

using SceneOf = std::function<const Rig&(size_t motion)>;

Contestant Changed(const Contestant& whole, Carrier carrier, const SceneOf& scene,
                   const std::function<void(Motion*)>& change) {
  Contestant changed = whole;
  changed.motions = ParallelMap<ExecutableMotion>(whole.motions.size(), [&](size_t i) {
    Motion motion = whole.motions[i].timed->motion;
    change(&motion);
    return MakeExecutable(std::move(motion), carrier, scene(i));
  });
  return changed;
}

bool IsLooped(const Contestant& contestant) {
  return std::all_of(contestant.motions.begin(), contestant.motions.end(),
                     [](const ExecutableMotion& motion) { return motion.timed.has_value(); });
}

// After which loops to cut, without the last one.
std::set<int> Cuts(int num_loops) {
  std::set<int> cuts;
  for (int k = 1; k <= kMostCuts; ++k) cuts.insert(std::max(1, num_loops * k / (kMostCuts + 1)));
  if (num_loops <= kMostCuts) {
    cuts.clear();
    for (int k = 1; k < num_loops; ++k) cuts.insert(k);
  }
  return cuts;
}

// One method with all its budgets; points get their trials later.
void AddMethod(const Contestant& whole, Carrier carrier, const SceneOf& scene, Pareto* pareto,
               std::vector<Contestant>* contestants) {
  const auto add = [&](double scale, int num_loops, Contestant contestant) {
    pareto->points.push_back({whole.policy, scale, num_loops, {}});
    contestants->push_back(std::move(contestant));
  };
  add(1.0, 0, whole);
  if (!IsLooped(whole)) return;
  for (const double scale : kScales) {
    add(scale, 0, Changed(whole, carrier, scene, [&](Motion* motion) {
          for (Loop& loop : motion->loops) loop.coefficients *= scale;
        }));
  }
  size_t num_loops = 1000;
  for (const ExecutableMotion& motion : whole.motions) {
    num_loops = std::min(num_loops, motion.timed->motion.loops.size());
  }
  for (const int cut : Cuts(static_cast<int>(num_loops))) {
    add(1.0, cut, Changed(whole, carrier, scene, [&](Motion* motion) {
          motion->loops.resize(static_cast<size_t>(cut));
        }));
  }
}

std::string TitleOf(const Pareto& pareto, const std::string& budget) {
  std::string task = TaskName(pareto.setting.task);
  task[0] = static_cast<char>(task[0] - 'a' + 'A');
  return task + " error against " + budget;
}

}  // namespace

Pareto EvaluatePareto(const ContestSetting& setting, const std::vector<MotionUnderTrial>& motions) {
  const std::vector<Rig> rigs = RigsUnderTrial(setting);
  const Rig scene = PlanningScene(setting);
  const SceneOf in_scene = [&](size_t) -> const Rig& { return scene; };
  const SceneOf on_rig = [&](size_t i) -> const Rig& { return rigs[i]; };
  const Carrier carrier = setting.carrier;
  Pareto pareto{setting, {}};
  std::vector<Contestant> contestants;
  AddMethod(RandomContestant(setting.task, carrier, rigs, Rng(setting.seed)), carrier, on_rig,
            &pareto, &contestants);
  AddMethod(FixedContestant("handcrafted", HandcraftedMotion(setting.task), carrier, scene),
            carrier, in_scene, &pareto, &contestants);
  AddMethod(FixedContestant("expert", ExpertMotion(), carrier, scene), carrier, in_scene, &pareto,
            &contestants);
  for (const Contestant& brought : BroughtContestants(motions, setting.task, carrier, scene)) {
    AddMethod(brought, carrier, in_scene, &pareto, &contestants);
  }
  ContestTrials trials = RunContest(setting, rigs, contestants);
  for (size_t k = 0; k < trials.size(); ++k) pareto.points[k].trials = std::move(trials[k]);
  return pareto;
}

Value ToValue(const std::vector<Pareto>& tasks) {
  Value rows = Value::Array();
  for (const Pareto& pareto : tasks) {
    const Rng rng = Rng(pareto.setting.seed).Stream("pareto " + TaskName(pareto.setting.task));
    for (size_t k = 0; k < pareto.points.size(); ++k) {
      const ParetoPoint& point = pareto.points[k];
      Value row = MethodRow(pareto.setting, point.method, point.trials, rng.Stream("row", k));
      row.Set("scale", point.scale)
          .Set("num_loops", point.num_loops == 0 ? Value() : Value(point.num_loops));
      rows.Append(std::move(row));
    }
  }
  Value value = Value::Object();
  value.Set("kind", "pareto").Set("rows", std::move(rows));
  return value;
}

std::vector<Chart> ChartsOf(const std::vector<Pareto>& tasks) {
  struct Budget {
    const char* name;
    const char* title;
    const char* key;
  };
  constexpr Budget kBudgets[] = {{"path", "path [m], logarithmic", "path_length_m"},
                                 {"time", "time [s], logarithmic", "motion_s"},
                                 {"frames", "frames, logarithmic", "num_frames"}};
  std::vector<Chart> charts;
  for (const Pareto& pareto : tasks) {
    const Value document = ToValue(std::vector<Pareto>{pareto});
    for (const Budget& budget : kBudgets) {
      Chart chart;
      chart.title = TitleOf(pareto, budget.name);
      chart.note = "Mean error with its 95 % interval. A method is scaled, or cut after its loops.";
      chart.x_title = budget.title;
      chart.y_title = "mean error [%], logarithmic";
      chart.is_x_logarithmic = true;
      chart.is_y_logarithmic = true;
      // The whole motion belongs to both lines of its method.
      for (const bool is_cut : {false, true}) {
        std::map<std::string, std::vector<std::pair<double, const Value*>>> methods;
        std::vector<std::string> order;
        for (const Value& row : document.At("rows").elements()) {
          const bool is_whole =
              row.Find("num_loops") == nullptr && row.At("scale").AsDouble() == 1.0;
          if (!is_whole && (row.Find("num_loops") != nullptr) != is_cut) continue;
          if (row.Find("mean_error_percent") == nullptr) continue;
          const std::string method = row.At("policy").AsString();
          if (!methods.contains(method)) order.push_back(method);
          methods[method].emplace_back(row.At(budget.key).AsDouble(), &row);
        }
        for (const std::string& method : order) {
          auto& points = methods[method];
          if (is_cut && points.size() == 1) continue;
          std::stable_sort(points.begin(), points.end(),
                           [](const auto& a, const auto& b) { return a.first < b.first; });
          ChartSeries series{method + (is_cut ? ", cut" : ", scaled"), {}, {}, {}, {}};
          for (const auto& [x, row] : points) {
            const std::vector<double> ci95 = row->At("ci95").AsDoubles(2);
            series.x.push_back(x);
            series.y.push_back(row->At("mean_error_percent").AsDouble());
            series.low.push_back(ci95[0]);
            series.high.push_back(ci95[1]);
          }
          chart.series.push_back(std::move(series));
        }
      }
      charts.push_back(std::move(chart));
    }
  }
  return charts;
}

}  // namespace calibrato
