"""How Sphinx builds the documentation (`make docs`); it asks no other machine for anything."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

project = "The disorder landscape of Majorana nanowires"
copyright = "the disorder-landscape authors, MIT licence"
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "licences",
    "paper_formulas",
    "wire_parameters",
]

html_theme = "furo"
html_title = "Disorder landscape"
html_static_path = ["static"]
html_css_files = ["tables.css"]
html_copy_source = False
html_show_sphinx = False

myst_heading_anchors = 3

# The docstrings give types in words, in NumPy's style.
autodoc_typehints = "none"
napoleon_google_docstring = False
napoleon_use_param = False
napoleon_use_rtype = False
