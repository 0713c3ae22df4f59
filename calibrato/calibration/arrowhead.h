#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace calibrato {

/// Normal equations H x = -g of a problem that is long in time: a chain of blocks, each coupled to
/// the next one only, and a border coupled to all of them,
///
///         | D_0  L_0'           E_0' |        x_c: unknowns of block c (block_size of them)
///     H = | L_0  D_1  L_1'      E_1' |        y:   unknowns of the border (border_size)
///         |      L_1  D_2  ..   E_2' |
///         | E_0  E_1  E_2  ..   C    |
///
/// as from a spline cut into blocks of control points, with the calibration as its border. What
/// does not couple is not stored: memory is linear in the number of blocks.
class ArrowheadSystem {
 public:
  /// @pre num_blocks >= 1, block_size >= 1, border_size >= 0
  ArrowheadSystem(int num_blocks, int block_size, int border_size);

  int num_blocks() const { return num_blocks_; }
  int block_size() const { return block_size_; }
  int border_size() const { return border_size_; }
  int num_unknowns() const { return num_blocks_ * block_size_ + border_size_; }

  void SetZero();

  /// Columns of a local matrix, in order: block c, block c + 1, border, residual.
  int local_size() const { return 2 * block_size_ + border_size_ + 1; }
  /// Adds J'J, with J the rows [J_c, J_{c+1}, J_border, residual] of measurements that see blocks c
  /// and c + 1 and the border; only its lower triangle is read. @pre c + 1 < num_blocks
  void Add(int c, const Eigen::MatrixXd& local);
  /// Adds [J_border, residual]'[..] alone, border_size + 1 square.
  void AddToBorder(const Eigen::MatrixXd& local);

  /// The sum of squared residuals.
  double squared_error() const { return corner_(border_size_, border_size_); }
  /// g: blocks in order, then the border.
  Eigen::VectorXd Gradient() const;
  Eigen::VectorXd Diagonal() const;
  /// C: the border's own part of H.
  Eigen::MatrixXd BorderBlock() const;
  /// All of H, for small problems.
  Eigen::MatrixXd Dense() const;

 private:
  friend class ArrowheadCholesky;
  // Below the columns of block c stand D_c, L_c, E_c and g_c' (gradients are one more border row).
  auto Panel(int c) { return panels_.middleCols(c * block_size_, block_size_); }
  auto Panel(int c) const { return panels_.middleCols(c * block_size_, block_size_); }

  int num_blocks_;
  int block_size_;
  int border_size_;
  Eigen::MatrixXd panels_;
  Eigen::MatrixXd corner_;  // C, and below it the border's gradient and the squared error
};

/// The Cholesky factor of H + damping * diag(H), block by block: time linear in the number of
/// blocks, the same to the bit for any number of threads.
class ArrowheadCholesky {
 public:
  /// Nothing where the matrix is not positive definite. @param damping  >= 0.
  [[nodiscard]] static std::optional<ArrowheadCholesky> Factor(const ArrowheadSystem& system,
                                                               double damping);

  /// x = -(H + damping diag H)^-1 g.
  [[nodiscard]] Eigen::VectorXd Step() const;

  /// (H + damping diag H)^-1 b for each column b: blocks in order, then the border.
  [[nodiscard]] Eigen::MatrixXd Solve(const Eigen::MatrixXd& right_sides) const;

  /// What the data know about the border where the blocks are unknown: the Schur complement
  /// C - sum of E D^-1 E', whose inverse is the marginal covariance of the border.
  [[nodiscard]] Eigen::MatrixXd BorderInformation() const;

  /// log det of the matrix.
  [[nodiscard]] double LogDeterminant() const;

 private:
  explicit ArrowheadCholesky(ArrowheadSystem factor) : factor_(std::move(factor)) {}
  ArrowheadSystem factor_;         // Panels hold the factor, the corner the Schur complement
  Eigen::MatrixXd corner_factor_;  // Cholesky factor of the Schur complement
};

}  // namespace calibrato
