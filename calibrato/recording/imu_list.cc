#include "calibrato/recording/imu_list.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "calibrato/base/input_error.h"
#include "calibrato/base/nearest_name.h"
#include "calibrato/base/value.h"
#include "calibrato/recording/comma_separated.h"
#include "calibrato/recording/text_lines.h"

namespace calibrato {
namespace {

constexpr size_t kMaxRows = 50'000'000;

// What may stand in a column.
struct Quantity {
  std::vector<std::string_view> names;  // in lower case, without the axis
  std::vector<std::string_view> units;  // without blanks; the first is the one to recommend
};
const Quantity kStamp{{"timestamp", "stamp", "time", "t"}, {"ns"}};
const Quantity kGyro{
    {"w", "w_rs_s", "omega", "g", "gyr", "gyro", "angular_velocity", "field.angular_velocity"},
    {"rad/s", "rads^-1", "rads-1"}};
const Quantity kAccel{{"a", "a_rs_s", "alpha", "f", "acc", "accel", "linear_acceleration",
                       "field.linear_acceleration"},
                      {"m/s^2", "ms^-2", "ms-2", "m/s2"}};

std::string LowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

// A list to be read: its columns in Kalibr's order, the stamp first.
struct Layout {
  std::vector<const Quantity*> sensors;  // each with three columns x, y, z
  bool allows_bare_axes = false;         // "x" for the first sensor's x

  size_t num_columns() const { return 1 + 3 * sensors.size(); }
  // "timestamp", "w_x", ..
  std::string ColumnName(size_t column) const {
    if (column == 0) return std::string(kStamp.names.front());
    const Quantity& sensor = *sensors[(column - 1) / 3];
    return std::string(sensor.names.front()) + '_' + "xyz"[(column - 1) % 3];
  }
  const Quantity& QuantityOf(size_t column) const {
    return column == 0 ? kStamp : *sensors[(column - 1) / 3];
  }
  std::string Header() const {
    std::string header = "#";
    for (size_t i = 0; i < num_columns(); ++i) {
      if (i > 0) header += ',';
      header += ColumnName(i) + " [" + std::string(QuantityOf(i).units.front()) + "]";
    }
    return header;
  }
  // Which column a name means, if any.
  std::optional<size_t> ColumnOf(std::string_view name) const {
    const auto has = [](const Quantity& quantity, std::string_view text) {
      return std::find(quantity.names.begin(), quantity.names.end(), text) != quantity.names.end();
    };
    std::string text = LowerCase(name);
    if (has(kStamp, text)) return 0;
    if (text.empty() || text.back() < 'x' || text.back() > 'z') return std::nullopt;
    const auto axis = static_cast<size_t>(text.back() - 'x');
    text.pop_back();
    if (text.empty() && allows_bare_axes) return 1 + axis;
    if (!text.empty() && (text.back() == '_' || text.back() == '.')) text.pop_back();
    for (size_t i = 0; i < sensors.size(); ++i) {
      if (has(*sensors[i], text)) return 1 + 3 * i + axis;
    }
    return std::nullopt;
  }
};

[[noreturn]] void Fail(const std::string& path, int64_t line, const std::string& why,
                       const std::string& remedy) {
  throw InputError(
      {"malformed list of IMU samples", path + " line " + std::to_string(line), why, remedy});
}

// Where each column of the layout stands in a line.
class Columns {
 public:
  // In Kalibr's order.
  Columns(std::string path, const Layout& layout)
      : path_(std::move(path)), layout_(layout), num_fields_(layout.num_columns()) {
    for (size_t i = 0; i < num_fields_; ++i) position_.push_back(i);
  }

  // By the names in a header, if it names a column of a sensor.
  void Name(int64_t line, std::string_view header) {
    std::vector<std::string_view> fields;
    SplitAtCommas(header, &fields);
    std::vector<std::optional<size_t>> position(layout_.num_columns());
    std::vector<std::string> unknown;
    bool names_a_sensor = false;
    for (size_t i = 0; i < fields.size(); ++i) {
      const size_t bracket = fields[i].find('[');
      const std::string_view name = Trimmed(fields[i].substr(0, bracket));
      const std::optional<size_t> column = layout_.ColumnOf(name);
      if (!column) {
        unknown.emplace_back(name);
        continue;
      }
      if (position[*column]) {
        Fail(path_, line, "the column " + std::string(name) + " stands twice",
             "leave one of them out");
      }
      if (bracket != std::string_view::npos) CheckUnit(line, *column, fields[i].substr(bracket));
      position[*column] = i;
      names_a_sensor |= *column > 0;
    }
    if (!names_a_sensor) return;
    for (size_t column = 0; column < position.size(); ++column) {
      if (position[column]) continue;
      const std::string name = layout_.ColumnName(column);
      const std::optional<std::string> nearest = NearestName(name, unknown);
      Fail(path_, line, "the column " + name + " is missing",
           nearest ? "rename the column '" + *nearest + "'"
                   : "begin with '" + layout_.Header() + "'");
    }
    num_fields_ = fields.size();
    for (size_t column = 0; column < position.size(); ++column) {
      position_[column] = *position[column];
    }
  }

