#include "broken_recordings.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "calibrato/base/rng.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/recording/corner_list.h"
#include "calibrato/recording/imu_list.h"
#include "calibrato/recording/stored_image.h"
#include "calibrato/rendering/render_board.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

using Samples = std::vector<VectorSample>;

constexpr uint64_t kSeed = 11;
constexpr double kImagesS = 6.0;  // How long recordings of images are [s].

// An IMU of the kind that is built into cameras.
const ImuNoise kNoise{200.0, 2e-3, 3e-4, 2e-4, 2e-5};

SyntheticCameraImu Rig() {
  SyntheticCameraImu rig;
  rig.duration_s = 15.0;
  rig.imu_noise = kNoise;
  return rig;
}

PlainRecording CornersOf(const SyntheticCameraImu& rig) {
  Rng rng(kSeed);
  CameraImuProblem problem = rig.Problem(rng);
  PlainRecording recording;
  recording.cameras = {{rig.model, rig.resolution, "/cam0", std::nullopt}};
  recording.target = rig.board;
  recording.stated_noise = rig.imu_noise;
  recording.views = std::move(problem.cameras[0].views);
  recording.imu = std::move(problem.imus[0].stream);
  return recording;
}

std::string PngFile(const GreyImage& image) {
  RawPixels pixels;
  pixels.resolution = image.resolution;
  pixels.encoding = "mono8";
  pixels.row_bytes = static_cast<size_t>(image.resolution.width);
  pixels.bytes.assign(image.pixels.begin(), image.pixels.end());
  return PngOf(pixels, "a rendered image");
}

PlainRecording ImagesOf(SyntheticCameraImu rig, const Board& board, const Scene& scene) {
  rig.board = board;
  rig.duration_s = kImagesS;
  rig.camera_rate_hz = 10.0;
  PlainRecording recording = CornersOf(rig);
  const BoardPattern pattern = PatternOf(board);
  Rng rng = Rng(kSeed).Stream("pixels");
  for (const BoardView& view : std::exchange(recording.views, {})) {
    const double t_i = (view.stamp - rig.epoch).seconds() + rig.time_offset_s[0];
    const Rigid3 T_c_g = rig.T_c_i[0] * rig.PoseAt(t_i).Inverse();
    const Exposure exposure = RenderBoard(pattern, recording.cameras[0], T_c_g, scene);
    recording.images[view.stamp.nanoseconds()] = PngFile(Digitised(exposure, {1.0, 0.01}, rng));
  }
  return recording;
}

Scene GoodScene() {
  Scene scene;
  scene.blur_px = 0.6;
  scene.vignetting = 0.1;
  return scene;
}

void ForEach(ImuStream* imu, const std::function<void(Samples*)>& change) {
  change(&imu->gyro);
  change(&imu->accel);
}

void Shift(VectorSample* sample, double seconds) {
  sample->stamp = sample->stamp + Duration::FromSeconds(seconds);
}

// The sample that is taken so many seconds after the first.
size_t SampleAt(const Samples& samples, double seconds) {
  const Time stamp = samples.front().stamp + Duration::FromSeconds(seconds);
  size_t k = 0;
  while (k + 1 < samples.size() && samples[k].stamp < stamp) ++k;
  return k;
}

BrokenRecording FromCorners(std::string name, std::string what, std::vector<std::string> findings,
                            const std::function<void(PlainRecording*)>& break_it) {
  return {std::move(name), std::move(what), std::move(findings), [break_it] {
            PlainRecording recording = CleanCorners();
            break_it(&recording);
            return recording;
          }};
}

