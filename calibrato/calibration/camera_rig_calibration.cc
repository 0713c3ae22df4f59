#include "calibrato/calibration/camera_rig_calibration.h"

#include <algorithm>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/calibration/camera_fit.h"
#include "calibrato/calibration/camera_relations.h"
#include "calibrato/calibration/common_numbering.h"
#include "calibrato/calibration/rig_adjustment.h"
#include "calibrato/sensors/board_symmetry.h"

namespace calibrato {
namespace {

void CheckViews(const CameraProblem& problem) {
  for (const BoardView& view : problem.views) {
    if (view.num_corners() == 0) continue;
    const double extent = view.points_g.cwiseAbs().maxCoeff();
    if (!(view.points_g.row(2).cwiseAbs().maxCoeff() <= 1e-9 * (1.0 + extent))) {
      throw InputError({"the board is not flat", "view " + view.name,
                        "its points do not lie in the plane z = 0",
                        "give the corners in a frame whose x and y span the board"});
    }
  }
}

// With a bent board, the views are those of its bent points.
CameraProblem WithBending(const CameraProblem& problem, const BendingShapes& shapes,
                          const BoardBending& bending) {
  CameraProblem bent = problem;
  for (BoardView& view : bent.views) view = shapes.Bent(view, bending);
  return bent;
}

void RefuseSeveralBendings(const std::vector<CameraGroup>& groups,
                           const std::vector<CameraFit>& fits) {
  std::string list;  // "cam0, cam1 | cam2"
  int num_groups = 0;
  for (const CameraGroup& group : groups) {
    if (!fits[static_cast<size_t>(group.cameras.front())].model) continue;
    if (++num_groups > 1) list += " | ";
    for (const int camera : group.cameras) {
      list += (camera == group.cameras.front() ? "cam" : ", cam") + std::to_string(camera);
    }
  }
  if (num_groups < 2) return;
  throw InputError({"cannot estimate the bending of one board", list,
                    "these never saw it at the same time, so each part would find a bending of its "
                    "own",
                    "calibrate the parts one at a time, or leave out --estimate-bending"});
}

// One bending for all views needs one frame g for them all, up to half a turn, which leaves
// a x^2 + b x y + c y^2 as it is. A quarter turn swaps a with c.
void RefuseBendingOfUnknownSide(const Board& board) {
  for (const BoardTurn& turn : BoardTurns(board)) {
    if (turn.T_g_turned.R.trace() < 0.0) continue;  // 1 + 2 cos(angle): -1 for half a turn.
    throw InputError({"cannot estimate the bending of this board", Describe(board),
                      "it looks the same after a quarter turn, so that its rows in one view may be "
                      "its columns in another",
                      SidedBoardAdvice(board) + ", or leave out --estimate-bending"});
  }
}

class ResultBuilder {
 public:
  explicit ResultBuilder(const CameraRigProblem& problem) : problem_(problem) {
    result_.termination = Termination::kConverged;
    result_.cameras.resize(problem.cameras.size());
    result_.T_cn_cnm1.resize(problem.cameras.size() - 1);
    result_.earlier_relations.resize(problem.cameras.size() - 1);
  }

  void Add(const RigAdjustment& adjustment, const std::vector<CameraFit>& fits) {
    const CameraGroup& group = adjustment.group;
    std::vector<CameraModel> models;
    std::vector<const BoardView*> views;
    for (const int c : group.cameras) {
      const auto camera = static_cast<size_t>(c);
      models.push_back(*fits[camera].model);
      for (const BoardView& view : problem_.cameras[camera].views) views.push_back(&view);
    }
    const BendingShapes shapes(views);
    const BorderLayout layout(models, problem_.estimate_bending);
    for (size_t k = 0; k < group.cameras.size(); ++k) {
      const auto c = static_cast<size_t>(group.cameras[k]);
      CameraCalibration& camera = result_.cameras[c];
      camera =
          problem_.estimate_bending
              ? DescribedFit(WithBending(problem_.cameras[c], shapes, adjustment.bending), fits[c])
              : DescribedFit(problem_.cameras[c], fits[c]);
      camera.termination = adjustment.termination;
      const std::optional<FreeFit>& free_fit = camera.free_fit;
      if (free_fit && free_fit->termination != Termination::kConverged) {
        camera.termination = free_fit->termination;
      }
      if (k > 0 && IsNeighbour(group, k)) {
        result_.T_cn_cnm1[c - 1] = group.T_cn_cnm1[k - 1];
      } else if (k > 0) {
        result_.earlier_relations[c - 1] = {group.cameras[k - 1], group.T_cn_cnm1[k - 1]};
      }
      if (!adjustment.covariance) continue;
      const int n = models[k].num_parameters();
      camera.noise_stddev_px = adjustment.noise_stddev_px[k];
      camera.covariance =
          adjustment.covariance->block(layout.parameters[k], layout.parameters[k], n, n);
      const int focal = CameraModel::FocalIndex(models[k].name());
      camera.information =
          InformationOf(camera.covariance.block<4, 4>(focal, focal), Eigen::Vector4d::Ones());
    }
    if (!group.is_side_known) result_.groups_of_unknown_side.push_back(group.cameras);
    result_.num_separated_views += adjustment.num_separated_views;
    if (!adjustment.covariance) return;
    AddCovariance(adjustment, models, layout);
    if (layout.bending >= 0 && !result_.bending) {
      result_.bending = {adjustment.bending,
                         adjustment.covariance->block<3, 3>(layout.bending, layout.bending),
                         shapes.Depth(adjustment.bending)};
    }
  }

