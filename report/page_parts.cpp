#include "report/page_parts.h"

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

}  // namespace welkin::report
