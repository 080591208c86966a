"""Wrong solutions as students write them: for each task the name that the check must give, and the body.

An empty name stands for a mistake that the check does not know; it must refuse the solution all the same.
"""

from tests.app.lab.wrong_springs import SPRINGS

WRONG: dict[str, tuple[tuple[str, str], ...]] = {
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
        ("factor inside the root", """
            w0 = 2 * np.pi / repeat_time
            return np.floor(np.sqrt(calm * gravity * k) / w0) * w0"""),
    ),
} | SPRINGS  # fmt: skip
