#include <vector>

#include "calibrato/report/documents_for_test.h"

namespace calibrato {
namespace {

Value Numbers(const std::vector<double>& numbers) { return Value::Numbers(numbers); }

}  // namespace

Value CameraImuDiffDocumentForTest() {
  const Value parameter =
      Value::Object().Set("name", "cam0.time_offset").Set("difference", 4e-4).Set("sigma", 1e-4);
  const Value group = Value::Object()
                          .Set("name", "cam0 time offset")
                          .Set("probability", 6e-5)
                          .Set("statistic", 16.0)
                          .Set("degrees_of_freedom", 1.0)
                          .Set("parameters", Value::Array().Append(parameter));
  Value document = Value::Object();
  document.Set("kind", "diff")
      .Set("of", "camera-imu")
      .Set("agreement", "differ")
      .Set("cameras", Value::Array().Append(Value::Object()
                                                .Set("name", "cam0")
                                                .Set("difference_px", 0.163)
                                                .Set("expected_difference_px", 0.041)))
      .Set("groups", Value::Array().Append(group));
  return document;
}

Value MergeDocumentForTest() {
  const Value parameter = Value::Object()
                              .Set("name", "cam0.fu")
                              .Set("value", 585.7512)
                              .Set("sigma", 0.31)
                              .Set("repeatability", 0.92)
                              .Set("stated_sigma", 0.4)
                              .Set("deviations", Numbers({-0.9, 0.1, 0.8}))
                              .Set("sigmas", Numbers({0.4, 0.4, 0.4}));
  const Value group = Value::Object()
                          .Set("name", "cam0 lens")
                          .Set("probability", 1e-4)
                          .Set("statistic", 36.0)
                          .Set("degrees_of_freedom", 8.0)
                          .Set("sigma_scale", 2.12)
                          .Set("parameters", Value::Array().Append(parameter));
  Value document = Value::Object();
  document.Set("kind", "merge")
      .Set("of", "camera")
      .Set("verdict", "warn")
      .Set("findings", Value::Array())
      .Set("results", Value::Array().Append("monday").Append("tuesday").Append("friday"))
      .Set("groups", Value::Array().Append(group));
  return document;
}

}  // namespace calibrato
