#include "calibrato/cli/export_result.h"

#include <cstdio>
#include <filesystem>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/cli/result_folder.h"
#include "calibrato/sensors/foreign_calibration.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

RigCalibration ReadRigCalibration(const ResultFolder& read) {
  return RigCalibrationFromValues(read.result, read.chain,
                                  read.imus.IsNull() ? nullptr : &read.imus);
}

}  // namespace

ExitCode ExportResult(const std::string& folder, const std::string& format,
                      std::optional<double> camera_rate_hz, const std::string& out,
                      const GlobalOptions& global) {
  const auto found = FindCalibrationFormat(format);
  if (!found) {
    std::string names;
    for (const std::string& name : CalibrationFormatNames()) {
      names += (names.empty() ? "" : ", ") + name;
    }
    throw InputError({"a calibration is not written as " + format, folder, "it is a folder",
                      "choose " + names + ", or give a MOTION.yaml"});
  }
  OutputFolder files(out);
  const ResultFolder read = ReadResultFolder(folder);
  ForeignFiles foreign = FilesFor(*found, ReadRigCalibration(read), camera_rate_hz);
  const Value* verdict = read.result.Find("verdict");
  if (verdict != nullptr) {
    const std::string name = verdict->AsString();
    if (name == "fail" || name == "inconclusive") {
      foreign.warnings.insert(
          foreign.warnings.begin(),
          "the calibration's verdict is " + name + ": not to be trusted, result.json says why");
    }
  }
  for (const auto& [name, content] : foreign.content) files.Add(name, content);
  files.Commit();
  for (const std::string& warning : foreign.warnings) {
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  }
  Value names = Value::Array();
  for (const auto& file : foreign.content) names.Append(file.first);
  Value summary = Value::Object();
  summary.Set("kind", "export")
      .Set("out", out)
      .Set("format", format)
      .Set("files", std::move(names))
      .Set("warnings", [&] {
        Value warnings = Value::Array();
        for (const std::string& warning : foreign.warnings) warnings.Append(warning);
        return warnings;
      }());
  if (global.json) {
    std::fputs(ToJson(summary).c_str(), stdout);
  } else if (!global.quiet) {
    for (const auto& file : foreign.content) {
      std::printf("%s\n", (fs::path(out) / file.first).string().c_str());
    }
  }
  return kDone;
}

}  // namespace calibrato
