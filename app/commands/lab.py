"""`springtide lab`: a folder of exercises made, worked on live, and checked; a class followed."""

import argparse
from pathlib import Path

from app.commands import open_lab
from app.commands.added_files import SCENE_OF_FILE
from app.messages import BaseParams
from app.scenes import scene_named

LIVE = "live"  # the command of the lab that need not be named


def add_arguments(lab: argparse.ArgumentParser) -> None:
    """The commands of `springtide lab`."""
    commands = lab.add_subparsers(metavar="DIR, new or check", required=True)
    lab.epilog = (
        "`springtide lab DIR` opens the scenes with the functions in that folder, live; "
        "`springtide lab class/*` shows the teacher the current task of each student."
    )
    live = commands.add_parser(LIVE, prog=lab.prog)
    folder_help = "a folder made by `springtide lab new`; several folders are a class"
    live.add_argument("folders", type=Path, nargs="+", metavar="DIR", help=folder_help)
    open_lab.add_arguments(live)
    live.set_defaults(run=run_live)
    # The options of `springtide lab DIR` stand in the help of `springtide lab`, where users look.
    lab.format_help = lambda: f"{argparse.ArgumentParser.format_help(lab)}\n{live.format_help()}"
    new = commands.add_parser("new", help="write a folder with the exercises")
    new.add_argument("folder", type=Path, metavar="DIR", help="a new or empty folder")
    new.add_argument("--solutions", action="store_true", help="for teachers: with the reference solutions")
    new.set_defaults(run=run_new)
    check = commands.add_parser("check", help="check the exercises; exit status 0 if all mandatory ones are right")
    check.add_argument("folders", type=Path, nargs="+", metavar="DIR", help="one folder, or those of a class")
    json = "write the results as JSON; without a file, print them"
    check.add_argument("--json", type=Path, nargs="?", const=Path("-"), metavar="FILE", help=json)
    check.add_argument("--csv", type=Path, metavar="FILE.csv", help="write a table, one row a folder")
    check.add_argument("--all", action="store_true", help="also list the tasks that are not begun")
    check.add_argument("--report", type=Path, metavar="FILE.html", help="write the page to hand in")
    check.set_defaults(run=run_check)
    for command in (live, new, check):
        more = "a folder with your own tasks, added to those of the course; see docs/lab.md"
        command.add_argument("--tasks", type=Path, action="append", default=[], metavar="FOLDER", help=more)


def with_live(words: list[str]) -> list[str]:
    """The words after `springtide lab`, with the command that `springtide lab DIR` leaves out."""
    return words if {*words[:1]} <= {"new", "check", LIVE, "-h", "--help"} else [LIVE, *words]


def run(arguments: argparse.Namespace) -> int:
    """Run the command of the lab that was named; returns the exit status."""
    return arguments.run(arguments)


def run_live(arguments: argparse.Namespace) -> int:
    """`springtide lab DIR`."""
    if len(arguments.folders) > 1:
        return serve_class(arguments)
    from app.lab.course.task import load_tasks
    from app.lab.student.session import Session
    from app.lab.student.workbook import Workbook

    session = Session(arguments.folders[0], load_tasks(*arguments.tasks), arguments.tasks)
    try:
        verdicts = session.versions
        states = lambda: {name: verdict.state for name, verdict in verdicts.verdicts.items()}  # noqa: E731
        workbook = Workbook(session.tasks, session.folder, states)
        choose_scene(arguments, workbook.set_up_of(workbook.task).scene)
        return open_lab.run(arguments, session, workbook)
    finally:
        session.close()


def choose_scene(arguments: argparse.Namespace, of_task: str) -> None:
    """Open a student's lab at the next task, unless another scene is requested. of_task: scene of that task."""
    is_asked = arguments.scene or arguments.resume or arguments.preset is not None or arguments.set
    if not is_asked and all(getattr(arguments, option) is None for option in SCENE_OF_FILE):
        arguments.scene = of_task
    if open_lab.scene_name(arguments) == open_lab.DEFAULT_SCENE and arguments.preset is None and not arguments.set:
        arguments.first_params = first_rope_of_student


def first_rope_of_student() -> BaseParams:
    """The rope that a student's lab opens: with RK4 a right solution equals the program's to rounding."""
    from app.scenes.setups import make_setup

    return make_setup(scene_named(open_lab.DEFAULT_SCENE), "", {"integrator": "rk4"}).params


def serve_class(arguments: argparse.Namespace) -> int:
    """`springtide lab class/*`."""
    from app.commands.lab_class import serve_class as serve_page

    plain = argparse.ArgumentParser()
    open_lab.add_arguments(plain)
    for name, default in vars(plain.parse_args([])).items():
        if name not in ("port", "no_open") and getattr(arguments, name) != default:
            option = f"--{name.replace('_', '-')}"
            raise ValueError(f"{option}: the class page takes --port, --no-open and --tasks only")
    return serve_page(arguments.folders, arguments.tasks, arguments.port, browser=not arguments.no_open)


def run_new(arguments: argparse.Namespace) -> int:
    """`springtide lab new`."""
    from app.commands.lab_folders import new

    return new(arguments.folder, arguments.tasks, solutions=arguments.solutions)


def run_check(arguments: argparse.Namespace) -> int:
    """`springtide lab check`."""
    from app.commands.lab_folders import check

    out = {"json": arguments.json, "csv": arguments.csv, "report": arguments.report}
    return check(arguments.folders, arguments.tasks, out, everything=arguments.all)
