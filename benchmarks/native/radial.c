/* The sum of Gerstner waves as a careful C programmer would write it: the floor for sim/ocean/wave_sum.py. A wave is
   eleven floats: kx, ky [turns/m], phase [turns], then the factors of the eight sums. Built by build.py. */
#include <math.h>

static inline float sine(float q) {
    float s = q * q;
    return q * (6.283185160088972f +
                s * (-41.34165503128634f + s * (81.60100406453265f + s * (-76.5497820808528f + s * 39.53670436428712f))));
}

/* Pointers are parameters of their own: gcc forgets `restrict` on locals and then gives up vectorising. */
static void add_pair(int count, const float *p, const float *restrict x, const float *restrict y, float *restrict z,
                     float *restrict X, float *restrict Y, float *restrict hx, float *restrict hy, float *restrict xx,
                     float *restrict yy, float *restrict xy) {
    const float k0 = p[0], l0 = p[1], p0 = p[2], a0 = p[3], b0 = p[4], c0 = p[5], d0 = p[6], e0 = p[7], f0 = p[8],
                g0 = p[9], h0 = p[10], k1 = p[11], l1 = p[12], p1 = p[13], a1 = p[14], b1 = p[15], c1 = p[16],
                d1 = p[17], e1 = p[18], f1 = p[19], g1 = p[20], h1 = p[21];
    for (int i = 0; i < count; i++) {
        float t = k0 * x[i] + l0 * y[i] + p0;
        t -= rintf(t);
        float u = fabsf(t) - 0.25f, cos0 = -sine(u), sin0 = copysignf(sine(0.25f - fabsf(u)), t);
        t = k1 * x[i] + l1 * y[i] + p1;
        t -= rintf(t);
        u = fabsf(t) - 0.25f;
        float cos1 = -sine(u), sin1 = copysignf(sine(0.25f - fabsf(u)), t);
        z[i] += a0 * cos0 + a1 * cos1;
        X[i] += b0 * sin0 + b1 * sin1;
        Y[i] += c0 * sin0 + c1 * sin1;
        hx[i] += d0 * sin0 + d1 * sin1;
        hy[i] += e0 * sin0 + e1 * sin1;
        xx[i] += f0 * cos0 + f1 * cos1;
        yy[i] += g0 * cos0 + g1 * cos1;
        xy[i] += h0 * cos0 + h1 * cos1;
    }
}

void add_waves(int n, int block, int waves, const float *x, const float *y, const float *wave, float *out) {
    for (int first = 0; first < n; first += block) {
        int count = first + block < n ? block : n - first;
        float *o = out + first;
        for (int w = 0; w < waves; w += 2)
            add_pair(count, wave + 11 * w, x + first, y + first, o, o + n, o + 2 * n, o + 3 * n, o + 4 * n, o + 5 * n,
                     o + 6 * n, o + 7 * n);
    }
}
