// Makes the page interactive: controls, map, chosen cell, table, links into it.

/** Make an element with attributes, and children that are elements or texts. */
function make(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "on") {
      for (const [event, act] of Object.entries(value)) element.addEventListener(event, act);
    } else if (value !== false && value !== null) {
      element.setAttribute(key, value === true ? "" : value);
    }
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

/** Return the names of the best and the next best in the chosen cell. */
function nameContest(shown) {
  return shown ? [shown.best, shown.next] : [];
}

/** Start the page, if it has a map. */
function start() {
  const source = document.getElementById("data");
  if (!source) return;
  const data = JSON.parse(source.textContent);
  new Page(data).show();
}

class Page {
  constructor(data) {
    this.shades = data.shades;
    this.parts = data.parts.map(openPart);
    this.state = this.readLink();
    this.order = {sorted: null, down: false, filter: ""};
    const static_ = document.getElementById("static");
    this.figure = static_.querySelector("figure");
    this.map = this.figure.querySelector("svg.map");
    document.getElementById("drawing").append(this.figure);
    static_.remove();
    document.getElementById("rows").remove();
    for (const id of ["controls", "drawing", "cell", "tools", "said"]) {
      document.getElementById(id).hidden = false;
    }
    for (const cell of this.map.querySelectorAll("g.cell")) this.listen(cell);
    window.addEventListener("hashchange", () => {
      this.state = this.readLink();
      this.show();
    });
  }

  get part() {
    return this.parts[this.state.tuning];
  }

