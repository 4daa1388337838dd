#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes reconstruct.csv: right-face values of every reconstruction of libcore/schemes, for tests/libcore/schemes/test_reconstruct.c.

    tests/oracles/reconstruct.py > tests/oracles/reconstruct.csv

A row holds five cell averages a, b, c, d, e (doubles, printed so that they read back to the bit) and the value at the face between c
and d by each scheme, computed with 60 digits from the formulas as they are published, not from those of the C code:

PHM     the hyperbola of Marquina (1994), SIAM J. Sci. Comput. 15: of the two differences l, r of the cell, of one sign,
        d = 2 l r/(l + r), s = 2 (sqrt(d/l) - 1) if |l| <= |r|, else 2 (1 - sqrt(d/r));
        c + d (1/(s (1 - s/2)) - ln((2 + s)/(2 - s))/s^2); of other differences c.
WPENO5  Weighted PowerENO5 of Serna & Marquina (2004), J. Comput. Phys. 194: the second differences of the outer parabolas are
        replaced by power_3(x, y) = (x + y)/2 (1 - |(x - y)/(x + y)|^3) of two neighbours of one sign, else 0; linear weights 1/5,
        1/5, 3/5.
WENO5   Jiang & Shu (1996), J. Comput. Phys. 126: linear weights 1/10, 6/10, 3/10 over (epsilon + smoothness)^2.
WENOZ   Borges et al. (2008), J. Comput. Phys. 227: linear weights times 1 + (tau/(epsilon + smoothness))^2, tau = |b0 - b2|.
TENO5   Fu, Hu & Adams (2016), J. Comput. Phys. 305: gamma = (1 + tau/(epsilon + smoothness))^6; a parabola counts with its linear
        weight where gamma over the sum of the three is at least C_T = 1e-5, else not at all.

