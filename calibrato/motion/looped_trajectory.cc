#include "calibrato/motion/looped_trajectory.h"

#include <array>
#include <complex>

#include "calibrato/geometry/rpy.h"

namespace calibrato {
namespace {

constexpr std::array<int, 3> kHarmonics = {1, 2, 4};
constexpr int kNumDegreesOfFreedom = 6;
constexpr int kNumPerDegreeOfFreedom = 6;

}  // namespace

LoopCoefficients ScaledAction(const LoopCoefficients& action) {
  constexpr std::array<double, kNumDegreesOfFreedom> kScale = {1.0, 1.0, 1.0, 2.5, 5.0, 2.5};
  LoopCoefficients scaled;
  for (int i = 0; i < scaled.size(); ++i)
    scaled[i] = kScale[i / kNumPerDegreeOfFreedom] * action[i];
  return scaled;
}

LoopOffset LoopOffsetAt(const LoopCoefficients& coefficients, double theta) {
  LoopOffset offset{PoseVector::Zero(), PoseVector::Zero(), PoseVector::Zero()};
  const Eigen::Map<const Eigen::Matrix<double, kNumPerDegreeOfFreedom, kNumDegreesOfFreedom>>
      by_degree_of_freedom(coefficients.data());
  // Each harmonic is twice the one before it, and so are the angles.
  std::complex<double> turn = std::polar(1.0, theta);
  for (size_t harmonic = 0; harmonic < kHarmonics.size(); ++harmonic, turn *= turn) {
    const double q = kHarmonics[harmonic];
    const double cosine = turn.real();
    const double sine = turn.imag();
    const auto row = static_cast<Eigen::Index>(2 * harmonic);
    const PoseVector a = by_degree_of_freedom.row(row).transpose();
    const PoseVector b = by_degree_of_freedom.row(row + 1).transpose();
    offset.value += a * (cosine - 1.0) + b * sine;
    offset.first += q * (b * cosine - a * sine);
    offset.second -= q * q * (a * cosine + b * sine);
  }
  return offset;
}

Rigid3 LoopPoseAt(const BasePose& base, const LoopCoefficients& coefficients, double theta) {
  const PoseVector offset = LoopOffsetAt(coefficients, theta).value;
  return {RotationFromRpy(base.rpy_rad + offset.tail<3>()), base.xyz_m + offset.head<3>()};
}

}  // namespace calibrato
