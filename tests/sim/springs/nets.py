"""Nets that several tests share."""

import dataclasses

import numpy as np

from sim.springs import INTEGRATORS, Contact, Grab, Net, cloth, rope
from sim.springs.net import Family

DAMPABLE = [name for name, record in INTEGRATORS.items() if not record.undamped_only]

FAMILIES = (  # those of a cloth, so that kernels are compiled for no other net
    Family(0, 1, 0.2, 800.0, 4.0),
    Family(1, 0, 0.2, 700.0, 3.0),
    Family(1, 1, 0.3, 300.0, 2.0),
    Family(1, -1, 0.3, 250.0, 1.0),
    Family(0, 2, 0.45, 90.0, 0.5),
    Family(2, 0, 0.45, 80.0, 0.5),
)
KNIGHT = Family(2, -1, 0.5, 40.0, 0.25)


def patch(model="axial", contact=None, *, rows=3, cols=4, seed=0, floor=None, sphere=None, grab=None, **more) -> Net:
    """A crumpled, stretched net of six families, unequal masses and weaker sides, one corner pinned."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(0.25 * np.arange(rows), 0.25 * np.arange(cols), indexing="ij")
    x0 = np.stack([x, y, np.zeros_like(x)]) + 0.03 * rng.standard_normal((3, rows, cols))
    return dataclasses.replace(
        rope(2, gravity=9.81),
        x0=np.ascontiguousarray(x0),
        families=FAMILIES,
        mass=0.7,
        mass_ratios=rng.uniform(0.8, 1.2, (rows, cols)),
        side_ratio=0.6 if min(rows, cols) > 1 else 1.0,
        drag=0.3,
        damping_model=model,
        pinned=frozenset({(0, 0)}),
        floor=floor,
        sphere=sphere,
        contact=contact or Contact(),
        grab=grab,
        **more,
    )


def touching_patch(model="axial", contact=None, *, rows=3, cols=4, **more) -> Net:
    """The same on the floor and a moving sphere, pulled at one particle."""
    return patch(
        model,
        contact,
        rows=rows,
        cols=cols,
        floor=0.01,
        sphere=(0.3, 0.4, -0.95, 1.0),
        sphere_velocity=(0.3, -0.2, 0.1),
        epoch=-0.1,
        grab=Grab(min(2, rows - 1), min(2, cols - 1), (1.0, 1.0, 1.0), 200.0, 5.0, 30.0),
        **more,
    )


def draped(contact=None, *, damping_model="axial", **more) -> Net:
    """A rope of 9 points on a moving sphere: links touch it in their middle, and two of them at their common end."""
    angles = np.radians([-100.0, -75.0, -50.0, -20.0, 5.0, 30.0, 60.0, 80.0, 100.0])
    # The third point pokes in: its neighbours are far out.
    out = np.array([0.62, 0.60, 0.47, 0.60, 0.49, 0.5, 0.52, 0.50, 0.55])
    net = rope(
        9, 1.8, 0.7, 400.0, 4.0, 0.3, 9.81, sphere=(0.01, -0.02, 0.03, 0.45), contact=contact or Contact(900.0, 20.0),
        radius=0.05, damping_model=damping_model,
    )  # fmt: skip
    x0 = np.stack([out * np.sin(angles), 0.02 * np.cos(3.0 * angles), out * np.cos(angles)])[:, None]
    return dataclasses.replace(net, **{"x0": x0, "sphere_velocity": (0.3, -0.2, 0.1), "epoch": -0.1, **more})


def spread(contact=None, *, damping_model="axial", **more) -> Net:
    """A cloth on a moving sphere that is small beside its cells, which faces touch at corners, sides and insides."""
    net = patch(damping_model, contact or Contact(900.0, 20.0), rows=4, cols=5, seed=3)
    x0 = net.x0.copy()
    x0[2] += 0.6 * ((x0[0] - 0.35) ** 2 + (x0[1] - 0.45) ** 2)
    x0[2, 2, 2] -= 0.12  # pokes in
    changes = {"x0": x0, "sphere": (0.32, 0.47, -0.29, 0.3), "sphere_velocity": (0.3, -0.2, 0.1), "epoch": -0.1}
    return dataclasses.replace(net, **{**changes, "pinned": frozenset({(3, 4)}), "radius": 0.02, **more})


def hairpin(contact_damping, damping=0.0, drag=0.0, moving=()) -> Net:
    """A rope folded back over itself, nearer than its thickness."""
    x = np.zeros((3, 1, 8))
    x[0, 0], x[2, 0, 4:] = [0.0, -0.25, -0.5, -0.75, -0.75, -0.5, -0.25, 0.0], 0.08
    net = rope(8, 1.75, 1.0, 400.0, damping, drag, 10.0, contact=Contact(300.0, contact_damping))
    other = (family._replace(stiffness=0.0, damping=0.0) for family in FAMILIES[1:])
    return dataclasses.replace(net, x0=x, families=(*net.families, *other), thickness=0.1, pin_paths=moving)


def folded_sheet(stiffness) -> Net:
    """A sheet; its last six rows come down on the rows before them, which are pinned."""
    net = cloth(
        20, 8, 0.4, 1.0, 0.3, 400.0, 100.0, 0.0, 0.02, pinned=[(i, j) for i in range(14) for j in range(8)],
        contact=Contact(stiffness, 0.05), thickness=0.05,
    )  # fmt: skip
    x = net.x0.copy()
    for i in range(14, 20):
        x[1, i], x[2, i] = x[1, 13] - (i - 14.0) / 19, 0.055 + 0.02 * (i - 14)
    return dataclasses.replace(net, x0=x)
