#pragma once

namespace roundabout::logs {

/// The report's look on screen and on paper.
inline constexpr const char* kReportStyle = R"css(
:root { --ink: #1d2733; --quiet: #667385; --line: #dde3ea; --good: #1b7f4b; --bad: #b3261e; --warn: #a85b00; }
* { box-sizing: border-box; }
body { font: 14px/1.45 "Segoe UI", "DejaVu Sans", Helvetica, Arial, sans-serif; color: var(--ink);
  max-width: 1120px; margin: 28px auto; padding: 0 24px; }
h1 { font-size: 26px; margin: 0; }
h2 { font-size: 17px; margin: 30px 0 10px; padding-bottom: 4px; border-bottom: 1px solid var(--line); }
p { margin: 6px 0; }
.quiet { color: var(--quiet); }
.verdict { border-left: 6px solid var(--good); background: #eef7f1; padding: 12px 18px; margin: 16px 0; font-size: 18px; }
.verdict.failed { border-color: var(--bad); background: #fcefee; }
.verdict ul { font-size: 14px; margin: 6px 0 0; padding-left: 20px; }
.cards { display: grid; grid-template-columns: repeat(4, 1fr); gap: 12px; }
.card { border: 1px solid var(--line); border-radius: 6px; padding: 10px 14px; }
.card b { display: block; font-size: 22px; font-weight: 600; }
.card span { color: var(--quiet); font-size: 12.5px; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: 13px; }
th { text-align: right; font-weight: 600; color: var(--quiet); border-bottom: 2px solid var(--line); padding: 4px 8px; vertical-align: bottom; }
td { text-align: right; border-bottom: 1px solid var(--line); padding: 4px 8px; }
th:first-child, td:first-child { text-align: left; }
.good { color: var(--good); } .bad { color: var(--bad); font-weight: 600; } .warn { color: var(--warn); }
.plans { display: grid; grid-template-columns: repeat(3, 1fr); gap: 10px; }
.plans img { width: 100%; height: 340px; object-fit: contain; }
img { max-width: 100%; }
figure { margin: 0 0 10px; text-align: center; } figcaption { color: var(--quiet); font-size: 12.5px; }
pre { background: #f6f8fa; border: 1px solid var(--line); border-radius: 6px; padding: 12px; font-size: 11.5px; overflow-x: auto; }
details summary { cursor: pointer; color: var(--quiet); }
@media print { body { margin: 0; font-size: 11px; } .verdict { font-size: 14px; } h2 { margin-top: 14px; }
  .plans img { height: 230px; } details { display: none; } h2, table, img { break-inside: avoid; } }
)css";

}  // namespace roundabout::logs
