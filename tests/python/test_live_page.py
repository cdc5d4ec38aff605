"""The page of the live view in Chromium, with the mouse and the keys of a user."""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import skerry as sk
from browser import Tab, open_browser
from worlds import ball_world, skip_without_live_view

skip_without_live_view()

# Keeps the messages that the page sends, and errors such as those of shaders.
KEEP_SENT = """
window.sent = [];
window.complaints = [];
console.error = (...words) => window.complaints.push(words.join(" "));
const send = WebSocket.prototype.send;
WebSocket.prototype.send = function (text) { window.sent.push(JSON.parse(text)); send.call(this, text); };
"""


DRAWN = "Number(document.documentElement.dataset.drawn)"
PAUSED = "document.documentElement.dataset.playing === 'false'"


@pytest.fixture(scope="module")
def tab() -> Iterator[Tab]:
    with open_browser() as opened:
        opened.call("Page.enable")
        opened.call("Page.addScriptToEvaluateOnNewDocument", source=KEEP_SENT)
        yield opened


@contextmanager
def running(tab: Tab, shown: sk.World | sk.Scene, **options: Any) -> Iterator[sk.View]:
    """A view that runs on another thread, and its page, which has drawn some frames."""
    view = sk.view(shown, open=False, **options)
    thread = threading.Thread(target=view.run)
    thread.start()
    try:
        tab.open(view.address)
        tab.wait(f"document.documentElement.dataset.ready && ({PAUSED} || {DRAWN} > 5)")
        yield view
        assert tab.evaluate("window.complaints") == []
    finally:
        view.close()
        thread.join()
    assert "error" not in tab.marks()


def place_of(tab: Tab, text: str) -> tuple[float, float]:
    """A place in the window where the tip at the pointer contains a text."""
    place = tab.evaluate(
        """(async () => {
        const canvas = document.querySelector("#view > canvas:not(#overlay)"), box = canvas.getBoundingClientRect();
        const tip = document.getElementById("tip");
        for (let i = 0; i < 400; ++i) {
          const turn = 2.4 * i, x = box.x + box.width / 2 + 10 * Math.sqrt(i) * Math.cos(turn),
            y = box.y + box.height / 2 + 10 * Math.sqrt(i) * Math.sin(turn);
          canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: x, clientY: y, pointerType: "mouse" }));
          if (!tip.hidden && tip.textContent.includes(TEXT)) return [x, y];
        }
        })()""".replace("TEXT", json.dumps(text))
    )
    assert place, f"no tip contains {text!r}"
    return place[0], place[1]


def time_of(tab: Tab) -> float:
    """Simulated time of the picture [s]."""
    return float(tab.marks()["time"])


def times_of(world: sk.World) -> list[float]:
    """List to which each step appends the time of the world [s]. Other threads cannot read it while the view runs."""
    times: list[float] = []
    world.watch_steps(lambda _: times.append(world.time))
    return times


def settled_time(tab: Tab, times: list[float]) -> float:
    """Simulated time of the picture as soon as it shows the last step before a pause [s]."""
    tab.wait(f"Math.abs(Number(document.documentElement.dataset.time) - {times[-1]!r}) < 1e-9")
    return time_of(tab)


def test_the_page_shows_the_run_and_hides_its_token(tab: Tab) -> None:
    with running(tab, ball_world()[0], title="a <ball>") as view:
        tab.wait("Number(document.documentElement.dataset.time) > 0.1")
        assert tab.evaluate("document.getElementById('title').textContent") == "a <ball>"
        assert tab.marks()["live"] == "open"
        token = view.address.rpartition("=")[2]
        assert token not in tab.evaluate("location.href + document.documentElement.outerHTML")
        place_of(tab, "ball")
        tab.press("f")  # flat surfaces have other shaders
        tab.wait(f"{DRAWN} > {tab.evaluate(DRAWN) + 1}")
        assert tab.evaluate("window.complaints") == []
        tab.call("Page.reload")
        tab.wait("document.documentElement?.dataset.ready")
        assert view.is_open
    tab.wait("document.documentElement.dataset.live === 'lost'")


