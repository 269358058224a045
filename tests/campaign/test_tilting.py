"""Importance sampling gives the probability that is known, with an interval that holds it and is narrower than that of plain sampling."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pydantic import TypeAdapter

from safeloc.campaign.aggregate import Results
from safeloc.campaign.counted import to_parquet
from safeloc.campaign.declaration import Campaign, parse_campaign
from safeloc.campaign.distributions import Distribution, Floats
from safeloc.campaign.scenes import check_strata, drawn_of
from safeloc.campaign.statistics import Estimate, proportion, tilted_share
from safeloc.campaign.tilting import Tilting
from safeloc.errors import InputError
from tests.campaign.declared import ON_VALLEY

RARE = 1.99
"""The event: a severity above it, of which one in 200 is declared."""
SEVERITY = 'front_wheel_severity = { distribution = "uniform", low = 0.0, high = 2.0, unit = "share" }\n'
TILT = '[situations.tilt]\nfront_wheel_severity = { distribution = "uniform", low = 1.9, high = 2.0, unit = "share" }\n'


def declared(**keys: object) -> Distribution:
    """A distribution as a file declares it."""
    made: Distribution = TypeAdapter(Distribution).validate_python({"unit": "share", **keys})
    return made


DECLARED = [
    declared(distribution="uniform", low=-1, high=4),
    declared(distribution="normal", mean=1, deviation=2, low=-1, high=4),
    declared(distribution="log-uniform", low=0.1, high=4),
]


@pytest.mark.parametrize("one", DECLARED, ids=lambda one: one.distribution)
def test_a_density_is_that_of_the_draws(one: Distribution) -> None:
    """It sums to 1, and below any value to the share of the draws that lie there."""
    assert not isinstance(one, type(None)) and hasattr(one, "density")
    low, high = one.support
    at = np.linspace(low, high, 20_001)[:-1] + (high - low) / 40_000
    sums = np.cumsum(one.density(at)) * (high - low) / 20_000
    assert sums[-1] == pytest.approx(1, abs=1e-4)
    draws = np.sort(one.draw(np.random.default_rng(1), 20_000))
    assert np.abs(np.interp(draws, at, sums) - np.arange(20_000) / 20_000).max() < 0.015
    assert one.density(np.array([low - 0.1, high + 0.1])).tolist() == [0, 0]


def estimated(seed: int, number: int) -> tuple[Estimate, Estimate]:
    """The probability that a standard normal value exceeds 4, by importance sampling and by plain sampling."""
    plain = declared(distribution="normal", mean=0, deviation=1, low=-8, high=8)
    tilting = Tilting(0.5, number, np.random.default_rng(seed))
    values = tilting.draw("x", plain, {"x": declared(distribution="normal", mean=4, deviation=0.5, low=-8, high=8)})
    counted: Floats = tilting.weights * (values > 4)
    assert tilting.weights.max() <= 2
    beyond = int((plain.draw(np.random.default_rng(seed), number) > 4).sum())
    return tilted_share(float(counted.sum()), float((counted**2).sum()), number, 2.0, 0.95), proportion(
        beyond, number, 0.95
    )


def test_the_estimate_of_a_known_probability() -> None:
    """3.167e-5: within 5 % on average, held by nearly every interval, which is far narrower than that of as many plain draws."""
    known, number = 3.1671e-5, 40_000
    found = [estimated(seed, number) for seed in range(60)]
    assert np.mean([tilted.value for tilted, _ in found]) == pytest.approx(known, rel=0.05)
    assert sum(tilted.low <= known <= tilted.high for tilted, _ in found) >= 57
    spread = [float(np.std([one.value for one in some])) for some in zip(*found, strict=True)]
    assert spread[0] < spread[1] / 10


def test_two_tilted_values_multiply_their_weights() -> None:
    """The corner in which both are great has probability 1 in 10 000; discrete values are weighed by their shares."""
    number, rng = 40_000, np.random.default_rng(3)
    tilting = Tilting(0.5, number, rng)
    even = declared(distribution="uniform", low=0, high=1)
    first = tilting.draw("first", even, {"first": declared(distribution="uniform", low=0.9, high=1)})
    rare = declared(distribution="choice", values=(1, 2), shares=(0.99, 0.01))
    second = tilting.draw("second", rare, {"second": declared(distribution="choice", values=(2,))})
    share = float((tilting.weights * ((first > 0.99) & (second == 2))).mean())
    assert share == pytest.approx(1e-4, rel=0.15)
    assert float(tilting.weights.mean()) == pytest.approx(1, rel=0.03)


def campaign(**changes: str) -> Campaign:
    """A campaign whose severity is declared, and in its second situation tilted."""
    text = ON_VALLEY.replace("[figures]\n", f"[figures]\n{SEVERITY}").replace("vehicles = 3", "vehicles = 3000")
    text = f"{text}{TILT}"
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    return parse_campaign(text, "c.toml")


def test_results_weigh_the_vehicles(tmp_path: Path) -> None:
    """Of what was drawn for a campaign: the known share in each stratum, the tilted one with an interval a fraction of the other's."""
    one = campaign()
    check_strata(one)
    (tmp_path / "shards").mkdir()
    for shard in one.shards:
        drawn = drawn_of(one, shard)
        event = (drawn.figures["front_wheel_severity"] > RARE).astype(np.int64)
        assert drawn.weights is not None
        none = np.zeros(drawn.vehicles, dtype=np.int64)
        columns = {f"{law}_{what}": none for law in ("kept", "broken") for what in ("contained", "silent", "wrong")}
        rows = {
            "row": "vehicle", "stratum": shard.stratum.number, "shard": shard.number, "vehicle": np.arange(drawn.vehicles), "cycles": none + 10,
            "told": none + 10, "before_first": none, **columns, "broken_wrong": event, "broken_contained": 10 - event, "weight": drawn.weights,
        }  # fmt: skip
        (tmp_path / "shards" / f"{shard.number}.parquet").write_bytes(to_parquet([rows]))
    data = Results(one, tmp_path).as_data()
    broken = data["answers"]["containment"][1]
    plain, tilted = broken["strata"]
    assert all(part["low"] <= 0.005 <= part["high"] for part in (plain, tilted, broken["whole"]))
    assert tilted["value"] == pytest.approx(0.005, rel=0.2)
    assert tilted["events"] > 5 * plain["events"]
    assert "importance sampling" in tilted["method"] and "importance sampling" in broken["whole"]["method"]
    assert "drawn towards what is rare" in tilted["says"]
    wrong = next(law for law in data["laws"] if (law["law"], law["interval"]) == ("law broken", "wrong interval"))
    assert wrong["strata"][1]["value"] == pytest.approx(0.0005, rel=0.2)
    assert data["answers"]["availability"][0]["strata"][1]["value"] == pytest.approx(1, abs=0.1)
    assert data["answers"]["width"][0]["strata"][1]["quantiles"] == []


