# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies of revolution (`axis` of system/meshDict) of a gas with transport.

References: rigid rotation, which has no stress; uniform expansion, which has that of the bulk viscosity alone; u = g rho (R^2 - r^2)/
(4 mu) in a pipe and u = A r + B/r between two cylinders, both so slow that the gas stays isothermal; conserved sums; the work of walls
by torque times angular velocity.
"""
import os
import re
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes

from studies.exact import garzoDufty
from studies.made import triangles

ALPHA, SLOW = 0.2, 1e-4
GAS = garzoDufty.Grains(3, 1.0)
RHO = ALPHA / GAS.per
PROPERTIES = """grain {{ diameter 1; mass 1; restitution {e!r}; }}
equationOfState TorquatoSpheres;   cooling {cooling};   transport {law};
"""
CYCLIC = {"x": "cyclic", "yLow": "symmetryPlane"}
POLYHEDRAL = {"schemes": "meshEngine polyhedral;\n"}
FORCES = "functions { %s budget { type energyBudget; } }\n" % " ".join(
    f"{name} {{ type forces; patches ({name}); CofR (0 0 0); writeControl timeStep; writeInterval 1; }}" for name in ("yLow", "yHigh"))


def rotating(omega, inner=0.0):
    return f"rotatingWallVelocity; origin (0 {-inner!r} 0); axis (1 0 0); omega {omega!r}; value uniform (0 0 0)"


class RoundFlows(harness.Folder, unittest.TestCase):
    def case(self, name, n, size, U, end, walls=None, kinds=None, inner=0.0, along="x", T=1.0, T_wall="zeroGradient", law="GarzoDufty",
             e=1.0, alpha=ALPHA, cooling="none", solution="", schemes="", functions="", gravity=None, **control):
        """A gas of spheres of packing ALPHA in a box of n cells about an axis at y = -inner (or x, `along` y: all is swapped).
        U: a function of centres and radii; walls: types of U by patch; kinds: types of patches."""
        case, swap = os.path.join(self.folder, name), along == "y"
        walls, kinds = walls or {}, {**(CYCLIC if kinds is None else kinds), **dict.fromkeys(walls or {}, "wall")}
        if swap:
            other = {"x": "y", "y": "x"}
            n, size = (n[1], n[0], n[2]), (size[1], size[0], size[2])
            walls, kinds = ({other[p[0]] + p[1:]: v for p, v in d.items()} for d in (walls, kinds))
        patches = boxes.write_mesh(case, n, size, kinds)
        x = boxes.centres(n, size)
        x = x[:, [1, 0, 2]] if swap else x
        u = np.stack(U(x, x[:, 1] + inner), axis=1)
        rest = [f"{p} {k if k in ('empty', 'cyclic', 'symmetryPlane') else 'zeroGradient'}" for p, k in patches.items() if p not in walls]
        for field, values, rules in (("alpha", np.full(len(x), alpha), {}), ("T", np.full(len(x), T), dict.fromkeys(walls, T_wall)),
                                     ("U", u[:, [1, 0, 2]] if swap else u, walls)):
            rows = rest + [f"{p} {rules.get(p, 'zeroGradient')}" for p in walls]
            boxes.write_field(case, field, values, "\n".join(rows))
        boxes.write_dictionary(case, "constant", "granularProperties", PROPERTIES.format(law=law, e=e, cooling=cooling))
        origin = f"({-inner!r} 0 0)" if swap else f"(0 {-inner!r} 0)"
        boxes.write_dictionary(case, "system", "meshDict", "axis { direction (%s); origin %s; }\n" % ("0 1 0" if swap else "1 0 0", origin))
        boxes.write_dictionary(case, "system", "fvSolution", solution)
        boxes.write_dictionary(case, "system", "fvSchemes", boxes.SCHEMES.format(**boxes.STANDARD) + schemes)
        boxes.write_dictionary(case, "system", "controlDict",
                               boxes.CONTROL.format(end=end, **{**boxes.STANDARD, "interval": end, **control}) + functions)
        if gravity:
            boxes.write_dictionary(case, "constant", "g", "dimensions [0 1 -2 0 0 0 0];\nvalue (%r %r 0);\n" % (gravity[::-1] if swap else gravity))
        return case, x

    @staticmethod
    def run_case(case, ranks=1):
        harness.program("granularGas", "-case", case, ranks=ranks)
        return harness.haff.Case(case)

    def pipe(self, name, cells, along="x", wide=1, end=20.0, **options):
        """Error of the velocity in a pipe over the largest one, and of the force on its wall, after a run from the exact flow."""
        R, mu = 5.0, float(GAS.shear(RHO, 1.0))
        g = 4 * mu * SLOW / (RHO * R**2)
        more = 0.25 * (R / cells)**2 if "schemes" in options else 0  # polyhedra have means over r dr, of r^2 that is r^2 + h^2/4
        case, x = self.case(name, (wide, cells, 1), (wide * R / cells, R, 0.1),
                            lambda x, r: (SLOW * (1 - (r**2 + more) / R**2), 0 * r, 0 * r), end, {"yHigh": "noSlip"}, along=along, T_wall="fixedValue; value uniform 1", gravity=(g, 0.0), **options)
        u = self.run_case(case).field("U")[:, "xy".index(along)]
        return np.abs(u / SLOW - (1 - (x[:, 1]**2 + more) / R**2)).max()

    def test_pipe(self):
        """Poiseuille flow: second order, on lattices of (axial, radial) cells either way, and of radial cells; on polyhedra, too."""
        for along, wide, engine in (("x", 1, {}), ("x", 3, {}), ("y", 3, {}), ("x", 1, POLYHEDRAL), ("y", 3, POLYHEDRAL)):
            with self.subTest(along=along, wide=wide, **engine):
                name = f"pipe{along}{wide}{len(engine)}"
                errors = [self.pipe(name + str(cells), cells, along, wide, **engine) for cells in (8, 16)]
                self.assertLess(errors[1], 4e-3)
                self.assertGreater(np.log2(errors[0] / errors[1]), 1.9, f"errors {errors}")

    def couette(self, cells, omegas=(1.0, -0.5), radii=(5.0, 10.0), **options):
        """Errors of the swirl and of both torques between two cylinders, each over the largest exact one."""
        B = (omegas[0] - omegas[1]) / (radii[0]**-2 - radii[1]**-2)
        A = omegas[1] - B / radii[1]**2
        walls = {p: rotating(SLOW * omega, radii[0]) for p, omega in zip(("yLow", "yHigh"), omegas)}
        more = ((radii[1] - radii[0]) / cells)**2 / 12 if "schemes" in options else 0  # polyhedra have means over r dr

        def flow(r):
            return SLOW * (A * (r + more / r) + B / r)
        case, x = self.case(f"couette{cells}{len(options)}", (1, cells, 1), (1.0, radii[1] - radii[0], 0.1), lambda x, r: (0 * r, 0 * r, flow(r)),
                            30.0, walls, {"x": "cyclic"}, radii[0], T_wall="fixedValue; value uniform 1", functions=FORCES, **options)
        result, r = self.run_case(case), x[:, 1] + radii[0]
        exact = -4 * np.pi * GAS.shear(RHO, 1.0) * B * SLOW  # on the shaft, by the gas, per length
        depth = np.ptp(result.mesh.points[:, 0])
        torque = [result.table(p, "moment.dat")[-1, 1] / (exact * depth) for p in ("yLow", "yHigh")]
        u = flow(r)
        return np.array([np.abs(result.field("U")[:, 2] - u).max() / np.abs(u).max(), torque[0] - 1, torque[1] + 1])

    def test_couette(self):
        """Second order; the torque on each cylinder, extrapolated from two meshes."""
        for engine in ({}, POLYHEDRAL):
            with self.subTest(**engine):
                found = np.abs([self.couette(cells, **engine) for cells in (8, 12)])
                order = np.log(found[0] / found[1]) / np.log(12 / 8)
                self.assertGreater(order.min(), 1.9, f"orders {order}, errors {found}")
                self.assertLess(np.abs((2.25 * found[1] - found[0]) / 1.25)[1:].max(), 1e-4)

    def couette_triangles(self, rows):
        """Errors of the torques on both cylinders, over the exact one, on triangles of `rows` edges across the gap."""
        case, B, A, inner = os.path.join(self.folder, f"triangles{rows}"), 50.0, -1.0, 5.0  # u_s = A r + B/r: 1 and -0.5 rad/s
        triangles.make(case, 5 / 4, rows // 4, os.path.join(os.environ["HAFF_BIN"], "gmshToCase"), cyclic="x", rows=rows,
                       patches="bottom { type wall; } top { type wall; }")
        mesh = harness.haff.Mesh(case + "/constant/polyMesh")
        swirl = SLOW * triangles.means(mesh, lambda x: A * (x[:, 1] + inner)**2 + B) / triangles.means(mesh, lambda x: x[:, 1] + inner)
        walls = {"bottom": rotating(SLOW, inner), "top": rotating(-0.5 * SLOW, inner)}
        rest = "left cyclic\nright cyclic\nback empty\nfront empty\n"
        for field, values, rules in (("alpha", np.full(len(swirl), ALPHA), {}), ("U", swirl[:, None] * [0, 0, 1], walls),
                                     ("T", np.ones(len(swirl)), dict.fromkeys(walls, "fixedValue; value uniform 1"))):
            boxes.write_field(case, field, values, rest + "\n".join(f"{p} {rules.get(p, 'zeroGradient')}" for p in walls))
        boxes.write_dictionary(case, "constant", "granularProperties", PROPERTIES.format(law="GarzoDufty", e=1.0, cooling="none"))
        boxes.write_dictionary(case, "system", "meshDict", "axis { direction (1 0 0); origin (0 -5 0); }\n")
        boxes.write_dictionary(case, "system", "fvSolution", "")
        boxes.write_dictionary(case, "system", "fvSchemes", boxes.SCHEMES.format(**boxes.STANDARD))
        functions = FORCES.replace("yLow", "bottom").replace("yHigh", "top")
        boxes.write_dictionary(case, "system", "controlDict", boxes.CONTROL.format(end=30.0, **{**boxes.STANDARD, "interval": 30.0}) + functions)
        result, exact = self.run_case(case), -4 * np.pi * GAS.shear(RHO, 1.0) * B * SLOW
        torque = [result.table(p, "moment.dat")[-1, 1] / (exact * np.ptp(result.mesh.points[:, 0])) for p in walls]
        return np.array([torque[0] - 1, torque[1] + 1])

    def test_triangles(self):
        """Torques between two cylinders on triangles: second order, extrapolated from two meshes."""
        coarse, fine = (self.couette_triangles(rows) for rows in (12, 16))
        self.assertGreater(np.log(np.abs(coarse / fine)).min() / np.log(16 / 12), 1.9, f"errors {coarse} {fine}")
        self.assertLess(np.abs((16 * fine - 9 * coarse) / 7).max(), 1e-4)

    def spun(self, name, inner, law="GarzoDufty", **engine):
        """The swirl over that of gas that rotates as a rigid body with its walls, after a step of 1e-6 s, and the radius."""
        more = 0.25**2 / 12 if engine else 0  # polyhedra have means over r dr
        spin = {p: rotating(1.0, inner) if law != "none" else "slip" for p in ("yLow", "yHigh")[inner == 0:]}
        case, x = self.case(name, (4, 16, 1), (1.0, 4.0, 0.1), lambda x, r: (0 * r, 0 * r, r + more / r), 1e-6, spin,
                            {"x": "cyclic"} if inner else None, inner, adjust="no", step=1e-6, law=law, **engine)
        r = x[:, 1] + inner
        return self.run_case(case).field("U")[:, 2] / (r + more / r), r

    def test_rigid(self):
        """Gas that rotates as a rigid body with its walls feels no stress: its swirl stays to round-off, in a pipe and in a ring."""
        for inner, engine in ((0.0, {}), (2.0, {}), (0.0, POLYHEDRAL), (2.0, POLYHEDRAL)):
            with self.subTest(inner=inner, **engine):
                swirl, r = self.spun(f"rigid{inner}{len(engine)}", inner, **engine)
                if engine:  # near the axis the uneven E of a uniform T moves the gas by 1e-9, with stress and without
                    swirl[r < 1] -= self.spun(f"plain{inner}", inner, "none", **engine)[0][r < 1] - 1
                self.assertLess(np.abs(swirl - 1).max(), 1e-11)  # a shear of 1/s would change it by 1e-6 mu/(rho r h)

    def test_expansion(self):
        """u = a (x, r) has the stress of the bulk viscosity alone: it heats the gas, and moves nothing."""
        for engine in ({}, POLYHEDRAL):
            with self.subTest(**engine):
                self.expand("expand" + str(len(engine)), **engine)

    def expand(self, name, **engine):
        a, dt, states, h = 0.1, 1e-3, {}, 6 / 40
        kinds = {"x": "patch", "yLow": "symmetryPlane", "yHigh": "patch"}
        more = h**2 / 12 if engine else 0  # polyhedra have means over r dr, of r that is r + h^2/(12 r)
        for law in ("none", "GarzoDufty"):
            case, x = self.case(name + law, (40, 40, 1), (6.0, 6.0, 0.1), lambda x, r: (a * x[:, 0], a * (r + more / r), 0 * r), dt,
                                kinds=kinds, law=law, adjust="no", step=dt, **engine)
            states[law] = self.run_case(case)
        inside = (np.abs(x[:, 0] - 3) < 0.3) & (x[:, 1] < 3)  # as far as what the patches do cannot come
        difference = {name: states["GarzoDufty"].field(name)[inside] - states["none"].field(name)[inside] for name in ("T", "U")}
        # stress without its hoop part would give 1e-5; the cells of polyhedra at the axis feel p by uneven heat
        self.assertLess(np.abs(difference["U"][x[inside, 1] > 4 * h * (len(engine) > 0)]).max(), 1e-11 if engine else 1e-12)
        heat = GAS.bulk(RHO, 1.0) * (3 * a)**2 * dt / (1.5 * RHO)
        np.testing.assert_allclose(difference["T"], heat, rtol=2e-3)

    def whirl(self, name, wall="noSlip", T_wall="zeroGradient", inner=0.0, n=(24, 32, 1), end=0.5, **options):
        """Gas in a closed can, or a ring of it, that moves along all three axes."""
        def start(x, r):
            s = (r - inner) / 4
            bump = np.sin(np.pi * s) * np.sin(np.pi * x[:, 0] / 3)
            return bump, 0.7 * bump * s, s * (1 - 0.3 * np.cos(np.pi * x[:, 0] / 3))
        walls = {p: wall for p in (("xLow", "xHigh", "yLow", "yHigh") if inner else ("xLow", "xHigh", "yHigh"))}
        return self.case(name, n, (3.0, 4.0, 0.1), start, end, walls, {"yLow": "symmetryPlane"}, inner, T_wall=T_wall, functions=FORCES
                         if inner else "functions { budget { type energyBudget; } }\n", **options)

    def test_conserved(self):
        """Mass and energy of a can to round-off; the axial momentum that the walls take; with slip the angular momentum."""
        for inner, wall, engine in ((0.0, "noSlip", {}), (0.0, "slip", {}), (2.0, "noSlip", {}), (2.0, "slip", {}),
                                    (0.0, "noSlip", POLYHEDRAL), (2.0, "slip", POLYHEDRAL)):
            with self.subTest(inner=inner, wall=wall, **engine):
                case, x = self.whirl(f"can{inner}{wall}{len(engine)}", wall, inner=inner, **engine)
                result = self.run_case(case)
                budget = result.table("budget")
                self.assertLess(np.abs(budget[:, [4, 12, 19]]).max() / budget[0, 5], 1e-14)
                self.assertLess(abs(budget[-1, 5] / budget[0, 5] - 1), 1e-13)
                r, h = x[:, 1] + inner, 4 / 32
                weight = r**2 + 0.25 * h**2  # of r u_s on lattices, of polyhedra of the mean of u_s over r dr
                weight = weight / (1 + h**2 / (12 * r**2)) if engine else weight
                spin = [(result.field("alpha", t) * result.field("U", t)[:, 2] * weight).sum() for t in (0, 0.5)]
                (self.assertLess if wall == "noSlip" else self.assertGreater)(spin[1] / spin[0], 0.99)
                self.assertLess(abs(spin[1] / spin[0] - 1), 1e-13 if wall == "slip" else 1)

    def test_same(self):
        """1 and 3 ranks, and a restart, give the same bits, also of what the gas carries."""
        for engine in ({}, POLYHEDRAL):
            with self.subTest(**engine):
                name, options = str(len(engine)), {"n": (40, 48, 1), "end": 0.02, "interval": 0.01, **engine}
                one, three = (self.carries(name + ranks, **options)[0] for ranks in ("one", "three"))
                self.run_case(one)
                self.run_case(three, ranks=3)
                runs.same(self, runs.results(one), runs.results(three), "ranks")
                part = runs.until(one, os.path.join(self.folder, name + "part"), 0.01)
                self.run_case(part)
                runs.same(self, runs.contents(os.path.join(one, "0.02")), runs.contents(os.path.join(part, "0.02")), "restart")

    def test_axes(self):
        """Flow about the axis y, whose radius is the first axis of the cells, is flow about x with the axes swapped."""
        fields = {}
        for along in "xy":
            case, x = self.whirl("about" + along, n=(12, 16, 1), end=0.1, along=along)
            order = np.lexsort((x[:, 0], x[:, 1]))  # x: (along the axis, from the axis)
            result = self.run_case(case)
            U = result.field("U")[order]
            fields[along] = np.column_stack((result.field("T")[order], U[:, [1, 0, 2]] if along == "y" else U))
        self.assertGreater(np.ptp(fields["x"], axis=0).min(), 0.01)
        np.testing.assert_allclose(fields["y"], fields["x"], rtol=0, atol=1e-12)

    def carries(self, name, **options):
        case, x = self.whirl(name, **options)
        runs.add(case, "constant/granularProperties", "carried { dye { type passive; diffusivity 0.3; } mark { type passive; } }\n")
        for field, values in (("dye", np.where(x[:, 1] < 1.5, 1.0, 0.0)), ("mark", np.full(len(x), 0.3))):
            boxes.DIMENSIONS[field] = "[0 0 0 0 0 0 0]"
            boxes.write_field(case, field, values, '".*" zeroGradient\nyLow symmetryPlane\nzEmpty empty')
        return case, x

    def test_carried(self):
        """What gas carries is conserved over the full turn, within its bounds; a uniform quantity keeps its bits."""
        for engine in ({}, POLYHEDRAL):
            with self.subTest(**engine):
                case, x = self.carries(f"carried{len(engine)}", end=0.1, **engine)
                one = self.run_case(case)
                amount = [(one.field("alpha", t) * one.field("dye", t) * x[:, 1]).sum() for t in (0, 0.1)]
                self.assertLess(abs(amount[1] / amount[0] - 1), 1e-13)
                dye = one.field("dye")
                self.assertTrue(dye.min() >= 0 and dye.max() <= 1)
                self.assertGreater(np.abs(dye - one.field("dye", 0)).max(), 0.2)
                np.testing.assert_array_equal(one.field("mark"), 0.3)

    def test_shear_rate(self):
        """A cooling law of the shear rate: rigid rotation has none, u_x = a r that of the plane flow, u = a (-2 x, r) sqrt(12) a."""
        def cooled(name, U, plane=False, **engine):
            case, x = self.case(name, (12, 16, 1), (0.3, 0.4, 0.1), U, 1e-5, kinds=CYCLIC,
                                walls={"yHigh": "slip"}, T=0.01, alpha=0.5, e=0.7, law="none", cooling="Jenkins", adjust="no",
                                step=1e-5, **engine)
            if plane:
                os.remove(os.path.join(case, "system", "meshDict"))
            inside = (x[:, 1] > 0.12) & (x[:, 1] < 0.28) & (np.abs(x[:, 0] - 0.15) < 0.03)  # as far as the ends do not reach
            return 0.01 - self.run_case(case).field("T")[inside]
        rest = cooled("rest", lambda x, r: (0 * r, 0 * r, 0 * r))
        for engine in ({}, POLYHEDRAL):
            more = 0.025**2 / 12 if engine else 0  # polyhedra have means over r dr
            # the centrifugal force thins the gas, which cools it by the square of the step
            np.testing.assert_allclose(cooled("rotates" + str(len(engine)), lambda x, r: (0 * r, 0 * r, 0.6 * (r + more / r)), **engine), rest, rtol=1e-2)
        plane, stretch = cooled("plane", lambda x, r: (0.6 * r, 0 * r, 0 * r), plane=True), 0.6 / np.sqrt(12)
        self.assertLess((plane / rest).max(), 0.8)  # correlated impacts take less
        for engine in ({}, POLYHEDRAL):
            more = 0.025**2 / 12 if engine else 0  # polyhedra have means over r dr
            for name, U in (("sheared", lambda x, r: (0.6 * (r + more / r), 0 * r, 0 * r)),
                            ("stretched", lambda x, r: (-2 * stretch * (x[:, 0] - 0.15), stretch * (r + more / r), 0 * r))):
                with self.subTest(name, **engine):
                    # on polyhedra E of the means changes by h^2 besides; without u_r/r the rate would differ by a tenth
                    np.testing.assert_allclose(cooled(name + str(len(engine)), U, **engine), plane, rtol=1e-3 if engine else 1e-4)

    def test_stages(self):
        """Super steps about the axis have the stages of plane flow (on radial cells one more), and damp what changes from cell to cell: with
        the rates of plane flow the cells beside the axis are unstable."""
        for n, size in (((24, 32, 1), (0.6, 0.8, 0.1)), ((1, 20, 1), (1.0, 0.5, 0.1))):
            stages = []
            for plane in (False, True):
                case, x = self.case(f"stages{n[0]}{plane}", n, size, lambda x, r: (0 * r, SLOW * (-1.0)**np.rint(r / size[1] * n[1] - 0.5), 0 * r),
                                    0.3, {"yHigh": "noSlip"}, {"x": "cyclic", "yLow": "symmetryPlane"}, T_wall="fixedValue; value uniform 1")
                if plane:
                    os.remove(os.path.join(case, "system", "meshDict"))
                log = harness.program("granularGas", "-case", case).stdout
                stages.append(float(re.findall(r"in ([\d.]+) stages of viscous stress", log)[-1]))
                self.assertLess(np.abs(harness.haff.Case(case).field("U")).max(), 1e-4 * SLOW)
            self.assertLessEqual(stages[0], stages[1] + (n[0] == 1))
    def test_implicit(self):
        """Implicit diffusion finds the flow that super steps find."""
        for engine in ({}, POLYHEDRAL):
            with self.subTest(**engine):
                fields = []
                for scheme in ("RKJ2", "implicit"):
                    case, _ = self.whirl(f"by{scheme}{len(engine)}", T_wall="fixedValue; value uniform 1", adjust="no", step=0.005,
                                         solution=f"diffusion {{ type {scheme}; }}\n", **engine)
                    fields.append(self.run_case(case).field("U"))
                self.assertLess(np.abs(fields[0] - fields[1]).max(), 2e-4)

    def test_works(self):
        """Walls of Johnson & Jackson that rotate: the energy changes by torque times angular velocity."""
        for engine in ({}, POLYHEDRAL):
            with self.subTest(**engine):
                self.works("spin" + str(len(engine)), **engine)

    def works(self, name, **engine):
        drags = "JohnsonJacksonSlip; specularityCoefficient 0.6; restitutionCoefficient 1"
        case, _ = self.case(name, (1, 16, 1), (1.0, 4.0, 0.1), lambda x, r: (0 * r, 0 * r, 0 * r), 1.0,
                            {"yLow": drags + "; origin (0 -2 0); axis (1 0 0); omega 0.2; value uniform (0 0 0)", "yHigh": rotating(-0.1, 2.0)},
                            {"x": "cyclic"}, 2.0, functions=FORCES, **engine)
        path = os.path.join(case, "0", "T")
        with open(path) as f:
            text = f.read().replace("yLow { type zeroGradient;", f"yLow {{ type {drags}; value uniform 1;")
        with open(path, "w") as f:
            f.write(text)
        result = self.run_case(case)
        budget = result.table("budget")
        change = budget[-1, 5] - budget[0, 5]
        self.assertGreater(change, 1e-3)
        self.assertLess(abs(change - budget[-1, 9]), 1e-12 * budget[0, 5])
        self.assertLess(np.abs(budget[:, [4, 12]]).max() / budget[0, 5], 1e-13)
        work = 0
        for patch, omega in (("yLow", 0.2), ("yHigh", -0.1)):
            rows = result.table(patch, "moment.dat")
            work -= (np.diff(rows[:, 0], prepend=0) * rows[:, 1]).sum() * omega
        self.assertLess(abs(work / change - 1), 1e-9)


if __name__ == "__main__":
    unittest.main()
