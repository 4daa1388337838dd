# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns on a shaken layer, measured from the fields on the mesh: of granularGas and granularMD alike.

    haff faraday CASE [-from CYCLE] [-to CYCLE] [-of mass|lift|height] [-figure FILE.png]

prints, for the cycles wanted, the wavelength of the pattern with the box's quantum, whether one stands at all, its period,
its growth per cycle. Needs constant/g and constant/shaking, a mesh that is a box of equal cells and periodic across, and
times written at the same phases of every cycle.

What is taken of a column of cells: `mass` over the mean (the default, and what the paper of Carrillo et al. took: where the
grains are), `height` of the centre of mass, or `lift`, that height above the mean times the mass: where a column is nearly
empty its height is noise. A wave a cos(2 pi k x/L + b) has the complex amplitude c = a exp(ib) in mode k and the power
|c|^2/2. Of a mode the alternating part counts, (c(n) - c(n+1))/2 of cycles that follow each other: the whole of a pattern of
twice the period of the shaking, nothing of what changes slowly (grains slosh through a long box), half the noise. Its
powers are averaged over cycles and phases before anything is read from them: the wavelength of each moment's strongest
mode (`strongest`, kept to show it) is noise at the phases where the layer is flat, and so is its mean.

A pattern stands where the highest power is at least CONTRAST times the floor, the median of all modes, and where the whole
amplitude turns over from one period to the next (`flip` below FLIP: -1 for the period 2T, 0 for noise).
"""
import os
import re

import numpy as np

from haff import command
from haff.case.case import Case
from haff.case.foam import FoamFile, FormatError
from haff.paths import suggestion

CONTRAST, FLIP = 5.0, -0.5


def dictionary(case, name, *wanted):
    """Numbers, vectors and tables (t, v, t, v, ..) of a flat dictionary of constant/: {key: [values]}. FormatError where a key that is
    wanted is not among them; FileNotFoundError."""
    path = os.path.join(case.path, "constant", name)
    if not os.path.isfile(path):
        raise FileNotFoundError(f"{path} is not there, or no file: this command is about layers under gravity")
    text = FoamFile(path).body.decode("latin-1")
    text = re.sub(r"//[^\n]*", "", text)
    number = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
    found = {k: [float(w) for w in re.findall(number, v)]
             for k, v in re.findall(rf"(\w+)\s+(?:\[[^\]]*\]\s*|table\s*)?([(\s]*{number}[^;]*);", text)}
    for key in wanted:
        if key not in found:
            raise FormatError(f"{path}: there is no number '{key}'{suggestion(key, found)}")
    return found


class Layer:
    """A case on a box: `up` is against gravity, heights count from the plate, `x` runs along the longest other axis."""

    def __init__(self, case):
        self.case = case if isinstance(case, Case) else Case(case)
        g = np.array(dictionary(self.case, "g", "value")["value"])
        self.up = int(np.argmax(np.abs(g)))
        self.sign = -np.sign(g[self.up])
        if os.path.exists(os.path.join(self.case.path, "constant", "shaking")):
            shaking = dictionary(self.case, "shaking", "frequency", "amplitude")
            self.frequency, self.acceleration = shaking["frequency"][0], shaking["amplitude"][-1]  # of a ramp: its end
            self.amplitude = np.abs(g).max() * self.acceleration / (2 * np.pi * self.frequency) ** 2
        places, points = self.case.centres, self.case.mesh.points
        low, high = points.min(axis=0), points.max(axis=0)
        digits = 9 - int(np.ceil(np.log10((high - low).max())))
        lines = [np.unique(np.round(places[:, a], digits)) for a in range(3)]
        if len(places) != np.prod([len(line) for line in lines]):
            raise ValueError(f"{self.case.path}: the mesh is no full box of equal cells")
        self.dim = sum(len(line) > 1 for line in lines)
        self.along = max((a for a in range(3) if a != self.up), key=lambda a: len(lines[a]) * (high - low)[a])
        across = 3 - self.up - self.along
        self.order = np.lexsort([np.round(places[:, a], digits) for a in (across, self.up, self.along)])
        self.shape = [len(lines[a]) for a in (self.along, self.up, across)]
        self.x, self.length = lines[self.along] - low[self.along], (high - low)[self.along]
        self.y = lines[self.up] - low[self.up] if self.sign > 0 else high[self.up] - lines[self.up]

    def field(self, name, time):
        """[x][up][across] or [x][up][across][3]."""
        values = self.case.field(name, time)[self.order]
        return values.reshape(*self.shape, *values.shape[1:])

    def mass(self, time):
        """Of every column [x], over their mean."""
        mass = self.field("alpha", time).sum(axis=(1, 2))
        return mass / mass.mean()

    def lift(self, time):
        """Mass times the height of its centre above that of the layer [x]."""
        mass = self.field("alpha", time).sum(axis=2)
        return (mass @ self.y - (mass @ self.y).sum() / mass.sum() * mass.sum(axis=1)) / mass.sum(axis=1).mean()

    def height(self, time):
        """Of the centre of mass of every column [x]; that of the layer where a column is empty."""
        mass = self.field("alpha", time).sum(axis=2)
        total, mean = mass.sum(axis=1), (mass @ self.y).sum() / mass.sum()
        return np.where(total > 0, mass @ self.y / np.where(total > 0, total, 1), mean)

    def phases(self, first=0.0, last=np.inf, near=5e-3):
        """{phase in periods: ([cycle], [name of the time])} of the phases that come in three cycles or more, without the
        start of the case, whose fields may be expressions."""
        if not hasattr(self, "frequency"):
            raise ValueError(f"{self.case.path} is not shaken (it has no constant/shaking), so it has no phases")
        found = {}
        for name in self.case.times:
            cycles = float(name) * self.frequency
            if cycles > 0 and first - near <= cycles <= last + near:
                phase = (cycles + near) % 1 - near
                key = next((k for k in found if abs(k - phase) < near), abs(round(phase, 3)))
                found.setdefault(key, ([], []))
                found[key][0].append(int(round(cycles - key)))
                found[key][1].append(name)
        return {k: v for k, v in sorted(found.items()) if len(v[0]) > 2}

    def profile(self, times, columns=None, dim=None):
        """With height, over one or more times: {"y", "alpha", "U" (up), "T", "p" where there is one}. U and T are those
        of all mass in a row: T holds what U differs by from cell to cell (dim: components of velocity that T is of,
        default the axes solved). columns: of each time, masks [x] such as crests gives; default all. Of grains there is
        "TComponents" [y][3], too."""
        dim = dim or self.dim
        times = [times] if isinstance(times, str) else list(times)
        columns = columns or [slice(None)] * len(times)
        rows = self.shape[1]
        total, momentum, energy, pressure = np.zeros(rows), np.zeros((rows, 3)), np.zeros(rows), np.zeros(rows)
        count, parts = 0, np.zeros((rows, 3))
        has_p, has_parts = (os.path.exists(os.path.join(self.case.path, times[0], name)) for name in ("p", "TComponents"))
        for time, mask in zip(times, columns):
            alpha, U, T = (self.field(name, time)[mask] for name in ("alpha", "U", "T"))
            total += alpha.sum(axis=(0, 2))
            momentum += np.einsum("xyz,xyzk->yk", alpha, U)
            energy += (alpha * (dim * T + (U**2).sum(axis=3))).sum(axis=(0, 2))
            pressure += self.field("p", time)[mask].sum(axis=(0, 2)) if has_p else 0
            parts += np.einsum("xyz,xyzk->yk", alpha, self.field("TComponents", time)[mask] + U**2) if has_parts else 0
            count += alpha.shape[0] * alpha.shape[2]
        safe = np.where(total > 0, total, 1)
        mean = momentum / safe[:, None]
        order = np.argsort(self.y)
        result = {"y": self.y, "alpha": total / count, "U": self.sign * mean[:, self.up],
                  "T": np.maximum(energy / safe - (mean**2).sum(axis=1), 0) / dim}
        if has_p:
            result["p"] = pressure / count
        if has_parts:
            result["TComponents"] = np.maximum(parts / safe[:, None] - mean**2, 0)
        return {k: v[order] for k, v in result.items()}

    def crests(self, time, mode, valleys=False, of="mass"):
        """Mask [x] of the quarter of the columns where the waves about that mode are highest, or lowest: modes from half to
        one and a half times it, for a pattern may be longer here and shorter there."""
        c = modes(getattr(self, of)(time)[None])[0]
        k = np.arange(len(c))
        c[(k < 0.5 * mode) | (k > 1.5 * mode)] = 0
        wave = (c * np.exp(2j * np.pi * np.outer(self.x, k) / self.length)).real.sum(axis=1) * (-1 if valleys else 1)
        return wave > np.quantile(wave, 0.75)


def interface(profile, gas, packing=0.05):
    """Height at which the packing of a profile last falls below `packing`, and the Mach number |U|/c there (U relative to
    the plate, along gravity); gas: disks.Disks, for the sound speed. nan where there is no such height."""
    alpha = profile["alpha"]
    below = np.flatnonzero(alpha >= packing)
    if not len(below) or below[-1] + 1 == len(alpha):
        return np.nan, np.nan
    i = below[-1]
    part = np.log(alpha[i] / packing) / np.log(alpha[i] / max(alpha[i + 1], 1e-30))
    y, U, T = (profile[k][i] + part * (profile[k][i + 1] - profile[k][i]) for k in ("y", "U", "T"))
    A = gas.A(packing)
    return y, abs(U) / np.sqrt(T * (A + (A - 1) * gas.slope(packing) + A * A))


def pairs(layer, first, last=np.inf, of="mass", heaps=True):
    """Of a pattern of twice the period, written at the same phases of every period from cycle `first` on: its mode, and for
    each pair of cycles {phase in 0 .. 2: name of the time} with the mask [x] of the columns where a heap (else a
    valley) lies at its start."""
    written = layer.phases(first, last)
    if 0 not in written:
        raise ValueError(f"{layer.case.path}: the begin of the strokes was not written in three cycles or more from cycle {first:g} on")
    mode = measure(list(samples(layer, first, last, of).values()), layer.length)["mode"]
    name = {(n, phase): time for phase, (cycles, names) in written.items() for n, time in zip(cycles, names)}
    starts = [n for n in range(int(np.ceil(first)), max(written[0][0]), 2) if all((n + k, p) in name for p in written for k in (0, 1))]
    if not starts:
        raise ValueError(f"{layer.case.path}: no two whole cycles that follow each other were written from cycle {first:g} on")
    return mode, [({p + k: name[n + k, p] for p in written for k in (0, 1)}, layer.crests(name[n, 0], mode, not heaps, of)) for n in starts]


def modes(heights):
    """Complex amplitudes [moment][mode] of heights [moment][x]; mode 0 is the mean. x counts from half a cell."""
    n = heights.shape[1]
    c = 2 * np.fft.rfft(heights, axis=1) / n
    c[:, 0] /= 2
    return c * np.exp(-1j * np.pi * np.arange(c.shape[1]) / n)


def spectrum(c):
    """Mean power [mode]; 0 in mode 0, and the shortest wave of the grid (which has no phase) is left out."""
    power = (np.abs(c) ** 2).mean(axis=0) / 2
    power[0] = 0
    return power[:-1]


def flip(c, cycles):
    """Correlation of amplitudes [moment][mode] with those a period later: -1 where the wave turns over at every period,
    1 where it stays, 0 for noise."""
    at = np.flatnonzero(np.diff(cycles) == 1)
    here, later = c[at], c[at + 1]
    scale = ((np.abs(here) ** 2 + np.abs(later) ** 2) / 2).sum(axis=0)
    return (later * here.conj()).real.sum(axis=0) / np.where(scale > 0, scale, 1)


def alternating(c, cycles):
    """Half the differences [moment][mode] of amplitudes of cycles that follow each other."""
    at = np.flatnonzero(np.diff(cycles) == 1)
    if not len(at):
        raise ValueError("no two cycles of the same phase follow each other")
    return (c[at] - c[at + 1]) / 2


def jumps(c, cycles):
    """Phase (0..2 pi) by which a mode's amplitude [moment] turns from one period to the next."""
    at = np.flatnonzero(np.diff(cycles) == 1)
    return np.angle(c[at + 1] / c[at]) % (2 * np.pi)


