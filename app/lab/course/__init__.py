"""The course: tasks, the student's folder, the workbook and its answers."""
