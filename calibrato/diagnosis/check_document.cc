#include "calibrato/diagnosis/check_document.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "calibrato/diagnosis/envelope.h"
#include "calibrato/diagnosis/upper_median.h"

namespace calibrato {
namespace {

constexpr int kNumPieces = 400;
constexpr size_t kMostImages = 2000;
constexpr size_t kMostCorners = 4000;

double RateHz(const StreamTiming& timing) {
  return timing.median_period_s > 0.0 ? 1.0 / timing.median_period_s : 0.0;
}

size_t NumSaturated(const StreamDefects& defects) {
  return defects.num_saturated[0] + defects.num_saturated[1] + defects.num_saturated[2];
}

Value StreamValue(const CheckedStream& stream, Verdict verdict) {
  const StreamTiming& timing = stream.timing;
  Value steps = Value::Array();
  for (const StreamTiming::StepBack& step : timing.steps_back) steps.Append(step.step_s);
  Value value = Value::Object();
  value.Set("name", stream.name)
      .Set("verdict", VerdictName(verdict))
      .Set("num", timing.num_stamps)
      .Set("duration_s", timing.duration_s)
      .Set("rate_hz", RateHz(timing))
      .Set("jitter_s", timing.jitter_s)
      .Set("num_missing", timing.num_missing)
      .Set("num_gaps", timing.num_gaps)
      .Set("longest_gap_s", timing.longest_gap_s)
      .Set("steps_back_s", std::move(steps));
  if (stream.defects) {
    value.Set("num_not_finite", stream.defects->num_not_finite)
        .Set("num_out_of_order", stream.defects->num_out_of_order)
        .Set("num_duplicates", stream.defects->num_duplicates)
        .Set("num_saturated", NumSaturated(*stream.defects));
  }
  return value;
}

Value ClockValue(const CheckedClock& clock) {
  Value pieces = Value::Array();
  for (const ClockOffset& offset : clock.offsets) {
    const Time zero = clock.offsets.front().begin;
    Value piece = Value::Object();
    piece.Set("begin_s", (offset.begin - zero).seconds())
        .Set("end_s", (offset.end - zero).seconds())
        .Set("time_offset_s", offset.comparison.time_offset_s)
        .Set("correlation", offset.comparison.correlation);
    pieces.Append(std::move(piece));
  }
  Value value = Value::Object();
  value.Set("imu", clock.imu)
      .Set("camera", clock.camera)
      .Set("time_offset_s", clock.comparison.time_offset_s)
      .Set("correlation", clock.comparison.correlation)
      .Set("speed_ratio", clock.comparison.scale)
      .Set("pieces", std::move(pieces));
  return value;
}

// Null without values.
Value MedianValue(std::vector<double> values) {
  return values.empty() ? Value() : Value(UpperMedian(std::move(values)));
}

Value BoardValue(const CameraToCheck& camera, const CheckedBoard& board, Verdict verdict) {
  std::vector<double> widths;
  std::vector<double> black;
  std::vector<double> white;
  std::vector<double> brightness;
  for (const ImageQuality& image : camera.images) {
    brightness.push_back(image.brightness);
    if (!image.board) continue;
    widths.push_back(image.board->edge_width_px);
    black.push_back(image.board->black);
    white.push_back(image.board->white);
  }
  Value coverage = Value::Object();
  coverage.Set("x", board.coverage.x)
      .Set("y", board.coverage.y)
      .Set("size", board.coverage.size)
      .Set("skew", board.coverage.skew);
  Value parts = Value::Array();
  for (const std::string& part : board.uncovered_parts) parts.Append(part);
  Value value = Value::Object();
  value.Set("camera", board.camera)
      .Set("verdict", VerdictName(verdict))
      .Set("num_images", board.num_images)
      .Set("num_with_board", camera.views.size())
      .Set("longest_away_s", board.longest_away_s)
      .Set("coverage", std::move(coverage))
      .Set("uncovered_parts", std::move(parts))
      .Set("travel_m", board.travel_m ? Value::Numbers(*board.travel_m) : Value())
      .Set("edge_width_px", MedianValue(std::move(widths)))
      .Set("black", MedianValue(std::move(black)))
      .Set("white", MedianValue(std::move(white)))
      .Set("brightness", MedianValue(std::move(brightness)));
  return value;
}

Value MotionValue(const CheckedMotion& motion, Verdict verdict) {
  Value rest;
  if (motion.rest) {
    rest.Set("duration_s", motion.rest->duration_s)
        .Set("gyro_noise_density", motion.rest->gyro_noise_density)
        .Set("accel_noise_density", motion.rest->accel_noise_density);
  }
  Value value = Value::Object();
  value.Set("imu", motion.imu)
      .Set("verdict", VerdictName(verdict))
      .Set("rates_rad_s", Value::Numbers(motion.rates))
      .Set("forces_m_s2", Value::Numbers(motion.forces))
      .Set("median_force_m_s2", motion.median_force)
      .Set("rest", std::move(rest));
  return value;
}

const CameraToCheck& CameraOf(const RecordingToCheck& recording, const CheckedBoard& board) {
  return *std::find_if(recording.cameras.begin(), recording.cameras.end(),
                       [&](const CameraToCheck& camera) { return camera.name == board.camera; });
}

// The times that a plot shows, of streams whose clocks may have nothing in common.
class TimeAxis {
 public:
  void Add(Time stamp) {
    begin_ = is_empty_ ? stamp : std::min(begin_, stamp);
    end_ = is_empty_ ? stamp : std::max(end_, stamp);
    is_empty_ = false;
  }
  // Where a stream's zero is: the axis's own, or its first stamp if all of it lies elsewhere.
  Time ZeroOf(Time first, Time last) const {
    return is_empty_ || last < begin_ || end_ < first ? first : begin_;
  }
  double duration_s() const { return (end_ - begin_).seconds(); }

