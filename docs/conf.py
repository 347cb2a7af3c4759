"""Builds the site of the documentation: `make docs`.

The source folder of Sphinx is the root of the repository, so that a page's links to results/, src/
and conf/ resolve on the site as they do in a checkout.
"""

from owtsweep import __version__

project = "owtsweep"
author = "the owtsweep contributors"
project_copyright = author
version = release = __version__

extensions = ["myst_parser"]
root_doc = "docs/index"
include_patterns = ["docs/**", "results/reference/**", "benchmarks/report.md", "*.md"]
suppress_warnings = ["myst.header"]  # tables that a run writes begin with small headings
myst_heading_anchors = 4  # as on GitHub

html_theme = "pydata_sphinx_theme"
html_title = "owtsweep"
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "show_prev_next": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": [],
    "footer_end": [],
}
