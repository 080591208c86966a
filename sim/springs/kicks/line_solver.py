"""The system for the damping forces of links: a sparse symmetric matrix, by a factorisation along the lines.

`Coupling` holds its structure, which a mooring keeps. An entry couples two links that end at one free node or at one
body. A line alone has a tridiagonal matrix; links that meet where lines do fill in few more entries, as each line is
eliminated towards its more connected end.
"""

from collections import defaultdict
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel

# Links that meet at a free node or at a body: link, node and fairlead or -1.
Meeting = dict[tuple[str, int], list[tuple[int, int, int]]]


class Coupling(NamedTuple):
    """Structure of the matrix of links. A value is one of its lower triangle: the diagonal first, then the columns."""

    link_order: NDArray[np.int64]  # (links,) the link of each row
    columns_below: NDArray[np.int64]  # (links + 1,) first entry below the diagonal of each column
    rows_below: NDArray[np.int64]  # (entries,)
    # Value of the entry in the rows of each two entries of a column, which its elimination changes.
    link_targets: NDArray[np.int64]
    # (products, 7): value, two links, the node of each, and the fairlead of each or -1 for a node that is free
    products: NDArray[np.int64]


def coupling_of(ends: NDArray[np.int64], free: NDArray[np.bool_], carried: NDArray[np.int64]) -> Coupling:
    """The coupling of links between nodes `ends` (links, 2). free: (n,) nodes; carried: (fairleads, 2) node, body."""
    body_of = {int(node): (int(body), i) for i, (node, body) in enumerate(carried)}
    meeting: Meeting = defaultdict(list)
    for q, pair in enumerate(ends.tolist()):
        for node in pair:
            if node in body_of:
                body, fairlead = body_of[node]
                meeting["body", body].append((q, node, fairlead))
            elif free[node]:
                meeting["node", node].append((q, node, -1))
    order = elimination_order(ends, meeting, body_of)
    row_of = np.argsort(order)
    below = [set[int]() for _ in order]  # rows of the entries below the diagonal of each column
    for links in meeting.values():
        rows = {int(row_of[q]) for q, _, _ in links}
        for row in rows:
            below[row] |= {other for other in rows if other > row}
    for others in below:
        if others:
            first = min(others)
            below[first] |= others - {first}
    columns, rows, value = [0], list[int](), {(row, row): row for row in range(len(order))}
    for column, others in enumerate(below):
        for row in sorted(others):
            value[row, column] = len(order) + len(rows)
            rows.append(row)
        columns.append(len(rows))
    targets = [value[others[i], others[j]] for others in map(sorted, below)
               for i in range(len(others)) for j in range(i + 1)]  # fmt: skip
    products = []
    for links in meeting.values():
        for q, node, fairlead in links:
            for k, other, of_other in links:
                if row_of[q] >= row_of[k]:
                    products.append((value[row_of[q], row_of[k]], q, k, node, other, fairlead, of_other))
    return Coupling(
        np.asarray(order, np.int64), np.array(columns, np.int64), np.array(rows, np.int64),
        np.array(targets, np.int64), np.array(products, np.int64).reshape(-1, 7),
    )  # fmt: skip


def elimination_order(
    ends: NDArray[np.int64], meeting: Meeting, body_of: dict[int, tuple[int, int]]
) -> NDArray[np.int64]:
    """Links in the order of elimination: chains of links towards their end where more links meet."""

    def degree(node: int) -> int:
        if node in body_of:
            return len(meeting["body", body_of[node][0]])
        return len(meeting.get(("node", node), ()))

    order, start, links = [], 0, ends.tolist()
    while start < len(links):
        stop = start + 1
        while stop < len(links) and links[stop][0] == links[stop - 1][1] and degree(links[stop][0]) == 2:
            stop += 1
        chain = list(range(start, stop))
        order += chain[::-1] if degree(links[start][0]) > degree(links[stop - 1][1]) else chain
        start = stop
    return np.array(order, np.int64)


@kernel(noalias=True, allocates=False)
def factorise(values, columns, rows, targets):
    """Turn the values of a positive definite matrix into those of L D L^T."""
    n, t = columns.shape[0] - 1, 0
    for k in range(n):
        over = 1.0 / values[k]
        for e in range(columns[k], columns[k + 1]):
            part = values[n + e] * over
            for g in range(columns[k], e + 1):
                values[targets[t]] -= part * values[n + g]
                t += 1
        for e in range(columns[k], columns[k + 1]):
            values[n + e] *= over


@kernel(noalias=True, allocates=False)
def solve_factorised(values, columns, rows, y):
    """Turn y (rows,) into the solution of the matrix that `factorise` was given."""
    n = columns.shape[0] - 1
    for k in range(n):
        for e in range(columns[k], columns[k + 1]):
            y[rows[e]] -= values[n + e] * y[k]
    for turn in range(n):
        k = n - 1 - turn
        y[k] /= values[k]
        for e in range(columns[k], columns[k + 1]):
            y[k] -= values[n + e] * y[rows[e]]
