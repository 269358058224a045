"""Configurations hide no case: every case split of every shipped machine is live in one that is proved, or has a reason."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import pytest
from pydantic import ValidationError

from safeloc.assurance.source_places import place_of
from safeloc.assurance.splits import deciding as looking
from safeloc.assurance.splits.covered import (
    SHARED,
    Covered,
    configurations_of,
    covered,
    folder_of,
    hidden_in_shared_rooms,
    judge,
    targets_of,
    text_of,
)
from safeloc.assurance.splits.deciding import Change, changed, changes, deciding
from safeloc.assurance.splits.folded import cases_of, folded_cases
from safeloc.assurance.splits.live_splits import splits_of
from safeloc.assurance.splits.observed import Split
from safeloc.assurance.splits.places import source_of
from safeloc.config import Configurations
from safeloc.errors import InputError
from safeloc.models.emitter.variables import EmitterConfig
from safeloc.models.guard.variables import GuardConfig
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.satellite_selection.variables import SelectionConfig
from safeloc.shipped_machines import ENTRIES
from safeloc.target import Entry

FOLDERS = list(dict.fromkeys(map(folder_of, ENTRIES)))
QUICK = ("emitter", "transmission", "axle_counter", "delocalized", "guard")
REMEDY = """these case splits are folded away in every configuration, so no proof sees their other side:
{splits}
Declare a configuration in which they are live in models/{folder}/configurations.py (`safeloc list splits --machine {machine}`
names a figure that does it) and prove it (`safeloc prove {machine} --configurations all`); or write there, under NEVER, why
none can make them live."""


def _as_lines(splits: Iterable[Split]) -> str:
    return "\n".join(sorted({f"  {split.kind} at {split.place}: {text_of(split)}" for split in splits}))


def assert_nothing_hidden(found: Covered) -> None:
    """Fail with what to do."""
    assert not found.hidden, REMEDY.format(
        splits=_as_lines(found.hidden), folder=found.folder, machine=targets_of(found.folder)[0].name
    )
    assert found.idle == (), (
        f"reasons that nothing needs any more in models/{found.folder}/configurations.py: {found.idle}"
    )


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("folder", QUICK)
def test_the_configurations_of_a_machine_hide_no_case(folder: str) -> None:
    """Of the quick ones."""
    assert_nothing_hidden(covered(folder))


@pytest.mark.slow
def test_no_configuration_hides_a_case() -> None:
    """Of all machines, and of the rooms that several of them use; no reason is left over."""
    found = [covered(folder) for folder in FOLDERS]
    for one in found:
        assert_nothing_hidden(one)
    assert hidden_in_shared_rooms(found) == {}
    unused = {text_of(split) for one in found for split in one.shared}
    assert set(SHARED) <= unused


def alone(entry: Entry[Any]) -> Entry[Any]:
    """A machine that is proved in its defaults only."""
    return replace(entry, configurations=Configurations(never=entry.configurations.never))


def test_a_case_that_is_hidden_again_is_told() -> None:
    """Without the declared configuration the transition that the defaults leave out is hidden."""
    found = judge("emitter", [alone(ENTRIES["emitter"])])
    (split,) = found.hidden
    assert "branch where it fails" == split.kind
    assert "own.config.passes_to_recover > 1" == source_of(split.place)
    with pytest.raises(AssertionError, match=r"in models/emitter/configurations\.py"):
        assert_nothing_hidden(found)


def test_hidden_cases_are_counted() -> None:
    """A case that no configuration makes live is told once, with the figure that would; one that is live somewhere is not hidden."""
    (hidden,) = cases_of(judge("emitter", [alone(ENTRIES["emitter"])]))
    assert hidden.is_hidden
    assert hidden.live.startswith("live in no configuration; passes_to_recover = ")
    assert [False] == [case.is_hidden for case in folded_cases(["emitter"])]


def test_cases_of_an_unknown_machine() -> None:
    """A user's own machine has none that are looked for."""
    with pytest.raises(InputError, match=r"^no shipped machine 'own\.py:machine'; cases are looked for in odometry, "):
        folded_cases(["own.py:machine"])


def test_a_reason_that_nothing_needs_is_told() -> None:
    """It would hide the next case of that name."""
    entry = ENTRIES["emitter"]
    more = replace(entry.configurations, never={"models/emitter/__init__.py: gone": "a reason"})
    found = judge("emitter", [replace(entry, configurations=more)])
    assert found.idle == ("models/emitter/__init__.py: gone",)


def kinds(folder: str, config: object) -> dict[str, str]:
    """What is dead, with why."""
    entry = targets_of(folder)[0]
    splits = splits_of(lambda: entry.make(config))  # type: ignore[arg-type]
    return {f"{split.kind} {source_of(split.place)}": why for split, why in splits.dead.items()}


def test_acceleration_and_brake_alike_make_a_choice_idle() -> None:
    """The guard's defaults: whichever way the vehicle goes, its speed changes alike; with another brake it does not."""
    choice = "choice ite(box.slow >= 0, as_num(gain, UM_S), change)"
    assert "both branches are alike" == kinds("guard", GuardConfig())[choice]
    assert choice not in kinds("guard", GuardConfig(brake_mm_s2=2_500))


@pytest.mark.thorough
def test_an_offset_of_zero_makes_a_charge_idle() -> None:
    """The reflector's radar at the front end; behind it the offset is in the terms."""
    charges = {one for one in kinds("reflector", ReflectorConfig()) if "radar_offset" in one or "offset_mm" in one}
    assert len(charges) > 4
    assert charges.isdisjoint(kinds("reflector", ReflectorConfig(radar_offset_mm=2_500)))


def test_ranges_decide_a_comparison() -> None:
    """An age that has the limit as its range."""
    found = kinds("transmission", ENTRIES["transmission"].config())
    assert ["the ranges of its variables decide it"] == [*found.values()]


def test_the_figure_that_decides_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the changes of single figures the one that makes the hidden case live."""
    entry, config = ENTRIES["emitter"], EmitterConfig()
    tried = [Change("window_cycles", 5), Change("passes_to_recover", 101), Change("passes_to_recover", 1)]
    monkeypatch.setattr(looking, "changes", lambda _: iter(tried))
    dead = splits_of(lambda: entry.make(config))
    assert [Change("passes_to_recover", 1)] == [*deciding(entry, config, dead).values()]


def test_every_figure_is_changed() -> None:
    """Flags, names and numbers, within their ranges, also of what is inside; the change is told in words."""
    found = [*changes(SelectionConfig())]
    assert {"doppler", "pseudorange"} == {one.value for one in found if one.figure == "compared"}
    assert {1, 3, 4, 1_000} == {one.value for one in found if one.figure == "warm_up_cycles"}
    assert "odometer.rate_ppm = 1000000" in [str(one) for one in changes(ReflectorConfig())]
    assert changed(SelectionConfig(), Change("removal", "both")) == SelectionConfig(removal="both")
    with pytest.raises(ValidationError):
        changed(SelectionConfig(), Change("warm_up_cycles", 0))


def test_declared_configurations_are_no_defaults() -> None:
    """Each changes a figure, and no two of a machine are the same."""
    for entry in ENTRIES.values():
        every = [config.model_dump_json() for config in configurations_of(entry).values()]
        assert len(set(every)) == len(every), entry.name


def test_equal_code_of_two_files_has_two_places() -> None:
    """Python compares code without its file, and two machines may have the same expression in the same line."""
    here = alone.__code__
    there = here.replace(co_filename="elsewhere.py")
    assert here == there
    assert (here.co_filename, "elsewhere.py") == (place_of(here, 0).file, place_of(there, 0).file)
