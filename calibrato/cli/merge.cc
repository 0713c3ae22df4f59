#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/output.h"
#include "calibrato/cli/result_folder.h"
#include "calibrato/diagnosis/finding.h"
#include "calibrato/diagnosis/result_parameters.h"

namespace calibrato {
namespace {

struct Options {
  std::vector<std::string> folders;
  std::string out;
};

// One spelling a folder, however it was given: relative, by a link, with a slash at its end.
std::filesystem::path OneSpelling(const std::string& folder) {
  const std::filesystem::path absolute =
      std::filesystem::absolute(std::filesystem::path(".") / folder);
  std::error_code error;
  std::filesystem::path path = std::filesystem::weakly_canonical(absolute, error);
  if (error) path = absolute.lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

// @throws InputError where a folder was given twice, or is the one to write to.
void CheckFolders(const Options& options) {
  std::set<std::filesystem::path> taken = {OneSpelling(options.out)};
  for (const std::string& folder : options.folders) {
    if (taken.insert(OneSpelling(folder)).second) continue;
    throw InputError({"a result would count twice", folder,
                      "it was given before, or is the folder of --out",
                      "give each recording once, and another --out"});
  }
}

ExitCode RunMerge(const Options& options, const GlobalOptions& global) {
  Stopwatch stopwatch;
  OutputFolder out(options.out);
  CheckFolders(options);
  std::vector<ResultFolder> folders;
  for (const std::string& folder : options.folders) folders.push_back(ReadResultFolder(folder));
  const MergedDocuments merged = MergeResults(folders);
  for (const char* name : {"camchain.yaml", "camchain-imucam.yaml", "imu.yaml"}) out.Remove(name);
  out.Add(ChainName(CalibrationKind(merged.result)), ToYaml(merged.chain));
  if (!merged.imus.IsNull()) out.Add("imu.yaml", ToYaml(merged.imus));
  CommitResult("Calibrations merged", merged.result, Value::Object(), &stopwatch, &out);
  if (global.json) {
    std::fputs(ToJson(merged.result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%sreport: %s/report.html\n", MergeText(merged.result).c_str(),
                options.out.c_str());
  }
  const std::string verdict = merged.result.At("verdict").AsString();
  return verdict == VerdictName(Verdict::kPass) || verdict == VerdictName(Verdict::kWarn)
             ? kDone
             : kNotTrusted;
}

}  // namespace

Action SetUpMerge(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("folders", options->folders,
                 "The --out folders of calibrations of one rig from different recordings")
      ->required();
  app.add_option("--out", options->out, "Folder for the merged calibration")->required();
  return [options, &global] { return RunMerge(*options, global); };
}

}  // namespace calibrato
