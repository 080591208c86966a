"""The folder "Your code": state, speed and errors of the student's functions."""

import numpy as np
import viser

from app.formats.formatting import metres, number
from app.lab.check.program_check import Verdict
from app.lab.course.live_values import LiveValues
from app.lab.course.task import Task
from app.lab.diagnosis.equation_html import equation_lines
from app.lab.process.runner import BUSY, RunError
from app.lab.student.live_net import CLOTH, ROPE, StudentReport
from app.lab.student.live_tables import Call, LiveTables, TableReport
from app.lab.student.scene_values import VALUES, calls_here
from app.lab.student.session import CodeState, Session
from app.render.markup.axis import draw_axes, fitted, rounded
from app.render.markup.html import (
    ERROR_COLOUR,
    GOOD_COLOUR,
    WARNING_COLOUR,
    Html,
    bold,
    coloured,
    faint,
    fill,
    join,
    lines,
    note,
)
from app.scenes.charts import PALETTE

SAME = 1e-6  # [m] below which two ropes are the same
ROUNDING = 1e-9  # [m] by which a right solution may differ if nothing else explains a difference
MAX_EXPLAINED = 0.25  # [m] that the lines of `unlike` explain at most
BEYOND = (
    "That is more than these settings explain. A function that is called right below is right at the inputs of the "
    "check: look for a limit or a special case in it."
)
CHART_WIDTH, CHART_HEIGHT = 280, 148  # [pixels] of the chart of the difference
CHART_LEFT, CHART_BOTTOM, CHART_TOP = 40, 42, 22  # [pixels] of its margins
MAX_POINTS = 150  # of its line
ORDER = ("failed", "wrong", "waits", "not checked", "checking", "right")  # of the functions
COLOURS = {
    "right": GOOD_COLOUR,
    "wrong": ERROR_COLOUR,
    "failed": ERROR_COLOUR,
    "waits": WARNING_COLOUR,
    "checking": WARNING_COLOUR,
    "not checked": WARNING_COLOUR,
}


HINTS = {  # scene -> first step
    "rope": "Write spring_force in rope.py and save it: the rope uses it right away.",
    "cloth": "Write cloth_forces or cloth_links in cloth.py and save it: the cloth uses it right away.",
    "square_sea": "Write gravity, spectrum or dispersion in square_sea.py and save it: the sea uses it right away.",
    "radial_sea": "Write mixture_viscosity, wave_decay, reflectance or draft in radial_sea.py and save it: the sea "
    "uses it right away.",
}


NEEDS_SCIPY = "Plain Python is fast enough here. With SciPy installed np.linalg can be compiled."
TRANSLUCENT = {"rope": "rope (translucent)", "cloth": "cloth (yours is the translucent one)"}


class CodePanel:
    """Shows the state of a session."""

    def __init__(self, gui: viser.GuiApi, session: Session, scene: str) -> None:
        self.session, self.scene = session, scene
        self.net = session.cloth if scene == "cloth" else session.rope
        self.state = session.state  # as shown by the headline
        self.calls: dict[str, Call] = {}  # of functions at the numbers of the scene
        with gui.add_folder("Your code"):
            self.text = gui.add_html("")
            self.choice = gui.add_checkbox(
                "Use your functions",
                session.tables.shown,
                hint="Off: use the built-in ones, for comparison",
                visible=False,
            )

        @self.choice.on_update
        async def _(_: object) -> None:  # no coroutine: viser would call it in a pool of threads
            session.tables.show(self.choice.value)

    @property
    def is_stale(self) -> bool:
        """True if a version was saved, or has failed, since the last update."""
        return self.session.state != self.state

    def update(self, live: LiveValues) -> Html:
        """Show changes, and return one line on the state of the files. live: the values of the scene."""
        session = self.session
        self.state = session.state
        calls = calls_here(self.scene, session.begun, live)
        if calls.keys() != self.calls.keys() or not all(call.same(self.calls[name]) for name, call in calls.items()):
            self.calls = calls
            session.values.want(calls)
        state_text = code_lines(self.state, self.net.report, tables_of(session), self.scene)
        self.text.content = note(lines([state_text, function_lines(session, self.scene)]))
        self.choice.visible = bool(session.tables.tables)
        mistake = mistake_of(session, session.begun)
        return headline(self.state, self.net.report, tables_of(session), self.scene, mistake)


def tables_of(session: Session) -> TableReport:
    """Functions that run by tables, and the others that the student has begun."""
    report, begun = session.tables.report, session.begun
    idle = {name: why for name, why in report.idle.items() if name in begun}
    return report._replace(idle=idle, off=bool(session.tables.tables) and not session.tables.shown)


def place_of(error: RunError) -> str:
    """The file of an error, and its line if known."""
    return f"{error.file}, line {error.line}" if error.line else error.file


def is_busy(state: CodeState) -> bool:
    """True if the newest version could not be run for a reason outside it."""
    return state.error is not None and state.error.kind == BUSY


