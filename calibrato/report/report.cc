#include "calibrato/report/report.h"

#include <cassert>
#include <string_view>

// The parts of the page, compiled in by assets.s.in.
extern "C" {
extern const char calibrato_report_template[];
extern const char calibrato_report_template_end[];
extern const char calibrato_report_style[];
extern const char calibrato_report_style_end[];
extern const char calibrato_report_plotly[];
extern const char calibrato_report_plotly_end[];
extern const char calibrato_report_scripts[];
extern const char calibrato_report_scripts_end[];
}

namespace calibrato {
namespace {

std::string_view Text(const char* begin, const char* end) {
  return {begin, static_cast<size_t>(end - begin)};
}

std::string EscapeMarkup(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

// In JSON a '<' stands within strings only. Escaped, none of them can end the script element, nor
// open a comment within it.
std::string EmbeddedJson(const std::vector<Value>& documents) {
  Value array = Value::Array();
  for (const Value& document : documents) {
    static_cast<void>(document.At("kind").AsString());
    array.Append(document);
  }
  std::string escaped;
  for (const char c : ToJsonLine(array)) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

}  // namespace

std::string ReportHtml(const std::string& title, const std::vector<Value>& documents) {
  const std::string escaped_title = EscapeMarkup(title);
  const std::string json = EmbeddedJson(documents);
  const std::string_view style = Text(calibrato_report_style, calibrato_report_style_end);
  const std::string_view plotly = Text(calibrato_report_plotly, calibrato_report_plotly_end);
  const std::string_view scripts = Text(calibrato_report_scripts, calibrato_report_scripts_end);
  const auto part = [&](std::string_view name) -> std::string_view {
    if (name == "title") return escaped_title;
    if (name == "style") return style;
    if (name == "documents") return json;
    if (name == "plotly") return plotly;
    assert(name == "scripts");
    return scripts;
  };

  // One pass over the template: what a part contains is never taken for a mark.
  std::string_view rest = Text(calibrato_report_template, calibrato_report_template_end);
  std::string page;
  page.reserve(rest.size() + 2 * escaped_title.size() + json.size() + style.size() + plotly.size() +
               scripts.size());
  for (size_t mark = rest.find("{{"); mark != std::string_view::npos; mark = rest.find("{{")) {
    const size_t end = rest.find("}}", mark);
    assert(end != std::string_view::npos);
    page += rest.substr(0, mark);
    page += part(rest.substr(mark + 2, end - mark - 2));
    rest.remove_prefix(end + 2);
  }
  page += rest;
  return page;
}

}  // namespace calibrato
