"""The diagnosis of wrong functions: the tableau of a step, the terms of a force. Mistakes are drawn at random."""

import ast
import random
import re
import textwrap
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.lab.check.comparing import reproduces
from app.lab.check.program_check import Verdict
from app.lab.course.task import load_tasks
from app.lab.diagnosis.differences import part_of
from app.lab.diagnosis.edits import Tree, more_slips, slips
from app.lab.diagnosis.equation_html import notation
from app.lab.diagnosis.equations import equations_of, written
from app.lab.diagnosis.factors import is_simple
from app.lab.diagnosis.links import SPRING_FORMS, spring
from app.lab.diagnosis.steps import explain_step
from app.lab.diagnosis.tableau import STEPS, NoTableau, merged, order_of, pruned, read_tableau
from app.lab.diagnosis.terms import Term, explain_terms

TASKS = {task.name: task for task in load_tasks() if task.check is not None}
SEED = 20261126
SAMPLES = 16

# The equations of a step, in order: a name, and its terms as symbol, power of h, coefficient.
Lines = list[tuple[str, list[tuple[str, int, float]]]]
METHODS: dict[str, Lines] = {
    "step_rk4": [
        ("x2", [("x", 0, 1), ("v", 1, 1 / 2)]), ("v2", [("v", 0, 1), ("a1", 1, 1 / 2)]),
        ("x3", [("x", 0, 1), ("v2", 1, 1 / 2)]), ("v3", [("v", 0, 1), ("a2", 1, 1 / 2)]),
        ("x4", [("x", 0, 1), ("v3", 1, 1)]), ("v4", [("v", 0, 1), ("a3", 1, 1)]),
        ("new x", [("x", 0, 1), ("v", 1, 1 / 6), ("v2", 1, 1 / 3), ("v3", 1, 1 / 3), ("v4", 1, 1 / 6)]),
        ("new v", [("v", 0, 1), ("a1", 1, 1 / 6), ("a2", 1, 1 / 3), ("a3", 1, 1 / 3), ("a4", 1, 1 / 6)]),
    ],
    "step_euler": [("new x", [("x", 0, 1), ("v", 1, 1)]), ("new v", [("v", 0, 1), ("a1", 1, 1)])],
    "step_leapfrog": [
        ("x2", [("x", 0, 1), ("v", 1, 1), ("a1", 2, 1 / 2)]), ("v2", [("v", 0, 1), ("a1", 1, 1 / 2)]),
        ("new x", [("x2", 0, 1)]),
        ("new v", [("v", 0, 1), ("a1", 1, 1 / 2), ("a2", 1, 1 / 2)]),
    ],
}  # fmt: skip
FACTORS = (2.0, 0.5, 3.0, 1 / 3, 1.5, 0.75, 0.9, -1.0)


def step_of(lines: Lines) -> Callable[..., Any]:
    """A step that follows these equations; stage n is computed at xn and vn."""

    def step(x: Any, v: Any, h: float, acceleration: Callable[..., Any]) -> tuple[Any, Any]:
        known = {"x": x, "v": v, "a1": acceleration(x, v)}
        for name, terms in lines:
            known[name] = sum(c * h**power * known[symbol] for symbol, power, c in terms)
            if re.fullmatch(r"v\d", name):
                known[f"a{name[1]}"] = acceleration(known[f"x{name[1]}"], known[name])
        return known["new x"], known["new v"]

    return step


def explain(name: str, step: Callable[..., Any]) -> Any:
    method = TASKS[name].check.METHOD
    return explain_step(step, method.steps, with_velocity=method.with_velocity)


