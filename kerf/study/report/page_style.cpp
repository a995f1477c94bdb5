#include "kerf/study/report/page_style.h"

namespace kerf::report {
namespace {

// Eight colours that colour-blind readers can tell apart, each with a contrast of 3:1 or more against the page in both
// modes; and the text with 4.5:1 or more.
constexpr std::string_view kStyle = R"css(
:root { color-scheme: light dark;
  --page: #ffffff; --panel: #f6f7f9; --text: #1b1f24; --soft: #57606a; --rule: #d5dae0; --grid: #e4e8ec;
  --accent: #0b62a8; --bar: #3b7fb8; --first: #6b7280; --paper-ink: #9a4a00; --warn: #b3261e; --warn-page: #fdecea;
  --up1: #e3f0fb; --up2: #c3def5; --up3: #9cc8ee; --down1: #fdeedd; --down2: #fbd7ae;
  --c0: #0067a3; --c1: #c44f00; --c2: #007f5c; --c3: #a8518a; --c4: #8f6500; --c5: #2382b4; --c6: #5a5a5a; --c7: #8b1a2b; }
@media screen and (prefers-color-scheme: dark) { :root {
  --page: #14171b; --panel: #1c2026; --text: #e6e9ed; --soft: #a3acb7; --rule: #39414b; --grid: #2a3038;
  --accent: #7cbcf2; --bar: #4d94cf; --first: #9aa3ae; --paper-ink: #f0a868; --warn: #ff9d94; --warn-page: #3a1d1b;
  --up1: #1a2f42; --up2: #1d436a; --up3: #205a94; --down1: #3a2b1a; --down2: #5a3c16;
  --c0: #5db3f0; --c1: #ff8a4c; --c2: #3dcba0; --c3: #e79ccb; --c4: #e9b949; --c5: #9bd8f5; --c6: #b8b8b8; --c7: #ff8fa0; } }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; text-size-adjust: 100%; }
body { margin: 0 auto; max-width: 1340px; padding: 28px 28px 64px; background: var(--page); color: var(--text);
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Liberation Sans", Arial, sans-serif; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .4rem; letter-spacing: -.01em; overflow-wrap: anywhere; }
h2 { font-size: 1.4rem; line-height: 1.25; margin: 3rem 0 .6rem; padding-top: 1rem; border-top: 2px solid var(--text); overflow-wrap: anywhere; }
h3 { font-size: 1.08rem; margin: 2rem 0 .4rem; overflow-wrap: anywhere; }
h2 small, h3 small { font-size: .95rem; font-weight: 400; color: var(--soft); margin-left: .5em; white-space: nowrap; }
p { margin: .35rem 0; max-width: 75ch; }
a { color: var(--accent); }
code { font-family: ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, "Liberation Mono", monospace; font-size: .86em; overflow-wrap: anywhere; }
.made { color: var(--soft); margin: 0; overflow-wrap: anywhere; max-width: none; }
.command { display: block; margin: .7rem 0; padding: .6rem .8rem; background: var(--panel); border-left: 3px solid var(--accent);
  white-space: pre-wrap; overflow-wrap: anywhere; }
.notes { margin: .7rem 0; padding-left: 1.2rem; max-width: 80ch; }
nav ul { list-style: none; display: flex; flex-wrap: wrap; gap: .4rem; margin: 1rem 0 0; padding: 0; }
nav a { display: inline-block; padding: .3rem .8rem; border: 1px solid var(--rule); border-radius: 99px; text-decoration: none;
  font-size: .92rem; overflow-wrap: anywhere; }
nav a:hover, nav a:focus-visible { background: var(--panel); border-color: var(--accent); }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 280px), 1fr)); gap: 18px; margin: 1rem 0; }
.pictures figure { margin: 0; }
.pictures img { display: block; width: 100%; height: auto; border-radius: 4px; background: var(--panel); }
.pictures figcaption { margin-top: .35rem; font-size: .88rem; color: var(--soft); overflow-wrap: anywhere; }
.findings { margin: .3rem 0 .8rem; padding-left: .9rem; border-left: 3px solid var(--rule); }
.findings p { max-width: none; overflow-wrap: anywhere; }
.warning { color: var(--warn); background: var(--warn-page); padding: .5rem .8rem; border-left: 4px solid var(--warn); font-weight: 600; }
.hint { color: var(--soft); font-size: .86rem; }
.scroll { position: relative; overflow-x: auto; margin: .6rem 0 1.2rem; }
.scroll:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
table { border-collapse: collapse; font-size: .84rem; font-variant-numeric: tabular-nums; width: 100%; }
table.overview { width: auto; }
caption { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap; }
th, td { padding: .38rem .45rem; text-align: right; vertical-align: top; border-bottom: 1px solid var(--grid); white-space: nowrap; }
th[scope=row], thead th:first-child { text-align: left; position: sticky; left: 0; background: var(--page); z-index: 1; }
th[scope=row] { font-weight: 400; white-space: normal; min-width: 13.5rem; padding-left: 2.6em; line-height: 1.35; }
thead th { vertical-align: bottom; border-bottom: 2px solid var(--rule); line-height: 1.25; font-weight: 600; white-space: normal; }
thead th > span, thead button > span { display: block; }
.symbol { font-family: "Liberation Serif", "Times New Roman", Georgia, serif; font-style: italic; font-size: 1.12rem; font-weight: 600; white-space: nowrap; }
.symbol.upright { font: inherit; font-weight: 600; }
.symbol sub { font-size: .68em; font-style: normal; line-height: 0; }
.words { font-size: .9em; font-weight: 400; color: var(--soft); }
.unit { font-size: .9em; font-weight: 400; color: var(--soft); }
.unit::before { content: "in "; }
th button { font: inherit; color: inherit; background: none; border: 0; padding: 0; margin: 0; text-align: inherit; cursor: pointer; }
th button:hover .words, th button:focus-visible .words { color: var(--accent); text-decoration: underline; }
th[aria-sort] .words::after { content: " \2191"; color: var(--accent); }
th[aria-sort=descending] .words::after { content: " \2193"; }
td > span, td > strong { display: block; }
td strong { color: var(--accent); font-weight: 700; }
.range { font-size: .9em; color: var(--soft); }
.paper { font-size: .9em; color: var(--paper-ink); line-height: 1.3; margin-top: .15rem; }
.paper .ratio { display: block; }
table.limits th[scope=row] { min-width: 5rem; padding-left: .45rem; }
wbr.narrow { display: none; }
th .number { position: absolute; left: 0; width: 2.1em; text-align: right; }
.unfinished { text-align: left; white-space: normal; color: var(--soft); font-style: italic; }
.unfinished b { color: var(--warn); font-style: normal; }
.none { color: var(--soft); }
.state { text-align: left; } .state.missed { color: var(--warn); background: var(--warn-page); font-weight: 700; }
td.said { text-align: left; white-space: normal; min-width: 14rem; } .bar-text { color: var(--soft); }
table.goals thead th { text-align: left; } table.goals th[scope=row] { padding-left: .45rem; min-width: 11rem; }
table.matrix { width: auto; } table.matrix thead th { min-width: 3.4rem; } table.matrix th, table.matrix td { padding: .34rem .3rem; font-size: .92em; }
.chart.wide { max-width: 900px; }
.up1 { background: var(--up1); } .up2 { background: var(--up2); } .up3 { background: var(--up3); font-weight: 700; }
.down1 { background: var(--down1); } .down2 { background: var(--down2); }
.mean { border-left: 2px solid var(--rule); }
table.overview th, table.overview td { min-width: 5.6rem; }
table.overview thead th { max-width: 9rem; overflow-wrap: anywhere; }
table.overview th[scope=row] { min-width: 19rem; max-width: 30rem; }
tbody tr:hover > *, tr.lit > * { background: var(--panel); }
.charts { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 350px), 1fr)); gap: 22px 26px; margin: 1rem 0; align-items: start; }
.chart { margin: 0; min-width: 0; max-width: 520px; }
.chart figcaption { margin: 0 0 .3rem; font-size: .9rem; line-height: 1.35; }
.scale, .left-out { color: var(--soft); font-size: .8rem; margin-left: .35em; }
.left-out { color: var(--warn); }
.chart svg { display: block; width: 100%; height: auto; overflow: visible; }
svg text { font: 11px system-ui, -apple-system, "Segoe UI", Roboto, "Liberation Sans", Arial, sans-serif; fill: var(--text); font-variant-numeric: tabular-nums; }
svg .name, svg .value, svg .label, svg .missing, svg .number { paint-order: stroke; stroke: var(--page); stroke-width: 3px; stroke-linejoin: round; }
svg .name { font: 10.5px ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, "Liberation Mono", monospace; }
svg .number { font-weight: 700; text-anchor: end; }
svg .tick { fill: var(--soft); font-size: 10.5px; }
svg .title { fill: var(--soft); }
svg .middle { text-anchor: middle; }
svg .end { text-anchor: end; }
svg .missing { font-style: italic; fill: var(--warn); }
svg .label { font-weight: 600; }
svg .grid { stroke: var(--grid); fill: none; }
svg .axis { stroke: var(--soft); fill: none; }
svg .first { stroke: var(--first); fill: none; stroke-dasharray: 4 3; }
svg .bar { fill: var(--bar); }
svg .stem { stroke: var(--bar); stroke-width: 1.2; stroke-dasharray: 2 2; fill: none; }
svg .spread { stroke: var(--text); stroke-width: 1.2; fill: none; }
svg .paper-mark { fill: var(--page); stroke: var(--paper-ink); stroke-width: 1.8; }
svg .leader { stroke: var(--soft); stroke-width: .7; fill: none; stroke-dasharray: 1.5 1.5; }
svg .hover { fill: none; pointer-events: all; }
svg .line { stroke: var(--c); stroke-width: 1.8; fill: none; stroke-linejoin: round; }
svg g[class] .spread { stroke: var(--c); }
svg .marker { fill: var(--c); stroke: var(--page); stroke-width: .8; }
svg .marker.open { fill: var(--page); stroke: var(--c); stroke-width: 1.8; }
.c0 { --c: var(--c0); } .c1 { --c: var(--c1); } .c2 { --c: var(--c2); } .c3 { --c: var(--c3); }
.c4 { --c: var(--c4); } .c5 { --c: var(--c5); } .c6 { --c: var(--c6); } .c7 { --c: var(--c7); }
g.lit .hover { fill: var(--panel); }
g.lit .bar { fill: var(--accent); }
g.lit .marker { stroke: var(--text); stroke-width: 2; }
g.lit .line { stroke-width: 3.2; }
g.lit text { font-weight: 700; }
.key { list-style: none; margin: .4rem 0 0; padding: 0; font-size: .84rem; line-height: 1.35; }
.key li { padding: .18rem 0 .18rem 42px; position: relative; }
.key li.lit { background: var(--panel); }
.key svg { position: absolute; left: 2px; top: .38rem; width: 34px; height: 14px; }
.key-panel { max-width: none; }
details { margin: 1rem 0; }
summary { cursor: pointer; color: var(--accent); }
.legend { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 340px), 1fr)); gap: 14px 30px; margin: 1rem 0; }
.legend dt { font-weight: 600; }
.legend dt .words { margin-left: .5em; font-size: .8rem; }
.legend dd { margin: .1rem 0 0; font-size: .92rem; }
.sources { padding-left: 1.2rem; max-width: 80ch; }
@media (max-width: 640px) {
  wbr.narrow { display: inline; }
  body { padding: 18px 14px 48px; }
  h1 { font-size: 1.5rem; } h2 { font-size: 1.25rem; margin-top: 2.2rem; }
  h2 small, h3 small { display: block; margin: .1rem 0 0; }
  th[scope=row], table.overview th[scope=row] { min-width: 9.6rem; max-width: 9.6rem; font-size: .78rem; }
  th, td { padding: .36rem .42rem; }
}
@media print {
  @page { size: A4 landscape; margin: 11mm; }
  body { max-width: none; padding: 0; font-size: 10.5pt; }
  nav { display: none; }
  .scroll { overflow: visible; }
  table { font-size: 7.6pt; } th, td { padding: 2pt 3pt; }
  th[scope=row] { min-width: 0; position: relative; } thead th:first-child { position: static; }
  figure, tr, .legend > div, .findings, .pictures figure { break-inside: avoid; }
  h2, h3, caption { break-after: avoid; }
  .charts { grid-template-columns: repeat(3, 1fr); gap: 10pt 14pt; }
  .pictures { grid-template-columns: repeat(4, 1fr); }
  .legend { grid-template-columns: repeat(3, 1fr); }
  * { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
}
)css";

