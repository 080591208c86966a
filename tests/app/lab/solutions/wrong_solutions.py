"""Wrong solutions as students write them: for each task the name that the check must give, and the body.

An empty name stands for a mistake that the check does not know; it must refuse the solution all the same.
"""

from tests.app.lab.solutions.wrong_springs import SPRINGS, changed

# Right bodies, which a mistake changes in one or two places.
FRESNEL = """
            b = np.arcsin(np.sin(angle) / index)
            c, t = np.cos(angle), np.cos(b)
            s = (c - index * t) / (c + index * t)
            p = (index * c - t) / (index * c + t)
            return (s ** 2 + p ** 2) / 2"""
RAIN = """
            s = np.full(len(z0), np.inf)
            for i in range(len(z0)):
                a, b = z0[i] - level0[i], z1[i] - level1[i]
                if a > 0 and b <= 0:
                    s[i] = a / (a - b)
            return s"""
PHILLIPS = """
            kk, U = np.hypot(*k), np.hypot(*wind)
            if kk == 0:
                return 0
            L = U ** 2 / gravity
            return amplitude * np.exp(-1 / (kk * L) ** 2) / kk ** 4 * (k @ wind / kk / U) ** 2"""

WRONG: dict[str, tuple[tuple[str, str], ...]] = {
    "net_buoyancy": (
        ("sign reversed", "return volume * gravity * (body_density - fluid_density)"),
        ("density of air", "return (1.2 - body_density) * gravity * volume"),
        ("weight forgotten", "return fluid_density * volume * gravity"),
        ("gravity forgotten", "return fluid_density * volume - body_density * volume"),
        ("buoyancy forgotten", "return -body_density * volume * gravity"),
        ("weight and buoyancy added", """
            buoyancy = fluid_density * volume * gravity
            weight = body_density * volume * gravity
            return buoyancy + weight"""),
        ("volume forgotten", "return fluid_density * gravity - body_density * gravity"),
    ),
    "extra_draft": (
        ("the whole thickness", "return oil_thickness"),
        ("the part that the oil carries", "return oil_thickness * oil_density / water_density"),
        ("densities swapped", "return oil_thickness * (1 - water_density / oil_density)"),
        ("relative to the oil", "return oil_thickness * (water_density - oil_density) / oil_density"),
        ("constant factor", "return 2 * oil_thickness * (1 - oil_density / water_density)"),
        ("sign reversed", "return oil_thickness * (oil_density - water_density) / water_density"),
        ("density of air", "return oil_thickness * (water_density - 1.2) / water_density"),
        ("difference not divided", "return (water_density - oil_density) * oil_thickness"),
    ),
    "draft": (
        ("mean density", """
            under = oil_density * oil_thickness + water_density * (height - oil_thickness)
            return body_density * height / (under / height)"""),
        ("oil forgotten", "return body_density * height / water_density"),
        ("thick oil forgotten", """
            rest = body_density * height - oil_density * oil_thickness
            return oil_thickness + rest / water_density"""),
        ("depth in the water only", """
            if body_density * height < oil_density * oil_thickness:
                return body_density * height / oil_density
            return (body_density * height - oil_density * oil_thickness) / water_density"""),
        ("oil_thickness not used", "return body_density * height / (0.5 * (oil_density + water_density))"),
        ("water forgotten", "return height * body_density / oil_density"),
        ("lift of the oil forgotten", """
            if body_density * height < oil_density * oil_thickness:
                return body_density * height / oil_density
            return body_density * height / water_density + oil_thickness"""),
        ("densities swapped", """
            load = body_density * height
            if load < water_density * oil_thickness:
                return load / water_density
            return oil_thickness + (load - water_density * oil_thickness) / oil_density"""),
        ("density of air", """
            load, lift = body_density * height, 1.2 * oil_thickness
            if load < lift:
                return load / 1.2
            return oil_thickness + (load - lift) / water_density"""),
        ("cases swapped", """
            if oil_density * oil_thickness < body_density * height:
                return body_density * height / oil_density
            return oil_thickness + (body_density * height - oil_density * oil_thickness) / water_density"""),
    ),
    "surface_colour": (
        ("light passes once", """
            T = np.exp(-absorption * thickness)
            return T * water_colour + (1 - T) * oil_colour"""),
        ("colours swapped", """
            T = np.exp(-2 * absorption * thickness)
            return [T * o + (1 - T) * w for o, w in zip(oil_colour, water_colour)]"""),
        ("fractions do not sum to one", "return oil_colour + np.exp(-2 * absorption * thickness) * water_colour"),
        ("wrong shape", """
            T = np.exp(-2 * absorption * thickness)
            return T * water_colour[0] + (1 - T) * oil_colour[0]"""),
        ("sign reversed in the exponent", """
            T = np.exp(2 * absorption * thickness)
            return T * water_colour + (1 - T) * oil_colour"""),
        ("exponential forgotten", """
            T = 1 - 2 * absorption * thickness
            return T * water_colour + (1 - T) * oil_colour"""),
        ("mean of the colours", "return [0.5 * (o + w) for o, w in zip(oil_colour, water_colour)]"),
        ("colour of the oil alone", "return oil_colour"),
    ),
    "mixture_viscosity": (
        ("products for powers", "return oil_viscosity * oil_fraction * water_viscosity * (1 - oil_fraction)"),
        ("arithmetic mean", "return oil_fraction * oil_viscosity + (1 - oil_fraction) * water_viscosity"),
        ("fractions swapped", "return oil_viscosity ** (1 - oil_fraction) * water_viscosity ** oil_fraction"),
        ("two kinds of logarithm", """
            m = oil_fraction * np.log10(oil_viscosity) + (1 - oil_fraction) * np.log10(water_viscosity)
            return np.exp(m)"""),
        ("logarithm not undone", """
            return oil_fraction * np.log(oil_viscosity) + (1 - oil_fraction) * np.log(water_viscosity)"""),
        ("two kinds of logarithm", """
            m = oil_fraction * np.log(oil_viscosity) + (1 - oil_fraction) * np.log(water_viscosity)
            return 10 ** m"""),
        ("fraction not used", "return np.exp((np.log(oil_viscosity) + np.log(water_viscosity)) / 2)"),
        ("harmonic mean", "return 1 / (oil_fraction / oil_viscosity + (1 - oil_fraction) / water_viscosity)"),
        ("weights do not sum to one", """
            return np.exp(oil_fraction * np.log(oil_viscosity) + np.log(water_viscosity))"""),
    ),
    "wave_decay": (
        ("rate of the energy", "return amplitude * np.exp(-4 * viscosity * wavenumber ** 2 * time)"),
        ("wavenumber not squared", "return amplitude * np.exp(-2 * viscosity * wavenumber * time)"),
        ("wave grows", "return amplitude * np.exp(2 * viscosity * wavenumber ** 2 * time)"),
        ("factor instead of amplitude", "return np.exp(-2 * viscosity * wavenumber ** 2 * time)"),
        ("factor 2 forgotten", "return amplitude * np.exp(-viscosity * wavenumber ** 2 * time)"),
        ("exponential forgotten", "return amplitude - amplitude * 2 * viscosity * wavenumber ** 2 * time"),
        ("wavelength for wavenumber", """
            k = 2 * np.pi / wavenumber
            return amplitude * np.exp(-2 * viscosity * k ** 2 * time)"""),
        ("rate instead of amplitude", "return 2 * viscosity * wavenumber ** 2"),
    ),
    "reflectance": (
        ("angle from the surface", changed(FRESNEL, "b = np.arc", "angle = np.pi / 2 - angle\n            b = np.arc")),
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
        ("one polarisation only", changed(FRESNEL, "(s ** 2 + p ** 2) / 2", "p ** 2")),
        ("not squared", changed(FRESNEL, "(s ** 2 + p ** 2) / 2", "(s + p) / 2")),
        ("not squared", changed(FRESNEL, "(s ** 2 + p ** 2) / 2", "(abs(s) + abs(p)) / 2")),
        ("mean before the square", changed(FRESNEL, "(s ** 2 + p ** 2) / 2", "((s + p) / 2) ** 2")),
        ("light that passes", changed(FRESNEL, "(s ** 2 + p ** 2) / 2", "1 - (s ** 2 + p ** 2) / 2")),
        ("light bent the wrong way", changed(FRESNEL, "b = np.arcsin(np.sin(angle) / index)",
            "if index * np.sin(angle) > 1: return 1\n            b = np.arcsin(index * np.sin(angle))")),
    ),
    "mesh_volume": (
        ("products of coordinates", """
            V = 0
            for a, b, c in vertices:
                V += a * b * c / 6
            return V"""),
        ("product by components", """
            V = 0
            for f in faces:
                V += np.sum(vertices[f[0]] * vertices[f[1]] * vertices[f[2]]) / 6
            return V"""),
        ("corners counted from 1", """
            a, b, c = vertices[faces[:, 0] - 1], vertices[faces[:, 1] - 1], vertices[faces[:, 2] - 1]
            return np.einsum("ij,ij", a, np.cross(b, c)) / 6"""),
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
        ("factor 1/6 wrong", "return sum(np.linalg.det(vertices[face]) for face in faces)"),
        ("factor 1/6 wrong", "return sum(np.linalg.det(vertices[face]) for face in faces) / 2"),
        ("area instead of volume", """
            A = 0
            for i, j, k in faces:
                n = np.cross(vertices[j] - vertices[i], vertices[k] - vertices[i])
                A += 0.5 * np.sqrt(n @ n)
            return A"""),
        ("bounding box", """
            size = vertices.max(axis=0) - vertices.min(axis=0)
            return size[0] * size[1] * size[2]"""),
    ),
    "jet_landing": (
        ("brackets of the divisor", """
            h = x[2] - level
            t = (v[2] + np.sqrt(v[2] ** 2 + 2 * gravity * h)) / 2 * gravity
            return np.array([x[0] + v[0] * t, x[1] + v[1] * t, level])"""),
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
        ("level forgotten", """
            t = (v[2] + np.sqrt(v[2] ** 2 + 2 * gravity * x[2])) / gravity
            return np.array([x[0] + v[0] * t, x[1] + v[1] * t, level])"""),
        ("half forgotten", """
            t = max(np.roots([-gravity, v[2], x[2] - level]))
            return np.array([x[0] + v[0] * t, x[1] + v[1] * t, level])"""),
        ("height set to 0", """
            t = (v[2] + np.sqrt(v[2] ** 2 + 2 * gravity * (x[2] - level))) / gravity
            return [x[0] + v[0] * t, x[1] + v[1] * t, 0]"""),
        ("straight down", "return [x[0], x[1], level]"),
    ),
    "gravity": (
        ("radius unchanged", "return 9.81 * mass_ratio"),
        ("mass squared", "return 9.81 * mass_ratio ** 2"),
        ("radius not squared", "return 9.81 * mass_ratio / mass_ratio ** (1 / 3)"),
        ("gravity unchanged", "return 9.81"),
        ("upside down", "return 9.81 / mass_ratio ** (1 / 3)"),
        ("radius grows with the mass", """
            R = mass_ratio
            return 9.81 * mass_ratio / R ** 2"""),
        ("mass forgotten", """
            R = mass_ratio ** (1 / 3)
            return 9.81 / R ** 2"""),
    ),
    "rain_hit": (
        ("motion of the surface forgotten", changed(RAIN, "a / (a - b)", "a / (z0[i] - z1[i])")),
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
        ("surface taken as still", changed(RAIN, "z0[i] - level0[i]", "z0[i] - level1[i]")),
        ("misses not infinite", """
            a, b = z0 - level0, z1 - level1
            return a / (a - b)"""),
        ("fraction from the end", changed(RAIN, "s[i] = a / (a - b)", "s[i] = 1 - a / (a - b)")),
        ("end of the step", changed(RAIN, "s[i] = a / (a - b)", "s[i] = 1")),
        ("distance instead of fraction", changed(RAIN, "s[i] = a / (a - b)", "s[i] = a")),
    ),
    "spectrum": (
        ("wavelength for wavenumber", changed(PHILLIPS, "L = U", "kk = 2 * np.pi / kk\n            L = U")),
        ("wavelength for wavenumber", changed(
            PHILLIPS, "L = U", "s, kk = kk, 2 * np.pi / kk\n            L = U", "wind / kk", "wind / s")),
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
        ("gravity forgotten", changed(PHILLIPS, "U ** 2 / gravity", "U ** 2")),
        ("sign reversed in the exponent", changed(PHILLIPS, "exp(-1", "exp(1")),
        ("cosine not squared", changed(PHILLIPS, "(k @ wind / kk / U) ** 2", "(k @ wind / kk / U)")),
        ("no longest wave", changed(PHILLIPS, " * np.exp(-1 / (kk * L) ** 2)", "")),
        ("k L not squared", changed(PHILLIPS, "(kk * L) ** 2", "(kk * L)")),
    ),
    "damping_length": (
        ("amplitude instead of power", "return np.sqrt(2 * viscosity * time)"),
        ("root forgotten", "return 4 * viscosity * time"),
        ("factor 2 forgotten", "return (viscosity * time) ** 0.5"),
        ("constant factor", "return np.pi * np.sqrt(viscosity * time)"),
        ("root of the viscosity only", "return 2 * np.sqrt(viscosity) * time"),
        ("root of the time only", "return 2 * viscosity * time ** 0.5"),
        ("divided by the time", "return 2 * np.sqrt(viscosity / time)"),
        ("time not used", "return 2 * viscosity ** 0.5"),
    ),
    "dispersion": (
        ("wavelength for wavenumber", """
            w0 = 2 * np.pi / repeat_time
            return calm * w0 * np.floor(np.sqrt(gravity * 2 * np.pi / k) / w0)"""),
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
        ("factor inside the root", """
            w0 = 2 * np.pi / repeat_time
            return np.floor(np.sqrt(calm * gravity * k) / w0) * w0"""),
        ("rounded up", """
            w0 = 2 * np.pi / repeat_time
            return calm * np.ceil(np.sqrt(gravity * k) / w0) * w0"""),
        ("root forgotten", """
            w0 = 2 * np.pi / repeat_time
            return calm * (gravity * k // w0) * w0"""),
        ("calm not used", """
            w0 = 2 * np.pi / repeat_time
            return np.sqrt(gravity * k) // w0 * w0"""),
        ("number of turns", """
            w0 = 2 * np.pi / repeat_time
            return calm * np.floor(np.sqrt(gravity * k) / w0)"""),
    ),
} | SPRINGS  # fmt: skip
