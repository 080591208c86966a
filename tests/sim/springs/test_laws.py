"""The laws of a link, in all that asks them: forces, energies, damping, tangents, implicit steps, gauge and statics."""

import dataclasses
import itertools

import numpy as np
import pytest

from sim.jit import kernel
from sim.springs import INTEGRATORS, LAWS, PinPath, State, advance, rope
from sim.springs.integrators.implicit.tangent import DAMPING, STIFFNESS
from sim.springs.laws import energy as link_energy
from sim.springs.laws import largest_stiffness, over_step, stiffness, tension
from sim.springs.state import energy
from tests import naive
from tests.sim.springs.nets import patch
from tests.sim.springs.test_forces import agrees, own_power, shaken
from tests.sim.springs.test_stability import products

K, REST = 700.0, 0.4
STRAINS = np.array([-0.7, -0.2, -1e-3, 1e-3, 0.05, 0.3, 1.5])
OTHERS = [name for name in LAWS if name != "spring"]
PATH = PinPath(0.0, ((0.0, 0.0, 0.0), (0.5, 0.2, 0.3), (-0.5, 0.4, 1.0), (0.4, 0.5, -1.0)))


@kernel
def set_laws(law, k, rest, lengths, found):
    """found (4, n): tension, stiffness and energy at each length, and the mean tension from each to the last."""
    n = lengths.shape[0]
    for j in range(n):
        found[0, j] = tension(law, k, rest, lengths[j])
        found[1, j] = stiffness(law, k, rest, lengths[j])
        found[2, j] = link_energy(law, k, rest, lengths[j])
        s, rise = over_step(law, k, rest, lengths[j], lengths[n - 1])
        found[3, j] = s * 0.5 * (lengths[j] + lengths[n - 1])
        found[4, j] = rise


def laws_at(name, lengths):
    found = np.empty((5, len(lengths)))
    set_laws(LAWS[name].numbers, K, REST, np.ascontiguousarray(lengths), found)
    return found


@pytest.mark.parametrize("name", LAWS)
def test_the_tension_is_the_energy_s_slope_and_the_stiffness_the_tension_s(name):
    lengths, e = REST * (1.0 + STRAINS), 1e-6 * REST
    own, longer, shorter = (laws_at(name, lengths + d) for d in (0.0, e, -e))
    assert (longer[2] - shorter[2]) / (2 * e) == pytest.approx(own[0], rel=1e-8, abs=1e-6)
    assert (longer[0] - shorter[0]) / (2 * e) == pytest.approx(own[1], rel=1e-8, abs=1e-6)
    at_rest = laws_at(name, np.array([REST, REST]))
    assert at_rest[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert at_rest[2, 0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", LAWS)
def test_the_mean_tension_of_a_step_does_the_work_of_the_energy(name):
    for strains in itertools.product(STRAINS, (0.2, -0.1, 1e-3 + 1e-12)):
        lengths = REST * (1.0 + np.array(strains))
        found = laws_at(name, lengths)
        gained = found[2, 1] - found[2, 0]
        assert found[3, 0] * (lengths[1] - lengths[0]) == pytest.approx(gained, rel=1e-9, abs=1e-13)
        e = 1e-5 * REST
        longer, shorter = (laws_at(name, lengths + (0.0, d)) for d in (e, -e))
        density = (longer[3, 0] / (lengths.sum() + e) - shorter[3, 0] / (lengths.sum() - e)) * 2.0 / e
        if min(abs(lengths - REST)) > 1e-2 * REST:
            assert density == pytest.approx(found[4, 0], rel=1e-5, abs=1e-3 * K)


@pytest.mark.parametrize("name", LAWS)
def test_the_laws_are_their_formulas(name):
    net = rope(2, REST, stiffness=K, law=name)
    lengths = REST * (1.0 + STRAINS)
    expected = [naive.tension(net, net.families[0], length) for length in lengths]
    assert laws_at(name, lengths)[0] == pytest.approx(expected, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("strain", [0.3, 1.5])
@pytest.mark.parametrize("name", LAWS)
def test_the_largest_stiffness_is_that_of_all_lengths_within_a_strain(name, strain):
    lengths = REST * (1.0 + np.linspace(max(-strain, -0.999), strain, 401))
    assert largest_stiffness(LAWS[name].numbers, strain) * K == pytest.approx(laws_at(name, lengths)[1].max(), rel=5e-3)


@pytest.mark.parametrize("name", LAWS)
def test_a_length_has_the_tension_it_was_asked_for(name):
    tensions = np.array([1e-3, 1.0, 50.0, 1e4])
    law = LAWS[name]
    assert laws_at(name, law.length(law.numbers, K, REST, tensions))[0] == pytest.approx(tensions, rel=1e-9)


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("name", OTHERS)
def test_forces_are_the_formulas(name, model):
    for net in (rope(9, damping_model=model, law=name), dataclasses.replace(patch(model), law=LAWS[name].numbers)):
        for seed in range(3):
            agrees(net, *shaken(net, seed))


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("name", OTHERS)
def test_tangents_are_the_derivatives_of_the_forces(name, model):
    net = dataclasses.replace(patch(model), law=LAWS[name].numbers)
    stiff, damping = naive.tangent(net, net.x0)
    assert products(net, net.x0, STIFFNESS) == pytest.approx(stiff, rel=1e-5, abs=1e-5 * np.abs(stiff).max())
    assert products(net, net.x0, DAMPING) == pytest.approx(damping, rel=1e-6, abs=1e-6 * np.abs(damping).max())


@pytest.mark.parametrize("method", ["leapfrog", "rk4"])
@pytest.mark.parametrize("name", OTHERS)
def test_a_short_step_books_the_powers_of_the_formulas(name, method):
    """Of links of which some are slack, whose damping comes and goes; and of a root that moves."""
    h, net = 1e-6, dataclasses.replace(rope(9, law=name), pin_paths=(((0, 0), PATH),))
    state = State(*shaken(net))
    state.v[:, 0, 0] = PATH.coefficients[1]
    state.x[:, 0, 0] = PATH.coefficients[0]
    dissipated, work = own_power(net, state.x, state.v, 0.0, h)
    before = energy(net, state)
    advance(net, state, INTEGRATORS[method], h, 1, with_account=True)
    assert state.dissipated / h == pytest.approx(dissipated, rel=3e-3)
    assert state.work / h == pytest.approx(work, rel=3e-3)
    assert (energy(net, state).total - before.total) / h == pytest.approx(work - dissipated, rel=3e-3, abs=1e-3)
