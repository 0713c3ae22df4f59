#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/learning/byte_stream.h"

namespace calibrato {

/// A network of two hidden layers of rectified units, y = W3 relu(W2 relu(W1 x + b1) + b2) + b3, in
/// double precision, with its Adam optimiser.
class Perceptron {
 public:
  /// Weights uniform in +-1/sqrt(n), n the layer's inputs; those of the last layer a tenth of it.
  Perceptron(int num_inputs, int hidden_size, int num_outputs, Rng& rng);

  /// What Backward() needs of a pass.
  struct Pass {
    Eigen::MatrixXd input, first, second;  ///< One column a sample; hidden values after relu.
    Eigen::MatrixXd output;
  };
  [[nodiscard]] Pass Forward(const Eigen::MatrixXd& input) const;

  /// Adds the gradient by the weights to what Step() will follow.
  /// @param by_output  Derivative of a loss by the pass's output, one column a sample.
  /// @return ... by its input.
  Eigen::MatrixXd Backward(const Pass& pass, const Eigen::MatrixXd& by_output);
  /// The last alone: the weights' gradient stays as it is.
  [[nodiscard]] Eigen::MatrixXd InputGradient(const Pass& pass,
                                              const Eigen::MatrixXd& by_output) const;

  /// One Adam step down the gradients, which are then cleared.
  void Step(double learning_rate);

  /// weights <- (1 - share) weights + share of the other's.
  void MoveTowards(const Perceptron& other, double share);

  /// All weights in one piece: W1, b1, W2, b2, W3, b3, each by columns.
  [[nodiscard]] const Eigen::VectorXd& weights() const { return weights_; }
  [[nodiscard]] Eigen::VectorXd& mutable_weights() { return weights_; }
  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }

  void Write(ByteWriter& writer) const;
  /// @return False if they are those of another size: nothing was changed.
  [[nodiscard]] bool Read(ByteReader& reader);

 private:
  struct Layer {
    Eigen::Index outputs, inputs, offset;
  };
  [[nodiscard]] Eigen::Map<const Eigen::MatrixXd> Weight(const Layer& layer) const;
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> Bias(const Layer& layer) const;
  [[nodiscard]] Eigen::MatrixXd Apply(const Layer& layer, const Eigen::MatrixXd& x) const;
  void AddGradient(const Layer& layer, const Eigen::MatrixXd& x, const Eigen::MatrixXd& dy);

  std::vector<Layer> layers_;
  Eigen::VectorXd weights_, gradient_, first_moment_, second_moment_;
  int64_t num_updates_ = 0;
};

}  // namespace calibrato
