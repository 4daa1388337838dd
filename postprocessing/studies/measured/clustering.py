# SPDX-License-Identifier: GPL-3.0-or-later
"""A gas and grains that cool in the same periodic box, beside each other: energy, impacts, spectra, when Haff's law is left.

    haff clustering start GRAINS TIME LONGEST FOLDER     the longest waves of the grains at a time as expressions of 0.orig/alpha, T and U
    haff clustering table GRAINS FOLDER TIME...          cooling.csv and spectra.csv of a run of granularMD
    haff clustering alike GAS GRAINS TIME...             how alike density and momentum of the long waves are, phase by phase
    haff clustering density GRAINS TIME FILE.npz         counts of its grains in 32^3 cells

Waves are exp(2 pi i n x/L) of whole n; the spectra are those of the density over its mean, and of the momentum over the mean density,
along the wave and across it, times the number of grains: a gas of grains at random has 1 and T.
"""
import os
import re

import numpy as np

import haff
from haff import command
from haff.case import grains
from haff.case.foam import header
from haff.start import enskog
from studies.exact import disks, garzoDufty

SIDE = {2: 160, 3: 64}  # cells a side in which grains are counted
LONGEST = {2: 62, 3: 13}  # |n|^2 of the shortest waves that the shipped gases begin with
FIELDS = {"alpha": ("volScalarField", "[0 0 0 0 0 0 0]"), "T": ("volScalarField", "[0 2 -2 0 0 0 0]"), "U": ("volVectorField", "[0 1 -1 0 0 0 0]")}


def value(path, file, key):
    """The number of an entry of a dictionary."""
    with open(os.path.join(path, file), encoding="latin-1") as f:
        found = re.search(rf"\b{key}\s+(?:uniform\s+)?([-+.\deE]+)\s*;", re.sub(r"//[^\n]*", "", f.read()))
    if not found:
        raise haff.FormatError(f"{os.path.join(path, file)}: '{key}' is no number here, as it is in a box of uniform gas that cools")
    return float(found.group(1))


