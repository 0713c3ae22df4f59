// `calibrato evaluate`: a command for each table and figure, and one for all.

#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/evaluate_options.h"
#include "calibrato/cli/evaluate_parts.h"
#include "calibrato/cli/output.h"
#include "calibrato/report/report.h"

namespace calibrato {
namespace {

Value Plots(const EvaluationPart& part) {
  Value plots = Value::Object();
  plots.Set("plots", part.plots);
  return plots;
}

std::string KindOf(const EvaluationPart& part) { return part.result.At("kind").AsString(); }

ExitCode RunPart(MakeEvaluationPart make, const NumRigs& num_rigs, const EvaluateOptions& options,
                 const GlobalOptions& global) {
  Stopwatch stopwatch;
  OutputFolder out(options.out);
  stopwatch.Start("evaluation_s");
  const EvaluationPart part = make(options, global, num_rigs);
  return CommitPart(part, options.out, global, &stopwatch, &out);
}

Action SetUpPart(MakeEvaluationPart make, const NumRigs& num_rigs, CLI::App& app,
                 const GlobalOptions& global) {
  auto options = std::make_shared<EvaluateOptions>();
  AddEvaluateOptions(app, options.get());
  return [make, num_rigs, options, &global] { return RunPart(make, num_rigs, *options, global); };
}

struct PartOfAll {
  const char* name;
  MakeEvaluationPart make;
  NumRigs num_rigs;
  bool has_one_task = false;
};

// With --quick all of them take less than five minutes on two cores.
const std::vector<PartOfAll>& PartsOfAll() {
  static const std::vector<PartOfAll> kParts = {{"table1", MakeTable1, {500, 50, 50}},
                                                {"table6", MakeTable6, {500, 50, 10}},
                                                {"figure4", MakeFigure4, {200, 20, 20}, true},
                                                {"figure5", MakeFigure5, {500, 50, 20}, true},
                                                {"figure7", MakeFigure7, {2, 2, 2}, true},
                                                {"pareto", MakePareto, {200, 20, 10}},
                                                {"rivals", MakeRivals, {20, 10, 2}}};
  return kParts;
}

// Each part in a folder of its own below --out, and one page for all.
ExitCode RunAll(const EvaluateOptions& options, const GlobalOptions& global) {
  Stopwatch stopwatch;
  OutputFolder out(options.out);
  Value parts = Value::Array();
  std::vector<Value> documents;
  std::string text;
  for (const PartOfAll& each : PartsOfAll()) {
    EvaluateOptions own = options;
    // Figures that exist for one task are made whatever --task says.
    if (each.has_one_task) own.task.clear();
    // The one varies what a rig file fixes, the other has no images.
    if (each.make == MakeFigure4 && !own.rig_file.empty()) continue;
    if (each.make == MakeFigure7 && own.fidelity == "rendered") {
      own.fidelity = own.carrier == "arm" ? "physical" : "fast";
    }
    stopwatch.Start(each.name + std::string("_s"));
    const EvaluationPart part = each.make(own, global, each.num_rigs);
    const std::string kind = KindOf(part);
    for (const auto& [name, seconds] : part.seconds) stopwatch.Add("rivals_" + name, seconds);
    for (const auto& [name, content] : part.files) out.Add(kind + "/" + name, content);
    out.Add(kind + "/" + kind + ".json", ToJson(part.result));
    out.Add(kind + "/result.json", ToJson(part.result));
    out.Add(kind + "/plots.json", ToJsonLine(Plots(part)) + "\n");
    documents.push_back(Document(part.result, Plots(part)));
    parts.Append(kind);
    text += part.title + "\n" + part.text + "\n";
  }
  Value result = Value::Object();
  result.Set("kind", "evaluation")
      .Set("seed", static_cast<int64_t>(global.seed))
      .Set("parts", std::move(parts));
  out.Add("result.json", ToJson(result));
  out.Add("plots.json", ToJsonLine(Value::Object()) + "\n");
  documents.insert(documents.begin(), result);
  out.Add("report.html", ReportHtml("Tables and figures", documents));
  out.Add("timing.json", ToJson(stopwatch.Timing()));
  out.Commit();
  if (global.json) {
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%sreport: %s/report.html\n", text.c_str(), options.out.c_str());
  }
  return kDone;
}

}  // namespace

Action SetUpEvaluateTable1(CLI::App& app, const GlobalOptions& global) {
  return SetUpPart(MakeTable1, {500, 50, 100}, app, global);
}

Action SetUpEvaluateTable6(CLI::App& app, const GlobalOptions& global) {
  return SetUpPart(MakeTable6, {500, 50, 100}, app, global);
}

Action SetUpEvaluateFigure4(CLI::App& app, const GlobalOptions& global) {
  return SetUpPart(MakeFigure4, {500, 50, 50}, app, global);
}

Action SetUpEvaluateFigure5(CLI::App& app, const GlobalOptions& global) {
  return SetUpPart(MakeFigure5, {500, 50, 50}, app, global);
}

Action SetUpEvaluateFigure7(CLI::App& app, const GlobalOptions& global) {
  return SetUpPart(MakeFigure7, {2, 2, 2}, app, global);
}

Action SetUpEvaluatePareto(CLI::App& app, const GlobalOptions& global) {
  return SetUpPart(MakePareto, {200, 20, 20}, app, global);
}

Action SetUpEvaluateRows(CLI::App& app, const GlobalOptions& global) {
  return SetUpPart(MakeRows, {500, 50, 20}, app, global);
}

Action SetUpEvaluateRivals(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<EvaluateOptions>();
  AddEvaluateOptions(app, options.get());
  AddOutsideOption(app, options.get());
  const NumRigs num_rigs{20, 10, 4};
  return [options, num_rigs, &global] { return RunPart(MakeRivals, num_rigs, *options, global); };
}

Action SetUpEvaluateAll(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<EvaluateOptions>();
  AddEvaluateOptions(app, options.get());
  AddOutsideOption(app, options.get());
  return [options, &global] { return RunAll(*options, global); };
}

}  // namespace calibrato