def test_the_run_pauses_steps_and_starts_again(tab: Tab) -> None:
    world, _, _ = ball_world()
    step, times = world.stable_step, times_of(world)
    with running(tab, world):
        tab.click("#play")
        tab.wait(PAUSED)
        tab.wait("document.getElementById('play').getAttribute('aria-label') === 'Play'")
        paused = settled_time(tab, times)
        tab.click("#step")
        tab.wait(f"Number(document.documentElement.dataset.time) > {paused}")
        assert settled_time(tab, times) - paused == pytest.approx(step, rel=0.5)
        tab.press("Home")
        tab.wait("Number(document.documentElement.dataset.time) === 0")
        assert tab.marks()["playing"] == "false"
        tab.click("#play")
        tab.wait("document.documentElement.dataset.playing === 'true'")
        tab.wait("Number(document.documentElement.dataset.time) > 0.05")


def test_slow_motion_takes_shorter_calls(tab: Tab) -> None:
    world, ball, _ = ball_world()
    times = times_of(world)
    with world.recorder({"ball": sk.BodyProbe(ball)}) as recorder, running(tab, world):
        tab.evaluate(
            "((select) => { select.value = '0.1'; select.dispatchEvent(new Event('change')); })"
            "(document.querySelector('#rate select'))"
        )
        tab.wait("window.sent.some((message) => message.do === 'rate' && message.value === 0.1)")
        tab.click("#play")
        tab.wait(PAUSED)
        paused = settled_time(tab, times)
        tab.click("#play")
        tab.wait(f"Number(document.documentElement.dataset.time) > {paused}")
    assert np.diff(recorder.table()["time"])[-1] == pytest.approx(0.1 / 60, rel=1e-6)


def test_stress_is_sent_when_it_is_shown(tab: Tab) -> None:
    world, ball, _ = ball_world()
    world.advance(0.08)  # the ball is pressed flat
    with running(tab, world, paused=True):
        tab.press("2")
        tab.wait("document.documentElement.dataset.color === 'stress'")
        tab.wait("window.sent.some((message) => (message.names || []).includes('stress'))")
        tab.wait("/[1-9].*Pa/.test(document.getElementById('color_legend').textContent)")
        place_of(tab, "von Mises stress")


