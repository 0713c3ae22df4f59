#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/value.h"

// What a calibration's result estimates, as one vector with one covariance, so that results can be
// compared and merged without asking of what they are.

namespace calibrato {

/// Parameters that belong together: a lens, a pose, a time offset, an IMU's intrinsics.
struct ParameterGroup {
  std::string name;                ///< "cam0 lens", "cam1 pose", "cam0 time offset", "imu0 axes"
  std::vector<std::string> names;  ///< As in the covariance: "cam0.fu", .. (docs/formats.md)
  Eigen::VectorXd values;          ///< What three of a rotation say is in `rotations`; 0 here.
  /// Where a rotation stands among the names, and which; perturbed from the left (rigid3.h).
  std::vector<std::pair<Eigen::Index, Eigen::Matrix3d>> rotations = {};

  [[nodiscard]] Eigen::Index size() const { return values.size(); }
  /// The delta with from.Perturbed(delta) == *this. @pre both have the same names
  [[nodiscard]] Eigen::VectorXd DifferenceTo(const ParameterGroup& from) const;
  [[nodiscard]] ParameterGroup Perturbed(const Eigen::VectorXd& delta) const;
};

/// All of a result that a covariance is of and that the next recording finds again: not its biases,
/// which walk, nor gravity, which is the board's place.
struct ResultParameters {
  std::vector<ParameterGroup> groups;
  /// Marginal, of all groups one after the other; empty if the result has none.
  Eigen::MatrixXd covariance;

  /// nullptr if there is no group of that name.
  [[nodiscard]] const ParameterGroup* Find(const std::string& group) const;
  /// Of some groups, one after the other; empty if unknown. @pre there are such groups
  [[nodiscard]] Eigen::MatrixXd CovarianceOf(const std::vector<std::string>& group_names) const;
};

/// From a result.json of kind `camera`, `camera-imu` or `merge`.
/// @param chain  camchain-imucam.yaml beside it, for lenses that were estimated along; null for
///               kind `camera`.
/// @throws InputError: of another kind, or without an estimate.
[[nodiscard]] ResultParameters ParametersOf(const Value& result, const Value* chain);

/// Kind of the calibration: `camera` or `camera-imu`, also of a merged one. @throws InputError
[[nodiscard]] std::string CalibrationKind(const Value& result);

}  // namespace calibrato
