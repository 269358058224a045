"""The report of a guarded run: one self-contained page with a map and the intervals over time, and the judgements."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from safeloc.config import figures
from safeloc.errors import InputError
from safeloc.models.guard import machine
from safeloc.models.guard.variables import GuardConfig
from safeloc.railway.guard.guard import Judgement
from safeloc.railway.guard.judgement_data import as_data, counted
from safeloc.railway.guard.tracks import Tracks
from safeloc.railway.map.projection import Projector
from safeloc.report.guard_map import Spot, guard_map
from safeloc.report.guard_plot import Moment, guard_plot
from safeloc.report.guard_words import WORDS
from safeloc.report.style_sheet import style_sheet

_TEMPLATE = Path(__file__).with_name("guard.html.jinja")
_JUDGEMENTS = "judgements.jsonl"


def write_guard_folder(
    folder: Path, judgements: Sequence[Judgement], tracks: Tracks, config: GuardConfig, stream: str
) -> Path:
    """Write page and judgements, and return the path of the page. InputError if the folder cannot be written."""
    page = folder / "index.html"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lines = (json.dumps(as_data(judgement)) + "\n" for judgement in judgements)
        (folder / _JUDGEMENTS).write_text("".join(lines), encoding="utf-8")
        page.write_text(guard_page(judgements, tracks, config, stream), encoding="utf-8")
    except OSError as error:
        raise InputError(f"{folder}: the report cannot be written here: {error.strerror or error}.") from error
    return page


def guard_page(judgements: Sequence[Judgement], tracks: Tracks, config: GuardConfig, stream: str) -> str:
    """Return the page as text."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    name = Path(stream).name
    counts = counted(judgements)
    return environment.from_string(_TEMPLATE.read_text(encoding="utf-8")).render(
        style=Markup(style_sheet()),
        name=name,
        total=len(judgements),
        passed=counts.get("PASSED", 0),
        doubtful=sum(one.beside is not None and one.beside.doubtful for one in judgements),
        line=tracks.topology.line.name,
        rows=[(reason, WORDS[reason], number) for reason, number in counts.items()],
        map=Markup(_map(judgements, tracks, f"map of {name}")),
        plot=Markup(guard_plot(list(_moments(judgements, tracks)), config.tolerance_mm, f"intervals of {name}")),
        figures=list(figures(config)),
        law=machine(config).doc,
        judgements=_JUDGEMENTS,
        version=version("safeloc"),
    )


def _way(tracks: Tracks) -> Iterable[str]:
    return () if tracks.route is None else (laid.run.edge for laid in tracks.route)


def _map(judgements: Iterable[Judgement], tracks: Tracks, title: str) -> str:
    """Draw the entire line, even if only a route on it is guarded."""
    plane = Projector(tracks.topology.line)
    return guard_map(plane.courses(), _way(tracks), list(_spots(judgements, plane, tracks.crs)), title)


def _spots(judgements: Iterable[Judgement], plane: Projector, crs: str) -> Iterator[Spot]:
    """Yield every fix with a place on the map."""
    for one in judgements:
        if one.place is not None:
            assert one.delivery.x is not None and one.delivery.y is not None
            yield Spot(*plane.plane(one.delivery.x, one.delivery.y, crs=crs), one.reason)


def _moments(judgements: Iterable[Judgement], tracks: Tracks) -> Iterator[Moment]:
    """Yield deliveries by their time of arrival. Without a route, a position counts only while the guard has a way."""
    start: int | None = None
    now = 0
    for one in judgements:
        time: Any = one.delivery.time_ms if one.delivery.received_ms is None else one.delivery.received_ms
        if time is None and start is None:
            continue
        start = time if start is None else start
        now = now if time is None else max(now, time - start)
        placed = tracks.route is not None or one.window_mm is not None
        yield Moment(now, one.reason, one.position_mm if placed else None, one.interval_mm)
