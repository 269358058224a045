"""The view of runs: a page that steps through the run of any result, with its data in scripts beside it or within it.

The page itself is in explorer/: markup, style, and scripts by what they do. Its data come from the report's data alone:
machine by machine what a reader has to know beside the runs (`view`), and the runs as the folder has them.
"""

from __future__ import annotations

import json
import random
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from markupsafe import Markup

from safeloc.codegen.javascript import common, javascript, on_board
from safeloc.errors import InputError
from safeloc.explain.pytest_file import run_file_pieces
from safeloc.proof.drawn_runs.lawful import first_state
from safeloc.report.links import Links
from safeloc.report.stored import machine_names
from safeloc.report.verdict_words import told_of
from safeloc.runtime.scripts import script
from safeloc.target import Target

RUN_PAGE, VIEW = "run.html", ".view.js"
VIEW_FUNCTION, MACHINE_FUNCTION = "safelocView", "safelocScript"
"""The functions of the page that take what belongs to a machine beside its runs, and the machine itself."""
_HERE = Path(__file__).parent
SHARED, OVERVIEW = ("dom", "packed"), ("overview", "conditions", "words", "scrolled")
RUNS = ("runs", "charts", "interval", "strip", "diagram", "parts", "live", "branch", "watch", "view", "control")
"""Scripts of explorer/, in the order in which they use each other."""
_DEFENCE = re.compile(r"(?:of the machine by itself, )?a defence: ")
"""Begins the method of a result whose run breaks a law of the world, to which the machine answers with the transition that is shown."""
_BREAKS = {"violated", "unknown"}
"""Verdicts whose run breaks the statement in its last step; that of an undecided one begins in a state to which no run need come."""
_PART = re.compile(r"#\d+")
_Data = Mapping[str, Any]


def scripts(*groups: Sequence[str], calls: Sequence[str] = ()) -> Markup:
    """Return one script of our own texts, and after them calls of its functions with data.

    Each group has names of its own beside those that all of them share.
    """
    own = _joined(SHARED) + "".join(f"{{\n{_joined(group)}}}\n" for group in groups)
    return Markup(f'"use strict";\n(() => {{\n{own}}})();\n{"".join(calls)}')


def _joined(names: Sequence[str]) -> str:
    of_machines = f"const machineCommon = {common()};\n" if names is RUNS else ""
    return of_machines + "".join(_packed(asset(f"explorer/{name}.js")) for name in names)


def _packed(text: str) -> str:
    """Return one of our scripts without its remarks, indentation and empty lines; none of its texts goes over lines."""
    without = re.sub(r"^ *(?:/\*(?:(?!\*/)(?s:.))*\*/|//.*)$", "", text, flags=re.MULTILINE)
    return "".join(f"{line.strip()}\n" for line in without.splitlines() if line.strip())


def asset(name: str) -> Markup:
    """Return one of our own texts."""
    return Markup((_HERE / name).read_text(encoding="utf-8"))


