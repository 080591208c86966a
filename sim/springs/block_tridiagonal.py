"""Direct solution of symmetric block-tridiagonal systems with 3 x 3 blocks: a rope's implicit step in O(points).

Block elimination without pivoting (Golub & Van Loan, 4.5.1), each pivot block as L D L^T; safe for positive definite
matrices. A symmetric block is its six numbers xx, xy, xz, yy, yz, zz side by side: a long system is read as a few
streams of memory, where six arrays each would be too many for the processor to foresee.
"""

from sim.jit import kernel


@kernel(inline=True)
def solve_block(l10, l20, l21, d0, d1, d2, x, y, z):
    """u of L D L^T u = (x, y, z), with the reciprocals d of D."""
    y -= l10 * x
    z -= l20 * x + l21 * y
    z *= d2
    y = y * d1 - l21 * z
    x = x * d0 - l10 * y - l20 * z
    return x, y, z


@kernel(noalias=True, allocates=False)
def solve_block_tridiagonal(diagonal, beside, u):
    """Solve A u = r in place.

    diagonal: (n, 6), A_jj, overwritten by the factors of its pivots. beside: (n, 6), A_j,j+1 = A_j+1,j, symmetric
    blocks; the last is not read. u: (n, 3), r before and the solution after.
    """
    n = u.shape[0]
    # S = A_jj - A_j,j-1 S_j-1^-1 A_j-1,j, the Schur complement of all blocks before
    sxx, sxy, sxz = diagonal[0, 0], diagonal[0, 1], diagonal[0, 2]
    syy, syz, szz = diagonal[0, 3], diagonal[0, 4], diagonal[0, 5]
    rx, ry, rz = u[0, 0], u[0, 1], u[0, 2]
    for j in range(n):
        d0 = 1.0 / sxx
        l10, l20 = sxy * d0, sxz * d0
        d1 = 1.0 / (syy - l10 * sxy)
        e21 = syz - l20 * sxy
        l21 = e21 * d1
        d2 = 1.0 / (szz - l20 * sxz - l21 * e21)
        diagonal[j, 0], diagonal[j, 1], diagonal[j, 2] = l10, l20, l21
        diagonal[j, 3], diagonal[j, 4], diagonal[j, 5] = d0, d1, d2
        u[j, 0], u[j, 1], u[j, 2] = rx, ry, rz
        if j + 1 == n:
            break
        bxx, bxy, bxz = beside[j, 0], beside[j, 1], beside[j, 2]
        byy, byz, bzz = beside[j, 3], beside[j, 4], beside[j, 5]
        # G = S^-1 B column by column, then S_next = A - B G and r_next = r - G^T r
        gxx, gyx, gzx = solve_block(l10, l20, l21, d0, d1, d2, bxx, bxy, bxz)
        gxy, gyy, gzy = solve_block(l10, l20, l21, d0, d1, d2, bxy, byy, byz)
        gxz, gyz, gzz = solve_block(l10, l20, l21, d0, d1, d2, bxz, byz, bzz)
        sxx = diagonal[j + 1, 0] - bxx * gxx - bxy * gyx - bxz * gzx
        sxy = diagonal[j + 1, 1] - bxx * gxy - bxy * gyy - bxz * gzy
        sxz = diagonal[j + 1, 2] - bxx * gxz - bxy * gyz - bxz * gzz
        syy = diagonal[j + 1, 3] - bxy * gxy - byy * gyy - byz * gzy
        syz = diagonal[j + 1, 4] - bxy * gxz - byy * gyz - byz * gzz
        szz = diagonal[j + 1, 5] - bxz * gxz - byz * gyz - bzz * gzz
        px, py, pz = rx, ry, rz
        rx = u[j + 1, 0] - gxx * px - gyx * py - gzx * pz
        ry = u[j + 1, 1] - gxy * px - gyy * py - gzy * pz
        rz = u[j + 1, 2] - gxz * px - gyz * py - gzz * pz
    ux, uy, uz = 0.0, 0.0, 0.0
    for back in range(n):
        j = n - 1 - back
        rx, ry, rz = u[j, 0], u[j, 1], u[j, 2]
        if back:
            bxx, bxy, bxz = beside[j, 0], beside[j, 1], beside[j, 2]
            byy, byz, bzz = beside[j, 3], beside[j, 4], beside[j, 5]
            rx -= bxx * ux + bxy * uy + bxz * uz
            ry -= bxy * ux + byy * uy + byz * uz
            rz -= bxz * ux + byz * uy + bzz * uz
        ux, uy, uz = solve_block(
            diagonal[j, 0], diagonal[j, 1], diagonal[j, 2], diagonal[j, 3], diagonal[j, 4], diagonal[j, 5], rx, ry, rz
        )
        u[j, 0], u[j, 1], u[j, 2] = ux, uy, uz