def wrong_steps(rng: random.Random) -> Iterator[tuple[str, str, Lines]]:
    """Methods with one wrong entry: the method, the line, all lines."""
    while True:
        name = rng.choice(("step_rk4", "step_rk4", "step_leapfrog", "step_euler"))
        lines = [(line, list(terms)) for line, terms in METHODS[name]]
        line, terms = rng.choice([entry for entry in lines if (name, entry[0]) != ("step_leapfrog", "v2")])
        i = rng.randrange(len(terms))
        symbol, power, c = terms[i]
        kind = rng.choice(("factor", "power", "symbol", "missing"))
        stage = 5 if line.startswith("new") else int(line[1])
        others = [f"{symbol[0]}{n}" for n in range(2, stage)] + [symbol[0] if symbol[0] != "a" else "a1"]
        known = {"x", "v", "a1", *(other for other, _ in lines), *(f"a{other[1]}" for other, _ in lines)}
        others = [other for other in others if other in known and other != symbol]
        if kind == "factor":
            terms[i] = symbol, power, c * rng.choice(FACTORS)
        elif kind == "power" and power:
            terms[i] = symbol, power + rng.choice((1, -1)), c
        elif kind == "symbol" and others:
            terms[i] = rng.choice(others), power, c
        elif kind == "missing" and len(terms) > 1:
            del terms[i]
        else:
            continue
        yield name, line, lines


def test_of_200_steps_with_one_wrong_entry_the_line_is_named() -> None:
    wrong = wrong_steps(random.Random(SEED))
    missed = []
    for _ in range(200):
        name, line, lines = next(wrong)
        found = explain(name, step_of(lines))
        if found is None or [equation.name for equation in found.equations if equation.right] != [line]:
            missed.append((name, line, dict(lines)[line], found))
    assert len(missed) <= 2, missed


def right_steps(rng: random.Random) -> Iterator[tuple[str, str]]:
    """Right methods in other notation: the method and its body."""
    half = lambda: rng.choice(("h / 2", "0.5 * h", "h * 0.5", "1 / 2 * h"))  # noqa: E731
    while True:
        yield "step_euler", rng.choice((
            "a = acceleration(x, v)\nx = x + h * v\nreturn x, v + h * a",
            "new = v + h * acceleration(x, v)\nreturn new * h - h * (new - v) + x, new",
            "x = x + h * v - 0 * x\nreturn x, v + h * acceleration(x - h * v, v)",
        ))  # fmt: skip
        yield "step_leapfrog", rng.choice((
            f"w = v + {half()} * acceleration(x, v)\nx = x + h * w\nreturn x, w + {half()} * acceleration(x, w)",
            f"a = acceleration(x, v)\nx = x + h * v + h**2 / 2 * a\nreturn x, v + {half()} * (acceleration(x, v) + a)",
            f"x = x + {half()} * v\nv = v + h * acceleration(x, v)\nreturn x + {half()} * v, v",
        ))  # fmt: skip
        times = rng.choice((True, False))  # k = h f rather than f
        k, by = ("h * ", "") if times else ("", "h * ")
        middle = rng.choice(("/ 2", "* 0.5"))
        yield "step_rk4", "\n".join((
            f"k1x, k1v = {k}v, {k}acceleration(x, v)",
            f"k2x, k2v = {k}(v + {by}k1v {middle}), {k}acceleration(x + {by}k1x {middle}, v + {by}k1v {middle})",
            f"k3x, k3v = {k}(v + {by}k2v {middle}), {k}acceleration(x + {by}k2x {middle}, v + {by}k2v {middle})",
            f"k4x, k4v = {k}(v + {by}k3v), {k}acceleration(x + {by}k3x, v + {by}k3v)",
            rng.choice((
                f"return x + {by}(k1x + 2 * k2x + 2 * k3x + k4x) / 6, v + {by}(k1v + 2 * (k2v + k3v) + k4v) / 6",
                f"return (x + {by}k1x / 6 + {by}(k2x + k3x) / 3 + {by}k4x / 6,"
                f" v + {by}(k1v / 6 + k2v / 3 + k3v / 3 + k4v / 6))",
            )),
        ))  # fmt: skip


def compiled(name: str, arguments: str, body: str) -> Callable[..., Any]:
    """A function with this body."""
    known: dict[str, Any] = {"np": np}
    exec(f"def {name}({arguments}):\n{textwrap.indent(textwrap.dedent(body), '    ')}\n", known)
    return known[name]


def single_precision(step: Callable[..., Any]) -> Callable[..., Any]:
    """A step that computes in single precision."""
    return lambda x, v, h, acceleration: step(
        x.astype(np.float32), v.astype(np.float32), np.float32(h), lambda x, v: acceleration(x, v).astype(np.float32)
    )


