"""Wrong solutions as students write them: for each task the name that the check must give, and the body.

An empty name stands for a mistake that the check does not know; it must refuse the solution all the same.
"""

# Right bodies, which a mistake changes in one or two places.
ROPE = """
            F = -drag * v
            for i in range(len(x) - 1):
                r = x[i + 1] - x[i]
                l = np.linalg.norm(r)
                f = stiffness * (l - rest_length) * r / l - damping * (v[i] - v[i + 1])
                F[i] += f
                F[i + 1] -= f
            a = F / mass
            a[:, 2] -= gravity
            a[0] = 0
            return a"""
RK4 = """
            v1, a1 = v, acceleration(x, v)
            v2, a2 = v + h / 2 * a1, acceleration(x + h / 2 * v1, v + h / 2 * a1)
            v3, a3 = v + h / 2 * a2, acceleration(x + h / 2 * v2, v + h / 2 * a2)
            v4, a4 = v + h * a3, acceleration(x + h * v3, v + h * a3)
            return x + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)"""
SPHERE = """
            d = x - centre
            l = np.linalg.norm(d)
            if l > radius:
                return np.zeros(3)
            n = d / l
            return max(stiffness * (radius - l) - damping * (v @ n), 0) * n"""


def changed(body: str, *texts: str) -> str:
    """The body with each text replaced by the one behind it."""
    for old, new in zip(texts[::2], texts[1::2], strict=True):
        assert old in body
        body = body.replace(old, new)
    return body


