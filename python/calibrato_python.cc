// The library from Python: plain data in, plain data out, as in C++. Rigs, motions and results
// cross as JSON, corners and samples as arrays; python/calibrato/__init__.py gives them their
// faces.

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/mdp/design_setting.h"
#include "calibrato/mdp/motion_design.h"
#include "calibrato/mdp/motion_information.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/sensors/imu_file.h"
#include "calibrato/sensors/rig.h"
#include "calibrato/simulation/simulated_run.h"

namespace calibrato {
namespace {

namespace py = pybind11;

using Rows2 = Eigen::Matrix<double, Eigen::Dynamic, 2>;
using Rows3 = Eigen::Matrix<double, Eigen::Dynamic, 3>;

Rig ReadRig(const std::string& json) { return RigFromValue(ParseJson(json, "rig"), nullptr); }

Motion ReadMotion(const std::string& json) {
  return MotionFromValue(ParseJson(json, "motion"), nullptr);
}

BoardView MakeView(const Rows2& pixels, const Rows3& points, std::optional<std::vector<int>> ids,
                   int64_t stamp_ns) {
  if (pixels.rows() != points.rows() ||
      (ids && ids->size() != static_cast<size_t>(pixels.rows()))) {
    throw InputError(
        {"a view's arrays are not of one length", "",
         std::to_string(pixels.rows()) + " pixels and " + std::to_string(points.rows()) + " points",
         "give one row a corner in each"});
  }
  if (!pixels.allFinite() || !points.allFinite()) {
    throw InputError({"a view has corners that are not finite", "",
                      "a pixel or a point is NaN or infinite", "leave these corners out"});
  }
  BoardView view;
  view.stamp = Time::FromNanoseconds(stamp_ns);
  view.name = std::to_string(stamp_ns);
  view.pixels = pixels.transpose();
  view.points_g = points.transpose();
  for (Eigen::Index k = 0; k < pixels.rows(); ++k) {
    view.corner_ids.push_back(ids ? (*ids)[static_cast<size_t>(k)] : static_cast<int>(k));
  }
  return view;
}

Rows3 ValuesOf(const std::vector<VectorSample>& samples) {
  Rows3 values(static_cast<Eigen::Index>(samples.size()), 3);
  for (size_t k = 0; k < samples.size(); ++k) {
    values.row(static_cast<Eigen::Index>(k)) = samples[k].value.transpose();
  }
  return values;
}

std::vector<int64_t> StampsOf(const std::vector<VectorSample>& samples) {
  std::vector<int64_t> stamps;
  for (const VectorSample& sample : samples) stamps.push_back(sample.stamp.nanoseconds());
  return stamps;
}

std::vector<VectorSample> SamplesOf(const std::string& sensor,
                                    const std::vector<int64_t>& stamps_ns, const Rows3& values) {
  if (stamps_ns.size() != static_cast<size_t>(values.rows())) {
    throw InputError({"stamps and samples are not of one length", "",
                      std::to_string(stamps_ns.size()) + " and " + std::to_string(values.rows()),
                      "give one stamp a row"});
  }
  std::vector<VectorSample> samples;
  for (size_t k = 0; k < stamps_ns.size(); ++k) {
    const std::string where = sensor + " row " + std::to_string(k);
    if (!values.row(static_cast<Eigen::Index>(k)).allFinite()) {
      throw InputError({"a sample is not finite", where, "it has a NaN or an infinity",
                        "leave this sample out"});
    }
    if (k > 0 && stamps_ns[k] <= stamps_ns[k - 1]) {
      throw InputError({"the stamps do not ascend", where,
                        std::to_string(stamps_ns[k]) + " ns stands after " +
                            std::to_string(stamps_ns[k - 1]) + " ns",
                        "sort the samples by time, and give each stamp once"});
    }
    samples.push_back({Time::FromNanoseconds(stamps_ns[k]),
                       values.row(static_cast<Eigen::Index>(k)).transpose()});
  }
  return samples;
}

TimedMotion Planned(const Motion& motion, const Rig& rig, bool scale_to_fit) {
  auto planned = PlanMotion(motion, rig);
  if (const auto* refusal = std::get_if<Refusal>(&planned)) {
    if (!scale_to_fit) {
      throw InputError({"the carrier '" + CarrierName(motion.carrier) + "' can't make this motion",
                        "", refusal->Describe(), "make it smaller, or give scale_to_fit=True"});
    }
    return PlanScaledToFit(motion, rig);
  }
  return std::get<TimedMotion>(planned);
}

py::dict Simulate(const std::string& rig_json, const std::string& motion_json,
                  const std::string& carrier, const std::string& fidelity, uint64_t seed,
                  bool scale_to_fit) {
  const Rig rig = ReadRig(rig_json);
  Motion motion = ReadMotion(motion_json);
  motion.carrier = CarrierFromName(carrier);
  const Fidelity of = FidelityFromName(fidelity);
  if (of == Fidelity::kRendered) {
    throw InputError({"images are not handed to Python", "", "fidelity rendered",
                      "use fast or physical, or calibrato simulate"});
  }
  py::dict recording;
  SimulatedRun run;
  {
    const py::gil_scoped_release release;
    const TimedMotion timed = Planned(motion, rig, scale_to_fit);
    run = SimulateRun(rig, timed, of, Time::FromNanoseconds(1'000'000'000), Rng(seed));
  }
  recording["views"] = run.frames.views;
  recording["num_frames"] = run.frames.num_frames;
  recording["imu_stamps_ns"] = StampsOf(run.imu.stream.gyro);
  recording["gyro"] = ValuesOf(run.imu.stream.gyro);
  recording["accel"] = ValuesOf(run.imu.stream.accel);
  return recording;
}

py::object CovarianceOrNone(const Eigen::MatrixXd& covariance) {
  if (covariance.size() == 0) return py::none();
  return py::cast(covariance);
}

py::dict CalibrateCameraFrom(const std::vector<BoardView>& views, std::pair<int, int> resolution,
                             const std::string& model, bool reject_outliers) {
  CameraProblem problem;
  problem.model = model;
  problem.resolution = {resolution.first, resolution.second};
  problem.views = views;
  problem.reject_outliers = reject_outliers;
  CameraCalibration found;
  {
    const py::gil_scoped_release release;
    found = CalibrateCamera(problem);
  }
  py::dict result;
  result["termination"] = std::string(TerminationName(found.termination));
  result["model"] = model;
  result["names"] = CameraModel::ParameterNames(model);
  result["parameters"] = found.model ? py::cast(found.model->parameters()) : py::none();
  result["covariance"] = CovarianceOrNone(found.covariance);
  result["reprojection_rms_px"] = found.reprojection_rms_px;
  result["noise_stddev_px"] = found.noise_stddev_px;
  result["num_views"] = found.used_views.size();
  return result;
}

py::dict CalibrateCameraImuFrom(const std::vector<BoardView>& views, const std::string& model,
                                const std::optional<Eigen::VectorXd>& parameters,
                                const std::vector<int64_t>& stamps_ns, const Rows3& gyro,
                                const Rows3& accel, const std::string& imu_json) {
  if (!parameters) {
    throw InputError({"the camera has no parameters", "", "its calibration found no start",
                      "calibrate it again, from more views"});
  }
  CameraImuProblem problem;
  problem.cameras.push_back({CameraModel(model, *parameters), views, {}, {}});
  problem.imus.push_back(
      {{SamplesOf("gyro", stamps_ns, gyro), SamplesOf("accel", stamps_ns, accel)},
       ImuNoiseFromValue(ParseJson(imu_json, "imu")),
       ImuModelKind::kCalibrated});
  CameraImuCalibration found;
  {
    const py::gil_scoped_release release;
    found = CalibrateCameraImu(problem);
  }
  py::dict result;
  result["termination"] = std::string(TerminationName(found.termination));
  result["reprojection_rms_px"] = found.reprojection_rms_px;
  if (!found.state) {
    result["T_cam_imu"] = py::none();
    result["time_offset_s"] = py::none();
  } else {
    result["T_cam_imu"] = found.state->cameras.front().T_c_i.Matrix();
    result["time_offset_s"] = found.state->cameras.front().time_offset_s;
  }
  result["names"] = found.information.names;
  result["covariance"] = CovarianceOrNone(found.information.covariance);
  return result;
}

// None where the motion does not determine the calibration.
py::object ExpectedInformation(const std::string& rig_json, const std::string& motion_json,
                               const std::string& task_name) {
  const Rig rig = ReadRig(rig_json);
  const Motion motion = ReadMotion(motion_json);
  const Task task = TaskFromName(task_name);
  if (task == Task::kJoint) {
    throw InputError(
        {"information is of one task", "", "joint is two", "ask for intrinsic and for extrinsic"});
  }
  const auto found = task == Task::kIntrinsic ? ExpectIntrinsicInformation(rig, motion)
                                              : ExpectExtrinsicInformation(rig, motion);
  if (!found) return py::none();
  py::dict result;
  result["covariance"] = found->covariance;
  result["num_frames"] = found->num_frames;
  if (task == Task::kIntrinsic) {
    result["names"] = CameraModel::ParameterNames(rig.cameras.front().model.name());
  } else {
    result["names"] = std::vector<std::string>{"rot_x", "rot_y", "rot_z",      "pos_x",
                                               "pos_y", "pos_z", "time_offset"};
  }
  return result;
}

py::object Plan(const std::string& rig_json, const std::string& task_name,
                std::optional<double> max_path_m, std::optional<double> max_time_s, int num_starts,
                int evaluations, uint64_t seed) {
  const Rig rig = AsEstimated(ReadRig(rig_json));
  const Task task = TaskFromName(task_name);
  MotionDesignProblem problem;
  problem.task = task;
  problem.rigs = {rig};
  problem.num_loops = NumLoops(task);
  problem.base_pose = BasePoseBeforeBoard(rig);
  Motion handcrafted = HandcraftedMotion(task);
  handcrafted.base_pose = problem.base_pose;
  std::optional<MotionDesign> design;
  {
    const py::gil_scoped_release release;
    const MotionBudget budget = BudgetOf(handcrafted, rig);
    problem.max_path_m = max_path_m.value_or(budget.path_m);
    problem.max_duration_s = max_time_s.value_or(budget.duration_s);
    MultistartOptions options;
    options.num_starts = num_starts;
    options.evaluations_per_start = evaluations;
    options.evaluations_of_best = evaluations;
    design = DesignFromManyStarts(problem, options, Rng(seed));
  }
  if (!design) return py::none();
  return py::str(ToJson(ToValue(design->motion)));
}

std::string HandcraftedJson(const std::string& rig_json, const std::string& task) {
  Motion motion = HandcraftedMotion(TaskFromName(task));
  motion.base_pose = BasePoseBeforeBoard(ReadRig(rig_json));
  return ToJson(ToValue(motion));
}

}  // namespace

PYBIND11_MODULE(_calibrato, m) {
  py::register_exception<InputError>(m, "InputError", PyExc_ValueError);
  py::class_<BoardView>(m, "View")
      .def(py::init(&MakeView), py::arg("pixels"), py::arg("points"),
           py::arg("corner_ids") = py::none(), py::arg("stamp_ns") = 0)
      .def_property_readonly("pixels",
                             [](const BoardView& v) { return Rows2(v.pixels.transpose()); })
      .def_property_readonly("points",
                             [](const BoardView& v) { return Rows3(v.points_g.transpose()); })
      .def_property_readonly("corner_ids", [](const BoardView& v) { return v.corner_ids; })
      .def_property_readonly("stamp_ns", [](const BoardView& v) { return v.stamp.nanoseconds(); });
  m.def("paper_rig", [] { return ToJson(ToValue(PaperRig())); });
  m.def("read_rig", [](const std::string& path) {
    return ToJson(ToValue(RigFromValue(ReadYaml(path), nullptr)));
  });
  m.def("read_motion", [](const std::string& path) {
    return ToJson(ToValue(MotionFromValue(ReadYaml(path), nullptr)));
  });
  m.def("yaml", [](const std::string& json) { return ToYaml(ParseJson(json, "value")); });
  m.def("handcrafted_motion", &HandcraftedJson);
  m.def("path_length_m", [](const std::string& motion) { return PathLength(ReadMotion(motion)); });
  m.def("simulate", &Simulate);
  m.def("calibrate_camera", &CalibrateCameraFrom);
  m.def("calibrate_camera_imu", &CalibrateCameraImuFrom);
  m.def("information", &ExpectedInformation);
  m.def("plan", &Plan);
}

}  // namespace calibrato
