#include "calibrato/learning/design_learner.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/progress.h"
#include "calibrato/learning/gaussian_process.h"

namespace calibrato {
namespace {

// Of the three functions of the trust. The expected loss is known without noise, and moves by
// tenths over the whole range; how far it is off may move as much. What is stated comes of the same
// rigs and noise in each round, so that rounds differ by little but their motions.
constexpr GaussianProcessOptions kExpectation{
    .length_scale = 1.0, .signal_stddev = 0.5, .noise_stddev = 0.02};
constexpr GaussianProcessOptions kStated{
    .length_scale = 0.7, .signal_stddev = 0.3, .noise_stddev = 0.02};
constexpr double kLengthScale = 0.7;
constexpr double kOverconfidenceStddev = 0.2;
constexpr int kNumCandidates = 512;
constexpr int kFramesOfStarts = 24;

// Standard deviation of half the logarithm of the pooled NEES, whose relative one is sqrt(2 / dof).
double NoiseOf(const DesignRound& round) {
  double dimension = 0.0;
  for (const MotionJudgement& it : round.judgements) dimension += it.nees_dimension;
  return 0.5 * std::sqrt(2.0 / std::max(1.0, dimension));
}

// What is believed of the loss at any trust, from the rounds so far.
class LossModel {
 public:
  explicit LossModel(const std::vector<DesignRound>& rounds)
      : expected_(
            Points(rounds),
            Values(rounds, [base = rounds.front().expected_loss](
                               const DesignRound& round) { return round.expected_loss - base; }),
            kExpectation),
        stated_(Points(rounds),
                Values(rounds,
                       [](const DesignRound& round) {
                         return StatedLoss(round) - round.expected_loss;
                       }),
                kStated),
        overconfidence_(Points(rounds), Values(rounds, &Overconfidence),
                        {.length_scale = kLengthScale,
                         .signal_stddev = kOverconfidenceStddev,
                         .noise_stddev = NoiseOf(rounds.front())}) {}

  [[nodiscard]] double Hopeful(const Trust& trust) const {
    double mean = 0.0;
    double variance = 0.0;
    for (const GaussianProcess* part : {&expected_, &stated_, &overconfidence_}) {
      const Belief belief = part->At(trust);
      mean += belief.mean;
      variance += belief.stddev * belief.stddev;
    }
    return mean - std::sqrt(variance);
  }
  // Of a round that was played: only what its few rigs tell roughly leans on the other rounds.
  [[nodiscard]] double Believed(const DesignRound& round) const {
    return StatedLoss(round) + overconfidence_.At(round.trust).mean;
  }

 private:
  static Eigen::MatrixXd Points(const std::vector<DesignRound>& rounds) {
    Eigen::MatrixXd points(Trust::RowsAtCompileTime, static_cast<Eigen::Index>(rounds.size()));
    for (size_t i = 0; i < rounds.size(); ++i)
      points.col(static_cast<Eigen::Index>(i)) = rounds[i].trust;
    return points;
  }
  static Eigen::VectorXd Values(const std::vector<DesignRound>& rounds,
                                const std::function<double(const DesignRound&)>& value) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(rounds.size()));
    for (size_t i = 0; i < rounds.size(); ++i)
      values(static_cast<Eigen::Index>(i)) = value(rounds[i]);
    return values;
  }

  GaussianProcess expected_;
  GaussianProcess stated_;
  GaussianProcess overconfidence_;
};

// The second round draws all limits in halfway, so that there is something to compare; the others
// go where the loss may be least.
Trust NextTrust(const std::vector<DesignRound>& rounds, Rng rng) {
  if (rounds.size() == 1) return Trust::Constant(0.5);
  const LossModel model(rounds);
  Trust best = Trust::Ones();
  double best_loss = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kNumCandidates; ++i) {
    Trust trust;
    for (double& x : trust) x = rng.Uniform(0.0, 1.0);
    const double loss = model.Hopeful(trust);
    if (loss < best_loss) {
      best_loss = loss;
      best = trust;
    }
  }
  return best;
}

size_t BestRound(const std::vector<DesignRound>& rounds) {
  const LossModel model(rounds);
  size_t best = 0;
  for (size_t i = 1; i < rounds.size(); ++i) {
    if (model.Believed(rounds[i]) < model.Believed(rounds[best])) best = i;
  }
  return best;
}

// A design on its way between processes; nothing stays nothing.
std::string ToText(const std::optional<MotionDesign>& design) {
  if (!design) return "";
  return ToJsonLine(Value::Object()
                        .Set("motion", ToValue(design->motion))
                        .Set("loss", design->loss)
                        .Set("evaluations", design->num_information_evaluations));
}

std::optional<MotionDesign> DesignFromText(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const Value value = ParseJson(text, "the design of a process");
  return MotionDesign{MotionFromValue(value.At("motion"), nullptr), value.At("loss").AsDouble(),
                      value.At("evaluations").AsInt()};
}

