"""The machines that ship are found in their folders, in a stated order, with what a host has to know of each."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from safeloc import shipped_machines
from safeloc.catalogue import load_target
from safeloc.errors import InputError, ModelError
from safeloc.models.delocalized import DelocalizedConfig
from safeloc.models.localizer import LocalizerConfig
from safeloc.shipped_machines import ENTRIES, folders
from safeloc.target import Entry, Family
from tests.shipped import shipped

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "docs" / "examples" / "beacons.py"


def test_a_machine_is_found_without_the_others() -> None:
    """Asked for by the name of its folder it is imported alone, and is the same entry afterwards."""
    code = """
import sys
from safeloc.shipped_machines import ENTRIES
one = ENTRIES["axle_head"]
print(sorted(name for name in sys.modules if name.startswith("safeloc.models.") and name.endswith(".target")))
print("no machine" in ENTRIES, len(ENTRIES), ENTRIES["axle_head"] is one, dict(ENTRIES)["axle_head"] is one)
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ["['safeloc.models.axle_head.target']", f"False {len(ENTRIES)} True True"] == ran.stdout.splitlines()


def test_every_folder_with_a_target_is_in_the_catalogue() -> None:
    """Two folders declare two machines; a folder without target.py is shared by others and declares none."""
    assert sorted(path.parent.name for path in (ROOT / "models").glob("*/target.py")) == folders()
    assert sorted({entry.folder for entry in ENTRIES.values()}) == folders()
    assert "vocabulary" not in folders()
    assert ["verification", "verification_doubted"] == [
        name for name, entry in ENTRIES.items() if entry.folder == "verification"
    ]


def test_the_order_is_stated() -> None:
    """By family, place and name: no two shipped machines of a family share a place."""
    places = [(list(Family).index(entry.family), entry.place, entry.name) for entry in ENTRIES.values()]
    assert sorted(places) == places
    assert len(places) == len({place[:2] for place in places})


def with_folders(monkeypatch: pytest.MonkeyPatch, **declared: object) -> None:
    """The catalogue as it would be with these folders, each with what its target.py calls ENTRIES."""
    monkeypatch.setattr(shipped_machines, "folders", lambda: list(declared))
    monkeypatch.setattr(
        shipped_machines,
        "import_module",
        lambda name: SimpleNamespace(__file__=f"{name}.py", ENTRIES=declared[name.split(".")[2]]),
    )


def test_a_machine_without_a_place_comes_last_in_its_family(monkeypatch: pytest.MonkeyPatch) -> None:
    """Several of them are in order of their names, whatever their folders are called."""
    one, two = (
        Entry(name, "", DelocalizedConfig, ENTRIES["delocalized"].maker, Family.ODOMETRY) for name in ("b", "a")
    )
    with_folders(monkeypatch, u=(ENTRIES["balise"],), v=(one,), w=(two,), x=(ENTRIES["delocalized"],))
    assert ["delocalized", "a", "b", "balise"] == list(shipped_machines.found())


def test_a_name_that_two_folders_declare_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The message names both."""
    with_folders(monkeypatch, first=(ENTRIES["emitter"],), second=(replace(ENTRIES["emitter"], place=1),))
    with pytest.raises(ModelError, match=r"^models/first and models/second both declare a machine 'emitter'\.$"):
        shipped_machines.found()


@pytest.mark.parametrize("wrong", [None, (), [ENTRIES["emitter"]], ("emitter",)])
def test_a_target_that_declares_no_entry_is_refused(wrong: object, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise a machine would be missing in silence."""
    with_folders(monkeypatch, lamp=wrong)
    with pytest.raises(ModelError, match=r"^safeloc\.models\.lamp\.target\.py: ENTRIES is .*; declare a tuple of entr"):
        shipped_machines.found()


def test_a_configuration_of_another_machine_is_refused() -> None:
    """By name of both classes, before anything is made of it."""
    with pytest.raises(InputError, match=r"^emitter takes a EmitterConfig, got DelocalizedConfig\.$"):
        ENTRIES["emitter"].make(DelocalizedConfig())


# ------------------------------------------------------------------ for hosts


@pytest.mark.parametrize("name", ENTRIES)
def test_what_hosts_are_told_is_there(name: str) -> None:
    """In its defaults a target has every machine and every input that its entry names; a wrong name would be passed over."""
    target, entry = shipped(name), ENTRIES[name]
    assert entry.silent == target.silent
    assert entry.records_of == target.input_of_record


def test_a_localizer_with_fewer_sources_has_fewer_silent_machines() -> None:
    """Machines and inputs that a configuration leaves out are not named."""
    target = ENTRIES["localizer"].make(LocalizerConfig(sources=("odometry", "balise")))
    assert set(target.silent) <= {machine.name for machine in target.machines}
    assert len(target.silent) < len(ENTRIES["localizer"].silent)


def test_a_users_source_is_silent_under_no_name(tmp_path: Path) -> None:
    """Of one that is called as a shipped machine nothing was proved."""
    path = tmp_path / "own.py"
    text = SOURCE.read_text(encoding="utf-8")
    assert 'name="beacons"' in text
    path.write_text(text.replace('name="beacons"', 'name="emitter"'), encoding="utf-8")
    target: Any = load_target(f"contract+{path}:source")
    assert ("emitter", ()) == (target.name, target.silent)
