"""The table of a shard: what became of its vehicles, in rows of four kinds.

vehicle   one for each: its cycles by law and interval, its smallest margin, times to withdraw
clause    how often a clause was broken: cycles, and vehicles
stanford  cycles by error and margin, in cells of a fiftieth of the limit; the last cell holds all beyond
place     by stretch of the line: cycles and widths, and what the vehicles that were there have on the mean, with its squares
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from safeloc.campaign.declaration import Campaign, Shard
from safeloc.campaign.judged import NEVER, Flags, Outcome, Whole, cycles_until_silent, first_of
from safeloc.language.units import NM_PER_MM
from safeloc.simulation.many_runs import Array, Drawn
from safeloc.target import Target

CELLS_TO_LIMIT, CELLS = 50, 120
"""Cells of the Stanford diagram up to the limit, and in all."""
SHARE_UNITS = 1_000_000
"""A vehicle's share of cycles in a stretch is counted in millionths, so that sums are the same in every order."""

SCHEMA = pa.schema(
    [("row", pa.string()), ("stratum", pa.int32()), ("shard", pa.int32())]
    + [("vehicle", pa.int64()), ("name", pa.string()), ("x", pa.int64()), ("y", pa.int64())]
    + [(name, pa.int64()) for name in ("cycles", "vehicles", "told", "before_first")]
    + [(f"{law}_{what}", pa.int64()) for law in ("kept", "broken") for what in ("contained", "silent", "wrong")]
    + [
        (name, pa.int64())
        for name in ("first_broken", "first_wrong", "longest_wrong", "least_margin_nm", "least_margin_cycle")
    ]
    + [(name, pa.int64()) for name in ("widest_mm", "width_sum_mm", "withdrawn_after", "reaction", "refused")]
    + [(name, pa.int64()) for name in ("reporting", "share_sum", "share_squares", "mean_sum", "mean_squares")]
    + [("weight", pa.float64())]
)
"""Columns; those that a kind of row does not have are empty, and so are figures that a vehicle has not."""


def alert_limit_mm(campaign: Campaign, target: Target) -> int:
    """Return the declared alert limit, else the machine's tolerance. InputError, with the place in the file, without either."""
    found = campaign.declared.alert_limit_mm or getattr(target.config, "tolerance_mm", None)
    if found is None:
        raise campaign.refuse(("machine",), f"{target.name} has no tolerance_mm; give alert_limit_mm.")
    return int(found)


def to_parquet(groups: Sequence[Mapping[str, Any]]) -> bytes:
    """Return a table with the rows of all groups as Parquet."""
    tables = []
    for group in groups:
        size = len(next(values for values in group.values() if not isinstance(values, str | int)))
        columns = [_column(group.get(field.name), field.type, size) for field in SCHEMA]
        tables.append(pa.Table.from_arrays(columns, schema=SCHEMA))
    sink = io.BytesIO()
    parquet.write_table(pa.concat_tables(tables), sink, compression="zstd")
    return sink.getvalue()


def _column(values: Any, kind: Any, size: int) -> Any:
    if values is None:
        return pa.nulls(size, kind)
    if isinstance(values, str | int):
        return pa.repeat(pa.scalar(values, kind), size)
    if isinstance(values, np.ma.MaskedArray):
        return pa.array(values.filled(0), kind, mask=np.ma.getmaskarray(values))
    return pa.array(values, kind)