WRONG: dict[str, tuple[tuple[str, str], ...]] = {
    "line_tension": (
        ("level part only", "return weight * (hanging ** 2 - height ** 2) / (2 * height)"),
        ("weight only", "return weight * hanging"),
        ("hanging not used", "return weight * height"),
    ),
    "spring_force": (
        ("sign reversed", """
            r = x1 - x2
            n = r / np.linalg.norm(r)
            return stiffness * (np.linalg.norm(r) - rest_length) * n + damping * (v1 - v2)"""),
        ("sign of the spring reversed", """
            r = x1 - x2
            dist = np.sqrt(np.sum(r ** 2))
            return stiffness * (dist - rest_length) * r / dist - damping * (v1 - v2)"""),
        ("sign of the damping reversed", """
            r = x2 - x1
            return stiffness * (np.linalg.norm(r) - rest_length) * r / np.linalg.norm(r) - damping * (v2 - v1)"""),
        ("rest length forgotten", "return stiffness * (x2 - x1) - damping * (v1 - v2)"),
        ("no force when compressed", """
            r = x2 - x1
            stretch = max(np.linalg.norm(r) - rest_length, 0)
            return stiffness * stretch * r / np.linalg.norm(r) - damping * (v1 - v2)"""),
        ("the spring is k max(|r| - d, 0) r/|r|", """
            r = x2 - x1
            stretch = max(np.linalg.norm(r) - rest_length, 0)
            return stiffness * stretch * r / np.linalg.norm(r) - 1.5 * damping * (v1 - v2)"""),
        ("NaN", """
            r, dv = x2 - x1, v1 - v2
            speed = np.linalg.norm(dv)
            n = r / np.linalg.norm(r)
            return stiffness * (np.linalg.norm(r) - rest_length) * n - damping * speed * dv / speed"""),
        ("damping on absolute velocity", """
            r = x2 - x1
            l = np.linalg.norm(r)
            return stiffness * (l - rest_length) * r / l - damping * v1"""),
        ("the damping is missing", """
            r = x2 - x1
            l = np.linalg.norm(r)
            return stiffness * (l - rest_length) * r / l"""),
        ("direction not of unit length", """
            r = x2 - x1
            return stiffness * (np.linalg.norm(r) - rest_length) * r - damping * (v1 - v2)"""),
        ("force not along the link", """
            force = np.zeros(3)
            for i in range(3):
                force[i] = stiffness * (x2[i] - x1[i] - rest_length) - damping * (v1[i] - v2[i])
            return force"""),
        ("wrong shape", """
            l = np.linalg.norm(x2 - x1)
            return stiffness * (l - rest_length)"""),
        ("the spring is k (|r| - d)² r/|r|, times 0.5", """
            r = x2 - x1
            l = np.linalg.norm(r)
            return 0.5 * stiffness * (l - rest_length) ** 2 * r / l - damping * (v1 - v2)"""),
    ),
    "rope_acceleration": (
        ("mass forgotten", """
            a = np.zeros((len(x), 3))
            for i in range(1, len(x)):
                a[i] = (0, 0, -gravity)
                a[i] -= drag * v[i]
                for j in (i - 1, i + 1):
                    if j < len(x):
                        r = x[j] - x[i]
                        l = np.linalg.norm(r)
                        a[i] += stiffness * (l - rest_length) * r / l - damping * (v[i] - v[j])
            return a"""),
        ("force on one end only", changed(ROPE, "\n                F[i + 1] -= f", "")),
        ("root not held", changed(ROPE, "\n            a[0] = 0", "")),
        ("gravity divided by the mass", changed(ROPE, "a[:, 2] -= gravity", "a[:, 2] -= gravity / mass")),
        ("gravity along the wrong axis", changed(ROPE, "a[:, 2] -= gravity", "a[:, 1] -= gravity")),
        ("the air drag is missing", changed(ROPE, "-drag * v", "np.zeros_like(x)")),
        ("", changed(ROPE, "-drag * v", "-drag * np.abs(v) * v")),
    ),
    "step_euler": (
        ("velocity before position", """
            v = v + h * acceleration(x, v)
            x = x + h * v
            return x, v"""),
        ("position before velocity", """
            x = x + h * v
            v = v + h * acceleration(x, v)
            return x, v"""),
        ("the new position is x + h v + h²/2 a1", """
            a = acceleration(x, v)
            return x + v * h + a * h * h / 2, v + a * h"""),
        ("results swapped", "return v + h * acceleration(x, v), x + h * v"),
        ("the new position is h v", "return h * v, h * acceleration(x, v)"),
        ("position before velocity", """
            for i in range(len(x)):
                x[i] += h * v[i]
            v += h * acceleration(x, v)
            return x, v"""),
        ("wrong shape", "return x + h * v"),
    ),
    "step_rk4": (
        ("keeps the first force", """
            a = acceleration(x, v)
            v1, v2, v3, v4 = v, v + h / 2 * a, v + h / 2 * a, v + h * a
            return x + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a + 2 * a + 2 * a + a)"""),
        ("weights do not add up to one", changed(RK4, "h / 6 * (", "h * (")),
        ("weights do not add up to one", changed(RK4, "+ 2 * ", "+ ")),
        ("acceleration a2 is computed at the position x + h v", """
            k1x, k1v = v, acceleration(x, v)
            k2x, k2v = v + h * k1v, acceleration(x + h * k1x, v + h * k1v)
            k3x, k3v = v + h * k2v, acceleration(x + h * k2x, v + h * k2v)
            k4x, k4v = v + h * k3v, acceleration(x + h * k3x, v + h * k3v)
            return x + h / 6 * (k1x + 2 * k2x + 2 * k3x + k4x), v + h / 6 * (k1v + 2 * k2v + 2 * k3v + k4v)"""),
        ("midpoint method", """
            a1 = acceleration(x, v)
            xm, vm = x + h / 2 * v, v + h / 2 * a1
            return x + h * vm, v + h * acceleration(xm, vm)"""),
        ("too few stages", """
            a1 = acceleration(x, v)
            v2 = v + h * a1
            a2 = acceleration(x + h * v, v2)
            return x + h / 2 * (v + v2), v + h / 2 * (a1 + a2)"""),
    ),
    "step_leapfrog": (
        ("no half step", """
            v = v + h * acceleration(x, v)
            return x + h * v, v"""),
        ("position before velocity", """
            x = x + h * v
            v = v + h * acceleration(x, v)
            return x, v"""),
        ("second half step forgotten", """
            vh = v + 0.5 * h * acceleration(x, v)
            return x + h * vh, vh"""),
        ("force not computed anew", """
            a = acceleration(x, v)
            v_half = v + h / 2 * a
            x = x + h * v_half
            return x, v_half + h / 2 * a"""),
        ("Euler", "return x + h * v, v + h * acceleration(x, v)"),
    ),
    "sphere_force": (
        ("damping that pulls", changed(SPHERE, "max(stiffness * (radius - l) - damping * (v @ n), 0)",
                                       "(stiffness * (radius - l) - damping * (v @ n))")),
        ("normal not unit length", changed(SPHERE, "n = d / l", "n = d")),
        ("damping with the whole velocity", changed(SPHERE, "max(stiffness * (radius - l) - damping * (v @ n), 0) * n",
                                                    "stiffness * (radius - l) * n - damping * v")),
        ("sign reversed", changed(SPHERE, "d = x - centre", "d = centre - x", "- damping", "+ damping")),
        ("force outside the sphere", """
            d = x - centre
            l = np.linalg.norm(d)
            n = d / l
            return (stiffness * (radius - l) - damping * (v @ n)) * n"""),
        ("returns nothing", changed(SPHERE, "\n                return np.zeros(3)", "\n                return")),
    ),
    "cloth_links": (
        ("no shear links", """
            links = []
            for i in range(rows):
                for j in range(cols):
                    for di, dj in ((0, 1), (1, 0), (0, 2), (2, 0)):
                        if i + di < rows and j + dj < cols:
                            links.append((i * cols + j, (i + di) * cols + j + dj))
            return links"""),
        ("one diagonal only", """
            links = []
            for i in range(rows):
                for j in range(cols):
                    for di, dj in ((0, 1), (1, 0), (1, 1), (0, 2), (2, 0)):
                        if i + di < rows and j + dj < cols:
                            links.append([i * cols + j, (i + di) * cols + j + dj])
            return np.array(links)"""),
        ("end of a row joined to the next row", """
            links = []
            n = rows * cols
            for a in range(n):
                for step in (1, cols, cols + 1, cols - 1, 2, 2 * cols):
                    if a + step < n:
                        links.append((a, a + step))
            return links"""),
        ("each link twice", """
            links = []
            for i in range(rows):
                for j in range(cols):
                    for di, dj in ((0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)):
                        for s in (1, -1):
                            p, q = i + s * di, j + s * dj
                            if 0 <= p < rows and 0 <= q < cols:
                                links.append((i * cols + j, p * cols + q))
            return links"""),
    ),
    "cloth_forces": (
        ("force on one end only", """
            F = np.zeros_like(x)
            for (i, j), d in zip(links, rest_lengths):
                r = x[j] - x[i]
                l = np.linalg.norm(r)
                F[i] += stiffness * (l - d) * r / l - damping * (v[i] - v[j])
            return F"""),
        ("repeated indices", """
            F = np.zeros_like(x)
            i, j = links[:, 0], links[:, 1]
            r = x[j] - x[i]
            l = np.linalg.norm(r, axis=1)
            f = (stiffness * (l - rest_lengths) / l)[:, None] * r - damping * (v[i] - v[j])
            F[i] += f
            F[j] -= f
            return F"""),
        ("forces overwritten", """
            F = np.zeros_like(x)
            for n in range(len(links)):
                i, j = links[n]
                r = x[j] - x[i]
                l = np.linalg.norm(r)
                F[i] = stiffness * (l - rest_lengths[n]) * r / l - damping * (v[i] - v[j])
                F[j] = -F[i]
            return F"""),
        ("rest length forgotten", """
            F = np.zeros_like(x)
            for i, j in links:
                f = stiffness * (x[j] - x[i]) - damping * (v[i] - v[j])
                F[i] += f
                F[j] -= f
            return F"""),
    ),
    "net_buoyancy": (
        ("sign reversed", "return volume * gravity * (body_density - fluid_density)"),
        ("density of air", "return (1.2 - body_density) * gravity * volume"),
        ("weight forgotten", "return fluid_density * volume * gravity"),
        ("gravity forgotten", "return fluid_density * volume - body_density * volume"),
    ),
    "extra_draft": (
        ("the whole thickness", "return oil_thickness"),
        ("the share that the oil carries", "return oil_thickness * oil_density / water_density"),
        ("densities swapped", "return oil_thickness * (1 - water_density / oil_density)"),
        ("relative to the oil", "return oil_thickness * (water_density - oil_density) / oil_density"),
        ("constant factor", "return 2 * oil_thickness * (1 - oil_density / water_density)"),
    ),
    "draft": (
        ("oil forgotten", "return body_density * height / water_density"),
        ("thick oil forgotten", """
            rest = body_density * height - oil_density * oil_thickness
            return oil_thickness + rest / water_density"""),
        ("depth in the water only", """
            if body_density * height < oil_density * oil_thickness:
                return body_density * height / oil_density
            return (body_density * height - oil_density * oil_thickness) / water_density"""),
        ("oil_thickness not used", "return body_density * height / (0.5 * (oil_density + water_density))"),
    ),
    "surface_colour": (
        ("light passes once", """
            T = np.exp(-absorption * thickness)
            return T * water_colour + (1 - T) * oil_colour"""),
        ("colours swapped", """
            T = np.exp(-2 * absorption * thickness)
            return [T * o + (1 - T) * w for o, w in zip(oil_colour, water_colour)]"""),
        ("shares do not sum to one", "return oil_colour + np.exp(-2 * absorption * thickness) * water_colour"),
        ("wrong shape", """
            T = np.exp(-2 * absorption * thickness)
            return T * water_colour[0] + (1 - T) * oil_colour[0]"""),
    ),
    "mixture_viscosity": (
        ("arithmetic mean", "return oil_fraction * oil_viscosity + (1 - oil_fraction) * water_viscosity"),
        ("fractions swapped", "return oil_viscosity ** (1 - oil_fraction) * water_viscosity ** oil_fraction"),
        ("two kinds of logarithm", """
            m = oil_fraction * np.log10(oil_viscosity) + (1 - oil_fraction) * np.log10(water_viscosity)
            return np.exp(m)"""),
        ("logarithm not undone", """
            return oil_fraction * np.log(oil_viscosity) + (1 - oil_fraction) * np.log(water_viscosity)"""),
    ),
    "wave_decay": (
        ("rate of the energy", "return amplitude * np.exp(-4 * viscosity * wavenumber ** 2 * time)"),
        ("wavenumber not squared", "return amplitude * np.exp(-2 * viscosity * wavenumber * time)"),
        ("wave grows", "return amplitude * np.exp(2 * viscosity * wavenumber ** 2 * time)"),
        ("factor instead of amplitude", "return np.exp(-2 * viscosity * wavenumber ** 2 * time)"),
    ),
    "reflectance": (
        ("one polarisation only", """
            c = np.cos(angle)
            t = np.sqrt(1 - (np.sin(angle) / index) ** 2)
            return ((c - index * t) / (c + index * t)) ** 2"""),
        ("angle not used", "return ((index - 1) / (index + 1)) ** 2"),
        ("sum instead of mean", """
            c = np.cos(angle)
            t = np.sqrt(1 - (np.sin(angle) / index) ** 2)
            return ((c - index * t) / (c + index * t)) ** 2 + ((index * c - t) / (index * c + t)) ** 2"""),
        ("NaN", """
            c = np.cos(angle)
            t = np.sqrt(1 - (np.sin(angle) * index) ** 2)
            return (((c - index * t) / (c + index * t)) ** 2 + ((index * c - t) / (index * c + t)) ** 2) / 2"""),
        ("", """
            R0 = ((index - 1) / (index + 1)) ** 2
            return R0 + (1 - R0) * (1 - np.cos(angle)) ** 5"""),
    ),
    "mesh_volume": (
        ("factor 1/6 wrong", """
            V = 0
            for i, j, k in faces:
                V += vertices[i].dot(np.cross(vertices[j], vertices[k]))
            return V / 3"""),
        ("absolute values added", """
            V = 0
            for i, j, k in faces:
                V += abs(vertices[i].dot(np.cross(vertices[j], vertices[k]))) / 6
            return V"""),
        ("sign reversed", """
            V = 0
            for i, j, k in faces:
                V += vertices[i].dot(np.cross(vertices[k], vertices[j])) / 6
            return V"""),
    ),
    "jet_landing": (
        ("the earlier time", """
            t = (v[2] - np.sqrt(v[2] ** 2 + 2 * gravity * (x[2] - level))) / gravity
            return np.array([x[0] + v[0] * t, x[1] + v[1] * t, level])"""),
        ("start velocity forgotten", """
            t = np.sqrt(2 * (x[2] - level) / gravity)
            return np.array([x[0] + v[0] * t, x[1] + v[1] * t, level])"""),
        ("level forgotten", """
            t = (v[2] + np.sqrt(v[2] ** 2 + 2 * gravity * x[2])) / gravity
            return np.array([x[0] + v[0] * t, x[1] + v[1] * t, 0])"""),
        ("gravity forgotten in the height", """
            t = (v[2] + np.sqrt(v[2] ** 2 + 2 * gravity * (x[2] - level))) / gravity
            return x + v * t"""),
    ),
    "gravity": (
        ("radius unchanged", "return 9.81 * mass_ratio"),
        ("mass squared", "return 9.81 * mass_ratio ** 2"),
        ("radius not squared", "return 9.81 * mass_ratio / mass_ratio ** (1 / 3)"),
        ("gravity unchanged", "return 9.81"),
        ("upside down", "return 9.81 / mass_ratio ** (1 / 3)"),
    ),
    "rain_hit": (
        ("surface taken as still", """
            s = np.full(len(z0), np.inf)
            for i in range(len(z0)):
                if z0[i] > level0[i] and z1[i] <= level0[i]:
                    s[i] = (z0[i] - level0[i]) / (z0[i] - z1[i])
            return s"""),
        ("only the end is tested", """
            a, b = z0 - level0, z1 - level1
            return np.where(b <= 0, a / (a - b), np.inf)"""),
        ("true or false", "return (z0 > level0) & (z1 <= level1)"),
        ("0 for no meeting", """
            s = np.zeros(len(z0))
            for i in range(len(z0)):
                a, b = z0[i] - level0[i], z1[i] - level1[i]
                if a > 0 and b <= 0:
                    s[i] = a / (a - b)
            return s"""),
    ),
    "spectrum": (
        ("speed not squared", """
            kk = np.hypot(*k)
            if kk == 0:
                return 0
            U = np.hypot(*wind)
            L = U / gravity
            return amplitude * np.exp(-1 / (kk * L) ** 2) / kk ** 4 * (k @ wind / kk / U) ** 2"""),
        ("k squared instead of its fourth power", """
            k2 = k @ k
            if k2 == 0:
                return 0
            U2 = wind @ wind
            L = U2 / gravity
            return amplitude * np.exp(-1 / (k2 * L ** 2)) / k2 * (k @ wind) ** 2 / k2 / U2"""),
        ("vectors not of unit length", """
            kk = np.linalg.norm(k)
            if kk < 1e-9:
                return 0
            L = (wind @ wind) / gravity
            return amplitude * np.exp(-1 / (kk * L) ** 2) / kk ** 4 * np.dot(k, wind) ** 2"""),
        ("NaN", """
            kk = np.linalg.norm(k)
            L = (wind @ wind) / gravity
            cosine = np.dot(k, wind) / (kk * np.linalg.norm(wind))
            return amplitude * np.exp(-1 / (kk * L) ** 2) / kk ** 4 * cosine ** 2"""),
        ("direction forgotten", """
            kk = np.linalg.norm(k)
            if kk == 0:
                return 0
            return amplitude * np.exp(-1 / (kk * (wind @ wind) / gravity) ** 2) / kk ** 4"""),
    ),
    "damping_length": (
        ("amplitude instead of power", "return np.sqrt(2 * viscosity * time)"),
        ("root forgotten", "return 4 * viscosity * time"),
        ("factor 2 forgotten", "return (viscosity * time) ** 0.5"),
        ("constant factor", "return np.pi * np.sqrt(viscosity * time)"),
    ),
    "dispersion": (
        ("not rounded", "return calm * np.sqrt(gravity * k)"),
        ("2 pi forgotten", """
            w0 = 1 / repeat_time
            return calm * np.floor(np.sqrt(gravity * k) / w0) * w0"""),
        ("rounded to the nearest", """
            w0 = 2 * np.pi / repeat_time
            return calm * round(np.sqrt(gravity * k) / w0) * w0"""),
        ("scaled before rounding", """
            w0 = 2 * np.pi / repeat_time
            return np.floor(calm * np.sqrt(gravity * k) / w0) * w0"""),
        ("gravity forgotten", """
            w0 = 2 * np.pi / repeat_time
            return calm * int(np.sqrt(k) / w0) * w0"""),
    ),
}  # fmt: skip
