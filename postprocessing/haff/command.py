# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of every command: one look, `-help` and `-version` everywhere, files only where the user says so, and what goes
wrong said in one message."""
import argparse
import contextlib
import dis
import os
import re
import subprocess
import sys

from haff.paths import TOP, lacking, program

VERSION = "0.3.0"  # CMakeLists.txt has it, too


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
    from importlib.metadata import version  # to load matplotlib takes ten times as long
    lines = [f"{name} {VERSION}", f"Python    {sys.version.split()[0]}, numpy {version('numpy')}, matplotlib {version('matplotlib')}"]
    try:
        path = program("granularGas")
        said = subprocess.run([path, "-version"], capture_output=True, text=True, check=True).stdout.strip().split("\n")
        return "\n".join([*lines, f"programs  {said[0]}, in {os.path.dirname(path)}", *said[1:]])
    except (OSError, subprocess.CalledProcessError):
        return "\n".join([*lines, "programs  none was found", "", LICENCE])


LICENCE = """Licence GPL-3.0-or-later: GNU GPL version 3 or later <https://www.gnu.org/licenses/gpl-3.0.html>.
This is free software: you may change and pass it on. There is NO WARRANTY, as far as the law permits."""

OURS = os.path.dirname(os.path.abspath(__file__)), os.path.join(TOP, "postprocessing", "studies")
CURES = {FileNotFoundError: "No such file or folder", IsADirectoryError: "this is a folder, and a file is wanted here: rename or remove it",
         NotADirectoryError: "this is a file, and a folder is wanted here: rename or remove it", PermissionError: "permission denied; chmod gives it"}


class Reading:
    """The last file below one of some folders that Python has opened. An error that no check foresaw is most often about that file."""

    hooked, folders, last = False, (), None

    @classmethod
    def watch(cls, words):
        cls.folders, cls.last = tuple(os.path.join(os.path.abspath(w), "") for w in words if os.path.isdir(w)), None
        if not cls.hooked:
            sys.addaudithook(cls.seen)  # which cannot be taken away again
            cls.hooked = True

    @classmethod
    def seen(cls, event, arguments):
        if event == "open" and cls.folders and isinstance(arguments[0], str) and not arguments[0].endswith((".py", ".pyc")):
            path = os.path.abspath(arguments[0])
            if path.startswith(cls.folders):
                cls.last = path


@contextlib.contextmanager
def replacing(path, suffix=""):
    """Gives the temporary name under which a file is written first. It becomes `path` when the file is whole; after an error it is removed."""
    temporary = f"{path.removesuffix(suffix)}.{os.getpid()}.tmp{suffix}"
    try:
        yield temporary
        os.replace(temporary, path)
    finally:
        if os.path.exists(temporary):
            os.remove(temporary)


def is_meant(error):
    """Was the error raised by a `raise` of this package or of a study, so that its text is for the user?"""
    last = error.__traceback__
    while last and last.tb_next:
        last = last.tb_next
    code = last and last.tb_frame.f_code
    return bool(last) and code.co_filename.startswith(OURS) and code.co_code[last.tb_lasti] == dis.opmap["RAISE_VARARGS"]


def cure(text):
    """What to do about a file that an error names first, where the error does not say so: of a mesh, or of a time that was written."""
    path = text.split(": ")[0]
    folder = os.path.dirname(path)
    if not os.path.isfile(path):
        return ""
    if os.path.basename(folder) == "polyMesh" and "make it again" not in text:
        return "; the mesh is damaged: make it again (gmshToCase, or the case's Allrun)"
    if re.fullmatch(r"\d+(\.\d*)?([eE][-+]?\d+)?", os.path.basename(folder)) and "expression" not in text:
        return f"; the file is damaged: take another time, or remove {folder}, and a run goes on from the time before"
    return ""


def message(error):
    """The message for a user: the text of the error, or the file that is wrong, and what to do."""
    if is_meant(error):
        text = str(error.args[0] if isinstance(error, KeyError) and error.args else error)
        return text + cure(text)
    if isinstance(error, ModuleNotFoundError) and error.name:
        return lacking(error.name)
    if isinstance(error, OSError) and error.filename:
        path = re.sub(r"\.\d+\.tmp$", "", str(error.filename))  # files are written under a temporary name
        return f"{path}: {CURES.get(type(error)) or error.strerror}"
    if isinstance(error, MemoryError):
        return f"there is too little memory for this ({error})"
    said = f"{type(error).__name__}: {error}"
    if Reading.last:
        return f"{Reading.last} does not hold what is wanted ({said}); checkCase looks a case over. If that finds it sound, HAFF_TRACEBACK=1 shows where this came from: please report that"
    return f"{said}; this is a fault of haff: HAFF_TRACEBACK=1 shows where this came from: please report that"


def ended(name, work):
    """The exit code of a command's work. What goes wrong is one message on stderr, and exit code 1; with HAFF_TRACEBACK=1 Python says more."""
    try:
        return work() or 0
    except BrokenPipeError:
        return 1
    except KeyboardInterrupt:
        print(f"{name}: stopped", file=sys.stderr)
        return 130
    except Exception as error:  # whatever it is, a user gets a sentence
        if os.environ.get("HAFF_TRACEBACK"):
            raise
        print(f"{name}: {message(error)}", file=sys.stderr)
        return 1
