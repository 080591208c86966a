"""Set-ups of the lab's tasks, and links that open a task."""

from app.lab import task
from app.lab.workbook import Workbook
from app.messages import BaseParams
from app.scenes import scene_named
from app.scenes.contract import AnyKind
from app.scenes.setups import Setup, read_query, split_task
from sim.parameters import check_record
from sim.validation import argument_error


def params_of_setup(setup: task.Setup) -> tuple[AnyKind, BaseParams, str]:
    """The scene of a task of the lab, its parameters, and the preset that they come from.

    Raises ValueError if the scene, the preset or a parameter does not exist.
    """
    kind = scene_named(setup.scene)
    preset = setup.preset or next(iter(kind.presets))
    if preset not in kind.presets:
        raise argument_error("preset", preset, "one of " + ", ".join(kind.presets))
    return kind, check_record(kind.params, {**kind.presets[preset], **setup.parameters}), preset


def read_link(query: str, workbook: Workbook | None) -> Setup:
    """The set-up of a link; of one that names only a task, with or without its scene, the task's own.

    Raises ValueError with everything in it that is not allowed.
    """
    name, rest = split_task(query)
    if not name:
        return read_query(query)
    if workbook is None:
        raise argument_error("task", name, "none in this lab")
    own = workbook.set_up_of(workbook.named(name))
    if rest not in ("", f"scene={own.scene}"):
        setup = read_query(rest)
        if setup.scene != own.scene:
            raise argument_error("scene", setup.scene, f"{own.scene}, that of task {name}")
        return setup._replace(task=name)
    kind, params, preset = params_of_setup(own)
    return Setup(kind.name, params, own.parameters, preset, task=name)
