"""Quantities of every scene of springs: its step relative to the limit."""

from app.scenes.quantities import Quantities, Quantity

STABILITY: Quantities = {
    "h_omega": Quantity("1", "hω, step times highest frequency", lambda now: now.readings.stability.h_omega),
    "h_omega_limit": Quantity(
        "1", "Limit of hω, step times highest frequency", lambda now: now.readings.stability.limit
    ),
    "limit_used": Quantity("1", "Step over the largest stable one", lambda now: now.readings.stability.share),
    "damping_ratio": Quantity("1", "Damping ratio ζ of the fastest mode", lambda now: now.readings.stability.zeta),
    "critical_step": Quantity("s", "Largest stable step", lambda now: now.readings.stability.critical_step),
    "accurate_step": Quantity(
        "s", "Largest step with oscillation and damping right to 1 %", lambda now: now.readings.stability.accurate_step
    ),
    "step_error": Quantity(
        "1", "Error of oscillation and damping at the step", lambda now: now.readings.stability.error
    ),
}
