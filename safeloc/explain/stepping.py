"""A machine that is run step by step by hand: inputs are set, transitions are looked at before they fire, steps are taken back."""

from __future__ import annotations

import re
import weakref
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from safeloc.errors import InputError
from safeloc.explain.failing_parts import Part, failing_parts, parts_of, value_text
from safeloc.explain.mattering_inputs import open_first
from safeloc.explain.pytest_file import run_file
from safeloc.language.absence import stand_ins, without_absent
from safeloc.language.expr import Bool, Expr, NumVar, Var
from safeloc.language.interpret import Program, admitted, fired_names, holds, named, outputs, read_inputs, start, step
from safeloc.language.machine import Machine
from safeloc.language.monitor import Broken, Checks, Holds, Look, Status, Undecided
from safeloc.language.nodes import Value
from safeloc.language.renamed import hint
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, canonical
from safeloc.language.terms import Sharing, in_order
from safeloc.language.trace import Step, Trace, present_inputs, shown
from safeloc.runtime.streams.steps import write_steps
from safeloc.target import Target

ABSENT = ("absent", "none", "-")
"""Words for an input that is absent."""
_TRUTHS = {"true": True, "false": False}


@dataclass(frozen=True)
class RowView:
    """A transition of the present mode, with the inputs that are set.

    enabled  its guard holds
    fires    it is the one that the next step takes
    why      the parts of the guard that do not hold; of an enabled one the guard alone
    """

    machine: str
    name: str
    target: str
    enabled: bool
    fires: bool
    why: tuple[Part, ...]


