"""Formulas as MathML, which browsers draw themselves: from a short notation as in `F = (ρ_w − ρ_o) g V`.

A single letter is a variable, a word of two or more letters stands upright. `_` and `^` take one item or `{...}`,
`\\frac{a}{b}` and `\\sqrt{a}` are as in TeX, and a text in quotation marks is a text.
"""

import re
from typing import NamedTuple

from app.render.markup.html import Html, fill, join

TOKEN = re.compile(r'\s*(?:(\\[a-z]+)|(\d+(?:\.\d+)?)|([A-Za-z]{2,})|([^\W\d_])|"([^"]*)"|(\S))')
MINUS = {"-": "−", "*": "·"}
BRACKETS = "()|[]"
# Fonts with the measures of formulas: a browser may know none itself, and would put subscripts on the line.
FONTS = (
    "Cambria Math",
    "STIX Two Math",
    "Latin Modern Math",
    "Libertinus Math",
    "Noto Sans Math",
    "DejaVu Math TeX Gyre",
)
GAP = Html('<mspace width="0.17em"></mspace>')


class Parsed(NamedTuple):
    """MathML of a part of a formula, and where the rest begins."""

    html: Html
    at: int


def formula(text: str) -> Html:
    """A formula as MathML, on a line of its own. Raises ValueError for braces that do not match, or an unknown word."""
    tokens = [match for match in TOKEN.finditer(text) if match.group().strip()]
    content = row(tokens, 0, closed=False)
    return fill('<math display="block" style="font-family: {}, math">{}</math>', ", ".join(FONTS), content.html)


def row(tokens: list[re.Match[str]], at: int, *, closed: bool) -> Parsed:
    """Items up to the end, or up to the brace that closes them."""
    parts: list[Html] = []
    was_function = False  # a word, as ln, that stands before its argument
    while at < len(tokens) and tokens[at].group().strip() != "}":
        part = scripted(tokens, at)
        if was_function and tokens[at].group().strip() not in BRACKETS:
            parts.append(GAP)
        was_function = tokens[at][3] is not None
        parts.append(part.html)
        at = part.at
    if closed != (at < len(tokens)):
        raise ValueError("the braces do not match")
    return Parsed(fill("<mrow>{}</mrow>", join(parts)), at + 1 if closed else at)


def scripted(tokens: list[re.Match[str]], at: int) -> Parsed:
    """An item with its subscript and superscript."""
    base = item(tokens, at)
    scripts: dict[str, Html] = {}
    at = base.at
    while at < len(tokens) and tokens[at].group().strip() in ("_", "^"):
        sign = tokens[at].group().strip()
        script = item(tokens, at + 1)
        scripts[sign], at = script.html, script.at
    below, above = scripts.get("_"), scripts.get("^")
    if below is not None and above is not None:
        return Parsed(fill("<msubsup>{}{}{}</msubsup>", base.html, below, above), at)
    if below is not None:
        return Parsed(fill("<msub>{}{}</msub>", base.html, below), at)
    if above is not None:
        return Parsed(fill("<msup>{}{}</msup>", base.html, above), at)
    return Parsed(base.html, at)


def item(tokens: list[re.Match[str]], at: int) -> Parsed:
    """One item: a letter, a number, a sign, a group in braces, a fraction or a root."""
    if at >= len(tokens):
        raise ValueError("something is missing at the end")
    command, number, word, letter, text, sign = tokens[at].groups()
    if sign == "{":
        return row(tokens, at + 1, closed=True)
    if command == "\\frac":
        above = item(tokens, at + 1)
        below = item(tokens, above.at)
        return Parsed(fill("<mfrac>{}{}</mfrac>", above.html, below.html), below.at)
    if command == "\\sqrt":
        inside = item(tokens, at + 1)
        return Parsed(fill("<msqrt>{}</msqrt>", inside.html), inside.at)
    if command is not None:
        raise ValueError(f"{command} is not known")
    if number is not None:
        return Parsed(fill("<mn>{}</mn>", number), at + 1)
    if word is not None or letter is not None:
        return Parsed(fill("<mi>{}</mi>", word or letter), at + 1)
    if text is not None:
        return Parsed(fill("<mtext>\u00a0{}\u00a0</mtext>", text), at + 1)
    if sign in BRACKETS:
        return Parsed(fill('<mo stretchy="false" lspace="0" rspace="0">{}</mo>', sign), at + 1)
    return Parsed(fill("<mo>{}</mo>", MINUS.get(sign, sign)), at + 1)
