#pragma once

#include <cmath>
#include <vector>

#include "calibrato/sensors/camera_model.h"

namespace calibrato {

struct Lens {
  const char* model;
  std::vector<double> parameters;
};

inline CameraModel Make(const Lens& lens) {
  return {lens.model,
          Eigen::Map<const Eigen::VectorXd>(lens.parameters.data(),
                                            static_cast<Eigen::Index>(lens.parameters.size()))};
}

/// Lenses for an image of 640 x 480, at least one of every model: plain ones, the barrel of a cheap
/// one, a pincushion, ones that turn back at a finite radius, fisheyes that see behind themselves,
/// mirrors, and parameters beyond the range that the literature gives them.
inline const std::vector<Lens>& Lenses() {
  static const std::vector<Lens> lenses = {
      {"pinhole-none", {585.7561, 586.0, 320.5, 240.5}},
      {"pinhole-radtan",
       {458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907, 0.00019, 1e-5}},
      {"pinhole-radtan", {832.5, 832.53, 303.959, 206.585, -0.228601, 0.190353, 0.001, -0.002}},
      {"pinhole-radtan5", {585.7561, 585.0, 320.5, 240.5, 0.1, -0.05, 0.002, -0.001, 0.08}},
      {"pinhole-radtan5", {585.7561, 585.0, 320.5, 240.5, -0.2, 0.05, 0.0, 0.0, -0.05}},
      {"pinhole-equi", {190.0, 191.0, 320.5, 240.5, 0.0, 0.0, 0.0, 0.0}},
      {"pinhole-equi", {230.0, 229.0, 315.0, 243.0, -0.013, 0.021, -0.015, 0.003}},
      {"pinhole-equi", {250.0, 249.0, 320.0, 240.0, 0.05, -0.02, 0.003, -0.0006}},
      {"pinhole-fov", {400.0, 401.0, 319.0, 239.0, 0.9}},
      {"pinhole-fov", {500.0, 501.0, 319.0, 239.0, 0.02}},
      {"pinhole-fov", {360.0, 361.0, 319.0, 239.0, 1.9}},
      {"omni-none", {0.9, 600.0, 601.0, 320.5, 240.5}},
      {"omni-none", {2.1, 750.0, 748.0, 320.5, 240.5}},
      {"omni-none", {-0.3, 500.0, 501.0, 320.5, 240.5}},
      {"omni-radtan", {1.4, 800.0, 801.0, 318.0, 242.0, -0.15, 0.3, 0.001, -0.0006}},
      {"omni-radtan", {0.8, 600.0, 601.0, 318.0, 242.0, 0.02, 0.01, 0.0, 0.0}},
      {"ds-none", {-0.2, 0.6, 190.0, 191.0, 320.5, 240.5}},
      {"ds-none", {0.4, 0.3, 350.0, 351.0, 320.5, 240.5}},
      {"ds-none", {1.2, 0.7, 500.0, 501.0, 320.5, 240.5}},
      {"ds-none", {0.1, -0.2, 500.0, 501.0, 320.5, 240.5}},
      {"eucm-none", {0.6, 1.1, 230.0, 231.0, 320.5, 240.5}},
      {"eucm-none", {0.45, 0.8, 250.0, 251.0, 320.5, 240.5}},
      {"eucm-none", {-0.1, 1.3, 500.0, 501.0, 320.5, 240.5}}};
  return lenses;
}

/// The unit vector at an angle off the axis [rad], on the side phi of the image.
inline Eigen::Vector3d Direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// Points at several distances in every direction that the lens sees within 2000 px, three
/// degrees away from where its domain ends.
inline std::vector<Eigen::Vector3d> PointsInView(const CameraModel& model) {
  std::vector<Eigen::Vector3d> points;
  for (double theta = 0.0; theta < 3.1; theta += 0.1) {
    for (double phi = 0.05; phi < 6.28; phi += 0.4) {
      const auto pixel = model.Project(Direction(theta, phi));
      if (!pixel || !(pixel->norm() < 2000.0) || !model.Project(Direction(theta + 0.05, phi))) {
        continue;
      }
      for (const double distance : {0.3, 1.0, 20.0}) {
        points.push_back(distance * Direction(theta, phi));
      }
    }
  }
  return points;
}

}  // namespace calibrato
