/* The machine itself, where the page has it: which transitions are refused and why, terms by name, and steps with other inputs.
   It is the script that `safeloc export --to javascript` writes; docs/export.md tells what it does. */

const machines = new Map();
window.safelocMachine = (name, machine) => machines.set(name, machine);
window.safelocCommon = machineCommon; // what the scripts of all machines have in common
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
  if (machine && !machine.look) throw new Error(`the script of the machine is of an earlier version; \`safeloc verify\` writes it again`);
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

  /* The rows of the tables in the modes before a step, and the parts of all terms with their values in it; kept for the step that is
     shown. Claims that look back need what a monitor has kept up to the step before. */
  seen(step) {
    if (this.looked?.step !== step) {
      const look = (state, inputs) => this.machine.look(state, inputs, this.machine.looksBack ? this.monitors(step - 1).at(-1) : undefined);
      this.looked = { step, seen: step === 0 && this.fits ? this.machine.lookFirst(this.before(1)) : this.asked(step, null, look) };
    }
    return this.looked.seen;
  }

  rows(step) {
    return step < 1 ? null : (this.seen(step)?.rows ?? null);
  }

  /* What a monitor of the claims holds before the first step and after each step up to this one. */
  monitors(step) {
    const found = [this.machine.monitor(this.before(1))];
    for (let at = 1; at <= step; at += 1) found.push(this.machine.monitored(found.at(-1), this.before(at), this.given(at)));
    return found;
  }

  values(step) {
    return this.asked(step, {}, (state, inputs) => this.machine.values(state, inputs));
  }

  broken(step) {
    return this.asked(step, [], (state, inputs) => this.machine.broken(state, inputs));
  }
}
