#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "calibrato/mdp/one_look.h"
#include "calibrato/motion/arm.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// One photo of the board, in the words of the options of those commands that plan from it.
struct LookArguments {
  std::string photo;  ///< Empty: the board stands where the rig's file has it.
  /// Of the arm when it was taken [rad]. Empty: it stood in the start pose: that of the arm by its
  /// URDF, or BasePose() (paper_scene.h) of the Panda.
  std::vector<double> joints;
  std::string cameras;    ///< camchain.yaml, instead of the rig's cameras.
  double hfov_rad = 0.0;  ///< A first guess instead of the rig's camera; 0: none.
  std::string rig_out;    ///< Where the rig with its board as seen is written to.
};

/// Adds --photo, --photo-joints, --cameras, --hfov and --rig-out.
void AddLookArguments(CLI::App& app, LookArguments* arguments);

/// The rig as the photo has it, what the photo told, and from where it was taken.
struct SeenRig {
  Rig rig;
  OneLook look;
  Rigid3 T_b_e;
  bool is_from_start_pose = false;  ///< Because nobody said otherwise.
};
/// @param arm  That holds the camera; null for the Panda.
/// @pre arguments.photo is not empty
/// @throws InputError, one line: no photo, not one of this camera's size, no board in it (with what
/// was seen instead), corners that tell no pose.
[[nodiscard]] SeenRig LookByPhoto(const LookArguments& arguments, Rig rig, const Arm* arm);

/// @throws InputError where an option needs a photo and there is none.
void CheckLookArguments(const LookArguments& arguments);

/// "board: 1.442 m away, 1.5 deg from facing the camera (42 corners, rms 0.11 px: +- 1.2 mm, 0.06
/// deg)", then, if nobody said so, from where: "photo: from the start pose, the controlled frame at
/// 0.400 0.300 0.470 m, rpy 1.571 0.800 1.571 rad (from elsewhere: --photo-joints)".
[[nodiscard]] std::string Describe(const SeenRig& seen);
/// {distance_m, tilt_rad, num_corners, reprojection_rms_px, translation_sigma_m,
/// rotation_sigma_rad, T_w_g, T_b_e}
[[nodiscard]] Value ToValue(const SeenRig& seen);

}  // namespace calibrato
