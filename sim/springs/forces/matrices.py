"""The matrices of forces: parts of the tangent, and the blocks of an implicit step.

About a state the free points obey M u'' + D u' + K u = 0. A part of the tangent is one of these matrices. A block of an
implicit step's matrix, M + g D + g^2 K, is the six numbers xx, xy, xz, yy, yz, zz; number e of point j is at j + e n.
"""

from sim.jit import kernel

STIFFNESS = 0  # K
DAMPING = 1  # D
TRANSVERSE = 2  # the part of K across the links, which axial damping does not reach
FRICTION = 3  # M over what slides along floor or sphere: h D of friction that stops a point within a step
STIFFEST = 4  # K of links that are as stiff as any may soon be


@kernel(inline=True)
def add_block(blocks, j, n, along, across, nx, ny, nz):
    """Block j += across I + (along - across) n n^T."""
    s = along - across
    blocks[j] += across + s * nx * nx
    blocks[j + n] += s * nx * ny
    blocks[j + 2 * n] += s * nx * nz
    blocks[j + 3 * n] += across + s * ny * ny
    blocks[j + 4 * n] += s * ny * nz
    blocks[j + 5 * n] += across + s * nz * nz


@kernel(inline=True)
def add_product(out, u, j, n, along, across, nx, ny, nz):
    """Point j of out += [along n n^T + across (I - n n^T)] u."""
    s = (along - across) * (u[j] * nx + u[n + j] * ny + u[2 * n + j] * nz)
    out[j] += across * u[j] + s * nx
    out[n + j] += across * u[n + j] + s * ny
    out[2 * n + j] += across * u[2 * n + j] + s * nz
