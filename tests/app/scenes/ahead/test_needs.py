"""What is compiled before parameters run is known without the net that they describe, and is what the scene runs."""

import dataclasses
import random
from typing import Any

import pytest

from app.scenes import scene_named
from app.scenes.cloth import scene as cloth
from app.scenes.cloth.start import sphere_home
from app.scenes.rope import scene as rope
from app.scenes.setups import make_setup
from sim.parameters import clamp_value, parameters_of
from sim.springs import INTEGRATORS
from sim.springs.automatic import AUTO
from sim.springs.integrator_fallback import integrator_or_fallback

SIZES = {"rope": ("points",), "cloth": ("rows", "cols")}


def kind_of(module: Any) -> Any:
    """The table of the scene that a module is of."""
    return scene_named(module.__package__.rpartition(".")[2])


def fail(*_: object) -> None:
    raise AssertionError("a net is built")


def test_a_method_that_is_named_needs_no_net(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (cloth, rope):
        monkeypatch.setattr(module, "build", fail)
        for method in ("rk4", "leapfrog", "implicit_euler"):
            params = dataclasses.replace(kind_of(module).params(), integrator=method)
            assert methods_of(module.needs(params)) == {method}


def methods_of(pieces: tuple[str, ...]) -> set[str]:
    """The methods among the pieces of any law."""
    return {piece.partition(",")[0] for piece in pieces} & set(INTEGRATORS)


@pytest.mark.parametrize("module", [cloth, rope], ids=["cloth", "rope"])
@pytest.mark.parametrize("method", [AUTO, "pefrl"])
def test_a_small_net_has_the_method_of_the_large_one(module: Any, method: str) -> None:
    rng = random.Random(method)
    kind = kind_of(module)
    declared, found = parameters_of(kind.params), set()
    for _ in range(40):
        params: Any = make_setup(kind, rng.choice(list(kind.presets))).params
        values = {name: rng.randint(2, 40) for name in SIZES[kind.name]}
        for name in rng.sample(["stiffness", "damping", "gravity", "sphere_radius", "contact_damping"], 3):
            values[name] = clamp_value(declared[name], getattr(params, name) * 10 ** rng.uniform(-2.0, 1.0))
        step = 10 ** rng.uniform(-4.0, -1.5)
        params = dataclasses.replace(params, **values, integrator=method, time_step=step)
        net = module.build(params, sphere_home(params)) if module is cloth else module.build(params)
        runs = integrator_or_fallback(method, net, step)[0].name
        assert methods_of(module.needs(params)) == {runs}
        found.add(runs)
    assert len(found) > 1 or method != AUTO