class Box:
    """What gas and grains have in common; lengths in grain diameters, which the cases take for 1, as T of the start."""

    def __init__(self, path):
        self.case = haff.Case(path)
        corners = self.case.mesh.points
        cyclic = [name for name, (kind, _, _) in self.case.mesh.patches.items() if kind == "cyclic"]
        self.d = len(cyclic) // 2
        if self.d < 2:
            raise ValueError(f"{path} is no box that is periodic along two axes or three: it has {len(cyclic)} cyclic patches")
        self.length = float(np.ptp(corners[:, 0]))
        self.alpha = value(path, "0.orig/alpha", "internalField")
        self.e = value(path, "constant/granularProperties", "restitution")
        self.number = round(self.alpha * self.length**self.d / enskog.volume(self.d, 1))
        with open(os.path.join(path, "constant", "granularProperties")) as f:
            old = "JenkinsRichman" in f.read()
        self.gas = disks.Disks(self.e) if old else garzoDufty.Grains(self.d, self.e)
        self.theory = disks.Cooling(self.gas, self.alpha)

    def haff(self, t):
        return self.gas.cooled(self.alpha, 1.0, np.asarray(t, float))

    # ---- grains -----------------------------------------------------------------------------------------------------

    def totals(self):
        """Time, impacts of each grain, (2/d) of the energy of motion per mass: of grains."""
        rows = self.case.table("grains", "grains.dat")
        rows = rows[np.unique(rows[:, 0], return_index=True)[1]]
        return rows[:, 0], 2 * rows[:, 1] / self.number, rows[:, 5]

    def cloud(self, time):
        """Places and velocities along the box's axes."""
        found = grains.read(self.case, time)
        return found["x"][:, :self.d], found["U"][:, :self.d]

    # ---- gas --------------------------------------------------------------------------------------------------------

    def budget(self):
        """Time and (2/d) of the energy of motion per mass after every step: of the gas."""
        rows = self.case.table("budget", "energyBudget.dat")
        rows = rows[np.unique(rows[:, 0], return_index=True)[1]]
        return rows[:, 0], 2 / self.d * rows[:, 5] / rows[:, 1]

    def order(self):
        """Cells so that they run along z, y, x, and their number a side."""
        x = np.round(self.case.centres, 6)
        side = round(len(x) ** (1 / self.d))
        return np.lexsort(x.T), side

    def cells(self, time):
        """Density over its mean [side]^d and velocity [d][side]^d, axes z, y, x, of the gas."""
        order, side = self.order()
        shape = (side,) * self.d
        rho = self.case.field("alpha", time)[order].reshape(shape)
        u = self.case.field("U", time)[order]
        return rho / rho.mean(), np.array([u[:, k].reshape(shape) for k in range(self.d)])

    def impacts(self):
        """Written times, and the impacts of each grain of the gas until then, by Enskog's rate in its cells: that rate in units of Haff's
        law's is summed over the logarithm in which the impacts of the latter grow."""
        beta, times = self.theory.beta, [time for time in self.case.times if float(time) > 0]
        t, rate = np.append(0.0, [float(time) for time in times]), [1.0]
        first = float(enskog.collision_rate(self.alpha, 1.0, self.d, 1))
        for time in times:
            alpha, T = self.case.field("alpha", time), self.case.field("T", time)
            mean = np.average(enskog.collision_rate(alpha, T, self.d, 1), weights=alpha)
            rate.append(mean / first * (1 + beta * float(time)))
        steps = np.diff(self.theory.tau(t)) * first * (np.array(rate)[1:] + np.array(rate)[:-1]) / 2
        return t[1:], np.cumsum(steps)

    # ---- both -------------------------------------------------------------------------------------------------------

    def put(self, x, u, side):
        """Density over its mean and momentum over mean density, of grains counted in side^d cells."""
        cell = np.minimum((x / self.length * side).astype(int), side - 1)
        index = np.ravel_multi_index(cell.T[::-1], (side,) * self.d)
        per, shape = side**self.d / len(x), (side,) * self.d
        rho = np.bincount(index, minlength=side**self.d).reshape(shape) * per
        return rho, np.array([np.bincount(index, v, side**self.d).reshape(shape) * per for v in u.T])

    def spectra(self, rho, j):
        """n of shells one wide, and the means over each of the powers of density, momentum across (of one direction) and
        along, times the number of grains."""
        side = rho.shape[0]
        n = np.fft.fftfreq(side, 1 / side)
        axes = np.meshgrid(*(n,) * self.d, indexing="ij")[::-1]  # x first
        k = np.sqrt(sum(a * a for a in axes))
        shell = np.rint(k).astype(int)
        use = (shell > 0) & (k < side / 2)
        waves = [np.fft.fftn(q) / side**self.d for q in (rho, *j)]
        power = sum(abs(w) ** 2 for w in waves[1:])
        along = abs(sum(a * w for a, w in zip(axes, waves[1:]))) ** 2 / np.where(k > 0, k * k, 1)
        number = np.bincount(shell[use])[1:]
        of = lambda q: self.number * np.bincount(shell[use], q[use])[1:] / number
        return np.bincount(shell[use], k[use])[1:] / number, of(abs(waves[0]) ** 2), of((power - along) / (self.d - 1)), of(along)


def likeness(one, other, most=4.5):
    """Correlation of two fields on the same cells in the waves to that n: 1 if they are alike, phase by phase."""
    side = one.shape[0]
    n = np.fft.fftfreq(side, 1 / side)
    k = np.sqrt(sum(a * a for a in np.meshgrid(*(n,) * one.ndim, indexing="ij")))
    a, b = (np.fft.fftn(q)[(k > 0) & (k < most)] for q in (one, other))
    return float((a * b.conj()).real.sum() / np.sqrt((abs(a) ** 2).sum() * (abs(b) ** 2).sum()))


