#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/calibration/coverage.h"
#include "calibrato/calibration/design_criterion.h"
#include "calibrato/mdp/original_mistakes.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"
#include "calibrato/sensors/rig.h"

// What is known of a calibration at one step of an episode: what observations are made of, and what
// rewards are increments of. Before any data both are those of the prior.

namespace calibrato {

/// What a camera that nobody calibrated is off by, before any data [px]: where the reprojection
/// term starts from.
inline constexpr double kPriorReprojectionPx = 1.0;

/// Of camera 0.
struct IntrinsicStatus {
  Eigen::Vector4d estimate =
      Eigen::Vector4d::Zero();  ///< fu fv pu pv [px]; the prior mean while not determined.
  Eigen::Matrix4d covariance =
      Eigen::Matrix4d::Zero();   ///< Marginal, of the data together with the prior [px^2].
  double information = 0.0;      ///< InformationStatus [nat].
  double relative_error = 0.0;   ///< [-]
  double reprojection_px = 0.0;  ///< Root mean square over corners [px].
  /// The whole calibration, where the data determine it: for those who build on it.
  std::optional<CameraModel> model;
  Eigen::MatrixXd model_covariance;  ///< Of all parameters of `model`.
};

/// Standard deviations of fu fv pu pv before any data [px]: 34.8 px is 0.05 rad of field of view
/// (paper, Table 4); the 10 px of the centre are ours, since the paper's rigs have none.
[[nodiscard]] Eigen::Vector4d PriorIntrinsicsSigma();

[[nodiscard]] IntrinsicStatus PriorIntrinsicStatus(const Camera& truth, DesignCriterion criterion);

/// Calibrates the camera anew from all frames that count so far, as an IntrinsicTaskModel.
/// @return That of the prior while the data do not determine the camera: fewer than three frames,
/// not converged, rank-deficient, or sigma(f) / f above 5 %.
[[nodiscard]] IntrinsicStatus CalibrateIntrinsics(const std::vector<BoardView>& views,
                                                  const Camera& truth, DesignCriterion criterion,
                                                  int max_iterations);

/// Of T_cam_imu.
struct ExtrinsicStatus {
  Rigid3 estimate;
  /// Marginal, [rotation, translation].
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double information = 0.0;  ///< InformationStatus [nat].
  /// Trace of the conditional covariance, unnormalised: the original's. 0 before any data.
  double conditional_trace = 0.0;
  double relative_error = 0.0;   ///< [-]
  double reprojection_px = 0.0;  ///< Root mean square over corners [px].
};

[[nodiscard]] ExtrinsicStatus PriorExtrinsicStatus(const Rigid3& truth, DesignCriterion criterion);

/// How the extrinsics are calibrated.
struct ExtrinsicSolve {
  DesignCriterion criterion = DesignCriterion::kA;
  int max_iterations = 50;  ///< >= 1
  Mistakes mistakes;        ///< Of these: swapped noise.
  /// The camera as estimated, with its covariance; not given: the truth, taken as exact.
  std::optional<CameraModel> camera;
  Eigen::MatrixXd camera_covariance;
};

/// Calibrates camera and IMU anew from all that was recorded so far.
/// @param truth  What the estimate is compared with.
/// @return Nothing while the data do not determine the extrinsics.
[[nodiscard]] std::optional<ExtrinsicStatus> CalibrateExtrinsics(
    const Rig& rig, const std::vector<BoardView>& views, const ImuStream& imu, const Rigid3& truth,
    const ExtrinsicSolve& solve);

/// x y z [m] and fixed-axis roll pitch yaw [rad] of T_cam_imu: the paper's theta.
[[nodiscard]] Eigen::Matrix<double, 6, 1> ExtrinsicVector(const Rigid3& T_c_i);

/// ||estimate - truth|| / ||truth|| of these vectors, angles the short way round: the paper's
/// relative error, which mixes metres with radians [-].
[[nodiscard]] double RelativeExtrinsicError(const Rigid3& estimate, const Rigid3& truth);

/// ||[fu fv pu pv] - truth|| / ||truth||: the paper's relative error [-].
[[nodiscard]] double RelativeIntrinsicError(const Eigen::Vector4d& estimate,
                                            const Eigen::Vector4d& truth);

/// What is known of T_cam_imu before any data: the mean and spread of the paper's Table 4, 0.1 rad
/// and 0.01 m, as covariance of [rotation, translation].
[[nodiscard]] Rigid3 PriorMeanExtrinsics();
[[nodiscard]] Eigen::Matrix<double, 6, 6> PriorExtrinsicsCovariance();

/// The truth as the original implementation had it (Mistake::kWrongTruth): the IMU slides 0.03 m
/// along its finger's axis, which it took for unturned.
[[nodiscard]] Rigid3 OriginalTruth(const Rigid3& T_c_i);

/// How much is known [nat]: minus half the logarithm of the criterion of the normalised marginal
/// covariance (of kD, per parameter). The paper takes minus the trace itself; the increment of that
/// from the prior's 30,300 to a few after one loop drowns all later ones, and a network that
/// predicts it learns nothing else. The logarithm orders calibrations alike, and gives a halved
/// sigma the same reward, log 2, wherever it happens.
[[nodiscard]] double InformationStatus(DesignCriterion criterion,
                                       const Eigen::Matrix<double, 6, 6>& covariance);
/// Of fu fv pu pv, over 1 px.
[[nodiscard]] double IntrinsicInformationStatus(DesignCriterion criterion,
                                                const Eigen::Matrix4d& covariance);

/// What a policy sees of each, see IntrinsicEnvironment and ExtrinsicEnvironment.
[[nodiscard]] Eigen::VectorXd ObservationOf(const IntrinsicStatus& status,
                                            const Coverage& coverage);       // 8 numbers
[[nodiscard]] Eigen::VectorXd ObservationOf(const ExtrinsicStatus& status);  // 12 numbers

}  // namespace calibrato
