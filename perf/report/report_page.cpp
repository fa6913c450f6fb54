#include "perf/report/report_page.h"

#include <algorithm>
#include <sstream>

#include "perf/report/measurement.h"
#include "perf/report/plot_svg.h"
#include "perf/report/words.h"

namespace welkin::report {

const char* const kPageStyle = R"css(
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, sans-serif; color: #1c1c1c; background: #f6f6f4; margin: 0; }
main { max-width: 940px; margin: 0 auto; padding: 24px 20px 60px; }
h1 { font-size: 26px; margin: 0 0 4px; }
h2 { font-size: 19px; margin: 0 0 6px; }
p { margin: 6px 0; max-width: 78ch; }
.quiet { color: #5a5a5a; font-size: 13px; }
section { background: #fff; border: 1px solid #ddd; border-radius: 6px; padding: 16px 18px; margin: 18px 0; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 2px 16px; margin: 8px 0; font-size: 14px; }
dt { color: #5a5a5a; } dd { margin: 0; }
svg { display: block; width: 100%; height: auto; margin: 10px 0 4px; }
.point { cursor: crosshair; }
.point:hover circle, .point:hover rect, .point.lit circle, .point.lit rect { stroke: #111; stroke-width: 2.4px; }
.table { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 13px; font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; border-bottom: 2px solid #888; padding: 4px 8px; vertical-align: bottom; }
td { border-bottom: 1px solid #e6e6e6; padding: 3px 8px; vertical-align: top; }
th.n, td.n { text-align: right; white-space: nowrap; }
tr.front td { background: #f3f7ec; }
tr.peer td { color: #4d4d4d; font-style: italic; }
tr.lit td { background: #fff1b8; }
td small { color: #5a5a5a; }
.worse { color: #a11; font-weight: 600; } .better { color: #176b2c; }
nav a { margin-right: 12px; white-space: nowrap; }
#tip { position: fixed; pointer-events: none; background: #1c1c1c; color: #fff; font-size: 13px; line-height: 1.4;
       padding: 6px 10px; border-radius: 4px; white-space: pre-line; max-width: 320px; display: none; z-index: 2; }
@media print {
  body { background: #fff; font-size: 11px; } main { max-width: none; padding: 0; }
  section { border: none; padding: 0; break-inside: auto; } nav, #tip { display: none; }
  h2, svg { break-after: avoid; } svg, tr { break-inside: avoid; } table { font-size: 10px; }
  tr.front td { background: none; font-weight: 600; }
}
)css";

const char* const kPageScript = R"js(
const tip = document.getElementById("tip");
for (const section of document.querySelectorAll("section.pass")) {
  const points = [...section.querySelectorAll(".point")];
  const rows = [...section.querySelectorAll("tbody tr")];
  const rowOf = (point) => rows.find((row) => row.dataset.label === point.firstChild.textContent.split("\n")[0]);
  for (const point of points) {
    const title = point.querySelector("title");
    const words = title.textContent;
    const row = rowOf(point);
    point.dataset.words = words;
    const show = (event) => {
      title.textContent = ""; // the browser's own tip would cover this one
      tip.textContent = words;
      tip.style.display = "block";
      const x = Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8);
      const y = Math.min(event.clientY + 14, innerHeight - tip.offsetHeight - 8);
      tip.style.left = `${x}px`;
      tip.style.top = `${y}px`;
      if (row) row.classList.add("lit");
    };
    point.addEventListener("pointerenter", show);
    point.addEventListener("pointermove", show);
    point.addEventListener("pointerleave", () => {
      title.textContent = words;
      tip.style.display = "none";
      if (row) row.classList.remove("lit");
    });
    if (row) {
      row.addEventListener("pointerenter", () => point.classList.add("lit"));
      row.addEventListener("pointerleave", () => point.classList.remove("lit"));
    }
  }
}
document.documentElement.dataset.ready = document.querySelectorAll(".point[data-words]").length;
)js";

namespace {

void definition(std::ostream& out, const char* term, const std::string& text) {
  out << "<dt>" << term << "</dt><dd>" << escaped(text) << "</dd>\n";
}

void head(std::ostream& out, const Report& report) {
  const Machine& machine = report.machine;
  out << "<header>\n<h1>Welkin: error against run time</h1>\n<p>Every setting of every method, measured on this "
         "machine. "
         "Down is more exact, left is faster; a ring marks the front: no other setting of Welkin is both.</p>\n<dl>\n";
  definition(out, "Processor", machine.processor);
  definition(out, "Instruction set", machine.instruction_set);
  definition(out, "Compiler", machine.compiler);
  definition(out, "Welkin", machine.welkin);
  definition(out, "Light", report.environment);
  definition(out, "Scale", report.scale);
  definition(out, "Times",
             machine.clock + ", " + std::to_string(machine.threads) + (machine.threads == 1 ? " thread" : " threads") +
                 ", the least of several calls");
  definition(out, "Measured", machine.date);
  out << "</dl>\n";
  for (const std::string& note : report.notes) out << "<p class=\"quiet\">" << escaped(note) << "</p>\n";
  out << "<nav>";
  for (const Pass& pass : report.passes) {
    out << "<a href=\"#" << escaped(pass.id) << "\">" << escaped(pass.title) << "</a> ";
  }
  out << "</nav>\n</header>\n";
}

void recommendation_cell(std::ostream& out, const Recommendation& one) {
  out << "<td>";
  if (one.setting) {
    out << escaped(one.setting->method) << "<br>" << escaped(one.setting->setting) << "<br><small>"
        << percent(one.setting->error_rms) << ", " << duration_markup(one.setting->seconds) << "</small>";
  } else {
    out << "<small>none reaches it</small>";
  }
  out << "</td>";
}

void recommended(std::ostream& out, const Report& report) {
  out << "<section id=\"recommended\">\n<h2>Which setting to take</h2>\n<p class=\"quiet\">For an rms error of at most "
         "so much, on "
         "this light: the fastest setting, and of those within 5 % of its time the most exact.</p>\n<div "
         "class=\"table\"><table>\n"
         "<thead><tr><th>Task</th>";
  for (const double target : kErrorTargets) out << "<th>" << percent(target) << "</th>";
  out << "</tr></thead>\n<tbody>\n";
  std::string last;
  for (const Recommendation& one : recommendations(report)) {
    if (one.pass != last) {
      const auto pass =
          std::find_if(report.passes.begin(), report.passes.end(), [&](const Pass& p) { return p.id == one.pass; });
      out << (last.empty() ? "" : "</tr>\n") << "<tr><td><a href=\"#" << escaped(one.pass) << "\">"
          << escaped(pass->title) << "</a></td>";
      last = one.pass;
    }
    recommendation_cell(out, one);
  }
  out << (last.empty() ? "" : "</tr>\n") << "</tbody></table></div>\n</section>\n";
}

void change_rows(std::ostream& out, const std::vector<Change>& changes, const char* what, const char* kind, bool time) {
  for (const Change& change : changes) {
    out << "<tr><td class=\"" << kind << "\">" << what << "</td><td>" << escaped(change.after.pass) << "</td><td>"
        << escaped(label(change.after)) << "</td><td class=\"n\">"
        << (time ? duration_markup(change.before.seconds) : percent(change.before.error_rms)) << "</td><td class=\"n\">"
        << (time ? duration_markup(change.after.seconds) : percent(change.after.error_rms)) << "</td></tr>\n";
  }
}

void one_sided_rows(std::ostream& out, const std::vector<Measurement>& measurements, const char* what) {
  for (const Measurement& one : measurements) {
    out << "<tr><td>" << what << "</td><td>" << escaped(one.pass) << "</td><td>" << escaped(label(one))
        << "</td><td></td><td></td></tr>\n";
  }
}

void compared(std::ostream& out, const Comparison& comparison) {
  out << "<section id=\"compared\">\n<h2>Against the older report</h2>\n<p>" << comparison.compared
      << " settings compared: "
      << (comparison.regressed() ? "<span class=\"worse\">some are worse than they were.</span>"
                                 : "none is worse than it was.")
      << "</p>\n";
  if (!comparison.times_refused.empty()) {
    out << "<p class=\"quiet\">Times are not compared: " << escaped(comparison.times_refused) << ".</p>\n";
  }
  std::ostringstream rows;
  change_rows(rows, comparison.worse_error, "larger error", "worse", false);
  change_rows(rows, comparison.slower, "slower", "worse", true);
  change_rows(rows, comparison.better_error, "smaller error", "better", false);
  change_rows(rows, comparison.faster, "faster", "better", true);
  one_sided_rows(rows, comparison.gone, "no longer measured");
  one_sided_rows(rows, comparison.added, "new");
  if (!rows.str().empty()) {
    out << "<div class=\"table\"><table>\n<thead><tr><th></th><th>Task</th><th>Setting</th><th class=\"n\">Before</th>"
           "<th class=\"n\">Now</th></tr></thead>\n<tbody>\n"
        << rows.str() << "</tbody></table></div>\n";
  }
  out << "</section>\n";
}

void measurement_row(std::ostream& out, const Measurement& one, bool on_front) {
  out << "<tr data-label=\"" << escaped(label(one)) << "\"";
  if (on_front || !one.peer.empty()) out << " class=\"" << (on_front ? "front" : "peer") << "\"";
  out << "><td>" << (on_front ? "&#9679;" : "") << "</td><td>"
      << escaped(one.peer.empty() ? one.method : one.peer + ", " + one.method) << "</td><td>" << escaped(one.setting)
      << "</td><td class=\"n\">" << percent(one.error_rms) << "</td><td class=\"n\">" << percent(one.error_maximum)
      << "</td><td class=\"n\">" << duration_markup(one.seconds) << "</td></tr>\n";
}

void section(std::ostream& out, const Report& report, const Pass& pass) {
  const std::vector<Measurement> measurements = of_pass(report, pass.id);
  const std::vector<std::size_t> front = pareto_front(measurements);
  out << "<section class=\"pass\" id=\"" << escaped(pass.id) << "\">\n<h2>" << escaped(pass.title) << "</h2>\n<p>"
      << escaped(pass.task) << "</p>\n"
      << plot_svg(pass, measurements, report.machine, PlotUse::page)
      << "<div class=\"table\"><table>\n<thead><tr><th>Front</th><th>Method</th><th>Setting</th><th class=\"n\">Error, "
         "rms</th>"
         "<th class=\"n\">Largest</th><th class=\"n\">Time</th></tr></thead>\n<tbody>\n";
  for (std::size_t k = 0; k < measurements.size(); ++k) {
    measurement_row(out, measurements[k], std::find(front.begin(), front.end(), k) != front.end());
  }
  out << "</tbody></table></div>\n<p class=\"quiet\">Error: " << escaped(pass.error_meaning);
  if (!measurements.empty()) out << " Truth: " << escaped(measurements.front().truth) << '.';
  out << "</p>\n</section>\n";
}

}  // namespace

std::string to_html(const Report& report, const std::optional<Comparison>& comparison) {
  std::ostringstream out;
  out << "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
         "content=\"width=device-width, initial-scale=1\">\n<title>Welkin: error against run time</title>\n<style>"
      << kPageStyle << "</style>\n</head>\n<body>\n<main>\n";
  head(out, report);
  if (comparison) compared(out, *comparison);
  recommended(out, report);
  for (const Pass& pass : report.passes) section(out, report, pass);
  out << "</main>\n<div id=\"tip\"></div>\n<script>" << kPageScript << "</script>\n</body>\n</html>\n";
  return out.str();
}

}  // namespace welkin::report
