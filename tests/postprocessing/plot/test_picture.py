# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of tiny cases: what stands in the figure is what stands in the fields; colours, walls, times, names and units."""
import os
import shutil
import types
import unittest

import matplotlib
import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection, PolyCollection, QuadMesh
from matplotlib.colors import LogNorm

from tests.cases import harness
from tests.cases.harness import haff
from tests.postprocessing.plot import cases

from haff.plot import figures, picture, quantity
from haff.plot.quantity import CannotDraw
from haff.plot.wish import Wish, named_time

GMSH = shutil.which("gmsh")


def the(kind, axes):
    """The only collection of a kind in axes."""
    found = [c for c in axes.collections if type(c) is kind]
    assert len(found) == 1, found
    return found[0]


def pictures(figure):
    """The axes that hold pictures or curves, not the colour bars (of which some are insets of them)."""
    return [a for a in figure.axes if a.axison and not hasattr(a, "_colorbar")]


def walls_of(axes):
    return [c for c in axes.collections if isinstance(c, LineCollection) and c.get_linewidth()[0] == 1.4][0].get_segments()


class Pictures(harness.Folder, unittest.TestCase):
    def setUp(self):
        self.path = os.path.join(self.folder, self._testMethodName)

    def tearDown(self):
        figures.plt.close("all")

    def draw(self, **wish):
        return picture.draw(cases.space(self.path), Wish(**wish))

    def wide(self):
        """A lattice of 12 x 8 with a body, alpha, T, U and p at times 0.5 and 1."""
        n, size = (12, 8, 1), (1.2, 0.8, 0.1)
        hole = np.zeros((1, 8, 12), bool)
        hole[0, 3:5, 6:9] = True
        at = cases.box(self.path, n, size, hole=hole.ravel(), hole_patch="body")
        for time, factor in (("0.5", 1.0), ("1", 2.0)):
            cases.fields(self.path, time, alpha=factor * at[:, 0], T=10.0 ** (4 * at[:, 1]), p=1 + at[:, 0],
                         U=np.stack([at[:, 0] - 0.6, 0 * at[:, 0], 0 * at[:, 0]], axis=1))
        return at


