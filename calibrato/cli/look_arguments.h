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
  std::string photo;           ///< Empty: the board stands where the rig's file has it.
  std::vector<double> joints;  ///< Of the arm when it was taken [rad]; empty: the start pose.
  std::string cameras;         ///< camchain.yaml, instead of the rig's cameras.
  double hfov_rad = 0.0;       ///< A first guess instead of the rig's camera; 0: none.
  std::string rig_out;         ///< Where the rig with its board as seen is written to.
};

/// Adds --photo, --photo-joints, --cameras, --hfov and --rig-out.
void AddLookArguments(CLI::App& app, LookArguments* arguments);

/// The rig as the photo has it, and what the photo told.
struct SeenRig {
  Rig rig;
  OneLook look;
};
/// @param arm  That holds the camera; null for the Panda.
/// @pre arguments.photo is not empty
/// @throws InputError, one line: no photo, not one of this camera's size, no board in it (with what
/// was seen instead), corners that tell no pose.
[[nodiscard]] SeenRig LookByPhoto(const LookArguments& arguments, Rig rig, const Arm* arm);

/// @throws InputError where an option needs a photo and there is none.
void CheckLookArguments(const LookArguments& arguments);

/// "board: 1.442 m away, 31.0 deg from facing the camera; 42 corners, 0.11 px; +- 1.2 mm, ..".
[[nodiscard]] std::string Describe(const OneLook& look, const Rig& rig);
/// {distance_m, tilt_rad, num_corners, reprojection_rms_px, translation_sigma_m,
/// rotation_sigma_rad, T_w_g}
[[nodiscard]] Value ToValue(const OneLook& look, const Rig& rig);

}  // namespace calibrato
