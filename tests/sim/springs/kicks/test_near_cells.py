"""The list of what may meet of a cloth, and the places that are nearest to each other, against all pairs."""

import dataclasses

import numpy as np
import pytest

from sim.springs import cloth
from sim.springs.kicks.apart import least_distance
from sim.springs.near.near_balls import balls_near, sort_balls
from sim.springs.near.near_cells import find_near, find_neighbours, four_in_list, motion_since
from sim.springs.points.places import Four, places_at
from tests.sim.springs.kicks.cloths import elements


def to_segments(points, a, b):
    """Distances of points (n, 3) from segments."""
    way = b - a
    part = np.clip(((points - a) * way).sum(1) / (way * way).sum(1), 0.0, 1.0)
    return np.linalg.norm(points - a - part[:, None] * way, axis=1)


def distances(points, pairs, parts):
    """Distances of pairs (n, 4): of two edges, or of a point and a face if `parts` is 1.

    The least of those at which an end or a corner takes part and, where the foot of the common normal lies on both, of
    that.
    """
    a, b, c, d = (points[pairs[:, e]] for e in range(4))
    if parts == 2:
        ends = (to_segments(a, c, d), to_segments(b, c, d), to_segments(c, a, b), to_segments(d, a, b))
        sides, to = np.stack([b - a, c - d], 2), c - a
    else:
        ends = (to_segments(a, b, c), to_segments(a, c, d), to_segments(a, d, b))
        sides, to = np.stack([c - b, d - b], 2), a - b
    feet = np.einsum("nij,nj->ni", np.linalg.pinv(sides), to)
    off = np.linalg.norm(to - np.einsum("nij,nj->ni", sides, feet), axis=1)
    inside = (feet >= 0.0).all(1) & ((feet <= 1.0).all(1) if parts == 2 else feet.sum(1) <= 1.0)
    return np.minimum(np.min(ends, axis=0), np.where(inside, off, np.inf))


def crumpled(rows, cols, rough, seed=0, ratio=0.5, **more):
    """A rolled cloth whose layers are near to each other, and roughened; `rough` in parts of its spacing."""
    rng = np.random.default_rng(seed)
    net = cloth(rows, cols, 0.1 * (cols - 1), 0.1 * (rows - 1), pinned="free", thickness=0.1 * ratio, **more)
    angle = net.x0[1] / 0.15
    radius = 0.12 + 0.008 * angle
    x = np.stack([net.x0[0], radius * np.sin(angle), radius * np.cos(angle)])
    return dataclasses.replace(net, x0=x + 0.1 * rough * rng.standard_normal(x.shape))


def listed_pairs(p):
    """{the points of two edges, or of a point and a face} in the list, and the gaps."""
    found = {}
    for q in range(p.near[-1, 0]):
        four = four_in_list(p, q)
        key = (four.a, frozenset((four.b, four.c, four.d))) if four.is_face else frozenset(
            (frozenset((four.a, four.b)), frozenset((four.c, four.d)))
        )  # fmt: skip
        assert key not in found
        found[key] = p.near_gaps[q]
    return found


def key_of(row, parts):
    a, b, c, d = row
    return (a, frozenset((b, c, d))) if parts == 1 else frozenset((frozenset((a, b)), frozenset((c, d))))


@pytest.mark.parametrize(("rows", "cols", "rough"), [
    (14, 6, 0.0), (14, 6, 0.05), (12, 7, 0.3), (3, 9, 0.2), (2, 4, 0.3), (9, 2, 0.3), (16, 7, 0.02),
])  # fmt: skip
def test_the_list_has_every_pair_that_comes_near_in_the_step_and_bounds_all_others(rows, cols, rough):
    net = crumpled(rows, cols, rough)
    p, x = net.kernel_view(1.0), net.x0.reshape(-1)
    least = least_distance(p)
    y = x + 0.004 * np.random.default_rng(1).standard_normal(x.shape) + np.repeat([0.3, 0.1, -0.2], rows * cols)
    find_near(x, y, p, least)
    found, times = listed_pairs(p), np.linspace(0.0, 1.0, 5)
    for parts, pairs in zip((2, 1), elements(rows, cols), strict=True):
        nearest = np.min([distances(((1.0 - t) * x + t * y).reshape(3, -1).T, pairs, parts) for t in times], axis=0)
        gaps = np.array([found.pop(key_of(row, parts), np.nan) for row in pairs.tolist()])
        assert not (nearest[np.isnan(gaps)] < min(p.reach) - 1e-12).any()
        assert (gaps <= nearest + 1e-12)[~np.isnan(gaps)].all()
        assert min(p.clear) <= nearest.min() + 1e-12
    assert found == {}


def test_a_flat_cloth_lists_nothing_and_knows_how_far_its_neighbours_are():
    """0.71 of the spacing; of a roll at least 0.52, as a window that is bent is nearly flat seen along its normal."""
    for net, bound in ((crumpled(14, 6, 0.0), 0.052), (cloth(9, 8, 0.7, 0.8, thickness=0.05), 0.0707)):
        p = net.kernel_view(1.0)
        find_near(net.x0.reshape(-1), net.x0.reshape(-1), p, least_distance(p))
        assert (p.near[: p.near[-1, 0], 2] == 0).all()
        assert bound <= p.clear[1] <= 0.0708


