# SPDX-License-Identifier: GPL-3.0-or-later
"""Names the source tree that the studies lie in: its paths, its commit."""
import datetime
import os
import subprocess

from haff.paths import TOP


def measured_by(command):
    """The line that stands above a table of a report: commit of the source tree, day, command."""
    said = subprocess.run(["git", "-C", TOP, "rev-parse", "--short=8", "HEAD"], capture_output=True, text=True)
    commit = said.stdout.strip() if said.returncode == 0 else "an unknown commit"
    return f"Measured at {commit}, {datetime.date.today()}: `{command}`."


def of_source(*parts):
    """A path in the source tree."""
    return os.path.join(TOP, *parts)
