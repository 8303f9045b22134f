"""Tasks as a person does them on the page: with held keys, on the simulated arm."""

import pytest

from tests.dashboard.chromium import Browser
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab, opened, soon

pytestmark = pytest.mark.real_time

TASK = """
kind = "waypoints"
title = "Near"
joints = ["shoulder_rotation", "elbow_flexion"]
bounds_rad = [[{left}, {right}], [-0.4, 0.79]]
order = ["here", "there", "here"]
tolerance_rad = 0.04
dwell_s = 0.2
waypoints = [{{ name = "here", at_rad = [{x}, {y}] }}, {{ name = "there", at_rad = [{there}, {y}] }}]
"""
VIEW = "document.querySelector('.jointspace').view"


def near(site: Lab) -> None:
    """A task that begins where the arm is."""
    x, y = (site.angle(name) for name in ("shoulder_rotation", "elbow_flexion"))
    there = x + 0.15 if x < 0.5 else x - 0.15
    left, right = min(x, there) - 0.1, max(x, there) + 0.1
    folder = site.folder / "bentod" / "tasks"
    folder.mkdir(parents=True, exist_ok=True)
    text = TASK.format(left=left, right=right, x=x, y=min(max(y, -0.4), 0.79), there=there)
    (folder / "near.toml").write_text(text)


async def shown(page: Page, task: str) -> None:
    """The part of the page with tasks, and this one chosen."""
    await page.click("#tab-task")
    await page.until(f"!!document.querySelector('#task-choice option[value=\"{task}\"]')")
    await page.fill("#task-choice", task)


async def test_a_way_point_is_reached_with_a_held_key_and_leaves_its_marks(
    browser: Browser, site: Lab
) -> None:
    near(site)
    page = await opened(await browser.page(), site.operator)
    await shown(page, "near")
    await page.eval("window.heard = [], bentod.onEvent((event) => heard.push(event.data.mark))")
    await page.click("#task-start")
    await page.until("bentod.told.task?.phase === 'running'")
    assert await page.eval("bentod.frame.trial.name") == "near"
    way = await page.eval(f"{VIEW}.task.places[1].centre[0] > {VIEW}.task.places[0].centre[0]")
    key = "ArrowRight" if way else "ArrowLeft"
    await page.key_down(key)
    await page.until("bentod.told.task.inside")
    await page.key_up(key)
    await page.until("heard.includes('waypoint there held')")
    assert await page.eval("heard.filter(Boolean)") == ["task near", "waypoint there", "waypoint there held"]
    assert await page.eval("bentod.motion.keys") == []
    assert "Go to here" in await page.eval("document.querySelector('.task-advice').textContent")
    await page.click("#task-stop")
    await page.until("bentod.told.task.phase === 'over'")
    assert site.state()["trial"] is None
    assert not page.problems


async def test_keys_move_the_arm_only_while_held_and_while_the_picture_has_the_focus(page: Page) -> None:
    await shown(page, "")
    await page.eval("document.querySelector('.jointspace').focus()")
    await page.key_down("ArrowUp")
    await page.until("bentod.frame.joints[1].holder.startsWith('client:page')")
    await page.eval("document.querySelector('.jointspace').blur()")
    assert await page.eval("bentod.motion.keys") == []
    await page.key_up("ArrowUp")
    await page.key_down("ArrowUp")
    assert await page.eval("bentod.motion.keys") == []
    await page.key_up("ArrowUp")
    await page.fill(".drive select", "one")
    active = "bentod.frame.groups[0].active"
    before = await page.eval(active)
    await page.eval("document.querySelector('.jointspace').focus()")
    await page.key(" ")
    await page.until(f"{active} !== '{before}'")
    await page.key_down("ArrowLeft")
    moved = "bentod.frame.joints.filter((j) => j.holder.startsWith('client:page')).map((j) => j.name)"
    await page.until(f"{moved}.includes({active})")
    await page.key_up("ArrowLeft")
    await page.until(f"{moved}.length === 0")


async def test_an_observer_sees_the_task_and_drives_nothing(looking: Page) -> None:
    await shown(looking, "maze")
    await looking.until("document.querySelector('#task-start').disabled")
    await looking.eval("document.querySelector('.jointspace').focus()")
    await looking.key_down("ArrowRight")
    assert await looking.eval("bentod.motion.keys") == []
    assert "only operators" in await looking.eval("document.querySelector('.drive-hint').textContent")


async def test_the_picture_shows_the_arm_where_it_is_and_whose_trial_runs(page: Page, site: Lab) -> None:
    await shown(page, "waypoints")
    with site.arm() as arm:
        arm.call("trial_start", name="elsewhere")
    await page.until("document.querySelector('.task-advice').textContent.includes('not watched')")
    await page.click("#task-stop")
    await soon(lambda: site.state()["trial"] is None)
    await page.eval(
        "bentod.feed = () => {};"  # no frame but ours
        f"(() => {{ const v = {VIEW}, f = structuredClone(bentod.frame); f.joints[0].position = -0.11;"
        "f.joints[1].position = 0.21; bentod.frame = f; v._again(); })()"
    )
    colour = (
        "((dx) => {{ const v = {view}, s = v.scale, d = v.canvas.width / s.size.width;"
        "const p = [s.x(-0.11), s.y(0.21)];"
        "return [...v.canvas.getContext('2d').getImageData((p[0] + dx) * d, p[1] * d, 1, 1).data] }})({dx})"
    )
    assert await page.eval(colour.format(view=VIEW, dx=0)) == [0, 0, 0, 255]
    assert await page.eval(colour.format(view=VIEW, dx=9)) == [255, 255, 255, 255]
    degree = await page.eval(f"{VIEW}.scale.x(-0.10) - {VIEW}.scale.x(-0.11)")
    assert degree == pytest.approx(await page.eval(f"0.01 * {VIEW}.scale.perRad"))
