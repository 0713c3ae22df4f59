#include "calibrato/calibration/comparison.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <optional>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/calibration/pixel_derivatives.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A direction that both cameras see: the pixel in the first, and the ray through it.
struct Direction {
  Eigen::Index row;
  Eigen::Index column;
  Eigen::Vector2d pixel;
  Eigen::Vector3d ray;
};

std::vector<Direction> SharedDirections(const CameraEstimate& first, const CameraEstimate& second) {
  std::vector<Direction> directions;
  for (Eigen::Index row = 0; row < kImageMapRows; ++row) {
    for (Eigen::Index column = 0; column < kImageMapColumns; ++column) {
      const Eigen::Vector2d pixel = ImageMapPixel(first.resolution, row, column);
      const auto ray = first.model.Unproject(pixel);
      if (!ray || !second.model.Project(*ray)) continue;
      directions.push_back({row, column, pixel, ray->normalized()});
    }
  }
  return directions;
}

// Differences second - first of the directions, and their derivatives by the turn (3) and by both
// cameras' parameters (first's: of the pixel at which it sees the ray).
struct Linearised {
  Eigen::VectorXd difference;
  Eigen::MatrixX3d by_rotation;
  Eigen::MatrixXd by_first;
  Eigen::MatrixXd by_second;
};

// Nothing where a direction leaves the second lens's domain.
std::optional<Linearised> Linearise(const CameraEstimate& first, const CameraEstimate& second,
                                    const std::vector<Direction>& directions,
                                    const Eigen::Matrix3d& R) {
  const auto n = static_cast<Eigen::Index>(directions.size());
  Linearised result{Eigen::VectorXd(2 * n), Eigen::MatrixX3d(2 * n, 3),
                    Eigen::MatrixXd(2 * n, first.model.num_parameters()),
                    Eigen::MatrixXd(2 * n, second.model.num_parameters())};
  for (Eigen::Index k = 0; k < n; ++k) {
    const Direction& direction = directions[static_cast<size_t>(k)];
    const Eigen::Vector3d turned = R * direction.ray;
    const auto in_first = ProjectWithDerivatives(first.model, direction.ray);
    const auto in_second = ProjectWithDerivatives(second.model, turned);
    if (!in_first || !in_second) return std::nullopt;
    result.difference.segment<2>(2 * k) = in_second->pixel - direction.pixel;
    result.by_rotation.middleRows<2>(2 * k) = -in_second->by_point * Hat(turned);
    result.by_first.middleRows<2>(2 * k) = -in_first->by_parameters;
    result.by_second.middleRows<2>(2 * k) = in_second->by_parameters;
  }
  return result;
}

// Directions near the edge of the second lens's domain may leave it as the camera is turned: they
// are taken out beforehand.
constexpr double kLargestTurn = 0.05;  // [rad]

bool SeesAround(const CameraModel& model, const Eigen::Vector3d& ray) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      if (!model.Project(ExpSo3(sign * kLargestTurn * Eigen::Vector3d::Unit(axis)) * ray)) {
        return false;
      }
    }
  }
  return true;
}

// The turn with the least sum of squared differences, by Gauss-Newton.
Eigen::Matrix3d FitTurn(const CameraEstimate& first, const CameraEstimate& second,
                        const std::vector<Direction>& directions) {
  constexpr int kMaxIterations = 20;
  constexpr double kSmallStep = 1e-12;  // [rad]
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  for (int i = 0; i < kMaxIterations; ++i) {
    const auto linearised = Linearise(first, second, directions, R);
    if (!linearised) break;
    const Eigen::MatrixX3d& J = linearised->by_rotation;
    const Eigen::Vector3d step =
        -(J.transpose() * J).ldlt().solve(J.transpose() * linearised->difference);
    const Eigen::Matrix3d next = ExpSo3(step) * R;
    if (LogSo3(next).norm() > kLargestTurn) break;
    R = next;
    if (step.norm() < kSmallStep) break;
  }
  return R;
}

bool SameParametersHeld(const CameraEstimate& first, const CameraEstimate& second) {
  if (first.model.name() != second.model.name()) return false;
  const Eigen::VectorXd a = first.covariance.diagonal();
  const Eigen::VectorXd b = second.covariance.diagonal();
  const Eigen::VectorXd difference = second.model.parameters() - first.model.parameters();
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    // Held in both, at the same value, or free in both.
    if ((a(i) > 0.0) != (b(i) > 0.0) || (a(i) == 0.0 && difference(i) != 0.0)) return false;
  }
  return true;
}

// Of the sum of squared differences d'd with covariance C: a weighted sum of chi-square variables
// whose weights are C's eigenvalues, taken for a multiple of one (Satterthwaite 1946).
Significance SignificanceOfSum(double sum_of_squares, const Eigen::MatrixXd& root) {
  // C = root root': its non-zero eigenvalues are those of root' root.
  const Eigen::MatrixXd gram = root.transpose() * root;
  const double trace = gram.trace();
  const double trace_of_square = gram.squaredNorm();
  if (!(trace_of_square > 0.0)) return {};
  Significance significance;
  significance.degrees = trace * trace / trace_of_square;
  significance.statistic = sum_of_squares * trace / trace_of_square;
  significance.probability = ChiSquareTail(significance.statistic, significance.degrees);
  return significance;
}

