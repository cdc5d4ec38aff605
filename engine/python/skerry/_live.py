"""The live view: the page of a world in a browser while the world runs."""

from __future__ import annotations

import contextlib
import os
import pathlib
import shutil
import sys
import tempfile
import threading
import time
import weakref
import webbrowser
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

from . import _core
from ._arrays import checked, counted, flag, name_text, real
from ._errors import SceneError
from ._scene import Scene
from ._world import World
from ._world.probes import Probe, recorded_probes

if TYPE_CHECKING:
    from types import TracebackType

    from ._world import StepReport

_LONG_CALL = 0.05  # a call of advance() after which the next one also shows the world between its steps [s]
_RELOAD = 5.0  # time in which a page may connect again, for example after a reload [s]


class View:
    """Shows a world in a browser while it runs. view() makes it, and describes its use."""

    __slots__ = ("__weakref__", "_closed", "_core", "_forget_page", "_lock", "_resets", "_seen", "_slow", "_world")

    def __init__(self, world: World, core: _core.LiveView) -> None:
        self._world, self._core = world, core
        self._lock = threading.Lock()  # allows close() while another thread runs the world
        self._closed = False
        self._slow = False  # the last call of advance() was long
        self._resets = 0
        self._seen: float | None = None  # time at which a page was connected last [s]
        self._forget_page: Callable[[], object] | None = None  # removes the file of _open_page()

    @property
    def world(self) -> World:
        """The world that the page shows."""
        return self._world

    @property
    def address(self) -> str:
        """Address of the page, on this computer only. It contains the secret token that allows a page to connect."""
        return self._core.address()

    @property
    def is_open(self) -> bool:
        """False after close(), and when all pages that were open have been closed for 5 s."""
        self._note_pages()
        return not self._closed and (self._seen is None or time.monotonic() - self._seen < _RELOAD)

    @property
    def playing(self) -> bool:
        """False while the page pauses the run. The button for a single step makes it true until the next sync(). run()
        obeys it; a loop of your own can call World.advance() only if it is true."""
        return self._core.playing()

    @property
    def client_count(self) -> int:
        """Number of connected pages, at most 4."""
        return self._core.clients()

    @property
    def frames_sent(self) -> int:
        """Number of frames that were sent to pages."""
        return self._core.frames_sent()

    @property
    def frames_dropped(self) -> int:
        """Number of frames that pages missed because they were busy with earlier frames."""
        return self._core.frames_dropped()

    def sync(self) -> None:
        """Carries out the commands of users of the page since the last call (pulls, sliders, gravity, reset), and shows
        the present state if a page can take a frame, else drops it. While the page pauses the run, waits up to 20 ms
        for a command. Call it after each call of World.advance(). A reset is refused while a recorder is in its `with`
        block. BufferError: arrays of views() are in use."""
        self._turn(self._core.sync)

    def run(self) -> None:
        """Runs the world at the rate that the page shows, until the page is closed or Ctrl-C is pressed, then closes
        the view. A step that fails pauses the run, and the page shows why. Recorders and films in their `with` blocks
        follow the run; so do functions of World.watch_steps()."""
        try:
            for dt in self.steps():
                self._advance(dt)
        except KeyboardInterrupt:
            pass
        finally:
            self.close()

    def steps(self) -> Iterator[float]:
        """Durations by which a loop of your own has to advance the world [s], until the page is closed. They follow the
        page: its rate, pauses and single steps. While there is nothing to advance, the iterator waits."""
        while self.is_open:
            if dt := self._turn(self._core.due):
                yield dt

    def close(self) -> None:
        """Ends the server, the pulls of pages, and run() of another thread. Pages keep their last picture. The end of
        the `with` block does this. If the world is in use, the end of run() or the next sync() ends the pulls."""
        self._closed = True
        with self._lock:
            self._core.close()
            with contextlib.suppress(RuntimeError, BufferError, SceneError):
                self._core.sync(self._world._core)
        if self._forget_page:
            self._forget_page()

    def _open_page(self) -> bool:
        """Opens the page by a file that leads to it. Other users of the computer can read the arguments of programs,
        but not this file, so that the token in the address stays secret. Returns False if there is no display, because
        webbrowser would then start a browser in the terminal and wait for its end."""
        if not any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")):
            return False
        folder = pathlib.Path(tempfile.mkdtemp(prefix="skerry-view-"))
        self._forget_page = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        file = folder / "view.html"
        refresh = f'<meta http-equiv="refresh" content="0; url={self.address}">'
        with os.fdopen(os.open(file, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600), "w", encoding="utf-8") as out:
            out.write(f'<!doctype html><meta charset="utf-8">{refresh}\n')
        return webbrowser.open(file.as_uri())

    def _turn(self, function: Callable[[_core.World], float | None]) -> float | None:
        with self._lock:
            self._core.refuse_resets(self._reset_refusal())
            result = function(self._world._core)
        self._note_pages()
        if self._core.resets() != self._resets:
            self._resets = self._core.resets()
            self._world._forget_objects()
        return result

    def _note_pages(self) -> bool:
        """True if a page is connected. Then stores the present time in `_seen`."""
        connected = self._core.clients() > 0
        if connected:
            self._seen = time.monotonic()
        return connected

    def _reset_refusal(self) -> str:
        """Reason why the world must not go back in time, for example an active recorder; empty if it may."""
        try:
            for follower in self._world._followers:
                follower.require_no_jump()
        except SceneError as error:
            return str(error)
        return ""

    def _advance(self, dt: float) -> None:
        begun = time.monotonic()
        connected = self._note_pages()
        try:
            report = self._world.try_advance(dt, check=self._show if self._slow else None)
            problem = "" if report.status in ("ok", "stopped") else report.message
        except SceneError as error:  # for example overlaps that the settings of the world refuse
            problem = str(error)
        ended = time.monotonic()
        self._slow = ended - begun > _LONG_CALL
        if connected:
            self._seen = ended  # a page that was closed during a long call may be loading again
        if problem:
            with self._lock:
                self._core.fail(problem)

    def _show(self, _: StepReport) -> bool:
        """Shows the world between two steps of a long call. False: a page has sent a command, so that the call ends."""
        with self._lock:
            return not self._closed and self._core.between_steps(self._world._core)

    def __enter__(self) -> View:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<skerry.View {'closed' if self._closed else self.address}>"


