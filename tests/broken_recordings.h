#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "calibrato/sensors/board.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"

// Recordings of a rig that is shaken before a board, each with one thing wrong with it: what
// `calibrato check` must name, and nothing else. docs/check.md lists them.

namespace calibrato {

/// A recording before it is written. Whatever is broken is broken here.
struct PlainRecording {
  std::vector<Camera> cameras;            ///< One; what camchain.yaml says of it.
  Board target;                           ///< What target.yaml says.
  ImuNoise stated_noise;                  ///< What imu.yaml says.
  std::vector<BoardView> views;           ///< Written as a list of corners, if there are no images.
  std::map<int64_t, std::string> images;  ///< By stamp [ns]: image files.
  ImuStream imu;
};

/// The files of a recording by name, with camchain.yaml, target.yaml and imu.yaml beside it.
[[nodiscard]] std::map<std::string, std::string> FilesOf(const PlainRecording& recording);

/// Corners at 20 Hz and an IMU of 200 Hz, 15 s; nothing is wrong.
[[nodiscard]] PlainRecording CleanCorners();
/// Images of 640 x 480 at 10 Hz, 6 s; nothing is wrong.
[[nodiscard]] PlainRecording CleanImages();

struct BrokenRecording {
  std::string name;  ///< "gyroscope-in-degrees": that of its folder.
  std::string what;  ///< What was done to it.
  /// Words of the findings that it must have: no other finding may be a warning or worse.
  std::vector<std::string> findings;
  std::function<PlainRecording()> make;
};

[[nodiscard]] std::vector<BrokenRecording> BrokenRecordings();

}  // namespace calibrato
