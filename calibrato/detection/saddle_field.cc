#include "calibrato/detection/saddle_field.h"

#include <cmath>
#include <utility>

namespace calibrato {
namespace {

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

std::vector<Eigen::Vector2d> PixelsOf(const std::vector<Saddle>& saddles) {
  std::vector<Eigen::Vector2d> pixels;
  pixels.reserve(saddles.size());
  for (const Saddle& saddle : saddles) pixels.push_back(saddle.pixel);
  return pixels;
}

// The steps from a saddle to its nearest neighbours along its edges.
std::optional<LatticeSeed> SeedAt(int k, const SaddleField& field) {
  constexpr double kMaxSine = 0.35;
  const Saddle& here = field.saddle(k);
  LatticeSeed seed;
  seed.point = k;
  for (int edge = 0; edge < 2; ++edge) {
    std::optional<Eigen::Vector2d> nearest;
    for (const double side : {1.0, -1.0}) {
      const std::optional<int> next =
          field.NeighbourAlong(k, side * here.edges.col(edge), kMaxSine);
      if (!next) continue;
      const Eigen::Vector2d step = side * (field.saddle(*next).pixel - here.pixel);
      if (!nearest || step.norm() < nearest->norm()) nearest = step;
    }
    if (!nearest) return std::nullopt;
    seed.steps.col(edge) = *nearest;
  }
  return seed;
}

}  // namespace

SaddleField::SaddleField(std::vector<Saddle> saddles)
    : saddles_(std::move(saddles)), points_(PixelsOf(saddles_)), index_(points_) {}

bool SaddleField::MayBeNeighbours(int a, int b) const {
  constexpr double kMaxSine = 0.5;
  const Eigen::Matrix2d& edges_a = saddle(a).edges;
  const Eigen::Matrix2d& edges_b = saddle(b).edges;
  return std::abs(Cross(edges_a.col(0), edges_b.col(1))) < kMaxSine &&
         std::abs(Cross(edges_a.col(1), edges_b.col(0))) < kMaxSine;
}

std::optional<int> SaddleField::NeighbourAlong(int k, const Eigen::Vector2d& direction,
                                               double max_sine) const {
  const Eigen::Vector2d here = saddle(k).pixel;
  // Most neighbours are near: circles that double until they hold one.
  constexpr double kFirstRadius = 24.0;  // [px]
  constexpr double kLastRadius = 2000.0;
  for (double radius = kFirstRadius; radius <= kLastRadius; radius *= 2.0) {
    double nearest = radius * radius;
    std::optional<int> best;
    index_.VisitNear(here, radius, [&](int other) {
      const Eigen::Vector2d step = points_[static_cast<size_t>(other)] - here;
      const double squared_length = step.squaredNorm();
      if (!(squared_length < nearest && direction.dot(step) > 0.0)) return;
      const double cross = Cross(direction, step);
      if (cross * cross > max_sine * max_sine * squared_length) return;
      if (!MayBeNeighbours(k, other)) return;
      nearest = squared_length;
      best = other;
    });
    if (best) return best;
  }
  return std::nullopt;
}

std::optional<int> SaddleField::NearestTo(const Eigen::Vector2d& place, double radius) const {
  std::optional<int> best;
  double nearest = radius;
  index_.VisitNear(place, radius, [&](int other) {
    const double distance = (saddle(other).pixel - place).norm();
    if (distance > nearest) return;
    nearest = distance;
    best = other;
  });
  return best;
}

std::vector<std::vector<LatticeNode>> SaddleLattices(const SaddleField& field, int min_nodes) {
  std::vector<std::vector<LatticeNode>> lattices;
  const size_t n = field.saddles().size();
  if (n < static_cast<size_t>(min_nodes)) return lattices;
  std::vector<bool> is_taken(n, false);
  const auto may_be_neighbours = [&](int from, int to) {
    return !is_taken[static_cast<size_t>(to)] && field.MayBeNeighbours(from, to);
  };
  for (size_t k = 0; k < n; ++k) {
    if (is_taken[k]) continue;
    const std::optional<LatticeSeed> seed = SeedAt(static_cast<int>(k), field);
    if (!seed) continue;
    std::vector<LatticeNode> nodes =
        GrowLattice(field.points(), field.index(), *seed, may_be_neighbours);
    // A seed with a wrong step finds few; what it found is still there for others.
    if (nodes.size() < static_cast<size_t>(min_nodes)) continue;
    for (const LatticeNode& node : nodes) is_taken[static_cast<size_t>(node.point)] = true;
    lattices.push_back(std::move(nodes));
  }
  return lattices;
}

}  // namespace calibrato
