"""Where the programs of haff and its source tree are."""
import os
import shutil

TOP = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")))


def folder_of_programs():
    """$HAFF_BIN; else build/bin of the source tree in which this package lies; else the folder of the granularGas in PATH."""
    if "HAFF_BIN" in os.environ:
        return os.environ["HAFF_BIN"]
    built = os.path.join(TOP, "build", "bin")
    found = None if os.path.exists(os.path.join(built, "granularGas")) else shutil.which("granularGas")
    return os.path.dirname(found) if found else built


def program(name):
    """The path of a program; FileNotFoundError says what to do where there is none."""
    path = os.path.join(folder_of_programs(), name)
    if not os.path.exists(path):
        raise FileNotFoundError(f"{path} is not there: build haff (cmake --build build), put its programs in PATH, or set HAFF_BIN to their folder")
    return path


def of_source(*parts):
    """A path in the source tree; FileNotFoundError where the package was installed without it."""
    path = os.path.join(TOP, *parts)
    if not os.path.isdir(os.path.join(TOP, "cases")):
        raise FileNotFoundError(f"{path} is a part of the source tree of haff: set HAFF_SOURCE to its folder")
    return path