class DesignLearner {
 public:
  DesignLearner(const DesignLearnOptions& options, const Judge& judge, std::string folder,
                Team& team)
      : options_(options),
        judge_(judge),
        folder_(std::move(folder)),
        team_(team),
        rng_(options.seed) {
    result_.task = options.problem.task;
    result_.preset = "best";
    if (!options.resume) return;
    progress_ = DesignProgressFromText(
        OfTheFirst(team_, [&] { return ReadDesignCheckpoint(folder_); }), folder_, NameOfRun());
    if (NumEpisodes() <= options.num_episodes) return;
    throw InputError({"cannot resume", folder_,
                      "it has " + std::to_string(NumEpisodes()) + " episodes, " +
                          std::to_string(options.num_episodes) + " were asked for",
                      "ask for at least " + std::to_string(NumEpisodes())});
  }

  LearnResult Run(const std::atomic<bool>* interrupt) {
    const auto num_rounds =
        static_cast<size_t>(std::max(1, options_.num_episodes / options_.episodes_per_round));
    Progress progress("learning", static_cast<int>(num_rounds) * options_.episodes_per_round);
    progress.Advance(static_cast<int>(progress_.rounds.size()) * options_.episodes_per_round);
    while (progress_.rounds.size() < num_rounds) {
      if (AnyOf(team_, interrupt != nullptr && interrupt->load())) {
        return Ended(LearnTermination::kInterrupted, "interrupted after episode " +
                                                         std::to_string(NumEpisodes()) +
                                                         "; continue with --resume");
      }
      PlayRound(&progress);
    }
    return Finish();
  }

 private:
  [[nodiscard]] int NumEpisodes() const {
    return static_cast<int>(progress_.rounds.size()) * options_.episodes_per_round;
  }

  // What the course of learning depends on.
  [[nodiscard]] Value NameOfRun() const {
    const MotionDesignProblem& problem = options_.problem;
    return Value::Object()
        .Set("task", TaskName(problem.task))
        .Set("carrier", CarrierName(options_.carrier))
        .Set("environment", options_.environment)
        .Set("seed", std::to_string(options_.seed))
        .Set("episodes_per_round", options_.episodes_per_round)
        .Set("rigs", problem.rigs.size())
        .Set("loops", problem.num_loops)
        .Set("max_path_m", problem.max_path_m)
        .Set("max_duration_s", problem.max_duration_s)
        .Set("coefficient_limit", problem.coefficient_limit)
        .Set("criterion", static_cast<int>(problem.criterion))
        .Set("frames_per_loop", problem.frames_per_loop)
        .Set("starts", options_.starts.num_starts)
        .Set("evaluations_per_start", options_.starts.evaluations_per_start)
        .Set("evaluations_of_best", options_.starts.evaluations_of_best)
        .Set("robust_evaluations", options_.robust_evaluations)
        .Set("evaluations_of_round", options_.evaluations_of_round);
  }

  void Save() const {
    ExpectAlike(team_, ToJsonLine(ToValue(progress_.rounds.back().motion.motion)) +
                           std::to_string(RealisedLoss(progress_.rounds.back())));
    if (!team_.is_first()) return;
    std::filesystem::create_directories(folder_);
    WriteDesignProgress(folder_, NameOfRun(), progress_, options_.problem.task);
  }

