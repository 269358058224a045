"""Runs of a system, computed from the checker's own nodes; a common beginning of several runs is computed once.

Many results of a report are shown by beginnings of the same recordings. Therefore all goals of one system are observed
together, and a step is plain Python code that is generated once from the nodes.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence

from safeloc.checker.dag import Dag
from safeloc.checker.terms import Translation
from safeloc.language.expr import Var
from safeloc.language.interpret import read_inputs, start
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal, watch
from safeloc.language.system import environment
from safeloc.runtime.streams.steps import Cell

State = tuple[Value, ...]
Computed = Callable[[Sequence[Value]], tuple[Value, ...]]
_OPERATORS = {"+": "+", "-": "-", "*": "*", "div": "//", "<": "<", "<=": "<=", ">=": ">=", "=": "=="}


def computed(dag: Dag, variables: Sequence[int], terms: Sequence[int]) -> Computed:
    """Return a function from values of variables to values of terms, over unbounded whole numbers; div rounds down."""
    names = {variable: f"v{place}" for place, variable in enumerate(variables)}
    lines = [f"{''.join(f'{name}, ' for name in names.values()) or '()'} = given"]
    for term in terms:
        for number in dag.below(term, names):
            names[number] = f"t{number}"
            lines.append(f"t{number} = {_written(dag, number, names)}")
    lines.append(f"return ({''.join(f'{names[term]}, ' for term in terms)})")
    made: dict[str, Computed] = {}
    exec(
        "def function(given):\n" + "".join(f"    {line}\n" for line in lines), made
    )  # generated from our own nodes only
    return made["function"]


def _written(dag: Dag, number: int, names: Mapping[int, str]) -> str:
    operator, *rest = dag.nodes[number]
    parts = [names[part] for part in dag.parts(number)]
    match operator:
        case "lit":
            return str(int(rest[0]))
        case "truth":
            return str(bool(rest[0]))
        case "not":
            return f"not {parts[0]}"
        case "and" | "or":
            return f" {operator} ".join(parts)
        case "ite":
            return f"{parts[1]} if {parts[0]} else {parts[2]}"
        case "var":
            raise KeyError(f"{rest[0]} has no value")
        case _:
            return f"{parts[0]} {_OPERATORS[str(operator)]} {parts[1]}"


class Walk:
    """The states that runs reach, by number, with the successor of each for given inputs.

    All goals belong to one system and have the same assumption, that of `goals[0].plain`.
    """

    def __init__(self, goals: Sequence[Goal], write: Translation) -> None:
        self._plain = goals[0].plain
        self._system = watch(self._plain, goals).system
        state, inputs = list(map(write, self._system.state)), list(map(write, self._system.inputs))
        asked = [environment(self._plain), *(self._system.next[var] for var in self._system.state)]
        self._step = computed(write.dag, [*state, *inputs], list(map(write, asked)))
        self._goods = computed(write.dag, state, [write(goal.good) for goal in goals])
        self._states: list[State] = []
        self._met: list[frozenset[int]] = []
        self._first: dict[Hashable, int] = {}
        self._after: dict[Hashable, int | None] = {}

    def met(self, first: Mapping[str, Value], stream: Iterable[Mapping[str, Cell]]) -> frozenset[int]:
        """Return the places of the goals that a run reaches before it violates the assumption."""
        return frozenset().union(*self.met_in_turn(first, stream))

    def met_in_turn(self, first: Mapping[str, Value], stream: Iterable[Mapping[str, Cell]]) -> Iterator[frozenset[int]]:
        """Yield, for each state of a run before it violates the assumption, the places of the goals that the state reaches."""
        return (self._met[number] for number in self._numbers(first, stream))

    def states(self, first: Mapping[str, Value], stream: Iterable[Mapping[str, Cell]]) -> Iterator[State]:
        """Yield the states of a run before it violates the assumption, without the observers' variables."""
        count = len(self._plain.state)
        return (self._states[number][:count] for number in self._numbers(first, stream))

    def _numbers(self, first: Mapping[str, Value], stream: Iterable[Mapping[str, Cell]]) -> Iterator[int]:
        """Yield the numbers of a run's states; InputError for a first state or inputs that the system does not have."""
        names = {var.name for var in self._plain.inputs}
        now = self._begun(first)
        yield now
        for record in stream:
            after = self._moved(now, {name: cell for name, cell in record.items() if name in names})
            if after is None:
                return
            now = after
            yield now

    def _begun(self, first: Mapping[str, Value]) -> int:
        key = frozenset(first.items())
        if key not in self._first:
            values = start(self._system, first)
            self._first[key] = self._kept(tuple(values[var] for var in self._system.state))
        return self._first[key]

    def _moved(self, now: int, record: Mapping[str, Cell]) -> int | None:
        key = (now, tuple((name, type(cell), cell) for name, cell in record.items()))
        if key not in self._after:
            inputs: Mapping[Var, Value] = read_inputs(self._plain, record)
            allowed, *after = self._step([*self._states[now], *(inputs[var] for var in self._plain.inputs)])
            self._after[key] = self._kept(tuple(after)) if allowed else None
        return self._after[key]

    def _kept(self, state: State) -> int:
        self._states.append(state)
        self._met.append(frozenset(place for place, good in enumerate(self._goods(state)) if not good))
        return len(self._states) - 1
