#include "calibrato/learning/normalisation.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace calibrato {
namespace {

// A quantity that never varied has no unit of its own; what is left of it then is rounding.
double UsableStddev(double variance, double mean) {
  const double stddev = std::sqrt(std::max(variance, 0.0));
  return stddev > 1e-9 * std::max(1.0, std::abs(mean)) ? stddev : 1.0;
}

}  // namespace

Eigen::VectorXd Normalisation::Normalised(const Eigen::VectorXd& observation) const {
  // As std::clamp, which lets NaN through: Eigen's min and max may lose it.
  return ((observation - observation_mean).array() / observation_stddev.array())
      .unaryExpr([](double x) { return std::clamp(x, -kCutOff, kCutOff); });
}

double Normalisation::Normalised(double reward) const {
  return std::clamp((reward - reward_mean) / reward_stddev, -kCutOff, kCutOff);
}

Normalisation UnitNormalisation(int observation_size) {
  Normalisation unit;
  unit.observation_mean = Eigen::VectorXd::Zero(observation_size);
  unit.observation_stddev = Eigen::VectorXd::Ones(observation_size);
  return unit;
}

Normalisation NormalisationOf(const ReplayMemory& memory) {
  assert(memory.size() > 0);
  const auto n = static_cast<double>(memory.size());
  const Eigen::Index size = memory[0].next_observation.size();
  Eigen::VectorXd observation_sum = Eigen::VectorXd::Zero(size);
  double reward_sum = 0.0;
  for (size_t i = 0; i < memory.size(); ++i) {
    observation_sum += memory[i].history.observations.back() + memory[i].next_observation;
    reward_sum += memory[i].reward;
  }
  Normalisation result;
  result.observation_mean = observation_sum / (2.0 * n);
  result.reward_mean = reward_sum / n;

  Eigen::ArrayXd observation_squares = Eigen::ArrayXd::Zero(size);
  double reward_squares = 0.0;
  for (size_t i = 0; i < memory.size(); ++i) {
    observation_squares +=
        (memory[i].history.observations.back() - result.observation_mean).array().square() +
        (memory[i].next_observation - result.observation_mean).array().square();
    reward_squares += std::pow(memory[i].reward - result.reward_mean, 2);
  }
  result.observation_stddev.resize(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    result.observation_stddev[i] =
        UsableStddev(observation_squares[i] / (2.0 * n), result.observation_mean[i]);
  }
  result.reward_stddev = UsableStddev(reward_squares / n, result.reward_mean);
  return result;
}

}  // namespace calibrato
