#include "calibrato/report/report.h"

#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/report/documents_for_test.h"

namespace calibrato {
namespace {

size_t Count(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// What the browser reads as markup: the page without the content of script and style elements.
std::string Markup(const std::string& page) {
  std::string markup;
  size_t at = 0;
  for (size_t open = page.find('<'); open != std::string::npos; open = page.find('<', at)) {
    const size_t close = page.find('>', open);
    markup += page.substr(at, close + 1 - at);
    at = close + 1;
    for (const std::string name : {"script", "style"}) {
      if (page.compare(open, name.size() + 1, "<" + name) == 0) at = page.find("</" + name, at);
    }
  }
  return markup + page.substr(at);
}

// What the page's scripts will parse.
Value EmbeddedDocuments(const std::string& page) {
  const std::string opening = "<script type=\"application/json\" id=\"documents\">";
  const size_t begin = page.find(opening) + opening.size();
  return ParseJson(page.substr(begin, page.find("</script", begin) - begin), "page");
}

std::vector<Value> AllDocuments() {
  return {CameraDocumentForTest(), CameraImuDocumentForTest(), LearnDocumentForTest(),
          Table1DocumentForTest()};
}

TEST(ReportHtml, AsksForNothingFromAnywhere) {
  const std::string page = ReportHtml("A report", AllDocuments());
  const std::string markup = Markup(page);
  EXPECT_NE(markup.find("<main id=\"report\">"), std::string::npos);
  EXPECT_EQ(markup.find("http:"), std::string::npos);
  EXPECT_EQ(markup.find("https:"), std::string::npos);
  EXPECT_FALSE(std::regex_search(markup, std::regex(R"((src|href|action)\s*=)")));
  EXPECT_EQ(markup.find("<link"), std::string::npos);
  EXPECT_EQ(page.find("@import"), std::string::npos);
  EXPECT_NE(markup.find("default-src 'none'"), std::string::npos);
}

// Plotly's own choice is a button that sends the data of a chart to its maker.
TEST(ReportHtml, OffersNoButtonThatSendsDataAway) {
  const std::string page = ReportHtml("A report", {});
  EXPECT_NE(page.find("\n  showSendToCloud: false,\n  plotlyServerURL: \"\",\n"),
            std::string::npos);
}

TEST(ReportHtml, HoldsEachPartOnceWithoutMarksLeft) {
  const std::string page = ReportHtml("A report", AllDocuments());
  EXPECT_EQ(Count(page, "* plotly.js v"), 1u);
  EXPECT_EQ(Count(page, "function writePage("), 1u);
  EXPECT_EQ(Count(page, "\n.verdict-line {"), 1u);
  EXPECT_EQ(Count(page, "</script"), 3u);
  EXPECT_EQ(Count(page, "</style"), 1u);
  EXPECT_EQ(Markup(page).find("{{"), std::string::npos);
}

TEST(ReportHtml, StaysBelowEightMegabytes) {
  EXPECT_LT(ReportHtml("A report", AllDocuments()).size(), size_t{8} << 20);
}

TEST(ReportHtml, MakesAHostileNameInertAndKeepsIt) {
  const std::string hostile = "</script><script>alert(1)</script><!-- {{title}} \xE2\x80\xA8";
  Value document = Value::Object();
  document.Set("kind", "camera").Set("findings", Value::Array().Append(hostile));
  const std::string page = ReportHtml("A report", {document});
  EXPECT_EQ(page.find("<script>alert(1)"), std::string::npos);
  EXPECT_EQ(Count(page, "</script"), 3u);
  const Value embedded = EmbeddedDocuments(page);
  EXPECT_EQ(embedded.elements()[0].At("findings").elements()[0].AsString(), hostile);
}

TEST(ReportHtml, KeepsTheOrderOfTheDocuments) {
  const Value embedded =
      EmbeddedDocuments(ReportHtml("A report", {Table1DocumentForTest(), CameraDocumentForTest()}));
  ASSERT_EQ(embedded.size(), 2u);
  EXPECT_EQ(embedded.elements()[0].At("kind").AsString(), "table1");
  EXPECT_EQ(ToJson(embedded.elements()[1]), ToJson(CameraDocumentForTest()));
}

TEST(ReportHtml, EscapesTheTitle) {
  const std::string page = ReportHtml("<b>\"R\" & D</b> {{plotly}}", {});
  EXPECT_EQ(page.find("<b>\"R\""), std::string::npos);
  EXPECT_EQ(Count(page, "&lt;b&gt;&quot;R&quot; &amp; D&lt;/b&gt; {{plotly}}"), 2u);
}

TEST(ReportHtml, RefusesADocumentWithoutAKind) {
  EXPECT_THROW(ReportHtml("A report", {Value::Object()}), InputError);
  EXPECT_THROW(ReportHtml("A report", {Value("camera")}), InputError);
  EXPECT_THROW(ReportHtml("A report", {Value::Object().Set("kind", 3)}), InputError);
}

}  // namespace
}  // namespace calibrato
