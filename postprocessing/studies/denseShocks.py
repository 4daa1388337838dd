# SPDX-License-Identifier: GPL-3.0-or-later
"""Dense gas and strong shocks against exact Riemann solutions: what the rules of single faces of the flux `common` change.

    haff denseShocks [-out FILE.md] [-quick] [-problem NAME]    tables on stdout, or in the file

Every problem is run by granularGas with its defaults (common, WPENO5, SSPRK43, maxCo 1) twice: with the rules, which is the
default on lattices (`on`, `commonCoeffs { shocks on; expansions on; contacts on; }`), and without. On polyhedra, maxCo is 2;
gmsh makes them.
"""
import sys
import tempfile

import numpy as np

from haff import command
from studies.denseMeshes import Ball, Body, Strip
from studies.denseTubes import BURSTS, Cooled, Slant, Standing, Tube, burst, contact, drifting_burst, head_on, others, randoms
from studies.exact.eos import GoldshteinShapiro, PerfectGas, TorquatoSpheres
from studies.measured.shocks import billig
from studies.source import measured_by


def per_mille(errors):
    return " ".join(f"{1e3 * e:.2f}" for e in errors)


def both(show):
    """What `show` says of the run without and with the rules."""
    return " | ".join(show(rules) for rules in (False, True))


def burst_words(tube, n, rules):
    *fields, limited = tube.fields(n, rules)
    cells, high = tube.ahead(n, fields[2])
    return f"{cells:.2f} / {100 * high:.1f} % / {per_mille(tube.errors(n, fields)[:2])}" + (f", {limited} limited" if limited else "")


def contact_words(tube, n, rules):
    _, u, p, _ = tube.fields(n, rules)
    return f"{100 * np.abs(p / 1e4 - 1).max():.1f} % / {np.abs(u - 0.7).max():.2f}"


def noise_words(tube, n, rules):
    *fields, _ = tube.fields(n, rules)
    return "%.1e / %.1e" % tube.noise(n, fields[0]) + f" / {1e3 * tube.errors(n, fields)[0]:.2f}"


def burst_row(tube, n):
    return f"| {tube.name} | {n} | {both(lambda rules: burst_words(tube, n, rules))} |"


def bursts(grids):
    yield "| burst | cells | off: shock ahead in cells / p behind it too high / L1 of rho, u in 1e-3 | on |\n|---|---|---|---|"
    tube = drifting_burst()
    for n in grids:
        yield burst_row(tube, n)
    for drift in (0.0, 0.4, 1.2):
        tube = Tube(f"A at {drift}", (0.4005, drift, 399.0), (0.0032, drift + 0.5613, 1.0), 0.52 - 0.15 * drift, 0.2)
        yield burst_row(tube, 400)
    for problem in BURSTS:
        yield burst_row(burst(*problem), 400)
    yield burst_row(burst(*BURSTS[1], eos=GoldshteinShapiro(0.9), name=", e = 0.9 in p alone"), 400)


def contacts(grids):
    yield "| contact J, cells | off: largest error of p / false u at t = 0.001, 0.002, 0.004 | on |\n|---|---|---|"
    for n in grids:
        yield f"| {n} | {both(lambda rules: ', '.join(contact_words(contact(t), n, rules) for t in (0.001, 0.002, 0.004)))} |"


def noises(grids):
    yield "| head on B, cells | off: noise, mean / largest / L1 of rho in 1e-3 | on |\n|---|---|---|"
    tube = head_on()
    for n in grids:
        yield f"| {n} | {both(lambda rules: noise_words(tube, n, rules))} |"


def singles(n):
    yield f"| {n} cells | off: L1 of rho, u, p in 1e-3 (density in the centre over exact) | on |\n|---|---|---|"
    for tube in others():
        def show(rules):
            *fields, _ = tube.fields(n, rules)
            return per_mille(tube.errors(n, fields)) + f" ({fields[0][n // 2] / tube.averages(n)[0][n // 2]:.3f})"

        yield f"| {tube.name} | {both(show)} |"


def equations(n):
    """The problems above with Torquato's contact value."""
    eos = TorquatoSpheres(1.0)
    yield f"| Torquato's spheres, {n} cells | off: as in the tables above | on |\n|---|---|---|"
    for tube in (drifting_burst(eos=eos), *(burst(*problem, eos=eos) for problem in BURSTS)):
        yield f"| {tube.name} | {both(lambda rules: burst_words(tube, n, rules))} |"
    yield f"| J, t = 0.002 | {both(lambda rules: contact_words(contact(0.002, eos), n, rules))} |"
    yield f"| B | {both(lambda rules: noise_words(head_on(eos=eos), n, rules))} |"


