"""Gas that falls on a wall, before the collapse: packing at the wall, and the mass that has flowed in."""
import unittest

from tests.cases import harness


class Wall(harness.Folder, unittest.TestCase):
    def test_250_cells(self):
        self.compare(self.short("wall", 250, endTime=0.2), harness.entries("wall"))


if __name__ == "__main__":
    unittest.main()
