#pragma once

#include <memory>

#include "calibrato/motion/carrier.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// The arm before its board as a bystander sees it: for videos and pictures.
class OutsideView {
 public:
  static constexpr Resolution kResolution{640, 480};

  /// @throws InputError if nothing can be drawn without a screen (HeadlessGl).
  explicit OutsideView(const Rig& rig);
  ~OutsideView();
  OutsideView(const OutsideView&) = delete;
  OutsideView& operator=(const OutsideView&) = delete;

  /// Without the arm if the path has no joints.
  [[nodiscard]] RgbImage Draw(const CarrierPath& path, double t_s) const;

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

/// Two pictures beside each other; the second, of any size, is shrunk or centred to the height of
/// the first.
[[nodiscard]] RgbImage SideBySide(const RgbImage& left, const GreyImage& right);

}  // namespace calibrato
