#pragma once

#include <memory>
#include <string>
#include <vector>

namespace calibrato {

/// Ways to draw without a screen: "egl" (the graphics card's, or Mesa's in software), "osmesa"
/// (software alone).
/// What the environment variable MUJOCO_GL names ("off" for none at all), else both in this order.
[[nodiscard]] std::vector<std::string> HeadlessGlWays();

/// An OpenGL context without a window. The libraries are opened when they are asked for: calibrato
/// runs without them as long as nothing is rendered. All contexts of a process are of one way.
class HeadlessGl {
 public:
  /// @throws InputError that says what each way lacks, if none works.
  explicit HeadlessGl(const std::vector<std::string>& ways = HeadlessGlWays());
  ~HeadlessGl();
  HeadlessGl(const HeadlessGl&) = delete;
  HeadlessGl& operator=(const HeadlessGl&) = delete;

  /// For what is drawn next on this thread.
  void MakeCurrent() const;
  [[nodiscard]] const std::string& way() const { return way_; }

 private:
  class Context;
  class Egl;
  class OsMesa;
  std::unique_ptr<Context> context_;
  std::string way_;
};

}  // namespace calibrato
