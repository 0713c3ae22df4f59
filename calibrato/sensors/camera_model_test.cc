#include "calibrato/sensors/camera_model.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/expect_jacobian.h"

namespace calibrato {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

struct Case {
  std::string name;
  std::vector<double> parameters;
};

// A plain lens, the barrel of a cheap one, a pincushion, one that turns back at a finite radius.
const std::vector<Case> kCases = {
    {"pinhole-none", {585.7561, 586.0, 320.5, 240.5}},
    {"pinhole-radtan",
     {458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907, 0.00019, 1e-5}},
    {"pinhole-radtan", {832.5, 832.53, 303.959, 206.585, -0.228601, 0.190353, 0.001, -0.002}},
    {"pinhole-radtan5", {585.7561, 585.0, 320.5, 240.5, 0.1, -0.05, 0.002, -0.001, 0.08}},
    {"pinhole-radtan5", {585.7561, 585.0, 320.5, 240.5, -0.2, 0.05, 0.0, 0.0, -0.05}}};

CameraModel Make(const Case& c) {
  return {c.name, Eigen::Map<const VectorXd>(c.parameters.data(),
                                             static_cast<Eigen::Index>(c.parameters.size()))};
}

// A grid of pixels with their rays at several distances.
std::vector<Vector3d> PointsInView(const CameraModel& model) {
  std::vector<Vector3d> points;
  for (double u = 10.0; u < 640.0; u += 62.0) {
    for (double v = 10.0; v < 480.0; v += 46.0) {
      const auto ray = model.Unproject({u, v});
      if (!ray) continue;
      for (const double depth : {0.3, 1.0, 20.0}) points.push_back(depth * *ray);
    }
  }
  return points;
}

TEST(CameraModel, ProjectsByHand) {
  // x = 0.1, y = -0.2, s = 0.05: c = 1 + 0.1 * 0.05 = 1.005, plus p1 = 0.01, p2 = 0.02:
  // dx = 2 * 0.01 * (-0.02) + 0.02 * (0.05 + 0.02) = 0.001, dy = 0.01 * (0.05 + 0.08) + 2 * 0.02 *
  // (-0.02) = 0.0005.
  VectorXd parameters(8);
  parameters << 100.0, 200.0, 50.0, 60.0, 0.1, 0.0, 0.01, 0.02;
  const auto pixel = CameraModel("pinhole-radtan", parameters).Project({0.2, -0.4, 2.0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 100.0 * (0.1005 + 0.001) + 50.0, 1e-12);
  EXPECT_NEAR(pixel->y(), 200.0 * (-0.201 + 0.0005) + 60.0, 1e-12);
}

TEST(CameraModel, AddsTheThirdRadialTerm) {
  VectorXd parameters(9);
  parameters << 100.0, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5;
  // s = 0.25: c = 1 + 0.5 * 0.25^3.
  EXPECT_NEAR(CameraModel("pinhole-radtan5", parameters).Project({0.5, 0.0, 1.0})->x(),
              100.0 * 0.5 * (1.0 + 0.5 * 0.015625), 1e-12);
}

TEST(CameraModel, JacobiansAgreeWithDifferences) {
  for (const Case& c : kCases) {
    const CameraModel model = Make(c);
    std::visit(
        [&](const auto& lens) {
          using Lens = std::decay_t<decltype(lens)>;
          for (const Vector3d& p : PointsInView(model)) {
            Vector2d pixel;
            typename Lens::JacobianPoint J_point;
            typename Lens::JacobianParameters J_parameters;
            ASSERT_TRUE(lens.Project(p, &pixel, &J_point, &J_parameters));
            ExpectJacobian(
                [&](const VectorXd& x) -> VectorXd { return *model.Project(Vector3d(x)); }, p,
                J_point, 1e-6, 1e-3 * p.z());
            ExpectJacobian(
                [&](const VectorXd& x) -> VectorXd { return *CameraModel(c.name, x).Project(p); },
                model.parameters(), J_parameters, 1e-6);
          }
        },
        model.variant());
  }
}

TEST(CameraModel, ProjectionDependsOnTheDirectionAlone) {
  // Homogeneous of degree zero: J p = 0 (Euler).
  for (const Case& c : kCases) {
    const CameraModel model = Make(c);
    std::visit(
        [&](const auto& lens) {
          for (const Vector3d& p : PointsInView(model)) {
            Vector2d pixel;
            typename std::decay_t<decltype(lens)>::JacobianPoint J;
            ASSERT_TRUE(lens.Project(p, &pixel, &J, nullptr));
            EXPECT_LT((J * p).norm(), 1e-9);
          }
        },
        model.variant());
  }
}

TEST(CameraModel, UnprojectionInvertsProjection) {
  for (const Case& c : kCases) {
    const CameraModel model = Make(c);
    const std::vector<Vector3d> points = PointsInView(model);
    ASSERT_GT(points.size(), 200U) << c.name;
    for (const Vector3d& p : points) {
      const auto pixel = model.Project(p);
      ASSERT_TRUE(pixel);
      const auto ray = model.Unproject(*pixel);
      ASSERT_TRUE(ray);
      EXPECT_LT((*ray / ray->z() - p / p.z()).norm(), 1e-9) << c.name;
    }
  }
}

TEST(CameraModel, RefusesPointsBehindTheCamera) {
  for (const Case& c : kCases) {
    EXPECT_FALSE(Make(c).Project({0.1, 0.1, -1.0}));
    EXPECT_FALSE(Make(c).Project({0.1, 0.1, 0.0}));
    EXPECT_FALSE(Make(c).Project({0.1, 0.1, std::nan("")}));
  }
}

TEST(CameraModel, RefusesPointsBeyondTheTurningRadius) {
  // r (1 + k1 r^2) with k1 = -1/3 grows up to r = 1 exactly.
  VectorXd parameters(8);
  parameters << 100.0, 100.0, 0.0, 0.0, -1.0 / 3.0, 0.0, 0.0, 0.0;
  const CameraModel model("pinhole-radtan", parameters);
  EXPECT_TRUE(model.Project({0.999, 0.0, 1.0}));
  EXPECT_FALSE(model.Project({1.001, 0.0, 1.0}));
  // The largest image radius is 100 * (1 - 1/3).
  EXPECT_TRUE(model.Unproject({66.6, 0.0}));
  EXPECT_FALSE(model.Unproject({66.7, 0.0}));
}

TEST(CameraModel, TurningRadiusOfTheCubicIsItsFirstRoot) {
  // 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3 = (1 - s/0.5) (1 - s/2) (1 - s/3)
  //   = 1 - (2 + 1/2 + 1/3) s + (1 + 2/3 + 1/6) s^2 - 1/3 s^3.
  VectorXd parameters(9);
  parameters << 100.0, 100.0, 0.0, 0.0, -(17.0 / 6.0) / 3.0, (11.0 / 6.0) / 5.0, 0.0, 0.0,
      -(1.0 / 3.0) / 7.0;
  const CameraModel model("pinhole-radtan5", parameters);
  EXPECT_TRUE(model.Project({std::sqrt(0.4999), 0.0, 1.0}));
  EXPECT_FALSE(model.Project({std::sqrt(0.5001), 0.0, 1.0}));
}

TEST(CameraModel, CoversImageTellsLensesThatCanExist) {
  EXPECT_TRUE(CoversImage(Make(kCases[0]), {640, 480}));
  EXPECT_TRUE(CoversImage(Make(kCases[1]), {752, 480}));
  VectorXd parameters(8);
  parameters << 300.0, 300.0, 320.0, 240.0, -0.4, 0.0, 0.0, 0.0;
  EXPECT_FALSE(CoversImage(CameraModel("pinhole-radtan", parameters), {640, 480}));
}

TEST(CameraModel, NamesItsParametersInOrder) {
  EXPECT_EQ(CameraModel::ParameterNames("pinhole-radtan5"),
            (std::vector<std::string>{"fu", "fv", "pu", "pv", "k1", "k2", "p1", "p2", "k3"}));
  EXPECT_EQ(CameraModel::NumParameters("pinhole-none"), 4);
}

TEST(CameraModel, RefusesWhatIsNoCamera) {
  EXPECT_THROW(CameraModel("pinhole-radtann", VectorXd::Ones(8)), InputError);
  EXPECT_THROW(CameraModel("pinhole-radtan", VectorXd::Ones(7)), InputError);
  VectorXd negative = VectorXd::Ones(4);
  negative(1) = -1.0;
  EXPECT_THROW(CameraModel("pinhole-none", negative), InputError);
  negative(1) = std::nan("");
  EXPECT_THROW(CameraModel("pinhole-none", negative), InputError);
}

}  // namespace
}  // namespace calibrato
