/* The rope's integrators as a careful C programmer would write them: the floor that the compiled kernels are held to.
   Arrays are (3, n); w is 1/mass, 0 where pinned; f is (3, n + 1). Built by build.py. */
#include <math.h>

static void accelerate(int n, const double *restrict x, const double *restrict v, const double *restrict w,
                       double *restrict f, double *restrict a, double k, double b, double rest, const double *load, double c) {
    const double *X = x, *Y = x + n, *Z = x + 2 * n, *U = v, *V = v + n, *W = v + 2 * n;
    double *restrict fx = f, *restrict fy = f + n + 1, *restrict fz = f + 2 * (n + 1);
    if (b == 0.0)
        for (int j = 0; j < n - 1; j++) {
            double rx = X[j + 1] - X[j], ry = Y[j + 1] - Y[j], rz = Z[j + 1] - Z[j];
            double s = k - k * rest / sqrt(rx * rx + ry * ry + rz * rz + 1e-300);
            fx[j + 1] = s * rx, fy[j + 1] = s * ry, fz[j + 1] = s * rz;
        }
    else
        for (int j = 0; j < n - 1; j++) {
            double rx = X[j + 1] - X[j], ry = Y[j + 1] - Y[j], rz = Z[j + 1] - Z[j];
            double s = k - k * rest / sqrt(rx * rx + ry * ry + rz * rz + 1e-300);
            fx[j + 1] = s * rx + b * (U[j + 1] - U[j]);
            fy[j + 1] = s * ry + b * (V[j + 1] - V[j]);
            fz[j + 1] = s * rz + b * (W[j + 1] - W[j]);
        }
    for (int q = 0; q < 3; q++) {
        const double *restrict ff = f + q * (n + 1), *restrict vv = v + q * n;
        double *restrict aa = a + q * n, mg = load[q];
        for (int j = 0; j < n; j++) aa[j] = w[j] * (ff[j + 1] - ff[j] + mg - c * vv[j]);
    }
}

void rk4(int n, double *restrict x, double *restrict v, const double *restrict w, double *restrict scratch, double k,
         double b, double rest, double gx, double gy, double gz, double c, double mass, double h, int steps) {
    int m = 3 * n;
    double *restrict a1 = scratch, *restrict a2 = a1 + m, *restrict a3 = a2 + m, *restrict a4 = a3 + m;
    double *restrict xs = a4 + m, *restrict vs = xs + m, *restrict f = vs + m;
    double load[3] = {gx, gy, gz};
    (void)mass;
    for (int i = 0; i < m + 3; i++) f[i] = 0;
    for (int s = 0; s < steps; s++) {
        accelerate(n, x, v, w, f, a1, k, b, rest, load, c);
        for (int i = 0; i < m; i++) xs[i] = x[i] + h / 2 * v[i], vs[i] = v[i] + h / 2 * a1[i];
        accelerate(n, xs, vs, w, f, a2, k, b, rest, load, c);
        for (int i = 0; i < m; i++) xs[i] = x[i] + h / 2 * vs[i], vs[i] = v[i] + h / 2 * a2[i];
        accelerate(n, xs, vs, w, f, a3, k, b, rest, load, c);
        for (int i = 0; i < m; i++) xs[i] = x[i] + h * vs[i], vs[i] = v[i] + h * a3[i];
        accelerate(n, xs, vs, w, f, a4, k, b, rest, load, c);
        for (int i = 0; i < m; i++) {
            x[i] += h * (v[i] + h / 6 * (a1[i] + a2[i] + a3[i]));
            v[i] += h / 6 * (a1[i] + a4[i] + 2 * (a2[i] + a3[i]));
        }
    }
}

static void damp_links(int n, int first, double *restrict v, const double *restrict w, double free, double held) {
    double *restrict U = v, *restrict V = v + n, *restrict W = v + 2 * n;
    for (int j = first; j < n - 1; j += 2) {
        double share = w[j] * w[j + 1] > 0 ? free : held;
        double du = share * (U[j + 1] - U[j]), dv = share * (V[j + 1] - V[j]), dw = share * (W[j + 1] - W[j]);
        U[j] += w[j] * du, V[j] += w[j] * dv, W[j] += w[j] * dw;
        U[j + 1] -= w[j + 1] * du, V[j + 1] -= w[j + 1] * dv, W[j + 1] -= w[j + 1] * dw;
    }
}