@dataclass(eq=False)
class Stepper:
    """A run that is made by hand.

    first     values of variables whose first value is open
    recorded  inputs of a recording, which the next steps take as long as nothing else is set
    config    file of the target's configuration, which a saved test loads it with; None for the defaults
    """

    target: Target
    first: Mapping[str, Value] = field(default_factory=dict)
    recorded: Sequence[Mapping[str, object]] = ()
    config: Path | None = None
    _set: dict[str, object] = field(default_factory=dict, init=False)
    _inputs: list[dict[str, object]] = field(default_factory=list, init=False)
    _states: list[dict[Var, Value]] = field(default_factory=list, init=False)
    _steps: list[Step] = field(default_factory=list, init=False)
    _held: dict[str, object] = field(default_factory=dict, init=False)
    _looks: list[Look] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        self._states.append(start(self.system, self.first))

    # -------------------------------------------------------------- what it is

    @property
    def system(self) -> TransitionSystem:
        """The system that is run."""
        return self.target.system

    @property
    def number(self) -> int:
        """The number of steps that were taken."""
        return len(self._steps)

    @property
    def trace(self) -> Trace:
        """The run so far."""
        return Trace(self.system, named(self._states[0]), tuple(self._steps))

    @property
    def state(self) -> dict[str, str]:
        """The present state by name, as text."""
        return {var.name: shown(var, value) for var, value in self._states[-1].items()}

    @property
    def outputs(self) -> dict[str, str]:
        """The present outputs by name, as text; absent ones are left out."""
        values = without_absent(outputs(self.system, self._states[-1]), stand_ins(self.system))
        return {
            name: value_text(self.system.outputs[name], value) for name, value in values.items() if value is not None
        }

    @property
    def watchable(self) -> dict[str, str]:
        """The present state and all outputs by name, as text; an output may be `absent`."""
        outputs = self.outputs
        return {**self.state, **{name: outputs.get(name, ABSENT[0]) for name in self.system.outputs}}

    @property
    def inputs(self) -> dict[str, str]:
        """The inputs of the next step by name, as text; absent ones are left out."""
        values = self._next_inputs()
        return {
            name: shown(self.system.variable(name), value)
            for name, value in present_inputs(self.system, named(values)).items()
        }

    @property
    def given(self) -> frozenset[str]:
        """The names of the inputs that are set for the next step."""
        return frozenset(self._set)

    @property
    def held(self) -> dict[str, str]:
        """The inputs that are held in every step until they are released, as text by name."""
        return {
            name: ABSENT[0] if value is None else shown(self.system.variable(name), value)  # type: ignore[arg-type] # admitted
            for name, value in self._held.items()
        }

    @property
    def input_variables(self) -> list[Var]:
        """The inputs that can be set, without presence flags."""
        return [var for var in self.system.inputs if var.name not in self._flags]

    def broken_laws(self) -> list[str]:
        """Return the laws of the world, each with its machine, that the next step breaks; no proof speaks of what follows."""
        return laws_broken(self.system, self._states[-1], self._next_inputs())

    def rows(self) -> list[RowView]:
        """Return the transitions of each machine's present mode, in the order in which they are tried."""
        return rows_at(self.system, self._states[-1], self._next_inputs())

    def broken(self) -> dict[str, int]:
        """Return the properties that the run has broken, each with the step that did."""
        return {name: one.at for name, one in self._statuses() if isinstance(one, Broken)}

    def broken_now(self) -> dict[str, list[Part]]:
        """Return the properties that the last step broke, or the first state, each with the parts of its term that fail."""
        broken = self.broken()
        return {
            prop.name: failing_parts(self.trace, prop) for prop in self._claims if broken.get(prop.name) == self.number
        }

    def without_assumption(self) -> dict[str, int]:
        """Return the properties that claim nothing any more, each with the step that broke their assumption."""
        return {name: one.at for name, one in self._statuses() if isinstance(one, Undecided)}

    def _statuses(self) -> Iterator[tuple[str, Status]]:
        """Yield each property that no single run shows, with its status after the run so far."""
        self._look()
        for number, prop in enumerate(self._claims):
            yield prop.name, _status([(look.values[number], look.kept[number]) for look in self._looks])

    @cached_property
    def _claims(self) -> list[Property]:
        return [prop for prop in self.target.properties if prop.kind != "reachable"]

    @cached_property
    def _checks(self) -> Checks:
        return Checks(self.system, self._claims)

    def _look(self) -> None:
        """Look at every state that was not looked at yet."""
        if not self._looks:
            self._looks.append(self._checks.first(self.first))
        for inputs in self._inputs[len(self._looks) - 1 :]:
            self._looks.append(self._checks.after(self._looks[-1], inputs))

    # -------------------------------------------------------------- what is done

    def give(self, name: str, text: str) -> None:
        """Set an input of the next step: a whole number, true, false, a label, or `absent`. InputError for anything else."""
        self._set[name] = self._admitted(name, text)

    def hold(self, name: str, text: str) -> None:
        """Hold an input in every step from the next one on, whatever is recorded; `give` takes precedence. Errors as of `give`."""
        self._held[name] = self._admitted(name, text)

    def release(self, name: str) -> None:
        """Hold an input no more. InputError for one that is not held."""
        if name not in self._held:
            raise InputError(f"input {name!r} is not held; held are {', '.join(self._held) or 'none'}.")
        del self._held[name]

    def _admitted(self, name: str, text: str) -> object:
        known = {var.name: var for var in self.input_variables}
        if name not in known:
            raise InputError(f"{self.system.name} has no input {name!r}; it has {', '.join(known)}.{hint(name, known)}")
        if text.lower() not in ABSENT:
            return admitted(known[name], _value(text))
        if name not in {option.value.name for option in self.system.optionals}:
            raise InputError(f"{self.system.name}: input {name!r} is never absent; give it a value.")
        return None

    def take(self) -> Step:
        """Take a step with the inputs that are set, and return it; the next one begins with nothing set."""
        inputs = self._next_inputs()
        after, fired = step(self.system, self._states[-1], inputs)
        made = Step(named(inputs), fired_names(fired), named(after), outputs(self.system, after))
        self._inputs.append(dict(present_inputs(self.system, named(inputs))))
        self._states.append(after)
        self._steps.append(made)
        self._set.clear()
        return made

    def back(self, steps: int = 1) -> None:
        """Take back that many steps. InputError if there are not so many."""
        if not 0 <= steps <= self.number:
            raise InputError(f"there are {self.number} steps to take back, not {steps}.")
        kept = self.number - steps
        del self._steps[kept:], self._inputs[kept:], self._states[kept + 1 :], self._looks[kept + 1 :]
        self._set.clear()

    def save(self, path: Path) -> None:
        """Write the run as a step stream, which `safeloc replay` reads, or as a test file if the path ends in `.py`.

        InputError for an existing file and for no steps.
        """
        if path.exists():
            raise InputError(f"{path} exists; give another file, since its content would be lost.")
        if not self._inputs:
            raise InputError("no step was taken; there is no run to save.")
        if path.suffix == ".py":
            path.write_text(run_file(self.target, self.trace, self.config), encoding="utf-8")
        else:
            write_steps(path, self.trace.stream(), machine=self.target.name, first=open_first(self.trace))

    # -------------------------------------------------------------- inputs

    @property
    def _flags(self) -> set[str]:
        return {option.present.name for option in self.system.optionals}

    def _next_inputs(self) -> dict[Var, Value]:
        """Return all inputs of the next step: what is set, else what is recorded, else rest."""
        recorded = self.recorded[self.number] if self.number < len(self.recorded) else None
        record = _rest(self.system) if recorded is None else dict(recorded)
        return read_inputs(self.system, {**record, **self._held, **self._set})


