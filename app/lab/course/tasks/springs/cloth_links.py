"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def cloth_links(rows, cols):
    """The links of a cloth of rows x cols points: an array of shape (links, 2) with the numbers of the two points.

    Point (i, j), row i and column j, has the number i cols + j. Three kinds of links, each pair once, in any order:
    structural (i, j)-(i, j+1) and (i, j)-(i+1, j); shear (i, j)-(i+1, j+1) and (i, j+1)-(i+1, j);
    bend (i, j)-(i, j+2) and (i, j)-(i+2, j).

    rows, cols: numbers of points, each at least 3.
    """
    links = []
    for i in range(rows):
        for j in range(cols):
            for di, dj in ((0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)):
                if i + di < rows and 0 <= j + dj < cols:
                    links.append((i * cols + j, (i + di) * cols + j + dj))
    return np.array(links)


def inputs(rng):
    rows, cols = rng.choice([3, 4, 5, 6], 2, replace=False)
    return int(rows), int(cols)


def normalise(links):
    """The pairs in ascending order, whatever the order of links and ends; another form stays as it is."""
    if links.ndim != 2 or links.shape[1] != 2:
        return links
    pairs = np.sort(links, axis=1)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def variant(offsets, wraps=False, swapped=False, twice=False, first=0):
    """A function that makes a mistake: other neighbours, or another numbering. first: column of neighbours."""

    def function(rows, cols):
        links = []
        for i in range(rows):
            for j in range(cols):
                for di, dj in offsets:
                    if i + di < rows and (wraps or first <= j + dj < cols):
                        a, b = i * cols + j, (i + di) * cols + j + dj
                        if swapped:
                            a, b = i + j * rows, i + di + (j + dj) * rows
                        if b < rows * cols:
                            links += [(a, b), (b, a)] if twice else [(a, b)]
        return np.array(links)

    return function


ALL = ((0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0))
MISTAKES = (
    Mistake(
        "no shear links",
        "The diagonals of the cells are missing.",
        variant(((0, 1), (1, 0), (0, 2), (2, 0))),
    ),
    Mistake("one diagonal only", "Each cell has two diagonals, and one is missing.", variant((*ALL[:3], *ALL[4:]))),
    Mistake("one diagonal only", "Each cell has two diagonals, and one is missing.", variant((*ALL[:2], *ALL[3:]))),
    Mistake("no bend links", "The links over two cells are missing.", variant(ALL[:4])),
    Mistake(
        "structural links only",
        "Only direct neighbours are joined. Shear and bend links are missing.",
        variant(ALL[:2]),
    ),
    Mistake(
        "end of a row joined to the next row",
        "The last point of a row is joined to the first of the next. Check that the column stays below cols.",
        variant(ALL, wraps=True),
    ),
    Mistake(
        "start of a row joined to its end",
        "The first point of a row is joined to the last of the same row. Check that the column is not below 0.",
        variant(ALL, first=-1),
    ),
    Mistake(
        "rows and columns swapped",
        "Points are numbered by columns. Point (i, j) has the number i cols + j.",
        variant(ALL, swapped=True),
    ),
    Mistake(
        "each link twice",
        "Every link is there twice, once from each end: the cloth is twice as stiff.",
        variant(ALL, twice=True),
    ),
)


def contrast(result, right, rows, cols):
    """The kinds of links that are missing, and those that are too many."""
    if result.ndim != 2 or result.shape[1] != 2:
        return ""
    has, needs = ({tuple(pair) for pair in links.tolist()} for links in (result, right))
    missing, extra = kinds(needs - has, cols), kinds(has - needs, cols)
    parts = [f"missing: {missing}"] if missing else []
    parts += [f"too many: {extra}"] if extra else []
    twice = len(result) - len(has)
    parts += [f"{twice} {'link is' if twice == 1 else 'links are'} there twice"] if twice > 0 else []
    return f"For {rows} x {cols} points: {'; '.join(parts)}." if parts else ""


def kinds(links, cols):
    """Links by their kinds, in words."""
    numbers = {}
    for a, b in ((int(a), int(b)) for a, b in links):
        down, across = b // cols - a // cols, b % cols - a % cols
        numbers[down, across] = numbers.get((down, across), 0) + 1
    return ", ".join(f"{count} of (i, j)-{end('i', i)}{end('j', j)}" for (i, j), count in sorted(numbers.items()))


def end(letter, offset):
    """One index of the second point of a link."""
    shifted = letter if offset == 0 else f"{letter}{offset:+d}"
    return f"({shifted}, " if letter == "i" else f"{shifted})"


CURVE = Curve(
    "points along each side",
    "links",
    np.arange(3.0, 17.0),
    lambda f, x: [len(f(int(n), int(n))) for n in x],
)


def behaviour(student):
    """Links over two columns at most, as many as there must be, and none from a point to itself."""
    rows, cols = 4, 7
    links = np.asarray(student(rows, cols))
    require(
        np.abs(np.diff(links % cols, axis=1)).max() <= 2,
        "a point at the end of a row is joined to one at the start of a row. Check that the column stays below cols.",
        "end of a row joined to the next row",
    )
    number = rows * (cols - 1) + cols * (rows - 1) + 2 * (rows - 1) * (cols - 1) + rows * (cols - 2) + cols * (rows - 2)
    require(len(links) == number, f"a cloth of 4 x 7 points has {number} links; yours has {len(links)}")
    require((links[:, 0] != links[:, 1]).all(), "a link joins a point to itself")
