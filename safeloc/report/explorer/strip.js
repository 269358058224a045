/* The line at one step: the train, the intervals that the machine states, sections with their modes, and places that inputs name. */

const NAMED = 170; // greatest width of the column of names, in pixels
const NARROWEST = 200; // of a line that is drawn
const ROW = 22;
const LEAST_MM = 20000; // of the stretch of the line that is shown
const SPANS = 6; // as many widths of the widest reported interval are shown

class Strip {
  constructor(box, view) {
    this.box = box;
    this.view = view;
    this.card = box.closest("section");
    this.truth = truthOf(view.trace, view.data.reported?.truth);
    this.spans = [...this.stated(), ...this.bounded()];
    this.places = view.columns("inputs").filter(({ name, signal }) => signal?.unit === "mm" && /(^|[._])(position|place)_mm$/.test(name));
    this.card.hidden = this.spans.length === 0 || (this.spans.every(({ from }) => from.every((value) => value === null)) && this.truth.every((value) => value === null));
    this.stretch = this.widest();
    this.resized = new ResizeObserver(() => this.width !== box.clientWidth && this.show(this.step));
    this.resized.observe(box);
  }

  close() {
    this.resized.disconnect();
  }

  column(name) {
    const kind = ["outputs", "state", "inputs"].find((one) => this.view.trace.names[one].includes(name));
    return kind ? this.view.trace.series(kind, name).map((value) => (typeof value === "boolean" || value === null ? value : Number(value))) : null;
  }

  /* Outputs that are a position with its margins: PART.position_mm, PART.margin_below_mm, PART.margin_above_mm. */
  stated() {
    const named = this.view.trace.names.outputs.filter((name) => /(^|\.)position_mm$/.test(name));
    return named.flatMap((name) => {
      const part = name.slice(0, -"position_mm".length);
      const [at, below, above] = ["position_mm", "margin_below_mm", "margin_above_mm"].map((one) => this.column(part + one));
      if (!at || !below || !above) return [];
      const valid = this.validOf(name, part);
      const given = at.map((value, step) => (valid && !valid[step] ? null : value));
      return [{ name: part.slice(0, -1) || "reported", at: given, from: minus(given, below), to: plus(given, above), mode: null }];
    });
  }

  validOf(name, part) {
    const names = this.view.data.reported;
    if (names?.position === name) return this.column(names.valid)?.map((value) => value === names.valid_is) ?? null;
    return this.column(`${part}valid`);
  }

  /* Pairs of bounds: sections from and to, with their mode; other places low and high. */
  bounded() {
    const { outputs, state } = this.view.trace.names;
    return [...new Set([...outputs, ...state])].flatMap((name) => {
      const [, stem, ending] = /^(.*?)(from|low)_mm$/.exec(name) ?? [];
      if (stem === undefined || /length|view|range/.test(stem) || this.view.signal(name)?.unit !== "mm") return [];
      const [from, to] = [this.column(name), this.column(`${stem}${ending === "from" ? "to" : "high"}_mm`)];
      if (!from || !to) return [];
      const mode = ending === "from" && state.includes(`${stem}mode`) ? `${stem}mode` : null;
      return [{ name: stem.replace(/[._]$/, ""), at: null, from, to, mode }];
    });
  }

  widest() {
    const reported = this.spans.find(({ name }) => `${name}.position_mm` === this.view.data.reported?.position) ?? this.spans[0];
    const widths = reported ? minus(reported.to, reported.from).filter((value) => value !== null && Number.isFinite(value)) : [];
    return Math.max(LEAST_MM, SPANS * widths.reduce((most, value) => Math.max(most, value), 0));
  }

  /* The stretch of the line around the train, which moves on in quarters, so that what stands still stays in its place. */
  window(step) {
    const known = [this.truth[step], ...this.spans.map(({ at, from }) => at?.[step] ?? from[step])];
    const around = known.find((value) => value !== null && value !== undefined) ?? 0;
    const quarter = this.stretch / 4;
    const begin = (Math.floor(around / quarter) - 1.5) * quarter;
    return [begin, begin + this.stretch];
  }

  show(step) {
    this.step = step;
    this.width = this.box.clientWidth;
    if (this.card.hidden || this.width < NARROWEST) return;
    this.named = Math.min(NAMED, Math.round(this.width * 0.38));
    [this.begin, this.end] = this.window(step);
    const shownNow = this.spans.filter(({ from, to }) => from[step] !== null && to[step] !== null);
    const marks = this.places.filter(({ values }) => values[step] !== null).map(({ name, values }) => ({ name, at: Number(values[step]) }));
    const tall = ROW * (shownNow.length + marks.length + 2) + 6;
    const svg = drawn("svg", { width: this.width, height: tall, role: "img", "aria-label": this.words(step, shownNow, marks) }, ...this.axis(tall));
    shownNow.forEach((span, row) => svg.append(...this.spanAt(span, step, ROW * (row + 1))));
    marks.forEach((mark, row) => svg.append(...this.markAt(mark, ROW * (row + 1 + shownNow.length))));
    if (this.truth[step] !== null) svg.append(...this.train(this.truth[step], tall));
    this.box.replaceChildren(svg);
  }

