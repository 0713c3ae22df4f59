#include "calibrato/calibration/view_selection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "calibrato/base/parallel.h"
#include "calibrato/calibration/bundle_adjustment.h"
#include "calibrato/calibration/coverage.h"

namespace calibrato {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double Distance(const ViewParameters& a, const ViewParameters& b) {
  return std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.size - b.size) +
         std::abs(a.skew - b.skew);
}

// Mean way of the corners that both views hold [px]. Both lists of numbers ascend. Infinite as soon
// as it is known not to be below `bound`: of views that differ the first corners tell, so that
// comparing each with each stays cheap.
std::optional<double> MeanWay(const BoardView& a, const BoardView& b, double bound = kInfinity) {
  const double enough = bound * static_cast<double>(std::min(a.num_corners(), b.num_corners()));
  double sum = 0.0;
  int count = 0;
  size_t i = 0;
  size_t j = 0;
  while (i < a.corner_ids.size() && j < b.corner_ids.size()) {
    if (a.corner_ids[i] < b.corner_ids[j]) {
      ++i;
    } else if (b.corner_ids[j] < a.corner_ids[i]) {
      ++j;
    } else {
      sum += (a.pixels.col(static_cast<Eigen::Index>(i++)) -
              b.pixels.col(static_cast<Eigen::Index>(j++)))
                 .norm();
      ++count;
      if (sum >= enough) return kInfinity;
    }
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

// The trace of the block's marginal covariance; infinite where the information is singular. Scaled
// to a unit diagonal first, so that parameters of different units are judged alike.
double TraceOfBlock(const Eigen::MatrixXd& information, const std::vector<Eigen::Index>& block) {
  const Eigen::VectorXd diagonal = information.diagonal();
  if (!(diagonal.array() > 0.0).all()) return kInfinity;
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(scale.asDiagonal() * information * scale.asDiagonal());
  constexpr double kLeastPivot = 1e-13;
  if (!(ldlt.vectorD().minCoeff() > kLeastPivot)) return kInfinity;
  double trace = 0.0;
  for (const Eigen::Index i : block) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(information.rows(), i);
    trace += scale(i) * scale(i) * ldlt.solve(unit)(i);
  }
  return trace;
}

// Without what was held: every matrix, and the block counted in what is left.
struct FreePart {
  std::vector<Eigen::MatrixXd> information;
  Eigen::MatrixXd sum;
  std::vector<Eigen::Index> block;
};

FreePart WithoutHeld(const std::vector<Eigen::MatrixXd>& information,
                     const std::vector<Eigen::Index>& block) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(information[0].rows(), information[0].cols());
  for (const Eigen::MatrixXd& view : information) sum += view;
  std::vector<Eigen::Index> free;
  FreePart part;
  for (Eigen::Index i = 0; i < sum.rows(); ++i) {
    if (!(sum(i, i) > 0.0)) continue;
    if (std::find(block.begin(), block.end(), i) != block.end()) {
      part.block.push_back(static_cast<Eigen::Index>(free.size()));
    }
    free.push_back(i);
  }
  for (const Eigen::MatrixXd& view : information) part.information.push_back(view(free, free));
  part.sum = sum(free, free);
  return part;
}

}  // namespace

std::vector<std::optional<double>> BoardSpeeds(const std::vector<BoardView>& views) {
  std::vector<std::optional<double>> speeds(views.size());
  for (size_t v = 1; v < views.size(); ++v) {
    const double seconds = (views[v].stamp - views[v - 1].stamp).seconds();
    const auto way = MeanWay(views[v - 1], views[v]);
    if (way && seconds > 0.0) speeds[v] = *way / seconds;
  }
  return speeds;
}

