/* Lanes of modes and line charts of a run, all on one scale of steps. A click or a drag moves the cursor, or zooms. */

const LEFT = 94; // as wide as 1 000 000 000
const RIGHT = 12;
const TALL = 150;
const LANE = 22;

class Charts {
  /* box: where they are drawn; lanes, charts: what; moved: called with a step that was chosen. */
  constructor(box, steps, moved) {
    this.box = box;
    this.steps = steps;
    this.moved = moved;
    this.lanes = [];
    this.charts = [];
    this.marks = [];
    this.step = 0;
    this.periodMs = null; // length of a step, where the configuration has it
    this.whole();
    this.drag = null;
    this.resized = new ResizeObserver(() => this.width !== box.clientWidth && this.draw());
    this.resized.observe(box);
  }

  whole() {
    this.from = 0;
    this.to = Math.max(this.steps, 1);
  }

  x(step) {
    return LEFT + ((this.width - LEFT - RIGHT) * (step - this.from)) / (this.to - this.from);
  }

  stepAt(x) {
    const share = (x - LEFT) / (this.width - LEFT - RIGHT);
    return Math.min(this.steps, Math.max(0, Math.round(this.from + share * (this.to - this.from))));
  }

  zoom(factor, around = this.step) {
    const length = Math.max(8, Math.min(this.steps, (this.to - this.from) * factor));
    const share = (around - this.from) / (this.to - this.from);
    const inside = share >= 0 && share <= 1 ? share : 0.5;
    this.show(Math.round(around - inside * length), Math.round(around + (1 - inside) * length));
  }

  show(from, to) {
    this.from = Math.max(0, Math.min(from, this.steps - 1));
    this.to = Math.min(Math.max(this.steps, 1), Math.max(to, this.from + 1));
    this.draw();
  }

  draw() {
    this.width = this.box.clientWidth;
    if (this.width < LEFT + RIGHT + 20) return;
    this.lines = [];
    this.hovers = [];
    this.readouts = [];
    const made = this.lanes.length ? [this.drawLanes()] : [];
    for (const chart of this.charts) made.push(this.drawChart(chart));
    if (made.length) made.push(this.drawSteps());
    this.box.replaceChildren(...made);
    this.move(this.step);
  }

  /* Puts the cursor on a step, and says the values there. */
  move(step) {
    this.step = step;
    if (step < this.from || step > this.to) {
      const length = this.to - this.from;
      this.show(step - Math.round(length / 2), step - Math.round(length / 2) + length);
      return;
    }
    for (const line of this.lines) line.setAttribute("transform", `translate(${this.x(step).toFixed(1)} 0)`);
    this.read(step);
  }

  read(step) {
    for (const { chart, cells } of this.readouts) {
      chart.lines.forEach((line, at) => (cells[at].textContent = said(line.values[step], chart.unit)));
    }
  }

  /* Says the values of a step under the pointer, in all charts at once; without one those of the cursor. */
  hover(step) {
    this.read(step ?? this.step);
    for (const line of this.hovers) {
      line.style.visibility = step === null ? "hidden" : "visible";
      if (step !== null) line.setAttribute("transform", `translate(${this.x(step).toFixed(1)} 0)`);
    }
  }

  frame(height, label) {
    const svg = drawn("svg", { viewBox: `0 0 ${this.width} ${height}`, height, role: "img", "aria-label": label });
    const cursor = drawn("line", { class: "cursor", x1: 0, x2: 0, y1: 0, y2: height });
    const hover = drawn("line", { class: "hover", x1: 0, x2: 0, y1: 0, y2: height });
    this.lines.push(cursor);
    this.hovers.push(hover);
    svg.append(hover);
    this.listen(svg);
    return [svg, cursor];
  }

  /* The way of the violation and of the end of the run, drawn over everything else. */
  markers(height) {
    return this.marks
      .filter(({ step }) => step >= this.from && step <= this.to)
      .map(({ step, words, kind }) => {
        const x = this.x(step).toFixed(1);
        return drawn("g", {}, drawn("line", { class: kind ?? "mark", x1: x, x2: x, y1: 0, y2: height }), drawn("title", {}, words));
      });
  }

