"""A sentence about a wrong function is true of that function, and says what to change."""

import ast
import random
import re
import textwrap
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from app.lab.check.comparing import call, conform, parts, reproduces, same
from app.lab.check.diagnose import FRESH, FRESH_SEED, SEED
from app.lab.check.diagnosis.differences import number
from app.lab.check.diagnosis.edits import own_edits
from app.lab.check.diagnosis.effects import EFFECTS
from app.lab.check.program_check import SAMPLES, compare
from app.lab.check.student_function import StudentFunction
from app.lab.checking import Wrong
from app.lab.course.task import Task, load_tasks
from app.lab.process.runner import RunError, Runner
from tests.app.lab.solutions.audit_mistakes import MISTAKES
from tests.app.lab.solutions.right_solutions import RIGHT

TASKS = {task.name: task for task in load_tasks() if task.check is not None}
HEAD = "import numpy as np\n\nKEPT = {}\n\n"
REPAIR = re.compile(r"With (.+) in place of (.+) in line (\d+) it is right\.|Without (.+) in line (\d+) it is right\.")
CONDITION = re.compile(r"It is right if the condition (.+) in line (\d+) (always|never) holds\.")
RANDOM_SEED = 20261127
TRUTH_SEED = 5  # of inputs that no check has seen


@pytest.fixture(scope="module")
def runner(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Runner]:
    with Runner(tmp_path_factory.mktemp("student"), time_limit=20.0) as runner:
        yield runner


def source_of(task: Task, body: str) -> str:
    """A file with a function of this body."""
    return f"{HEAD}def {task.name}({', '.join(task.arguments)}):\n{textwrap.indent(textwrap.dedent(body), '    ')}\n"


def judged(runner: Runner, task: Task, source: str) -> Wrong | RunError | None:
    """What the check says of a file."""
    file = f"solution_{len(list(runner.folder.iterdir()))}.py"
    (runner.folder / file).write_text(source, "utf-8")
    try:
        compare(StudentFunction(runner, replace(task, file=file)))
    except (Wrong, RunError) as error:
        return error
    return None


def function_of(task: Task, source: str) -> Callable[..., Any]:
    """The function of a file, in this process."""
    known: dict[str, Any] = {}
    exec(source, known)
    return known[task.name]


def samples_of(task: Task, seed: int, count: int) -> list[tuple[Any, ...]]:
    """Inputs of a task."""
    rng = np.random.default_rng(seed)
    return [tuple(task.check.inputs(rng)) for _ in range(count)]


def result(task: Task, function: Callable[..., Any], sample: tuple[Any, ...]) -> Any:
    """The result of a function in the form that is compared."""
    normalise = getattr(task.check, "normalise", lambda value: value)
    return normalise(conform(call(function, sample), call(task.function, sample)))


def is_true(task: Task, source: str, said: Wrong) -> bool:
    """True if what is said of the function in a file holds for it."""
    function, text = function_of(task, source), str(said)
    if said.form is not None:
        form = said.form
        return all(
            reproduces(result(task, form, s), result(task, function, s), call(task.function, s))
            for s in samples_of(task, TRUTH_SEED, 20)
        )
    if found := REPAIR.search(text):
        after, before, line, without, other_line = found.groups()
        return is_repaired(task, source, int(line or other_line), before or without, after or "")
    if found := CONDITION.search(text):
        test, line, holds = found.groups()
        return is_repaired(task, source, int(line), test, str(holds == "always"))
    if text.startswith("The result does not change with "):
        names = text.removeprefix("The result does not change with ").rstrip(".").split(" and ")
        return all(is_unused(task, function, name) for name in names)
    if text.startswith("it returns "):
        return said.mistake in ("NaN", "infinite", "wrong shape", "wrong type", "returns nothing")
    if (contrast := getattr(task.check, "contrast", None)) is not None:
        inputs = samples_of(task, SEED, SAMPLES) + samples_of(task, FRESH_SEED, FRESH)
        said_of = [contrast(result(task, function, s), result(task, task.function, s), *s) for s in inputs]
        return any(sentence and text.endswith(sentence) for sentence in said_of)
    found = re.search(r"(?:it|It) returns (\(.*?\)|\S+).*; expected (.+)\.$", text)
    assert found, text
    inputs = samples_of(task, SEED, SAMPLES) + samples_of(task, FRESH_SEED, FRESH)
    pairs = ((result(task, function, s), result(task, task.function, s)) for s in inputs)
    return any(found[1] in values_in(one) and found[2] in values_in(other) for one, other in pairs)


