"""Regenerate the gallery: docs/gallery.md and its pictures in docs/images/gallery/.

    python docs/make_gallery.py    # about eight minutes

Pages are photographed with Debian's chromium and playwright; without them the photographs stay as they are.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
import threading
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from PIL import Image

DOCS = Path(__file__).parent
SCENES = DOCS.parent / "scenes"
PICTURES = DOCS / "images" / "gallery"
WIDTH_PX, LARGEST_BYTES = 1100, 200_000
STEPS = 500
PUSHED_SEED = 3  # no push makes the robot fall
QUADRUPED_SEEDS = 3
FLAGS = (
    "--headless=new --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader "
    "--disable-background-networking"
)


def keep(picture: Path, name: str) -> None:
    """Take a picture into the gallery, small enough for a repository."""
    with Image.open(picture) as image:
        image.load()
    small = image.convert("RGB")
    for width, colours in ((WIDTH_PX, 256), (WIDTH_PX, 64), (800, 64), (600, 32)):
        scaled = small.copy()
        scaled.thumbnail((width, 3 * width), Image.Resampling.LANCZOS)
        out = PICTURES / f"{name}.png"
        scaled.quantize(colours, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(out, optimize=True)
        if out.stat().st_size < LARGEST_BYTES:
            return
    raise SystemExit(f"{out} stays larger than {LARGEST_BYTES} bytes")


def mission(work: Path) -> dict[str, object]:
    """Walk the two rooms, and draw plan, run and strategy."""
    from surefoot.frames import Cell
    from surefoot.missions.biped.mission import run_mission
    from surefoot.missions.plans.planning import plan_mission
    from surefoot.viewer import view_answers, view_plan, view_run
    from surefoot.viewer.maps.answers import Asked

    scene, plan, run = SCENES / "two_rooms_mission.yaml", work / "plan", work / "run"
    plan_mission(scene, plan)
    walked = run_mission(scene, plan, steps=STEPS, seed=0, obstacle="random", out=run)
    for picture in (*view_plan(plan, work), *view_run(run, work)):
        keep(picture, f"mission_{picture.stem}")
    (answers,) = view_answers(plan, Asked(Cell(3, 4)), work)
    keep(answers, "mission_answers")
    return {"turns": walked.turns, "corrections": walked.waypoint_corrections, "goals": sum(walked.goals_reached)}


def pushes(work: Path) -> dict[str, object]:
    """Walk the two rooms while somebody pushes, and draw a step that a region's law recovered."""
    from surefoot.missions.biped.mission import run_mission
    from surefoot.missions.biped.run_log import read_run
    from surefoot.missions.pushes.source import push_source
    from surefoot.viewer import view_step

    run = work / "pushed"
    walked = run_mission(
        SCENES / "two_rooms_mission.yaml", work / "plan", steps=STEPS, seed=PUSHED_SEED, obstacle="random", out=run,
        pushes=push_source("random", PUSHED_SEED, {}),
    )  # fmt: skip
    steps = [one for one in read_run(run).steps if one.push is not None and one.push.recovery == "region"]
    chosen = max(steps, key=lambda one: len(one.push.omegas_before_switch + one.push.omegas_after_switch))
    keep(view_step(run, chosen.step, work)[0], "pushes_step")
    names = ("pushes", "recovered_in_region", "recovered_by_step", "falls")
    return {name: getattr(walked, name) for name in names}


def regions(work: Path) -> dict[str, object]:
    """Synthesise the regions of a step, and draw them."""
    from surefoot.reach import load_region
    from surefoot.reach.winning_sets import KeyframeStep, initial_winning_set
    from surefoot.viewer.steps.omegas import draw_omegas
    from surefoot.viewer.steps.regions import draw_all

    command("reach --step-length 0.52 --apex-velocity 0.45 0.7 --disturbance rate --save", work / "step")
    region = load_region(work / "step.json")
    single = work / "winning_set.png"  # one of the sets that winning_sets.png shows
    for picture in {*draw_all(region, work), draw_omegas(region, work / "omegas.png")} - {single}:
        keep(picture, f"region_{picture.stem}")
    sets = [initial_winning_set(KeyframeStep(v, height_change_m=-0.2)).size for v in (0.5, 0.6, 0.7)]
    return {"cells": region.counts, "sets": " / ".join(map(str, sets)), "ms": round(1e3 * region.time_s, 1)}