def measure(samples, length):
    """What stands in samples [(cycles, amplitudes [cycle][mode])], one for each phase: a dictionary of

    power, floor     of the alternating part, mean over all phases [mode]; median of it
    mode, wavelength of the highest power; `longer`, `shorter`: the next that fit the box, the uncertainty
    centroid, spread wavelength of the mean wave number of what exceeds the floor (by three errors) from half to one
                     and a half times that of the peak (harmonics are not the pattern's), and its deviation
    contrast, flip   of the peak over the floor; correlation from period to period, of the phase where it is highest
    phase            index of that phase in samples
    stands           whether a pattern stands
    """
    powers = np.array([spectrum(alternating(c, cycles)) for cycles, c in samples])
    power = powers.mean(axis=0)
    floor = np.median(power[1:])
    k = int(np.argmax(power))
    best = int(np.argmax(powers[:, k]))
    turned = float(flip(samples[best][1][:, k], samples[best][0]))
    error = 3 / np.sqrt(min(len(n) for n, _ in samples))
    number = np.arange(len(power))
    window = (number >= 0.5 * k) & (number <= 1.5 * k) & (number > 0)
    excess = np.where(window, np.maximum(power - floor * (1 + error), 0), 0)
    result = {"power": power, "floor": floor, "mode": k, "wavelength": length / k, "shorter": length / (k + 1),
              "longer": length / (k - 1) if k > 1 else np.inf, "contrast": power[k] / floor if floor > 0 else np.inf,
              "flip": turned, "phase": best, "centroid": np.nan, "spread": np.nan}
    if excess.sum() > 0:
        mean = (number * excess).sum() / excess.sum()
        waves = length / np.maximum(number, 1)
        result["centroid"] = length / mean
        result["spread"] = np.sqrt((excess * (waves - length / mean) ** 2).sum() / excess.sum())
    result["stands"] = bool(result["contrast"] >= CONTRAST and turned <= FLIP)
    return result


