# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers of a new case: grains, start, stream, gravity, times, from the options and the mesh."""
import math

import numpy as np

from haff.start import enskog

AXES = "xyz"


def rounded(x, digits=2):
    """x with that number of digits."""
    return float(f"{x:.{digits - 1}e}")


def sound_speed(alpha, e, d):
    """c/sqrt(T) of a dense gas of disks (d = 2) or spheres (3), by Torquato's contact value: c^2/T = d(alpha A)/d alpha + (gamma - 1) A^2 with
    p = rho T A and gamma - 1 = 2/d."""
    A = lambda x: float(enskog.pressure_factor(x, e, d))
    h = 1e-5 * alpha
    return math.sqrt(A(alpha) + alpha * (A(alpha + h) - A(alpha - h)) / (2 * h) + 2 / d * A(alpha) ** 2)


class Flow:
    """Everything that the files of the case say in numbers. o: the options; kind: {patch: kind}. ValueError."""

    def __init__(self, o, geometry, kind):
        self.o, self.geometry, self.kind = o, geometry, kind
        self.grains, self.soft = o.application in ("granularMD", "granularDEM"), o.application == "granularDEM"
        self.d = self.shape(o.grains)
        self.rough = "rough" in kind.values()
        if self.rough and self.soft:
            raise ValueError("a rough wall is one of granularGas; soft grains rub on any wall: leave out  =rough")
        if self.rough and self.grains:
            raise ValueError("a rough wall is one of granularGas; in granularMD walls are smooth")
        self.transport = (o.transport or self.rough) and not self.grains
        self.sticky = (self.transport or self.soft) and o.walls != "slip"
        self.g = self.gravity(o.gravity)
        self.open = [p for p in geometry.patches if kind[p.name] in ("inlet", "outlet", "open")]
        self.stream = any(kind[p.name] == "inlet" for p in self.open) or bool(self.open and (o.Mach or o.speed))
        self.plate = self.floor() if np.any(self.g) and not self.stream else None
        self.layer = self.plate is not None and not self.start
        self.lid = self.opened()
        self.friction = not self.grains and not o.shaking and not self.stream and bool(np.any(self.g)) and (self.plate is not None or bool(o.problem))
        self.falls = bool(np.any(self.g)) and not self.stream and self.plate is None  # it has no flat floor to lie on, as in a funnel
        self.restitution = o.restitution if o.restitution is not None else 0.95 if self.stream else 0.9
        self.alpha = o.alpha or (0.05 if self.stream else (0.8 if self.d == 2 else 0.6) if self.layer or self.start else 0.2)
        self.diameter = o.diameter or rounded(min(geometry.width / 4, geometry.least / 1.5))
        self.check()
        self.speeds()
        self.times()

    def shape(self, grains):
        """2 for disks, 3 for spheres."""
        solved = len(self.geometry.axes)
        if self.grains and solved == 1:
            raise ValueError(f"-application {self.o.application}: grains move in two or three dimensions, and the mesh has one")
        if self.grains and grains and (grains == "disks") != (solved == 2):
            raise ValueError(f"-application {self.o.application}: on {solved} solved axes grains are {'disks' if solved == 2 else 'spheres'}, so leave out  -grains {grains}")
        if grains == "disks" and solved == 3:
            raise ValueError("-grains disks: disks move in a plane, and the mesh has three dimensions; take spheres")
        return 2 if grains == "disks" or (self.grains and solved == 2) else 3

    def gravity(self, given):
        """The vector of gravity: of a number the magnitude counts, downwards; two components are along the solved axes of a plane."""
        g, axes = np.zeros(3), self.geometry.axes
        if given is None:
            return g
        if len(given) == 2 and len(axes) != 2:
            raise ValueError(f"-gravity {','.join(f'{x:g}' for x in given)}: {len(axes)} axes are solved; give a number, downwards, or X,Y,Z")
        if len(given) == 3:
            g[:] = given
        elif len(given) == 2:
            g[axes] = given
        else:
            g[axes[-1]] = -abs(given[0])
        if any(g[k] for k in range(3) if k not in axes):
            raise ValueError(f"-gravity {','.join(f'{x:g}' for x in given)}: the mesh has no {', '.join(AXES[k] for k in range(3) if k not in axes)}")
        return g

    @property
    def gravity_text(self):
        """One line for the terminal: where gravity points, and what was made of a number."""
        said = f"({' '.join(f'{x + 0.0:g}' for x in self.g)})"
        turned = len(self.o.gravity) == 1 and self.o.gravity[0] < 0
        return said + (f": the magnitude of {self.o.gravity[0]:g}, downwards; upwards is a vector" if turned else "")

    @property
    def plate_text(self):
        """One line for the terminal: how the plate moves that is shaken."""
        acceleration, omega = self.o.shaking[0] * float(np.linalg.norm(self.g)), 2 * math.pi * self.o.shaking[1]
        return f"moves by +-{acceleration / omega**2:.4g}, at most {acceleration / omega:.4g} fast, with {acceleration:.4g} of acceleration"

    @property
    def start(self):
        """The expression of alpha at the start that a problem brings with it, or None."""
        return self.o.problem and self.o.problem.start

    @property
    def down(self):
        """The axis across the floor or, without one, that gravity lies along."""
        return int(np.argmax(np.abs(self.g if self.plate is None else self.plate.normal)))

    @property
    def inclined(self):
        """Is gravity none of the axes?"""
        return np.count_nonzero(self.g) > 1

    @property
    def units(self):
        """(length, time) where gravity is the earth's in m or cm; else ("", ""), for nothing says what the numbers are measured in."""
        g = float(np.linalg.norm(self.g))
        return next(((length, "s") for length, earth in (("m", 9.81), ("cm", 981)) if abs(g / earth - 1) < 0.005), ("", ""))

    @property
    def settled(self):
        """Is the start a layer at rest by the equation of state? That wants a box, and gravity across its floor; else an expression lays the layer."""
        return self.layer and not self.inclined and self.geometry.box

    def floor(self):
        """The wall across an axis that gravity points to, within 60 degrees, or None."""
        towards = self.g / np.linalg.norm(self.g)
        walls = [p for p in self.geometry.patches if self.kind[p.name] in ("wall", "body", "rough") and p.plane and np.abs(p.normal).max() > 1 - 1e-6]
        found = max(walls, key=lambda p: p.normal @ towards, default=None)
        return found if found is not None and found.normal @ towards > 0.5 - 1e-6 else None

    def opened(self):
        """The name of the side over a layer that slides down an inclined floor, which becomes open unless -patch says what it is; None."""
        given = [entry.partition("=")[0] for entry in self.o.patch]
        over = [p.name for p in self.geometry.patches if self.layer and self.inclined and not self.grains and not self.o.problem and p.plane
                and p.normal @ self.plate.normal < -1 + 1e-6 and self.kind[p.name] == "wall" and p.name not in given]
        self.kind.update({name: "outlet" for name in over[:1]})
        return over[0] if over else None

    def check(self):
        packed = enskog.TORQUATO[self.d][1]
        limits = (("-alpha", self.alpha, 0, packed), ("-restitution", self.restitution, 0, 1), ("-diameter", self.diameter, 0, math.inf),
                  ("-Mach", self.o.Mach or 1, 0, math.inf), ("-end", self.o.end or 1, 0, math.inf))
        for name, value, low, high in limits:
            if not (low <= value <= high and (value > 0 or name == "-restitution")) or (name == "-alpha" and value >= packed):
                raise ValueError(f"{name} {value:g}: it lies between {low:g} and {high:g}")
        if self.o.shaking and not self.layer:
            raise ValueError("-shaking shakes the plate that a layer lies on: it wants  -gravity, a wall below, and no stream")
        if self.o.Mach and not self.stream:
            raise ValueError("-Mach is that of a stream, and no patch is an inlet; name one so, or say  -patch NAME=inlet")

    def direction(self):
        """Of the stream: into the inlets (else along x), along the mirrors."""
        inlets = [p for p in self.geometry.patches if self.kind[p.name] == "inlet"]
        along = -sum((p.normal * p.area for p in inlets), np.zeros(3)) if inlets else np.eye(3)[self.geometry.axes[0]]
        along[[k for k in range(3) if k not in self.geometry.axes]] = 0
        for p in self.geometry.patches:
            if self.kind[p.name] == "symmetry" and p.plane:
                along = along - (along @ p.normal) * p.normal
        size = np.linalg.norm(along)
        if size < 1e-9 * sum(p.area for p in inlets):
            raise ValueError("the inlets face each other: say the velocity of the stream with  -speed X,Y,Z")
        along = along / size
        nearest = int(np.argmax(np.abs(along)))
        return np.sign(along[nearest]) * np.eye(3)[nearest] if abs(along[nearest]) > 0.999 else along.round(4)

    def speeds(self):
        """Velocity and temperature of the start, and the speed below which impacts are elastic."""
        g = float(np.linalg.norm(self.g))
        given = self.o.speed or [rounded(math.sqrt(g * self.geometry.size[self.down])) if self.falls else 1.0]  # as after a fall of half the height
        self.velocity, fall = np.zeros(3), math.sqrt(g * self.diameter)
        if self.stream:
            self.velocity = np.array(given) if len(given) == 3 else given[0] * self.direction()
            self.speed, self.Mach = float(np.linalg.norm(self.velocity)), self.o.Mach or 3.0
            if not self.speed > 0:
                raise ValueError("-speed 0: a stream moves")
            self.T = rounded((self.speed / self.Mach / sound_speed(self.alpha, self.restitution, self.d)) ** 2, 4)
        elif len(given) == 3:
            raise ValueError("-speed X,Y,Z is that of a stream, and no patch is an inlet; name one so, or say  -patch NAME=inlet")
        elif self.layer or self.start:  # shaken it is warm; at rest it is cold, where most impacts are elastic, so that it has lost what it would lose
            self.T = rounded(fall**2 * (0.05 if self.o.shaking else 1 / 900))
        else:
            self.T = rounded(given[0] ** 2, 4)
        # gas that falls packs: with a threshold of a fall through a grain its sound stays some ten times as fast as its flow, and steps as long
        self.threshold = rounded(fall if self.falls and not self.grains else fall / 30 if np.any(self.g) and not self.stream else math.sqrt(self.T) / 10) if self.restitution < 1 and not self.soft else 0

    @property
    def stiffness(self):
        """Of the spring between soft grains of mass 1: the fastest impact overlaps them by a hundredth of their diameter."""
        fall, shaken = math.sqrt(2 * float(np.linalg.norm(self.g)) * self.geometry.size[self.down]), 0.0
        if self.o.shaking:
            shaken = self.o.shaking[0] * float(np.linalg.norm(self.g)) / (2 * math.pi * self.o.shaking[1])
        fastest = max(fall, shaken, float(np.linalg.norm(self.velocity)) + 3 * math.sqrt(self.T))
        return rounded(0.5 * (fastest / (0.01 * self.diameter)) ** 2)

    def times(self):
        """End, and time between writes."""
        length = self.geometry.longest
        if self.o.problem:
            end, writes = self.o.problem.end, 20
        elif self.o.shaking:
            end, writes = 20 / self.o.shaking[1], 40
        elif self.layer:
            end, writes = 5 * math.sqrt(2 * self.geometry.size[self.down] / float(np.linalg.norm(self.g))), 20
        elif self.stream:
            end, writes = 3 * length / self.speed, 20
        else:
            end, writes = 10 * length / math.sqrt(self.T), 20
        self.end = self.o.end or (end if self.o.shaking else rounded(end))
        between = 0.5 / self.o.shaking[1] if self.o.shaking else self.end / writes  # of a shaken layer: at the same phases of every stroke
        if between >= self.end:
            between = self.end / writes
        self.end, self.interval = (float(f"{x:.12g}") for x in (self.end, between))

    def summary(self):
        """One line for the terminal."""
        what = f"{'grains' if self.grains else 'gas'}: {'disks' if self.d == 2 else 'spheres'}, restitution {self.restitution:g}"
        if self.stream:
            return f"{what}; a stream of volume fraction {self.alpha:g}, velocity {self.velocity_text}, Mach number {self.Mach:g}"
        if self.start:
            return f"{what}; grains at volume fraction {self.alpha:g}, at rest, where  {self.start_text}  says"
        if self.layer:
            return f"{what}; a layer, {self.depth:g} diameters deep at volume fraction {self.alpha:g}" + (
                f", shaken by {self.o.shaking[0]:g} g at {self.o.shaking[1]:g} strokes in a unit of time" if self.o.shaking else ", at rest")
        return f"{what}; volume fraction {self.alpha:g} with faint waves, T {self.T:g}, left to itself"

    # ---- as texts of the files ----

    @property
    def depth(self):
        """Of a layer, in grain diameters: a quarter of the height, or an eighth where it is thrown up."""
        if self.o.problem and self.o.problem.depth:
            return self.o.problem.depth
        return rounded((0.125 if self.o.shaking else 0.25) * float(self.geometry.size[self.down]) / self.diameter)

    @property
    def waves_along(self):
        """Is there a periodic axis across gravity, along which the depth of a layer may vary?"""
        return any(self.kind[p.name] == "periodic" and not (p.normal @ self.g) for p in self.geometry.patches)

    @property
    def start_text(self):
        """The expression of alpha at the start: of a problem, or of a layer."""
        if self.start:
            return self.start.format(alpha=self.alpha_text)
        depth, axis, g = self.depth * self.diameter, self.down, self.geometry
        where = f"{AXES[axis]} < {g.low[axis] + depth:g}" if self.plate.normal[axis] < 0 else f"{AXES[axis]} > {g.high[axis] - depth:g}"
        return f"{where} ? {self.alpha_text} : 1e-6"

    @property
    def alpha_text(self):
        return f"{self.alpha:g}"

    @property
    def T_text(self):
        return f"{self.T:.6g}"

    @property
    def velocity_text(self):
        return f"({' '.join(f'{x + 0.0:g}' for x in self.velocity)})"

    def from_low(self, k):
        """The coordinate along an axis, from the low end of the box."""
        low = self.geometry.low[k]
        return f"({AXES[k]} {'-' if low > 0 else '+'} {abs(low):.10g})" if low else AXES[k]

    @property
    def wave(self):
        """The start of a gas that nothing drives: a faint wave along each axis, two lengths of it in the box."""
        waves = [f"cos({4 * math.pi / self.geometry.size[k]:.10g}*" + self.from_low(k) + ")" for k in self.geometry.axes]
        return f"{self.alpha:g}*(1 + {0.2 / len(waves):.3g}*({' + '.join(waves)}))"
