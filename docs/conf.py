"""The documentation as a site: `sphinx-build -W -b html docs build/docs`."""

import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

project = "Springtide"
author = "The Springtide authors"
release = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinxcontrib.mermaid"]
exclude_patterns = ["notebooks"]
html_theme = "furo"
html_title = f"Springtide {release}"
myst_heading_anchors = 3
myst_fence_as_directive = ["mermaid"]
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the signatures in the sources hold names that only a type checker resolves


def as_rst(app, what, name, obj, options, lines):
    """Rewrite a docstring, which is plain text with `code` and indented lists, as reStructuredText."""
    written = []
    for paragraph in re.split(r"\n\s*\n", "\n".join(lines).strip()):
        rows = paragraph.splitlines()
        if any(re.match(r"\s|[-*] ", row) for row in rows):
            written += ["::", "", *(f"    {row}" for row in rows), ""]
        else:
            text = re.sub(r"([\\*|_])", r"\\\1", " ".join(rows))
            written += [re.sub(r"`+([^`]+)`+", lambda code: f"``{code[1].replace(chr(92), '')}``", text), ""]
    lines[:] = written


def is_left_out(app, what, name, obj, skip, options):
    """Leave out the fields of named tuples, which their signature already shows."""
    return True if type(obj).__name__ == "_tuplegetter" else None


def setup(app):
    """Register what is done to docstrings and members."""
    app.connect("autodoc-process-docstring", as_rst)
    app.connect("autodoc-skip-member", is_left_out)
