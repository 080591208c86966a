"""Symbols in texts of the panel and of the lab: each stands beside its word."""

import html
import re
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from app.lab.course.task import load_tasks
from app.scenes import NAMES, scene_named, view_named
from sim.parameters import check_record, parameters_of
from sim.validation import DivergenceError

ROOT = Path(__file__).parents[3]
# A symbol, and the words of which one is to stand in the same text.
SYMBOLS = {
    r"h ?ω": "step", r"ζ": "damping ratio|twice the damping", r"(?<!h)(?<!h )ω": "frequency",
    r"\bHs\b|H<sub>": "significant height", r"\bTp\b|T<sub>": "peak period", r"ρ": "density", r"[μν]": "viscosity",
    r"\bg( =|/| in\b)": "gravity", r"\bn = ": "refractive index", r"λ": "eigenvalue|wavelength|wave length",
    r"σ": "deviation|tension", r"\bh [<=]": "step", r"\bU10\b": "wind",
}  # fmt: skip
SETTINGS: list[tuple[str, dict[str, Any]]] = [
    *((name, {}) for name in NAMES),
    ("rope", {"integrator": "explicit_euler", "stiffness": 2000.0}),
    ("rope", {"integrator": "implicit_euler"}),
    ("square_sea", {"viscosity": 1e-3, "deep": False, "depth": 2.0}),
    ("square_sea", {"size": "64", "mesh": "32", "order": 3, "deep": False}),
    ("radial_sea", {"spill": "mixed", "compare": True}),
    ("radial_sea", {"spill": "layer", "thickness": 0.1}),
]


def unexplained(text: str) -> list[str]:
    """The symbols of a text without a word for them."""
    words = html.unescape(text)
    return [s for s, word in SYMBOLS.items() if re.search(s, words) and not re.search(word, words, re.IGNORECASE)]


def test_a_symbol_without_a_word_is_found() -> None:
    assert unexplained("hω = 0.68 limit 2.00 at ζ = 0.021") == [r"h ?ω", "ζ"]
    assert unexplained("Step: 34 % of the largest stable (hω 0.68 of 2.00)") == []


NOT_DRAWN: Any = SimpleNamespace(ropes=None, drawn=None, mesh=None, water=None)  # a view before anything is drawn


def texts_of(name: str, changes: dict[str, Any]) -> Iterator[str]:
    """The texts that the panel shows of a scene after a few steps."""
    kind, view = scene_named(name), view_named(name)
    scene = kind.make(check_record(kind.params, changes))
    try:
        scene.advance(3)
    except DivergenceError as error:
        yield str(error)
    status = SimpleNamespace(halted="")
    snapshot = SimpleNamespace(frame=scene.frame(), readings=scene.readings(), params=scene.params, status=status)
    for read in ("figures", "readout", "marks", "notes"):
        if hasattr(view, read):
            found = getattr(view, read)(NOT_DRAWN, snapshot)
            yield from found.values() if isinstance(found, dict) else [found]
    yield from (quantity.meaning for quantity in kind.quantities.values())


@pytest.mark.parametrize(("name", "changes"), SETTINGS)
def test_every_symbol_that_a_scene_shows_has_its_word(name: str, changes: dict[str, Any]) -> None:
    texts = [text for text in texts_of(name, changes) if text]
    assert texts
    assert not [(text, found) for text in texts if (found := unexplained(text))]


@pytest.mark.parametrize("name", NAMES)
def test_every_symbol_of_a_scene_s_controls_and_presets_has_its_word(name: str) -> None:
    kind = scene_named(name)
    declared = parameters_of(kind.params)
    texts = [kind.help, *kind.about.values(), *(f"{key} {p.title} {p.doc}" for key, p in declared.items())]
    charts = [
        f"{axes.title} {' '.join(getattr(axes, 'series', ()))}"
        for axes in (*kind.plots.values(), *kind.curves.values())
    ]
    assert not [(text, found) for text in (*texts, *charts) if (found := unexplained(text))]


def test_each_info_sign_names_a_section_of_the_physics() -> None:
    sources = (path.read_text("utf-8") for path in (ROOT / "app" / "scenes").rglob("*.py"))
    named = {section for source in sources for section in re.findall(r'\binfo\([^"]*"([^"]*)"\)', source)}
    headings = set(re.findall(r"(?m)^## (.*)$", (ROOT / "docs" / "physics.md").read_text("utf-8")))
    assert len(named) >= 4
    assert named <= headings


def test_every_symbol_of_a_task_s_texts_has_its_word() -> None:
    for task in load_tasks(with_checks=False):
        texts = [task.statement, *(step.text for step in task.steps), *([task.setup.look] if task.setup else [])]
        for question in task.questions:
            texts += [f"{question.ask} {question.why}", *(error.text for error in question.typical_errors)]
        if task.guide is not None:
            texts += [task.guide.question, task.guide.answer]
        assert not [(task.name, text, found) for text in texts if (found := unexplained(text))]
