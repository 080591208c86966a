"""Coefficients of a dataset against physics: damping, smoothness, symmetry, and damping against the exciting force."""

import math

import numpy as np

from sim.dispersion import wavenumber
from sim.floating.linear.hydrodynamics import haskind
from sim.floating.linear.linear_table import LinearTable
from sim.inputs.bounds import beyond

SMALL = 0.05  # of the largest value of a motion: below it, values are not compared
MAIN = 0.2  # of the largest damping of a motion, from which on it is compared with that of the exciting force
MIN_NAMED = 1e-3  # of the largest damping of a kind of motion, below which another one is round-off
KINDS = ((0, 1, 2), (3, 4, 5))  # motions of the same unit


def doubts_of(
    omega: np.ndarray,
    added: np.ndarray,
    damping: np.ndarray,
    X: np.ndarray,
    table: LinearTable,
    motions: tuple[str, ...],
) -> list[str]:
    """Warnings on coefficients (n, 6, 6) and forces (n, headings, 6) of a file, and on the table made of them.

    omega (n,) [rad/s], rising.
    """
    doubts = [*doubts_of_matrices(omega, added, damping, motions), *doubts_of_forces(omega, X, motions)]
    return doubts or doubts_of_damping(omega, table, motions)


def doubts_of_matrices(
    omega: np.ndarray, added: np.ndarray, damping: np.ndarray, motions: tuple[str, ...]
) -> list[str]:
    """Warnings on added mass and damping (n, 6, 6) at rising omega (n,) [rad/s], as a file has them."""
    doubts = []
    for i, motion in enumerate(motions):
        own, like = damping[:, i, i], next(kind for kind in KINDS if i in kind)
        largest = float(np.abs(damping[:, i, i]).max())
        if largest > MIN_NAMED * max(float(np.abs(damping[:, j, j]).max()) for j in like):
            at = int(own.argmin())
            said = f"damping {own[at]:.3g}, {own[at] / largest:.2g} of its largest value,"
            where = place(motion, omega[at])
            doubts += beyond("dataset", "damping over its largest value", float(own[at]) / largest, where, said)
        for what, values in (("added mass", added[:, i, i]), ("damping", own)):
            doubts += spike(what, values, motion, omega)
    return [*doubts, *asymmetry("added mass", added, omega, motions), *asymmetry("damping", damping, omega, motions)]


def doubts_of_forces(omega: np.ndarray, X: np.ndarray, motions: tuple[str, ...]) -> list[str]:
    """Warnings on exciting forces (n, headings, 6) at rising omega (n,) [rad/s] that change in one frequency alone."""
    size = np.abs(X).max(axis=1)
    return [text for i, motion in enumerate(motions) for text in spike("exciting force", size[:, i], motion, omega)]


def place(motion: str, omega: float) -> str:
    """Motion and frequency [rad/s] in words."""
    return f"{motion} at omega {omega:.4g} rad/s"


def spike(what: str, values: np.ndarray, motion: str, omega: np.ndarray) -> list[str]:
    """A warning on the value (n,) that is the farthest above both beside it, if it is so by more than its bound."""
    size = np.abs(values)
    if len(size) < 3:
        return []
    beside = np.maximum(size[:-2], size[2:])
    typical = float(np.median(size))
    others = np.array([np.delete(size, i).max() for i in range(1, len(size) - 1)])
    ratio = np.where(size[1:-1] > SMALL * others, size[1:-1] / np.maximum(beside, max(1e-3 * typical, 1e-300)), 0.0)
    at = int(ratio.argmax())
    said = f"{what} {values[at + 1]:.3g}, {ratio[at]:.3g} times the values beside it,"
    return beyond("dataset", "value over those beside it", float(ratio[at]), place(motion, omega[at + 1]), said)


def asymmetry(what: str, values: np.ndarray, omega: np.ndarray, motions: tuple[str, ...]) -> list[str]:
    """A warning on the two motions whose coefficients (n, 6, 6) differ the most from those exchanged."""
    diagonal = np.sqrt(np.abs(np.einsum("nii->ni", values)).max(axis=0))
    scale = np.outer(diagonal, diagonal)
    apart = np.where(scale > 0.0, np.abs(values - values.swapaxes(1, 2)) / np.where(scale > 0.0, scale, 1.0), 0.0)
    n, i, j = (int(one) for one in np.unravel_index(int(apart.argmax()), apart.shape))
    said = f"{what} {values[n, i, j]:.3g} and {values[n, j, i]:.3g} with the motions exchanged: the difference"
    return beyond("dataset", "asymmetry", float(apart[n, i, j]),
                  place(f"{motions[i]} and {motions[j].lower()}", float(omega[n])), said)  # fmt: skip


def doubts_of_damping(omega: np.ndarray, table: LinearTable, motions: tuple[str, ...]) -> list[str]:
    """Warnings on damping that the exciting force contradicts, by Haskind's relation; none with one heading only.

    omega (n,) [rad/s] of the table.
    """
    if not math.isnan(table.heading):
        return []
    X, damping = table.excitation[0, 0], table.damping[0, 0]
    k = wavenumber(table.frequency, 1.0, table.depth)
    radiated = np.array([np.diag(haskind(one, float(each), table.depth)) for one, each in zip(X, k, strict=True)])
    own, wrong = np.einsum("nii->ni", damping), []
    for i, motion in enumerate(motions):
        like = next(kind for kind in KINDS if i in kind)
        largest = max(float(radiated[:, i].max()), float(own[:, i].max()))
        main = np.flatnonzero((np.maximum(radiated[:, i], own[:, i]) > MAIN * largest) & (radiated[:, i] > 0.0))
        if largest < MIN_NAMED * max(float(radiated[:, j].max()) for j in like) or not len(main):
            continue
        ratio = own[main, i] / radiated[main, i]
        miss = np.abs(np.log(np.maximum(ratio, 1e-9)))
        at = int(miss.argmax())
        said = f"damping {ratio[at]:.3g} times that which follows from the exciting force"
        texts = beyond("dataset", "damping over that of the exciting force", float(ratio[at]),
                       place(motion, float(omega[int(main[at])])), said)  # fmt: skip
        wrong += [(float(miss[at]), text) for text in texts]
    more = f"; so in {len(wrong)} motions" if len(wrong) > 1 else ""
    return [max(wrong)[1] + more] if wrong else []