def left(t, T, law, factor=2.0):
    """When T has grown to that many times Haff's law; nan if it has not."""
    ratio = np.log(np.maximum(T, 1e-300) / law / factor)
    above = np.flatnonzero(ratio > 0)
    if not len(above) or above[0] == 0:
        return np.nan
    i = above[0]
    part = ratio[i - 1] / (ratio[i - 1] - ratio[i])
    return float(t[i - 1] * (t[i] / t[i - 1]) ** part) if t[i - 1] > 0 else float(part * t[i])


# ---- the start of the gas -------------------------------------------------------------------------------------------

def half(d, longest):
    """Every n of |n|^2 <= longest, but not its negative."""
    reach = int(np.sqrt(longest))
    all_ = np.array(np.meshgrid(*(np.arange(-reach, reach + 1),) * d, indexing="ij")).reshape(d, -1).T
    size = (all_**2).sum(axis=1)
    first = np.array([next((v for v in n if v), 0) > 0 for n in all_])
    found = all_[(size <= longest) & first]
    return found[np.lexsort([*found.T, (found**2).sum(axis=1)])]


def expression(waves, amplitudes, length):
    """Real waves with these complex amplitudes of exp(2 pi i n x/L), as one text."""
    text = ""
    for n, c in zip(waves, amplitudes):
        at = "".join(f"{'+' if k > 0 else '-'}{'' if abs(k) == 1 else f'{abs(k)}*'}{name}" for k, name in zip(n, "xyz") if k).lstrip("+")
        text += f"{2 * abs(c):+.3g}*cos(pi*({at})/{length / 2:g}{np.angle(c):+.2f})".replace("+0.", "+.").replace("-0.", "-.")
    return text


def start(path, time, longest, folder):
    """Writes the waves that the grains have at that time: the gas begins with the same noise, as far as these waves hold it."""
    box = Box(path)
    x, u = box.cloud(time)
    waves = half(box.d, longest)
    T = (u**2).sum(axis=1).mean() / box.d
    amplitude = np.array([np.exp(-2j * np.pi / box.length * (x @ n)) for n in waves]) / len(x)
    u = u / np.sqrt(T)
    texts = {"alpha": f'"{box.alpha:g}*(1{expression(waves, amplitude.sum(axis=1), box.length)})"',
             "T": f'"1{expression(waves, amplitude @ ((u**2).sum(axis=1) / box.d - 1), box.length)}"',
             "U": "(" + " ".join(f'"{expression(waves, amplitude @ u[:, k], box.length)}"' if k < box.d else '"0"' for k in range(3)) + ")"}
    uniform = {"alpha": f"{box.alpha:g}", "T": "1", "U": "(0 0 0)"}
    sides = '    ".*" { type cyclic; }\n' if box.d == 3 else '    "(left|right|bottom|top)" { type cyclic; }\n    "(front|back)"            { type empty; }\n'
    for name, (kind, dimensions) in FIELDS.items():
        with open(os.path.join(folder, name), "w") as f:
            f.write(header(kind, name, "0.orig") + "\n"
                    f"// The {len(waves)} longest waves of {len(x)} grains at their start: postprocessing/studies/measured/clustering.py.\n"
                    f"dimensions      {dimensions};\ninternalField   uniform {uniform[name]};\nexpression      {texts[name]};\nboundaryField\n{{\n{sides}}}\n")


# ---- tables of grains -----------------------------------------------------------------------------------------------