def footholds(work: Path) -> dict[str, object]:
    """Solve a foothold program, and draw it."""
    from surefoot.footholds import read_problem, solve, write_plan
    from surefoot.viewer import view_folder

    problem = read_problem(SCENES / "footholds" / "stones.yaml")
    solution = solve(problem)
    write_plan(work / "stones.json", problem, solution)
    keep(view_folder(work / "stones.json")[0], "footholds_stones")
    return {"gap": f"{solution.gap:.1e}", "cpu": round(solution.solve_cpu_ms)}


def baselines(work: Path) -> None:
    """Measure and draw the baselines of the foothold programs."""
    command("footholds baselines --seeds 2 --horizon 3 --time-limit 10 -o", work)
    keep(work / "horizons.png", "baselines_horizons")
    keep(work / "nearest.png", "baselines_nearest")


def quadruped(work: Path) -> dict[str, object]:
    """Walk over bars, around an obstacle, against the nearest foothold, and on turned ground; draw all that."""
    from surefoot.missions.bench.campaign import Campaign
    from surefoot.missions.bench.quadruped import measure
    from surefoot.missions.bench.tables import nearest_rows, turned_rows
    from surefoot.viewer.studies.quadruped import draw_ways

    campaign = Campaign(work / "campaign", ("rebar-7",), range(QUADRUPED_SEEDS))
    found = measure(campaign)
    for picture in draw_ways(campaign, found, work / "ways"):
        keep(picture, f"quadruped_{picture.stem}")
    nearest = (
        f"| {one.scene}{', thinned' if one.thinned else ''} | {one.planner} | {one.whole} of {one.ways} "
        f"| {one.out_of_reach:.1%} | {one.off_polygon:.1%} |"
        for one in nearest_rows(found.straight)
    )
    turned = (
        f"| {one.scene} | {one.angle_deg} | {one.polygons:.1f} | {one.binaries:.0f} "
        f"| {one.least_ms or 0:.0f}, {one.mean_ms or 0:.0f}, {one.most_ms or 0:.0f} |"
        for one in turned_rows(found.turned)
    )
    slowest = max((one.first_ms or 0.0 for one in found.detours), default=0.0)
    return {
        "slowest": f"{slowest:.1f}",
        "nearest": "\n".join(nearest),
        "turned": "\n".join(turned),
        "seeds": QUADRUPED_SEEDS,
    }


def classes(work: Path) -> None:
    """Draw terrain classes."""
    from surefoot.skills.classes import class_set
    from surefoot.viewer.terrain.classes import draw_classes

    keep(draw_classes(class_set("unstructured-8"), work / "classes.png"), "skills_classes")


def walk(work: Path) -> dict[str, object]:
    """Walk a quadruped over stones and gaps, and draw the walk and the skills that it found."""
    from surefoot.missions.quadruped.mission import QuadrupedOrder, run_quadruped
    from surefoot.viewer import view_folder, view_run

    command("skills terrain unstructured-4 --seed 0 -o", work / "ground.yaml")
    walked = run_quadruped(QuadrupedOrder(work / "ground.yaml"), work / "walk")
    for picture in (*view_run(work / "walk", work / "walk"), *view_folder(work / "ground.yaml", work)):
        keep(picture, f"walk_{picture.stem}")
    return {"transitions": walked.transitions, "skills": walked.new_skills, "seconds": round(walked.walked_s, 1)}


def zigzag(work: Path) -> dict[str, object]:
    """Walk a quadruped along a zig-zag, turning in place, and draw the walk."""
    from surefoot.missions.quadruped.mission import QuadrupedOrder, run_quadruped
    from surefoot.viewer import view_run

    command("skills terrain zig-zag --yaw --no-sideways -o", work / "zigzag.yaml")
    walked = run_quadruped(QuadrupedOrder(work / "zigzag.yaml"), work / "zigzag")
    keep(view_run(work / "zigzag", work / "zigzag")[0], "zigzag_map")
    return {"transitions": walked.transitions, "seconds": round(walked.walked_s, 1), "idle": round(walked.idle_s, 2)}


