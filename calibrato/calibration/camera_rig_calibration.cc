#include "calibrato/calibration/camera_rig_calibration.h"

#include <algorithm>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/calibration/camera_fit.h"
#include "calibrato/calibration/camera_relations.h"
#include "calibrato/calibration/rig_adjustment.h"

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

class ResultBuilder {
 public:
  explicit ResultBuilder(const CameraRigProblem& problem) : problem_(problem) {
    result_.termination = Termination::kConverged;
    result_.cameras.resize(problem.cameras.size());
    result_.T_cn_cnm1.resize(problem.cameras.size() - 1);
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
      if (k > 0 && group.cameras[k - 1] + 1 == group.cameras[k]) {
        result_.T_cn_cnm1[c - 1] = group.T_cn_cnm1[k - 1];
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
  // Of each group one block; its names have the numbers that the cameras have in the problem.
  void AddCovariance(const RigAdjustment& adjustment, const std::vector<CameraModel>& models,
                     const BorderLayout& layout) {
    const std::vector<std::string> names = BorderNames(models, layout.bending >= 0);
    for (const std::string& name : names) {
      const size_t dot = name.find('.');
      if (!name.starts_with("cam")) {
        result_.covariance_names.push_back(name);
        continue;
      }
      const int place = std::stoi(name.substr(3, dot - 3));
      result_.covariance_names.push_back(
          "cam" + std::to_string(adjustment.group.cameras[static_cast<size_t>(place)]) +
          name.substr(dot));
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
  std::vector<CameraFit> fits = ParallelMap<CameraFit>(problem.cameras.size(), [&](size_t c) {
    return FitCamera(problem.cameras[c], max_iterations);
  });
  ResultBuilder builder(problem);
  for (const CameraGroup& group : RelateCameras(fits, problem.frame_of_view)) {
    const CameraFit& first = fits[static_cast<size_t>(group.cameras.front())];
    // A camera without start values shares no frame.
    if (first.termination == Termination::kNoStart) {
      builder.AddFailed(group.cameras.front(), first);
    } else {
      builder.Add(AdjustRig(problem, group, max_iterations, &fits), fits);
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