  void AddFailed(int camera, const CameraFit& fit) {
    const auto c = static_cast<size_t>(camera);
    result_.cameras[c] = DescribedFit(problem_.cameras[c], fit);
  }

  CameraRigCalibration Result() && {
    for (const CameraCalibration& camera : result_.cameras) {
      if (camera.termination != Termination::kConverged) result_.termination = camera.termination;
    }
    return std::move(result_);
  }

 private:
  // Whether the camera before one in its group is the one before it in the rig.
  static bool IsNeighbour(const CameraGroup& group, size_t k) {
    return group.cameras[k - 1] + 1 == group.cameras[k];
  }

  // Of each group one block; its names have the numbers that the cameras have in the problem.
  void AddCovariance(const RigAdjustment& adjustment, const std::vector<CameraModel>& models,
                     const BorderLayout& layout) {
    const CameraGroup& group = adjustment.group;
    const auto camera = [&](size_t k) { return "cam" + std::to_string(group.cameras[k]) + "."; };
    for (const std::string& name : BorderNames(models, layout.bending >= 0)) {
      const size_t dot = name.find('.');
      if (!name.starts_with("cam")) {
        result_.covariance_names.push_back(name);
        continue;
      }
      const auto k = static_cast<size_t>(std::stoi(name.substr(3, dot - 3)));
      const std::string parameter = name.substr(dot + 1);
      const bool is_relation = parameter.starts_with("rot_") || parameter.starts_with("pos_");
      const bool is_earlier = is_relation && !IsNeighbour(group, k);
      result_.covariance_names.push_back(
          camera(k) + (is_earlier ? "from_" + camera(k - 1) : std::string()) + parameter);
    }
    const Eigen::Index before = result_.covariance.rows();
    const Eigen::Index size = adjustment.covariance->rows();
    result_.covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(before + size, before + size));
    result_.covariance.bottomRightCorner(size, size) = *adjustment.covariance;
  }

  const CameraRigProblem& problem_;
  CameraRigCalibration result_;
};

}  // namespace

CameraRigCalibration CalibrateCameraRig(const CameraRigProblem& problem, int max_iterations) {
  for (const CameraProblem& camera : problem.cameras) CheckViews(camera);
  if (problem.estimate_bending && problem.board) RefuseBendingOfUnknownSide(*problem.board);
  std::vector<CameraFit> fits = ParallelMap<CameraFit>(problem.cameras.size(), [&](size_t c) {
    return FitCamera(problem.cameras[c], max_iterations);
  });
  const std::vector<BoardTurn> turns =
      problem.board ? BoardTurns(*problem.board) : std::vector<BoardTurn>();
  const std::vector<CameraGroup> groups = RelateCameras(fits, problem.frame_of_view, turns);
  if (problem.estimate_bending) RefuseSeveralBendings(groups, fits);
  std::optional<CameraRigProblem> renumbered;
  if (!turns.empty() && fits.size() > 1) {
    renumbered = problem;
    for (const CameraGroup& group : groups) NumberAlike(group, turns, &*renumbered, &fits);
  }
  const CameraRigProblem& numbered = renumbered ? *renumbered : problem;

  ResultBuilder builder(numbered);
  for (const CameraGroup& group : groups) {
    const CameraFit& first = fits[static_cast<size_t>(group.cameras.front())];
    if (first.model) {
      builder.Add(AdjustRig(numbered, group, max_iterations, &fits), fits);
    } else {
      builder.AddFailed(group.cameras.front(), first);
    }
  }
  CameraRigCalibration result = std::move(builder).Result();
  for (size_t c = 1; c < fits.size(); ++c) {
    result.num_shared_frames.push_back(NumSharedFrames(fits[c - 1], problem.frame_of_view[c - 1],
                                                       fits[c], problem.frame_of_view[c]));
  }
  return result;
}

}  // namespace calibrato