REFUSED = {
    "beyond": ("low = 1.9, high = 2.0", "low = 1.9, high = 2.1", "leaves what is declared"),
    "name": ("[situations.tilt]\nfront_wheel", "[situations.tilt]\nrear_wheel", "nothing of this name is declared"),
    "kind": ('"uniform", low = 1.9, high = 2.0', '"choice", values = [1.9]', "tilt a choice by a choice"),
    "fixed": ('"uniform", low = 1.9, high = 2.0', '"fixed", value = 1.9', "a fixed value has no density"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_tilt_that_does_not_fit_is_refused(name: str) -> None:
    """With file, line and key."""
    old, new, says = REFUSED[name]
    with pytest.raises(InputError, match=r"^c\.toml:\d+: situations\.1\.tilt\..*") as refused:
        check_strata(campaign(**{old: new}))
    assert says in str(refused.value)


def test_a_tilted_time_of_a_fault_keeps_its_unit() -> None:
    """Times are tilted in the fault's own table."""
    tilt = 'lasts = { distribution = "fixed", value = 50, unit = "cycles" }\n'
    drawn = tilt.replace('"fixed", value = 50', '"uniform", low = 10, high = 50')
    rare = 'tilt = { lasts = { distribution = "uniform", low = 40, high = 50, unit = "s" } }\n'
    with pytest.raises(
        InputError,
        match=r"^c\.toml:\d+: situations\.1\.faults\.0\.tilt\.lasts: its unit is cycles, as declared, not 's'",
    ):
        check_strata(campaign(**{tilt: drawn + rare}))
    one = campaign(**{tilt: drawn + rare.replace('"s"', '"cycles"')})
    check_strata(one)
    lasted = [(fault.end or 0) - fault.begin for (fault,) in drawn_of(one, one.shards[-1]).faults]
    assert np.mean([length >= 40 for length in lasted]) == pytest.approx(0.5 + 0.5 * 10 / 40, abs=0.05)
