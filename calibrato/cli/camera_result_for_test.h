#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {

/// Writes what `calibrate camera` leaves of one pinhole camera of this focal length [px]; every
/// sigma is 1 px.
/// @return the folder.
inline std::string WriteCameraResult(const ScratchFolder& scratch, const std::string& folder,
                                     double f) {
  const std::vector<double> intrinsics = {f, f, 320.0, 240.0};
  const Value camera = Value::Object()
                           .Set("model", "pinhole-none")
                           .Set("resolution", Value::Numbers(std::vector<double>{640, 480}))
                           .Set("intrinsics", Value::Numbers(intrinsics))
                           .Set("distortion", Value::Array())
                           .Set("T_cn_cnm1", Value());
  Value names = Value::Array();
  Value matrix = Value::Array();
  for (size_t i = 0; i < 4; ++i) {
    names.Append(std::string("cam0.") + std::string("fufvpupv").substr(2 * i, 2));
    std::vector<double> row(4, 0.0);
    row[i] = 1.0;
    matrix.Append(Value::Numbers(row));
  }
  Value result = Value::Object();
  result.Set("kind", "camera")
      .Set("verdict", "pass")
      .Set("cameras", Value::Array().Append(camera))
      .Set("covariance", Value::Object().Set("names", names).Set("matrix", matrix));
  const Value chain =
      Value::Object().Set("cam0", Value::Object()
                                      .Set("camera_model", "pinhole")
                                      .Set("intrinsics", Value::Numbers(intrinsics))
                                      .Set("distortion_model", "none")
                                      .Set("distortion_coeffs", Value::Array())
                                      .Set("resolution", Value::Array().Append(640).Append(480))
                                      .Set("rostopic", "/cam0/image_raw"));
  (void)scratch.Write(folder + "/camchain.yaml", ToYaml(chain));
  const std::string path = scratch.Write(folder + "/result.json", ToJson(result));
  return std::filesystem::path(path).parent_path().string();
}

}  // namespace calibrato
