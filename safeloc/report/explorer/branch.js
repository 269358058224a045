const MOST_STEPS = 10000; // that a link may take, and a press of a button

/* A run with other inputs: it has the steps of a stored run up to one of them, and goes on as the machine does. */

class Branch extends Trace {
  constructor(trace, live, from) {
    super(trace.runs, trace.number);
    this.results = trace.results;
    this.stored = trace;
    this.from = from;
    this.steps = from;
    this.live = new Live(live.machine, this);
    this.names = { ...trace.names, inputs: [...new Set([...trace.names.inputs, ...this.live.inputs.map(({ name }) => name)])] }; // also those that no stored run has
    this.columns = KINDS.flatMap((kind) => this.names[kind].map((name) => [kind, name]));
    const absent = Array(from + 1).fill(null);
    for (const [kind, name] of this.columns) this.found.set(`${kind} ${name}`, (trace.series(kind, name) ?? absent).slice(0, from + 1));
    this.found.set("truth", trace.truth.slice(0, from + 1));
    this.monitors = this.live.monitors(from).slice(-1);
    this.taken = [];
  }

  /* What the claims of the machine say of the steps that were taken here: statement, step and name of each that one of them breaks. */
  get broken() {
    return this.became(true).map(({ statement, step, name }) => [statement, step, name]);
  }

  /* Claims that say nothing any more, since a step broke what they assume. */
  get silent() {
    return this.became(false);
  }

  became(broken) {
    const { claims } = this.live.machine;
    const found = this.monitors.at(-1).became.map((one, at) => one && { ...one, name: claims[at].name, statement: claims[at].statement });
    return found.filter((one) => one && one.broken === broken && one.step > this.from).sort((one, other) => one.step - other.step);
  }

  /* Takes a step with these inputs, in the machine's own form. RangeError for inputs that the machine refuses. */
  take(given, signals) {
    const { machine } = this.live;
    const before = this.live.before(this.steps + 1);
    const made = machine.step(before, given);
    this.monitors.push(machine.monitored(this.monitors.at(-1), before, given));
    this.taken.push(given);
    const fired = Object.fromEntries(machine.machines.map((name, at) => [machine.machines.length === 1 ? "fired" : `${name}.fired`, made.fired[at]]));
    const values = { inputs: given, fired, state: made.state, outputs: made.outputs };
    for (const [kind, name] of this.columns) {
      this.found.get(`${kind} ${name}`).push(asStored(values[kind][name] ?? null, kind === "fired" ? null : signals[name]));
    }
    this.found.get("truth").push(null);
    this.steps += 1;
  }

  /* Inputs of a stored step, in the machine's own form. */
  storedInputs(step) {
    return new Live(this.live.machine, this.stored).given(step);
  }

  back() {
    for (const values of this.found.values()) values.pop();
    this.monitors.pop();
    this.taken.pop();
    this.steps -= 1;
  }

  /* ---------------------------------------------------- as a link */

  /* What the recording has as inputs of a step, or the step before where it has none: what a link tells differences from. */
  base(step) {
    if (step <= this.stored.steps) return this.storedInputs(step);
    return step - this.from >= 2 ? this.taken[step - this.from - 2] : step > 1 ? this.live.given(step - 1) : {};
  }

  /* The steps that were taken here, as [how many, what differs from the base] of equal ones in a row. */
  changes() {
    const found = [];
    this.taken.forEach((given, at) => {
      const base = this.base(this.from + at + 1);
      const names = Object.keys({ ...base, ...given }).filter((name) => (base[name] ?? null) !== (given[name] ?? null));
      const differs = this.live.machine.toJson(Object.fromEntries(names.map((name) => [name, given[name] ?? null])));
      if (found.length && JSON.stringify(found.at(-1)[1]) === JSON.stringify(differs)) found.at(-1)[0] += 1;
      else found.push([1, differs]);
    });
    return found;
  }

