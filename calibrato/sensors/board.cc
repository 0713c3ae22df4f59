#include "calibrato/sensors/board.h"

#include "calibrato/base/input_error.h"

namespace calibrato {

Eigen::Matrix3Xd BoardPoints(const Board& board) {
  const auto& checkerboard = std::get<Checkerboard>(board);
  Eigen::Matrix3Xd points(3, checkerboard.rows * checkerboard.columns);
  for (int row = 0; row < checkerboard.rows; ++row) {
    for (int column = 0; column < checkerboard.columns; ++column) {
      points.col(row * checkerboard.columns + column) << row * checkerboard.row_spacing_m,
          column * checkerboard.column_spacing_m, 0.0;
    }
  }
  return points;
}

Eigen::Vector3d BoardCentre(const Board& board) {
  const Eigen::Matrix3Xd points = BoardPoints(board);
  return 0.5 * (points.rowwise().minCoeff() + points.rowwise().maxCoeff());
}

std::string Describe(const Board& board) {
  const auto& checkerboard = std::get<Checkerboard>(board);
  return "checkerboard of " + std::to_string(checkerboard.rows) + " rows x " +
         std::to_string(checkerboard.columns) + " columns of inner corners, squares of " +
         FormatNumber(1e3 * checkerboard.row_spacing_m) + " x " +
         FormatNumber(1e3 * checkerboard.column_spacing_m) + " mm";
}

Board BoardFromValue(const Value& value, std::vector<std::string>* warnings) {
  const Value& type = value.At("target_type");
  if (type.AsString() != "checkerboard") {
    type.Fail("unknown board", "'" + type.AsString() + "' is not a board that calibrato can find",
              "use target_type: 'checkerboard'");
  }
  if (warnings != nullptr) {
    const std::vector<std::string> unknown =
        value.UnknownKeys({"target_type", "targetCols", "targetRows", "rowSpacingMeters",
                           "colSpacingMeters", "T_w_g"});
    warnings->insert(warnings->end(), unknown.begin(), unknown.end());
  }
  Checkerboard board;
  board.rows = static_cast<int>(value.At("targetRows").AsInt(2, 1000));
  board.columns = static_cast<int>(value.At("targetCols").AsInt(2, 1000));
  board.row_spacing_m = value.At("rowSpacingMeters").AsPositive();
  board.column_spacing_m = value.At("colSpacingMeters").AsPositive();
  return board;
}

Value ToValue(const Board& board) {
  const auto& checkerboard = std::get<Checkerboard>(board);
  Value value = Value::Object();
  value.Set("target_type", "checkerboard")
      .Set("targetCols", checkerboard.columns)
      .Set("targetRows", checkerboard.rows)
      .Set("rowSpacingMeters", checkerboard.row_spacing_m)
      .Set("colSpacingMeters", checkerboard.column_spacing_m);
  return value;
}

}  // namespace calibrato
