// The terms of a machine: their values in a step, their texts, and the parts that make them what they are.
//
//   nodes  [kind, ...]: places of operands, of units and of texts; names: place of a term, place of its name, ...
//   lists  values before the step, of the inputs, after the step, and of what fired; kept: what past operators keep

const LITERAL = 0, VARIABLE = 1, TRUTH = 2, NOT = 3, AND = 4, OR = 5, CHOICE = 6, COMPARED = 7, SUM = 8, DIFFERENCE = 9,
  PRODUCT = 10, QUOTIENT = 11, LEAST = 12, MOST = 13, PAST = 14;
const WIRED = 4;
const LONGEST = 200, DEEPEST = 7, SHALLOW = 3, MOST_VALUES = 12;

function termsOf({ nodes, names, units, texts }) {
  const nameOf = new Map();
  for (let at = 0; at < names.length; at += 2) nameOf.set(names[at], texts[names[at + 1]]);
  const kindOf = (place) => nodes[place][0];

  function operands(place) {
    const [kind, ...given] = nodes[place];
    switch (kind) {
      case LITERAL: case VARIABLE: case TRUTH: return [];
      case COMPARED: case PRODUCT: return given.slice(1);
      case QUOTIENT: return [given[1]];
      case PAST: return given.slice(2);
      default: return given;
    }
  }

  // The unit of a number: its name, the members of an enumeration, or null of a truth value.
  function unitOf(place) {
    const [kind, first, second, third] = nodes[place];
    if (kind === LITERAL || kind === VARIABLE || kind === PRODUCT || kind === QUOTIENT) return first < 0 ? null : units[first];
    if (kind === CHOICE) return unitOf(third);
    return kind === SUM ? unitOf(second) : kind === DIFFERENCE || kind === LEAST || kind === MOST ? unitOf(first) : null;
  }

  // ---------------------------------------------------------------- text

  function infix(place, most, deepest, isWhole = false) {
    const whole = [...written(place, 0, deepest, isWhole)];
    const letters = whole[0] === "(" && whole.at(-1) === ")" && closesAtEnd(whole) ? whole.slice(1, -1) : whole;
    return letters.length <= most ? letters.join("") : `${letters.slice(0, most - 1).join("")}\u2026`;
  }

  function closesAtEnd(letters) {
    let depth = 0;
    for (let at = 0; at < letters.length; at += 1) {
      depth += (letters[at] === "(") - (letters[at] === ")");
      if (depth === 0) return at === letters.length - 1;
    }
    return false;
  }

  function literal([, unit, value]) {
    const measure = units[unit];
    if (Array.isArray(measure)) return measure[Number(value)];
    return measure ? `${value} ${measure}` : String(value);
  }

  // isWhole: a name is not written in its own place, but what it stands for
  function written(place, depth, deepest, isWhole = false) {
    if (nameOf.has(place) && !isWhole) return nameOf.get(place);
    const node = nodes[place];
    const [kind, first, second, third] = node;
    if (depth > deepest && kind > TRUTH) return "\u2026";
    const inner = (one) => written(one, depth + 1, deepest);
    switch (kind) {
      case LITERAL: return literal(node);
      case VARIABLE: return texts[second];
      case TRUTH: return first ? "true" : "false";
      case NOT: return isEqual(first) ? `(${inner(nodes[first][2])} \u2260 ${inner(nodes[first][3])})` : `not ${inner(first)}`;
      case AND: case OR: return `(${node.slice(1).map(inner).join(kind === AND ? " and " : " or ")})`;
      case CHOICE: return `(${inner(second)} if ${inner(first)} else ${inner(third)})`;
      case COMPARED: return `(${inner(second)} ${["=", "\u2264", "<"][first]} ${inner(third)})`;
      case SUM: return isZero(second) ? written(first, depth, deepest) : `(${inner(first)} + ${inner(second)})`;
      case DIFFERENCE: return `(${inner(first)} \u2212 ${inner(second)})`;
      case PRODUCT: return `(${inner(second)} \u00d7 ${inner(third)})`;
      case QUOTIENT: return `\u230a${inner(second)} / ${third}\u230b`;
      case LEAST: return `min(${inner(first)}, ${inner(second)})`;
      case MOST: return isMagnitude(first, second) ? `|${inner(first)}|` : `max(${inner(first)}, ${inner(second)})`;
      case PAST: return `${first}(${node.slice(3).map(inner).join(", ")})`;
    }
  }

  const isEqual = (place) => kindOf(place) === COMPARED && nodes[place][1] === 0;
  const isZero = (place) => kindOf(place) === LITERAL && Number(nodes[place][2]) === 0;
  const isMagnitude = (first, second) => kindOf(second) === DIFFERENCE && isZero(nodes[second][1]) && nodes[second][2] === first;

  // ---------------------------------------------------------------- values in a step

  const remembered = nodes.flatMap((node, place) => (node[0] === PAST ? [place] : []));

  function valuesIn({ lists, kept = [] }) {
    const found = new Array(nodes.length);
    const value = (place) => (found[place] === undefined ? (found[place] = computed(nodes[place])) : found[place]);

    function computed(node) {
      const [kind, first, second, third, fourth] = node;
      switch (kind) {
        case LITERAL: return BigInt(second);
        case VARIABLE: return third === WIRED ? value(fourth) : lists[third][fourth];
        case TRUTH: return first === 1;
        case NOT: return !value(first);
        case AND: return node.every((one, at) => at === 0 || value(one));
        case OR: return node.some((one, at) => at > 0 && value(one));
        case CHOICE: return value(first) ? value(second) : value(third);
        case COMPARED: return compared(first, value(second), value(third));
        case SUM: return value(first) + value(second);
        case DIFFERENCE: return value(first) - value(second);
        case PRODUCT: return value(second) * value(third);
        case QUOTIENT: return down(value(second), BigInt(third));
        case LEAST: return value(first) < value(second) ? value(first) : value(second);
        case MOST: return value(first) > value(second) ? value(first) : value(second);
        case PAST: return lookedBack(first, kept[second] ?? false, node.slice(3));
      }
    }

    function compared(operator, left, right) {
      return operator === 0 ? left === right : operator === 1 ? left <= right : left < right;
    }

    function lookedBack(operator, was, given) {
      if (operator === "previous") return was;
      return operator === "once" ? value(given[0]) || was : value(given[1]) || (value(given[0]) && was);
    }

    // What past operators keep for the next step.
    function keep() {
      return remembered.map((place) => value(nodes[place][1] === "previous" ? nodes[place][3] : place));
    }

    return { value, keep };
  }

  // ---------------------------------------------------------------- parts

  const isLiteral = (place) => kindOf(place) === LITERAL;

  // The parts of a term in a step. `why` tells a tree of those that decide, as `safeloc step` and `safeloc explain` do; `parts` all of
  // one level down, of a name what it stands for.
  function within(step) {
    const { value, keep } = valuesIn(step);

    function told(place) {
      const unit = unitOf(place);
      return Array.isArray(unit) ? unit[Number(value(place))] : String(value(place));
    }

    function why(place, wanted) {
      return value(place) === wanted ? [treePart(place, 0)] : tree(place, 0);
    }

    function tree(place, depth) {
      if (kindOf(place) === NOT) return tree(nodes[place][1], depth);
      return [treePart(place, depth), ...below(place).flatMap((one) => tree(one, depth + 1))];
    }

    function treePart(place, depth) {
      const every = kindOf(place) === COMPARED ? reads(place) : [];
      const read = [...new Map(every.map((one) => [infix(one, LONGEST, DEEPEST), told(one)]))];
      const values = Object.fromEntries(read.slice(0, MOST_VALUES));
      return { text: infix(place, LONGEST, DEEPEST), value: value(place), depth, values, leftOut: Math.max(0, read.length - MOST_VALUES) };
    }

    // The sides of a comparison, and the names and variables in those that have no name.
    function reads(place) {
      const sides = nodes[place].slice(2).filter((one) => !isLiteral(one));
      return [...new Set([...sides, ...leavesOf(sides.filter((one) => !nameOf.has(one)))])];
    }

    function below(place) {
      // the parts that give a part its value: a conjunction is false by one of its parts, a disjunction true
      const kind = kindOf(place);
      if (nameOf.has(place)) return [];
      if (kind === CHOICE) return [nodes[place][1], value(nodes[place][1]) ? nodes[place][2] : nodes[place][3]];
      if (kind !== AND && kind !== OR) return [];
      return joined(place).filter((one) => decides(place, one));
    }

    function decides(place, one) {
      const kind = kindOf(place);
      if (kind === CHOICE) return one === nodes[place][1] || one === (value(nodes[place][1]) ? nodes[place][2] : nodes[place][3]);
      if (kind !== AND && kind !== OR) return true;
      return value(place) !== (kind === OR) || value(one) === value(place);
    }

    function part(place, of = place) {
      const isNamed = nameOf.has(place);
      const sides = kindOf(place) === COMPARED ? nodes[place].slice(2).filter((one) => !isLiteral(one)) : [];
      return {
        place, name: isNamed ? nameOf.get(place) : "", text: infix(place, Infinity, SHALLOW, true), value: told(place),
        unit: numberUnit(place), decides: of === place || decides(of, place), more: partsBelow(place).length > 0,
        reads: sides.map((side) => ({ text: infix(side, Infinity, SHALLOW), value: told(side), unit: numberUnit(side) })),
      };
    }

    const numberUnit = (place) => (typeof unitOf(place) === "string" ? unitOf(place) : "");
    const parts = (place) => partsBelow(place).map((inner) => part(inner, place));

    return { value, keep, told, why, part, parts };
  }

  // The names and variables in terms, operands first.
  function leavesOf(roots) {
    const seen = new Set();
    const found = new Set();
    const visit = (place) => {
      if (seen.has(place) || nameOf.has(place)) return;
      seen.add(place);
      for (const inner of operands(place)) visit(inner);
      if (kindOf(place) === VARIABLE) found.add(place);
      for (const inner of operands(place)) if (nameOf.has(inner)) found.add(inner);
    };
    roots.forEach(visit);
    return found;
  }

  const joined = (place) => {
    const kind = kindOf(place);
    const flat = (one) => (kindOf(one) === kind && !nameOf.has(one) ? operands(one).flatMap(flat) : [one]);
    return operands(place).flatMap(flat);
  };

  // What stands one level below a term: the parts of a conjunction or disjunction, the operands of another, what a wire brings.
  function partsBelow(place) {
    const [kind, , , list, wired] = nodes[place];
    if (kind === VARIABLE) return list === WIRED ? [wired] : [];
    const found = kind === AND || kind === OR ? joined(place) : operands(place);
    return [...new Set(found)].filter((one) => !isLiteral(one) && kindOf(one) !== TRUTH);
  }

  return { in: within };
}
