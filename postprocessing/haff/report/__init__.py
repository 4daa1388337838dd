# SPDX-License-Identifier: GPL-3.0-or-later
"""Reports of runs as one HTML file: `haff report`. page.css and page.js are inlined into it, as is uPlot from vendor/."""
