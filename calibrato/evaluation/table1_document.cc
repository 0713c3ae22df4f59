#include "calibrato/evaluation/table1_document.h"

#include <cmath>
#include <cstdio>
#include <functional>

#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

double MeanOf(const Table1Row& row, bool converged_only,
              const std::function<double(const Trial&)>& figure) {
  std::vector<double> values;
  for (const Trial& trial : row.trials) {
    if (trial.converged || !converged_only) values.push_back(figure(trial));
  }
  return Mean(values);
}

Value Percent(const Interval& interval) {
  Value value = Value::Array();
  value.Append(100.0 * interval.low).Append(100.0 * interval.high);
  return value;
}

Value Pair(const Interval& interval) {
  Value value = Value::Array();
  value.Append(interval.low).Append(interval.high);
  return value;
}

Value Numbers(const Eigen::Vector3d& v) { return Value::Numbers(v); }

Value RowValue(const Table1& table, const Table1Row& row) {
  const auto converged = [&](double Trial::*figure) {
    return MeanOf(row, true, [figure](const Trial& trial) { return trial.*figure; });
  };
  const auto all = [&](double Trial::*figure) {
    return MeanOf(row, false, [figure](const Trial& trial) { return trial.*figure; });
  };
  Value value = Value::Object();
  value.Set("task", TaskName(Task::kIntrinsic))
      .Set("policy", row.policy)
      .Set("carrier", CarrierName(table.options.carrier))
      .Set("fidelity", "fast")
      .Set("rigs", RigDistributionName(table.options.rigs))
      .Set("seed", static_cast<int64_t>(table.options.seed))
      .Set("n", static_cast<int64_t>(row.trials.size()))
      .Set("mean_error_percent", 100.0 * row.mean_error)
      .Set("ci95", Percent(row.mean_error_ci95))
      .Set("median_error_percent", 100.0 * row.median_error)
      .Set("ratio_to_handcrafted", row.ratio_to_handcrafted)
      .Set("ratio_ci95", Pair(row.ratio_ci95))
      .Set("ratio_to_random", row.ratio_to_random)
      .Set("ratio_to_random_ci95", Pair(row.ratio_to_random_ci95))
      .Set("path_length_m", all(&Trial::path_length_m))
      .Set("path_length_original_m", all(&Trial::path_length_original_m))
      .Set("motion_s", all(&Trial::motion_s))
      .Set("scale", row.scale)
      .Set("prediction_error_px", converged(&Trial::prediction_error_px))
      .Set("focal_error_px", converged(&Trial::focal_error_px))
      .Set("translation_error_m", Value())
      .Set("rotation_error_rad", Value())
      .Set("time_offset_error_s", Value())
      .Set("a_optimality", converged(&Trial::a_optimality))
      .Set("a_optimality_conditional", Value())
      .Set("error_over_bound", std::sqrt(converged(&Trial::nees) / 4.0))
      .Set("failures", row.num_failures);
  return value;
}

// The camera's way and, now and then, where it looked, loop by loop.
Value MotionPlot(const Table1Row& row) {
  constexpr int kPointsALoop = 60;
  constexpr int kAxesEvery = 6;
  const Rigid3 T_e_c0 = PaperRig().T_e_c0;
  Value loops = Value::Array();
  Value axes = Value::Array();
  double start_s = 0.0;
  for (const double duration_s : row.example.loop_duration_s) {
    Value loop = Value::Array();
    for (int k = 0; k <= kPointsALoop; ++k) {
      const Rigid3 T_b_c0 = row.example.At(start_s + duration_s * k / kPointsALoop).T_b_e * T_e_c0;
      loop.Append(Numbers(T_b_c0.t));
      if (k % kAxesEvery == 0) {
        Eigen::Matrix<double, 6, 1> axis;
        axis << T_b_c0.t, T_b_c0.R.col(2);
        axes.Append(Value::Numbers(axis));
      }
    }
    start_s += duration_s;
    loops.Append(std::move(loop));
  }
  Value plot = Value::Object();
  plot.Set("policy", row.policy)
      .Set("path_length_m", PathLength(row.example.motion))
      .Set("motion_s", row.example.duration_s())
      .Set("loops", std::move(loops))
      .Set("axis_b", std::move(axes));
  return plot;
}

