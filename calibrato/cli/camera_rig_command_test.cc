// `calibrato calibrate camera` on lists of corners that several cameras saw.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kFocalLength = 500.0;
constexpr double kBaseline = 0.1;  // Each camera is so far to the right of the one before it [m].
constexpr double kSpacing = 0.03;

struct View {
  int frame = 0;
  std::vector<std::array<double, 2>> pixels;  // By the number of the corner.
};

// Pinholes side by side, and a checkerboard before them.
class CameraRig : public testing::Test {
 protected:
  // [camera][view]; where a board is partly out of the image there is none.
  std::vector<std::vector<View>> Views(int num_cameras) const {
    Rng rng(1);
    std::vector<std::vector<View>> views(static_cast<size_t>(num_cameras));
    for (int frame = 0; frame < 40; ++frame) {
      const double x = rng.Uniform(-0.15, 0.45);
      const double y = rng.Uniform(-0.25, 0.25);
      const double z = rng.Uniform(0.6, 1.1);
      const double roll = rng.Uniform(-0.4, 0.4);
      const double pitch = rng.Uniform(-0.6, 0.6);
      const double yaw = rng.Uniform(-0.6, 0.6);
      for (int camera = 0; camera < num_cameras; ++camera) {
        View view{frame, {}};
        bool is_inside = true;
        for (int id = 0; id < rows_ * columns_; ++id) {
          // About the board's middle; turned about z, x and y in this order.
          const double a = (id % columns_ - 0.5 * (columns_ - 1)) * kSpacing;
          const double b = (id / columns_ - 0.5 * (rows_ - 1)) * kSpacing;
          const double u = std::cos(roll) * a - std::sin(roll) * b;
          const double v = std::sin(roll) * a + std::cos(roll) * b;
          const double depth = std::sin(pitch) * v;
          const double X = std::cos(yaw) * u + std::sin(yaw) * depth + x - camera * kBaseline;
          const double Y = std::cos(pitch) * v + y;
          const double Z = std::cos(yaw) * depth - std::sin(yaw) * u + z;
          view.pixels.push_back({kFocalLength * X / Z + 319.5 + 0.1 * rng.Normal(),
                                 kFocalLength * Y / Z + 239.5 + 0.1 * rng.Normal()});
          is_inside = is_inside && std::abs(view.pixels.back()[0] - 319.5) < 315.0 &&
                      std::abs(view.pixels.back()[1] - 239.5) < 235.0;
        }
        if (is_inside) views[static_cast<size_t>(camera)].push_back(view);
      }
    }
    return views;
  }

  void Write(const std::vector<std::vector<View>>& views) const {
    for (size_t camera = 0; camera < views.size(); ++camera) {
      std::ostringstream text;
      text.precision(12);
      text << "timestamp [ns],tag_id,tag_corner,u [px],v [px]\n";
      for (const View& view : views[camera]) {
        for (size_t id = 0; id < view.pixels.size(); ++id) {
          text << 1'000'000'000 + 100'000'000LL * view.frame << "," << id << ",0,"
               << view.pixels[id][0] << "," << view.pixels[id][1] << "\n";
        }
      }
      (void)scratch_.Write("rig/cam" + std::to_string(camera) + "_corners.csv", text.str());
    }
  }