def test_none_of_200_right_steps_in_other_notation_is_called_wrong() -> None:
    rng = random.Random(SEED)
    drawn = right_steps(rng)
    for i in range(200):
        name, body = next(drawn)
        step = compiled(name, "x, v, h, acceleration", body)
        step = single_precision(step) if i % 4 == 0 else step
        assert explain(name, step) is None, (name, body)


# A function of a task with a mark for each of its terms, and the right terms with words for each.
FORCES: dict[str, tuple[str, dict[str, tuple[str, str]]]] = {
    "spring_force": (
        "r = x2 - x1\ns = np.linalg.norm(r)\nreturn A + B",
        {"A": ("stiffness * (s - rest_length) * r / s", "the spring"), "B": ("-damping * (v1 - v2)", "the damping")},
    ),
    "rope_acceleration": (
        """
        F = C
        for i in range(len(x) - 1):
            r = x[i + 1] - x[i]
            s = np.linalg.norm(r)
            u = v[i] - v[i + 1]
            pull = A + B
            F[i] += pull
            F[i + 1] -= pull
        a = F / mass
        a[:, 2] += D
        a[0] = 0
        return a
        """,
        {
            "A": ("stiffness * (s - rest_length) * r / s", "the spring"), "B": ("-damping * u", "the damping"),
            "C": ("-drag * v", "the air drag"), "D": ("-gravity", "gravity"),
        },
    ),
    "cloth_forces": (
        """
        F = np.zeros_like(x)
        for (i, j), d in zip(links, rest_lengths):
            r = x[j] - x[i]
            s = np.linalg.norm(r)
            u = v[i] - v[j]
            F[i] += A + B
            F[j] += C + D
        return F
        """,
        {
            "A": ("stiffness * (s - d) * r / s", "the spring on the first end"),
            "B": ("-damping * u", "the damping on the first end"),
            "C": ("-stiffness * (s - d) * r / s", "the spring on the second end"),
            "D": ("damping * u", "the damping on the second end"),
        },
    ),
    "sphere_force": (
        """
        r = x - centre
        s = np.linalg.norm(r)
        if s > radius:
            return np.zeros(3)
        n = r / s
        p = A + B
        return p if p @ n > 0 else np.zeros(3)
        """,
        {"A": ("stiffness * (radius - s) * n", "the push"), "B": ("-damping * (v @ n) * n", "the damping")},
    ),
}  # fmt: skip


def numbers_of(name: str) -> list[str]:
    """The arguments of a task that are numbers."""
    sample = TASKS[name].check.inputs(np.random.default_rng(0))
    return [argument for argument, value in zip(TASKS[name].arguments, sample, strict=True) if np.ndim(value) == 0]


def wrong_forces(rng: random.Random) -> Iterator[tuple[str, str, str, tuple[str, ...]]]:
    """Functions with one wrong term: the task, the term's name, words that name the change (any), the body."""
    while True:
        name = rng.choice(sorted(FORCES))
        body, terms = FORCES[name]
        mark = rng.choice(sorted(terms))
        text, said = terms[mark]
        numbers = numbers_of(name)
        present = [number for number in numbers if number in text]
        factor, argument, own = rng.choice((2, 0.5, 3, 0.1, -2)), rng.choice(numbers), rng.choice(present)
        other = rng.choice([number for number in numbers if number != own])
        changed, words = rng.choice((
            (f"-({text})", ("has the wrong sign",)),
            (f"{factor} * ({text})", (f"is {factor:g} times what it must be",)),
            (f"0 * ({text})", ("is missing",)),
            (f"{argument} * ({text})", (argument,)),
            (f"({text}) / {argument}", (argument, "|r|/d - 1")),
            (text.replace(own, other), (other,)),
            (text.replace(own, f"{own} ** 2"), (own,)),
        ))  # fmt: skip
        for key, (right, _) in terms.items():
            body = re.sub(rf"\b{key}\b", f"({changed if key == mark else right})", body)
        yield name, said, body, words