def cooling(n, fine):
    yield (f"| e = 0.9, {n} cells | off: L1 of rho, u, p in 1e-3 against {fine} cells with the rules | on | "
           f"{fine} cells without them against those with |\n|---|---|---|---|")
    Cooled.fine = fine
    for tube in (drifting_burst(), *(burst(*problem) for problem in BURSTS), head_on()):
        tube = Cooled(tube)
        yield f"| {tube.name} | {both(lambda rules: per_mille(tube.errors(n, tube.fields(n, rules)[:3])))} | {per_mille(tube.gap)} |"


def diagonals(n):
    yield (f"| along the diagonal, {n} x {n} cells | off: shock ahead in lines of cells / p behind it too high / L1 of rho, u in 1e-3 | on "
           "|\n|---|---|---|")
    for tube in (drifting_burst(), *(burst(*problem) for problem in BURSTS)):
        slant = Slant(tube)

        def show(rules):
            at, fields, known, image, limited = slant.run(n, rules)
            cells, high = slant.ahead(n, at, fields[2])
            errors = [np.abs(a - b).mean() / np.ptp(b) for a, b in zip(fields[:2], known)]
            return (f"{cells:.2f} / {high:.1f} % / {per_mille(errors)}" + (f", {limited} limited" if limited else "")
                    + (f", image off by {image:.0e}" if image else ""))

        yield f"| {tube.name} | {both(show)} |"
    slant = Slant(contact(0.002))

    def of_contact(rules):
        _, (_, u, p), *_ = slant.run(n, rules)
        return f"{100 * np.abs(p / 1e4 - 1).max():.1f} % / {np.abs(u - 0.7).max():.2f}"

    yield f"| J: largest error of p / false u at t = {slant.end:g} | {both(of_contact)} |"


def standing(n):
    yield (f"| standing shock, {n} x {n // 4} cells | off: largest transverse velocity over the inflow's after 10 crossings of the box / "
           "place of the shock, first and last cell | on |\n|---|---|---|")
    words = lambda v, first, last: f"{v:.1e} / {first:.0f} .. {last:.0f}"
    shocks = [Standing(nu, mach) for nu, mach in ((0.001, 6), (0.01, 6), (0.1, 6), (0.1, 15.8), (0.4, 15.8))]
    for shock in (*shocks, Standing(1.0, 6, PerfectGas(5 / 3))):
        yield f"| {shock.name} | {both(lambda rules: words(*shock.run(n, 10, rules)))} |"
    for flux in ("Marquina", "LaxFriedrichs", "MUSTA"):
        yield f"| {shocks[1].name}, `{flux}` | {words(*shocks[1].run(n, 10, False, flux=flux))} | |"


def ratios(number, n=200):
    found, limited = [], np.zeros(2, int)
    for tube in randoms(number):
        errors = []
        for k, rules in enumerate((False, True)):
            *fields, count = tube.fields(n, rules)
            limited[k] += count
            errors.append(tube.errors(n, fields))
        found.append(np.array(errors[1]) / errors[0])
    show = lambda v: " ".join(f"{x:.2f}" for x in v)
    yield (f"{number} random problems, {n} cells, L1 of rho, u, p with the rules over that without: geometric mean "
           f"{show(np.exp(np.log(found).mean(axis=0)))}; worst {show(np.max(found, axis=0))}; best {show(np.min(found, axis=0))}; "
           f"faces limited {limited[0]} without, {limited[1]} with.")


def strip_burst(strip, tube, name, polynomial):
    def show(rules):
        rho, u, p, limited = strip.fields(tube, rules, polynomial)
        cells, high = tube.ahead(strip.n, strip.slices(p))
        errors = strip.errors(tube, (rho, u, p))[:2]
        return f"{cells:.2f} / {100 * high:.1f} % / {per_mille(errors)}" + (f", {limited} limited" if limited else "")

    return f"| {name} | {polynomial} | {strip.n} | {both(show)} |"


def strip_contact(strip, polynomial):
    def show(rules):
        found = []
        for t in (0.001, 0.002, 0.004):
            _, u, p, _ = strip.fields(contact(t), rules, polynomial)
            found.append(f"{100 * np.abs(p / 1e4 - 1).max():.1f} % / {np.hypot(u[:, 0] - 0.7, u[:, 1]).max():.2f}")
        return ", ".join(found)

    return f"| J: largest error of p / false u at t = 0.001, 0.002, 0.004 | {polynomial} | {strip.n} | {both(show)} |"