def values_in(value: Any) -> set[str]:
    """The numbers and rows of a result, as they are shown."""
    return {number(entry) for part in parts(value) for entry in (part, *(part if part.ndim else ()))}


def is_unused(task: Task, function: Callable[..., Any], name: str) -> bool:
    """True if a function does not depend on an argument."""
    i = task.arguments.index(name)
    one, *others = (s for s in samples_of(task, TRUTH_SEED, 40) if same_form(s, samples_of(task, TRUTH_SEED, 1)[0]))
    changed = ((*one[:i], other[i], *one[i + 1 :]) for other in others)
    return all(same(result(task, function, one), result(task, function, other)) for other in changed)


def same_form(one: tuple[Any, ...], other: tuple[Any, ...]) -> bool:
    """True if arguments have the same shapes."""
    return [np.shape(a) for a in one] == [np.shape(b) for b in other]


def is_repaired(task: Task, source: str, line: int, before: str, after: str) -> bool:
    """True if a function is right with a text in its line for another one, at one of the places that have it."""
    for tree in edited_trees(source, line, before, after):
        try:
            function = function_of(task, tree)
            if all(same(result(task, function, s), result(task, task.function, s)) for s in samples_of(task, 5, 20)):
                return True
        except Exception:  # another place than the one that is meant
            continue
    return False


def edited_trees(source: str, line: int, before: str, after: str) -> Iterator[str]:
    """The files with a text for another one in a line, as Python writes it."""
    tree = ast.parse(source)
    for node in [node for node in ast.walk(tree) if getattr(node, "lineno", 0) == line]:
        if ast.unparse(node) != before:
            continue
        new = ast.parse(after).body if after else [ast.Pass()]
        value = new[0].value if isinstance(new[0], ast.Expr) and isinstance(node, ast.expr) else new[0]
        for parent in ast.walk(tree):
            for field, held in ast.iter_fields(parent):
                if held is node:
                    setattr(parent, field, value)
                    yield ast.unparse(ast.fix_missing_locations(tree))
                    setattr(parent, field, node)
                elif isinstance(held, list) and node in held:
                    i = held.index(node)
                    held[i] = value
                    yield ast.unparse(ast.fix_missing_locations(tree))
                    held[i] = node


NAMES = sorted({name for name, *_ in MISTAKES})
SLOW = {"cloth_forces", "cloth_links", "rope_acceleration", "sphere_force"}  # tasks whose mistakes take seconds


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.long if name in SLOW else ()) for name in NAMES])
def test_mistakes_are_named_so_that_one_knows_what_to_change(runner: Runner, name: str) -> None:
    task = TASKS[name]
    for words, body in [(words, body) for other, words, body in MISTAKES if other == name]:
        source = source_of(task, body)
        said = judged(runner, task, source)
        assert said is not None, body
        if isinstance(said, RunError):
            assert said.kind in EFFECTS, (body, said)
            assert any(word in str(said) for word in words.split("|")), (body, said)
            continue
        assert is_true(task, source, said), (body, said.mistake, said)
        assert any(word in f"{said.mistake}: {said}" for word in words.split("|")), (body, said.mistake, str(said))


def test_the_mistakes_are_as_many_as_the_audit_made() -> None:
    assert len(MISTAKES) == 95
    assert len(NAMES) == 23


def test_a_product_that_is_a_division_which_rounds_down_is_named(runner: Runner) -> None:
    """Its result is 0 at all inputs that are tried, and not at some others."""
    right = RIGHT["draft"]
    assert "oil_density * min(" in right
    source = source_of(TASKS["draft"], right.replace("oil_density * min(", "oil_density // min("))
    said = judged(runner, TASKS["draft"], source)
    assert isinstance(said, Wrong)
    assert "oil_density // min(" in str(said)
    assert is_true(TASKS["draft"], source, said)


def test_an_edit_that_leaves_a_small_part_wrong_is_not_said_to_make_it_right(runner: Runner) -> None:
    """With level / height the tension is too large by 1 N, less than a hundred-thousandth of most."""
    body = """level = weight * (hanging * hanging - height * height) / 2 + height
return np.hypot(level, weight * hanging)"""
    source = source_of(TASKS["line_tension"], body)
    said = judged(runner, TASKS["line_tension"], source)
    assert isinstance(said, Wrong)
    assert is_true(TASKS["line_tension"], source, said), str(said)


