#include "output/report_parts.hpp"

namespace mpm::output::report {

/// System fonts only, two themes from one set of variables, and rules that keep figures whole on paper.
const char* style() {
  return R"css(
:root { --text: #1c2330; --soft: #5a6475; --page: #ffffff; --panel: #f4f6f9; --line: #d9dee6; --accent: #0072b2;
  --good: #00714f; --good-panel: #e6f4ee; --bad: #b3261e; --bad-panel: #fceceb; --warn: #8a5a00;
  --warn-panel: #fdf4e0; }
@media (prefers-color-scheme: dark) { :root { --text: #e6e9ef; --soft: #a3adbd; --page: #14181f; --panel: #1e242e;
  --line: #363e4b; --accent: #6bbdf0; --good: #5fd3a8; --good-panel: #12302a; --bad: #ff8f85; --bad-panel: #3d1b19;
  --warn: #f0c060; --warn-panel: #352a10; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--text); font: 16px/1.55 system-ui, "Segoe UI", Roboto,
  "Helvetica Neue", Arial, sans-serif; overflow-wrap: break-word; }
main { max-width: 60rem; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .6rem; text-wrap: balance; }
h2 { font-size: 1.25rem; margin: 2.6rem 0 .8rem; padding-top: .9rem; border-top: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 1.6rem 0 .5rem; }
section > h3::first-letter { text-transform: uppercase; }
sup { line-height: 0; font-size: .75em; }
p { margin: .5rem 0; max-width: 46rem; }
a { color: var(--accent); }
.soft, figcaption { color: var(--soft); font-size: .9rem; }
.banner { margin: 1.4rem 0 .8rem; padding: .8rem 1rem; border-left: .35rem solid; border-radius: .3rem; }
.banner strong { display: block; font-size: 1.08rem; }
.banner span { color: var(--text); }
.banner ul { margin: .3rem 0 0; padding-left: 1.2rem; color: var(--text); }
.good { color: var(--good); background: var(--good-panel); border-color: var(--good); }
.bad { color: var(--bad); background: var(--bad-panel); border-color: var(--bad); }
.warn { color: var(--warn); background: var(--warn-panel); border-color: var(--warn); }
.verdict { font-weight: 600; white-space: nowrap; background: none; }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(10.5rem, 1fr)); gap: .7rem; margin: 1.2rem 0; }
.card { background: var(--panel); border-radius: .4rem; padding: .7rem .9rem; }
.card dt { color: var(--soft); font-size: .84rem; }
.card dd { margin: .1rem 0 0; font-size: 1.22rem; font-weight: 600; font-variant-numeric: tabular-nums;
  line-height: 1.3; }
.card small { display: block; font-size: .8rem; font-weight: 400; color: var(--soft); }
.scroll { overflow-x: auto; margin: .6rem 0; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums; min-width: 100%; }
table.pairs, table.bars { min-width: min(100%, 34rem); }
th, td { text-align: left; vertical-align: top; padding: .38rem .8rem .38rem 0; border-bottom: 1px solid var(--line);
  overflow-wrap: normal; }
th { font-weight: 600; }
thead th { color: var(--soft); font-size: .84rem; }
table tbody th { font-weight: 400; color: var(--soft); }
td.number, th.number { text-align: right; white-space: nowrap; }
table.pairs > tbody > tr > td.number { text-align: left; }
td table { min-width: 0; font-size: 1em; }
td .scroll { margin: 0; }
td table tr:last-child > * { border-bottom: 0; }
section > .scroll > table.pairs > tbody > tr > th { width: 15rem; }
td.number { padding-right: 1.4rem; } thead th.number { padding-right: 1.4rem; }
tr.total > * { font-weight: 700; color: var(--text); border-top: 2px solid var(--soft); }
td.bar { width: 38%; min-width: 8rem; padding-right: 0; }
.track { position: relative; display: block; height: .8rem; margin-top: .35rem; background: var(--panel);
  border-radius: .15rem; }
.track i { position: absolute; top: 0; bottom: 0; min-width: 1px; background: var(--accent); border-radius: .15rem;
  print-color-adjust: exact; -webkit-print-color-adjust: exact; }
.track i.minus { background: #d55e00; }
.track b { position: absolute; top: -.15rem; bottom: -.15rem; width: 1px; background: var(--soft); }
figure { margin: 1.2rem 0 1.8rem; break-inside: avoid; }
figure img { display: block; width: 100%; height: auto; background: #fff; border: 1px solid var(--line);
  border-radius: .3rem; }
figcaption { margin-top: .4rem; display: flex; flex-wrap: wrap; gap: 0 1rem; justify-content: space-between; }
figcaption b { color: var(--text); font-weight: 600; }
.strip { display: grid; grid-template-columns: repeat(auto-fill, minmax(13rem, 1fr)); gap: .8rem; }
.strip figure { margin: 0; }
.method { margin: 0 0 1rem; padding-left: .9rem; border-left: 3px solid var(--line); break-inside: avoid; }
.method h3 { margin: 0; }
.method h3 span { font-weight: 400; color: var(--soft); font-size: .88rem; }
.method p { margin: .15rem 0; }
td code { overflow-wrap: anywhere; }
code, pre { font: .86rem/1.5 ui-monospace, "Cascadia Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace; }
pre { background: var(--panel); border-radius: .4rem; padding: .8rem 1rem; overflow-x: auto; white-space: pre-wrap;
  overflow-wrap: anywhere; }
details { margin: .6rem 0; }
summary { cursor: pointer; color: var(--accent); }
ul.files { columns: 2; padding-left: 1.2rem; }
@media (max-width: 36rem) { main { padding: 1.2rem .9rem 3rem; } h1 { font-size: 1.5rem; } ul.files { columns: 1; }
  .cards { grid-template-columns: repeat(2, 1fr); gap: .5rem; } .card { padding: .55rem .7rem; }
  .card dd { font-size: 1.08rem; } .strip { grid-template-columns: repeat(2, 1fr); } td.bar { min-width: 6rem; } }
@media print { :root { --text: #000; --soft: #444; --page: #fff; --panel: #f4f6f9; --line: #bbb; --accent: #0072b2;
  --good: #00714f; --good-panel: #fff; --bad: #b3261e; --bad-panel: #fff; --warn: #8a5a00; --warn-panel: #fff; }
  body { font-size: 10.5pt; } main { max-width: none; padding: 0; } h2, h3 { break-after: avoid; }
  details::details-content { content-visibility: visible; block-size: auto; }
  tr, .card, .banner { break-inside: avoid; } .scroll { overflow: visible; } a { text-decoration: none; } }
)css";
}

}  // namespace mpm::output::report
