"""A sentence about a wrong function is true of that function, and says what to change."""

import ast
import contextlib
import json
import random
import re
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from app.lab.check.comparing import call, conform, parts, reproduces, same
from app.lab.check.diagnose import behave
from app.lab.check.inputs import Watched, inputs_of
from app.lab.check.program_check import check_exactly, check_program, compare, settled
from app.lab.check.student_function import StudentFunction
from app.lab.checking import Counted, Wrong
from app.lab.course.task import Task, load_tasks
from app.lab.diagnosis.differences import number
from app.lab.diagnosis.edits import Tree, more_slips
from app.lab.diagnosis.effects import EFFECTS
from app.lab.process.runner import RunError, Runner
from tests.app.lab.solutions.audit_mistakes import MISTAKES
from tests.app.lab.solutions.followed import followed, says_a_repair
from tests.app.lab.solutions.right_solutions import RIGHT

TASKS = {task.name: task for task in load_tasks() if task.check is not None}
HEAD = "import numpy as np\n\nKEPT = {}\n\n"
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
    student = StudentFunction(runner, replace(task, file=file))
    try:
        compare(student)
        behave(student)
        check_exactly(student)
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


def is_true(runner: Runner, task: Task, source: str, said: Wrong) -> bool:
    """True if what is said of the function in a file holds for it."""
    function, text = function_of(task, source), str(said)
    if says_a_repair(text):
        with contextlib.suppress(ValueError):  # a sentence that cannot be followed
            return judged(runner, task, followed(source, text)) is None
        return False
    if said.form is not None:
        form = said.form
        return all(
            reproduces(result(task, form, s), result(task, function, s), call(task.function, s))
            for s in samples_of(task, TRUTH_SEED, 20)
        )
    if text.startswith("The result does not change with "):
        names = text.removeprefix("The result does not change with ").rstrip(".").split(" and ")
        return all(is_unused(task, function, name) for name in names)
    if text.startswith("it returns "):
        return said.mistake in ("NaN", "infinite", "wrong shape", "wrong type", "returns nothing")
    inputs = inputs_of(task.check, task.name)
    if (contrast := getattr(task.check, "contrast", None)) is not None:
        said_of = [contrast(result(task, function, s), result(task, task.function, s), *s) for s in inputs]
        return any(sentence and text.endswith(sentence) for sentence in said_of)
    found = re.search(r"(?:it|It) returns (\(.*?\)|\S+).*; expected (.+)\.$", text)
    assert found, text
    tried = [*inputs, *behaviour_inputs(task, function)]
    pairs = ((result(task, function, s), result(task, task.function, s)) for s in tried)
    return any(found[1] in values_in(one) and found[2] in values_in(other) for one, other in pairs)


def behaviour_inputs(task: Task, function: Callable[..., Any]) -> list[tuple[Any, ...]]:
    """The inputs at which the behaviour of a function is tried: those of a motion follow from its own results."""
    seen = []

    def noted(*arguments: Any) -> Any:
        seen.append(tuple(a.copy() if isinstance(a, np.ndarray) else a for a in arguments))
        return conform(call(function, arguments), call(task.function, arguments))

    with contextlib.suppress(Wrong):
        getattr(task.check, "behaviour", lambda _: None)(noted)
    return seen


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
            assert said.kind in (*EFFECTS, "raised"), (body, said)
            assert not says_a_repair(str(said)) or judged(runner, task, followed(source, str(said))) is None
            assert any(word in str(said) for word in words.split("|")), (body, said)
            continue
        assert is_true(runner, task, source, said), (body, said.mistake, said)
        assert any(word in f"{said.mistake}: {said}" for word in words.split("|")), (body, said.mistake, str(said))


FIRST_YEAR = json.loads((Path(__file__).parents[1] / "solutions" / "first_year_mistakes.json").read_text("utf-8"))
FORCE = RIGHT["spring_force"]


@pytest.mark.parametrize("step", [16, pytest.param(1, marks=[pytest.mark.stress, pytest.mark.timeout(3600)])])
def test_no_mistake_of_a_first_year_is_called_right_and_each_repair_does_what_it_says(
    runner: Runner, step: int
) -> None:
    """Each repair is done as the sentence says, and checked again. step: every how many mistakes one is tried."""
    refused = []
    for case in FIRST_YEAR[::step]:
        task = TASKS[case["function"]]
        source = source_of(task, case["body"])
        if "spring_force(" in case["body"]:
            source += source_of(TASKS["spring_force"], FORCE).removeprefix(HEAD)
        said = judged(runner, task, source)
        assert said is not None, case
        if says_a_repair(str(said)) and (again := judged(runner, task, followed(source, str(said)))) is not None:
            refused.append((case, str(said), str(again)))
    assert refused == []


