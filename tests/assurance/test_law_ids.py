"""An id of the register stands for one law with one set of figures, in every report, and says of which machine."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from safeloc.assurance.law_ids import ids_of
from safeloc.assurance.register import Assumption
from safeloc.catalogue import ENTRIES, load_target
from safeloc.language.composition import compose
from safeloc.language.expr import Bool, number
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.system import lower
from safeloc.language.units import MM
from safeloc.language.world import Law, World
from safeloc.proof.cores.clauses import ClauseId
from safeloc.report.machines import machine_data
from safeloc.target import Target
from tests.shipped import laws_of, shipped

(ON,) = modes("ON")
Said = tuple[object, ...]


@cache
def registers() -> dict[str, tuple[Assumption, ...]]:
    """The register of every machine that ships."""
    return {name: laws_of(name) for name in ENTRIES}


def said(one: Assumption) -> Said:
    """What a law says, with its figures."""
    figures = tuple((figure.value, figure.unit, figure.source) for figure in one.figures)
    return one.machine, one.name, one.statement, one.term, figures, one.source, one.owner, one.check


def test_an_id_has_one_meaning_and_a_meaning_has_one_id() -> None:
    """In words, term, figures, source and owner, over all machines that ship."""
    meanings, ids = defaultdict[str, set[Said]](set), defaultdict[Said, set[str]](set)
    for found in registers().values():
        for one in found:
            meanings[one.id].add(said(one))
            ids[said(one)].add(one.id)
    assert {} == {id_: several for id_, several in meanings.items() if len(several) > 1}
    assert {} == {words: several for words, several in ids.items() if len(several) > 1}
    assert len(meanings) > 200


@pytest.mark.thorough
def test_the_page_writes_every_law_of_an_id_in_the_same_way() -> None:
    """The whole term, to its last part: that of the register is cut where it is long."""
    written = defaultdict[str, set[str]](set)
    for name in ("odometry", "supervised_odometry", "marker_device", "satellite", "satellite_drift", "localizer"):
        for part in machine_data(load_target(name))["parts"]:
            for law in part["clauses"]:
                written[law["id"]].add(f"{law['terms']} {law['parts']}")
    assert {} == {id_: several for id_, several in written.items() if len(several) > 1}


def test_an_id_begins_with_a_machine_that_ships() -> None:
    """So a reader knows what to verify; the member of a composition stands after it."""
    for name, found in registers().items():
        for one in found:
            first, *member, number_ = one.id.split("/")
            assert first in ENTRIES, (name, one.id)
            assert member in ([], [one.machine]), (name, one.id)
            assert number_[0] == "A" and int(number_[1:]) > 0
            assert member or first == one.machine, (name, one.id)


def test_entries_name_their_members() -> None:
    """The register looks there for a machine that ships in compositions alone."""
    for name, entry in ENTRIES.items():
        machines = tuple(machine.name for machine in shipped(name).machines)
        assert entry.members == (() if len(machines) == 1 else machines), name


def test_a_law_keeps_its_id_in_a_composition_unless_it_is_another_there() -> None:
    """The localizer's odometry excludes the unit that is faulty, so its law of the wheel is its own."""
    ids = ids_of(shipped("localizer"))
    assert "odometry/A13" == ids[ClauseId("odometry", "the readers are as far apart as configured")]
    assert "localizer/odometry/A1" == ids[ClauseId("odometry", "front_wheel obeys its error law")]
    both = [
        ids_of(shipped(name))[ClauseId("uplink", "a position that is sent holds the truth")]
        for name in ("localizer", "localizer_sections")
    ]
    assert ["localizer/uplink/A1"] * 2 == both


def test_other_figures_make_another_law(tmp_path: Path) -> None:
    """Of a composition in a configuration of the user; laws without that figure stay the same."""
    file = tmp_path / "own.toml"
    file.write_text("max_speed_mm_s = 30_000\n", encoding="utf-8")
    shipped, own = ids_of(load_target("supervised_odometry")), ids_of(load_target("supervised_odometry", file))
    changed = {law.name: (shipped[law], id_) for law, id_ in own.items() if shipped[law] != id_}
    assert changed, own
    assert all(ours == f"supervised_odometry/{theirs}" for theirs, ours in changed.values())
    assert len(changed) < len(own)


TRUTH = number("truth", MM, 0, 100)


def machine(name: str, laws: Sequence[str]) -> Machine:
    """A machine with laws of these names."""
    heard, total = number("heard", MM, 0, 9), number("total", MM, 0, 9)
    clauses: dict[str, Bool | Law] = {law: TRUTH < 50 + at for at, law in enumerate(laws)}
    rows = [Transition("take", ON, ON, set={total: heard})]
    return Machine(
        name, (ON,), [heard], {total: 0}, {"total": total}, rows, world=World({TRUTH: ANY}, [], {TRUTH: TRUTH}, clauses)
    )


def ids_of_two(first: Sequence[str], second: Sequence[str]) -> dict[str, str]:
    """The ids of a composition of a user's machines with these laws."""
    parts = machine("first", first), machine("second", second)
    whole = compose("both", parts, {}, shared=[TRUTH])
    return {str(law): id_ for law, id_ in ids_of(Target("both", parts, whole.system, (), spec="own.py:both")).items()}


def test_a_law_at_the_end_of_another_machine_changes_no_id() -> None:
    """Numbers are counted in each machine by itself."""
    before, after = ids_of_two(["a"], ["b", "c"]), ids_of_two(["a", "new"], ["b", "c"])
    assert {"first: a": "both/first/A1", "second: b": "both/second/A1", "second: c": "both/second/A2"} == before
    assert {**before, "first: new": "both/first/A2"} == after


def test_a_machine_by_itself_has_its_target_s_name() -> None:
    """Also where a user gives the target another name than the machine."""
    one = machine("m", ["a"])
    assert {ClauseId("m", "a"): "t/A1"} == ids_of(Target("t", (one,), lower(one), (), spec="own.py:t"))


def test_a_user_s_composition_has_ids_of_its_own() -> None:
    """Also with a machine that ships in it: nothing that ships is loaded to number a user's laws."""
    shipped = load_target("supervised_odometry")
    own = ids_of(replace(shipped, name="mine", spec="own.py:mine"))
    assert {f"mine/{law.machine}" for law in own} == {id_.rpartition("/")[0] for id_ in own.values()}
