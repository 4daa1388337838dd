# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear stability of Marquina's flux on uniform gas, from its formulas; and growth rates measured with granularGas.

    haff marquinaStability FIGURE.png      tables on stdout, figure; a minute or two
    haff marquinaStability -check     formulas against a few runs; exit code 1 where a rate differs by 5 % or noise grows in
                                      MarquinaStable (tests/postprocessing does the same, and more)

reports/marquinaStability.md has the derivation. A rate is in units of c/h: amplitudes grow as exp(rate c t / h).
"""
import os
import subprocess
import sys
import tempfile

import numpy as np

import haff
from haff import command
from haff.paths import program
from studies.exact.eos import GoldshteinShapiro
from studies.made import boxes
from studies.source import measured_by




class PrintedSound(GoldshteinShapiro):
    """The sound speed, and it alone, with the paper's A' (half of dA/drho)."""

    def c_over_root_T(self, rho):
        A = self.A(rho)
        return np.sqrt(A + self.rho_dA(rho) / 2 + (self.gamma - 1) * A**2)


def characteristic(eos, U):
    """R, L, speeds and flux of a state (rho, momentum, energy); complex states are differentiated by it."""
    rho, u = U[0], U[1] / U[0]
    eps = U[2] / rho - u * u / 2
    T = (eos.gamma - 1) * eps
    p, c, H = eos.p(rho, T), eos.c(rho, T), eps + eos.p(rho, T) / rho + u * u / 2
    b1 = (eos.gamma - 1) * eos.A(rho) / c**2
    b2 = 1 + b1 * (u * u - H)
    R = np.array([[1, 1, 1], [u - c, u, u + c], [H - u * c, H - 1 / b1, H + u * c]])
    L = np.array([[b2 / 2 + u / (2 * c), -b1 * u / 2 - 1 / (2 * c), b1 / 2], [1 - b2, b1 * u, -b1],
                  [b2 / 2 - u / (2 * c), -b1 * u / 2 + 1 / (2 * c), b1 / 2]])
    return R, L, np.array([u - c, u, u + c]), np.array([rho * u, rho * u * u + p, u * (U[2] + p)])


def jacobian(function, U):
    """By complex steps."""
    return np.stack([function(U + 1e-30j * unit).imag / 1e-30 for unit in np.eye(3)], axis=1)


def uniform(eos, nu, mach):
    """The state of T = 1 in units of mass of its density, and its sound speed."""
    rho = eos.rho(nu)
    c = eos.c(rho, 1.0)
    return np.array([rho, rho * mach * c, rho * (1 / (eos.gamma - 1) + (mach * c) ** 2 / 2)]), c


def matrices(eos, nu, mach, flux="Marquina"):
    """A = df/dU and M of F = (f_l + f_r)/2 - M (U_r - U_l)/2, over c. `common`: M = R |Lambda| L. `Marquina`: fields run
    with the signs s of their speeds, F = sum over p of P_p(u_side) f(u_side), so M = d/dU of sum s_p P_p(U) f(U)."""
    U, c = uniform(eos, nu, mach)
    R, L, speed, _ = characteristic(eos, U)
    sign = np.sign(np.round(speed / c, 12))

    def one_sided(state):
        R, L, _, f = characteristic(eos, state)
        return R @ (sign * (L @ f))

    A = jacobian(lambda state: characteristic(eos, state)[3], U)
    M = jacobian(one_sided, U) if flux == "Marquina" else R @ np.diag(abs(speed)) @ L
    scale = np.array([1, c, c * c])  # so that the entries are of one size
    return [scale * matrix / scale[:, None] / c for matrix in (A, M)]


def faces(reconstruct, k):
    """Fourier symbols of the values to the left and right of face 1/2; WENO5 with its linear weights."""
    weights = {"firstOrder": (0, 0, 1, 0, 0), "WENO5": np.array((2, -13, 47, 27, -3)) / 60}[reconstruct]
    m = np.arange(-2, 3)
    return weights @ np.exp(1j * k * m), weights @ np.exp(1j * k * (1 - m))


WAVES = np.concatenate([np.linspace(0.01, 0.2, 20), np.linspace(0.2, np.pi, 200)])
CELLS = 40  # of the runs


def symbol(A, M, reconstruct, k):
    """h/c d/dt of the Fourier mode exp(i k x/h), as a matrix."""
    left, right = faces(reconstruct, k)
    return -(1 - np.exp(-1j * k)) * (A * (left + right) - M * (right - left)) / 2


def rates(values, dt):
    """Of eigenvalues of symbols: exact in time (dt = 0) or with SSP-RK3 of dt in units of h/c."""
    z = values * dt
    return np.log(abs(1 + z + z**2 / 2 + z**3 / 6)) / dt if dt else values.real


def growth(eos, nu, mach=0.0, flux="Marquina", reconstruct="firstOrder", courant=0.0):
    """The largest rate over all waves. courant: dt (|u| + c)/h of SSP-RK3."""
    A, M = matrices(eos, nu, mach, flux)
    return max(rates(np.linalg.eigvals(symbol(A, M, reconstruct, k)), courant / (1 + abs(mach))).max() for k in WAVES)


def worst_wave(eos, nu, mach, reconstruct, courant):
    """Of Marquina's flux, among those that fit in CELLS: rate, k and the complex vector (rho, momentum, energy)."""
    A, M = matrices(eos, nu, mach)
    c, best = uniform(eos, nu, mach)[1], (-np.inf,)
    for k in 2 * np.pi / CELLS * np.arange(1, CELLS // 2):
        values, vectors = np.linalg.eig(symbol(A, M, reconstruct, k))
        rate = rates(values, courant / (1 + abs(mach)))
        best = max(best, (rate.max(), k, tuple(vectors[:, rate.argmax()] * (1, c, c * c))))
    return best


def onset(eos, mach=0.0, low=0.02, high=0.64, least=1e-3, **scheme):
    """The smallest volume fraction at which a rate exceeds `least`; nan: none."""
    if growth(eos, high, mach, **scheme) < least:
        return np.nan
    while high - low > 1e-4:
        middle = (low + high) / 2
        low, high = (low, middle) if growth(eos, middle, mach, **scheme) > least else (middle, high)
    return high


def rest_determinant(eos, nu):
    """Sign of det M of density and energy at rest: 2 dln(rho A/sqrt C)/dln rho - (dln A/dln rho) A/(1/(gamma-1) + A)."""
    rho = eos.rho(nu)
    slope = lambda f: (np.log(f(rho * (1 + 1e-30j))) / 1e-30).imag
    phi = slope(lambda r: r * eos.A(r) / eos.c_over_root_T(r))
    return 2 * phi - slope(eos.A) * eos.A(rho) / (1 / (eos.gamma - 1) + eos.A(rho))


def run(eos, nu, mach, dU, flux, reconstruct, courant, sound_steps, pieces=16):
    """Periodic uniform gas plus dU [3][CELLS], T = 1, h = 1, by granularGas: times in units of h/c, and the root mean
    square of the change of rho over rho at each."""
    U, c = uniform(eos, nu, mach)
    rho, u = U[0] + dU[0], (U[1] + dU[1]) / (U[0] + dU[0])
    T = (eos.gamma - 1) * ((U[2] + dU[2]) / rho - u * u / 2)
    with tempfile.TemporaryDirectory() as folder:
        case = boxes.box_case(folder, (CELLS, 1, 1), (float(CELLS), 1.0, 1.0), rho, np.outer(u, (1, 0, 0)), eos.p(rho, T),
                              sound_steps / c, flux=flux, reconstruct=reconstruct, e=eos.e, types={"x": "cyclic"},
                              courant=courant, interval=sound_steps / c / pieces)
        if isinstance(eos, PrintedSound):
            path = os.path.join(case, "constant", "granularProperties")
            with open(path) as f:
                text = f.read().replace("Coeffs {", "Coeffs { printedSoundSpeed yes;")
            with open(path, "w") as f:
                f.write(text)
        subprocess.run([program("granularGas"), "-case", case], capture_output=True)
        result = haff.Case(case)
        size = [np.sqrt(np.mean((result.field("rho", t) / U[0] - 1) ** 2)) for t in result.times]
        return np.array([float(t) for t in result.times]) * c, np.array(size)


def noise(eos, nu, mach=0.0, flux="Marquina", reconstruct="firstOrder", courant=0.2, sound_steps=200.0, size=1e-7):
    """Noise of rho at the end of a run over that at its start."""
    U, _ = uniform(eos, nu, mach)
    dU = U[0] * characteristic(eos, U)[0] @ np.random.default_rng(1).uniform(-size, size, (3, CELLS))
    _, sizes = run(eos, nu, mach, dU, flux, reconstruct, courant, sound_steps)
    return sizes[-1] / sizes[0]


def run_worst(eos, nu, mach, flux, reconstruct, courant, end, size=1e-9):
    """run() with the worst wave of Marquina's flux; times, sizes and the rate of the formulas. end: None: e^5 of it."""
    rate, k, vector = worst_wave(eos, nu, mach, reconstruct, courant)
    wave = (np.array(vector)[:, None] * np.exp(1j * k * np.arange(CELLS))).real
    wave *= size * uniform(eos, nu, mach)[0][0] / abs(wave[0]).max()
    times, sizes = run(eos, nu, mach, wave, flux, reconstruct, courant, end or min(60.0, 5 / abs(rate)))
    return times, sizes, rate


def measured(eos, nu, mach=0.0, reconstruct="firstOrder", courant=0.2):
    """The rate of the worst wave of Marquina's flux in granularGas, and that of the formulas."""
    times, sizes, rate = run_worst(eos, nu, mach, "Marquina", reconstruct, courant, None)
    return np.polyfit(times, np.log(sizes), 1)[0], rate


def kept(eos, nu, mach=0.0, reconstruct="firstOrder", courant=0.2):
    """What MarquinaStable keeps of that wave after 45 to 60 h/c."""
    _, sizes, _ = run_worst(eos, nu, mach, "MarquinaStable", reconstruct, courant, 60.0)
    return sizes[-4:].max() / sizes[0]


GASES = {"correct A'": GoldshteinShapiro, "printed A'": PrintedSound}
MACHS = (0.0, 0.1, 0.3, 0.5, 0.7, 0.9)


def onsets():
    print(measured_by("haff marquinaStability") + "\n")
    print("| onset alpha | " + " | ".join(f"Mach {m:g}" for m in MACHS) + " |\n|---" + "|---" * len(MACHS) + "|")
    for name, gas in GASES.items():
        for e in (1.0, 0.9, 0.2):
            values = [onset(gas(e), mach) for mach in MACHS]
            print(f"| {name}, e = {e:g} | " + " | ".join(f"{v:.3f}" for v in values) + " |")


def figure(path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plot, axes = plt.subplots(1, 2, figsize=(11, 4.2), sharey=True)
    print("\n" + measured_by("haff marquinaStability") + "\n")
    print("| scheme | Mach | alpha | rate, formulas | program | MarquinaStable keeps |\n|---|---|---|---|---|---|")
    for ax, reconstruct in zip(axes, ("firstOrder", "WENO5")):
        for i, mach in enumerate((0.0, 0.3, 0.7)):
            for style, (name, gas) in zip(("-", ":"), GASES.items()):
                nu = np.linspace(0.2, 0.62, 85)
                ax.plot(nu, [worst_wave(gas(1.0), n, mach, reconstruct, 0.2)[0] for n in nu], f"C{i}{style}", lw=1.2,
                        label=f"Mach {mach:g}, {name}")
            for n in (0.25, 0.3, 0.35, 0.4, 0.425, 0.45, 0.475, 0.5, 0.55, 0.6):
                rate, formulas = measured(GoldshteinShapiro(1.0), n, mach, reconstruct)
                left = f"{kept(GoldshteinShapiro(1.0), n, mach, reconstruct):.1e}" if formulas > 1e-3 else ""
                ax.plot(n, rate, f"C{i}o", ms=5, label="program, correct A'" if n == 0.25 and not i else None)
                print(f"| {reconstruct} | {mach:g} | {n:g} | {formulas:.4f} | {rate:.4f} | {left} |", flush=True)
        ax.axhline(0, color="0.6", lw=0.8)
        ax.set(title=reconstruct, xlabel="volume fraction", ylim=(-0.05, 10))
        ax.set_yscale("symlog", linthresh=0.02)
    axes[0].set_ylabel("growth rate of the worst wave, c/h")
    axes[0].legend(fontsize=7, loc="upper left")
    plot.tight_layout()
    plot.savefig(path, dpi=110)


def check():
    gas, failed = GoldshteinShapiro(1.0), False
    for nu, mach, reconstruct in ((0.6, 0.0, "firstOrder"), (0.42, 0.3, "firstOrder"), (0.55, 0.2, "WENO5")):
        rate, formulas = measured(gas, nu, mach, reconstruct)
        stable = noise(gas, nu, mach, "MarquinaStable", reconstruct)
        good = abs(rate / formulas - 1) < 0.05 and stable < 1
        print(f"alpha {nu:g} Mach {mach:g} {reconstruct}: rate {rate:.4f}, formulas {formulas:.4f}; MarquinaStable: noise "
              f"to {stable:.3f} of its start: {'good' if good else 'WRONG'}")
        failed |= not good
    return failed


def main():
    parser = command.parser(__doc__)
    parser.add_argument("figure", nargs="?", help="written; png, pdf or svg")
    parser.add_argument("-check", action="store_true")
    o = parser.parse_args()
    if o.check:
        sys.exit(check())
    if not o.figure:
        parser.error("name the figure to write, or -check")
    onsets()
    figure(o.figure)


if __name__ == "__main__":
    main()
