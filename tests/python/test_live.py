"""The live view as programs see it: refusals of the server, its messages, and commands of clients."""

from __future__ import annotations

import base64
import itertools
import math
import re
import stat
import time
import urllib.parse
import webbrowser
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import skerry as sk
from live_client import advance, answer_to, connect, place_of, status_of, upgrade
from worlds import ball_world, skip_without_live_view

skip_without_live_view()


@pytest.fixture(scope="module")
def shared() -> Any:
    """A view for tests that leave it as it is."""
    with sk.view(ball_world()[0], open=False) as opened:
        yield opened


# Requests that are refused.


def test_the_page_is_served_without_secrets(shared: sk.View) -> None:
    port, token = place_of(shared)
    answer = answer_to(port, "GET / HTTP/1.1", f"Host: 127.0.0.1:{port}", "Connection: close")
    head = answer.split(b"\r\n\r\n")[0].lower()
    assert status_of(answer) == 200 and b"<!doctype html" in answer[: len(head) + 400].lower()
    assert b"content-security-policy:" in head and b"nosniff" in head and b"no-store" in head
    assert token.encode() not in answer


def test_the_server_listens_on_the_loopback_address_only(shared: sk.View) -> None:
    port, _ = place_of(shared)
    listening = [
        line.split()[1]
        for table in ("/proc/net/tcp", "/proc/net/tcp6")
        for line in Path(table).read_text().splitlines()[1:]
        if line.split()[3] == "0A" and int(line.split()[1].rsplit(":")[1], 16) == port
    ]
    assert listening == [f"0100007F:{port:04X}"]


def test_the_right_token_connects(shared: sk.View) -> None:
    port, token = place_of(shared)
    assert len(token) >= 32
    assert status_of(answer_to(port, *upgrade(port, token), seconds=0.3)) == 101
    local = {"Host": f"localhost:{port}", "Origin": f"http://localhost:{port}"}
    assert status_of(answer_to(port, *upgrade(port, token, **local), seconds=0.3)) == 101


@pytest.mark.parametrize(
    "changes",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": None},
        {"Origin": "https://127.0.0.1:PORT"},
        {"Origin": "http://127.0.0.1:1"},
        {"Origin": "http://127.0.0.1:PORT.evil.example"},
        {"Host": "evil.example"},
        {"Host": "evil.example:PORT"},
        {"Host": "127.0.0.1"},
        {"Host": None},
    ],
    ids=str,
)
def test_a_foreign_origin_or_host_is_refused(shared: sk.View, changes: dict[str, str | None]) -> None:
    port, token = place_of(shared)
    given = {name: value and value.replace("PORT", str(port)) for name, value in changes.items()}
    answer = answer_to(port, *upgrade(port, token, **given))
    assert status_of(answer) in (400, 403) and b"ball" not in answer


@pytest.mark.parametrize("host", ["evil.example", "evil.example:PORT", "127.0.0.1:1", "[::1]:PORT"])
def test_the_page_is_refused_to_a_foreign_host(shared: sk.View, host: str) -> None:
    port, _ = place_of(shared)
    answer = answer_to(port, "GET / HTTP/1.1", f"Host: {host.replace('PORT', str(port))}", "Connection: close")
    assert status_of(answer) == 403 and len(answer) < 2000


def test_a_wrong_token_is_refused(shared: sk.View) -> None:
    port, token = place_of(shared)
    wrong = ("0" if token[0] != "0" else "1") + token[1:]
    for given in (None, "", wrong, token[:-1], token + "0", token.swapcase() + "!", "%00" + token):
        answer = answer_to(port, *upgrade(port, given))
        assert status_of(answer) == 403, given


