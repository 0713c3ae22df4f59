#include "calibrato/detection/lens_map.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrato/detection/homography.h"

namespace calibrato {
namespace {

constexpr int kMaxIterations = 50;
constexpr int kMaxNewtonSteps = 20;
// What is expected of a lens before it has been seen, against residuals of this size.
constexpr double kExpectedResidual = 0.1;    // [px]
constexpr double kExpectedDecentring = 0.1;  // of the scale
const Eigen::Vector4d kExpectedBend(1.0, 0.3, 0.1, 0.1);

// The board shifted and scaled to about -1 .. 1.
struct Normalisation {
  Eigen::Vector2d middle;
  double size;

  explicit Normalisation(const Eigen::Matrix2Xd& board)
      : middle(board.rowwise().mean()), size((board.colwise() - middle).cwiseAbs().maxCoeff()) {}
  Eigen::Matrix2Xd operator()(const Eigen::Matrix2Xd& board) const {
    return (board.colwise() - middle) / size;
  }
  Eigen::Matrix3d Matrix() const {
    Eigen::Matrix3d N;
    N << 1.0 / size, 0.0, -middle.x() / size, 0.0, 1.0 / size, -middle.y() / size, 0.0, 0.0, 1.0;
    return N;
  }
};

// g and its derivatives at t.
struct Bend {
  double value;
  double first;
  double second;

  Bend(const Eigen::Vector4d& g, double t)
      : value(1.0 + t * (g(0) + t * (g(1) + t * (g(2) + t * g(3))))),
        first(g(0) + t * (2.0 * g(1) + t * (3.0 * g(2) + t * 4.0 * g(3)))),
        second(2.0 * g(1) + t * (6.0 * g(2) + t * 12.0 * g(3))) {}
};

// Where the ray h meets the image: s of LensMap, by Newton's steps from `start`.
struct Meeting {
  double s;
  double slope;  // of s h_z - g(s^2 q) by s: positive as long as the image grows outwards
};

std::optional<Meeting> Meet(const Eigen::Vector3d& h, const Eigen::Vector4d& g, double start) {
  const double q = h.head<2>().squaredNorm();
  double s = start;
  for (int i = 0; i < kMaxNewtonSteps; ++i) {
    const Bend bend(g, s * s * q);
    const double slope = h.z() - 2.0 * s * q * bend.first;
    if (!(slope > 0.0)) return std::nullopt;
    const double step = (bend.value - s * h.z()) / slope;
    s += step;
    if (!(s > 0.0)) return std::nullopt;
    if (std::abs(step) < 1e-12 * s) return Meeting{s, slope};
  }
  return std::nullopt;
}

// s where the pixel is about known.
double StartFor(const Eigen::Vector3d& h, const Eigen::Vector2d& offset) {
  const double length = h.head<2>().norm();
  return length > 1e-9 ? offset.norm() / length : 1.0 / h.z();
}

constexpr int kNumParameters = 15;  // H row by row, g, centre
using Parameters = Eigen::Matrix<double, kNumParameters, 1>;
using NormalMatrix = Eigen::Matrix<double, kNumParameters, kNumParameters>;

// In normalised coordinates, where the image's middle is the origin and the scale is 1.
struct Problem {
  Eigen::Matrix2Xd board;
  Eigen::Matrix2Xd pixels;
  Parameters weights = Parameters::Zero();  // of the square of each parameter
  double radius = 0.0;                      // of discs
};

Eigen::Matrix3d H_Of(const Parameters& x) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(x.data());
}

// By how much the centroid of a disc is beside its centre; nothing where the lens does not see it.
std::optional<Eigen::Vector2d> CentroidOffset(const Problem& problem, const Parameters& x,
                                              Eigen::Index k) {
  const LensMap lens{H_Of(x), x.tail<2>(), 1.0, x.segment<4>(9)};
  const std::optional<LocalMap> map = lens.Around(problem.board.col(k), problem.pixels.col(k));
  if (!map) return std::nullopt;
  return map->CentroidOffset(problem.radius);
}

// Its derivatives, by differences: they are so small beside those of the centre itself, and so
// smooth, that this does for Gauss-Newton.
Eigen::Matrix<double, 2, kNumParameters> OffsetDerivatives(const Problem& problem,
                                                           const Parameters& x, Eigen::Index k,
                                                           const Eigen::Vector2d& offset) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix<double, 2, kNumParameters> J;
  for (int i = 0; i < kNumParameters; ++i) {
    Parameters moved = x;
    moved(i) += kStep;
    J.col(i) = (CentroidOffset(problem, moved, k).value_or(offset) - offset) / kStep;
  }
  return J;
}

