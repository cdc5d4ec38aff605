"""Checks a built documentation site: check_site.py FOLDER

- Every link, picture and script leads to a file of the site, and every #anchor to an element of it.
- No page loads anything from the network.
- KaTeX renders all formulas, and the search finds words, in Chromium, from a file: address.
"""

import html.parser
import pathlib
import re
import sys
import urllib.parse

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests/python"))
from browser import open_browser

# Words that users search for, and a page that the search must list.
SEARCHES = {"friction": "docs/methods/friction.html", "pressure": "docs/methods/cavities.html",
            "tie": "docs/methods/ties.html", "too slow": "docs/why.html", "young_modulus": "reference/scene.html",
            "add_body": "reference/python/skerry.World.html", "SpringSettings": "reference/cpp/spring.html"}
LOADED = {("script", "src"), ("img", "src"), ("iframe", "src"), ("link", "href"), ("source", "src"), ("video", "src")}


class Page(html.parser.HTMLParser):
    """Links and anchors of a page."""

    def __init__(self, file):
        super().__init__()
        self.links = []  # (address, true if the page loads it)
        self.anchors = {"", "top"}
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        """Collects the links and anchors of an element."""
        for name, value in attributes:
            if name == "id" or (tag == "a" and name == "name"):
                self.anchors.add(value)
            elif name in ("href", "src") and value:
                self.links.append((value, (tag, name) in LOADED))


def broken_links(folder):
    """Yields a message for each link that leads nowhere."""
    pages = {file: Page(file) for file in sorted(folder.rglob("*.html")) if folder / "films" not in file.parents}
    for file, page in pages.items():
        for link, loaded in dict.fromkeys(page.links):
            where = urllib.parse.urlsplit(link)
            if where.scheme or where.netloc:
                if loaded and where.scheme != "data":
                    yield f"{file.relative_to(folder)}: loads {link}, expected a file of the site"
                continue
            target = (file.parent / urllib.parse.unquote(where.path)).resolve() if where.path else file
            if not target.is_file():
                yield f"{file.relative_to(folder)}: {link} leads to no file"
            elif target in pages and urllib.parse.unquote(where.fragment) not in pages[target].anchors:
                yield f"{file.relative_to(folder)}: {link} leads to no anchor"
    for file in folder.rglob("*.css"):
        for link in re.findall(r"""(?:url\(|@import\s)["']?((?:https?:)?//[^"')]+)""", file.read_text("utf-8")):
            yield f"{file.relative_to(folder)}: loads {link}, expected a file of the site"


def failed_pages(folder):
    """Yields a message for each page with a formula that has an error, and for each search that does not list its
    page."""
    with open_browser() as tab:
        for file in sorted(folder.rglob("*.html")):
            if 'class="math' not in file.read_text("utf-8"):
                continue
            tab.open(file.as_uri())
            tab.wait("document.querySelector('.katex, .katex-error')")
            if errors := tab.evaluate("[...document.querySelectorAll('.katex-error')].map(error => error.title)"):
                yield f"{file.relative_to(folder)}: {errors}"
        for word, page in SEARCHES.items():
            tab.open(f"{(folder / 'search.html').as_uri()}?q={word}")
            tab.wait("/finished|not match/.test(document.querySelector('#search-results')?.innerText)")
            found = tab.evaluate("[...document.querySelectorAll('#search-results li a')].map(link => link.pathname)")
            if str(folder / page) not in found:
                yield f"search for {word}: found {len(found)} pages, expected {page} among them"


def main():
    """Prints the problems of the site."""
    folder = pathlib.Path(sys.argv[1]).resolve()
    problems = [*broken_links(folder), *failed_pages(folder)]
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
