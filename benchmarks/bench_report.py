"""How large a report folder is, by kind, and how fast its page opens.

`python -m benchmarks.bench_report FOLDER`: files and megabytes of each kind, how many bytes of content stand for each one
kept, and, where there is a Chromium, milliseconds until the page is usable: as it is, and as one single page.
"""

from __future__ import annotations

import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from safeloc.report.folder import render_folder
from safeloc.runtime.packed import SUFFIX, read_packed

MB = 1_000_000
RUNS = 3
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
USABLE = """<script>addEventListener("load", () => {
document.title = `usable after ${document.body.offsetHeight ? performance.now() : "?"} ms` })</script></body>"""


def main(folder: Path) -> None:
    """Print a line for each kind, then for each form of the page."""
    kinds: dict[str, list[Path]] = {}
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        kinds.setdefault(path.relative_to(folder).parts[0], []).append(path)
    print(f"{'kind':<14} {'files':>6} {'MB':>7} {'unpacked':>9}")
    for kind, files in kinds.items():
        print(f"{kind:<14} {len(files):>6} {_size(files) / MB:>7.2f} {sum(map(_content, files)) / _size(files):>8.1f}x")
    every = [path for files in kinds.values() for path in files]
    print(f"{'in all':<14} {len(every):>6} {_size(every) / MB:>7.2f}")
    if BROWSER is not None:
        with tempfile.TemporaryDirectory() as place:
            copy = Path(shutil.copytree(folder, Path(place, "copy")))
            for form, single in (("in parts", False), ("one page", True)):
                page = render_folder(copy, single=single)
                times = [_usable_ms(BROWSER, page) for _ in range(RUNS)]
                print(f"page {form}: usable after {statistics.median(times):.0f} ms, {page.stat().st_size / MB:.2f} MB")


def _size(files: list[Path]) -> int:
    return sum(path.stat().st_size for path in files)


def _content(path: Path) -> int:
    return len(read_packed(path)) if path.suffix == SUFFIX else path.stat().st_size


def _usable_ms(browser: str, page: Path) -> float:
    """From the request until all is loaded and laid out, in a new browser."""
    timed = page.with_name("timed.html")
    timed.write_text(page.read_text(encoding="utf-8").replace("</body>", USABLE), encoding="utf-8")
    with tempfile.TemporaryDirectory() as profile:
        options = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}"]
        command = [browser, *options, "--window-size=1400,1000", "--dump-dom", timed.as_uri()]
        shown = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = re.search(r"<title>usable after ([\d.]+) ms", shown)
    return float(found[1]) if found else float("nan")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
