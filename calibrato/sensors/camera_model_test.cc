#include "calibrato/sensors/camera_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/expect_jacobian.h"
#include "calibrato/sensors/lenses_for_test.h"

namespace calibrato {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::HasSubstr;

TEST(CameraModel, JacobiansAgreeWithDifferences) {
  for (const Lens& lens : Lenses()) {
    const CameraModel model = Make(lens);
    std::visit(
        [&](const auto& concrete) {
          using Concrete = std::decay_t<decltype(concrete)>;
          for (const Vector3d& p : PointsInView(model)) {
            Vector2d pixel;
            typename Concrete::JacobianPoint J_point;
            typename Concrete::JacobianParameters J_parameters;
            ASSERT_TRUE(concrete.Project(p, &pixel, &J_point, &J_parameters));
            ExpectJacobian(
                [&](const VectorXd& x) -> VectorXd { return model.Project(Vector3d(x)).value(); },
                p, J_point, 1e-6, 1e-3 * p.norm());
            ExpectJacobian(
                [&](const VectorXd& x) -> VectorXd {
                  return CameraModel(lens.model, x).Project(p).value();
                },
                model.parameters(), J_parameters, 1e-6, 3e-6);
          }
        },
        model.variant());
  }
}

TEST(CameraModel, ProjectionDependsOnTheDirectionAlone) {
  // Homogeneous of degree zero: J p = 0 (Euler).
  for (const Lens& lens : Lenses()) {
    const CameraModel model = Make(lens);
    std::visit(
        [&](const auto& concrete) {
          for (const Vector3d& p : PointsInView(model)) {
            Vector2d pixel;
            typename std::decay_t<decltype(concrete)>::JacobianPoint J;
            ASSERT_TRUE(concrete.Project(p, &pixel, &J, nullptr));
            EXPECT_LT((J * p).norm(), 1e-9);
          }
        },
        model.variant());
  }
}

TEST(CameraModel, UnprojectionInvertsProjection) {
  for (const Lens& lens : Lenses()) {
    const CameraModel model = Make(lens);
    const std::vector<Vector3d> points = PointsInView(model);
    ASSERT_GT(points.size(), 200U) << lens.model;
    for (const Vector3d& p : points) {
      const auto ray = model.Unproject(*model.Project(p));
      ASSERT_TRUE(ray) << lens.model << " " << p.transpose();
      EXPECT_LT((ray->normalized() - p.normalized()).norm(), 1e-9) << lens.model;
    }
  }
}

TEST(CameraModel, ProjectionInvertsUnprojectionOverTheImage) {
  for (const Lens& lens : Lenses()) {
    const CameraModel model = Make(lens);
    int num_rays = 0;
    for (double u = 0.0; u < 640.0; u += 21.3) {
      for (double v = 0.0; v < 480.0; v += 15.9) {
        const auto ray = model.Unproject({u, v});
        if (!ray) continue;
        ++num_rays;
        const auto pixel = model.Project(*ray);
        ASSERT_TRUE(pixel) << lens.model << " " << u << " " << v;
        EXPECT_LT((*pixel - Vector2d(u, v)).norm(), 1e-8) << lens.model;
      }
    }
    EXPECT_GT(num_rays, 600) << lens.model;
  }
}

TEST(CameraModel, EveryModelIsTested) {
  std::set<std::string_view> tested;
  for (const Lens& lens : Lenses()) tested.insert(lens.model);
  EXPECT_EQ(tested, std::set<std::string_view>(kCameraModelNames.begin(), kCameraModelNames.end()));
}

TEST(CameraModel, RefusesWhatIsNoPoint) {
  for (const Lens& lens : Lenses()) {
    const CameraModel model = Make(lens);
    EXPECT_FALSE(model.Project({0.1, 0.1, std::nan("")})) << lens.model;
    EXPECT_FALSE(model.Project({std::nan(""), 0.1, 1.0})) << lens.model;
    EXPECT_FALSE(model.Project({0.0, 0.0, 0.0})) << lens.model;
    EXPECT_FALSE(model.Project({0.0, 0.0, -1.0})) << lens.model;
    EXPECT_FALSE(model.Unproject({std::nan(""), 100.0})) << lens.model;
  }
}

TEST(CameraModel, CoversImageTellsLensesThatCanExist) {
  const auto covers = [](const Lens& lens) { return CoversImage(Make(lens), {640, 480}); };
  EXPECT_TRUE(covers(Lenses()[0]));
  EXPECT_TRUE(covers(Lenses()[1]));
  EXPECT_FALSE(covers({"pinhole-radtan", {300.0, 300.0, 320.0, 240.0, -0.4, 0.0, 0.0, 0.0}}));
  // Dark corners: the image radius ends at 314 px (theta = pi), at 224 px and at 101 px; the lens
  // sees more than 90 degrees off its axis.
  EXPECT_TRUE(covers({"pinhole-equi", {100.0, 100.0, 320.0, 240.0, 0.0, 0.0, 0.0, 0.0}}));
  EXPECT_TRUE(covers({"ds-none", {0.0, 0.6, 100.0, 100.0, 320.0, 240.0}}));
  EXPECT_TRUE(covers({"omni-none", {1.4, 100.0, 100.0, 320.0, 240.0}}));
  // Turns back at 57 degrees; sees less than 90 degrees off its axis.
  EXPECT_FALSE(covers({"pinhole-equi", {100.0, 100.0, 320.0, 240.0, -1.0 / 3.0, 0.0, 0.0, 0.0}}));
  EXPECT_FALSE(covers({"eucm-none", {1.3, 1.0, 100.0, 100.0, 320.0, 240.0}}));
  EXPECT_FALSE(covers({"pinhole-fov", {100.0, 100.0, 320.0, 240.0, 1.0}}));
}

TEST(CameraModel, NamesItsParametersInKalibrsOrder) {
  const auto names = [](std::string_view model) {
    std::string joined;
    for (const std::string& name : CameraModel::ParameterNames(model)) joined += name + " ";
    return joined;
  };
  EXPECT_EQ(names("pinhole-none"), "fu fv pu pv ");
  EXPECT_EQ(names("pinhole-radtan"), "fu fv pu pv k1 k2 p1 p2 ");
  EXPECT_EQ(names("pinhole-radtan5"), "fu fv pu pv k1 k2 p1 p2 k3 ");
  EXPECT_EQ(names("pinhole-equi"), "fu fv pu pv k1 k2 k3 k4 ");
  EXPECT_EQ(names("pinhole-fov"), "fu fv pu pv w ");
  EXPECT_EQ(names("omni-none"), "xi fu fv pu pv ");
  EXPECT_EQ(names("omni-radtan"), "xi fu fv pu pv k1 k2 p1 p2 ");
  EXPECT_EQ(names("ds-none"), "xi alpha fu fv pu pv ");
  EXPECT_EQ(names("eucm-none"), "alpha beta fu fv pu pv ");
}

TEST(CameraModel, TellsIntrinsicsFromDistortion) {
  for (const Lens& lens : Lenses()) {
    const CameraModel model = Make(lens);
    const int focal_index = CameraModel::FocalIndex(lens.model);
    EXPECT_EQ(CameraModel::ParameterNames(lens.model)[static_cast<size_t>(focal_index)], "fu");
    EXPECT_EQ(model.focal_and_centre(), model.parameters().segment<4>(focal_index));
    VectorXd whole(model.num_parameters());
    whole << model.intrinsics(), model.distortion();
    EXPECT_EQ(whole, model.parameters());
    EXPECT_EQ(model.intrinsics().size(), CameraModel::NumIntrinsics(lens.model));
    EXPECT_EQ(model.num_parameters(), CameraModel::NumParameters(lens.model));
    EXPECT_LE(model.num_parameters(), kMaxCameraParameters);
    EXPECT_EQ(model.name(), lens.model);
  }
}

std::string ErrorOf(const Lens& lens) {
  try {
    (void)Make(lens);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CameraModel, RefusesWhatIsNoCamera) {
  EXPECT_THAT(ErrorOf({"pinhole-radtann", {1.0, 1.0, 1.0, 1.0}}), HasSubstr("pinhole-radtan,"));
  EXPECT_THAT(ErrorOf({"pinhole-radtan", std::vector<double>(7, 1.0)}),
              HasSubstr("expected 8, got 7"));
  EXPECT_THAT(ErrorOf({"pinhole-none", {1.0, -1.0, 1.0, 1.0}}), HasSubstr("focal lengths"));
  EXPECT_THAT(ErrorOf({"omni-none", {0.0, 0.0, 1.0, 1.0, 1.0}}), HasSubstr("focal lengths"));
  EXPECT_THAT(ErrorOf({"pinhole-none", {1.0, std::nan(""), 1.0, 1.0}}), HasSubstr("finite"));
  EXPECT_THAT(ErrorOf({"pinhole-none", {1.0, 1.0, std::nan(""), 1.0}}), HasSubstr("finite"));
}

TEST(CameraModel, RefusesParametersOutsideTheModelsRange) {
  EXPECT_THAT(ErrorOf({"omni-none", {-1.0, 1.0, 1.0, 1.0, 1.0}}), HasSubstr("xi must be above"));
  EXPECT_THAT(ErrorOf({"ds-none", {-1.0, 0.5, 1.0, 1.0, 1.0, 1.0}}), HasSubstr("xi must be above"));
  EXPECT_THAT(ErrorOf({"eucm-none", {0.5, 0.0, 1.0, 1.0, 1.0, 1.0}}), HasSubstr("beta must be"));
  EXPECT_THAT(ErrorOf({"pinhole-fov", {1.0, 1.0, 1.0, 1.0, -0.1}}), HasSubstr("w must lie in"));
  EXPECT_THAT(ErrorOf({"pinhole-fov", {1.0, 1.0, 1.0, 1.0, 3.15}}), HasSubstr("w must lie in"));
}

}  // namespace
}  // namespace calibrato
