#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/number_range.h"
#include "calibrato/cli/parse.h"
#include "calibrato/rendering/draw_board.h"

namespace calibrato {
namespace {

struct Options {
  std::string target;
  std::string out;
  DrawingOptions drawing;
};

DrawingFormat FormatOf(const std::string& path) {
  const std::string suffix = std::filesystem::path(path).extension().string();
  if (suffix == ".pdf") return DrawingFormat::kPdf;
  if (suffix == ".svg") return DrawingFormat::kSvg;
  if (suffix == ".png") return DrawingFormat::kPng;
  throw InputError(
      {"unknown kind of drawing", "--out " + path, "", "end the name in .pdf, .svg or .png"});
}

ExitCode RunBoard(const Options& options, const GlobalOptions& global) {
  const DrawingFormat format = FormatOf(options.out);
  std::vector<std::string> warnings;
  const Board board = BoardFromValue(ReadYaml(options.target), &warnings);
  PrintWarnings(warnings);
  WriteFileAtomically(options.out, DrawBoard(board, format, options.drawing));
  if (global.json) {
    Value result = Value::Object();
    result.Set("kind", "board").Set("board", Describe(board)).Set("path", options.out);
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%s: %s; print it at 100 %% and measure it\n", options.out.c_str(),
                Describe(board).c_str());
  }
  return kDone;
}

}  // namespace

Action SetUpBoard(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("--target", options->target, "The board: Kalibr's target YAML")->required();
  app.add_option("--out", options->out, "What to write: board.pdf, board.svg or board.png")
      ->required();
  app.add_option("--dpi", options->drawing.dpi, "Of a PNG: pixels an inch")
      ->check(NumberBetween(36.0, 2400.0))
      ->capture_default_str();
  return [options, &global] { return RunBoard(*options, global); };
}

}  // namespace calibrato