def busy_text(state: CodeState) -> Html:
    """The reason, and a note that it will be tried again."""
    return coloured(f"could not be run ({state.error.text if state.error else ''}); trying again", WARNING_COLOUR)


def mistake_of(session: Session, begun: frozenset[str]) -> str:
    """The first mistake of a function under way, in the order of the lab; "" if none is known."""
    verdicts = ((task.name, session.versions.verdicts.get(task.name)) for task in session.tasks if task.name in begun)
    mistake = next(((name, verdict) for name, verdict in verdicts if verdict and verdict.state == "wrong"), None)
    return "" if mistake is None else f"{mistake[0]} is wrong: {mistake[1].mistake or mistake[1].sentence}"


def headline(state: CodeState, report: StudentReport, tables: TableReport, scene: str, mistake: str = "") -> Html:
    """State of the files on one line, for the head of the panel.

    mistake: in a running function.
    """
    if is_busy(state):
        return fill("Your code: {}", busy_text(state))
    if state.error is not None:
        place, text = place_of(state.error), state.error.text
        return fill("Your code: {}: {}: {}", coloured("stopped", ERROR_COLOUR), place, text)
    if report.left_at == report.left_at:
        left = f"the {scene} left its bounds at t = {report.left_at:.2f} s"
        return fill("Your code: {}", coloured(left, ERROR_COLOUR))
    runs = bool(report.version or tables.running)
    if mistake:
        return fill("Your code: {}", coloured(f"{'runs, but ' if runs else ''}{mistake}", WARNING_COLOUR))
    if not runs:
        nothing = "this scene uses none of your functions yet"
        return fill("Your code: {}", nothing if state.version else "reading your files …")
    return fill("Your code: {} since {}", coloured("runs", GOOD_COLOUR), state.saved_at)


def code_lines(state: CodeState, report: StudentReport, tables: TableReport, scene: str) -> Html:
    """The saved version, its error, and the part of the scene that it moves."""
    runs = bool(report.version or tables.running)
    texts: list[Html] = [saved_text(state, HINTS.get(scene, ""), runs=runs or tables.off)]
    if state.error is not None and not is_busy(state):
        place = bold(place_of(state.error))
        texts.append(fill('<div class="springtide-code-error">{}: {}</div>', place, state.error.text))
        if runs:
            texts.append(fill("The last version that worked stays in use."))
    if report.version:
        texts += net_texts(state, report, scene)
    return lines([*texts, *sea_texts(tables)])


def sea_texts(tables: TableReport) -> list[Html]:
    """The functions that move a sea, those that it does not use, and the difference from the program's sea."""
    texts: list[Html] = []
    if tables.off:
        texts.append(fill("The sea uses the built-in functions."))
    if tables.running:
        what = join((fill("{} ({})", bold(name), moved) for name, moved in tables.running.items()), ", ")
        texts.append(fill("The sea uses your {}.", what))
    for name, own, program, unit in tables.differences:
        value, reference = (f"{number(x, 3)} {unit}" if x == x else "…" for x in (own, program))
        texts.append(fill("{} {} (program {})", name, bold(value), reference))
    texts += [faint(f"To use your {name} here: {why}.") for name, why in tables.idle.items()]
    return texts


def saved_text(state: CodeState, hint: str, *, runs: bool) -> Html:
    """The version, and the first function to write if none runs."""
    if not state.version:
        return fill("Reading your files …")
    if is_busy(state):
        return fill("Saved at {}: {}", state.saved_at, busy_text(state))
    if state.error is not None:
        return fill("Saved at {}: {}", state.saved_at, coloured("stopped", ERROR_COLOUR))
    if not runs and hint:
        return fill("{}", hint)
    return fill("Saved at {}: {}", state.saved_at, coloured("runs", GOOD_COLOUR))


