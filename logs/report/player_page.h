#pragma once

namespace roundabout::logs {

/// What the player shows, before its script fills it.
inline constexpr const char* kPlayerBody = R"html(
<style>
.player { display: grid; grid-template-columns: minmax(0, 3fr) minmax(0, 2fr); gap: 14px; }
.player canvas { width: 100%; display: block; }
#map { border: 1px solid var(--line); border-radius: 6px; aspect-ratio: 1 / 1; }
.player .side { display: flex; flex-direction: column; min-height: 0; }
.player .bar { grid-column: 1 / -1; display: flex; gap: 10px; align-items: center; font-variant-numeric: tabular-nums; }
.player .bar input { flex: 1; }
.player .bar output { min-width: 110px; text-align: right; }
.player .over { grid-column: 1 / -1; }
#events { overflow-y: auto; flex: 1 1 0; min-height: 150px; margin: 10px 0 0; padding: 0; list-style: none; font-size: 12.5px; border-top: 1px solid var(--line); }
#events li { padding: 2px 6px; cursor: pointer; display: flex; gap: 8px; }
#events li.now { background: #eef2f7; }
#events time { color: var(--quiet); min-width: 52px; text-align: right; font-variant-numeric: tabular-nums; }
#now i { display: inline-block; width: 10px; height: 10px; border-radius: 5px; margin-right: 6px; }
@media print { .player .bar, .player .side { display: none; } .player { display: block; } }
</style>
<h2>The flight</h2>
<div class="player">
<div class="bar"><button id="play" title="space">play</button>
<select id="speed" title="times real time"><option>0.25</option><option>0.5</option><option selected>1</option><option>2</option><option>5</option><option>10</option></select>×
<input id="slider" type="range" min="0" step="0.01" value="0" aria-label="time"><output id="clock"></output></div>
<canvas id="map"></canvas>
<div class="side"><table id="now"><thead><tr><th>vehicle</th><th>height (m)</th><th>speed (m/s)</th><th>to goal (m)</th><th>mode</th></tr></thead><tbody></tbody></table>
<ul id="events"></ul></div>
<div class="over"><canvas id="gap" height="130"></canvas><canvas id="modes"></canvas></div>
</div>
<p class="quiet">Discs are bodies, rings what policies assume, crosses goals, lines the last 4 s. Click a curve or an event to go there; space plays, arrow keys step 0.1 s, with shift 5 s.</p>
)html";