static void damp_drag(int n, double *restrict v, const double *restrict w, double keep) {
    for (int q = 0; q < 3; q++)
        for (int j = 0; j < n; j++) v[q * n + j] *= w[j] > 0 ? keep : 1.0;
}

static void damp_all(int n, int reverse, double *restrict v, const double *restrict w, double free, double held,
                     double keep) {
    for (int turn = 0; turn < 2; turn++)
        if (turn == reverse) {
            if (free > 0) damp_links(n, reverse, v, w, free, held), damp_links(n, 1 - reverse, v, w, free, held);
        } else if (keep < 1)
            damp_drag(n, v, w, keep);
}

/* Damping that ends a step and that which begins the next, in one pass: links of every second pair from `start` on, then
   the others, drag, and both again, each stage two points behind the one before. */
static void damp_twice(double *restrict v, const double *restrict first, const double *restrict second,
                       const double *restrict keep, int start, int count) {
    double after_one = 0, after_two = 0, after_three = 0;
    for (int k = 0; k < count; k++) {
        int i = start + 2 * k;
        double u = v[i], last = v[i + 1], d = last - u;
        u += first[i] * d, last -= second[i] * d;
        d = u - after_one;
        double q = (after_one + first[i - 1] * d) * keep[i - 1];
        u = (u - second[i - 1] * d) * keep[i];
        d = q - after_two;
        double b = after_two + first[i - 2] * d;
        q -= second[i - 2] * d;
        d = b - after_three;
        v[i - 3] = after_three + first[i - 3] * d, v[i - 2] = b - second[i - 3] * d;
        after_one = last, after_two = u, after_three = q;
    }
}

void leapfrog(int n, double *restrict x, double *restrict v, const double *restrict w, double *restrict scratch, double k,
              double b, double rest, double gx, double gy, double gz, double c, double mass, double h, int steps) {
    const int m = 3 * n, width = n + n % 2, size = 3 * width, pad = 4;
    double *restrict a = scratch, *restrict f = a + m, *restrict y = f + m + 3;
    double *restrict first = y + size + 2 * pad, *restrict second = first + size + 2 * pad;
    double *restrict keep = second + size + 2 * pad;
    double load[3] = {gx, gy, gz}, inv = 1 / mass;
    double free = -expm1(-b * inv * h) / (2 * inv), held = -expm1(-b * inv * h / 2) / inv, left = exp(-c * inv * h / 2);
    for (int i = 0; i < m + 3; i++) f[i] = 0;
    for (int i = 0; i < size + 2 * pad; i++) y[i] = first[i] = second[i] = 0, keep[i] = 1;
    for (int e = 0; e < 3; e++)
        for (int j = 0; j < n; j++) {
            int at = pad + e * width + j;
            if (w[j] > 0) keep[at] = left;
            if (j + 1 < n) {
                double share = w[j] * w[j + 1] > 0 ? free : held;
                first[at] = w[j] * share, second[at] = w[j + 1] * share;
            }
        }
    accelerate(n, x, v, w, f, a, k, 0, rest, load, 0);
    damp_all(n, 0, v, w, free, held, left);
    for (int i = 0; i < m; i++) v[i] += h / 2 * a[i];
    for (int s = 0; s < steps; s++) {
        for (int i = 0; i < m; i++) x[i] += h * v[i];
        accelerate(n, x, v, w, f, a, k, 0, rest, load, 0);
        int reverse = 1 - (s & 1);
        if (s + 1 == steps) {
            for (int i = 0; i < m; i++) v[i] += h / 2 * a[i];
            damp_all(n, reverse, v, w, free, held, left);
            break;
        }
        for (int e = 0; e < 3; e++)
            for (int j = 0; j < n; j++) y[pad + e * width + j] = v[e * n + j] + h / 2 * a[e * n + j];
        if (reverse && c > 0)
            for (int i = 0; i < size + 2 * pad; i++) y[i] *= keep[i];
        damp_twice(y, first, second, keep, reverse ? pad - 1 : pad, size / 2 + 2);
        if (!reverse && c > 0)
            for (int i = 0; i < size + 2 * pad; i++) y[i] *= keep[i];
        for (int e = 0; e < 3; e++)
            for (int j = 0; j < n; j++) v[e * n + j] = y[pad + e * width + j] + h / 2 * a[e * n + j];
    }
}

