"""The documentation as a site: `sphinx-build -W -b html docs build/docs`."""

import ast
import dataclasses
import inspect
import re
import sys
import textwrap
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
autoclass_content = "both"  # what a constructor takes stands in the docstring of __init__
autodoc_typehints = "none"  # the signatures in the sources hold names that only a type checker resolves


def as_rst(app, what, name, obj, options, lines):
    """Rewrite a docstring, which is plain text with `code`, indented lists and examples, as reStructuredText."""
    written = []
    for paragraph in re.split(r"\n\s*\n", "\n".join(lines).strip()):
        rows = paragraph.splitlines()
        if rows and rows[0].lstrip().startswith(">>> "):
            written += [*textwrap.dedent(paragraph).splitlines(), ""]
        elif paragraph.startswith("Create new instance of "):  # of a named tuple, which Python writes
            continue
        elif any(re.match(r"\s|[-*] ", row) for row in rows):
            written += ["::", "", *(f"    {row}" for row in rows), ""]
        else:
            text = re.sub(r"([\\*|_])", r"\\\1", " ".join(rows))
            written += [re.sub(r"`+([^`]+)`+", lambda code: f"``{code[1].replace(chr(92), '')}``", text), ""]
    is_record = what == "class" and (hasattr(obj, "_fields") or dataclasses.is_dataclass(obj))
    if is_record and lines[:1] == inspect.cleandoc(obj.__doc__).splitlines()[:1]:  # not that of its constructor
        written += ["::", "", *(f"    {row}" for row in fields_of(obj)), ""]
    lines[:] = written


def fields_of(record):
    """Return the source lines of a record's fields: units and shapes stand in their comments."""
    source = textwrap.dedent(inspect.getsource(record)).splitlines()
    body = ast.parse("\n".join(source)).body[0].body
    ends = [node.end_lineno for node in body if isinstance(node, ast.AnnAssign)]
    start = body[0].end_lineno if ast.get_docstring(ast.parse("\n".join(source)).body[0]) else 1
    return [row.strip() for row in source[start : max(ends, default=start)] if row.strip()]


def is_left_out(app, what, name, obj, skip, options):
    """Leave out the fields of named tuples, which their signature already shows."""
    return True if type(obj).__name__ == "_tuplegetter" else None


def setup(app):
    """Register what is done to docstrings and members."""
    app.connect("autodoc-process-docstring", as_rst)
    app.connect("autodoc-skip-member", is_left_out)
