// Writes report pages for the tests in a browser: one with every kind of document, and one with all
// that can be missing or wrong in a document.
//
//   write_report_pages FOLDER

#include <cstdio>
#include <filesystem>
#include <string>

#include "calibrato/base/files.h"
#include "calibrato/report/documents_for_test.h"
#include "calibrato/report/report.h"

namespace calibrato {
namespace {

std::string PageOfEveryKind() {
  return ReportHtml("Every kind of result",
                    {CameraDocumentForTest(), CameraImuDocumentForTest(), CheckDocumentForTest(),
                     NoiseDocumentForTest(), LearnDocumentForTest(), Table1DocumentForTest(),
                     ParetoDocumentForTest(), CameraImuDiffDocumentForTest(),
                     MergeDocumentForTest(), DryRunDocumentForTest()});
}

std::string PageOfWhatIsWrong() {
  Value finding = Value::Object();
  finding.Set("severity", "warn").Set("what", "</script><b id=\"evil\">bold</b>");
  Value camera = Value::Object();
  camera.Set("kind", "camera")
      .Set("verdict", "fail")
      .Set("findings", Value::Array().Append(finding));
  Value broken = Value::Object();
  broken.Set("kind", "camera").Set("cameras", Value::Array().Append(Value()));
  const auto empty = [](const std::string& kind) { return Value::Object().Set("kind", kind); };
  return ReportHtml(
      "What is missing or wrong",
      {Value::Object().Set("kind", "horoscope").Set("luck", 7), camera, broken, empty("learn"),
       empty("table1"), empty("camera-imu"), empty("diff"), empty("check"), empty("noise"),
       empty("rivals"), empty("evaluation"), empty("merge"), empty("dry-run")});
}

}  // namespace
}  // namespace calibrato

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_report_pages FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  calibrato::WriteFileAtomically(folder / "every-kind.html", calibrato::PageOfEveryKind());
  calibrato::WriteFileAtomically(folder / "wrong.html", calibrato::PageOfWhatIsWrong());
  return 0;
}
