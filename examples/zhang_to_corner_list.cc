// Turns the data of Zhang's method into a recording that calibrato reads.
//
// Z. Zhang published a board of 8 x 8 separate black squares, seen in five images of 640 x 480: one
// line a square, the four corners of each as x y or u v. Model.txt holds them on the board [inch],
// data1.txt to data5.txt in the images [px].
//
//     zhang_to_corner_list FOLDER OUT
//     calibrato calibrate camera OUT --model pinhole-radtan --out RESULT
//
// Source: Z. Zhang, "A flexible new technique for camera calibration", IEEE PAMI 22 (2000).

#include <Eigen/Core>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/recording/corner_list.h"

namespace {

using namespace calibrato;

constexpr int kNumImages = 5;
constexpr int kNumCorners = 8 * 8 * 4;
constexpr double kMetresPerInch = 0.0254;

Eigen::Matrix2Xd ReadPoints(const std::string& path) {
  std::istringstream text(ReadFile(path));
  Eigen::Matrix2Xd points(2, kNumCorners);
  int count = 0;
  for (double x = 0.0, y = 0.0; text >> x >> y; ++count) {
    if (count < kNumCorners) points.col(count) << x, y;
  }
  if (count != kNumCorners || !text.eof()) {
    throw InputError({"not Zhang's data", path,
                      "expected 256 pairs of numbers, found " + std::to_string(count),
                      "give the folder with Model.txt and data1.txt to data5.txt"});
  }
  return points;
}

void Convert(const std::string& folder, const std::string& out) {
  const Eigen::Matrix2Xd model = kMetresPerInch * ReadPoints(folder + "/Model.txt");
  std::vector<BoardView> views(kNumImages);
  for (int i = 0; i < kNumImages; ++i) {
    BoardView& view = views[static_cast<size_t>(i)];
    view.stamp =
        Time::FromNanoseconds((i + 1) * int64_t{1'000'000'000});  // only to tell them apart
    for (int k = 0; k < kNumCorners; ++k) view.corner_ids.push_back(k);
    view.pixels = ReadPoints(folder + "/data" + std::to_string(i + 1) + ".txt");
    // Zhang's y runs down the board; ours up, so that z = x cross y points towards the viewer.
    view.points_g = Eigen::Matrix3Xd::Zero(3, kNumCorners);
    view.points_g.row(0) = model.row(0);
    view.points_g.row(1) = -model.row(1);
  }
  OutputFolder files(out);
  files.Add("cam0_corners.csv", CornerListText(views, 4));
  files.Add("sensor.yaml",
            ToYaml(Value::Object().Set("resolution", Value::Array().Append(640).Append(480))));
  files.Commit();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "error: usage: zhang_to_corner_list FOLDER OUT\n";
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
