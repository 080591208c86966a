"""Direct solution of block-tridiagonal systems with 3 x 3 blocks: a rope's implicit step in O(points).

Block elimination without pivoting (Golub & Van Loan, 4.5.1), each pivot block as L U; safe where symmetric parts are
positive definite. A block is its nine numbers side by side, row by row: a long system is read as a few streams of
memory, where nine arrays each would be too many for the processor to prefetch.
"""

from sim.jit import kernel


@kernel(inline=True)
def solve_pivot(l10, l20, l21, d0, d1, d2, u01, u02, u12, x, y, z):
    """The solution of L U s = (x, y, z), with the reciprocals d of U's diagonal."""
    y -= l10 * x
    z -= l20 * x + l21 * y
    z *= d2
    y = (y - u12 * z) * d1
    x = (x - u01 * y - u02 * z) * d0
    return x, y, z


@kernel(noalias=True, allocates=False)
def solve_block_tridiagonal(diagonal, beside, u):
    """Solve A u = r in place.

    diagonal: (n, 9), A_jj. beside: (n, 9), A_j,j+1 = A_j+1,j, overwritten by what the way back needs of the way down,
    half of what the factors of the pivots would be; the last is not read. u: (n, 3), r before and the solution after.
    """
    n = u.shape[0]
    # S = A_jj - A_j,j-1 S_j-1^-1 A_j-1,j, the Schur complement of all blocks before
    xx, xy, xz = diagonal[0, 0], diagonal[0, 1], diagonal[0, 2]
    yx, yy, yz = diagonal[0, 3], diagonal[0, 4], diagonal[0, 5]
    zx, zy, zz = diagonal[0, 6], diagonal[0, 7], diagonal[0, 8]
    rx, ry, rz = u[0, 0], u[0, 1], u[0, 2]
    for j in range(n):
        d0 = 1.0 / xx
        l10, l20 = yx * d0, zx * d0
        d1 = 1.0 / (yy - l10 * xy)
        u12 = yz - l10 * xz
        l21 = (zy - l20 * xy) * d1
        d2 = 1.0 / (zz - l20 * xz - l21 * u12)
        u01, u02 = xy, xz
        u[j, 0], u[j, 1], u[j, 2] = solve_pivot(l10, l20, l21, d0, d1, d2, u01, u02, u12, rx, ry, rz)
        if j + 1 == n:
            break
        sx, sy, sz = u[j, 0], u[j, 1], u[j, 2]
        bxx, bxy, bxz = beside[j, 0], beside[j, 1], beside[j, 2]
        byx, byy, byz = beside[j, 3], beside[j, 4], beside[j, 5]
        bzx, bzy, bzz = beside[j, 6], beside[j, 7], beside[j, 8]
        # s = S^-1 r and G = S^-1 B, column by column; S_next = A - B G, r_next = r - B s, and back u = s - G u_next
        gxx, gyx, gzx = solve_pivot(l10, l20, l21, d0, d1, d2, u01, u02, u12, bxx, byx, bzx)
        gxy, gyy, gzy = solve_pivot(l10, l20, l21, d0, d1, d2, u01, u02, u12, bxy, byy, bzy)
        gxz, gyz, gzz = solve_pivot(l10, l20, l21, d0, d1, d2, u01, u02, u12, bxz, byz, bzz)
        beside[j, 0], beside[j, 1], beside[j, 2] = gxx, gxy, gxz
        beside[j, 3], beside[j, 4], beside[j, 5] = gyx, gyy, gyz
        beside[j, 6], beside[j, 7], beside[j, 8] = gzx, gzy, gzz
        xx = diagonal[j + 1, 0] - bxx * gxx - bxy * gyx - bxz * gzx
        xy = diagonal[j + 1, 1] - bxx * gxy - bxy * gyy - bxz * gzy
        xz = diagonal[j + 1, 2] - bxx * gxz - bxy * gyz - bxz * gzz
        yx = diagonal[j + 1, 3] - byx * gxx - byy * gyx - byz * gzx
        yy = diagonal[j + 1, 4] - byx * gxy - byy * gyy - byz * gzy
        yz = diagonal[j + 1, 5] - byx * gxz - byy * gyz - byz * gzz
        zx = diagonal[j + 1, 6] - bzx * gxx - bzy * gyx - bzz * gzx
        zy = diagonal[j + 1, 7] - bzx * gxy - bzy * gyy - bzz * gzy
        zz = diagonal[j + 1, 8] - bzx * gxz - bzy * gyz - bzz * gzz
        rx = u[j + 1, 0] - bxx * sx - bxy * sy - bxz * sz
        ry = u[j + 1, 1] - byx * sx - byy * sy - byz * sz
        rz = u[j + 1, 2] - bzx * sx - bzy * sy - bzz * sz
    for back in range(1, n):
        j = n - 1 - back
        ux, uy, uz = u[j + 1, 0], u[j + 1, 1], u[j + 1, 2]
        u[j, 0] -= beside[j, 0] * ux + beside[j, 1] * uy + beside[j, 2] * uz
        u[j, 1] -= beside[j, 3] * ux + beside[j, 4] * uy + beside[j, 5] * uz
        u[j, 2] -= beside[j, 6] * ux + beside[j, 7] * uy + beside[j, 8] * uz
