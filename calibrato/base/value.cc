#include "calibrato/base/value.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "calibrato/base/input_error.h"
#include "calibrato/base/nearest_name.h"
#include "calibrato/base/required_keys.h"
#include "calibrato/base/scalar_text.h"

namespace calibrato {
namespace {

std::string Count(size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace

Value::Value(bool value) : data_(value) {}
Value::Value(int value) : data_(int64_t{value}) {}
Value::Value(int64_t value) : data_(value) {}
Value::Value(size_t value) : data_(static_cast<int64_t>(value)) {
  assert(value <= static_cast<size_t>(std::numeric_limits<int64_t>::max()));
}
Value::Value(double value) : data_(value) {}
Value::Value(const char* value) : data_(std::string(value)) {}
Value::Value(std::string value) : data_(std::move(value)) {}
Value::Value(std::string_view value) : data_(std::string(value)) {}

Value Value::Object() {
  Value value;
  value.data_ = Members();
  return value;
}

Value Value::Array() {
  Value value;
  value.data_ = Elements();
  return value;
}

bool Value::IsNull() const { return std::holds_alternative<std::monostate>(data_); }
bool Value::IsObject() const { return std::holds_alternative<Members>(data_); }
bool Value::IsArray() const { return std::holds_alternative<Elements>(data_); }

const Value& Value::At(std::string_view key) const {
  static const Members kNoMembers;
  const Members& all = IsNull() ? kNoMembers : members();
  for (const auto& [name, value] : all) {
    if (name == key) return value;
  }
  FailMissingKey(*this, std::string(key), KeysOf(*this));
}

const Value* Value::Find(std::string_view key) const {
  if (IsNull()) return nullptr;
  for (const auto& [name, value] : members()) {
    if (name == key) return value.IsNull() ? nullptr : &value;
  }
  return nullptr;
}

Value& Value::Set(std::string_view key, Value value) {
  if (IsNull()) data_ = Members();
  assert(IsObject());
  auto& members = std::get<Members>(data_);
  for (auto& [name, old] : members) {
    if (name == key) {
      old = std::move(value);
      return *this;
    }
  }
  members.emplace_back(std::string(key), std::move(value));
  return *this;
}

const Value::Members& Value::members() const {
  if (!IsObject()) FailType("keys with values", "write it as 'key: value' lines or {key: value}");
  return std::get<Members>(data_);
}

std::vector<std::string> Value::UnknownKeys(const std::vector<std::string>& known) const {
  std::vector<std::string> warnings;
  if (IsNull()) return warnings;
  for (const auto& [name, value] : members()) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string warning = "unknown key " + name;
    if (value.source_.file) {
      warning = "unknown key " + value.source_.key + ", " + *value.source_.file + " line " +
                std::to_string(value.source_.line);
    }
    const std::optional<std::string> nearest = NearestName(name, known);
    warnings.push_back(warning + (nearest ? "; did you mean " + *nearest + "?" : "; ignored"));
  }
  return warnings;
}

const Value::Elements& Value::elements() const {
  if (!IsArray()) FailType("an array", "write it in brackets, as in [1, 2, 3]");
  return std::get<Elements>(data_);
}

Value& Value::Append(Value value) {
  if (IsNull()) data_ = Elements();
  assert(IsArray());
  std::get<Elements>(data_).push_back(std::move(value));
  return *this;
}

size_t Value::size() const {
  if (const auto* elements = std::get_if<Elements>(&data_)) return elements->size();
  if (const auto* members = std::get_if<Members>(&data_)) return members->size();
  return 0;
}

bool Value::AsBool() const {
  if (const auto* value = std::get_if<bool>(&data_)) return *value;
  if (const auto* scalar = std::get_if<Scalar>(&data_)) {
    if (scalar->text == "true") return true;
    if (scalar->text == "false") return false;
  }
  FailType("true or false", "write true or false, in lower case and without quotes");
}

int64_t Value::AsInt() const {
  if (const auto* value = std::get_if<int64_t>(&data_)) return *value;
  if (const auto* scalar = std::get_if<Scalar>(&data_)) {
    if (const auto number = ParseWholeNumber(scalar->text)) return *number;
  }
  FailType("a whole number", "write digits only, as in 6, without quotes, point or unit");
}

int64_t Value::AsInt(int64_t low, int64_t high) const {
  const int64_t value = AsInt();
  if (value < low || value > high) {
    Fail("value out of range",
         "expected a whole number from " + std::to_string(low) + " to " + std::to_string(high) +
             ", found " + std::to_string(value),
         "choose one within these limits");
  }
  return value;
}

double Value::AsDouble() const {
  if (const auto* value = std::get_if<int64_t>(&data_)) return static_cast<double>(*value);
  if (const auto* value = std::get_if<double>(&data_)) {
    if (std::abs(*value) <= std::numeric_limits<double>::max()) return *value;
  }
  if (const auto* scalar = std::get_if<Scalar>(&data_)) {
    if (const auto number = ParseDecimal(scalar->text)) return *number;
  }
  FailType("a finite number", "write it as in 0.06 or 1e-3, without quotes or unit");
}

double Value::AsPositive() const {
  const double value = AsDouble();
  if (!(value > 0.0)) {
    Fail("value out of range", "expected a number above 0, found " + FormatNumber(value),
         "choose one above 0");
  }
  return value;
}

double Value::AsNonNegative() const {
  const double value = AsDouble();
  if (!(value >= 0.0)) {
    Fail("value out of range", "expected 0 or a number above, found " + FormatNumber(value),
         "choose one that is not negative");
  }
  return value;
}

std::string Value::AsString() const {
  if (const auto* value = std::get_if<std::string>(&data_)) return *value;
  if (const auto* scalar = std::get_if<Scalar>(&data_)) return scalar->text;
  FailType("text", "write it in quotes, as in \"text\"");
}

std::vector<double> Value::AsDoubles(size_t size) const {
  const std::string expected =
      size == 0 ? "an array of numbers" : "an array of " + Count(size, "number");
  const std::string remedy = "write it in brackets, as in [0.1, 0.2]";
  if (!IsArray()) FailType(expected, remedy);
  std::vector<double> numbers;
  const Elements& rows = elements();
  for (const Value& row : rows) {
    if (row.IsArray() != rows.front().IsArray()) {
      row.Fail("wrong shape", "numbers and arrays stand side by side",
               "write all rows in brackets, as in [[1, 2], [3, 4]]");
    }
    if (!row.IsArray()) {
      numbers.push_back(row.AsDouble());
      continue;
    }
    if (row.size() != rows.front().size()) {
      row.Fail("wrong shape",
               "expected a row of " + std::to_string(rows.front().size()) +
                   " as the first, found " + std::to_string(row.size()),
               "give all rows the same length");
    }
    const std::vector<double> inner = row.AsDoubles();
    numbers.insert(numbers.end(), inner.begin(), inner.end());
  }
  if (size != 0 && numbers.size() != size) {
    Fail("wrong size", "expected " + expected + ", found " + std::to_string(numbers.size()),
         "write exactly " + std::to_string(size));
  }
  return numbers;
}

std::string Value::Where() const {
  if (!source_.file) return "";
  std::string where = *source_.file + " line " + std::to_string(source_.line);
  if (!source_.key.empty()) where += ", key " + source_.key;
  return where;
}

void Value::Fail(const std::string& what, const std::string& why, const std::string& remedy) const {
  throw InputError({what, Where(), why, remedy});
}

void Value::FailType(const std::string& expected, const std::string& remedy) const {
  Fail("wrong type", "expected " + expected + ", found " + Found(), remedy);
}

std::string Value::Found() const {
  struct Describe {
    const Value& described;
    std::string operator()(std::monostate) const { return "nothing"; }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(int64_t value) const { return std::to_string(value); }
    std::string operator()(double value) const {
      if (value != value) return "not a number";
      if (std::abs(value) > std::numeric_limits<double>::max()) return "infinity";
      return FormatNumber(value);
    }
    std::string operator()(const std::string& value) const {
      return std::string("the text \"").append(ShortenText(value)).append("\"");
    }
    std::string operator()(const Scalar& value) const {
      return std::string("'").append(ShortenText(value.text)).append("'");
    }
    std::string operator()(const Elements& value) const {
      return "an array of " + Count(value.size(), "element");
    }
    std::string operator()(const Members& value) const {
      return value.empty() ? "an empty mapping" : "a mapping with " + KeysInWords(described);
    }
  };
  return std::visit(Describe{*this}, data_);
}

}  // namespace calibrato
