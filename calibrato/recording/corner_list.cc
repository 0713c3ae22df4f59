#include "calibrato/recording/corner_list.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <tuple>

#include "calibrato/base/input_error.h"
#include "calibrato/base/nearest_name.h"
#include "calibrato/base/value.h"
#include "calibrato/recording/comma_separated.h"
#include "calibrato/recording/text_lines.h"

namespace calibrato {
namespace {

constexpr size_t kMaxRows = 50'000'000;
constexpr int kCornersPerTag = 4;
constexpr int kMaxTagId = 10'000'000;

enum Column { kStamp, kTagId, kTagCorner, kU, kV, kX, kY, kZ, kNumColumns };
constexpr std::array<std::string_view, kNumColumns> kColumnNames = {
    "timestamp", "tag_id", "tag_corner", "u", "v", "x", "y", "z"};
constexpr std::array<std::string_view, kNumColumns> kColumnUnits = {"ns", "",  "",  "px",
                                                                    "px", "m", "m", "m"};

struct Row {
  int64_t stamp = 0;
  int tag_id = 0;
  int tag_corner = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Vector3d point_g = Eigen::Vector3d::Zero();
  int64_t line = 0;
};

// Where each known column stands in a line.
class Header {
 public:
  Header(const std::string& path, int64_t line, std::string_view text) : path_(path) {
    position_.fill(-1);
    std::vector<std::string_view> fields;
    SplitAtCommas(text, &fields);
    num_fields_ = fields.size();
    for (size_t i = 0; i < fields.size(); ++i) {
      const size_t bracket = fields[i].find('[');
      names_.emplace_back(Trimmed(fields[i].substr(0, bracket)));
      const auto* name = std::find(kColumnNames.begin(), kColumnNames.end(), names_.back());
      if (name == kColumnNames.end()) continue;
      const auto column = static_cast<size_t>(name - kColumnNames.begin());
      if (position_[column] >= 0) {
        Fail(line, names_.back(), "the column stands twice", "leave one of them out");
      }
      CheckUnit(line, column, fields[i], bracket);
      position_[column] = static_cast<int>(i);
    }
    for (const Column column : {kStamp, kTagId, kU, kV}) Require(line, column);
    if (Has(kX) || Has(kY) || Has(kZ)) {
      for (const Column column : {kX, kY, kZ}) Require(line, column);
    }
  }

  bool Has(Column column) const { return position_[column] >= 0; }
  bool has_points() const { return Has(kX); }

  Row ParseRow(int64_t line, std::string_view text, std::vector<std::string_view>* fields) const {
    SplitAtCommas(text, fields);
    if (fields->size() != num_fields_) {
      throw InputError({"malformed corner list", Where(line),
                        "expected " + std::to_string(num_fields_) + " fields, found " +
                            std::to_string(fields->size()),
                        "give one field for each column of the header"});
    }
    Row row;
    row.line = line;
    row.stamp = Whole<int64_t>(line, *fields, kStamp, std::numeric_limits<int64_t>::max());
    row.tag_id = Whole<int>(line, *fields, kTagId, kMaxTagId);
    if (Has(kTagCorner)) {
      row.tag_corner = Whole<int>(line, *fields, kTagCorner, kCornersPerTag - 1);
    }
    // Not by Eigen's <<, which must not be interrupted by an exception.
    row.pixel = {Number(line, *fields, kU), Number(line, *fields, kV)};
    if (has_points()) {
      row.point_g = {Number(line, *fields, kX), Number(line, *fields, kY),
                     Number(line, *fields, kZ)};
    }
    return row;
  }

  std::string Where(int64_t line) const { return path_ + " line " + std::to_string(line); }

 private:
  [[noreturn]] void Fail(int64_t line, std::string_view column, const std::string& why,
                         const std::string& remedy) const {
    throw InputError(
        {"malformed corner list", Where(line) + ", column " + std::string(column), why, remedy});
  }

  void Require(int64_t line, Column column) const {
    if (Has(column)) return;
    const std::string name(kColumnNames[column]);
    const std::optional<std::string> nearest = NearestName(name, names_);
    Fail(line, name, "the column is missing",
         nearest
             ? "rename the column '" + *nearest + "'"
             : "begin with '#timestamp [ns],tag_id,tag_corner,u [px],v [px],x [m],y [m],z [m]'");
  }

