#include "calibrato/diagnosis/merged_calibration.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Inverse of a covariance of parameters with units of their own: of the correlation, scaled back.
MatrixXd InverseOf(const MatrixXd& covariance) {
  const VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  const MatrixXd inverse =
      correlation.ldlt().solve(MatrixXd::Identity(covariance.rows(), covariance.cols()));
  const MatrixXd scaled = scale.asDiagonal() * inverse * scale.asDiagonal();
  return 0.5 * (scaled + scaled.transpose());
}

struct Mean {
  VectorXd value;
  MatrixXd covariance;
  double squared = 0.0;  ///< Sum of the squared distances, each in its own covariance.
};

Mean WeightedMean(const std::vector<VectorXd>& values, const std::vector<MatrixXd>& covariances) {
  const Index size = values.front().size();
  MatrixXd information = MatrixXd::Zero(size, size);
  VectorXd sum = VectorXd::Zero(size);
  std::vector<MatrixXd> weights;
  for (size_t i = 0; i < values.size(); ++i) {
    weights.push_back(InverseOf(covariances[i]));
    information += weights[i];
    sum += weights[i] * values[i];
  }
  Mean mean;
  mean.covariance = InverseOf(information);
  mean.value = mean.covariance * sum;
  for (size_t i = 0; i < values.size(); ++i) {
    const VectorXd away = values[i] - mean.value;
    mean.squared += away.dot(weights[i] * away);
  }
  return mean;
}

void CheckSameParameters(const std::vector<ResultParameters>& results,
                         const std::vector<std::string>& names) {
  if (results.size() < 2) {
    throw InputError({"nothing to merge", "", "one result alone",
                      "give the --out folders of at least two recordings"});
  }
  const ResultParameters& first = results.front();
  for (size_t i = 0; i < results.size(); ++i) {
    if (results[i].covariance.size() == 0) {
      throw InputError({"a result without covariance cannot be merged", names[i],
                        "nothing says how much it weighs", "leave it out"});
    }
    const auto differ = [&](const std::string& what) {
      throw InputError({"the results are not of the same parameters", names[i],
                        what + " differs from " + names.front(),
                        "calibrate all recordings with the same models and options"});
    };
    if (results[i].groups.size() != first.groups.size()) differ("the number of parameters");
    for (size_t g = 0; g < first.groups.size(); ++g) {
      const ParameterGroup& group = results[i].groups[g];
      if (group.names != first.groups[g].names) differ(group.name);
      const VectorXd here = results[i].CovarianceOf({group.name}).diagonal();
      const VectorXd there = first.CovarianceOf({group.name}).diagonal();
      const VectorXd difference = group.DifferenceTo(first.groups[g]);
      for (Index k = 0; k < here.size(); ++k) {
        const bool is_held = !(here(k) > 0.0);
        // A rotation less itself is zero but for rounding.
        const bool is_moved = !(std::abs(difference(k)) <= 1e-12);
        if (is_held != !(there(k) > 0.0) || (is_held && is_moved)) {
          differ("what " + group.names[static_cast<size_t>(k)] + " was held at");
        }
      }
    }
  }
}

// Differences of a result to the first, all groups one after the other.
VectorXd DifferenceOf(const ResultParameters& result, const ResultParameters& first) {
  VectorXd all(first.covariance.rows());
  Index begin = 0;
  for (size_t g = 0; g < first.groups.size(); ++g) {
    const VectorXd difference = result.groups[g].DifferenceTo(first.groups[g]);
    all.segment(begin, difference.size()) = difference;
    begin += difference.size();
  }
  return all;
}

Mean MeanOfFree(const std::vector<VectorXd>& values, const std::vector<MatrixXd>& covariances,
                const std::vector<Index>& free) {
  std::vector<VectorXd> free_values;
  std::vector<MatrixXd> free_covariances;
  for (size_t i = 0; i < values.size(); ++i) {
    free_values.push_back(values[i](free));
    free_covariances.push_back(covariances[i](free, free));
  }
  return WeightedMean(free_values, free_covariances);
}

}  // namespace

