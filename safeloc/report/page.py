"""The report as an HTML page, made from the report's data alone.

A small report is one page without parts. The page of a large one holds the overview; the other parts are scripts beside it,
which `page.js` opens. Runs are shown by a page of their own (safeloc.report.run_page). A single page has everything in it.
"""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from safeloc.language.verdict import SHOWN
from safeloc.proof.verification.unasked import QUICK
from safeloc.report.conditions import conditions, counts, needs
from safeloc.report.file_names import file_names
from safeloc.report.first_steps import first_steps
from safeloc.report.glossary import words_in
from safeloc.report.headline import ALWAYS_COUNTED, BEST_FIRST, KindAndVerdict, counted, headline
from safeloc.report.held_in import recordings, statements
from safeloc.report.links import REPORT, Links, anchor, is_in_a_file, linked
from safeloc.report.margins import first_page_row, margins_shown, of_another_version
from safeloc.report.mutation_words import score_words
from safeloc.report.overview import RESULTS, results_script, results_text
from safeloc.report.run_page import OVERVIEW, RUN_PAGE, RUNS, asset, island, known_runs, scripts, views
from safeloc.report.traces import trace_charts, trace_rows
from safeloc.report.verdict_words import requirement_lines, told_of
from safeloc.runtime.scripts import script

_HERE = Path(__file__).parent
PARTS = "page"
"""The folder beside the page with its parts."""
MOST_OF_ONE_PAGE = 1_000_000
"""Most characters of the parts in a page that has them in it: such a page opens within a second."""
_NO_PARTS: Mapping[str, str] = MappingProxyType({})
_BARE: Mapping[str, Any] = MappingProxyType({"made": "", "run_at": "", "overview": "", "run": "", "script": ""})
"""What a page without search, parts and runs has besides the report."""
_NOTHING_BESIDE: Mapping[str, str] = MappingProxyType(
    {"items_beside": "", "conditions_beside": "", "conditions_at": ""}
)
"""Parts of a page that has none."""
_LONG_ASSUMPTION = 200
"""Characters of an assumption beyond which the page says it once for each machine."""
_MANY_ROWS = 4
"""If a claim rests on more transitions, only their number is shown."""
_FROM_A_FILE = f"from the folder in which you asked for this report, with its own folder in place of {REPORT}"
_LONGEST_RUN, LAST_STEPS = 40, 20
"""Of a longer run, only the last steps are shown unfolded."""
_SUMMARY: Mapping[str, tuple[str, ...]] = {
    "properties": ("property",),
    "obligations and lemmas": ("obligation", "lemma"),
    "property tests": ("test",),
    "replayed recordings": ("replay",),
}
_Data = Mapping[str, Any]


@dataclass(frozen=True)
class Pages:
    """The page, the page of runs (empty if there is none), and the parts of both by file name."""

    page: str
    runs: str
    parts: Mapping[str, str]


def to_pages(data: _Data, *, single: bool = False, runs: Sequence[str] = ()) -> Pages:
    """Return the pages of a report; the first has no parts if it is small, or `single`.

    runs  the scripts with runs and machines; a single page has them in it
    """
    rendering = _Rendering(data)
    contents = rendering.contents()
    made = _digest(json.dumps(data["made"]), rendering.results, *contents.values())
    if single:
        return Pages(rendering.with_everything(made, runs), "", {})
    beside = {RESULTS: results_script(rendering.results, made), **dict(views(data, made))}
    large = sum(map(len, contents.values())) > MOST_OF_ONE_PAGE
    page, parts = rendering.in_parts(made, contents) if large else (rendering.whole(made), {})
    return Pages(page, rendering.run_page(made), {**parts, **beside})


def _digest(*texts: str) -> str:
    """Return that of a report, by which the page knows that a script beside it belongs to it: of how it was made and all it says."""
    total = hashlib.sha256()
    for text in texts:
        total.update(hashlib.sha256(text.encode()).digest())
    return total.hexdigest()[:16]


def to_html(data: _Data) -> str:
    """Return the complete page, without search, for the result of `report_data`, or for a report that was read from a folder."""
    return _Rendering(data).page()


