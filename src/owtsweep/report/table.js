// The table of all cells: sorted, filtered, copied as CSV.

/** Most rows that are shown at once; the filter finds the others. */
const MOST_ROWS = 500;

/** Return the columns of the table: heading, value of a row, and whether it is a number. */
function listColumns(part, state) {
  const unit = findCriterion(part, state.criterion).unit;
  const inUnit = (label) => (unit ? `${label} (${unit})` : label);
  const conditions = part.conditions.map((condition, i) => ({
    label: condition.unit ? `${condition.word} (${condition.unit})` : condition.word,
    get: (cell) => condition.values[cell.at[i]],
    number: typeof condition.values[0] === "number",
    plain: true,
  }));
  const of = (label, get, number) => ({
    label,
    get: (cell) => (cell.shown ? get(cell.shown) : null),
    number,
  });
  const columns = [
    ...conditions,
    of("verdict", (shown) => nameVerdict(shown.verdict), false),
    of("best", (shown) => shown.best, false),
    of(inUnit("error"), (shown) => shown.error, true),
    of("next best", (shown) => shown.next, false),
    of(inUnit("its error"), (shown) => shown.nextError, true),
  ];
  if (!isJudged(part, state)) return columns;
  columns.splice(
    columns.length - 2,
    0,
    of("95 % from", (shown) => shown.row.error_low, true),
    of("to", (shown) => shown.row.error_high, true),
  );
  if (part.cells.baseline) {
    columns.push(
      of("no estimator", (shown) => shown.row.baseline, false),
      of(inUnit("its error"), (shown) => shown.row.error_baseline, true),
    );
  }
  columns.push(of("records", (shown) => shown.row.n, true));
  columns.at(-1).plain = true;
  return columns;
}

/** Return a verdict in the page's words. */
function nameVerdict(verdict) {
  return {close: "what if: close", apart: "what if: apart"}[verdict] || verdict;
}

/** Return -1, 0 or 1; missing values come last. */
function compareValues(a, b) {
  const missing = (value) => value === null || value === undefined || value === "";
  if (missing(a) || missing(b)) return Number(missing(a)) - Number(missing(b));
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a).localeCompare(String(b));
}

/** Return the cells that hold a text somewhere, in the order of a column. */
function arrangeCells(cells, columns, {sorted, down, filter}) {
  const wanted = filter.trim().toLowerCase();
  const texts = (cell) =>
    columns.map(({get, plain}) => {
      const value = get(cell);
      return typeof value === "number" && !plain ? showNumber(value) : String(value ?? "");
    });
  const found = wanted
    ? cells.filter((cell) => texts(cell).some((text) => text.toLowerCase().includes(wanted)))
    : [...cells];
  if (sorted === null || sorted >= columns.length) return found;
  const {get} = columns[sorted];
  return found.sort((a, b) => compareValues(get(a), get(b)) * (down ? -1 : 1));
}
