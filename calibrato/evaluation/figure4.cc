#include "calibrato/evaluation/figure4.h"

#include <utility>

#include "calibrato/base/parallel.h"
#include "calibrato/evaluation/method_row.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

Rng RowStream(const Figure4& figure, size_t k) {
  return Rng(figure.setting.seed).Stream("figure 4 row", k);
}

}  // namespace

std::vector<Rig> RigsWithFieldOfView(const ContestSetting& setting, double hfov_rad) {
  const Rng rng(setting.seed);
  return ParallelMap<Rig>(static_cast<size_t>(setting.num_rigs), [&](size_t i) {
    Rng draws = rng.Stream("evaluation rig", i);
    Rig rig;
    do {
      rig = DrawRig(setting.rigs, draws);
      Camera& camera = rig.cameras.front();
      Eigen::VectorXd parameters = camera.model.parameters();
      parameters.segment<2>(CameraModel::FocalIndex(camera.model.name()))
          .setConstant(FocalLengthFromFieldOfView(hfov_rad, camera.resolution.width));
      camera.model = CameraModel(camera.model.name(), parameters);
    } while (!CoversImage(rig.cameras.front().model, rig.cameras.front().resolution));
    return rig;
  });
}

Figure4 EvaluateFigure4(const ContestSetting& setting,
                        const std::vector<MotionUnderTrial>& motions) {
  Figure4 figure{setting, {}};
  const Rig scene = PlanningScene(setting);
  std::vector<Contestant> fixed = {
      FixedContestant("handcrafted", HandcraftedMotion(Task::kIntrinsic), setting.carrier, scene)};
  for (Contestant& brought :
       BroughtContestants(motions, Task::kIntrinsic, setting.carrier, scene)) {
    fixed.push_back(std::move(brought));
  }
  for (const double hfov_rad : kFigure4FieldsOfView) {
    const std::vector<Rig> rigs = RigsWithFieldOfView(setting, hfov_rad);
    std::vector<Contestant> contestants = {
        RandomContestant(Task::kIntrinsic, setting.carrier, rigs, Rng(setting.seed))};
    contestants.insert(contestants.end(), fixed.begin(), fixed.end());
    ContestTrials trials = RunContest(setting, rigs, contestants);
    for (size_t k = 0; k < contestants.size(); ++k) {
      figure.points.push_back({hfov_rad, contestants[k].policy, std::move(trials[k])});
    }
  }
  return figure;
}

Value ToValue(const Figure4& figure) {
  Value rows = Value::Array();
  for (size_t k = 0; k < figure.points.size(); ++k) {
    const Figure4Point& point = figure.points[k];
    Value row = MethodRow(figure.setting, point.policy, point.trials, RowStream(figure, k));
    row.Set("hfov_rad", point.hfov_rad);
    rows.Append(std::move(row));
  }
  Value value = Value::Object();
  value.Set("kind", "figure4").Set("rows", std::move(rows));
  return value;
}

std::vector<Chart> ChartsOf(const Figure4& figure) {
  Chart chart;
  chart.title = "Error against field of view";
  chart.note =
      "Mean relative error of the intrinsics with its 95 % interval, over the same rigs for every "
      "policy: the paper's Figure 4.";
  chart.x_title = "horizontal field of view [rad]";
  chart.y_title = "mean error [%]";
  const Value rows = ToValue(figure).At("rows");
  for (const Value& row : rows.elements()) {
    const std::string policy = row.At("policy").AsString();
    ChartSeries* series = nullptr;
    for (ChartSeries& known : chart.series) {
      if (known.name == policy) series = &known;
    }
    if (series == nullptr) series = &chart.series.emplace_back(ChartSeries{policy, {}, {}, {}, {}});
    if (row.Find("mean_error_percent") == nullptr) continue;
    series->x.push_back(row.At("hfov_rad").AsDouble());
    series->y.push_back(row.At("mean_error_percent").AsDouble());
    const std::vector<double> ci95 = row.At("ci95").AsDoubles(2);
    series->low.push_back(ci95[0]);
    series->high.push_back(ci95[1]);
  }
  return {chart};
}

}  // namespace calibrato