inline constexpr const char* kPlayerScript = R"js(
"use strict";
(() => {
const F = JSON.parse(document.getElementById("flight").textContent);
const $ = id => document.getElementById(id);
const T = F.t, end = T[T.length - 1], N = F.vehicles.length;
const MODE = { waiting: "#c9ced6", on_floor: "#dfe3e9", taking_off: "#8fc7e8", flying: "#3b7dd8",
  at_goal: "#58b87a", holding: "#f0a020", landing: "#a98fd8", landed: "#dfe3e9", killed: "#b3261e" };
const color = mode => MODE[mode] || "#888888";
let now = 0, playing = false, last = null;

function index(t) {  // the last frame at or before t
  let low = 0, high = T.length - 1;
  while (low < high) {
    const mid = (low + high + 1) >> 1;
    if (T[mid] <= t) low = mid; else high = mid - 1;
  }
  return low;
}
function placeAt(v, t) {
  const i = index(t), a = v.places[i], b = v.places[Math.min(i + 1, T.length - 1)];
  if (!a || !b) return a;
  const span = T[Math.min(i + 1, T.length - 1)] - T[i], s = span > 0 ? (t - T[i]) / span : 0;
  return a.map((value, k) => value + (b[k] - value) * s);
}
function latest(list, t) {
  let found = null;
  for (const entry of list) { if (entry[0] > t) break; found = entry; }
  return found;
}
function canvas(id, height) {
  const c = $(id), ratio = window.devicePixelRatio || 1, width = c.clientWidth || 600;
  const tall = height || c.clientHeight || width;
  c.width = width * ratio; c.height = tall * ratio;
  if (height) c.style.height = height + "px";
  const g = c.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, width, tall);
  g.font = "12px sans-serif";
  return { g, width, height: tall };
}

const bounds = (() => {
  if (F.room) return F.room;
  let b = [Infinity, Infinity, -Infinity, -Infinity];
  for (const v of F.vehicles) for (const p of v.places) if (p)
    b = [Math.min(b[0], p[0] - 1000), Math.min(b[1], p[1] - 1000), Math.max(b[2], p[0] + 1000), Math.max(b[3], p[1] + 1000)];
  return isFinite(b[0]) ? b : [-1000, -1000, 1000, 1000];
})();

function drawMap() {
  const { g, width, height } = canvas("map");
  const scale = Math.min((width - 30) / (bounds[2] - bounds[0]), (height - 30) / (bounds[3] - bounds[1]));
  const X = x => width / 2 + (x - (bounds[0] + bounds[2]) / 2) * scale;
  const Y = y => height / 2 - (y - (bounds[1] + bounds[3]) / 2) * scale;
  g.strokeStyle = "#e6eaf0"; g.fillStyle = "#8a94a3"; g.lineWidth = 1;
  const grid = (bounds[2] - bounds[0]) > 30000 ? 5000 : 1000;
  for (let x = Math.ceil(bounds[0] / grid) * grid; x <= bounds[2]; x += grid) {
    g.beginPath(); g.moveTo(X(x), Y(bounds[1])); g.lineTo(X(x), Y(bounds[3])); g.stroke();
    if (x % (2 * grid) === 0) g.fillText(x / 1000, X(x) - 4, Y(bounds[1]) + 13);
  }
  for (let y = Math.ceil(bounds[1] / grid) * grid; y <= bounds[3]; y += grid) {
    g.beginPath(); g.moveTo(X(bounds[0]), Y(y)); g.lineTo(X(bounds[2]), Y(y)); g.stroke();
    if (y % (2 * grid) === 0) g.fillText(y / 1000, X(bounds[0]) - 14, Y(y) + 4);
  }
  g.strokeStyle = "#667385"; g.strokeRect(X(bounds[0]), Y(bounds[3]), (bounds[2] - bounds[0]) * scale, (bounds[3] - bounds[1]) * scale);
  g.fillStyle = "#9aa3af";
  for (const corners of F.obstacles) {
    g.beginPath(); corners.forEach((c, i) => i ? g.lineTo(X(c[0]), Y(c[1])) : g.moveTo(X(c[0]), Y(c[1]))); g.fill();
  }
  for (const v of F.vehicles) {
    const p = placeAt(v, now), goal = latest(v.goals, now);
    g.strokeStyle = g.fillStyle = v.color;
    if (goal) {
      const x = X(goal[1]), y = Y(goal[2]);
      g.lineWidth = 2; g.beginPath(); g.moveTo(x - 5, y - 5); g.lineTo(x + 5, y + 5); g.moveTo(x + 5, y - 5); g.lineTo(x - 5, y + 5); g.stroke();
    }
    g.lineWidth = 1.5; g.globalAlpha = 0.6; g.beginPath();
    let pen = false;
    for (let i = index(now - 4); i <= index(now); ++i) {
      const q = v.places[i];
      if (!q) { pen = false; continue; }
      if (pen) g.lineTo(X(q[0]), Y(q[1])); else g.moveTo(X(q[0]), Y(q[1]));
      pen = true;
    }
    if (p) g.lineTo(X(p[0]), Y(p[1]));
    g.stroke(); g.globalAlpha = 1;
    if (!p) continue;
    g.globalAlpha = 0.35; g.lineWidth = 1; g.beginPath(); g.arc(X(p[0]), Y(p[1]), v.assumed * scale, 0, 7); g.stroke();
    g.globalAlpha = p[2] > 150 ? 0.85 : 0.3; g.beginPath(); g.arc(X(p[0]), Y(p[1]), Math.max(v.body * scale, 3), 0, 7); g.fill();
    g.globalAlpha = 1; g.fillStyle = "#1d2733"; g.textAlign = "center";
    g.fillText(v.name, X(p[0]), Y(p[1]) - v.assumed * scale - 3); g.textAlign = "left";
  }
}

const left = 64;
function axis(width) { const w = width - left - 8; return { x: t => left + w * t / (end || 1), t: x => Math.max(0, Math.min(end, (x - left) / w * end)) }; }
function cursor(g, a, height) { g.strokeStyle = "#b3261e"; g.lineWidth = 1; g.beginPath(); g.moveTo(a.x(now), 0); g.lineTo(a.x(now), height); g.stroke(); }

function drawGap() {
  const { g, width, height } = canvas("gap", 130), a = axis(width), top = 3000, bottom = Math.min(-200, ...F.gaps.filter(x => x !== null));
  const Y = mm => 8 + (height - 26) * (top - Math.min(mm, top)) / (top - bottom);
  g.fillStyle = "#667385"; g.fillText("gap (m)", 2, height / 2);
  for (const m of [0, 1, 2, 3]) {
    g.strokeStyle = m ? "#e6eaf0" : "#c62828"; g.beginPath(); g.moveTo(left, Y(m * 1000)); g.lineTo(width - 8, Y(m * 1000)); g.stroke();
    g.fillText(m, left - 14, Y(m * 1000) + 4);
  }
  const margin = F.vehicles.map(v => v.assumed - v.body).sort((x, y) => y - x).slice(0, 2).reduce((x, y) => x + y, 0);
  g.strokeStyle = "#e08a00"; g.setLineDash([5, 4]); g.beginPath(); g.moveTo(left, Y(margin)); g.lineTo(width - 8, Y(margin)); g.stroke(); g.setLineDash([]);
  g.strokeStyle = "#1f4e79"; g.lineWidth = 1.4; g.beginPath();
  let pen = false;
  F.gaps.forEach((gap, i) => {
    if (gap === null) { pen = false; return; }
    if (pen) g.lineTo(a.x(T[i]), Y(gap)); else g.moveTo(a.x(T[i]), Y(gap));
    pen = true;
  });
  g.stroke();
  const step = [1, 2, 5, 10, 20, 60, 120, 300, 600].find(s => end / s < 14) || 1200;
  for (let t = 0; t <= end; t += step) g.fillText(t + " s", Math.min(a.x(t) - 6, width - 36), height - 4);
  cursor(g, a, height - 16);
}
function drawModes() {
  const row = 16, height = row * N + 24, { g, width } = canvas("modes", height), a = axis(width);
  const seen = new Set();
  F.vehicles.forEach((v, i) => {
    g.fillStyle = "#1d2733"; g.fillText(v.name, 4, i * row + 12);
    v.modes.forEach((m, k) => {
      const to = k + 1 < v.modes.length ? v.modes[k + 1][0] : end;
      seen.add(m[1]);
      g.fillStyle = color(m[1]); g.fillRect(a.x(m[0]), i * row + 2, Math.max(a.x(to) - a.x(m[0]), 0.5), row - 4);
    });
  });
  let x = left;
  for (const mode of seen) {
    g.fillStyle = color(mode); g.fillRect(x, height - 15, 10, 10);
    g.fillStyle = "#667385"; g.fillText(mode, x + 14, height - 6); x += g.measureText(mode).width + 30;
  }
  cursor(g, a, row * N);
}

const rows = F.vehicles.map(v => {
  const tr = $("now").tBodies[0].insertRow();
  const name = tr.insertCell(), dot = document.createElement("i");
  dot.style.background = v.color; name.append(dot, v.name);
  return [0, 1, 2, 3].map(() => tr.insertCell());
});
const items = F.events.map(([t, text, look]) => {
  const li = document.createElement("li"), time = document.createElement("time"), span = document.createElement("span");
  time.textContent = t.toFixed(1) + " s"; span.textContent = text; span.className = look;
  li.append(time, span); li.onclick = () => seek(t); $("events").append(li);
  return li;
});
let marked = -1;
function drawText() {
  $("clock").textContent = now.toFixed(2) + " / " + end.toFixed(1) + " s";
  $("slider").value = now;
  F.vehicles.forEach((v, i) => {
    const p = placeAt(v, now), goal = latest(v.goals, now), mode = latest(v.modes, now), cells = rows[i];
    cells[0].textContent = p ? (p[2] / 1000).toFixed(2) : "unseen";
    cells[1].textContent = p ? (p[3] / 1000).toFixed(2) : "–";
    cells[2].textContent = p && goal ? (Math.hypot(p[0] - goal[1], p[1] - goal[2]) / 1000).toFixed(2) : "–";
    cells[3].textContent = mode ? mode[1] : "–"; cells[3].title = mode ? mode[2] : "";
  });
  let current = -1;
  F.events.forEach((e, i) => { if (e[0] <= now) current = i; });
  if (current !== marked) {
    if (marked >= 0) items[marked].classList.remove("now");
    marked = current;
    if (marked >= 0) { items[marked].classList.add("now"); const ul = $("events"); ul.scrollTop = items[marked].offsetTop - ul.offsetTop - ul.clientHeight / 2; }
  }
}
function draw() { drawMap(); drawGap(); drawModes(); drawText(); }
function seek(t) { now = Math.max(0, Math.min(end, t)); draw(); }
function play(on) {
  playing = on; last = null; $("play").textContent = on ? "pause" : "play";
  if (on && now >= end) now = 0;
  if (on) requestAnimationFrame(tick);
}
function tick(stamp) {
  if (!playing) return;
  if (last !== null) now += (stamp - last) / 1000 * Number($("speed").value);
  last = stamp;
  if (now >= end) { now = end; play(false); }
  draw();
  if (playing) requestAnimationFrame(tick);
}
$("slider").max = end;
$("slider").oninput = () => seek(Number($("slider").value));
$("play").onclick = () => play(!playing);
for (const id of ["gap", "modes"]) $(id).onclick = e => seek(axis($(id).clientWidth).t(e.offsetX));
addEventListener("keydown", e => {
  if (e.target.tagName === "SELECT") return;
  const step = e.shiftKey ? 5 : 0.1;
  if (e.key === " ") play(!playing); else if (e.key === "ArrowLeft") seek(now - step); else if (e.key === "ArrowRight") seek(now + step); else return;
  e.preventDefault();
});
addEventListener("resize", draw);
const at = () => { const found = /[#&]t=([0-9.]+)/.exec(location.hash); if (found) seek(Number(found[1])); };
addEventListener("hashchange", at);
draw(); at();
document.documentElement.dataset.player = "ready";
})();
)js";

}  // namespace roundabout::logs