@dataclass(frozen=True, eq=False)
class Counted:
    """The outcome of a shard, to be counted."""

    shard: Shard
    clauses: Sequence[str]
    drawn: Drawn
    outcome: Outcome
    limit_mm: int
    place_step_mm: int

    def groups(self) -> list[dict[str, Any]]:
        """Return the rows as groups of columns, a group for each kind of row."""
        own = {"stratum": self.shard.stratum.number, "shard": self.shard.number}
        groups = [self._vehicles(), self._clauses(), self._stanford(), self._places()]
        return [{**own, **group} for group in groups if len(group[next(reversed(group))])]

    def _vehicles(self) -> dict[str, Any]:
        one = self.outcome
        cycles, vehicles = one.told.shape
        margin = np.where(one.told, one.margin_nm, np.iinfo(np.int64).max)
        silent_at_all = ~one.told.any(axis=0)
        least = margin.argmin(axis=0)
        begin = np.array([_begin(faults) for faults in self.drawn.faults], dtype=np.int64)
        wrong, broken = one.told & (margin < 0), one.broken
        width = np.where(one.told, one.width_mm, 0)
        return {
            "row": "vehicle", "vehicle": np.arange(self.shard.first, self.shard.end), "cycles": np.full(vehicles, cycles),
            "told": one.told.sum(axis=0), "before_first": np.where(silent_at_all, cycles, one.told.argmax(axis=0)),
            **_by_law(one.told, wrong, broken),
            "first_broken": _unless(first_of(broken), NEVER), "first_wrong": _unless(first_of(wrong), NEVER),
            "longest_wrong": _longest(wrong),
            "least_margin_nm": np.ma.array(margin.min(axis=0), mask=silent_at_all),
            "least_margin_cycle": np.ma.array(least, mask=silent_at_all),
            "widest_mm": np.ma.array(width.max(axis=0), mask=silent_at_all), "width_sum_mm": width.sum(axis=0),
            "withdrawn_after": _time(one.told, begin), "reaction": _time(one.told, first_of(broken)),
            "refused": one.refused, "weight": np.ones(vehicles) if self.drawn.weights is None else self.drawn.weights,
        }  # fmt: skip

    def _clauses(self) -> dict[str, Any]:
        broken = ~self.outcome.held
        return {
            "row": "clause",
            "name": list(self.clauses),
            "cycles": broken.sum(axis=(1, 2)),
            "vehicles": broken.any(axis=1).sum(axis=1),
        }

    def _stanford(self) -> dict[str, Any]:
        one = self.outcome
        told, place = one.told, one.position_mm * NM_PER_MM
        above = one.truth_nm >= place
        error = np.abs(one.truth_nm - place)[told]
        margin = np.where(above, one.high_mm * NM_PER_MM - place, place - one.low_mm * NM_PER_MM)[told]
        x, y = (np.minimum(each * CELLS_TO_LIMIT // (self.limit_mm * NM_PER_MM), CELLS - 1) for each in (error, margin))
        beyond = error > margin  # a wrong interval in a cell on the diagonal is told apart by its name
        found: dict[str, list[Array]] = {"x": [], "y": [], "vehicles": []}
        names: list[str] = []
        for name, those in (("contained", ~beyond), ("wrong", beyond)):
            cells, counts = np.unique(x[those] * CELLS + y[those], return_counts=True)
            found["x"].append(cells // CELLS)
            found["y"].append(cells % CELLS)
            found["vehicles"].append(counts)
            names += [name] * len(cells)
        joined = {name: np.concatenate(parts) for name, parts in found.items()}
        return {"row": "stanford", "name": names, "x": joined["x"], "y": joined["y"], "cycles": joined["vehicles"]}

    def _places(self) -> dict[str, Any]:
        one, vehicles = self.outcome, self.outcome.told.shape[1]
        stretch = one.truth_nm // (self.place_step_mm * NM_PER_MM)
        known, of_cycle = np.unique(stretch, return_inverse=True)
        cell = (of_cycle.reshape(stretch.shape) * vehicles + np.arange(vehicles)).ravel()
        told, width = one.told.ravel(), np.where(one.told, one.width_mm, 0).ravel()
        widest = np.zeros(len(known), dtype=np.int64)
        np.maximum.at(widest, cell[told] // vehicles, width[told])

        def each(weights: Array | None = None) -> Array:
            """Return a sum for each vehicle in each stretch: array [stretch, vehicle]."""
            sums = np.bincount(cell, weights=weights, minlength=len(known) * vehicles)
            return sums.astype(np.int64).reshape(len(known), vehicles)

        cycles, reports, widths = each(), each(told), each(width)
        share, mean = reports * SHARE_UNITS // np.maximum(cycles, 1), widths // np.maximum(reports, 1)
        return {
            "row": "place", "x": known, "cycles": cycles.sum(axis=1), "vehicles": (cycles > 0).sum(axis=1),
            "told": reports.sum(axis=1), "width_sum_mm": widths.sum(axis=1), "widest_mm": widest,
            "share_sum": share.sum(axis=1), "share_squares": (share**2).sum(axis=1),
            "reporting": (reports > 0).sum(axis=1), "mean_sum": mean.sum(axis=1), "mean_squares": (mean**2).sum(axis=1),
        }  # fmt: skip


def _begin(faults: Sequence[Any]) -> int:
    """Return the cycle in which the first fault of a vehicle begins; NEVER without one."""
    return min((fault.begin for fault in faults), default=NEVER)


def _by_law(told: Flags, wrong: Flags, broken: Flags) -> dict[str, Whole]:
    """Return the cycles of each vehicle by law and interval."""
    found = {}
    for law, those in (("kept", ~broken), ("broken", broken)):
        for what, flags in (("contained", told & ~wrong), ("silent", ~told), ("wrong", wrong)):
            found[f"{law}_{what}"] = (those & flags).sum(axis=0)
    return found


def _unless(values: Whole, none: int) -> Any:
    return np.ma.array(values, mask=values == none)


def _time(told: Flags, since: Whole) -> Any:
    """Return the cycles until nothing is reported; NEVER: until the end; empty where nothing could be withdrawn."""
    found = cycles_until_silent(told, since)
    return np.ma.array(found, mask=found < NEVER)


def _longest(wrong: Flags) -> Whole:
    """Return the greatest number of cycles in a row with a wrong interval, for each vehicle."""
    longest = np.zeros(wrong.shape[1], dtype=np.int64)
    for run in np.flatnonzero(wrong.any(axis=0)):
        edges = np.flatnonzero(np.diff(wrong[:, run].astype(np.int8), prepend=0, append=0))
        longest[run] = int((edges[1::2] - edges[::2]).max())
    return longest


def wrong_cycles(data: bytes) -> tuple[int, int]:
    """Return the cycles with a wrong interval in a shard's table: with the laws kept, and broken."""
    table = parquet.read_table(io.BytesIO(data), columns=["kept_wrong", "broken_wrong"], use_threads=False)
    return tuple(sum(one or 0 for one in table.column(name).to_pylist()) for name in ("kept_wrong", "broken_wrong"))  # type: ignore[return-value]
