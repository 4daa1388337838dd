#include "libcore/models/source.h"

#define PI 3.14159265358979323846

bool source_cools(const struct sources *s, const struct material *m) {
    return s->cooling && m->restitution < 1 && m->diameter > 0;
}

bool source_active(const struct sources *s, const struct material *m) {
    bool falls = s->gravity[0] != 0 || s->gravity[1] != 0 || s->gravity[2] != 0;
    return falls || source_cools(s, m);
}

bool source_shaken(const struct sources *s) {
    for (int i = 0; i < s->knots; i++)
        if (s->ramp[2 * i + 1] != 0) return true;
    return s->knots == 0 && s->amplitude != 0;
}

/* Integral of cos(omega t + phase) from t to t + dt */
static double swing(const struct sources *s, double t, double dt) {
    double omega = 2 * PI * s->frequency;
    return omega > 0 ? (sin(omega * (t + dt) + s->phase) - sin(omega * t + s->phase)) / omega : dt * cos(s->phase);
}

/* Of (a + slope (t' - t)) cos(omega t' + phase) from t to t + dt: by parts, the rest being the integral of the sine */
static double sloping_swing(const struct sources *s, double t, double dt, double a, double slope) {
    double omega = 2 * PI * s->frequency, end = omega * (t + dt) + s->phase;
    if (!(omega > 0)) return (a + 0.5 * slope * dt) * dt * cos(s->phase);
    double rest = (cos(end) - cos(omega * t + s->phase)) / omega;
    return a * swing(s, t, dt) + slope * (dt * sin(end) + rest) / omega;
}

/* The same of the ramp, knot by knot */
static double ramped_swing(const struct sources *s, double t, double dt) {
    const double(*knot)[2] = (const double(*)[2])s->ramp;
    const int last = s->knots - 1;
    double sum = 0, end = t + dt, from = t;
    for (int i = -1; i <= last && from < end; i++) { /* piece i: between knots i and i + 1 */
        const double *low = knot[i < 0 ? 0 : i], *high = knot[i < last ? i + 1 : last];
        if (i < last && high[0] <= from) continue;
        double to = i < last && high[0] < end ? high[0] : end;
        double slope = high[0] > low[0] ? (high[1] - low[1]) / (high[0] - low[0]) : 0;
        sum += sloping_swing(s, from, to - from, low[1] + slope * (from - low[0]), slope);
        from = to;
    }
    return sum;
}

void source_kick(const struct sources *s, double t, double dt, double kick[MAX_DIM]) {
    double time = dt;
    if (s->knots > 0)
        time += ramped_swing(s, t, dt);
    else if (s->amplitude != 0)
        time += s->amplitude * swing(s, t, dt);
    for (int k = 0; k < MAX_DIM; k++) kick[k] = s->gravity[k] * time;
}

/* eps after dt of dT/dt = -B T^(3/2), T = (gamma - 1) eps: physics 1.1, exact for frozen rho */
KERNEL static void cool(int n, double g1, double per_contact, double dt, const double *restrict contact,
                        double *restrict eps) {
    for (int i = 0; i < n; i++) {
        double root = sqrt(g1 * eps[i]);
        double slow = 1 + 0.5 * dt * (per_contact * contact[i]) * root;
        eps[i] = eps[i] / (slow * slow);
    }
}

/* The same for dT/dt = -B T^(3/2) (1 + x) e^-x, x = v_c^2 / (4 T). With s = sqrt x and tau = B v_c dt this is
 *   ds/dtau = (1 + x) e^-x / 4:  Haff's straight line at first, then a logarithm.
 * w = sqrt(2 (e^2x - 1)) follows both, dw/dtau = r/2 with r = 2 s (1 + x)/sqrt(2 (1 - e^-2x)), which is 1 at x = 0 and
 * grows no faster than s^3; one midpoint step in w is of second order, keeps T positive and falling, stops it where
 * e^-x leaves nothing, and is sensible for a step of any length. The kernel works with w e^-x0, which cannot
 * overflow, and gains x1 - x0 = ln(1 + e^-2x0 (w1^2 - w0^2)/2)/2 without a difference of close numbers. */
ALWAYS_INLINE double scaled_w(double x) {
    return sqrt(-2 * exponential_minus_one(-2 * smaller(x, 300))); /* e^-600: nothing */
}
ALWAYS_INLINE double speed_of_w(double x) {
    return 2 * sqrt(x) * (1 + x) / scaled_w(x);
}
ALWAYS_INLINE double gain_of_x(double w, double step) {
    return 0.5 * logarithm_plus_one(0.5 * step * (2 * w + step));
}

KERNEL static void cool_above(int n, double g1, double per_contact, double threshold, double dt,
                              const double *restrict contact, double *restrict eps) {
    for (int i = 0; i < n; i++) {
        double T = g1 * eps[i], x = 0.25 * threshold * threshold / T;
        x = smaller(larger(x, 1e-200), 1e100); /* neither 0/0 nor an overflow, and no other result */
        double w = scaled_w(x);
        double path = dt * (per_contact * contact[i]) * sqrt(T * x) * exponential(-smaller(x, 300)); /* tau e^-x / 2 */
        double middle = x + gain_of_x(w, 0.5 * path * speed_of_w(x));
        eps[i] *= x / (x + gain_of_x(w, path * speed_of_w(middle)));
    }
}

KERNEL static void internal_energy(int n, int dim, double *const U[MAX_VAR], double *restrict eps) {
    const double *restrict rho = U[0], *restrict E = U[dim + 1];
    for (int i = 0; i < n; i++) eps[i] = 0;
    for (int k = dim; k >= 1; k--) {
        const double *restrict mom = U[k];
        for (int i = 0; i < n; i++) eps[i] += mom[i] * mom[i];
    }
    for (int i = 0; i < n; i++) {
        double inverse = 1 / rho[i];
        eps[i] = (E[i] - 0.5 * eps[i] * inverse) * inverse;
    }
}

KERNEL static void kick_momentum(int n, double kick, const double *restrict rho, double *restrict mom) {
    for (int i = 0; i < n; i++) mom[i] += rho[i] * kick;
}

KERNEL static void total_energy(int n, int dim, double *const U[MAX_VAR], const double *restrict eps) {
    const double *restrict rho = U[0];
    double *restrict E = U[dim + 1];
    for (int i = 0; i < n; i++) E[i] = 0;
    for (int k = dim; k >= 1; k--) {
        const double *restrict mom = U[k];
        for (int i = 0; i < n; i++) E[i] += mom[i] * mom[i];
    }
    for (int i = 0; i < n; i++) E[i] = rho[i] * eps[i] + 0.5 * E[i] / rho[i];
}

void source_apply(const struct sources *s, const struct eos *eos, const struct material *m, int n, int dim, double dt,
                  const double kick[MAX_DIM], double *const U[MAX_VAR]) {
    double e[BATCH], contact[BATCH];
    internal_energy(n, dim, U, e);
    if (source_cools(s, m)) {
        double loss = cooling_factor(m) * (1 - m->restitution * m->restitution) / m->diameter;
        eos->contact(m, n, U[0], contact);
        double g1 = m->gamma - 1;
        if (m->threshold > 0)
            cool_above(n, g1, g1 * loss, m->threshold, dt, contact, e);
        else
            cool(n, g1, g1 * loss, dt, contact, e);
    }
    for (int k = 0; k < dim; k++)
        if (kick[k] != 0) kick_momentum(n, kick[k], U[0], U[k + 1]);
    total_energy(n, dim, U, e);
}