def net_texts(state: CodeState, report: StudentReport, scene: str) -> list[Html]:
    """The rope or cloth that the student's functions move."""
    used = (CLOTH if scene == "cloth" else ROPE).in_use(report.own, report.method, sphere=report.sphere)
    own = ", ".join(name for name, is_own in used.items() if is_own)
    other = ", ".join(name for name, is_own in used.items() if not is_own)
    texts = [fill("Your {} is driven by {}{}.", scene, bold(own), fill(" (reference: {})", other) if other else "")]
    if not own:
        texts = [fill("Your {} has not moved yet.", scene)]
    if report.seconds:
        pace = report.step / report.seconds
        speed = f"{1e6 * report.seconds:.0f} µs a step, {number(pace)} times real time"
        compiled_names = [name for name in report.compiled if used.get(name)]
        rest = [name for name, is_own in used.items() if is_own and name not in compiled_names]
        how = f"{', '.join(compiled_names)} compiled by numba" if compiled_names else "Plain Python"
        how += f", {', '.join(rest)} plain Python" if compiled_names and rest else ""
        texts.append(fill("{}: {}.", how, speed if pace > 1.0 else coloured(speed, WARNING_COLOUR)))
        if state.not_compiled and not compiled_names:
            needs_scipy = "scipy" in state.not_compiled.lower()
            texts.append(faint(NEEDS_SCIPY if needs_scipy else f"Not compiled: {state.not_compiled}"))
    if report.left_at == report.left_at:
        texts.append(coloured(f"Your {scene} left its bounds at t = {report.left_at:.2f} s.", ERROR_COLOUR))
    elif report.difference == report.difference:
        apart = "Less than 1 µm" if report.difference < SAME else metres(report.difference)
        texts.append(fill("{} from the program's {}.", bold(apart), TRANSLUCENT[scene]))
        texts.append(difference_chart(report, scene))
        if report.difference > (MAX_EXPLAINED if report.unlike else SAME):
            texts.append(coloured(BEYOND, WARNING_COLOUR))
    elif report.restarts and own:
        texts.append(fill("It has not moved far enough since its restart to be compared."))
    if report.grid != (0, 0):
        rows, cols = report.grid
        what = "Rows and columns: {} × {} points, without pleats, self-collision and mouse, as plain Python is slow."
        texts.append(fill(what, rows, cols))
    if not report.difference < ROUNDING:
        texts += [faint(line) for line in report.unlike]
    texts += [faint(line) for line in report.left_out]
    if report.restarts:
        often = "once" if report.restarts == 1 else f"{report.restarts} times"
        texts.append(faint(f"It fell behind {often}, so it was restarted from the built-in {scene}."))
    return texts


def difference_chart(report: StudentReport, thing: str) -> Html:
    """Chart of the difference over time; "" without a difference. thing: "rope" or "cloth".

    A chart of viser's (uPlot) in a folder widens the panel with each change of its axes.
    """
    times, differences = report.times, report.differences
    if len(times) < 2 or differences.max() < SAME:
        return Html()
    chosen = np.unique(np.linspace(0, len(times) - 1, MAX_POINTS).astype(int))
    x = fitted("t [s]", float(times[0]), float(times[-1]), CHART_LEFT, CHART_WIDTH - CHART_LEFT - 4)
    bottom = CHART_HEIGHT - CHART_BOTTOM
    name = f"Distance from the program's {thing} [m]"
    y = rounded(name, 0.0, float(differences.max()), bottom, CHART_TOP - bottom)
    points = zip(times[chosen].tolist(), differences[chosen].tolist(), strict=True)
    line = " ".join(f"{x.at(time):.1f},{y.at(difference):.1f}" for time, difference in points)
    return fill(
        '<svg class="springtide-difference" viewBox="0 0 {w} {h}" width="100%" role="img" font-size="11" '
        'fill="currentColor"><title>Distance of your {thing} from the program\'s [m] over time [s]</title>{axes}'
        '<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/></svg>',
        thing=thing, w=CHART_WIDTH, h=CHART_HEIGHT, axes=draw_axes(x, y), line=line, colour=PALETTE[0],
    )  # fmt: skip


def function_lines(session: Session, scene: str) -> Html:
    """State and errors of each function under way: mistakes first, beginning with the file of the scene."""
    verdicts, waiting = session.versions.verdicts, session.check.waiting
    rows: list[tuple[int, bool, Html]] = []
    is_left = False
    for task in session.tasks:
        if not task.file:
            continue
        verdict = verdicts.get(task.name, Verdict("checking" if task.name in waiting else "not begun"))
        if verdict.state == "not begun":
            is_left = True
        else:
            compared = compared_text(scene, task.name, session.values)
            rows.append(
                (ORDER.index(verdict.state), task.file != f"{scene}.py", function_line(task, verdict, compared))
            )
    rest = faint("The other functions are not begun.") if is_left else Html()
    return join([*(line for *_, line in sorted(rows, key=lambda row: row[:2])), rest])


def compared_text(scene: str, task: str, values: LiveTables) -> Html:
    """The function at the numbers of the scene, beside the program's number; nothing where its newest version fails."""
    value, table = VALUES.get((scene, task)), values.tables.get(task)
    if value is None or table is None or task in values.errors:
        return Html()
    student, program = (f"{number(x, 4)} {value.unit}".rstrip() for x in (float(table.values[0]), table.call.program))
    return fill('<div class="springtide-faint">{}: {}, program {}</div>', value.what, bold(student), program)


def function_line(task: Task, verdict: Verdict, compared: Html) -> Html:
    """One function: its name and state, its errors, and its values in the scene."""
    why = verdict.located if verdict.text else ""
    return fill(
        '<div class="springtide-function" data-function="{}" data-state="{}">{} {}{}{}{}</div>',
        task.name, verdict.state, task.name, coloured(verdict.state, COLOURS[verdict.state]),
        fill('<div class="springtide-faint">{}</div>', why) if why else "",
        equation_lines(verdict.equations) if verdict.equations else "",
        compared,
    )  # fmt: skip
