# SPDX-License-Identifier: GPL-3.0-or-later
"""Energy of the grains beside Haff's law and their impacts; spectra of this run beside the kept ones. Beside the gas: ../cooling3D."""
from haff.plot import script
from studies.measured import clustering

clustering.draw_grains(script.folder(), script.here(), script.target("cooling3DMD"), (500, 3000, 20000))