def test_no_form_is_told_that_leaves_out_a_small_part_of_the_result(runner: Runner) -> None:
    """A level part that lacks the weight twice is 1e-8 of the tension, and less at most inputs."""
    body = """level = (hanging * hanging - height * height) / weight / 2 / height
return np.hypot(level, weight * hanging)"""
    source = source_of(TASKS["line_tension"], body)
    said = judged(runner, TASKS["line_tension"], source)
    assert isinstance(said, Wrong)
    assert is_true(TASKS["line_tension"], source, said), str(said)


def test_no_form_is_told_of_a_function_that_is_infinite_wherever_it_is_tried(runner: Runner) -> None:
    """It is not at some other inputs, so that what agrees with it here need not agree there."""
    body = """a, b = z1 - level1, z0 - level0
s = np.full(a.shape, np.inf)
np.divide(a, a - level0, out=s, where=(a > 0) & (b <= 0))
return s"""
    source = source_of(TASKS["rain_hit"], body)
    said = judged(runner, TASKS["rain_hit"], source)
    assert isinstance(said, Wrong)
    assert is_true(TASKS["rain_hit"], source, said), str(said)


def test_an_argument_that_counts_only_where_it_is_small_is_not_called_unused(runner: Runner) -> None:
    body = """once = np.exp(-absorption * absorption)
return oil_colour + once * once * (absorption - oil_colour)"""
    source = source_of(TASKS["surface_colour"], body)
    said = judged(runner, TASKS["surface_colour"], source)
    assert isinstance(said, Wrong)
    assert str(said) == "The result does not change with water_colour and thickness."


def test_the_less_likely_edits_are_tried_around_a_conditional_expression_too() -> None:
    source = b"def one(a, b):\n    x = (a if a > b else b)\n    return 2 * x\n"
    found = {(edit.before, edit.after) for edit in own_edits(source, "one", {}, far=True)}
    assert any("if a > b else b" in before and before != after for before, after in found)


SIGNS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Pow)
COMPARISONS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)


def edited_at_random(tree: ast.Module, rng: random.Random) -> None:
    """Change one thing in a function."""
    nodes = [node for node in ast.walk(tree) if not isinstance(node, ast.arguments | ast.arg)]
    names = sorted({node.id for node in nodes if isinstance(node, ast.Name) and node.id not in ("np", "range", "len")})
    node: Any = rng.choice([node for node in nodes if isinstance(node, ast.BinOp | ast.Constant | ast.Name | ast.Compare
                            | ast.Call | ast.Tuple | ast.AugAssign | ast.UnaryOp | ast.Subscript)])  # fmt: skip
    if isinstance(node, ast.BinOp):
        if rng.random() < 0.7:
            node.op = rng.choice(SIGNS)()
        else:
            node.left, node.right = node.right, node.left
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        node.value = rng.choice((0, 1, 2, 3, 0.5, 10, -1, 1000, 9.8, node.value + 1, node.value * 1.1))
    elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in names:
        node.id = rng.choice(names)
    elif isinstance(node, ast.Compare):
        node.ops = [rng.choice(COMPARISONS)()]
    elif isinstance(node, ast.Call) and node.args:
        rng.shuffle(node.args)
    elif isinstance(node, ast.Tuple):
        rng.shuffle(node.elts)
    elif isinstance(node, ast.AugAssign):
        node.op = rng.choice(SIGNS)()
    elif isinstance(node, ast.UnaryOp):
        node.op = rng.choice((ast.USub, ast.UAdd))()


def wrong_at_random(rng: random.Random) -> Iterator[tuple[Task, str]]:
    """Right solutions with one or two edits at random."""
    while True:
        name = rng.choice(sorted(RIGHT))
        tree = ast.parse(source_of(TASKS[name], RIGHT[name]))
        own = next(node for node in tree.body if isinstance(node, ast.FunctionDef))
        for _ in range(rng.choice((1, 1, 2))):
            edited_at_random(ast.Module(own.body, []), rng)
        yield TASKS[name], ast.unparse(ast.fix_missing_locations(tree)) + "\n"


@pytest.mark.parametrize("count", [6, pytest.param(300, marks=[pytest.mark.stress, pytest.mark.timeout(3600)])])
def test_no_sentence_about_functions_with_edits_at_random_is_untrue(runner: Runner, count: int) -> None:
    drawn = wrong_at_random(random.Random(RANDOM_SEED))
    untrue, judged_wrong = [], 0
    while judged_wrong < count:
        task, source = next(drawn)
        said = judged(runner, task, source)
        if isinstance(said, Wrong):
            judged_wrong += 1
            if not is_true(task, source, said):
                untrue.append((source, said.mistake, str(said)))
    assert untrue == []
