"""Wrong solutions of the tasks with lines, ropes, cloth and steps, in the form of `wrong_solutions`."""

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
CLOTH_LINKS = """
            n = np.arange(rows * cols).reshape(rows, cols)
            pairs = [
                (n[:, :-1], n[:, 1:]), (n[:-1], n[1:]),
                (n[:-1, :-1], n[1:, 1:]),
                (n[:-1, 1:], n[1:, :-1]),
                (n[:, :-2], n[:, 2:]), (n[:-2], n[2:]),
            ]
            return np.concatenate([np.transpose([a.ravel(), b.ravel()]) for a, b in pairs])"""


def changed(body: str, *texts: str) -> str:
    """The body with each text replaced by the one behind it."""
    for old, new in zip(texts[::2], texts[1::2], strict=True):
        assert old in body
        body = body.replace(old, new)
    return body


SPRINGS: dict[str, tuple[tuple[str, str], ...]] = {
    "line_tension": (
        ("horizontal part only", "return weight * (hanging ** 2 - height ** 2) / (2 * height)"),
        ("weight only", "return weight * hanging"),
        ("hanging not used", "return weight * height"),
        ("parts added", """
            H = weight * (hanging ** 2 - height ** 2) / (2 * height)
            V = weight * hanging
            return H + V"""),
        ("factor 2 forgotten", "return weight / height * (hanging ** 2 + height ** 2)"),
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
        ("damping along the link only", """
            r = x2 - x1
            l = np.linalg.norm(r)
            n = r / l
            return (stiffness * (l - rest_length) - damping * np.dot(v1 - v2, n)) * n"""),
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
        ("force on one end only", changed(ROPE, "\n                F[i] += f", "")),
        ("same force on both ends", changed(ROPE, "F[i + 1] -= f", "F[i + 1] += f")),
        ("sign of the springs reversed", changed(ROPE, "F[i] += f", "F[i] -= f", "F[i + 1] -= f", "F[i + 1] += f")),
        ("multiplied by the mass", changed(ROPE, "F / mass", "F * mass")),
        ("gravity upwards", changed(ROPE, "a[:, 2] -= gravity", "a[:, 2] += gravity")),
        ("gravity multiplied by the mass", changed(ROPE, "a[:, 2] -= gravity", "a[:, 2] -= mass * gravity")),
        ("rest length forgotten", changed(ROPE, "(l - rest_length)", "l")),
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
            x = x.copy()
            for i in range(len(x)):
                x[i] += h * v[i]
            v = v + h * acceleration(x, v)
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
        ("Euler", """
            a = acceleration(x, v)
            return x + h * v, v + h * a"""),
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
        ("force not computed again", """
            a = acceleration(x, v)
            v_half = v + h / 2 * a
            x = x + h * v_half
            return x, v_half + h / 2 * a"""),
        ("Euler", "return x + h * v, v + h * acceleration(x, v)"),
    ),
    "sphere_force": (
        ("only above counts as outside", """
            d = x - centre
            distance = np.linalg.norm(d)
            if x[2] > centre[2] + radius:
                return np.zeros(3)
            n = d / distance
            return max(stiffness * (radius - distance) - damping * np.dot(v, n), 0) * n"""),
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
        ("normal not unit length", changed(SPHERE, "(v @ n), 0) * n", "(v @ n), 0) * d")),
        ("force outside the sphere", """
            d = x - centre
            l = np.linalg.norm(d)
            return stiffness * (radius - l) / l * d"""),
        ("distance instead of depth", changed(SPHERE, "(radius - l)", "l")),
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
        ("one diagonal only", changed(CLOTH_LINKS, "                (n[:-1, :-1], n[1:, 1:]),\n", "")),
        ("no bend links", changed(CLOTH_LINKS, "                (n[:, :-2], n[:, 2:]), (n[:-2], n[2:]),\n", "")),
        ("structural links only", """
            links = []
            for i in range(rows):
                for j in range(cols):
                    if j < cols - 1:
                        links.append((cols * i + j, cols * i + j + 1))
                    if i < rows - 1:
                        links.append((cols * i + j, cols * (i + 1) + j))
            return links"""),
        ("end of a row joined to the next row", """
            links = []
            for i in range(rows):
                for j in range(cols):
                    for di, dj in ((0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)):
                        other = (i + di) * cols + j + dj
                        if i + di < rows and other < rows * cols:
                            links.append((i * cols + j, other))
            return links"""),
        ("start of a row joined to its end", """
            links = []
            for i in range(rows):
                for j in range(cols):
                    for di, dj in ((0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)):
                        if i + di < rows and j + dj < cols:
                            links.append((i * cols + j, (i + di) * cols + j + dj))
            return links"""),
        ("rows and columns swapped", changed(CLOTH_LINKS, ".reshape(rows, cols)", ".reshape(cols, rows).T")),
    ),
    "cloth_forces": (
        ("air drag for the damping of the links", """
            F = -damping * v
            for (i, j), d in zip(links, rest_lengths):
                r = x[j] - x[i]
                l = np.linalg.norm(r)
                F[i] += stiffness * (l - d) * r / l
                F[j] -= stiffness * (l - d) * r / l
            return F"""),
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
        ("force on one end only", """
            F = np.zeros((len(x), 3))
            for n, (i, j) in enumerate(links):
                r = x[i] - x[j]
                l = np.sqrt(r @ r)
                F[j] += stiffness * (l - rest_lengths[n]) * r / l - damping * (v[j] - v[i])
            return F"""),
        ("same force on both ends", """
            F = np.zeros_like(x)
            for (i, j), d in zip(links, rest_lengths):
                r = x[j] - x[i]
                l = np.linalg.norm(r)
                f = stiffness * (l - d) * r / l - damping * (v[i] - v[j])
                F[i] += f
                F[j] += f
            return F"""),
        ("damping on absolute velocity", """
            F = np.zeros_like(x)
            for (i, j), d in zip(links, rest_lengths):
                r = x[j] - x[i]
                l = np.linalg.norm(r)
                f = stiffness * (l - d) * r / l - damping * v[i]
                F[i] += f
                F[j] -= f
            return F"""),
        ("damping on absolute velocity", """
            F = np.zeros_like(x)
            for (i, j), d in zip(links, rest_lengths):
                r = x[j] - x[i]
                l = np.linalg.norm(r)
                f = stiffness * (l - d) * r / l
                F[i] += f - damping * v[i]
                F[j] -= f + damping * v[j]
            return F"""),
    ),
}  # fmt: skip
