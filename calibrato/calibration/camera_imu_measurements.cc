#include "calibrato/calibration/camera_imu_measurements.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "calibrato/base/parallel.h"
#include "calibrato/calibration/view_fit.h"

namespace calibrato {
namespace {

constexpr size_t kViewsInATask = 16;
constexpr size_t kSamplesInATask = 512;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void ForRanges(size_t n, size_t size, const std::function<void(size_t)>& body) {
  ParallelFor((n + size - 1) / size, [&](size_t task) {
    for (size_t i = task * size; i < std::min(n, (task + 1) * size); ++i) body(i);
  });
}

bool IsInside(const CameraImuState& state, double t_s) {
  return t_s >= 0.0 && t_s <= state.T_g_i.duration_s();
}

// How an IMU moves at one of its stamps, and its biases.
struct ImuInstant {
  ImuMotion motion;
  ImuBias bias;
};

std::optional<ImuInstant> InstantAt(const CameraImuState& state, size_t imu, Time stamp) {
  const double t = TimeOfSample(state, imu, stamp);
  if (!IsInside(state, t)) return std::nullopt;
  const SplinePoint point = state.T_g_i.At(t);
  ImuMotion motion{point.T_a_b.R, point.omega_b, point.alpha_b, point.acceleration_a};
  if (imu > 0) motion = MotionOfFrame(motion, state.imus[imu].T_i_imu);
  return ImuInstant{motion, state.BiasAt(static_cast<int>(imu), t)};
}

// Of both sensors. Usually they share their stamps, and one evaluation of the spline.
void AddSampleResiduals(const ImuStream& stream, size_t imu, const CameraImuState& state,
                        CameraImuResiduals* residuals) {
  const ImuIntrinsics& intrinsics = state.imus[imu].intrinsics;
  const Eigen::Vector3d nothing = Eigen::Vector3d::Constant(kNaN);
  std::vector<Eigen::Vector3d>& gyro = residuals->gyro.emplace_back(stream.gyro.size(), nothing);
  std::vector<Eigen::Vector3d>& accel = residuals->accel.emplace_back(stream.accel.size(), nothing);
  ForRanges(std::max(gyro.size(), accel.size()), kSamplesInATask, [&](size_t k) {
    std::optional<ImuInstant> instant;
    if (k < gyro.size()) {
      instant = InstantAt(state, imu, stream.gyro[k].stamp);
      if (instant) {
        gyro[k] = PredictGyro(instant->motion, state.gravity_g, intrinsics, instant->bias.gyro) -
                  stream.gyro[k].value;
      }
    }
    if (k >= accel.size()) return;
    const bool is_shared = k < gyro.size() && stream.gyro[k].stamp == stream.accel[k].stamp;
    if (!is_shared) instant = InstantAt(state, imu, stream.accel[k].stamp);
    if (!instant) return;
    accel[k] = PredictAccel(instant->motion, state.gravity_g, intrinsics, instant->bias.accel) -
               stream.accel[k].value;
  });
}

std::vector<CameraImuMeasurements::Sample> SelectedSamples(const std::vector<VectorSample>& samples,
                                                           const std::vector<bool>& selected,
                                                           Time start) {
  std::vector<CameraImuMeasurements::Sample> result;
  result.reserve(samples.size());
  for (size_t k = 0; k < samples.size(); ++k) {
    if (selected[k]) result.push_back({(samples[k].stamp - start).seconds(), samples[k].value});
  }
  return result;
}

std::vector<bool> AreFinite(const std::vector<Eigen::Vector3d>& residuals) {
  std::vector<bool> finite(residuals.size());
  for (size_t k = 0; k < residuals.size(); ++k) finite[k] = residuals[k].allFinite();
  return finite;
}

std::vector<std::vector<bool>> AreFinite(const std::vector<Eigen::Matrix2Xd>& views) {
  std::vector<std::vector<bool>> finite;
  for (const Eigen::Matrix2Xd& errors : views) {
    std::vector<bool>& of_view = finite.emplace_back();
    for (Eigen::Index k = 0; k < errors.cols(); ++k) {
      of_view.push_back(errors.col(k).allFinite());
    }
  }
  return finite;
}

BoardView OneCorner(const BoardView& view, Eigen::Index k) {
  return {view.stamp,
          view.name,
          {view.corner_ids[static_cast<size_t>(k)]},
          view.pixels.col(k),
          view.points_g.col(k)};
}

// NaN for corners that were exposed beyond the trajectory's ends.
Eigen::Matrix2Xd ViewResiduals(const CameraImuState& state, const CameraCalibrationState& camera,
                               const BoardView& view, double first_row_s) {
  const auto residuals_at = [&](const BoardView& seen, double t) -> Eigen::Matrix2Xd {
    if (!IsInside(state, t)) return Eigen::Matrix2Xd::Constant(2, seen.num_corners(), kNaN);
    const Rigid3 T_c_g = camera.T_c_i * state.T_g_i.PoseAt(t).Inverse();
    return ReprojectionResiduals(camera.model, seen, {T_c_g.R, T_c_g.t / state.board_scale});
  };
  if (camera.line_delay_s == 0.0) return residuals_at(view, first_row_s);
  Eigen::Matrix2Xd residuals(2, view.num_corners());
  for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
    residuals.col(k) =
        residuals_at(OneCorner(view, k), first_row_s + camera.line_delay_s * view.pixels(1, k));
  }
  return residuals;
}

std::vector<Eigen::Matrix2Xd> CornerResiduals(const CameraImuProblem& problem,
                                              const CameraImuState& state, size_t camera) {
  const std::vector<BoardView>& views = problem.cameras[camera].views;
  std::vector<Eigen::Matrix2Xd> residuals(views.size());
  ForRanges(views.size(), kViewsInATask, [&](size_t v) {
    residuals[v] = ViewResiduals(state, state.cameras[camera], views[v],
                                 TimeOfView(state, camera, views[v].stamp));
  });
  return residuals;
}

BoardView WithCorners(const BoardView& view, const std::vector<bool>& selected) {
  const auto count = std::count(selected.begin(), selected.end(), true);
  BoardView part{view.stamp, view.name, {}, Eigen::Matrix2Xd(2, count), Eigen::Matrix3Xd(3, count)};
  Eigen::Index n = 0;
  for (size_t k = 0; k < selected.size(); ++k) {
    if (!selected[k]) continue;
    const auto column = static_cast<Eigen::Index>(k);
    part.corner_ids.push_back(view.corner_ids[k]);
    part.pixels.col(n) = view.pixels.col(column);
    part.points_g.col(n++) = view.points_g.col(column);
  }
  return part;
}

}  // namespace

