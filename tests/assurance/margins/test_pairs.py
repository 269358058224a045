"""Pairs of figures that are declared with the machines that ship: five each, or as many as there are, and of figures that can move so."""

from __future__ import annotations

import pytest

from safeloc.assurance.margins.figures import configured_figures
from safeloc.catalogue import ENTRIES, load_target
from safeloc.cli.fronts import declared_pairs
from safeloc.errors import InputError

FIVE = 5
FEWER = {
    "axle_section": "only two of its three figures meet in a law; an axle that leads a train before a reset meets neither",
    "train_order": "the number of trains is the form of its world, so no front of it and the line can be drawn",
    "emitter": "its pattern and its place are names of its own, and its other figures meet in two sums",
}
"""Machines with fewer pairs than their figures would make, each with the reason."""


def test_declared_pairs_name_figures_of_their_machine_that_can_move_so() -> None:
    for entry in ENTRIES.values():
        known = {one.name: one for one in configured_figures(entry.config())}
        assert len({one.name for one in entry.pairs}) == len(entry.pairs) <= FIVE
        for one in entry.pairs:
            (first, way), (second, other) = (text.split(":") for text in (one.first, one.second))
            assert first != second
            for name, to in ((first, way), (second, other)):
                assert known[name].value != {"up": known[name].high, "down": known[name].low}[to], (entry.name, name)


def test_every_machine_with_two_figures_or_more_has_five_pairs_or_all_that_it_can_have() -> None:
    """A composition has those of its machines; the others declare five, or all pairs of few figures, or stand in a list."""
    fewer = []
    for entry in ENTRIES.values():
        count = len(list(configured_figures(entry.config())))
        if not entry.pairs_of and len(entry.pairs) < min(FIVE, count * (count - 1) // 2):
            fewer.append(entry.name)
    assert sorted(fewer) == sorted(FEWER)


def test_the_pairs_of_a_composition_are_of_figures_that_it_has() -> None:
    compositions = [entry for entry in ENTRIES.values() if entry.pairs_of]
    assert {"localizer", "counting_head"} <= {entry.name for entry in compositions}
    for entry in compositions:
        known = [one.name for one in configured_figures(entry.config())]
        assert not entry.pairs
        for pair in (pair for name in entry.pairs_of for pair in ENTRIES[name].pairs):
            for name in (text.partition(":")[0] for text in (pair.first, pair.second)):
                assert any(one == name or one.endswith(f".{name}") for one in known), (entry.name, name)


def test_a_composition_names_the_commands_for_its_pairs() -> None:
    with pytest.raises(InputError, match=r"supervised_odometry has the pairs .*`safeloc margins odometry --pairs`"):
        declared_pairs(load_target("supervised_odometry"))
