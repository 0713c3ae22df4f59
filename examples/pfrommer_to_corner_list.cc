// Turns the corners of a stereo fisheye rig that B. Pfrommer published with his calibrator into a
// recording that calibrato reads.
//
// One line a corner: camera, stamp [ns], u v of his calibrated model, u v as detected [px]. The
// board has 3 x 4 AprilTags of 0.07 m, 0.087 m apart, and the file does not say which tag a corner
// is of: only views of all 48 corners, which stand in the order of the tags, are taken.
//
//     pfrommer_to_corner_list FOLDER OUT
//     calibrato calibrate camera OUT --model pinhole-equi --out RESULT
//
// Source: github.com/berndpfrommer/multicam_imu_calib, stereo_camera_output/projections.txt.

#include <array>
#include <cstdint>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/recording/corner_list.h"

namespace {

using namespace calibrato;

constexpr int kTagColumns = 4;
constexpr int kNumCorners = 3 * kTagColumns * 4;
constexpr double kTagSize = 0.07;    // [m]
constexpr double kTagPitch = 0.087;  // [m]

// Anticlockwise from the tag's lower left, as seen by the viewer.
Eigen::Matrix3Xd BoardPointsOfTags() {
  constexpr std::array<std::array<int, 2>, 4> kCorners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, kNumCorners);
  for (int k = 0; k < kNumCorners; ++k) {
    const int tag = k / 4;
    const auto& corner = kCorners[static_cast<size_t>(k % 4)];
    points(0, k) = kTagPitch * (tag % kTagColumns) + kTagSize * corner[0];
    points(1, k) = kTagPitch * (tag / kTagColumns) + kTagSize * corner[1];
  }
  return points;
}

// [camera][stamp]: detected corners.
using Corners = std::map<int, std::map<int64_t, std::vector<Eigen::Vector2d>>>;

Corners ReadProjections(const std::string& path) {
  std::istringstream text(ReadFile(path));
  Corners corners;
  int camera = 0;
  int64_t stamp = 0;
  double model_u = 0.0, model_v = 0.0, u = 0.0, v = 0.0;
  while (text >> camera >> stamp >> model_u >> model_v >> u >> v) {
    corners[camera][stamp].emplace_back(u, v);
  }
  if (!text.eof() || corners.empty()) {
    throw InputError({"not a list of projections", path, "expected lines of six numbers",
                      "give the folder with projections.txt"});
  }
  return corners;
}

void Convert(const std::string& folder, const std::string& out) {
  const Eigen::Matrix3Xd points_g = BoardPointsOfTags();
  OutputFolder files(out);
  for (const auto& [camera, by_stamp] : ReadProjections(folder + "/projections.txt")) {
    std::vector<BoardView> views;
    for (const auto& [stamp, corners] : by_stamp) {
      if (corners.size() != static_cast<size_t>(kNumCorners)) continue;
      BoardView view;
      view.stamp = Time::FromNanoseconds(stamp);
      view.points_g = points_g;
      view.pixels.resize(2, kNumCorners);
      for (int k = 0; k < kNumCorners; ++k) {
        view.corner_ids.push_back(k);
        view.pixels.col(k) = corners[static_cast<size_t>(k)];
      }
      views.push_back(std::move(view));
    }
    files.Add("cam" + std::to_string(camera) + "_corners.csv", CornerListText(views, 4));
  }
  files.Add("sensor.yaml",
            ToYaml(Value::Object().Set("resolution", Value::Array().Append(1440).Append(1080))));
  files.Commit();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "error: usage: pfrommer_to_corner_list FOLDER OUT\n";
    return 2;
  }
  try {
    Convert(argv[1], argv[2]);
  } catch (const InputError& error) {
    std::cerr << "error: " << error.what() << "\n";
    return 2;
  }
  return 0;
}
