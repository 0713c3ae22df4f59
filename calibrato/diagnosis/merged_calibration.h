#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrato/calibration/comparison.h"
#include "calibrato/diagnosis/finding.h"
#include "calibrato/diagnosis/result_parameters.h"

namespace calibrato {

/// Calibrations of one rig from several recordings, merged into one.
///
/// The estimate is the weighted mean, each result x_i by the inverse of its covariance C_i:
///
///     x = C sum C_i^-1 x_i,   C = (sum C_i^-1)^-1
///
/// How far the results lie apart is compared with what their covariances say, group by group: with
/// x_g that group's own weighted mean, sum (x_i - x_g)' C_i,g^-1 (x_i - x_g) is chi-square with
/// (n - 1) d degrees of freedom where covariances tell the truth. Where it is significantly more,
/// the group's standard deviations are multiplied by the root of the ratio (Birge 1932, as within
/// one recording). They are never made smaller. What all recordings have in common (the board, a
/// lens that all were given) no scatter shows.
struct MergedCalibration {
  struct Group {
    ParameterGroup merged;
    Significance scatter;      ///< Of the results about their mean.
    double sigma_scale = 1.0;  ///< >= 1
    /// One column a result: how far it lies from the merged values.
    Eigen::MatrixXd deviations;
    Eigen::MatrixXd sigmas;  ///< ... and what its own covariance says.
    /// Standard deviation over the results, n - 1 in its denominator: the repeatability, which
    /// knows nothing of covariances.
    Eigen::VectorXd repeatability;
  };
  std::vector<Group> groups;
  /// Marginal, of all groups one after the other, scaled by the groups' sigma_scale.
  Eigen::MatrixXd covariance;
};

/// @param names  One a result, for errors.
/// @throws InputError: fewer than two results, without covariance, of different parameters, or with
/// a parameter that was held at different values.
[[nodiscard]] MergedCalibration MergeCalibrations(const std::vector<ResultParameters>& results,
                                                  const std::vector<std::string>& names);

/// A warning for each group that scatters by more than its covariances say.
[[nodiscard]] std::vector<Finding> FindingsOf(const MergedCalibration& merged);

}  // namespace calibrato
