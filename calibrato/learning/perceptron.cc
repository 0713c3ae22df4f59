#include "calibrato/learning/perceptron.h"

#include <cmath>

namespace calibrato {

Perceptron::Perceptron(int num_inputs, int hidden_size, int num_outputs, Rng& rng) {
  constexpr double kLastLayer = 0.1;
  Eigen::Index size = 0;
  const Eigen::Index sizes[] = {num_inputs, hidden_size, hidden_size, num_outputs};
  for (int i = 0; i < 3; ++i) {
    layers_.push_back({sizes[i + 1], sizes[i], size});
    size += sizes[i + 1] * (sizes[i] + 1);
  }
  weights_.resize(size);
  for (const Layer& layer : layers_) {
    const bool is_last = &layer == &layers_.back();
    const double bound =
        (is_last ? kLastLayer : 1.0) / std::sqrt(static_cast<double>(layer.inputs));
    for (double& w : weights_.segment(layer.offset, layer.outputs * (layer.inputs + 1))) {
      w = rng.Uniform(-bound, bound);
    }
  }
  gradient_ = Eigen::VectorXd::Zero(size);
  first_moment_ = gradient_;
  second_moment_ = gradient_;
}

Eigen::Map<const Eigen::MatrixXd> Perceptron::Weight(const Layer& layer) const {
  return {weights_.data() + layer.offset, layer.outputs, layer.inputs};
}

Eigen::Map<const Eigen::VectorXd> Perceptron::Bias(const Layer& layer) const {
  return {weights_.data() + layer.offset + layer.outputs * layer.inputs, layer.outputs};
}

Eigen::MatrixXd Perceptron::Apply(const Layer& layer, const Eigen::MatrixXd& x) const {
  return (Weight(layer) * x).colwise() + Bias(layer);
}

Perceptron::Pass Perceptron::Forward(const Eigen::MatrixXd& input) const {
  Pass pass;
  pass.input = input;
  pass.first = Apply(layers_[0], input).cwiseMax(0.0);
  pass.second = Apply(layers_[1], pass.first).cwiseMax(0.0);
  pass.output = Apply(layers_[2], pass.second);
  return pass;
}

void Perceptron::AddGradient(const Layer& layer, const Eigen::MatrixXd& x,
                             const Eigen::MatrixXd& dy) {
  Eigen::Map<Eigen::MatrixXd> weight(gradient_.data() + layer.offset, layer.outputs, layer.inputs);
  weight += dy * x.transpose();
  gradient_.segment(layer.offset + layer.outputs * layer.inputs, layer.outputs) +=
      dy.rowwise().sum();
}

Eigen::MatrixXd Perceptron::Backward(const Pass& pass, const Eigen::MatrixXd& by_output) {
  const auto is_on = [](const Eigen::MatrixXd& hidden) {
    return (hidden.array() > 0.0).cast<double>().matrix().eval();
  };
  AddGradient(layers_[2], pass.second, by_output);
  const Eigen::MatrixXd by_second =
      (Weight(layers_[2]).transpose() * by_output).cwiseProduct(is_on(pass.second));
  AddGradient(layers_[1], pass.first, by_second);
  const Eigen::MatrixXd by_first =
      (Weight(layers_[1]).transpose() * by_second).cwiseProduct(is_on(pass.first));
  AddGradient(layers_[0], pass.input, by_first);
  return Weight(layers_[0]).transpose() * by_first;
}

Eigen::MatrixXd Perceptron::InputGradient(const Pass& pass,
                                          const Eigen::MatrixXd& by_output) const {
  const auto is_on = [](const Eigen::MatrixXd& hidden) {
    return (hidden.array() > 0.0).cast<double>().matrix().eval();
  };
  const Eigen::MatrixXd by_second =
      (Weight(layers_[2]).transpose() * by_output).cwiseProduct(is_on(pass.second));
  const Eigen::MatrixXd by_first =
      (Weight(layers_[1]).transpose() * by_second).cwiseProduct(is_on(pass.first));
  return Weight(layers_[0]).transpose() * by_first;
}

void Perceptron::Step(double learning_rate) {
  ++num_updates_;
  const auto t = static_cast<double>(num_updates_);
  first_moment_ = 0.9 * first_moment_ + 0.1 * gradient_;
  second_moment_ = 0.999 * second_moment_ + 0.001 * gradient_.cwiseAbs2();
  const double rate = learning_rate / (1.0 - std::pow(0.9, t));
  const double scale = 1.0 / (1.0 - std::pow(0.999, t));
  weights_.array() -=
      rate * first_moment_.array() / ((scale * second_moment_.array()).sqrt() + 1e-8);
  gradient_.setZero();
}

void Perceptron::MoveTowards(const Perceptron& other, double share) {
  weights_ += share * (other.weights_ - weights_);
}

void Perceptron::Write(ByteWriter& writer) const {
  writer.Write(weights_);
  writer.Write(first_moment_);
  writer.Write(second_moment_);
  writer.Write(num_updates_);
}

bool Perceptron::Read(ByteReader& reader) {
  Eigen::VectorXd weights = reader.ReadVector();
  Eigen::VectorXd first = reader.ReadVector();
  Eigen::VectorXd second = reader.ReadVector();
  const int64_t num_updates = reader.ReadInt();
  const Eigen::Index size = weights_.size();
  if (weights.size() != size || first.size() != size || second.size() != size) return false;
  weights_ = std::move(weights);
  first_moment_ = std::move(first);
  second_moment_ = std::move(second);
  num_updates_ = num_updates;
  return true;
}

}  // namespace calibrato