void AddUnits(std::vector<BrokenRecording>* list) {
  list->push_back(FromCorners("gyroscope-in-degrees", "The gyroscope is in degrees per second.",
                              {"it is in deg/s"}, [](PlainRecording* r) {
                                for (VectorSample& s : r->imu.gyro) {
                                  s.value *= 180.0 / std::numbers::pi;
                                }
                              }));
  list->push_back(FromCorners("accelerometer-in-g", "The accelerometer is in g.", {"it is in g"},
                              [](PlainRecording* r) {
                                for (VectorSample& s : r->imu.accel) s.value /= kStandardGravity;
                              }));
  list->push_back(FromCorners("swapped-sensors",
                              "The columns of gyroscope and accelerometer are swapped.",
                              {"the gyroscope's columns read"},
                              [](PlainRecording* r) { std::swap(r->imu.gyro, r->imu.accel); }));
  list->push_back({"gravity-removed",
                   "A phone's linear acceleration: gravity was taken out.",
                   {"gravity was taken out of it"},
                   [] {
                     const SyntheticCameraImu rig = Rig();
                     PlainRecording r = CornersOf(rig);
                     for (VectorSample& s : r.imu.accel) {
                       const double t = (s.stamp - rig.epoch).seconds();
                       s.value += rig.MotionAt(t).R_w_i.transpose() * rig.gravity_g;
                     }
                     return r;
                   }});
  list->push_back(FromCorners("constant-axis", "A column of the accelerometer was never filled.",
                              {"imu0 accelerometer x never changes"}, [](PlainRecording* r) {
                                for (VectorSample& s : r->imu.accel) s.value.x() = 0.0;
                              }));
}

