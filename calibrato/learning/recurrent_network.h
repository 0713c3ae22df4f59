#pragma once

// Private to the room: the one header that shows libtorch.
#include <torch/torch.h>

#include <cstdint>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/learning/networks.h"

namespace calibrato {

/// Sequences of different lengths for one pass through the recurrent layer, the longest first, and
/// aligned at their ends: at pair s all sequences that have begun are the first rows.
struct SequenceBatch {
  int64_t num_sequences = 0;        ///< Those without any pair, the last ones, included.
  std::vector<int64_t> num_active;  ///< How many sequences have begun at pair s; never falls.
  torch::Tensor pairs;  ///< Pair 0 of the active sequences, then pair 1 of those active then, ..
};

/// One of the two networks of the paper's Figure 2, with its optimiser. All weights stand in one
/// piece of memory, so that they are saved and stepped as one.
class RecurrentNetwork {
 public:
  RecurrentNetwork(int pair_size, int action_size, int hidden_size, int output_size, Rng& rng);
  RecurrentNetwork(const RecurrentNetwork&) = delete;
  RecurrentNetwork& operator=(const RecurrentNetwork&) = delete;

  /// y = x weight^T + bias. The gradient of what is trained is added up beside it.
  struct Dense {
    torch::Tensor weight, bias;
    torch::Tensor weight_gradient, bias_gradient;
  };
  /// The layers as tensors that share the network's memory.
  struct Layers {
    Dense input;      // pair -> 3H: reset, update and new gate
    Dense recurrent;  // H -> 3H
    Dense action;     // action -> H
    Dense joint;      // [hidden, action], 2H -> H
    Dense output;     // H -> outputs
  };
  /// With gradients, for training.
  [[nodiscard]] const Layers& trained() const { return trained_; }
  /// Without: gradients by the inputs cost no gradients by the weights.
  [[nodiscard]] const Layers& fixed() const { return fixed_; }

  /// The state after each sequence's last pair, one row each, in the batch's order.
  static torch::Tensor Encode(const Layers& layers, const SequenceBatch& batch);
  /// The state after one more pair.
  static torch::Tensor Advance(const Layers& layers, const torch::Tensor& pair,
                               const torch::Tensor& hidden);
  static torch::Tensor Output(const Layers& layers, const torch::Tensor& hidden,
                              const torch::Tensor& action);

  /// One Adam step (Kingma and Ba, ICLR 2015) down the gradients, which are then cleared.
  void Step(double learning_rate);

  [[nodiscard]] size_t size() const { return numbers_.weights.size(); }
  [[nodiscard]] const NetworkWeights& numbers() const { return numbers_; }
  void Restore(const NetworkWeights& numbers);

 private:
  NetworkWeights numbers_;
  std::vector<float> gradient_;
  Layers trained_;
  Layers fixed_;
};

}  // namespace calibrato
