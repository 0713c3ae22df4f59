// Where the models end: up to there the image radius is finite and grows with the angle off the
// axis, and no point beyond is projected.

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <string>

#include "calibrato/sensors/lenses_for_test.h"

namespace calibrato {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFocal = 100.0;

// The largest angle that is projected; expects that it is projected all the way there, to a growing
// radius, and that unprojection gives each angle back.
double LargestAngle(const CameraModel& model) {
  double largest = 0.0;
  double last_radius = -1.0;
  bool ended = false;
  for (double theta = 0.0; theta < kPi; theta += 1e-3) {
    const auto pixel = model.Project(Direction(theta, 0.7));
    if (!pixel) {
      ended = true;
      continue;
    }
    EXPECT_FALSE(ended) << model.name() << " sees again at " << theta;
    EXPECT_GT(pixel->norm(), last_radius) << model.name() << " turns back at " << theta;
    last_radius = pixel->norm();
    largest = theta;
    const auto ray = model.Unproject(*pixel);
    if (!ray) {
      ADD_FAILURE() << model.name() << " has no ray for " << theta;
      continue;
    }
    EXPECT_LT((ray->normalized() - Direction(theta, 0.7)).norm(), 1e-6)
        << model.name() << " " << theta;
  }
  // Nor does a pixel have a ray that is not seen there.
  for (double radius = 0.0; radius < 2.0 * last_radius; radius += 0.01 * last_radius) {
    const Eigen::Vector2d pixel(0.6 * radius, 0.8 * radius);
    if (const auto ray = model.Unproject(pixel)) {
      const auto again = model.Project(*ray);
      EXPECT_TRUE(again && (*again - pixel).norm() < 1e-6 * (1.0 + radius))
          << model.name() << " radius " << radius << " of " << last_radius;
    }
  }
  return largest;
}

// Where a formula for the radius first stops to be positive, finite and growing.
template <typename Radius>
double TurningAngle(const Radius& radius) {
  double last = -1.0;
  for (double theta = 0.0; theta < kPi; theta += 1e-3) {
    const double r = radius(theta);
    if (!(r > last && std::isfinite(r))) return theta;
    last = r;
  }
  return kPi;
}

TEST(CameraDomain, OmniEndsWhereItsRadiusDoes) {
  for (const double xi : {-0.9, -0.3, 0.0, 0.5, 0.99, 1.0, 1.01, 1.5, 3.0}) {
    const double turn = TurningAngle([&](double theta) {
      const double depth = std::cos(theta) + xi;
      return depth > 0.0 ? std::sin(theta) / depth : -1.0;
    });
    EXPECT_NEAR(LargestAngle(Make({"omni-none", {xi, kFocal, kFocal, 0.0, 0.0}})), turn, 2.1e-3)
        << "xi " << xi;
  }
}

TEST(CameraDomain, DoubleSphereEndsWhereItsRadiusDoes) {
  for (const double xi : {-0.95, -0.5, -0.2, 0.0, 0.3, 0.8, 1.0, 1.5, 3.0}) {
    for (const double alpha : {-0.3, 0.0, 0.2, 0.5, 0.6, 0.8, 1.0, 1.3}) {
      const double turn = TurningAngle([&](double theta) {
        const double z = std::cos(theta) + xi;
        const double depth = alpha * std::hypot(std::sin(theta), z) + (1.0 - alpha) * z;
        return depth > 0.0 ? std::sin(theta) / depth : -1.0;
      });
      const CameraModel model = Make({"ds-none", {xi, alpha, kFocal, kFocal, 0.0, 0.0}});
      EXPECT_NEAR(LargestAngle(model), turn, 2.1e-3) << "xi " << xi << " alpha " << alpha;
    }
  }
}

TEST(CameraDomain, ExtendedUnifiedEndsWhereItsRadiusDoes) {
  for (const double alpha : {-0.3, 0.0, 0.2, 0.5, 0.6, 0.8, 1.0, 1.3}) {
    for (const double beta : {0.3, 1.0, 2.5}) {
      const double turn = TurningAngle([&](double theta) {
        const double d = std::hypot(std::sqrt(beta) * std::sin(theta), std::cos(theta));
        const double depth = alpha * d + (1.0 - alpha) * std::cos(theta);
        return depth > 0.0 ? std::sin(theta) / depth : -1.0;
      });
      const CameraModel model = Make({"eucm-none", {alpha, beta, kFocal, kFocal, 0.0, 0.0}});
      EXPECT_NEAR(LargestAngle(model), turn, 2.1e-3) << "alpha " << alpha << " beta " << beta;
    }
  }
}

TEST(CameraDomain, EquiEndsWhereItsPolynomialTurnsBack) {
  // theta (1 - theta^2 / 12) grows up to theta = 2; the largest image radius is 4/3.
  const CameraModel model =
      Make({"pinhole-equi", {kFocal, kFocal, 0.0, 0.0, -1.0 / 12.0, 0.0, 0.0, 0.0}});
  EXPECT_TRUE(model.Project(Direction(1.9999, 0.3)));
  EXPECT_FALSE(model.Project(Direction(2.0001, 0.3)));
  EXPECT_TRUE(model.Unproject({kFocal * 4.0 / 3.0 - 1e-3, 0.0}));
  EXPECT_FALSE(model.Unproject({kFocal * 4.0 / 3.0 + 1e-3, 0.0}));
  EXPECT_NEAR(LargestAngle(model), 2.0, 1.1e-3);
  // Without a turn it sees all but the point behind itself.
  const CameraModel whole = Make({"pinhole-equi", {kFocal, kFocal, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}});
  EXPECT_NEAR(LargestAngle(whole), kPi, 1.1e-3);
  EXPECT_TRUE(whole.Unproject({kFocal * 3.1415, 0.0}));
  EXPECT_FALSE(whole.Unproject({kFocal * 3.1416, 0.0}));
}

TEST(CameraDomain, FovSeesTheHalfSpaceInACircle) {
  const CameraModel model = Make({"pinhole-fov", {kFocal, kFocal, 0.0, 0.0, 0.9}});
  EXPECT_TRUE(model.Project({1.0, 0.0, 1e-6}));
  EXPECT_FALSE(model.Project({1.0, 0.0, 0.0}));
  const double edge = kFocal * kPi / 2.0 / 0.9;
  EXPECT_TRUE(model.Unproject({edge - 1e-3, 0.0}));
  EXPECT_FALSE(model.Unproject({edge + 1e-3, 0.0}));
  EXPECT_NEAR(LargestAngle(model), kPi / 2.0, 1.1e-3);
}

TEST(CameraDomain, PinholesSeeTheHalfSpace) {
  EXPECT_NEAR(LargestAngle(Make({"pinhole-none", {kFocal, kFocal, 0.0, 0.0}})), kPi / 2.0, 1.1e-3);
}

TEST(CameraDomain, RadtanEndsAtItsTurningRadius) {
  // r (1 + k1 r^2) with k1 = -1/3 grows up to r = 1; the largest image radius is 2/3. So it is for
  // the plane of the unified sphere.
  const CameraModel pinhole =
      Make({"pinhole-radtan", {kFocal, kFocal, 0.0, 0.0, -1.0 / 3.0, 0.0, 0.0, 0.0}});
  EXPECT_NEAR(LargestAngle(pinhole), kPi / 4.0, 1.1e-3);
  const CameraModel omni =
      Make({"omni-radtan", {1.0, kFocal, kFocal, 0.0, 0.0, -1.0 / 3.0, 0.0, 0.0, 0.0}});
  EXPECT_NEAR(LargestAngle(omni), kPi / 2.0, 1.1e-3);
  for (const CameraModel& model : {pinhole, omni}) {
    EXPECT_TRUE(model.Unproject({66.6, 0.0}));
    EXPECT_FALSE(model.Unproject({66.7, 0.0}));
  }
}

TEST(CameraDomain, TurningRadiusOfTheCubicIsItsFirstRoot) {
  // 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3 = (1 - s/0.5) (1 - s/2) (1 - s/3)
  //   = 1 - (2 + 1/2 + 1/3) s + (1 + 2/3 + 1/6) s^2 - 1/3 s^3.
  const CameraModel model = Make({"pinhole-radtan5",
                                  {100.0, 100.0, 0.0, 0.0, -(17.0 / 6.0) / 3.0, (11.0 / 6.0) / 5.0,
                                   0.0, 0.0, -(1.0 / 3.0) / 7.0}});
  EXPECT_TRUE(model.Project({std::sqrt(0.4999), 0.0, 1.0}));
  EXPECT_FALSE(model.Project({std::sqrt(0.5001), 0.0, 1.0}));
}

TEST(CameraDomain, FisheyesSeeTwoHundredDegrees) {
  for (const Lens& lens : std::vector<Lens>{
           {"pinhole-equi", {190.0, 191.0, 320.5, 240.5, -0.013, 0.021, -0.015, 0.003}},
           {"omni-none", {1.5, 600.0, 601.0, 320.5, 240.5}},
           {"omni-radtan", {1.5, 600.0, 601.0, 320.5, 240.5, -0.05, 0.02, 0.001, -0.001}},
           {"ds-none", {-0.2, 0.6, 190.0, 191.0, 320.5, 240.5}},
           {"eucm-none", {0.65, 1.1, 230.0, 231.0, 320.5, 240.5}}}) {
    const CameraModel model = Make(lens);
    for (double phi = 0.0; phi < 6.28; phi += 0.1) {
      const Eigen::Vector3d sideways = Direction(100.0 * kPi / 180.0, phi);
      const auto pixel = model.Project(7.0 * sideways);
      ASSERT_TRUE(pixel) << lens.model;
      const auto ray = model.Unproject(*pixel);
      ASSERT_TRUE(ray) << lens.model;
      EXPECT_LT(ray->z(), 0.0);
      EXPECT_LT((ray->normalized() - sideways).norm(), 1e-9) << lens.model;
    }
  }
}

}  // namespace
}  // namespace calibrato