constexpr std::string_view kScript = R"js(
'use strict';
for (const table of document.querySelectorAll('table')) {
  const body = table.tBodies[0], heads = [...table.tHead.rows[0].cells];
  const value = (row, column) => {
    const cell = row.cells[column];
    return cell === undefined || cell.dataset.v === undefined ? NaN : Number(cell.dataset.v);
  };
  heads.forEach((head, column) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener('click', () => {
      const sign = head.getAttribute('aria-sort') === 'ascending' ? -1 : 1;
      heads.forEach(other => other.removeAttribute('aria-sort'));
      head.setAttribute('aria-sort', sign === 1 ? 'ascending' : 'descending');
      const known = [], unknown = [];
      for (const row of body.rows) (Number.isNaN(value(row, column)) ? unknown : known).push(row);
      known.sort((a, b) => {
        const x = value(a, column), y = value(b, column);
        return x === y ? 0 : sign * (x > y ? 1 : -1);
      });
      body.append(...known, ...unknown);
    });
  });
}
let lit = null;
document.addEventListener('mouseover', event => {
  const part = event.target.closest('[data-row]');
  const row = part === null ? null : part.dataset.row;
  if (row === lit) return;
  for (const old of document.querySelectorAll('.lit')) old.classList.remove('lit');
  lit = row;
  if (row === null) return;
  for (const other of document.querySelectorAll('[data-row="' + row + '"]')) other.classList.add('lit');
});
window.addEventListener('beforeprint', () => {
  for (const folded of document.querySelectorAll('details')) folded.open = true;
});
)js";

}  // namespace

std::string_view page_style() { return kStyle; }

std::string_view page_script() { return kScript; }

}  // namespace kerf::report
