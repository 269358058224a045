/* The view of a run: what is shown of it at the cursor. Keys, buttons and links are in control.js. */

const BOUND = 28; // height of a row of the table of steps, in pixels
const MOST_PLAIN = 200; // a longer run shows only the rows around the cursor
const MOST_LETTERS = 160; // of a cell in that table; on paper all of them
const IN_SIGHT = 16; // rows of that table
const AROUND = 10; // rows that are drawn above those in sight, and twice as many below

class View {
  constructor(data, trace, moved) {
    this.data = data;
    this.trace = trace;
    this.moved = moved;
    this.step = 0;
    this.part = "";
    this.plotted = [];
    this.known = new Map();
    this.parts = new Map(data.parts.map((part) => [part.name, part]));
    this.member = memberOf(data, trace);
    this.diagram = new Diagram(place("run-diagram"));
    this.fired = this.firingSteps();
    this.charts = new Charts(place("run-charts"), trace.steps, (step) => this.show(step));
    this.charts.periodMs = data.period_ms;
    this.charts.marks = this.broken.map(([statement, step]) => ({ step, words: `violated at step ${step}: ${statement}` }));
    if (trace.from !== undefined) this.charts.marks.push({ step: trace.from, words: "other inputs from here on", kind: "branch" });
    this.strip = new Strip(place("run-line"), this);
    this.values = [];
    this.watched = [];
    this.live = null;
    this.unexplained = ""; // why the page has no machine that could explain this run
    this.fill();
  }

  close() {
    this.charts.resized.disconnect();
    this.strip.close();
  }

  /* Takes the machine itself, when the page has loaded it. */
  setLive(live) {
    this.live = live;
    this.show(this.step);
  }

  /* What the run breaks: statements, each with the step that breaks it, in the order of the steps. */
  get broken() {
    const every = this.data.results[this.result]?.broken ?? [];
    if (this.trace.from === undefined) return every;
    return [...every.filter(([, step]) => step <= this.trace.from), ...this.trace.broken]; // of a branch what the claims say in the page
  }

  get violating() {
    return this.broken.length ? this.broken[0][1] : null;
  }

  get result() {
    return this.trace.results[0];
  }

  /* Unit and labels of a name; a machine of a composition that runs by itself has its names without that of the machine. */
  signal(name) {
    const { signals } = this.data;
    const own = this.member ? signals[`${this.member}.${name}`] ?? this.parts.get(this.member)?.signals[name] : undefined;
    return own ?? signals[name];
  }

  /* ---------------------------------------------------- names */

  /* The machine that a name belongs to: those of a composition have it in front. */
  ofPart(name) {
    return !this.part || name.startsWith(`${this.part}.`);
  }

  names(kind) {
    return this.columns(kind).map(({ name }) => name);
  }

  /* Names of a kind that this run has, each with its values in every step. */
  columns(kind) {
    const key = `${kind} ${this.part}`;
    if (!this.known.has(key)) {
      const names = this.trace.present(kind).filter((name) => this.ofPart(name));
      this.known.set(key, names.map((name) => ({ name, signal: this.signal(name), values: this.trace.series(kind, name) })));
    }
    return this.known.get(key);
  }

  /* Machine and transition of all that fired in a step. */
  firedAt(step) {
    const found = [];
    for (const name of this.trace.names.fired) {
      const value = step > 0 ? this.trace.at("fired", name, step) : null;
      if (value !== null && (this.ofPart(name) || this.alone)) found.push([this.machineOf(name), value]);
    }
    return found;
  }

  get alone() {
    return this.trace.names.fired.length === 1;
  }

  machineOf(name) {
    return name.endsWith(".fired") ? name.slice(0, -".fired".length) : this.data.parts.length === 1 ? this.data.parts[0].name : this.member;
  }