def _rest(system: TransitionSystem) -> dict[str, object]:
    optional = {var for option in system.optionals for var in (option.value, option.present)}
    return {
        var.name: canonical(var) if isinstance(var, NumVar) else False for var in system.inputs if var not in optional
    }


def _status(seen: Sequence[tuple[Value, bool]]) -> Status:
    """Return what a run says of a property: for each state, whether it holds there and whether the step kept its assumption."""
    for number, (holds_there, kept) in enumerate(seen):
        if not kept:
            return Undecided(number, "the assumption is broken from here on")
        if not holds_there:
            return Broken(number)
    return Holds()


def _value(text: str) -> object:
    if text.lower() in _TRUTHS:
        return _TRUTHS[text.lower()]
    return int(text) if re.fullmatch(r"[+-]?[0-9]+", text) else text


# ------------------------------------------------------------------ rows


def rows_at(system: TransitionSystem, state: Mapping[Var, Value], inputs: Mapping[Var, Value]) -> list[RowView]:
    """Return the transitions of each machine's present mode, in the order in which they are tried."""
    taken = fired_names(step(system, state, inputs)[1])
    if system not in _GUARDS:
        _GUARDS[system] = _Guards(system)
    return list(_GUARDS[system].rows({**state, **inputs}, taken))


def laws_broken(system: TransitionSystem, state: Mapping[Var, Value], inputs: Mapping[Var, Value]) -> list[str]:
    """Return the laws of the world, each with its machine, that a step breaks."""
    values = {**state, **inputs}
    return [name for name, term in _laws(system).items() if not holds(term, values)]


@dataclass(frozen=True, eq=False)
class _Machine:
    """One machine of the system, and how its terms read in a step of the whole."""

    machine: Machine
    fired: str
    in_a_step: Callable[[Expr], Expr]
    share: Sharing = field(default_factory=Sharing)

    @cached_property
    def guards(self) -> dict[str, Bool]:
        """The guards by transition; equal terms are the same node, so that a name is found wherever its term stands."""
        return {one.name: self.share.bool(one.when) for one in self.machine.transitions}

    @cached_property
    def names(self) -> dict[Expr, str]:
        """The terms that the machine names."""
        return {self.share(term): name for name, term in self.machine.definitions.items()}

    def terms(self) -> list[Expr]:
        """Return the mode, the guards and all terms in them."""
        return list(in_order([self.machine.mode, *self.guards.values()]))

    def rows(self, known: Mapping[Expr, Value], taken: Mapping[str, str]) -> Iterator[RowView]:
        """Yield the transitions of the present mode in the order in which they are tried; `known` has the values of `terms`."""
        mode = known[self.machine.mode]
        present = [one for one in self.machine.transitions if mode in [source.value for source in one.sources]]
        for one in sorted(present, key=lambda row: row.rank):
            guard = self.guards[one.name]
            enabled = bool(known[guard])
            why = tuple(parts_of(guard, known, wanted=True, names=self.names))
            yield RowView(self.machine.name, one.name, one.target.label, enabled, taken[self.fired] == one.name, why)


class _Guards:
    """The guards of all machines of a system, prepared to be evaluated at once: later machines read what earlier ones compute."""

    def __init__(self, system: TransitionSystem) -> None:
        self._machines = _parts(system)
        self._terms = [machine.terms() for machine in self._machines]
        read = zip(self._machines, self._terms, strict=True)
        self._program = Program([machine.in_a_step(term) for machine, terms in read for term in terms])

    def rows(self, values: Mapping[Var, Value], taken: Mapping[str, str]) -> Iterator[RowView]:
        """Yield the transitions of each machine's present mode, in the order in which they are tried."""
        found = iter(self._program(values))
        for machine, terms in zip(self._machines, self._terms, strict=True):
            yield from machine.rows({term: next(found) for term in terms}, taken)


_GUARDS: weakref.WeakKeyDictionary[TransitionSystem, _Guards] = weakref.WeakKeyDictionary()


def _laws(system: TransitionSystem) -> dict[str, Bool]:
    """Return the clauses that a step has to keep, by machine and name."""
    if not system.parts:
        [machine] = system.machines
        return {f"{machine.name}: {name}": term for name, term in machine.world.terms.items()}
    return {f"{part.name}: {name}": term for part in system.parts for name, term in part.assumed.items()}


def _parts(system: TransitionSystem) -> list[_Machine]:
    fired = [var.name for var in system.fired]
    if not system.parts:
        [machine] = system.machines
        return [_Machine(machine, fired[0], lambda term: term)]
    return [_Machine(part.machine, name, part.in_a_step) for part, name in zip(system.parts, fired, strict=True)]
