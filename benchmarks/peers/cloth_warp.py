"""The step of the cloth in warp, which reads the types of a kernel from annotations and its source from a file."""

from typing import Any


def make_step(wp: Any) -> Any:
    """A kernel: one symplectic Euler step of each particle, gathered over its twelve links."""

    def step(
        x: wp.array(dtype=wp.vec3d),  # type: ignore[valid-type]
        v: wp.array(dtype=wp.vec3d),  # type: ignore[valid-type]
        w: wp.array(dtype=wp.float64),  # type: ignore[valid-type]
        where: wp.array(dtype=wp.vec2i),  # type: ignore[valid-type]
        what: wp.array(dtype=wp.vec3d),  # type: ignore[valid-type]
        rows: wp.int32,  # type: ignore[valid-type]
        cols: wp.int32,  # type: ignore[valid-type]
        g: wp.vec3d,  # type: ignore[valid-type]
        mass: wp.float64,  # type: ignore[valid-type]
        dt: wp.float64,  # type: ignore[valid-type]
        xn: wp.array(dtype=wp.vec3d),  # type: ignore[valid-type]
        vn: wp.array(dtype=wp.vec3d),  # type: ignore[valid-type]
    ):
        p = wp.tid()
        i = p // cols
        j = p - i * cols
        f = mass * g
        for q in range(12):
            a = i + where[q][0]
            c = j + where[q][1]
            if a >= 0 and a < rows and c >= 0 and c < cols:
                s = a * cols + c
                r = x[s] - x[p]
                link = what[q]
                f = f + (link[1] - link[1] * link[0] / wp.length(r)) * r + link[2] * (v[s] - v[p])
        vn[p] = v[p] + dt * w[p] * f
        xn[p] = x[p] + dt * vn[p]

    return wp.kernel(step)
