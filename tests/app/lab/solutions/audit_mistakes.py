"""Ninety-five mistakes of students in 23 functions, most of them as an audit made them.

Each has the function, words that its sentence must have so that one knows what to change, and the body.
"""

from tests.app.lab.solutions.students_mistakes import LEAPFROG, SPRING
from tests.app.lab.solutions.wrong_springs import CLOTH_LINKS, RK4, ROPE, SPHERE, changed

CLOTH = """
            F = np.zeros_like(x)
            for n, (i, j) in enumerate(links):
                r = x[j] - x[i]
                l = np.linalg.norm(r)
                pull = stiffness * (l - rest_lengths[n]) * r / l - damping * (v[i] - v[j])
                F[i] += pull
                F[j] -= pull
            return F"""
EULER = """
            a = acceleration(x, v)
            new_x, new_v = x.copy(), v.copy()
            n = len(x)
            for i in range(n):
                new_x[i] = x[i] + h * v[i]
                new_v[i] = v[i] + h * a[i]
            return new_x, new_v"""
RAIN = """
            s = np.full(len(z0), np.inf)
            for i in range(len(z0)):
                if z0[i] > level0[i] and z1[i] <= level1[i]:
                    s[i] = (z0[i] - level0[i]) / (z0[i] - level0[i] - z1[i] + level1[i])
            return s"""
DRAFT = """
            if body_density * height <= oil_density * oil_thickness:
                return body_density * height / oil_density
            return oil_thickness + (body_density * height - oil_density * oil_thickness) / water_density"""
PHILLIPS = """
            kk, U = np.sqrt(k @ k), np.sqrt(wind @ wind)
            if kk == 0:
                return 0.0
            L = U ** 2 / gravity
            return amplitude * np.exp(-1 / (kk * L) ** 2) / kk ** 4 * (k @ wind / kk / U) ** 2"""
WAVE = """
            w0 = 2 * np.pi / repeat_time
            return calm * np.floor(np.sqrt(gravity * k) / w0) * w0"""
FRESNEL = """
            c = np.cos(angle)
            t = np.sqrt(1 - (np.sin(angle) / index) ** 2)
            rs = (c - index * t) / (c + index * t)
            rp = (index * c - t) / (index * c + t)
            return (rs ** 2 + rp ** 2) / 2"""
VOLUME = """
            total = 0.0
            for i, j, k in faces:
                total += vertices[i] @ np.cross(vertices[j], vertices[k])
            return total / 6"""
JET = """
            t = (v[2] + np.sqrt(v[2] ** 2 + 2 * gravity * (x[2] - level))) / gravity
            return np.array([x[0] + v[0] * t, x[1] + v[1] * t, level])"""
COLOUR = """
            T = np.exp(-2 * absorption * thickness)
            return T * water_colour + (1 - T) * oil_colour"""
VISCOSITY = """
            mean = oil_fraction * np.log(oil_viscosity) + (1 - oil_fraction) * np.log(water_viscosity)
            return np.exp(mean)"""

