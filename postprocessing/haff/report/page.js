// Films, plots and the reload of a report. SPDX-License-Identifier: GPL-3.0-or-later
"use strict";
(() => {
const data = JSON.parse(document.getElementById("data").textContent);
const films = [...document.querySelectorAll("img[data-film]")].map(img => {
    const frames = data.films[img.dataset.film];
    frames[frames.length - 1][1] = img.src;
    return {img, frames};
});
const bar = document.getElementById("timebar"), slider = document.getElementById("time"), now = document.getElementById("now");
const play = document.getElementById("play");
const times = data.times, plots = [], kept = {};
let at = times.length - 1;

// ---- the slider ----

// The last of some ascending times that is not behind a time; the first where all are.
function upTo(list, time) {
    let k = 0;
    list.forEach((t, i) => { if (Number(t) <= Number(time)) k = i; });
    return k;
}

function show(k) {
    at = Math.min(Math.max(k, 0), times.length - 1);
    for (const film of films) {
        const frame = film.frames[upTo(film.frames.map(f => f[0]), times[at])];
        if (film.img.src !== frame[1]) {
            film.img.src = frame[1];
            film.img.alt = frame[2];
        }
    }
    slider.value = at;
    now.textContent = "t = " + Number(times[at]) + (data.unit ? " " + data.unit : "");
    slider.setAttribute("aria-valuetext", now.textContent);
    for (const plot of plots) plot.moved();
}

const moving = films.length > 0 || data.charts.some(c => c.frames);
if (times.length > 1 && moving) {
    bar.hidden = false;
    slider.max = times.length - 1;
    slider.addEventListener("input", () => { stop(); show(Number(slider.value)); });
}

let ticking = 0;
function stop() {
    clearInterval(ticking);
    ticking = 0;
    play.innerHTML = "&#9654;";
    play.setAttribute("aria-label", "play the film");
}
play.addEventListener("click", () => {
    if (ticking) return stop();
    if (at === times.length - 1) show(0);
    play.innerHTML = "&#10074;&#10074;";
    play.setAttribute("aria-label", "stop the film");
    ticking = setInterval(() => at < times.length - 1 ? show(at + 1) : stop(), 250);
});

// ---- plots ----

const style = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹";
function short(v) {
    if (v == null) return "–";
    if (v === 0) return "0";
    const size = Math.abs(v);
    if (size >= 1e-3 && size < 1e5) return String(Number(v.toPrecision(5)));
    const [m, e] = v.toExponential(3).split("e");
    const power = [...String(Math.abs(e))].map(d => RAISED[d]).join("");
    return (Number(m) === 1 ? "" : Number(m) + "·") + "10" + (e < 0 ? "⁻" : "") + power;
}

// A number along an axis, with the digits that its neighbours ask for.
function marked(v, step) {
    if (!(step > 0 && step < 0.1 && Math.abs(v) >= 0.1 && Math.abs(v) < 1e5)) return short(v);
    return String(Number(v.toFixed(Math.min(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) + 1, 12))));
}

// The columns of a chart: given ones, or of profiles those of the first, the chosen and the last time.
function columns(chart) {
    if (!chart.frames) return {series: chart.series, data: chart.data};
    const here = upTo(chart.times, times[at]), last = chart.times.length - 1;
    if (chart.labels) return {series: chart.labels.map(label => ({label})), data: [chart.data[0], ...chart.frames[here]]};
    const label = k => "t = " + Number(chart.times[k]) + (data.unit ? " " + data.unit : "");
    const chosen = [[here, "chosen"], [0, "first"], [last, "last"]].filter(([k], i) => i === 0 || last > 0);
    return {series: chosen.map(([k, kind]) => ({label: kind === "chosen" ? label(k) : kind + ", " + label(k), kind})),
        data: [chart.data[0], ...chosen.map(([k]) => chart.frames[k])]};
}

function ends(chart) {
    let low = Infinity, high = -Infinity;
    for (const v of chart.frames.flat(2)) if (v != null) { low = Math.min(low, v); high = Math.max(high, v); }
    const room = high > low ? 0.04 * (high - low) : Math.abs(high) * 0.1 || 1;
    return [low - room, high + room];
}

function seriesOf(s, k, gaps) {
    const colour = s.kind === "line" || s.kind === "first" || s.kind === "last" ? style("--quiet") : style("--c" + k % 7);
    return {label: s.label, stroke: colour, width: s.points ? 0 : s.kind === "chosen" ? 2 : 1.25, dash: s.kind === "first" ? [4, 4] : undefined,
        paths: s.points ? () => null : undefined, spanGaps: gaps, value: (u, v, j, i) => short(i == null && !s.points ? u.data[j].findLast(d => d != null) : v),
        points: s.points ? {show: true, size: 4, width: 0, fill: colour} : {show: undefined, size: 4}};
}

// The time of the slider as a line through plots over time.
function marker(u) {
    if (bar.hidden) return;
    const x = u.valToPos(Number(times[at]), "x", true), {left, top, width, height} = u.bbox;
    if (!(x >= left && x <= left + width)) return;
    u.ctx.save();
    u.ctx.strokeStyle = style("--mark");
    u.ctx.lineWidth = devicePixelRatio;
    u.ctx.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
    u.ctx.beginPath();
    u.ctx.moveTo(x, top);
    u.ctx.lineTo(x, top + height);
    u.ctx.stroke();
    u.ctx.restore();
}

// Of the places along an axis by powers of ten: the powers, each third of many, and where these are few 2 and 5 times them.
function decades(u, list) {
    const some = list.filter(v => v != null && v > 0), few = some.length && some[some.length - 1] / some[0] < 100;
    const every = some.length && some[some.length - 1] / some[0] > 1e8 ? 3 : 1;
    return list.map(v => {
        const power = Math.floor(Math.log10(v) + 1e-9), lead = v > 0 ? Math.round(v / 10 ** power) : 0;
        return lead === 1 && power % every === 0 || few && (lead === 2 || lead === 5) ? v : null;
    });
}

function axis(label, size, log) {
    const filter = log ? decades : (u, list) => list;
    const text = style("--text"), font = "12px " + style("--sans");
    return {label, labelFont: font, font, stroke: text, size, labelSize: 22, labelGap: 0, filter, grid: {stroke: style("--rule"), width: 1, filter},
        ticks: {stroke: style("--rule"), width: 1, size: 4, filter}, values: (u, list, k, space, step) => list.map(v => v == null ? "" : marked(v, log ? 0 : step))};
}

function options(chart, found, width) {
    const y = chart.frames ? {range: ends(chart)} : chart.log ? {distr: 3} : {};
    const markers = {fill: (u, k) => found.series[k - 1] && found.series[k - 1].points ? style("--c" + (k - 1) % 7) : null};
    return {width, height: Math.round(Math.min(Math.max(0.5 * width, 190), 280)), legend: {live: true, markers},
        cursor: {sync: chart.time ? {key: "time", setSeries: false} : undefined, points: {size: 6}, drag: {x: true, y: false}},
        scales: {x: {time: false}, y}, axes: [axis(chart.x, 44), axis(chart.y, 62, chart.log)],
        series: [{label: chart.x, value: (u, v, j, i) => short(i == null ? u.data[0].findLast(d => d != null) : v)}, ...found.series.map((s, k) => seriesOf(s, k, !!chart.gaps))], hooks: {draw: chart.time ? [marker] : []}};
}

function plot(place) {
    const chart = data.charts[place.dataset.chart];
    let made = null, wide = 0;
    const make = () => {
        const found = columns(chart);
        if (made) made.destroy();
        wide = place.clientWidth;
        made = new uPlot(options(chart, found, wide), found.data, place);
    };
    make();
    const fit = () => { if (place.clientWidth && place.clientWidth !== wide) make(); };
    new ResizeObserver(() => requestAnimationFrame(fit)).observe(place);
    return {make, moved: () => chart.frames ? make() : chart.time && made.redraw(false, false)};
}

for (const place of document.querySelectorAll("[data-chart]")) plots.push(plot(place));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plots.forEach(p => p.make()));

