"""The equations of a wrong function as HTML, for the panel and the report."""

import re
from collections.abc import Sequence

from app.lab.diagnosis.equations import NEW
from app.lab.diagnosis.explanation import Equation
from app.render.markup.html import Html, fill, join

NUMBERED = re.compile(r"\b([xva])(\d+)\b|\bnew ([xv])\b")


def equation_lines(equations: Sequence[Equation]) -> Html:
    """Each equation on a line, its wrong terms in red, and the right one below: classes "wrong" and "right"."""
    is_step = any(line.name.startswith(NEW) for line in equations)
    head = fill('<div class="faint springtide-faint">a₂ is the acceleration at x₂ and v₂, and so on.</div>')
    lines = join(equation_line(line) for line in equations)
    return fill('<div class="springtide-equations">{}{}</div>', head if is_step else Html(), lines)


def equation_line(line: Equation) -> Html:
    """One equation."""
    expression = join(
        fill('<b class="wrong">{}</b>', notation(piece.text)) if piece.wrong else notation(piece.text)
        for piece in line.pieces
    )
    right = fill('<div class="right">must be {}</div>', notation(line.right)) if line.right else Html()
    return fill("<div>{} = {}{}</div>", notation(line.name), expression, right)


def notation(text: str) -> Html:
    """A text with the numbers of stages as subscripts."""
    parts, at = [], 0
    for match in NUMBERED.finditer(text):
        letter, number, new = match.groups()
        parts += [fill("{}", text[at : match.start()]), fill("{}<sub>{}</sub>", letter or new, number or "new")]
        at = match.end()
    return join([*parts, fill("{}", text[at:])])
