"""Wavelengths of gas and grains beside the paper's, from the table of the sweep made here, or that beside this file."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

from haff.plot import figures  # noqa: E402
from haff.studies import faradayDiagram  # noqa: E402

folder = figures.folder()
own = os.path.join(folder, "table")
faradayDiagram.draw(own if faradayDiagram.table(own) else folder)