  Ended Calibrate(const Arguments& more = {}) const {
    const std::string target = scratch_.Write(
        "board.yaml", "target_type: 'checkerboard'\ntargetCols: " + std::to_string(columns_) +
                          "\ntargetRows: " + std::to_string(rows_) +
                          "\nrowSpacingMeters: 0.03\ncolSpacingMeters: 0.03\n");
    Arguments arguments = {
        "calibrate", "camera",  scratch_.Path("rig"), "--target", target,  "--resolution",
        "640x480",   "--model", "pinhole-none",       "--json",   "--out", scratch_.Path("out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(arguments);
  }
  Value Result(int expected_exit, const Arguments& more = {}) const {
    const Ended ended = Calibrate(more);
    EXPECT_EQ(ended.exit_code, expected_exit) << ended.err << ended.out;
    return ParseJson(ended.out, "stdout");
  }
  static std::string FindingsOf(const Value& result) {
    std::string text;
    for (const Value& finding : result.At("findings").elements()) {
      text += finding.At("severity").AsString() + ": " + finding.At("what").AsString() + "\n";
    }
    return text;
  }
  static const Value& Camera(const Value& result, size_t camera) {
    return result.At("cameras").elements()[camera];
  }

  ScratchFolder scratch_;
  int rows_ = 6;
  int columns_ = 7;
};

TEST_F(CameraRig, GoodCamerasHaveTheirResultBesideABadOne) {
  std::vector<std::vector<View>> views = Views(3);
  views[1].resize(2);
  Write(views);
  const Value result = Result(1);
  EXPECT_EQ(result.At("verdict").AsString(), "fail");
  EXPECT_THAT(FindingsOf(result),
              AllOf(HasSubstr("fail: cam1: only 2 views show the board"),
                    HasSubstr("info: cam1 could not be calibrated: the place of cam2 is given from "
                              "cam0 instead"),
                    HasSubstr("info: camchain.yaml is not written"), Not(HasSubstr("share no"))));
  for (const size_t good : {0U, 2U}) {
    EXPECT_NEAR(Camera(result, good).At("intrinsics").AsDoubles(4)[0], kFocalLength, 2.0);
  }
  EXPECT_EQ(Camera(result, 1).Find("intrinsics"), nullptr);
  EXPECT_GT(result.At("coverage").At("x").AsDouble(), 0.5);
  EXPECT_FALSE(std::filesystem::exists(scratch_.Path("out/camchain.yaml")));
  EXPECT_TRUE(std::filesystem::exists(scratch_.Path("out/report.html")));
}

TEST_F(CameraRig, ARigOfBadCamerasIsRefused) {
  std::vector<std::vector<View>> views = Views(2);
  for (std::vector<View>& camera : views) camera.resize(2);
  Write(views);
  const Ended ended = Calibrate();
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("too few views"), HasSubstr("at least 3")));
  EXPECT_FALSE(std::filesystem::exists(scratch_.Path("out")));
}

TEST_F(CameraRig, ACameraWithoutItsNeighbourIsRelatedToAnEarlierOne) {
  std::vector<std::vector<View>> views = Views(3);
  for (View& view : views[1]) view.frame += 1000;
  Write(views);
  const Value result = Result(0);
  EXPECT_THAT(FindingsOf(result),
              AllOf(HasSubstr("warn: cam0 and cam1 share no frame in which both saw the board: "
                              "where cam1 is from cam0 is not known"),
                    HasSubstr("info: cam1 and cam2 share no frame in which both saw the board: the "
                              "place of cam2 is given from cam0 instead")));
  EXPECT_EQ(Camera(result, 2).Find("T_cn_cnm1"), nullptr);
  const Value& earlier = Camera(result, 2).At("earlier_relation");
  EXPECT_EQ(earlier.At("camera").AsString(), "cam0");
  EXPECT_NEAR(earlier.At("T_cn_camera").AsDoubles(16)[3], -2.0 * kBaseline, 2e-3);
  EXPECT_EQ(Camera(result, 1).Find("earlier_relation"), nullptr);
  EXPECT_THAT(ToJson(result.At("covariance").At("names")),
              AllOf(HasSubstr("cam2.from_cam0.pos_x"), Not(HasSubstr("cam2.pos_x"))));
}

TEST_F(CameraRig, OneBendingOfCamerasThatAreNotRelatedIsRefused) {
  std::vector<std::vector<View>> views = Views(2);
  for (View& view : views[1]) view.frame += 1000;
  Write(views);
  const Ended ended = Calibrate({"--estimate-bending"});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("cam0 | cam1"), HasSubstr("--estimate-bending")));
  EXPECT_FALSE(std::filesystem::exists(scratch_.Path("out")));
}

TEST_F(CameraRig, ABoardThatLooksTheSameUpsideDownIsNumberedAlike) {
  rows_ = 6;
  columns_ = 8;
  std::vector<std::vector<View>> views = Views(2);
  for (size_t v = 0; v < views[1].size(); v += 3) {
    std::reverse(views[1][v].pixels.begin(), views[1][v].pixels.end());
  }
  Write(views);
  const Value result = Result(0);
  EXPECT_NEAR(Camera(result, 1).At("T_cn_cnm1").AsDoubles(16)[3], -kBaseline, 1e-3);
  EXPECT_THAT(FindingsOf(result), Not(HasSubstr("do not fit")));
  EXPECT_TRUE(Camera(result, 1).At("rejected").At("views").elements().empty());
}

