"""The register of assumptions is made from the laws of the worlds, complete, with figures and what is missing."""

from __future__ import annotations

from dataclasses import replace

import pytest
from pydantic import BaseModel

from safeloc.assurance.law_figures import FROM_MEMORY, is_from_memory
from safeloc.assurance.register import Assumption, figures_to_confirm, of_border, register, register_of
from safeloc.catalogue import load_target
from safeloc.config import Config, quantity
from safeloc.language.composition import Clause, compose
from safeloc.language.expr import Bool, NumVar, Var, number
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.system import lower
from safeloc.language.units import MM
from safeloc.language.world import Law, World
from safeloc.target import Target

(ON,) = modes("ON")
TRUTH, NEXT = number("truth", MM, 0, 100), number("next", MM, 0, 100)


class Reader(Config):
    """A reader's figures."""

    accuracy_mm: int = quantity(12, "mm", 0, 100, "[M] from memory")
    latency_ms: int = quantity(3, "ms", 0, 100, "[S] a data sheet")


class Both(Config):
    """Two readers, and a figure of the whole."""

    front: Reader = Reader()
    rear: Reader = Reader(accuracy_mm=20)
    length_mm: int = quantity(5, "mm", 0, 100, "[D] derived")


def machine(name: str, **laws: Bool | Law) -> Machine:
    """Adds up what it hears."""
    heard, total = number("heard", MM, 0, 9), number("total", MM, 0, 9)
    around = World({TRUTH: ANY}, [NEXT], {TRUTH: NEXT}, {law.replace("_", " "): term for law, term in laws.items()})
    rows = [Transition("take", ON, ON, set={total: heard})]
    return Machine(name, (ON,), [heard], {total: 0}, {"total": total}, rows, world=around)


def registered(made: Machine, config: BaseModel | None = None) -> list[Assumption]:
    """The register of a target of this machine alone."""
    return register(Target("t", (made,), lower(made), (), config))


def test_every_law_is_numbered_in_the_order_of_declaration() -> None:
    """A bare term is an assumption as well, and what nobody said of it is told."""
    full = Law(TRUTH < 50, "the truth is low", ("accuracy_mm",), "[S] a document", "supplier", "a type test")
    bare, said = registered(machine("front", stays=NEXT < 90, is_low=full), Reader())
    assert ("t/A1", "stays", "(< next 90)") == (bare.id, bare.name, bare.term)
    assert ("statement", "source", "owner", "check") == bare.lacks
    assert ("t/A2", (), "supplier") == (said.id, said.lacks, said.owner)
    assert [("accuracy_mm", "12", "mm", True)] == [
        (one.name, one.value, one.unit, one.to_confirm) for one in said.figures
    ]


def test_a_figure_is_that_of_the_machine_s_own_part() -> None:
    """Of two parts with a figure of the same name, that of the machine's name; without one of its name, all of them."""
    law = Law(TRUTH < 50, figures=("accuracy_mm", "length_mm"))
    (own,) = registered(machine("rear", law=law), Both())
    assert [("rear.accuracy_mm", "20"), ("length_mm", "5")] == [(one.name, one.value) for one in own.figures]
    (other,) = registered(machine("middle", law=law), Both())
    assert ["front.accuracy_mm", "rear.accuracy_mm", "length_mm"] == [one.name for one in other.figures]


def test_a_figure_that_nobody_configured_is_told() -> None:
    """A wrong name is not passed over."""
    (one,) = registered(machine("m", law=Law(TRUTH < 50, figures=("acuracy_mm",))), Reader())
    assert ["not found in the configuration"] == [figure.source for figure in one.figures]


def test_a_law_that_another_machine_guarantees_is_marked() -> None:
    """Nobody outside has to see to it."""
    first, second = machine("first"), machine("second", is_low=NEXT < 50, stays=NEXT < 90)
    heard = next(var for var in second.inputs if isinstance(var, Var))
    for discharge, expected in (([second], [True, True]), ([Clause(second, "is low")], [True, False])):
        whole = compose(
            "both", [first, second], {heard: first.output("total")}, shared=[TRUTH, NEXT], discharge=discharge
        )
        found = register(Target("both", (first, second), whole.system, ()))
        assert expected == [one.guaranteed for one in found]


def test_what_is_observable_is_told() -> None:
    """As a whole, in part, against another law, or not at all."""
    made = machine("m", low=NEXT < 50)
    own = next(var for var in made.inputs if isinstance(var, NumVar))
    laws = {
        "small": own < 8,
        "partly": (own < 9) & (TRUTH < 90),
        "same": NEXT.eq(own),
        "near": own + 1 < NEXT,
        "far": TRUTH > 1,
    }
    told = {one.name: one.monitored for one in registered(replace(made, world=replace(made.world, clauses=laws)))}
    assert {
        "small": "as a whole", "partly": "in part", "same": "against m: near", "near": "against m: same",
        "far": "no: only with the truth",
    } == told  # fmt: skip


def test_the_law_of_the_border_is_complete() -> None:
    """Every target that is run on records rests on it."""
    border = of_border()
    assert ("border/B1", "as a whole", ()) == (border.id, border.monitored, border.lacks)


def test_the_register_of_several_targets() -> None:
    """It has each law once with the targets that rest on it, in order, and that of the border at the end."""
    targets = [load_target(name) for name in ("odometry", "delocalized", "supervised_odometry")]
    found = register_of(targets)
    once = dict.fromkeys(one.id for target in targets for one in register(target))
    assert [*once, "border/B1"] == [row.one.id for row in found.rows]
    assert ("odometry", "supervised_odometry") == found.rows[0].targets
    assert (("every target on records",), of_border()) == (found.rows[-1].targets, found.rows[-1].one)
    assert figures_to_confirm(targets) == found.to_confirm
    assert 0 < found.observable < found.left_to_others == len(found.rows)


def test_a_law_that_one_of_two_targets_guarantees_is_left_to_others() -> None:
    """By itself the machine behind the source has to rely on it; where odometry stands before it, that is proved."""
    (row,) = (
        row
        for row in register_of([load_target("delocalized"), load_target("supervised_odometry")]).rows
        if row.guaranteed
    )
    assert (("supervised_odometry",), True) == (row.guaranteed, row.is_left_to_others)
    (row,) = (row for row in register_of([load_target("supervised_odometry")]).rows if row.guaranteed)
    assert not row.is_left_to_others


@pytest.mark.parametrize(
    ("source", "remembered"),
    [
        ("[M] a data sheet", True),
        ("[M, unsure]", True),
        ("[S] a standard; [M, fairly sure] the figure", True),
        ("[S] a standard", False),
        ("the default here, elsewhere 12 [M] a data sheet", False),
        ("[D] from [M]", False),
    ],
)
def test_memory_is_memory_however_sure(source: str, remembered: bool) -> None:
    """Also where it is one of several sources, and where it says how sure it is."""
    assert remembered is is_from_memory(source)


def test_figures_from_memory_are_counted_once() -> None:
    """Only they: those read in a document or derived need no operator; one that was set here is no default."""
    target = Target("t", (), lower(machine("m")), (), Both())
    (one,) = figures_to_confirm([target])
    assert ("accuracy_mm", "12", ("t: front.accuracy_mm",), 1) == (one.name, one.value, one.places, one.values)
    assert [] == figures_to_confirm([Target("t", (), target.system, ())])
    assert FROM_MEMORY == "[M]"
