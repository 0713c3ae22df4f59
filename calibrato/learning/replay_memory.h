#pragma once

#include <cstddef>
#include <deque>

#include "calibrato/learning/history.h"

namespace calibrato {

/// The data set D_RL of the paper's Algorithm 1: transitions of all episodes, the oldest forgotten
/// first. Off-policy: a transition stays true whoever chose its action.
class ReplayMemory {
 public:
  /// @pre capacity > 0
  explicit ReplayMemory(size_t capacity);

  /// @pre transition.history has one observation more than actions.
  void Add(Transition transition);

  [[nodiscard]] size_t size() const { return transitions_.size(); }
  [[nodiscard]] size_t capacity() const { return capacity_; }
  /// Oldest first. @pre index < size()
  [[nodiscard]] const Transition& operator[](size_t index) const { return transitions_[index]; }

 private:
  size_t capacity_;
  std::deque<Transition> transitions_;
};

}  // namespace calibrato