def view(
    world: World | Scene,
    *,
    rate: float = 1.0,
    port: int = 0,
    open: bool = True,
    paused: bool = False,
    probes: Mapping[str, Probe] | None = None,
    title: str | None = None,
) -> View:
    """Shows a world in a browser while it runs. The page can pause, step and reset the run, pull bodies with the mouse,
    switch gravity off, and move the sliders of a scene.

        skerry.view(world).run()  # until the page is closed or Ctrl-C is pressed

        with skerry.view(world) as view:  # with a loop of your own, at the rate that the page shows
            for dt in view.steps():
                world.advance(dt)

        skerry.view(skerry.load_scene("scenes/finger.json")).run()  # with its sliders and probes

    world: a world, or a scene.
    rate: simulated time per wall time in run(); 0: as fast as possible.
    port: port of the server, which listens on this computer only; 0: a free port.
    open: False: does not open the browser; View.address is the address.
    paused: True: run() begins paused.
    probes: quantities that the page plots, by name, as for World.recorder(); default: those of the scene.
    title: heading; default: the name of the scene.

    SceneError: the port is in use, a probe is wrong, or this build has no server."""
    checked(world, "view: world", World, Scene)
    scene, shown = (world, world.world) if isinstance(world, Scene) else (None, world)
    given = (scene.probes if scene else {}) if probes is None else probes
    core = _core.LiveView(
        shown._core,
        title=name_text(title, "title") if title is not None else scene.name if scene else "skerry",
        rate=real(rate, "rate"),
        port=counted(port, "port"),
        paused=flag(paused, "paused"),
        probes=recorded_probes(given, shown),
        sliders=scene._sliders if scene else [],
    )
    opened = View(shown, core)
    if flag(open, "open") and not opened._open_page():
        print(f"view: open {opened.address} in a browser on this computer", file=sys.stderr)
    return opened
