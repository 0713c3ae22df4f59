#include "calibrato/simulation/simulated_recording.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "calibrato/base/files.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/recording/recording.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

struct Simulated {
  Rig rig = PaperRig();
  TimedMotion motion = std::get<TimedMotion>(PlanMotion(HandcraftedMotion(Task::kExtrinsic), rig));
  Time start = Time::FromNanoseconds(1'600'000'000'000'000'000);
  SimulatedFrames frames;
  SimulatedImu imu;
  std::map<std::string, std::string> files;
  Simulated() {
    rig.time_offset_i_c = Duration::FromNanoseconds(7'300'000);
    Rng rng(1);
    frames = SimulateFrames(rig, motion, start, rng);
    Rng imu_rng(2);
    imu = SimulateImu(rig, motion, start, imu_rng);
    files = SimulatedRecordingFiles(rig, motion, start, Run());
  }
  [[nodiscard]] SimulatedRun Run() const {
    return {.path = PlannedPath(motion),
            .frames = frames,
            .imu = imu,
            .tracking = std::nullopt,
            .images = {}};
  }
};

TEST(SimulatedRecording, OpensLikeAnyOther) {
  const Simulated simulated;
  const std::string folder = testing::TempDir() + "calibrato_simulated_recording";
  std::filesystem::remove_all(folder);
  OutputFolder out(folder);
  for (const auto& [name, content] : simulated.files) out.Add(name, content);
  out.Commit();
  const Recording recording = OpenRecording(folder, {});
  ASSERT_EQ(recording.cameras.size(), 1U);
  EXPECT_EQ(recording.cameras[0].resolution, (Resolution{640, 480}));
  const auto& views = std::get<std::vector<BoardView>>(recording.cameras[0].data);
  ASSERT_EQ(views.size(), simulated.frames.views.size());
  EXPECT_EQ(views[11].stamp, simulated.frames.views[11].stamp);
  EXPECT_EQ(views[11].pixels, simulated.frames.views[11].pixels);
  EXPECT_EQ(views[11].points_g, simulated.frames.views[11].points_g);
  ASSERT_EQ(recording.imus.size(), 1U);
  EXPECT_EQ(recording.imus[0].name, "imu0");
  const ImuStream& stream = recording.imus[0].stream;
  ASSERT_EQ(stream.gyro.size(), simulated.imu.stream.gyro.size());
  EXPECT_EQ(stream.gyro[345].stamp, simulated.imu.stream.gyro[345].stamp);
  EXPECT_EQ(stream.gyro[345].value, simulated.imu.stream.gyro[345].value);
  EXPECT_EQ(stream.accel[345].value, simulated.imu.stream.accel[345].value);
  std::filesystem::remove_all(folder);
}

TEST(SimulatedRecording, TellsTheRateOfTheCamera) {
  Simulated simulated;
  simulated.rig.camera_rate_hz = 20.0;
  const std::map<std::string, std::string> files =
      SimulatedRecordingFiles(simulated.rig, simulated.motion, simulated.start, simulated.Run());
  EXPECT_EQ(ParseYaml(files.at("sensor.yaml"), "").At("rate_hz").AsDouble(), 20.0);
  EXPECT_EQ(ParseYaml(files.at("rig.yaml"), "").At("rate_hz").AsDouble(), 20.0);
}

TEST(SimulatedRecording, TellsTheBiasesAndTheNoise) {
  const Simulated simulated;
  const Value truth = ParseYaml(simulated.files.at("truth.yaml"), "truth.yaml");
  const Value& biases = truth.At("biases").At("imu0");
  EXPECT_EQ(biases.At("gyro_bias").AsDoubles(3)[1], simulated.imu.mean_gyro_bias(1));
  EXPECT_EQ(biases.At("accel_bias").AsDoubles(3)[2], simulated.imu.mean_accel_bias(2));
  EXPECT_EQ(truth.At("cam0").At("timeshift_cam_imu").AsDouble(), 0.0073);
  const std::vector<Imu> imus =
      ImusFromValue(ParseYaml(simulated.files.at("imu.yaml"), "imu.yaml"), nullptr);
  EXPECT_EQ(imus.at(0).noise.gyro_noise_density, simulated.rig.imu_noise.gyro_noise_density);
}

TEST(SimulatedRecording, RigAndMotionReadBack) {
  const Simulated simulated;
  std::vector<std::string> warnings;
  const Rig rig = RigFromValue(ParseYaml(simulated.files.at("rig.yaml"), "rig.yaml"), &warnings);
  EXPECT_EQ(ToYaml(ToValue(rig)), simulated.files.at("rig.yaml"));
  const Motion motion =
      MotionFromValue(ParseYaml(simulated.files.at("motion.yaml"), "motion.yaml"), &warnings);
  EXPECT_EQ(motion.loops[1].coefficients, simulated.motion.motion.loops[1].coefficients);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
}

// The truth of the board in the IMU frame, followed through the camera, must project to the corners
// seen at the same instant of the IMU's clock.
TEST(SimulatedRecording, TruthPosesProjectToTheCorners) {
  const Simulated simulated;
  std::istringstream poses(simulated.files.at("truth_poses.csv"));
  std::string line;
  std::getline(poses, line);
  EXPECT_EQ(line, "timestamp [ns],x,y,z,qw,qx,qy,qz");
  std::map<int64_t, Rigid3> T_g_i;
  while (std::getline(poses, line)) {
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    ASSERT_EQ(fields.size(), 8U);
    const auto number = [&](size_t i) { return std::strtod(fields[i].c_str(), nullptr); };
    T_g_i[std::strtoll(fields[0].c_str(), nullptr, 10)] = {
        Eigen::Quaterniond(number(4), number(5), number(6), number(7)).toRotationMatrix(),
        {number(1), number(2), number(3)}};
  }
  EXPECT_EQ(T_g_i.size(), static_cast<size_t>(200 * simulated.motion.duration_s()) + 1);
  for (const BoardView& view : simulated.frames.views) {
    const int64_t stamp = (view.stamp + simulated.rig.time_offset_i_c).nanoseconds();
    ASSERT_TRUE(T_g_i.contains(stamp));
    const Rigid3 T_c_g = simulated.rig.T_c0_i * T_g_i.at(stamp).Inverse();
    for (Eigen::Index k = 0; k < view.num_corners(); k += 7) {
      const auto pixel = simulated.rig.cameras[0].model.Project(T_c_g * view.points_g.col(k));
      EXPECT_LT((*pixel - view.pixels.col(k)).norm(), 0.7);  // Seven sigma of the noise.
    }
  }
}

}  // namespace
}  // namespace calibrato
