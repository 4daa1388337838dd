#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gas and grains side by side: Figs. 2 and 4 to 8 of Carrillo et al. from two runs of the same row.

    haff faradayFigures GAS GRAINS FOLDER [-gas CYCLE] [-grains CYCLE] [-only patterns|profiles|mach|momentum]

GAS: a row of faradayDiagram.py -keep; GRAINS: of ../cases/faradayMD/table1.py -keep; both are written at quarters of the
period, and taken from those cycles on (default 14 and 20). Moments are those of two periods that begin, t = 0, where the plate
passes its middle upwards and the grains lie compressed on it. Writes to FOLDER

    patterns.png   packing at eight moments (Fig. 2)
    profiles.png   packing and rho T/(g diameter) over the height, where a heap lies at t = 0 (Figs. 4, 6)
    mach.png       Mach number and height where the packing is 5 %, there and where a valley lies (Fig. 5)
    momentum.png   momentum over packing at four moments (Figs. 7, 8)

and prints the numbers; `./Allrun faraday fig2` and its like make both runs and call this with -only. Pictures show the last pair of periods of the gas, and the mean of the last four of the grains (the paper: of 25),
whose wave wanders. Profiles are means over all pairs, of the columns where a heap (a valley) lies at the first moment of each; U and T of a row
are those of all mass in it.
"""
import os

import numpy as np

from haff import command
from haff.layers import faraday
from haff.plot import figures
from studies.exact import disks

WIDTH, HEIGHT, GRAVITY = 120, 26, 981.0
NAMES = ("gas", "grains")


class Run:
    """A row's case: pairs of cycles from `first` on, with heaps and with valleys; pictures are means of the last `many`."""

    def __init__(self, path, first, many):
        self.layer = faraday.Layer(path)
        self.gas = disks.Disks.of(path)
        self.mode, self.heaps = faraday.pairs(self.layer, first)
        self.valleys = faraday.pairs(self.layer, first, heaps=False)[1]
        self.phases = sorted(self.heaps[0][0])
        self.pairs = [names for names, _ in self.heaps[-many:]]

    def profile(self, phase, valleys=False):
        chosen = self.valleys if valleys else self.heaps
        return self.layer.profile([names[phase] for names, _ in chosen], [mask for _, mask in chosen])

    def origin(self):
        """Index of the column half a wave before a heap at the start of the pairs shown: pictures begin there."""
        c = faraday.modes(np.array([self.layer.mass(names[0]) for names in self.pairs]).mean(axis=0)[None])[0]
        place = -np.angle(c[self.mode]) / (2 * np.pi) * self.layer.length / self.mode
        return int(np.searchsorted(self.layer.x, (place - 0.5 * self.layer.length / self.mode) % self.layer.length))

    def shown(self, phase, momentum=False):
        """Mean packing [x][up], or momentum along x and up times it [2][x][up], from the origin on."""
        layer, sum = self.layer, 0
        for names in self.pairs:
            alpha = layer.field("alpha", names[phase])[:, :, 0]
            U = layer.field("U", names[phase])[:, :, 0] if momentum else None
            sum = sum + (np.stack([alpha * U[:, :, k] for k in (layer.along, layer.up)]) if momentum else alpha)
        return np.roll(sum / len(self.pairs), -self.origin(), axis=1 if momentum else 0)


def boxes(rows):
    """A figure of that many moments, gas and grains side by side."""
    fig, axes = figures.plt.subplots(rows, 2, figsize=(9, 0.85 * rows + 0.8), sharex=True, sharey=True, squeeze=False, layout="constrained")
    for ax in axes[-1]:
        ax.set_xlabel(r"$x$ ($\sigma$)")
    for ax in axes[:, 0]:
        ax.set_ylabel(r"$y$ ($\sigma$)")
    return fig, axes


def packing(ax, run, phase, name, **colours):
    shown = ax.pcolormesh(run.layer.x, run.layer.y, run.shown(phase).T, shading="gouraud", rasterized=True, **colours)
    ax.set(xlim=(0, WIDTH), ylim=(0, HEIGHT), aspect="equal", xticks=np.arange(0, WIDTH + 1, 40))
    ax.text(0.01, 0.93, f"{name}, $t$ = {phase:g} $T$", transform=ax.transAxes, va="top", fontsize=8,
            bbox={"facecolor": "w", "edgecolor": "none", "pad": 1.5, "alpha": 0.8})
    return shown


def patterns(runs, folder):
    fig, axes = boxes(8)
    for row, phase in zip(axes, runs[0].phases):
        for ax, run, name in zip(row, runs, NAMES):
            shown = packing(ax, run, phase, name, cmap="magma_r", vmin=0, vmax=0.82)
    fig.colorbar(shown, ax=axes, label=r"$\alpha$", shrink=0.4, pad=0.01)
    figures.save(fig, os.path.join(folder, "patterns.png"))


