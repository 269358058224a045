"""The wiring of areas is refused with file, line and key, or it fits the machine."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.language.interpret import start
from safeloc.models.area import AreaConfig
from safeloc.models.sections import SectionsConfig
from safeloc.railway.trackside.wiring import load_wiring
from safeloc.runtime.service.broker.settings import read_broker
from safeloc.runtime.service.broker.topics import partition_of
from tests.railway.trackside.areas import END_MM, config, wired, wiring_text

RIGHT = wiring_text()
PAGE = Path(__file__).resolve().parents[3] / "docs" / "trackside.md"


def test_what_it_says(tmp_path: Path) -> None:
    """Places become first values; all vehicles may come where none is named."""
    wiring = wired(tmp_path)
    first = wiring.file.areas["west"].first
    assert (first["area.low_end_mm"], first["area.high_end_mm"], first["section_6.to_mm"]) == (0, END_MM, END_MM)
    assert first["area.inner_2_from_mm"] == END_MM // 2 + 1
    assert list(wiring.vehicles_of("west")) == ["a", "b", "c"]
    assert list(wired(tmp_path, f'{RIGHT}vehicles = ["b"]\n').vehicles_of("west")) == ["b"]


FLAWS = {
    "unknown key": (("clock_error_ms", "clock_eror_ms"), r"areas\.toml:\d+: clock_e"),
    "no length": (("length_mm = 120000\n", ""), r"areas\.toml:5: vehicles\.a\.length_mm"),
    "length of a wrong kind": (("length_mm = 120000", "length_mm = 1.5"), r"areas\.toml:6: vehicles\.a\.length_mm"),
    "ends out of order": (
        ("high_end_mm = 3000000", "high_end_mm = -1"),
        r"areas\.toml:18: areas\.west\.low_end_mm: the",
    ),
    "a section outside": (
        ("[0, 500000]", "[-1, 500000]"),
        r"areas\.toml:20: areas\.west\.sections_mm\.0: \[-1, 500000\]",
    ),
    "too few sections": (
        ("[0, 500000], ", ""),
        r"areas\.toml:20: .*5 stretches, but the configuration has sections = 6",
    ),
    "no inner detection": (("inner_mm", "# "), r"areas\.toml:17: .*has area.inner_detection = 2"),
    "inner detection backwards": (("[[0, 1500000]", "[[9, 1]"), r"areas\.toml:21: areas\.west\.inner_mm\.0"),
    "inner detection outside": (
        ("[[0, 1500000]", "[[-9, 1500000]"),
        r"areas\.toml:21: areas\.west\.inner_mm\.0: .*within the area",
    ),
    "overlapping sections": (
        ("[500000, 1000000]", "[400000, 1000000]"),
        r"areas\.toml:20: areas\.west\.sections_mm\.1: section_1 \[0, 500000\] and section_2 \[400000, 1000000\] overlap "
        r"in \[400000, 500000\]",
    ),
    "a section within another": (
        ("[500000, 1000000]", "[600000, 700000]"),
        r"areas\.toml:20: .*sections_mm\.1: between section_1 \[0, 500000\] and section_2 \[600000, 700000\], \[500000, 600000\]",
    ),
    "one section twice": (
        ("[500000, 1000000]", "[0, 500000]"),
        r"areas\.toml:20: .*sections_mm\.1: section_1 .* and section_2 .* overlap in \[0, 500000\]",
    ),
    "a gap of a millimetre": (
        ("[500000, 1000000]", "[500001, 1000000]"),
        r"areas\.toml:20: .*section_1 \[0, 500000\] and section_2 .* \[500000, 500001\] belongs to no section; .*"
        r"without_section_mm = \[\[500000, 500001\]\]",
    ),
    "a gap at the low end": (
        ("[0, 500000]", "[1, 500000]"),
        r"areas\.toml:20: .*sections_mm\.0: between low_end_mm 0 and section_1 \[1, 500000\], \[0, 1\] belongs to no section",
    ),
    "a gap at the high end": (
        ("[2500000, 3000000]", "[2500000, 2999000]"),
        r"areas\.toml:20: .*sections_mm\.5: between section_6 .* and high_end_mm 3000000, .* belongs to no section",
    ),
    "a named gap where a section is": (
        ("inner_mm", "without_section_mm = [[0, 9]]\ninner_mm"),
        r"areas\.toml:20: .*sections_mm\.0: without_section_mm\.0 \[0, 9\] and section_1 \[0, 500000\] overlap",
    ),
    "a named gap outside": (
        ("inner_mm", "without_section_mm = [[-9, 0]]\ninner_mm"),
        r"areas\.toml:21: areas\.west\.without_section_mm\.0: .*within the area",
    ),
    "old reports only": (("error_ms = 50", "error_ms = 1000"), r"areas\.toml:3: clock_error_ms: 1000 ms is no less"),
    "a prefix with a wildcard": (('fleet = "fleet"', 'fleet = "#"'), r"areas\.toml:1: fleet"),
    "no TOML": (("fleet =", "fleet"), r"areas\.toml: not TOML"),
    "no area": ((RIGHT[RIGHT.index("[areas") :], "[areas]\n"), r"areas\.toml:17: areas"),
}


@pytest.mark.parametrize("flaw", FLAWS)
def test_flaws(tmp_path: Path, flaw: str) -> None:
    """Each names its line."""
    (old, new), why = FLAWS[flaw]
    assert RIGHT.count(old) == 1
    with pytest.raises(InputError, match=why):
        wired(tmp_path, RIGHT.replace(old, new))


def test_a_gap_that_is_meant(tmp_path: Path) -> None:
    """It is named, and it is the gap; the sections may come in any order."""
    right = RIGHT.replace("[[0, 500000], [500000, 1000000]", "[[600000, 1000000], [0, 500000]")
    named = right.replace("inner_mm", "without_section_mm = [[500000, 600000]]\ninner_mm")
    assert "section_2.to_mm" in wired(tmp_path, named).file.areas["west"].first
    with pytest.raises(InputError, match=r"\[599999, 600000\] belongs to no section"):
        wired(tmp_path, named.replace("[[500000, 600000]]", "[[500000, 599999]]"))


def test_each_section_on_a_line_of_its_own(tmp_path: Path) -> None:
    """The line of the section is named, also behind a comment with a bracket."""
    text = RIGHT.replace("[500000, 1000000]", "# ], [\n  [500001, 1000000]")
    with pytest.raises(InputError, match=r"areas\.toml:21: areas\.west\.sections_mm\.1: "):
        wired(tmp_path, text)
    with pytest.raises(InputError, match=r"areas\.toml:23: areas\.west\.vehicles: z is not"):
        wired(tmp_path, f'{text.replace("500001", "500000")}vehicles = ["z"]\n')


def test_an_output_that_cannot_be_one(tmp_path: Path) -> None:
    """Integrity would never be confirmed, and nobody would know why."""
    with pytest.raises(InputError, match=r"areas\.toml:\d+: vehicles\.\w+\.whole"):
        wired(tmp_path, RIGHT.replace('whole = "whole"', 'whole = "no such"', 1))


def test_a_vehicle_that_is_not_there(tmp_path: Path) -> None:
    """An area names vehicles of the file only, each once."""
    with pytest.raises(InputError, match=r"areas\.toml:22: areas\.west\.vehicles: a is named twice"):
        wired(tmp_path, f'{RIGHT}vehicles = ["a", "a"]\n')
    with pytest.raises(InputError, match=r"areas\.toml:22: areas\.west\.vehicles: z is not among the vehicles"):
        wired(tmp_path, f'{RIGHT}vehicles = ["a", "z"]\n')


def test_counters_know_no_vehicle(tmp_path: Path) -> None:
    """An area whose borders count cannot be fed so: nobody knows which vehicle was counted."""
    (tmp_path / "areas.toml").write_text(RIGHT, encoding="utf-8")
    counted = SectionsConfig(area=AreaConfig(trains=2, inner_detection=2), sections=config().sections)
    with pytest.raises(InputError, match="counters do not know which vehicle they count"):
        load_wiring(tmp_path / "areas.toml", counted)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    """It is named."""
    with pytest.raises(InputError, match=r"absent\.toml"):
        load_wiring(tmp_path / "absent.toml", config())


def test_the_page_says_how(tmp_path: Path) -> None:
    """Configuration and wiring of docs/trackside.md fit each other, and the machine begins with them."""
    page = PAGE.read_text(encoding="utf-8")
    machine, wiring, _ = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    for name, text in (("sections.toml", machine), ("areas.toml", wiring)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    target = load_target("sections", tmp_path / "sections.toml")
    assert isinstance(target.config, SectionsConfig)
    found = load_wiring(tmp_path / "areas.toml", target.config)
    assert f"areas/records/{partition_of('west', 16)}/west" in page
    values = start(target.system, {**found.file.areas["west"].first})
    assert values


def test_the_page_shows_the_brokers_file(tmp_path: Path) -> None:
    """It can be read whole: partitions of the shown topic, the key of the codes, and the certificates for TLS."""
    _, _, text = re.findall(r"```toml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    path = tmp_path / "broker.toml"
    path.write_text(text, encoding="utf-8")
    (tmp_path / "report.key").write_bytes(bytes(range(32)))
    found = read_broker("mqtt://localhost/areas", path, {})
    assert (16, 5.0, "areas") == (found.partitions, found.lease_s, found.prefix)
    assert found.codes is not None
    with pytest.raises(InputError, match=r"broker-cert\.pem"):
        read_broker("mqtts://broker.example:8884/areas", path, {})