def samples_of(name: str, function: Callable[..., Any]) -> list[tuple[Any, ...]]:
    """Inputs at which the terms of a task add up to its result."""
    check = TASKS[name].check
    rng, found = np.random.default_rng(SEED), []
    while len(found) < SAMPLES:
        sample = tuple(check.inputs(rng))
        if not hasattr(check, "adds_up") or check.adds_up(function, *sample):
            found.append(sample)
    return found


@pytest.mark.parametrize("name", FORCES)
def test_the_terms_of_a_task_add_up_to_its_reference(name: str) -> None:
    task = TASKS[name]
    for sample in samples_of(name, task.function):
        total = sum(term.function(*sample) for term in task.check.TERMS)
        assert total == pytest.approx(task.function(*sample), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("seed", [SEED, pytest.param(SEED + 1, marks=pytest.mark.stress)])
def test_of_forces_with_one_wrong_term_the_term_and_the_change_are_named(seed: int) -> None:
    wrong = wrong_forces(random.Random(seed))
    missed = []
    number = 40 if seed == SEED else 200
    for _ in range(number):
        name, said, body, words = next(wrong)
        check = TASKS[name].check
        function = compiled(name, ", ".join(TASKS[name].arguments), body)
        samples = samples_of(name, function)
        found = explain_terms(function, check.TERMS, getattr(check, "GROUPS", ()), TASKS[name].arguments, samples)
        told = f"{found.mistake} {found.text}" if found else ""
        if said not in told or not any(word in told for word in words):
            missed.append((name, body, words, found))
    assert len(missed) <= number // 20, missed


def test_two_wrong_terms_are_both_named() -> None:
    name = "spring_force"
    task = TASKS[name]
    body = "r = x2 - x1\ns = np.linalg.norm(r)\nreturn -stiffness * (s - rest_length) * r / s - damping * (v1 - v2) / 3"
    function = compiled(name, ", ".join(task.arguments), body)
    found = explain_terms(function, task.check.TERMS, (), task.arguments, samples_of(name, function))
    assert found is not None
    assert found.mistake == "the spring has the wrong sign"
    assert "The damping is 1/3 times what it must be" in found.text
    assert [(line.name, [piece.wrong for piece in line.pieces], bool(line.right)) for line in found.equations] == [
        ("spring", [True], True), ("damping", [True], True),
    ]  # fmt: skip


@pytest.mark.parametrize(("kicks", "weights"), [((0.5, 1 / 3), "0.8333"), ((1.0, 0.5), "1.5")])
def test_weights_of_two_kicks_add_up_to_one(kicks: tuple[float, float], weights: str) -> None:
    def leapfrog(x: Any, v: Any, h: float, acceleration: Any) -> tuple[Any, Any]:
        first = acceleration(x, v)
        new = x + h * v + h * h / 2 * first
        return new, v + h * kicks[0] * first + h * kicks[1] * acceleration(new, v + h / 2 * first)

    found = explain("step_leapfrog", leapfrog)
    assert found.mistake == "weights do not add up to one"
    assert f"The weights add up to {weights} instead of 1." in found.text


def test_a_condition_may_hold_always_or_never() -> None:
    tree = Tree(b"def positive(x):\n    return x if x > 0.0 else -x\n", "positive", {}, ())
    fixed = [candidate for candidate in slips(tree, ["x"], ()) if candidate.condition]
    assert {tree.function(candidate)(3.0) for candidate in fixed} == {3.0, -3.0}
    assert {(tree.words(candidate).replacements[0].before, candidate.condition) for candidate in fixed} == {
        ("x > 0.0", "always"), ("x > 0.0", "never"),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("power", "more", "words"),
    [
        (1, 1, "the result is multiplied by speed twice instead of once"),
        (1, -1, "speed not used"),
        (1, 2, "the result is multiplied by speed 3 times instead of once"),
        (1, -2, "the result is divided by speed instead of multiplied"),
        (1, 0.5, "the result is multiplied by the root of speed"),
        (1, -0.5, "the result is divided by the root of speed"),
        (2, -1, "the result is multiplied by speed once instead of twice"),
        (2, -2, "speed not used"),
    ],
)
def test_a_product_is_explained_by_its_arguments(power: int, more: float, words: str) -> None:
    terms = (Term("the result", "", lambda mass, speed: mass * speed**power / 2.0),)
    rng = np.random.default_rng(SEED)
    samples = [tuple(map(float, rng.uniform(1.0, 3.0, 2))) for _ in range(SAMPLES)]
    wrong = lambda mass, speed: mass * speed ** (power + more) / 2.0  # noqa: E731
    found = explain_terms(wrong, terms, (), ("mass", "speed"), samples)
    assert found is not None
    assert found.mistake == words


def test_a_tableau_has_the_order_of_its_method() -> None:
    orders = {"step_euler": 1, "step_leapfrog": 2, "step_rk4": 4}
    for name, order in orders.items():
        method = TASKS[name].check.METHOD
        tableau = read_tableau(TASKS[name].function, with_velocity=method.with_velocity)
        assert order_of(tableau) == order
        x, v = np.random.default_rng(SEED).normal(size=(2, 4, 3))
        pull = lambda x, v: -3.0 * x - x**3  # noqa: E731
        for found, right in zip(tableau.apply(x, v, 0.1, pull), TASKS[name].function(x, v, 0.1, pull), strict=True):
            assert found == pytest.approx(right, rel=1e-8)


def test_calls_at_one_state_are_one_stage_and_unused_ones_none() -> None:
    def euler(x: Any, v: Any, h: float, acceleration: Any) -> tuple[Any, Any]:
        acceleration(x + v, v)
        return x + h * v, v + h / 2 * acceleration(x, v) + h / 2 * acceleration(x, v)

    tableau = read_tableau(euler, with_velocity=True)
    assert [tableau.stages, pruned(tableau).stages, merged(pruned(tableau)).stages] == [3, 2, 1]
    assert [f"{line.name} = {line.text}" for line in equations_of(merged(pruned(tableau)))] == [
        "new x = x + h v", "new v = v + h a1",
    ]  # fmt: skip
    assert explain("step_euler", euler) is None


@pytest.mark.parametrize(
    "step",
    [
        lambda x, v, h, a: (np.sin(x), v),
        lambda x, v, h, a: (x * np.nan, v),
        lambda x, v, h, a: (x + np.exp(h) * v, v + h * a(x, v)),
        lambda x, v, h, a: (np.maximum(x, 0.0), v),
        lambda x, v, h, a: (x, v + h * (a(x, v) if h > STEPS[1] else a(x, v) + a(x + v, v))),  # fewer calls
    ],
)
def test_what_is_no_combination_has_no_tableau(step: Callable[..., Any]) -> None:
    with pytest.raises(NoTableau):
        read_tableau(step, with_velocity=True)
    assert explain("step_euler", step) is None


def test_of_a_wrong_factor_of_the_step_no_term_in_its_bracket_is_marked() -> None:
    right = {("x", 0): 1.0, ("v", 1): 1 / 6, ("v2", 1): 1 / 3, ("v3", 1): 1 / 3, ("v4", 1): 1 / 6}
    twice = {term: c if term == ("x", 0) else 2.0 * c for term, c in right.items()}
    pieces = [piece for piece in written(twice, 1e-9, {*right} - {("x", 0)}, right) if piece.text]
    assert "".join(piece.text for piece in pieces) == "x + h/3 (v + 2 v2 + 2 v3 + v4)"
    assert [piece.text for piece in pieces if piece.wrong] == ["h/3"]
    other = {**right, ("v2", 1): 1 / 2}
    pieces = [piece for piece in written(other, 1e-9, {("v2", 1)}, right) if piece.text]
    assert "".join(piece.text for piece in pieces) == "x + h/6 (v + 3 v2 + 2 v3 + v4)"
    assert [piece.text for piece in pieces if piece.wrong] == ["3 v2"]


def test_a_form_may_differ_by_the_rounding_of_the_right_results() -> None:
    """A small difference of large numbers has their rounding."""
    form, found = np.array([1e-7 / 3.0]), np.array([2e-7 / 3.0])
    assert reproduces(form, found, np.array([1e6]))
    assert not reproduces(form, found, np.array([1.0]))


def shown(source: bytes, *kinds: Any) -> list[tuple[str, str]]:
    """The edits of a function in words."""
    tree = Tree(source, "one", {}, ())
    found = (tree.words(candidate) for kind in kinds for candidate in kind(tree) if tree.function(candidate))
    return [(one.before, one.after) for words in found for one in words.replacements]


def near(tree: Tree) -> Any:
    """The likelier edits."""
    return slips(tree, (), ())


def test_the_edits_of_a_number_and_of_the_arguments_of_a_call() -> None:
    source = b"def one(a, b):\n    return f(a, b, 3) + a\n"
    likely, far = ({after for _, after in shown(source, kind)} for kind in (near, more_slips))
    assert {after for after in likely if re.fullmatch(r"f\(a, b, [^ab]+\)", after)} == {
        "f(a, b, 3)", "f(a, b, 6)", "f(a, b, 1.5)", "f(a, b, 4)", "f(a, b, 2)", "f(a, b, -3)",
    }  # fmt: skip
    assert {after for after in far if re.fullmatch(r"f\([ab3, ]+\)", after)} == {"f(b, a, 3)", "f(a, 3, b)", "f(b, 3)"}
    assert {"f(a, b, 3) / (2 * np.pi)", "f(a, b, 3) * (2 * np.pi)", "f(a, b, 3) / np.pi"} <= far


def test_an_edit_of_an_index_is_shown_with_its_array() -> None:
    source = b"def one(numbers, rows):\n    return numbers[:-1, 1:] - numbers[2:rows]\n"
    found = shown(source, near, more_slips)
    assert ("numbers[:-1, 1:]", "numbers[1:, :-1]") in found
    assert len(found) > 100
    for text in (text for edit in found for text in edit if text):
        ast.parse(text)


def test_factors_that_a_person_may_omit() -> None:
    assert all(map(is_simple, (2.0, -0.5, 1e3, 2.0 * np.pi, 1.0 / 3.0, 1024.0)))
    assert not any(map(is_simple, (0.0, np.inf, -np.inf, np.nan, 59403.0)))


def test_the_forms_of_a_spring_that_only_pulls_or_only_pushes() -> None:
    pulls, pushes, both = (
        next(law for text, _, law in SPRING_FORMS if text.startswith(start))
        for start in ("k max(", "k min(", "k ||r| - d|")
    )
    for length, sign in ((1.5, 1.0), (0.5, -1.0)):
        r = np.array([0.6, 0.0, 0.8]) * length
        arguments = r, np.array([length]), np.zeros(3), 10.0, 1.0, 1.0
        force = spring(*arguments)
        assert np.abs(force).max() > 1.0
        np.testing.assert_array_equal(pulls(*arguments), force if sign > 0.0 else 0.0)
        np.testing.assert_array_equal(pushes(*arguments), force if sign < 0.0 else 0.0)
        np.testing.assert_allclose(both(*arguments), sign * force)


def test_numbers_of_stages_are_subscripts_and_all_else_stays() -> None:
    assert notation("h/2 (a1 + a2)") == "h/2 (a<sub>1</sub> + a<sub>2</sub>)"
    assert notation("force") == "force"


def test_the_sentence_of_a_verdict_ends_with_one_mark() -> None:
    assert [Verdict("wrong", text, "no end").sentence for text in ("it runs on", "It runs on.", "Does it end?")] == [
        "no end: it runs on.", "no end: It runs on.", "no end: Does it end?",
    ]  # fmt: skip


def test_the_part_of_a_result_that_is_wrong_is_named_where_others_are_right() -> None:
    first, second, both = (
        SimpleNamespace(wrong=tuple(np.array(part) for part in wrong))
        for wrong in (([True, False], [False]), ([False, False], [True]), ([True, True], [True]))
    )
    names = ("positions", "velocities")
    assert part_of([first], names) == "in the positions"
    assert part_of([second, second], names) == "in the velocities"
    assert part_of([first, second], names) == part_of([both], names) == ""
    assert part_of([SimpleNamespace(wrong=(np.array([True]),))], ("force",)) == ""
