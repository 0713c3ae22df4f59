#include "calibrato/evaluation/table1.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "calibrato/mdp/frames_that_count.h"
#include "calibrato/motion/expert_motion.h"

namespace calibrato {
namespace {

constexpr const char* kHandcrafted = "handcrafted";

std::string AtPathOf(const std::string& policy, const std::string& rival) {
  return policy + " at " + rival + "'s path";
}

// Room for rounding when paths that were made equal are compared.
bool IsLonger(double path, double other) { return path > other * (1.0 + 1e-9); }

std::vector<Contestant> Contestants(const Table1Options& options, const std::vector<Rig>& rigs,
                                    const Rig& scene) {
  const ContestSetting& setting = options.setting;
  const Carrier carrier = setting.carrier;
  const auto in_scene = [&](size_t) -> const Rig& { return scene; };
  const auto on_rig = [&](size_t i) -> const Rig& { return rigs[i]; };

  std::vector<Contestant> contestants;
  contestants.push_back(RandomContestant(setting.task, carrier, rigs, Rng(setting.seed)));
  contestants.push_back(
      FixedContestant(kHandcrafted, HandcraftedMotion(setting.task), carrier, scene));
  const double random_path = contestants[0].mean_path_length_m();
  const double handcrafted_path = contestants[1].mean_path_length_m();
  for (const Contestant& brought :
       BroughtContestants(options.motions, setting.task, carrier, scene)) {
    contestants.push_back(brought);
    const bool is_looped =
        std::all_of(brought.motions.begin(), brought.motions.end(),
                    [](const ExecutableMotion& m) { return m.timed.has_value(); });
    if (!is_looped || !IsLonger(brought.mean_path_length_m(), random_path)) continue;
    contestants.push_back(
        AtPathLength(brought, AtPathOf(brought.policy, "random"), random_path, carrier, in_scene));
  }
  contestants.push_back(AtPathLength(contestants[0], AtPathOf("random", kHandcrafted),
                                     handcrafted_path, carrier, on_rig));
  const Contestant expert = FixedContestant("expert", ExpertMotion(), carrier, scene);
  contestants.push_back(expert);
  contestants.push_back(
      AtPathLength(expert, AtPathOf("expert", kHandcrafted), handcrafted_path, carrier, in_scene));
  return contestants;
}

std::vector<BoardView> ViewsOf(Task task, const ExecutableMotion& motion, const Rig& scene,
                               const Rng& noise) {
  std::vector<BoardView> views =
      RecordForTrial(Task::kIntrinsic, scene, motion, Fidelity::kFast, noise).views;
  if (task == Task::kExtrinsic) return views;
  return FramesThatCount(std::move(views), scene.cameras.front().resolution, scene.board);
}

void Summarise(Task task, Table1Row* row, const Rng& rng) {
  const Figures errors = FiguresOf(row->trials, &Trial::relative_error);
  row->num_failures = NumFailures(row->trials);
  row->mean_error = Mean(Existing(errors));
  row->mean_error_ci95 = BootstrapMean(errors, rng);
  row->median_error = Median(Existing(errors));
  row->consistency =
      TestConsistency(Existing(FiguresOf(row->trials, &Trial::nees)), NeesDimension(task));
}

// Of every row to this one.
void Compare(std::vector<Table1Row>* rows, const std::string& rival, const std::string& purpose,
             Comparison Table1Row::*comparison, const Rng& rng) {
  const auto named = std::find_if(rows->begin(), rows->end(),
                                  [&](const Table1Row& row) { return row.policy == rival; });
  const Figures reference = FiguresOf(named->trials, &Trial::relative_error);
  std::vector<double> probabilities;
  for (size_t k = 0; k < rows->size(); ++k) {
    Table1Row& row = (*rows)[k];
    const bool is_itself = &row == &*named;
    const Figures own = FiguresOf(row.trials, &Trial::relative_error);
    const Figures& errors = is_itself ? reference : own;
    const Rng draws = rng.Stream("bootstrap ratio to " + purpose, k);
    Comparison& made = row.*comparison;
    made.ratio = PairedRatio(errors, reference);
    made.ci95 = BootstrapRatio(errors, reference, draws);
    made.probability =
        is_itself ? std::numeric_limits<double>::quiet_NaN()
                  : PairedPermutationProbability(errors, reference, draws.Stream("permutation"));
    probabilities.push_back(made.probability);
  }
  const std::vector<double> adjusted = HolmAdjusted(probabilities);
  for (size_t k = 0; k < rows->size(); ++k) {
    ((*rows)[k].*comparison).adjusted_probability = adjusted[k];
  }
}

std::string BestSimpleRival(const std::vector<Table1Row>& rows,
                            const std::vector<Contestant>& contestants) {
  const double longest = contestants[1].mean_path_length_m();
  size_t best = 1;
  for (size_t k = 0; k < rows.size(); ++k) {
    const std::string& policy = rows[k].policy;
    const bool is_simple = policy == "random" || policy == AtPathOf("random", kHandcrafted) ||
                           policy == "expert" || policy == AtPathOf("expert", kHandcrafted) ||
                           policy == "best-of-1000";
    if (!is_simple || IsLonger(contestants[k].mean_path_length_m(), longest)) continue;
    if (rows[k].mean_error < rows[best].mean_error) best = k;
  }
  return rows[best].policy;
}

}  // namespace

int Table1Row::num_trials() const {
  return trials.empty() ? 0 : static_cast<int>(trials.size() * trials.front().size());
}

double Table1Row::MeanOf(double Trial::*figure) const {
  return Mean(Existing(FiguresOf(trials, figure)));
}

double Table1Row::MedianOf(double Trial::*figure) const {
  return Median(Existing(FiguresOf(trials, figure)));
}

Table1 EvaluateTable1(const Table1Options& options) {
  const ContestSetting& setting = options.setting;
  const Rng rng = Rng(setting.seed).Stream(TaskName(setting.task));
  const std::vector<Rig> rigs = RigsUnderTrial(setting);
  const Rig scene = PlanningScene(setting);
  const std::vector<Contestant> contestants = Contestants(options, rigs, scene);
  ContestTrials trials = RunContest(setting, rigs, contestants);

  Table1 table{options, std::vector<Table1Row>(contestants.size()), ""};
  for (size_t k = 0; k < contestants.size(); ++k) {
    Table1Row& row = table.rows[k];
    row.policy = contestants[k].policy;
    row.trials = std::move(trials[k]);
    for (const ExecutableMotion& motion : contestants[k].motions) {
      row.scale = std::min(row.scale, motion.scale);
    }
    row.example = contestants[k].motions.front();
    row.example_views = ViewsOf(setting.task, row.example, scene, rng.Stream("example"));
    Summarise(setting.task, &row, rng.Stream("bootstrap", k));
  }
  table.best_simple_rival = BestSimpleRival(table.rows, contestants);
  Compare(&table.rows, kHandcrafted, kHandcrafted, &Table1Row::to_handcrafted, rng);
  Compare(&table.rows, "random", "random", &Table1Row::to_random, rng);
  Compare(&table.rows, table.best_simple_rival, "best simple rival",
          &Table1Row::to_best_simple_rival, rng);
  return table;
}

}  // namespace calibrato
