// Runs exported machines for the tests: a line of JSON in, [word, ...arguments]; a line of JSON out. BigInts are told as text.
"use strict";

const machines = {};
let handed, machine, state;
globalThis.safelocMachine = (_, made) => { handed = made; };

const words = {
  load: (text, key) => { (0, eval)(text); machine = machines[key] = handed; },
  choose: (key) => { machine = machines[key]; },
  first: (chosen) => { state = machine.first(machine.fromJson(chosen)); return state; },
  put: (values) => { state = machine.fromJson(values); },
  step: (inputs) => { const made = machine.step(state, machine.fromJson(inputs)); state = made.state; return made; },
  call: (method, inputs) => machine[method](state, machine.fromJson(inputs)),
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