 private:
  bool is_empty_ = true;
  Time begin_;
  Time end_;
};

Value CameraPlot(const CameraToCheck& camera, Time zero) {
  // Photos without stamps have no time lines.
  const bool is_stamped = std::any_of(camera.stamps.begin(), camera.stamps.end(),
                                      [](Time stamp) { return stamp != Time(); });
  std::map<Time, Eigen::Index> num_corners;
  for (const Time stamp : camera.stamps_without_board) num_corners[stamp] = 0;
  size_t num_all = 0;
  for (const BoardView& view : camera.views) {
    num_corners[view.stamp] = view.num_corners();
    num_all += static_cast<size_t>(view.num_corners());
  }
  Value times = Value::Array();
  Value counts = Value::Array();
  const size_t stride = num_corners.size() / kMostImages + 1;
  size_t k = 0;
  for (const auto& [stamp, count] : num_corners) {
    if (!is_stamped || k++ % stride != 0) continue;
    times.Append(std::round(1e3 * (stamp - zero).seconds()) / 1e3);
    counts.Append(static_cast<int64_t>(count));
  }
  Value edge_times = Value::Array();
  Value edge_widths = Value::Array();
  for (const ImageQuality& image : camera.images) {
    if (!is_stamped || !image.board) continue;
    edge_times.Append(std::round(1e3 * (image.stamp - zero).seconds()) / 1e3);
    edge_widths.Append(std::round(1e2 * image.board->edge_width_px) / 1e2);
  }
  Value corners = Value::Array();
  const size_t corner_stride = num_all / kMostCorners + 1;
  size_t corner = 0;
  for (const BoardView& view : camera.views) {
    for (Eigen::Index i = 0; i < view.num_corners(); ++i) {
      if (corner++ % corner_stride != 0) continue;
      const Eigen::Vector2d pixel = (10.0 * view.pixels.col(i)).array().round() / 10.0;
      corners.Append(Value::Numbers(pixel));
    }
  }
  Value resolution;
  if (camera.resolution) {
    resolution = Value::Array();
    resolution.Append(camera.resolution->width).Append(camera.resolution->height);
  }
  Value value = Value::Object();
  value.Set("name", camera.name)
      .Set("resolution", std::move(resolution))
      .Set("time_s", std::move(times))
      .Set("num_corners", std::move(counts))
      .Set("edge_time_s", std::move(edge_times))
      .Set("edge_width_px", std::move(edge_widths))
      .Set("corners", std::move(corners));
  return value;
}

std::vector<double> SecondsSince(Time zero, const std::vector<VectorSample>& samples) {
  std::vector<double> times_s;
  for (const VectorSample& sample : samples) times_s.push_back((sample.stamp - zero).seconds());
  return times_s;
}

Value Envelopes(const std::vector<VectorSample>& samples, Time zero) {
  const std::vector<double> times_s = SecondsSince(zero, samples);
  Value envelopes = Value::Array();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const VectorSample& sample : samples) values.push_back(sample.value(axis));
    envelopes.Append(Envelope(times_s, values, kNumPieces));
  }
  return envelopes;
}

