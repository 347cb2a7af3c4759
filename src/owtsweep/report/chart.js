// Draws curves over one axis as SVG: lines with bands, labels at their right ends, marks.

const SVG = "http://www.w3.org/2000/svg";

/** Make an element of a drawing. */
function draw(name, attributes, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

/** Make an empty chart. `label` tells of it to those who do not see it. */
function openChart(width, height, label) {
  const box = {viewBox: `0 0 ${width} ${height}`, width, height};
  return draw("svg", {class: "chart", ...box, role: "img", "aria-label": label});
}

/** Write a number beside an axis. */
function writeTick(svg, value, x, y, anchor) {
  const look = {class: "tick", x, y, "text-anchor": anchor};
  svg.append(draw("text", look, Number(value.toPrecision(3)).toString()));
}

/** Write what the axis below a chart shows. */
function writeAxis(svg, text, x, y) {
  svg.append(draw("text", {class: "axis", x, y, "text-anchor": "middle"}, text));
}

/** Return a function from values to pixels, and its ticks. */
function makeScale(low, high, from, to, logarithmic) {
  const f = logarithmic ? Math.log10 : (value) => value;
  const span = f(high) - f(low) || 1;
  const place = (value) => from + ((f(value) - f(low)) / span) * (to - from);
  const ticks = [];
  if (logarithmic) {
    const decades = f(high) - f(low);
    const steps = decades > 4 ? [1] : decades > 1.2 ? [1, 3] : [1, 1.5, 2, 3, 5, 7];
    for (let e = Math.floor(f(low)); e <= Math.ceil(f(high)); e += 1) {
      for (const step of steps) ticks.push(step * 10 ** e);
    }
  } else {
    const raw = span / 5;
    const unit = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((n) => n * unit).find((each) => each >= raw);
    for (let n = Math.ceil(low / step); n * step <= high * (1 + 1e-9); n += 1) ticks.push(n * step);
  }
  const inside = ticks.filter((value) => value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9));
  return {place, ticks: inside};
}

/** Move labels apart, so that none lies on another. */
function spread(labels, least, bottom) {
  labels.sort((a, b) => a.y - b.y);
  for (let i = 1; i < labels.length; i += 1) {
    labels[i].y = Math.max(labels[i].y, labels[i - 1].y + least);
  }
  let limit = bottom;
  for (let i = labels.length - 1; i >= 0; i -= 1) {
    labels[i].y = Math.min(labels[i].y, limit);
    limit = labels[i].y - least;
  }
}

/**
 * Return a chart. `curves`: name, colour, dash, and points [x, y, low, high]; NaN for a gap or no
 * band. `at`: x of a vertical line, or null. `label`: of the whole, for those who do not see it.
 */