def profiles(runs, folder):
    fig, axes = figures.panels(2, 4, width=8, height=2.1)
    for k, (phase, ax) in enumerate(zip(runs[0].phases, axes.flat)):
        for run, name, colour in zip(runs, NAMES, figures.COLOURS):
            p = run.profile(phase)
            energy = 4 / np.pi * p["alpha"] * p["T"] / GRAVITY
            ax.plot(p["y"], p["alpha"], color=colour, label=rf"$\alpha$, {name}")
            ax.plot(p["y"], energy, "--", color=colour, label=rf"$\rho T/\sigma g$, {name}")
            valley = run.profile(phase, valleys=True)
            print(f"{name:6s} t = {phase:4.2f} T: heap at t = 0: at the plate {p['alpha'][0]:.3f}, greatest {p['alpha'].max():.3f} at "
                  f"{p['y'][np.argmax(p['alpha'])]:.1f}, rho T/g {energy.max():.3f}; valley: at the plate {valley['alpha'][0]:.3f}, greatest "
                  f"{valley['alpha'].max():.3f}")
        ax.set(xlim=(0, 25), ylim=(0, 2.5))
        figures.label(ax, r"$y$ ($\sigma$)" if k > 3 else "", "", f"$t$ = {phase:g} $T$")
    axes[0][0].legend(fontsize=6)
    figures.save(fig, os.path.join(folder, "profiles.png"))


def mach(runs, folder):
    fig, axes = figures.panels(1, 2, height=2.6)
    for ax, run, name in zip(axes[0], runs, NAMES):
        for valleys, colour in ((False, figures.COLOURS[0]), (True, figures.COLOURS[1])):
            found = np.array([faraday.interface(run.profile(phase, valleys), run.gas) for phase in run.phases])
            there = "valley" if valleys else "heap"
            ax.plot(run.phases, found[:, 1], marker="o", markersize=3, color=colour, label=f"Mach number, {there} at $t$ = 0")
            ax.plot(run.phases, found[:, 0] / 10, "--", color=colour, label=r"height/10 $\sigma$")
            print(f"{name:6s} at a packing of 5 %, {there} at t = 0: Mach " + ", ".join(f"{m:.2f}" for m in found[:, 1])
                  + "; height " + ", ".join(f"{y:.1f}" for y in found[:, 0]))
        ax.set(xlim=(0, 2), ylim=(0, 6))
        figures.label(ax, "$t/T$", "", f"{name}, where the packing is 5 %")
    axes[0][0].legend(fontsize=6, ncols=2, loc="upper center")
    figures.save(fig, os.path.join(folder, "mach.png"))


def momentum(runs, folder):
    """Arrows of packing times velocity, in one scale, from every second cell both ways."""
    fig, axes = boxes(4)
    greatest = {}
    for row, phase in zip(axes, runs[0].phases[::2]):
        for ax, run, name in zip(row, runs, NAMES):
            layer, m = run.layer, run.shown(phase, momentum=True)
            shown = packing(ax, run, phase, name, cmap="Greys", vmin=0, vmax=1.2)
            cells = np.s_[:, ::2, ::2]
            ax.quiver(layer.x[::2], layer.y[::2], m[cells][0].T, m[cells][1].T, scale=20 * np.sqrt(GRAVITY), width=1.2e-3, color=figures.COLOURS[1])
            greatest[name] = max(greatest.get(name, 0), float(np.hypot(*m).max()) / np.sqrt(GRAVITY))
    fig.colorbar(shown, ax=axes, label=r"$\alpha$", shrink=0.6, pad=0.01)
    print("greatest momentum, alpha |U|/sqrt(g diameter): " + ", ".join(f"{k} {v:.2f}" for k, v in greatest.items()))
    figures.save(fig, os.path.join(folder, "momentum.png"))


DRAWN = patterns, profiles, mach, momentum


def main():
    parser = command.parser(__doc__)
    parser.add_argument("gas")
    parser.add_argument("grains")
    parser.add_argument("folder")
    parser.add_argument("-gas", dest="first_gas", type=float, default=14, metavar="CYCLE")
    parser.add_argument("-grains", dest="first_grains", type=float, default=20, metavar="CYCLE")
    parser.add_argument("-only", choices=[draw.__name__ for draw in DRAWN], help="one of the pictures")
    o = parser.parse_args()
    os.makedirs(o.folder, exist_ok=True)
    runs = [Run(o.gas, o.first_gas, 1), Run(o.grains, o.first_grains, 4)]
    for draw in DRAWN:
        if o.only in (None, draw.__name__):
            draw(runs, o.folder)


if __name__ == "__main__":
    main()
