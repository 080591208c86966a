"""Build the GLB models in this folder: `python -m assets.make_models`. The models are kept; this says what they are.

Parts are gathered by colour, one mesh and one material each. z is up, metres; a body's origin is its centre of mass.
"""

import math
from collections import defaultdict
from itertools import pairwise
from pathlib import Path

import numpy as np
import trimesh
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

Point = tuple[float, float, float]

# sRGB, roughness, metalness
PAINTS = {
    "yellow": ((238, 178, 32), 0.55, 0.0),
    "orange": ((226, 84, 28), 0.5, 0.0),
    "red": ((196, 36, 34), 0.5, 0.0),
    "white": ((236, 236, 230), 0.6, 0.0),
    "cream": ((214, 206, 184), 0.7, 0.0),
    "steel": ((120, 128, 136), 0.55, 0.3),
    "dark": ((52, 58, 66), 0.7, 0.2),
    "deck": ((96, 104, 100), 0.9, 0.0),
    "green": ((38, 110, 74), 0.8, 0.0),
    "blue": ((40, 92, 140), 0.6, 0.0),
    "rust": ((122, 74, 52), 0.85, 0.1),
    "glass": ((40, 62, 74), 0.2, 0.2),
    "lamp": ((255, 238, 170), 0.3, 0.0),
    "wood": ((168, 120, 70), 0.85, 0.0),
    "board": ((120, 80, 44), 0.9, 0.0),
    "weed": ((38, 48, 30), 0.3, 0.0),
}
WET_SHADE, WET_ROUGHNESS = 0.55, 0.22  # of a paint under water: factor on its linear colour, and roughness


SMOOTH = math.radians(62)  # between two faces, up to which the edge between them is drawn round