/* Symplectic Euler; `leapfrog_lagged` takes the same steps. */
void symplectic_euler(int n, double *restrict x, double *restrict v, const double *restrict w, double *restrict scratch,
                      double k, double b, double rest, double gx, double gy, double gz, double c, double mass, double h,
                      int steps) {
    int m = 3 * n;
    double *restrict a = scratch, *restrict f = scratch + m;
    double load[3] = {gx, gy, gz};
    (void)mass;
    for (int i = 0; i < m + 3; i++) f[i] = 0;
    for (int s = 0; s < steps; s++) {
        accelerate(n, x, v, w, f, a, k, b, rest, load, c);
        for (int i = 0; i < m; i++) v[i] += h * a[i], x[i] += h * v[i];
    }
}

/* The forces of a cloth, structural, shear and bend links of n x n particles, each link once: a row's links go into a
   buffer of the last three rows, padded by two zeros to its sides. f is (6, 3, 3, n + 4), k and rest (6,). */
void cloth_forces(int n, const double *restrict x, const double *restrict v, const double *restrict w, double *restrict f,
                  double *restrict a, const double *restrict k, const double *restrict rest, double b, double gx, double gy,
                  double gz, double c, int repeats) {
    const int di[6] = {0, 1, 1, 1, 0, 2}, dj[6] = {1, 0, 1, -1, 2, 0};
    const double load[3] = {gx, gy, gz};
    const int m = n + 4, N = n * n;
    for (int r = 0; r < repeats; r++) {
        for (int i = 0; i < 54 * m; i++) f[i] = 0;
        for (int i = 0; i < n; i++) {
            for (int q = 0; q < 6; q++) {
                double *restrict fx = f + ((q * 3 + i % 3) * 3) * m + 2, *restrict fy = fx + m, *restrict fz = fy + m;
                int first = dj[q] < 0 ? -dj[q] : 0, count = n - (dj[q] < 0 ? -dj[q] : dj[q]);
                if (i + di[q] >= n) {
                    for (int j = 0; j < n; j++) fx[j] = fy[j] = fz[j] = 0;
                    continue;
                }
                const double *X = x + i * n + first, *Y = X + N, *Z = Y + N, *U = v + i * n + first, *V = U + N, *W = V + N;
                const int to = di[q] * n + dj[q];
                const double kk = k[q], d = k[q] * rest[q];
                fx += first, fy += first, fz += first;
                for (int j = 0; j < count; j++) {
                    double rx = X[j + to] - X[j], ry = Y[j + to] - Y[j], rz = Z[j + to] - Z[j];
                    double s = kk - d / sqrt(rx * rx + ry * ry + rz * rz + 1e-300);
                    fx[j] = s * rx + b * (U[j + to] - U[j]);
                    fy[j] = s * ry + b * (V[j + to] - V[j]);
                    fz[j] = s * rz + b * (W[j + to] - W[j]);
                }
            }
            for (int e = 0; e < 3; e++) {
                const double *F[6], *G[6];
                for (int q = 0; q < 6; q++) {
                    F[q] = f + ((q * 3 + i % 3) * 3 + e) * m + 2;
                    G[q] = f + ((q * 3 + (i - di[q] + 3) % 3) * 3 + e) * m + 2 - dj[q];
                }
                const double *restrict f0 = F[0], *restrict f1 = F[1], *restrict f2 = F[2], *restrict f3 = F[3];
                const double *restrict f4 = F[4], *restrict f5 = F[5], *restrict g0 = G[0], *restrict g1 = G[1];
                const double *restrict g2 = G[2], *restrict g3 = G[3], *restrict g4 = G[4], *restrict g5 = G[5];
                const double *restrict vv = v + e * N + i * n, *restrict ww = w + i * n, mg = load[e];
                double *restrict aa = a + e * N + i * n;
                for (int j = 0; j < n; j++)
                    aa[j] = ww[j] * (mg - c * vv[j] + f0[j] - g0[j] + f1[j] - g1[j] + f2[j] - g2[j] + f3[j] - g3[j]
                                     + f4[j] - g4[j] + f5[j] - g5[j]);
            }
        }
    }
}
