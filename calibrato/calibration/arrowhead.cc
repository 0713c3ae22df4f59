#include "calibrato/calibration/arrowhead.h"

#include <Eigen/Cholesky>
#include <cassert>

namespace calibrato {

ArrowheadSystem::ArrowheadSystem(int num_blocks, int block_size, int border_size)
    : num_blocks_(num_blocks),
      block_size_(block_size),
      border_size_(border_size),
      panels_(Eigen::MatrixXd::Zero(local_size(), num_blocks * block_size)),
      corner_(Eigen::MatrixXd::Zero(border_size + 1, border_size + 1)) {
  assert(num_blocks >= 1 && block_size >= 1 && border_size >= 0);
}

void ArrowheadSystem::SetZero() {
  panels_.setZero();
  corner_.setZero();
}

void ArrowheadSystem::Add(int c, const Eigen::MatrixXd& local) {
  assert(c >= 0 && c + 1 < num_blocks_);
  assert(local.rows() == local_size() && local.cols() == local_size());
  const int b = block_size_;
  const int rest = border_size_ + 1;
  Panel(c) += local.leftCols(b);
  auto next = Panel(c + 1);
  next.topRows(b) += local.block(b, b, b, b);
  next.bottomRows(rest) += local.block(2 * b, b, rest, b);
  corner_ += local.bottomRightCorner(rest, rest);
}

void ArrowheadSystem::AddToBorder(const Eigen::MatrixXd& local) { corner_ += local; }

Eigen::VectorXd ArrowheadSystem::Gradient() const {
  Eigen::VectorXd gradient(num_unknowns());
  gradient << panels_.row(local_size() - 1).transpose(),
      corner_.row(border_size_).head(border_size_).transpose();
  return gradient;
}

Eigen::VectorXd ArrowheadSystem::Diagonal() const {
  Eigen::VectorXd diagonal(num_unknowns());
  for (int c = 0; c < num_blocks_; ++c) {
    diagonal.segment(c * block_size_, block_size_) = Panel(c).topRows(block_size_).diagonal();
  }
  diagonal.tail(border_size_) = corner_.diagonal().head(border_size_);
  return diagonal;
}

Eigen::MatrixXd ArrowheadSystem::BorderBlock() const {
  return corner_.topLeftCorner(border_size_, border_size_).selfadjointView<Eigen::Lower>();
}

Eigen::MatrixXd ArrowheadSystem::Dense() const {
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(num_unknowns(), num_unknowns());
  const int b = block_size_;
  for (int c = 0; c < num_blocks_; ++c) {
    lower.block(c * b, c * b, b, b) = Panel(c).topRows(b);
    if (c + 1 < num_blocks_) lower.block((c + 1) * b, c * b, b, b) = Panel(c).middleRows(b, b);
    lower.block(num_blocks_ * b, c * b, border_size_, b) = Panel(c).middleRows(2 * b, border_size_);
  }
  lower.bottomRightCorner(border_size_, border_size_) =
      corner_.topLeftCorner(border_size_, border_size_);
  return lower.selfadjointView<Eigen::Lower>();
}

std::optional<ArrowheadCholesky> ArrowheadCholesky::Factor(const ArrowheadSystem& system,
                                                           double damping) {
  ArrowheadCholesky cholesky(system);
  ArrowheadSystem& factor = cholesky.factor_;
  const int b = factor.block_size_;
  const int m = factor.border_size_;
  for (int c = 0; c < factor.num_blocks_; ++c) {
    factor.Panel(c).topRows(b).diagonal() += damping * system.Panel(c).topRows(b).diagonal();
  }
  factor.corner_.diagonal().head(m) *= 1.0 + damping;

  for (int c = 0; c < factor.num_blocks_; ++c) {
    auto panel = factor.Panel(c);
    Eigen::Ref<Eigen::MatrixXd> D = panel.topRows(b);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(D);
    if (llt.info() != Eigen::Success) return std::nullopt;
    const auto Lt = panel.topRows(b).transpose().triangularView<Eigen::Upper>();
    auto E = panel.bottomRows(m + 1);
    if (c + 1 < factor.num_blocks_) {
      auto below = panel.bottomRows(b + m + 1);
      Lt.solveInPlace<Eigen::OnTheRight>(below);
      auto next = factor.Panel(c + 1);
      next.topRows(b).selfadjointView<Eigen::Lower>().rankUpdate(panel.middleRows(b, b), -1.0);
      next.bottomRows(m + 1).noalias() -= E * panel.middleRows(b, b).transpose();
    } else {
      Lt.solveInPlace<Eigen::OnTheRight>(E);
    }
    factor.corner_.selfadjointView<Eigen::Lower>().rankUpdate(E, -1.0);
  }

  if (m > 0) {
    const Eigen::LLT<Eigen::MatrixXd> llt(factor.corner_.topLeftCorner(m, m));
    if (llt.info() != Eigen::Success) return std::nullopt;
    cholesky.corner_factor_ = llt.matrixLLT();
  }
  return cholesky;
}

Eigen::VectorXd ArrowheadCholesky::Step() const {
  const int b = factor_.block_size_;
  const int m = factor_.border_size_;
  const int n = factor_.num_blocks_;
  Eigen::VectorXd step(factor_.num_unknowns());
  auto border = step.tail(m);
  if (m > 0) {
    border = -factor_.corner_.row(m).head(m).transpose();
    corner_factor_.triangularView<Eigen::Lower>().solveInPlace(border);
    corner_factor_.transpose().triangularView<Eigen::Upper>().solveInPlace(border);
  }
  for (int c = n - 1; c >= 0; --c) {
    const auto panel = factor_.Panel(c);
    auto x = step.segment(c * b, b);
    x = -panel.row(2 * b + m).transpose();
    x.noalias() -= panel.middleRows(2 * b, m).transpose() * border;
    if (c + 1 < n) {
      x.noalias() -= panel.middleRows(b, b).transpose() * step.segment((c + 1) * b, b);
    }
    panel.topRows(b).transpose().triangularView<Eigen::Upper>().solveInPlace(x);
  }
  return step;
}

Eigen::MatrixXd ArrowheadCholesky::Solve(const Eigen::MatrixXd& right_sides) const {
  assert(right_sides.rows() == factor_.num_unknowns());
  const int b = factor_.block_size_;
  const int m = factor_.border_size_;
  const int n = factor_.num_blocks_;
  Eigen::MatrixXd solution = right_sides;
  auto border = solution.bottomRows(m);
  for (int c = 0; c < n; ++c) {
    const auto panel = factor_.Panel(c);
    auto x = solution.middleRows(c * b, b);
    panel.topRows(b).triangularView<Eigen::Lower>().solveInPlace(x);
    if (c + 1 < n) solution.middleRows((c + 1) * b, b).noalias() -= panel.middleRows(b, b) * x;
    border.noalias() -= panel.middleRows(2 * b, m) * x;
  }
  if (m > 0) {
    corner_factor_.triangularView<Eigen::Lower>().solveInPlace(border);
    corner_factor_.transpose().triangularView<Eigen::Upper>().solveInPlace(border);
  }
  for (int c = n - 1; c >= 0; --c) {
    const auto panel = factor_.Panel(c);
    auto x = solution.middleRows(c * b, b);
    x.noalias() -= panel.middleRows(2 * b, m).transpose() * border;
    if (c + 1 < n) {
      x.noalias() -= panel.middleRows(b, b).transpose() * solution.middleRows((c + 1) * b, b);
    }
    panel.topRows(b).transpose().triangularView<Eigen::Upper>().solveInPlace(x);
  }
  return solution;
}

Eigen::MatrixXd ArrowheadCholesky::BorderInformation() const {
  const int m = factor_.border_size_;
  return factor_.corner_.topLeftCorner(m, m).selfadjointView<Eigen::Lower>();
}

double ArrowheadCholesky::LogDeterminant() const {
  double sum = corner_factor_.diagonal().array().log().sum();
  for (int c = 0; c < factor_.num_blocks_; ++c) {
    sum += factor_.Panel(c).topRows(factor_.block_size_).diagonal().array().log().sum();
  }
  return 2.0 * sum;
}

}  // namespace calibrato
