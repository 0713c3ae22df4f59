#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/scalar_text.h"
#include "calibrato/base/value.h"
#include "calibrato/base/value_reader.h"

namespace calibrato {
namespace {

int LineOf(const YAML::Mark& mark) { return mark.line + 1; }

class YamlEvents : public YAML::EventHandler {
 public:
  explicit YamlEvents(ValueReader& reader) : reader_(reader) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (has_document_) {
      reader_.Fail("cannot read YAML", LineOf(mark), 0, "a second document begins here",
                   "remove what follows the line '---'");
    }
    has_document_ = true;
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    RefuseKey(mark, "nothing");
    Keep(anchor, reader_.AddScalar(Value(), LineOf(mark)));
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    RefuseKey(mark, "an alias");
    const auto kept = kept_.find(anchor);
    if (kept == kept_.end()) {
      reader_.Fail("cannot read YAML", LineOf(mark), mark.column + 1,
                   "the alias stands inside what it refers to", "write its content out");
    }
    reader_.AddCopy(kept->second, LineOf(mark));
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    const int line = LineOf(mark);
    // yaml-cpp's tag of scalars in quotes or block style, and the explicit one of text.
    const bool is_text = tag == "!" || tag == "tag:yaml.org,2002:str";
    if (reader_.WantsKey()) {
      if (text == "<<" && !is_text) {
        reader_.Fail("cannot read YAML", line, mark.column + 1, "merge keys (<<) are not taken",
                     "write the merged keys out");
      }
      if (anchor != 0) RefuseKey(mark, "an anchor");
      reader_.AddKey(text, line);
      return;
    }
    Keep(anchor, is_text ? reader_.AddScalar(text, line) : reader_.AddPlainText(text, line));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    RefuseKey(mark, "an array");
    reader_.BeginArray(LineOf(mark));
    open_anchors_.push_back(anchor);
  }
  void OnSequenceEnd() override { End(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    RefuseKey(mark, "a mapping");
    reader_.BeginObject(LineOf(mark));
    open_anchors_.push_back(anchor);
  }
  void OnMapEnd() override { End(); }

 private:
  void RefuseKey(const YAML::Mark& mark, const std::string& found) const {
    if (!reader_.WantsKey()) return;
    reader_.Fail("cannot read YAML", LineOf(mark), mark.column + 1,
                 "expected the name of a key, found " + found, "write it as 'key: value'");
  }

  void End() {
    const YAML::anchor_t anchor = open_anchors_.back();
    open_anchors_.pop_back();
    Keep(anchor, reader_.End());
  }

  void Keep(YAML::anchor_t anchor, const Value& value) {
    if (anchor == 0) return;
    reader_.CountCopy(value);
    kept_[anchor] = value;
  }

  ValueReader& reader_;
  bool has_document_ = false;
  std::vector<YAML::anchor_t> open_anchors_;  // of each level, 0 for none
  std::map<YAML::anchor_t, Value> kept_;
};

// yaml-cpp takes some control characters for the end of the file, and a photo for text.
void RefuseBinary(const std::string& text, const ValueReader& reader) {
  const auto found = std::find_if(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r';
  });
  if (found == text.end()) return;
  reader.Fail("cannot read YAML", static_cast<int>(1 + std::count(text.begin(), found, '\n')), 0,
              "it holds control characters, so it is not a text file",
              "check that it is the file you meant, saved as UTF-8");
}

bool IsPlainWord(const std::string& text) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto is_inner = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || std::string_view("_-/. ").find(c) < 5;
  };
  if (text.empty() || text.back() == ' ') return false;
  if (!is_letter(text[0]) && text[0] != '_' && text[0] != '/') return false;
  if (!std::all_of(text.begin(), text.end(), is_inner)) return false;
  // What YAML 1.1 or 1.2 takes for something else than text.
  std::string lower = text;
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  for (const char* word : {"true", "false", "yes", "no", "on", "off", "y", "n", "null"}) {
    if (lower == word) return false;
  }
  return true;
}

std::string YamlText(const std::string& text) { return IsPlainWord(text) ? text : QuoteText(text); }

// As FormatNumber, but with a point in the mantissa: 1.0e-05.
std::string YamlDouble(double value) {
  std::string text = FormatNumber(value);
  if (text == "null" || text.find('.') != std::string::npos) return text;
  text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

}  // namespace

class YamlWriter {
 public:
  static std::string Write(const Value& value) {
    YamlWriter writer;
    writer.Block(value, 0);
    return std::move(writer.text_);
  }

 private:
  static bool IsBlock(const Value& value) {
    if (value.IsObject()) return value.size() > 0;
    return value.IsArray() &&
           std::any_of(value.elements().begin(), value.elements().end(),
                       [](const Value& e) { return e.IsObject() || e.IsArray(); });
  }

  // The text of what fits on a line: scalars, arrays of scalars, and what is empty.
  static std::string Inline(const Value& value) {
    struct Format {
      std::string operator()(std::monostate) const { return "null"; }
      std::string operator()(bool x) const { return x ? "true" : "false"; }
      std::string operator()(int64_t x) const { return std::to_string(x); }
      std::string operator()(double x) const { return YamlDouble(x); }
      std::string operator()(const std::string& x) const { return YamlText(x); }
      std::string operator()(const Value::Scalar& x) const {
        const bool keeps_type = x.text == "true" || x.text == "false" || ParseDecimal(x.text) ||
                                ParseWholeNumber(x.text);
        return keeps_type ? x.text : YamlText(x.text);
      }
      std::string operator()(const Value::Members&) const { return "{}"; }
      std::string operator()(const Value::Elements& elements) const {
        std::string text;
        for (const Value& element : elements) text += (text.empty() ? "" : ", ") + Inline(element);
        return "[" + text + "]";
      }
    };
    return std::visit(Format(), value.data_);
  }

  // Starts where the line stands, ends with a newline; lines after the first are indented.
  void Block(const Value& value, size_t indent) {
    if (!IsBlock(value)) {
      text_ += Inline(value) + "\n";
      return;
    }
    bool is_first = true;
    const auto begin_line = [&](const std::string& start) {
      if (!is_first) text_.append(indent, ' ');
      is_first = false;
      text_ += start;
    };
    if (value.IsArray()) {
      for (const Value& element : value.elements()) {
        begin_line("- ");
        Block(element, indent + 2);
      }
      return;
    }
    for (const auto& [name, member] : value.members()) {
      begin_line(YamlText(name) + ":");
      if (IsBlock(member)) {
        text_ += "\n";
        text_.append(indent + 2, ' ');
      } else {
        text_ += " ";
      }
      Block(member, indent + 2);
    }
  }

  std::string text_;
};

Value ReadYaml(const std::string& path) { return ParseYaml(ReadFile(path), path); }

Value ParseYaml(const std::string& text, const std::string& name) {
  ValueReader reader(name);
  RefuseBinary(text, reader);
  YamlEvents events(reader);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(events)) {
    }
  } catch (const YAML::Exception& error) {
    reader.Fail("cannot read YAML", error.mark.line + 1, error.mark.column + 1, error.msg,
                "check indentation, brackets and quotes there and in the line before");
  }
  return reader.Finish();
}

std::string ToYaml(const Value& value) { return YamlWriter::Write(value); }

}  // namespace calibrato