// Of ascending stamps.
Value IntervalsValue(const std::string& name, const std::vector<double>& times_s, double median_s) {
  std::vector<double> later;
  std::vector<double> intervals_ms;
  for (size_t k = 1; k < times_s.size(); ++k) {
    later.push_back(times_s[k]);
    intervals_ms.push_back(1e3 * (times_s[k] - times_s[k - 1]));
  }
  Value value = Value::Object();
  value.Set("name", name)
      .Set("median_ms", 1e3 * median_s)
      .Set("interval_ms", Envelope(later, intervals_ms, kNumPieces));
  return value;
}

}  // namespace

Value CheckResult(const RecordingToCheck& recording, const RecordingCheck& check) {
  Value streams = Value::Array();
  for (const CheckedStream& stream : check.streams) {
    streams.Append(StreamValue(stream, check.VerdictOn(stream.name)));
  }
  Value clocks = Value::Array();
  for (const CheckedClock& clock : check.clocks) clocks.Append(ClockValue(clock));
  Value boards = Value::Array();
  for (const CheckedBoard& board : check.boards) {
    boards.Append(BoardValue(CameraOf(recording, board), board, check.VerdictOn(board.camera)));
  }
  Value motions = Value::Array();
  for (const CheckedMotion& motion : check.motions) {
    motions.Append(MotionValue(motion, check.VerdictOn(motion.imu)));
  }
  Value expected = Value::Array();
  for (const ExpectedSigma& parameter : check.expected) {
    Value value = Value::Object();
    value.Set("name", parameter.name)
        .Set("sigma", parameter.sigma)
        .Set("enough", parameter.enough)
        .Set("verdict", VerdictName(parameter.verdict))
        .Set("advice", parameter.advice);
    expected.Append(std::move(value));
  }
  Value result = Value::Object();
  result.Set("kind", "check")
      .Set("verdict", VerdictName(VerdictOf(check.findings)))
      .Set("findings", ToValue(check.findings))
      .Set("streams", std::move(streams))
      .Set("clocks", std::move(clocks))
      .Set("boards", std::move(boards))
      .Set("motions", std::move(motions))
      .Set("expected", std::move(expected));
  return result;
}