for (const button of document.querySelectorAll(".zoom")) button.addEventListener("click", () => button.classList.toggle("large"));

// ---- reload, which keeps the place, the slider and what is unfolded ----

const KEY = "haff report " + location.pathname;
try { Object.assign(kept, JSON.parse(sessionStorage.getItem(KEY) || "{}")); } catch (e) { /* a browser that keeps nothing */ }
const unfolded = () => [...document.querySelectorAll("details")].map(d => d.open);
if (times.length) show(kept.last === false && kept.time !== undefined ? upTo(times, kept.time) : times.length - 1);
if (data.every) {
    const hold = document.getElementById("hold");
    if (kept.open) [...document.querySelectorAll("details")].forEach((d, k) => { d.open = !!kept.open[k]; });
    if (kept.scroll !== undefined) scrollTo(0, kept.scroll);
    let held = false;
    hold.addEventListener("click", () => {
        held = !held;
        hold.setAttribute("aria-pressed", held);
        hold.textContent = held ? "go on" : "hold";
    });
    setInterval(() => {
        if (held || ticking || document.hidden) return;
        try {
            sessionStorage.setItem(KEY, JSON.stringify({scroll: scrollY, time: times[at], last: at === times.length - 1, open: unfolded()}));
        } catch (e) { /* as above */ }
        location.reload();
    }, 1000 * data.every);
}
})();