def table(path, folder, times, rows=120):
    """Of a run: rows in even steps of the logarithm of time, and spectra at written times."""
    box = Box(path)
    t, impacts, T = box.totals()
    keep = np.unique(np.searchsorted(t, np.geomspace(t[1], t[-1] * (1 - 1e-12), rows)))
    with open(os.path.join(folder, "cooling.csv"), "w") as f:
        f.write("t,impacts,T\n" + "".join(f"{t[i]:.6g},{impacts[i]:.6g},{T[i]:.6g}\n" for i in keep))
    with open(os.path.join(folder, "spectra.csv"), "w") as f:
        f.write("t,n,density,across,along\n")
        for time in times:
            for row in zip(*box.spectra(*box.put(*box.cloud(box.case.time(time)), SIDE[box.d]))):
                f.write(",".join([f"{time:g}", *(f"{v:.4g}" for v in row)]) + "\n")


def read(path, name):
    return np.genfromtxt(os.path.join(path, name), delimiter=",", names=True)


def at(rows, t):
    """Impacts and energy of grains between the rows of cooling.csv, in the logarithm of time."""
    return np.interp(np.log(t), np.log(rows["t"]), rows["impacts"]), np.exp(np.interp(np.log(t), np.log(rows["t"]), np.log(rows["T"])))


# ---- the figure -----------------------------------------------------------------------------------------------------

def rates(box, t):
    """Growth of the power of waves across themselves in linear theory from thermal noise: for n the power over Haff's T, of a gas that
    keeps to its first noise, and of grains, which make noise all the time (fluctuating hydrodynamics)."""
    n = np.linspace(0.5, 16, 300)
    k, tau = 2 * np.pi / box.length * n, float(box.theory.tau(t))
    growth, friction = 2 * box.theory.across(k), 2 * box.theory.shear * k * k
    grown = np.exp(growth * tau)
    return n, grown, grown + friction * np.where(abs(growth) > 1e-9, (grown - 1) / growth, tau)


def excess(box, t, longest=None):
    """Energy of motion over Haff's law in linear theory, by the waves across themselves alone: of grains, or of a gas that begins with the
    noise of grains in waves of |n|^2 <= longest and makes none. Of waves longer than 8 diameters: the sum over those of grains does not
    converge towards short ones, where hydrodynamics ends."""
    reach = int(box.length / 8)
    size = sum(a * a for a in np.meshgrid(*(np.arange(-reach, reach + 1),) * box.d)).ravel()
    size = size[(size > 0) & (size <= (box.length / 8) ** 2)]
    k = 2 * np.pi / box.length * np.sqrt(size)
    tau, growth, friction = float(box.theory.tau(t)), 2 * box.theory.across(k), 2 * box.theory.shear * k * k
    grown = np.exp(growth * tau)
    energy = grown[size <= longest].sum() if longest else (grown - 1 + friction * (grown - 1) / growth).sum()
    return 1 + (box.d - 1) / box.d / box.number * energy


def draw_energy(box, cooling, energy, impacts, say):
    """The energy of motion and the impacts of gas and grains over time, in two panels; returns time and energy, time and impacts of the gas."""
    from haff.plot import figures
    (t, T), (when, count) = box.budget(), box.impacts()
    law = box.haff(t)
    energy.loglog(t[1:], law[1:], color="0.5", linewidth=0.7, label="Haff's law")
    energy.loglog(t[1:], T[1:], label="gas")
    energy.loglog(cooling["t"][::2], cooling["T"][::2], "o", markersize=2.2, fillstyle="none", label="grains")
    gone = [left(t, T, law), left(cooling["t"], cooling["T"], box.haff(cooling["t"]))]
    for x, colour in zip(gone, figures.COLOURS):
        energy.axvline(x, color=colour, linewidth=0.6, linestyle=":")
    energy.set_xlim(0.5, 1.5 * t[-1])
    energy.legend()
    figures.label(energy, r"$t\,\sqrt{T_0}/\sigma$", rf"$2E/{box.d}NT_0$", "dotted: twice Haff's law")
    say(f"twice Haff's law: gas at t = {gone[0]:.0f}, grains at {gone[1]:.0f}")
    homogeneous = np.geomspace(when[0] / 10, when[-1], 100)
    impacts.semilogx(homogeneous, box.theory.tau(homogeneous) * enskog.collision_rate(box.alpha, 1.0, box.d, 1), color="0.5", linewidth=0.7)
    impacts.semilogx(when, count)
    impacts.semilogx(cooling["t"][::2], cooling["impacts"][::2], "o", markersize=2.2, fillstyle="none")
    impacts.set_xlim(homogeneous[0], homogeneous[-1])
    figures.label(impacts, r"$t\,\sqrt{T_0}/\sigma$", "impacts of a grain")
    return t, T, when, count