Value CheckPlots(const RecordingToCheck& recording, const RecordingCheck& check) {
  TimeAxis axis;
  for (const CameraToCheck& camera : recording.cameras) {
    for (const Time stamp : camera.stamps) axis.Add(stamp);
  }
  std::vector<ImuStream> mended;
  for (const CheckedImu& imu : recording.imus) mended.push_back(Mended(imu.recording.stream));
  if (recording.cameras.empty()) {
    for (const ImuStream& stream : mended) {
      for (const VectorSample& sample : stream.gyro) axis.Add(sample.stamp);
    }
  }
  Value cameras = Value::Array();
  Value intervals = Value::Array();
  const auto median_of = [&](const std::string& name) {
    for (const CheckedStream& stream : check.streams) {
      if (stream.name == name) return stream.timing.median_period_s;
    }
    return 0.0;
  };
  for (const CameraToCheck& camera : recording.cameras) {
    if (camera.stamps.empty()) continue;
    const auto [first, last] = std::minmax_element(camera.stamps.begin(), camera.stamps.end());
    const Time zero = axis.ZeroOf(*first, *last);
    cameras.Append(CameraPlot(camera, zero));
    std::vector<double> times_s;
    for (const Time stamp : camera.stamps) times_s.push_back((stamp - zero).seconds());
    intervals.Append(IntervalsValue(camera.name, times_s, median_of(camera.name)));
  }
  Value imus = Value::Array();
  for (size_t n = 0; n < mended.size(); ++n) {
    const ImuStream& stream = mended[n];
    if (stream.gyro.empty() || stream.accel.empty()) continue;
    const Time zero = axis.ZeroOf(stream.gyro.front().stamp, stream.gyro.back().stamp);
    const std::string& name = recording.imus[n].recording.name;
    Value value = Value::Object();
    value.Set("name", name)
        .Set("gyro", Envelopes(stream.gyro, zero))
        .Set("accel", Envelopes(stream.accel, zero));
    imus.Append(std::move(value));
    intervals.Append(IntervalsValue(name + " gyroscope", SecondsSince(zero, stream.gyro),
                                    median_of(name + " gyroscope")));
    intervals.Append(IntervalsValue(name + " accelerometer", SecondsSince(zero, stream.accel),
                                    median_of(name + " accelerometer")));
  }
  Value plots = Value::Object();
  plots.Set("duration_s", axis.duration_s())
      .Set("cameras", std::move(cameras))
      .Set("imus", std::move(imus))
      .Set("intervals", std::move(intervals));
  return plots;
}

std::string CheckText(const RecordingToCheck& recording, const RecordingCheck& check) {
  std::string text;
  for (const CheckedStream& stream : check.streams) {
    text += Format("%-20s %zu at %.4g Hz for %.1f s, jitter %.2g ms", stream.name.c_str(),
                   stream.timing.num_stamps, RateHz(stream.timing), stream.timing.duration_s,
                   1e3 * stream.timing.jitter_s);
    if (stream.timing.num_gaps > 0) {
      text += Format(", %zu gaps (longest %.3f s)", stream.timing.num_gaps,
                     stream.timing.longest_gap_s);
    }
    text += "\n";
  }
  for (const CheckedBoard& board : check.boards) {
    text += Format(
        "%-20s board in %zu of %zu images; coverage x %.0f %%, y %.0f %%, size %.0f %%, "
        "skew %.0f %%\n",
        board.camera.c_str(), CameraOf(recording, board).views.size(), board.num_images,
        100.0 * board.coverage.x, 100.0 * board.coverage.y, 100.0 * board.coverage.size,
        100.0 * board.coverage.skew);
  }
  for (const CheckedMotion& motion : check.motions) {
    text += Format(
        "%-20s turns by %.2f, %.2f, %.2f rad/s about x, y, z; forces vary by %.2f, %.2f, "
        "%.2f m/s^2\n",
        motion.imu.c_str(), motion.rates.x(), motion.rates.y(), motion.rates.z(), motion.forces.x(),
        motion.forces.y(), motion.forces.z());
  }
  for (const CheckedClock& clock : check.clocks) {
    text +=
        Format("%-20s ahead of %s by %.2f s (correlation of speeds %.3f)\n", clock.imu.c_str(),
               clock.camera.c_str(), clock.comparison.time_offset_s, clock.comparison.correlation);
  }
  for (const ExpectedSigma& parameter : check.expected) {
    const bool is_judged = !std::isnan(parameter.enough);
    text +=
        Format("%-20s expected sigma %s%s\n", parameter.name.c_str(), SigmaText(parameter).c_str(),
               !is_judged                            ? ""
               : parameter.verdict == Verdict::kPass ? ": enough"
                                                     : (": " + parameter.advice).c_str());
  }
  text += "verdict: " + std::string(VerdictName(VerdictOf(check.findings))) + "\n";
  for (const Finding& finding : check.findings) {
    text += "  - " + finding.what;
    if (!finding.remedy.empty()) text += "; " + finding.remedy;
    text += "\n";
  }
  return text;
}

}  // namespace calibrato
