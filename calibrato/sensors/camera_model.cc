#include "calibrato/sensors/camera_model.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

constexpr std::array<const char*, 9> kPinholeParameterNames = {"fu", "fv", "pu", "pv", "k1",
                                                               "k2", "p1", "p2", "k3"};
// Where in that list the third radial term stands, behind the tangential ones.
constexpr int kK3 = 8;

// The smallest positive root of 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3, the derivative of r c(r^2) by r,
// or infinity. Between the stationary points of the cubic there is at most one root: bisection
// finds it.
double SmallestStationarySquaredRadius(double k1, double k2, double k3) {
  const auto slope = [&](double s) { return 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3)); };
  // A lens that reaches s = 1e4 sees 179 degrees: beyond any pinhole camera.
  constexpr double kEnd = 1e4;
  std::vector<double> ends = {0.0};
  const double a = 21.0 * k3;
  const double b = 10.0 * k2;
  const double c = 3.0 * k1;
  if (a == 0.0) {
    if (b != 0.0) ends.push_back(-c / b);
  } else if (const double discriminant = b * b - 4.0 * a * c; discriminant >= 0.0) {
    const double root = std::sqrt(discriminant);
    ends.push_back((-b - root) / (2.0 * a));
    ends.push_back((-b + root) / (2.0 * a));
  }
  ends.push_back(kEnd);
  std::sort(ends.begin(), ends.end());
  double low = 0.0;
  for (const double end : ends) {
    if (!(end > low) || end > kEnd) continue;
    if (slope(end) <= 0.0) {
      double high = end;
      for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (slope(middle) > 0.0 ? low : high) = middle;
      }
      return low;
    }
    low = end;
  }
  return std::numeric_limits<double>::infinity();
}

int ModelIndex(std::string_view name) {
  const auto* found = std::find(std::begin(kCameraModelNames), std::end(kCameraModelNames), name);
  if (found == std::end(kCameraModelNames)) {
    std::string known;
    for (const std::string_view candidate : kCameraModelNames) {
      known += (known.empty() ? "" : ", ") + std::string(candidate);
    }
    throw InputError(
        {"unknown camera model '" + std::string(name) + "'", "", "", "use one of " + known});
  }
  return static_cast<int>(found - std::begin(kCameraModelNames));
}

CameraModel::Variant MakeVariant(std::string_view name, const Eigen::VectorXd& parameters) {
  const int expected = CameraModel::NumParameters(name);
  if (parameters.size() != expected) {
    throw InputError(
        {"wrong number of camera parameters for " + std::string(name), "",
         "expected " + std::to_string(expected) + ", got " + std::to_string(parameters.size()),
         "give the intrinsics fu fv pu pv, then the distortion"});
  }
  if (!parameters.allFinite() || !(parameters(0) > 0.0) || !(parameters(1) > 0.0)) {
    throw InputError({"camera parameters out of range for " + std::string(name), "",
                      "focal lengths must be positive and every parameter finite",
                      "check the order fu fv pu pv"});
  }
  switch (ModelIndex(name)) {
    case 0:
      return PinholeRadtan<0>(parameters);
    case 1:
      return PinholeRadtan<4>(parameters);
    default:
      return PinholeRadtan<5>(parameters);
  }
}

}  // namespace

template <int kNumDistortion>
PinholeRadtan<kNumDistortion>::PinholeRadtan(const Parameters& parameters)
    : parameters_(parameters) {
  if constexpr (kNumDistortion > 0) {
    double k3 = 0.0;
    if constexpr (kNumDistortion == 5) k3 = parameters(kK3);
    max_squared_radius_ = SmallestStationarySquaredRadius(parameters(4), parameters(5), k3);
  }
}

template <int kNumDistortion>
bool PinholeRadtan<kNumDistortion>::Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel,
                                            JacobianPoint* J_pixel_point,
                                            JacobianParameters* J_pixel_parameters) const {
  if (!(p_c.z() > 0.0)) return false;
  const double inverse_z = 1.0 / p_c.z();
  const double x = p_c.x() * inverse_z;
  const double y = p_c.y() * inverse_z;
  const double s = x * x + y * y;
  if (!(s < max_squared_radius_)) return false;

  const double fu = parameters_(0);
  const double fv = parameters_(1);
  double xd = x;
  double yd = y;
  Eigen::Matrix2d J_distorted_ray = Eigen::Matrix2d::Identity();
  double k1 = 0.0;
  double k2 = 0.0;
  double k3 = 0.0;
  if constexpr (kNumDistortion > 0) {
    k1 = parameters_(4);
    k2 = parameters_(5);
    const double p1 = parameters_(6);
    const double p2 = parameters_(7);
    if constexpr (kNumDistortion == 5) k3 = parameters_(kK3);
    const double c = 1.0 + s * (k1 + s * (k2 + s * k3));
    xd = c * x + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x);
    yd = c * y + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y;
    const double dc = 2.0 * (k1 + s * (2.0 * k2 + s * 3.0 * k3));  // dc/dx = dc * x, dc/dy = dc * y
    const double cross = dc * x * y + 2.0 * p1 * x + 2.0 * p2 * y;
    J_distorted_ray << c + dc * x * x + 2.0 * p1 * y + 6.0 * p2 * x, cross, cross,
        c + dc * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
  }
  *pixel << fu * xd + parameters_(2), fv * yd + parameters_(3);
  if (J_pixel_point != nullptr) {
    const Eigen::Vector2d d_x = Eigen::Vector2d(fu, fv).cwiseProduct(J_distorted_ray.col(0));
    const Eigen::Vector2d d_y = Eigen::Vector2d(fu, fv).cwiseProduct(J_distorted_ray.col(1));
    J_pixel_point->col(0) = inverse_z * d_x;
    J_pixel_point->col(1) = inverse_z * d_y;
    J_pixel_point->col(2) = -inverse_z * (x * d_x + y * d_y);
  }
  if (J_pixel_parameters != nullptr) {
    JacobianParameters& J = *J_pixel_parameters;
    J.template leftCols<4>() << xd, 0.0, 1.0, 0.0, 0.0, yd, 0.0, 1.0;
    if constexpr (kNumDistortion > 0) {
      J.col(4) << fu * x * s, fv * y * s;
      J.col(5) << fu * x * s * s, fv * y * s * s;
      J.col(6) << fu * 2.0 * x * y, fv * (s + 2.0 * y * y);
      J.col(7) << fu * (s + 2.0 * x * x), fv * 2.0 * x * y;
    }
    if constexpr (kNumDistortion == 5) J.col(kK3) << fu * x * s * s * s, fv * y * s * s * s;
  }
  return true;
}

