#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace calibrato {

/// A line on stderr with the share done and the time left, redrawn at most ten times a second. Says
/// nothing where stderr is not a terminal or progress was silenced.
///
///     detecting  [=========>          ]  47 %  212/448  3 s left  rms 0.21
class Progress {
 public:
  /// @param total  How many Advance() make 100 %.
  Progress(std::string title, int64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Safe to call from several threads.
  /// @param remark  Shown behind the bar; the last one stays until replaced.
  void Advance(int64_t count = 1, const std::string& remark = "");

  /// `--quiet` and `--json` silence every bar of the process.
  static void Silence();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace calibrato
