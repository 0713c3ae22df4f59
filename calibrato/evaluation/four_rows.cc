#include "calibrato/evaluation/four_rows.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "calibrato/base/cpu_time.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/base/progress.h"
#include "calibrato/evaluation/method_row.h"
#include "calibrato/mdp/design_setting.h"
#include "calibrato/mdp/motion_design.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {
namespace {

constexpr const char* kHandcrafted = "handcrafted";
constexpr const char* kRobust = "robust";
constexpr const char* kOracle = "oracle";

MotionDesignProblem ProblemOf(const ContestSetting& setting, const Rig& scene,
                              const FourRowsOptions& options) {
  MotionDesignProblem problem;
  problem.task = setting.task;
  problem.num_loops = NumLoops(setting.task);
  problem.base_pose = BasePoseBeforeBoard(scene);
  Motion handcrafted = HandcraftedMotion(setting.task);
  handcrafted.carrier = setting.carrier;
  handcrafted.base_pose = problem.base_pose;
  const MotionBudget budget = BudgetOf(handcrafted, scene);
  problem.max_path_m = budget.path_m;
  problem.max_duration_s = budget.duration_s;
  problem.rigs =
      // Of a rig file there is that one alone.
      BelievedRigs(setting.rigs, setting.fixed_rig ? 0 : options.num_believed,
                   Rng(setting.seed).Stream("believed"), scene);
  return problem;
}

// A motion for every rig, made side by side.
struct MadeForRigs {
  Contestant contestant;
  double mean_evaluations = 0.0;
  double cpu_s = 0.0;
};

MadeForRigs MakeForRigs(const std::string& policy, const std::vector<Rig>& rigs,
                        const ExecutableMotion& otherwise,
                        const std::function<MotionForRig(size_t)>& make) {
  struct Made {
    MotionForRig of_rig;
    double cpu_s = 0.0;
  };
  Progress progress(policy, static_cast<int64_t>(rigs.size()));
  const auto made = ParallelMap<Made>(rigs.size(), [&](size_t i) {
    const double start = ThreadCpuSeconds();
    Made each;
    try {
      each.of_rig = make(i);
    } catch (const InputError&) {
      // Before this board no carrier can stand: the trial will say so.
      each.of_rig.motion = otherwise;
    }
    each.cpu_s = ThreadCpuSeconds() - start;
    progress.Advance();
    return each;
  });
  MadeForRigs all{{policy, {}, true}, 0.0, 0.0};
  for (const Made& each : made) {
    all.contestant.motions.push_back(each.of_rig.motion);
    all.mean_evaluations += static_cast<double>(each.of_rig.num_information_evaluations) /
                            static_cast<double>(made.size());
    all.cpu_s += each.cpu_s;
  }
  return all;
}

// What the motion says it took; 0 if nothing.
int64_t CountIn(const Motion& motion, const std::string& key) {
  const Value& provenance = motion.provenance;
  const Value* count = provenance.IsObject() ? provenance.Find(key) : nullptr;
  return count == nullptr ? 0 : count->AsInt();
}

class Evaluation {
 public:
  Evaluation(const ContestSetting& setting, const FourRowsOptions& options)
      : setting_(setting),
        options_(options),
        rigs_(RigsUnderTrial(setting)),
        scene_(PlanningScene(setting)),
        problem_(ProblemOf(setting, scene_, options)) {
    result_.setting = setting;
  }

