"""A source of a user's own: its contract is proved by itself, the localizer hears it, and what is wrong with it is said."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from safeloc.catalogue import Target, load_target, sources_of, with_sources
from safeloc.errors import InputError
from safeloc.language.interpret import run
from safeloc.language.nodes import Value
from safeloc.language.system import without_ghosts
from safeloc.language.verdict import Proved, Violated
from safeloc.models.localizer import compose_machines
from safeloc.models.localizer.own_source import TAKEN
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.proved_base import base
from tests.proof.provers.small import told as names

BEACONS = Path(__file__).parents[2] / "docs" / "examples" / "beacons.py"
RUN_MM = 4_445
"""What a vehicle of 160 km/h runs in a cycle of 100 ms, rounded up."""


def edited(folder: Path, old: str, new: str) -> str:
    """The address of the example with a line of it written otherwise."""
    text = BEACONS.read_text(encoding="utf-8")
    assert old in text
    file = folder / "wrong.py"
    file.write_text(text.replace(old, new), encoding="utf-8")
    return f"{file}:source"


def verdicts(target: Target, only: str = "") -> dict[str, object]:
    """What becomes of each claim, or of one."""
    claims = [one for one in target.properties if only in ("", one.name)]
    found = prove(target.system, claims, Limits(seconds=20))
    return {one.id.rpartition("/")[2]: one.result for one in found if "/property/" in one.id}


# ------------------------------------------------------------------ the example


def test_the_example_is_short() -> None:
    """A source takes no more than sixty lines of a file outside the project."""
    assert len(BEACONS.read_text(encoding="utf-8").splitlines()) <= 60


def test_its_contract_is_proved_by_itself() -> None:
    """From the laws of its own world, whatever the other sources are."""
    target = load_target(f"contract+{BEACONS}:source")
    assert {name for name, verdict in verdicts(target).items() if not isinstance(verdict, Proved)} == set()
    assert "a range is true" in target.machines[0].world.clauses


def test_the_localizer_hears_it_alone() -> None:
    """The contract of arbitration holds with it, and no fact is lost."""
    known = base(load_target(f"alone+{BEACONS}:source").system)
    assert "contract of arbitration holds" in names(known.kept)
    assert not known.refuted


@pytest.mark.slow  # five sources and one more: minutes
def test_the_localizer_hears_it_beside_its_own() -> None:
    """The same beside all sources that ship."""
    known = base(load_target(f"localizer+{BEACONS}:source").system, seconds=60)
    assert "contract of arbitration holds" in names(known.kept)
    assert not known.refuted


def test_a_vehicle_is_located_by_beacons() -> None:
    """A range leads at once, runs on while none comes, and is withdrawn when what can have been run is too much."""
    target = load_target(f"alone+{BEACONS}:source")
    near: dict[str, Value | None] = {"beacons.beacon_mm": 120_000, "beacons.range_mm": 20_000}
    silent: dict[str, Value | None] = {"beacons.beacon_mm": None, "beacons.range_mm": None}
    others: dict[str, Value | None] = {
        "motion.odometer_mm": None,
        "motion.check_mm": None,
        "uplink.sent": True,
        "uplink.arrived": False,
    }
    system = without_ghosts(target.system)
    steps = run(system, [{**others, **one} for one in (near, *[silent] * 7)]).steps
    valid = [bool(step.outputs["arbitration.valid"]) for step in steps]
    assert valid == [True] * 6 + [False] * 2
    margins = [400 + RUN_MM * cycle for cycle in range(1, 7)]
    assert [step.outputs["delocalized.margin_above_mm"] for step in steps[:6]] == margins
    assert {step.outputs["delocalized.position_mm"] for step in steps[:6]} == {100_000}
    assert margins[-1] <= 30_000 < margins[-1] + RUN_MM


# ------------------------------------------------------------------ what is wrong is said


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("old", "new", "broken"),
    [
        ("{position: place, margin: fresh}", "{position: place, margin: fresh - 1}", "the interval holds the front end"),
        ("{margin: wider}", "{margin: margin + (run - 1)}", "the interval holds the front end"),
        ("RANGING_MM + run", "RANGING_MM", "the interval holds the front end"),
        ("SURVEY_MM, RANGING_MM, WIDEST_MM = 100", "SURVEY_MM, RANGING_MM, WIDEST_MM = 99", "the interval holds the front end"),
        ('"reference_accepted": valid & ', '"reference_accepted": ', None),
        ("ite(valid, LOCATED, SENSOR_FAILURE)", "ite(margin > 40_000, SENSOR_FAILURE, LOCATED)", "a reason is stated"),
        ('"reference_accepted": valid & margin.eq(fresh)', '"reference_accepted": ~valid', "a reference comes with an interval"),
    ],
)  # fmt: skip
def test_a_broken_clause_is_refuted_with_its_place(old: str, new: str, broken: str | None, tmp_path: Path) -> None:
    """A run breaks the clause, and the clause tells file and line; None: an edit that keeps the contract."""
    address = edited(tmp_path, old, new)
    target = load_target(f"contract+{address}")
    wrong = [name for name, verdict in verdicts(target).items() if isinstance(verdict, Violated)]
    assert wrong == ([] if broken is None else [broken])
    for claim in target.properties:
        assert re.match(r".*wrong\.py:\d+, contract of a source: ", claim.statement)


@pytest.mark.thorough
def test_a_margin_that_cannot_be_heard(tmp_path: Path) -> None:
    """Wider than the localizer hears: refuted, with the figure."""
    target = load_target(f"contract+{edited(tmp_path, '300, 45_000', '300, 450_000')}")
    claim = "the interval is in range"
    assert isinstance(verdicts(target, claim)[claim], Violated)
    assert "300000 mm" in next(one.statement for one in target.properties if one.name == claim)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('            "reason": ite(valid, LOCATED, SENSOR_FAILURE),\n', "", "has no output 'reason'; a source states it, a member"),
        ('"valid": valid,', '"valid": margin,', "output 'valid' of machine 'beacons' must be a truth value"),
        ('"position_mm": position_if(valid, position)', '"position_mm": mode', "output 'position_mm' .* must be a number of mm"),
        ("ite(valid, LOCATED, SENSOR_FAILURE)", "mode", "output 'reason' .* must be a member of REASON"),
        ('name="beacons"', 'name="uplink"', "the localizer has a machine 'uplink' already"),
        ('name="beacons"', 'name="of beacons"', "is no name for a source"),
        ("return Machine(", "return list[Machine](), dict(", "returned tuple; a source is a function"),
        ("vehicle.truth, ", "wrong.truth, ", "NameError"),
        ("world=vehicle.world({\"a range is true\": law})", "doc=''", "does not say where the vehicle is"),
    ],
)  # fmt: skip
def test_a_wrong_form_is_refused_with_file_and_line(old: str, new: str, said: str, tmp_path: Path) -> None:
    """What the localizer could not hear is said before anything is proved."""
    address = edited(tmp_path, old, new)
    if new == "doc=''":
        address = edited_without_lemma(tmp_path, address)
    with pytest.raises(InputError, match=f"wrong\\.py.*{said}"):
        load_target(f"alone+{address}")


def edited_without_lemma(folder: Path, address: str) -> str:
    """The same machine without a lemma, which would read the vehicle."""
    file = folder / "wrong.py"
    text = "\n".join(line for line in file.read_text(encoding="utf-8").splitlines() if "lemmas=" not in line)
    file.write_text(text, encoding="utf-8")
    return address


def test_names_are_those_of_no_other_machine() -> None:
    """Every machine of the localizer is among the names that are taken; one source twice is refused."""
    assert {machine.name for machine in compose_machines().machines} <= set(TAKEN)
    with pytest.raises(InputError, match="has a machine 'beacons' already"):
        load_target(f"alone+{BEACONS}:source+{BEACONS}:source")


@pytest.mark.parametrize(
    ("spec", "said"),
    [
        (f"localizer+{BEACONS}", "names no source; give FILE.py:NAME"),
        (f"localizer+{BEACONS}:sauce", "has no function 'sauce'"),
        (f"contract+{BEACONS}:SURVEY_MM", "has no function 'SURVEY_MM'"),
        (f"contract+{BEACONS}:source+{BEACONS}:source", "2 sources are given"),
    ],
)
def test_an_address_that_is_wrong(spec: str, said: str) -> None:
    """Told with what to give."""
    with pytest.raises(InputError, match=said):
        load_target(spec)


def test_what_is_verified_of_a_source() -> None:
    """Its contract, the localizer with it alone, and with all; a folder may have a plus in its name."""
    assert with_sources("localizer", ["a.py:one", "c++/b.py:two"]) == [
        "contract+a.py:one",
        "contract+c++/b.py:two",
        "alone+a.py:one+c++/b.py:two",
        "localizer+a.py:one+c++/b.py:two",
    ]
    assert sources_of("localizer+a.py:one+c++/b.py:two") == ["a.py:one", "c++/b.py:two"]
    assert sources_of("a.py:machine") == ["a.py:machine"]
    with pytest.raises(InputError, match="takes no source of your own"):
        with_sources("balise", ["a.py:one"])
