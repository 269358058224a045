"""Results of a campaign from its shards: DuckDB counts, and each count gives an estimate with its interval."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import duckdb

from safeloc.campaign.counted import SHARE_UNITS
from safeloc.campaign.declaration import Campaign, Stratum
from safeloc.campaign.scenes import scene_of
from safeloc.campaign.shards import FOLDER
from safeloc.campaign.statistics import (
    Estimate,
    Part,
    mean_share,
    proportion,
    quantile_ranks,
    rule_of_three,
    shared_confidence,
    stratified,
    tilted_share,
    weighted_mean,
)
from safeloc.language.units import NM_PER_MM
from safeloc.report.campaign_pictures import Spread, Stretch

_LAWS = {"kept": "law kept", "broken": "law broken"}
_STANDINGS = {"contained": "contained", "silent": "nothing reported", "wrong": "wrong interval"}
_QUANTILES = (0.5, 0.95, 0.99)
_SHARE_TOLD = "case when cycles > before_first then told / (cycles - before_first) else 0 end"

_READ_ONCE = """create table rows_ as select * from (
    select * from {files} where row = 'vehicle'
    union all by name
    select row, name, stratum, x, y, sum(cycles)::bigint as cycles, sum(vehicles)::bigint as vehicles, sum(told)::bigint as told,
        sum(width_sum_mm)::bigint as width_sum_mm, max(widest_mm) as widest_mm, sum(reporting)::bigint as reporting,
        sum(share_sum)::bigint as share_sum, sum(share_squares)::hugeint as share_squares,
        sum(mean_sum)::bigint as mean_sum, sum(mean_squares)::hugeint as mean_squares
    from {files} where row <> 'vehicle' group by all
) order by stratum"""
"""The vehicles, and the counts of all shards together: there are some hundred questions for each stratum, and thousands of files."""


class Results:
    """The results of a campaign, from the files of its shards."""

    def __init__(self, campaign: Campaign, folder: Path) -> None:
        self._campaign, self._folder = campaign, folder
        self._db = duckdb.connect()
        files = str(folder / FOLDER / "*.parquet").replace("'", "''")
        self._db.execute(_READ_ONCE.format(files=f"read_parquet('{files}')"))
        self._confidence = campaign.declared.confidence

    def as_data(self) -> dict[str, Any]:
        """Return the results as plain data (schema safeloc-campaign/1)."""
        declared = self._campaign.declared
        found: dict[str, Any] = {
            "schema": "safeloc-campaign/1",
            "machine": declared.machine,
            "file": self._campaign.name,
            "seed": declared.seed,
            "confidence": declared.confidence,
            "cycles_of_each_vehicle": declared.cycles,
            "vehicle_cycles": self._one("select sum(cycles) from rows_ where row = 'vehicle'"),
            "strata": [self._stratum(one) for one in self._campaign.strata],
            "laws": self._laws(),
            "clauses": self._clauses(),
        }
        answers: dict[str, Callable[[], list[dict[str, Any]]]] = {
            "containment": self._containment,
            "availability": self._availability,
            "width": self._width,
            "time to withdraw": lambda: self._times("withdrawn_after", "a fault begins"),
            "reaction": lambda: self._times("reaction", "a law is broken"),
        }
        found["answers"] = {question: answers[question]() for question in declared.questions}
        return found

    # -------------------------------------------------------------- what was run

    def _stratum(self, stratum: Stratum) -> dict[str, Any]:
        scene = scene_of(self._campaign, stratum)
        declared = self._campaign.figures_of(stratum)
        figures = {
            name: declared[name][0].words if name in declared else f"{one.default:g} {one.unit}"
            for name, one in scene.simulation.figures.items()
        }
        situation = self._campaign.situation_of(stratum)
        figures |= {f"{name}, tilted": one.words for name, one in situation.tilt.items()}
        faults = []
        for fault in situation.faults:
            begin = fault.begin.words if fault.begin else "the start"
            lasts = f"lasts {fault.lasts.words}" if fault.lasts else "lasts to the end"
            more = [f"{name} {one.words}" for name, one in fault.figures.items()]
            more += [f"tilted: {name} {one.words}" for name, one in fault.tilt.items()]
            faults.append("; ".join([f"{fault.kind} of {fault.where or 'all'}", f"begins at {begin}", lasts, *more]))
        return {
            "name": self._campaign.words_of(stratum),
            "weight": stratum.weight,
            "vehicles": stratum.vehicles,
            "figures": figures,
            "faults": faults,
            "tilted": situation.tilted if self._tilted(stratum) else None,
            "period_ms": scene.simulation.period_ms,
        }

    # -------------------------------------------------------------- the questions

    def _containment(self) -> list[dict[str, Any]]:
        return [
            self._share_of_vehicles(f"{law}_wrong > 0", f"vehicles with a wrong interval, {words}")
            for law, words in (("kept", "every law kept until then"), ("broken", "after a law was broken"))
        ]

    def _share_of_vehicles(self, event: str, what: str) -> dict[str, Any]:
        """Return the share of vehicles with an event: in the whole, and in each stratum."""
        rows = self._all(
            f"select stratum, count(*) filter (where {event}), count(*), coalesce(sum(weight) filter (where {event}), 0), "
            f"coalesce(sum(weight * weight) filter (where {event}), 0) from rows_ where row = 'vehicle' group by stratum"
        )
        events = {stratum: rest for stratum, *rest in rows}
        strata = self._campaign.strata

        def share(one: Stratum, confidence: float) -> Estimate:
            count, trials, total, squares = events[one.number]
            greatest = self._campaign.situation_of(one).greatest_weight
            if greatest is None:
                return proportion(count, trials, confidence)
            return tilted_share(total, squares, trials, greatest, confidence)

        if any(self._tilted(one) for one in strata):
            each = shared_confidence(self._confidence, sum(one.weight > 0 for one in strata))
            whole = weighted_mean([(one.weight, share(one, each)) for one in strata], self._confidence)
        else:
            whole = stratified([Part(one.weight, *events[one.number][:2]) for one in strata], self._confidence)
        return {
            "what": what,
            "unit": "share of vehicles",
            "whole": _data(whole),
            "strata": [
                {
                    "events": events[one.number][0],
                    **_data(share(one, self._confidence)),
                    "says": self._says(one, *events[one.number][:2]),
                }
                for one in strata
            ],
        }

    def _tilted(self, stratum: Stratum) -> bool:
        return self._campaign.situation_of(stratum).greatest_weight is not None

    def _says(self, stratum: Stratum, events: int, trials: int) -> str:
        if self._tilted(stratum):
            return f"{events} of {trials}, drawn towards what is rare and weighed"
        return rule_of_three(trials, self._confidence) if events == 0 else f"{events} of {trials}"

    def _availability(self) -> list[dict[str, Any]]:
        return [
            self._mean_of_vehicles(_SHARE_TOLD, "cycles with a report, from the first report on"),
            self._share_of_vehicles("told = 0", "vehicles that never report"),
        ]

    def _mean_of_vehicles(self, share: str, what: str) -> dict[str, Any]:
        """Return the mean over vehicles of a share of each: in the whole, and in each stratum."""
        rows = self._all(
            f"select stratum, sum(s), sum(s * s), count(*) from (select stratum, weight * ({share}) as s from rows_ where row = 'vehicle') "
            "group by stratum"
        )
        sums: dict[int, tuple[float, float, int]] = {
            stratum: (one, square, number) for stratum, one, square, number in rows
        }
        strata = self._campaign.strata
        each = shared_confidence(self._confidence, sum(one.weight > 0 for one in strata))

        def mean(one: Stratum, confidence: float) -> Estimate:
            greatest = self._campaign.situation_of(one).greatest_weight
            total, squares, trials = sums[one.number]
            if greatest is None:
                return mean_share(total, squares, trials, confidence)
            return tilted_share(total, squares, trials, greatest, confidence)

        parts = [(one.weight, mean(one, each)) for one in strata]
        return {
            "what": what,
            "unit": "mean share of cycles",
            "whole": _data(weighted_mean(parts, self._confidence)),
            "strata": [_data(mean(one, self._confidence)) for one in strata],
        }

    def _width(self) -> list[dict[str, Any]]:
        return [
            {
                "what": what,
                "unit": "mm",
                "strata": [self._quantiles(one, column, "told > 0") for one in self._campaign.strata],
            }
            for column, what in (
                ("widest_mm", "greatest width of a vehicle's interval"),
                ("width_sum_mm // told", "mean width of a vehicle's interval"),
            )
        ]

    def _times(self, column: str, since: str) -> list[dict[str, Any]]:
        strata = self._campaign.strata
        beyond = 1 << 62
        value = f"case when {column} = -1 then {beyond} else {column} end"
        quantiles = [self._quantiles(one, value, f"{column} is not null", beyond) for one in strata]
        return [
            {
                "what": f"time from the cycle in which {since} until nothing is reported, of vehicles that report before it",
                "unit": "cycles",
                "strata": quantiles,
                "withdrawn": [self._withdrawn(one, column) for one in strata],
            }
        ]

    def _withdrawn(self, stratum: Stratum, column: str) -> dict[str, Any] | None:
        found = self._all(
            f"select count(*) filter (where {column} >= 0), count(*) from rows_ where row = 'vehicle' and {column} is not null "
            f"and stratum = {stratum.number}"
        )[0]
        if not found[1] or self._tilted(stratum):
            return None
        return {"events": found[0], **_data(proportion(found[0], found[1], self._confidence))}

    def _quantiles(self, stratum: Stratum, value: str, where: str, beyond: int | None = None) -> dict[str, Any]:
        """Return quantiles over the vehicles of a stratum, each with the interval of its order statistics."""
        rows = f"from rows_ where row = 'vehicle' and stratum = {stratum.number} and {where}"
        trials = self._one(f"select count(*) {rows}")
        if not trials or self._tilted(stratum):  # weighed vehicles have no order statistics
            return {"trials": trials, "quantiles": []}

        def ranked(rank: int | None) -> int | None:
            if rank is None:
                return None
            found = self._one(f"select {value} {rows} order by {value} limit 1 offset {rank - 1}")
            return None if found == beyond else int(found)

        made = []
        for share in _QUANTILES:
            ranks = quantile_ranks(share, trials, self._confidence)
            ends = {"value": ranked(ranks.at), "low": ranked(ranks.low), "high": ranked(ranks.high)}
            made.append({"share": share, **ends, "confidence": self._confidence, "method": "order statistics"})
        return {"trials": trials, "quantiles": made}

    # -------------------------------------------------------------- laws kept and broken

    def _laws(self) -> list[dict[str, Any]]:
        return [
            {
                "law": _LAWS[law],
                "interval": _STANDINGS[what],
                "cycles": self._one(f"select sum({law}_{what}) from rows_ where row = 'vehicle'"),
                **self._mean_of_vehicles(f"{law}_{what} / cycles", f"cycles: {_LAWS[law]}, {_STANDINGS[what]}"),
            }
            for law in _LAWS
            for what in _STANDINGS
        ]

    def _clauses(self) -> list[dict[str, Any]]:
        """Return how often each clause of the world is broken."""
        rows = self._all(
            "select name, stratum, sum(cycles), sum(vehicles) from rows_ where row = 'clause' group by name, stratum"
        )
        names = list(dict.fromkeys(name for name, *_ in sorted(rows)))
        return [self._clause(name, {stratum: rest for one, stratum, *rest in rows if one == name}) for name in names]

    def _clause(self, name: str, counts: Mapping[int, Sequence[int]]) -> dict[str, Any]:
        parts = [
            Part(one.weight, counts[one.number][1], one.vehicles)
            for one in self._campaign.strata
            if one.number in counts
        ]
        strata = (
            self._campaign.strata
        )  # a clause may be one of some vehicles' configuration only; vehicles that count unlike are not summed
        missing = len(parts) < len(strata) or any(self._tilted(one) for one in strata)
        return {
            "name": name,
            "cycles": sum(cycles for cycles, _ in counts.values()),
            "vehicles": sum(vehicles for _, vehicles in counts.values()),
            "whole": None if missing else _data(stratified(parts, self._confidence)),
        }

    # -------------------------------------------------------------- pictures

    def stanford(self) -> list[tuple[int, int, str, int]]:
        """Return cells of error and margin: x, y, contained or wrong, cycles."""
        return self._all("select x, y, name, sum(cycles) from rows_ where row = 'stanford' group by all order by all")

    def silent(self) -> int:
        """Return the number of cycles without a report."""
        return int(self._one("select sum(cycles - told) from rows_ where row = 'vehicle'"))

    def along(self, stratum: Stratum, widest_mm: int | None) -> list[Stretch]:
        """Return the stretches of a stratum, each with intervals over the vehicles that were there; nothing where vehicles are weighed.

        widest_mm  the greatest width that can be reported; without it the mean width has no interval
        """
        if self._tilted(stratum):
            return []
        rows = self._all(
            "select x, vehicles, share_sum, share_squares, reporting, mean_sum, mean_squares, widest_mm from rows_ "
            f"where row = 'place' and stratum = {stratum.number} order by x"
        )
        return [self._stretch(row, widest_mm) for row in rows]

    def _stretch(self, row: Sequence[int], widest_mm: int | None) -> Stretch:
        x, vehicles, shares, share_squares, reporting, means, mean_squares, seen_mm = row
        share = mean_share(shares / SHARE_UNITS, share_squares / SHARE_UNITS**2, vehicles, self._confidence)
        told = Spread(share.value, share.low, share.high)
        if not reporting:
            return Stretch(x, vehicles, told, 0, None, 0)
        if widest_mm is None or seen_mm > widest_mm:
            return Stretch(x, vehicles, told, reporting, Spread(means / reporting, None, None), seen_mm)
        part = mean_share(means / widest_mm, mean_squares / widest_mm**2, reporting, self._confidence)
        width = Spread(part.value * widest_mm, part.low * widest_mm, part.high * widest_mm)
        return Stretch(x, vehicles, told, reporting, width, seen_mm)

    def margins_mm(self, stratum: Stratum) -> list[Spread]:
        """Return of the vehicles' smallest margins the least, and that of 1 %, of 10 % and the median with their intervals, mm.

        Nothing without a report, or where vehicles are weighed. An end is None where so few vehicles do not bound it, and so are both of the least.
        """
        rows = f"from rows_ where row = 'vehicle' and least_margin_nm is not null and stratum = {stratum.number}"
        trials = self._one(f"select count(*) {rows}")
        if not trials or self._tilted(stratum):
            return []

        def at(rank: int) -> int:
            found = self._one(f"select least_margin_nm {rows} order by least_margin_nm limit 1 offset {rank - 1}")
            return int(found) // NM_PER_MM

        made = [Spread(at(1), None, None)]
        for share in (0.01, 0.1, 0.5):
            ranks = quantile_ranks(share, trials, self._confidence)
            low, high = (None if rank is None else at(rank) for rank in (ranks.low, ranks.high))
            made.append(Spread(at(ranks.at), low, high))
        return made

    def times(self, stratum: Stratum, column: str) -> list[tuple[int, int]]:
        """Return times (-1: not until the end) and the number of vehicles with each; nothing where vehicles are weighed."""
        if self._tilted(stratum):
            return []
        return self._all(
            f"select {column}, count(*) from rows_ where row = 'vehicle' and {column} is not null and stratum = {stratum.number} "
            f"group by {column} order by {column}"
        )

    def vehicles(self, where: str) -> tuple[int, int]:
        """Return how many vehicles there are, and in how many strata."""
        counts = f"select count(*), count(distinct stratum) from rows_ where row = 'vehicle' and {where}"
        [(vehicles, strata)] = self._all(counts)
        return vehicles, strata

    def worst(self, where: str, order: str, number: int) -> Iterator[tuple[int, int, int]]:
        """Yield shard, place in the shard and cycle of the vehicles that come first in an order: the first one of each stratum, then the second ones."""
        first = f"order by {order}, shard, vehicle"
        ranked = (
            f"select shard, vehicle, coalesce(first_wrong, least_margin_cycle) as cycle, row_number() over (partition by stratum {first}) as place, "
            f"row_number() over ({first}) as among_all from rows_ where row = 'vehicle' and {where}"
        )
        yield from self._all(f"select shard, vehicle, cycle from ({ranked}) order by place, among_all limit {number}")

    def _all(self, text: str) -> list[Any]:
        return self._db.execute(text).fetchall()

    def _one(self, text: str) -> Any:
        found = self._db.execute(text).fetchone()
        assert found is not None
        return found[0]


def _data(estimate: Estimate) -> dict[str, Any]:
    return asdict(estimate)