class Model:
    """Parts by paint."""

    def __init__(self) -> None:
        self.parts: dict[str, list[trimesh.Trimesh]] = defaultdict(list)

    def add(self, paint: str, mesh: trimesh.Trimesh) -> None:
        self.parts[paint].append(mesh)

    def box(self, paint: str, centre: Point, size: Point, turn: float = 0.0) -> None:
        mesh = trimesh.creation.box(size)
        mesh.apply_transform(trimesh.transformations.rotation_matrix(turn, [0, 0, 1]))
        self.add(paint, mesh.apply_translation(centre))

    def bar(self, paint: str, a: Point, b: Point, radius: float, sections: int = 6, closed: bool = True) -> None:
        """A cylinder from a to b; its ends are left out (`closed` False) where other parts hide them."""
        mesh = trimesh.creation.cylinder(radius, segment=np.array([a, b], float), sections=sections)
        if not closed:
            along = np.subtract(b, a) / np.linalg.norm(np.subtract(b, a))
            mesh.update_faces(np.abs(mesh.face_normals @ along) < 0.5)
        self.add(paint, mesh)

    def cone(
        self, paint: str, low: float, high: float, bottom: float, top: float, sections: int = 24, closed: bool = True
    ) -> None:
        """A frustum about the z axis, from radius `low` at z = bottom to `high` at z = top."""
        outline = np.array([[0.0, bottom], [low, bottom], [high, top], [0.0, top]])
        self.add(paint, trimesh.creation.revolve(outline if closed else outline[1:3], sections=sections))

    def lattice(self, paint: str, low: list[Point], high: list[Point], bays: int, radius: float) -> None:
        """A tower of straight legs from `low` to `high` corners, with rings and one diagonal a face and bay."""
        a, b = np.array(low, float), np.array(high, float)
        n = len(a)
        levels = [a + (b - a) * s for s in np.linspace(0.0, 1.0, bays + 1)]
        for i in range(n):
            self.bar(paint, tuple(a[i]), tuple(b[i]), 1.6 * radius)
        for level, (p, q) in enumerate(pairwise(levels)):
            for i in range(n):
                j = (i + 1) % n
                self.bar(paint, tuple(q[i]), tuple(q[j]), radius, 4, closed=False)
                start, end = (p[i], q[j]) if level % 2 else (p[j], q[i])
                self.bar(paint, tuple(start), tuple(end), radius, 4, closed=False)

    def wet(self, level: float) -> None:
        """Have everything below z = level look wet."""
        for paint, meshes in list(self.parts.items()):
            color, rough, metal = PAINTS[paint]
            shade = tuple(round(c * WET_SHADE ** (1 / 2.2)) for c in color)
            PAINTS[f"wet {paint}"] = shade, min(rough, WET_ROUGHNESS), metal  # type: ignore[assignment]
            for part, up in ((paint, 1.0), (f"wet {paint}", -1.0)):
                cut = [beyond(mesh, level, up) for mesh in meshes]
                self.parts[part] = [mesh for mesh in cut if len(mesh.faces)]
                if not self.parts[part]:
                    del self.parts[part]

    def weed(self, radius: float, low: float, high: float) -> None:
        """A band of weed around z from low to high, with a ragged upper edge."""
        sides = 48
        angle, edge = 2.0 * math.pi * np.arange(sides) / sides, np.random.default_rng(3).uniform(0.35, 1.0, sides)
        ring = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
        vertices = [np.column_stack([ring, z]) for z in (np.full(sides, low), low + (high - low) * edge)]
        i, j = np.arange(sides), (np.arange(sides) + 1) % sides
        faces = np.concatenate([np.stack([i, j, i + sides], 1), np.stack([j, j + sides, i + sides], 1)])
        self.add("weed", trimesh.Trimesh(np.concatenate(vertices), faces, process=False))

    def save(self, path: Path) -> int:
        """Write the GLB; returns its number of triangles."""
        scene, count = trimesh.Scene(), 0
        for paint, meshes in self.parts.items():
            color, rough, metal = PAINTS[paint]
            whole = trimesh.graph.smooth_shade(trimesh.util.concatenate(meshes), angle=SMOOTH)
            linear = [*((np.array(color) / 255.0) ** 2.2).tolist(), 1.0]
            factor = (np.array(linear) * 255).round().astype(np.uint8)
            material = PBRMaterial(name=paint, baseColorFactor=factor, roughnessFactor=rough, metallicFactor=metal)
            whole.visual = TextureVisuals(material=material)
            scene.add_geometry(whole, node_name=paint, geom_name=paint)
            count += len(whole.faces)
        path.write_bytes(scene.export(file_type="glb", include_normals=True))  # type: ignore[arg-type]
        return count


def beyond(mesh: trimesh.Trimesh, level: float, up: float) -> trimesh.Trimesh:
    """The part of a mesh above z = level, or with up = -1 below it."""
    triangles = []
    for triangle in mesh.triangles:
        over = up * (triangle[:, 2] - level)
        corners = []
        for k in range(3):
            a, b, p, q = triangle[k], triangle[(k + 1) % 3], over[k], over[(k + 1) % 3]
            corners += ([a] if p >= 0.0 else []) + ([a + (b - a) * p / (p - q)] if p * q < 0.0 else [])
        triangles += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    points = np.array(triangles, float).reshape(-1, 3)
    return trimesh.Trimesh(points, np.arange(len(points)).reshape(-1, 3))


def square(half: float, z: float, x: float = 0.0, y: float = 0.0) -> list[Point]:
    return [(x + half, y + half, z), (x - half, y + half, z), (x - half, y - half, z), (x + half, y - half, z)]