function drawChart({curves, xLabel, yLabel, xLog, yLog, at, label, ticks}) {
  const [width, height, left, right, top, bottom] = [620, 300, 60, 110, 26, 42];
  const points = curves.flatMap((curve) => curve.points);
  const usable = (value) => Number.isFinite(value) && (!yLog || value > 0);
  const xs = points.map((p) => p[0]);
  const ys = points.map((p) => p[1]).filter(usable);
  if (!ys.length) return null;
  const ends = points.flatMap((p) => [p[2], p[3]]).filter(usable);
  let [yLow, yHigh] = [Math.min(...ys), Math.max(...ys)];
  const [lowest, highest] = [Math.min(yLow, ...ends), Math.max(yHigh, ...ends)];
  // on a logarithmic axis a band that nearly reaches 0 is cut, not the curves
  yLow = yLog ? Math.max(lowest, yLow / 3) : lowest;
  yHigh = yLog ? Math.min(highest, yHigh * 3) : highest;
  if (yLow === yHigh) [yLow, yHigh] = yLog ? [yLow / 2, yHigh * 2] : [yLow - 1, yHigh + 1];
  const x = makeScale(Math.min(...xs), Math.max(...xs), left, width - right, xLog);
  const y = makeScale(yLow, yHigh, height - bottom, top, yLog);
  const svg = openChart(width, height, label);
  for (const value of y.ticks) {
    const place = y.place(value);
    svg.append(draw("line", {class: "rule", x1: left, x2: width - right, y1: place, y2: place}));
    writeTick(svg, value, left - 6, place + 4, "end");
  }
  let before = -Infinity;
  for (const value of ticks || x.ticks) {
    const place = x.place(value);
    if (place - before < 34) continue;
    before = place;
    writeTick(svg, value, place, height - bottom + 16, "middle");
  }
  writeAxis(svg, xLabel, (left + width - right) / 2, height - 6);
  svg.append(draw("text", {class: "axis", x: 4, y: 14}, yLabel));
  if (at !== null && Number.isFinite(x.place(at))) {
    const place = x.place(at);
    svg.append(draw("line", {class: "here", x1: place, x2: place, y1: top, y2: height - bottom}));
  }
  const clip = (value) => Math.min(Math.max(value, top), height - bottom);
  const labels = [];
  for (const curve of curves) {
    const shown = curve.points.filter((p) => usable(p[1]));
    if (!shown.length) continue;
    const banded = shown.filter((p) => Number.isFinite(p[2]) && Number.isFinite(p[3]));
    if (banded.length > 1) {
      const low = (p) => (yLog && p[2] <= 0 ? height - bottom : clip(y.place(p[2])));
      const upper = banded.map((p) => `${x.place(p[0])},${clip(y.place(p[3]))}`);
      const lower = banded.map((p) => `${x.place(p[0])},${low(p)}`).reverse();
      const all = [...upper, ...lower].join(" ");
      svg.append(draw("polygon", {points: all, fill: curve.color, "fill-opacity": 0.18}));
    }
    const line = shown.map((p) => `${x.place(p[0])},${y.place(p[1])}`).join(" ");
    svg.append(
      draw("polyline", {
        points: line,
        fill: "none",
        stroke: curve.color,
        "stroke-width": curve.bold ? 3 : 1.8,
        "stroke-dasharray": curve.dash,
      }),
    );
    for (const p of curve.dots ? shown : shown.length === 1 ? shown : []) {
      svg.append(draw("circle", {cx: x.place(p[0]), cy: y.place(p[1]), r: 2.6, fill: curve.color}));
    }
    labels.push({
      name: curve.name,
      color: curve.color,
      end: y.place(shown.at(-1)[1]),
      y: y.place(shown.at(-1)[1]),
      x: x.place(shown.at(-1)[0]),
    });
  }
  spread(labels, 13, height - bottom);
  for (const each of labels) {
    const from = width - right + 4;
    svg.append(
      draw("line", {
        x1: each.x,
        x2: from + 8,
        y1: each.end,
        y2: each.y,
        stroke: each.color,
        "stroke-width": 1,
      }),
    );
    svg.append(draw("text", {class: "tick", x: from + 12, y: each.y + 4}, shorten(each.name, 14)));
  }
  return svg;
}

/**
 * Return a chart of single values: a line of dots for each name, over one axis.
 *
 * `lines`: name, colour and values. The mark is the median.
 */
function drawDots({lines, xLabel, label}) {
  const [width, left, right, step, bottom] = [620, 130, 20, 24, 44];
  const values = lines.flatMap((line) => line.values).filter(Number.isFinite);
  if (!values.length) return null;
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const spare = low === high ? Math.abs(low) / 2 || 1 : 0;
  const x = makeScale(low - spare, high + spare, left, width - right, low > 0 && !spare);
  const height = step * lines.length + bottom;
  const svg = openChart(width, height, label);
  for (const value of x.ticks) {
    const place = x.place(value);
    svg.append(draw("line", {class: "rule", x1: place, x2: place, y1: 0, y2: height - bottom}));
    writeTick(svg, value, place, height - bottom + 16, "middle");
  }
  writeAxis(svg, xLabel, (left + width - right) / 2, height - 6);
  lines.forEach(({name, color, values: all}, number) => {
    const y = step * (number + 0.5);
    const look = {class: "tick", x: left - 8, y: y + 4, "text-anchor": "end"};
    svg.append(draw("text", look, shorten(name, 16)));
    const sorted = all.filter(Number.isFinite).sort((a, b) => a - b);
    for (const value of sorted) {
      const dot = {cx: x.place(value), cy: y, r: 3, fill: color, "fill-opacity": 0.55};
      svg.append(draw("circle", dot));
    }
    if (!sorted.length) return;
    const place = x.place(sorted[Math.floor(sorted.length / 2)]);
    svg.append(draw("line", {class: "median", x1: place, x2: place, y1: y - 8, y2: y + 8}));
  });
  return svg;
}
