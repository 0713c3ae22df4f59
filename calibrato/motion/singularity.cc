#include "calibrato/motion/singularity.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace calibrato {

double SingularityDistance(const JointVector& q) {
  JointJacobian J;
  (void)PandaPose(q, &J);
  const Eigen::Matrix<double, 6, 6> squared = J * J.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(squared,
                                                                          Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
}

std::string SingularPart(const JointVector& q) {
  const auto near_half_turn = [](double angle) { return std::abs(std::sin(angle)); };
  const std::array<std::pair<double, const char*>, 3> parts = {
      {{near_half_turn(q[3] - StretchedElbow()), "elbow"},
       {near_half_turn(q[5]), "wrist"},
       {near_half_turn(q[1]), "shoulder"}}};
  return std::ranges::min_element(parts)->second;
}

}  // namespace calibrato
