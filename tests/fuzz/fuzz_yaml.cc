// Boards, camera chains, IMUs and rigs in YAML, and anything in JSON. The first byte says which
// reader takes the rest.

#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/imu_file.h"
#include "calibrato/sensors/rig.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace calibrato;
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  std::vector<std::string> warnings;
  try {
    switch (data[0] % 5) {
      case 0:
        static_cast<void>(BoardFromValue(ParseYaml(text, "fuzz"), &warnings));
        break;
      case 1:
        static_cast<void>(CameraChainFromValue(ParseYaml(text, "fuzz"), &warnings));
        break;
      case 2:
        static_cast<void>(ImusFromValue(ParseYaml(text, "fuzz"), &warnings));
        break;
      case 3:
        static_cast<void>(RigFromValue(ParseYaml(text, "fuzz"), &warnings));
        break;
      default:
        static_cast<void>(ToYaml(ParseJson(text, "fuzz")));
    }
  } catch (const InputError&) {
  }
  return 0;
}