All take epsilon = 1e-6 times the mean square of the five averages (plus 1e-40), so that the weights do not depend on units: that is
the one choice of the C code that the table shares. The stencils are smooth, kinked, torn at each place, have extrema and changes of
sign, tiny differences on a large mean and large ones beside tiny ones; for TENO5 each parabola lies once on each side of the cut-off,
by a factor of less than 1.2, and once each between 1e-5 and 1e-4 and between 1e-6 and 1e-5, which the script checks.
"""
import math
import random
from decimal import Decimal as D, getcontext

getcontext().prec = 60
CUT = D("1e-5")


def epsilon(q):
    return D("1e-6") * sum(v * v for v in q) / 5 + D("1e-40")


def phm(a, b, c, d, e):
    left, right = c - b, d - c
    if left * right <= 0:
        return c
    mean = 2 * left * right / (left + right)
    s = 2 * ((mean / left).sqrt() - 1) if abs(left) <= abs(right) else 2 * (1 - (mean / right).sqrt())
    if s == 0:
        return c + mean / 2
    return c + mean * (1 / (s * (1 - s / 2)) - ((2 + s) / (2 - s)).ln() / (s * s))


def power3(x, y):
    return (x + y) / 2 * (1 - abs((x - y) / (x + y)) ** 3) if x * y > 0 else D(0)


def wpeno5(a, b, c, d, e):
    middle = b - 2 * c + d
    left, right = power3(a - 2 * b + c, middle), power3(middle, c - 2 * d + e)
    values = (c + (c - b) / 2 + left / 3, (-b + 5 * c + 2 * d) / 6, (c + d) / 2 - right / 6)
    slopes = (c - b + left / 2, (d - b) / 2, d - c - right / 2)
    rough = [D(13) / 12 * P * P + s * s for P, s in zip((left, middle, right), slopes)]
    weights = [D(w) / 5 / (epsilon((a, b, c, d, e)) + r) ** 2 for w, r in zip((1, 1, 3), rough)]
    return sum(w * v for w, v in zip(weights, values)) / sum(weights)


LINEAR = (D(1) / 10, D(6) / 10, D(3) / 10)


def parabolas(a, b, c, d, e):
    """Face values and smoothness of the three parabolas."""
    values = ((2 * a - 7 * b + 11 * c) / 6, (-b + 5 * c + 2 * d) / 6, (2 * c + 5 * d - e) / 6)
    bends = (a - 2 * b + c, b - 2 * c + d, c - 2 * d + e)
    slopes = (a - 4 * b + 3 * c, b - d, 3 * c - 4 * d + e)
    return values, [D(13) / 12 * x * x + y * y / 4 for x, y in zip(bends, slopes)]


def mean_of(values, weights):
    return sum(w * v for w, v in zip(weights, values)) / sum(weights)


def weno5(*q):
    values, rough = parabolas(*q)
    return mean_of(values, [w / (epsilon(q) + b) ** 2 for w, b in zip(LINEAR, rough)])


def wenoz(*q):
    values, rough = parabolas(*q)
    tau = abs(rough[0] - rough[2])
    return mean_of(values, [w * (1 + (tau / (epsilon(q) + b)) ** 2) for w, b in zip(LINEAR, rough)])


def shares(q):
    """What TENO5 compares with its cut-off."""
    rough = parabolas(*q)[1]
    tau = abs(rough[0] - rough[2])
    gamma = [(1 + tau / (epsilon(q) + b)) ** 6 for b in rough]
    return [g / sum(gamma) for g in gamma]


def teno5(*q):
    return mean_of(parabolas(*q)[0], [w if s >= CUT else D(0) for w, s in zip(LINEAR, shares(q))])


SCHEMES = {"PHM": phm, "WPENO5": wpeno5, "WENO5": weno5, "WENOZ": wenoz, "TENO5": teno5}


def cell_averages(primitive, h, x):
    """Of the derivative of `primitive`, in five cells of width h of which the third ends at x."""
    return [(primitive(x + (j - 2) * h) - primitive(x + (j - 3) * h)) / h for j in range(5)]


def near_the_cut(which, low, high):
    """A stencil of which parabola `which` has a share between low and high, the others none within a factor of two of the cut-off."""
    draw = random.Random(f"{which} {low} {high}")
    while True:
        q = [draw.uniform(-1, 1) for _ in range(5)]
        found = shares([D(v) for v in q])
        rest = [s for k, s in enumerate(found) if k != which]
        if low < found[which] < high and all(s > 2 * CUT or s < CUT / 2 for s in rest):
            return q


def stencils():
    for x in (0.3, 1.1, math.pi / 2 - 0.02, 2.4):  # the third one has an extremum
        for h in (0.02, 0.3):
            yield f"smooth h {h}", cell_averages(lambda t: -math.cos(t), h, x)
    yield "parabola", [4.0, 1.0, 0.0, 1.0, 4.0]
    yield "beside its vertex", [9.25, 4.25, 1.25, 0.25, 1.25]
    yield "cubic", [-8.0, -1.0, 0.0, 1.0, 8.0]
    yield "line", [1.0, 2.0, 3.0, 4.0, 5.0]
    yield "line through 0", [-0.2, -0.1, 0.0, 0.1, 0.2]
    for k in range(1, 5):
        yield f"jump behind cell {k}", [1.0] * k + [3.5] * (5 - k)
        yield f"kink at cell {k}", [0.5 * max(0, i - k + 1) for i in range(5)]
        yield f"jump behind cell {k} of waves", [math.sin(0.4 * i) + (20 if i >= k else 0) for i in range(5)]
        yield f"change of sign behind cell {k}", [(-1.0 if i < k else 1.0) * (1 + 0.1 * i) for i in range(5)]
    yield "maximum", [1.0, 2.0, 3.5, 2.25, 0.5]
    yield "minimum", [1.0, -2.0, -3.0, -2.25, 0.5]
    yield "zigzag", [1.0, -1.0, 1.0, -1.0, 1.0]
    yield "step up", [0.0, 0.0, 1.0, 2.0, 2.0]
    yield "steep to the right", [1.0, 1.1, 1.2, 9.0, 90.0]
    yield "steep to the left", [-90.0, -9.0, 1.2, 1.3, 1.35]
    for size in (2.0**-30, 2.0**-20, 2.0**-10):  # exact sums
        yield f"differences of {size:.0e} on 3", [3 + size * v for v in (0.0, 1.0, 4.0, 6.0, 6.5)]
    for scale in (1e-12, 1e12):
        yield f"all times {scale:.0e}", [scale * v for v in (0.3, -1.7, 2.9, 3.1, 8.8)]
    yield "huge beside tiny", [1e-9, 3e-9, 2e-8, 1e7, 4e7]
    yield "tiny beside huge", [4e7, 1e7, 2e-8, 3e-9, 1e-9]
    for which in range(3):
        for low, high in (("1e-5", "1.2e-5"), ("0.84e-5", "1e-5"), ("1e-5", "1e-4"), ("1e-6", "1e-5")):
            yield f"parabola {which} of TENO5 between {low} and {high}", near_the_cut(which, D(low), D(high))
    draw = random.Random(5)
    for k in range(20):
        yield f"random {k}", [draw.uniform(-1, 1) * 10 ** draw.uniform(-2, 2) for _ in range(5)]


def main():
    print("stencil,a,b,c,d,e," + ",".join(SCHEMES))
    for name, q in stencils():
        exact = [D(v) for v in q]
        values = (scheme(*exact) for scheme in SCHEMES.values())
        print(",".join([name] + [repr(v) for v in q] + [f"{v:.20e}" for v in values]))


if __name__ == "__main__":
    main()