  drawLanes() {
    const height = this.lanes.length * LANE + 4;
    const [svg, cursor] = this.frame(height, "modes");
    this.lanes.forEach((lane, row) => {
      const y = 2 + row * LANE;
      svg.append(drawn("text", { x: LEFT - 8, y: y + 14, class: "tick", "text-anchor": "end" }, short(lane.name, LEFT - 10)));
      for (const [value, from, to] of stretches(lane.values, this.from, this.to)) {
        const x = this.x(from);
        const width = Math.max(1.5, this.x(to) - x);
        const tip = `${lane.name} = ${lane.words(value)}, steps ${from} to ${Math.max(from, to - 1)}`;
        svg.append(
          drawn("rect", { x, y, width, height: LANE - 4, class: `lane lane${Number(value) % 8}` }, drawn("title", {}, tip)),
        );
        const words = lane.words(value);
        if (words.length * 7.4 + 6 < width) svg.append(drawn("text", { x: x + 4, y: y + 13, class: "in-lane" }, words));
      }
    });
    svg.append(...this.markers(height), cursor);
    return element("figure", { class: "lanes" }, element("figcaption", {}, "mode of each machine"), svg);
  }

  drawChart(chart) {
    const [svg, cursor] = this.frame(TALL, `${chart.title}, in ${chart.unit || "numbers"}`);
    const every = [...chart.lines, ...(chart.band ?? []).map((values) => ({ values }))];
    const scale = upright(every, this.from, this.to);
    for (const tick of scale.ticks) {
      const y = scale.y(tick).toFixed(1);
      svg.append(
        drawn("line", { class: "grid", x1: LEFT, x2: this.width - RIGHT, y1: y, y2: y }),
        drawn("text", { class: "tick", x: LEFT - 8, y: Number(y) + 4, "text-anchor": "end" }, number(tick)),
      );
    }
    if (chart.band) svg.append(drawn("path", { class: "band", d: this.area(chart.band, scale) }));
    chart.lines.forEach((line, at) => svg.append(drawn("path", { class: `line line${at}`, d: this.path(line.values, scale) })));
    svg.append(...this.markers(TALL), cursor);
    return element("figure", {}, this.caption(chart), svg);
  }

  /* The scale of steps below all lanes and charts, with the time at each where the length of a step is known. */
  drawSteps() {
    const tall = this.periodMs ? 34 : 20;
    const svg = drawn("svg", { viewBox: `0 0 ${this.width} ${tall}`, height: tall, role: "img", "aria-label": `steps ${this.from} to ${this.to}` });
    const least = ((this.to - this.from) * 80) / (this.width - LEFT - RIGHT);
    const word = (text, y) => drawn("text", { class: "tick", x: LEFT - 8, y, "text-anchor": "end" }, text);
    svg.append(word("step", 12), ...(this.periodMs ? [word("time in s", 28)] : []));
    for (const step of scaled(this.from, this.to, Math.max(least, 1))) {
      const at = (text, y) => drawn("text", { class: "tick", x: this.x(step).toFixed(1), y, "text-anchor": "middle" }, text);
      svg.append(at(number(step), 12), ...(this.periodMs ? [at(number((step * this.periodMs) / 1000), 28)] : []));
    }
    return element("figure", {}, svg);
  }

  caption(chart) {
    const cells = chart.lines.map(() => element("b", {}));
    this.readouts.push({ chart, cells });
    const keys = chart.lines.map((line, at) =>
      element("span", { class: "key" }, element("i", { class: `swatch swatch${at}` }), `${line.name} `, cells[at]),
    );
    const close = chart.closed ? element("button", { class: "quiet", onclick: chart.closed, "aria-label": `close the chart of ${chart.title}` }, "\u00d7") : null;
    return element("figcaption", {}, element("span", {}, chart.unit ? `${chart.title}, in ${chart.unit}` : chart.title), ...keys, close);
  }

