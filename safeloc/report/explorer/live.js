/* The machine itself, where the page has it: which transitions are refused and why, terms by name, and steps with other inputs.
   It is the script that `safeloc export --to javascript` writes; docs/export.md tells what it does. */

const machines = new Map();
window.safelocMachine = (name, machine) => machines.set(name, machine);
window.safelocScript = (name, text) => arrive(`script ${name}`, text);

/* The machine of a target, by the name of its system; null where the page has none, or a run is one of a part by itself. Error for a
   script that cannot be loaded. */
async function machineOf(file, script, trace) {
  if (script && !machines.has(trace.machine)) {
    const text = await fetchedText(`script ${file}`, script);
    if (!machines.has(trace.machine) && text) {
      document.head.append(element("script", {}, text)); // our own text, as safe as that of this page
    }
  }
  const machine = machines.get(trace.machine) ?? null;
  return machine && new Live(machine, trace);
}

class Live {
  constructor(machine, trace) {
    this.machine = machine;
    this.trace = trace;
    this.state = machine.variables.filter((one) => one.role === "state").map((one) => one.name);
    this.inputs = machine.variables.filter((one) => one.role === "input");
    this.fits = this.state.every((name) => trace.at("state", name, 0) !== null);
    this.named = machine.named;
  }

  read(kind, names, step) {
    const given = {};
    for (const name of names) {
      const value = this.trace.at(kind, name, step);
      if (value !== null) given[name] = typeof value === "bigint" ? String(value) : value;
    }
    return this.machine.fromJson(given);
  }

  before(step) {
    return this.read("state", this.state, step - 1);
  }

  given(step) {
    return this.read("inputs", this.inputs.map((one) => one.name), step);
  }

  /* What the machine says of a step; `flaw` is why it says nothing. */
  asked(step, nothing, ask) {
    this.flaw = this.fits ? "" : "this run has not all variables of the machine";
    if (!this.fits || step < 1) return nothing;
    try {
      return ask(this.before(step), this.given(step));
    } catch (error) {
      this.flaw = error.message;
      return nothing;
    }
  }

  /* The rows of the tables in the modes before a step, each with the parts of its guard that decide. */
  rows(step) {
    return this.asked(step, null, (state, inputs) => this.machine.explain(state, inputs));
  }

  values(step) {
    return this.asked(step, {}, (state, inputs) => this.machine.values(state, inputs));
  }

  broken(step) {
    return this.asked(step, [], (state, inputs) => this.machine.broken(state, inputs));
  }
}

/* One part of a guard and its value, with the values that it reads. */
function partLine(part) {
  const values = Object.entries(part.values).map(([name, value]) => `${name} = ${value}`);
  if (part.leftOut) values.push(`and ${part.leftOut} more`);
  return element(
    "li",
    { style: `margin-left:${part.depth * 14}px` },
    element("span", { class: part.value ? "is-true" : "is-false" }, part.value ? "true" : "false"),
    " ",
    element("code", {}, part.text),
    values.length ? element("span", { class: "soft" }, ` ${values.join(", ")}`) : null,
  );
}
