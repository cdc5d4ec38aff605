"""Films of a run, and their pages in a notebook."""

import gc
import html
import re
import tempfile
import urllib.parse
import webbrowser
from pathlib import Path

import pytest

import skerry as sk
from browser import open_browser
from worlds import ball_world


def test_a_film_has_a_frame_at_each_multiple_of_every_and_at_the_end() -> None:
    world, _, _ = ball_world()
    with world.record(every=0.02) as film:
        world.run(0.05, dt=0.01)
    world.advance(0.01)
    assert len(film) == 4
    assert repr(film) == "<skerry.Film 4 frames>"
    with world.record(every=0) as film:
        world.run(0.03, dt=0.01)
    assert len(film) == 4


def test_a_film_is_shown_and_saved_as_the_same_page(tmp_path: Path) -> None:
    world, _, _ = ball_world()
    with world.record(title="a <ball>") as film:
        world.run(0.05)
    page = film.show(height=300)
    film.save(tmp_path / "a.html")
    assert (tmp_path / "a.html").read_text(encoding="utf-8") == page.html
    assert "<title>a &lt;ball&gt;" in page.html


def test_a_page_is_embedded_without_a_server() -> None:
    page = ball_world()[0].show(height=321)
    text = page._repr_html_()
    frame = re.fullmatch(r'<iframe srcdoc="([^"]*)" width="100%" height="321" .*></iframe>', text, flags=re.DOTALL)
    assert frame is not None
    assert html.unescape(frame[1]) == page.html
    assert len(page.html) > 100_000
    assert repr(page).startswith("<skerry.Page, ")


def test_a_film_of_a_failed_run_shows_it_up_to_the_failure() -> None:
    world, _, _ = ball_world()
    with pytest.raises(ZeroDivisionError), world.record(every=0.01) as film:
        world.advance(0.01)
        raise ZeroDivisionError
    assert len(film) == 2 and len(film.show().html) > 100_000


def test_a_film_leaves_no_files(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    world = ball_world()[0]
    with world.record() as film:
        world.advance(0.01)
    film.show()
    with pytest.raises(ValueError, match="every: found -1"):
        world.record(every=-1)
    left = world.record()
    left.__enter__()
    assert len(list(tmp_path.iterdir())) == 1
    del film, left, world
    gc.collect()
    assert list(tmp_path.iterdir()) == []


def test_a_browser_runs_the_page_inside_a_notebook(tmp_path: Path) -> None:
    world, _, _ = ball_world()
    with world.record() as film:
        world.run(0.1)
    listener = "<script>addEventListener('message', e => document.title = e.data)</script>"
    report = (
        "<script>setInterval(() => parent.postMessage("
        "document.querySelectorAll('canvas').length + ' canvases at ' + location.href, '*'), 20)</script>"
    )
    page = sk.Page(film.show().html.replace("</body>", report + "</body>"), 400)
    (tmp_path / "notebook.html").write_text(f"<html><body>{listener}{page._repr_html_()}</body></html>", "utf-8")
    with open_browser() as tab:
        tab.open((tmp_path / "notebook.html").as_uri())
        tab.wait(r"/^[1-9]\d* canvases at about:srcdoc$/.test(document.title)")


def test_a_film_records_only_in_its_block() -> None:
    world, _, _ = ball_world()
    film = world.record()
    world.advance(0.1)
    assert len(film) == 0 and not world._followers
    with pytest.raises(RuntimeError, match="film: found no frames, expected a `with` block"):
        film.show()
    with film:
        world.advance(0.1)
    assert len(film) > 1
    with pytest.raises(RuntimeError, match="film: found a film that was already recorded"), film:
        pass


def test_a_program_opens_a_page_in_the_browser(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    opened: list[str] = []
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))

    def open_page(address: str) -> bool:
        opened.append(address)
        return True

    monkeypatch.setattr(webbrowser, "open", open_page)
    page = ball_world()[0].show(title="a ball")
    page.open()
    page.open(tmp_path / "a page.html")
    files = [Path(urllib.parse.unquote(urllib.parse.urlparse(address).path)) for address in opened]
    assert files[0].parent == tmp_path and files[1] == tmp_path / "a page.html"
    assert [file.read_text(encoding="utf-8") for file in files] == [page.html] * 2
    monkeypatch.setattr(webbrowser, "open", lambda address: False)
    with pytest.raises(RuntimeError, match=r"found no browser to open it, expected one; the page is in .*b\.html"):
        page.open(tmp_path / "b.html")