  void CheckUnit(int64_t line, size_t column, std::string_view field, size_t bracket) const {
    if (bracket == std::string_view::npos) return;
    const std::string_view expected = kColumnUnits[column];
    const std::string_view unit = Trimmed(field.substr(bracket + 1, field.find(']') - bracket - 1));
    const bool is_pixel = expected == "px" && (unit == "pixel" || unit == "pixels");
    if (unit.empty() || expected.empty() || unit == expected || is_pixel) return;
    Fail(line, kColumnNames[column], "it is in [" + std::string(unit) + "]",
         "convert it to [" + std::string(expected) + "]");
  }

  template <typename T>
  T Whole(int64_t line, const std::vector<std::string_view>& fields, Column column, T high) const {
    const std::string_view field = fields[static_cast<size_t>(position_[column])];
    T value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size() || value < 0 || value > high) {
      Fail(line, kColumnNames[column],
           "expected a whole number from 0 to " + std::to_string(high) + ", found " + Quoted(field),
           "correct the line");
    }
    return value;
  }

  double Number(int64_t line, const std::vector<std::string_view>& fields, Column column) const {
    const std::string_view field = fields[static_cast<size_t>(position_[column])];
    double value = 0.0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value)) {
      Fail(line, kColumnNames[column], "expected a finite number, found " + Quoted(field),
           "correct the line");
    }
    return value;
  }

  std::string path_;
  size_t num_fields_ = 0;
  std::vector<std::string> names_;
  std::array<int, kNumColumns> position_{};
};

// The columns, if this line names them: the first line that is no comment, or a comment that has
// the names of two columns between commas.
std::optional<std::string_view> ColumnNames(std::string_view line) {
  if (!line.starts_with('#')) return line;
  line.remove_prefix(1);
  std::vector<std::string_view> fields;
  SplitAtCommas(line, &fields);
  const auto num_known = std::count_if(fields.begin(), fields.end(), [](std::string_view field) {
    const std::string_view name = Trimmed(field.substr(0, field.find('[')));
    return std::find(kColumnNames.begin(), kColumnNames.end(), name) != kColumnNames.end();
  });
  return num_known >= 2 ? std::optional(line) : std::nullopt;
}

struct Table {
  Header header;
  std::vector<Row> rows;
};

Table ReadTable(const std::string& path) {
  TextLines lines(path);
  std::optional<Table> table;
  std::vector<std::string_view> fields;
  while (const std::optional<std::string_view> next = lines.Next()) {
    const std::string_view line =
        Trimmed(lines.line_number() == 1 ? WithoutByteOrderMark(*next) : *next);
    if (line.empty()) continue;
    if (!table) {
      if (const std::optional<std::string_view> names = ColumnNames(line)) {
        table.emplace(Table{Header(path, lines.line_number(), *names), {}});
      }
    } else if (!line.starts_with('#')) {
      if (table->rows.size() == kMaxRows) {
        throw InputError({"cannot read file", path, "it has more than 50 million rows",
                          "cut the recording into parts"});
      }
      table->rows.push_back(table->header.ParseRow(lines.line_number(), line, &fields));
    }
  }
  if (!table || table->rows.empty()) {
    throw InputError({"no corners", path, table ? "it has no rows" : "the file is empty",
                      "record the board again or leave this camera out"});
  }
  return *std::move(table);
}

int CornerId(const Row& row, bool uses_tag_corner) {
  return uses_tag_corner ? row.tag_id * kCornersPerTag + row.tag_corner : row.tag_id;
}