  modeOf(machine, step) {
    const name = !this.member && this.trace.first.has(`${machine}.mode`) ? `${machine}.mode` : "mode";
    if (this.member && machine !== this.member) return ""; // it does not run here
    const value = this.trace.at("state", name, step);
    return value === null ? "" : shown(value, this.signal(name) ?? this.signal(`${machine}.mode`));
  }

  /* The steps in which another transition fires than in the step before. */
  firingSteps() {
    const found = [];
    let before = "";
    for (let step = 1; step <= this.trace.steps; step += 1) {
      const now = this.firedAt(step).join("\n");
      if (now !== before) found.push(step);
      before = now;
    }
    return found;
  }

  /* ---------------------------------------------------- what is drawn once */

  fill() {
    this.fillCharts();
    this.fillValues();
    this.fillSteps();
  }

  fillCharts() {
    this.charts.lanes = this.modeLanes();
    this.charts.charts = [...ofInterval(this.data, this.trace), ...this.speeds(), ...this.moving(), ...this.chosen()];
    this.charts.draw();
  }

  modeLanes() {
    const every = this.trace.names.state.filter((name) => name.split(".").at(-1) === "mode" && this.ofPart(name));
    const lanes = every
      .filter((name) => this.trace.first.get(name) !== null)
      .map((name) => ({
        name: name.includes(".") ? name.slice(0, name.lastIndexOf(".")) : name,
        values: this.trace.series("state", name),
        words: (value) => shown(value, this.signal(name)),
      }));
    const moving = lanes.filter((lane) => new Set(lane.values).size > 1);
    return lanes.length > 1 ? (moving.length ? moving : lanes.slice(0, 1)) : lanes;
  }

  speeds() {
    const names = [...this.trace.names.outputs, ...this.trace.names.state].filter(
      (name) => this.signal(name)?.unit === "mm/s" && this.ofPart(name),
    );
    const lines = [...new Set(names)].slice(0, 4).map((name) => ({ name, values: this.numbers(name) }));
    const moving = lines.filter((line) => line.values.some((value) => value));
    return moving.length ? [{ title: "speed", unit: "mm/s", lines: moving }] : [];
  }

  /* Of a machine without an interval, the three numbers that change most. */
  moving() {
    if (this.data.reported) return [];
    const spread = (name) => {
      const values = this.numbers(name).filter((value) => value !== null && value !== undefined);
      return values.reduce((most, value) => Math.max(most, value), -Infinity) - values.reduce((least, value) => Math.min(least, value), Infinity);
    };
    return this.names("state")
      .filter((name) => this.signal(name)?.unit && this.signal(name).unit !== "mm/s")
      .map((name) => [spread(name), name])
      .filter(([width]) => width > 0)
      .sort(([one], [other]) => other - one)
      .slice(0, 3)
      .map(([, name]) => this.chartOf(name));
  }

  chosen() {
    return this.plotted.map((name) => ({ ...this.chartOf(name), closed: () => this.plot(name) }));
  }

  chartOf(name) {
    return { title: name, unit: this.signal(name)?.unit ?? "", lines: [{ name: "", values: this.numbers(name) }] };
  }

  numbers(name) {
    const kind = ["state", "outputs", "inputs"].find((one) => this.trace.names[one].includes(name));
    return kind ? this.trace.series(kind, name).map((value) => (value === null ? null : Number(value))) : [];
  }

  plot(name) {
    this.plotted = this.plotted.includes(name) ? this.plotted.filter((one) => one !== name) : [...this.plotted, name];
    this.fillCharts();
    this.showValues();
    this.moved();
  }

  fillValues() {
    const table = place("run-values");
    this.values = [];
    for (const body of table.querySelectorAll("tbody")) body.remove();
    for (const kind of ["inputs", "state", "outputs"]) {
      const columns = this.columns(kind);
      if (!columns.length) continue;
      const head = element("tr", { role: "row" }, element("th", { colspan: 5, scope: "rowgroup", role: "rowheader" }, kind));
      const body = element("tbody", { role: "rowgroup" }, head);
      for (const column of columns) body.append(this.valueRow(kind, column));
      table.append(body);
    }
  }

