#include "calibrato/guide/guide_document.h"

#include <cmath>
#include <vector>

namespace calibrato {
namespace {

// Pixels are drawn: a tenth is fine enough.
Value PixelValue(const Eigen::Vector2d& pixel) {
  Value value = Value::Array();
  value.Append(std::round(10.0 * pixel.x()) / 10.0).Append(std::round(10.0 * pixel.y()) / 10.0);
  return value;
}

Value PixelValues(const std::vector<Eigen::Vector2d>& pixels) {
  Value values = Value::Array();
  for (const Eigen::Vector2d& pixel : pixels) values.Append(PixelValue(pixel));
  return values;
}

}  // namespace

Value GuideDocument(const GuideSnapshot& snapshot, const GuidePhase& phase, Resolution resolution) {
  Value document = Value::Object();
  document.Set("kind", "guide").Set("phase", phase.phase).Set("words", phase.words);
  document.Set("has_report", phase.has_report);
  document.Set("resolution", Value::Array().Append(resolution.width).Append(resolution.height));
  document.Set("elapsed_s", snapshot.elapsed_s).Set("time_left_s", snapshot.time_left_s);
  document.Set("num_frames", snapshot.num_frames).Set("num_views", snapshot.num_views);
  document.Set("num_imu_samples", snapshot.num_imu_samples);
  document.Set("num_dropped_frames", snapshot.num_dropped_frames);
  document.Set("frame_to_hint_ms", phase.frame_to_hint_ms);
  Value corners = Value::Array();
  if (snapshot.view) {
    for (Eigen::Index k = 0; k < snapshot.view->num_corners(); ++k) {
      corners.Append(PixelValue(snapshot.view->pixels.col(k)));
    }
  }
  document.Set("corners", std::move(corners));
  document.Set("ghost", PixelValues(snapshot.ghost)).Set("arrow", PixelValues(snapshot.arrow));
  if (snapshot.gesture) {
    Value hint = Value::Object();
    hint.Set("name", snapshot.gesture->name)
        .Set("words", snapshot.gesture->words)
        .Set("how", Describe(*snapshot.gesture))
        .Set("left_s", snapshot.gesture_left_s);
    document.Set("hint", std::move(hint));
  }
  document.Set("next", snapshot.next_words);
  Value progress = Value::Array();
  for (const ParameterProgress& parameter : snapshot.progress) {
    Value entry = Value::Object();
    entry.Set("name", parameter.name)
        .Set("unit", parameter.unit)
        .Set("sigma", parameter.sigma)
        .Set("wanted", parameter.wanted);
    progress.Append(std::move(entry));
  }
  document.Set("progress", std::move(progress)).Set("is_measured", snapshot.is_measured);
  Value coverage = Value::Object();
  coverage.Set("x", snapshot.coverage.x)
      .Set("y", snapshot.coverage.y)
      .Set("size", snapshot.coverage.size)
      .Set("skew", snapshot.coverage.skew);
  document.Set("coverage", std::move(coverage));
  Value warnings = Value::Array();
  for (const std::string& warning : snapshot.warnings) warnings.Append(warning);
  document.Set("warnings", std::move(warnings));
  if (snapshot.ended) document.Set("ended", *snapshot.ended);
  return document;
}

}  // namespace calibrato