class _Rendering:
    """The templates and their data."""

    def __init__(self, data: _Data) -> None:
        results = data["results"]
        machines = {machine["name"]: machine for machine in data["machines"]}
        shown = _shown_before(data["machines"])
        files = file_names([*machines, *(row["machine"] for row in results)])
        self.links = links = Links(data, files)
        self._machines = [_machine(machine, results, shown, links) for machine in data["machines"]]
        self._requirements = _requirements(data, links)
        self._conditions = _with_sources(conditions(data["machines"]), data["machines"], links)
        self._data = data
        self._given: dict[str, Any] = {
            "data": data,
            "changed": data.get("changed"),
            "headline": headline(_verdicts(results)),
            "counted": counted(_verdicts(results), ALWAYS_COUNTED),
            "undecided": [row for row in results if row["verdict"] == "unknown"],
            "empty": [row for row in results if row["verdict"] in ("vacuous", "not asked")],
            "violated": [
                _violated(row, machines[row["machine"]], links) for row in results if row["verdict"] == "violated"
            ],
            "requirements": self._requirements,
            "conditions": self._conditions,
            "resting": counts(self._conditions),
            "claim_rows": self._claim_rows(),
            "margin_rows": [first_page_row(one["name"], one.get("margins")) for one in data["machines"]],
            "words": words_in(self._said()),
            "first": first_steps(data, links),
        }

    def page(self, **more: Any) -> str:
        """Return the page without parts; `more` is what its templates know besides the report."""
        machines = [{**one, "beside": ""} for one in self._machines]
        given = {"machines": machines, "law_parts": {}, **_NOTHING_BESIDE, **self._given, **_BARE, **more}
        return self._filled("page", **given)

    def whole(self, made: str) -> str:
        """Return the page without parts that searches with the data beside it."""
        return self.page(run_at=RUN_PAGE, overview=self._overview(made), script=scripts(OVERVIEW))

    def with_everything(self, made: str, runs: Sequence[str]) -> str:
        """Return the page with search, the view of runs, and all their data in it."""
        texts = [results_script(self.results, made), *runs, *dict(views(self._data, made)).values()]
        script = scripts(OVERVIEW, *([RUNS] if runs else []), calls=texts)
        known = island(known_runs(self._data, made, report="")) if runs else ""
        return self.page(overview=self._overview(made, run=""), run=known, script=script)

    def run_page(self, made: str) -> str:
        """Return the page of runs that lies beside the page; nothing if there is no run."""
        first = {row["machine"]: at for row in reversed(self._data["results"]) if (at := self.links.run(row))}
        known, script = known_runs(self._data, made, report="index.html"), scripts(RUNS)
        given = {"data": self._data, "run": island(known), "script": script, "machines": sorted(first.items())}
        return self._filled("run_page", **given) if first else ""

    def _overview(
        self, made: str, *, run: str = RUN_PAGE, parts: Mapping[str, str] = _NO_PARTS, conditions_at: str = ""
    ) -> Markup:
        """Return where the search finds its data, the view of runs, the part of each machine, and that of the conditions."""
        return island(
            {
                "made": made,
                "results": f"{PARTS}/{RESULTS}",
                "run": run,
                "parts": dict(parts),
                "conditions": conditions_at,
            }
        )

    @cached_property
    def results(self) -> str:
        """Return the data for the search."""
        return results_text(self._data, self.links)

    @cached_property
    def _files(self) -> dict[str, str]:
        """Return the name of the file of each part, without ending."""
        return file_names(["beside", "results", "trace back", "conditions", *(one["name"] for one in self._machines)])

    @cached_property
    def _beside(self) -> dict[str, str]:
        """Return the part of each machine."""
        return {one["name"]: f"{PARTS}/{self._files[one['name']]}.js" for one in self._machines}

    @property
    def _conditions_at(self) -> str:
        return f"{PARTS}/{self._files['conditions']}.js"

    def contents(self) -> dict[str, str]:
        """Return the content of each part, by the name of its file without ending."""
        files, known = self._files, {"run_at": RUN_PAGE, "conditions_at": self._conditions_at}
        requirements = self._requirements
        return {
            **{
                files[one["name"]]: self._filled("machine", m=one, requirements=requirements, **known)
                for one in self._machines
            },
            files["trace back"]: self._filled("items", data=self._data, requirements=requirements),
            files["conditions"]: self._filled(
                "conditions", conditions=self._conditions, law_parts=self._beside, claim_rows=self._claim_rows()
            ),
        }

    def in_parts(self, made: str, contents: Mapping[str, str]) -> tuple[str, dict[str, str]]:
        """Return the page that loads its parts, and the parts by file name; all contain the digest of the report."""
        parts = {
            f"{file}.js": script("safelocPart", f"{PARTS}/{file}.js", made, data=text.encode())
            for file, text in contents.items()
        }
        parts[f"{self._files['beside']}.js"] = f"safelocBeside({json.dumps(made)});\n"
        page = self.page(
            machines=[{**one, "beside": self._beside[one["name"]]} for one in self._machines],
            items_beside=f"{PARTS}/{self._files['trace back']}.js",
            conditions_beside=self._conditions_at,
            made=made,
            run_at=RUN_PAGE,
            overview=self._overview(made, parts=self._beside, conditions_at=self._conditions_at),
            script=Markup(f"{asset('page.js')}{scripts(OVERVIEW)}"),
        )
        return page, parts

    def _said(self) -> str:
        """Return what the page says: its own words, and those of results and laws."""
        own = [asset(f"{name}.html.jinja") for name in ("page", "machine", "conditions")]
        rows = self._data["results"]
        results = dict.fromkeys(row[field] for row in rows for field in ("statement", "method", "assumption"))
        return " ".join([*own, *results, *(law["statement"] for law in self._conditions["laws"])])

    def _claim_rows(self) -> dict[str, str]:
        """Return the place on the page of each claim, by machine and name as the list of conditions has them."""
        claims = (row for row in self._data["results"] if row["kind"] == "property")
        return {f"{row['machine']}: {row['id'].split('/', 2)[-1]}": self.links.row(row) for row in claims}

    def _filled(self, template: str, **given: Any) -> str:
        return _environment().get_template(f"{template}.html.jinja").render(**given)


