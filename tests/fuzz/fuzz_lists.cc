// Lists of comma-separated values, plain and gzip. The first byte says which reader takes the rest.

#include "calibrato/base/input_error.h"
#include "calibrato/recording/corner_list.h"
#include "calibrato/recording/imu_list.h"
#include "file_of_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace calibrato;
  if (size == 0) return 0;
  const FileOfBytes file(data + 1, size - 1);
  try {
    switch (data[0] % 4) {
      case 0:
        static_cast<void>(ReadCornerList(file.path(), std::nullopt));
        break;
      case 1:
        static_cast<void>(ReadCornerList(file.path(), Eigen::Matrix3Xd::Zero(3, 42)));
        break;
      case 2:
        static_cast<void>(ReadImuList(file.path()));
        break;
      default:
        static_cast<void>(ReadGyroList(file.path()));
    }
  } catch (const InputError&) {
  }
  return 0;
}
