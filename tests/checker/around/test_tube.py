"""The checker's own tube allows what the definition allows: the prover's check of single streams is the other opinion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from safeloc.checker.around.folding import Folding
from safeloc.checker.around.question import Channel, Given
from safeloc.checker.around.tube import Tube
from safeloc.checker.dag import Dag
from safeloc.checker.solve import Opinions
from safeloc.checker.terms import Translation
from safeloc.checker.text import Certificate
from safeloc.language.expr import Var
from safeloc.language.nodes import Value
from safeloc.proof.around.containment import first_outside
from safeloc.proof.around.tube import Tube as Proved
from tests.proof.around.test_enumerated import near_rows, tubes


def allows(tube: Proved, rows: Sequence[Mapping[Var, Value]]) -> bool:
    """The checker's conditions have a solution in which the inputs are those of the stream."""
    write = Translation(Dag())
    dag, folding = write.dag, Folding(write.dag)
    channels = [Channel(one.names, one.drops, one.delay) for one in tube.deviations.channels]
    mine = Tube(tube.system, Given(tube.given.rows, [], [], []), tube.deviations.widths, channels, write)  # type: ignore[arg-type] # rows are mappings
    counters = {one.name: folding.number(0) for one in mine.counters}
    asked = list[int]()
    for number, row in enumerate(rows, 1):
        cycle = mine.cycle(number, folding, counters)
        counters |= cycle.counters
        asked += cycle.conditions
        for node, term in cycle.inputs.items():
            [var] = [var for var in tube.system.inputs if write(var) == node]
            value = row[var]
            if isinstance(value, bool):
                asked.append(term if value else folding.make("not", [term]))
            else:
                asked.append(folding.make("=", [term, folding.number(value)]))
    for node, (low, high) in folding.bounds.items():
        if dag.nodes[node][0] == "var":
            asked += [dag.make("<=", [dag.number(low), node]), dag.make("<=", [node, dag.number(high)])]
    found = Opinions(dag, 10)(Certificate("", {}, (), frozenset(asked), (dag.truth[False],)), None)
    assert len({answers[0] for answers in found.answers.values()}) == 1
    return found.answers["z3"] == ["sat"]


@given(st.data())
@settings(
    max_examples=25,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large],
)
def test_a_stream_is_allowed_exactly_if_it_lies_in_the_tube(data: st.DataObject) -> None:
    """Streams near random tubes, inside and outside."""
    tube = data.draw(tubes())
    rows = [data.draw(st.sampled_from(list(near_rows(tube, number)))) for number in range(1, tube.length + 1)]
    assert allows(tube, rows) == (first_outside(tube, rows) is None)
