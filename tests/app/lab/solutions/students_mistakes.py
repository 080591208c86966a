"""Mistakes as they stand in public solutions of like exercises, and neighbours of them, in our own words.

Each has the function, words that its name or its explanation must contain, and the body.
"""

from tests.app.lab.solutions.wrong_springs import RK4, ROPE, SPHERE, changed

SPRING = """
            r = x2 - x1
            length = np.linalg.norm(r)
            return stiffness * (length - rest_length) * r / length - damping * (v1 - v2)"""
LAW = "stiffness * (length - rest_length) * r / length"
DAMPING = "damping * (v1 - v2)"
PULL = "f = stiffness * (l - rest_length) * r / l - damping * (v[i] - v[i + 1])"
LEAPFROG = """
            a = acceleration(x, v)
            new = x + h * v + h * h / 2 * a
            return new, v + h / 2 * (a + acceleration(new, v))"""

CASES: tuple[tuple[str, str, str], ...] = (
    ("spring_force", "sign of the spring reversed", changed(SPRING, "r = x2 - x1", "r = x1 - x2")),
    ("spring_force", "sign reversed", changed(SPRING, f"return {LAW} - {DAMPING}", f"return -({LAW} - {DAMPING})")),
    ("spring_force", "sign of the damping reversed", changed(SPRING, f"- {DAMPING}", f"+ {DAMPING}")),
    ("spring_force", "rest length forgotten", changed(SPRING, "(length - rest_length)", "length")),
    ("spring_force", "damping on absolute velocity", changed(SPRING, "(v1 - v2)", "v1")),
    ("spring_force", "the damping is missing", changed(SPRING, f" - {DAMPING}", "")),
    ("spring_force", "direction not of unit length", changed(SPRING, "* r / length", "* r")),
    (
        "spring_force",
        "the damping is -b |v1 - v2| r/|r|",
        changed(SPRING, f"- {DAMPING}", "- damping * np.linalg.norm(v1 - v2) * r / length"),
    ),
    (
        "spring_force",
        "NaN",
        changed(SPRING, f"- {DAMPING}", "- damping * np.linalg.norm(v1 - v2) * (v1 - v2) / np.linalg.norm(v1 - v2)"),
    ),
    (
        "spring_force",
        "-b ((v1 - v2) . r/|r|) r/|r|, with the wrong sign",
        changed(SPRING, f"- {DAMPING}", "+ damping * ((v1 - v2) @ r) * r / length ** 2"),
    ),
    (
        "spring_force",
        "damping along the link only",
        changed(SPRING, f"- {DAMPING}", "- damping * ((v1 - v2) @ r) * r / length ** 2"),
    ),
    ("spring_force", "sign of the spring reversed", changed(SPRING, "length - rest_length", "rest_length - length")),
    ("spring_force", "force not along the link", f"return stiffness * (x2 - x1 - rest_length) - {DAMPING}"),
    (
        "spring_force",
        "The length is squared",
        changed(SPRING, "(length - rest_length) * r / length", "(length ** 2 - rest_length) * r / length"),
    ),
    (
        "spring_force",
        "A compressed spring must push",
        changed(SPRING, "(length - rest_length)", "abs(length - rest_length)"),
    ),
    (
        "spring_force",
        "no force when compressed",
        changed(SPRING, "(length - rest_length)", "max(length - rest_length, 0)"),
    ),
    (
        "spring_force",
        "constant factor",
        changed(SPRING, f"return {LAW} - {DAMPING}", f"return 0.5 * ({LAW} - {DAMPING})"),
    ),
    ("spring_force", "The stretch is |r| - d", changed(SPRING, "length - rest_length", "length / rest_length - 1")),
    (
        "rope_acceleration",
        "the damping on the second end has the wrong sign",
        changed(
            ROPE,
            PULL,
            "f = stiffness * (l - rest_length) * r / l\n                g = damping * (v[i + 1] - v[i])",
            "F[i] += f",
            "F[i] += f + g",
            "F[i + 1] -= f",
            "F[i + 1] -= f - g",
        ),
    ),
    (
        "rope_acceleration",
        "Add with +=",
        changed(
            ROPE,
            "F = -drag * v",
            "F = np.zeros_like(x)",
            "F[i] += f",
            "F[i] = f",
            "F[i + 1] -= f",
            "F[i + 1] = -f",
            "a = F / mass",
            "a = (F - drag * v) / mass",
        ),
    ),
    (
        "rope_acceleration",
        "gravity divided by the mass",
        changed(ROPE, "a[:, 2] -= gravity", "a[:, 2] -= gravity / mass"),
    ),
    ("rope_acceleration", "gravity along the wrong axis", changed(ROPE, "a[:, 2] -= gravity", "a[:, 1] -= gravity")),
    (
        "rope_acceleration",
        "state kept between calls",
        changed(ROPE, "F = -drag * v", "F = KEPT.setdefault(len(x), np.zeros_like(x))\n            F -= drag * v"),
    ),
    ("rope_acceleration", "root not held", changed(ROPE, "\n            a[0] = 0", "")),
    ("rope_acceleration", "the result leaves out the last point", changed(ROPE, "a[0] = 0", "a[0] = a[-1] = 0")),
    ("rope_acceleration", "the number of points", changed(ROPE, "F / mass", "F / (mass / len(x))")),
    ("rope_acceleration", "The loop has too few turns", changed(ROPE, "range(len(x) - 1)", "range(len(x) - 2)")),
    (
        "rope_acceleration",
        "the force of the links is 2 times",
        changed(ROPE, PULL, PULL.replace("f = ", "f = 2 * (") + ")"),
    ),
    (
        "rope_acceleration",
        "the air drag is not divided by mass",
        changed(ROPE, "-drag * v", "0 * x", "F / mass", "F / mass - drag * v"),
    ),
    ("step_euler", "velocity before position", "v = v + h * acceleration(x, v)\nreturn x + h * v, v"),
    ("step_euler", "position before velocity", "x = x + h * v\nreturn x, v + h * acceleration(x, v)"),
    ("step_euler", "velocity before position", "a = acceleration(x, v)\nreturn x + h * v + h * h * a, v + h * a"),
    ("step_euler", "0.99995 v", "return x + h * v, 0.99995 * (v + h * acceleration(x, v))"),
    ("step_euler", "0.99995 v", "return x + h * v, (v + h * acceleration(x, v)) * (1 - 5e-5)"),
    ("step_leapfrog", "no half step", "v = v + h * acceleration(x, v)\nreturn x + h * v, v"),
    (
        "step_leapfrog",
        "turns from call to call",
        """
            KEPT['odd'] = not KEPT.get('odd')
            return (x, v + h * acceleration(x, v)) if KEPT['odd'] else (x + h * v, v)""",
    ),
    (
        "step_leapfrog",
        "force not computed again",
        """
            a = acceleration(x, v)
            v = v + h / 2 * a
            return x + h * v, v + h / 2 * a""",
    ),
    ("step_leapfrog", "x + h v + h² a1: It must be x + h v + h²/2 a1", changed(LEAPFROG, "h * h / 2", "h * h")),
    (
        "step_rk4",
        "stages chained",
        """
            a1 = acceleration(x, v)
            x2, v2 = x + h / 2 * v, v + h / 2 * a1
            a2 = acceleration(x2, v2)
            x3, v3 = x2 + h / 2 * v2, v2 + h / 2 * a2
            a3 = acceleration(x3, v3)
            x4, v4 = x3 + h * v3, v3 + h * a3
            a4 = acceleration(x4, v4)
            return x + h / 6 * (v + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)""",
    ),
    (
        "step_rk4",
        "keeps the first force",
        changed(
            RK4,
            "acceleration(x + h / 2 * v1, v + h / 2 * a1)",
            "a1",
            "acceleration(x + h / 2 * v2, v + h / 2 * a2)",
            "a1",
            "acceleration(x + h * v3, v + h * a3)",
            "a1",
        ),
    ),
    (
        "step_rk4",
        "position x: It must be x + h/2 v",
        changed(RK4, "x + h / 2 * v1,", "x,", "x + h / 2 * v2,", "x,", "x + h * v3,", "x,"),
    ),
    (
        "step_rk4",
        "h forgotten",
        changed(
            RK4,
            "v + h / 2 * a",
            "v + 1 / 2 * a",
            "x + h / 2 * v",
            "x + 1 / 2 * v",
            "v + h * a3",
            "v + a3",
            "x + h * v3",
            "x + v3",
        ),
    ),
    (
        "step_rk4",
        "h used twice",
        changed(
            RK4,
            "a1 = v, acceleration(x, v)",
            "a1 = h * v, h * acceleration(x, v)",
            "v2, a2 = v + h / 2 * a1, acc",
            "v2, a2 = h * (v + h / 2 * a1), h * acc",
            "v3, a3 = v + h / 2 * a2, acc",
            "v3, a3 = h * (v + h / 2 * a2), h * acc",
            "v4, a4 = v + h * a3, acc",
            "v4, a4 = h * (v + h * a3), h * acc",
            "h / 6",
            "1 / 6",
        ),
    ),
    ("step_rk4", "The weights add up to 0.75 instead of 1", changed(RK4, "h / 6", "h / 8")),
    (
        "step_rk4",
        "a3 is computed at the position x + h/2 v: It must be x + h/2 v2",
        changed(RK4, "acceleration(x + h / 2 * v2, v + h / 2 * a2)", "acceleration(x + h / 2 * v1, v + h / 2 * a1)"),
    ),
    (
        "step_rk4",
        "a4 is computed at the position x + h/2 v2: It must be x + h v3",
        changed(RK4, "acceleration(x + h * v3", "acceleration(x + h / 2 * v2"),
    ),
    (
        "sphere_force",
        "-b p v: Only the normal part",
        changed(
            SPHERE,
            "return max(stiffness * (radius - l) - damping * (v @ n), 0) * n",
            "return (radius - l) * (stiffness * n - damping * v)",
        ),
    ),
    ("sphere_force", "-b |v| n: Only the normal part", changed(SPHERE, "(v @ n)", "np.linalg.norm(v)")),
    (
        "cloth_forces",
        "the damping on the second end has the wrong sign",
        """
            F = np.zeros_like(x)
            for (i, j), d in zip(links, rest_lengths):
                r = x[j] - x[i]
                pull = stiffness * (np.linalg.norm(r) - d) * r / np.linalg.norm(r)
                F[i] += pull - damping * (v[i] - v[j])
                F[j] -= pull + damping * (v[i] - v[j])
            return F""",
    ),
    (
        "dispersion",
        "gravity / k",
        """
            w0 = 2 * np.pi / repeat_time
            return calm * w0 * np.floor(np.sqrt(gravity / k) / w0)""",
    ),
    (
        "reflectance",
        "s + p in place of s - p",
        """
            c, t = np.cos(angle), np.sqrt(1 - (np.sin(angle) / index) ** 2)
            s, p = ((c - index * t) / (c + index * t)) ** 2, ((index * c - t) / (index * c + t)) ** 2
            return 0.5 * (s - p)""",
    ),
    (
        "spectrum",
        "kk ** 4 in place of kk ** 3",
        """
            kk, U = np.hypot(*k), np.hypot(*wind)
            if kk == 0:
                return 0
            return amplitude * np.exp(-((gravity / (kk * U * U)) ** 2)) / kk ** 3 * (k @ wind / kk / U) ** 2""",
    ),
    (
        "draft",
        "oil_thickness -",
        """
            if body_density * height < oil_density * oil_thickness:
                return body_density * height / oil_density
            return oil_thickness - (body_density * height - oil_density * oil_thickness) / water_density""",
    ),
    ("wave_decay", "wavenumber ** 3", "return amplitude * np.exp(-2 * viscosity * wavenumber ** 3 * time)"),
    (
        "surface_colour",
        "1 +",
        """
            T = np.exp(-2 * absorption * thickness)
            return T * water_colour + (1 + T) * oil_colour""",
    ),
)
