// Runs exported machines for the tests: a line of JSON in, [word, ...arguments]; a line of JSON out. BigInts are told as text.
"use strict";

const machines = {};
let handed, machine, state, monitor;
globalThis.safelocMachine = (_, made) => { handed = made; };

const words = {
  load: (text, key) => { (0, eval)(text); machine = machines[key] = handed; },
  choose: (key) => { machine = machines[key]; },
  first: (chosen) => { state = machine.first(machine.fromJson(chosen)); return state; },
  put: (values) => { state = machine.fromJson(values); },
  step: (inputs) => { const made = machine.step(state, machine.fromJson(inputs)); state = made.state; return made; },
  call: (method, inputs) => machine[method](state, machine.fromJson(inputs)),
  unfold: (inputs, deep) => {
    const { rows, parts } = machine.look(state, machine.fromJson(inputs));
    const level = (place, left) => (left ? parts(place).map(({ place: at, name, text, value, decides, reads }) => (
      { name, text, value, decides, reads: reads.map((one) => [one.text, one.value]), parts: level(at, left - 1) })) : []);
    return rows.map((row) => level(row.place, deep));
  },
  watch: () => { monitor = machine.monitor(state); return monitor.became; },
  claims: (inputs) => {
    const [before, given] = [monitor, machine.fromJson(inputs)];
    monitor = machine.monitored(monitor, state, given);
    const told = monitor.became.map((one, at) => {
      if (!one?.broken || one.step !== monitor.step) return one;
      const seen = machine.look(state, given, before);
      return { ...one, why: seen.why(seen.asked(machine.claims[at]), true) };
    });
    state = machine.step(state, given).state;
    return told;
  },
  raw: (text) => (0, eval)(`(machine, state) => (${text})`)(machine, state),
};

require("node:readline").createInterface({ input: process.stdin }).on("line", (line) => {
  const [word, ...given] = JSON.parse(line);
  let answer;
  try {
    answer = { told: words[word](...given) };
  } catch (error) {
    answer = { error: `${error.name}: ${error.message}` };
  }
  const text = JSON.stringify(answer, (_, value) => (typeof value === "bigint" ? String(value) : value));
  process.stdout.write(`${text}\n`);
});
