#include "calibrato/calibration/common_numbering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "calibrato/calibration/view_fit.h"

namespace calibrato {
namespace {

// A view that takes part, by its camera's place in the group.
struct PlacedView {
  size_t place = 0;
  size_t view = 0;
};

// How far apart two poses of one board are [rad]: a shift by their distance counts as 1 rad.
double Apart(const Rigid3& a, const Rigid3& b) {
  const Eigen::Matrix<double, 6, 1> delta = a.DifferenceTo(b);
  return delta.head<3>().norm() + delta.tail<3>().norm() / b.t.norm();
}

void Renumber(const BoardTurn& turn, const Eigen::Matrix3Xd& points_g, BoardView* view,
              ViewInliers* inliers) {
  std::vector<bool> corners;
  for (const int column : ColumnsInOrder(*view, turn.numbering)) {
    corners.push_back(inliers->corners[static_cast<size_t>(column)]);
  }
  *view = Renumbered(*view, turn.numbering, points_g);
  inliers->corners = std::move(corners);
  inliers->T_c_g = inliers->T_c_g * turn.T_g_turned;
}

// How far the corners of a view are from where a camera sees them [px^2]: their median, for a view
// that was left out has bad ones among them.
double MedianSquaredError(const CameraModel& model, const BoardView& view, const Rigid3& T_c_g) {
  const Eigen::Matrix2Xd residuals = ReprojectionResiduals(model, view, T_c_g);
  std::vector<double> errors;
  for (Eigen::Index k = 0; k < residuals.cols(); ++k) {
    const double error = residuals.col(k).squaredNorm();
    errors.push_back(std::isnan(error) ? std::numeric_limits<double>::infinity() : error);
  }
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

class Numberer {
 public:
  Numberer(const CameraGroup& group, const std::vector<BoardTurn>& turns, CameraRigProblem* problem,
           std::vector<CameraFit>* fits)
      : group_(group),
        turns_(turns),
        points_g_(BoardPoints(*problem->board)),
        problem_(problem),
        fits_(fits) {}

  void NumberUsedViews() {
    for (size_t place = 0; place < group_.cameras.size(); ++place) {
      const auto camera = static_cast<size_t>(group_.cameras[place]);
      for (size_t v = 0; v < (*fits_)[camera].views.size(); ++v) {
        if ((*fits_)[camera].views[v].count() == 0) continue;
        const auto [entry, is_first] =
            first_of_frame_.try_emplace(problem_->frame_of_view[camera][v], PlacedView{place, v});
        if (is_first) continue;
        RenumberIfBetter(place, v, [&](const BoardTurn* turn) {
          const Rigid3& T_c_g = (*fits_)[camera].views[v].T_c_g;
          return Apart(turn == nullptr ? T_c_g : T_c_g * turn->T_g_turned,
                       InCamera(place, entry->second));
        });
      }
    }
  }

  void NumberViewsLeftOut() {
    for (size_t place = 0; place < group_.cameras.size(); ++place) {
      const auto camera = static_cast<size_t>(group_.cameras[place]);
      const CameraFit& fit = (*fits_)[camera];
      for (size_t v = 0; v < fit.views.size(); ++v) {
        if (fit.views[v].count() > 0 || fit.views[v].reason != ViewRejection::kDoesNotFit) continue;
        const auto entry = first_of_frame_.find(problem_->frame_of_view[camera][v]);
        if (entry == first_of_frame_.end()) continue;
        const BoardView& view = problem_->cameras[camera].views[v];
        RenumberIfBetter(place, v, [&](const BoardTurn* turn) {
          return MedianSquaredError(
              *fit.model, turn == nullptr ? view : Renumbered(view, turn->numbering, points_g_),
              InCamera(place, entry->second));
        });
      }
    }
  }

 private:
  // The pose of the board in one camera, as another's view has it.
  Rigid3 InCamera(size_t place, const PlacedView& seen) const {
    const auto camera = static_cast<size_t>(group_.cameras[seen.place]);
    return group_.T_to_from(place, seen.place) * (*fits_)[camera].views[seen.view].T_c_g;
  }

  // By the turn of which `error` is least; nullptr is none.
  template <typename Error>
  void RenumberIfBetter(size_t place, size_t v, const Error& error) {
    const BoardTurn* best = nullptr;
    double least = error(nullptr);
    for (const BoardTurn& turn : turns_) {
      const double of_turn = error(&turn);
      if (!(of_turn < least)) continue;
      least = of_turn;
      best = &turn;
    }
    const auto camera = static_cast<size_t>(group_.cameras[place]);
    if (best == nullptr) return;
    Renumber(*best, points_g_, &problem_->cameras[camera].views[v], &(*fits_)[camera].views[v]);
  }

  const CameraGroup& group_;
  const std::vector<BoardTurn>& turns_;
  const Eigen::Matrix3Xd points_g_;
  CameraRigProblem* problem_;
  std::vector<CameraFit>* fits_;
  std::map<int, PlacedView> first_of_frame_;
};

}  // namespace

void NumberAlike(const CameraGroup& group, const std::vector<BoardTurn>& turns,
                 CameraRigProblem* problem, std::vector<CameraFit>* fits) {
  Numberer numberer(group, turns, problem, fits);
  numberer.NumberUsedViews();
  numberer.NumberViewsLeftOut();
}

}  // namespace calibrato
