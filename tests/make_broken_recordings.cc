// make_broken_recordings FOLDER: writes the recordings of docs/check.md.
// make_broken_recordings --list: prints that page's table of them.

#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "broken_recordings.h"
#include "calibrato/base/files.h"

namespace {

void Write(const std::string& folder, const calibrato::PlainRecording& recording) {
  calibrato::OutputFolder out(folder);
  for (auto& [name, content] : calibrato::FilesOf(recording)) out.Add(name, content);
  out.Commit();
  std::printf("%s\n", folder.c_str());
}

void PrintTable() {
  for (const calibrato::BrokenRecording& broken : calibrato::BrokenRecordings()) {
    std::string findings;
    for (const std::string& words : broken.findings) {
      findings += (findings.empty() ? "" : "; ") + words;
    }
    std::printf("| `%s` | %s | %s |\n", broken.name.c_str(), broken.what.c_str(), findings.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_broken_recordings FOLDER | --list\n");
    return 2;
  }
  if (std::string(argv[1]) == "--list") {
    PrintTable();
    return 0;
  }
  try {
    const std::filesystem::path folder = argv[1];
    Write((folder / "clean-corners").string(), calibrato::CleanCorners());
    Write((folder / "clean-images").string(), calibrato::CleanImages());
    for (const calibrato::BrokenRecording& broken : calibrato::BrokenRecordings()) {
      Write((folder / broken.name).string(), broken.make());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  }
  return 0;
}
