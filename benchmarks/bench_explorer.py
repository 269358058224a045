"""How long the page that steps through runs takes to open a run and to show a step, in Chromium.

`python -m benchmarks.bench_explorer [MACHINE [STREAM]]` opens a stream, or the longest recording, of a machine (the localizer): megabytes
of the page, and milliseconds until the run is there, for a step on and for a jump to any step, in the middle of several.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from selenium import webdriver

from safeloc.catalogue import load_target
from safeloc.report.recordings_page import recordings_page
from safeloc.runtime.streams.steps import read_steps

STEPS = 40
TIMED = """
const jump = arguments[0], slider = document.getElementById("run-slider"), times = [];
for (let n = 1; n <= arguments[1]; n += 1) {
    const begun = performance.now();
    slider.value = jump ? (n * 7919) % Number(slider.max) : n;
    slider.dispatchEvent(new Event("input"));
    document.body.offsetHeight;
    times.push(performance.now() - begun);
}
return times;"""


def main(name: str = "localizer", stream: str | None = None) -> None:
    """Print what was measured."""
    target = load_target(name)
    longest = Path(stream) if stream else max(target.streams, key=lambda path: len(read_steps(path).steps))
    with tempfile.TemporaryDirectory() as place:
        page = Path(place, "page.html")
        page.write_text(recordings_page(target, [longest], made="now"), encoding="utf-8")
        print(f"{longest.name}: {len(read_steps(longest).steps)} steps, page of {page.stat().st_size / 1e6:.2f} MB")
        driver = _browser()
        try:
            print(f"the run is there after {_opened_ms(driver, page):.0f} ms")
            for jump, words in ((False, "one step on"), (True, "a jump to any step")):
                times = driver.execute_script(TIMED, jump, STEPS)
                print(f"{words}: {statistics.median(times):.0f} ms, at most {max(times):.0f} ms")
        finally:
            driver.quit()


def _browser() -> Any:
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    for option in ("--headless", "--no-sandbox", "--disable-gpu", "--window-size=1400,1000"):
        options.add_argument(option)
    return webdriver.Chrome(options=options, service=webdriver.ChromeService(shutil.which("chromedriver") or ""))


def _opened_ms(driver: Any, page: Path) -> float:
    begun = time.perf_counter()
    driver.get(page.as_uri())
    while not driver.execute_script("return document.getElementById('run-said').textContent"):
        time.sleep(0.005)
    return (time.perf_counter() - begun) * 1000


if __name__ == "__main__":
    main(*sys.argv[1:])
