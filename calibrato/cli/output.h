#pragma once

#include <chrono>
#include <map>
#include <string>

#include "calibrato/base/files.h"
#include "calibrato/base/value.h"

namespace calibrato {

/// Wall times of a command's parts; the only place where they are kept (timing.json).
class Stopwatch {
 public:
  /// Ends the running part, if any, and starts this one: "detection_s".
  void Start(const std::string& part);
  /// Seconds that a part took by another clock: of one estimator, say, over many trials.
  void Add(const std::string& part, double seconds) { seconds_[part] += seconds; }
  /// {"detection_s": .., "total_s": .., "peak_memory_bytes": ..}
  [[nodiscard]] Value Timing();

 private:
  using Clock = std::chrono::steady_clock;
  void Stop();
  Clock::time_point begin_ = Clock::now();
  Clock::time_point part_begin_;
  std::string part_;
  std::map<std::string, double> seconds_;
};

/// Writes result.json, plots.json, timing.json, report.html and what was added to `out` before, all
/// together.
/// @param plots  What the report draws beside the result; kept, so that `calibrato report` can
/// write the page anew.
void CommitResult(const std::string& title, const Value& result, const Value& plots,
                  Stopwatch* stopwatch, OutputFolder* out);

/// A result with what is to be drawn of it, as ReportHtml takes it.
[[nodiscard]] Value Document(const Value& result, const Value& plots);

}  // namespace calibrato
