#include "calibrato/sensors/opencv_yaml.h"

#include "calibrato/base/value.h"

namespace calibrato {
namespace {

std::string RealText(double value) {
  const std::string text = FormatNumber(value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

}  // namespace

OpenCvYaml& OpenCvYaml::Comment(const std::string& text) {
  text_ += "# " + text + "\n";
  return *this;
}

OpenCvYaml& OpenCvYaml::Text(const std::string& key, const std::string& value) {
  text_ += key + ": \"" + value + "\"\n";
  return *this;
}

OpenCvYaml& OpenCvYaml::Whole(const std::string& key, int64_t value) {
  text_ += key + ": " + std::to_string(value) + "\n";
  return *this;
}

OpenCvYaml& OpenCvYaml::Real(const std::string& key, double value) {
  text_ += key + ": " + RealText(value) + "\n";
  return *this;
}

OpenCvYaml& OpenCvYaml::Begin(const std::string& key) {
  text_ += key + ":\n";
  return *this;
}

OpenCvYaml& OpenCvYaml::Matrix(const std::string& key, const Eigen::MatrixXd& matrix,
                               bool is_float) {
  text_ += key + ": !!opencv-matrix\n   rows: " + std::to_string(matrix.rows()) +
           "\n   cols: " + std::to_string(matrix.cols()) + "\n   dt: " + (is_float ? "f" : "d") +
           "\n   data: [";
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    if (row > 0) text_ += ",\n          ";
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      text_ += (column > 0 ? ", " : "") + RealText(matrix(row, column));
    }
  }
  text_ += "]\n";
  return *this;
}

}  // namespace calibrato