@cache
def _environment() -> Environment:
    """Return where templates are compiled; once in a process, since that takes longer than to fill them."""
    environment = Environment(
        loader=FileSystemLoader(_HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["linked"] = linked
    environment.globals["anchor"] = anchor
    return environment


def _with_sources(found: Mapping[str, list[dict[str, Any]]], machines: Sequence[_Data], links: Links) -> dict[str, Any]:
    """Return the conditions with the place of the source lines of each law, as the page of its first machine has them."""
    places = {machine["name"]: links.sources(machine, ())["laws"] for machine in machines}
    laws = [
        {**law, "source_at": places[law["targets"][0]].get((law["part"], law["name"]), "")} for law in found["laws"]
    ]
    return {**found, "laws": laws}


def _shown_before(machines: Sequence[_Data]) -> dict[tuple[str, int], str]:
    """Return, for a target and the number of its part, the earlier target that shows an identical machine."""
    first: dict[str, str] = {}
    again: dict[tuple[str, int], str] = {}
    for machine in machines:
        for number, part in enumerate(machine["parts"]):
            where = first.setdefault(json.dumps(part, sort_keys=True), machine["name"])
            if where != machine["name"]:
                again[machine["name"], number] = where
    return again


def _assumed_once(rows: Sequence[_Data]) -> list[_Data]:
    """Return the rows; one with the long assumption of an earlier row refers to that one (`assumed_as`) in place of the text."""
    first: dict[str, _Data] = {}
    found: list[_Data] = []
    for row in rows:
        before = first.setdefault(row["assumption"], row)
        again = before is not row and len(row["assumption"]) > _LONG_ASSUMPTION
        found.append({**row, "assumed_as": {"name": before["name"], "at": before["at"]} if again else None})
    return found


def _machine(
    machine: _Data, results: Sequence[_Data], shown: Mapping[tuple[str, int], str], links: Links
) -> dict[str, Any]:
    of_machine = [{**_named(row), **links.of(row)} for row in results if row["machine"] == machine["name"]]
    evidence = [row for row in of_machine if row["kind"] in ("test", "replay")]
    elsewhere = {part["name"] for n, part in enumerate(machine["parts"]) if (machine["name"], n) in shown}
    return {
        **machine,
        "rows": _assumed_once([row for row in of_machine if row["kind"] == "property"]),
        "recordings": recordings(evidence, lambda found: _counted(found, ("test", "replay"))),
        "statements": statements(evidence),
        "pictures": [{**one, "svg": Markup(one["svg"])} for one in machine["pictures"]],  # labels are escaped
        "rests": _rests(machine["evidence"]),
        "score": score_words(machine.get("mutation")),
        "margins": _drawn(margins_shown(machine.get("margins"))),
        "margins_of_another_version": of_another_version(machine.get("margins")),
        "tests": [row for row in evidence if row["kind"] == "test"],
        "obligations": [row for row in of_machine if row["kind"] in ("obligation", "lemma")],
        "counts": [(name, _counted(of_machine, kinds)) for name, kinds in _SUMMARY.items()],
        "parts": [
            {
                **part,
                "svg": Markup(part["svg"]),
                "shown": shown.get((machine["name"], number), ""),
                "anchor": anchor("term", machine["name"], part["name"]),
            }  # labels are escaped
            for number, part in enumerate(machine["parts"])
        ],
        "sources": links.sources(machine, elsewhere),
        "packed": links.packed(machine["name"]),
        "needs": needs(machine),
        "own": _is_own(machine),
        "formulas": machine.get("formulas", {}),
    }


def _is_own(machine: _Data) -> bool:
    """Return whether a machine is of the user's own: of `file.py:name` or `package.module:name`."""
    return ":" in machine["spec"]


def _rests(evidence: _Data | None) -> dict[str, Any] | None:
    """Return the cores of all claims as rows of a table, and the picture of the cut sets; None without evidence."""
    if evidence is None:
        return None
    return {
        **evidence,
        "cores": [_core(one) for one in evidence["cores"] if one["why_none"] != "shown by a run"],
        "picture": Markup(evidence["picture"]),  # labels are escaped
    }


def _drawn(margins: dict[str, Any] | None) -> dict[str, Any] | None:
    """Return margins with their pictures as markup, in which labels are escaped."""
    if margins is None:
        return None
    drawn = {
        part: [{**one, "picture": Markup(one["picture"])} for one in margins[part]] for part in ("moved", "fronts")
    }
    return {**margins, **drawn}


def _core(one: _Data) -> dict[str, Any]:
    """Return the core of a claim by kinds of elements; of many rows, only the number."""
    named: dict[str, list[str]] = {"clause": [], "contract": [], "lemma": [], "range": [], "row": []}
    for element in one["rests_on"]:
        named[element["kind"]].append(element["name"])
    rows = named["row"]
    return {
        **one,
        "clauses": named["clause"],
        "others": [*named["contract"], *named["lemma"], *named["range"]],
        "rows": f"{len(rows)} of {one['rows_of']}" if len(rows) > _MANY_ROWS else "; ".join(rows),
        "open_names": [element["name"] for element in one["undecided"]],
    }


def _verdicts(rows: Sequence[_Data]) -> list[KindAndVerdict]:
    return [KindAndVerdict(row["kind"], row["verdict"], row["method"] == QUICK, told_of(row) == SHOWN) for row in rows]


def _counted(rows: Sequence[_Data], kinds: Sequence[str]) -> str:
    """Return the number of each verdict, such as `14 proved, 7 shown by a run, 1 unknown`."""
    found = Counter(told_of(row) for row in rows if row["kind"] in kinds)
    return ", ".join(f"{found[verdict]} {verdict}" for verdict in BEST_FIRST if found[verdict]) or "none"


def _named(row: _Data) -> dict[str, Any]:
    """Return the row with a short name, its verdict as it is told, and with `notes_text`, by which tests of the same runs are grouped."""
    return {**row, "name": row["id"].split("/", 2)[-1], "told": told_of(row), "notes_text": json.dumps(row["notes"])}


def _requirements(data: _Data, links: Links) -> dict[str, Any]:
    """Return the requirements of machines in this report and of its results; the others are only counted."""
    present = {
        name for machine in data["machines"] for name in (machine["name"], *(p["name"] for p in machine["parts"]))
    }
    rows = [row for row in data["requirements"] if row["transitions"] or row["results"] or row["machine"] in present]
    results = {row["id"]: row for row in data["results"]}
    return {
        "rows": [_requirement(row, [results[name] for name in row["results"]], links) for row in rows],
        "known": {row["id"] for row in rows},
        "others": 0 if all(map(_is_own, data["machines"])) else len(data["requirements"]) - len(rows),
    }


def _requirement(row: _Data, results: Sequence[_Data], links: Links) -> dict[str, Any]:
    """Return a requirement with what shows it: each property, and how many results of each kind have which verdict."""
    return {**row, "shown": _shown_by(results, links), "found": list(requirement_lines(results))}


def _shown_by(rows: Sequence[_Data], links: Links) -> list[tuple[str, str, str]]:
    """Return name, verdict and place on the page of each property and of all that did not hold; of tests that held, the number."""
    single = [row for row in rows if row["kind"] == "property" or row["verdict"] not in ("proved", "held")]
    listed = [(row["id"].replace("/property/", ": "), told_of(row), links.row(row)) for row in single]
    for kind, word in (("test", "property tests"), ("replay", "replays")):
        number = sum(row["kind"] == kind and row not in single for row in rows)
        listed += [(f"{number} {word}", "held", "")] if number else []
    return listed


def _violated(row: _Data, machine: _Data, links: Links) -> dict[str, Any]:
    trace = row["trace"]
    charts = "" if trace is None else trace_charts(trace, machine)
    steps = [] if trace is None else trace_rows(trace, machine["signals"])
    return {
        "row": row,
        "charts": Markup(charts),  # our own text, every label in it is escaped
        "steps": steps,
        "groups": [steps] if len(steps) <= _LONGEST_RUN else [steps[:-LAST_STEPS], steps[-LAST_STEPS:]],
        "at": links.row(row),
        "run": links.run(row),
        "replay": links.replay(row, machine),
        "replay_from": _FROM_A_FILE if is_in_a_file(machine) else "from the folder of this report",
    }
