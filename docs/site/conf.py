"""Settings of Sphinx for the documentation site. scripts/site calls it and sets the folders in the environment."""

import os
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PARTS = pathlib.Path(os.environ["SKERRY_SITE_PARTS"])  # folder of intermediate files
RESULTS = pathlib.Path(os.environ["SKERRY_SITE_RESULTS"])  # results of notebooks and runs
sys.path[:0] = [str(ROOT / "docs/site"), str(ROOT / "scripts/lib")]

project = "Skerry"
version = re.search(r"project\(skerry VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text("utf-8"))[1]
extensions = [
    "myst_nb",
    "breathe",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_copybutton",
    "sphinx.ext.mathjax",
    "site_links",
    "site_reference",
]
root_doc = "index"
exclude_patterns = ["README.md", "docs/README.md", "docs/site", "tests", "engine", "profiling", "examples/**/*.md"]

# Markdown
myst_enable_extensions = ["colon_fence", "dollarmath", "deflist"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 6
suppress_warnings = [
    "myst.header",  # pages may start a section below the second level
    "duplicate_declaration.cpp",  # each header opens the namespace of the library
    "ref.python",  # a type such as `object` may also be the name of several members
]

# Formulas: the extension for MathJax marks them, and KaTeX, a system package, renders them.
mathjax_path = "katex.js"
html_js_files = [("contrib/auto-render.js", {"defer": "defer"}), ("formulas.js", {"defer": "defer"})]

# Notebooks run once; their results are kept until the package or a notebook changes.
nb_execution_mode = "cache"
nb_execution_cache_path = str(RESULTS / "notebooks")
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

# C++
breathe_projects = {"skerry": str(PARTS / "doxygen/xml")}
breathe_default_project = "skerry"
breathe_default_members = ("members", "undoc-members")
breathe_domain_by_extension = {"h": "cpp"}
primary_domain = "py"
cpp_maximum_signature_line_length = 100

# Python
autodoc_default_options = {
    "members": True,
    "undoc-members": True,
    "inherited-members": "BaseException, Mapping, Sequence, dict, list, tuple",  # except for members of these
}
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 100
autosummary_generate = True
autosummary_imported_members = True
templates_path = [str(ROOT / "docs/site/templates")]
default_role = "code"

# Pages
html_theme = "furo"
html_title = f"Skerry {version}"
html_static_path = ["static", "/usr/share/javascript/katex"]
html_css_files = ["katex.min.css", "site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_show_copyright = False
html_show_search_summary = False  # browsers do not let a page read other files
html_theme_options = {"top_of_page_buttons": []}
pygments_style = "friendly"
pygments_dark_style = "native"
copybutton_exclude = ".linenos, .gp, .go"