def test_nothing_but_the_page_is_served(shared: sk.View) -> None:
    port, token = place_of(shared)
    for target in ("/etc/passwd", "/../../etc/passwd", "/%2e%2e/", "/live", "/index.html", f"/?token={token}x" * 500):
        answer = answer_to(port, f"GET {target} HTTP/1.1", f"Host: 127.0.0.1:{port}", "Connection: close")
        assert status_of(answer) >= 400, target
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "PROPFIND"):
        lines = [f"{method} / HTTP/1.1", f"Host: 127.0.0.1:{port}", "Content-Length: 0", "Connection: close"]
        assert status_of(answer_to(port, *lines)) >= 400, method


# Messages to clients.


def test_a_client_gets_the_run_and_then_rows_with_frames(view: sk.View) -> None:
    with connect(view) as client:
        client.wait(lambda: client.frames)
        for _ in range(5):
            advance(client)
        assert client.messages[0]["type"] == "begin"
        assert [body for more in client.of_type("add") for body in more["bodies"]] == ["ball"]
        assert client.state == {"playing": True, "rate": 1, "gravity": True}
        assert [row["number"] for row in client.rows] == sorted({row["number"] for row in client.rows})
        last = client.rows[-1]
        assert last["time"] == pytest.approx(view.world.time, abs=1e-12)
        assert last["kinetic"] == pytest.approx(view.world.energy.kinetic, rel=1e-6)


def inflated_frames(page: str) -> bytes:
    """The stream of all frames of a page."""
    packed = re.search(r'id="frames"[^>]*>([^<]*)<', page)
    assert packed
    return zlib.decompress(base64.b64decode(packed[1]))


def test_frames_have_the_bytes_of_a_recorded_page() -> None:
    world, _, _ = ball_world()
    with sk.view(world, open=False) as view, connect(view) as client:
        client.send("fields", names=["stress", "strain", "error"])
        client.settle()
        client.wait(lambda: client.frames)
        for _ in range(10):
            advance(client)
        live, times = client.frames, [row["time"] for row in client.rows]
    again, _, _ = ball_world()
    with again.record(every=0) as film:
        for before, after in itertools.pairwise(times):
            again.advance(0.01 if after > before else 0)  # View.sync() may show a state twice
    assert b"".join(live) == inflated_frames(film.show().html)
    assert again.state_hash == world.state_hash


def test_two_clients_are_served_and_a_fifth_is_refused(view: sk.View) -> None:
    with connect(view) as first, connect(view) as second, connect(view), connect(view):
        view.world.advance(0.01)
        for client in (first, second):
            client.wait(lambda: client.rows and client.rows[-1]["time"] > 0)  # noqa: B023
        with connect(view) as fifth:
            fifth.wait(lambda: fifth.of_type("problem"))
            assert "found 4 browsers" in fifth.of_type("problem")[0]["text"] and not fifth.frames
        assert view.client_count == 4


def test_a_looking_client_does_not_change_the_bits(view: sk.View) -> None:
    alone, _, _ = ball_world()
    with connect(view) as client:
        for _ in range(10):
            advance(client)
            alone.advance(0.01)
    assert view.world.state_hash == alone.state_hash


# Commands.


def test_commands_change_the_world_and_all_clients_see_it(view: sk.View) -> None:
    world = view.world
    with connect(view) as client, connect(view) as other:
        client.send("gravity", on=False)
        other.wait(lambda: other.state.get("gravity") is False)
        assert tuple(world.settings.gravity) == (0, 0, 0)
        client.send("gravity", on=True)
        client.send("rate", value=0.25)
        client.send("pause")
        other.wait(lambda: other.state["playing"] is False)
        assert tuple(world.settings.gravity) == (0, 0, -9.81)
        assert other.state["rate"] == 0.25 and not view.playing


def test_a_single_step_lets_a_loop_advance_once(view: sk.View) -> None:
    with connect(view) as client:
        for command, playing in (("pause", False), ("step", True)):
            client.send(command)
            client.settle()
            view.sync()
            assert view.playing is playing
        view.sync()
        assert not view.playing


