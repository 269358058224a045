"""Nodes, switches and crossings from statements on which ends meet."""

from __future__ import annotations

from itertools import pairwise

import pytest

from safeloc.errors import InputError
from safeloc.railway.map.elements import Crossing, Switch
from safeloc.railway.map.imports.notes import Note
from safeloc.railway.map.imports.topology import End, Joined, Naming, Relation, join


def meet(one: End, other: End, *, passable: bool = True, name: str = "r") -> Relation:
    """Two ends that meet."""
    return Relation(name, one, other, passable, f"relation {name}")


PLAIN = Naming(
    node=lambda ends, own: "+".join(f"{edge}{end}" for edge, end in ends),
    sides=lambda stem, one, other: (one, other),
    coordinates=lambda end: None,
)


def joined(edges: str, *relations: Relation, naming: Naming = PLAIN) -> Joined:
    """Edges with one letter each."""
    return join(list(edges), relations, naming)


def test_two_ends_are_a_node() -> None:
    """Without a switch; the other ends stand alone."""
    found = joined("ab", meet(("a", 1), ("b", 0)))
    assert ["a0", "a1+b0", "b1"] == [node.id for node in found.nodes]
    assert {("a", 0): "a0", ("a", 1): "a1+b0", ("b", 0): "a1+b0", ("b", 1): "b1"} == found.node_of
    assert ((), (), ()) == (found.switches, found.crossings, found.notes)


def test_three_ends_with_two_ways_are_a_switch() -> None:
    """The stem is the end that both ways have in common, in whatever order it is told."""
    ways = meet(("b", 0), ("a", 1)), meet(("c", 1), ("b", 0)), meet(("a", 1), ("c", 1), passable=False)
    found = joined("abc", *ways)
    name = "a1+b0+c1"
    assert (Switch(id=name, node=name, stem="b", left="a", right="c"),) == found.switches


def test_a_switch_whose_sides_are_unknown_is_a_crossing() -> None:
    """It still says which ways there are; nothing is invented."""
    blind = Naming(PLAIN.node, lambda *_: None, PLAIN.coordinates)
    ways = meet(("a", 1), ("b", 0)), meet(("a", 1), ("c", 0))
    found = joined("abc", *ways, naming=blind)
    assert () == found.switches
    assert [(("a", "b"), ("a", "c"))] == [crossing.movements for crossing in found.crossings]
    told = "which branch is left is not known; the switch is a crossing"
    assert (Note("not carried over", "relation r", told),) == found.notes


def test_three_ways_between_three_ends_are_a_crossing() -> None:
    """No switch lets vehicles go from branch to branch."""
    ways = [meet((one, 0), (other, 0)) for one, other in ("ab", "bc", "ac")]
    (crossing,) = joined("abc", *ways).crossings
    assert (("a", "b"), ("a", "c"), ("b", "c")) == crossing.movements


def test_a_double_slip() -> None:
    """Four ends, four ways."""
    ways = [meet((one, 1), (other, 0)) for one in "ab" for other in "cd"]
    found = joined("abcd", *ways)
    name = "a1+b1+c0+d0"
    expected = Crossing(id=name, node=name, movements=(("a", "c"), ("a", "d"), ("b", "c"), ("b", "d")))
    assert (expected,) == found.crossings


def test_contradicting_statements_are_no_way() -> None:
    """The more cautious one is taken, and said."""
    both = meet(("a", 1), ("b", 0)), meet(("b", 0), ("a", 1), passable=False, name="other")
    found = joined("ab", *both)
    assert 4 == len(found.nodes)
    assert ["relation other", "relation r", "relation other"] == [note.place for note in found.notes]
    assert "doubtful" == found.notes[0].kind


def test_an_end_without_a_way_is_kept_apart() -> None:
    """It meets the others, but no vehicle gets there."""
    found = joined("abc", meet(("a", 1), ("b", 0)), meet(("b", 0), ("c", 0), passable=False))
    assert "c0" == found.node_of["c", 0]
    told = "ends that meet without a way between them; kept apart"
    assert (Note("not carried over", "relation r", told),) == found.notes


def test_a_ring_is_refused() -> None:
    """Both ends of an edge at one node, and an end that meets itself."""
    with pytest.raises(InputError, match=r"^relation r: both ends of edge 'a' meet at one node; divide it into two"):
        joined("a", meet(("a", 0), ("a", 1)))
    with pytest.raises(InputError, match=r"^relation r: joins one end of edge 'a' to itself\.$"):
        joined("a", meet(("a", 0), ("a", 0)))


def test_two_nodes_of_one_name_are_refused() -> None:
    """A format's names must tell places apart."""
    same = Naming(lambda ends, own: "n", PLAIN.sides, PLAIN.coordinates)
    with pytest.raises(InputError, match="node 'n': two places where edges meet have this name"):
        joined("ab", naming=same)


def test_large_networks_are_joined_quickly() -> None:
    """Ten thousand edges in a row: as many nodes and one more."""
    edges = [f"e{number}" for number in range(10_000)]
    relations = [meet((one, 1), (other, 0)) for one, other in pairwise(edges)]
    assert 10_001 == len(join(edges, relations, PLAIN).nodes)