// Fills in the points of the board, or holds the file's against them.
void ApplyBoard(const Eigen::Matrix3Xd& board_points_g, bool uses_tag_corner, Table* table) {
  constexpr double kMaxShareOfExtent = 0.01;
  const double extent =
      (board_points_g.rowwise().maxCoeff() - board_points_g.rowwise().minCoeff()).norm();
  for (Row& row : table->rows) {
    const int id = CornerId(row, uses_tag_corner);
    if (id >= board_points_g.cols()) {
      throw InputError({"corner outside the board", table->header.Where(row.line),
                        "its number is " + std::to_string(id) + ", the board has " +
                            std::to_string(board_points_g.cols()) + " corners",
                        "check --target"});
    }
    const Eigen::Vector3d expected_g = board_points_g.col(id);
    if (!table->header.has_points()) {
      row.point_g = expected_g;
    } else if (!((row.point_g - expected_g).norm() <= kMaxShareOfExtent * extent)) {
      const auto text = [](const Eigen::Vector3d& p) {
        return "(" + FormatNumber(p.x()) + ", " + FormatNumber(p.y()) + ", " + FormatNumber(p.z()) +
               ") m";
      };
      throw InputError({"corner list and board disagree", table->header.Where(row.line),
                        "corner " + std::to_string(id) + " is at " + text(row.point_g) +
                            " in the list and at " + text(expected_g) + " on the board",
                        "check --target or leave it out"});
    }
  }
}

BoardView View(const Header& header, bool uses_tag_corner, const Row* begin, const Row* end) {
  BoardView view;
  view.stamp = Time::FromNanoseconds(begin->stamp);
  view.name = std::to_string(begin->stamp);
  const auto count = end - begin;
  view.corner_ids.reserve(static_cast<size_t>(count));
  view.pixels.resize(2, count);
  view.points_g.resize(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const int id = CornerId(begin[k], uses_tag_corner);
    if (k > 0 && id == view.corner_ids.back()) {
      throw InputError({"malformed corner list", header.Where(begin[k].line),
                        "corner " + std::to_string(id) + " stands twice in the view at " +
                            view.name + ", first in line " + std::to_string(begin[k - 1].line),
                        "remove one of the two lines"});
    }
    view.corner_ids.push_back(id);
    view.pixels.col(k) = begin[k].pixel;
    view.points_g.col(k) = begin[k].point_g;
  }
  return view;
}

}  // namespace

std::vector<BoardView> ReadCornerList(const std::string& path,
                                      const std::optional<Eigen::Matrix3Xd>& board_points_g) {
  Table table = ReadTable(path);
  const bool uses_tag_corner = std::any_of(table.rows.begin(), table.rows.end(),
                                           [](const Row& row) { return row.tag_corner != 0; });
  if (board_points_g) {
    ApplyBoard(*board_points_g, uses_tag_corner, &table);
  } else if (!table.header.has_points()) {
    throw InputError({"unknown board", path, "the list has no columns x, y and z",
                      "give the board with --target"});
  }
  const auto order = [](const Row& row) {
    return std::tuple(row.stamp, row.tag_id, row.tag_corner, row.line);
  };
  const auto before = [&](const Row& a, const Row& b) { return order(a) < order(b); };
  if (!std::is_sorted(table.rows.begin(), table.rows.end(), before)) {
    std::sort(table.rows.begin(), table.rows.end(), before);
  }
  std::vector<BoardView> views;
  const Row* const end = table.rows.data() + table.rows.size();
  for (const Row* begin = table.rows.data(); begin != end;) {
    const Row* const next = std::find_if(
        begin, end, [stamp = begin->stamp](const Row& row) { return row.stamp != stamp; });
    views.push_back(View(table.header, uses_tag_corner, begin, next));
    begin = next;
  }
  return views;
}

std::string CornerListText(const std::vector<BoardView>& views, int corners_per_tag) {
  assert(corners_per_tag == 1 || corners_per_tag == kCornersPerTag);
  std::string text = "#timestamp [ns],tag_id,tag_corner,u [px],v [px],x [m],y [m],z [m]\n";
  for (const BoardView& view : views) {
    const std::string stamp = std::to_string(view.stamp.nanoseconds());
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      const int id = view.corner_ids[static_cast<size_t>(k)];
      text += stamp + ',' + std::to_string(id / corners_per_tag) + ',' +
              std::to_string(id % corners_per_tag);
      for (const double number : {view.pixels(0, k), view.pixels(1, k), view.points_g(0, k),
                                  view.points_g(1, k), view.points_g(2, k)}) {
        text += ',';
        text += FormatNumber(number);
      }
      text += '\n';
    }
  }
  return text;
}

}  // namespace calibrato