def test_steps_follow_the_rate_and_end_with_the_view() -> None:
    world = ball_world()[0]
    with sk.view(world, rate=0.5, open=False) as view:
        begun = time.monotonic()
        for dt in view.steps():
            world.advance(dt)
            if world.time > 0.1:
                view.close()
        assert time.monotonic() - begun > 0.15 and 0.1 < world.time < 0.25


def test_reset_goes_back_to_the_start(view: sk.View) -> None:
    world = view.world
    ball, start = world.bodies["ball"], world.state_hash
    with connect(view) as client:
        advance(client, 0.05)
        client.send("reset")
        client.wait(lambda: len(client.of_type("begin")) == 2)
        assert world.time == 0 and world.state_hash == start and ball.alive
        advance(client)


def test_a_reset_is_refused_while_a_recorder_is_active(view: sk.View) -> None:
    world = view.world
    with connect(view) as client:
        client.wait(lambda: client.frames)
        with world.recorder({"energy": sk.EnergyProbe()}, every=0.01) as recorder:
            advance(client, 0.02)
            client.send("reset")
            client.wait(lambda: client.of_type("problem"))
            assert "a recorder of 'energy' in its `with` block" in client.of_type("problem")[0]["text"]
            assert world.time > 0 and len(client.of_type("begin")) == 1
            advance(client, 0.01)
        assert list(recorder.table()["time"]) == pytest.approx([0, 0.02, 0.03], abs=1e-9)
        client.send("reset")
        client.wait(lambda: len(client.of_type("begin")) == 2)
        assert world.time == 0


def test_a_pulled_ball_follows_a_critically_damped_spring(view: sk.View) -> None:
    """The surface point is pulled along the line through the centre, without gravity: 1 - (1 + w t) exp(-w t)."""
    world = view.world
    world.set_gravity((0, 0, 0))
    ball = world.bodies["ball"]
    top = ball.positions[np.argmax(ball.positions[:, 2])]
    start, way, w = ball.center_of_mass[2], 0.1, 2 * math.pi * 2
    with connect(view) as client:
        client.wait(lambda: client.frames)
        client.send("pull", body=0, point=list(top), to=[top[0], top[1], top[2] + way])
        client.wait(lambda: client.rows and client.rows[-1]["pull"])
        begun = world.time
        for _ in range(20):
            advance(client, 0.02)
            t = world.time - begun
            expected = way * (1 - (1 + w * t) * math.exp(-w * t))
            assert ball.center_of_mass[2] - start == pytest.approx(expected, abs=0.03 * way)
        pull = client.rows[-1]["pull"]
        stiffness = ball.mass * w**2
        assert pull["force"] == pytest.approx(stiffness * pull["length"], rel=0.02)
        client.send("release")
        client.wait(lambda: client.rows[-1]["pull"] is None)
    assert len(world.springs) == 0


def test_the_scale_of_arrows_is_not_exceeded_by_one_of_few_forces() -> None:
    world = sk.World(threads=1)
    world.add_collider(sk.Plane())
    for place, size in ((0.0, 0.1), (1.0, 0.02)):
        world.add_body(sk.Mesh.ball(size, 4), sk.Material(), dynamics="rigid", position=(place, 0, size))
    world.advance(0.1)
    with sk.view(world, open=False) as view, connect(view) as client:
        advance(client, 0.01)
        forces = np.linalg.norm(world.contacts["force"], axis=1)
        assert 1 < np.count_nonzero(forces) < 100
        assert client.rows[-1]["top"]["force"] == pytest.approx(forces.max(), rel=0.01)