@pytest.mark.parametrize(
    ("name", "words", "body"),
    [
        ("spring_force", "whole numbers", "F = np.zeros(3, dtype=int)\nr = x2 - x1\n"
         "l = np.sqrt(r @ r)\nfor i in range(3):\n"
         "    F[i] = stiffness * (l - rest_length) * r[i] / l - damping * (v1[i] - v2[i])\nreturn F"),
        ("gravity", "Brackets are missing", "return 9.81 * mass_ratio ** 1 / 3"),
        ("dispersion", "Without np.tanh(k)|gravity * k in place of",
         "w0 = 2 * np.pi / repeat_time\nreturn calm * np.floor(np.sqrt(gravity * k * np.tanh(k)) / w0) * w0"),
        ("step_rk4", "The sign // rounds the quotient down",
         "kx1, kv1 = v, acceleration(x, v)\n"
         "kx2, kv2 = v + h // 2 * kv1, acceleration(x + h // 2 * kx1, v + h // 2 * kv1)\n"
         "kx3, kv3 = v + h // 2 * kv2, acceleration(x + h // 2 * kx2, v + h // 2 * kv2)\n"
         "kx4, kv4 = v + h * kv3, acceleration(x + h * kx3, v + h * kv3)\n"
         "return x + h / 6 * (kx1 + 2 * kx2 + 2 * kx3 + kx4), v + h / 6 * (kv1 + 2 * kv2 + 2 * kv3 + kv4)"),
        ("wave_decay", "one factor only",
         "return amplitude * np.exp(-2 * viscosity * (wavenumber * time) ** 2)"),
        ("reflectance", "never holds", "if angle > np.arcsin(1 / index):\n    return 1\nc = np.cos(angle)\n"
         "t = np.sqrt(1 - (np.sin(angle) / index) ** 2)\nRs = ((c - index * t) / (c + index * t)) ** 2\n"
         "Rp = ((index * c - t) / (index * c + t)) ** 2\nreturn (Rs + Rp) / 2"),
    ],
)  # fmt: skip
def test_a_cause_is_named_rather_than_a_text_that_fits_by_accident(
    runner: Runner, name: str, words: str, body: str
) -> None:
    source = source_of(TASKS[name], body)
    said = judged(runner, TASKS[name], source)
    assert any(word in str(said) for word in words.split("|")), said
    assert judged(runner, TASKS[name], followed(source, str(said))) is None


CALLERS = {
    "rope_acceleration": """
n = len(x)
F = -drag * v
for i in range(n - 1):
    f = spring_force(x[i], x[i + 1], v[i], v[i + 1], stiffness, damping, rest_length)
    F[i] += f
    F[i + 1] -= f
a = F / mass
a[:, 2] -= gravity
a[0] = 0
return a""",
    "cloth_forces": """
F = np.zeros(x.shape)
for (i, j), d in zip(links, rest_lengths):
    f = spring_force(x[i], x[j], v[i], v[j], stiffness, damping, d)
    F[i] += f
    F[j] -= f
return F""",
}


@pytest.mark.parametrize("name", CALLERS)
@pytest.mark.parametrize("force", ["return x1 - x2", "..."])
def test_a_right_function_waits_for_the_one_that_it_calls(tmp_path: Path, name: str, force: str) -> None:
    task = TASKS[name]
    (tmp_path / "rope.py").write_text(source_of(TASKS["spring_force"], force), "utf-8")
    head = "" if task.file == "rope.py" else "from rope import spring_force\n"
    with (tmp_path / task.file).open("a", encoding="utf-8") as file:
        file.write(head + source_of(task, CALLERS[name]))
    own = [task, TASKS["spring_force"]]
    with Runner(tmp_path, time_limit=20.0) as runner:
        verdicts = {one.name: check_program(tmp_path, runner, one, own) for one in own}
    assert verdicts[name].state == "right"
    assert verdicts[name].calls == ("spring_force",)
    found = settled(name, verdicts)
    assert found.state == "waits"
    assert "it calls spring_force, which is" in found.text