def draw(gas, kept, target, moments):
    """Energy of motion over Haff's law, impacts, and spectra at these times: lines of the gas in folder `gas`, dots of the grains whose
    tables lie in `kept`. Prints what the README quotes."""
    import sys

    from haff.plot import figures
    box, cooling, spectra = Box(gas), read(kept, "cooling.csv"), read(kept, "spectra.csv")
    fig, ((energy, impacts), (density, across)) = figures.panels(2, 2, width=7.6, height=2.7)
    say = lambda text: print(text, file=sys.stderr)
    t, T, when, count = draw_energy(box, cooling, energy, impacts, say)
    law = box.haff(t)
    for moment, colour in zip(moments, figures.COLOURS):
        rho, u = box.cells(box.case.time(moment))
        n, *power = box.spectra(rho, rho * u)
        rows = spectra[spectra["t"] == moment]
        haff_, here = float(box.haff(moment)), len(n) // 2
        for ax, mine, name, unit in ((density, power[0], "density", 1), (across, power[1], "across", haff_)):
            ax.loglog(n[:here], mine[:here] / unit, color=colour, label=f"$t$ = {moment:g}")
            ax.loglog(rows["n"], rows[name] / unit, "o", markersize=2.2, fillstyle="none", color=colour)
        hits, energies = at(cooling, moment)
        i = np.argmin(abs(t - moment))
        alpha = box.case.field("alpha", box.case.time(moment))
        heat = np.average(box.case.field("T", box.case.time(moment)), weights=alpha)
        say(f"t = {moment:g}: T of the gas {heat / law[i]:.3f} of Haff's law; 2E/{box.d} gas {T[i]:.4g}, grains {energies:.4g}, over Haff's law {T[i] / law[i]:.3f}, {energies / law[i]:.3f}; "
            f"impacts {np.interp(moment, when, count):.1f}, {hits:.1f}; deviation of density in waves to n = 5: "
            + ", ".join(f"{deviation(box, x, y):.3f}" for x, y in ((n, power[0]), (rows["n"], rows["density"])))
            + f"; greatest alpha of the gas {box.alpha * rho.max():.3f}; linear theory of 2E over Haff's law: gas {excess(box, moment, LONGEST[box.d]):.3f}, "
            + f"grains {excess(box, moment):.3f}")
    n, mine, noisy = rates(box, moments[0])
    across.loglog(n, mine, color="0.3", linewidth=0.6)
    across.loglog(n, noisy, color="0.3", linewidth=0.6, linestyle="--")
    across.set_ylim(1e-2)
    density.set_ylim(1e-2)
    density.legend()
    figures.label(density, r"$L/\lambda$", r"$N\,|\rho_k/\rho_0|^2$", "density")
    figures.label(across, r"$L/\lambda$", r"$N\,|j_k|^2/T_\mathrm{Haff}$", f"momentum across; thin: linear theory at {moments[0]:g}")
    figures.save(fig, target)