  words(step, spans, marks) {
    const train = this.truth[step] === null ? [] : [`train at ${metres(this.truth[step])}`];
    const stated = spans.map(({ name, from, to, mode }) => `${name} ${metres(from[step])} to ${metres(to[step])}${mode ? ` ${this.modeAt(mode, step)}` : ""}`);
    return [...train, ...stated, ...marks.map(({ name, at }) => `${name} ${metres(at)}`)].join("; ") || "nothing is known";
  }

  modeAt(name, step) {
    return shown(this.view.trace.at("state", name, step), this.view.signal(name));
  }

  x(at) {
    return this.named + ((this.width - this.named - 10) * (at - this.begin)) / (this.end - this.begin);
  }

  axis(tall) {
    const unit = 10 ** Math.floor(Math.log10(this.stretch / 4));
    const gap = [1, 2, 5, 10].map((factor) => factor * unit).find((one) => this.stretch / one <= Math.max(2, Math.min(8, (this.width - this.named) / 70))) ?? 10 * unit;
    const made = [];
    for (let at = Math.ceil(this.begin / gap) * gap; at <= this.end; at += gap) {
      made.push(drawn("line", { class: "grid", x1: this.x(at), x2: this.x(at), y1: 0, y2: tall - ROW }));
      const atEdge = this.x(at) > this.width - 40;
      made.push(drawn("text", { class: "tick", x: this.x(at), y: tall - 6, "text-anchor": atEdge ? "end" : "middle" }, metres(at)));
    }
    return made;
  }

  label(name, y) {
    const most = Math.floor(this.named / 6.6);
    const text = name.length > most ? `\u2026${name.slice(1 - most)}` : name;
    return drawn("text", { class: "tick", x: this.named - 8, y: y + 14, "text-anchor": "end" }, drawn("title", {}, name), text);
  }

  spanAt({ name, at, from, to, mode }, step, y) {
    const [low, high] = [from[step], to[step]];
    const made = [this.label(name, y)];
    if (high < this.begin || low > this.end) return [...made, this.beyond(low > this.end ? low : high, y)];
    const [left, right] = [Math.max(low, this.begin), Math.min(high, this.end)].map((one) => this.x(one));
    const lane = mode === null ? "span" : `span lane${Number(this.view.trace.at("state", mode, step)) % 8}`;
    made.push(drawn("rect", { class: lane, x: left, y: y + 3, width: Math.max(2, right - left), height: ROW - 6 }, drawn("title", {}, `${name}: ${metres(low)} to ${metres(high)}`)));
    if (mode !== null) made.push(drawn("text", { class: "in-lane", x: left + 5, y: y + 15 }, this.modeAt(mode, step)));
    if (at !== null && at[step] >= this.begin && at[step] <= this.end) made.push(drawn("line", { class: "line", x1: this.x(at[step]), x2: this.x(at[step]), y1: y + 2, y2: y + ROW - 2 }));
    return made;
  }

  markAt({ name, at }, y) {
    if (at < this.begin || at > this.end) return [this.label(name, y), this.beyond(at, y)];
    const x = this.x(at);
    const shape = drawn("path", { class: "sensed", d: `M${x} ${y + 4}l6 6l-6 6l-6 -6z` }, drawn("title", {}, `${name}: ${metres(at)}`));
    return [this.label(name, y), shape, drawn("text", { class: "tick", x: x + 10, y: y + 14 }, metres(at))];
  }

  /* What lies outside the stretch: an arrow at its side, with the place. */
  beyond(at, y) {
    const right = at > this.end;
    const text = right ? `${metres(at)} \u2192` : `\u2190 ${metres(at)}`;
    return drawn("text", { class: "tick", x: right ? this.width - 12 : this.named + 4, y: y + 14, "text-anchor": right ? "end" : "start" }, text);
  }

  train(at, tall) {
    const x = this.x(at);
    return [
      drawn("line", { class: "cursor", x1: x, x2: x, y1: ROW - 4, y2: tall - ROW }),
      drawn("path", { class: "train", d: `M${x} 6h-26v12h26l7 -6z` }, drawn("title", {}, `true position: ${metres(at)}`)),
      this.label("train", 0),
    ];
  }
}

/* Millimetres as metres, with all their digits. */
function metres(at) {
  const whole = Math.round(at);
  const text = shown(Math.trunc(Math.abs(whole) / 1000), null);
  const rest = String(Math.abs(whole) % 1000).padStart(3, "0").replace(/0+$/, "");
  return `${whole < 0 ? "\u2212" : ""}${text}${rest ? `.${rest}` : ""} m`;
}
