"""Builds the site of the documentation: `make docs`.

The source folder of Sphinx is the root of the repository, so that a page's links to results/, src/
and conf/ resolve on the site as they do in a checkout.
"""

import re

from sphinx.application import Sphinx

from owtsweep import __version__

project = "owtsweep"
author = "the owtsweep contributors"
project_copyright = author
version = release = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_gallery.gen_gallery"]
root_doc = "docs/index"
include_patterns = ["docs/**", "results/reference/**", "benchmarks/report.md", "*.md"]
exclude_patterns = ["results/reference/*/tables_6_to_9.md"]  # six tables without a title
suppress_warnings = ["myst.header"]  # tables that a run writes begin with small headings
myst_heading_anchors = 4  # as on GitHub

sphinx_gallery_conf = {
    "examples_dirs": "examples/gallery",
    "gallery_dirs": "docs/gallery",
    "filename_pattern": r"\.py$",
    "ignore_pattern": "alpha_beta",  # which my_estimator imports
    "abort_on_example_error": True,
    "download_all_examples": False,
    "within_subsection_order": "FileNameSortKey",
    "show_signature": False,
    "write_computation_times": False,
}

html_theme = "pydata_sphinx_theme"
html_title = "owtsweep"
html_context = {"default_mode": "auto"}
html_extra_path = ["index.html"]  # leads from the root of the site to its first page
html_static_path = ["site.css"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "show_prev_next": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": [],
    "footer_end": [],
}

autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
autodoc_class_signature = "separated"
default_role = "literal"

#: A line of a docstring about an argument, what is returned or what is raised.
ITEM = re.compile(r"(?P<name>[a-z]\w*(?:, [a-z]\w*)*|Returns?|Raises?(?= `?[A-Z]))(?P<colon>:?) ")


def list_items(app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]):
    """Turn lines such as "step: Sampling interval in s." of a docstring into a list."""
    found, inside = [], False
    for text in lines:
        line = text if ">>>" in text else re.sub(r"(?<!`)\*(?![^`\s]*`)", r"\*", text)
        item = ITEM.match(line)
        if item and (item["colon"] or item["name"].startswith("Raise")):
            found += [""] * (not inside) + [f"* **{item['name']}**{line[item.end('name') :]}"]
            inside = True
        elif inside and line and not line.startswith(" "):  # a sentence that goes on
            found += [f"  {line}"]
        elif inside and line:
            found += [f"  {line.strip()}"]
        else:
            found, inside = [*found, line], False
    lines[:] = found


def setup(app: Sphinx) -> None:
    app.connect("autodoc-process-docstring", list_items)