def island(data: _Data) -> Markup:
    """Return data as JSON that cannot end the element around it."""
    return Markup(json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"))


def known_runs(data: _Data, made: str, *, report: str) -> dict[str, Any]:
    """Return which machines have runs, and where their data lie; `made` is the digest of the report."""
    return {
        "made": made,
        "report": report,
        "alone": False,
        "first": "",
        "machines": {
            name: {
                "file": file,
                "runs": f"traces/{file}.js",
                "view": f"page/{file}{VIEW}",
                "script": f"machines/{file}.js" if name in data.get("scripts", ()) else "",
            }
            for name, file in _files(data).items()
        },
    }


def views(data: _Data, made: str) -> Iterator[tuple[str, str]]:
    """Yield file name and script of what belongs to each machine with runs."""
    files, links = _files(data), Links(data, machine_names(data))
    for machine in data["machines"]:
        if machine["name"] in files:
            results = [row for row in data["results"] if row["machine"] == machine["name"]]
            shown = {row["id"]: _result(row, data, links) for row in results if row["id"] in data["runs"]}
            file = files[machine["name"]]
            yield f"{file}{VIEW}", view_script(file, machine, shown, made)


def view_script(file: str, machine: _Data, results: _Data, made: str) -> str:
    """Return the script with what belongs to a machine beside its runs."""
    text = json.dumps(view(machine, results, made), separators=(",", ":"))
    return script(VIEW_FUNCTION, file, data=text.encode())


def machine_script(file: str, target: Target, *, ghosts: bool = True) -> str:
    """Return the script with the machine itself, so that the page can explain its steps and take others.

    ghosts  whether the runs of the page have the ghosts of the machine; a recording may be without
    Nothing for a machine that cannot run as a script: its runs are shown without explanations.
    """
    system = target.system if ghosts else on_board(target.system)
    test = run_file_pieces(target, None) if _can_be_loaded(target) else ()
    first = first_state(system, random.Random(0))
    try:
        text = javascript(system, first=first, test=test, properties=target.properties, with_common=False)
    except InputError:
        return ""
    return script(MACHINE_FUNCTION, file, data=text.encode())


def _can_be_loaded(target: Target) -> bool:
    """Return whether a test of its runs can load the target: by its name alone, or with its configuration's name or file."""
    if target.configuration or target.config_file is not None:
        return True
    return target.given is None and (target.config is None or target.config == type(target.config)())


def _result(row: _Data, data: _Data, links: Links) -> dict[str, Any]:
    broken = [[row["statement"], data["runs"][row["id"]], claim_of(row["id"])]] if row["verdict"] in _BREAKS else []
    is_defence = _DEFENCE.match(row["method"]) is not None
    said = {"verdict": told_of(row), "statement": row["statement"], "at": links.row(row), "broken": broken}
    return {**said, "defence": True} if is_defence else said


def claim_of(result: str) -> str:
    """Return the name of the property that a result is about; of a replay it stands behind the name of the recording."""
    _, kind, name = result.split("/", 2)
    return name.partition(": ")[2] if kind == "replay" else name


def _files(data: _Data) -> dict[str, str]:
    """Return the file name of each machine that has a run."""
    having = {row["machine"] for row in data["results"] if row["id"] in data.get("runs", {})}
    return {name: file for name, file in machine_names(data).items() if name in having}


def view(machine: _Data, results: _Data, made: str) -> dict[str, Any]:
    """Return what the page needs of a machine beside its runs: units and labels, tables, diagrams, and the results.

    results  id -> verdict, statement, place on the report's page, and what is broken, each with the step that breaks it
    """
    configuration = machine["configuration"]
    tolerance = configuration.get("tolerance_mm") if isinstance(configuration, dict) else None
    return {
        "made": made,
        "name": machine["name"],
        "declaration": machine["declaration"][:16],
        "spec": machine["spec"],
        "signals": machine["signals"],
        "reported": machine["reported"],
        "tolerance_mm": tolerance if type(tolerance) is int else None,
        "period_ms": _period_ms(machine["figures"]),
        "parts": [_part(part, machine) for part in machine["parts"]],
        "results": dict(results),
    }


def _period_ms(figures: Sequence[_Data]) -> int | None:
    """Return the length of a step: the configuration's own, else that of all its machines; None if there is none, or several."""
    found = {one["name"]: one["value"] for one in figures if one["name"].split(".")[-1] == "period_ms"}
    lengths = {found["period_ms"]} if "period_ms" in found else set(found.values())
    return int(lengths.pop()) if len(lengths) == 1 else None


def _part(part: _Data, machine: _Data) -> dict[str, Any]:
    """Return name, diagram and table of a machine, with the terms that its guards name, directly or through others, and its laws.

    signals  units and labels of names that it has only where it runs by itself: those that are wired in the composition
    """
    meaning = {line["name"]: line["text"] for line in part["definitions"]}
    table = [{key: row[key] for key in ("name", "source", "target", "guard")} for row in part["table"]]
    terms, left = dict[str, str](), [name for row in table for name in _PART.findall(row["guard"])]
    while left:
        name = left.pop()
        if name in meaning and name not in terms:
            terms[name] = meaning[name]
            left += _PART.findall(meaning[name])
    laws = {law["name"]: [law["id"], law["statement"]] for law in part["clauses"]}
    alone = {} if len(machine["parts"]) == 1 else _signals_alone(part, machine["signals"])
    return {"name": part["name"], "svg": part["svg"], "table": table, "terms": terms, "laws": laws, "signals": alone}


def _signals_alone(part: _Data, known: Collection[str]) -> dict[str, Any]:
    """Return unit and labels of each variable of a member that has another name, or none, in the whole."""
    return {
        one["name"]: {"unit": one["unit"], "members": _members(one)}
        for one in part["variables"]
        if f"{part['name']}.{one['name']}" not in known
    }


def _members(variable: _Data) -> list[str]:
    """Return the labels of an enumeration, out of the words for its range."""
    words = variable["range"]
    return [] if variable["unit"] or words == "true, false" or " .. " in words else words.split(", ")
