#include "calibrato/calibration/camera_imu_measurements.h"

#include <algorithm>
#include <limits>

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

std::vector<Eigen::Vector3d> SampleResiduals(const std::vector<VectorSample>& samples, size_t imu,
                                             bool accel, const CameraImuState& state) {
  const ImuCalibrationState& of = state.imus[imu];
  std::vector<Eigen::Vector3d> residuals(samples.size(), Eigen::Vector3d::Constant(kNaN));
  ForRanges(samples.size(), kSamplesInATask, [&](size_t k) {
    const double t = TimeOfSample(state, imu, samples[k].stamp);
    if (!IsInside(state, t)) return;
    const SplinePoint point = state.T_g_i.At(t);
    ImuMotion motion{point.T_a_b.R, point.omega_b, point.alpha_b, point.acceleration_a};
    if (imu > 0) motion = MotionOfFrame(motion, of.T_i_imu);
    const ImuBias bias = state.BiasAt(static_cast<int>(imu), t);
    residuals[k] = (accel ? PredictAccel(motion, state.gravity_g, of.intrinsics, bias.accel)
                          : PredictGyro(motion, state.gravity_g, of.intrinsics, bias.gyro)) -
                   samples[k].value;
  });
  return residuals;
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
    const std::vector<BoardView>& views = problem.cameras[n].views;
    const CameraCalibrationState& camera = state.cameras[n];
    auto& of_camera = residuals.corners_px.emplace_back(views.size());
    ForRanges(views.size(), kViewsInATask, [&](size_t v) {
      const double t = TimeOfView(state, n, views[v].stamp);
      if (IsInside(state, t)) {
        const Rigid3 T_c_g = camera.T_c_i * state.T_g_i.PoseAt(t).Inverse();
        of_camera[v] = ReprojectionResiduals(camera.model, views[v], T_c_g);
      } else {
        of_camera[v].setConstant(2, views[v].num_corners(), kNaN);
      }
    });
  }
  for (size_t n = 0; n < problem.imus.size(); ++n) {
    const ImuStream& stream = problem.imus[n].stream;
    residuals.gyro.push_back(SampleResiduals(stream.gyro, n, false, state));
    residuals.accel.push_back(SampleResiduals(stream.accel, n, true, state));
  }
  return residuals;
}

CameraImuSelection SelectionOfFinite(const CameraImuResiduals& residuals) {
  CameraImuSelection selection;
  for (const auto& views : residuals.corners_px) {
    auto& of_camera = selection.corners.emplace_back();
    for (const Eigen::Matrix2Xd& errors : views) {
      auto& of_view = of_camera.emplace_back();
      for (Eigen::Index k = 0; k < errors.cols(); ++k) {
        of_view.push_back(errors.col(k).allFinite());
      }
    }
  }
  for (const auto& gyro : residuals.gyro) selection.gyro.push_back(AreFinite(gyro));
  for (const auto& accel : residuals.accel) selection.accel.push_back(AreFinite(accel));
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
      const BoardView* view = &views[v];
      if (count < view->num_corners()) {
        view = &measurements.partial_views.emplace_back(WithCorners(*view, selected));
      }
      of_camera.push_back({(views[v].stamp - state.start).seconds(), view});
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