  valueRow(kind, { name, signal, values }) {
    const cell = (given, ...inside) => element("td", { role: "cell", ...given }, ...inside);
    const [before, after] = [cell({ class: "n" }), cell({ class: "n" })];
    const button = element("button", { class: "quiet", onclick: () => this.plot(name), "aria-label": `chart of ${name}` }, "chart");
    const unit = signal?.unit ?? "";
    const head = element("th", { scope: "row", role: "rowheader" }, element("code", {}, ...apartAtMarks(name)));
    const row = element("tr", { role: "row" }, head, before, after, cell({}, unit), cell({}, button));
    this.values.push({ kind, name, lower: name.toLowerCase(), signal, values, row, button, cells: { before, after }, texts: {} });
    return row;
  }

  fillSteps() {
    const box = place("run-steps-box");
    this.body = place("run-steps").tBodies[0];
    box.onscroll = () => this.rowsAround(Math.floor(box.scrollTop / BOUND));
    this.drawnFrom = null;
    this.rowsAround(0);
  }

  /* Draws the rows that can be seen; of a short run all of them, and on paper all of them in full. */
  rowsAround(first, paper = false) {
    const all = paper || this.trace.steps <= MOST_PLAIN;
    const from = all ? 0 : Math.max(0, (Math.floor(first / AROUND) - 1) * AROUND);
    const to = all ? this.trace.steps : Math.min(this.trace.steps, from + IN_SIGHT + 3 * AROUND);
    const drawnNow = `${from} ${to} ${this.part} ${paper}`;
    if (this.drawnFrom === drawnNow) return;
    this.drawnFrom = drawnNow;
    const rows = [];
    for (let step = from; step <= to; step += 1) rows.push(this.stepRow(step, paper ? Infinity : MOST_LETTERS));
    const gap = (count) => element("tr", { class: "gap", "aria-hidden": "true" }, element("td", { colspan: 4, style: `height:${count * BOUND}px` }));
    this.body.replaceChildren(...(from ? [gap(from)] : []), ...rows, ...(to < this.trace.steps ? [gap(this.trace.steps - to)] : []));
    this.markStep();
  }

  stepRow(step, most) {
    const fired = step ? this.firedAt(step).map(([, name]) => name).join(", ") : "start";
    const texts = [cut(fired, most), step ? this.told("inputs", step, most) : "", this.told("state", step, most)];
    const cells = texts.map((text) => element("td", { role: "cell" }, element("div", {}, text)));
    const button = element("button", { class: "quiet", onclick: () => this.show(step), "aria-label": `to step ${step}` }, String(step));
    const breaks = this.broken.some(([, at]) => at === step);
    return element("tr", { role: "row", "data-step": step, class: breaks ? "breaks" : null }, element("td", { class: "n", role: "cell" }, button), ...cells);
  }

  told(kind, step, most) {
    let text = "";
    for (const { name, signal, values } of this.columns(kind)) {
      if (values[step] === null || (kind === "state" && step && values[step] === values[step - 1])) continue;
      text += `${text ? ",  " : ""}${name} = ${shown(values[step], signal)}`;
      if (text.length > most) break;
    }
    return cut(text, most);
  }

  /* ---------------------------------------------------- at the cursor */

  show(step) {
    const at = window.scrollY;
    this.step = Math.max(0, Math.min(this.trace.steps, step));
    this.charts.move(this.step);
    this.strip.show(this.step);
    this.showFired();
    this.showWatched();
    this.showDiagram();
    this.showValues();
    this.markStep();
    if (window.scrollY !== at) window.scrollTo(0, at); // what is read stays in its place, whatever grows or shrinks above it
    this.moved();
  }