def rig() -> Model:
    """A jacket platform: 34 m decks on four legs, derrick to 56 m, helideck, crane, quarters, flare boom."""
    m = Model()
    # jacket
    low, high = square(17.0, -30.0), square(13.0, 15.0)
    for a, b in zip(low, high, strict=True):
        m.bar("yellow", a, b, 1.25, 12, closed=False)
        share = (3.0 - a[2]) / (b[2] - a[2])
        wet = tuple(p + (q - p) * share for p, q in zip(a, b, strict=True))
        m.bar("rust", a, wet, 1.3, 12)  # type: ignore[arg-type]
    for bottom, top in ((-12.0, 1.5), (1.5, 13.5)):
        p = [
            tuple(u + (v - u) * (bottom + 30) / 45 for u, v in zip(a, b, strict=True))
            for a, b in zip(low, high, strict=True)
        ]
        q = [
            tuple(u + (v - u) * (top + 30) / 45 for u, v in zip(a, b, strict=True))
            for a, b in zip(low, high, strict=True)
        ]
        for i in range(4):
            j = (i + 1) % 4
            m.bar("yellow", p[i], q[j], 0.5, 6, closed=False)  # type: ignore[arg-type]
            m.bar("yellow", p[j], q[i], 0.5, 6, closed=False)  # type: ignore[arg-type]
            m.bar("yellow", q[i], q[j], 0.5, 6, closed=False)  # type: ignore[arg-type]
    for x in (-3.0, -1.0, 1.0, 3.0):  # conductors
        m.bar("dark", (x, 0.0, -30.0), (x, 0.0, 16.0), 0.45, 6, closed=False)
    # decks
    m.box("deck", (0, 0, 15.5), (34, 30, 1.0))
    m.box("dark", (0, 0, 14.7), (31, 27, 0.6))
    m.box("deck", (0, 0, 22.5), (36, 32, 0.9))
    m.box("yellow", (0, 16.05, 22.5), (36.2, 0.2, 1.1))
    m.box("yellow", (0, -16.05, 22.5), (36.2, 0.2, 1.1))
    m.box("yellow", (18.05, 0, 22.5), (0.2, 32, 1.1))
    m.box("yellow", (-18.05, 0, 22.5), (0.2, 32, 1.1))
    for x in (-15.0, -5.0, 5.0, 15.0):
        for y in (-13.5, 13.5):
            m.bar("steel", (x, y, 15.0), (x, y, 22.5), 0.4, 6, closed=False)
    for y in (-14.2, 14.2):  # between the decks
        m.bar("steel", (-16, y, 18.6), (16, y, 18.6), 0.25, 6)
        m.bar("orange", (-16, y, 17.4), (16, y, 17.4), 0.18, 6)
    for x, y, sx, sy, paint in (
        (-9, -6, 9, 8, "cream"),
        (4, -8, 8, 6, "blue"),
        (10, 6, 7, 9, "steel"),
        (-6, 8, 10, 5, "green"),
    ):
        m.box(paint, (x, y, 18.6), (sx, sy, 5.2))
    # railing
    for z in (23.6, 24.2):
        corners = square(1.0, z)
        points = [(x * 18.0, y * 16.0, h) for x, y, h in corners]
        for i in range(4):
            m.bar("yellow", points[i], points[(i + 1) % 4], 0.06, 4, closed=False)
    for x in np.linspace(-18, 18, 10):
        for y in (-16.0, 16.0):
            m.bar("yellow", (x, y, 22.9), (x, y, 24.2), 0.06, 4, closed=False)
    # quarters with windows
    m.box("white", (-11.5, -7.5, 27.5), (11, 13, 9))
    m.box("cream", (-11.5, -7.5, 32.4), (11.6, 13.6, 0.6))
    for z in (24.9, 27.3, 29.7):
        m.box("glass", (-11.5, -7.5, z + 0.3), (11.15, 11.6, 0.9))
        m.box("glass", (-11.5, -7.5, z + 0.3), (9.6, 13.15, 0.9))
    # helideck
    m.add("green", trimesh.creation.cylinder(8.0, 0.6, sections=8).apply_translation((-17, -11, 36)))
    m.add("white", trimesh.creation.annulus(4.4, 5.0, 0.1, sections=24).apply_translation((-17, -11, 36.35)))
    for x, y, sx, sy in ((-18.3, -11, 0.7, 4.4), (-15.7, -11, 0.7, 4.4), (-17, -11, 2.6, 0.7)):
        m.box("white", (x, y, 36.36), (sx, sy, 0.1))
    for dx, dy in ((-4, -4), (4, -4), (-4, 4), (4, 4)):
        m.bar("steel", (-15 + dx * 0.6, -9 + dy * 0.6, 31.5), (-17 + dx, -11 + dy, 35.8), 0.22, 6, closed=False)
    # derrick
    m.box("steel", (3, 3, 25.0), (11, 11, 4.2))
    m.lattice("red", square(4.5, 27.0, 3, 3), square(1.3, 56.0, 3, 3), 7, 0.16)
    m.box("white", (3, 3, 56.6), (3.2, 3.2, 1.2))
    m.bar("white", (3, 3, 57), (3, 3, 62), 0.12, 6)
    m.bar("dark", (3, 3, 27), (3, 3, 52), 0.22, 6, closed=False)
    m.box("orange", (3, 3, 43), (1.6, 1.6, 2.6))
    # tanks and modules
    for x in (10.5, 14.5):
        m.bar("white", (x, -14, 25.1), (x, -3, 25.1), 1.7, 16)
        m.bar("red", (x, -9.2, 25.1), (x, -8.2, 25.1), 1.75, 16, closed=False)
    m.add("white", trimesh.creation.cylinder(2.6, 7.0, sections=20).apply_translation((13, 10.5, 26.4)))
    m.cone("white", 2.6, 0.4, 29.9, 31.0, 20)
    m.parts["white"][-1].apply_translation((13, 10.5, 0))
    m.bar("steel", (11, 3, 23), (11, 3, 36), 0.7, 10)
    m.bar("steel", (13, 3.6, 23), (13, 3.6, 34), 0.5, 10)
    for y in (10.5, 13.5):
        m.box("orange", (-6, y, 24.3), (10, 2.3, 2.6))
    m.box("blue", (-6, 12.0, 26.8), (9, 2.3, 2.4))
    # crane
    m.bar("yellow", (15, 14, 22), (15, 14, 33), 1.0, 12, closed=False)
    m.box("yellow", (15, 14, 34.2), (3.4, 3.0, 2.8), 0.6)
    m.lattice("yellow", [(15.6, 14.8, 34.0), (14.6, 15.4, 34.0), (15.2, 15.2, 35.2)],
              [(26.2, 28.8, 50.0), (25.7, 29.1, 50.0), (26.0, 29.0, 50.6)], 7, 0.11)  # fmt: skip
    m.bar("dark", (26, 29, 50), (26, 29, 33), 0.08, 4, closed=False)
    m.box("red", (26, 29, 32.4), (0.8, 0.8, 1.2))
    m.bar("dark", (14.2, 13.0, 38.5), (26, 29, 50.3), 0.06, 4, closed=False)
    m.bar("yellow", (15, 14, 35), (14.2, 13.0, 38.7), 0.25, 6)
    # flare boom
    m.lattice("steel", [(-17, 10, 22.8), (-17, 13, 22.8), (-17, 11.5, 25.2)],
              [(-42, 17.4, 43.0), (-42, 18.2, 43.0), (-42, 17.8, 44.0)], 8, 0.13)  # fmt: skip
    m.bar("dark", (-17, 11.5, 24.4), (-43, 18, 44.6), 0.3, 8)
    m.bar("rust", (-42.6, 17.9, 44.0), (-43.4, 18.1, 46.2), 0.55, 10)
    # lifeboats and boat landing
    for y in (-6.0, 2.0):
        boat = trimesh.creation.capsule(height=4.2, radius=1.25, count=(8, 10))
        boat.apply_transform(trimesh.transformations.rotation_matrix(math.pi / 2, [1, 0, 0]))
        m.add("orange", boat.apply_translation((19.6, y + 2.1, 20.4)))
        m.bar("steel", (18, y, 22.5), (19.6, y, 22.0), 0.2, 6, closed=False)
    m.box("dark", (0, -16.4, 2.6), (12, 2.4, 0.4))
    m.bar("steel", (-4, -16, 2.6), (-4, -14, 15), 0.2, 6, closed=False)
    m.bar("steel", (4, -16, 2.6), (4, -14, 15), 0.2, 6, closed=False)
    return m


