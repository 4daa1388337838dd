# SPDX-License-Identifier: GPL-3.0-or-later
"""Calls programs as one does who has neither the source tree nor the build: nothing of either is in the environment."""
import glob
import os
import re
import shutil
import subprocess

from tests.cases import harness

BUILD = os.path.dirname(harness.BIN)
INSTALLS = os.path.exists(os.path.join(BUILD, "cmake_install.cmake"))
LIBRARIES = [name for name in ("haffgas.so", "haffimplicit.so") if os.path.exists(os.path.join(harness.BIN, name))]
MODULE = "haffimplicit.so" in LIBRARIES
with open(os.path.join(harness.SOURCE, "CMakeLists.txt"), encoding="utf-8") as _file:
    _LISTS = dict(re.findall(r"^(?:project\(haff )?(?:set\()?(PROGRAMS|COMMANDS|VERSION) ([^)\n]*?)(?: LANGUAGES.*)?\)", _file.read(), re.M))
PROGRAMS, COMMANDS, VERSION = _LISTS["PROGRAMS"].split(), ["haff", *_LISTS["COMMANDS"].split()], _LISTS["VERSION"]


def environment(path=""):
    """Of a user who knows nothing of this tree; `path` first in PATH."""
    env = {k: v for k, v in os.environ.items() if not k.startswith(("HAFF", "PYTHON", "PIP", "VIRTUAL"))}
    return {**env, "PATH": ":".join([path] * bool(path) + ["/usr/local/bin", "/usr/bin", "/bin", "/usr/sbin", "/sbin"]), "PIP_NO_INDEX": "1",
            "PIP_DISABLE_PIP_VERSION_CHECK": "1", "MPLBACKEND": "Agg"}


def call(*command, cwd, path="", code=0, **more):
    """What a command says; an exit code other than `code` is a failure that shows it."""
    done = subprocess.run(command, capture_output=True, text=True, cwd=cwd, env={**environment(path), **more}, timeout=300)
    if done.returncode != code:
        raise AssertionError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout if code == 0 else done.stderr


def cached(name):
    """An entry of the build's CMakeCache.txt."""
    with open(os.path.join(BUILD, "CMakeCache.txt"), encoding="utf-8") as file:
        found = re.search(rf"^{name}:\w+=(.*)$", file.read(), re.M)
    return found[1] if found else ""


def keep_configuration(folder, source=harness.SOURCE):
    """What CMake found out about compiler and libraries for the build of this tree, for another one of `source` in `folder`: it takes a fifth
    of the time then. Options and the generator are left out."""
    for path in glob.glob(os.path.join(BUILD, "CMakeFiles", "[0-9]*")):
        shutil.copytree(path, os.path.join(folder, "CMakeFiles", os.path.basename(path)))
    places = {cached("CMAKE_CACHEFILE_DIR"): folder, cached("CMAKE_HOME_DIRECTORY"): source}
    with open(os.path.join(BUILD, "CMakeCache.txt"), encoding="utf-8") as file:
        text = re.sub("|".join(map(re.escape, places)), lambda found: places[found[0]], file.read())
    with open(os.path.join(folder, "CMakeCache.txt"), "w", encoding="utf-8") as file:
        file.write(re.sub(r"(?m)^(//.*\n)*(HAFF_\w+|BUILD_TESTING|CMAKE_GENERATOR\w*|CMAKE_MAKE_PROGRAM|CMAKE_BUILD_TYPE|CMAKE_C_FLAGS\w*|CMAKE_EXPORT\w+):.*\n", "", text))


def texts(folder):
    """{path below the folder: bytes} of its files, links left out."""
    found = {}
    for place, _, names in os.walk(folder):
        for path in (os.path.join(place, name) for name in names):
            if not os.path.islink(path):
                with open(path, "rb") as file:
                    found[os.path.relpath(path, folder)] = file.read()
    return found


def traces(folder):
    """Files of a folder that name the source tree or the build, but for what debuggers read of a build for them."""
    if cached("CMAKE_BUILD_TYPE") == "Debug":
        return []
    return sorted(path for path, text in texts(folder).items() if any(p.encode() in text for p in {harness.SOURCE, BUILD}))
