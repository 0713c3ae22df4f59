// Messages of ROS 1 and of ROS 2 (CDR). The first byte says which reader takes the rest.

#include "calibrato/base/input_error.h"
#include "calibrato/recording/byte_fields.h"
#include "calibrato/recording/ros_messages.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace calibrato;
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const MessageEncoding encoding = data[0] & 1 ? MessageEncoding::kCdr : MessageEncoding::kRos1;
  try {
    switch (data[0] / 2 % 3) {
      case 0:
        static_cast<void>(GreyOf({ReadImageMessage(encoding, bytes).pixels, "fuzz"}));
        break;
      case 1:
        static_cast<void>(GreyOf({ReadCompressedImageMessage(encoding, bytes).file, "fuzz"}));
        break;
      default:
        static_cast<void>(ReadImuMessage(encoding, bytes));
    }
  } catch (const Damage&) {
  } catch (const InputError&) {
  }
  return 0;
}
