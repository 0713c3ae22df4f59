#include <algorithm>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/scalar_text.h"
#include "calibrato/base/value.h"
#include "calibrato/base/value_reader.h"

namespace calibrato {
namespace {

// Where the parser stands in the text: counted as it takes characters.
struct Position {
  int line = 1;
  int column = 0;
  char last = ' ';

  void Count(char c) {
    if (last == '\n') {
      ++line;
      column = 0;
    }
    ++column;
    last = c;
  }
};

class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, Position* position) : at_(at), position_(position) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    position_->Count(*at_++);
    return *this;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  Position* position_;
};

class JsonEvents : public nlohmann::json_sax<nlohmann::json> {
 public:
  JsonEvents(ValueReader& reader, const Position& position)
      : reader_(reader), position_(position) {}

  bool null() override { return Add(Value()); }
  bool boolean(bool value) override { return Add(value); }
  bool number_integer(number_integer_t value) override { return Add(Value(int64_t{value})); }
  bool number_unsigned(number_unsigned_t value) override {
    const bool fits = value <= uint64_t{std::numeric_limits<int64_t>::max()};
    return Add(fits ? Value(static_cast<int64_t>(value)) : Value(static_cast<double>(value)));
  }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return Add(value); }
  bool string(string_t& value) override { return Add(std::move(value)); }
  bool binary(binary_t& /*value*/) override { return false; }  // JSON text has none

  bool start_object(size_t /*size*/) override {
    reader_.BeginObject(position_.line);
    return true;
  }
  bool key(string_t& value) override {
    reader_.AddKey(value, position_.line);
    return true;
  }
  bool end_object() override { return End(); }
  bool start_array(size_t /*size*/) override {
    reader_.BeginArray(position_.line);
    return true;
  }
  bool end_array() override { return End(); }

  bool parse_error(size_t /*position*/, const std::string& /*token*/,
                   const nlohmann::json::exception& error) override {
    // "[json.exception...] parse error at line 1, column 2: why"
    std::string why = error.what();
    why.erase(0, why.find("] ") + 2);
    if (why.starts_with("parse error")) why.erase(0, why.find(": ") + 2);
    reader_.Fail("cannot read JSON", position_.line, std::max(1, position_.column), why,
                 "check brackets, commas and quotes there and in the line before");
  }

 private:
  // A number ends at the character behind it, which the parser has taken by now. Position counts a
  // newline as the end of its own line, so that the line is right all the same.
  bool Add(Value value) {
    reader_.AddScalar(std::move(value), position_.line);
    return true;
  }
  bool End() {
    reader_.End();
    return true;
  }

  ValueReader& reader_;
  const Position& position_;
};

}  // namespace

class JsonWriter {
 public:
  static std::string Write(const Value& value, bool on_one_line) {
    JsonWriter writer(on_one_line);
    writer.Append(value, 0);
    return std::move(writer.text_);
  }

 private:
  explicit JsonWriter(bool on_one_line) : on_one_line_(on_one_line) {}

  static bool IsScalar(const Value& value) { return !value.IsObject() && !value.IsArray(); }

  static std::string FormatScalar(const Value& value) {
    struct Format {
      std::string operator()(std::monostate) const { return "null"; }
      std::string operator()(bool x) const { return x ? "true" : "false"; }
      std::string operator()(int64_t x) const { return std::to_string(x); }
      std::string operator()(double x) const { return FormatNumber(x); }
      std::string operator()(const std::string& x) const { return QuoteText(x); }
      std::string operator()(const Value::Scalar& x) const {
        if (x.text == "true" || x.text == "false") return x.text;
        // "-0" is a number with a sign, which only a double can keep.
        const auto whole = ParseWholeNumber(x.text);
        if (whole && *whole != 0) return std::to_string(*whole);
        if (const auto number = ParseDecimal(x.text)) return FormatNumber(*number);
        return QuoteText(x.text);
      }
      std::string operator()(const Value::Members&) const { return "{}"; }
      std::string operator()(const Value::Elements&) const { return "[]"; }
    };
    return std::visit(Format(), value.data_);
  }

  void Append(const Value& value, size_t indent) {
    if (value.size() == 0) {
      text_ += FormatScalar(value);
    } else if (value.IsArray()) {
      const Value::Elements& elements = value.elements();
      const bool flat = on_one_line_ || std::all_of(elements.begin(), elements.end(), IsScalar);
      text_ += '[';
      for (size_t i = 0; i < elements.size(); ++i) {
        Separate(i, flat, indent + 2);
        Append(elements[i], indent + 2);
      }
      if (!flat) NewLine(indent);
      text_ += ']';
    } else {
      const Value::Members& members = value.members();
      text_ += '{';
      for (size_t i = 0; i < members.size(); ++i) {
        Separate(i, on_one_line_, indent + 2);
        text_ += QuoteText(members[i].first) + ": ";
        Append(members[i].second, indent + 2);
      }
      if (!on_one_line_) NewLine(indent);
      text_ += '}';
    }
  }

  void Separate(size_t index, bool flat, size_t indent) {
    if (index > 0) text_ += flat ? ", " : ",";
    if (!flat) NewLine(indent);
  }

  void NewLine(size_t indent) {
    text_ += '\n';
    text_.append(indent, ' ');
  }

  bool on_one_line_;
  std::string text_;
};

Value ReadJson(const std::string& path) { return ParseJson(ReadFile(path), path); }

Value ParseJson(const std::string& text, const std::string& name) {
  ValueReader reader(name);
  Position position;
  JsonEvents events(reader, position);
  nlohmann::json::sax_parse(CountingIterator(text.data(), &position),
                            CountingIterator(text.data() + text.size(), &position), &events);
  return reader.Finish();
}

std::string ToJson(const Value& value) { return JsonWriter::Write(value, false) + "\n"; }

std::string ToJsonLine(const Value& value) { return JsonWriter::Write(value, true); }

}  // namespace calibrato
