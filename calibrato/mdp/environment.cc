#include "calibrato/mdp/environment.h"

namespace calibrato {

double SumOf(const std::vector<RewardTerm>& terms) {
  double sum = 0.0;
  for (const RewardTerm& term : terms) sum += term.value();
  return sum;
}

}  // namespace calibrato
