"""The course lab: a folder of exercises, checks that name mistakes, and a report to hand in.

Its rooms from top to bottom; none imports one above it:

- `report`: the page to hand in, the page of a class.
- `student`: the lab in the page (`workbook.py`), and the functions that a student saves while a scene runs
  (`session.py`).
- `check`: verdicts on a function (`program_check.py`), and on a folder.
- `process`: a process that runs a student's functions (`runner.py`, `worker.py`).
- `course`: `tasks/` holds the tasks, one TOML file each and, for programming tasks, one Python file with the reference
  solution and its check. `folder.py` writes the student's folder, `answers.py` reads its answers.
- `checking.py`: what the check of a task may declare.
- `diagnosis`: what is wrong with a function: terms, equations, edits, side effects.

Nothing here imports a viewer.
"""