def strip_noise(strip, polynomial):
    tube = head_on()

    def show(rules):
        rho, u, p, _ = strip.fields(tube, rules, polynomial)
        return "%.1e / %.1e" % strip.noise(tube, rho) + f" / {1e3 * strip.errors(tube, (rho, u, p))[0]:.2f}"

    return f"| B: noise, mean / largest / L1 of rho in 1e-3 | {polynomial} | {strip.n} | {both(show)} |"


def strip_single(strip, tube, polynomial):
    show = lambda rules: per_mille(strip.errors(tube, strip.fields(tube, rules, polynomial)[:3]))
    return f"| {tube.name}: L1 of rho, u, p in 1e-3 | {polynomial} | {strip.n} | {both(show)} |"


def polyhedra(grids):
    yield "| strip of triangles | polynomials | edges along it | off: as in the tables above, per edge in place of cell | on |\n|---|---|---|---|---|"
    with tempfile.TemporaryDirectory() as folder:
        strips = [Strip(n, folder) for n in grids]
        for polynomial in ("CWENO3", "linear"):
            for strip in strips:
                yield strip_burst(strip, drifting_burst(), "A", polynomial)
            for problem in BURSTS:
                tube = burst(*problem)
                yield strip_burst(strips[-1], tube, tube.name, polynomial)
            for strip in strips[:2]:
                yield strip_contact(strip, polynomial)
            for strip in strips:
                yield strip_noise(strip, polynomial)
        for tube in others():
            yield strip_single(strips[0], tube, "CWENO3")


def balls(sizes, cells):
    yield "| burst out of a ball | cells | off: shock ahead in V^(1/3) / p behind it too high / L1 of rho, u in 1e-3 | on |\n|---|---|---|---|"
    ball = Ball(cells)
    for n, polynomial in sizes:
        def show(rules):
            cells, high, errors, limited, show.cells = ball.run(n, polynomial, rules)
            return f"{cells:.2f} / {100 * high:.1f} % / {per_mille(errors)}" + (f", {limited} limited" if limited else "")

        row = both(show)
        yield f"| {'tetrahedra, ' + polynomial if polynomial else 'lattice'} | {show.cells} | {row} |"


def bodies(n):
    yield ("| cylinder in air | cells | Mach | stand-off, Billig (1967) | `fronts off`: stand-off / density apart from its mirror image, over the "
           "jump | on |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for body in (Body(n, quads, folder) for quads in (True, False)):
            for mach in (5, 10, 20):
                off, on = ("%.3f / %.0e" % body.run(mach, f"commonCoeffs {{ fronts {word}; }}\n") for word in ("off", "on"))
                yield f"| {body.name} | {body.mesh.cells} | {mach} | {billig(mach, 'cylinder'):.3f} | {off} | {on} |"


def tables(quick):
    grids = (100, 200) if quick else (100, 200, 400, 800, 1600)
    yield "bursts", bursts(grids)
    yield "contacts", contacts(grids[:4])
    yield "noise", noises(grids if quick else grids[1:])
    yield "others", singles(100 if quick else 400)
    yield "equations", equations(100 if quick else 400)
    yield "cooling", cooling(100, 800 if quick else 12800)
    yield "diagonal", diagonals(40 if quick else 200)
    yield "standing", standing(40 if quick else 100)
    yield "random", ratios(4 if quick else 40)
    yield "polyhedra", polyhedra((50, 100) if quick else (100, 200, 400))
    yield "bodies", bodies(6 if quick else 12)
    sizes = ((16, ""), (8, "CWENO3")) if quick else ((32, ""), (64, ""), (12, "CWENO3"), (24, "CWENO3"), (12, "linear"), (24, "linear"))
    yield "balls", balls(sizes, 400 if quick else 6400)


def main():
    parser = command.parser(__doc__)
    parser.add_argument("-out", metavar="FILE.md", help="writes the tables there")
    parser.add_argument("-quick", action="store_true", help="coarse grids, four random problems")
    parser.add_argument("-problem", help="one table: bursts, contacts, noise, others, equations, cooling, diagonal, standing, random, polyhedra, bodies, balls")
    options = parser.parse_args()
    out = open(options.out, "w") if options.out else sys.stdout
    for name, rows in tables(options.quick):
        if options.problem in (None, name):
            print(f"\n## {name}\n", file=out)
            for row in rows:
                if "\n|---" in row:  # the head of a table
                    print(measured_by(f"haff denseShocks -problem {name}"), file=out, end="\n\n")
                print(row, file=out, flush=True)


if __name__ == "__main__":
    main()
