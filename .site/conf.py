"""Sphinx's settings for the site; ``build.py`` calls it."""

import re
import sys
from pathlib import Path

from latex2mathml.converter import convert

import primkit

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

project, author, copyright = "primkit", "The primkit authors", "The primkit authors; code BSD-3-Clause, text CC BY 4.0"
release = primkit.__version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "numpydoc"]
nb_execution_mode = "off"  # the stored outputs are the lessons' own, and tested
nb_mime_priority_overrides = [("html", "text/html", 0)]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
suppress_warnings = ["mystnb.unknown_mime_type", "myst.header", "misc.highlighting_failure"]
numpydoc_show_class_members = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # docstrings say what goes in, with shapes and units
default_role = "code"

html_context = {"default_mode": "auto"}  # light or dark as the reader's system is
html_theme = "pydata_sphinx_theme"
html_title = "primkit"
html_static_path = [str(HERE / "static")]
html_css_files = ["interactive.css"]
html_js_files = [("interactive.js", {"defer": "defer"})]
html_copy_source = html_show_sourcelink = False
html_show_search_summary = False  # it fetches pages, which a folder without a server refuses
html_theme_options = {
    "logo": {"text": "primkit"},
    "navbar_end": ["theme-switcher"],
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "header_links_before_dropdown": 6,
    "back_to_top_button": False,
    "show_toc_level": 2,  # what is shown by and by is not reached by keys
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
html_sidebars = {page: [] for page in ("index", "start", "live", "results", "changelog")}  # nothing lies below them


def setup(app):
    """Let formulas be MathML: no script, no font from elsewhere."""
    app.connect("autodoc-process-docstring", as_fields)
    app.add_html_math_renderer("mathml", inline_renderers=(as_mathml, None), block_renderers=(as_mathml, None))


def as_fields(_app, what, _name, _object, _options, lines):
    """Show what goes into a module and comes out of it as a list; its first line is the page's title."""
    if what == "module":
        lines[:] = [re.sub(r"^(In|Out):", r":\1:", line) for line in lines[1:]]


def as_mathml(visitor, node):
    """Write a formula."""
    from docutils import nodes

    display = "inline" if isinstance(node, nodes.math) else "block"
    focus = {"inline": "", "block": ' tabindex="0"'}[display]  # one that is too wide is scrolled, also by keys
    visitor.body.append(convert(node.astext(), display=display).replace("<math", f"<math{focus}", 1))
    raise nodes.SkipNode


html_math_renderer = "mathml"
