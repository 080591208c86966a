"""Set-ups of the lab's tasks, and links that open a task."""

from app.lab.course import task
from app.lab.student.workbook import Workbook
from app.scenes import scene_named
from app.scenes.setups import Setup, make_setup, read_query, split_task
from sim.validation import argument_error


def setup_of_task(own: task.TaskSetup) -> Setup:
    """The set-up of a task of the lab. Raises ValueError if the scene, the preset or a parameter does not exist."""
    kind = scene_named(own.scene)
    return make_setup(kind, own.preset or next(iter(kind.presets)), own.parameters)


def read_link(query: str, workbook: Workbook | None) -> Setup:
    """The set-up of a link; of one that names only a task, with or without its scene, the task's own.

    Raises ValueError with all its errors.
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
    return setup_of_task(own)._replace(task=name)