def can_buoy(paint: str) -> Model:
    """A flat drum of radius 0.6 and height 0.7 with a lattice tower and a lamp; the hull is the drum."""
    m = Model()
    edges = (-0.35, -0.2, -0.02, 0.12, 0.22)
    for color, (bottom, top) in zip(("dark", paint, "white", paint), pairwise(edges), strict=True):
        m.cone(color, 0.6, 0.6, bottom, top, 32, closed=False)
    m.add("dark", trimesh.creation.cylinder(0.6, 0.01, sections=32).apply_translation((0, 0, -0.345)))
    m.cone(paint, 0.6, 0.52, 0.22, 0.35, 32)
    m.lattice(paint, square(0.3, 0.33), square(0.1, 1.35), 3, 0.018)
    m.cone(paint, 0.17, 0.17, 1.33, 1.42, 16)
    m.cone("lamp", 0.085, 0.085, 1.42, 1.6, 12, closed=False)
    m.cone("dark", 0.11, 0.02, 1.6, 1.68, 12)
    for angle in (0.0, math.pi / 2):
        board = trimesh.creation.box((0.44, 0.02, 0.34))
        board.apply_transform(trimesh.transformations.rotation_matrix(angle, [0, 0, 1]))
        m.add("white" if paint == "red" else "dark", board.apply_translation((0, 0, 1.0)))
    for angle in np.arange(4) * math.pi / 2 + 0.4:
        m.bar("dark", (0.48 * math.cos(angle), 0.48 * math.sin(angle), 0.3),
              (0.48 * math.cos(angle), 0.48 * math.sin(angle), 0.46), 0.025)  # fmt: skip
    m.wet(0.02)
    m.weed(0.604, -0.12, -0.02)
    return m