@pytest.mark.parametrize("name", sorted(TASKS.keys() - {"cloth_links"}))  # which compares whole numbers in loops
def test_each_comparison_of_a_reference_has_inputs_on_both_sides(name: str) -> None:
    task = TASKS[name]
    watched = Watched(task.function)
    notes = [watched.sides(sample) for sample in inputs_of(task.check, name)]
    for i, text in enumerate(watched.texts):
        sides = np.concatenate([note[i].ravel() for note in notes if i in note])
        assert (sides < 0.0).any(), text
        assert (sides > 0.0).any(), text
        size = np.median(np.abs(sides[sides != 0.0]))
        assert np.abs(sides).min() < 0.1 * size, text


def test_the_mistakes_are_as_many_as_the_audit_made() -> None:
    assert len(MISTAKES) == 95
    assert len(NAMES) == 23


def test_a_product_that_is_a_division_which_rounds_down_is_named(runner: Runner) -> None:
    """Its result is 0 at all inputs that are tried, and not at some others."""
    right = RIGHT["draft"]
    assert "oil_density * min(" in right
    source = source_of(TASKS["draft"], right.replace("oil_density * min(", "oil_density // min("))
    said = judged(runner, TASKS["draft"], source)
    assert (
        "with oil_density * min(d, oil_thickness) in place of oil_density // min(d, oil_thickness)" in str(said).lower()
    )
    assert judged(runner, TASKS["draft"], followed(source, str(said))) is None


def test_an_edit_that_leaves_a_small_part_wrong_is_not_said_to_make_it_right(runner: Runner) -> None:
    """With level / height the tension is too large by 1 N, less than a hundred-thousandth of most."""
    body = """level = weight * (hanging * hanging - height * height) / 2 + height
return np.hypot(level, weight * hanging)"""
    source = source_of(TASKS["line_tension"], body)
    said = judged(runner, TASKS["line_tension"], source)
    assert isinstance(said, Wrong)
    assert is_true(runner, TASKS["line_tension"], source, said), str(said)


def test_no_form_is_told_that_leaves_out_a_small_part_of_the_result(runner: Runner) -> None:
    """A level part that lacks the weight twice is 1e-8 of the tension, and less at most inputs."""
    body = """level = (hanging * hanging - height * height) / weight / 2 / height
return np.hypot(level, weight * hanging)"""
    source = source_of(TASKS["line_tension"], body)
    said = judged(runner, TASKS["line_tension"], source)
    assert isinstance(said, Wrong)
    assert is_true(runner, TASKS["line_tension"], source, said), str(said)


def test_no_form_is_told_of_a_function_that_is_infinite_wherever_it_is_tried(runner: Runner) -> None:
    """It is not at some other inputs, so that what agrees with it here need not agree there."""
    body = """a, b = z1 - level1, z0 - level0
s = np.full(a.shape, np.inf)
np.divide(a, a - level0, out=s, where=(a > 0) & (b <= 0))
return s"""
    source = source_of(TASKS["rain_hit"], body)
    said = judged(runner, TASKS["rain_hit"], source)
    assert isinstance(said, Wrong)
    assert is_true(runner, TASKS["rain_hit"], source, said), str(said)


def test_an_argument_that_counts_only_where_it_is_small_is_not_called_unused(runner: Runner) -> None:
    body = """once = np.exp(-absorption * absorption)
return oil_colour + once * once * (absorption - oil_colour)"""
    source = source_of(TASKS["surface_colour"], body)
    said = judged(runner, TASKS["surface_colour"], source)
    assert isinstance(said, Wrong)
    assert str(said) == "The result does not change with water_colour and thickness."


def test_the_less_likely_edits_are_tried_around_a_conditional_expression_too() -> None:
    tree = Tree(b"def one(a, b):\n    x = (a if a > b else b)\n    return 2 * x\n", "one", {}, ())
    found = {(one.before, one.after) for candidate in more_slips(tree) for one in tree.words(candidate).replacements}
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


@pytest.mark.parametrize("count", [6, pytest.param(5000, marks=[pytest.mark.stress, pytest.mark.timeout(3600)])])
def test_no_sentence_about_functions_with_edits_at_random_is_untrue(runner: Runner, count: int) -> None:
    drawn = wrong_at_random(random.Random(RANDOM_SEED))
    untrue, judged_wrong = [], 0
    while judged_wrong < count:
        task, source = next(drawn)
        said = judged(runner, task, source)
        if isinstance(said, Wrong):
            judged_wrong += 1
            if not is_true(runner, task, source, said):
                untrue.append((source, said.mistake, str(said)))
    assert untrue == []