class Profiles(Pictures):
    def setUp(self):
        super().setUp()
        self.x = cases.box(self.path, (20, 1, 1), (2, 0.1, 0.1))[:, 0]
        for k, time in enumerate(("0", "0.25", "0.5", "1", "2", "3", "4", "5", "6")):
            cases.fields(self.path, time, alpha=0.1 * k + 0.01 * self.x, T=np.full(20, 2.5), p=self.x**2 + k,
                         U=np.stack([0 * self.x, np.full(20, float(k)), 0 * self.x], axis=1))

    def test_main_fields_at_six_times(self):
        figure = self.draw()
        axes = pictures(figure)
        self.assertEqual([a.get_ylabel() for a in axes], [r"packing fraction $\alpha$", "velocity $U_{y}$ (m s$^{-1}$)",
                                                          "temperature $T$ (m$^{2}$ s$^{-2}$)", "pressure $p$ (kg m$^{-1}$ s$^{-2}$)"])
        times = ["0", "0.5", "1", "3", "4", "6"]  # six of nine, evenly, with both ends
        self.assertEqual([line.get_label() for line in axes[0].lines], [f"$t$ = {t} s" for t in times])
        for line, t in zip(axes[0].lines, times):
            k = ["0", "0.25", "0.5", "1", "2", "3", "4", "5", "6"].index(t)
            np.testing.assert_allclose(line.get_xdata(), self.x, atol=1e-12)
            np.testing.assert_allclose(line.get_ydata(), 0.1 * k + 0.01 * self.x)
        self.assertEqual(axes[0].get_xlim(), (0, 2))
        low, high = axes[2].get_ylim()  # a constant is a line in the middle
        self.assertAlmostEqual((low + high) / 2, 2.5)
        self.assertGreater(high - low, 0.1)

    def test_times(self):
        self.assertEqual(len(pictures(self.draw(fields=["p"], time="all"))[0].lines), 9)
        self.assertEqual(len(pictures(self.draw(fields=["p"], time="0.25,6"))[0].lines), 2)
        one, = pictures(self.draw(fields=["p"], time="1.0000000001"))[0].lines
        np.testing.assert_allclose(one.get_ydata(), self.x**2 + 3)
        for word, message in (("0.3", "has no time 0.3; the nearest is 0.25, the times are 0 0.25 0.5"), ("late", "'late' is no time; the times are")):
            with self.assertRaisesRegex(CannotDraw, message):
                self.draw(time=word)

    def test_units(self):
        """system/units of the case or of the case around it; a quantity without unit has no brackets."""
        with open(os.path.join(self.path, "system", "units"), "w") as f:
            f.write('FoamFile\n{\n    object units;\n}\nlength cm; // as in the paper\nmass ""; time s;\n')
        p, = pictures(self.draw(fields=["p"]))
        self.assertEqual((p.get_xlabel(), p.get_ylabel()), ("$x$ (cm)", "pressure $p$ (cm$^{-1}$ s$^{-2}$)"))
        inner = os.path.join(self.path, "e0.7")
        os.makedirs(os.path.join(inner, "system"))
        self.assertEqual(figures.units(inner)["length"], "cm")
        with open(os.path.join(inner, "system", "units"), "w") as f:
            f.write('length "$\\sigma$"; time "";\n')
        self.assertEqual(figures.unit((0, 2, 0), figures.units(inner)), r"$\sigma$$^{2}$")
        self.assertEqual(figures.unit((0, 2, -2), figures.units(inner)), "")  # a time without a name: no half of a unit
        with open(os.path.join(inner, "system", "units"), "w") as f:
            f.write("lenght cm;\n")
        with self.assertRaisesRegex(ValueError, "lenght is none of mass, length, time"):
            figures.units(inner)

    def test_components_and_fields(self):
        u, = pictures(self.draw(fields=["U"], component="y", time="6"))
        self.assertEqual(set(u.lines[0].get_ydata()), {8.0})
        self.assertEqual(pictures(self.draw(fields=["U.mag"], time="6"))[0].get_ylabel(), "speed $|U|$ (m s$^{-1}$)")
        for fields, component, message in ((["alhpa"], None, "did you mean alpha.*\n.*fields there: T U alpha p"), (["T"], "x", "scalar"),
                                           (["U"], "xx", "has the components x y z and mag, not xx")):
            with self.assertRaisesRegex(CannotDraw, message):
                self.draw(fields=fields, component=component)
        for wish in ({"cut": ((1, 0, 0), (1, 0, 0))}, {"iso": 1.0}, {"volume": True}):
            with self.assertRaisesRegex(CannotDraw, "one axis only|one dimension"):
                self.draw(**wish)

    def test_a_start_by_expression_is_left_out(self):
        with open(os.path.join(self.path, "0", "alpha"), "a") as f:
            f.write('expression "x";\n')
        axes = pictures(self.draw(fields=["alpha"]))[0]
        self.assertEqual(axes.lines[0].get_label(), "$t$ = 0.25 s")
        with self.assertRaisesRegex(CannotDraw, "expression"):
            self.draw(fields=["alpha"], time="0")


