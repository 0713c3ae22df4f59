#include "calibrato/cli/look_arguments.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/cli/number_range.h"
#include "calibrato/cli/parse.h"
#include "calibrato/detection/detect.h"
#include "calibrato/geometry/rpy.h"
#include "calibrato/motion/panda.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/recording/photo.h"

namespace calibrato {
namespace {

// Where the controlled frame was.
Rigid3 PoseOfPhoto(const LookArguments& arguments, const Arm* arm) {
  if (arguments.joints.empty()) {
    return arm != nullptr ? PoseOf(*arm, arm->start, nullptr)
                          : LoopPoseAt(BasePose(), LoopCoefficients::Zero(), 0.0);
  }
  const size_t num_joints = arm != nullptr ? arm->joints.size() : 7;
  if (arguments.joints.size() != num_joints) {
    throw InputError({"bad --photo-joints", "",
                      "the arm has " + std::to_string(num_joints) + " joints, found " +
                          std::to_string(arguments.joints.size()),
                      "give one angle a joint in rad, joint 1 first"});
  }
  JointVector q = JointVector::Zero();
  std::ranges::copy(arguments.joints, q.begin());
  const JointRange range =
      arm != nullptr ? JointRange{arm->limits.lower, arm->limits.upper} : JointRange{};
  if (!(JointLimitExcess(q, range) <= 0.0)) {
    throw InputError({"bad --photo-joints", "",
                      "the arm can't stand so: a joint is beyond its limit",
                      "give one angle a joint in rad, joint 1 first"});
  }
  return arm != nullptr ? PoseOf(*arm, q, nullptr) : PandaPose(q, nullptr);
}

void TakeCameras(const LookArguments& arguments, Resolution photo, Rig* rig) {
  if (!arguments.cameras.empty()) {
    std::vector<std::string> warnings;
    rig->cameras = CameraChainFromValue(ReadYaml(arguments.cameras), &warnings);
    PrintWarnings(warnings);
  }
  if (arguments.hfov_rad > 0.0) {
    const double f = FocalLengthFromFieldOfView(arguments.hfov_rad, photo.width);
    const Eigen::Vector4d middle(f, f, 0.5 * (photo.width - 1), 0.5 * (photo.height - 1));
    rig->cameras = {
        {CameraModel("pinhole-none", middle), photo, rig->cameras.front().rostopic, {}}};
  }
  const Resolution camera = rig->cameras.front().resolution;
  if (camera == photo) return;
  const auto size = [](Resolution r) {
    return std::to_string(r.width) + " x " + std::to_string(r.height);
  };
  throw InputError({"the photo is not of this camera", arguments.photo,
                    "it has " + size(photo) + " pixels, the camera " + size(camera),
                    "give a photo as the camera takes it, its --cameras, or a guess by --hfov"});
}

double Tilt(const OneLook& look, const Rig& rig) {
  const Eigen::Vector3d middle_c0 = look.T_c0_g * BoardCentre(rig.board);
  const Eigen::Vector3d towards_camera = -middle_c0.normalized();
  return std::acos(std::clamp(look.T_c0_g.R.col(2).dot(towards_camera), -1.0, 1.0));
}

double Distance(const OneLook& look, const Rig& rig) {
  return (look.T_c0_g * BoardCentre(rig.board)).norm();
}

}  // namespace

void AddLookArguments(CLI::App& app, LookArguments* arguments) {
  app.add_option("--photo", arguments->photo,
                 "Image of the board by camera 0: where the board stands, instead of the rig's "
                 "T_w_g");
  app.add_option(
         "--photo-joints", arguments->joints,
         "The arm's joint angles when it was taken, one a joint [rad] (of the start pose: "
         "start_joints_rad of --arm; the Panda's hand at 0.4 0.3 0.47 m from its base, roll, "
         "pitch, yaw 1.5708 0.8 1.5708)")
      ->expected(6, 7)
      ->delimiter(',');
  app.add_option("--cameras", arguments->cameras,
                 "camchain.yaml of the camera that took it, instead of the rig's cameras");
  app.add_option("--hfov", arguments->hfov_rad,
                 "Its horizontal field of view as a first guess [rad], instead of the rig's camera")
      ->check(NumberBetween(0.1, 3.0));
  app.add_option("--rig-out", arguments->rig_out,
                 "RIG.yaml to write: the rig with camera and board as planned with, for simulate "
                 "and export");
}

void CheckLookArguments(const LookArguments& arguments) {
  if (!arguments.photo.empty()) {
    if (arguments.cameras.empty() || !(arguments.hfov_rad > 0.0)) return;
    throw InputError({"--cameras and --hfov say the same thing", "", "which camera took the photo",
                      "leave one of them out"});
  }
  const LookArguments standard;
  std::string unused;
  if (arguments.joints != standard.joints) unused = "--photo-joints";
  if (arguments.cameras != standard.cameras) unused = "--cameras";
  if (arguments.hfov_rad != standard.hfov_rad) unused = "--hfov";
  if (arguments.rig_out != standard.rig_out) unused = "--rig-out";
  if (unused.empty()) return;
  throw InputError({unused + " has no use here", "", "it belongs to a photo of the board",
                    "add --photo IMAGE, or leave it out"});
}

SeenRig LookByPhoto(const LookArguments& arguments, Rig rig, const Arm* arm) {
  const Rigid3 T_b_e = PoseOfPhoto(arguments, arm);
  const GreyImage image = ReadPhoto(arguments.photo);
  TakeCameras(arguments, image.resolution, &rig);
  const Detections found =
      SearchForBoards({{arguments.photo}, [&](size_t) { return image; }, {}}, rig.board);
  if (found.no_board) {
    InputError::Parts why = *found.no_board;
    why.remedy = "take one in which the whole board is sharp, and check the board of --rig";
    throw InputError(why);
  }
  std::optional<OneLook> look = LookAtBoard(rig.cameras.front().model, found.views.front());
  if (!look) {
    throw InputError({"the photo does not tell where the board is", arguments.photo,
                      "its corners fit no pose before this camera",
                      "check the camera's intrinsics, or take a photo from nearer"});
  }
  constexpr double kLarge = 2.0;  // [px]
  if (look->reprojection_rms_px > kLarge) {
    char text[40];
    std::snprintf(text, sizeof(text), "%.1f", look->reprojection_rms_px);
    PrintWarnings({"camera and photo do not agree, " + arguments.photo + ": corners are off by " +
                   text + " px; the board may stand elsewhere than planned for"});
  }
  SeenRig seen;
  seen.rig = WithBoardAsSeen(std::move(rig), T_b_e, look->T_c0_g);
  seen.look = *std::move(look);
  seen.T_b_e = T_b_e;
  seen.is_from_start_pose = arguments.joints.empty();
  return seen;
}

std::string Describe(const SeenRig& seen) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const OneLook& look = seen.look;
  char text[200];
  std::snprintf(text, sizeof(text),
                "board: %.3f m away, %.1f deg from facing the camera (%d corners, rms %.2f px: "
                "+- %.1f mm, %.2f deg)",
                Distance(look, seen.rig), kDegrees * Tilt(look, seen.rig), look.num_corners,
                look.reprojection_rms_px, 1e3 * look.translation_sigma_m,
                kDegrees * look.rotation_sigma_rad);
  std::string described = text;
  if (!seen.is_from_start_pose) return described;
  const Eigen::Vector3d& xyz = seen.T_b_e.t;
  const Eigen::Vector3d rpy = RpyFromRotation(seen.T_b_e.R);
  std::snprintf(text, sizeof(text),
                "\nphoto: from the start pose, the controlled frame at %.3f %.3f %.3f m, rpy %.3f "
                "%.3f %.3f rad (from elsewhere: --photo-joints)",
                xyz.x(), xyz.y(), xyz.z(), rpy.x(), rpy.y(), rpy.z());
  return described + text;
}

Value ToValue(const SeenRig& seen) {
  const OneLook& look = seen.look;
  return Value::Object()
      .Set("distance_m", Distance(look, seen.rig))
      .Set("tilt_rad", Tilt(look, seen.rig))
      .Set("num_corners", look.num_corners)
      .Set("reprojection_rms_px", look.reprojection_rms_px)
      .Set("translation_sigma_m", look.translation_sigma_m)
      .Set("rotation_sigma_rad", look.rotation_sigma_rad)
      .Set("T_w_g", ToValue(seen.rig.T_w_g))
      .Set("T_b_e", ToValue(seen.T_b_e));
}

}  // namespace calibrato