void AddStamps(std::vector<BrokenRecording>* list) {
  list->push_back(FromCorners(
      "gap", "0.4 s of the IMU are lost.", {"imu0 gyroscope: 1 gap", "imu0 accelerometer: 1 gap"},
      [](PlainRecording* r) {
        ForEach(&r->imu, [](Samples* s) { s->erase(s->begin() + 1200, s->begin() + 1280); });
      }));
  list->push_back(FromCorners(
      "doubled-stamps", "Ten samples of the IMU are there twice.",
      {"imu0 gyroscope: 10 of 3010 samples repeat the stamp",
       "imu0 accelerometer: 10 of 3010 samples repeat the stamp"},
      [](PlainRecording* r) {
        ForEach(&r->imu, [](Samples* s) {
          s->insert(s->begin() + 900, s->begin() + 890, s->begin() + 900);
        });
        ForEach(&r->imu, [](Samples* s) {
          std::stable_sort(s->begin(), s->end(), [](const VectorSample& a, const VectorSample& b) {
            return a.stamp < b.stamp;
          });
        });
      }));
  list->push_back(FromCorners("out-of-order", "Two messages of the IMU arrived in the wrong order.",
                              {"imu0 gyroscope: 1 of 3000 samples have a stamp earlier",
                               "imu0 accelerometer: 1 of 3000 samples have a stamp earlier"},
                              [](PlainRecording* r) {
                                ForEach(&r->imu,
                                        [](Samples* s) { std::swap((*s)[900], (*s)[901]); });
                              }));
  list->push_back(
      FromCorners("jitter", "The IMU's stamps are those of the messages' arrival.",
                  {"imu0 gyroscope: its stamps jitter", "imu0 accelerometer: its stamps jitter"},
                  [](PlainRecording* r) {
                    Rng rng(kSeed + 1);
                    for (size_t k = 0; k < r->imu.gyro.size(); ++k) {
                      const double late_s = 2e-3 * rng.Uniform(-1.0, 1.0);
                      Shift(&r->imu.gyro[k], late_s);
                      Shift(&r->imu.accel[k], late_s);
                    }
                  }));
  list->push_back(FromCorners(
      "clock-set-back", "The IMU's clock was set back by 0.4 s in the middle.",
      {"imu0 gyroscope: the clock was set back", "imu0 accelerometer: the clock was set back",
       "imu0 gyroscope: 1 of 3000 samples have a stamp earlier",
       "imu0 accelerometer: 1 of 3000 samples have a stamp earlier", "moved against each other"},
      [](PlainRecording* r) {
        ForEach(&r->imu, [](Samples* s) {
          for (size_t k = SampleAt(*s, 8.0); k < s->size(); ++k) Shift(&(*s)[k], -0.4025);
        });
      }));
  list->push_back(FromCorners(
      "clock-set-forward", "The IMU's clock was set forward by 0.6 s in the middle.",
      {"moved against each other", "imu0 gyroscope: 1 gap", "imu0 accelerometer: 1 gap"},
      [](PlainRecording* r) {
        ForEach(&r->imu, [](Samples* s) {
          for (size_t k = SampleAt(*s, 8.0); k < s->size(); ++k) Shift(&(*s)[k], 0.6);
        });
      }));
  list->push_back(FromCorners("clock-ahead", "The IMU's clock is ahead of the camera's by 0.5 s.",
                              {"the clock of imu0 is 0.51 s ahead of that of cam0"},
                              [](PlainRecording* r) {
                                ForEach(&r->imu, [](Samples* samples) {
                                  for (VectorSample& s : *samples) Shift(&s, 0.5);
                                });
                              }));
  list->push_back(FromCorners("other-clock", "The IMU counts from when it was switched on.",
                              {"imu0 gyroscope and cam0 have no time in common",
                               "imu0 accelerometer and cam0 have no time in common",
                               "the clock of imu0 is 1399999999.99 s behind"},
                              [](PlainRecording* r) {
                                const Time first = r->imu.gyro.front().stamp;
                                ForEach(&r->imu, [&](Samples* samples) {
                                  for (VectorSample& s : *samples) {
                                    s.stamp = Time::FromNanoseconds(1'000) + (s.stamp - first);
                                  }
                                });
                              }));
}

void AddSensors(std::vector<BrokenRecording>* list) {
  list->push_back(FromCorners("saturated", "The gyroscope's range is too small for the motion.",
                              {"stand at the end of its range"}, [](PlainRecording* r) {
                                for (VectorSample& s : r->imu.gyro) {
                                  s.value.z() = std::clamp(s.value.z(), -0.7, 0.7);
                                }
                              }));
  list->push_back(FromCorners("not-a-number", "Some samples are NaN.",
                              {"imu0 gyroscope: 3 of 3000 samples are not finite",
                               "imu0 accelerometer: 3 of 3000 samples are not finite"},
                              [](PlainRecording* r) {
                                ForEach(&r->imu, [](Samples* samples) {
                                  for (const size_t k : {700, 1400, 2100}) {
                                    (*samples)[k].value.x() =
                                        std::numeric_limits<double>::quiet_NaN();
                                  }
                                });
                              }));
  list->push_back(FromCorners(
      "wrong-rate", "imu.yaml says 400 Hz, the IMU has 200.",
      {"imu0 gyroscope: samples come at 200 Hz", "imu0 accelerometer: samples come at 200 Hz"},
      [](PlainRecording* r) { r->stated_noise.rate_hz = 400.0; }));
  list->push_back(FromCorners(
      "noisier-than-stated",
      "The IMU lay still for 3 s before it was moved, and imu.yaml is of a better one.",
      {"imu0 gyroscope: at rest its noise is", "imu0 accelerometer: at rest its noise is"},
      [](PlainRecording* r) {
        Rng rng(kSeed + 2);
        ForEach(&r->imu, [&](Samples* samples) {
          const bool is_gyro = samples == &r->imu.gyro;
          const double stddev = (is_gyro ? kNoise.gyro_noise_density : kNoise.accel_noise_density) *
                                std::sqrt(kNoise.rate_hz);
          // The first sample's reading is taken for that at rest.
          const VectorSample first = samples->front();
          Samples rest;
          for (int k = 600; k > 0; --k) {
            Eigen::Vector3d noise(rng.Normal(), rng.Normal(), rng.Normal());
            const Eigen::Vector3d mean = is_gyro ? Eigen::Vector3d::Zero().eval() : first.value;
            rest.push_back(
                {first.stamp - Duration::FromNanoseconds(5'000'000) * k, mean + stddev * noise});
          }
          samples->insert(samples->begin(), rest.begin(), rest.end());
        });
        r->stated_noise.gyro_noise_density *= 0.1;
        r->stated_noise.accel_noise_density *= 0.1;
      }));
}

void AddMotions(std::vector<BrokenRecording>* list) {
  const auto moving = [](const std::function<void(SyntheticCameraImu*)>& change) {
    return [change] {
      SyntheticCameraImu rig = Rig();
      change(&rig);
      return CornersOf(rig);
    };
  };
  list->push_back({"no-motion",
                   "The rig stood still.",
                   {"imu0 did not move"},
                   moving([](SyntheticCameraImu* rig) {
                     rig->rotation = 0.0;
                     rig->translation = 0.0;
                   })});
  list->push_back({"no-rotation",
                   "The rig was pushed to and fro, and never turned.",
                   {"imu0 moved but did not turn"},
                   moving([](SyntheticCameraImu* rig) { rig->rotation = 0.0; })});
  list->push_back({"one-axis",
                   "The rig was turned about one axis only.",
                   {"imu0 turned about one axis only", "would not tell well the translation"},
                   moving([](SyntheticCameraImu* rig) {
                     rig->rotation_of_axis = {1.0, 0.0, 0.0};
                   })});
  list->push_back({"too-gentle",
                   "The rig was moved so gently that the IMU hardly felt it.",
                   {"would not tell well the translation", "would not tell well the time offset"},
                   moving([](SyntheticCameraImu* rig) {
                     rig->slowest_rad_s = 0.6;
                     rig->rotation = 0.6;
                   })});
  list->push_back(FromCorners("board-seldom-seen", "The board left the image for most of the time.",
                              {"cam0: the board is in 120 of"}, [](PlainRecording* r) {
                                std::vector<BoardView> seen;
                                for (size_t k = 0; k < r->views.size(); ++k) {
                                  if (k % 50 < 20) seen.push_back(r->views[k]);
                                }
                                r->views = std::move(seen);
                              }));
}

void AddImages(std::vector<BrokenRecording>* list) {
  const auto seen_as = [](const std::function<void(Scene*)>& change) {
    return [change] {
      Scene scene = GoodScene();
      change(&scene);
      return ImagesOf(Rig(), Rig().board, scene);
    };
  };
  list->push_back({"out-of-focus",
                   "The lens is out of focus.",
                   {"the board is blurred"},
                   seen_as([](Scene* scene) { scene->blur_px = 2.6; })});
  list->push_back({"too-dark",
                   "Hardly any light.",
                   {"black and white differ by less than 40"},
                   seen_as([](Scene* scene) {
                     scene->black = 3.0;
                     scene->white = 30.0;
                     scene->background = 15.0;
                   })});
  list->push_back({"over-exposed",
                   "White is beyond the sensor's range.",
                   {"the board's white is at the end of the sensor's range"},
                   seen_as([](Scene* scene) {
                     scene->black = 40.0;
                     scene->white = 420.0;
                   })});
  list->push_back({"lost-images",
                   "Ten images in a row were not written.",
                   {"cam0: about 10 images are missing"},
                   [] {
                     PlainRecording r = CleanImages();
                     r.images.erase(std::next(r.images.begin(), 25),
                                    std::next(r.images.begin(), 35));
                     return r;
                   }});
  list->push_back({"truncated-image",
                   "A copy was broken off: one image is only half there.",
                   {"cam0: cannot read image"},
                   [] {
                     PlainRecording r = CleanImages();
                     std::string& bytes = std::next(r.images.begin(), 30)->second;
                     bytes.resize(bytes.size() / 2);
                     return r;
                   }});
  list->push_back({"swapped-rows-and-columns",
                   "target.yaml has rows and columns of an AprilGrid swapped.",
                   {"a board of 3 rows x 5 columns was found"},
                   [] {
                     PlainRecording r = ImagesOf(Rig(), AprilGrid{3, 5, 0.055, 0.3}, GoodScene());
                     r.target = AprilGrid{5, 3, 0.055, 0.3};
                     return r;
                   }});
}

}  // namespace

std::map<std::string, std::string> FilesOf(const PlainRecording& recording) {
  std::map<std::string, std::string> files;
  files["camchain.yaml"] = ToYaml(ToValue(recording.cameras));
  files["target.yaml"] = ToYaml(ToValue(recording.target));
  files["imu.yaml"] = ToYaml(ToValue(recording.stated_noise));
  files["imu0.csv"] = ImuListText(recording.imu);
  for (const auto& [stamp, content] : recording.images) {
    files["cam0/" + std::to_string(stamp) + ".png"] = content;
  }
  if (recording.images.empty()) {
    files["cam0_corners.csv"] = CornerListText(recording.views, PointsPerTag(recording.target));
  }
  return files;
}

PlainRecording CleanCorners() { return CornersOf(Rig()); }

PlainRecording CleanImages() { return ImagesOf(Rig(), Rig().board, GoodScene()); }

std::vector<BrokenRecording> BrokenRecordings() {
  std::vector<BrokenRecording> list;
  AddUnits(&list);
  AddStamps(&list);
  AddSensors(&list);
  AddMotions(&list);
  AddImages(&list);
  return list;
}

}  // namespace calibrato