  void AddDesigns() {
    Add({FixedContestant(kHandcrafted, HandcraftedMotion(setting_.task), setting_.carrier, scene_)},
        {});
    const double start = ProcessCpuSeconds();
    MotionDesignProblem one = problem_;
    one.rigs.resize(1);
    const std::optional<MotionDesign> nominal = DesignFromManyStarts(
        one, {options_.num_starts, options_.evaluations_per_start, options_.evaluations_of_best},
        Rng(setting_.seed).Stream("rows"));
    if (!nominal) {
      throw InputError({"no motion teaches anything about this rig", RigsName(setting_),
                        "the board is never seen as a whole", "move the board"});
    }
    PlanningRow row;
    row.num_design_evaluations = nominal->num_information_evaluations;
    Add({FixedContestant("nominal", nominal->motion, setting_.carrier, scene_)}, row);
    robust_ = *nominal;
    if (const auto design =
            DesignMotion(problem_, nominal->motion, {options_.robust_evaluations})) {
      robust_ = *design;
      robust_.num_information_evaluations += nominal->num_information_evaluations;
    }
    row.num_design_evaluations = robust_.num_information_evaluations;
    Add({FixedContestant(kRobust, robust_.motion, setting_.carrier, scene_)}, row);
    result_.seconds["nominal and robust"] += ProcessCpuSeconds() - start;
    AddClosedLoop("closed loop", {robust_.motion}, row);
    AddOracle(row);
  }

  void AddBrought(const std::vector<MotionUnderTrial>& motions) {
    for (const Contestant& brought :
         BroughtContestants(motions, setting_.task, setting_.carrier, scene_)) {
      std::vector<Motion> looped;
      PlanningRow row;
      for (const ExecutableMotion& member : brought.motions) {
        if (!member.timed) continue;
        row.num_episodes += CountIn(member.timed->motion, "episodes");
        row.num_design_evaluations += CountIn(member.timed->motion, "information_evaluations");
        looped.push_back(member.timed->motion);
      }
      // A row is the mean of its members, and so are its budgets.
      const auto num_members = static_cast<int64_t>(std::max<size_t>(1, looped.size()));
      row.num_episodes /= num_members;
      row.num_design_evaluations /= num_members;
      Add({brought}, row);
      if (looped.size() != brought.motions.size()) continue;
      AddClosedLoop(brought.policy + ", closed loop", looped, row);
    }
  }

  FourRows Judge() {
    std::vector<Contestant> flat;
    for (const std::vector<Contestant>& members : contestants_) {
      flat.insert(flat.end(), members.begin(), members.end());
    }
    const ContestTrials trials = RunContest(setting_, rigs_, flat);
    size_t next = 0;
    for (size_t k = 0; k < contestants_.size(); ++k) {
      for (size_t m = 0; m < contestants_[k].size(); ++m, ++next) {
        for (const std::vector<Trial>& member : trials[next]) {
          result_.rows[k].trials.push_back(member);
        }
      }
    }
    return result_;
  }

 private:
  // Contestants whose trials make one row.
  void Add(std::vector<Contestant> members, PlanningRow row) {
    row.policy = members.front().policy;
    contestants_.push_back(std::move(members));
    result_.rows.push_back(std::move(row));
  }

  void AddClosedLoop(const std::string& policy, const std::vector<Motion>& starts,
                     PlanningRow row) {
    std::vector<Contestant> members;
    for (const Motion& start : starts) {
      // A policy that was brought keeps to its own budget where that is larger.
      MotionDesignProblem problem = problem_;
      const MotionBudget own = BudgetOf(start, scene_);
      problem.max_path_m = std::max(problem.max_path_m, own.path_m);
      problem.max_duration_s = std::max(problem.max_duration_s, own.duration_s);
      MadeForRigs made = MakeForRigs(
          policy, rigs_, MakeExecutable(start, setting_.carrier, scene_), [&](size_t i) {
            return PlayClosedLoop(problem, start, setting_.carrier, setting_.fidelity, rigs_[i],
                                  NoiseOf(setting_, i), options_.closed_loop);
          });
      row.mean_evaluations_of_rig += made.mean_evaluations / static_cast<double>(starts.size());
      result_.seconds[policy] += made.cpu_s;
      members.push_back(std::move(made.contestant));
    }
    Add(std::move(members), std::move(row));
  }

