# SPDX-License-Identifier: GPL-3.0-or-later
"""What the numbers of a case are measured in.

A case says so in system/units (length cm; mass g; time s;); without that file they are kg, m and s, as everywhere in OpenFOAM. A copy
of a case that lies inside its folder has the units of that case. A name "" leaves that unit out (grains that are counted have no mass).
"""
import os
import re

SI = {"mass": "kg", "length": "m", "time": "s"}
ORDER = ("mass", "length", "time")
OTHERS = ("K", "mol", "A", "cd")


def read(path):
    """{"mass", "length", "time"}: texts, of the case in the folder `path` or of the case around it. ValueError for other keys."""
    for folder in (path, os.path.dirname(os.path.abspath(path))):
        file = os.path.join(folder, "system", "units")
        if os.path.isfile(file):
            with open(file, errors="replace") as f:
                text = re.sub(r"FoamFile\s*\{.*?\}|//[^\n]*|/\*.*?\*/", " ", f.read(), flags=re.S)
            found = {k: v.strip().strip('"') for k, v in re.findall(r"(\w+)\s+(\"[^\"]*\"|[^;]*);", text)}
            wrong = sorted(found.keys() - SI.keys())
            if wrong:
                raise ValueError(f"{file}: {wrong[0]} is none of mass, length, time")
            return {**SI, **found}
    return dict(SI)


def text(exponents, of=SI):
    """Exponents of mass, length, time, K, mol, A, cd as a short text: "kg/m^3", "m^2/s^2", "1/s"; "" where there is no unit."""
    powers = [(name, n) for name, n in zip([of[k] for k in ORDER] + list(OTHERS), exponents) if name and n]
    power = lambda name, n: name if n == 1 else f"{name}^{n:g}"
    above = " ".join(power(name, n) for name, n in powers if n > 0)
    below = [power(name, -n) for name, n in powers if n < 0]
    return "/".join([above or "1"] + below) if powers else ""