  // @param numbers  One for each column but the stamp.
  Time ParseRow(int64_t line, std::string_view text, std::vector<std::string_view>* fields,
                std::vector<double>* numbers) const {
    SplitAtCommas(text, fields);
    if (fields->size() != num_fields_) {
      Fail(path_, line,
           "expected " + std::to_string(num_fields_) + " fields, found " +
               std::to_string(fields->size()),
           "give '" + layout_.Header() + "', or name more columns in a header");
    }
    numbers->clear();
    for (size_t column = 1; column < position_.size(); ++column) {
      const std::string_view field = (*fields)[position_[column]];
      double number = 0.0;
      const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), number);
      if (error != std::errc() || end != field.data() + field.size()) {
        Fail(path_, line,
             "column " + layout_.ColumnName(column) + ": expected a number, found " + Quoted(field),
             "correct the line or remove it");
      }
      numbers->push_back(number);
    }
    return Stamp(line, (*fields)[position_[0]]);
  }

 private:
  void CheckUnit(int64_t line, size_t column, std::string_view bracketed) const {
    std::string unit(bracketed.substr(1, bracketed.find(']') - 1));
    std::erase_if(unit, [](char c) { return c == ' ' || c == '\t' || c == '*'; });
    const std::vector<std::string_view>& known = layout_.QuantityOf(column).units;
    if (unit.empty() || std::find(known.begin(), known.end(), unit) != known.end()) return;
    const std::string wanted(known.front());
    Fail(path_, line, "the column " + layout_.ColumnName(column) + " is in [" + unit + "]",
         "convert it to [" + wanted + "]");
  }

  Time Stamp(int64_t line, std::string_view field) const {
    int64_t stamp = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), stamp);
    if (error != std::errc() || end != field.data() + field.size() || stamp < 0) {
      Fail(path_, line, "expected a stamp in whole nanoseconds, found " + Quoted(field),
           field.find('.') != std::string_view::npos ? "write seconds times 1e9, without a point"
                                                     : "correct the line or remove it");
    }
    return Time::FromNanoseconds(stamp);
  }

  std::string path_;
  const Layout& layout_;
  size_t num_fields_;
  std::vector<size_t> position_;
};

bool BeginsWithNumber(std::string_view line) {
  int64_t number = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  return error != std::errc::invalid_argument;
}

// One list of samples for each sensor of the layout.
std::vector<std::vector<VectorSample>> ReadList(const std::string& path, const Layout& layout) {
  TextLines lines(path);
  Columns columns(path, layout);
  std::vector<std::vector<VectorSample>> sensors(layout.sensors.size());
  std::vector<std::string_view> fields;
  std::vector<double> numbers;
  bool may_be_header = true;
  while (const std::optional<std::string_view> next = lines.Next()) {
    const std::string_view line =
        Trimmed(lines.line_number() == 1 ? WithoutByteOrderMark(*next) : *next);
    if (line.empty()) continue;
    const bool is_comment = line.starts_with('#');
    if (is_comment || (may_be_header && !BeginsWithNumber(line))) {
      if (may_be_header) columns.Name(lines.line_number(), line.substr(is_comment ? 1 : 0));
      may_be_header &= is_comment;
      continue;
    }
    may_be_header = false;
    if (sensors.front().size() == kMaxRows) {
      throw InputError({"cannot read file", path, "it has more than 50 million rows",
                        "cut the recording into parts"});
    }
    const Time stamp = columns.ParseRow(lines.line_number(), line, &fields, &numbers);
    for (size_t i = 0; i < sensors.size(); ++i) {
      sensors[i].push_back({stamp, Eigen::Vector3d(&numbers[3 * i])});
    }
  }
  if (sensors.front().empty()) {
    throw InputError({"no IMU samples", path, "the file has no rows",
                      "record the IMU again or remove the file"});
  }
  return sensors;
}

std::vector<VectorSample> ReadOneSensor(const std::string& path, const Quantity& sensor) {
  const Layout layout{{&sensor}, true};
  return std::move(ReadList(path, layout).front());
}

// What ReadList takes for it: JSON's "null" is no number.
std::string FieldText(double x) {
  if (std::isnan(x)) return "nan";
  if (std::isinf(x)) return x > 0.0 ? "inf" : "-inf";
  return FormatNumber(x);
}

std::string ListText(const Layout& layout,
                     const std::vector<const std::vector<VectorSample>*>& sensors) {
  std::string text = layout.Header() + "\n";
  const std::vector<VectorSample>& first = *sensors.front();
  for (size_t k = 0; k < first.size(); ++k) {
    text += std::to_string(first[k].stamp.nanoseconds());
    for (const std::vector<VectorSample>* sensor : sensors) {
      assert((*sensor)[k].stamp == first[k].stamp);
      for (const double x : (*sensor)[k].value) text += ',' + FieldText(x);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

ImuStream ReadImuList(const std::string& path) {
  const Layout layout{{&kGyro, &kAccel}};
  std::vector<std::vector<VectorSample>> sensors = ReadList(path, layout);
  return {std::move(sensors[0]), std::move(sensors[1])};
}

std::vector<VectorSample> ReadGyroList(const std::string& path) {
  return ReadOneSensor(path, kGyro);
}

std::vector<VectorSample> ReadAccelList(const std::string& path) {
  return ReadOneSensor(path, kAccel);
}

std::string ImuListText(const ImuStream& stream) {
  assert(stream.gyro.size() == stream.accel.size());
  return ListText({{&kGyro, &kAccel}}, {&stream.gyro, &stream.accel});
}

std::string GyroListText(const std::vector<VectorSample>& samples) {
  return ListText({{&kGyro}}, {&samples});
}

std::string AccelListText(const std::vector<VectorSample>& samples) {
  return ListText({{&kAccel}}, {&samples});
}

}  // namespace calibrato
