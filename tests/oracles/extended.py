#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes extended.csv: extended kinetic theory of sheared spheres, for tests/libcore/models/test_extended.c.

    tests/oracles/extended.py > tests/oracles/extended.csv
    tests/oracles/extended.py arrest > tests/oracles/arrest.csv

The functions are those of the papers, not those of the C code (Jenkins & Berzi 2010, Berzi & Vescovi 2015, Vescovi et al. 2014, Chialvo
& Sundaresan 2013), with 40 digits. Units: density and diameter of a grain; T per unit mass. G = nu g0:

    p = f1 T,  s = f2 sqrt(T) y,  Gamma = f3 T^(3/2)/L,  q = -f4 sqrt(T) dT/dx       y: shear rate
    f1 = nu (1 + 2 (1 + e) G),  f2 = 8 J nu G/(5 sqrt pi),  f3 = 12 (1 - e'^2) nu G/sqrt pi,  f4 = 4 M nu G/sqrt pi

A row has e, friction mu_p, nu_s, nu; G and nu dG/dnu; f1, f2, f3, f4; f0 of Berzi & Vescovi, f0 of Jenkins with c = 0.5; and steady
homogeneous shear by Berzi & Vescovi's f0: L, T/y^2, p/y^2, s/p. There s y = Gamma, which gives L = S whatever f2 is.

arrest.csv: a uniform cell of e 0.7, mu_p 0.5 under constant p = 1 and s, from T = 0.02, by (3/2) nu dT/dt = s y - Gamma with y = s/(f2
sqrt T) and nu of p: the time until T = 1e-10, by quadrature of dT over its rate; or, where s/p is above the yield ratio, 0 and the T
that stays."""
import sys

from mpmath import diff, exp, findroot, log, mp, mpf, pi, quad, sqrt

mp.dps = 40
PACKINGS = {"0": "0.636", "0.1": "0.613", "0.3": "0.587", "0.5": "0.581", "1": "0.573"}


def g0(nu, nus):
    fluid = (2 - nu) / (2 * (1 - nu)**3)
    if nu < mpf("0.4"):
        return fluid
    f = (nu**2 - mpf("0.8") * nu + nus * (mpf("0.8") - nus)) / (mpf("0.8") * nus - mpf("0.16") - nus**2)
    return f * fluid + (1 - f) * 2 / (nus - nu)


def row(e, mu, nus, nu):
    G = nu * g0(nu, nus)
    steep = nu * diff(lambda x: x * g0(x, nus), nu, h=mpf(10)**-15)
    lost = e - mpf(3) / 2 * mu * exp(-3 * mu)
    J = (1 + e) / 2 + pi / 32 * (5 + 2 * (1 + e) * (3 * e - 1) * G) * (5 + 4 * (1 + e) * G) / ((24 - 6 * (1 - e)**2 - 5 * (1 - e**2)) * G**2)
    M = (1 + e) / 2 + 9 * pi / (144 * (1 + e) * G**2) * (5 + 3 * G * (2 * e - 1) * (1 + e)**2) * (5 + 6 * G * (1 + e)) / (16 - 7 * (1 - e))
    f1, f2 = nu * (1 + 2 * (1 + e) * G), 8 * J * nu * G / (5 * sqrt(pi))
    f3, f4 = 12 / sqrt(pi) * (1 - lost**2) * nu * G, 4 * M * nu * G / sqrt(pi)
    S = 1 + 26 * (1 - lost) / 15 * max((nu - mpf("0.49")) / (mpf("0.64") - nu), 0)
    T = f2 * S / f3
    return G, steep, f1, f2, f3, f4, S**(mpf(3) / 2) * sqrt(f2 / f3), G**(mpf(1) / 3) / 4, S, T, f1 * T, f2 / (f1 * sqrt(T))


def rate(s, lnT):
    """d ln T/dt of the cell under p = 1."""
    T, e, mu, nus = exp(lnT), mpf("0.7"), mpf("0.5"), mpf("0.581")
    low, high = mpf("0.001"), nus
    for _ in range(100):
        nu = (low + high) / 2
        low, high = (nu, high) if nu * (1 + 2 * (1 + e) * nu * g0(nu, nus)) * T < 1 else (low, nu)
    _, _, _, f2, f3, _, f0, *_ = row(e, mu, nus, nu)
    y = s / (f2 * sqrt(T))
    return (s * y - f3 * T**mpf("1.5") / max(1, f0 * y / sqrt(T))) / (mpf("1.5") * nu * T)


def main():
    if sys.argv[1:] == ["arrest"]:
        mp.dps = 20
        print("s/p,time,T")
        for s in ("0.1", "0.2", "0.3", "0.4"):
            ends = [log(mpf(10)) * k for k in (-10, -8, -6, -5, -4, -3, -2.5)] + [log(mpf("0.02"))]
            print(f"{s},{mp.nstr(quad(lambda x: -1 / rate(mpf(s), x), ends, maxdegree=6), 8)},1e-10")
        for s in ("0.45", "0.5"):
            x = findroot(lambda x: rate(mpf(s), x), (log(mpf("1e-3")), log(mpf("0.5"))), solver="anderson", tol=1e-12)
            print(f"{s},0,{mp.nstr(exp(x), 10)}")
        return
    print("e,mu_p,nu_s,nu,G,steep,f1,f2,f3,f4,f0_BerziVescovi,f0_Jenkins,L,T,p,s/p")
    for e in ("0.5", "0.7", "0.9"):
        for mu, nus in PACKINGS.items():
            for nu in ("0.01", "0.2", "0.3", "0.395", "0.42", "0.48", "0.5", "0.55", "0.57", "0.6"):
                if mpf(nu) < mpf(nus):
                    print(",".join([e, mu, nus, nu, *(mp.nstr(v, 18) for v in row(mpf(e), mpf(mu), mpf(nus), mpf(nu)))]))


main()
