"""The site: Sphinx reads the pages where they lie; docs/_toc.yml is the table of contents."""

import gc

# All of every page stays: looking for garbage among it takes a seventh of the time.
gc.set_threshold(100_000)

project = "Active binocular vision"
author = "Active binocular vision maintainers"
extensions = [
    "myst_nb",
    "sphinx_external_toc",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
]
external_toc_path = "docs/_toc.yml"
include_patterns = ["*.md", "docs/**", "results/*.md", "sweeps/README.md"]
exclude_patterns = ["docs/examples/**"]
templates_path = ["templates"]
html_static_path = ["static"]
html_css_files = ["site.css"]

html_theme = "furo"
html_title = project
html_show_copyright = False
html_additional_pages = {"index": "redirect.html"}

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4

nb_execution_mode = "cache"
nb_execution_raise_on_error = True
nb_execution_timeout = 600  # seconds for a cell; one trains for some on an idle machine
nb_execution_in_temp = True
nb_output_stderr = "remove"