// A photo of a board of 6 x 7 inner corners, as a PGM of 320 x 240.
std::string Photo(double pitch, double yaw) {
  constexpr int kSamples = 3;  // Across a pixel.
  constexpr double kDistance = 1.0;
  std::string image = "P5\n320 240\n255\n";
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      int sum = 0;
      for (int sample = 0; sample < kSamples * kSamples; ++sample) {
        const double x = (u - 159.5 + (sample % kSamples + 0.5) / kSamples - 0.5) / 300.0;
        const double y = (v - 119.5 + (sample / kSamples + 0.5) / kSamples - 0.5) / 300.0;
        // Where the ray meets the board, whose x and y run along `across` and `down`.
        const std::array<double, 3> across = {std::cos(yaw), 0.0, -std::sin(yaw)};
        const std::array<double, 3> down = {std::sin(yaw) * std::sin(pitch), std::cos(pitch),
                                            std::cos(yaw) * std::sin(pitch)};
        const std::array<double, 3> normal = {std::sin(yaw) * std::cos(pitch), -std::sin(pitch),
                                              std::cos(yaw) * std::cos(pitch)};
        const double depth = kDistance * normal[2] / (x * normal[0] + y * normal[1] + normal[2]);
        const std::array<double, 3> offset = {depth * x, depth * y, depth - kDistance};
        double a = 0.0;
        double b = 0.0;
        for (size_t i = 0; i < 3; ++i) {
          a += offset[i] * across[i];
          b += offset[i] * down[i];
        }
        const int column = static_cast<int>(std::floor(a / 0.06 + 4.0));
        const int row = static_cast<int>(std::floor(b / 0.06 + 3.5));
        const bool is_square = column >= 0 && column < 8 && row >= 0 && row < 7;
        sum += is_square && (row + column) % 2 == 0 ? 30 : 220;
      }
      image.push_back(static_cast<char>(sum / (kSamples * kSamples)));
    }
  }
  return image;
}

TEST_F(CameraRig, ACameraWithoutImagesInTheWindowDoesNotStopTheOther) {
  for (int k = 0; k < 6; ++k) {
    const std::string photo = Photo(0.5 * std::cos(1.0 * k), 0.5 * std::sin(1.0 * k));
    const std::string seconds = std::to_string(10 + k) + "000000000.pgm";
    (void)scratch_.Write("rig/cam0/data/1" + seconds, photo);
    (void)scratch_.Write("rig/cam1/data/2" + seconds, photo);  // 100 s later.
  }
  const Value result = Result(1, {"--to", "20"});
  EXPECT_THAT(FindingsOf(result),
              HasSubstr("fail: cam1: no board found in any image: none of its images lies in the "
                        "window"));
  EXPECT_NEAR(Camera(result, 0).At("intrinsics").AsDoubles(4)[0], 300.0, 5.0);
  EXPECT_EQ(Camera(result, 1).Find("intrinsics"), nullptr);
}

TEST_F(CameraRig, HeldParametersStayAndAreNamed) {
  Write(Views(1));
  const Value free = Result(0);
  const Value held = Result(0, {"--fix", "fu"});
  EXPECT_NEAR(Camera(held, 0).At("intrinsics").AsDoubles(4)[0],
              Camera(free, 0).At("intrinsics").AsDoubles(4)[0], 1e-3);
  EXPECT_EQ(Camera(held, 0).At("intrinsics_sigma").AsDoubles(4)[0], 0.0);
  EXPECT_THAT(FindingsOf(held), HasSubstr("info: fu is held at 500"));
  const Value given = Result(0, {"--fix", "fu=500.5,pu=319.5"});
  EXPECT_EQ(Camera(given, 0).At("intrinsics").AsDoubles(4)[0], 500.5);
  EXPECT_EQ(Camera(given, 0).At("intrinsics").AsDoubles(4)[2], 319.5);
  EXPECT_THAT(FindingsOf(given), Not(HasSubstr("is held")));
  const Value centred = Result(0, {"--fix", "pu,pv"});
  EXPECT_EQ(Camera(centred, 0).At("intrinsics").AsDoubles(4)[2], 319.5);
  EXPECT_THAT(FindingsOf(centred), HasSubstr("pu is held at 319.5, the middle of the image"));
}

TEST_F(CameraRig, AValueToHoldMustBePossible) {
  Write(Views(1));
  for (const char* word : {"fu=long", "fu=-500"}) {
    const Ended ended = Calibrate({"--fix", word});
    EXPECT_EQ(ended.exit_code, 2) << ended.out;
    EXPECT_THAT(ended.err, HasSubstr("fu"));
    EXPECT_FALSE(std::filesystem::exists(scratch_.Path("out")));
  }
}

}  // namespace
}  // namespace calibrato
