"""Open meshes: where they are open, and four ways to close one: divide edges, weld, mirror, and a deck.

A mesh is open where an edge has no opposite. In meshes of panels one long edge may meet several short ones of finer
neighbours: `divided` splits it at their nodes. CAD programs leave gaps between surfaces, which `welded` closes; models
of symmetric hulls are halves, which `mirrored` completes; hulls of shells have no deck, which `capped` adds.
"""

import itertools

import numpy as np

from sim.floating.hulls.closed_mesh import enclosed_volume, open_edges, parts_of
from sim.validation import argument_error, check_choice, check_number

AXES = ("x", "y")
WELDS = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 5e-2)  # [m] that are tried for advice
MAX_WELD = 3e-3  # of the largest extent
LEVEL = 1e-3  # of the largest extent: how far the edges of a plane of symmetry may lie from it
TURNS = np.array([[0, 1, 2], [0, 2, 3]])  # corners of the two triangles of a quadrangle
ON_EDGE = 1e-6  # of the size of a mesh: how far a node may lie from the edge that it divides
MAX_DIVIDED = 20_000  # open edges, up to which they are looked at one by one
SIMPLE_LOOP = "an open loop that does not cross itself, as seen from above"
SMALLEST_EAR = 1e-12  # of the area of a loop


def triangles_of(corners: np.ndarray) -> np.ndarray:
    """Triangles (k, 3) of faces (m, 3) or (m, 4), without those that repeat a corner."""
    faces = corners[:, TURNS].reshape(-1, 3) if corners.shape[1] == 4 else corners
    return faces[~degenerate(faces)]


def degenerate(faces: np.ndarray) -> np.ndarray:
    """Mask (m,) of the faces (m, 3) that repeat a corner."""
    return (faces[:, 0] == faces[:, 1]) | (faces[:, 1] == faces[:, 2]) | (faces[:, 2] == faces[:, 0])


