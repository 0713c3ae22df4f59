#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "calibrato/evaluation/figure4.h"
#include "calibrato/evaluation/figure5.h"
#include "calibrato/evaluation/figure7.h"
#include "calibrato/evaluation/pareto.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

ContestSetting Small(Task task, int num_rigs) {
  ContestSetting setting;
  setting.task = task;
  setting.num_rigs = num_rigs;
  return setting;
}

TEST(Figure4, RigsDifferInNothingButTheirFocalLength) {
  const ContestSetting setting = Small(Task::kIntrinsic, 5);
  for (const double hfov_rad : {0.8, 1.0}) {
    for (const Rig& rig : RigsWithFieldOfView(setting, hfov_rad)) {
      const Eigen::Vector4d intrinsics = rig.cameras.front().model.focal_and_centre();
      EXPECT_NEAR(intrinsics[0], 320.0 / std::tan(0.5 * hfov_rad), 1e-9);
      EXPECT_EQ(intrinsics[0], intrinsics[1]);
      EXPECT_EQ(intrinsics[2], 320.5);
      EXPECT_TRUE(CoversImage(rig.cameras.front().model, rig.cameras.front().resolution));
    }
  }
}

TEST(Figure4, HasARowForEachPolicyAndFieldOfView) {
  const Figure4 figure = EvaluateFigure4(Small(Task::kIntrinsic, 2), {});
  const Value document = ToValue(figure);
  EXPECT_EQ(document.At("rows").size(), 10U);
  EXPECT_EQ(document.At("rows").elements()[0].At("hfov_rad").AsDouble(), 0.8);
  const std::vector<Chart> charts = ChartsOf(figure);
  ASSERT_EQ(charts.size(), 1U);
  ASSERT_EQ(charts[0].series.size(), 2U);
  EXPECT_EQ(charts[0].series[1].x, std::vector<double>({0.8, 0.9, 1.0, 1.1, 1.2}));
}

TEST(Figure5, QuantilesAscend) {
  const Table1 table = EvaluateTable1({Small(Task::kExtrinsic, 2), {}});
  const Value document = Figure5Value(table);
  EXPECT_EQ(document.At("rows").size(), table.rows.size());
  for (const Value& row : document.At("rows").elements()) {
    const Value& quantiles = row.At("quantiles_percent");
    EXPECT_LE(quantiles.At("q05").AsDouble(), quantiles.At("q50").AsDouble());
    EXPECT_LE(quantiles.At("q50").AsDouble(), quantiles.At("q95").AsDouble());
    EXPECT_NEAR(quantiles.At("q50").AsDouble(), row.At("median_error_percent").AsDouble(), 1e-12);
  }
  for (const Chart& chart : Figure5Charts(table)) {
    ASSERT_EQ(chart.series.size(), table.rows.size());
    EXPECT_EQ(chart.series[0].y.size(), 2U);
  }
}

TEST(Figure7, ResidualsAreOfTheSizeOfTheirNoise) {
  const Figure7 figure = EvaluateFigure7(Small(Task::kExtrinsic, 2), {});
  const Value document = ToValue(figure);
  const Value& row = document.At("rows").elements()[0];
  EXPECT_EQ(row.At("termination").AsString(), "converged");
  // 0.1 px in u and in v; samples of the stated densities, less what the trajectory takes up.
  EXPECT_NEAR(row.At("reprojection_rms_px").AsDouble(), 0.1 * std::sqrt(2.0), 0.01);
  EXPECT_NEAR(row.At("gyro_rms_normalised").AsDouble(), 0.9, 0.15);
  EXPECT_NEAR(row.At("accel_rms_normalised").AsDouble(), 0.9, 0.15);
  for (const double mean : row.At("reprojection_mean_px").AsDoubles(2)) {
    EXPECT_NEAR(mean, 0.0, 0.01);
  }
  for (const Chart& chart : ChartsOf(figure)) {
    ASSERT_EQ(chart.series.size(), 1U) << chart.title;
    EXPECT_GT(chart.series[0].y.size(), 10U) << chart.title;
    EXPECT_EQ(chart.series[0].x.size(), chart.series[0].y.size()) << chart.title;
  }
}

TEST(Pareto, LessBudgetMeansLessPathAndLessTime) {
  const Pareto pareto = EvaluatePareto(Small(Task::kIntrinsic, 2), {});
  const Value document = ToValue({pareto});
  double whole_path = 0.0;
  double whole_time = 0.0;
  std::set<int64_t> cuts;
  for (const Value& row : document.At("rows").elements()) {
    if (row.At("policy").AsString() != "handcrafted") continue;
    const double path = row.At("path_length_m").AsDouble();
    const double time = row.At("motion_s").AsDouble();
    const double scale = row.At("scale").AsDouble();
    if (const Value* num_loops = row.Find("num_loops")) {
      cuts.insert(num_loops->AsInt());
      EXPECT_LT(path, whole_path);
      EXPECT_LT(time, whole_time);
    } else if (scale == 1.0) {
      whole_path = path;
      whole_time = time;
    } else {
      EXPECT_NEAR(path, scale * whole_path, 1e-9);
      EXPECT_LE(time, whole_time);
    }
  }
  EXPECT_NEAR(whole_path, 11.3641, 1e-4);
  EXPECT_EQ(cuts, std::set<int64_t>({1, 2, 3}));
  EXPECT_EQ(ChartsOf({pareto}).size(), 3U);
}

TEST(Chart, ItsListHasALineForEachPoint) {
  Chart chart;
  chart.series = {{"a, b", {1.0, 2.0}, {3.0, 4.0}, {2.5, 3.5}, {3.5, 4.5}},
                  {"c", {}, {7.0}, {}, {}}};
  EXPECT_EQ(ChartCsv(chart),
            "series,x,y,low,high\n\"a, b\",1,3,2.5,3.5\n\"a, b\",2,4,3.5,4.5\nc,,7,,\n");
}

}  // namespace
}  // namespace calibrato
