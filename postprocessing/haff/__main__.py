# SPDX-License-Identifier: GPL-3.0-or-later
"""What can be called from the command line.

    haff                 this list
    haff COMMAND -help   what a command does
    haff -version        version, programs, licence
"""
import os
import runpy
import sys

from haff import command, paths

COMMANDS = {
    "newCase": ("haff.start.newCase", "a new case around a geometry of gmsh; also called newCase"),
    "fromOpenFOAM": ("haff.openfoam.fromOpenFOAM", "a case of rhoCentralFoam, rhoPimpleFoam or sonicFoam as a case of haff"),
    "Plot": ("haff.plot.plotCase", "a picture of any field of a case; also called haffPlot"),
    "Movie": ("haff.plot.movie", "a film of a field; also called haffMovie"),
    "turn": ("haff.plot.turn", "an axisymmetric case turned about its axis, as VTK in 3D"),
    "Log": ("haff.plot.log", "how a run goes: time steps, extremes, drift, speed; also called haffLog"),
    "report": ("haff.report.report", "a report of a run as one HTML file: pictures, films, plots, provenance; of sweeps and of two cases, too"),
    "figure": ("haff.plot.script", "the figure of a shipped case, by its figure.py"),
    "expected": ("haff.runs.expected", "compares a finished case with its expected.json"),
    "run": ("haff.runs.runCase", "runs a case, or a copy of it with other entries"),
    "sweep": ("haff.runs.sweepCase", "runs a case with every combination of values of entries, several at once, and makes a table"),
    "ensemble": ("haff.runs.ensembleCase", "runs a case of granularMD with several seeds, and writes the means with their standard errors"),
    "contours": ("haff.plot.contours", "contour lines and walls of a lattice in two dimensions"),
    "columns": ("haff.layers.columns", "profiles over the height, of gas and grains, as a table"),
    "faraday": ("haff.layers.faraday", "patterns on shaken layers, of gas and grains"),
    "compare": ("haff.runs.compareCase", "two results beside each other: gas and grains, two grids, two codes"),
}
STUDIES = {  # of the source tree
    "checkCases": ("studies.checks.checkCases", "runs shipped cases in full and compares them with their expected.json (Allcheck)"),
    "faradayDiagram": ("studies.faradayDiagram", "Table 1 of Carrillo et al. by the gas"),
    "faradayOnset": ("studies.faradayOnset", "growth of single waves on a shaken layer"),
    "faradayFigures": ("studies.faradayFigures", "gas and grains on a shaken plate side by side"),
    "clustering": ("studies.measured.clustering", "gas and grains that cool in the same box"),
    "tutorials": ("studies.tutorials", "tutorials of OpenFOAM, converted, beside what OpenFOAM itself makes of them"),
    "workPrecision": ("studies.workPrecision", "run time against error of every scheme, and of rhoCentralFoam"),
    "denseShocks": ("studies.denseShocks", "dense gas and strong shocks against exact solutions, with and without rules of faces"),
    "scaling": ("studies.scaling", "a case on more ranks than are at hand, from the messages that it sends"),
    "crossCheck": ("studies.crossCheck", "an elastic case beside rhoCentralFoam"),
    "marquinaStability": ("studies.marquinaStability", "stability of Marquina's flux on uniform gas"),
    "segregationPrecision": ("studies.segregationPrecision", "run time against error of granularSegregation"),
    "serna": ("studies.serna", "the numbers of Serna & Marquina on several grids and by several fluxes"),
    "figure1": ("studies.figure1", "Fig. 1 of Serna & Marquina"),
    "riemann": ("studies.exact.riemann", "the exact solution of the blast of Serna & Marquina"),
    "obliqueShock": ("studies.exact.obliqueShock", "exact oblique shocks"),
    "layer": ("studies.exact.layer", "the shaken layer by a program independent of the solver"),
    "muI": ("studies.exact.muI", "steady flow down a rough slope by the law of Jop, Forterre & Pouliquen"),
    "segregation": ("studies.exact.segregation", "exact values of the segregation equation"),
}
ALL = {**COMMANDS, **STUDIES}


def listing(commands):
    return __doc__ + "\n" + "\n".join(f"  {name:22}{about}" for name, (_, about) in commands.items())


def run(module):
    if module.startswith("studies."):
        paths.find_studies()
    runpy.run_module(module, run_name="__main__")


def main():
    called = os.path.basename(sys.argv[0])
    name = called if called in ALL else called[4:] if called.startswith("haff") else ""
    words = sys.argv[1:] if name else sys.argv[2:]
    name = name or (sys.argv[1] if len(sys.argv) > 1 else "-help")
    if name in ("-help", "-h", "--help"):
        print(listing(ALL if paths.has_studies() else COMMANDS))
        return 0
    if name in ("-version", "--version"):
        print(command.version_text("haff"))
        return 0
    if name not in ALL:
        import difflib
        near = difflib.get_close_matches(name, ALL, 1, 0.5)
        print(f"haff: there is no command '{name}'{f'; did you mean {near[0]}?' if near else ''}  (haff -help lists them)", file=sys.stderr)
        return 2
    sys.argv = [called if called in (name, f"haff{name}") else f"haff {name}", *words]
    command.Reading.watch(words)
    return command.ended(sys.argv[0], lambda: run(ALL[name][0]))


if __name__ == "__main__":
    sys.exit(main())
