#include "calibrato/diagnosis/comparison_document.h"

#include <gtest/gtest.h>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/camera_chain.h"

namespace calibrato {
namespace {

// result.json of two pinhole cameras with these focal lengths, the second 0.1 m beside the first
// and turned; every sigma is 1 px, 1 mrad, 1 mm.
Value Result(double f0, double f1, double turn_rad) {
  const auto camera = [](double f) {
    Value value = Value::Object();
    value.Set("model", "pinhole-none")
        .Set("resolution", Value::Numbers(std::vector<double>{640, 480}))
        .Set("intrinsics", Value::Numbers(std::vector<double>{f, f, 320.0, 240.0}))
        .Set("distortion", Value::Array())
        .Set("T_cn_cnm1", Value());
    return value;
  };
  Value second = camera(f1);
  second.Set("T_cn_cnm1", ToValue(Rigid3{ExpSo3({0.0, turn_rad, 0.0}), {-0.1, 0.0, 0.0}}));
  Value names = Value::Array();
  std::vector<double> variances;
  for (const char* name :
       {"cam0.fu", "cam0.fv", "cam0.pu", "cam0.pv", "cam1.fu", "cam1.fv", "cam1.pu", "cam1.pv"}) {
    names.Append(name);
    variances.push_back(1.0);
  }
  for (const char* name :
       {"cam1.rot_x", "cam1.rot_y", "cam1.rot_z", "cam1.pos_x", "cam1.pos_y", "cam1.pos_z"}) {
    names.Append(name);
    variances.push_back(1e-6);
  }
  Value matrix = Value::Array();
  for (size_t row = 0; row < variances.size(); ++row) {
    std::vector<double> entries(variances.size(), 0.0);
    entries[row] = variances[row];
    matrix.Append(Value::Numbers(entries));
  }
  Value covariance = Value::Object();
  covariance.Set("names", names).Set("matrix", matrix);
  Value result = Value::Object();
  result.Set("kind", "camera")
      .Set("cameras", Value::Array().Append(camera(f0)).Append(second))
      .Set("covariance", covariance);
  return result;
}

TEST(CompareResults, AgreeWithinTheirCovariances) {
  const ResultComparison comparison =
      CompareResults(Result(600.0, 610.0, 0.01), Result(601.0, 610.5, 0.011));
  EXPECT_EQ(AgreementOf(comparison), Agreement::kAgree);
  ASSERT_EQ(comparison.cameras.size(), 2U);
  // fu and fv 1 px apart, each with variance 1 + 1.
  EXPECT_NEAR(comparison.cameras[0].camera.significance.statistic, 1.0, 1e-12);
  EXPECT_NEAR(comparison.cameras[1].camera.significance.statistic, 0.25, 1e-12);
  EXPECT_FALSE(comparison.cameras[0].T_cn_cnm1);
  EXPECT_NEAR(comparison.cameras[1].T_cn_cnm1->rotation_rad, 1e-3, 1e-12);
  EXPECT_NEAR(comparison.cameras[1].T_cn_cnm1->significance.statistic, 0.5, 1e-6);
}

TEST(CompareResults, DifferWhereOneFocalLengthDoes) {
  const ResultComparison comparison =
      CompareResults(Result(600.0, 610.0, 0.01), Result(600.0, 620.0, 0.01));
  EXPECT_EQ(AgreementOf(comparison), Agreement::kDiffer);
  const Value value = ComparisonResult(comparison);
  EXPECT_EQ(value.At("kind").AsString(), "diff");
  EXPECT_EQ(value.At("agreement").AsString(), "differ");
  const Value& camera = value.At("cameras").elements()[1];
  EXPECT_LT(camera.At("probability").AsDouble(), 1e-9);
  EXPECT_NEAR(camera.At("difference_px").At("worst_px").AsDouble(), 10.0 / 610.0 * 400.0, 0.1);
  EXPECT_NE(ComparisonText(comparison).find("differ by more than chance"), std::string::npos);
}

TEST(CompareResults, DifferWhereThePoseBetweenTheCamerasDoes) {
  const ResultComparison comparison =
      CompareResults(Result(600.0, 610.0, 0.01), Result(600.0, 610.0, 0.02));
  EXPECT_EQ(AgreementOf(comparison), Agreement::kDiffer);
}

TEST(CompareResults, AreInconclusiveWithoutACovariance) {
  Value second = Result(600.0, 610.0, 0.01);
  Value none = Value::Object();
  none.Set("names", Value::Array()).Set("matrix", Value::Array());
  second.Set("covariance", none);
  const ResultComparison comparison = CompareResults(Result(600.0, 610.0, 0.01), second);
  EXPECT_EQ(AgreementOf(comparison), Agreement::kInconclusive);
  const Value read = ParseJson(ToJson(ComparisonResult(comparison)), "diff");
  EXPECT_EQ(read.At("cameras").elements()[0].Find("probability"), nullptr);
}

TEST(CompareResults, RefuseWhatIsNotOfTheSameCameras) {
  const Value rig = Result(600.0, 610.0, 0.01);
  Value alone = rig;
  alone.Set("cameras", Value::Array().Append(rig.At("cameras").elements()[0]));
  EXPECT_THROW((void)CompareResults(rig, alone), InputError);
  Value training = rig;
  training.Set("kind", "learn");
  EXPECT_THROW((void)CompareResults(rig, training), InputError);
  Value unfinished = Value::Object();
  unfinished.Set("model", "pinhole-none")
      .Set("resolution", Value::Numbers(std::vector<double>{640, 480}));
  Value without = rig;
  without.Set("cameras", Value::Array().Append(unfinished).Append(unfinished));
  EXPECT_THROW((void)CompareResults(rig, without), InputError);
}

}  // namespace
}  // namespace calibrato
