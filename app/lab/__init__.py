"""The course lab: a folder of exercises, checks that name mistakes, and a report to hand in.

`tasks/` holds the tasks, one TOML file each and, for programming tasks, one Python file with the
reference solution and its check. `folder.py` writes the student's folder, `runner.py` runs the student's functions in
a separate process, `program_check.py` and `answer_check.py` judge, `report.py` writes the page to hand in.
`workbook.py` is the lab in the page, and `session.py` lets a scene run the functions that a student saves meanwhile.
Nothing here imports a viewer.
"""