  path(values, scale) {
    let text = "";
    let up = true;
    for (const [step, value] of this.thinned(values)) {
      if (value === null) up = true;
      else {
        text += `${up ? "M" : "L"}${this.x(step).toFixed(1)} ${scale.y(value).toFixed(1)}${up ? "h.01" : ""}`;
        up = false;
      }
    }
    return text;
  }

  area([low, high], scale) {
    let text = "";
    let run = [];
    const close = () => {
      if (!run.length) return;
      const point = (step, value) => `${this.x(step).toFixed(1)} ${scale.y(value).toFixed(1)}`;
      const there = run.map((step) => point(step, high[step]));
      const back = run.reverse().map((step) => point(step, low[step]));
      text += `M${[...there, ...back].join("L")}Z`;
      run = [];
    };
    for (let step = this.from; step <= this.to; step += 1) {
      if (low[step] === null || low[step] === undefined || high[step] === null) close();
      else run.push(step);
    }
    close();
    return text;
  }

  /* Of many steps in one column of the screen, the first, lowest, highest and last. */
  *thinned(values) {
    const every = Math.max(1, Math.floor((this.to - this.from) / Math.max(this.width, 1) / 2));
    for (let from = this.from; from <= this.to; from += every) {
      let low = from;
      let high = from;
      const to = Math.min(from + every - 1, this.to);
      for (let step = from; step <= to; step += 1) {
        if (values[step] === null || values[step] === undefined) continue;
        if (values[low] === null || values[step] < values[low]) low = step;
        if (values[high] === null || values[step] > values[high]) high = step;
      }
      for (const step of [...new Set([from, low, high, to])].sort((a, b) => a - b)) yield [step, values[step] ?? null];
    }
  }

  listen(svg) {
    const at = (event) => this.stepAt(event.clientX - svg.getBoundingClientRect().left);
    svg.addEventListener("pointerdown", (event) => (this.drag = { from: at(event), x: event.clientX }));
    svg.addEventListener("pointermove", (event) => this.hover(at(event)));
    svg.addEventListener("pointerleave", () => this.hover(null));
    svg.addEventListener("pointerup", (event) => {
      const drag = this.drag;
      this.drag = null;
      if (drag && Math.abs(event.clientX - drag.x) > 12) this.show(...[drag.from, at(event)].sort((a, b) => a - b));
      else this.moved(at(event));
    });
    svg.addEventListener("dblclick", () => {
      this.whole();
      this.draw();
    });
  }
}

/* Yields [value, first step, step after the last one] of each stretch of equal values. */
function* stretches(values, from, to) {
  let begun = from;
  for (let step = from + 1; step <= to; step += 1) {
    if (values[step] === values[begun]) continue;
    yield [values[begun], begun, step];
    begun = step;
  }
  yield [values[begun], begun, to];
}

function upright(lines, from, to) {
  let low = Infinity;
  let high = -Infinity;
  for (const { values } of lines) {
    for (let step = from; step <= to; step += 1) {
      const value = values[step];
      if (value === null || value === undefined) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) [low, high] = [0, 1];
  const room = (high - low) * 0.06 || 1;
  low -= room;
  high += room;
  const y = (value) => TALL - 8 - ((TALL - 16) * (value - low)) / (high - low);
  return { y, ticks: scaled(low, high, ((high - low) * 34) / TALL) };
}

/* Round numbers from one value to another that are at least so far apart. */
function scaled(low, high, least) {
  const power = 10 ** Math.floor(Math.log10(least));
  const apart = [1, 2, 5, 10].find((factor) => factor * power >= least * 0.999) * power;
  const ticks = [];
  for (let at = Math.ceil(low / apart); at <= Math.floor(high / apart); at += 1) ticks.push(at * apart);
  return ticks;
}

const number = (value) => shown(Math.abs(value) < 1e-9 ? 0 : Number(value.toPrecision(9)), null);
const said = (value, unit) => (value === null || value === undefined ? "none" : `${number(value)}${unit ? `\u00a0${unit}` : ""}`);
const short = (text, room) => (text.length * 6.3 > room ? `\u2026${text.slice(-Math.floor(room / 6.3) + 1)}` : text);