  /** Return the state that the address names; what it does not name is the program's own. */
  readLink() {
    const given = new URLSearchParams(location.hash.slice(1));
    const named = this.parts.findIndex((part) => part.tuning === given.get("tuning"));
    const tuning = Math.max(named, 0);
    const part = this.parts[tuning];
    const names = part.criteria.map((each) => each.name);
    // of the address itself: its values may hold commas and percent signs
    const [, cell] = /[#&]cell=([^&]*)/.exec(location.hash) || [null, ""];
    const values = cell.split(",").map((value) => new URLSearchParams(`v=${value}`).get("v"));
    const at = part.conditions.map((condition, i) => {
      const place = condition.values.findIndex((value) => String(value) === values[i]);
      return place >= 0 ? place : Math.floor((condition.values.length - 1) / 2);
    });
    const records = Number(given.get("records"));
    const amplitude = Number(given.get("amplitude"));
    return {
      tuning,
      at,
      criterion: names.includes(given.get("criterion")) ? given.get("criterion") : names[0],
      window: part.windows.includes(given.get("window")) ? given.get("window") : part.window,
      records: records > 0 ? records : Infinity,
      amplitude: part.superposed && amplitude > 0 ? amplitude : null,
      along: part.upwards >= 0 && part.superposed ? part.upwards : part.across,
    };
  }

  /** Write the state into the address, so that a link leads back to it. */
  writeLink() {
    const {part, state} = this;
    const words = [];
    if (this.parts.length > 1) words.push(`tuning=${encodeURIComponent(part.tuning)}`);
    if (state.criterion !== part.criteria[0].name) words.push(`criterion=${state.criterion}`);
    if (state.window !== part.window) words.push(`window=${state.window}`);
    if (state.records !== Infinity) words.push(`records=${state.records}`);
    const cell = part.conditions.map((c, i) => encodeURIComponent(String(c.values[state.at[i]])));
    words.push(`cell=${cell.join(",")}`);
    if (state.amplitude !== null) words.push(`amplitude=${state.amplitude.toPrecision(4)}`);
    history.replaceState(null, "", `#${words.join("&")}`);
  }

  change(changes) {
    Object.assign(this.state, changes);
    this.writeLink();
    this.show();
  }

  /** Return what is known of a cell; computed once for each state. */
  judge(at) {
    const key = at.join();
    if (!this.judged.has(key)) this.judged.set(key, judgeCell(this.part, this.state, at));
    return this.judged.get(key);
  }

  show() {
    this.judged = new Map();
    this.showControls();
    this.paint();
    this.showCell();
    this.showTable();
  }

  /** Fill the row of controls; the element that has the focus keeps it. */
  showControls() {
    const {part, state} = this;
    const place = document.getElementById("controls");
    const focus = document.activeElement ? document.activeElement.id : "";
    const choose = (id, label, options, chosen, act) => {
      if (options.length < 2) return null;
      const select = make(
        "select",
        {id, on: {change: () => act(select.value)}},
        ...options.map(([value, text]) =>
          make("option", {value, selected: value === chosen}, text),
        ),
      );
      return make("label", {}, `${label} `, select);
    };
    const looks = new Set(
      Object.values(part.looks[state.criterion] || {}).flatMap((cells) =>
        cells.flatMap((cell) => cell.map((look) => look[0])),
      ),
    );
    const counts = [...looks].sort((a, b) => a - b).map((n) => [String(n), `what if ${n}`]);
    place.replaceChildren(
      ...[
        choose(
          "tuning",
          "tuning",
          this.parts.map((each, i) => [String(i), each.tuning]),
          String(state.tuning),
          (value) => this.change({tuning: Number(value)}),
        ),
        choose(
          "criterion",
          "error of",
          part.criteria.map((each) => [each.name, each.name.replaceAll("_", " ")]),
          state.criterion,
          (criterion) => this.change({criterion}),
        ),
        choose(
          "window",
          "part of a record",
          part.windows.map((name) => [
            name,
            name === part.window ? `${name} (judged)` : `${name} (what if)`,
          ]),
          state.window,
          (name) => this.change({window: name}),
        ),
        part.exact || counts.length < 2
          ? null
          : choose(
              "records",
              "records of a cell",
              [["judged", "as judged"], ...counts],
              state.records === Infinity ? "judged" : String(state.records),
              (value) => this.change({records: value === "judged" ? Infinity : Number(value)}),
            ),
        ...part.further.map((axis) =>
          choose(
            `axis${axis}`,
            part.conditions[axis].word,
            part.conditions[axis].values.map((value, i) => [
              String(i),
              showValue(part.conditions[axis], value),
            ]),
            String(state.at[axis]),
            (value) => {
              const at = [...state.at];
              at[axis] = Number(value);
              this.change({at});
            },
          ),
        ),
      ].filter((each) => each !== null),
    );
    if (focus && document.getElementById(focus)) document.getElementById(focus).focus();
  }

  cellAt(i, j) {
    return this.map.querySelector(`#c${i}-${j}`);
  }

  /** Fill the cells of the map. */
  paint() {
    const {part, state} = this;
    const counts = new Map();
    for (const {i, j, at} of listMapCells(part, state.at)) {
      const group = this.cellAt(i, j);
      const shown = this.judge(at);
      const [box, mark] = group.querySelectorAll("rect");
      const chosen = at.join() === state.at.join();
      group.classList.toggle("chosen", chosen);
      group.setAttribute("tabindex", chosen ? "0" : "-1");
      group.setAttribute("role", "button");
      group.setAttribute("aria-pressed", String(chosen));
      const told = `${nameCell(part, at)}: ${this.tell(shown)}`;
      group.setAttribute("aria-label", told);
      group.querySelector("title").textContent = told;
      let fill = "#d9d9d9";
      let texts = ["", "", ""];
      if (shown) {
        const scheme = part.schemes.find((each) => each.name === shown.best);
        const ratio = shown.nextError / shown.error;
        fill = fillOf(scheme.color, shown.next ? ratio : NaN, this.shades);
        const next =
          shown.next && Number.isFinite(ratio)
            ? `${shorten(shown.next, 16)} ×${showNumber(ratio)}`
            : "";
        texts = [
          shorten(shown.best, 16) + (shown.verdict === "tie" ? " =" : ""),
          showNumber(shown.error),
          next,
        ];
        counts.set(shown.best, (counts.get(shown.best) || 0) + 1);
      }
      box.setAttribute("fill", fill);
      const doubtful = shown && ["open", "close"].includes(shown.verdict);
      mark.setAttribute("fill", doubtful ? "url(#hatch)" : "none");
      group.querySelectorAll("text").forEach((text, n) => {
        text.textContent = texts[n];
        text.setAttribute("fill", textColorOn(fill));
      });
    }
    const swatch = ([name, count]) => {
      const icon = draw("svg", {width: 14, height: 14, "aria-hidden": "true", class: "swatch"});
      const {color} = part.schemes.find((each) => each.name === name);
      icon.append(draw("rect", {width: 14, height: 14, fill: color}));
      return make("li", {}, icon, ` ${name} (${count} ${count === 1 ? "cell" : "cells"})`);
    };
    document.getElementById("legend").replaceChildren(...[...counts].map(swatch));
    const judged = isJudged(part, state);
    const {title} = findCriterion(part, state.criterion);
    const tuning = part.tuning ? `, tuning ${part.tuning}` : "";
    this.figure.querySelector("figcaption").textContent =
      `Best scheme by ${title}, ${state.window} part of a record${tuning}`;
    document.getElementById("what-if").hidden = judged;
    document.getElementById("drawing").classList.toggle("unjudged", !judged);
  }

  /** Return in words what is known of a cell. */
  tell(shown) {
    if (!shown) return "no result";
    const {part, state} = this;
    const {unit} = findCriterion(part, state.criterion);
    const error = `${showNumber(shown.error)} ${unit}`.trim();
    const ratio = shown.nextError / shown.error;
    const next =
      shown.next && Number.isFinite(ratio)
        ? `; next ${shown.next}, ${showNumber(ratio)} times as much`
        : "";
    return `${shown.best}, ${nameVerdict(shown.verdict)}, error ${error}${next}`;
  }

  listen(group) {
    const [i, j] = group.id.slice(1).split("-").map(Number);
    const place = () => {
      const at = [...this.state.at];
      at[this.part.across] = i;
      if (this.part.upwards >= 0) at[this.part.upwards] = j;
      return at;
    };
    const say = () => {
      const at = place();
      const told = this.tell(this.judge(at));
      document.getElementById("said").textContent = `${nameCell(this.part, at)}: ${told}.`;
    };
    group.addEventListener("mouseenter", say);
    group.addEventListener("focus", say);
    group.addEventListener("click", () => this.change({at: place(), amplitude: null}));
    group.addEventListener("keydown", (event) => {
      const steps = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
      const step = steps[event.key];
      if (step) {
        const next = this.cellAt(i + step[0], j + step[1]);
        if (next) next.focus();
      } else if (event.key === "Enter" || event.key === " ") {
        this.change({at: place(), amplitude: null});
      } else {
        return;
      }
      event.preventDefault();
    });
  }

  /** Show the chosen cell: all schemes, curves over an axis, a stretch of time. */
  showCell() {
    const {part, state} = this;
    const {at, amplitude} = state;
    const title = document.getElementById("cell-title");
    title.textContent = nameCell(part, at, amplitude);
    const whatIf = !isJudged(part, state) || amplitude !== null;
    const shown = this.judge(at);
    const records = amplitude === null ? countRecords(part, state, at) : state.records;
    const lines = runContest(part, state.criterion, state.window, at, records, amplitude);
    const verdict = document.getElementById("cell-verdict");
    verdict.textContent = whatIf ? this.tellWhatIf(lines) : this.tellVerdict(shown);
    document.getElementById("cell-table").replaceChildren(this.makeContest(lines, whatIf));
    this.showSlider();
    this.showCurves();
    this.showStretch();
    this.showSpectra();
    this.showRecords();
  }

  tellVerdict(shown) {
    if (!shown) return "No result in this cell.";
    const {row} = shown;
    const said = {
      won: "is best",
      tie: "is the simplest of a tie",
      open: "is best so far, not decided",
    }[shown.verdict];
    const others = (row.left || "").split("; ").filter((name) => name && name !== shown.best);
    const left =
      shown.verdict !== "won" && others.length ? ` Not surely worse: ${others.join(", ")}.` : "";
    const more = row.more
      ? ` Some ${Number(row.more.toPrecision(2))} more records would decide.`
      : "";
    const seen = row.n > 0 ? `, ${row.n} record${row.n === 1 ? "" : "s"}` : "";
    const look = row.look > 0 ? `, look ${row.look}` : "";
    const single = row.n === 1 ? " One record has no interval." : "";
    return `${shown.best} ${said}${seen}${look}.${left}${more}${single}`;
  }

  tellWhatIf(lines) {
    if (!lines.length) return "What if: no result.";
    const names = this.part.schemes.map((each) => each.name);
    const close = lines.filter((line) => line.close).map((line) => names[line.scheme]);
    const others = close.length
      ? `not told apart in this cell alone: ${close.join(", ")}`
      : "all others are worse beyond the 95 % interval of this cell alone";
    return `What if, no verdict: ${names[lines[0].scheme]} has the least error; ${others}.`;
  }

  makeContest(lines, whatIf) {
    const {part, state} = this;
    const {unit} = findCriterion(part, state.criterion);
    const heads = [
      "scheme",
      unit ? `error (${unit})` : "error",
      "95 %",
      "× best",
      "95 %, paired",
      "records",
    ];
    const range = (low, high) =>
      Number.isFinite(high) ? `${showNumber(low)} to ${showNumber(high)}` : "–";
    const rows = lines.map((line, n) => {
      const {name, baseline} = part.schemes[line.scheme];
      const cells = [
        showNumber(line.error),
        range(line.low, line.high),
        n ? showNumber(line.ratio) : "best",
        n ? range(line.ratioLow, line.ratioHigh) : "",
        part.exact
          ? "expected"
          : n && line.paired < lines[0].n
            ? `${line.paired} paired`
            : String(line.n),
      ];
      return make(
        "tr",
        {},
        make("th", {scope: "row"}, baseline ? `${name} (no estimator)` : name),
        ...cells.map((text) => make("td", {}, text)),
      );
    });
    const caption = `${whatIf ? "What if: e" : "E"}rrors of all schemes in this cell`;
    return make(
      "table",
      {},
      make("caption", {}, caption),
      make("thead", {}, make("tr", {}, ...heads.map((text) => make("th", {scope: "col"}, text)))),
      make("tbody", {}, ...rows),
    );
  }

  /** Show the slider of the last condition: any value for linear schemes, else those of the grid. */
  showSlider() {
    const {part, state} = this;
    const place = document.getElementById("slider");
    const axis = part.conditions.length - 1;
    const {values} = part.conditions[axis];
    place.hidden = !(part.superposed && values.length > 1 && values[0] > 0);
    if (place.hidden) return;
    const [low, high] = [Math.log(values[0]), Math.log(values.at(-1))];
    const now = state.amplitude === null ? values[state.at[axis]] : state.amplitude;
    let input = document.getElementById("amplitude");
    if (!input) {
      const act = () => {
        const {values: all} = this.part.conditions.at(-1);
        const ends = [Math.log(all[0]), Math.log(all.at(-1))];
        const value = Math.exp(ends[0] + (ends[1] - ends[0]) * (Number(input.value) / 1000));
        const near = all.findIndex((each) => Math.abs(Math.log(each / value)) < 0.004);
        const at = [...this.state.at];
        if (near >= 0) at[at.length - 1] = near;
        this.change({amplitude: near >= 0 ? null : value, at});
      };
      input = make("input", {id: "amplitude", type: "range", min: 0, max: 1000, on: {input: act}});
      place.replaceChildren(make("label", {}, make("span", {id: "amplitude-text"}), input));
    }
    const condition = part.conditions[axis];
    const text = `${condition.label}: ${showValue(condition, Number(now.toPrecision(3)))} `;
    document.getElementById("amplitude-text").textContent = text;
    input.value = String(Math.round((1000 * (Math.log(now) - low)) / (high - low)));
    input.setAttribute("aria-valuetext", text);
  }

  /** Show errors over one axis of the map, through the chosen cell. */
  showCurves() {
    const {part, state} = this;
    const axes = [part.across, part.upwards].filter(
      (axis) =>
        axis >= 0 &&
        part.conditions[axis].values.length > 1 &&
        typeof part.conditions[axis].values[0] === "number",
    );
    const place = document.getElementById("curves");
    if (!axes.length) {
      place.replaceChildren();
      return;
    }
    const along = axes.includes(state.along) ? state.along : axes[0];
    const condition = part.conditions[along];
    const {unit, title} = findCriterion(part, state.criterion);
    const continuous =
      part.superposed && along === part.conditions.length - 1 && condition.values[0] > 0;
    const points = condition.values.map((value, i) => ({value, i, amplitude: null}));
    if (continuous) {
      const [low, high] = [condition.values[0], condition.values.at(-1)].map(Math.log);
      for (let n = 1; n < 60; n += 1) {
        const value = Math.exp(low + ((high - low) * n) / 60);
        points.push({value, i: 0, amplitude: value});
      }
      points.sort((a, b) => a.value - b.value);
    }
    const curves = part.schemes.map(({name, color, dash}) => ({
      name,
      color,
      dash,
      points: [],
      dots: !continuous,
    }));
    for (const {value, i, amplitude} of points) {
      const at = [...state.at];
      at[along] = i;
      const scaled = along === part.conditions.length - 1 ? amplitude : state.amplitude;
      const lines = runContest(part, state.criterion, state.window, at, state.records, scaled);
      for (const line of lines) {
        curves[line.scheme].points.push([value, line.error, line.low, line.high]);
      }
    }
    const best = this.judge(state.at);
    for (const curve of curves) curve.bold = Boolean(best) && curve.name === best.best;
    const last = along === part.conditions.length - 1 && state.amplitude !== null;
    const positive = curves.every((curve) => curve.points.every((p) => !(p[1] <= 0)));
    const fixed = part.conditions
      .filter((_, i) => i !== along)
      .map((c) => `${c.word} ${showValue(c, c.values[state.at[part.conditions.indexOf(c)]])}`);
    const chart = drawChart({
      curves: curves.filter((curve) => curve.points.length),
      xLabel: condition.unit ? `${condition.label} (${condition.unit})` : condition.label,
      yLabel: unit ? `error (${unit}), band 95 %` : "error, band 95 %",
      xLog: condition.values[0] > 0 && condition.values.at(-1) / condition.values[0] > 20,
      yLog: positive,
      ticks: condition.values,
      at: last ? state.amplitude : condition.values[state.at[along]],
      label: `Errors by ${title} over ${condition.label}, ${fixed.join(", ")}`,
    });
    const switches =
      axes.length < 2
        ? []
        : axes.map((axis) =>
            make(
              "button",
              {
                type: "button",
                "aria-pressed": String(axis === along),
                id: `along${axis}`,
                on: {click: () => this.change({along: axis})},
              },
              `over ${part.conditions[axis].word}`,
            ),
          );
    const focus = document.activeElement ? document.activeElement.id : "";
    const heading = make(
      "h3",
      {},
      `Error over ${condition.word}${fixed.length ? `, at ${fixed.join(", ")}` : ""}`,
    );
    place.replaceChildren(heading, make("p", {class: "switches"}, ...switches), chart || "");
    if (focus.startsWith("along")) document.getElementById(focus).focus();
  }

  /** Show 40 s of one record: truth and estimates; or say how to get them. */
  showStretch() {
    const {part, state} = this;
    const place = document.getElementById("stretch");
    const stretch = findStretch(part, state.at, state.amplitude);
    const heading = make("h3", {}, "40 s of record 0, from the middle of its judged part on");
    if (!stretch) {
      place.replaceChildren(heading, make("p", {class: "note"}, part.help));
      return;
    }
    const {label} = stretch;
    const names = stretch.errors.map(({name}) => name);
    const shown = this.drawn || new Set(nameContest(this.judge(state.at)));
    const boxes = names.map((name) => {
      const act = () => {
        this.drawn = new Set(shown);
        if (!this.drawn.delete(name)) this.drawn.add(name);
        this.showStretch();
        document.getElementById(`draw-${names.indexOf(name)}`).focus();
      };
      const id = `draw-${names.indexOf(name)}`;
      return make(
        "label",
        {},
        make("input", {type: "checkbox", id, checked: shown.has(name), on: {change: act}}),
        ` ${name}`,
      );
    });
    const chart = (series, yLabel) =>
      drawChart({
        curves: series.filter(({name}) => name === "truth" || shown.has(name)),
        xLabel: "time (s)",
        yLabel,
        xLog: false,
        yLog: false,
        at: null,
        label: `${yLabel} over time: ${[...shown].join(", ")}`,
      });
    place.replaceChildren(
      heading,
      make("p", {class: "switches"}, ...boxes),
      make(
        "div",
        {class: "columns"},
        ...[chart(stretch.values, label), chart(stretch.errors, "error of it")].filter(
          (each) => each !== null,
        ),
      ),
    );
  }

  /** Show the error of each scheme that motion of one frequency leaves, where it is known. */
  showSpectra() {
    const {part, state} = this;
    const place = document.getElementById("spectra");
    const lines = ((part.details || {}).spectra || []).filter(
      ([, measure]) => measure === state.criterion,
    );
    const curves = lines.flatMap(([name, , frequencies, squares]) => {
      const scheme = part.schemes.find((each) => each.name === name);
      const points = frequencies.map((f, k) => [f, Math.sqrt(squares[k]), NaN, NaN]);
      return scheme ? [{name, color: scheme.color, dash: scheme.dash, points}] : [];
    });
    const chart = curves.length
      ? drawChart({
          curves,
          xLabel: "frequency of the motion (Hz)",
          yLabel: "rms error over rms displacement",
          xLog: true,
          yLog: true,
          at: null,
          label: `Error spectra by ${state.criterion} of ${curves.map(({name}) => name).join(", ")}`,
        })
      : null;
    place.replaceChildren(
      ...(chart
        ? [make("h3", {}, "Error that motion leaves, by frequency, without noise"), chart]
        : []),
    );
  }

  /** Show the errors of single records, where the page has them. */
  showRecords() {
    const {part, state} = this;
    const {unit} = findCriterion(part, state.criterion);
    const found = listRecords(part, state.criterion, state.window, state.at, state.amplitude);
    const lines = found
      .map((values, i) => ({...part.schemes[i], values}))
      .filter(({values}) => values.length);
    const chart = lines.length
      ? drawDots({
          lines,
          xLabel: unit ? `error of a record (${unit})` : "error of a record",
          label: `Errors of single records by ${state.criterion}, ${nameCell(part, state.at, state.amplitude)}`,
        })
      : null;
    const most = Math.max(0, ...lines.map(({values}) => values.length));
    document
      .getElementById("records-shown")
      .replaceChildren(
        ...(chart
          ? [
              make("h3", {}, `Errors of single records, ${most} at most; the mark is the median`),
              chart,
            ]
          : []),
      );
  }

  /** Return the columns of the table, all cells, and those that it shows, in order. */
  arrange() {
    const {part, state} = this;
    const columns = listColumns(part, state);
    const cells = part.conditions
      .reduce((all, {values}) => all.flatMap((at) => values.map((_, i) => [...at, i])), [[]])
      .map((at) => ({at, shown: this.judge(at)}));
    return {columns, cells, arranged: arrangeCells(cells, columns, this.order)};
  }

  showTable() {
    const {state} = this;
    const {columns, cells, arranged} = this.arrange();
    const head = make(
      "tr",
      {},
      ...columns.map(({label}, n) => {
        const sorted = this.order.sorted === n;
        const act = () => {
          this.order = {...this.order, sorted: n, down: sorted && !this.order.down};
          this.showTable();
          document.getElementById(`sort${n}`).focus();
        };
        const mark = sorted ? (this.order.down ? " ▼" : " ▲") : "";
        return make(
          "th",
          {
            scope: "col",
            "aria-sort": sorted ? (this.order.down ? "descending" : "ascending") : false,
          },
          make("button", {type: "button", id: `sort${n}`, on: {click: act}}, label + mark),
        );
      }),
    );
    const rows = arranged.slice(0, MOST_ROWS).map((cell) => {
      const chosen = cell.at.join() === state.at.join();
      const act = () => this.change({at: cell.at, amplitude: null});
      const texts = columns.map(({get, plain}) => {
        const value = get(cell);
        return typeof value === "number" && !plain ? showNumber(value) : String(value ?? "–");
      });
      const line = make(
        "tr",
        {class: chosen ? "chosen" : false, on: {click: act}},
        ...texts.map((text, n) => make("td", {class: columns[n].number ? "number" : false}, text)),
      );
      return line;
    });
    const more = arranged.length > MOST_ROWS ? `, the first ${MOST_ROWS} shown` : "";
    document.getElementById("found").textContent =
      `${arranged.length} of ${cells.length} cells${more}`;
    const table = make(
      "table",
      {class: "cells"},
      make("caption", {}, `All cells by ${state.criterion.replaceAll("_", " ")}`),
      make("thead", {}, head),
      make("tbody", {}, ...rows),
    );
    document.getElementById("all").replaceChildren(table);
    const filter = document.getElementById("filter");
    if (!filter.dataset.ready) {
      filter.dataset.ready = "yes";
      filter.addEventListener("input", () => {
        this.order = {...this.order, filter: filter.value};
        this.showTable();
      });
      document.getElementById("copy").addEventListener("click", () => this.copy());
    }
  }

  /** Copy what the table shows as CSV; where a browser forbids it, show the text to be copied. */
  async copy() {
    const {columns, arranged} = this.arrange();
    const text = toCsv(
      columns.map(({label}) => label),
      arranged.map((cell) => columns.map(({get}) => get(cell))),
    );
    const said = document.getElementById("copied");
    const field = document.getElementById("csv");
    try {
      await navigator.clipboard.writeText(text);
      said.textContent = `${arranged.length} cells copied`;
      field.hidden = true;
    } catch {
      field.hidden = false;
      field.value = text;
      field.select();
      said.textContent = "copy the text below";
    }
  }
}

start();
