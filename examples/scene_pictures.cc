// The pictures of docs/simulation.md: the scene from outside, and what the camera sees at the start
// and at five poses of the handcrafted motion.
//
//   scene_pictures FOLDER

#include <array>
#include <cstdio>
#include <string>
#include <variant>

#include "calibrato/base/files.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/recording/photo.h"
#include "calibrato/simulation/outside_view.h"
#include "calibrato/simulation/rendered_camera.h"

namespace calibrato {
namespace {

// Three in a row, each at half its size: the mean of four pixels.
GreyImage Sheet(const std::array<GreyImage, 6>& images) {
  const Resolution half{images[0].resolution.width / 2, images[0].resolution.height / 2};
  GreyImage sheet{{3 * half.width, 2 * half.height}, {}};
  sheet.pixels.resize(1UL * sheet.resolution.width * sheet.resolution.height);
  for (int v = 0; v < sheet.resolution.height; ++v) {
    for (int u = 0; u < sheet.resolution.width; ++u) {
      const GreyImage& image = images[3 * (v / half.height) + u / half.width];
      const size_t width = image.resolution.width;
      const uint8_t* pixel =
          image.pixels.data() + width * 2 * (v % half.height) + 2 * (u % half.width);
      const int sum = pixel[0] + pixel[1] + pixel[width] + pixel[width + 1];
      sheet.pixels[1UL * sheet.resolution.width * v + u] = static_cast<uint8_t>((sum + 2) / 4);
    }
  }
  return sheet;
}

void Draw(const std::string& folder) {
  Rig rig = PaperRig();
  rig.exposure_s = 0.005;
  rig.image_disturbances.read_noise = 1.5;
  rig.image_disturbances.shot_noise = 0.02;
  rig.image_disturbances.vignetting = 0.2;
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.carrier = Carrier::kArm;
  const CarrierPath path = PlannedPath(std::get<TimedMotion>(PlanMotion(motion, rig)));
  WriteFileAtomically(folder + "/scene.png", EncodePng(OutsideView(rig).Draw(path, 1.7)));
  const RenderedCamera camera(rig);
  std::array<GreyImage, 6> images;
  constexpr std::array<double, 6> kTimes = {0.0, 1.7, 2.7, 7.5, 11.9, 13.2};  // [s]
  for (size_t i = 0; i < images.size(); ++i) {
    Rng noise(i);
    images[i] = camera.Take(path, kTimes[i], noise);
  }
  WriteFileAtomically(folder + "/camera-views.png", EncodePng(Sheet(images)));
}

}  // namespace
}  // namespace calibrato

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: scene_pictures FOLDER\n");
    return 2;
  }
  calibrato::Draw(argv[1]);
  return 0;
}
