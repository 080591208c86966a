/* The rope's integrators as a careful C programmer would write them: the floor that the compiled kernels are held to.
   Arrays are (3, n); w is 1/mass, 0 where pinned; f is (3, n + 1). Built by app/bench/kernels.py. */
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

void leapfrog(int n, double *restrict x, double *restrict v, const double *restrict w, double *restrict scratch, double k,
              double b, double rest, double gx, double gy, double gz, double c, double mass, double h, int steps) {
    int m = 3 * n;
    double *restrict a = scratch, *restrict f = scratch + m;
    double load[3] = {gx, gy, gz}, inv = 1 / mass;
    double free = -expm1(-b * inv * h) / (2 * inv), held = -expm1(-b * inv * h / 2) / inv, keep = exp(-c * inv * h / 2);
    for (int i = 0; i < m + 3; i++) f[i] = 0;
    accelerate(n, x, v, w, f, a, k, 0, rest, load, 0);
    for (int s = 0; s < steps; s++) {
        if (b > 0) damp_links(n, 0, v, w, free, held), damp_links(n, 1, v, w, free, held);
        if (c > 0) damp_drag(n, v, w, keep);
        for (int i = 0; i < m; i++) v[i] += h / 2 * a[i];
        for (int i = 0; i < m; i++) x[i] += h * v[i];
        accelerate(n, x, v, w, f, a, k, 0, rest, load, 0);
        for (int i = 0; i < m; i++) v[i] += h / 2 * a[i];
        if (c > 0) damp_drag(n, v, w, keep);
        if (b > 0) damp_links(n, 1, v, w, free, held), damp_links(n, 0, v, w, free, held);
    }
}
