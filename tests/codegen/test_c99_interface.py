"""What the generated texts say of their origin and of the interface: a host sees what it was made for, and what changed."""

from __future__ import annotations

from typing import Any

import pytest

from safeloc.catalogue import load_target
from safeloc.codegen.c99 import to_c
from safeloc.codegen.c99_header import header
from safeloc.codegen.c99_interface import interface, interface_digest
from safeloc.codegen.c99_layout import Layout, layout_of
from safeloc.codegen.c99_statuses import FIRST_INPUT_STATUS, statuses
from safeloc.language.expr import choice, enumeration, members, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import MM
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.proof.exported import _origin
from safeloc.shipped_machines import ENTRIES
from tests.codegen.c_folder import runs_of


def odometry(**figures: Any) -> Layout:
    """The layout of the odometry machine with these figures."""
    return layout_of(without_ghosts(ENTRIES["odometry"].make(OdometryConfig(**figures)).system))


def counting(*, most_mm: int = 10, first_mm: int = 0, labels: tuple[str, ...] = ("UP", "DOWN")) -> Layout:
    """The layout of a machine that adds a movement."""
    (on,) = table = modes("ON")
    ways = members("way", *labels)
    moved, way = number("moved", MM, 0, most_mm), choice("way", enumeration(ways))
    sums = number("sums", MM, 0, 100)
    row = Transition("add", on, on, when=way.eq(ways[0]), set={sums: moved})
    return layout_of(lower(Machine("adder", table, [moved, way], {sums: first_mm}, {"sums": sums}, [row])))


def test_the_interface_changes_only_with_what_a_host_sees() -> None:
    """A figure that changes no range, type or number leaves the digest as it is; the declaration is another one."""
    one, other = odometry(), odometry(lone_limit_cycles=80)
    assert one.digest != other.digest
    assert interface(one) == interface(other)
    faster = interface(odometry(max_speed_mm_s=40_000))
    assert interface(one) != faster
    assert "input front_wheel_mm int64_t " in faster


def test_what_changed_is_seen_line_by_line() -> None:
    """A wider range, another order of members, and not the first state."""
    same = [counting(), counting(first_mm=7)]
    assert len({interface_digest(layout) for layout in same}) == 1
    before, wider, turned = (
        set(interface(layout).splitlines())
        for layout in (counting(), counting(most_mm=11), counting(labels=("DOWN", "UP")))
    )
    assert wider - before == {"input moved int64_t 0 .. 11 mm"}
    assert turned - before == {"member way ADDER_WAY_DOWN = 0", "member way ADDER_WAY_UP = 1"}


def test_statuses_below_the_inputs_have_numbers_that_stay() -> None:
    """A host may have stored them, so a machine with proved invariants and one without have the same."""
    expected = ["OK", "NO_POINTER", "STATE_OUT_OF_RANGE", "FIRST_REFUSED", "SNAPSHOT_FOREIGN", "SNAPSHOT_DAMAGED"]
    fixed = {name: number for name, number, _ in statuses(counting()) if number < FIRST_INPUT_STATUS}
    assert fixed == {**{f"ADDER_{name}": number for number, name in enumerate(expected)}, "ADDER_STATE_NOT_SET": 7}


@pytest.mark.parametrize(
    ("name", "owner", "prefix"), [("occupied_track", "", ""), ("localizer_track", "occupied_track.", "occupied_track_")]
)
def test_the_header_says_that_the_edge_may_not_be_known(name: str, owner: str, prefix: str) -> None:
    """A host that reads the header alone sees the edge, the possible ones, and that a coordinate is no place on the map."""
    target = load_target(name)
    text = header(layout_of(without_ghosts(target.system)), target.doc, _origin(target))
    said = {
        line.split(";")[0].split()[1]: line for line in text.splitlines() if line.startswith("    ") and ";" in line
    }
    assert (
        "; edge of the map on which end A is, counted with its direction; 0: it is not known" in said[f"{prefix}edge"]
    )
    assert (
        f"from the beginning of the edge that {owner}edge tells, while {owner}valid is 1"
        in said[f"{prefix}position_mm"]
    )
    for slot in range(1, 5):
        assert "; edge on which end A may be; 0: none" in said[f"{prefix}track_{slot}_edge"]
        assert f"edge of {owner}track_{slot}_edge" in said[f"{prefix}track_{slot}_high_mm"]
    if owner:
        assert "no place on the map while occupied_track.edge is 0" in said["delocalized_position_mm"]


def test_the_folder_says_what_it_was_exported_for() -> None:
    """Version, configuration and cycle stand in the header and in the README, with each figure; the digests in both."""
    target = load_target("odometry")
    origin, layout = _origin(target), odometry()
    text = header(layout, target.doc, origin)
    assert "#define ODOMETRY_PERIOD_MS 100\n" in text
    assert " *     vehicle_length_mm = 204700 mm\n" in text
    assert " *     second_unit.rate_ppm = 21277 ppm of distance\n" in text
    assert "Exported with the default configuration." in text
    assert f"#define ODOMETRY_INTERFACE UINT64_C(0x{interface_digest(layout)[:16]})" in text
    assert "; distance run in this cycle, positive towards end A (front) */" in text
    assert "; estimate of the place of end A on the line, while valid is 1 */" in text
    small = counting()
    readme = to_c(small.system, runs_of(small.system, 5), origin=origin)["README.md"]
    assert "| tolerance_mm | 30000 mm |" in readme
    assert "One step is one cycle of 100 ms." in readme
    assert f"Interface: SHA-256 {interface_digest(small)}" in readme