def crate() -> Model:
    """A box of 1.2 x 1.2 x 0.7 m with a frame of boards."""
    m = Model()
    m.box("board", (0, 0, 0), (1.14, 1.14, 0.64))
    for x in (-0.55, 0.55):
        for y in (-0.55, 0.55):
            m.box("wood", (x, y, 0), (0.1, 0.1, 0.7))
    for z in (-0.3, 0.3):
        for s in (-0.55, 0.55):
            m.box("wood", (0, s, z), (1.0, 0.1, 0.1))
            m.box("wood", (s, 0, z), (0.1, 1.0, 0.1))
    for s in np.linspace(-0.42, 0.42, 5):
        m.box("wood", (s, 0, 0.325), (0.15, 1.0, 0.03))
        for side in (-0.575, 0.575):
            m.box("wood", (s, side, 0), (0.15, 0.03, 0.5))
            m.box("wood", (side, s, 0), (0.03, 0.15, 0.5))
    for side in (-0.598, 0.598):
        m.bar("board", (-0.45, side, -0.24), (0.45, side, 0.24), 0.03, 4)
        m.bar("board", (side, -0.45, -0.24), (side, 0.45, 0.24), 0.03, 4)
    m.wet(0.02)
    return m


def ball() -> Model:
    """A sphere of radius 0.5 in gores of two colours."""
    m = Model()
    sphere = trimesh.creation.uv_sphere(radius=0.5, count=(16, 24))
    centres = sphere.triangles_center
    gore = (np.floor((np.arctan2(centres[:, 1], centres[:, 0]) + math.pi) / (math.pi / 3)) % 2).astype(int)
    cap = np.abs(centres[:, 2]) > 0.46
    for paint, chosen in (("orange", (gore == 0) & ~cap), ("white", (gore == 1) & ~cap), ("blue", cap)):
        m.add(paint, sphere.submesh([np.flatnonzero(chosen)], append=True))  # type: ignore[arg-type]
    m.wet(0.15)
    return m


MODELS = {"rig": rig, "buoy_red": lambda: can_buoy("red"), "buoy_yellow": lambda: can_buoy("yellow"), "crate": crate,
          "ball": ball}  # fmt: skip

if __name__ == "__main__":
    for name, make in MODELS.items():
        path = Path(__file__).with_name(f"{name}.glb")
        print(f"{path.name}: {make().save(path)} triangles, {path.stat().st_size / 1e3:.0f} kB")
