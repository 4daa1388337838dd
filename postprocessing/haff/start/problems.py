# SPDX-License-Identifier: GPL-3.0-or-later
"""The standard problems of the field as options of newCase: a chute, a silo, a column that collapses. Each is a geometry in grain
diameters, what its patches are, where the grains lie at the start, and what is measured."""
import dataclasses
import math

from haff.start import geometry

DIAMETER, GRAVITY = 1e-3, 9.81  # m, m/s^2, where none is given
BUDGET = "{ type energyBudget; writeControl timeStep; writeInterval 10; }"
FRICTION = "grains rub on each other, friction { type muI; } in constant/granularProperties"


@dataclasses.dataclass
class Problem:
    """geo: text of mesh.geo; kind: {patch: kind}; gravity: vector; start: expression of alpha, where {alpha} is filled in, or None: a layer
    on the floor, `depth` diameters deep; end: time; functions: [(name, dictionary, note)]; look: what haffPlot is to show;
    note: what the models do, and what they leave out."""
    geo: str
    kind: dict
    gravity: list
    end: float
    note: str
    start: str = None
    depth: float = None
    functions: tuple = ()
    look: str = ""


def chosen(o):
    """The Problem that the options name, whose grains get a diameter; None. ValueError."""
    named = [name for name in ("chute", "silo", "column") if getattr(o, name) is not None]
    if not named:
        return None
    given = [option for option in ("mesh", "box", "shaking") if getattr(o, option)]
    if named[1:] or given:
        raise ValueError(f"-{named[0]} is a whole problem: leave out  {'-' if named[1:] or given[0] != 'mesh' else ''}{(named[1:] or given)[0]}")
    if o.application != "granularGas":
        raise ValueError(f"-{named[0]} is a problem of granularGas: grains of {o.application} move in boxes")
    if o.gravity and (len(o.gravity) != 1 or not o.gravity[0]):
        raise ValueError(f"-{named[0]} has a direction of gravity of its own: give its size, as  -gravity {GRAVITY:g}")
    o.diameter = o.diameter or DIAMETER
    if not 0 < o.diameter < math.inf:
        raise ValueError(f"-diameter {o.diameter:g}: it is positive")
    o.transport = True
    g = abs(o.gravity[0]) if o.gravity else GRAVITY
    made = {"chute": chute, "silo": silo, "column": column}[named[0]](getattr(o, named[0]), o.diameter, g)
    o.gravity = made.gravity
    return made


def chute(angle, d, g):
    """A layer of 15 diameters that slides down a rough floor, periodic along it, in a frame that is inclined with it."""
    if not 0 < angle <= 60:
        raise ValueError(f"-chute {angle:g}: the angle of the floor, in degrees, above 0 and up to 60")
    a = math.radians(angle)
    return Problem(geometry.box([4 * d, 60 * d], [4, 60], ("left", "right", "floor", "top")), {"left": "periodic", "right": "periodic", "floor": "rough", "top": "outlet"},
                   [float(f"{g * math.sin(a):.6g}"), float(f"{-g * math.cos(a):.6g}"), 0.0], round_up(100 * math.sqrt(d / g)),
                   f"{FRICTION}: the layer rests below 21 degrees, flows steadily up to some 30, and speeds up above; real ones stop at an angle that depends on their depth",
                   depth=15, functions=(("budget", BUDGET, "mass, momentum and energy, and what changes them: is the flow steady?"),), look=" U.x")


def silo(opening, d, g):
    """A silo with a flat floor, 32 diameters wide and filled to 24, over a slot of that width in diameters and a room that is open downwards."""
    if not 4 <= opening <= 24 or opening % 2:
        raise ValueError(f"-silo {opening:g}: the width of the slot in grain diameters, an even number of 4 to 24")
    flow = f"{{ type surfaceFieldValue; fields (phi); regionType sampledSurface; operation sum; sampledSurfaceDict {{ type plane; basePoint (0 {-1.5 * d:g} 0); normalVector (0 -1 0); }} }}"
    return Problem(silo_geo(int(opening), d), {"wall": "wall", "lid": "wall", "outlet": "outlet"}, [0.0, -g, 0.0], round_up(20 * math.sqrt(d / g)),
                   f"{FRICTION}: it runs out steadily; no slot is ever blocked, and smooth walls bear no weight (frictionalSlip does)",
                   start=f"y > 0 && y < {24 * d:g} ? {{alpha}} : 1e-5", functions=(("discharge", flow, "flow rate: grains per second through the slot, over the thickness of the mesh"),
                              ("content", "{ type volFieldValue; fields (rho); operation volIntegrate; }", "grains that are left")))


