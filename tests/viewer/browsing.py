"""A browser for tests of pages: Debian's chromium, without a screen; tests skip where it is absent."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from surefoot.viewer.live.view import serving

TIMEOUT_MS = 90_000
_ARGUMENTS = (
    "--headless=new --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader --no-first-run "
    "--disable-background-networking --disable-component-update --disable-sync"
)


@dataclass
class Opened:
    """A page, with what it asked for and complained about."""

    page: Any
    requests: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    def open(self, url: str, node: str) -> None:
        """Open an address, and wait until a node of the scene is there."""
        self.requests.clear()
        self.errors.clear()
        self.page.goto(url)
        self.wait(f"window.__viserMutable?.nodePoseData?.[{node!r}] !== undefined")

    def wait(self, condition: str) -> None:
        """Wait until something written in JavaScript holds."""
        self.page.wait_for_function(condition)

    def place(self, node: str) -> list[float]:
        """Return where a node of the scene is."""
        return [float(x) for x in self.page.evaluate(f"window.__viserMutable.nodePoseData[{node!r}].position")]

    def nodes(self, prefix: str) -> set[str]:
        """Return the visible nodes below a name; a picture makes a browser without a screen draw them first."""
        self.page.evaluate("window.__viserMutable.requestRender()")
        self.page.screenshot(timeout=TIMEOUT_MS)
        script = """prefix => Object.entries(window.__viserMutable.nodeRefFromName)
            .filter(([name, node]) => name.startsWith(prefix) && node?.visible).map(([name]) => name)"""
        return set(self.page.evaluate(script, prefix))

    def caption(self) -> str:
        """Return what the page says of the moment."""
        return str(self.page.inner_text("#surefoot-caption"))

    def time_s(self) -> float:
        """Return the moment that the slider stands at."""
        return float(self.page.get_attribute("[role=slider]", "aria-valuenow"))

    def go_to(self, time_s: float) -> None:
        """Type a moment into the field beside the slider."""
        box = self.page.locator("input[inputmode=decimal]")
        box.fill(f"{time_s:.4f}")
        box.press("Enter")
        self.wait(f"Math.abs(document.querySelector('[role=slider]').ariaValueNow - {time_s}) < 0.06")


@contextmanager
def browser() -> Iterator[Opened]:
    """Yield a page of a browser without a screen."""
    path = shutil.which("chromium")
    if path is None:
        pytest.skip("chromium is not installed, so no page is opened")
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed, so no page is opened")
    with sync_api.sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=path, args=_ARGUMENTS.split(), timeout=TIMEOUT_MS)
        page = running.new_page(viewport={"width": 700, "height": 460})
        page.set_default_timeout(TIMEOUT_MS)
        opened = Opened(page)
        page.on("request", lambda request: opened.requests.append(request.url))
        page.on("pageerror", lambda error: opened.errors.append(str(error)))
        page.on("console", lambda said: opened.errors.append(said.text) if said.type == "error" else None)
        yield opened
        running.close()


@contextmanager
def followed(run_folder: Path) -> Iterator[Opened]:
    """Yield a page of a browser that looks at the live view of a run."""
    stop = threading.Event()
    with serving(run_folder, None) as (address, view), browser() as one:
        thread = threading.Thread(target=view.run, args=(stop,))
        thread.start()
        one.open(address, "/robot/trunk")
        yield one
        stop.set()
        thread.join()
