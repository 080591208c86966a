"""Values of every scene of springs for the tasks of the lab: its step relative to the limit."""

from app.scenes.contract import Measure
from sim.springs.stability import Gauge


def stability_values(gauge: Gauge) -> dict[str, Measure]:
    """h omega, its limit, and the largest stable step."""
    return {
        "h_omega": Measure(gauge.h_omega, "1", "hω, step times highest frequency"),
        "h_omega_limit": Measure(gauge.limit, "1", "Limit of hω, step times highest frequency"),
        "limit_used": Measure(gauge.share, "1", "Step over the largest stable one"),
        "damping_ratio": Measure(gauge.zeta, "1", "Damping ratio ζ of the fastest mode"),
        "critical_step": Measure(gauge.critical_step, "s", "Largest stable step"),
    }