def test_a_slider_of_a_removed_object_does_not_end_the_run() -> None:
    scene = sk.load_scene(
        {
            "settings": {"threads": 1},
            "materials": {"rubber": {"E": 2e5, "nu": 0.4, "rho": 1000}},
            "bodies": [{"name": "ball", "mesh": {"ball": {"radius": 0.05, "resolution": 2}}, "material": "rubber"}],
            "colliders": [{"name": "wall", "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "position": [0.5, 0, 0]}],
            "sliders": [{"name": "push", "collider": "wall", "along": [1, 0, 0], "low": -0.1, "high": 0.1}],
        }
    )
    with sk.view(scene, open=False) as view, connect(view) as client:
        client.wait(lambda: client.rows)
        assert client.rows[-1]["sliders"] == pytest.approx([0], abs=1e-12)
        scene.world.colliders["wall"].remove()
        advance(client)
        client.wait(lambda: client.rows[-1]["sliders"] == [None])
        client.send("slider", number=0, value=0.05)
        client.wait(lambda: client.of_type("problem"))
        assert "removed" in client.of_type("problem")[-1]["text"]
        advance(client)
        assert view.playing


def test_the_browser_is_opened_without_the_token_in_its_arguments(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []

    def note(address: str) -> bool:
        opened.append(address)
        return True

    monkeypatch.setattr(webbrowser, "open", note)
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"):
        monkeypatch.delenv(name, raising=False)
    with sk.view(ball_world()[0]):
        assert not opened  # there is no display
    monkeypatch.setenv("DISPLAY", ":0")
    with sk.view(ball_world()[0]) as view:
        token = place_of(view)[1]
        assert len(opened) == 1 and token not in opened[0]
        file = Path(urllib.parse.unquote(urllib.parse.urlparse(opened[0]).path))
        assert view.address in file.read_text(encoding="utf-8")
        assert [stat.S_IMODE(path.stat().st_mode) for path in (file, file.parent)] == [0o600, 0o700]
    assert not file.parent.exists()


def test_closing_a_view_ends_its_pulls() -> None:
    world = ball_world()[0]
    before = world.state_hash
    with sk.view(world, open=False) as view, connect(view) as client:
        client.wait(lambda: client.frames)
        client.send("pull", body=0, point=[0, 0, 0], to=[0, 0, 9])
        client.wait(lambda: len(world.springs) > 0)
        view.close()
        assert len(world.springs) == 0 and world.state_hash == before


MALFORMED = [
    "",
    "{",
    "[]",
    "null",
    "7",
    '{"do":7}',
    '{"do":"fly"}',
    '{"do":"rate"}',
    '{"do":"rate","value":"x"}',
    '{"do":"rate","value":-1}',
    '{"do":"rate","value":1e999}',
    '{"do":"slider","number":0,"value":1}',
    '{"do":"slider","number":-1,"value":1}',
    '{"do":"pull","body":5,"point":[0,0,0],"to":[0,0,0]}',
    '{"do":"pull","body":0,"point":[0,0],"to":[0,0,0]}',
    '{"do":"pull","body":0,"point":[0,0,0],"to":[0,0,null]}',
    '{"do":"fields","names":["colour"]}',
    '{"do":"seen","number":-5}',
    '{"do":"seen","number":"x"}',
    '{"do":"gravity","on":1}',
    "[" * 500,
    '{"do":"pause","do":"fly","x":' + "[" * 500,
]


def test_a_malformed_command_is_a_problem_and_changes_nothing(view: sk.View) -> None:
    with connect(view) as client:
        client.wait(lambda: client.frames)
        for count, text in enumerate(MALFORMED):
            client.connection.send(text)
            client.wait(lambda: len(client.of_type("problem")) > count)  # noqa: B023
        advance(client)
        assert view.playing and client.state["rate"] == 1
        assert all(problem["text"] for problem in client.of_type("problem"))
    world, _, _ = ball_world()
    world.advance(0.01)
    assert world.state_hash == view.world.state_hash


def test_a_thousand_quick_commands_are_applied_in_order(view: sk.View) -> None:
    with connect(view) as client:
        for number in range(1000):
            client.send("rate", value=(number + 1) / 100)
        client.settle()
        client.wait(lambda: client.of_type("state") and client.state["rate"] == 10)
        advance(client)
