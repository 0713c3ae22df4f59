#include "calibrato/cli/output.h"

#include <sys/resource.h>

#include "calibrato/report/report.h"

namespace calibrato {

void Stopwatch::Start(const std::string& part) {
  Stop();
  part_ = part;
  part_begin_ = Clock::now();
}

void Stopwatch::Stop() {
  if (part_.empty()) return;
  seconds_[part_] += std::chrono::duration<double>(Clock::now() - part_begin_).count();
  part_.clear();
}

Value Stopwatch::Timing() {
  Stop();
  Value timing = Value::Object();
  for (const auto& [part, seconds] : seconds_) timing.Set(part, seconds);
  timing.Set("total_s", std::chrono::duration<double>(Clock::now() - begin_).count());
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  timing.Set("peak_memory_bytes", static_cast<int64_t>(usage.ru_maxrss) * 1024);
  return timing;
}

Value Document(const Value& result, const Value& plots) {
  Value document = result;
  for (const auto& [key, value] : plots.members()) document.Set(key, value);
  return document;
}

void CommitResult(const std::string& title, const Value& result, const Value& plots,
                  Stopwatch* stopwatch, OutputFolder* out) {
  stopwatch->Start("report_s");
  out->Add("result.json", ToJson(result));
  out->Add("plots.json", ToJsonLine(plots) + "\n");
  out->Add("report.html", ReportHtml(title, {Document(result, plots)}));
  out->Add("timing.json", ToJson(stopwatch->Timing()));
  out->Commit();
}

}  // namespace calibrato