  showFired() {
    const before = new Set(this.firedAt(this.step - 1).map(String));
    const fired = this.firedAt(this.step);
    const others = fired.filter((one) => !before.has(String(one)));
    const as = fired.filter((one) => before.has(String(one)));
    const lines = (others.length ? others : fired.length === 1 ? fired : []).map(([machine, name]) => this.firedLine(machine, name));
    if (as.length && fired.length > 1) {
      const rest = as.map(([machine, name]) => this.firedLine(machine, name));
      lines.push(fold("as before", [`${as.length} fired as in the step before`], () => rest, { open: !others.length }));
    }
    lines.unshift(...this.broken.filter(([, step]) => step === this.step).map((one) => this.brokenLine(one)));
    const laws = this.live?.broken(this.step) ?? [];
    if (laws.length) lines.push(element("p", { class: "unknown" }, `No proof speaks of what follows: this step breaks ${laws.length > 1 ? `${laws.length} laws` : "a law"} of the world.`), ...laws.map((name) => this.lawLine(name)));
    if (!this.step) lines.push(element("p", { class: "soft" }, "the state before the first step"));
    replaced(place("run-fired"), ...lines);
  }

  /* A statement that the step breaks, with the term that must not be so and the parts that make it so. */
  brokenLine([statement, , claim]) {
    const head = element("p", { class: "violated" }, element("b", {}, "violated here: "), spoken(statement));
    const seen = this.live?.seen(this.step);
    const asked = claim ? seen?.claim(claim) : null;
    if (!asked) return head;
    const late = asked.steps > 0 ? [element("p", { class: "soft" }, `The response has not come within ${asked.steps} steps; this is it:`)] : [];
    return element("div", {}, head, fold(`claim/${claim}`, ["the part that fails, with its values"], () => [...late, ...wholeTerm(seen, seen.asked(asked), `claim/${claim}`)], { open: true }));
  }

  /* A law that the step breaks: its id, what it says, and the parts of its term that would have to be otherwise, with their values. */
  lawLine(law) {
    const seen = this.live.seen(this.step);
    const [machine, name] = apart(law);
    const [id, statement] = this.parts.get(machine)?.laws?.[name] ?? ["", ""];
    const head = element("p", {}, element("b", { class: "unknown" }, `broken: ${name}`), element("span", { class: "soft" }, ` ${id}`), statement ? element("br") : null, spoken(statement));
    const at = seen?.law(law);
    const lines = () => [element("p", { class: "soft" }, "Lawful is a step in which this is true; false parts are those that break it:"), ...wholeTerm(seen, at, `law/${law}`)];
    return element("div", {}, head, at === undefined ? null : fold(`law/${law}`, ["what would be lawful"], lines, { open: true }));
  }

  firedLine(machine, name) {
    const row = this.parts.get(machine)?.table.find((one) => one.name === name);
    const [before, after] = [this.modeOf(machine, this.step - 1), this.modeOf(machine, this.step)];
    const way = before === after ? `in ${after}` : `${before} \u2192 ${after}`;
    const head = element("p", { class: "fired" }, this.alone ? null : element("span", { class: "soft" }, `${machine}: `), element("b", {}, name), ` ${way}`);
    const live = this.live?.rows(this.step)?.find((one) => one.fires && one.transition === name && (this.alone || one.machine === machine));
    if (live) return element("div", {}, head, this.whyOf(live, "fired"));
    return row ? element("div", {}, head, this.guard(machine, row.guard)) : head;
  }

  /* The guard of a row and why it holds or not; it stays open from step to step. */
  whyOf(row, at = "row") {
    const key = `${at}/${row.machine}/${row.transition}`;
    return fold(key, ["why"], () => wholeTerm(this.live.seen(this.step), row.place, key));
  }

