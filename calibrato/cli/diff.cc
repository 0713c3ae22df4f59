#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "calibrato/base/files.h"
#include "calibrato/base/value.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/output.h"
#include "calibrato/cli/result_folder.h"
#include "calibrato/diagnosis/camera_imu_comparison_document.h"
#include "calibrato/diagnosis/comparison_document.h"
#include "calibrato/diagnosis/result_parameters.h"

namespace calibrato {
namespace {

struct Options {
  std::string first;
  std::string second;
  double level = kSignificance;
  std::string out;
};

struct Compared {
  Value result;
  std::string text;
  Agreement agreement = Agreement::kInconclusive;
};

Compared Compare(const Value& first, const Value& second, double level) {
  const ResultComparison comparison = CompareResults(first, second);
  return {ComparisonResult(comparison, level), ComparisonText(comparison, level),
          AgreementOf(comparison, level)};
}

Compared Compare(const ResultFolder& first, const ResultFolder& second, double level) {
  const CameraImuComparison comparison =
      CompareCameraImuResults(first.result, first.chain, second.result, second.chain);
  return {ComparisonResult(comparison, level), ComparisonText(comparison, level),
          AgreementOf(comparison, level)};
}

ExitCode RunDiff(const Options& options, const GlobalOptions& global) {
  Stopwatch stopwatch;
  std::optional<OutputFolder> out;
  if (!options.out.empty()) out.emplace(options.out);
  const Value first = ReadResult(options.first);
  const Value second = ReadResult(options.second);
  Compared compared;
  if (CalibrationKind(first) == "camera-imu" && CalibrationKind(second) == "camera-imu") {
    compared =
        Compare(ReadResultFolder(options.first), ReadResultFolder(options.second), options.level);
  } else {
    compared = Compare(first, second, options.level);
  }
  if (out) {
    CommitResult("Two calibrations compared", compared.result, Value::Object(), &stopwatch, &*out);
  }
  if (global.json) {
    std::fputs(ToJson(compared.result).c_str(), stdout);
  } else if (!global.quiet) {
    std::fputs(compared.text.c_str(), stdout);
  }
  return compared.agreement == Agreement::kAgree ? kDone : kNotTrusted;
}

}  // namespace

Action SetUpDiff(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("first", options->first, "The --out folder of a calibration")->required();
  app.add_option("second", options->second, "... and of another of the same rig")->required();
  app.add_option("--level", options->level,
                 "How often results of an unchanged rig may be found to differ")
      ->check(CLI::Range(1e-9, 0.5))
      ->capture_default_str();
  app.add_option("--out", options->out, "Folder for the comparison; none by default");
  return [options, &global] { return RunDiff(*options, global); };
}

}  // namespace calibrato
