"""What a declaration must satisfy before anything else looks at it: one small function per rule.

Each rule yields complaints; `check` raises ModelError with all of them, so that one run shows every mistake.
What needs a solver (overlap, dead transitions, ranges) is an obligation, not a check.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from safeloc.errors import ModelError
from safeloc.expr import Bool, BoolVar, Expr, Lit, Num, NumVar, Optional, Var
from safeloc.machine import ANY, STAY_NAME, Initial, Machine, Transition
from safeloc.nodes import Compare, Past
from safeloc.terms import in_order, variables
from safeloc.units import Enumeration

RESERVED = ("mode", "fired")


def check(machine: Machine) -> None:
    """Raise ModelError naming every offence, each with file and line."""
    first, *others = RULES  # the others walk the terms, so there have to be terms
    complaints = list(first(machine)) or [complaint for rule in others for complaint in rule(machine)]
    if complaints:
        raise ModelError(f"machine {machine.name!r} ({machine.src}):\n" + "\n".join(f"  - {c}" for c in complaints))


def input_variables(machine: Machine) -> list[Var]:
    """All input variables, presence flags included."""
    result: list[Var] = []
    for item in machine.inputs:
        result += [item.present, item.value] if isinstance(item, Optional) else [item]
    return result


def _terms_are_terms(machine: Machine) -> Iterator[str]:
    guards = {f"guard of {t.name!r} ({t.src})": t.when for t in machine.transitions}
    truths: dict[str, object] = {**guards, "assumption": machine.assumption, "initially": machine.initially}
    truths |= {f"clause {name!r}": clause for name, clause in machine.clauses.items()}
    truths |= {f"lemma {name!r}": lemma for name, lemma in machine.lemmas.items()}
    for what, term in truths.items():
        if not isinstance(term, Bool):
            yield f"{what}: {term!r} is no truth-valued term; a constant is written TRUE or FALSE."
    for name, output in machine.outputs.items():
        if not isinstance(output, (Num, Bool)):
            yield f"output {name!r}: {output!r} is no term; make it of state variables."
    for var, move in machine.ghost_moves.items():
        if not isinstance(move, (Num, Bool)):
            yield f"ghost move of {var.name!r}: {move!r} is no term; a ghost that rests moves to itself."


def _modes_are_one_enumeration(machine: Machine) -> Iterator[str]:
    if not machine.modes:
        yield "no modes; declare at least one with modes(...)."
    elif any(mode.unit is not machine.modes[0].unit for mode in machine.modes):
        yield "modes come from different enumerations; create them with one call of modes(...)."
    elif [mode.label for mode in machine.modes] != list(_members(machine.modes[0])):
        yield "modes must be all members of their enumeration, in order."


def _members(mode: Lit) -> tuple[str, ...]:
    return mode.unit.members if isinstance(mode.unit, Enumeration) else ()


def _names_are_distinct(machine: Machine) -> Iterator[str]:
    owned = [*input_variables(machine), *machine.state, *machine.ghosts, *machine.ghost_inputs]
    yield from _repeated("variable", (var.name for var in owned))
    own_value = {var.name for var in owned if machine.outputs.get(var.name) is var}
    yield from _repeated("variable or output", {var.name for var in owned} - own_value | set(RESERVED), machine.outputs)
    yield from _repeated("transition", (t.name for t in machine.transitions))
    for var in owned:
        if var.name in RESERVED or var.name.startswith(("before.", "observer.")):
            yield f"variable {var.name!r} ({var.src}): this name is reserved; choose another."
        if var.before is not None:
            yield f"variable {var.name!r} ({var.src}) is a value before the step; only properties may use it."
    if any(t.name == STAY_NAME for t in machine.transitions):
        yield f"transition name {STAY_NAME!r} is reserved."


def _names_can_be_written(machine: Machine) -> Iterator[str]:
    """Proof texts quote names in bars and number the copies of an input with @."""
    for var in [*input_variables(machine), *machine.state, *machine.ghosts, *machine.ghost_inputs]:
        if not var.name or not var.name.isprintable() or set(var.name) & set("@|\\"):
            yield f"variable {var.name!r} ({var.src}): a name is not empty, printable, and without @, | and \\."


def _repeated(what: str, *groups: Iterable[str]) -> Iterator[str]:
    seen: set[str] = set()
    for group in groups:
        for name in group:
            if name in seen:
                yield f"{what} {name!r} is declared twice; names must be distinct."
            seen.add(name)


def _transitions_join_known_modes(machine: Machine) -> Iterator[str]:
    for t in machine.transitions:
        for mode in (*t.sources, t.target):
            if not any(mode is known for known in machine.modes):
                yield f"transition {t.name!r} ({t.src}): {mode.label!r} is not a mode of this machine."
        if not t.sources:
            yield f"transition {t.name!r} ({t.src}) has no source mode."


def _ranks_are_in_order(machine: Machine) -> Iterator[str]:
    """Among transitions out of one mode; the order of the table is the order of priority."""
    highest: dict[Lit, Transition] = {}
    for t in machine.transitions:
        for source in t.sources:
            before = highest.setdefault(source, t)
            if t.rank < before.rank:
                yield (
                    f"transition {t.name!r} ({t.src}) has rank {t.rank} but follows {before.name!r} of rank {before.rank} "
                    f"out of {source.label}; declare it earlier."
                )
                break
            highest[source] = t


def _updates_fit(machine: Machine) -> Iterator[str]:
    for t in machine.transitions:
        for var, value in t.set.items():
            if var not in machine.state:
                yield f"transition {t.name!r} ({t.src}) sets {var.name!r}, which is not a state variable."
            else:
                yield from _fits(f"transition {t.name!r} ({t.src}) sets {var.name!r}", var, value)
    for var, move in machine.ghost_moves.items():
        if var not in machine.ghosts:
            yield f"ghost move of {var.name!r}, which is not a ghost."
        else:
            yield from _fits(f"ghost move of {var.name!r}", var, move)


def _initial_values_fit(machine: Machine) -> Iterator[str]:
    for var, value in [*machine.state.items(), *machine.ghosts.items()]:
        if isinstance(value, (Num, Bool)) and not isinstance(value, Lit):
            yield f"initial value of {var.name!r} ({var.src}): {value!r} is a term; give a value, or ANY and `initially`."
        elif value is not ANY:
            yield from _fits(f"initial value of {var.name!r} ({var.src})", var, value)


def _fits(what: str, var: Var, value: Expr | Initial) -> Iterator[str]:
    match var:
        case BoolVar():
            if not isinstance(value, (bool, Bool)):
                yield f"{what}: {value!r} is not a truth value."
        case NumVar(unit=unit, low=low, high=high):
            if isinstance(value, (bool, Bool)) or not isinstance(value, (int, Num)):
                yield f"{what}: {value!r} is not a number."
            elif isinstance(value, Num) and not value.unit.same(unit):
                yield f"{what}: unit is {value.unit.name}, expected {unit.name}."
            constant = value.value if isinstance(value, Lit) else value
            if isinstance(constant, int) and not isinstance(constant, bool) and not low <= constant <= high:
                yield f"{what}: {constant} is outside {low}..{high}."


def _reads_are_declared(machine: Machine) -> Iterator[str]:
    inputs, state = set(input_variables(machine)), {*machine.state, machine.mode}
    own, ghosts = inputs | state, {*machine.ghosts, *machine.ghost_inputs}
    for t in machine.transitions:
        terms = [t.when, *(value for value in t.set.values() if isinstance(value, (Num, Bool)))]
        yield from _only(f"transition {t.name!r} ({t.src})", terms, own, "inputs and state")
    for name, term in machine.outputs.items():
        yield from _only(f"output {name!r}", [term], state, "state (after the step)")
    for var, move in machine.ghost_moves.items():
        yield from _only(f"ghost move of {var.name!r}", [move], own | ghosts, "declared variables")
    yield from _only("assumption", [machine.assumption], own | ghosts, "declared variables")
    for name, clause in machine.clauses.items():
        yield from _only(f"clause {name!r}", [clause], own | ghosts, "declared variables")
    yield from _only("initially", [machine.initially], state | set(machine.ghosts), "state and ghosts")
    for name, lemma in machine.lemmas.items():
        yield from _only(f"lemma {name!r}", [lemma], state | set(machine.ghosts), "state and ghosts")


def _only(what: str, terms: list[Expr], allowed: set[Var], allowed_text: str) -> Iterator[str]:
    for var in variables(terms):
        if var not in allowed:
            yield f"{what} reads {var.name!r}; it may read only {allowed_text}."
    if any(isinstance(node, Past) for node in in_order(terms)):
        yield f"{what} uses a past operator; only properties may."


def _ghosts_move(machine: Machine) -> Iterator[str]:
    for ghost in machine.ghosts:
        if ghost not in machine.ghost_moves:
            yield f"ghost {ghost.name!r} ({ghost.src}) has no move; give it one in ghost_moves (itself, if it rests)."


def _guards_can_hold(machine: Machine) -> Iterator[str]:
    for t in machine.transitions:
        for node in in_order([t.when]):
            if isinstance(node, Compare) and _is_constant(node):
                yield f"transition {t.name!r} ({t.src}): a comparison in its guard never changes."


def _is_constant(node: Compare) -> bool:
    left, right = _range(node.left), _range(node.right)
    if left is None or right is None:
        return False
    return {
        "<": left[1] < right[0] or left[0] >= right[1],
        "<=": left[1] <= right[0] or left[0] > right[1],
        "==": left[1] < right[0] or left[0] > right[1],
    }[node.op]


def _range(term: Num) -> tuple[int, int] | None:
    match term:
        case Lit(value, _):
            return value, value
        case NumVar(low=low, high=high):
            return low, high
        case _:
            return None


RULES: tuple[Callable[[Machine], Iterator[str]], ...] = (
    _terms_are_terms,
    _modes_are_one_enumeration,
    _names_are_distinct,
    _names_can_be_written,
    _transitions_join_known_modes,
    _ranks_are_in_order,
    _updates_fit,
    _initial_values_fit,
    _reads_are_declared,
    _ghosts_move,
    _guards_can_hold,
)