def test_the_list_of_neighbours_alone_is_made_anew_and_that_of_others_stays():
    """As the whole list is made of the same positions."""
    net = crumpled(14, 6, 0.2)
    x = net.x0.reshape(-1)
    p, q = net.kernel_view(1.0), net.kernel_view(1.0)
    find_near(x, x, p, least_distance(p))
    find_near(x, x, q, least_distance(q))
    assert q.near[-1, 1] < q.near[-1, 0]
    q.near[q.near[-1, 1] : q.near[-1, 0]] = 0
    q.joined[:] = 0.0
    assert find_neighbours(x, x, q)
    assert listed_pairs(p) == listed_pairs(q)
    assert np.array_equal(p.joined, q.joined)
    assert np.array_equal(p.clear, q.clear)


def test_a_flat_region_hides_no_layer_that_lies_on_it():
    """Of a large cloth most blocks need no look; a strip of it that is folded back does."""
    rng = np.random.default_rng(4)
    net = cloth(26, 16, 1.5, 2.5, pinned="free", thickness=0.08)
    x = net.x0.copy() + 0.002 * rng.standard_normal(net.x0.shape)
    x[1, 20:] = x[1, 19:13:-1]
    x[2, 20:] += 0.03
    p, flat = net.kernel_view(1.0), x.reshape(-1)
    find_near(flat, flat, p, least_distance(p))
    nearest = {}
    for parts, pairs in zip((2, 1), elements(26, 16), strict=True):
        first, second = x.reshape(3, -1).T[pairs[:, :parts]], x.reshape(3, -1).T[pairs[:, parts:]]
        pairs = pairs[np.linalg.norm(first.mean(1) - second.mean(1), axis=1) < 0.35]
        gaps = distances(x.reshape(3, -1).T, pairs, parts)
        nearest |= {key_of(row, parts): gap for row, gap in zip(pairs.tolist(), gaps, strict=True)}
    listed = set(listed_pairs(p))
    assert {key for key, gap in nearest.items() if gap < min(p.reach) - 1e-12} <= listed
    assert len(listed) > 200


def test_balls_near_one_are_those_of_all_pairs_in_order():
    """Of a dense and a sparse heap, with radii that differ."""
    rng = np.random.default_rng(5)
    for size in (1.0, 8.0):
        balls = np.concatenate([size * rng.random((3, 150)), 0.2 * rng.random((1, 150))])
        buckets, beside = sort_balls(balls, 0.3), np.empty(150, np.int64)
        apart = np.linalg.norm(balls[:3, :, None] - balls[:3, None], axis=0) - balls[3][:, None] - balls[3]
        for a in range(150):
            count = balls_near(balls, buckets, a, 0.3, beside)
            assert beside[:count].tolist() == [b for b in range(a, 150) if apart[a, b] < 0.3]


def test_motion_since_the_list_was_made_bounds_how_near_pairs_come():
    """Every distance, by the bound of its kind; the mean motion counts for none."""
    net = crumpled(10, 6, 0.1)
    x = net.x0.reshape(-1)
    moved = x + 0.01 * np.random.default_rng(3).standard_normal(x.shape) + 5.0
    p = net.kernel_view(1.0)
    p.listed[:], p.joined[:] = x, x
    far, links = motion_since(moved, p)
    for parts, pairs in zip((2, 1), elements(10, 6), strict=True):
        closer = distances(x.reshape(3, -1).T, pairs, parts) - distances(moved.reshape(3, -1).T, pairs, parts)
        assert closer.max() <= 2.0 * far
        rows, cols = np.divmod(pairs, 6)
        within = np.maximum(np.ptp(rows, axis=1), np.ptp(cols, axis=1))
        assert closer[within <= 2].max() <= 2.0 * links
        assert closer[within <= 3].max() <= 3.0 * links
    assert far < 0.1


def test_the_places_are_the_nearest():
    """Of random points, small and large, thin and nearly parallel."""
    rng = np.random.default_rng(0)
    for scale in (1e-6, 1.0, 1e3):
        points = scale * rng.standard_normal((400, 4, 3)) * rng.choice([1.0, 1e-2], (400, 1, 3))
        for parts in (1, 2):
            pairs = np.arange(4)[None].repeat(1, 0)
            for each in points:
                x = np.ascontiguousarray(each.T).reshape(-1)
                places = places_at(x, 4, Four(parts == 1, 0, 1, 2, 3))
                weights = np.array([places.wa, places.wb, places.wc, places.wd])
                assert places.distance == pytest.approx(distances(each, pairs, parts)[0], rel=1e-6, abs=1e-9 * scale)
                assert weights @ each == pytest.approx(
                    places.distance * np.array([places.nx, places.ny, places.nz]), abs=1e-9 * scale
                )
                assert weights[:parts].sum() == pytest.approx(-1.0)
                assert weights[parts:].sum() == pytest.approx(1.0)
                assert (weights[:parts] <= 0.0).all()
                assert (weights[parts:] >= -1e-12).all()
