#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace calibrato {

/// A tree of plain data: what a YAML or JSON file says, or what a result.json will say. Values that
/// were read remember their file, line and key, and every accessor that fails throws an InputError
/// that names them, so that a typo is found in one look:
///
///     wrong type, board.yaml line 3, key targetCols: expected a whole number, found 'six'; ...
///
/// Reading:
///     const Value board = ReadYaml("board.yaml");
///     const int columns = board.At("targetCols").AsInt(2, 1000);
/// Writing (keys keep the order in which they were set):
///     Value result = Value::Object();
///     result.Set("kind", "camera").Set("num_views", 13);
///     WriteFileAtomically(path, ToJson(result));
class Value {
 public:
  using Members = std::vector<std::pair<std::string, Value>>;
  using Elements = std::vector<Value>;

  Value() = default;  ///< null
  // Implicit, so that Set("kind", "camera") and Set("sigma_m", 0.1) read as they should.
  Value(bool value);              // NOLINT(google-explicit-constructor)
  Value(int value);               // NOLINT(google-explicit-constructor)
  Value(int64_t value);           // NOLINT(google-explicit-constructor)
  Value(size_t value);            // NOLINT(google-explicit-constructor)
  Value(double value);            // NOLINT(google-explicit-constructor)
  Value(const char* value);       // NOLINT(google-explicit-constructor)
  Value(std::string value);       // NOLINT(google-explicit-constructor)
  Value(std::string_view value);  // NOLINT(google-explicit-constructor)
  static Value Object();
  static Value Array();
  /// An array of numbers, from anything with begin() and end() over doubles (std::vector, Eigen
  /// vector).
  template <typename Range>
  static Value Numbers(const Range& range) {
    Value array = Array();
    for (const double x : range) array.Append(x);
    return array;
  }

  bool IsNull() const;
  bool IsObject() const;
  bool IsArray() const;

  // Objects --------------------------------------------------------------------------------------
  /// The member of that name. @throws InputError "missing key ..." if there is none.
  const Value& At(std::string_view key) const;
  /// nullptr if there is none (or it is null).
  const Value* Find(std::string_view key) const;
  /// Adds or replaces a member; returns *this for chaining. A null value becomes an object.
  Value& Set(std::string_view key, Value value);
  const Members& members() const;  ///< @throws InputError unless an object
  /// One warning for each member whose key is not among the known ones, each with file, line and
  /// the nearest known key: "unknown key targetcols, board.yaml line 3; did you mean targetCols?".
  std::vector<std::string> UnknownKeys(const std::vector<std::string>& known) const;

  // Arrays ---------------------------------------------------------------------------------------
  const Elements& elements() const;  ///< @throws InputError unless an array
  Value& Append(Value value);
  size_t size() const;  ///< Number of elements or members; 0 for scalars.

  // Scalars --------------------------------------------------------------------------------------
  // Each throws an InputError that names file, line, key, what was expected and what was found.
  bool AsBool() const;
  int64_t AsInt() const;
  int64_t AsInt(int64_t low, int64_t high) const;  ///< low <= value <= high
  double AsDouble() const;                         ///< Finite; whole numbers are taken as well.
  double AsPositive() const;                       ///< Finite and > 0.
  double AsNonNegative() const;                    ///< Finite and >= 0.
  std::string AsString() const;
  /// An array of exactly `size` finite numbers (any number of them if size is 0). Nested arrays,
  /// such as a 4x4 matrix written as four rows, are flattened row by row.
  std::vector<double> AsDoubles(size_t size = 0) const;

  /// "board.yaml line 3, key cam0.intrinsics", or "" for values that were not read from a file.
  std::string Where() const;
  /// An InputError about this value, for checks of meaning that the accessors can't make.
  [[noreturn]] void Fail(const std::string& what, const std::string& why,
                         const std::string& remedy) const;

 private:
  friend class ValueReader;
  struct Scalar {  ///< Unquoted YAML text; its type is decided by the accessor that asks for it.
    std::string text;
  };
  struct Source {
    std::shared_ptr<const std::string> file;
    int line = 0;  ///< First line is 1; 0 if not read from a file.
    std::string key;
  };
  friend class JsonWriter;
  friend class YamlWriter;
  [[noreturn]] void FailType(const std::string& expected, const std::string& remedy) const;
  std::string Found() const;

  std::variant<std::monostate, bool, int64_t, double, std::string, Scalar, Elements, Members> data_;
  Source source_;
};

/// @throws InputError if the file is missing, unreadable, larger than 64 MB, or not YAML (with line
/// and column); a key that stands twice in one mapping is an error as well, and so are more than
/// one document, merge keys (<<), more than 100 levels or a million values (aliases expanded).
Value ReadYaml(const std::string& path);
/// @param name  Stands for the file in errors.
Value ParseYaml(const std::string& text, const std::string& name);
/// Strict JSON. @throws InputError likewise.
Value ReadJson(const std::string& path);
Value ParseJson(const std::string& text, const std::string& name);

/// Indented by two, arrays of scalars on one line; numbers are the shortest that read back to the
/// same bits; NaN and infinities are written as null. Ends with a newline.
std::string ToJson(const Value& value);
/// The same on a single line, without a newline: for .jsonl files.
std::string ToJsonLine(const Value& value);
/// Block style with arrays of scalars in flow style, as Kalibr writes its files. Doubles always
/// carry a point (Kalibr refuses whole numbers where it wants floats, and its reader takes 1e-05
/// for text); NaN and infinities are written as null. Text is quoted where it would read back as
/// something else.
std::string ToYaml(const Value& value);

/// The shortest decimal that reads back to the same double, as JSON writes it; "null" unless
/// finite.
std::string FormatNumber(double value);

}  // namespace calibrato
