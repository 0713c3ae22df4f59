#include "calibrato/simulation/rendered_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <variant>

#include "calibrato/motion/paper_scene.h"
#include "calibrato/rendering/render_board.h"
#include "calibrato/simulation/fast_simulation.h"

namespace calibrato {
namespace {

const Time kStart = Time::FromNanoseconds(1'600'000'000'000'000'000);

CarrierPath Path(Carrier carrier, const Motion& from) {
  Motion motion = from;
  motion.carrier = carrier;
  return PlannedPath(std::get<TimedMotion>(PlanMotion(motion, PaperRig())));
}
CarrierPath Handcrafted() { return Path(Carrier::kArm, HandcraftedMotion(Task::kExtrinsic)); }

Rig DistortedRig() {
  Rig rig = PaperRig();
  Eigen::VectorXd parameters(8);
  parameters << 585.0, 586.0, 320.5, 240.5, -0.28, 0.08, 5e-4, -3e-4;
  rig.cameras[0].model = CameraModel("pinhole-radtan", parameters);
  return rig;
}

GreyImage Take(const Rig& rig, const CarrierPath& path, double t_s, uint64_t seed = 1) {
  Rng rng(seed);
  return RenderedCamera(rig).Take(path, t_s, rng);
}

// How far two images differ where `layer` covers the pixel wholly.
int WorstOnTheBoard(const GreyImage& image, const BoardLayer& layer) {
  const GreyImage board = Digitised(layer.light);
  int worst = 0;
  for (size_t k = 0; k < image.pixels.size(); ++k) {
    if (layer.coverage[k] < 0.9999F) continue;
    worst = std::max(worst, std::abs(image.pixels[k] - board.pixels[k]));
  }
  return worst;
}

TEST(RenderedCamera, TheBoardIsTheExactOneAndTheRoomIsBehindIt) {
  const Rig rig = DistortedRig();
  const CarrierPath path = Handcrafted();
  const GreyImage image = Take(rig, path, 2.0);
  const Rigid3 T_c_g = BoardInCamera(rig, path.at(2.0).T_b_e);
  const BoardLayer layer = RenderBoardLayer(PatternOf(rig.board), rig.cameras[0],
                                            {[&](double) { return T_c_g; }}, Scene());
  EXPECT_LE(WorstOnTheBoard(image, layer), 1);
  // The room is there, and not of one grey.
  std::vector<int> room;
  for (size_t k = 0; k < image.pixels.size(); ++k) {
    if (layer.coverage[k] == 0.0F) room.push_back(image.pixels[k]);
  }
  const auto [least, most] = std::minmax_element(room.begin(), room.end());
  EXPECT_GT(room.size(), 100'000u);
  EXPECT_GT(*most - *least, 40);
}

TEST(RenderedCamera, AnExposureIsTheMeanOfItsInstants) {
  Rig rig = DistortedRig();
  rig.exposure_s = 0.02;
  const CarrierPath path = Handcrafted();
  const double t_s = 1.6;
  const GreyImage image = Take(rig, path, t_s);
  std::vector<PoseOfRow> instants;
  constexpr int kNumInstants = 40;  // not those that the camera takes
  for (int i = 0; i < kNumInstants; ++i) {
    const double t = t_s + rig.exposure_s * ((i + 0.5) / kNumInstants - 0.5);
    const Rigid3 T_c_g = BoardInCamera(rig, path.at(t).T_b_e);
    instants.emplace_back([T_c_g](double) { return T_c_g; });
  }
  const BoardLayer layer =
      RenderBoardLayer(PatternOf(rig.board), rig.cameras[0], instants, Scene());
  // Half a pixel between instants, on a contrast of 200, averaged over a pixel.
  EXPECT_LE(WorstOnTheBoard(image, layer), 8);
}

TEST(RenderedCamera, RollingShutterExposesRowsOneAfterTheOther) {
  for (const double line_delay_s : {5e-5, 2e-4}) {
    Rig rig = DistortedRig();
    rig.image_disturbances.line_delay_s = line_delay_s;
    const CarrierPath path = Handcrafted();
    const double t_s = 1.6;
    const GreyImage image = Take(rig, path, t_s);
    const PoseOfRow exact = [&](double row) {
      return BoardInCamera(rig, path.at(t_s + rig.image_disturbances.line_delay_s * row).T_b_e);
    };
    const BoardLayer layer =
        RenderBoardLayer(PatternOf(rig.board), rig.cameras[0], {exact}, Scene());
    EXPECT_LE(WorstOnTheBoard(image, layer), 2);
  }
}

TEST(RenderedCamera, TheHandHidesTheBoardWhereItIsNearer) {
  Rig rig = PaperRig();
  rig.T_e_c0.t.z() = -0.12;  // behind the palm, which fills the middle of the image
  const CarrierPath path = Handcrafted();
  const Rigid3 T_c_g = BoardInCamera(rig, path.at(0.0).T_b_e);
  const BoardLayer layer = RenderBoardLayer(PatternOf(rig.board), rig.cameras[0],
                                            {[&](double) { return T_c_g; }}, Scene());
  const auto num_as_board = [&](const CarrierPath& with) {
    const GreyImage image = Take(rig, with, 0.0);
    int count = 0;
    for (size_t k = 0; k < image.pixels.size(); ++k) {
      count +=
          layer.coverage[k] > 0.9999F && std::abs(image.pixels[k] - layer.light.pixels[k]) < 1.0F
              ? 1
              : 0;
    }
    return count;
  };
  CarrierPath without_arm = path;
  without_arm.joints = nullptr;
  const int num_board = num_as_board(without_arm);
  EXPECT_GT(num_board, 20'000);
  EXPECT_LT(num_as_board(path), num_board / 2);
}

TEST(RenderedCamera, LightFallsOffAndNoiseHasItsVariance) {
  Rig rig = PaperRig();
  Motion still;
  still.loops.resize(1);
  const CarrierPath path = Path(Carrier::kFree, still);
  const GreyImage plain = Take(rig, path, 0.0);
  rig.image_disturbances.vignetting = 0.5;
  const GreyImage vignetted = Take(rig, path, 0.0);
  EXPECT_NEAR(vignetted.pixels.front(), 0.5 * plain.pixels.front(), 1.0);
  EXPECT_NEAR(vignetted.pixels[640 * 240 + 320], plain.pixels[640 * 240 + 320], 1.0);
  rig.image_disturbances.vignetting = 0.0;
  rig.image_disturbances.read_noise = 3.0;
  const GreyImage noisy = Take(rig, path, 0.0);
  double sum = 0.0;
  for (size_t k = 0; k < noisy.pixels.size(); ++k) {
    sum += std::pow(noisy.pixels[k] - plain.pixels[k], 2);
  }
  // Rounding adds 1/12 twice.
  EXPECT_NEAR(sum / static_cast<double>(noisy.pixels.size()), 9.0 + 1.0 / 6.0, 0.15);
}

TEST(SimulateImages, FramesHaveTheirStampsAndSomeAreDropped) {
  Rig rig = PaperRig();
  rig.image_disturbances.drop_probability = 0.2;
  rig.image_disturbances.stamp_jitter_s = 0.001;
  Motion still;
  still.loops.resize(1);
  const CarrierPath path = Path(Carrier::kFree, still);
  std::vector<SimulatedImage> frames;
  const auto keep = [&](SimulatedImage image) { frames.push_back(std::move(image)); };
  const int num_dropped = SimulateImages(rig, path, kStart, Rng(1), keep);
  EXPECT_GT(num_dropped, 2);
  EXPECT_EQ(frames.size() + num_dropped, 50u);
  double sum = 0.0;
  for (const SimulatedImage& frame : frames) {
    const double late_s = (frame.stamp - kStart).seconds() - frame.t_s;
    EXPECT_LT(std::abs(late_s), 0.005);
    sum += late_s * late_s;
  }
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(frames.size())), 0.001, 0.0004);
}

TEST(SimulateImages, SameSeedSameBytes) {
  Rig rig = PaperRig();
  rig.exposure_s = 0.005;
  rig.image_disturbances.read_noise = 1.0;
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.loops.resize(1);
  motion.loops[0].duration_s = 5.0;
  CarrierPath path = Path(Carrier::kFree, motion);
  path.duration_s = 0.35;
  const auto take = [&] {
    std::vector<std::vector<uint8_t>> images;
    SimulateImages(rig, path, kStart, Rng(7),
                   [&](const SimulatedImage& image) { images.push_back(image.image.pixels); });
    return images;
  };
  const auto first = take();
  EXPECT_EQ(first.size(), 4u);
  EXPECT_EQ(first, take());
}

}  // namespace
}  // namespace calibrato
