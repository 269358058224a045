/* Reads the runs of a machine: docs/report.md, "Runs in columns". What is read is checked as far as it is needed to show it. */

const KINDS = ["inputs", "fired", "state", "outputs"];

/* The values of which these are the differences; words and truth values stay, digits of large numbers become exact. */
function summed(column, words) {
  const values = [];
  let now = 0;
  for (let at = 0; at < column.length; at += 2) {
    const value = column[at];
    for (let count = column[at + 1]; count > 0; count -= 1) {
      if (typeof value === "number") values.push((now += value));
      else values.push(typeof value === "string" && !words ? BigInt(value) : value);
    }
  }
  return values;
}

class Runs {
  constructor(data) {
    if (data.schema !== "safeloc-runs/2") throw new Error(`Runs of schema ${data.schema} cannot be shown here.`);
    this.names = data.names;
    this.runs = data.runs;
    this.columns = data.columns;
    this.kept = new Map();
    this.places = [0];
    for (const run of data.runs) this.places.push(this.places.at(-1) + run.steps - run.like[1]);
    this.first = {};
    let at = 0;
    for (const kind of KINDS) {
      this.first[kind] = at;
      at += this.names[kind].length;
    }
    this.truth = at;
  }

  /* The kept steps of all runs in one column. */
  column(at) {
    if (!this.kept.has(at)) {
      const found = typeof this.columns[at] === "number" ? this.columns[this.columns[at]] : this.columns[at];
      const words = at >= this.first.fired && at < this.first.state;
      this.kept.set(at, summed(found, words));
    }
    return this.kept.get(at);
  }

  /* The stretches of kept steps that make up a run. */
  stretches(number) {
    const found = [];
    let wanted = this.runs[number].steps;
    while (wanted > 0) {
      const [like, shared] = this.runs[number].like;
      if (wanted > shared) found.unshift([this.places[number], this.places[number] + wanted - shared]);
      wanted = Math.min(wanted, shared);
      number = like;
    }
    return found;
  }

  find(result) {
    const number = this.runs.findIndex((run) => run.results.includes(result));
    return number < 0 ? null : new Trace(this, number);
  }
}

/* One run. Step 0 is the state before the first step. */
class Trace {
  constructor(runs, number) {
    const run = runs.runs[number];
    this.names = runs.names;
    this.results = run.results;
    this.machine = run.machine;
    this.steps = run.steps;
    this.runs = runs;
    this.number = number;
    this.first = new Map(runs.names.state.map((name, at) => [name, exact(run.first[at])]));
    this.stretches = runs.stretches(number);
    this.found = new Map();
  }

  series(kind, name) {
    const key = `${kind} ${name}`;
    if (this.found.has(key)) return this.found.get(key);
    const at = this.names[kind].indexOf(name);
    if (at < 0) return null; // and nothing is kept of it: a branch adds to all that is kept, and takes back from it
    const before = kind === "state" ? (this.first.get(name) ?? null) : null;
    this.found.set(key, [before, ...this.values(this.runs.first[kind] + at)]);
    return this.found.get(key);
  }

  values(at) {
    const column = this.runs.column(at);
    return this.stretches.flatMap(([from, to]) => column.slice(from, to));
  }

  get truth() {
    if (!this.found.has("truth")) this.found.set("truth", [null, ...this.values(this.runs.truth)]);
    return this.found.get("truth");
  }

  at(kind, name, step) {
    return this.series(kind, name)?.[step] ?? null;
  }

  changed(kind, name, step) {
    return step > 0 && this.at(kind, name, step) !== this.at(kind, name, step - 1);
  }

  /* The names of a kind that this run has at all. */
  present(kind) {
    return this.names[kind].filter((name) => this.series(kind, name).some((value) => value !== null));
  }
}

const exact = (value) => (typeof value === "string" ? BigInt(value) : value);