def welded(vertices: np.ndarray, faces: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """The mesh with corners nearer than a tolerance [m] made one, without the faces that this makes lines.

    Corners up to 3.5 times as far apart may become one, too.
    """
    if tolerance == 0.0 or not len(vertices):
        return vertices, faces
    scaled, pairs = vertices / (2.0 * tolerance), []
    # two points within the tolerance share a cell of twice its size in at least one of eight grids
    for shift in np.ndindex(2, 2, 2):
        cells = np.floor(scaled + 0.5 * np.array(shift))
        order = np.lexsort(cells.T)
        same = (np.diff(cells[order], axis=0) == 0.0).all(axis=1)
        pairs.append(np.stack([order[:-1][same], order[1:][same], order[1:][same]], axis=1))
    label = (
        parts_of(np.concatenate(pairs), len(vertices)) if any(len(one) for one in pairs) else np.arange(len(vertices))
    )
    faces = label[faces]
    return vertices, faces[~degenerate(faces)]


def divided(vertices: np.ndarray, faces: np.ndarray, tolerance: float) -> np.ndarray:
    """The faces (m, 3) with open edges divided at the ends of other open edges on them, within a tolerance [m].

    No corner moves.
    """
    edges = open_boundary(faces)
    if not 0 < len(edges) <= MAX_DIVIDED:
        return faces
    nodes = np.unique(edges)
    nodes = nodes[np.argsort(vertices[nodes, 0], kind="stable")]
    places = vertices[nodes]
    ends = vertices[edges]
    low = np.searchsorted(places[:, 0], ends[:, :, 0].min(axis=1) - tolerance)
    high = np.searchsorted(places[:, 0], ends[:, :, 0].max(axis=1) + tolerance, side="right")
    on: dict[tuple[int, int], list[int]] = {}  # edge -> the nodes on it, from its first corner on
    for (a, b), (start, end), first, last in zip(edges.tolist(), ends, low.tolist(), high.tolist(), strict=True):
        along = end - start
        length = float(np.linalg.norm(along))
        if length <= 2.0 * tolerance:
            continue
        offset = places[first:last] - start
        at = offset @ along / length
        aside = np.linalg.norm(offset - np.outer(at / length, along), axis=1)
        chosen = np.flatnonzero((aside <= tolerance) & (at > tolerance) & (at < length - tolerance))
        if len(chosen):
            on[a, b] = nodes[first:last][chosen[np.argsort(at[chosen])]].tolist()
    if not on:
        return faces
    whole = np.array([not any((row[i - 1], row[i]) in on for i in range(3)) for row in faces.tolist()])
    pieces, left = [], faces[~whole].tolist()
    while left:
        face = left.pop()
        turned = ((face[i - 2], face[i - 1], face[i]) for i in range(3))
        edge = next(((a, b, c) for a, b, c in turned if (a, b) in on and c not in on[a, b]), None)
        if edge is None:
            pieces.append(face)
        else:
            a, b, c = edge
            left.extend([u, v, c] for u, v in itertools.pairwise([a, *on[a, b], b]))
    return np.concatenate([faces[whole], np.array(pieces, faces.dtype).reshape(-1, 3)])


def mirrored(vertices: np.ndarray, faces: np.ndarray, axis: str, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """The mesh and its image across x = 0 or y = 0; corners within a tolerance [m] of the plane come to lie in it.

    Raises ValueError for a mesh that lies on both sides.
    """
    i = AXES.index(check_choice("mirror", axis, AXES))
    place = np.where(np.abs(vertices[:, i]) <= tolerance, 0.0, vertices[:, i])
    used = place[np.unique(faces)]
    if len(used) and used.min() < 0.0 < used.max():
        allowed = f"a mesh on one side of {axis} = 0; this one has {axis} from {used.min():.4g} to {used.max():.4g} m"
        raise argument_error("mirror", axis, allowed)
    vertices = vertices.copy()
    vertices[:, i] = place
    sign = np.ones(3)
    sign[i] = -1.0
    n = len(vertices)
    image = np.where(place == 0.0, np.arange(n), np.arange(n) + n)
    # faces within the plane would close each half by itself
    across = (place[faces] != 0.0).any(axis=1)
    faces = faces[across]
    return np.concatenate([vertices, vertices * sign]), np.concatenate([faces, image[faces][:, ::-1]])


def open_boundary(faces: np.ndarray) -> np.ndarray:
    """Directed edges (k, 2) of faces (m, 3) that have not exactly one opposite."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    width = int(faces.max()) + 1 if len(faces) else 1
    forward, backward = edges[:, 0] * width + edges[:, 1], edges[:, 1] * width + edges[:, 0]
    known, count = np.unique(forward, return_counts=True)
    once = known[count == 1]
    return edges[~(np.isin(forward, once) & np.isin(backward, once))]


def loops_of(edges: np.ndarray) -> list[list[int]]:
    """Closed loops of directed edges (k, 2), each followed to where it began; other edges are left out."""
    after: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        after.setdefault(a, []).append(b)
    loops = []
    while after:
        start = next(iter(after))
        loop, place = [], start
        while place in after:
            loop.append(place)
            following = after[place].pop()
            if not after[place]:
                del after[place]
            place = following
            if place == start:
                break
        if place == start and len(loop) > 2:
            loops.append(loop)
    return loops


def capped(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The mesh with a deck over each open loop in its upper half.

    Raises ValueError without a loop, or for one that crosses itself as seen from above.
    """
    z = vertices[np.unique(faces), 2]
    middle = 0.5 * (z.min() + z.max())
    loops = [loop for loop in loops_of(open_boundary(faces)) if vertices[loop, 2].min() >= middle]
    if not loops:
        raise argument_error("cap", "deck", "a mesh with an open loop in its upper half")
    return vertices, np.concatenate([faces, *(filled(vertices[:, :2], loop[::-1]) for loop in loops)])


def filled(points: np.ndarray, loop: list[int]) -> np.ndarray:
    """Triangles (n - 2, 3) that fill a loop of n indices of points (k, 2), by cutting off ears (Meisters 1975).

    Raises ValueError for a loop that crosses itself.
    """
    x, y = points[loop].T
    area = 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())
    turn, left, triangles = 1.0 if area >= 0.0 else -1.0, list(loop), []
    least = SMALLEST_EAR * abs(area)
    while len(left) > 3:
        ear = next((i for i in range(len(left)) if is_ear(points, left, i, turn, least)), None)
        if ear is None:  # all that is left lies on lines: any corner will do, if it cuts off nothing
            ear = next((i for i in range(len(left)) if abs(corner_area(points, left, i)) <= least), None)
        if ear is None:
            raise argument_error("cap", "deck", SIMPLE_LOOP)
        triangles.append([left[ear - 1], left[ear], left[(ear + 1) % len(left)]])
        del left[ear]
    if turn * corner_area(points, left, 1) < -least:
        raise argument_error("cap", "deck", SIMPLE_LOOP)
    return np.array([*triangles, left], np.int64)


def corner_area(points: np.ndarray, loop: list[int], i: int) -> float:
    """Signed area of the triangle of a corner of a loop and its two neighbours."""
    a, b, c = points[loop[i - 1]], points[loop[i]], points[loop[(i + 1) % len(loop)]]
    return 0.5 * float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def is_ear(points: np.ndarray, loop: list[int], i: int, turn: float, least: float) -> bool:
    """True if the triangle of a corner lies inside the loop, with no other corner in it."""
    if turn * corner_area(points, loop, i) <= least:
        return False
    corners = (loop[i - 1], loop[i], loop[(i + 1) % len(loop)])
    a, b, c = (points[one] for one in corners)
    p = points[[one for one in loop if one not in corners]]

    def side(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return turn * ((v[0] - u[0]) * (p[:, 1] - u[1]) - (v[1] - u[1]) * (p[:, 0] - u[0]))

    inside = (side(a, b) >= 0.0) & (side(b, c) >= 0.0) & (side(c, a) > 0.0)
    return not inside.any()


def repaired(
    vertices: np.ndarray, faces: np.ndarray, weld: float, mirror: str, cap: str
) -> tuple[np.ndarray, np.ndarray]:
    """The mesh welded to a tolerance [m], mirrored across an axis ("x" or "y"), and with a deck ("deck").

    Open edges are divided at nodes on them.

    Raises ValueError for a value that is not allowed or does not fit the mesh.
    """
    check_number("weld", weld, "m", 0.0)
    vertices, faces = welded(vertices, faces, weld)
    size = float(np.ptp(vertices, axis=0).max()) if len(vertices) else 0.0
    faces = divided(vertices, faces, max(weld, ON_EDGE * size))
    if mirror:
        vertices, faces = mirrored(vertices, faces, mirror, max(weld, 1e-6 * size))
    if cap:
        check_choice("cap", cap, ("deck",))
        vertices, faces = capped(vertices, faces)
    return vertices, faces


def place_of_gaps(vertices: np.ndarray, faces: np.ndarray) -> str:
    """Number of open edges, and the box that they lie in."""
    edges = open_boundary(faces)
    low, high = vertices[np.unique(edges)].min(axis=0), vertices[np.unique(edges)].max(axis=0)
    box = ", ".join(f"{name} {a:.4g} to {b:.4g}" for name, a, b in zip("xyz", low, high, strict=True))
    return f"{open_edges(faces)} edges without exactly one opposite, at {box} m"


def remedy(vertices: np.ndarray, faces: np.ndarray) -> str:
    """The options that close a mesh, "" if none of those that are tried does."""
    size = float(np.ptp(vertices, axis=0).max())
    welds = [0.0, *(tolerance for tolerance in WELDS if tolerance < MAX_WELD * size)]
    for mirror, cap in (("", ""), ("y", ""), ("x", ""), ("", "deck"), ("y", "deck"), ("x", "deck")):
        for weld in welds:
            try:
                points, closed = repaired(vertices, faces, weld, mirror, cap)
            except ValueError:
                continue
            if len(closed) > 3 and not open_edges(closed) and enclosed_volume(points, closed) != 0.0:
                options = [f"--weld {weld:.0e}".replace("e-0", "e-")] * (weld > 0.0) + [f"--mirror {mirror}"] * bool(
                    mirror
                )
                return " ".join([*options, *([f"--cap {cap}"] if cap else [])])
    return ""