double TimeOfView(const CameraImuState& state, size_t camera, Time stamp) {
  return (stamp - state.start).seconds() + state.cameras[camera].time_offset_s;
}

double TimeOfSample(const CameraImuState& state, size_t imu, Time stamp) {
  return (stamp - state.start).seconds() + state.imus[imu].time_offset_s;
}

CameraImuResiduals ResidualsOf(const CameraImuProblem& problem, const CameraImuState& state) {
  CameraImuResiduals residuals;
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    residuals.corners_px.push_back(CornerResiduals(problem, state, n));
  }
  for (size_t n = 0; n < problem.imus.size(); ++n) {
    AddSampleResiduals(problem.imus[n].stream, n, state, &residuals);
  }
  return residuals;
}

CameraImuSelection SelectionOfFinite(const CameraImuResiduals& residuals) {
  CameraImuSelection selection;
  for (const auto& views : residuals.corners_px) selection.corners.push_back(AreFinite(views));
  for (const auto& gyro : residuals.gyro) selection.gyro.push_back(AreFinite(gyro));
  for (const auto& accel : residuals.accel) selection.accel.push_back(AreFinite(accel));
  return selection;
}

CameraImuSelection SelectionOnTrajectory(const CameraImuProblem& problem,
                                         const CameraImuState& state) {
  CameraImuSelection selection;
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    selection.corners.push_back(AreFinite(CornerResiduals(problem, state, n)));
  }
  for (size_t n = 0; n < problem.imus.size(); ++n) {
    const auto are_inside = [&](const std::vector<VectorSample>& samples) {
      std::vector<bool> inside(samples.size());
      for (size_t k = 0; k < samples.size(); ++k) {
        inside[k] = IsInside(state, TimeOfSample(state, n, samples[k].stamp));
      }
      return inside;
    };
    selection.gyro.push_back(are_inside(problem.imus[n].stream.gyro));
    selection.accel.push_back(are_inside(problem.imus[n].stream.accel));
  }
  return selection;
}

CameraImuMeasurements MeasurementsOf(const CameraImuProblem& problem, const CameraImuState& state,
                                     const CameraImuSelection& selection) {
  CameraImuMeasurements measurements;
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    const std::vector<BoardView>& views = problem.cameras[n].views;
    auto& of_camera = measurements.cameras.emplace_back();
    for (size_t v = 0; v < views.size(); ++v) {
      const std::vector<bool>& selected = selection.corners[n][v];
      const auto count = std::count(selected.begin(), selected.end(), true);
      if (count == 0) continue;
      const double time_s = (views[v].stamp - state.start).seconds();
      if (problem.estimate_line_delays) {
        for (Eigen::Index k = 0; k < views[v].num_corners(); ++k) {
          if (!selected[static_cast<size_t>(k)]) continue;
          of_camera.push_back({time_s, views[v].pixels(1, k),
                               &measurements.partial_views.emplace_back(OneCorner(views[v], k))});
        }
        continue;
      }
      const BoardView* view = &views[v];
      if (count < view->num_corners()) {
        view = &measurements.partial_views.emplace_back(WithCorners(*view, selected));
      }
      of_camera.push_back({time_s, 0.0, view});
    }
  }
  for (size_t n = 0; n < problem.imus.size(); ++n) {
    const ImuStream& stream = problem.imus[n].stream;
    measurements.imus.push_back({SelectedSamples(stream.gyro, selection.gyro[n], state.start),
                                 SelectedSamples(stream.accel, selection.accel[n], state.start)});
  }
  return measurements;
}

}  // namespace calibrato
