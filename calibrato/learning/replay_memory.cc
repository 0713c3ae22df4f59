#include "calibrato/learning/replay_memory.h"

#include <cassert>
#include <utility>

namespace calibrato {

ReplayMemory::ReplayMemory(size_t capacity) : capacity_(capacity) { assert(capacity > 0); }

void ReplayMemory::Add(Transition transition) {
  assert(transition.history.observations.size() == transition.history.actions.size() + 1);
  if (transitions_.size() == capacity_) transitions_.pop_front();
  transitions_.push_back(std::move(transition));
}

}  // namespace calibrato
