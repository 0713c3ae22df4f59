#include "calibrato/learning/design_rounds.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

constexpr int kFormatVersion = 1;
// Rigs' worth of belief that stated covariances are true.
constexpr double kBelievedRigs = 4.0;
constexpr size_t kMaxBytes = size_t{1} << 30;

std::string CheckpointPath(const std::string& folder) { return folder + "/checkpoint.json"; }

Value ToValue(const DesignRound& round) {
  Value judgements = Value::Array();
  for (const MotionJudgement& it : round.judgements) judgements.Append(calibrato::ToValue(it));
  return Value::Object()
      .Set("trust", Value::Numbers(round.trust))
      .Set("motion", ToValue(round.motion.motion))
      .Set("loop_duration_s", Value::Numbers(round.motion.loop_duration_s))
      .Set("expected_loss", round.expected_loss)
      .Set("judgements", std::move(judgements));
}

// Without the joint path, which nobody asks an old round for.
DesignRound RoundFromValue(const Value& value) {
  DesignRound round;
  const std::vector<double> trust = value.At("trust").AsDoubles(4);
  round.trust = Eigen::Map<const Trust>(trust.data());
  round.motion.motion = MotionFromValue(value.At("motion"), nullptr);
  round.motion.loop_duration_s =
      value.At("loop_duration_s").AsDoubles(round.motion.motion.loops.size());
  round.expected_loss = value.At("expected_loss").AsDouble();
  for (const Value& it : value.At("judgements").elements()) {
    round.judgements.push_back(JudgementFromValue(it));
  }
  if (round.judgements.empty()) {
    value.At("judgements").Fail("nothing there", "expected one an episode", "learn again");
  }
  return round;
}

std::string TrainingLines(const DesignProgress& progress, Task task) {
  std::string lines;
  int episode = 0;
  for (size_t i = 0; i < progress.rounds.size(); ++i) {
    const DesignRound& round = progress.rounds[i];
    const double path_length_m = PathLength(round.motion.motion);
    for (const MotionJudgement& it : round.judgements) {
      const double surprise =
          0.5 * std::log(std::max(it.nees, 1e-12) / static_cast<double>(it.nees_dimension));
      lines += ToJsonLine(Value::Object()
                              .Set("episode", ++episode)
                              .Set("kind", "design")
                              .Set("task", TaskName(task))
                              .Set("round", i + 1)
                              .Set("return", -it.stated_loss)
                              .Set("terms", Value::Object().Set("information", -it.stated_loss))
                              .Set("predicted_return", -round.expected_loss)
                              .Set("realised_loss_of_round", RealisedLoss(round))
                              .Set("surprise", surprise)
                              .Set("final_relative_error", it.relative_error)
                              .Set("path_length_m", path_length_m)
                              .Set("motion_s", round.motion.duration_s())
                              .Set("trusted", calibrato::ToValue(LimitsOf(round.trust)))) +
               "\n";
    }
  }
  return lines;
}

}  // namespace

Value ToValue(const MotionJudgement& judgement) {
  return Value::Object()
      .Set("stated_loss", judgement.stated_loss)
      .Set("nees", judgement.nees)
      .Set("nees_dimension", judgement.nees_dimension)
      .Set("relative_error", judgement.relative_error);
}

MotionJudgement JudgementFromValue(const Value& value) {
  return {value.At("stated_loss").AsDouble(), value.At("nees").AsNonNegative(),
          static_cast<int>(value.At("nees_dimension").AsInt(1, 1000)),
          value.At("relative_error").AsNonNegative()};
}

double StatedLoss(const DesignRound& round) {
  assert(!round.judgements.empty());
  double stated = 0.0;
  for (const MotionJudgement& it : round.judgements) stated += it.stated_loss;
  return stated / static_cast<double>(round.judgements.size());
}

double Overconfidence(const DesignRound& round) {
  assert(!round.judgements.empty());
  double nees = 0.0;
  double dimension = 0.0;
  for (const MotionJudgement& it : round.judgements) {
    nees += it.nees;
    dimension += it.nees_dimension;
  }
  const double believed = kBelievedRigs * dimension / static_cast<double>(round.judgements.size());
  return 0.5 * std::log((believed + nees) / (believed + dimension));
}

double RealisedLoss(const DesignRound& round) { return StatedLoss(round) + Overconfidence(round); }

void WriteDesignProgress(const std::string& folder, const Value& run,
                         const DesignProgress& progress, Task task) {
  Value rounds = Value::Array();
  for (const DesignRound& round : progress.rounds) rounds.Append(ToValue(round));
  Value checkpoint = Value::Object();
  checkpoint.Set("format_version", kFormatVersion)
      .Set("run", run)
      .Set("information_evaluations", progress.num_information_evaluations)
      .Set("rounds", std::move(rounds));
  WriteFileAtomically(folder + "/training.jsonl", TrainingLines(progress, task));
  WriteFileAtomically(CheckpointPath(folder), ToJson(checkpoint));
}

std::string ReadDesignCheckpoint(const std::string& folder) {
  const std::string path = CheckpointPath(folder);
  if (!std::filesystem::exists(path)) {
    throw InputError({"nothing to resume", path, "there is no such file",
                      "leave out --resume, or give the --out of the run to continue"});
  }
  return ReadFile(path, kMaxBytes);
}

DesignProgress DesignProgressFromText(const std::string& text, const std::string& folder,
                                      const Value& run) {
  const std::string path = CheckpointPath(folder);
  const Value checkpoint = ParseJson(text, path);
  const Value& version = checkpoint.At("format_version");
  if (version.AsInt() != kFormatVersion) {
    version.Fail("cannot resume", "its format is version " + std::to_string(version.AsInt()),
                 "learn again without --resume");
  }
  for (const auto& [name, value] : run.members()) {
    const Value* theirs = checkpoint.At("run").Find(name);
    const std::string there = theirs == nullptr ? "missing" : ToJsonLine(*theirs);
    if (there == ToJsonLine(value)) continue;
    throw InputError({"cannot resume", path,
                      "its " + name + " is " + there + ", " + ToJsonLine(value) + " was asked for",
                      "ask for the same, or learn again without --resume"});
  }
  DesignProgress progress;
  progress.num_information_evaluations = checkpoint.At("information_evaluations").AsInt();
  for (const Value& round : checkpoint.At("rounds").elements()) {
    progress.rounds.push_back(RoundFromValue(round));
  }
  return progress;
}

void WriteDesignPolicy(const std::string& folder, const Value& run, const Motion& motion) {
  OutputFolder out(folder);
  out.Add("policy.yaml", ToYaml(Value::Object()
                                    .Set("format_version", kFormatVersion)
                                    .Set("preset", "best")
                                    .Set("task", run.At("task"))
                                    .Set("run", run)));
  out.Add("motion.yaml", ToYaml(calibrato::ToValue(motion)));
  out.Commit();
}

}  // namespace calibrato