def photographs(work: Path) -> None:
    """Photograph the pages of the runs, the foothold plan and the strategies, and the live views."""
    from surefoot.viewer import view_page

    command(f"synth {SCENES / 'specifications' / 'tank.structuredslugs'} -o", work / "tank.json")
    pages = {
        "page_walk": (view_page(work / "walk", work / "walk.html"), "follow", 6.0),
        "page_specification": (view_page(work / "tank.json", work / "tank.html"), None, 0.0),
        "page_replay": (view_page(work / "run", work / "replay.html"), "overview", 41.0),
        "page_replay_follow": (work / "replay.html", "follow", 60.0),
        "page_footholds": (view_page(work / "stones.json", work / "footholds.html"), "overview", 0.8),
        "page_strategy": (view_page(work / "plan", work / "strategy.html"), None, 0.0),
    }
    chromium = shutil.which("chromium")
    if chromium is None:
        print("chromium is not installed: the photographs of pages stay as they are")
        return
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS.split(), timeout=90_000)
        page = browser.new_page(viewport={"width": 1000, "height": 640})
        page.set_default_timeout(90_000)
        for name, (file, camera, time_s) in pages.items():
            page.goto(file.as_uri())
            if camera is not None:
                page.wait_for_function("window.__viserMutable?.nodePoseData?.['/robot/trunk'] !== undefined")
                page.keyboard.press("Space")
                page.get_by_role("button", name=camera, exact=True).click()
                page.locator("#webgl-software-rendering button").click()
                page.locator("input[inputmode=decimal]").fill(str(time_s))
                page.locator("input[inputmode=decimal]").press("Enter")
                page.wait_for_timeout(4000)
            page.screenshot(path=work / f"{name}.png", timeout=90_000)
            keep(work / f"{name}.png", name)
        live(page, work)
        browser.close()


def live(page: Any, work: Path) -> None:
    """Photograph live views: of a walk of which half is logged, and of a strategy."""
    from surefoot.viewer.browser.page import HOST, server
    from surefoot.viewer.live.strategy import StrategyView
    from surefoot.viewer.live.strategy_choices import Question
    from surefoot.viewer.live.view import serving

    log = work / "walk" / "run.jsonl"
    lines = log.read_text("utf-8").splitlines(keepends=True)
    log.write_text("".join(lines[: len(lines) // 2]), "utf-8")
    stop = threading.Event()
    with serving(work / "walk", None) as (address, view):
        following = threading.Thread(target=view.run, args=(stop,))
        following.start()
        photograph(page, address, "/robot/trunk", work / "live_walk.png")
        stop.set()
        following.join()
    with server() as running:
        shown = StrategyView(running, work / "plan")
        one = shown.book.strategy
        decisions = zip(one.goal.tolist(), one.heading.tolist(), one.state.tolist(), strict=True)
        known = Counter(decision for decision in decisions if any(one.states[decision[2]].hidden))
        (goal, heading, state), _ = known.most_common(1)[0]
        shown.ask(Question(goal, heading, None, one.states[state].visible, state))
        photograph(page, f"http://{HOST}:{running.get_port()}", "/orders", work / "live_strategy.png")


def photograph(page: Any, address: str, node: str, path: Path) -> None:
    """Photograph a live view when a node of its scene is there."""
    page.goto(address)
    page.wait_for_function(f"window.__viserMutable?.nodePoseData?.[{node!r}] !== undefined")
    page.wait_for_timeout(6000)
    page.locator("#webgl-software-rendering button").click()
    page.wait_for_timeout(1000)
    page.screenshot(path=path, timeout=90_000)
    keep(path, path.stem)


def command(line: str, *paths: Path) -> None:
    """Run a command of the command line."""
    from surefoot.cli import main

    if main([*line.split(), *map(str, paths)]) != 0:
        raise SystemExit(f"surefoot {line} failed")


def main() -> None:
    """Make every picture, and the page."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    PICTURES.mkdir(parents=True, exist_ok=True)
    numbers: dict[str, dict[str, object]] = {}
    steps: tuple[Callable[[Path], dict[str, object] | None], ...]
    steps = (mission, pushes, regions, footholds, classes, walk, zigzag, photographs, baselines, quadruped)
    with tempfile.TemporaryDirectory() as folder:
        for step in steps:
            print(step.__name__, flush=True)
            numbers[step.__name__] = step(Path(folder)) or {}
    template = (DOCS / "gallery.md.in").read_text("utf-8")
    (DOCS / "gallery.md").write_text(template.format(**numbers, steps=STEPS), "utf-8")


if __name__ == "__main__":
    main()