class Maps(Pictures):
    def test_colours_are_the_values(self):
        """Four panels at the last time: values, range, holes, walls."""
        at = self.wide()
        axes = pictures(self.draw())
        self.assertEqual([a.get_title("left") for a in axes][:2], [r"packing fraction $\alpha$", "speed $|U|$ (m s$^{-1}$)"])
        mesh = the(QuadMesh, axes[0])
        values = np.ma.masked_invalid(np.asarray(mesh.get_array()).reshape(8, 12))
        self.assertEqual(np.ma.count_masked(np.ma.masked_array(mesh.get_array())), 6)
        np.testing.assert_allclose(np.unique(np.ma.masked_array(mesh.get_array()).compressed()), np.unique(2 * at[:, 0]))
        self.assertAlmostEqual(mesh.norm.vmin, 0.1)
        self.assertAlmostEqual(mesh.norm.vmax, 2.3)
        self.assertAlmostEqual(values[0, 3], 0.7)
        self.assertEqual(len(walls_of(axes[0])), 10)
        speeds = the(QuadMesh, axes[1])
        self.assertEqual((speeds.cmap.name, round(speeds.norm.vmin, 9), round(speeds.norm.vmax, 9)), ("cividis", 0.05, 0.55))

    def test_ranges(self):
        """A wished range; logarithmic colours; colours of both signs lie around zero."""
        self.wide()
        mesh = the(QuadMesh, pictures(self.draw(fields=["alpha"], span=(0.5, 1.5)))[0])
        self.assertEqual((mesh.norm.vmin, mesh.norm.vmax), (0.5, 1.5))
        mesh = the(QuadMesh, pictures(self.draw(fields=["T"], log=True))[0])
        self.assertIsInstance(mesh.norm, LogNorm)
        np.testing.assert_allclose((mesh.norm.vmin, mesh.norm.vmax), (10**0.2, 10**3.0))
        mesh = the(QuadMesh, pictures(self.draw(fields=["U.x"]))[0])
        self.assertEqual(mesh.cmap.name, figures.SIGNED)
        self.assertAlmostEqual(mesh.norm.vmin, -0.55)
        self.assertAlmostEqual(mesh.norm.vmax, 0.55)
        with self.assertRaisesRegex(CannotDraw, "-log needs values above 0"):
            self.draw(fields=["T"], log=True, span=(-1.0, 1.0))

    def test_times_of_which_one_is_uniform(self):
        """The colours of all times begin at a start at rest, not below it: a speed is not of both signs."""
        at = cases.box(self.path, (9, 7, 1), (0.9, 0.7, 0.1))
        cases.fields(self.path, "0", U=np.zeros_like(at))
        cases.fields(self.path, "1", U=at)
        mesh = the(QuadMesh, pictures(self.draw(fields=["U"], time="all"))[0])
        self.assertEqual((mesh.cmap.name, mesh.norm.vmin), ("cividis", 0))

    def test_one_cell_does_not_rule_the_colours(self):
        at = cases.box(self.path, (40, 40, 1), (1, 1, 0.1))
        values = at[:, 0].copy()
        values[777] = 500.0
        cases.fields(self.path, "1", alpha=values)
        axes = pictures(self.draw())[0]
        mesh = the(QuadMesh, axes)
        self.assertLess(mesh.norm.vmax, 1)
        self.assertGreater(mesh.norm.vmax, 0.98)
        self.assertEqual(axes.child_axes[0]._colorbar.extend, "max")

    def test_lines_of_equal_values(self):
        """alpha = 2 x: the line of the middle value is the straight x = 0.6."""
        self.wide()
        axes = pictures(self.draw(fields=["alpha"], contours=1))[0]
        lines = [c for c in axes.collections if not isinstance(c, QuadMesh) and abs(c.get_linewidth()[0] - 0.4) < 1e-9]
        points = np.concatenate([path.vertices for c in lines for path in c.get_paths()])
        far = (points[:, 1] < 0.29) | (points[:, 1] > 0.51)  # nearer to the body, cells within it are given means, and painted over
        np.testing.assert_allclose(points[far, 0], 0.6, atol=1e-9)
        self.assertGreater(far.sum(), 4)

    def test_all_times(self):
        """One field at all times: a panel each, with one range."""
        self.wide()
        axes = pictures(self.draw(fields=["alpha"], time="all"))
        self.assertEqual([a.get_title("left") for a in axes], ["$t$ = 0.5 s", "$t$ = 1 s"])
        self.assertEqual({(round(the(QuadMesh, a).norm.vmin, 9), round(the(QuadMesh, a).norm.vmax, 9)) for a in axes}, {(0.05, 2.3)})
        with self.assertRaisesRegex(CannotDraw, "one field at several times"):
            self.draw(fields=["alpha", "T"], time="all")

    def test_slice_is_a_profile(self):
        at = self.wide()
        axes = pictures(self.draw(fields=["T"], cut=((1, 0, 0), (0.33, 0, 0))))[0]
        self.assertEqual(axes.get_xlabel(), "$y$ (m)")
        np.testing.assert_allclose(axes.lines[0].get_xdata(), np.unique(at[:, 1]))
        np.testing.assert_allclose(axes.lines[0].get_ydata(), 10.0 ** (4 * np.unique(at[:, 1])))
        with self.assertRaisesRegex(CannotDraw, "no cells along z"):
            self.draw(cut=((0, 0, 1), (0, 0, 0.05)))
        with self.assertRaisesRegex(CannotDraw, "are for three"):
            self.draw(fields=["T"], iso=3.0)

    def test_columns_are_profiles(self):
        """A plane of 3 x 12 cells has nothing to show across: means over it."""
        at = cases.box(self.path, (3, 12, 1), (3, 12, 1), {"x": "cyclic"})
        cases.fields(self.path, "1", alpha=at[:, 1] + 0.5 * (at[:, 0] - 1.5))
        axes, = pictures(self.draw())
        self.assertEqual((axes.get_ylabel(), axes.get_xlabel()), ("$y$ (m)", r"packing fraction $\alpha$"))
        np.testing.assert_allclose(axes.lines[0].get_xdata(), np.arange(12) + 0.5)
        np.testing.assert_allclose(axes.lines[0].get_ydata(), np.arange(12) + 0.5)

    @unittest.skipUnless(GMSH, "gmsh is not installed")
    def test_triangles(self):
        self.path, at = cases.meshed(self.folder, "wedge15", 8)
        cases.fields(self.path, "1", alpha=at[:, 0])
        axes = pictures(self.draw(contours=3))[0]
        tint = the(PolyCollection, axes)
        self.assertEqual(len(tint.get_paths()), len(at))
        np.testing.assert_allclose(np.sort(tint.get_array()), np.sort(at[:, 0]))
        self.assertGreater(len(walls_of(axes)), 5)

    def test_nothing_to_draw(self):
        cases.box(self.path, (5, 5, 1), (1, 1, 0.1))
        with self.assertRaisesRegex(CannotDraw, "has no times with fields: run it first"):
            self.draw()


