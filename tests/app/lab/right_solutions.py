"""Right solutions in another hand: for each task one with loops and plain numbers, and one with another formula."""

RIGHT: dict[str, tuple[str, str]] = {
    "line_tension": (
        "return weight * ((hanging - height) ** 2 / 2 / height + hanging)",
        """
        import math
        level = weight * (hanging * hanging - height * height) / 2 / height
        return math.hypot(level, weight * hanging)""",
    ),
    "spring_force": (
        """
        r = [x2[i] - x1[i] for i in range(3)]
        length = sum(c * c for c in r) ** 0.5
        pull = stiffness * (length - rest_length) / length
        return [pull * r[i] - damping * (v1[i] - v2[i]) for i in range(3)]""",
        """
        r = x1 - x2
        return -stiffness * (1 - rest_length / np.sqrt(r @ r)) * r + damping * (v2 - v1)""",
    ),
    "rope_acceleration": (
        """
        n = len(x)
        a = [[0.0, 0.0, 0.0]]
        for i in range(1, n):
            row = [-drag * v[i][c] / mass for c in range(3)]
            row[2] -= gravity
            for j in (i - 1, i + 1):
                if j < n:
                    r = [x[j][c] - x[i][c] for c in range(3)]
                    l = (r[0] ** 2 + r[1] ** 2 + r[2] ** 2) ** 0.5
                    for c in range(3):
                        row[c] += (stiffness * (l - rest_length) * r[c] / l - damping * (v[i][c] - v[j][c])) / mass
            a.append(row)
        return a""",
        """
        r = np.diff(x, axis=0)
        f = stiffness * (1 - rest_length / np.sqrt((r * r).sum(1)))[:, np.newaxis] * r + damping * np.diff(v, axis=0)
        total = np.concatenate([f, [[0, 0, 0]]]) - np.concatenate([[[0, 0, 0]], f])
        a = (total - drag * v) / mass - gravity * np.array([0, 0, 1])
        a[0] *= 0
        return a""",
    ),
    "step_euler": (
        """
        a = acceleration(x, v)
        n = len(x)
        xs = [[x[i][c] + h * v[i][c] for c in range(3)] for i in range(n)]
        vs = [[v[i][c] + h * a[i][c] for c in range(3)] for i in range(n)]
        return [xs, vs]""",
        """
        a = acceleration(x, v)
        x += h * v
        v += h * a
        return x, v""",
    ),
    "step_rk4": (
        """
        n = len(x)
        def f(s):
            a = acceleration([r[:3] for r in s], [r[3:] for r in s])
            return [list(s[i][3:]) + list(a[i]) for i in range(n)]
        def add(s, d, t):
            return [[p + t * q for p, q in zip(a, b)] for a, b in zip(s, d)]
        y = [list(x[i]) + list(v[i]) for i in range(n)]
        f1 = f(y)
        f2 = f(add(y, f1, h / 2))
        f3 = f(add(y, f2, h / 2))
        f4 = f(add(y, f3, h))
        for d, w in ((f1, 1), (f2, 2), (f3, 2), (f4, 1)):
            y = add(y, d, w * h / 6)
        return [r[:3] for r in y], [r[3:] for r in y]""",
        """
        f = lambda y: np.array([y[1], acceleration(y[0], y[1])])
        y = np.array([x, v])
        k1 = h * f(y)
        k2 = h * f(y + k1 / 2)
        k3 = h * f(y + k2 / 2)
        k4 = h * f(y + k3)
        return y + (k1 + 2 * k2 + 2 * k3 + k4) / 6""",
    ),
    "step_leapfrog": (
        """
        x = x + h / 2 * v
        v = v + h * acceleration(x, v)
        return x + h / 2 * v, v""",
        """
        a = acceleration(x, v)
        new = x + h * v + h * h / 2 * a
        return new, v + h / 2 * (a + acceleration(new, v))""",
    ),
    "sphere_force": (
        """
        r = [x[i] - centre[i] for i in range(3)]
        l = sum(c * c for c in r) ** 0.5
        F = [0.0, 0.0, 0.0]
        if l < radius:
            speed = sum(v[i] * r[i] for i in range(3)) / l
            size = stiffness * (radius - l) - damping * speed
            if size > 0:
                F = [size * c / l for c in r]
        return F""",
        """
        n = (x - centre) / np.linalg.norm(x - centre)
        p = radius - n @ (x - centre)
        return (p > 0) * np.maximum(stiffness * p - damping * n @ v, 0) * n""",
    ),
    "cloth_links": (
        """
        links = set()
        for a in range(rows * cols):
            for b in range(a):
                di, dj = abs(a // cols - b // cols), abs(a % cols - b % cols)
                if (di, dj) in ((0, 1), (1, 0), (1, 1), (0, 2), (2, 0)):
                    links.add((a, b))
        return links""",
        """
        n = np.arange(rows * cols).reshape(rows, cols)
        pairs = [(n[:, :-1], n[:, 1:]), (n[:-1], n[1:]), (n[:-1, :-1], n[1:, 1:]), (n[1:, :-1], n[:-1, 1:]),
                 (n[:, 2:], n[:, :-2]), (n[2:], n[:-2])]
        return np.vstack([np.stack((a.ravel(), b.ravel()), axis=1) for a, b in pairs])""",
    ),
    "cloth_forces": (
        """
        F = [[0.0] * 3 for _ in x]
        for n in range(len(links)):
            i, j = int(links[n][0]), int(links[n][1])
            r = [x[j][c] - x[i][c] for c in range(3)]
            l = sum(c * c for c in r) ** 0.5
            for c in range(3):
                f = stiffness * (l - rest_lengths[n]) * r[c] / l - damping * (v[i][c] - v[j][c])
                F[i][c] += f
                F[j][c] -= f
        return F""",
        """
        i, j = links.T
        r = x[j] - x[i]
        f = (stiffness * (1 - rest_lengths / np.sqrt(np.einsum("ij,ij->i", r, r)))) * r.T + damping * (v[j] - v[i]).T
        F = np.zeros_like(x)
        np.add.at(F, i, f.T)
        np.subtract.at(F, j, f.T)
        return F""",
    ),
    "net_buoyancy": (
        """
        weight = body_density * volume * gravity
        lift = fluid_density * volume * gravity
        return lift - weight""",
        "return volume * gravity * -(body_density - fluid_density)",
    ),
    "extra_draft": (
        """
        carried = oil_thickness * oil_density / water_density
        return oil_thickness - carried""",
        "return (water_density - oil_density) / water_density * oil_thickness",
    ),
    "draft": (
        """
        D = body_density * height / oil_density
        if D > oil_thickness:
            D = (body_density * height + (water_density - oil_density) * oil_thickness) / water_density
        return D""",
        """
        low, high = 0.0, 10 * height
        for _ in range(80):
            D = (low + high) / 2
            lift = oil_density * min(D, oil_thickness) + water_density * max(D - oil_thickness, 0)
            low, high = (D, high) if lift < body_density * height else (low, D)
        return D""",
    ),
    "surface_colour": (
        """
        import math
        T = math.exp(-2 * absorption * thickness)
        return [T * water_colour[i] + (1 - T) * oil_colour[i] for i in range(3)]""",
        """
        once = np.exp(-absorption * thickness)
        return oil_colour + once * once * (water_colour - oil_colour)""",
    ),
    "mixture_viscosity": (
        """
        import math
        return math.exp(oil_fraction * math.log(oil_viscosity) + (1 - oil_fraction) * math.log(water_viscosity))""",
        "return oil_viscosity ** oil_fraction * water_viscosity ** (1 - oil_fraction)",
    ),
    "wave_decay": (
        """
        import math
        return amplitude / math.exp(2 * viscosity * time * wavenumber * wavenumber)""",
        """
        a = amplitude
        for _ in range(20000):
            a = a - a * 2 * viscosity * wavenumber ** 2 * time / 20000
        return a""",
    ),
    "reflectance": (
        """
        import math
        c = math.cos(angle)
        t = math.sqrt(1 - math.sin(angle) ** 2 / index ** 2)
        rs = (c - index * t) / (c + index * t)
        rp = (index * c - t) / (index * c + t)
        return 0.5 * (rs * rs + rp * rp)""",
        """
        b = np.arcsin(np.sin(angle) / index)
        s = np.sin(angle - b) / np.sin(angle + b)
        p = np.tan(angle - b) / np.tan(angle + b)
        return np.mean([s ** 2, p ** 2]) if angle > 0 else ((index - 1) / (index + 1)) ** 2""",
    ),
    "mesh_volume": (
        """
        V = 0
        for i, j, k in faces:
            a, b, c = vertices[i], vertices[j], vertices[k]
            V += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            V += a[2] * (b[0] * c[1] - b[1] * c[0])
        return V / 6""",
        """
        inside = vertices.mean(axis=0)
        return sum(np.linalg.det(vertices[f] - inside) for f in faces) / 6""",
    ),
    "jet_landing": (
        """
        import math
        z = x[2] - level
        t = (v[2] + math.sqrt(v[2] * v[2] + 2 * gravity * z)) / gravity
        return [x[0] + v[0] * t, x[1] + v[1] * t, level]""",
        """
        t = max(np.roots([-gravity / 2, v[2], x[2] - level]).real)
        return x + v * t + np.array([0, 0, -gravity]) * t ** 2 / 2""",
    ),
    "gravity": (
        """
        G, M, R = 6.674e-11, 5.972e24, 6.371e6
        mass = mass_ratio * M
        density = M / (4 / 3 * np.pi * R ** 3)
        radius = (3 * mass / (4 * np.pi * density)) ** (1 / 3)
        return 9.81 * mass / radius ** 2 / (M / R ** 2)""",
        "return 9.81 * np.cbrt(mass_ratio)",
    ),
    "rain_hit": (
        """
        s = []
        for i in range(len(z0)):
            above, below = z0[i] - level0[i], level1[i] - z1[i]
            s.append(above / (above + below) if above > 0 and below >= 0 else float("inf"))
        return s""",
        """
        a, b = z0 - level0, z1 - level1
        s = np.full(a.shape, np.inf)
        np.divide(a, a - b, out=s, where=(a > 0) & (b <= 0))
        return s""",
    ),
    "spectrum": (
        """
        import math
        k2 = k[0] ** 2 + k[1] ** 2
        if k2 < 1e-12:
            return 0
        w2 = wind[0] ** 2 + wind[1] ** 2
        L = w2 / gravity
        along = (k[0] * wind[0] + k[1] * wind[1]) ** 2 / (k2 * w2)
        return amplitude * math.exp(-1 / (k2 * L * L)) / k2 ** 2 * along""",
        """
        if not k.any():
            return 0.0
        angle = np.arctan2(k[1], k[0]) - np.arctan2(wind[1], wind[0])
        x = np.hypot(*k) * np.hypot(*wind) ** 2 / gravity
        return amplitude * np.exp(-x ** -2) * np.cos(angle) ** 2 / np.hypot(*k) ** 4""",
    ),
    "damping_length": (
        """
        import math
        return math.sqrt(4 * viscosity * time)""",
        "return 2 * viscosity ** 0.5 * time ** 0.5",
    ),
    "dispersion": (
        """
        import math
        w0 = 2 * math.pi / repeat_time
        return calm * int(math.sqrt(gravity * k) / w0) * w0""",
        """
        w0 = 2 * np.pi / repeat_time
        w = np.sqrt(gravity * k)
        return calm * (w - w % w0)""",
    ),
}