template <int kNumDistortion>
std::optional<Eigen::Vector3d> PinholeRadtan<kNumDistortion>::Unproject(
    const Eigen::Vector2d& pixel) const {
  if (!pixel.allFinite()) return std::nullopt;
  const Eigen::Vector2d distorted =
      (pixel - parameters_.template segment<2>(2)).cwiseQuotient(parameters_.template head<2>());
  if constexpr (kNumDistortion == 0) return Eigen::Vector3d(distorted.x(), distorted.y(), 1.0);

  // Newton with the step halved while it leaves the domain or does not come nearer; from the centre
  // outwards, since the undistorted pixel may itself lie outside the domain.
  const auto residual = [&](const Eigen::Vector2d& ray, Eigen::Vector2d* difference,
                            JacobianPoint* J) {
    Eigen::Vector2d projected;
    if (!Project({ray.x(), ray.y(), 1.0}, &projected, J, nullptr)) return false;
    *difference = projected - pixel;
    return true;
  };
  Eigen::Vector2d ray = distorted;
  if (!(ray.squaredNorm() < 0.5 * max_squared_radius_)) ray.setZero();
  Eigen::Vector2d difference;
  JacobianPoint J;
  for (int iteration = 0; iteration < 50; ++iteration) {
    if (!residual(ray, &difference, &J)) return std::nullopt;
    if (difference.norm() < 1e-9) return Eigen::Vector3d(ray.x(), ray.y(), 1.0);
    const Eigen::Vector2d step = -J.leftCols<2>().inverse() * difference;
    double scale = 1.0;
    Eigen::Vector2d next_difference;
    while (scale > 1e-6 && !(residual(ray + scale * step, &next_difference, nullptr) &&
                             next_difference.norm() < difference.norm())) {
      scale *= 0.5;
    }
    if (!(scale > 1e-6)) break;
    ray += scale * step;
  }
  // Rounding may keep a wide-angle pixel a little above the strict tolerance.
  if (difference.norm() < 1e-6) return Eigen::Vector3d(ray.x(), ray.y(), 1.0);
  return std::nullopt;
}

template class PinholeRadtan<0>;
template class PinholeRadtan<4>;
template class PinholeRadtan<5>;

CameraModel::CameraModel(std::string_view name, const Eigen::VectorXd& parameters)
    : model_(MakeVariant(name, parameters)) {}

int CameraModel::NumParameters(std::string_view name) {
  constexpr std::array<int, 3> kNumParameters = {4, 8, 9};
  return kNumParameters[static_cast<size_t>(ModelIndex(name))];
}

std::vector<std::string> CameraModel::ParameterNames(std::string_view name) {
  return {kPinholeParameterNames.begin(), kPinholeParameterNames.begin() + NumParameters(name)};
}

Eigen::VectorXd CameraModel::parameters() const {
  return std::visit([](const auto& model) -> Eigen::VectorXd { return model.parameters(); },
                    model_);
}

int CameraModel::num_parameters() const {
  return std::visit([](const auto& model) { return model.kNumParameters; }, model_);
}

std::optional<Eigen::Vector2d> CameraModel::Project(const Eigen::Vector3d& p_c) const {
  Eigen::Vector2d pixel;
  const bool inside = std::visit(
      [&](const auto& model) { return model.Project(p_c, &pixel, nullptr, nullptr); }, model_);
  return inside ? std::make_optional(pixel) : std::nullopt;
}

std::optional<Eigen::Vector3d> CameraModel::Unproject(const Eigen::Vector2d& pixel) const {
  return std::visit([&](const auto& model) { return model.Unproject(pixel); }, model_);
}

bool CoversImage(const CameraModel& model, Resolution resolution) {
  // The distortion grows with the radius, so the border decides; corners lie farthest out.
  const double right = resolution.width - 1;
  const double bottom = resolution.height - 1;
  for (const double u : {0.0, right}) {
    for (const double v : {0.0, bottom}) {
      if (!model.Unproject({u, v})) return false;
    }
  }
  return true;
}

}  // namespace calibrato
