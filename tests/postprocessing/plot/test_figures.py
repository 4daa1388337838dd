# SPDX-License-Identifier: GPL-3.0-or-later
"""What all figures share: names on axes, and saving, which leaves a file whole or as it was."""
import os
import unittest

from tests.cases import harness

from haff.plot import figures


class Figures(harness.Folder, unittest.TestCase):
    def figure(self):
        fig, axes = figures.panels(1, 2)
        axes[0][0].plot([0, 1], [0, 1])
        figures.label(axes[0][0], "x", "alpha", "a title")
        figures.label(axes[0][1], "t", "other words")
        return fig, axes

    def test_names(self):
        """alpha is called alpha; fields have their units; any other text stands as it is."""
        fig, axes = self.figure()
        self.assertEqual([axes[0][0].get_xlabel(), axes[0][0].get_ylabel(), axes[0][0].get_title()], ["$x$ (cm)", r"packing fraction $\alpha$", "a title"])
        self.assertEqual([axes[0][1].get_xlabel(), axes[0][1].get_ylabel()], ["$t$ (s)", "other words"])
        self.assertEqual(figures.AXES["T"], "temperature $T$ (cm$^{2}$ s$^{-2}$)")
        self.assertEqual(figures.axis("T", figures.SI), "temperature $T$ (m$^{2}$ s$^{-2}$)")
        figures.plt.close(fig)

    def test_save(self):
        for suffix, magic in (("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")):
            path = os.path.join(self.folder, "a." + suffix)
            written = []
            for _ in range(2):
                figures.save(self.figure()[0], path)
                with open(path, "rb") as f:
                    written.append(f.read())
            self.assertTrue(written[0].startswith(magic))
            self.assertEqual(written[0], written[1], "the same figure is the same file")
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.pdf", "a.png", "a.svg"])

    def test_a_failed_save_changes_nothing(self):
        path = os.path.join(self.folder, "b.png")
        with open(path, "w") as f:
            f.write("before")
        fig, axes = self.figure()
        axes[0][0].set_title("$\\nosuchcommand$")
        with self.assertRaises(ValueError):
            figures.save(fig, path)
        with open(path) as f:
            self.assertEqual(f.read(), "before")
        os.remove(path)
        with self.assertRaisesRegex(ValueError, r"b\.jpg: figures are written as \.png, \.pdf or \.svg"):
            figures.save(self.figure()[0], os.path.join(self.folder, "b.jpg"))
        self.assertEqual([n for n in os.listdir(self.folder) if n.startswith("b.")], [])


if __name__ == "__main__":
    unittest.main()
