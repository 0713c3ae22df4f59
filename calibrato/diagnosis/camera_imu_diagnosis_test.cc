#include "calibrato/diagnosis/camera_imu_diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/calibration/prediction_error.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/diagnosis/camera_imu_document.h"
#include "calibrato/diagnosis/camera_imu_plots.h"

namespace calibrato {
namespace {

CameraImuReport ReportOn(const CameraImuProblem& problem) {
  CameraImuReport report{problem, CalibrateCameraImu(problem), {}, {}, {}};
  report.resolutions.assign(problem.cameras.size(), SyntheticCameraImu().resolution);
  report.diagnosis = DiagnoseCameraImu(problem, report.calibration);
  return report;
}

CameraImuReport ReportOn(const SyntheticCameraImu& truth, uint64_t seed = 1) {
  Rng rng(seed);
  return ReportOn(truth.Problem(rng));
}

// Whether a finding of this severity says these words.
bool Says(const CameraImuReport& report, Severity severity, const std::string& words) {
  const auto& findings = report.diagnosis.findings;
  return std::any_of(findings.begin(), findings.end(), [&](const Finding& finding) {
    return finding.severity == severity &&
           (finding.what + " | " + finding.remedy).find(words) != std::string::npos;
  });
}

TEST(SigmasOf, NamesWhatIsUndeterminedAndKnowsTheRest) {
  // The first parameter is known to 1/2; of the other two only their sum is.
  CameraImuInformation information;
  information.names = {"a", "b", "c"};
  information.information_matrix.resize(3, 3);
  information.information_matrix << 4, 0, 0, 0, 1, 1, 0, 1, 1;
  const std::vector<double> sigmas = SigmasOf(information);
  EXPECT_NEAR(sigmas[0], 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(sigmas[1]));
  EXPECT_TRUE(std::isnan(sigmas[2]));
}

TEST(DiagnoseCameraImu, PassesAGoodRecordingWithoutAWord) {
  const CameraImuReport report = ReportOn(SyntheticCameraImu());
  EXPECT_EQ(VerdictOf(report), Verdict::kPass) << CameraImuText(report);
  EXPECT_TRUE(report.diagnosis.findings.empty()) << CameraImuText(report);
  ASSERT_EQ(report.diagnosis.parameters.size(), 7u);
  EXPECT_EQ(report.diagnosis.parameters[0].name, "cam0.rot_x");
  EXPECT_EQ(report.diagnosis.parameters[6].name, "cam0.time_offset");
  ASSERT_TRUE(report.diagnosis.split.has_value());
  EXPECT_FALSE(report.diagnosis.split->cameras[0].significance.is_significant());
  EXPECT_NEAR(report.diagnosis.residuals->gyros[0].normalised, 1.0, 0.1);
  EXPECT_NEAR(report.diagnosis.residuals->accels[0].normalised, 1.0, 0.1);
}

TEST(DiagnoseCameraImu, KnowsMoreTheLongerItLooks) {
  const CameraImuReport report = ReportOn(SyntheticCameraImu());
  const std::vector<CameraImuKnowledge>& knowledge = report.diagnosis.knowledge;
  ASSERT_GT(knowledge.size(), 4u);
  for (size_t k = 1; k < knowledge.size(); ++k) {
    EXPECT_LT(knowledge[k].translation_sigma_m, knowledge[k - 1].translation_sigma_m * (1 + 1e-6));
  }
  // At the end it knows what the calibration states.
  double squared = 0.0;
  for (size_t k = 3; k < 6; ++k) squared += std::pow(report.diagnosis.parameters[k].sigma, 2);
  EXPECT_NEAR(knowledge.back().translation_sigma_m, std::sqrt(squared), 0.02 * std::sqrt(squared));
}

TEST(DiagnoseCameraImu, IsInconclusiveWhereTheRigHardlyTurned) {
  SyntheticCameraImu truth;
  truth.rotation = 0.01;
  truth.imu_noise.accel_noise_density *= 3.0;
  const CameraImuReport report = ReportOn(truth);
  EXPECT_EQ(VerdictOf(report), Verdict::kInconclusive) << CameraImuText(report);
  EXPECT_TRUE(Says(report, Severity::kInconclusive, "cam0: the translation along"));
  EXPECT_TRUE(Says(report, Severity::kInconclusive, "which it hardly did"));
}

TEST(DiagnoseCameraImu, FailsWhereTheNoiseIsFarFromWhatIsStated) {
  Rng rng(1);
  CameraImuProblem problem = SyntheticCameraImu().Problem(rng);
  problem.imus[0].noise.gyro_noise_density /= 10.0;
  const CameraImuReport report = ReportOn(problem);
  EXPECT_EQ(VerdictOf(report), Verdict::kFail) << CameraImuText(report);
  EXPECT_TRUE(Says(report, Severity::kFail, "imu0: the gyroscope does not fit"));
  EXPECT_EQ(report.diagnosis.parameters[0].verdict, Verdict::kFail);
}

TEST(DiagnoseCameraImu, CountsWhatWasLeftOut) {
  Rng rng(1);
  CameraImuProblem problem = SyntheticCameraImu().Problem(rng);
  for (const size_t k : {500, 501, 900}) problem.imus[0].stream.gyro[k].value.x() += 3.0;
  BoardView& late = problem.cameras[0].views[50];
  late.pixels.row(0).array() += 40.0;
  const CameraImuReport report = ReportOn(problem);
  const std::vector<VectorSample>& gyro = problem.imus[0].stream.gyro;
  const std::vector<LeftOut>& outliers = report.diagnosis.residuals->gyros[0].outliers;
  ASSERT_EQ(outliers.size(), 3U);
  EXPECT_EQ(outliers[0].stamp, gyro[500].stamp);
  EXPECT_EQ(outliers[2].stamp, gyro[900].stamp);
  EXPECT_TRUE(Says(report, Severity::kInfo, "imu0: 3 of"));
  EXPECT_TRUE(Says(report, Severity::kInfo, late.name));
  // By stamp and by time, in words and in the result.
  const Time start = report.calibration.state->start;
  const double spike_s = (gyro[500].stamp - start).seconds();
  EXPECT_TRUE(Says(report, Severity::kInfo, Format("left out, %.3f, ", spike_s)));
  const Value result = CameraImuResult(report);
  const Value& of_gyro = result.At("imus").elements()[0].At("gyro");
  EXPECT_EQ(of_gyro.At("num_outliers").AsInt(), 3);
  ASSERT_EQ(of_gyro.At("outlier_stamps_ns").size(), 3U);
  EXPECT_EQ(of_gyro.At("outlier_stamps_ns").elements()[1].AsInt(), gyro[501].stamp.nanoseconds());
  EXPECT_NEAR(of_gyro.At("outlier_times_s").AsDoubles()[0], spike_s, 1e-6);
  const Value& camera = result.At("cameras").elements()[0];
  ASSERT_EQ(camera.At("rejected_view_stamps_ns").size(), 1U);
  EXPECT_EQ(camera.At("rejected_view_stamps_ns").elements()[0].AsInt(), late.stamp.nanoseconds());
  EXPECT_NEAR(camera.At("rejected_view_times_s").AsDoubles()[0],
              (late.stamp - start).seconds() + camera.At("time_offset_s").AsDouble(), 1e-6);
}

TEST(DiagnoseCameraImu, SeesThatTheCameraMovedOnTheRigHalfWayThrough) {
  SyntheticCameraImu truth;
  Rng rng(1);
  CameraImuProblem problem = truth.Problem(rng);
  // The second half's images are those of a camera 2 mm to the side.
  SyntheticCameraImu moved = truth;
  moved.T_c_i[0].t.x() += 0.002;
  Rng other_rng(2);
  const CameraImuProblem other = moved.Problem(other_rng);
  std::vector<BoardView>& views = problem.cameras[0].views;
  views.resize(views.size() / 2);
  for (const BoardView& view : other.cameras[0].views) {
    if (view.stamp > views.back().stamp) views.push_back(view);
  }
  const CameraImuReport report = ReportOn(problem);
  EXPECT_TRUE(Says(report, Severity::kWarn, "disagree: cam0.pos_x by")) << CameraImuText(report);
}

// The lens that the estimator is given is another one than that of the images: errors that last,
// and differ with where in the image the board is.
TEST(DiagnoseCameraImu, WidensSigmasWhereErrorsLast) {
  SyntheticCameraImu truth;
  truth.duration_s = 20.0;
  Rng rng(1);
  CameraImuProblem problem = truth.Problem(rng);
  Eigen::VectorXd parameters = truth.model.parameters();
  parameters(4) += 0.01;
  problem.cameras[0].model = CameraModel("pinhole-radtan", parameters);
  const CameraImuReport report = ReportOn(problem);
  ASSERT_TRUE(report.diagnosis.scatter.has_value());
  const double scale = report.diagnosis.sigma_scale();
  EXPECT_GT(scale, 1.5);
  EXPECT_TRUE(Says(report, Severity::kInfo, "all sigmas were multiplied by that"));
  const std::vector<double> as_if_independent = SigmasOf(report.calibration.information);
  EXPECT_DOUBLE_EQ(report.diagnosis.parameters[3].sigma, scale * as_if_independent[3]);
  const Value result = CameraImuResult(report);
  EXPECT_DOUBLE_EQ(result.At("covariance").At("matrix").elements()[3].AsDoubles()[3],
                   std::pow(scale * as_if_independent[3], 2));
}

TEST(ScatterOfParts, IsChanceWhereErrorsAreIndependent) {
  const int n = FullSample() ? 200 : 8;
  double ratio = 0.0;
  int num_scaled = 0;
  for (int seed = 0; seed < n; ++seed) {
    SyntheticCameraImu truth;
    truth.duration_s = 8.0;
    Rng rng(static_cast<uint64_t>(seed));
    const CameraImuProblem problem = truth.Problem(rng);
    const auto scatter = ScatterOfParts(problem, CalibrateCameraImu(problem), 4);
    ASSERT_TRUE(scatter.has_value());
    ratio += scatter->ratio / n;
    num_scaled += scatter->sigma_scale() > 1.0 ? 1 : 0;
  }
  // Chi-square with 21 degrees of freedom, over 21.
  EXPECT_NEAR(ratio, 1.0, 3.5 * std::sqrt(2.0 / (21.0 * n)));
  EXPECT_LE(num_scaled, FullSample() ? 5 : 1);
}

// The test promises what a solve with the further parameters finds.
TEST(CompareImuModels, FindsMisalignedAxesFromEitherModel) {
  SyntheticCameraImu truth;
  truth.duration_s = 20.0;
  truth.intrinsics.R_gyro_i = ExpSo3({0.004, -0.003, 0.005});
  truth.intrinsics.M_accel(2, 2) = 1.003;
  Rng rng(3);
  CameraImuProblem problem = truth.Problem(rng);
  const CameraImuReport simple = ReportOn(problem);
  problem.imus[0].model = ImuModelKind::kScaleMisalignment;
  const CameraImuReport rich = ReportOn(problem);
  ASSERT_TRUE(simple.diagnosis.imu_models.has_value());
  ASSERT_TRUE(rich.diagnosis.imu_models.has_value());
  for (const CameraImuReport* report : {&simple, &rich}) {
    const ImuModelComparison& models = *report->diagnosis.imu_models;
    EXPECT_EQ(models.significance.degrees, 24.0);
    EXPECT_TRUE(models.significance.is_significant());
  }
  EXPECT_TRUE(Says(simple, Severity::kWarn, "give --imu-model scale-misalignment"));
  EXPECT_FALSE(Says(rich, Severity::kWarn, "--imu-model"));
  // For the richer model, whichever was solved.
  EXPECT_LT(simple.diagnosis.imu_models->qaic_change(), -20.0);
  EXPECT_LT(rich.diagnosis.imu_models->qaic_change(), -20.0);
  const Eigen::Vector<double, 6> change = rich.calibration.state->cameras[0].T_c_i.DifferenceTo(
      simple.calibration.state->cameras[0].T_c_i);
  EXPECT_LT((simple.diagnosis.imu_models->change[0] - change).norm(), 0.2 * change.norm());
}

TEST(CompareImuModels, AreSilentAboutAPerfectImu) {
  const CameraImuReport report = ReportOn(SyntheticCameraImu());
  ASSERT_TRUE(report.diagnosis.imu_models.has_value());
  EXPECT_FALSE(report.diagnosis.imu_models->significance.is_significant());
  EXPECT_GT(report.diagnosis.imu_models->qaic_change(), 0.0);
}

TEST(CameraImuResult, HasTheKeysOfTheFormats) {
  const CameraImuReport report = ReportOn(SyntheticCameraImu());
  const Value result = CameraImuResult(report);
  EXPECT_EQ(result.At("kind").AsString(), "camera-imu");
  EXPECT_EQ(result.At("verdict").AsString(), "pass");
  const Value& camera = result.At("cameras").elements()[0];
  EXPECT_EQ(camera.At("T_cam_imu").AsDoubles(16)[15], 1.0);
  EXPECT_NEAR(camera.At("time_offset_s").AsDouble(), 0.0073, 1e-4);
  for (const char* key : {"rotation_sigma_rad", "translation_sigma_m"}) {
    for (const double sigma : camera.At(key).AsDoubles(3)) EXPECT_GT(sigma, 0.0);
  }
  EXPECT_GT(camera.At("time_offset_sigma_s").AsPositive(), 0.0);
  EXPECT_EQ(result.At("imus").elements()[0].At("gyro_bias").AsDoubles(3).size(), 3u);
  EXPECT_EQ(result.At("gravity_g").AsDoubles(3).size(), 3u);
  EXPECT_EQ(result.At("information").At("eigenvalues").AsDoubles(6).size(), 6u);
  EXPECT_NEAR(result.At("residuals").At("accel_normalised").AsDouble(), 1.0, 0.1);
  const std::vector<Value>& names = result.At("covariance").At("names").elements();
  const std::vector<Value>& matrix = result.At("covariance").At("matrix").elements();
  ASSERT_EQ(matrix.size(), names.size());
  // Behind the calibration the biases, whose sigmas stand with them.
  const size_t first = names.size() - 6;
  const Value& imu = result.At("imus").elements()[0];
  for (size_t k = 0; k < 6; ++k) {
    const std::string sensor = k < 3 ? "gyro_bias" : "accel_bias";
    EXPECT_EQ(names[first + k].AsString(), "imu0." + sensor + "_" + "xyz"[k % 3]);
    EXPECT_DOUBLE_EQ(imu.At(sensor + "_sigma").AsDoubles(3)[k % 3],
                     std::sqrt(matrix[first + k].AsDoubles()[first + k]));
  }
}

// Of that camera, by that covariance, times the scale of all sigmas; that it is the error to be
// expected is shown beside the function.
TEST(CameraImuResult, StatesThePredictionErrorThatTheScaledCovarianceSays) {
  CameraImuReport report = ReportOn(SyntheticCameraImu());
  report.resolutions[0] = {400, 300};
  ASSERT_TRUE(report.diagnosis.scatter.has_value());
  report.diagnosis.scatter->ratio = 2.25;
  report.diagnosis.scatter->probability = 0.0;
  const CameraImuState& state = *report.calibration.state;
  const CameraImuLayout layout(report.problem, state.T_g_i.order());
  const double expected =
      ExpectedPredictionErrorPx(state.cameras[0], report.resolutions[0], layout.cameras[0],
                                report.calibration.information.covariance);
  EXPECT_GT(expected, 0.0);
  EXPECT_DOUBLE_EQ(
      CameraImuResult(report).At("cameras").elements()[0].At("prediction_error_px").AsDouble(),
      1.5 * expected);
}

// What to do depends on why it stopped.
TEST(DiagnoseCameraImu, AsksForMoreIterationsOnlyWhereTheyWereUsedUp) {
  CameraImuReport report = ReportOn(SyntheticCameraImu());
  for (const Termination termination : {Termination::kIterationLimit, Termination::kNoStepHelps}) {
    report.calibration.termination = termination;
    report.diagnosis = DiagnoseCameraImu(report.problem, report.calibration);
    EXPECT_TRUE(Says(report, Severity::kFail,
                     "did not converge: " + std::string(TerminationName(termination))));
    EXPECT_EQ(Says(report, Severity::kFail, "--max-iterations"),
              termination == Termination::kIterationLimit);
  }
}

// One richer IMU makes the result that of the richer model, whichever IMU it is.
TEST(CompareImuModels, NameTheModelInUse) {
  const auto used = [](const CameraImuReport& report) {
    return CameraImuResult(report).At("imu_models").At("used").AsString();
  };
  EXPECT_EQ(used(ReportOn(SyntheticCameraImu())), "calibrated");
  Rng rng(1);
  CameraImuProblem problem = SyntheticCameraImu().Problem(rng);
  problem.imus[0].model = ImuModelKind::kScaleMisalignmentSizeEffect;
  EXPECT_EQ(used(ReportOn(problem)), "scale-misalignment");
  problem.imus.push_back(problem.imus[0]);
  problem.imus[0].model = ImuModelKind::kCalibrated;
  EXPECT_EQ(used(ReportOn(problem)), "scale-misalignment");
}

TEST(CameraImuResult, WithoutAnEstimateSaysWhy) {
  Rng rng(1);
  CameraImuProblem problem = SyntheticCameraImu().Problem(rng);
  for (BoardView& view : problem.cameras[0].views) {
    view.stamp = view.stamp + Duration::FromSeconds(1000.0);
  }
  const CameraImuReport report = ReportOn(problem);
  const Value result = CameraImuResult(report);
  EXPECT_EQ(result.At("verdict").AsString(), "fail");
  EXPECT_EQ(result.Find("cameras"), nullptr);
  EXPECT_EQ(CameraImuPlots(report).size(), 0u);
}

TEST(CameraImuPlots, PredictWhatWasMeasured) {
  const CameraImuReport report = ReportOn(SyntheticCameraImu());
  const Value plots = CameraImuPlots(report);
  const Value& gyro = plots.At("imus").elements()[0].At("gyro");
  const double sigma = gyro.At("stddev").AsDouble();
  for (int axis = 0; axis < 3; ++axis) {
    const auto high = [&](const char* what) {
      return gyro.At(what).elements()[size_t(axis)].At("high").AsDoubles();
    };
    const std::vector<double> measured = high("measured");
    const std::vector<double> predicted = high("predicted");
    ASSERT_EQ(measured.size(), predicted.size());
    for (size_t k = 0; k < measured.size(); ++k) {
      EXPECT_NEAR(measured[k], predicted[k], 6.0 * sigma + 1e-4);
    }
  }
  EXPECT_LE(plots.At("cameras").elements()[0].At("corner_residuals").size(), 1500u);
  EXPECT_EQ(plots.At("board_outline_g").size(), 4u);
  EXPECT_NEAR(plots.At("cameras").elements()[0].At("median_interval_ms").AsDouble(), 50.0, 1e-3);
}

}  // namespace
}  // namespace calibrato