Value CoveragePlot(const Table1Row& row) {
  Value pixels = Value::Array();
  const auto rounded = [](double x) { return std::round(10.0 * x) / 10.0; };
  for (const BoardView& view : row.example_views) {
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      Value pixel = Value::Array();
      pixel.Append(rounded(view.pixels(0, k))).Append(rounded(view.pixels(1, k)));
      pixels.Append(std::move(pixel));
    }
  }
  Value plot = Value::Object();
  plot.Set("policy", row.policy).Set("pixels", std::move(pixels));
  return plot;
}

Value BoardOutline() {
  const Rig rig = PaperRig();
  const Rigid3 T_b_g = ArmBaseInWorld().Inverse() * rig.T_w_g;
  const Eigen::Matrix3Xd points = BoardPoints(rig.board);
  const Eigen::Vector3d far = points.rowwise().maxCoeff();
  Value outline = Value::Array();
  for (const auto& [x, y] :
       {std::pair{0.0, 0.0}, {far.x(), 0.0}, {far.x(), far.y()}, {0.0, far.y()}}) {
    outline.Append(Numbers(T_b_g * Eigen::Vector3d(x, y, 0.0)));
  }
  return outline;
}

}  // namespace

Value ToValue(const Table1& table) {
  Value rows = Value::Array();
  for (const Table1Row& row : table.rows) rows.Append(RowValue(table, row));
  Value value = Value::Object();
  value.Set("kind", "table1").Set("rows", std::move(rows));
  return value;
}

Value Table1Plots(const Table1& table) {
  Value errors = Value::Array();
  Value motions = Value::Array();
  Value coverage = Value::Array();
  for (const Table1Row& row : table.rows) {
    Value of_rigs = Value::Array();
    for (const Trial& trial : row.trials) {
      of_rigs.Append(trial.converged ? Value(trial.relative_error) : Value());
    }
    Value entry = Value::Object();
    entry.Set("policy", row.policy).Set("relative_error", std::move(of_rigs));
    errors.Append(std::move(entry));
    motions.Append(MotionPlot(row));
    coverage.Append(CoveragePlot(row));
  }
  const Resolution resolution = PaperRig().cameras.front().resolution;
  Value size = Value::Array();
  size.Append(resolution.width).Append(resolution.height);
  Value plots = Value::Object();
  plots.Set("errors", std::move(errors))
      .Set("motions", std::move(motions))
      .Set("coverage", std::move(coverage))
      .Set("resolution", std::move(size))
      .Set("board_outline_b", BoardOutline());
  return plots;
}

std::string Table1Text(const Table1& table) {
  char line[256];
  std::snprintf(line, sizeof(line),
                "intrinsic task, carrier %s, rigs %s, fidelity fast, n = %d, seed %llu\n"
                "%-14s %-24s %8s %-21s %8s %8s %6s %6s\n",
                CarrierName(table.options.carrier).c_str(),
                RigDistributionName(table.options.rigs).c_str(), table.options.num_rigs,
                static_cast<unsigned long long>(table.options.seed), "policy",
                "mean error [%] (95 %)", "median", "over handcrafted", "path [m]", "time [s]",
                "scale", "failed");
  std::string text = line;
  for (const Table1Row& row : table.rows) {
    char mean[64];
    char ratio[64];
    std::snprintf(mean, sizeof(mean), "%.4f (%.4f, %.4f)", 100.0 * row.mean_error,
                  100.0 * row.mean_error_ci95.low, 100.0 * row.mean_error_ci95.high);
    std::snprintf(ratio, sizeof(ratio), "%.3f (%.3f, %.3f)", row.ratio_to_handcrafted,
                  row.ratio_ci95.low, row.ratio_ci95.high);
    std::snprintf(line, sizeof(line), "%-14s %-24s %8.4f %-21s %8.3f %8.2f %6.3f %6d\n",
                  row.policy.c_str(), mean, 100.0 * row.median_error, ratio,
                  MeanOf(row, false, [](const Trial& trial) { return trial.path_length_m; }),
                  MeanOf(row, false, [](const Trial& trial) { return trial.motion_s; }), row.scale,
                  row.num_failures);
    text += line;
  }
  return text;
}

}  // namespace calibrato