// Least squares in the metric of the covariance, along the direction in which both focal lengths
// grow alike; nothing where one of them was held.
FocalChange FocalChangeOf(const CameraEstimate& first, const Eigen::VectorXd& difference,
                          const Eigen::MatrixXd& covariance) {
  const Eigen::Index focal = CameraModel::FocalIndex(first.model.name());
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(difference.size());
  direction.segment<2>(focal) = first.model.parameters().segment<2>(focal);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < difference.size(); ++i) {
    if (covariance(i, i) > 0.0) free.push_back(i);
  }
  if (!(covariance(focal, focal) > 0.0) || !(covariance(focal + 1, focal + 1) > 0.0)) return {};
  const Eigen::VectorXd scale = covariance.diagonal()(free).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation =
      scale.asDiagonal() * covariance(free, free) * scale.asDiagonal();
  const Eigen::VectorXd along = scale.cwiseProduct(direction(free));
  const Eigen::VectorXd weighted = correlation.ldlt().solve(along);
  const double information = along.dot(weighted);
  FocalChange change;
  change.relative = weighted.dot(scale.cwiseProduct(difference(free))) / information;
  change.sigma = 1.0 / std::sqrt(information);
  change.significance.degrees = 1.0;
  change.significance.statistic = std::pow(change.relative / change.sigma, 2);
  change.significance.probability = ChiSquareTail(change.significance.statistic, 1.0);
  return change;
}

// A root L with C = L L'.
Eigen::MatrixXd RootOf(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

Significance SignificanceOf(const Eigen::VectorXd& difference,
                            const Eigen::MatrixXd& covariance_of_difference) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < difference.size(); ++i) {
    if (covariance_of_difference(i, i) > 0.0) free.push_back(i);
  }
  if (free.empty()) return {};
  const Eigen::VectorXd scale =
      covariance_of_difference.diagonal()(free).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation =
      scale.asDiagonal() * covariance_of_difference(free, free) * scale.asDiagonal();
  const Eigen::VectorXd scaled = scale.cwiseProduct(difference(free));
  Significance significance;
  significance.degrees = static_cast<double>(free.size());
  significance.statistic = scaled.dot(correlation.ldlt().solve(scaled));
  significance.probability = ChiSquareTail(significance.statistic, significance.degrees);
  return significance;
}

CameraComparison CompareCameras(const CameraEstimate& first, const CameraEstimate& second) {
  if (!(first.resolution == second.resolution)) {
    const auto text = [](Resolution r) {
      return std::to_string(r.width) + "x" + std::to_string(r.height);
    };
    throw InputError({"the images differ in size", "",
                      text(first.resolution) + " and " + text(second.resolution),
                      "compare results of one camera at one resolution"});
  }
  std::vector<Direction> directions = SharedDirections(first, second);
  std::erase_if(directions, [&](const Direction& direction) {
    return !SeesAround(second.model, direction.ray);
  });
  constexpr size_t kFewest = 6;
  if (directions.size() < kFewest) {
    throw InputError({"the two cameras see nothing in common", "",
                      "hardly a direction is seen by both lenses",
                      "check that both results are of the same camera"});
  }

  CameraComparison comparison;
  const Eigen::Matrix3d R = FitTurn(first, second, directions);
  comparison.rotation = LogSo3(R);
  comparison.difference_px = MapOverImage(first.resolution, [&](const Eigen::Vector2d& pixel) {
    const auto ray = first.model.Unproject(pixel);
    if (!ray) return kNan;
    const auto other = second.model.Project(R * *ray);
    return other ? (*other - pixel).norm() : kNan;
  });
  const auto linearised = Linearise(first, second, directions, R);
  if (!linearised) return comparison;
  const auto num_directions = static_cast<double>(directions.size());
  const double sum_of_squares = linearised->difference.squaredNorm();
  comparison.rms_px = std::sqrt(sum_of_squares / num_directions);
  if (first.covariance.size() == 0 || second.covariance.size() == 0) return comparison;

  // The turn is fitted to the noise as well: what it takes up is projected out.
  const Eigen::MatrixX3d& J = linearised->by_rotation;
  Eigen::MatrixXd root(J.rows(), linearised->by_first.cols() + linearised->by_second.cols());
  root << linearised->by_first * RootOf(first.covariance),
      linearised->by_second * RootOf(second.covariance);
  root -= J * (J.transpose() * J).ldlt().solve(J.transpose() * root);
  comparison.expected_rms_px = std::sqrt(root.squaredNorm() / num_directions);
  comparison.by_parameters = SameParametersHeld(first, second);
  comparison.significance =
      comparison.by_parameters
          ? SignificanceOf(second.model.parameters() - first.model.parameters(),
                           first.covariance + second.covariance)
          : SignificanceOfSum(sum_of_squares, root);
  if (comparison.by_parameters) {
    comparison.focal_change =
        FocalChangeOf(first, second.model.parameters() - first.model.parameters(),
                      first.covariance + second.covariance);
  }
  return comparison;
}

PoseComparison ComparePoses(const Rigid3& first, const Eigen::MatrixXd& first_covariance,
                            const Rigid3& second, const Eigen::MatrixXd& second_covariance) {
  const Eigen::Matrix<double, 6, 1> difference = second.DifferenceTo(first);
  PoseComparison comparison{difference.head<3>().norm(), difference.tail<3>().norm(), {}};
  if (first_covariance.size() != 0 && second_covariance.size() != 0) {
    comparison.significance = SignificanceOf(difference, first_covariance + second_covariance);
  }
  return comparison;
}

}  // namespace calibrato
