"""Right solutions in another hand: for each task one with another formula than the reference's."""

RIGHT: dict[str, str] = {
    "line_tension": """
        import math
        level = weight * (hanging * hanging - height * height) / 2 / height
        return math.hypot(level, weight * hanging)""",
    "spring_force": """
        r = x1 - x2
        return -stiffness * (1 - rest_length / np.sqrt(r @ r)) * r + damping * (v2 - v1)""",
    "rope_acceleration": """
        r = np.diff(x, axis=0)
        f = stiffness * (1 - rest_length / np.sqrt((r * r).sum(1)))[:, np.newaxis] * r + damping * np.diff(v, axis=0)
        total = np.concatenate([f, [[0, 0, 0]]]) - np.concatenate([[[0, 0, 0]], f])
        a = (total - drag * v) / mass - gravity * np.array([0, 0, 1])
        a[0] *= 0
        return a""",
    "step_euler": """
        a = acceleration(x, v)
        x = x + h * v
        v = v + h * a
        return x, v""",
    "step_rk4": """
        f = lambda y: np.array([y[1], acceleration(y[0], y[1])])
        y = np.array([x, v])
        k1 = h * f(y)
        k2 = h * f(y + k1 / 2)
        k3 = h * f(y + k2 / 2)
        k4 = h * f(y + k3)
        return y + (k1 + 2 * k2 + 2 * k3 + k4) / 6""",
    "step_leapfrog": """
        a = acceleration(x, v)
        new = x + h * v + h * h / 2 * a
        return new, v + h / 2 * (a + acceleration(new, v))""",
    "sphere_force": """
        n = (x - centre) / np.linalg.norm(x - centre)
        p = radius - n @ (x - centre)
        return (p > 0) * np.maximum(stiffness * p - damping * n @ v, 0) * n""",
    "cloth_links": """
        n = np.arange(rows * cols).reshape(rows, cols)
        pairs = [(n[:, :-1], n[:, 1:]), (n[:-1], n[1:]), (n[:-1, :-1], n[1:, 1:]), (n[1:, :-1], n[:-1, 1:]),
                 (n[:, 2:], n[:, :-2]), (n[2:], n[:-2])]
        return np.vstack([np.stack((a.ravel(), b.ravel()), axis=1) for a, b in pairs])""",
    "cloth_forces": """
        i, j = links.T
        r = x[j] - x[i]
        f = (stiffness * (1 - rest_lengths / np.sqrt(np.einsum("ij,ij->i", r, r)))) * r.T + damping * (v[j] - v[i]).T
        F = np.zeros_like(x)
        np.add.at(F, i, f.T)
        np.subtract.at(F, j, f.T)
        return F""",
    "net_buoyancy": "return volume * gravity * -(body_density - fluid_density)",
    "extra_draft": "return (water_density - oil_density) / water_density * oil_thickness",
    "draft": """
        low, high = 0.0, 10 * height
        for _ in range(80):
            D = (low + high) / 2
            lift = oil_density * min(D, oil_thickness) + water_density * max(D - oil_thickness, 0)
            low, high = (D, high) if lift < body_density * height else (low, D)
        return D""",
    "surface_colour": """
        once = np.exp(-absorption * thickness)
        return oil_colour + once * once * (water_colour - oil_colour)""",
    "mixture_viscosity": "return oil_viscosity ** oil_fraction * water_viscosity ** (1 - oil_fraction)",
    "wave_decay": """
        once = np.exp(-viscosity * wavenumber * wavenumber * time)
        return once * once * amplitude""",
    "reflectance": """
        b = np.arcsin(np.sin(angle) / index)
        s = np.sin(angle - b) / np.sin(angle + b)
        p = np.tan(angle - b) / np.tan(angle + b)
        return np.mean([s ** 2, p ** 2]) if angle > 0 else ((index - 1) / (index + 1)) ** 2""",
    "mesh_volume": """
        inside = vertices.mean(axis=0)
        return sum(np.linalg.det(vertices[f] - inside) for f in faces) / 6""",
    "jet_landing": """
        t = max(np.roots([-gravity / 2, v[2], x[2] - level]).real)
        return x + v * t + np.array([0, 0, -gravity]) * t ** 2 / 2""",
    "gravity": "return 9.81 * np.cbrt(mass_ratio)",
    "rain_hit": """
        a, b = z0 - level0, z1 - level1
        s = np.full(a.shape, np.inf)
        np.divide(a, a - b, out=s, where=(a > 0) & (b <= 0))
        return s""",
    "spectrum": """
        if not k.any():
            return 0.0
        angle = np.arctan2(k[1], k[0]) - np.arctan2(wind[1], wind[0])
        x = np.hypot(*k) * np.hypot(*wind) ** 2 / gravity
        return amplitude * np.exp(-x ** -2) * np.cos(angle) ** 2 / np.hypot(*k) ** 4""",
    "damping_length": "return 2 * viscosity ** 0.5 * time ** 0.5",
    "dispersion": """
        w0 = 2 * np.pi / repeat_time
        w = np.sqrt(gravity * k)
        return calm * (w - w % w0)""",
}
