// Reads a stretch of one record: the truth and the estimates of all schemes over time.

/** Return the numbers of a series; none of a damaged one. */
function decodeSeries([name, scale, text]) {
  if (text.length % 4 || !/^[A-Za-z0-9+/]*={0,2}$/.test(text) || atob(text).length % 2) {
    return {name, values: new Float64Array()};
  }
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return {name, values: Float64Array.from(new Int16Array(bytes.buffer), (n) => n * scale)};
}

/**
 * Return truth and estimates in a cell, or null where the page has none.
 *
 * Of a linear scheme the page has two amplitudes. Its error is a straight line in the amplitude.
 */
function findStretch(part, at, amplitude) {
  const kept = part.details;
  if (!kept) return null;
  const last = part.conditions.length - 1;
  const fits = (cell) =>
    cell.at.every((i, axis) => (axis === last && part.superposed) || i === at[axis]);
  const cells = kept.cells.filter(fits);
  if (!cells.length) return null;
  const {values} = part.conditions[last];
  const N = amplitude === null ? values[at[last]] : amplitude;
  const [one, other] = [cells[0], cells.at(-1)];
  const [low, high] = [one, other].map((cell) => values[cell.at[last]]);
  const share = part.superposed && high !== low ? (N - low) / (high - low) : 0;
  if (part.superposed && high === low && N !== low) return null;
  const ends = new Map(other.series.map(decodeSeries).map((each) => [each.name, each.values]));
  const mixed = one.series
    .map(decodeSeries)
    .filter(({name}) => ends.has(name))
    .map(({name, values: from}) => {
      const to = ends.get(name);
      return {name, values: from.map((value, k) => value + share * (to[k] - value))};
    });
  const truth = mixed.find(({name}) => name === "");
  if (!truth) return null;
  const look = (name) => part.schemes.find((each) => each.name === name);
  const timed = (series) =>
    Array.from(series, (value, k) => [one.start + k * one.step, value, NaN, NaN]);
  const drawn = mixed.filter(({name}) => name && look(name));
  const style = (name) => ({name, color: look(name).color, dash: look(name).dash});
  return {
    label: kept.label,
    values: [
      {name: "truth", color: "#888888", dash: "", bold: true, points: timed(truth.values)},
      ...drawn.map(({name, values: error}) => ({
        ...style(name),
        points: timed(error.map((value, k) => value + truth.values[k])),
      })),
    ],
    errors: drawn.map(({name, values: error}) => ({...style(name), points: timed(error)})),
  };
}