def strongest(samples, length):
    """Mean and deviation of the wavelength that is strongest at each moment: the estimator not to use."""
    waves = np.concatenate([length / (1 + np.argmax(np.abs(c[:, 1:-1]), axis=1)) for _, c in samples])
    return waves.mean(), waves.std()


def growth(cycles, amplitude, floor=0.0):
    """Factor per cycle of a mode's amplitude [cycle] between three times its noise and half of where it ends (median of
    the last third), with the first and last cycle used; nan when fewer than four cycles lie between."""
    cycles, amplitude = np.asarray(cycles), np.asarray(amplitude)
    top = np.median(amplitude[-max(len(amplitude) // 3, 1):])
    past = np.flatnonzero(amplitude > top / 2)
    end = past[0] if len(past) else len(amplitude)
    below = np.flatnonzero(amplitude[:end] < 3 * floor)
    start = below[-1] + 1 if len(below) else 0
    if end - start < 4:
        return np.nan, None, None
    slope = np.polyfit(cycles[start:end], np.log(amplitude[start:end]), 1)[0]
    return float(np.exp(slope)), int(cycles[start]), int(cycles[end - 1])


def fastest(wavelengths, factors):
    """Wavelength of the greatest growth: of the parabola through three neighbours, in the wave number."""
    a, b, _ = np.polyfit(1 / np.asarray(wavelengths), np.log(factors), 2)
    return -2 * a / b if a < 0 else np.nan


def samples(layer, first=0.0, last=np.inf, of="mass"):
    """{phase: (cycles, amplitudes)} of what a case has written."""
    take = getattr(layer, of)
    return {phase: (np.array(cycles), modes(np.array([take(t) for t in times])))
            for phase, (cycles, times) in layer.phases(first, last).items()}


def describe(result):
    """One line."""
    kind = "pattern" if result["stands"] else "no pattern"
    return (f"{kind}: wavelength {result['wavelength']:.4g} ({result['shorter']:.4g} .. {result['longer']:.4g}), centroid "
            f"{result['centroid']:.4g} +- {result['spread']:.2g}, {result['contrast']:.3g} times the floor, "
            f"flip {result['flip']:.2f}")


def draw(layer, found, result, path, of="mass"):
    """What was measured at the phase of the highest power over place and cycle, and the spectrum."""
    from haff.plot import figures
    figure, axes = figures.panels(1, 2)
    cycles_over_place(figure, axes[0][0], layer, list(found)[result["phase"]], of)
    spectra(axes[0][1], [("", layer.length, result)])
    figures.save(figure, path)


def cycles_over_place(figure, axes, layer, phase, of="mass", unit=r"\sigma"):
    from haff.plot import figures
    cycles, names = layer.phases()[phase]
    values = np.array([getattr(layer, of)(name) for name in names])
    low, high = np.percentile(values, (1, 99))
    shown = axes.pcolormesh(layer.x, cycles, values, cmap="magma_r", vmin=low, vmax=high, rasterized=True)
    figure.colorbar(shown, ax=axes, label="mass over its mean" if of == "mass" else f"{of} (${unit}$)")
    figures.label(axes, f"$x$ (${unit}$)", "cycle", f"at {phase:.2f} $T$ of every cycle")


def spectra(axes, entries, unit=r"\sigma"):
    """Spectra [(label, length, result)] over the wavelength, floors dotted."""
    from haff.plot import figures
    for label, length, result in entries:
        waves = length / np.arange(1, len(result["power"]))
        line, = axes.loglog(waves, result["power"][1:], marker=".", markersize=3, label=label)
        axes.axhline(result["floor"], color=line.get_color(), linewidth=0.7, linestyle=":")
    figures.label(axes, rf"wavelength (${unit}$)", "power")
    if any(label for label, _, _ in entries):
        axes.legend()


def main():
    parser = command.parser(__doc__)
    parser.add_argument("case")
    parser.add_argument("-from", dest="first", type=float, default=0.0, metavar="CYCLE")
    parser.add_argument("-to", dest="last", type=float, default=np.inf, metavar="CYCLE")
    parser.add_argument("-of", choices=("mass", "lift", "height"), default="mass")
    parser.add_argument("-figure")
    wanted = parser.parse_args()
    layer = Layer(wanted.case)
    if len(layer.x) < 8:
        parser.exit(1, f"{wanted.case}: the layer is {len(layer.x)} cells wide; waves want 8 or more\n")
    found = samples(layer, wanted.first, wanted.last, wanted.of)
    if not found:
        parser.exit(1, f"{wanted.case}: no phase of the shaking was written in three cycles or more\n")
    result = measure(list(found.values()), layer.length)
    print(describe(result))
    phase = list(found)[result["phase"]]
    cycles, c = found[phase]
    factor, first, last = growth(cycles, np.abs(c[:, result["mode"]]), np.sqrt(2 * result["floor"]))
    height = np.mean([layer.height(name).mean() for name in layer.phases(wanted.first, wanted.last)[phase][1]])
    print(f"phase {phase:.3f} of the period, cycles {cycles[0]} to {cycles[-1]}: amplitude of {wanted.of} "
          f"{np.abs(c[:, result['mode']]).mean():.4g}, mean height of the columns {height:.4g}")
    if np.isfinite(factor):
        print(f"growth {factor:.4g} per cycle (cycles {first} to {last})")
    if wanted.figure:
        draw(layer, found, result, wanted.figure, wanted.of)


if __name__ == "__main__":
    main()
