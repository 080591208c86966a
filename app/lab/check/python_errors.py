"""Python's errors, in words that name the change to make."""

import re

# Messages of Python, and the fault of the code behind each.
ERRORS = tuple(
    (re.compile(pattern), words)
    for pattern, words in (
        (
            r"truth value of an array",
            "A condition needs one answer, and this one has an answer for each entry: take one entry at a time in a "
            "loop, or use np.where, np.maximum and the like.",
        ),
        (
            r"only (0-dimensional|size-1|length-1) arrays can be converted",
            "A function of one number gets an array here. np.sqrt, np.exp and so on take arrays; np.linalg.norm is the "
            "length of a vector.",
        ),
        (
            r"setting an array element with a sequence|inhomogeneous shape",
            "One entry gets several numbers. An array of n vectors has the shape (n, 3), as np.zeros((n, 3)).",
        ),
        (r"bitwise_xor|operand type\(s\) for \^", "In Python ^ is no power: write **."),
        (r"EOFError|reading from stdin", "A checked function has no keyboard: use the arguments in place of input()."),
        (r"'NoneType'", "A value is None here: a function without return gives None, and so does list.append."),
        (
            r"'(int|float|numpy\.\w+)' object is not callable|'ndarray' object is not callable",
            "A number is called like a function here: a * is missing before a bracket, or a name such as sum stands "
            "for a number.",
        ),
        (r"missing \d+ required positional argument", "A call has too few arguments."),
        (r"takes .* positional arguments? but", "A call has too many or too few arguments."),
        (r"name 'np' is not defined", "Write import numpy as np at the top of the file."),
        (r"name 'math' is not defined", "Write import math at the top of the file."),
        (r"name '(null|true|false)' is not defined", "This may be a notebook: save it as Python (.py)."),
        (r"name '(get_ipython|display)' is not defined", "This name is known in notebooks only: remove the line."),
        (r"out of (bounds|range)", "The numbers of n entries are 0 to n - 1: does a loop go one too far?"),
        (
            r"could not be broadcast|operands could not|not aligned|mismatch in its core dimension",
            "Arrays of these shapes do not fit. Beside n vectors, shape (n, 3), n numbers need a column: [:, None].",
        ),
        (r"too many indices", "The array has fewer dimensions than indices."),
        (r"UnboundLocalError", "A branch in which it is not set has been taken, or it is set only below this line."),
        (r"RecursionError", "The function calls itself without an end."),
        (r"sequence by non-int|concatenate list|operand type\(s\) for .*'(list|tuple)'|bad operand type .*'list'",
         "A list is no vector: make an array of it, np.array(...)."),
        (r"not iterable", "A single number stands where several are needed."),
        (r"assignment destination is read-only", "This array cannot be changed: work on a copy."),
        (r"Cannot cast ufunc", "An array of whole numbers cannot take decimals: make it with np.zeros(...)."),
    )
)  # fmt: skip
INNER_NAME = re.compile(r"[\w.]+\.<locals>\.(\w+)|\b[A-Za-z]\w*\.__call__")


def in_plain_words(text: str) -> str:
    """An error's own text, and the cure if it is known."""
    said = INNER_NAME.sub(lambda match: match[1] or "the function", text)
    cure = next((words for pattern, words in ERRORS if pattern.search(text)), "")
    return f"{said.rstrip('.')}. {cure}" if cure else said
