# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact solutions (docs/physics.md 11.3) of phi_t + (f phi (1 - phi))_y = D phi_yy, f constant: kink, Gray-Chugunov, Gray-Thornton.

    haff segregation > tests/oracles/gray_chugunov_exact.csv
"""

import numpy as np

from haff import command


def kink(y, t, f=-1.0, D=0.01, y0=0.2, c=-0.25):
    """Travelling front from (f - c)/f behind to 0 ahead (Christov (6)); 0 <= c/f <= 1."""
    return (c - f) / (2 * f) * (-1 + np.tanh((c - f) * (np.asarray(y) - y0 - c * t) / (2 * D)))


def gray_chugunov(y, t, f, D, L, phi0):
    """Uniform phi0 at t = 0 between walls at -L and L, by Cole-Hopf phi = 1/2 + (D/f) omega_s / omega:

        omega_t = D omega_ss - (f^2/4D) omega, omega(s, 0) = e^(beta s), constant at both walls, s = y + L.

    The parts cancel to e^(-L|f|/D) of their size, so the working precision grows with L|f|/D.
    """
    from mpmath import mp, mpf, cos, cosh, exp, pi, sin, sinh
    with mp.workdps(int(30 + 1.2 * L * abs(f) / D)):
        f, D, l, t, phi0 = mpf(f), mpf(D), 2 * mpf(L), mpf(t), mpf(phi0)
        mu, kappa, beta = abs(f) / (2 * D), f * f / (4 * D), f * (phi0 - mpf(1) / 2) / D
        end, terms = exp(beta * l), []
        for n in range(1, 100000):
            k = n * pi / l
            decay = exp(-(kappa + D * k * k) * t)
            amplitude = 2 * k / l * (1 - (-1) ** n * end) * (1 / (k * k + beta * beta) - 1 / (k * k + mu * mu)) * decay
            terms.append((k, amplitude))
            if n > 5 and k * decay * max(1, end) < mpf(10) ** (5 - mp.dps):
                break
        out = []
        for one in np.atleast_1d(y):
            s = mpf(float(one)) + l / 2
            w = (end * sinh(mu * s) + sinh(mu * (l - s))) / sinh(mu * l)
            slope = mu * (end * cosh(mu * s) - cosh(mu * (l - s))) / sinh(mu * l)
            for k, amplitude in terms:
                w += amplitude * sin(k * s)
                slope += amplitude * k * cos(k * s)
            out.append(mpf(1) / 2 + D / f * slope / w)
        return out


def gray_thornton_uniform(y, t, L, phi0, f=-1.0):
    """D = 0, uniform phi0, f < 0: shocks phi0|0 from the top at speed (1 - phi0) f, 1|phi0 from the bottom at -phi0 f;
    they meet at t = 2L/|f| and leave 1 below, 0 above."""
    y = np.asarray(y, float)
    low, high = -L + phi0 * abs(f) * t, L - (1 - phi0) * abs(f) * t
    if low >= high:
        low = high = -L + 2 * L * phi0
    return np.where(y < low, 1.0, np.where(y > high, 0.0, phi0))


def chute_height(phi0, percolation):
    """Bagnold's flow 1 - (1 - s)^1.5, 0 <= s <= 1, carries in a mixture phi0, in which small grains percolate along the flow,
    too, at a speed in units of the flow's at the surface; where all small grains run below the large ones, they reach up to
    the s below which as much runs as small grains come in."""
    low, high, enter = 0.0, 1.0, 0.6 * phi0 + percolation * phi0 * (1 - phi0)
    while high - low > 1e-15:
        s = (low + high) / 2
        low, high = (s, high) if s - 0.4 * (1 - (1 - s) ** 2.5) < enter else (low, s)
    return low


def main():
    command.parser(__doc__).parse_args()
    from mpmath import nstr
    print("D_r,t,y,phi(f=-1;D=D_r;L=0.5;phi0=0.55)")
    y = np.arange(-80, 81) / 160
    for ratio in (0.5, 0.1, 0.02, 0.002):
        for t in (0.1, 0.5, 1, 2):
            for one, phi in zip(y, gray_chugunov(y, t, -1.0, ratio, 0.5, 0.55)):
                print(f"{ratio:g},{t:g},{one:.5f},{nstr(phi, 18)}")


if __name__ == "__main__":
    main()
