// A machine that runs step by step: checks of what it is given, values by name, and why a transition is refused.
// Every machine's script contains this text, and calls machineOf with its own tables and functions.
//
//   data     tables: variables, transitions, parts of guards, names of values
//   moves    functions (s, i, o, f), one for each machine of a composition: what they move goes into o and f
//   outputs  state after the step -> list of outputs
//   first    state -> whether it may be the first one

function down(value, divisor) {
  // value / divisor, rounded towards minus infinity; the divisor is positive
  const quotient = value / divisor;
  return value % divisor < 0n ? quotient - 1n : quotient;
}

function fits(value) {
  if (BigInt.asIntN(64, value) !== value) throw new Error(`a value of the step, ${value}, exceeds 64 bits.`);
  return value;
}

function machineOf(data, moves, outputs, first) {
  const named = (list) => Object.fromEntries(list.map((one) => [one.name, one]));
  const state = data.variables.filter((one) => one.role === "state");
  const inputs = data.variables.filter((one) => one.role === "input");
  const shown = data.variables.filter((one) => one.role === "output");
  const byName = { state: named(state), input: named(inputs) };
  const flags = Object.fromEntries(inputs.filter((one) => one.optional).map((one) => [one.present, one]));
  const inputNames = { ...byName.input, ...flags };
  const places = Object.fromEntries(data.inputs.map((name, place) => [name, place]));
  const transitions = data.transitions.map((one) => ({
    ...one, guard: data.texts[one.guard], sets: one.sets.map((place) => updateOf(data.texts[place])),
  }));

  function updateOf(text) {
    const [variable, term] = text.split(" := ", 2);
    return { variable, text: term };
  }

  // ---------------------------------------------------------------- values from outside, and back

  function quoted(value) {
    if (typeof value === "string") return JSON.stringify(value);
    return typeof value === "bigint" ? `${value}n` : value instanceof Object ? `an ${typeof value}` : String(value);
  }

  function admitted(variable, value, within = inRange) {
    const { name, kind, unit } = variable;
    if (kind === "boolean") {
      if (typeof value !== "boolean") throw new RangeError(`${name}: expected true or false, got ${quoted(value)}.`);
      return value;
    }
    if (kind !== "integer") {
      const member = typeof value === "string" ? variable.values.indexOf(value) : -1;
      if (member < 0) throw new RangeError(`${name}: expected ${variable.values.join(", ")}, got ${quoted(value)}.`);
      return within(variable, BigInt(member), value);
    }
    if (typeof value !== "bigint") {
      throw new RangeError(`${name}: expected a whole number of ${unit} as BigInt, got ${quoted(value)}.`);
    }
    return within(variable, value, `${value} ${unit}`);
  }

  function inRange(variable, value, text) {
    const { least, most } = variable;
    if (value < BigInt(least) || value > BigInt(most)) {
      throw new RangeError(`${variable.name}: ${text} is outside ${least}..${most}.`);
    }
    return value;
  }

  function in64Bits(variable, value, text) {
    // where a law of the world is broken a state may leave its range, and the run goes on as in the interpreter
    if (BigInt.asIntN(64, value) === value) return value;
    throw new RangeError(`${variable.name}: ${text} exceeds 64 bits.`);
  }

  const told = (variable, value) =>
    variable.kind === "integer" || variable.kind === "boolean" ? value : variable.values[Number(value)];

  const byNames = (variables, list) =>
    Object.fromEntries(variables.map((one, place) => [one.name, told(one, list[place])]));

  function refuseUnknown(given, known, what) {
    const unknown = Object.keys(given).filter((name) => !Object.hasOwn(known, name));
    if (unknown.length) throw new RangeError(`${data.name}: unknown ${what} ${unknown.map(quoted).join(", ")}.`);
  }

  function stateOf(given) {
    refuseUnknown(given, byName.state, "state variables");
    return state.map((one) => {
      if (!Object.hasOwn(given, one.name)) throw new RangeError(`${data.name}: state variable "${one.name}" is missing.`);
      return admitted(one, given[one.name], in64Bits);
    });
  }

  function inputsOf(given) {
    refuseUnknown(given, inputNames, "inputs");
    const list = new Array(data.inputs.length);
    for (const one of inputs) {
      const value = Object.hasOwn(given, one.name) ? given[one.name] : null;
      if (one.optional) {
        const flag = Object.hasOwn(given, one.present) ? given[one.present] : null;
        const absent = BigInt(one.absent);
        list[places[one.name]] = value === null ? absent : admitted(one, value);
        list[places[one.present]] = present(one, flag, value, list[places[one.name]] === absent);
      } else {
        if (!Object.hasOwn(given, one.name)) throw new RangeError(`${data.name}: input "${one.name}" is missing.`);
        list[places[one.name]] = admitted(one, value);
      }
    }
    return list;
  }

  function present(one, flag, value, isAbsentValue) {
    const there = value !== null;
    if (flag === null) return there;
    if (typeof flag !== "boolean") {
      throw new RangeError(`${one.present}: expected true or false, got ${quoted(flag)}.`);
    }
    if (flag !== there && !(flag === false && isAbsentValue)) {
      throw new RangeError(`${data.name}: ${one.present} is ${flag} but ${one.name} is ${quoted(value)}.`);
    }
    return flag;
  }

  function fromJson(given) {
    // what it cannot read it leaves as it is, and the step refuses it
    const read = ([name, value]) => {
      const { kind, values: members } = byName.state[name] ?? byName.input[name] ?? {};
      if (kind === "integer" && Number.isSafeInteger(value)) return [name, BigInt(value)];
      if (kind === "integer" && typeof value === "string" && /^-?[0-9]+$/.test(value)) return [name, BigInt(value)];
      return [name, typeof value === "number" && kind !== "integer" ? (members?.[value] ?? value) : value];
    };
    return Object.fromEntries(Object.entries(given).map(read));
  }

  function toJson(given) {
    const written = (value) => {
      if (typeof value !== "bigint") return value;
      return Number.isSafeInteger(Number(value)) ? Number(value) : String(value);
    };
    return Object.fromEntries(Object.entries(given).map(([name, value]) => [name, written(value)]));
  }

  // ---------------------------------------------------------------- the step

  function start(chosen = {}) {
    refuseUnknown(chosen, byName.state, "state variables");
    const list = state.map((one) => {
      const declared = one.kind === "boolean" ? one.first : BigInt(one.first);
      if (!Object.hasOwn(chosen, one.name)) return declared;
      const value = admitted(one, chosen[one.name]);
      if (one.open || value === declared) return value;
      throw new RangeError(
        `${data.name}: ${one.name} starts at ${told(one, declared)} by declaration and cannot be chosen; leave it out.`,
      );
    });
    if (!first(list)[0]) {
      throw new RangeError(
        `${data.name}: the chosen first state breaks \`initially\`; choose values that satisfy it.`,
      );
    }
    return byNames(state, list);
  }

  function moved(s, i) {
    const after = s.slice();
    const numbers = data.fired.map(() => 0n);
    for (const move of moves) move(s, i, after, numbers);
    refuseWide(state, after);
    return { after, numbers, fired: numbers.map((number, place) => data.fired[place][Number(number)]) };
  }

  function refuseWide(variables, list) {
    list.forEach((value, place) => {
      if (typeof value === "bigint" && BigInt.asIntN(64, value) !== value) {
        throw new Error(`${data.name}: ${variables[place].name} would be ${value}, which exceeds 64 bits.`);
      }
    });
  }

  function step(given, row) {
    const { after, fired } = moved(stateOf(given), inputsOf(row));
    return { state: byNames(state, after), outputs: outputsOf(after), fired };
  }

  function outputsOf(after) {
    const list = outputs(after);
    refuseWide(shown, list);
    return Object.fromEntries(
      shown.map((one, place) => [one.name, String(list[place]) === one.absent ? null : told(one, list[place])]),
    );
  }

  // ---------------------------------------------------------------- why

  const terms = termsOf(data);

  // The terms with their values in one step; a monitor gives past operators what they keep.
  function reading(given, row, monitor = undefined) {
    const [s, i] = [stateOf(given), inputsOf(row)];
    const { after, numbers, fired } = moved(s, i);
    return { s, fired, told: terms.in({ lists: [s, i, after, numbers], kept: monitor?.kept }) };
  }

  function explain(given, row) {
    const { s, fired, told: of } = reading(given, row);
    return atHome(s, fired).map(({ place, fires, ...one }) => {
      const enabled = of.value(place);
      return { ...one, enabled, fires, parts: of.why(place, true) };
    });
  }

  function atHome(s, fired) {
    return data.rows.flatMap((one, machine) => {
      const mode = told(state[one.mode], s[one.mode]);
      const rows = one.order.map((place) => transitions[place]).filter((row) => row.sources.includes(mode));
      return rows.map(({ name, machine: of, target, part }) => (
        { transition: name, machine: of, target, place: part, fires: fired[machine] === name }
      ));
    });
  }

  // The same, to be looked at part by part: each has a place, whose parts `parts` tells one level down.
  function look(given, row, monitor = undefined) {
    const { s, fired, told: of } = reading(given, row, monitor);
    return { rows: atHome(s, fired).map((one) => ({ ...one, enabled: of.value(one.place) })), ...looked(of) };
  }

  const looked = (of) => ({
    part: of.part, parts: of.parts, why: of.why,
    claim: (name) => data.claims.find((one) => one.name === name),
    law: (name) => data.laws.find((one) => one.name === name)?.place,
    asked: (one) => (one.steps < 0 ? one.term : one.response),
  });

  // The same of a first state, which claims about states alone have to keep.
  function lookFirst(given) {
    const s = stateOf(given);
    return { rows: [], ...looked(terms.in({ lists: [s, [], s, []] })) };
  }

  function namedValues(given, row) {
    const { told: of } = reading(given, row);
    return Object.fromEntries(data.named.map((one) => [one.name, told(one, of.value(one.place))]));
  }

  function broken(given, row) {
    const { told: of } = reading(given, row);
    return data.laws.filter((one) => !of.value(one.place)).map((one) => one.name);
  }

  // ---------------------------------------------------------------- claims

  // A monitor holds what claims keep from step to step: values of past operators, steps waited for a response, and what became
  // of each claim: null while it holds, else the step that broke it, or that broke what it assumes, which is final.
  function monitor(given) {
    const of = terms.in({ lists: [stateOf(given), [], stateOf(given), []] });
    const holds = (one) => one.steps >= 0 || !one.first || of.value(one.term);
    return {
      step: 0, kept: new Array(data.slots).fill(false), waited: data.claims.map(() => 0),
      became: data.claims.map((one) => (holds(one) ? null : { broken: true, step: 0 })),
    };
  }

  function monitored(before, given, row) {
    const { told: of } = reading(given, row, before);
    const step = before.step + 1;
    const waited = data.claims.map((one, at) => (one.steps < 0 ? 0 : waitedFor(one, before.waited[at], of)));
    const became = before.became.map((was, at) => was ?? judged(data.claims[at], waited[at], of, step));
    return { step, kept: of.keep(), waited, became };
  }

  function waitedFor(one, before, of) {
    if (before > one.steps) return before;
    return of.value(one.response) ? 0 : before > 0 ? before + 1 : of.value(one.term) ? 1 : 0;
  }

  function judged(one, waited, of, step) {
    if (!one.assumed.every((place) => of.value(place))) return { broken: false, step };
    const holds = one.steps < 0 ? of.value(one.term) : waited <= one.steps;
    return holds ? null : { broken: true, step };
  }

  // ---------------------------------------------------------------- a run as a file

  function written(text) {
    // JSON in ASCII, as Python writes it
    const escape = (letter) => `\\u${letter.charCodeAt(0).toString(16).padStart(4, "0")}`;
    return JSON.stringify(text).replace(/[\u007f-\uffff]/g, escape);
  }

  const literal = (entries, truths) =>
    `{${entries.map(([name, one]) => `${written(name)}: ${truths[one] ?? one}`).join(", ")}}`;

  function recorded(rows, chosen) {
    if (!rows.length) throw new RangeError("no step was taken; there is no run to save.");
    const begin = stateOf(start(chosen));
    const steps = rows.map(inputsOf);
    const isThere = (one, list) => !one.optional || list[places[one.present]];
    const read = data.recorded.map((name) => byName.input[name]);
    const named = (list) => read.filter((one) => isThere(one, list)).map((one) => [one.name, list[places[one.name]]]);
    const open = state.flatMap((one, place) => (one.open ? [[one.name, begin[place]]] : []));
    return { begin, steps, open, rows: steps.map(named) };
  }

  function asStream(rows, chosen = {}) {
    const run = recorded(rows, chosen);
    const first = literal(run.open, {});
    const header = `{"schema": ${written(data.schema)}, "machine": ${written(data.name)}, "first": ${first}}`;
    return [header, ...run.rows.map((row) => literal(row, {}))].map((line) => `${line}\n`).join("");
  }

  function asTest(rows, chosen = {}) {
    if (!data.test.length) throw new Error(`${data.name}: this script was made without the text of a test.`);
    const run = recorded(rows, chosen);
    const truths = { true: "True", false: "False" };
    const fired = [];
    run.steps.reduce((s, i) => {
      const made = moved(s, i);
      fired.push(`[${made.fired.map(written).join(", ")}]`);
      return made.after;
    }, run.begin);
    const listed = (lines) => lines.map((line) => `    ${line},\n`).join("");
    const steps = listed(run.rows.map((row) => literal(row, truths)));
    const [head, beforeSteps, beforeFired, tail] = data.test;
    return `${head}${literal(run.open, truths)}${beforeSteps}${steps}${beforeFired}${listed(fired)}${tail}`;
  }

  return {
    name: data.name, machines: data.machines, variables: data.variables, transitions, named: data.named,
    laws: data.laws.map((one) => one.name), claims: data.claims, looksBack: data.slots > 0,
    first: start, step, explain, look, lookFirst, values: namedValues, broken, monitor, monitored, fromJson, toJson, asStream, asTest,
  };
}