MergedCalibration MergeCalibrations(const std::vector<ResultParameters>& results,
                                    const std::vector<std::string>& names) {
  CheckSameParameters(results, names);
  const ResultParameters& first = results.front();
  const auto num_results = static_cast<Index>(results.size());
  std::vector<VectorXd> values;
  std::vector<MatrixXd> covariances;
  for (const ResultParameters& result : results) {
    values.push_back(DifferenceOf(result, first));
    covariances.push_back(result.covariance);
  }
  std::vector<Index> free;
  for (Index k = 0; k < first.covariance.rows(); ++k) {
    if (first.covariance(k, k) > 0.0) free.push_back(k);
  }
  if (free.empty()) {
    throw InputError(
        {"nothing to merge", "", "every parameter was held", "calibrate without holding them"});
  }
  const Mean mean = MeanOfFree(values, covariances, free);
  VectorXd delta = VectorXd::Zero(first.covariance.rows());
  delta(free) = mean.value;
  MergedCalibration merged;
  merged.covariance = MatrixXd::Zero(delta.size(), delta.size());
  merged.covariance(free, free) = mean.covariance;

  VectorXd scale = VectorXd::Ones(delta.size());
  Index begin = 0;
  for (const ParameterGroup& group : first.groups) {
    const Index size = group.size();
    MergedCalibration::Group out;
    out.merged = group.Perturbed(delta.segment(begin, size));
    out.deviations.resize(size, num_results);
    out.sigmas.resize(size, num_results);
    for (Index i = 0; i < num_results; ++i) {
      const auto n = static_cast<size_t>(i);
      out.deviations.col(i) = results[n].Find(group.name)->DifferenceTo(out.merged);
      out.sigmas.col(i) = covariances[n].diagonal().segment(begin, size).cwiseSqrt();
    }
    const MatrixXd about_mean = out.deviations.colwise() - out.deviations.rowwise().mean();
    out.repeatability =
        (about_mean.rowwise().squaredNorm() / static_cast<double>(num_results - 1)).cwiseSqrt();
    std::vector<Index> of_group;
    for (const Index k : free) {
      if (k >= begin && k < begin + size) of_group.push_back(k);
    }
    if (!of_group.empty()) {
      out.scatter.statistic = MeanOfFree(values, covariances, of_group).squared;
      out.scatter.degrees = static_cast<double>((num_results - 1) * of_group.size());
      out.scatter.probability = ChiSquareTail(out.scatter.statistic, out.scatter.degrees);
    }
    merged.groups.push_back(std::move(out));
    begin += size;
  }
  // Several groups are tested: each must be as much rarer by chance (Bonferroni).
  begin = 0;
  for (MergedCalibration::Group& group : merged.groups) {
    const auto num_groups = static_cast<double>(merged.groups.size());
    if (group.scatter.probability < kSignificance / num_groups) {
      group.sigma_scale = std::sqrt(group.scatter.statistic / group.scatter.degrees);
    }
    scale.segment(begin, group.merged.size()).setConstant(group.sigma_scale);
    begin += group.merged.size();
  }
  merged.covariance = scale.asDiagonal() * merged.covariance * scale.asDiagonal();
  return merged;
}

std::vector<Finding> FindingsOf(const MergedCalibration& merged) {
  std::vector<Finding> findings;
  for (const MergedCalibration::Group& group : merged.groups) {
    if (group.sigma_scale <= 1.0) continue;
    findings.push_back(
        {Severity::kWarn,
         Format("%s scatters %.1f times as far between the recordings as their covariances say",
                group.merged.name.c_str(), group.sigma_scale),
         "its sigmas are multiplied by as much; did the rig change between them (focus, a knock, "
         "temperature), or does the model not fit the lens?"});
  }
  return findings;
}

}  // namespace calibrato
