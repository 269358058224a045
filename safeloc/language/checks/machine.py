"""Rules for the declaration of a machine, checked before any other code reads it: one small function per rule.

`check` raises ModelError with all complaints, so that one run shows every error.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from safeloc.errors import ModelError
from safeloc.language.checks.rule import Rule, complaints, every_complaint
from safeloc.language.checks.terms import malformed
from safeloc.language.expr import Bool, BoolVar, Expr, Lit, Num, NumVar, Optional, Var
from safeloc.language.first_values import ANY, Initial
from safeloc.language.nodes import Compare, Past
from safeloc.language.render import infix
from safeloc.language.terms import in_order, variables
from safeloc.language.transition_table import STAY_NAME, Modes, Transition

if TYPE_CHECKING:
    from safeloc.language.machine import Machine

_RESERVED = ("mode", "fired")
_LONGEST_NAME = 120


def check_shape(machine: Machine) -> None:
    """Raise ModelError if a field holds something of a wrong kind; the other rules rely on this check."""
    _refuse(machine, complaints(SHAPE, machine))


def check(machine: Machine) -> None:
    """Raise ModelError with every complaint, each with file and line."""
    _refuse(machine, every_complaint(MACHINE, machine))


def _refuse(machine: Machine, found: list[str]) -> None:
    if found:
        raise ModelError(f"machine {machine.name!r} ({machine.src}):\n" + "\n".join(f"  - {c}" for c in found))


def input_variables(machine: Machine) -> list[Var]:
    """Return all input variables, presence flags included."""
    result: list[Var] = []
    for item in machine.inputs:
        result += [item.present, item.value] if isinstance(item, Optional) else [item]
    return result


def _variables_are_variables(machine: Machine) -> Iterator[str]:
    wanted = "declare it with number, boolean, choice or optional"
    for item in machine.inputs:
        if not isinstance(item, (NumVar, BoolVar, Optional)):
            yield f"input {item!r} is no variable; {wanted}."
    for what, declared in (
        ("state", machine.state),
        ("ghost", machine.world.ghosts),
        ("choice", machine.world.choices),
    ):
        for var in declared:
            if not isinstance(var, (NumVar, BoolVar)):
                yield f"{what} {var!r} is no variable; {wanted}."
    for t in machine.transitions:
        if not isinstance(t, Transition):
            yield f"transition {t!r}: make it with Transition(...)."
        elif wrong := [mode for mode in (*_sources(t), t.target) if not isinstance(mode, Lit)]:
            text = " is a text; give the mode itself, as modes(...) made it." if isinstance(wrong[0], str) else ""
            yield f"transition {t.name!r} ({t.src}): {wrong[0]!r}{text or ' is no mode; make modes with modes(...).'}"
    for mode in machine.modes:
        if not isinstance(mode, Lit):
            yield f"mode {mode!r}: make modes with modes(...)."


def _sources(t: Transition) -> tuple[object, ...]:
    """Return the source modes; a text is one wrong mode, not its letters."""
    return (t.source,) if isinstance(t.source, str) else t.sources


def _terms_are_terms(machine: Machine) -> Iterator[str]:
    guards = {f"guard of {t.name!r} ({t.src})": t.when for t in machine.transitions}
    truths: dict[str, object] = {**guards, "initially": machine.initially}
    truths |= {f"clause {name!r}": clause for name, clause in machine.world.terms.items()}
    truths |= {f"lemma {name!r}": lemma for name, lemma in machine.lemmas.items()}
    for what, term in truths.items():
        if not isinstance(term, Bool):
            yield f"{what}: {term!r} is no truth-valued term; write TRUE or FALSE for a constant."
    for name, output in machine.outputs.items():
        if not isinstance(output, (Num, Bool)):
            yield f"output {name!r}: {output!r} is no term; build a term over state variables."
    for var, move in machine.world.moves.items():
        if not isinstance(move, (Num, Bool)):
            yield f"move of ghost {var.name!r}: {move!r} is no term; a ghost that keeps its value has itself as its move."


def _terms_are_well_formed(machine: Machine) -> Iterator[str]:
    """Every term is well formed, also a term built without the functions of the language."""
    values = [value for t in machine.transitions for value in t.set.values() if isinstance(value, (Num, Bool))]
    yield from malformed(
        [*_terms(machine), *values, *input_variables(machine), *machine.state, *machine.world.variables]
    )


def _terms(machine: Machine) -> list[Expr]:
    guards = [t.when for t in machine.transitions]
    terms: list[Expr] = [*machine.outputs.values(), *machine.world.moves.values(), *machine.definitions.values()]
    terms += [*machine.world.terms.values(), *machine.lemmas.values()]
    ends = [mode for t in machine.transitions for mode in (*t.sources, t.target)]
    return [*guards, *terms, *ends, *machine.modes, machine.initially]


def _modes_are_one_enumeration(machine: Machine) -> Iterator[str]:
    if not machine.modes:
        yield "it has no modes; declare at least one with modes(...)."
        return
    table = machine.modes[0].unit
    if any(mode.unit is not table for mode in machine.modes):
        yield "modes come from different enumerations; create them with one call of modes(...)."
    elif not isinstance(table, Modes):
        yield f"mode {machine.modes[0].label!r}: make modes with modes(...)."
    elif [mode.label for mode in machine.modes] != list(table.members):
        yield "modes must be all members of their enumeration, in order."


def _names_are_distinct(machine: Machine) -> Iterator[str]:
    declared = [*input_variables(machine), *machine.state, *machine.world.variables]
    yield from _repeated("variable", (var.name for var in declared))
    shown = {var.name for var in declared if machine.outputs.get(var.name) is var}  # an output may show a variable
    yield from _repeated("variable or output", {var.name for var in declared} - shown | set(_RESERVED), machine.outputs)
    yield from _repeated("transition", (t.name for t in machine.transitions))
    for var in declared:
        if var.name in _RESERVED or var.name.startswith(("before.", "observer.")):
            yield f"variable {var.name!r} ({var.src}): this name is reserved; choose another."
        if var.before is not None:
            yield f"variable {var.name!r} ({var.src}) is a value before the step; only properties may use it."
    if any(t.name == STAY_NAME for t in machine.transitions):
        yield f"transition name {STAY_NAME!r} is reserved; choose another."


def _labels_can_be_written(machine: Machine) -> Iterator[str]:
    """Reports, certificates and files write each name on one line."""
    wrong = set(machine.name) & set("|\\/")
    if not machine.name.strip() or wrong or not machine.name.isprintable() or len(machine.name) > _LONGEST_NAME:
        yield f"its name is {machine.name!r}; use 1 to {_LONGEST_NAME} printable characters, without /, | and \\."
    labels = {"mode": [mode.label for mode in machine.modes], "transition": [t.name for t in machine.transitions]}
    labels |= {"output": list(machine.outputs), "lemma": list(machine.lemmas), "clause": list(machine.world.clauses)}
    for what, names in labels.items():
        for name in names:
            if not name.strip() or not name.isprintable() or len(name) > _LONGEST_NAME:
                yield f"{what} {name!r}: a name has 1 to {_LONGEST_NAME} printable characters, on one line."


def _names_can_be_written(machine: Machine) -> Iterator[str]:
    """Certificates quote names in bars, and number the copies of an input with @."""
    for var in [*input_variables(machine), *machine.state, *machine.world.variables]:
        if not var.name or not var.name.isprintable() or set(var.name) & set("@|\\"):
            yield f"variable {var.name!r} ({var.src}): a name has printable characters, at least one, without @, | and \\."


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
            yield f"transition {t.name!r} ({t.src}) has no source mode; name at least one."


def _sources_are_named_once(machine: Machine) -> Iterator[str]:
    """A transition names each source mode once: lowering counts the names to see whether the transition leaves every mode."""
    for t in machine.transitions:
        twice = sorted({mode.label for mode in t.sources if sum(mode is other for other in t.sources) > 1})
        if twice:
            yield f"transition {t.name!r} ({t.src}) names source mode {twice[0]!r} twice; name each mode once."


def _ranks_are_in_order(machine: Machine) -> Iterator[str]:
    """Ranks of transitions out of one mode do not decrease, since the order of the table is the order of priority."""
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
                yield f"transition {t.name!r} ({t.src}) sets {var.name!r}, which is not a state variable; declare it in state, with its first value."
            else:
                yield from _fits(f"transition {t.name!r} ({t.src}) sets {var.name!r}", var, value)
    for var, move in machine.world.moves.items():
        if var not in machine.world.ghosts:
            yield f"move of ghost {var.name!r}, which is not a ghost."
        else:
            yield from _fits(f"move of ghost {var.name!r}", var, move)


def _initial_values_fit(machine: Machine) -> Iterator[str]:
    for var, value in [*machine.state.items(), *machine.world.ghosts.items()]:
        if isinstance(value, (Num, Bool)) and not isinstance(value, Lit):
            yield (
                f"initial value of {var.name!r} ({var.src}): {value!r} is a term; give a value, or ANY with a condition in "
                "`initially`."
            )
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
    state, ghosts = {*machine.state, machine.mode}, {*machine.world.variables}
    readable = {*input_variables(machine), *state}
    on_board = _Readers(readable, "inputs and state")
    for t in machine.transitions:
        terms = [t.when, *(value for value in t.set.values() if isinstance(value, (Num, Bool)))]
        yield from on_board.complaints(f"transition {t.name!r} ({t.src})", terms)
    after = _Readers(state, "state (after the step)")
    for name, term in machine.outputs.items():
        yield from after.complaints(f"output {name!r}", [term])
    anywhere = _Readers(readable | ghosts, "declared variables", on_board)
    for var, move in machine.world.moves.items():
        yield from anywhere.complaints(f"move of ghost {var.name!r}", [move])
    for name, clause in machine.world.terms.items():
        yield from anywhere.complaints(f"clause {name!r}", [clause])
    at_rest = _Readers(state | set(machine.world.ghosts), "state and ghosts", after)
    yield from at_rest.complaints("initially", [machine.initially])
    for name, lemma in machine.lemmas.items():
        yield from at_rest.complaints(f"lemma {name!r}", [lemma])


def _world_is_apart(machine: Machine) -> Iterator[str]:
    """A world does not read the state that the machine computes: a law that depends on it can prove a wrong machine right."""
    if not machine.world.reads_machine:
        for what, read in read_of_machine(machine).items():
            yield (
                f"{what} reads {read[0].name!r}, which the machine computes; let it read inputs, ghosts and choices only. "
                "If that is impossible, give the reason as reads_machine."
            )


def read_of_machine(machine: Machine) -> dict[str, list[Var]]:
    """Return the computed variables that clauses and ghosts' moves read, by the name of the clause or move.

    A state variable that no transition sets is not among them: it is a figure of the site, such as the place of a counter.
    """
    computed, world = {*_set_by_rows(machine), machine.mode, machine.fired_name}, machine.world
    laws: dict[str, Expr] = {f"clause {name!r}": term for name, term in world.terms.items()}
    laws |= {f"move of ghost {var.name!r}": move for var, move in world.moves.items()}
    read = {what: [var for var in variables([term]) if var in computed] for what, term in laws.items()}
    return {what: found for what, found in read.items() if found}


def _set_by_rows(machine: Machine) -> set[Var]:
    return {var for transition in machine.transitions for var in transition.set}


class _Readers:
    """Checks terms that may read the same variables; accepted parts are not visited again, since terms share most parts.

    allowed   the variables that the terms may read; `words` names them in a message
    narrower  the check of terms that may read fewer variables: parts accepted there are accepted here
    """

    def __init__(self, allowed: set[Var], words: str, narrower: _Readers | None = None) -> None:
        self._allowed, self._words = allowed, words
        self._fine: set[Expr] = set() if narrower is None else set(narrower._fine)

    def complaints(self, what: str, terms: Iterable[Expr]) -> list[str]:
        """List the errors in these terms, one sentence each."""
        nodes = in_order(terms, self._fine)
        strange = [node for node in nodes if isinstance(node, (NumVar, BoolVar)) and node not in self._allowed]
        found = [f"{what} reads {var.name!r}; it may read only {self._words}." for var in strange]
        if any(isinstance(node, Past) for node in nodes):
            found.append(f"{what} uses a past operator; only properties may.")
        if not found:
            self._fine.update(nodes)
        return found


def _ghosts_move(machine: Machine) -> Iterator[str]:
    for ghost in machine.world.ghosts:
        if ghost not in machine.world.moves:
            yield f"ghost {ghost.name!r} ({ghost.src}) has no move; give it one in moves (itself, if it keeps its value)."


def _guards_can_hold(machine: Machine) -> Iterator[str]:
    fine: set[Expr] = set()
    for t in machine.transitions:
        nodes = in_order([t.when], fine)
        constant = [node for node in nodes if isinstance(node, Compare) and _is_constant(node)]
        yield from (f"transition {t.name!r} ({t.src}): {_never_changes(node)}" for node in constant)
        if not constant:
            fine.update(nodes)


def _is_constant(node: Compare) -> bool:
    left, right = _range(node.left), _range(node.right)
    if left is None or right is None:
        return False
    return {
        "<": left[1] < right[0] or left[0] >= right[1],
        "<=": left[1] <= right[0] or left[0] > right[1],
        "==": left[1] < right[0] or left[0] > right[1],
    }[node.op]


def _never_changes(node: Compare) -> str:
    """Return a sentence on a comparison that is always true, or never, by the ranges of what it compares."""
    sides = ((term, _range(term)) for term in (node.left, node.right) if isinstance(term, NumVar))
    ranges = " and ".join(f"{term.name} lies between {reach[0]} and {reach[1]}" for term, reach in sides if reach)
    return f"the comparison {infix(node)} in its guard never changes: {ranges or 'both sides are constants'}."


def _range(term: Num) -> tuple[int, int] | None:
    match term:
        case Lit(value, _):
            return value, value
        case NumVar(low=low, high=high):
            return low, high
        case _:
            return None


SHAPE: tuple[Rule[Machine], ...] = (
    Rule("variables are variables", "a crash", _variables_are_variables),
    Rule("modes are one enumeration", "a crash", _modes_are_one_enumeration),
    Rule("terms are terms", "a crash", _terms_are_terms),
    Rule("terms are well formed", "a wrong verdict", _terms_are_well_formed),
)
"""Rules on which those of MACHINE rely, since these visit all terms; only the first broken rule is reported."""

MACHINE: tuple[Rule[Machine], ...] = (
    Rule("names are distinct", "a wrong verdict", _names_are_distinct),
    Rule("names can be written", "a crash", _names_can_be_written),
    Rule("labels can be written", "a slip", _labels_can_be_written),
    Rule("transitions join known modes", "a slip", _transitions_join_known_modes),
    Rule("sources are named once", "a wrong verdict", _sources_are_named_once),
    Rule("ranks are in order", "a slip", _ranks_are_in_order),
    Rule("updates fit", "a wrong verdict", _updates_fit),
    Rule("initial values fit", "a wrong verdict", _initial_values_fit),
    Rule("reads are declared", "a wrong verdict", _reads_are_declared),
    Rule("ghosts move", "a crash", _ghosts_move),
    Rule("the world is apart", "a wrong verdict", _world_is_apart),
    Rule("guards can hold", "a slip", _guards_can_hold),
)
