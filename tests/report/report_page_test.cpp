// The page stands alone: nothing in it comes from a network or another file, and nothing in it is taken for markup.
#include "report/report_page.h"

#include <cmath>
#include <string>

#include "report/made_up_report.h"
#include "report/plot_svg.h"
#include "support/catch.h"

using namespace welkin::report;
using welkin::test::made_up_report;
using welkin::test::point;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

std::string plot(PlotUse use) {
  const Report report = made_up_report();
  return plot_svg(report.passes[0], of_pass(report, "one"), report.machine, use);
}

}  // namespace

TEST_CASE("report: the page needs nothing else", "[report]") {
  const std::string page = to_html(made_up_report(), compare(made_up_report(), made_up_report()));
  for (const char* part :
       {"http:", "https:", "//www", "src=", "<link", "@import", "url(", "fetch(", "XMLHttp", "import("}) {
    INFO(part);
    CHECK_FALSE(has(page, part));
  }
  // Links lead to places in the page alone.
  CHECK(count(page, "href=\"") == count(page, "href=\"#"));
  CHECK(count(page, "<script>") == 1);
  CHECK(has(page, "@media print"));
}

TEST_CASE("report: the page has every setting, its machine and what to take", "[report]") {
  const Report report = made_up_report();
  const std::string page = to_html(report);
  for (const Measurement& one : report.measurements) CHECK(has(page, "data-label=\"" + label(one) + "\""));
  for (const char* part :
       {"a processor", "a compiler", "avx2", "processor time", "2026-11-22", "a light", "A note.", "The first",
        "What is done.", "What rms is.", "the truth", "none reaches it", "Which setting to take"}) {
    INFO(part);
    CHECK(has(page, part));
  }
  CHECK(count(page, "<svg ") == 2);
  CHECK(count(page, "class=\"point\"") == 5);
  CHECK(count(page, "<tr data-label=") == 5);
  CHECK(count(page, " class=\"front\"") == 3);  // two of the first pass, one of the second
  CHECK_FALSE(has(page, "Against the older report"));
}

TEST_CASE("report: names that look like markup stay text", "[report]") {
  Report report = made_up_report();
  const std::string evil = "<script>alert(1)</script>\"'&";
  report.measurements[0].method = report.measurements[1].setting = report.passes[0].title = report.environment = evil;
  report.measurements[3].peer = report.measurements[4].truth = report.machine.processor = report.notes[0] = evil;
  const std::string page = to_html(report, compare(report, report));
  CHECK(count(page, "<script>") == 1);
  CHECK_FALSE(has(page, "alert(1)</script>"));
  CHECK(has(page, "&lt;script&gt;alert(1)&lt;/script&gt;&quot;&#39;&amp;"));
}

TEST_CASE("report: the page shows what has become worse", "[report]") {
  Report after = made_up_report();
  after.measurements[1].error_rms *= 4.0;
  after.measurements[0].seconds *= 3.0;
  const std::string page = to_html(after, compare(made_up_report(), after));
  CHECK(has(page, "Against the older report"));
  CHECK(has(page, "larger error"));
  CHECK(has(page, "slower"));
  CHECK(has(page, "some are worse"));
}

TEST_CASE("report: a plot stands alone as a file", "[report]") {
  const std::string file = plot(PlotUse::file);
  CHECK(has(file, "xmlns=\"http://www.w3.org/2000/svg\""));
  CHECK(count(file, "http") == 1);
  CHECK_FALSE(has(file, "<script"));
  CHECK_FALSE(has(file, "nan"));
  CHECK_FALSE(has(file, "inf"));
  CHECK(count(file, "<g class=\"point\">") == 4);
  CHECK(count(file, "r=\"7.5\"") == 2);  // rings of the front
  CHECK_FALSE(has(plot(PlotUse::page), "http"));
}

TEST_CASE("report: plots take errors of nothing, one point, and no points", "[report]") {
  const Report report = made_up_report();
  const std::vector<Measurement> exact{point("exact", 0.0, 1e-3), point("none", std::nan(""), 1e-3)};
  const std::string text = plot_svg(report.passes[0], exact, report.machine, PlotUse::file);
  CHECK(count(text, "<g class=\"point\">") == 1);
  CHECK_FALSE(has(text, "nan"));
  CHECK_FALSE(has(text, "inf"));
  CHECK(plot_svg(report.passes[0], {}, report.machine, PlotUse::file).empty());
}
