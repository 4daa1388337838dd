# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavelengths of gas and grains beside the paper's, from the table of the sweep made here, or that beside this file."""
from haff.plot import script
from studies import faradayDiagram

own = script.folder("table")
faradayDiagram.draw(own if faradayDiagram.table(own) else script.here(), script.target("faradayDiagram"))