  /* A guard, with the terms below it for which its letters stand. */
  guard(machine, text) {
    const known = this.parts.get(machine).terms;
    const named = [...new Set(text.match(/#\d+/g) ?? [])].filter((name) => known[name]);
    const terms = named.map((name) => element("li", {}, element("code", {}, `${name} = ${spoken(known[name])}`)));
    return element("div", { class: "guard" }, "when ", element("code", {}, spoken(text)), terms.length ? element("ul", {}, ...terms) : null);
  }

  /* Of a composition, the machine that was chosen, else one that changed its mode, else the one before. */
  showDiagram() {
    if (this.member) return this.showPart(this.parts.get(this.member));
    const changed = this.data.parts.find(({ name }) => this.step && this.modeOf(name, this.step) !== this.modeOf(name, this.step - 1));
    const part = this.parts.get(this.part) ?? changed ?? this.diagram.part ?? this.data.parts[0];
    this.showPart(part);
  }

  showPart(part) {
    if (!part) return;
    const before = this.modeOf(part.name, Math.max(0, this.step - 1));
    this.diagram.show(part, before, this.modeOf(part.name, this.step));
    this.showRows(part, before);
  }

  showRows(part, mode) {
    const numbers = new Map(part.table.map((row, at) => [row.name, at + 1]));
    const rows = this.explained(part) ?? this.rowsAtHome(part, mode);
    const why = this.live?.flaw ?? this.unexplained;
    const note = why && this.step ? element("p", { class: "soft" }, `Why a transition is refused cannot be told: ${why}.`) : null;
    replaced(place("run-rows"), element("ol", {}, ...rows.map((row) => rowLine(row, numbers.get(row.transition), row.place === undefined ? null : this.whyOf(row)))), ...(note ? [note] : []));
    place("run-rows-box").firstElementChild.textContent = `transitions of ${part.name} in ${mode}`;
  }

  /* The rows of the present mode with the parts that refuse them, where the page has the machine itself. */
  explained(part) {
    const rows = this.live?.rows(this.step);
    return rows?.filter((row) => this.data.parts.length === 1 || row.machine === part.name) ?? null;
  }

  rowsAtHome(part, mode) {
    const fired = new Set(this.firedAt(this.step).filter(([machine]) => machine === part.name || this.alone).map(([, name]) => name));
    return part.table
      .filter((row) => row.source.split(", ").includes(mode))
      .map((row) => ({ transition: row.name, target: row.target, fires: fired.has(row.name), enabled: null }));
  }

  showValues() {
    const word = place("run-filter").value.trim().toLowerCase();
    const only = place("run-only").checked;
    for (const one of this.values) {
      const [was, is] = [one.values[this.step - 1] ?? null, one.values[this.step] ?? null];
      const changed = this.step > 0 && was !== is;
      const hidden = (was === null && is === null) || (only && !changed) || !one.lower.includes(word);
      if (one.row.hidden !== hidden) one.row.hidden = hidden;
      if (!hidden) this.showValue(one, was, is, changed);
    }
    for (const body of place("run-values").tBodies) {
      body.rows[0].hidden = ![...body.rows].slice(1).some((row) => !row.hidden);
    }
  }

  /* Charts the first name that the filter leaves, and goes to it. */
  openFirst() {
    const first = this.values.find((one) => !one.row.hidden);
    if (!first) return;
    if (!this.plotted.includes(first.name)) this.plot(first.name);
    first.button.focus();
  }

  /* Only what differs from what stands there is written: most values stay from step to step. */
  showValue(one, was, is, changed) {
    const first = one.kind !== "state" && !this.step;
    const none = one.kind !== "state" && this.step === 1; // inputs and outputs are of a step, and the first has none before it
    write(one, "before", none ? "\u2013" : this.step ? shown(was, one.signal) : "");
    write(one, "after", first ? "" : shown(is, one.signal));
    if (one.changed !== changed) one.row.classList.toggle("changed", (one.changed = changed));
    const plotted = this.plotted.includes(one.name);
    if (one.plotted !== plotted) one.button.setAttribute("aria-pressed", String((one.plotted = plotted)));
  }

  /* ---------------------------------------------------- watch */

  watch(text) {
    if (text && !this.watched.includes(text)) this.watched.push(text);
    this.showWatched();
    this.moved();
  }

  unwatch(text) {
    this.watched = this.watched.filter((one) => one !== text);
    this.showWatched();
    this.moved();
  }

  showWatched() {
    const now = this.watched.length ? this.live?.values(this.step) ?? {} : {};
    const before = this.watched.length ? this.live?.values(this.step - 1) ?? {} : {};
    place("run-watched").replaceChildren(...this.watched.map((text) => {
      const [was, is] = [this.evaluate(text, this.step - 1, before), this.evaluate(text, this.step, now)];
      const close = element("button", { class: "quiet", onclick: () => this.unwatch(text), "aria-label": `do not watch ${text}` }, "\u00d7");
      return element("tr", { class: was !== is ? "changed" : null }, element("th", { scope: "row" }, element("code", {}, text)), element("td", { class: "n" }, this.step ? was : ""), element("td", { class: "n" }, is), element("td", {}, this.signal(text)?.unit ?? ""), element("td", {}, close));
    }));
  }

  evaluate(text, step, terms) {
    try {
      const found = evaluated(text, (name) => this.valueOf(name, step, terms));
      return typeof found === "bigint" ? shown(found, null) : String(found ?? "absent");
    } catch (error) {
      return error.message;
    }
  }

  /* The value of a name after a step, in the machine's own words; of a term that the machine names, in that step. */
  valueOf(name, step, terms) {
    const kind = ["state", "outputs", "inputs"].find((one) => this.trace.names[one].includes(name));
    if (!kind && !(name in terms)) throw new Error(`no ${name}${step > 0 && !this.live ? " in this run" : ""}`);
    const value = kind ? this.trace.at(kind, name, step) : terms[name];
    if (value === null || typeof value === "boolean" || typeof value === "string") return value;
    return this.signal(name)?.members?.length ? shown(value, this.signal(name)) : BigInt(value);
  }

  markStep() {
    for (const row of this.body.querySelectorAll("[aria-current]")) row.removeAttribute("aria-current");
    this.body.querySelector(`[data-step="${this.step}"]`)?.setAttribute("aria-current", "step");
  }

  /* Brings the row of the cursor into sight, without moving the page. */
  follow() {
    const box = place("run-steps-box");
    const top = this.step * BOUND;
    if (top < box.scrollTop || top > box.scrollTop + box.clientHeight - 3 * BOUND) box.scrollTop = Math.max(0, top - box.clientHeight / 2);
    this.rowsAround(Math.floor(box.scrollTop / BOUND));
    this.markStep();
  }
}

/* The machine of a composition that a run is of, if it is one of that machine by itself; nothing for a run of the whole. */
const memberOf = (data, trace) => (data.parts.length > 1 && trace.machine.startsWith(`${data.name} `) ? trace.machine.slice(data.name.length + 1) : "");

/* "machine: name" in its two parts. */
const apart = (text) => [text.slice(0, text.indexOf(": ")), text.slice(text.indexOf(": ") + 2)];

/* A name that goes over lines ends them at its own marks, not within a word. */
const apartAtMarks = (name) => name.split(/(?<=[._])/).flatMap((part, at) => (at ? [element("wbr"), part] : [part]));

const cut = (text, most) => (text.length > most ? `${text.slice(0, most)}\u2026` : text);

function write(one, cell, text) {
  if (one.texts[cell] !== text) one.cells[cell].textContent = one.texts[cell] = text;
}

/* A transition of the present mode: it fired, or was enabled, or is refused by parts of its guard. */
function rowLine(row, number, why) {
  const word = row.fires ? "fired" : row.enabled === null ? "" : row.enabled ? "enabled" : "refused";
  const head = [element("b", {}, row.transition), ` \u2192 ${row.target}`, word ? element("span", { class: `tag ${word}` }, word) : null];
  return element("li", { value: number, class: row.fires ? "took" : null }, ...head, why);
}
