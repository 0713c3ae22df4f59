#include "calibrato/learning/recurrent_network.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace calibrato {
namespace {

using torch::Tensor;
using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const RowMajor> AsEigen(const Tensor& tensor) {
  assert(tensor.is_contiguous() && tensor.dim() == 2);
  return {tensor.data_ptr<float>(), tensor.size(0), tensor.size(1)};
}

Eigen::Map<RowMajor> AsMutableEigen(Tensor& tensor) {
  return {tensor.data_ptr<float>(), tensor.size(0), tensor.size(1)};
}

Eigen::Map<const Eigen::RowVectorXf> AsEigenRow(const Tensor& tensor) {
  return {tensor.data_ptr<float>(), tensor.numel()};
}

Eigen::Map<Eigen::RowVectorXf> AsMutableEigenRow(Tensor& tensor) {
  return {tensor.data_ptr<float>(), tensor.numel()};
}

// Products are Eigen's: torch would hand them to whatever BLAS the system has, with other last bits
// for each, and with Debian's default one at a fraction of the speed. The gradients of the weights
// are added where they belong at once; as tensors of their own they would cost more than their
// products.
class DenseFunction : public torch::autograd::Function<DenseFunction> {
 public:
  static Tensor forward(torch::autograd::AutogradContext* context, const Tensor& x,
                        const Tensor& weight, const Tensor& bias, const Tensor& weight_gradient,
                        const Tensor& bias_gradient) {
    const Tensor input = x.contiguous();
    context->save_for_backward({input, weight, weight_gradient, bias_gradient});
    Tensor y = torch::empty({input.size(0), weight.size(0)});
    auto result = AsMutableEigen(y);
    result.noalias() = AsEigen(input) * AsEigen(weight).transpose();
    result.rowwise() += AsEigenRow(bias);
    return y;
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 const torch::autograd::variable_list& outer) {
    const torch::autograd::variable_list saved = context->get_saved_variables();
    const Tensor dy = outer[0].contiguous();
    Tensor dx;
    if (context->needs_input_grad(0)) {
      dx = torch::empty_like(saved[0]);
      AsMutableEigen(dx).noalias() = AsEigen(dy) * AsEigen(saved[1]);
    }
    if (context->needs_input_grad(1)) {
      Tensor weight_gradient = saved[2];
      Tensor bias_gradient = saved[3];
      AsMutableEigen(weight_gradient).noalias() += AsEigen(dy).transpose() * AsEigen(saved[0]);
      AsMutableEigenRow(bias_gradient) += AsEigen(dy).colwise().sum();
    }
    return {dx, Tensor(), Tensor(), Tensor(), Tensor()};
  }
};

Tensor Apply(const RecurrentNetwork::Dense& layer, const Tensor& x) {
  return DenseFunction::apply(x, layer.weight, layer.bias, layer.weight_gradient,
                              layer.bias_gradient);
}

// The gates of a GRU (Cho et al., EMNLP 2014, with the reset gate after the recurrent product).
// @param from_input, from_hidden  Rows of [reset, update, new] before their nonlinearity.
Tensor Gated(const Tensor& from_input, const Tensor& from_hidden, const Tensor& hidden) {
  const int64_t n = hidden.size(1);
  const Tensor gates =
      torch::sigmoid(from_input.narrow(1, 0, 2 * n) + from_hidden.narrow(1, 0, 2 * n));
  const Tensor reset = gates.narrow(1, 0, n);
  const Tensor update = gates.narrow(1, n, n);
  const Tensor candidate =
      torch::tanh(from_input.narrow(1, 2 * n, n) + reset * from_hidden.narrow(1, 2 * n, n));
  return candidate + update * (hidden - candidate);
}

}  // namespace

RecurrentNetwork::RecurrentNetwork(int pair_size, int action_size, int hidden_size, int output_size,
                                   Rng& rng) {
  struct Shape {
    Dense Layers::*layer;
    int64_t outputs;
    int64_t inputs;
    int64_t fan_in;
  };
  const int64_t n = hidden_size;
  const std::array<Shape, 5> shapes = {{{&Layers::input, 3 * n, pair_size, n},
                                        {&Layers::recurrent, 3 * n, n, n},
                                        {&Layers::action, n, action_size, action_size},
                                        {&Layers::joint, n, 2 * n, 2 * n},
                                        {&Layers::output, output_size, n, n}}};
  int64_t num_weights = 0;
  for (const Shape& shape : shapes) num_weights += shape.outputs * (shape.inputs + 1);
  numbers_.weights.reserve(static_cast<size_t>(num_weights));
  for (const Shape& shape : shapes) {
    const double bound = 1.0 / std::sqrt(static_cast<double>(shape.fan_in));
    for (int64_t i = 0; i < shape.outputs * (shape.inputs + 1); ++i) {
      numbers_.weights.push_back(static_cast<float>(rng.Uniform(-bound, bound)));
    }
  }
  numbers_.first_moment.assign(numbers_.weights.size(), 0.0F);
  numbers_.second_moment.assign(numbers_.weights.size(), 0.0F);
  gradient_.assign(numbers_.weights.size(), 0.0F);

  int64_t offset = 0;
  for (const Shape& shape : shapes) {
    const auto view = [&](std::vector<float>& numbers, int64_t start, bool is_weight) {
      float* const first = numbers.data() + start;
      return is_weight ? torch::from_blob(first, {shape.outputs, shape.inputs})
                       : torch::from_blob(first, {shape.outputs});
    };
    const int64_t bias = offset + shape.outputs * shape.inputs;
    fixed_.*shape.layer = {view(numbers_.weights, offset, true),
                           view(numbers_.weights, bias, false), view(gradient_, offset, true),
                           view(gradient_, bias, false)};
    trained_.*shape.layer = {view(numbers_.weights, offset, true).set_requires_grad(true),
                             view(numbers_.weights, bias, false).set_requires_grad(true),
                             view(gradient_, offset, true), view(gradient_, bias, false)};
    // Where a bias enters without a product, autograd adds its gradient to the same memory.
    Dense& trained = trained_.*shape.layer;
    trained.bias.mutable_grad() = trained.bias_gradient;
    offset = bias + shape.outputs;
  }
}

