#include "calibrato/base/value_reader.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {

ValueReader::ValueReader(const std::string& name) : file_(std::make_shared<std::string>(name)) {
  root_.source_ = {file_, 1, ""};
}

void ValueReader::BeginObject(int line) { Begin(Value::Object(), line); }
void ValueReader::BeginArray(int line) { Begin(Value::Array(), line); }

void ValueReader::Begin(Value value, int line) {
  CheckDepth(levels_.size() + 1, line);
  SetSource(value, line);
  Level level;
  level.value = std::move(value);
  levels_.push_back(std::move(level));
}

const Value& ValueReader::End() {
  assert(!levels_.empty());
  Value value = std::move(levels_.back().value);
  levels_.pop_back();
  return Place(std::move(value));
}

void ValueReader::AddKey(const std::string& key, int line) {
  assert(WantsKey());
  Level& level = levels_.back();
  if (!level.keys.insert(key).second) {
    Fail("duplicate key " + key, line, 0, "it stands earlier in the same mapping",
         "remove one of the two");
  }
  level.key = key;
  level.key_line = line;
}

const Value& ValueReader::AddScalar(Value value, int line) {
  SetSource(value, line);
  return Place(std::move(value));
}

const Value& ValueReader::AddPlainText(const std::string& text, int line) {
  Value value;
  value.data_ = Value::Scalar{text};
  return AddScalar(std::move(value), line);
}

void ValueReader::AddCopy(const Value& value, int line) {
  const Extent extent = Measure(value);
  CheckDepth(levels_.size() + extent.depth, line);
  Count(extent.values, extent.text_bytes, line);
  Place(value);
}

void ValueReader::CountCopy(const Value& value) {
  const Extent extent = Measure(value);
  Count(extent.values, extent.text_bytes, value.source_.line);
}

bool ValueReader::WantsKey() const {
  return !levels_.empty() && levels_.back().value.IsObject() && levels_.back().key_line == 0;
}

Value ValueReader::Finish() {
  assert(levels_.empty());
  return std::move(root_);
}

void ValueReader::Fail(const std::string& what, int line, int column, const std::string& why,
                       const std::string& remedy) const {
  std::string where = *file_ + " line " + std::to_string(line);
  if (column > 0) where += ", column " + std::to_string(column);
  throw InputError({what, where, why, remedy});
}

ValueReader::Extent ValueReader::Measure(const Value& value) {
  Extent extent;
  const auto include = [&extent](const Value& inner) {
    const Extent part = Measure(inner);
    extent.values += part.values;
    extent.text_bytes += part.text_bytes;
    extent.depth = std::max(extent.depth, part.depth);
  };
  extent.text_bytes = value.source_.key.size();
  if (value.IsObject()) {
    for (const auto& [name, member] : value.members()) {
      extent.text_bytes += name.size();
      include(member);
    }
    ++extent.depth;
  } else if (value.IsArray()) {
    for (const Value& element : value.elements()) include(element);
    ++extent.depth;
  } else if (const auto* text = std::get_if<std::string>(&value.data_)) {
    extent.text_bytes += text->size();
  } else if (const auto* scalar = std::get_if<Value::Scalar>(&value.data_)) {
    extent.text_bytes += scalar->text.size();
  }
  return extent;
}

void ValueReader::CheckDepth(size_t depth, int line) const {
  if (depth > kMaxDepth) {
    Fail("too many levels", line, 0,
         "more than " + std::to_string(kMaxDepth) + " inside each other",
         "check that it is the file you meant");
  }
}

void ValueReader::Count(size_t values, size_t text_bytes, int line) {
  num_values_ += values;
  num_text_bytes_ += text_bytes;
  if (num_values_ > kMaxValues) {
    Fail("too many values", line, 0,
         "more than " + std::to_string(kMaxValues) + ", each use of an alias counted",
         "check that it is the file you meant");
  }
  if (num_text_bytes_ > kMaxTextBytes) {
    Fail("too much text", line, 0,
         "more than " + std::to_string(kMaxTextBytes >> 20) + " MB with all keys written out",
         "check that it is the file you meant");
  }
}

void ValueReader::SetSource(Value& value, int line) {
  std::string key;
  if (!levels_.empty()) {
    const Level& parent = levels_.back();
    key = parent.value.source_.key;
    if (parent.value.IsObject()) {
      if (!key.empty()) key += '.';
      key += parent.key;
      // A mapping's own first line is that of its first key, too late for "missing key".
      line = parent.key_line;
    } else {
      key += '[';
      key += std::to_string(parent.value.size());
      key += ']';
    }
  }
  value.source_ = {file_, line, std::move(key)};
  const Extent extent = Measure(value);
  Count(1, extent.text_bytes, line);
}

const Value& ValueReader::Place(Value value) {
  if (levels_.empty()) {
    root_ = std::move(value);
    return root_;
  }
  Level& parent = levels_.back();
  if (parent.value.IsArray()) {
    auto& elements = std::get<Value::Elements>(parent.value.data_);
    return elements.emplace_back(std::move(value));
  }
  assert(parent.key_line > 0);
  parent.key_line = 0;
  auto& members = std::get<Value::Members>(parent.value.data_);
  return members.emplace_back(std::move(parent.key), std::move(value)).second;
}

}  // namespace calibrato
