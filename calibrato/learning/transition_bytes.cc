#include "calibrato/learning/transition_bytes.h"

namespace calibrato {
namespace {

LoopCoefficients ReadAction(ByteReader& reader) {
  const Eigen::VectorXd action = reader.ReadVector();
  if (action.size() != LoopCoefficients::RowsAtCompileTime) {
    reader.Fail("an action without 36 coefficients");
  }
  return action;
}

}  // namespace

void Write(const Transition& transition, ByteWriter& writer) {
  writer.Write(static_cast<int64_t>(transition.history.actions.size()));
  for (const Eigen::VectorXd& observation : transition.history.observations) {
    writer.Write(observation);
  }
  for (const LoopCoefficients& action : transition.history.actions) {
    writer.Write(Eigen::VectorXd(action));
  }
  writer.Write(Eigen::VectorXd(transition.action));
  writer.Write(transition.reward);
  writer.Write(transition.next_observation);
}

Transition ReadTransition(ByteReader& reader) {
  Transition transition;
  const int64_t num_actions = reader.ReadInt();
  if (num_actions < 0) reader.Fail("a history of negative length");
  for (int64_t k = 0; k <= num_actions; ++k) {
    transition.history.observations.push_back(reader.ReadVector());
  }
  for (int64_t k = 0; k < num_actions; ++k) {
    transition.history.actions.push_back(ReadAction(reader));
  }
  transition.action = ReadAction(reader);
  transition.reward = reader.ReadDouble();
  transition.next_observation = reader.ReadVector();
  return transition;
}

}  // namespace calibrato