Tensor RecurrentNetwork::Encode(const Layers& layers, const SequenceBatch& batch) {
  const int64_t n = layers.recurrent.weight.size(1);
  if (batch.pairs.size(0) == 0) return torch::zeros({batch.num_sequences, n});
  const Tensor from_input = Apply(layers.input, batch.pairs);
  Tensor hidden = torch::zeros({0, n});
  int64_t first_row = 0;
  for (const int64_t num_active : batch.num_active) {
    const int64_t num_new = num_active - hidden.size(0);
    assert(num_new >= 0);
    // A sequence that begins has state 0, and its product with the recurrent weights costs nothing.
    std::vector<Tensor> from_hidden;
    if (hidden.size(0) > 0) {
      from_hidden.push_back(Apply(layers.recurrent, hidden));
    }
    if (num_new > 0) {
      from_hidden.push_back(layers.recurrent.bias.expand({num_new, 3 * n}));
      hidden = torch::cat({hidden, torch::zeros({num_new, n})});
    }
    hidden = Gated(from_input.narrow(0, first_row, num_active), torch::cat(from_hidden), hidden);
    first_row += num_active;
  }
  assert(first_row == batch.pairs.size(0));
  const int64_t num_empty = batch.num_sequences - hidden.size(0);
  return num_empty == 0 ? hidden : torch::cat({hidden, torch::zeros({num_empty, n})});
}

Tensor RecurrentNetwork::Advance(const Layers& layers, const Tensor& pair, const Tensor& hidden) {
  return Gated(Apply(layers.input, pair), Apply(layers.recurrent, hidden), hidden);
}

Tensor RecurrentNetwork::Output(const Layers& layers, const Tensor& hidden, const Tensor& action) {
  const Tensor features = Apply(layers.action, action);
  const Tensor joint = torch::relu(Apply(layers.joint, torch::cat({hidden, features}, 1)));
  return Apply(layers.output, joint);
}

void RecurrentNetwork::Step(double learning_rate) {
  constexpr float kDecay1 = 0.9F;
  constexpr float kDecay2 = 0.999F;
  constexpr float kEpsilon = 1e-8F;
  ++numbers_.num_updates;
  const auto t = static_cast<double>(numbers_.num_updates);
  const auto rate = static_cast<float>(learning_rate / (1.0 - std::pow(0.9, t)));
  const auto scale2 = static_cast<float>(1.0 / (1.0 - std::pow(0.999, t)));
  const auto size = static_cast<Eigen::Index>(numbers_.weights.size());
  Eigen::Map<Eigen::ArrayXf> weights(numbers_.weights.data(), size);
  Eigen::Map<Eigen::ArrayXf> first(numbers_.first_moment.data(), size);
  Eigen::Map<Eigen::ArrayXf> second(numbers_.second_moment.data(), size);
  Eigen::Map<Eigen::ArrayXf> gradient(gradient_.data(), size);
  // In pieces that stay in the cache over the three passes.
  constexpr Eigen::Index kPiece = 4096;
  for (Eigen::Index i = 0; i < size; i += kPiece) {
    const Eigen::Index n = std::min(kPiece, size - i);
    const auto g = gradient.segment(i, n);
    auto m = first.segment(i, n);
    auto v = second.segment(i, n);
    m = kDecay1 * m + (1.0F - kDecay1) * g;
    v = kDecay2 * v + (1.0F - kDecay2) * g.square();
    weights.segment(i, n) -= rate * m / ((scale2 * v).sqrt() + kEpsilon);
  }
  gradient.setZero();
}

void RecurrentNetwork::Restore(const NetworkWeights& numbers) {
  assert(numbers.weights.size() == size());
  // Copied into place: the layers share this memory.
  std::copy(numbers.weights.begin(), numbers.weights.end(), numbers_.weights.begin());
  const auto restore_moment = [](const std::vector<float>& from, std::vector<float>& to) {
    if (from.empty()) {
      std::fill(to.begin(), to.end(), 0.0F);
    } else {
      assert(from.size() == to.size());
      std::copy(from.begin(), from.end(), to.begin());
    }
  };
  restore_moment(numbers.first_moment, numbers_.first_moment);
  restore_moment(numbers.second_moment, numbers_.second_moment);
  numbers_.num_updates = numbers.num_updates;
}

}  // namespace calibrato
