#pragma once

#include <limits>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/calibration/comparison.h"
#include "calibrato/diagnosis/comparison_document.h"
#include "calibrato/diagnosis/result_parameters.h"

namespace calibrato {

/// Two results of `calibrate camera-imu`, of different recordings of one rig.
struct CameraImuComparison {
  /// A pose, a time offset, an IMU's axes: tested by itself.
  struct Group {
    std::string name;  ///< "cam0 pose"
    std::vector<std::string> names;
    Eigen::VectorXd difference;  ///< Second less first [rad, m, s, px, -].
    Eigen::VectorXd sigma;       ///< Of the difference; empty if a covariance is missing.
    Significance significance;
  };
  std::vector<Group> groups;  ///< What both estimated.
  /// How far the two place one point from each other in the image, as a filter would suffer it
  /// (prediction_error.h), and what the covariances let expect; NaN without one.
  struct Camera {
    std::string name;
    double difference_px = std::numeric_limits<double>::quiet_NaN();
    double expected_px = std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<Camera> cameras;
};

/// @param first_chain, second_chain  camchain-imucam.yaml beside each result.json.
/// @throws InputError: of another kind, other cameras, without an estimate.
[[nodiscard]] CameraImuComparison CompareCameraImuResults(const Value& first,
                                                          const Value& first_chain,
                                                          const Value& second,
                                                          const Value& second_chain);

/// Where several groups are tested, each must be as much rarer by chance (Bonferroni).
/// @param level  How often all tests together may find a difference where there is none.
[[nodiscard]] Agreement AgreementOf(const CameraImuComparison& comparison,
                                    double level = kSignificance);

/// {"kind": "diff", "of": "camera-imu", "agreement", "level", "cameras": [{"name", "difference_px",
/// "expected_difference_px"}], "groups": [{"name", "probability", "statistic",
/// "degrees_of_freedom", "parameters": [{"name", "difference", "sigma"}]}]}
[[nodiscard]] Value ComparisonResult(const CameraImuComparison& comparison,
                                     double level = kSignificance);

[[nodiscard]] std::string ComparisonText(const CameraImuComparison& comparison,
                                         double level = kSignificance);

}  // namespace calibrato
