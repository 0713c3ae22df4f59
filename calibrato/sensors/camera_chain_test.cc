#include "calibrato/sensors/camera_chain.h"

#include <gtest/gtest.h>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/lenses_for_test.h"

namespace calibrato {
namespace {

const char* const kYaml =
    "cam0:\n"
    "  camera_model: pinhole\n"
    "  intrinsics: [458.654, 457.296, 367.215, 248.375]\n"
    "  distortion_model: radtan\n"
    "  distortion_coeffs: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n"
    "  resolution: [752, 480]\n"
    "  rostopic: /left\n"
    "cam1:\n"
    "  camera_model: pinhole\n"
    "  intrinsics: [457.587, 456.134, 379.999, 255.238]\n"
    "  distortion_model: none\n"
    "  distortion_coeffs: []\n"
    "  resolution: [752, 480]\n"
    "  T_cn_cnm1: [[1.0, 0.0, 0.0, -0.11], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, "
    "0.0, 1.0]]\n";

std::string ErrorOf(const std::string& yaml) {
  try {
    (void)CameraChainFromValue(ParseYaml(yaml, "chain.yaml"), nullptr);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CameraChain, ReadsKalibrsFile) {
  std::vector<std::string> warnings;
  const auto cameras = CameraChainFromValue(ParseYaml(kYaml, "chain.yaml"), &warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].model.name(), "pinhole-radtan");
  EXPECT_EQ(cameras[0].model.parameters()(5), 0.07395907);
  EXPECT_EQ(cameras[0].resolution, (Resolution{752, 480}));
  EXPECT_EQ(cameras[0].rostopic, "/left");
  EXPECT_FALSE(cameras[0].T_cn_cnm1);
  EXPECT_EQ(cameras[1].model.name(), "pinhole-none");
  EXPECT_EQ(cameras[1].T_cn_cnm1->t.x(), -0.11);
}

TEST(CameraChain, RoundTripKeepsEveryBit) {
  const auto cameras = CameraChainFromValue(ParseYaml(kYaml, "chain.yaml"), nullptr);
  const std::string text = ToYaml(ToValue(cameras));
  const auto again = CameraChainFromValue(ParseYaml(text, "again.yaml"), nullptr);
  ASSERT_EQ(again.size(), 2U);
  EXPECT_EQ(again[0].model.parameters(), cameras[0].model.parameters());
  EXPECT_EQ(ToYaml(ToValue(again)), text);
}

TEST(CameraChain, EveryModelIsReadBackToTheBit) {
  for (const Lens& lens : Lenses()) {
    const std::vector<Camera> chain = {{Make(lens), {640, 480}, "/cam0/image_raw", std::nullopt}};
    const std::string text = ToYaml(ToValue(chain));
    const auto again = CameraChainFromValue(ParseYaml(text, "again.yaml"), nullptr);
    ASSERT_EQ(again.size(), 1U) << lens.model;
    EXPECT_EQ(again[0].model.name(), lens.model);
    EXPECT_EQ(again[0].model.parameters(), chain[0].model.parameters()) << lens.model;
  }
}

TEST(CameraChain, ModelsAreCalledAsInKalibr) {
  const auto yaml = [](const std::string& projection, const std::string& intrinsics,
                       const std::string& distortion, const std::string& coefficients) {
    return "cam0:\n  camera_model: " + projection + "\n  intrinsics: " + intrinsics +
           "\n  distortion_model: " + distortion + "\n  distortion_coeffs: " + coefficients +
           "\n  resolution: [640, 480]\n";
  };
  const auto name = [](const std::string& text) {
    return std::string(CameraChainFromValue(ParseYaml(text, "x"), nullptr)[0].model.name());
  };
  EXPECT_EQ(name(yaml("pinhole", "[2, 2, 3, 4]", "none", "[]")), "pinhole-none");
  EXPECT_EQ(name(yaml("pinhole", "[2, 2, 3, 4]", "radtan", "[0, 0, 0, 0]")), "pinhole-radtan");
  EXPECT_EQ(name(yaml("pinhole", "[2, 2, 3, 4]", "radtan5", "[0, 0, 0, 0, 0]")), "pinhole-radtan5");
  EXPECT_EQ(name(yaml("pinhole", "[2, 2, 3, 4]", "equidistant", "[0, 0, 0, 0]")), "pinhole-equi");
  EXPECT_EQ(name(yaml("pinhole", "[2, 2, 3, 4]", "fov", "[1]")), "pinhole-fov");
  EXPECT_EQ(name(yaml("omni", "[1, 2, 2, 3, 4]", "none", "[]")), "omni-none");
  EXPECT_EQ(name(yaml("omni", "[1, 2, 2, 3, 4]", "radtan", "[0, 0, 0, 0]")), "omni-radtan");
  EXPECT_EQ(name(yaml("ds", "[0, 0.5, 2, 2, 3, 4]", "none", "[]")), "ds-none");
  EXPECT_EQ(name(yaml("eucm", "[0.5, 1, 2, 2, 3, 4]", "none", "[]")), "eucm-none");

  const std::string written = ToYaml(ToValue(CameraChainFromValue(
      ParseYaml(yaml("pinhole", "[2, 2, 3, 4]", "equidistant", "[0, 0, 0, 0]"), "x"), nullptr)));
  EXPECT_NE(written.find("distortion_model: equidistant"), std::string::npos) << written;

  // The right number of parameters in all, but not in each list.
  EXPECT_NE(ErrorOf(yaml("pinhole", "[2, 2, 3, 4, 0]", "radtan", "[0, 0, 0]"))
                .find("expected 4, got 5; give fu fv pu pv"),
            std::string::npos);
  EXPECT_NE(ErrorOf(yaml("ds", "[0, 0.5, 2, 2, 3, 4]", "radtan", "[0, 0, 0, 0]"))
                .find("unknown camera model 'ds-radtan'"),
            std::string::npos);
}

TEST(CameraChain, AMissingKeyIsNamedWithItsCamera) {
  const std::string error = ErrorOf("cam0:\n  camera_model: pinhole\n  distortion_model: none\n");
  EXPECT_NE(error.find("intrinsics"), std::string::npos) << error;
  EXPECT_NE(error.find("cam0"), std::string::npos) << error;
}

TEST(CameraChain, TheWrongNumberOfCoefficientsIsAnError) {
  std::string yaml(kYaml);
  yaml.replace(yaml.find(", 1.76187114e-05"), 16, "");
  const std::string error = ErrorOf(yaml);
  EXPECT_NE(error.find("expected 8, got 7"), std::string::npos) << error;
  EXPECT_NE(error.find("chain.yaml line"), std::string::npos) << error;
}

TEST(CameraChain, CamerasOutOfOrderAreAnError) {
  std::string yaml(kYaml);
  yaml.replace(yaml.find("cam1"), 4, "cam2");
  EXPECT_NE(ErrorOf(yaml).find("cam1"), std::string::npos);
}

TEST(Rigid3FromValue, TakesRowsOrSixteenNumbersAndRefusesTheRest) {
  const Rigid3 T{ExpSo3({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}};
  const Rigid3 read = Rigid3FromValue(ParseYaml(ToYaml(ToValue(T)), "x"));
  EXPECT_LT((read.R - T.R).norm() + (read.t - T.t).norm(), 1e-14);
  EXPECT_EQ(Rigid3FromValue(ParseYaml("[1,0,0,5, 0,1,0,6, 0,0,1,7, 0,0,0,1]", "x")).t,
            Eigen::Vector3d(5.0, 6.0, 7.0));
  EXPECT_THROW((void)Rigid3FromValue(ParseYaml("[2,0,0,5, 0,1,0,6, 0,0,1,7, 0,0,0,1]", "x")),
               InputError);
  EXPECT_THROW((void)Rigid3FromValue(ParseYaml("[1,0,0,5, 0,1,0,6, 0,0,-1,7, 0,0,0,1]", "x")),
               InputError);
  EXPECT_THROW((void)Rigid3FromValue(ParseYaml("[1,0,0,5, 0,1,0,6, 0,0,1,7, 0,0,1,1]", "x")),
               InputError);
}

}  // namespace
}  // namespace calibrato
