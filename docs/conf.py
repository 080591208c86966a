"""The documentation as a site: `python docs/make_replays.py && sphinx-build -W -b html docs build/docs`.

Without the replays the front page shows pictures in their place.
"""

import ast
import dataclasses
import inspect
import re
import shutil
import sys
import textwrap
import tomllib
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive, directives

ROOT = Path(__file__).parent.parent
REPLAYS = Path(__file__).with_name("replays")
sys.path.insert(0, str(ROOT))

project = "Springtide"
author = "The Springtide authors"
release = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinxcontrib.mermaid"]
exclude_patterns = ["notebooks", "replays"]
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["front.css"]
html_js_files = ["replays.js"]
html_title = f"Springtide {release}"
myst_heading_anchors = 3
myst_fence_as_directive = ["mermaid"]
autodoc_member_order = "bysource"
autoclass_content = "both"  # what a constructor takes stands in the docstring of __init__
autodoc_typehints = "none"  # the signatures in the sources hold names that only a type checker resolves


class Replay(Directive):
    """A picture of a scene with a caption, over which its replay runs while it is in view, if the replay was made."""

    required_arguments = 1  # the scene
    has_content = True  # the caption
    option_spec = {"picture": directives.uri, "alt": directives.unchanged_required}  # noqa: RUF012  docutils reads it

    def run(self):
        """Make the figure."""
        scene = self.arguments[0]
        caption, messages = self.state.inline_text(" ".join(self.content), self.lineno)
        figure = nodes.figure("", nodes.image(uri=self.options["picture"], alt=self.options["alt"]), classes=["replay"])
        if (REPLAYS / f"{scene}.html").exists():
            place = f'<div class="replay-place" data-replay="replays/{scene}.html" data-title="{scene}"></div>'
            figure += nodes.raw("", place, format="html")
        figure += nodes.caption("", "", *caption)
        return [figure, *messages]


class Gallery(Directive):
    """Pictures of all presets of a scene, with their names."""

    required_arguments = 1  # the scene

    def run(self):
        """Make the pictures."""
        from app.scenes import scene_named

        scene = self.arguments[0]
        shown = nodes.container(classes=["gallery"])
        for number, preset in enumerate(scene_named(scene).presets, 1):
            picture = nodes.image(uri=f"../assets/pictures/presets/{scene}_{number}.jpg", alt=preset)
            shown += nodes.figure("", picture, nodes.caption("", "", nodes.Text(preset)))
        return [shown]


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


def copy_replays(app, error):
    """Copy the replays to the site."""
    if error is None and app.builder.format == "html" and REPLAYS.exists():
        shutil.copytree(REPLAYS, Path(app.outdir) / "replays", dirs_exist_ok=True)


def setup(app):
    """Register the directives, what is done to docstrings and members, and the replays."""
    app.add_directive("replay", Replay)
    app.add_directive("gallery", Gallery)
    app.connect("build-finished", copy_replays)
    app.connect("autodoc-process-docstring", as_rst)
    app.connect("autodoc-skip-member", is_left_out)