// The sum of squares, and if asked for its gradient and Gauss-Newton's Hessian (both halved);
// infinite where the lens does not see a point.
double CostOf(const Problem& problem, const Parameters& x, Parameters* gradient,
              NormalMatrix* hessian) {
  const Eigen::Matrix3d H = H_Of(x);
  const Eigen::Vector4d g = x.segment<4>(9);
  const Eigen::Vector2d centre = x.tail<2>();
  double cost = x.dot(problem.weights.cwiseProduct(x));
  if (gradient) {
    *gradient = problem.weights.cwiseProduct(x);
    *hessian = problem.weights.asDiagonal();
  }
  for (Eigen::Index k = 0; k < problem.board.cols(); ++k) {
    const Eigen::Vector3d position = problem.board.col(k).homogeneous();
    const Eigen::Vector2d offset = problem.pixels.col(k) - centre;
    const Eigen::Vector3d h = H * position;
    const std::optional<Meeting> meeting = Meet(h, g, StartFor(h, offset));
    if (!meeting) return std::numeric_limits<double>::infinity();
    const double s = meeting->s;
    Eigen::Vector2d residual = s * h.head<2>() - offset;
    std::optional<Eigen::Vector2d> beside(Eigen::Vector2d::Zero());
    if (problem.radius > 0.0) beside = CentroidOffset(problem, x, k);
    if (!beside) return std::numeric_limits<double>::infinity();
    residual += *beside;
    cost += residual.squaredNorm();
    if (!gradient) continue;
    const double t = s * s * h.head<2>().squaredNorm();
    const Bend bend(g, t);
    Eigen::Matrix<double, 2, 3> by_h = Eigen::Matrix<double, 2, 3>::Zero();
    by_h.leftCols<2>() = s * Eigen::Matrix2d::Identity();
    const Eigen::RowVector3d s_by_h =
        Eigen::RowVector3d(2.0 * s * s * bend.first * h.x(), 2.0 * s * s * bend.first * h.y(), -s) /
        meeting->slope;
    by_h += h.head<2>() * s_by_h;
    Eigen::Matrix<double, 2, kNumParameters> J;
    for (int row = 0; row < 3; ++row) {
      J.middleCols<3>(3 * row) = by_h.col(row) * position.transpose();
    }
    J.middleCols<4>(9) =
        h.head<2>() * Eigen::RowVector4d(t, t * t, t * t * t, t * t * t * t) / meeting->slope;
    J.rightCols<2>().setIdentity();
    if (problem.radius > 0.0) J += OffsetDerivatives(problem, x, k, *beside);
    *gradient += J.transpose() * residual;
    *hessian += J.transpose() * J;
  }
  return cost;
}

// Levenberg and Marquardt. H's own scale does not matter, and is kept at 1.
void Minimise(const Problem& problem, Parameters* x) {
  Parameters gradient;
  NormalMatrix hessian;
  double cost = CostOf(problem, *x, &gradient, &hessian);
  double damping = 1e-4;
  for (int i = 0; i < kMaxIterations && std::isfinite(cost) && damping < 1e6; ++i) {
    NormalMatrix damped = hessian;
    damped.diagonal() += damping * hessian.diagonal();
    damped.diagonal().array() += 1e-12 * hessian.trace();
    Parameters next = *x - damped.ldlt().solve(gradient);
    const double norm = next.head<9>().norm();
    next.head<9>() /= norm;
    const double next_cost = CostOf(problem, next, nullptr, nullptr);
    if (!(next_cost < cost)) {
      damping *= 10.0;
      continue;
    }
    const bool is_converged = cost - next_cost < 1e-6 * cost;
    *x = next;
    damping = std::max(1e-9, 0.1 * damping);
    if (is_converged) return;
    cost = CostOf(problem, *x, &gradient, &hessian);
  }
}

}  // namespace

