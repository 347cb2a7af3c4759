// What a page computes: contests of a cell, from means and covariances. No document is needed.

/** Return the numbers of 32 bits in a text. */
function decodeFloats(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

/** Return the data of a tuning with what is looked up often. */
function openPart(part) {
  const index = new Map();
  const cells = part.cells;
  cells.at.forEach((at, row) => index.set(`${cells.criterion[row]} ${at.join()}`, row));
  return {...part, numbers: decodeFloats(part.floats), index};
}

/** Return the row of a cell in best_scheme.csv, or undefined. */
function findRow(part, criterion, at) {
  const row = part.index.get(`${criterion} ${at.join()}`);
  if (row === undefined) return undefined;
  const found = {row};
  for (const [name, column] of Object.entries(part.cells)) found[name] = column[row];
  return found;
}

/** Return the criterion of a name. */
function findCriterion(part, name) {
  return part.criteria.find((each) => each.name === name);
}

/** Return the number of a cell among those with statistics of their own. */
function findPlace(part, at) {
  const axes = part.superposed ? part.conditions.slice(0, -1) : part.conditions;
  return axes.reduce((sum, axis, i) => sum * axis.values.length + at[i], 0);
}

/** Return the looks at a cell that see at most so many records, the most records last. */
function listLooks(part, criterion, window, at, records) {
  const place = findPlace(part, at);
  const byWindow = (part.looks[criterion] || {})[window] || [];
  return (byWindow[place] || []).filter((look) => look[0] <= records);
}

/** Return factors on the numbers of a scheme: 1, or those of motion, cross and noise. */
function listWeights(part, amplitude) {
  return part.superposed ? [amplitude * amplitude, 2 * amplitude, 1] : [1];
}

/** Return mean and standard error of a sum of schemes' values, with a sign each. */
function summarise(part, look, signs, amplitude) {
  const [records, schemes, offset, lines] = look;
  const weights = listWeights(part, amplitude);
  const width = schemes.length * weights.length;
  const used = [];
  for (const [scheme, sign] of signs) {
    const first = schemes.indexOf(scheme) * weights.length;
    weights.forEach((weight, i) => used.push([first + i, sign * weight]));
  }
  const add = (start) => used.reduce((sum, [i, w]) => sum + w * part.numbers[start + i], 0);
  let square = 0;
  for (let k = 0; k < lines; k += 1) square += add(offset + width * (k + 1)) ** 2;
  return {mean: add(offset), error: lines ? Math.sqrt(square / records) : NaN, records};
}

/** Return the error, in the criterion's unit, of a mean of what is judged. */
function express(criterion, mean) {
  if (!criterion.squared) return mean;
  return mean >= 0 ? Math.sqrt(mean) : NaN;
}

/**
 * Return the contest of a cell: a line for each scheme, the least error first.
 *
 * A scheme that left earlier than the best one is compared over the records that both have: its
 * error is that of the best, times the ratio over these records. `close`: the interval of the
 * paired difference to the best, in this cell alone, holds 0.
 */
function runContest(part, criterionName, window, at, records, amplitude) {
  const criterion = findCriterion(part, criterionName);
  const looks = listLooks(part, criterionName, window, at, records);
  const last = part.conditions.at(-1).values[at.at(-1)];
  const N = amplitude === null ? last : amplitude;
  const deepest = new Map();
  for (const look of looks) {
    for (const scheme of look[1]) {
      if (!deepest.has(scheme) || deepest.get(scheme)[0] <= look[0]) deepest.set(scheme, look);
    }
  }
  if (!deepest.size) return [];
  const own = new Map();
  for (const [scheme, look] of deepest) own.set(scheme, summarise(part, look, [[scheme, 1]], N));
  const share = (a, b) => looks.filter((k) => k[1].includes(a) && k[1].includes(b)).at(-1);
  /** The mean of a scheme, scaled to all records of another. */
  const scale = (scheme, best) => {
    const look = share(scheme, best);
    if (scheme === best || !look) return own.get(scheme).mean;
    const [one, other] = [scheme, best].map((i) => summarise(part, look, [[i, 1]], N).mean);
    return other === 0 ? one : own.get(best).mean * (one / other);
  };
  const most = Math.max(...[...own.values()].map((each) => each.records));
  const least = (from, value) => from.reduce((a, b) => (value(b) < value(a) ? b : a));
  const full = [...own.keys()].filter((i) => own.get(i).records === most);
  const leader = least(full, (i) => own.get(i).mean);
  const best = least([...own.keys()], (i) => scale(i, leader));
  const lines = [...own.keys()].map((scheme) => {
    const mean = scale(scheme, best);
    const {error, records: n} = own.get(scheme);
    const half = n > 1 ? (part.t[n] ?? NaN) * error : NaN;
    const line = {scheme, error: express(criterion, mean), n, low: NaN, high: NaN};
    if (scheme === best || n === own.get(best).records) {
      line.low = express(criterion, Math.max(mean - half, 0));
      line.high = express(criterion, mean + half);
    }
    line.clipped = mean - half < 0;
    const look = share(scheme, best);
    const reference = own.get(best).mean;
    line.ratio = line.error / express(criterion, reference);
    line.paired = look ? look[0] : 0;
    line.close = false;
    if (scheme !== best && look) {
      const pair = summarise(
        part,
        look,
        [
          [scheme, 1],
          [best, -1],
        ],
        N,
      );
      const base = summarise(part, look, [[best, 1]], N).mean;
      const reach = (part.t[look[0]] ?? NaN) * pair.error;
      const asRatio = (value) => express(criterion, Math.max(1 + value / base, 0));
      line.ratioLow = asRatio(pair.mean - reach);
      line.ratioHigh = asRatio(pair.mean + reach);
      line.close = !(pair.mean - reach > 0);
    }
    return line;
  });
  return lines.sort((a, b) => (a.scheme === best ? -1 : b.scheme === best ? 1 : a.error - b.error));
}

/** Return for each scheme the errors of single records in a cell; [] where the page has none. */
function listRecords(part, criterionName, window, at, amplitude) {
  const kept = ((part.records || {})[criterionName] || {})[window];
  if (!kept) return [];
  const criterion = findCriterion(part, criterionName);
  const [offset, , schemes, width, records] = kept;
  const place = findPlace(part, at);
  const N = amplitude === null ? part.conditions.at(-1).values[at.at(-1)] : amplitude;
  const weights = listWeights(part, N);
  return part.schemes.map((_, scheme) => {
    const first = offset + (place * schemes + scheme) * width * records;
    const errors = [];
    for (let n = 0; n < records; n += 1) {
      const square = weights.reduce(
        (sum, w, i) => sum + w * part.numbers[first + i * records + n],
        0,
      );
      if (!Number.isNaN(square)) errors.push(express(criterion, Math.max(square, 0)));
    }
    return errors;
  });
}

/** Return what a map shows of a cell: the program's verdict, or what would be ("what if"). */
function judgeCell(part, state, at) {
  const row = findRow(part, state.criterion, at);
  const names = part.schemes.map((each) => each.name);
  if (isJudged(part, state)) {
    if (row === undefined) return null;
    return {
      best: row.best,
      next: row.runner_up,
      verdict: row.verdict,
      error: row.error_best,
      nextError: row.error_runner_up,
      row,
    };
  }
  const lines = runContest(part, state.criterion, state.window, at, state.records, null);
  if (!lines.length) return null;
  const next = lines[1];
  return {
    best: names[lines[0].scheme],
    next: next ? names[next.scheme] : "",
    verdict: next && next.close ? "close" : "apart",
    error: lines[0].error,
    nextError: next ? next.error : null,
    row,
  };
}

/** Return whether a state is what the program has judged, so that it has verdicts. */
function isJudged(part, state) {
  return state.window === part.window && state.records === Infinity;
}

/** Return the records that a contest of a cell sees: those on which its verdict rests. */
function countRecords(part, state, at) {
  if (state.records !== Infinity) return state.records;
  const row = findRow(part, state.criterion, at);
  return row && row.n > 0 ? row.n : Infinity;
}

/** Return all combinations of the values of a map's axes, as indices of conditions. */
function listMapCells(part, at) {
  const cells = [];
  const lines = part.upwards < 0 ? 1 : part.conditions[part.upwards].values.length;
  part.conditions[part.across].values.forEach((_, i) => {
    for (let j = 0; j < lines; j += 1) {
      const here = [...at];
      here[part.across] = i;
      if (part.upwards >= 0) here[part.upwards] = j;
      cells.push({i, j, at: here});
    }
  });
  return cells;
}

/** Return a name, cut if it has more letters than fit. */
function shorten(name, most) {
  return name.length > most ? `${name.slice(0, most - 1)}…` : name;
}

/** Return a number with three digits that count. */
function showNumber(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (typeof value !== "number") return String(value);
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const digits = 2 - Math.floor(Math.log10(Math.abs(value)));
  return digits >= 0 && digits <= 5
    ? value.toFixed(digits)
    : Number(value.toPrecision(3)).toString();
}

/** Return a value of a condition as text, with its unit. */
function showValue(condition, value) {
  if (typeof value === "string") return value;
  const text = Number(value.toPrecision(6)).toString();
  return condition.unit ? `${text} ${condition.unit}` : text;
}

/** Return the conditions of a cell in words. */
function nameCell(part, at, amplitude = null) {
  const words = part.conditions.map((condition, i) => {
    const last = i === part.conditions.length - 1;
    const value =
      last && amplitude !== null ? Number(amplitude.toPrecision(3)) : condition.values[at[i]];
    return `${condition.word} ${showValue(condition, value)}`;
  });
  return words.join(", ");
}

/** Return the text of a CSV file; texts that a spreadsheet would take for formulas are quoted. */
function toCsv(header, rows) {
  const quote = (value) => {
    if (typeof value === "number") return Number.isNaN(value) ? "" : String(value);
    let text = value === null || value === undefined ? "" : String(value);
    if (/^[=+\-@\t\r]/.test(text)) text = `'${text}`;
    return /[",\n\r']/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  return [header, ...rows].map((row) => row.map(quote).join(",")).join("\r\n") + "\r\n";
}

/** Return a scheme's colour, paler the nearer the runner-up is, as "#rrggbb". */
function fillOf(color, ratio, shades) {
  let share = 1;
  if (Number.isFinite(ratio)) {
    const strength = Math.log(Math.min(Math.max(ratio, 1), shades.full)) / Math.log(shades.full);
    share = shades.palest + (1 - shades.palest) * strength;
  }
  const channels = [1, 3, 5].map((start) => parseInt(color.slice(start, start + 2), 16) / 255);
  const mixed = channels.map((c) => Math.round(255 * (1 - share * (1 - c))));
  return `#${mixed.map((c) => c.toString(16).padStart(2, "0")).join("")}`;
}

/** Return black or white, whichever is more readable on a colour. */
function textColorOn(color) {
  const linear = [1, 3, 5].map((start) => {
    const c = parseInt(color.slice(start, start + 2), 16) / 255;
    return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  });
  const light = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
  return (light + 0.05) ** 2 > 0.05 * 1.05 ? "#000000" : "#ffffff";
}
