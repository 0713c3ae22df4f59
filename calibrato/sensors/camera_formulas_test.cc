// The models against numbers worked out by hand, and against each other where two of them are one.

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <utility>

#include "calibrato/sensors/lenses_for_test.h"

namespace calibrato {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

void ExpectPixel(const Lens& lens, const Vector3d& p, double u, double v) {
  const auto pixel = Make(lens).Project(p);
  ASSERT_TRUE(pixel) << lens.model;
  EXPECT_NEAR(pixel->x(), u, 1e-11) << lens.model;
  EXPECT_NEAR(pixel->y(), v, 1e-11) << lens.model;
}

TEST(CameraFormulas, Radtan) {
  // x = 0.1, y = -0.2, s = 0.05: c = 1 + 0.1 * 0.05 = 1.005, plus p1 = 0.01, p2 = 0.02:
  // dx = 2 * 0.01 * (-0.02) + 0.02 * (0.05 + 0.02) = 0.001, dy = 0.01 * (0.05 + 0.08) + 2 * 0.02 *
  // (-0.02) = 0.0005.
  ExpectPixel({"pinhole-radtan", {100.0, 200.0, 50.0, 60.0, 0.1, 0.0, 0.01, 0.02}},
              {0.2, -0.4, 2.0}, 100.0 * (0.1005 + 0.001) + 50.0, 200.0 * (-0.201 + 0.0005) + 60.0);
  // s = 0.25: c = 1 + 0.5 * 0.25^3.
  ExpectPixel({"pinhole-radtan5", {100.0, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5}},
              {0.5, 0.0, 1.0}, 100.0 * 0.5 * (1.0 + 0.5 * 0.015625), 0.0);
}

TEST(CameraFormulas, Equi) {
  // theta = 0.5 on the side (0.6, 0.8): theta' = 0.5 (1 + 0.4/4 + 0.16/16 + 0.64/64 + 2.56/256)
  // = 0.565.
  const double s = std::sin(0.5);
  ExpectPixel({"pinhole-equi", {100.0, 200.0, 50.0, 60.0, 0.4, 0.16, 0.64, 2.56}},
              {0.6 * s, 0.8 * s, std::cos(0.5)}, 50.0 + 100.0 * 0.565 * 0.6,
              60.0 + 200.0 * 0.565 * 0.8);
  // 135 degrees off the axis.
  ExpectPixel({"pinhole-equi", {100.0, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}}, {0.0, 2.0, -2.0}, 0.0,
              100.0 * 0.75 * kPi);
}

TEST(CameraFormulas, Fov) {
  // w = pi/2: 2 tan(w/2) = 2. r = sqrt(3)/2: atan(sqrt(3)) = pi/3, r' = 2/3.
  const double r = std::sqrt(3.0) / 2.0;
  ExpectPixel({"pinhole-fov", {100.0, 200.0, 50.0, 60.0, kPi / 2.0}}, {0.6 * r, 0.8 * r, 1.0},
              50.0 + 100.0 * 0.4, 60.0 + 200.0 * 0.8 * 2.0 / 3.0);
}

TEST(CameraFormulas, FovIsSmoothWhereItsSeriesBegin) {
  // They begin at w = 0.01 and at 2 r tan(w/2) = 0.01.
  const auto jacobians = [](double w, double r) {
    FieldOfView::Parameters parameters;
    parameters << 100.0, 200.0, 50.0, 60.0, w;
    Vector2d pixel;
    FieldOfView::JacobianPoint J_point;
    FieldOfView::JacobianParameters J_parameters;
    EXPECT_TRUE(
        FieldOfView(parameters).Project({0.6 * r, 0.8 * r, 1.0}, &pixel, &J_point, &J_parameters));
    Eigen::Matrix<double, 2, 4> J;
    J << J_point, J_parameters.col(4);
    return J;
  };
  constexpr double kStep = 1e-10;
  const double edge = 0.01 / (2.0 * std::tan(0.45));
  for (const auto& [below, above] :
       {std::pair(jacobians(0.01 - kStep, 0.8), jacobians(0.01 + kStep, 0.8)),
        std::pair(jacobians(0.9, edge - kStep), jacobians(0.9, edge + kStep))}) {
    // Entry by entry: the derivative by w is small there.
    EXPECT_LT(((below - above).array() / above.array()).abs().maxCoeff(), 1e-6);
  }
}

TEST(CameraFormulas, Omni) {
  // d = 5, D = 4 + 0.8 * 5 = 8.
  ExpectPixel({"omni-none", {0.8, 100.0, 200.0, 50.0, 60.0}}, {0.0, 3.0, 4.0}, 50.0,
              60.0 + 200.0 * 0.375);
  // Behind: d = 13, D = -5 + 13 = 8.
  ExpectPixel({"omni-none", {1.0, 100.0, 200.0, 50.0, 60.0}}, {12.0, 0.0, -5.0}, 50.0 + 150.0,
              60.0);
  // m = 0.5, c = 1 + 0.2 * 0.25 = 1.05, tangential 3 * 0.01 * 0.25.
  ExpectPixel({"omni-radtan", {0.4, 100.0, 200.0, 50.0, 60.0, 0.2, 0.0, 0.0, 0.01}},
              {3.0, 0.0, 4.0}, 50.0 + 100.0 * (0.525 + 0.0075), 60.0);
}

TEST(CameraFormulas, DoubleSphere) {
  // d1 = 5, z2 = 4 - 0.8 * 5 = 0, d2 = 3, D = 1.5.
  ExpectPixel({"ds-none", {-0.8, 0.5, 100.0, 200.0, 50.0, 60.0}}, {3.0, 0.0, 4.0}, 50.0 + 200.0,
              60.0);
  // Behind: d1 = 13, z2 = -5 + 0.8 * 13 = 5.4, d2 = sqrt(144 + 29.16), alpha = 1.
  ExpectPixel({"ds-none", {0.8, 1.0, 100.0, 200.0, 50.0, 60.0}}, {0.0, 12.0, -5.0}, 50.0,
              60.0 + 200.0 * 12.0 / std::sqrt(173.16));
}

TEST(CameraFormulas, ExtendedUnified) {
  // d = sqrt(20/9 * 9 + 16) = 6, D = 0.5 * 6 + 0.5 * 4 = 5.
  ExpectPixel({"eucm-none", {0.5, 20.0 / 9.0, 100.0, 200.0, 50.0, 60.0}}, {3.0, 0.0, 4.0},
              50.0 + 60.0, 60.0);
  // Behind: d = sqrt(35/9 * 9 + 1) = 6, D = 0.8 * 6 - 0.2 * 1 = 4.6.
  ExpectPixel({"eucm-none", {0.8, 35.0 / 9.0, 100.0, 200.0, 50.0, 60.0}}, {0.0, 3.0, -1.0}, 50.0,
              60.0 + 200.0 * 3.0 / 4.6);
}

// Two lenses that are one: the same pixel, or none, for every direction.
void ExpectSame(const Lens& a, const Lens& b) {
  const CameraModel model_a = Make(a);
  const CameraModel model_b = Make(b);
  int num_seen = 0;
  for (double theta = 0.0; theta < kPi; theta += 0.0137) {
    for (double phi = 0.1; phi < 6.2; phi += 1.1) {
      const auto pixel_a = model_a.Project(Direction(theta, phi));
      const auto pixel_b = model_b.Project(Direction(theta, phi));
      ASSERT_EQ(pixel_a.has_value(), pixel_b.has_value())
          << a.model << " " << b.model << " theta " << theta;
      if (!pixel_a) continue;
      ++num_seen;
      EXPECT_LT((*pixel_a - *pixel_b).norm(), 1e-11 * (1.0 + pixel_a->norm()))
          << a.model << " " << b.model << " theta " << theta;
    }
  }
  EXPECT_GT(num_seen, 100);
}

TEST(CameraFormulas, ModelsWithoutTheirParametersAreThePinhole) {
  const Lens pinhole{"pinhole-none", {300.0, 310.0, 320.0, 240.0}};
  ExpectSame(pinhole, {"pinhole-radtan", {300.0, 310.0, 320.0, 240.0, 0.0, 0.0, 0.0, 0.0}});
  ExpectSame(pinhole, {"pinhole-radtan5", {300.0, 310.0, 320.0, 240.0, 0.0, 0.0, 0.0, 0.0, 0.0}});
  ExpectSame(pinhole, {"pinhole-fov", {300.0, 310.0, 320.0, 240.0, 0.0}});
  ExpectSame(pinhole, {"omni-none", {0.0, 300.0, 310.0, 320.0, 240.0}});
  ExpectSame(pinhole, {"ds-none", {0.0, 0.0, 300.0, 310.0, 320.0, 240.0}});
  ExpectSame(pinhole, {"eucm-none", {0.0, 1.7, 300.0, 310.0, 320.0, 240.0}});
}

TEST(CameraFormulas, DistortedModelsContainEachOther) {
  ExpectSame({"pinhole-radtan", {300.0, 310.0, 320.0, 240.0, -0.2, 0.05, 0.001, 0.002}},
             {"pinhole-radtan5", {300.0, 310.0, 320.0, 240.0, -0.2, 0.05, 0.001, 0.002, 0.0}});
  ExpectSame({"pinhole-radtan", {300.0, 310.0, 320.0, 240.0, -0.2, 0.05, 0.001, 0.002}},
             {"omni-radtan", {0.0, 300.0, 310.0, 320.0, 240.0, -0.2, 0.05, 0.001, 0.002}});
  ExpectSame({"omni-none", {1.3, 300.0, 310.0, 320.0, 240.0}},
             {"omni-radtan", {1.3, 300.0, 310.0, 320.0, 240.0, 0.0, 0.0, 0.0, 0.0}});
}

TEST(CameraFormulas, UnifiedModelsAreOneWhereTheirExtraParameterRests) {
  for (const double alpha : {-0.4, 0.0, 0.3, 0.5, 0.65, 0.9}) {
    const Lens extended{"eucm-none", {alpha, 1.0, 300.0, 310.0, 320.0, 240.0}};
    ExpectSame(extended, {"ds-none", {0.0, alpha, 300.0, 310.0, 320.0, 240.0}});
    // Mei's xi is alpha / (1 - alpha), and his focal length 1 + xi times ours.
    const double scale = 1.0 / (1.0 - alpha);
    ExpectSame(extended,
               {"omni-none", {alpha * scale, 300.0 * scale, 310.0 * scale, 320.0, 240.0}});
  }
  // The first sphere alone.
  for (const double xi : {-0.5, 0.3, 1.0, 1.8}) {
    // Beyond xi = 1 the double sphere ends where its first sphere folds, as Mei's does.
    ExpectSame({"ds-none", {xi, 0.0, 300.0, 310.0, 320.0, 240.0}},
               {"omni-none", {xi, 300.0, 310.0, 320.0, 240.0}});
  }
}

// The image radius of a lens without a direction of its own, over the angle.
void ExpectRadius(const Lens& lens, double f, double (*radius)(double), double max_theta) {
  const CameraModel model = Make(lens);
  for (double theta = 0.0; theta < max_theta; theta += 0.01) {
    const auto pixel = model.Project(2.5 * Direction(theta, 0.7));
    ASSERT_TRUE(pixel) << lens.model << " " << theta;
    EXPECT_NEAR(pixel->norm(), f * radius(theta), 1e-9 * (1.0 + pixel->norm())) << lens.model;
  }
}

TEST(CameraFormulas, ClassicalFisheyesAreSpecialCases) {
  const auto equidistant = [](double theta) { return theta; };
  const auto stereographic = [](double theta) { return 2.0 * std::tan(0.5 * theta); };
  const auto orthographic = [](double theta) { return std::sin(theta); };
  ExpectRadius({"pinhole-equi", {200.0, 200.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}}, 200.0, equidistant,
               kPi);
  ExpectRadius({"omni-none", {1.0, 400.0, 400.0, 0.0, 0.0}}, 200.0, stereographic, 3.1);
  ExpectRadius({"eucm-none", {0.5, 1.0, 200.0, 200.0, 0.0, 0.0}}, 200.0, stereographic, 3.1);
  ExpectRadius({"eucm-none", {1.0, 1.0, 200.0, 200.0, 0.0, 0.0}}, 200.0, orthographic, 1.57);
  ExpectRadius({"ds-none", {0.0, 1.0, 200.0, 200.0, 0.0, 0.0}}, 200.0, orthographic, 1.57);
}

}  // namespace
}  // namespace calibrato