  /* Takes the steps of a link. RangeError or Error for what is no such list, or what the machine refuses. */
  follow(changes, signals) {
    const isList = Array.isArray(changes) && changes.every((one) => Array.isArray(one) && one.length === 2 && Number.isInteger(one[0]) && one[0] > 0 && one[1] && Object.getPrototypeOf(one[1]) === Object.prototype);
    if (!isList) throw new Error("its changes are damaged");
    if (changes.reduce((sum, [count]) => sum + count, 0) > MOST_STEPS) throw new Error(`it has more than ${shown(MOST_STEPS, null)} steps`);
    for (const [count, differs] of changes) {
      for (let at = 0; at < count; at += 1) this.take(present({ ...this.base(this.steps + 1), ...this.live.machine.fromJson(differs) }), signals);
    }
  }

  /* The run as a file: the inputs of every step, and the first values that the machine leaves open. */
  written(form) {
    const { machine } = this.live;
    const rows = Array.from({ length: this.steps }, (_, at) => this.live.given(at + 1));
    const open = machine.variables.filter((one) => one.role === "state" && one.open).map(({ name }) => name);
    const first = this.live.read("state", open, 0);
    const [begun, here] = [machine.first(first), this.live.before(1)];
    if (this.live.state.some((name) => begun[name] !== here[name])) throw new Error("this run begins in a state that is no first state of the machine, so no stream can hold it.");
    return machine[form](rows, first);
  }
}

/* A value as runs are stored: numbers, exact beyond those that JavaScript holds, and the number of a label. */
function asStored(value, signal) {
  if (typeof value === "string" && signal) return signal.members.indexOf(value);
  if (typeof value !== "bigint") return value;
  return value >= Number.MIN_SAFE_INTEGER && value <= Number.MAX_SAFE_INTEGER ? Number(value) : value;
}

/* ------------------------------------------------------ the form for the inputs of the next step */

class Inputs {
  constructor(box, live) {
    this.live = live;
    this.fields = live.inputs.map((one) => [one, fieldOf(one)]);
    const row = ([one, field]) => element("p", {}, element("label", { for: field.id }, one.name), field, this.release(one), element("span", { class: "soft" }, rangeOf(one)));
    this.releases = new Map();
    this.rows = this.fields.map((pair) => ({ name: pair[0].name, of: groupOf(pair[0]), row: row(pair) }));
    this.own = new Set(); // names that somebody set: they stay where the others follow the recording
    for (const [one, field] of this.fields) field.addEventListener("input", () => this.choose(one.name, true));
    this.box = box;
    this.arrange();
  }

  /* What was set by hand first, then each machine's inputs, then those of the world; rows keep their fields and what is in them. */
  arrange() {
    const world = this.rows.filter(({ of }) => of === WORLD);
    const rest = this.rows.filter(({ of, name }) => of !== WORLD && !this.own.has(name));
    const groups = [[YOURS, this.rows.filter(({ name }) => this.own.has(name))], ...[...new Set(rest.map(({ of }) => of))].map((of) => [of, rest.filter((one) => one.of === of)])];
    const heads = groups.filter(([, rows]) => rows.length).map(([of, rows]) => element("div", { role: "group", "aria-label": of || "inputs" }, of ? element("h3", {}, of) : null, ...rows.map(({ row }) => row)));
    const left = world.filter(({ name }) => !this.own.has(name)).map(({ row }) => row);
    this.world = element("details", { open: this.world?.open ?? false }, element("summary", {}, `${world.length} inputs of the world: how the train moves and its sensors err`), ...left);
    this.box.replaceChildren(...heads, ...(world.length ? [this.world] : []));
    this.filter(this.words ?? "");
  }

