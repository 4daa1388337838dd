# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the programs of haff and its source tree are."""
import difflib
import importlib
import os
import shutil
import sys

TOP = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")))

WITHOUT_STUDIES = "this needs the studies, a part of the source tree of haff that is not installed: set HAFF_SOURCE to the folder of that tree"


def lacking(module):
    """The message for a Python without such a module: which Python to take, or how this one gets it."""
    if module == "studies":
        return WITHOUT_STUDIES
    other = "/usr/bin/python3"
    take = f"take {other}, or  " if os.path.exists(other) and os.path.realpath(other) != os.path.realpath(sys.executable) else f"apt-get install python3-{module}, or  "
    return f"{sys.executable} has no {module}, which haff needs: {take}{sys.executable} -m pip install {module}"


def suggestion(word, known):
    """"; did you mean NAME?" of the known name that is nearest to a word, whatever its capitals; "" where none is near."""
    names = {name.lower(): name for name in known}
    near = difflib.get_close_matches(word.lower(), names, 1, 0.4)
    return f"; did you mean {names[near[0]]}?" if near else ""


def folder_of_programs():
    """$HAFF_BIN; else build/bin of the source tree in which this package lies; else bin of the prefix in which it is installed,
    or of Python's own; else the folder of the granularGas in PATH."""
    if "HAFF_BIN" in os.environ:
        return os.environ["HAFF_BIN"]
    built = os.path.join(TOP, "build", "bin")
    found = next((folder for folder in (built, *installed()) if os.path.exists(os.path.join(folder, "granularGas"))), None)
    on_path = None if found else shutil.which("granularGas")
    return found or (os.path.dirname(on_path) if on_path else built)


def installed():
    """bin of PREFIX, where this package lies in PREFIX/lib/haff/python or PREFIX/lib/pythonX.Y/site-packages."""
    above = os.path.dirname(os.path.abspath(__file__))
    prefixes = [above := os.path.dirname(above) for _ in range(4)][2:]
    return [os.path.join(prefix, "bin") for prefix in (*prefixes, sys.prefix)]


def program(name):
    """The path of a program; FileNotFoundError says what to do where there is none."""
    path = os.path.join(folder_of_programs(), name)
    if not os.path.exists(path):
        raise FileNotFoundError(f"{path} is not there: build haff (cmake --build build), put its programs in PATH, or set HAFF_BIN to their folder")
    return path


def has_studies():
    """Are the studies there? They lie in postprocessing/studies of the source tree, and no installation has them."""
    return os.path.isdir(os.path.join(TOP, "postprocessing", "studies"))


def find_studies():
    """Lets Python find the package `studies`. FileNotFoundError without the source tree."""
    if not has_studies():
        raise FileNotFoundError(WITHOUT_STUDIES)
    if (folder := os.path.join(TOP, "postprocessing")) not in sys.path:
        sys.path.append(folder)


def take_study(name):
    """A module of the studies, as "checks.shocks". FileNotFoundError without the source tree; ModuleNotFoundError."""
    find_studies()
    return importlib.import_module(f"studies.{name}")