class Solids(Pictures):
    def setUp(self):
        super().setUp()
        self.at = cases.box(self.path, (10, 8, 6), (1.0, 0.8, 0.6), {"y": "wall"})
        ball = np.exp(-20 * ((self.at - [0.5, 0.4, 0.3]) ** 2).sum(axis=1))
        cases.fields(self.path, "1", alpha=ball, U=self.at)

    def test_cuts_and_a_surface(self):
        figure = self.draw()
        axes = [a for a in figure.axes if a.collections and not hasattr(a, "_colorbar")]
        shapes = [np.shape(np.asarray(the(QuadMesh, a).get_array()).reshape(-1))[0] for a in axes]
        self.assertEqual(shapes, [6 * 8, 10 * 6, 10 * 8])
        self.assertEqual(len({(the(QuadMesh, a).norm.vmin, the(QuadMesh, a).norm.vmax) for a in axes}), 1)
        view = next(a for a in figure.axes if a.images)
        image = view.images[0].get_array()
        middle = image[image.shape[0] // 2, image.shape[1] // 2]
        value = float(view.get_title("left").split("=")[1])
        expected = np.array(matplotlib.colormaps["viridis"]((value - the(QuadMesh, axes[0]).norm.vmin)
                                                            / np.ptp([the(QuadMesh, axes[0]).norm.vmin, the(QuadMesh, axes[0]).norm.vmax])))[:3]
        self.assertLess(np.abs(middle[:3] / middle[:3].sum() - expected / expected.sum()).max(), 0.1)  # the colour of the value, in some light
        self.assertEqual(np.argmax(middle[:3]), np.argmax(expected))

    def test_the_surface_parts_high_from_low(self):
        """Of two sets of values around 1 and 5, of whatever sizes, the value lies between both; also by logarithms."""
        from haff.plot.scale import Scale
        from haff.plot.views import parting_value
        rng = np.random.default_rng(4)
        for share in (0.05, 0.5, 0.9):
            values = np.where(rng.uniform(size=4000) < share, 5 + rng.normal(size=4000) / 5, 1 + np.abs(rng.normal(size=4000)) / 5)
            for log in (False, True):
                q = quantity.Quantity("alpha", "", (0, 0, 0), values, figures.SI)
                value = parting_value(Scale(q, Wish(log=log)), values)
                self.assertAlmostEqual((values > value).mean(), (values > 3).mean(), delta=0.002)

    def test_surface_and_cloud(self):
        for wish in ({"iso": 0.5}, {"volume": True}):
            figure = self.draw(fields=["alpha"], dpi=40, **wish)
            image = next(a for a in figure.axes if a.images).images[0].get_array()
            self.assertGreater(image[image.shape[0] // 2, image.shape[1] // 2, 3], 0.9)
            self.assertEqual(image[0, 0, 3], 0)
        with self.assertRaisesRegex(CannotDraw, "has no surface at 7; it lies between 0"):
            self.draw(fields=["alpha"], iso=7.0)
        with self.assertRaisesRegex(CannotDraw, "one field"):
            self.draw(fields=["alpha", "U"])

    def test_slices(self):
        axes = pictures(self.draw(fields=["alpha", "U.z"], cut=((0, 0, 1), (0, 0, 0.25))))
        np.testing.assert_allclose(np.asarray(the(QuadMesh, axes[1]).get_array()), 0.25)
        figure = self.draw(fields=["U.x"], cut=((1, 1, 0), (0.4, 0.4, 0.3)))
        self.assertGreater(len(the(PolyCollection, pictures(figure)[0]).get_paths()), 40)

    def test_line(self):
        axes = pictures(self.draw(fields=["U.x"], line=((0, 0.05, 0.05), (1, 0.05, 0.05))))[0]
        np.testing.assert_allclose(axes.lines[0].get_xdata(), axes.lines[0].get_ydata())
        self.assertEqual((axes.get_xlabel(), len(axes.lines[0].get_xdata())), ("$x$ (m)", 10))
        axes = pictures(self.draw(fields=["U.x"], line=((0, 0, 0), (1, 0.8, 0.6))))[0]
        self.assertEqual(axes.get_xlabel(), "distance along the line (m)")


class Grains(Pictures):
    def grains(self, n, size):
        cases.box(self.path, n, size)
        rng = np.random.default_rng(3)
        self.x = rng.uniform(0.1, 0.9, (30, 3)) * size
        self.U, self.d = rng.normal(size=(30, 3)), rng.uniform(0.02, 0.05, 30)
        cases.cloud(self.path, "2", self.x, self.U, self.d)
        cases.fields(self.path, "2", alpha=np.zeros(int(np.prod(n))))

    def test_disks(self):
        self.grains((6, 5, 1), (1.0, 0.8, 0.1))
        axes = pictures(self.draw())[0]
        disks = the(EllipseCollection, axes)
        np.testing.assert_allclose(disks.get_offsets(), self.x[:, :2])
        np.testing.assert_allclose(disks.get_array(), np.linalg.norm(self.U, axis=1))
        np.testing.assert_allclose(2 * disks._widths, self.d)
        np.testing.assert_allclose(the(EllipseCollection, pictures(self.draw(component="x"))[0]).get_array(), self.U[:, 0])
        the(QuadMesh, pictures(self.draw(fields=["alpha"]))[0])
        with self.assertRaisesRegex(CannotDraw, "grains are drawn where they are"):
            self.draw(fields=["grains"], line=((0, 0, 0), (1, 1, 1)))

    def test_spheres(self):
        self.grains((6, 5, 4), (1.0, 0.8, 0.6))
        figure = self.draw()
        image = next(a for a in figure.axes if a.images).images[0].get_array()
        share = (image[..., 3] > 0.5).mean()
        self.assertGreater(share, 0.005)
        self.assertLess(share, 0.25)

    def test_no_grains(self):
        at = self.wide()
        self.assertTrue(len(at))
        with self.assertRaisesRegex(CannotDraw, "has no field 'grains'"):
            self.draw(fields=["grains"])
        self.assertEqual(quantity.known(haff.Case(self.path), "1"), ["T", "U", "alpha", "p"])


class Times(unittest.TestCase):
    def test_named_time(self):
        """A number names the time within 1e-6 of itself or of the span of all times, whichever is more."""
        case, there = types.SimpleNamespace(path="CASE"), ["0", "0.1", "10"]
        for word, found in (("0.100005", "0.1"), ("0.1", "0.1"), ("1e1", "10"), ("10.000009", "10")):
            self.assertEqual(named_time(case, word, there), found)
        self.assertEqual(named_time(case, "1000.0005", ["1000", "1001"]), "1000")
        for word in ("0.10002", "10.00002", "five"):
            with self.assertRaisesRegex(CannotDraw, "the times are"):
                named_time(case, word, there)


if __name__ == "__main__":
    unittest.main()