  void AddOracle(PlanningRow row) {
    MadeForRigs made = MakeForRigs(
        kOracle, rigs_, MakeExecutable(robust_.motion, setting_.carrier, scene_), [&](size_t i) {
          return DesignForTruth(problem_, robust_.motion, setting_.carrier, rigs_[i],
                                options_.oracle_evaluations);
        });
    row.mean_evaluations_of_rig = made.mean_evaluations;
    result_.seconds[kOracle] += made.cpu_s;
    Add({std::move(made.contestant)}, std::move(row));
  }

  const ContestSetting setting_;
  const FourRowsOptions options_;
  const std::vector<Rig> rigs_;
  const Rig scene_;
  const MotionDesignProblem problem_;
  MotionDesign robust_;
  std::vector<std::vector<Contestant>> contestants_;
  FourRows result_;
};

const PlanningRow* Find(const FourRows& task, const std::string& policy) {
  for (const PlanningRow& row : task.rows) {
    if (row.policy == policy) return &row;
  }
  return nullptr;
}

void SetRatio(const FourRows& task, const PlanningRow& row, const std::string& rival,
              const Rng& rng, Value* value) {
  const PlanningRow* const reference = Find(task, rival);
  if (reference == nullptr || reference == &row) return;
  const auto set = [&](const std::string& key, double Trial::*figure) {
    const Figures own = FiguresOf(row.trials, figure);
    const Figures theirs = FiguresOf(reference->trials, figure);
    value->Set(key, FiniteValue(PairedRatio(own, theirs)))
        .Set(key + "_ci95", PairValue(BootstrapRatio(own, theirs, rng.Stream(key))));
  };
  set("ratio_to_" + rival, &Trial::relative_error);
  set("prediction_ratio_to_" + rival, &Trial::prediction_error_px);
}

}  // namespace

FourRows EvaluateFourRows(const ContestSetting& setting,
                          const std::vector<MotionUnderTrial>& motions,
                          const FourRowsOptions& options) {
  CheckFidelity(setting);
  Evaluation evaluation(setting, options);
  evaluation.AddDesigns();
  evaluation.AddBrought(motions);
  return evaluation.Judge();
}

Value ToValue(const std::vector<FourRows>& tasks) {
  Value rows = Value::Array();
  for (const FourRows& task : tasks) {
    const Rng rng = Rng(task.setting.seed).Stream("rows " + TaskName(task.setting.task));
    for (size_t k = 0; k < task.rows.size(); ++k) {
      const PlanningRow& made = task.rows[k];
      const Rng draws = rng.Stream("row", k);
      Value row = MethodRow(task.setting, made.policy, made.trials, draws);
      row.Set("episodes", made.num_episodes)
          .Set("design_information_evaluations", made.num_design_evaluations)
          .Set("information_evaluations_of_rig", made.mean_evaluations_of_rig);
      for (const char* rival : {kHandcrafted, kRobust, kOracle}) {
        SetRatio(task, made, rival, draws, &row);
      }
      rows.Append(std::move(row));
    }
  }
  return Value::Object().Set("kind", "rows").Set("rows", std::move(rows));
}

std::vector<Chart> ChartsOf(const std::vector<FourRows>& tasks) {
  std::vector<Chart> charts;
  for (const FourRows& task : tasks) {
    Chart chart;
    chart.kind = Chart::Kind::kBoxes;
    chart.title = "Relative error over rigs, " + TaskName(task.setting.task);
    chart.note = "The box holds the middle half of the rigs, its line is the median.";
    chart.y_title = "relative error [%], logarithmic";
    chart.is_y_logarithmic = true;
    for (const PlanningRow& row : task.rows) {
      ChartSeries series{row.policy, {}, {}, {}, {}};
      for (const double error : Existing(FiguresOf(row.trials, &Trial::relative_error))) {
        series.y.push_back(100.0 * error);
      }
      chart.series.push_back(std::move(series));
    }
    charts.push_back(std::move(chart));
  }
  return charts;
}

}  // namespace calibrato