std::vector<size_t> SelectByCoverage(const std::vector<BoardView>& views, Resolution resolution,
                                     const CoverageSelectionOptions& options) {
  const std::vector<std::optional<double>> speeds = BoardSpeeds(views);
  std::vector<size_t> kept;
  std::vector<ViewParameters> database;
  for (size_t v = 0; v < views.size(); ++v) {
    if (speeds[v] && *speeds[v] > options.max_speed_per_s * resolution.width) continue;
    const ViewParameters parameters = ViewParametersOf(views[v], resolution);
    const bool is_new = std::all_of(database.begin(), database.end(), [&](const auto& other) {
      return Distance(parameters, other) > options.novelty;
    });
    if (!is_new) continue;
    kept.push_back(v);
    database.push_back(parameters);
  }
  return kept;
}

std::vector<size_t> SelectDistinct(const std::vector<BoardView>& views, double least_way_px) {
  std::vector<size_t> kept;
  for (size_t v = 0; v < views.size(); ++v) {
    const bool is_distinct = std::all_of(kept.begin(), kept.end(), [&](size_t other) {
      const auto way = MeanWay(views[other], views[v], least_way_px);
      return !way || *way >= least_way_px;
    });
    if (is_distinct) kept.push_back(v);
  }
  return kept;
}

std::vector<Eigen::MatrixXd> InformationOfViews(const CameraCalibration& calibration,
                                                const std::vector<bool>& fixed) {
  assert(calibration.model && calibration.noise_stddev_px > 0.0);
  const double weight = 1.0 / (calibration.noise_stddev_px * calibration.noise_stddev_px);
  return ParallelMap<Eigen::MatrixXd>(calibration.used_views.size(), [&](size_t v) {
    return Eigen::MatrixXd(weight * CameraInformation(*calibration.model, {calibration.T_c_g[v]},
                                                      {calibration.used_views[v]}, fixed));
  });
}

InformationSelection SelectByInformation(const std::vector<Eigen::MatrixXd>& information,
                                         const std::vector<Eigen::Index>& block,
                                         const InformationSelectionOptions& options) {
  InformationSelection selection;
  if (information.empty()) return selection;
  const FreePart part = WithoutHeld(information, block);
  selection.a_optimality_all = TraceOfBlock(part.sum, part.block);
  selection.a_optimality_kept = selection.a_optimality_all;
  if (std::isinf(selection.a_optimality_all)) return selection;

  // The first few views leave parameters open. A trace of the whole stands in for what they lack:
  // small enough to vanish beside any view that tells something.
  constexpr double kStandIn = 1e-6;
  Eigen::MatrixXd known = kStandIn * part.sum;
  std::vector<bool> is_kept(information.size(), false);
  double trace = kInfinity;
  while (selection.kept.size() < information.size()) {
    size_t best = 0;
    double best_trace = kInfinity;
    for (size_t v = 0; v < information.size(); ++v) {
      if (is_kept[v]) continue;
      const double with = TraceOfBlock(known + part.information[v], part.block);
      if (with < best_trace) {
        best = v;
        best_trace = with;
      }
    }
    const bool helps = best_trace < (1.0 - options.least_gain) * trace;
    if (std::isinf(best_trace) || (!helps && selection.kept.size() >= options.min_views)) break;
    is_kept[best] = true;
    selection.kept.push_back(best);
    known += part.information[best];
    trace = best_trace;
  }
  std::sort(selection.kept.begin(), selection.kept.end());
  selection.a_optimality_kept = TraceOfBlock(known - kStandIn * part.sum, part.block);

  Eigen::MatrixXd first = Eigen::MatrixXd::Zero(part.sum.rows(), part.sum.cols());
  while (selection.num_enough < information.size()) {
    first += part.information[selection.num_enough++];
    if (TraceOfBlock(first, part.block) <= selection.a_optimality_kept) break;
  }
  return selection;
}

std::optional<Duration> TimeOfFirst(size_t num_views, const std::vector<BoardView>& views) {
  if (num_views == 0 || num_views > views.size()) return std::nullopt;
  const Duration time = views[num_views - 1].stamp - views.front().stamp;
  if (!(time > Duration())) return std::nullopt;
  return time;
}

}  // namespace calibrato