  // MapOver, its time taken.
  std::vector<std::string> Divide(size_t n, const std::function<std::string(size_t)>& function) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::string> results = MapOver(team_, n, function);
    result_.divided_s +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return results;
  }

  // For the nominal rig from many starts, then for all rigs.
  Motion FirstDesign() {
    MotionDesignProblem nominal = options_.problem;
    nominal.rigs.resize(1);
    // Enough for the fourth harmonic, in half the time. The final design needs more: with few
    // frames the board leaves the image between them.
    nominal.frames_per_loop = std::min(nominal.frames_per_loop, kFramesOfStarts);
    const DesignMany by_team = [&](size_t n, const auto& from_start) {
      std::vector<std::optional<MotionDesign>> designs;
      for (const std::string& text : Divide(n, [&](size_t k) { return ToText(from_start(k)); })) {
        designs.push_back(DesignFromText(text));
      }
      return designs;
    };
    std::optional<MotionDesign> design =
        DesignFromManyStarts(nominal, options_.starts, rng_.Stream("starts"), by_team);
    if (!design) {
      throw InputError({"nothing to learn from", "",
                        "no motion within these limits shows the board",
                        "allow a longer path or more time"});
    }
    progress_.num_information_evaluations += design->num_information_evaluations;
    return DesignedFrom(design->motion, options_.problem, options_.robust_evaluations);
  }

  Motion DesignedFrom(const Motion& start, const MotionDesignProblem& problem, int evaluations) {
    const std::optional<MotionDesign> design = DesignMotion(problem, start, {evaluations});
    if (!design) return start;
    progress_.num_information_evaluations += design->num_information_evaluations;
    return design->motion;
  }

  // As its carrier makes it. The arm's time law may need longer than the design thought: then the
  // design is told to hurry less.
  TimedMotion Planned(Motion motion, MotionDesignProblem problem) {
    constexpr int kMaxAttempts = 4;
    for (int attempt = 0;; ++attempt) {
      motion.carrier = options_.carrier;
      auto planned = PlanMotion(motion, problem.rigs.front());
      TimedMotion timed = std::holds_alternative<TimedMotion>(planned)
                              ? std::get<TimedMotion>(std::move(planned))
                              : PlanScaledToFit(motion, problem.rigs.front());
      const double excess = timed.duration_s() / problem.max_duration_s;
      if (excess <= 1.001 || attempt == kMaxAttempts) return timed;
      problem.limits.speed /= excess;
      problem.limits.angular_speed /= excess;
      problem.limits.acceleration /= excess * excess;
      problem.limits.angular_acceleration /= excess * excess;
      motion = DesignedFrom(timed.motion, problem, options_.evaluations_of_round);
    }
  }

  void PlayRound(Progress* progress) {
    DesignRound round;
    const size_t index = progress_.rounds.size();
    if (index == 0) {
      round.motion = Planned(FirstDesign(), options_.problem);
    } else {
      round.trust = NextTrust(progress_.rounds, rng_.Stream("trust", index));
      const MotionDesignProblem problem = Within(options_.problem, LimitsOf(round.trust));
      const Motion& start = progress_.rounds[BestRound(progress_.rounds)].motion.motion;
      round.motion = Planned(DesignedFrom(start, problem, options_.evaluations_of_round), problem);
    }
    Motion executed = round.motion.motion;
    for (size_t i = 0; i < executed.loops.size(); ++i) {
      executed.loops[i].duration_s = round.motion.loop_duration_s[i];
    }
    round.expected_loss = ExpectLoss(options_.problem, executed).value;
    progress_.num_information_evaluations += NumEvaluations(options_.problem);
    const auto judgements = Divide(static_cast<size_t>(options_.episodes_per_round), [&](size_t i) {
      std::string judgement = ToJsonLine(ToValue(judge_(round.motion, i)));
      progress->Advance(team_.size());
      return judgement;
    });
    for (const std::string& text : judgements) {
      round.judgements.push_back(JudgementFromValue(ParseJson(text, "the judgement of a process")));
    }
    progress_.rounds.push_back(std::move(round));
    Save();
  }

  LearnResult Ended(LearnTermination termination, std::string text) {
    result_.num_episodes = NumEpisodes();
    result_.num_calibrations = NumEpisodes();
    result_.num_information_evaluations = progress_.num_information_evaluations;
    result_.best_return = -std::numeric_limits<double>::infinity();
    for (const DesignRound& round : progress_.rounds) {
      result_.best_return = std::max(result_.best_return, -RealisedLoss(round));
    }
    result_.termination = termination;
    result_.termination_text = std::move(text);
    return result_;
  }

  LearnResult Finish() {
    const size_t best = BestRound(progress_.rounds);
    const DesignRound& round = progress_.rounds[best];
    result_.motion = round.motion.motion;
    for (size_t i = 0; i < result_.motion.loops.size(); ++i) {
      result_.motion.loops[i].duration_s = round.motion.loop_duration_s[i];
    }
    result_.motion.provenance =
        Value::Object()
            .Set("method", "learned")
            .Set("task", TaskName(result_.task))
            .Set("preset", "best")
            .Set("seed", std::to_string(options_.seed))
            .Set("episodes", NumEpisodes())
            .Set("information_evaluations", progress_.num_information_evaluations)
            .Set("round", best + 1)
            .Set("trusted", ToValue(LimitsOf(round.trust)));
    if (team_.is_first()) WriteDesignPolicy(folder_ + "/policy", NameOfRun(), result_.motion);
    char text[200];
    std::snprintf(text, sizeof(text), "done: %d episodes; the motion of round %zu of %zu, %s",
                  NumEpisodes(), best + 1, progress_.rounds.size(),
                  best == 0 ? "the design that trusts the model: learning added nothing to it"
                            : "which learning preferred to the design that trusts the model");
    return Ended(LearnTermination::kDone, text);
  }

  const DesignLearnOptions& options_;
  const Judge& judge_;
  std::string folder_;
  Team& team_;
  Rng rng_;
  DesignProgress progress_;
  LearnResult result_;
};

}  // namespace

LearnResult LearnByDesign(const DesignLearnOptions& options, const Judge& judge,
                          const std::string& folder, const std::atomic<bool>* interrupt,
                          Team* team) {
  assert(!options.problem.rigs.empty() && options.episodes_per_round >= 1);
  Alone alone;
  return DesignLearner(options, judge, folder, team != nullptr ? *team : alone).Run(interrupt);
}

}  // namespace calibrato