SIMULATED = """
x, v = np.array(x, float), np.array(v, float)
dt = {dt}
while x[2] > level or v[2] > 0:
    x = x + dt * v
    v[2] -= gravity * dt
x[2] = level
return x"""
STEPS = re.compile(
    r"Its largest error is (.+) % with (.+) in line (\d+), and (.+) % with (.+) there: an error of finite"
)


@pytest.mark.parametrize("dt", ["0.01", "0.001"])
def test_an_error_of_finite_steps_is_that_of_the_function_with_both_steps(runner: Runner, dt: str) -> None:
    task = TASKS["jet_landing"]
    source = source_of(task, SIMULATED.format(dt=dt))
    found = STEPS.search(str(judged(runner, task, source)))
    assert found
    before, old, line, after, new = found.groups()
    assert old == dt
    assert f"dt = {dt}" in source.splitlines()[int(line) - 1]
    for step, error in ((old, before), (new, after)):
        function = function_of(task, source.replace(f"dt = {dt}", f"dt = {step}"))
        pairs = [(call(function, s), call(task.function, s)) for s in inputs_of(task.check, task.name)[:16]]
        assert max(np.abs(a - b).max() / np.abs(b).max() for a, b in pairs) == pytest.approx(
            0.01 * float(error), rel=0.05
        )


def test_a_small_number_of_another_kind_is_no_step(runner: Runner) -> None:
    root = "np.sqrt(v[2] ** 2 + 2 * gravity * (x[2] - level) + 0.01)"
    body = f"t = (v[2] + {root}) / gravity\nreturn (x + v * t) * [1, 1, 0]"
    assert "finite steps" not in str(judged(runner, TASKS["jet_landing"], source_of(TASKS["jet_landing"], body)))


SOLVER = """
from scipy.integrate import solve_ivp
n = x.size
f = lambda t, y: np.concatenate([y[n:], acceleration(y[:n].reshape(-1, 3), y[n:].reshape(-1, 3)).ravel()])
y = solve_ivp(f, (0, h), np.concatenate([x.ravel(), v.ravel()]), method="{method}").y[:, -1]
return y[:n].reshape(-1, 3), y[n:].reshape(-1, 3)"""


@pytest.mark.parametrize("method", ["RK45", "RK23"])
@pytest.mark.parametrize(("name", "right"), [("step_rk4", "4 times"), ("step_euler", "1 time")])
def test_a_step_of_a_solver_is_told_by_its_calls(runner: Runner, name: str, right: str, method: str) -> None:
    task = TASKS[name]
    source = source_of(task, SOLVER.format(method=method))
    said = re.search(r"It calls acceleration (\d+) times in this step, the solution of the course (.+?)\.",
                     str(judged(runner, task, source)))  # fmt: skip
    assert said
    assert said[2] == right
    counts = set()
    for *state, acceleration in inputs_of(task.check, name):
        counted = Counted(acceleration)
        function_of(task, source)(*state, counted)
        counts.add(len(counted.calls))
    assert int(said[1]) in counts


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("return 6.67e-11 * 5.97e24 * mass_ratio / (6371 * mass_ratio ** (1 / 3)) ** 2", "is about 1e+06 times"),
        ("return 6.67e-11 * 5.97e27 * mass_ratio / (6371e3 * mass_ratio ** (1 / 3)) ** 2", "is about 1000 times"),
        ("return 9.81e-9 * mass_ratio ** (1 / 3)", "is 1e-09 times"),
        ("return -9.81e4 * mass_ratio ** (1 / 3)", "is -10000 times"),
        ("return 3.1e5 * mass_ratio ** (1 / 3)", "is 31600.4 times"),
    ],
)
def test_a_large_factor_is_that_of_all_results(runner: Runner, body: str, words: str) -> None:
    said = judged(runner, TASKS["gravity"], source_of(TASKS["gravity"], body))
    assert isinstance(said, Wrong)
    assert said.form is not None
    assert words in str(said)
    assert is_true(runner, TASKS["gravity"], source_of(TASKS["gravity"], body), said)