MISTAKES: tuple[tuple[str, str, str], ...] = (
    # Side effects.
    ("spring_force", "r = r - x1", changed(SPRING, "r = x2 - x1", "r = x2\n            r -= x1")),
    (
        "surface_colour",
        "water_colour = water_colour * T",
        """
            T = np.exp(-2 * absorption * thickness)
            water_colour *= T
            oil_colour *= 1 - T
            return water_colour + oil_colour""",
    ),
    (
        "step_rk4",
        "xt = xt + h / 2 * v1",
        """
            v1, a1 = v, acceleration(x, v)
            xt = x
            xt += h / 2 * v1
            v2, a2 = v + h / 2 * a1, acceleration(xt, v + h / 2 * a1)
            v3, a3 = v + h / 2 * a2, acceleration(x + h / 2 * v2, v + h / 2 * a2)
            v4, a4 = v + h * a3, acceleration(x + h * v3, v + h * a3)
            return x + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)""",
    ),
    ("rope_acceleration", "F = F * (-drag)", changed(ROPE, "F = -drag * v", "F = v\n            F *= -drag")),
    (
        "rope_acceleration",
        "KEPT",
        changed(ROPE, "F = -drag * v", "F = KEPT.setdefault('F', 0 * x)\n            F -= drag * v"),
    ),
    ("step_euler", "x = x + h * v", "x += h * v\nreturn x, v + h * acceleration(x, v)"),
    # False or empty sentences of the audit.
    ("damping_length", "sqrt", "return 2 * viscosity * time"),
    (
        "sphere_force",
        "outside the sphere",
        changed(SPHERE, "            if l > radius:\n                return np.zeros(3)\n", ""),
    ),
    (
        "sphere_force",
        "outside the sphere",
        """
            d = x - centre
            l = np.linalg.norm(d)
            return max(stiffness * abs(radius - l) - damping * (v @ d / l), 0) * d / l""",
    ),
    ("step_euler", "first and the last point", changed(EULER, "range(n)", "range(1, n - 1)")),
    ("draft", "in line", changed(DRAFT, "(body_density * height - oil", "(body_density * height + oil")),
    ("spring_force", "//", changed(SPRING, "* r / length", "* r // length")),
    ("gravity", "1 / 3 in place of 1 // 3", "return 9.81 * mass_ratio ** (1 // 3)"),
    ("cloth_forces", "rest_lengths[n]", changed(CLOTH, "rest_lengths[n]", "rest_lengths[0]")),
    (
        "rain_hit",
        "The surface moves too",
        changed(RAIN, " / (z0[i] - level0[i] - z1[i] + level1[i])", " / (z0[i] - z1[i])"),
    ),
    (
        "rope_acceleration",
        "The speed is squared",
        changed(ROPE, "-drag * v", "-drag * np.linalg.norm(v, axis=1)[:, None] * v"),
    ),
    ("spectrum", "wavelength", changed(PHILLIPS, "np.sqrt(k @ k)", "2 * np.pi / np.sqrt(k @ k) if k.any() else 0")),
    ("dispersion", "wavelength", changed(WAVE, "gravity * k", "gravity * 2 * np.pi / k")),
    (
        "dispersion",
        "1/(2 pi)",
        "f0 = 1 / repeat_time\nreturn calm * np.floor(np.sqrt(gravity * k) / (2 * np.pi) / f0) * f0",
    ),
    ("line_tension", "kN", "return weight * (hanging ** 2 + height ** 2) / (2 * height) / 1000"),
    ("net_buoyancy", "abs", "return abs(fluid_density - body_density) * gravity * volume"),
    (
        "reflectance",
        "from the surface",
        changed(FRESNEL, "np.cos(angle)", "np.sin(angle)", "(np.sin(angle) / index)", "(np.cos(angle) / index)"),
    ),
    (
        "mesh_volume",
        "from 1",
        changed(
            VOLUME, "vertices[i]", "vertices[i - 1]", "vertices[j], vertices[k]", "vertices[j - 1], vertices[k - 1]"
        ),
    ),
    ("gravity", "g = 9.81", "R = 6.371e6 * mass_ratio ** (1 / 3)\nreturn 6.6743e-11 * 5.972e24 * mass_ratio / R ** 2"),
    # Named well by the audit's program, too.
    ("spring_force", "damping along the link only", changed(SPRING, "(v1 - v2)", "((v1 - v2) @ r) * r / length ** 2")),
    (
        "spring_force",
        "each component|every component",
        "return stiffness * (x2 - x1 - rest_length) - damping * (v1 - v2)",
    ),
    (
        "step_rk4",
        "a3 is computed at the position x + h/2 v",
        changed(RK4, "acceleration(x + h / 2 * v2, v + h / 2 * a2)", "acceleration(x + h / 2 * v1, v + h / 2 * a1)"),
    ),
    (
        "step_rk4",
        "h/4",
        changed(
            RK4,
            "h / 6 * (v1 + 2 * v2 + 2 * v3 + v4)",
            "h / 4 * (v1 + v2 + v3 + v4)",
            "h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)",
            "h / 4 * (a1 + a2 + a3 + a4)",
        ),
    ),
    (
        "step_leapfrog",
        "a2 is computed at the position x + h v",
        """
            v_half = v + h / 2 * acceleration(x, v)
            new = x + h * v
            return new, v_half + h / 2 * acceleration(new, v)""",
    ),
    ("step_leapfrog", "force not computed again", changed(LEAPFROG, "(a + acceleration(new, v))", "(a + a)")),
    ("step_leapfrog", "symplectic Euler", "v = v + h * acceleration(x, v)\nreturn x + h * v, v"),
    ("step_euler", "results swapped", "return v + h * acceleration(x, v), x + h * v"),
    (
        "cloth_forces",
        "repeated|holds a number twice",
        """
            i, j = links.T
            r = x[j] - x[i]
            l = np.linalg.norm(r, axis=1)[:, None]
            f = stiffness * (l - rest_lengths[:, None]) * r / l - damping * (v[i] - v[j])
            F = np.zeros_like(x)
            F[i] += f
            F[j] -= f
            return F""",
    ),
    ("gravity", "mass squared", "return 9.81 * mass_ratio ** 2"),
    ("cloth_forces", "same sign", changed(CLOTH, "F[j] -= pull", "F[j] += pull")),
    ("rope_acceleration", "along y", changed(ROPE, "a[:, 2]", "a[:, 1]")),
    ("rope_acceleration", "the last|too few turns", changed(ROPE, "range(len(x) - 1)", "range(len(x) - 2)")),
    ("spectrum", "k L", changed(PHILLIPS, "np.exp(-1 / (kk * L) ** 2)", "np.exp(-1 / (kk * L))")),
    ("spectrum", "unit length", changed(PHILLIPS, "(k @ wind / kk / U)", "(k @ wind)")),
    ("spectrum", "NaN", changed(PHILLIPS, "            if kk == 0:\n                return 0.0\n", "")),
    (
        "dispersion",
        "before the rounding",
        "w0 = 2 * np.pi / repeat_time\nreturn np.floor(calm * np.sqrt(gravity * k) / w0) * w0",
    ),
    ("dispersion", "floor, not round", changed(WAVE, "np.floor", "np.round")),
    (
        "reflectance",
        "np.radians(angle)",
        changed(FRESNEL, "c = np.cos(angle)", "angle = np.radians(angle)\n            c = np.cos(angle)"),
    ),
    (
        "draft",
        "oil alone|Tell the two cases apart",
        "return oil_thickness + (body_density * height - oil_density * oil_thickness) / water_density",
    ),
    ("draft", "cases are swapped", changed(DRAFT, "<=", ">")),
    ("mixture_viscosity", "natural logarithm", changed(VISCOSITY, "np.exp(mean)", "10 ** mean")),
    (
        "wave_decay",
        "wavelength",
        "k = 2 * np.pi / wavenumber\nreturn amplitude * np.exp(-2 * viscosity * k ** 2 * time)",
    ),
    ("surface_colour", "twice", changed(COLOUR, "-2 * absorption", "-absorption")),
    ("jet_landing", "earlier", changed(JET, "(v[2] + np.sqrt", "(v[2] - np.sqrt")),
    ("line_tension", "right angles", "return weight * (hanging ** 2 - height ** 2) / (2 * height) + weight * hanging"),
    (
        "rope_acceleration",
        "between the first point and the last|too many turns",
        changed(
            ROPE,
            "for i in range(len(x) - 1):",
            "for i in range(len(x)):",
            "x[i + 1] - x[i]",
            "x[i] - x[i - 1]",
            "(v[i] - v[i + 1])",
            "(v[i - 1] - v[i])",
            "F[i] += f",
            "F[i - 1] += f",
            "F[i + 1] -= f",
            "F[i] -= f",
        ),
    ),
    (
        "cloth_links",
        "j + 2",
        """
            links = []
            for i in range(rows):
                for j in range(cols):
                    if j + 1 < cols: links.append((i * cols + j, i * cols + j + 1))
                    if i + 1 < rows: links.append((i * cols + j, (i + 1) * cols + j))
                    if i + 1 < rows and j + 1 < cols:
                        links.append((i * cols + j, (i + 1) * cols + j + 1))
                        links.append((i * cols + j + 1, (i + 1) * cols + j))
                    if j + 3 < cols: links.append((i * cols + j, i * cols + j + 2))
                    if i + 2 < rows: links.append((i * cols + j, (i + 2) * cols + j))
            return np.array(links)""",
    ),
    # Of the same kinds.
    ("spring_force", "r = x1 - x2|r must run", changed(SPRING, "r = x2 - x1", "r = x1 - x2")),
    ("spring_force", "damping drives", changed(SPRING, "- damping", "+ damping")),
    ("spring_force", "unit length|instead of r/|r|", changed(SPRING, "* r / length", "* r")),
    ("spring_force", "not subtracted|rest length", changed(SPRING, "(length - rest_length)", "length")),
    ("spring_force", "squared", changed(SPRING, "(length - rest_length)", "(length - rest_length) ** 2")),
    (
        "spring_force",
        "np.linalg.norm(r) in place of np.linalg.norm(x2)",
        changed(SPRING, "np.linalg.norm(r)", "np.linalg.norm(x2)"),
    ),
    ("spring_force", "v1 - v2 in place of", changed(SPRING, "damping * (v1 - v2)", "damping * (v1 - v2) ** 2")),
    (
        "spring_force",
        "wrong shape",
        changed(SPRING, "* r / length - damping * (v1 - v2)", "- damping * np.linalg.norm(v1 - v2)"),
    ),
    ("rope_acceleration", "not divided by the mass", changed(ROPE, "F / mass", "F")),
    ("rope_acceleration", "Point 0", changed(ROPE, "\n            a[0] = 0", "")),
    ("rope_acceleration", "upwards", changed(ROPE, "a[:, 2] -= gravity", "a[:, 2] += gravity")),
    ("rope_acceleration", "F[i] += f", changed(ROPE, "F[i] += f", "F[i] = f")),
    ("rope_acceleration", "a[0]", changed(ROPE, "a[0] = 0", "a[1] = 0")),
    ("rope_acceleration", "the air drag", changed(ROPE, "F = -drag * v", "F = drag * v")),
    (
        "sphere_force",
        "pulled back|never pull",
        changed(
            SPHERE,
            "max(stiffness * (radius - l) - damping * (v @ n), 0) * n",
            "(stiffness * (radius - l) - damping * (v @ n)) * n",
        ),
    ),
    ("sphere_force", "length", changed(SPHERE, "n = d / l", "n = d")),
    (
        "sphere_force",
        "the push has the wrong sign",
        changed(SPHERE, "stiffness * (radius - l)", "stiffness * (l - radius)"),
    ),
    ("sphere_force", "the damping", changed(SPHERE, "- damping * (v @ n)", "+ damping * (v @ n)")),
    ("step_euler", "new velocity", "v = v + h * acceleration(x, v)\nreturn x + h * v, v"),
    ("step_euler", "h forgotten", "return x + h * v, v + acceleration(x, v)"),
    ("step_leapfrog", "h forgotten", changed(LEAPFROG, "h * h / 2 * a", "h / 2 * a")),
    ("step_leapfrog", "second half step|behind", "v = v + h / 2 * acceleration(x, v)\nreturn x + h * v, v"),
    (
        "step_rk4",
        "a4 is computed",
        changed(RK4, "acceleration(x + h * v3, v + h * a3)", "acceleration(x + h / 2 * v3, v + h / 2 * a3)"),
    ),
    ("step_rk4", "new velocity", changed(RK4, "(a1 + 2 * a2 + 2 * a3 + a4)", "(a1 + 2 * a2 + a3 + a4)")),
    ("step_rk4", "h", changed(RK4, "v + h / 6 * (a1", "v + 1 / 6 * (a1")),
    ("cloth_forces", "in line", changed(CLOTH, "F[j] -= pull", "F[i] -= pull")),
    ("cloth_forces", "rest length", changed(CLOTH, "(l - rest_lengths[n])", "l")),
    (
        "cloth_links",
        "no shear|diagonals",
        changed(
            CLOTH_LINKS, "                (n[:-1, :-1], n[1:, 1:]),\n                (n[:-1, 1:], n[1:, :-1]),\n", ""
        ),
    ),
    (
        "cloth_links",
        "(i+1, j+1); too many:",
        changed(CLOTH_LINKS, "(n[:-1, :-1], n[1:, 1:])", "(n[:-2, :-2], n[2:, 2:])"),
    ),
    ("net_buoyancy", "sign|upwards", "return (body_density - fluid_density) * gravity * volume"),
    ("net_buoyancy", "volume", "return (fluid_density - body_density) * gravity"),
    ("extra_draft", "densities|upside down", "return oil_thickness * (1 - water_density / oil_density)"),
    (
        "extra_draft",
        "in line|not change with water_density",
        "return oil_thickness * oil_density - water_density / water_density",
    ),
    ("mixture_viscosity", "logarithm", changed(VISCOSITY, "np.exp(mean)", "mean")),
    ("mixture_viscosity", "1 - oil_fraction|1 - phi", changed(VISCOSITY, "(1 - oil_fraction) *", "")),
    ("wave_decay", "squared", "return amplitude * np.exp(-2 * viscosity * wavenumber * time)"),
    ("wave_decay", "grows", "return amplitude * np.exp(2 * viscosity * wavenumber ** 2 * time)"),
    ("jet_landing", "level", changed(JET, "(x[2] - level)", "x[2]")),
    (
        "jet_landing",
        "2 * gravity|2 * (gravity|half",
        changed(JET, "2 * gravity * (x[2] - level)", "gravity * (x[2] - level)"),
    ),
    ("rain_hit", "start below|z0 > level0", changed(RAIN, "z0[i] > level0[i] and ", "")),
    ("rain_hit", "infinity", changed(RAIN, "np.full(len(z0), np.inf)", "np.zeros(len(z0))")),
    ("mesh_volume", "sixth", changed(VOLUME, "total / 6", "total / 2")),
    ("reflectance", "square", changed(FRESNEL, "rs ** 2 + rp ** 2", "rs + rp")),
)
