#pragma once

#include <Eigen/Core>
#include <string>

namespace calibrato {

/// Text that OpenCV's FileStorage reads: YAML 1.0 with its own header and matrix tag. Real numbers
/// always carry a point or an exponent, since readers tell them from whole numbers by it.
class OpenCvYaml {
 public:
  OpenCvYaml& Comment(const std::string& text);
  OpenCvYaml& Text(const std::string& key, const std::string& value);
  OpenCvYaml& Whole(const std::string& key, int64_t value);
  OpenCvYaml& Real(const std::string& key, double value);
  /// Begins a mapping: what is set next, by two blanks of indentation in `key`, is of it.
  OpenCvYaml& Begin(const std::string& key);
  /// @param is_float  Of type float rather than double; the digits are the same.
  OpenCvYaml& Matrix(const std::string& key, const Eigen::MatrixXd& matrix, bool is_float = false);

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_ = "%YAML:1.0\n---\n";
};

}  // namespace calibrato
