// Boards as in Kalibr's target YAML.

#include <algorithm>
#include <iterator>

#include "calibrato/base/nearest_name.h"
#include "calibrato/base/required_keys.h"
#include "calibrato/sensors/board.h"

namespace calibrato {
namespace {

constexpr int kMaxSide = 1000;

// T_w_g stands beside the board's keys in RIG.yaml.
void WarnOfUnknownKeys(const Value& value, std::vector<std::string> known,
                       std::vector<std::string>* warnings) {
  if (warnings == nullptr) return;
  known.insert(known.end(), {"target_type", "T_w_g"});
  const std::vector<std::string> unknown = value.UnknownKeys(known);
  warnings->insert(warnings->end(), unknown.begin(), unknown.end());
}

int Side(const Value& value, const char* key, int smallest) {
  return static_cast<int>(value.At(key).AsInt(smallest, kMaxSide));
}

// Far beyond every board there is, and far from where a double overflows.
double InRange(const Value& value, const char* key) {
  constexpr double kLeast = 1e-6;
  constexpr double kMost = 1e3;
  const double number = value.At(key).AsDouble();
  if (number >= kLeast && number <= kMost) return number;
  value.At(key).Fail("value out of range",
                     "expected a number from 1e-6 to 1000, found " + FormatNumber(number),
                     "lengths are in metres, gaps between tags in sides of a tag");
}

Board ReadCheckerboard(const Value& value, std::vector<std::string>* warnings) {
  WarnOfUnknownKeys(value, {"targetCols", "targetRows", "rowSpacingMeters", "colSpacingMeters"},
                    warnings);
  RequireKeys(value, {"targetCols", "targetRows", "rowSpacingMeters", "colSpacingMeters"});
  Checkerboard board;
  board.rows = Side(value, "targetRows", 2);
  board.columns = Side(value, "targetCols", 2);
  board.row_spacing_m = InRange(value, "rowSpacingMeters");
  board.column_spacing_m = InRange(value, "colSpacingMeters");
  return board;
}

Board ReadAprilGrid(const Value& value, std::vector<std::string>* warnings) {
  WarnOfUnknownKeys(value, {"tagCols", "tagRows", "tagSize", "tagSpacing"}, warnings);
  RequireKeys(value, {"tagCols", "tagRows", "tagSize", "tagSpacing"});
  AprilGrid board;
  board.rows = Side(value, "tagRows", 1);
  board.columns = Side(value, "tagCols", 1);
  if (board.rows * board.columns > kNumAprilTags) {
    value.At("tagCols").Fail("too many tags",
                             std::to_string(board.rows) + " x " + std::to_string(board.columns) +
                                 " are more than the " + std::to_string(kNumAprilTags) +
                                 " of the family 36h11",
                             "use fewer tagRows or tagCols");
  }
  board.tag_size_m = InRange(value, "tagSize");
  board.tag_spacing = InRange(value, "tagSpacing");
  return board;
}

Board ReadCircleGrid(const Value& value, std::vector<std::string>* warnings) {
  WarnOfUnknownKeys(value, {"targetCols", "targetRows", "spacingMeters", "asymmetricGrid"},
                    warnings);
  RequireKeys(value, {"targetCols", "targetRows", "spacingMeters"});
  CircleGrid board;
  board.rows = Side(value, "targetRows", 2);
  board.columns = Side(value, "targetCols", 2);
  board.spacing_m = InRange(value, "spacingMeters");
  if (const Value* asymmetric = value.Find("asymmetricGrid")) {
    board.asymmetric = asymmetric->AsBool();
  }
  return board;
}

const MarkerDictionary& ReadDictionary(const Value& value) {
  const std::string name = value.AsString();
  const auto* found =
      std::find_if(std::begin(kMarkerDictionaries), std::end(kMarkerDictionaries),
                   [&](const MarkerDictionary& dictionary) { return dictionary.name == name; });
  if (found != std::end(kMarkerDictionaries)) return *found;
  std::vector<std::string> names;
  for (const MarkerDictionary& dictionary : kMarkerDictionaries) {
    names.emplace_back(dictionary.name);
  }
  const auto nearest = NearestName(name, names);
  value.Fail("unknown dictionary", "OpenCV has no '" + name + "'",
             nearest ? "did you mean " + *nearest + "?"
                     : "use one of OpenCV's, such as " + std::string(names[5]));
}

Board ReadCharuco(const Value& value, std::vector<std::string>* warnings) {
  WarnOfUnknownKeys(
      value, {"targetCols", "targetRows", "squareSizeMeters", "markerSizeMeters", "dictionary"},
      warnings);
  RequireKeys(value,
              {"targetCols", "targetRows", "squareSizeMeters", "markerSizeMeters", "dictionary"});
  Charuco board;
  board.rows = Side(value, "targetRows", 3);
  board.columns = Side(value, "targetCols", 3);
  board.square_size_m = InRange(value, "squareSizeMeters");
  board.marker_size_m = InRange(value, "markerSizeMeters");
  if (!(board.marker_size_m < board.square_size_m)) {
    value.At("markerSizeMeters")
        .Fail("marker too large", "it must fit into a square of squareSizeMeters",
              "use about 0.75 of squareSizeMeters");
  }
  const MarkerDictionary& dictionary = ReadDictionary(value.At("dictionary"));
  const int num_markers = board.rows * board.columns / 2;
  if (num_markers > dictionary.num_markers) {
    value.At("dictionary")
        .Fail("dictionary too small",
              "the board has " + std::to_string(num_markers) + " markers, " +
                  std::string(dictionary.name) + " only " + std::to_string(dictionary.num_markers),
              "use a larger one of the same kind");
  }
  board.dictionary = dictionary.name;
  return board;
}

Value Written(const Checkerboard& board) {
  Value value = Value::Object();
  value.Set("target_type", "checkerboard")
      .Set("targetCols", board.columns)
      .Set("targetRows", board.rows)
      .Set("rowSpacingMeters", board.row_spacing_m)
      .Set("colSpacingMeters", board.column_spacing_m);
  return value;
}

Value Written(const AprilGrid& board) {
  Value value = Value::Object();
  value.Set("target_type", "aprilgrid")
      .Set("tagCols", board.columns)
      .Set("tagRows", board.rows)
      .Set("tagSize", board.tag_size_m)
      .Set("tagSpacing", board.tag_spacing);
  return value;
}

Value Written(const CircleGrid& board) {
  Value value = Value::Object();
  value.Set("target_type", "circlegrid")
      .Set("targetCols", board.columns)
      .Set("targetRows", board.rows)
      .Set("spacingMeters", board.spacing_m)
      .Set("asymmetricGrid", board.asymmetric);
  return value;
}

Value Written(const Charuco& board) {
  Value value = Value::Object();
  value.Set("target_type", "charuco")
      .Set("targetCols", board.columns)
      .Set("targetRows", board.rows)
      .Set("squareSizeMeters", board.square_size_m)
      .Set("markerSizeMeters", board.marker_size_m)
      .Set("dictionary", board.dictionary);
  return value;
}

}  // namespace

Board BoardFromValue(const Value& value, std::vector<std::string>* warnings) {
  struct Kind {
    const char* name;
    Board (*read)(const Value&, std::vector<std::string>*);
  };
  constexpr Kind kKinds[] = {{"checkerboard", ReadCheckerboard},
                             {"aprilgrid", ReadAprilGrid},
                             {"circlegrid", ReadCircleGrid},
                             {"charuco", ReadCharuco}};
  const Value& type = value.At("target_type");
  for (const Kind& kind : kKinds) {
    if (type.AsString() == kind.name) return kind.read(value, warnings);
  }
  type.Fail("unknown board", "'" + type.AsString() + "' is not a board that calibrato can find",
            "use target_type: 'checkerboard', 'aprilgrid', 'circlegrid' or 'charuco'");
}

Value ToValue(const Board& board) {
  return std::visit([](const auto& which) { return Written(which); }, board);
}

}  // namespace calibrato
