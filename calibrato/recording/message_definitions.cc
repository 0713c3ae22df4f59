#include "calibrato/recording/message_definitions.h"

#include <cassert>

namespace calibrato {
namespace {

std::string Fields(const std::string& type) {
  if (type == "Image") {
    return "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n"
           "uint8 is_bigendian\nuint32 step\nuint8[] data\n";
  }
  if (type == "CompressedImage") return "std_msgs/Header header\nstring format\nuint8[] data\n";
  assert(type == "Imu");
  return "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
         "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
         "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n"
         "float64[9] linear_acceleration_covariance\n";
}

std::string Md5(const std::string& type) {
  if (type == "Image") return "060021388200f6f0f447d0fcd9c64743";
  if (type == "CompressedImage") return "8f7a12909da2c9d3332d540a0977563f";
  assert(type == "Imu");
  return "6a62c6daae103f4ff57a132d6f95cec2";
}

std::string Section(const std::string& name, const std::string& fields) {
  return std::string(80, '=') + "\nMSG: " + name + "\n" + fields;
}

std::string WithVectors(const std::string& type) {
  if (type != "Imu") return "";
  return Section("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n") +
         Section("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n");
}

}  // namespace

MessageDefinition Ros1Definition(const std::string& type) {
  return {"sensor_msgs/" + type,
          Fields(type) + Section("std_msgs/Header", "uint32 seq\ntime stamp\nstring frame_id\n") +
              WithVectors(type),
          Md5(type)};
}

MessageDefinition Ros2Definition(const std::string& type) {
  return {"sensor_msgs/msg/" + type,
          Fields(type) +
              Section("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n") +
              Section("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n") + WithVectors(type),
          ""};
}

}  // namespace calibrato
