"""Links of the repository's Markdown files, and players of recorded runs.

- A link to a folder leads to the page about this folder.
- The page of the accuracy tests ends with the table of all checks.
- A docstring that names a page, as in `docs/methods/contact.md`, links to it.
- Below a block of commands of docs/gallery.md that writes a page, the page plays.
"""

import html
import os
import pathlib
import re
import shutil
import subprocess

from docutils import nodes
from gallery_commands import commands_of
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform
from sphinx.util.osutil import relative_uri

# Pages about folders and files of the repository that are no pages themselves.
PAGE_OF = {
    "README.md": "index.md",
    "docs/README.md": "index.md",
    "docs/decisions": "reference/decisions.md",
    "examples/notebooks": "tutorials.md",
    "examples/python": "examples.md",
    "scenes/keys": "reference/scene.md",
    "docs/scene.schema.json": "reference/scene.md",
}
LINK = re.compile(r"\]\(([^()\s#:]+)(#[^()\s]*)?\)")
PAGE = re.compile(r"docs/[\w/-]+\.md")


def complete_page(app: Sphinx, page: str, source: list[str]) -> None:
    """Replaces links to the keys of PAGE_OF, and adds parts that the files of some pages do not have."""
    if page == "index":
        source[0] = (pathlib.Path(app.srcdir) / "README.md").read_text("utf-8") + source[0]
    if page == "docs/accuracy":
        source[0] += "\n## All checks\n\n```{csv-table}\n:file: accuracy/accuracy.csv\n:header-rows: 1\n```\n"
    if page == "docs/methods/README":
        source[0] += "\n```{toctree}\n:glob:\n:hidden:\n\n*\n```\n"
    # The links of a page that scripts/site moves count from its place in the repository.
    moved = page.startswith("reference/") and (pathlib.Path(app.srcdir) / f"docs/site/pages/{page}.md").exists()
    folder = pathlib.PurePosixPath("docs/site/pages" if moved else "", page).parent

    def redirected(link: re.Match[str]) -> str:
        target = os.path.normpath(folder / link[1])
        if target not in PAGE_OF and not moved:
            return link[0]
        return f"](/{PAGE_OF.get(target, target)}{link[2] or ''})"

    source[0] = LINK.sub(redirected, source[0])


class PagesInDocstrings(SphinxTransform):
    """Makes links of names of pages in docstrings."""

    default_priority = 500

    def apply(self) -> None:
        """Replaces parts of texts outside of code blocks and links."""
        if not self.env.docname.startswith("reference/"):
            return
        for text in list(self.document.findall(nodes.Text)):
            if isinstance(text.parent, (nodes.literal_block, nodes.reference, pending_xref)):
                continue
            parts: list[nodes.Node] = []
            at = 0
            for name in PAGE.finditer(text):
                page = name[0].removesuffix(".md")
                if page in self.env.found_docs:
                    link = pending_xref(
                        "",
                        nodes.inline("", name[0]),
                        reftype="doc",
                        refdomain="std",
                        reftarget=f"/{page}",
                        refexplicit=True,
                        refdoc=self.env.docname,
                        refwarn=True,
                    )
                    parts += [nodes.Text(text[at : name.start()]), link]
                    at = name.end()
            if parts:
                text.parent.replace(text, nodes.inline("", "", *parts, nodes.Text(text[at:])))


class Players(SphinxTransform):
    """Runs the commands of the gallery and shows the pages that they write."""

    default_priority = 500

    def apply(self) -> None:
        """Adds a player below each block of commands that writes pages."""
        if self.env.docname != "docs/gallery":
            return
        films = pathlib.Path(self.app.outdir) / "films"
        films.mkdir(parents=True, exist_ok=True)
        for block in list(self.document.findall(nodes.literal_block)):
            players = []
            for run in commands_of(block.astext()):
                written = pathlib.Path(os.environ["SKERRY_SITE_RESULTS"]) / run.page
                if not written.exists():
                    call = [os.environ["SKERRY_PROGRAM"], *run.arguments, "--page", str(written), "--quiet"]
                    subprocess.run(call, cwd=self.app.srcdir, check=True, stdout=subprocess.DEVNULL)
                shutil.copy(written, films)
                film = relative_uri(self.app.builder.get_target_uri(self.env.docname), f"films/{run.page}")
                address = html.escape(f"{film}#{run.state}&panel=0")
                frame = f'<iframe class="run" loading="lazy" src="{address}" title="{run.page}"></iframe>'
                players.append(nodes.raw("", frame, format="html"))
            if players:
                block.parent.insert(block.parent.index(block) + 1, players)


def setup(app: Sphinx) -> dict[str, bool]:
    """Adds the parts of this file to Sphinx."""
    app.connect("source-read", complete_page)
    app.add_transform(PagesInDocstrings)
    app.add_transform(Players)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
