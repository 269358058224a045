"""A campaign's file is refused with file, line and key for whatever is wrong in it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from safeloc.campaign.declaration import load_campaign, parse_campaign
from safeloc.campaign.scenes import check_strata
from safeloc.errors import InputError
from tests.campaign.declared import ON_VALLEY, SMALL

WRONG = {
    "unknown distribution": ('"choice", values', '"poisson", values', r"c\.toml:6: figures\.top_share: there is no distribution 'poisson'; there are fixed, uniform, "),
    "misspelt distribution": ('"choice", values', '"choise", values', r"there is no distribution 'choise'.* Did you mean 'choice'\?$"),
    "misspelt machine": ('machine = "odometry"', 'machine = "odometrie"', r"drives no odometrie .* Did you mean 'odometry'\?"),
    "wrong unit": ('1.0], unit = "share"', '1.0], unit = "mm"', r"c\.toml:6: figures\.top_share: its unit is share, not 'mm'"),
    "wrong unit of a time": ('20, unit = "s"', '20, unit = "m"', r"c\.toml:26: .*begin: its unit is cycles, ms or s, not 'm'"),
    "no unit": ('1.0], unit = "share"', "1.0]", r"c\.toml:6: .*unit: Field required"),
    "unknown figure": ("top_share", "top_speed", r"c\.toml:6: figures\.top_speed: there is no such figure; there are top_share"),
    "value out of range": ("[0.9, 1.0]", "[0.9, 1.5]", r"c\.toml:6: .*leaves the range 0\.05 to 1 share"),
    "a figure of single values": (
        '{ distribution = "choice", values = [0.9, 1.0]', '{ distribution = "uniform", low = 0.8, high = 1.0',
        r"c\.toml:6: .*give a fixed value or a choice",
    ),
    "not a number": ("values = [0.9, 1.0]", "values = [0.9, nan]", r"c\.toml:6: .*finite"),
    "shares": ("values = [0.9, 1.0]", "values = [0.9, 1.0], shares = [0.5, 0.6]", r"c\.toml:6: .*shares sum to 1\.1"),
    "weights": ("weight = 0.75", "weight = 0.7", r"c\.toml:\d\d: the weights of the situations sum to 0\.95; they must sum to 1 \(c\.toml:\d\d, c\.toml:\d\d\)"),
    "unknown key": ("cycles = 600", "cycels = 400", r"c\.toml:.*(cycels|cycles)"),
    "unknown fault": ('"slide"', '"glide"', r"c\.toml:24: .*kind: .*no such fault; it has .*slide"),
    "unknown place": ('"front_wheel"', '"front_whel"', r"c\.toml:25: .*nothing named 'front_whel' can be faulty; there are front_wheel"),
    "a fault after the run": ("high = 20", "high = 60", r"c\.toml:26: .*may begin after the run of 600 cycles"),
    "unknown line": ('"valley"', '"valey"', r"c\.toml:8: lines\.0: valey: no such file.*valley"),
    "unknown machine": ('"odometry"', '"odometrie"', r"c\.toml:.*odometrie"),
    "one name twice": ('"no fault"', '"the front wheel slides"', r"c\.toml:\d\d: two situations have one name, .*; each needs a name of its own \(c\.toml:\d\d, c\.toml:\d\d\)"),
    "not TOML": ("cycles = 600", "cycles = ", r"c\.toml: not TOML"),
    "unit of a fault's figure": (
        'kind = "slide"', 'figures.by_mm = { distribution = "fixed", value = 9000, unit = "m" }\nkind = "jump"',
        r"c\.toml:2\d: .*figures\.by_mm: its unit is mm, not 'm'",
    ),
    "a time of a fault without one": (
        'machine = "odometry"', 'machine = "balise"', r"c\.toml:2\d: .*where: nothing named 'front_wheel' can be faulty",
    ),
    "empty distribution": ("low = 10", "low = 20", r"c\.toml:26: .*low 20 is not below high 20"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_is_refused_with_its_line(case: str) -> None:
    """The message names file, line and key, and what there is instead."""
    old, new, message = WRONG[case]
    assert old in ON_VALLEY
    with pytest.raises(InputError, match=message):
        check_strata(parse_campaign(ON_VALLEY.replace(old, new, 1), "c.toml"))


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    """As any other file."""
    with pytest.raises(InputError, match=re.escape(str(tmp_path / "none.toml"))):
        load_campaign(tmp_path / "none.toml")


def test_strata_and_shards_follow_the_file() -> None:
    """Every situation on every line with every kind of vehicle; weights multiply; the last shard holds what is left."""
    text = ON_VALLEY.replace(
        '[[vehicles]]\nvehicle = "desiro-br642"',
        '[[vehicles]]\nvehicle = "desiro-br642"\nweight = 0.8\n[[vehicles]]\nvehicle = "metro"\nweight = 0.2',
    ).replace("\nvehicles = 3", "\nvehicles = 4", 1)
    campaign = parse_campaign(text, "c.toml")
    assert [0.6, 0.15, 0.2, 0.05] == pytest.approx([one.weight for one in campaign.strata])
    assert "no fault, line valley, metro" == campaign.words_of(campaign.strata[1])
    assert [(0, 3), (3, 4), (0, 3), (3, 4), (0, 3), (0, 3)] == [(one.first, one.end) for one in campaign.shards]
    assert list(range(6)) == [one.number for one in campaign.shards]


def test_a_machine_without_simulation_is_refused() -> None:
    """There is nothing to run."""
    with pytest.raises(InputError, match=r"c\.toml:1: machine: arbitration has no simulation"):
        check_strata(parse_campaign(SMALL.replace(SMALL.splitlines()[0], 'machine = "arbitration"'), "c.toml"))


def test_a_fault_that_takes_no_time_is_refused_with_one() -> None:
    """A balise group has its fault for the whole run."""
    text = ON_VALLEY.replace('"odometry"', '"balise"').replace('"front_wheel"', "3").replace('"slide"', '"late"')
    with pytest.raises(InputError, match=r"c\.toml:26: .*begin: a fault of 3 acts for the whole run; leave begin out"):
        check_strata(parse_campaign(text, "c.toml"))


def test_a_number_in_quotes_is_no_group() -> None:
    """Groups have numbers; the message says how to write one."""
    text = ON_VALLEY.replace('"odometry"', '"balise"').replace('"front_wheel"', '"3"').replace('"slide"', '"late"')
    with pytest.raises(InputError, match=r"c\.toml:25: .*nothing named '3' can be faulty; .* Write where = 3\.$"):
        check_strata(parse_campaign(text, "c.toml"))
