# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenFOAM's wedges: bodies of revolution as one layer of cells between two patches of type wedge, whose axis cells are collapsed or hollow.
They run as the plane mesh with `axis` does, and what is written belongs to the mesh in the files. What is refused."""
import os
import re
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes

N, SIZE = np.array((12, 8, 1)), np.array((1.2, 0.8, 0.1))
ANGLE = np.radians(5)


def listing(folder, name):
    """Head and entries of an ascii list, one a line."""
    with open(os.path.join(folder, name)) as f:
        head, rows = f.read().split("\n(\n", 1)
    return head.rsplit("\n", 1)[0], rows.rsplit("\n)", 1)[0].split("\n")


def write(folder, name, head, rows):
    with open(os.path.join(folder, name), "w") as f:
        f.write(f"{head}\n{len(rows)}\n(\n" + "\n".join(rows) + "\n)\n")


def to_wedge(case, hollow=0.0, angle=ANGLE, turn=0.0, axis="", lean=0.0, bend=0.0, sides=("wedge", "wedge")):
    """Bends the box, z across, about the x axis; at hollow = 0 the cells there are collapsed. turn: of the middle plane. axis: an entry of the
    boundary, without faces. lean: angle of the axis to x. bend: of one side, at its outer edge. sides: types of both."""
    folder = os.path.join(case, "constant", "polyMesh")
    heads, lists = zip(*(listing(folder, name) for name in ("points", "faces", "owner", "boundary")))
    x, r, z = np.array([[float(v) for v in row.strip("()").split()] for row in lists[0]]).T
    r, at = r + hollow, np.where(z > SIZE[2] / 2, angle / 2, -angle / 2) + turn
    at = np.where((z > SIZE[2] / 2) & (r > hollow + 0.99 * SIZE[1]), at + bend, at)
    points, faces = np.stack([x, r * np.cos(at), r * np.sin(at)], axis=1), [[int(v) for v in row[2:-1].split()] for row in lists[1]]
    owner, kept = lists[2], np.arange(len(x))
    if hollow == 0:
        low = {v: i for i, v in enumerate(x) if r[i] == 0 and z[i] < SIZE[2] / 2}
        kept = np.array([low[x[i]] if r[i] == 0 else i for i in range(len(x))])
    points = points @ np.array([[np.cos(lean), np.sin(lean), 0], [-np.sin(lean), np.cos(lean), 0], [0, 0, 1]])
    corners = [list(dict.fromkeys(kept[face].tolist())) for face in faces]
    used, place = np.unique(np.concatenate([c for c in corners if len(c) > 2]), return_inverse=True)
    number = dict(zip(used.tolist(), range(len(used))))
    stands = [len(c) > 2 for c in corners]
    rows, start = [], None
    for row in lists[3]:
        name, kind, count, first = re.fullmatch(r"\s*(\w+) \{ type (\w+); nFaces (\d+); startFace (\d+);.*\}", row).groups()
        start = int(first) if start is None else start
        count = sum(stands[int(first):int(first) + int(count)])
        for part in ("zLow", "zHigh") if name == "zEmpty" else (name,) if count else ():
            faces_of = count // 2 if name == "zEmpty" else count
            rows.append(f"    {part} {{ type {sides[part == 'zHigh'] if name == 'zEmpty' else 'patch'}; nFaces {faces_of}; startFace {start}; }}")
            start += faces_of
    if axis:
        rows.append(f"    axis {{ type {axis}; nFaces 0; startFace {start}; }}")
    write(folder, "points", heads[0], ["(%.17g %.17g %.17g)" % tuple(points[i]) for i in used])
    write(folder, "faces", heads[1], [f"{len(c)}({' '.join(str(number[i]) for i in c)})" for c, s in zip(corners, stands) if s])
    write(folder, "owner", heads[2], [o for o, s in zip(owner, stands) if s])
    write(folder, "boundary", heads[3], rows)


class Wedges(harness.Folder, unittest.TestCase):
    def case(self, name, hollow=0.0, wedge=True, kind="wedge", flux="common", **options):
        """A pulse in a gas at rest, in a tube of walls."""
        at = boxes.centres(N, SIZE) + (0, hollow, 0)
        pulse = 1 + np.exp(-40 * ((at[:, 0] - 0.5) ** 2 + (at[:, 1] - hollow - 0.3) ** 2))
        case = harness.box_case(os.path.join(self.folder, name), N, SIZE, 100 * pulse, 0 * at, 1000 * pulse, 0.05, flux=flux, slip=("yHigh", "yLow") if wedge or hollow else ("yHigh",), format="ascii",
                                types=None if wedge or hollow else {"yLow": "symmetryPlane"})
        if not wedge:
            boxes.write_dictionary(case, "system", "meshDict", f"axis {{ origin (0 {-hollow!r} 0); direction (1 0 0); }}\n")
            return case
        to_wedge(case, hollow, **options)
        rules = f'zLow {kind}\nzHigh {kind}\n"x.*" zeroGradient\n"y.*" '
        for field, values in (("rho", 100 * pulse), ("p", 1000 * pulse), ("U", 0 * at)):
            boxes.write_field(case, field, values, rules + ("slip" if field == "U" else "zeroGradient"))
        return case

    def run_of(self, case, ranks=1):
        harness.program("granularGas", "-case", case, ranks=ranks)
        return harness.haff.Case(case)

    def test_is_the_plane_mesh(self):
        """Fields of a wedge, cell by cell, are those of the plane mesh; they have the types of the wedge, and a restart reads them."""
        for hollow, flux in ((0.0, "common"), (0.2, "common"), (0.0, "common; meshEngine polyhedral")):
            with self.subTest(hollow=hollow, flux=flux):
                plane = self.run_of(self.case(f"plane{hollow}{len(flux)}", hollow, wedge=False, flux=flux))
                wedge = self.run_of(self.case(f"wedge{hollow}{len(flux)}", hollow, flux=flux))
                self.assertGreater(np.abs(plane.field("U")[:, 1]).max(), 0.1)
                for name in ("rho", "U", "p"):
                    scale = np.abs(plane.field(name)).max()
                    np.testing.assert_allclose(wedge.field(name), plane.field(name), atol=1e-10 * scale)
                with open(os.path.join(wedge.path, wedge.times[-1], "rho")) as f:
                    written = f.read()
                self.assertRegex(written, r"zLow\s*\{\s*type\s+wedge;")
                again = self.run_of(wedge.path, ranks=2)
                np.testing.assert_array_equal(again.field("rho"), wedge.field("rho"))

    def test_ranks_and_axis_patch(self):
        """A patch `axis` without faces, as blockMesh leaves it; two ranks have the same bits."""
        one = self.run_of(self.case("one", axis="empty"))
        two = self.run_of(self.case("two", axis="empty"), ranks=2)
        np.testing.assert_array_equal(one.field("rho"), two.field("rho"))

    def test_refused(self):
        """What is no wedge: with the file, and what to mesh."""
        for name, options, says in (("turned", {"turn": 0.2}, "lie otherwise"), ("other", {"kind": "empty"}, "patch zLow is of type wedge"),
                                    ("leaning", {"lean": 0.3}, "lie otherwise"), ("bent", {"bend": 0.02}, "is no plane"),
                                    ("below", {"turn": np.pi}, "radius is negative"), ("half", {"sides": ("wedge", "patch")}, "not two patches of type wedge"),
                                    ("empty", {"sides": ("wedge", "empty")}, "type empty beside")):
            with self.subTest(name):
                done = harness.program("granularGas", "-case", self.case(name, **options), check=False)
                self.assertEqual(done.returncode, 1, done.stdout)
                self.assertIn(says, done.stderr)
                self.assertRegex(done.stderr, r"polyMesh/boundary|0/\w+:\d+")


if __name__ == "__main__":
    unittest.main()
