/* A run with other inputs: it has the steps of a stored run up to one of them, and goes on as the machine does. */

class Branch extends Trace {
  constructor(trace, live, from) {
    super(trace.runs, trace.number);
    this.results = trace.results;
    this.stored = trace;
    this.from = from;
    this.steps = from;
    this.live = new Live(live.machine, this);
    this.columns = KINDS.flatMap((kind) => this.names[kind].map((name) => [kind, name]));
    for (const [kind, name] of this.columns) this.found.set(`${kind} ${name}`, trace.series(kind, name).slice(0, from + 1));
    this.found.set("truth", trace.truth.slice(0, from + 1));
  }

  /* Takes a step with these inputs, in the machine's own form. RangeError for inputs that the machine refuses. */
  take(given, signals) {
    const { machine } = this.live;
    const made = machine.step(this.live.before(this.steps + 1), given);
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
    this.steps -= 1;
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
    const row = ([one, field]) => element("p", {}, element("label", { for: field.id }, one.name), field, element("span", { class: "soft" }, rangeOf(one)));
    const own = this.fields.filter(([one]) => !one.ghost).map(row);
    const world = this.fields.filter(([one]) => one.ghost).map(row);
    box.replaceChildren(...own, ...(world.length ? [element("details", {}, element("summary", {}, `${world.length} inputs of the world: how the train moves and its sensors err`), ...world)] : []));
  }

  /* Fills in what was given in a step. */
  fill(given) {
    for (const [one, field] of this.fields) field.value = String(given[one.name] ?? "");
  }

  /* What is filled in, in the machine's own form; an empty field is an absent input. RangeError for what is no number. */
  get given() {
    const found = {};
    for (const [one, field] of this.fields) {
      const text = field.value.trim();
      if (text === "" && one.optional) continue;
      if (one.kind === "integer" && !/^-?\d+$/.test(text)) throw new RangeError(`${one.name}: ${text || "nothing"} is no whole number.`);
      found[one.name] = one.kind === "integer" ? BigInt(text) : one.kind === "boolean" ? text === "true" : text;
    }
    return found;
  }
}

function fieldOf(one) {
  const id = `run-input-${one.name}`;
  if (one.kind === "integer") return element("input", { id, inputmode: "numeric", autocomplete: "off", placeholder: one.optional ? "absent" : "" });
  const values = one.kind === "boolean" ? ["false", "true"] : one.values;
  const options = values.map((value) => element("option", { value }, value));
  return element("select", { id }, ...(one.optional ? [element("option", { value: "" }, "absent")] : []), ...options);
}

const rangeOf = (one) => (one.kind === "integer" ? `${shown(one.least, null)} to ${shown(one.most, null)} ${one.unit}` : "");

function download(name, text) {
  const address = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
