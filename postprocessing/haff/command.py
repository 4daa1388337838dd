# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of every command: one look, `-help` and `-version` everywhere, and files only where one is told to."""
import argparse
import os
import subprocess
import sys

VERSION = "0.2.0"  # CMakeLists.txt has it, too


def parser(text, **others):
    """An argparse.ArgumentParser whose help is `text`, by -help, -h or --help; options are written out."""
    made = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter, add_help=False, allow_abbrev=False,
                                   **others)
    made.add_argument("-help", "-h", "--help", action="help", help="this text")
    made.add_argument("-version", "--version", action=Version, nargs=0, default=argparse.SUPPRESS, help="version, programs, licence")
    return made


class Version(argparse.Action):
    """Prints version_text and ends the command."""

    def __call__(self, parser, *_):
        print(version_text(parser.prog))
        parser.exit()


def version_text(name):
    """What -version says: name and version, what Python it is, which programs it calls, and what these were made from. The licence
    is said by them; without them, here."""
    import matplotlib
    import numpy
    from haff.paths import program
    lines = [f"{name} {VERSION}", f"Python    {sys.version.split()[0]}, numpy {numpy.__version__}, matplotlib {matplotlib.__version__}"]
    try:
        path = program("granularGas")
        said = subprocess.run([path, "-version"], capture_output=True, text=True, check=True).stdout.strip().split("\n")
        return "\n".join([*lines, f"programs  {said[0]}, in {os.path.dirname(path)}", *said[1:]])
    except (OSError, subprocess.CalledProcessError):
        return "\n".join([*lines, "programs  none was found", "", LICENCE])


LICENCE = """Licence GPL-3.0-or-later: GNU GPL version 3 or later <https://www.gnu.org/licenses/gpl-3.0.html>.
This is free software: you may change and pass it on. There is NO WARRANTY, as far as the law permits."""
