#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/output.h"
#include "calibrato/diagnosis/comparison_document.h"

namespace calibrato {
namespace {

struct Options {
  std::string first;
  std::string second;
  std::string out;
};

Value ReadResult(const std::string& folder) {
  const std::filesystem::path path = std::filesystem::path(folder) / "result.json";
  if (!std::filesystem::exists(path)) {
    throw InputError({"no result", folder, "there is no result.json in it",
                      "give the --out folder of calibrate camera"});
  }
  return ReadJson(path.string());
}

ExitCode RunDiff(const Options& options, const GlobalOptions& global) {
  Stopwatch stopwatch;
  std::optional<OutputFolder> out;
  if (!options.out.empty()) out.emplace(options.out);
  const ResultComparison comparison =
      CompareResults(ReadResult(options.first), ReadResult(options.second));
  const Value result = ComparisonResult(comparison);
  if (out) CommitResult("Two calibrations compared", result, Value::Object(), &stopwatch, &*out);
  if (global.json) {
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::fputs(ComparisonText(comparison).c_str(), stdout);
  }
  return AgreementOf(comparison) == Agreement::kAgree ? kDone : kNotTrusted;
}

}  // namespace

Action SetUpDiff(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("first", options->first, "The --out folder of a calibration")->required();
  app.add_option("second", options->second, "... and of another of the same cameras")->required();
  app.add_option("--out", options->out, "Folder for the comparison; none by default");
  return [options, &global] { return RunDiff(*options, global); };
}

}  // namespace calibrato
