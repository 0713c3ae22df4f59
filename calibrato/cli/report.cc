#include "calibrato/report/report.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/output.h"

namespace calibrato {
namespace {

bool HasResult(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "result.json");
}

Value ReadDocument(const std::filesystem::path& folder) {
  Value plots = Value::Object();
  if (std::filesystem::exists(folder / "plots.json")) {
    plots = ReadJson((folder / "plots.json").string());
  }
  return Document(ReadJson((folder / "result.json").string()), plots);
}

ExitCode RunReport(const std::string& folder, const GlobalOptions& global) {
  namespace fs = std::filesystem;
  if (!fs::is_directory(folder)) {
    throw InputError({"no such folder", folder, "", "give the --out folder of another command"});
  }
  std::vector<Value> documents;
  if (HasResult(folder)) documents.push_back(ReadDocument(folder));
  std::vector<fs::path> below;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() && HasResult(entry.path())) below.push_back(entry.path());
  }
  std::sort(below.begin(), below.end());
  for (const fs::path& path : below) documents.push_back(ReadDocument(path));
  if (documents.empty()) {
    throw InputError({"nothing to report", folder,
                      "there is no result.json in it or in the folders in it",
                      "give the --out folder of another command"});
  }
  const std::string path = (fs::path(folder) / "report.html").string();
  WriteFileAtomically(path, ReportHtml("calibrato", documents));
  if (global.json) {
    Value result = Value::Object();
    result.Set("kind", "report").Set("path", path);
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("report: %s\n", path.c_str());
  }
  return kDone;
}

}  // namespace

Action SetUpReport(CLI::App& app, const GlobalOptions& global) {
  auto folder = std::make_shared<std::string>();
  app.add_option("folder", *folder, "A result's folder, or one that holds several")->required();
  return [folder, &global] { return RunReport(*folder, global); };
}

}  // namespace calibrato
