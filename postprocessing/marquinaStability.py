"""Linear stability of Marquina's flux on uniform gas, from its formulas; and growth rates measured with granularGas.

    marquinaStability.py FIGURE.png      table on stdout, figure
    marquinaStability.py --check         onset of the formulas against a few runs; exit code 1 if they disagree

reports/marquinaStability.md has the derivation. A rate is in units of c/h: amplitudes grow as exp(rate c t / h).
"""
import os
import subprocess
import sys
import tempfile

import numpy as np

import boxes
import haff
from eos import GoldshteinShapiro, PerfectGas

TOP = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
FLUXES = ("common", "Marquina", "MarquinaStable")


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


def symbols(eos, nu, mach, flux, reconstruct):
    """h/c d/dt of Fourier modes exp(i k x/h), one matrix for each of WAVES."""
    A, M = matrices(eos, nu, mach, flux)
    for k in WAVES:
        left, right = faces(reconstruct, k)
        yield -(1 - np.exp(-1j * k)) * (A * (left + right) - M * (right - left)) / 2


def growth(eos, nu, mach=0.0, flux="Marquina", reconstruct="firstOrder", courant=0.0):
    """The largest rate over all waves; with SSP-RK3 of a Courant number dt (|u| + c)/h, or exact in time (0)."""
    rates, dt = [], courant / (1 + abs(mach))
    for S in symbols(eos, nu, mach, flux, reconstruct):
        values = np.linalg.eigvals(S)
        z = values * dt
        rates.append(np.log(abs(1 + z + z**2 / 2 + z**3 / 6)).max() / dt if courant else values.real.max())
    return max(rates)


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


def program(name):
    return os.path.join(os.environ.get("HAFF_BIN", os.path.join(TOP, "build", "bin")), name)


def measured(nu, mach, flux, reconstruct="firstOrder", e=1.0, printed=False, courant=0.1, cells=40, noise=1e-7, pieces=8,
             sound_steps=400.0, seed=1):
    """The rate of granularGas: 1e-7 of noise in periodic uniform gas, over the part of the run in which it grows as an
    exponential and is still small. nan: the run came to an end before that."""
    eos = PrintedSound(e) if printed else GoldshteinShapiro(e)
    rho, c = eos.rho(nu), eos.c(eos.rho(nu), 1.0)
    random = np.random.default_rng(seed).uniform(-noise, noise, (3, cells))
    end = sound_steps / c / (1 + mach)  # h = 1
    with tempfile.TemporaryDirectory() as folder:
        case = boxes.box_case(folder, (cells, 1, 1), (float(cells), 1.0, 1.0), rho * (1 + random[0]),
                              np.outer(mach * c + c * random[1], (1, 0, 0)), eos.p(rho, 1.0) * (1 + random[2]), end, flux=flux,
                              reconstruct=reconstruct, e=e, types={"x": "cyclic"}, courant=courant, interval=end / pieces)
        if printed:
            path = os.path.join(case, "constant", "granularProperties")
            with open(path) as f:
                text = f.read().replace("Coeffs {", "Coeffs { printedSoundSpeed yes;")
            with open(path, "w") as f:
                f.write(text)
        subprocess.run([program("granularGas"), "-case", case], capture_output=True)
        result = haff.Case(case)
        times = [float(t) for t in result.times]
        size = [np.abs(result.field("rho", t) / rho - 1).max() for t in result.times]
    print(nu, mach, flux, times, size, file=sys.stderr) if os.environ.get("MQDEBUG") else None
    return np.array(times) * c, np.array(size)