def column(aspect, d, g):
    """A column 16 diameters wide and `aspect` times as high at the left end of a floor, which it runs out on."""
    if not 0.2 <= aspect <= 10:
        raise ValueError(f"-column {aspect:g}: height over width, 0.2 to 10")
    width, height = 16, max(round(16 * aspect), 4)
    long, high = width + 2 * max(height, width), round(1.25 * height) + 4
    return Problem(geometry.box([long * d, high * d], [long, high], ("left", "right", "floor", "top")), {"left": "wall", "right": "wall", "floor": "rough", "top": "wall"},
                   [0.0, -g, 0.0], round_up(5 * math.sqrt(2 * height * d / g)), f"{FRICTION}: the heap keeps its slope",
                   start=f"x < {width * d:g} && y < {height * d:g} ? {{alpha}} : 1e-5",
                   functions=(("budget", BUDGET, "mass, momentum and energy, and what changes them: is it at rest?"),))


def round_up(x):
    """x with two digits."""
    return float(f"{x:.1e}")


def silo_geo(opening, d):
    """mesh.geo of a silo: blocks of equal cells, one a diameter wide."""
    return f"""// A silo with a slot in its floor, over a room that is open downwards. Lengths in grain diameters d; N cells a diameter.
DefineConstant[ N = {{1, Min 1, Step 1, Name "cells in a diameter"}} ];
DefineConstant[ D = {{{opening}, Min 4, Max 24, Step 2, Name "width of the slot"}} ];
d = {d:.12g}; W = 32; H = 30; P = 3; R = 12; // widths of silo and slot, heights of silo, floor, room below

x[] = {{-W/2*d, -D/2*d, D/2*d, W/2*d}};   y[] = {{-(P + R)*d, -P*d, 0, H*d}};
nx[] = {{(W - D)/2*N, D*N, (W - D)/2*N}};   ny[] = {{R*N, P*N, H*N}};
For j In {{0:3}}
  For i In {{0:3}}
    Point(4*j + i + 1) = {{x[i], y[j], 0}};
  EndFor
EndFor
For j In {{0:3}}
  For i In {{0:2}}
    Line(100 + 10*j + i) = {{4*j + i + 1, 4*j + i + 2}};   Transfinite Curve {{100 + 10*j + i}} = nx[i] + 1;
  EndFor
EndFor
For j In {{0:2}}
  For i In {{0:3}}
    If (j != 1 || (i == 1 || i == 2))
      Line(200 + 10*j + i) = {{4*j + i + 1, 4*j + i + 5}};   Transfinite Curve {{200 + 10*j + i}} = ny[j] + 1;
    EndIf
  EndFor
EndFor
For j In {{0:2}}
  For i In {{0:2}}
    If (j != 1 || i == 1)
      Curve Loop(3*j + i + 1) = {{100 + 10*j + i, 200 + 10*j + i + 1, -(110 + 10*j + i), -(200 + 10*j + i)}};
      Plane Surface(3*j + i + 1) = {{3*j + i + 1}};
      Transfinite Surface {{3*j + i + 1}};   Recombine Surface {{3*j + i + 1}};
    EndIf
  EndFor
EndFor

Physical Curve("outlet") = {{100, 101, 102}};
Physical Curve("wall") = {{110, 112, 120, 122, 200, 203, 211, 212, 220, 223}};
Physical Curve("lid") = {{130, 131, 132}};
Physical Surface("gas") = {{1, 2, 3, 5, 7, 8, 9}};
"""