SCENE = {
    "settings": {"gravity": [0, 0, -10], "threads": 1},
    "materials": {"rubber": {"E": 2e5, "nu": 0.4, "rho": 1000}},
    "bodies": [
        {"name": "ball", "mesh": {"ball": {"radius": 0.05, "resolution": 4}}, "material": "rubber"},
    ],
    "colliders": [{"name": "wall", "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "position": [0.5, 0, 0]}],
    "sliders": [{"name": "push", "collider": "wall", "along": [1, 0, 0], "low": -0.1, "high": 0.1}],
    "probes": [{"name": "center", "quantity": "motion", "body": "ball"}],
}


def test_a_slider_moves_a_collider_and_gravity_can_be_switched(tab: Tab) -> None:
    scene = sk.load_scene(SCENE)
    recorder = scene.world.recorder({"center": sk.BodyProbe(scene.world.bodies["ball"])})
    with recorder, running(tab, scene):
        tab.click("#gravity")
        tab.evaluate(
            "((slider) => { slider.value = 0.1; slider.dispatchEvent(new Event('input')); })"
            "(document.getElementById('slider_0'))"
        )
        tab.wait("/100.mm/.test(document.querySelector('#sliders output').textContent)")
        begun = time_of(tab)
        tab.wait(f"Number(document.documentElement.dataset.time) > {begun + 1}")
        assert "center" in tab.evaluate("document.getElementById('probe_plots').textContent")
    assert scene.world.colliders["wall"].pose.position == pytest.approx((0.6, 0, 0), abs=1e-9)
    table = recorder.table()
    late = table["center.velocity_z"][-20:]
    assert np.ptp(late) < 1e-9 * np.abs(late).max()  # free flight without gravity


def test_a_body_pulled_with_the_mouse_moves_as_a_critically_damped_spring(tab: Tab) -> None:
    """The body hardly turns, because its moment of inertia is large: the displacement is 1 - (1 + w t) exp(-w t) of the
    way from the point taken to the mouse, with w = 2 pi 2 Hz."""
    world = sk.World(gravity=(0, 0, 0), threads=1, step_size=1e-3)
    given: Any = {"mass": 1, "center_of_mass": (0, 0, 0), "inertia": 1e5 * np.eye(3)}
    body = world.add_body(sk.Mesh.ball(0.1, 6).boundary(), sk.Material(), dynamics="rigid", **given)
    with world.recorder({"ball": sk.BodyProbe(body)}) as recorder, running(tab, world):
        x, y = place_of(tab, "body")
        tab.mouse("Pressed", x, y)
        tab.wait("window.sent.some(({ do: name }) => name === 'pull')")
        tab.mouse("Moved", x + 60, y - 40)
        tab.wait("window.sent.some(({ do: name }) => name === 'move')")
        begun = time_of(tab)
        tab.wait(f"Number(document.documentElement.dataset.time) > {begun + 0.8}")
        tab.mouse("Released", x + 60, y - 40)
        tab.wait("window.sent.some(({ do: name }) => name === 'release')")
        sent = tab.evaluate("window.sent")
        released = time_of(tab)
    (pull,) = [message for message in sent if message["do"] == "pull"]
    (move,) = [message for message in sent if message["do"] == "move"]
    way = np.array(move["to"]) - np.array(pull["point"])
    assert pull["body"] == 0 and np.linalg.norm(way) > 0.02
    table = recorder.table()
    moved = np.stack([table[f"ball.displacement_{axis}"] for axis in "xyz"], axis=1)
    start = np.flatnonzero(np.linalg.norm(moved, axis=1) > 1e-4 * np.linalg.norm(way))[0] - 1
    t = table["time"] - table["time"][start]
    w = 2 * math.pi * 2
    expected = 1 - (1 + w * t) * np.exp(-w * t)
    held = (t > 0) & (table["time"] < released)
    assert held.sum() > 20
    assert moved[held] == pytest.approx(expected[held, None] * way, abs=0.01 * float(np.linalg.norm(way)))


def test_a_body_is_pulled_with_keys(tab: Tab) -> None:
    """After 0.8 s a critically damped spring of 2 Hz has moved the body by 99.95 % of the way."""
    world = sk.World(gravity=(0, 0, 0), threads=1, step_size=1e-3)
    given: Any = {"mass": 1, "center_of_mass": (0, 0, 0), "inertia": 1e5 * np.eye(3)}
    body = world.add_body(sk.Mesh.ball(0.1, 6).boundary(), sk.Material(), dynamics="rigid", **given)
    with running(tab, world):
        tab.press("q")
        tab.wait("window.sent.some(({ do: name }) => name === 'pull')")
        for key in ("ArrowUp", "ArrowUp", "ArrowLeft"):
            tab.press(key)
        tab.wait("window.sent.some(({ do: name }) => name === 'move')")
        begun = time_of(tab)
        tab.wait(f"Number(document.documentElement.dataset.time) > {begun + 0.8}")
        tab.press("q")
        tab.wait("window.sent.some(({ do: name }) => name === 'release')")
        sent = tab.evaluate("window.sent")
    assert not [message for message in sent if message["do"] == "step"]
    (pull,) = [message for message in sent if message["do"] == "pull"]
    way = np.array([message["to"] for message in sent if message["do"] == "move"][-1]) - np.array(pull["point"])
    assert way[2] > 0.01  # z is up
    assert body.center_of_mass == pytest.approx(way, abs=0.01 * float(np.linalg.norm(way)))


def test_the_legend_can_be_folded_in_a_small_window(tab: Tab) -> None:
    shown = "document.getElementById('color_legend').offsetHeight > 0"
    size = {"height": 800, "deviceScaleFactor": 1, "mobile": False}
    with running(tab, ball_world()[0]):
        try:
            tab.call("Emulation.setDeviceMetricsOverride", width=1280, **size)
            tab.wait(f"{shown} && document.querySelector('[data-switch=legend]').offsetHeight === 0")
            tab.call("Emulation.setDeviceMetricsOverride", width=420, **size)
            for state in (f"!({shown})", shown):
                tab.click("[data-switch=legend]")
                tab.wait(state)
        finally:
            tab.call("Emulation.clearDeviceMetricsOverride")


def test_a_page_with_a_wrong_token_says_so(tab: Tab, tmp_path: Path) -> None:
    with sk.view(ball_world()[0], open=False) as view:
        tab.open(view.address[:-8] + "00000000")
        tab.wait("document.documentElement.dataset.live === 'refused'")
        assert "token" in tab.evaluate("document.getElementById('notice').textContent")
        assert view.client_count == 0