  /* Shows the inputs that have all of these words in their name; returns how many there are. */
  filter(text) {
    this.words = text;
    const words = text.toLowerCase().split(/\s+/).filter(Boolean);
    for (const { name, row } of this.rows) row.hidden = !words.every((word) => name.toLowerCase().includes(word));
    for (const group of this.box.querySelectorAll("[role=group]")) group.hidden = [...group.querySelectorAll("p")].every((row) => row.hidden);
    this.world.hidden = [...this.world.querySelectorAll("p")].every((row) => row.hidden);
    if (words.length && !this.world.hidden) this.world.open = true;
    return this.rows.filter(({ row }) => !row.hidden).length;
  }

  release(one) {
    const button = element("button", { class: "quiet own", hidden: true, "aria-label": `${one.name} as recorded again`, onclick: () => this.choose(one.name, false) }, "yours \u00d7");
    this.releases.set(one.name, button);
    return button;
  }

  /* Marks an input as set by hand, or gives it back to the recording. */
  choose(name, isOwn) {
    this.own[isOwn ? "add" : "delete"](name);
    this.releases.get(name).hidden = !isOwn;
    if (!isOwn) this.fill(this.filled);
    this.changed?.();
  }

  /* Marks these as set by hand, with their values in a step: what a link holds of the form. */
  restore(names, given) {
    for (const [one, field] of this.fields) {
      if (!names.includes(one.name)) continue;
      field.value = String(given[one.name] ?? "");
      this.own.add(one.name);
      this.releases.get(one.name).hidden = false;
    }
  }

  /* Fills in what was given in a step; what somebody set stays. */
  fill(given) {
    this.filled = given;
    for (const [one, field] of this.fields) if (!this.own.has(one.name)) field.value = String(given[one.name] ?? atRest(one));
    this.arrange();
  }

  /* These inputs of the recording, with what somebody set in their place. */
  over(recorded) {
    const given = this.given;
    const own = [...this.own].map((name) => [name, given[name] ?? null]);
    return present({ ...recorded, ...Object.fromEntries(own) });
  }

  /* What is filled in, in the machine's own form; an empty field is an absent input. RangeError for what is no number. */
  get given() {
    const found = {};
    for (const [one, field] of this.fields) {
      const text = field.value.trim();
      if (text === "" && one.optional) continue;
      if (one.kind === "integer" && !/^-?\d+$/.test(text)) throw new RangeError(text ? `${one.name}: ${text} is no whole number.` : `${one.name} is empty, but it cannot be absent: give a whole number, ${rangeOf(one)}.`);
      found[one.name] = one.kind === "integer" ? BigInt(text) : one.kind === "boolean" ? text === "true" : text;
    }
    return found;
  }
}

/* What an input has where nothing is recorded of it: absent, or the value nearest to zero, or the first. */
function atRest(one) {
  if (one.optional) return "";
  if (one.kind === "boolean") return "false";
  if (one.kind !== "integer") return one.values[0];
  const [least, most] = [BigInt(one.least), BigInt(one.most)];
  return least > 0n ? least : most < 0n ? most : 0n;
}

const YOURS = "set by you";
const WORLD = "world";

/* The group of an input: the world, the machine of a composition that it belongs to, or none. */
const groupOf = ({ ghost, name }) => (ghost ? WORLD : name.includes(".") ? name.slice(0, name.indexOf(".")) : "");

/* Inputs without those that are absent. */
const present = (given) => Object.fromEntries(Object.entries(given).filter(([, value]) => value !== null && value !== undefined));

function fieldOf(one) {
  const id = `run-input-${one.name}`;
  if (one.kind === "integer") return element("input", { id, inputmode: "numeric", autocomplete: "off", placeholder: one.optional ? "absent" : "" });
  const values = one.kind === "boolean" ? ["false", "true"] : one.values;
  const options = values.map((value) => element("option", { value }, value));
  return element("select", { id }, ...(one.optional ? [element("option", { value: "" }, "absent")] : []), ...options);
}

const rangeOf = (one) => (one.kind === "integer" ? `${shown(one.least, null)} to ${shown(one.most, null)}\u00a0${one.unit}` : "");

function download(name, text) {
  const address = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