std::optional<LocalMap> LensMap::Around(const Eigen::Vector2d& point,
                                        const Eigen::Vector2d& near) const {
  const Eigen::Vector3d h = H * point.homogeneous();
  const std::optional<Meeting> meeting = Meet(h, g, StartFor(h, (near - centre) / scale));
  if (!meeting) return std::nullopt;
  const double s = meeting->s;
  const double q = h.head<2>().squaredNorm();
  const Bend bend(g, s * s * q);
  // F(s, x, y) = s h_z - g(s^2 q) = 0, differentiated once and twice.
  const Eigen::Matrix2d h_i = H.topLeftCorner<2, 2>();
  const Eigen::RowVector2d z_i = H.block<1, 2>(2, 0);
  const Eigen::RowVector2d q_i = 2.0 * h.head<2>().transpose() * h_i;
  const Eigen::Matrix2d q_ij = 2.0 * h_i.transpose() * h_i;
  const double s2 = s * s;
  const double F_s = meeting->slope;
  const double F_ss = -2.0 * q * bend.first - 4.0 * s2 * q * q * bend.second;
  const Eigen::RowVector2d F_i = s * z_i - s2 * bend.first * q_i;
  const Eigen::RowVector2d F_si = z_i - 2.0 * s * (bend.first + s2 * q * bend.second) * q_i;
  const Eigen::Matrix2d F_ij = -s2 * (bend.first * q_ij + s2 * bend.second * q_i.transpose() * q_i);
  const Eigen::RowVector2d s_i = -F_i / F_s;
  const Eigen::Matrix2d s_ij =
      -(F_ss * s_i.transpose() * s_i + F_si.transpose() * s_i + s_i.transpose() * F_si + F_ij) /
      F_s;
  LocalMap map;
  map.pixel = centre + scale * s * h.head<2>();
  map.J_pixel_board = scale * (h.head<2>() * s_i + s * h_i);
  for (const auto& [column, i, j] : {std::array{0, 0, 0}, {1, 0, 1}, {2, 1, 1}}) {
    map.second.col(column) =
        scale * (s_ij(i, j) * h.head<2>() + s_i(i) * h_i.col(j) + s_i(j) * h_i.col(i));
  }
  return map;
}

std::optional<LensMap> FitLensMap(const Eigen::Matrix2Xd& board, const Eigen::Matrix2Xd& pixels,
                                  double radius, const Resolution& resolution) {
  assert(board.cols() >= 4 && pixels.cols() == board.cols());
  const Eigen::Vector2d middle(0.5 * (resolution.width - 1), 0.5 * (resolution.height - 1));
  const double scale = 0.5 * std::max(resolution.width, resolution.height);
  const Normalisation normalised(board);
  Problem problem{normalised(board), (pixels.colwise() - middle) / scale};
  const double expected = kExpectedResidual / scale;
  problem.weights.segment<4>(9) = (expected * kExpectedBend.cwiseInverse()).cwiseAbs2();
  problem.weights.tail<2>().setConstant(std::pow(expected / kExpectedDecentring, 2));

  const Eigen::Matrix3d start = FitHomography(problem.board, problem.pixels);
  Parameters x = Parameters::Zero();
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(x.data()) = start / start.norm();
  if (!std::isfinite(CostOf(problem, x, nullptr, nullptr))) return std::nullopt;
  Minimise(problem, &x);
  if (radius > 0.0) {
    problem.radius = radius / normalised.size;
    Minimise(problem, &x);
  }
  LensMap map;
  map.H = H_Of(x) * normalised.Matrix();
  map.centre = middle + scale * x.tail<2>();
  map.scale = scale;
  map.g = x.segment<4>(9);
  return map;
}

std::vector<LocalMap> FitLocalMapsThroughLens(const Eigen::Matrix2Xd& board,
                                              const Eigen::Matrix2Xd& pixels, double radius,
                                              const Resolution& resolution) {
  const std::optional<LensMap> lens = FitLensMap(board, pixels, radius, resolution);
  if (!lens) return FitLocalMaps(board, pixels);
  std::vector<LocalMap> maps;
  for (Eigen::Index k = 0; k < board.cols(); ++k) {
    std::optional<LocalMap> map = lens->Around(board.col(k), pixels.col(k));
    if (!map) return FitLocalMaps(board, pixels);
    map->pixel += map->CentroidOffset(radius);
    maps.push_back(*map);
  }
  return WithLeftOver(board, pixels, std::move(maps));
}

}  // namespace calibrato
