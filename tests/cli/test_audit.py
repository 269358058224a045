"""`safeloc audit`: lines for people, JSON for programs, and the exit code."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.railway.map.toml_files import find_line, to_toml
from tests.cli.calling import Call
from tests.railway.map.made import group, straight


@pytest.mark.parametrize("name", ["fig1", "fig2", "fig3"])
def test_the_worked_examples_hold(call: Call, name: str) -> None:
    """Exit code 0, and a count of what was checked."""
    called = call("audit", name)
    assert (0, "") == (called.code, called.err)
    assert ", 0 violated, 0 advice" in called.out.splitlines()[-1]


def test_figure_3_tells_its_routes(call: Call) -> None:
    """DCD as a suffix of ADCD, and ADCD with one miss as ACD."""
    printed = call("audit", "fig3").out
    assert "ADCD / DCD: by models alone ADCD looks like DCD after 1; " in printed
    assert "DCD is a suffix of ADCD" in printed
    assert "ADCD / ACD: by models alone ADCD looks like ACD after 1; with distances and balises ADCD looks like ACD " \
        "after 2" in printed  # fmt: skip


def test_a_broken_rule_ends_in_1(call: Call, tmp_path: Path) -> None:
    """The finding is printed with place, kilometre and figures; JSON says the same."""
    path = tmp_path / "own.toml"
    path.write_text(to_toml(find_line("fig1")).replace("length_mm = 1000000", "length_mm = 1400000"), encoding="utf-8")
    called = call("audit", str(path))
    assert 1 == called.code
    assert "violated  odometry stretch [RFL-D1] from reflector 111 (B) to the end of the map" in called.out
    (told,) = json.loads(call("audit", str(path), "--json").out)
    (finding,) = told["findings"]
    assert (False, "safeloc-audit/1") == (told["holds"], told["schema"])
    assert {"edge": "103", "position_mm": 1_400_000} == finding["place"]
    assert {"what": "distance", "actual": 543_000, "relation": "<=", "required": 464_981, "unit": "mm"} == finding[
        "figures"
    ]


def test_findings_are_folded_by_rule_and_ordered_by_weight(call: Call, tmp_path: Path) -> None:
    """The stretches that are farthest from what is required come first, five of them; `--all` prints the others too."""
    path = tmp_path / "long.toml"
    lengths = [600_000, 900_000, 700_000, 1_200_000, 800_000, 650_000, 1_000_000]
    groups = tuple(group(number, f"e{number}", 0) for number in range(1, len(lengths)))
    path.write_text(to_toml(straight(*lengths, balise_groups=groups)), encoding="utf-8")
    lines = call("audit", str(path)).out.splitlines()
    stretches = [line for line in lines if "odometry stretch [" in line]
    figures = [float(line.split("distance ")[1].split()[0]) for line in stretches]
    assert 5 == len(figures) and sorted(figures, reverse=True) == figures and 1_200 == figures[0]
    assert f"{'':9} odometry stretch: {len(lengths) - 5} more, none of them farther from what is required" in lines
    every = [line for line in call("audit", str(path), "--all").out.splitlines() if "odometry stretch [" in line]
    assert len(lengths) == len(every) and stretches == every[:5]
    (told,) = json.loads(call("audit", str(path), "--json").out)
    assert [1_200_000, 1_000_000] == [one["figures"]["actual"] for one in told["findings"]][:2]


def test_the_vehicle_counts(call: Call, tmp_path: Path) -> None:
    """The same line is fine for one vehicle and not for another."""
    path = tmp_path / "coarse.toml"
    path.write_text("[localization]\nodometry_rate_ppm = 100_000\n", encoding="utf-8")
    assert 0 == call("audit", "fig3", "--vehicle", "metro").code
    assert 1 == call("audit", "fig3", "--vehicle", str(path)).code


def test_a_line_has_to_suit_every_vehicle_on_it(call: Call, tmp_path: Path) -> None:
    """Several vehicles on one line are audited one by one; one that it does not suit decides (RFL-15)."""
    path = tmp_path / "coarse.toml"
    path.write_text("[localization]\nodometry_rate_ppm = 100_000\n", encoding="utf-8")
    assert 0 == call("audit", "fig3", "--vehicle", "metro", "--vehicle", "freight-v90").code
    called = call("audit", "fig3", "--json", "--vehicle", "metro", "--vehicle", str(path))
    told = {report["vehicle"]: report["holds"] for report in json.loads(called.out)}
    assert (1, {"metro": True, str(path): False}) == (called.code, told)


def test_wrong_input_ends_in_2(call: Call, tmp_path: Path) -> None:
    """Unknown line, broken file, unknown vehicle: one message, no traceback."""
    broken = tmp_path / "broken.toml"
    broken.write_text(
        to_toml(find_line("fig1")).replace('from_node = "west"', 'from_node = "nowhere"'), encoding="utf-8"
    )
    for arguments, told in (
        (("nowhere",), "safeloc: nowhere: no such file, and no shipped line"),
        ((str(broken),), "there is no node 'nowhere'"),
        (("fig1", "--vehicle", "x"), "safeloc: x: no such file, and no shipped vehicle"),
    ):
        called = call("audit", *arguments)
        assert (2, "") == (called.code, called.out)
        assert told in called.err


def test_shipped_lines_are_listed(call: Call) -> None:
    """Names that `audit` takes, with where the lines come from."""
    assert "fig3  1  ES 2 657 990 T3, Fig. 3; lengths chosen" in call("list", "lines").out.splitlines()
