"""How long the pages of a report take to open and to show a step, in Chromium: by the clock, and in processor time of the page.

`python -m benchmarks.bench_explorer [MACHINE [STREAM]]` opens a stream, or the longest recording, of a machine (the localizer): megabytes
of the page, and milliseconds until the run is there, for a step on and for a jump to any step, in the middle of several.
`python -m benchmarks.bench_explorer FOLDER` opens the page of a report several times.

The clock also counts what other programs take from the processor; the time of the page's own thread hardly does. Every step is drawn
before the next one is asked for.
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

STEPS, OPENINGS = 40, 5
TIMED = """
const [jump, steps, done] = arguments, slider = document.getElementById("run-slider"), times = [];
function show() {
    const begun = performance.now(), n = times.length + 1;
    if (n > steps) return done(times);
    slider.value = jump ? (n * 7919) % Number(slider.max) : n;
    slider.dispatchEvent(new Event("input"));
    requestAnimationFrame(() => setTimeout(() => { times.push(performance.now() - begun); setTimeout(show); }));
}
show();"""


def main(name: str = "localizer", stream: str | None = None) -> None:
    """Print what was measured."""
    if Path(name, "index.html").is_file():
        _report(Path(name, "index.html"))
        return
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
                before = _processor_ms(driver)
                times = driver.execute_async_script(TIMED, jump, STEPS)
                own = (_processor_ms(driver) - before) / STEPS
                print(
                    f"{words}: {own:.0f} ms of the page's processor time; drawn after {statistics.median(times):.0f} ms"
                )
        finally:
            driver.quit()


def _report(page: Path) -> None:
    """Print how long the page of a report takes until it is loaded and laid out."""
    driver = _browser()
    try:
        for _ in range(OPENINGS):
            driver.get("about:blank")
            begun = time.perf_counter()
            driver.get(page.absolute().as_uri())
            driver.execute_script("return document.body.offsetHeight")
            took = (time.perf_counter() - begun) * 1000
            print(
                f"the report is there after {took:.0f} ms; {_processor_ms(driver):.0f} ms of the page's processor time"
            )
    finally:
        driver.quit()


def _browser() -> Any:
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    for option in ("--headless", "--no-sandbox", "--disable-gpu", "--window-size=1400,1000"):
        options.add_argument(option)
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(shutil.which("chromedriver") or ""))
    driver.set_script_timeout(300)
    driver.execute_cdp_cmd("Performance.enable", {"timeDomain": "threadTicks"})
    return driver


def _processor_ms(driver: Any) -> float:
    """Return the processor time that the main thread of the page has used since it was opened."""
    metrics = driver.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]
    return float(next(one["value"] for one in metrics if one["name"] == "TaskDuration")) * 1000


def _opened_ms(driver: Any, page: Path) -> float:
    begun = time.perf_counter()
    driver.get(page.as_uri())
    while not driver.execute_script("return document.getElementById('run-said').textContent"):
        time.sleep(0.005)
    return (time.perf_counter() - begun) * 1000


if __name__ == "__main__":
    main(*sys.argv[1:])