def draw_grains(path, kept, target, moments):
    """Energy of motion of the grains beside Haff's law, spectra of the density beside the kept ones (dots), and the grains of a slab."""
    from haff.plot import figures
    box, spectra = Box(path), read(kept, "spectra.csv")
    fig, ((energy, density, places),) = figures.panels(1, 3, width=9.5, height=2.9)
    t, _, T = box.totals()
    energy.loglog(t[1:], box.haff(t[1:]), color="0.5", linewidth=0.7, label="Haff's law")
    energy.loglog(t[1:], T[1:], color=figures.COLOURS[1], label="grains")
    energy.axvline(left(t, T, box.haff(t)), color=figures.COLOURS[1], linewidth=0.6, linestyle=":")
    energy.legend()
    figures.label(energy, r"$t\,\sqrt{T_0}/\sigma$", rf"$2E/{box.d}NT_0$", rf"{box.number} grains, $\alpha$ = {box.alpha:g}, $e$ = {box.e:g}")
    for moment, colour in zip(moments, figures.COLOURS):
        x, u = box.cloud(box.case.time(moment))
        n, power = box.spectra(*box.put(x, u, SIDE[box.d]))[:2]
        rows = spectra[spectra["t"] == moment]
        density.loglog(n, power, color=colour, label=f"$t$ = {moment:g}")
        density.loglog(rows["n"], rows["density"], "o", markersize=2.2, fillstyle="none", color=colour)
    density.legend()
    figures.label(density, r"$L/\lambda$", r"$N\,|\rho_k/\rho_0|^2$", "density (dots: kept)")
    x = x[x[:, 2] < 4] if box.d == 3 else x
    places.plot(x[:, 0], x[:, 1], ".", markersize=0.5, color="0.2", rasterized=True)
    places.set_aspect("equal")
    places.set_xlim(0, box.length)
    places.set_ylim(0, box.length)
    figures.label(places, r"$x/\sigma$", r"$y/\sigma$", f"$t$ = {moments[-1]:g}" + (", $z < 4\\,\\sigma$" if box.d == 3 else ""))
    figures.save(fig, target)


def deviation(box, n, power, most=5.5):
    """Standard deviation of the density over its mean in waves to that n, from the shells of a spectrum."""
    use = n < most
    waves = {2: 2 * np.pi * n, 3: 4 * np.pi * n * n}[box.d]
    return float(np.sqrt((waves * power)[use].sum() / box.number))


def compare(gas, path, times):
    """Prints the likeness of density and momentum of gas and grains; waves to n = 4."""
    box, other = Box(gas), Box(path)
    for time in times:
        rho, u = box.cells(box.case.time(time))
        counted, j = other.put(*other.cloud(other.case.time(time)), len(rho))
        print(f"t = {time:g}: " + ", ".join(f"{likeness(a, b):.2f}" for a, b in zip((rho, *(rho * u)), (counted, *j))))


def density(path, time, file, side=32):
    box = Box(path)
    rho, _ = box.put(*box.cloud(box.case.time(time)), side)
    np.savez_compressed(file, counts=np.rint(rho * box.number / side**box.d).astype(np.uint8), time=time)


def main():
    parser = command.parser(__doc__)
    what = parser.add_subparsers(dest="what", required=True)
    begin = what.add_parser("start")
    for name, kind in (("grains", str), ("time", str), ("longest", int), ("folder", str)):
        begin.add_argument(name, type=kind)
    keep = what.add_parser("table")
    keep.add_argument("grains")
    keep.add_argument("folder")
    keep.add_argument("times", type=float, nargs="+")
    alike = what.add_parser("alike")
    for name in ("gas", "grains"):
        alike.add_argument(name)
    alike.add_argument("times", type=float, nargs="+")
    counts = what.add_parser("density")
    for name, kind in (("grains", str), ("time", float), ("file", str)):
        counts.add_argument(name, type=kind)
    o = parser.parse_args()
    if o.what == "start":
        start(o.grains, o.time, o.longest, o.folder)
    elif o.what == "alike":
        compare(o.gas, o.grains, o.times)
    elif o.what == "density":
        density(o.grains, o.time, o.file)
    else:
        table(o.grains, o.folder, o.times)


if __name__ == "__main__":
    main()
