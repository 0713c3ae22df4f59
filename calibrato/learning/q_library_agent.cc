#include "calibrato/learning/q_library_agent.h"

#include <algorithm>

#include "calibrato/learning/byte_stream.h"
#include "calibrato/motion/motion.h"

namespace calibrato {
namespace {

constexpr double kStep = 0.1;
constexpr double kLeastExploration = 0.1;

}  // namespace

std::vector<LoopCoefficients> MotionLibrary(double limit) {
  std::vector<LoopCoefficients> library;
  // Index 6 dof + k, k = cos1 sin1 cos2 sin2 cos4 sin4.
  for (int dof = 0; dof < 6; ++dof) {
    for (const int k : {1, 3}) {
      LoopCoefficients loop = LoopCoefficients::Zero();
      loop[6 * dof + k] = limit;
      library.push_back(loop);
    }
  }
  const LoopCoefficients scale = ScaledAction(LoopCoefficients::Ones());
  for (const Task task : {Task::kIntrinsic, Task::kExtrinsic}) {
    for (const Loop& loop : HandcraftedMotion(task).loops) {
      const LoopCoefficients action = loop.coefficients.cwiseQuotient(scale);
      const LoopCoefficients scaled = action * (limit / action.cwiseAbs().maxCoeff());
      // One handcrafted loop is a plain turn about an axis, which is there already.
      const bool is_known = std::any_of(library.begin(), library.end(),
                                        [&](const auto& known) { return known.isApprox(scaled); });
      if (!is_known) library.push_back(scaled);
    }
  }
  return library;
}

QLibraryAgent::QLibraryAgent(const LearnOptions& options, int horizon)
    : horizon_(horizon),
      num_updates_(options.networks.minibatch_size * options.networks.minibatches_per_call),
      library_(MotionLibrary(options.planning.swarm.limit)) {}

int QLibraryAgent::IndexOf(const LoopCoefficients& action) const {
  const auto place = std::find(library_.begin(), library_.end(), action);
  return place == library_.end() ? -1 : static_cast<int>(place - library_.begin());
}

std::optional<QLibraryAgent::Set> QLibraryAgent::SetOf(
    const std::vector<LoopCoefficients>& actions) const {
  Set set;
  for (const LoopCoefficients& action : actions) {
    set.push_back(IndexOf(action));
    if (set.back() < 0) return std::nullopt;
  }
  std::sort(set.begin(), set.end());
  return set;
}

int QLibraryAgent::BestOf(const Set& set) const {
  const auto known = table_.find(set);
  if (known == table_.end()) return -1;
  int best = -1;
  for (int k = 0; k < static_cast<int>(library_.size()); ++k) {
    if (!(known->second.visits[k] > 0.0)) continue;
    if (best < 0 || known->second.value[k] > known->second.value[best]) best = k;
  }
  return best;
}

TrainingLoss QLibraryAgent::Train(const ReplayMemory& memory, Rng& rng) {
  TrainingLoss loss;
  for (int i = 0; i < num_updates_; ++i) {
    const Transition& transition = memory[rng.UniformIndex(memory.size())];
    const int action = IndexOf(transition.action);
    const std::optional<Set> set = SetOf(transition.history.actions);
    if (action < 0 || !set) continue;
    Set after = *set;
    after.insert(std::upper_bound(after.begin(), after.end(), action), action);
    const bool is_last = static_cast<int>(after.size()) == horizon_;
    const int next = is_last ? -1 : BestOf(after);
    const double target = transition.reward + (next < 0 ? 0.0 : table_.at(after).value[next]);
    Row& row = table_[*set];
    if (row.value.size() == 0) {
      row.value = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(library_.size()));
      row.visits = row.value;
    }
    const double error = target - row.value[action];
    // What is learned for the first time is believed at once.
    row.value[action] += (row.visits[action] > 0.0 ? kStep : 1.0) * error;
    row.visits[action] += 1.0;
    loss.reward += error * error / num_updates_;
  }
  return loss;
}

Decision QLibraryAgent::Decide(int /*step*/, const History& history, Exploration exploration,
                               Rng& rng) const {
  const std::optional<Set> set = SetOf(history.actions);
  const int best = set ? BestOf(*set) : -1;
  int chosen = best;
  if (exploration == Exploration::kTraining || best < 0) {
    const auto tried = best < 0 ? 0.0 : (table_.at(*set).visits.array() > 0.0).cast<double>().sum();
    const double untried = 1.0 - tried / static_cast<double>(library_.size());
    const bool explores = best < 0 || rng.Uniform() < std::max(kLeastExploration, untried);
    if (explores) chosen = static_cast<int>(rng.UniformIndex(library_.size()));
  }
  Decision decision;
  decision.action = library_[static_cast<size_t>(chosen)];
  if (chosen == best && best >= 0) decision.predicted_return = table_.at(*set).value[best];
  return decision;
}

std::string QLibraryAgent::Bytes() const {
  ByteWriter writer;
  writer.Write(int64_t{horizon_});
  writer.Write(static_cast<int64_t>(table_.size()));
  for (const auto& [set, row] : table_) {
    writer.Write(static_cast<int64_t>(set.size()));
    for (const int k : set) writer.Write(int64_t{k});
    writer.Write(row.value);
    writer.Write(row.visits);
  }
  return writer.bytes();
}

bool QLibraryAgent::Restore(std::string_view bytes, const std::string& path) {
  ByteReader reader(bytes, path);
  if (reader.ReadInt() != horizon_) return false;
  std::map<Set, Row> table;
  const int64_t num_rows = reader.ReadInt();
  const auto size = static_cast<Eigen::Index>(library_.size());
  for (int64_t i = 0; i < num_rows; ++i) {
    Set set;
    const int64_t num_loops = reader.ReadInt();
    for (int64_t k = 0; k < num_loops; ++k) set.push_back(static_cast<int>(reader.ReadInt()));
    Row row;
    row.value = reader.ReadVector();
    row.visits = reader.ReadVector();
    if (row.value.size() != size || row.visits.size() != size) return false;
    table.emplace(std::move(set), std::move(row));
  }
  reader.ExpectEnd();
  table_ = std::move(table);
  return true;
}

}  // namespace calibrato
