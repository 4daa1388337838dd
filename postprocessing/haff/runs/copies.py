# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of cases: what a run starts from, without what runs have made, and with other entries.

A copy has a file run.json, which says of which case and with which changes it was made and how far its run has come. It
appears whole or not at all. Nothing here writes into the case that is copied.
"""
import difflib
import hashlib
import json
import os
import re
import shutil

from haff.case import entries
from haff.case.foam import is_time, times_in

NOTES = "run.json"
MADE = re.compile(r"\..*|postProcessing|VTK|ensemble|diverged|processor\d+|log\..*|run\.json|__pycache__")  # by runs, in the folder of a case
UNREAD = re.compile(r"README.*|(expected|tables)\.json|.*\.(py|png|pdf|svg|gif|mp4|foam)|All\w+")  # by programs, in the folder of a case
MESHES = "mesh.geo", "mesh.msh"


class ChangedCase(ValueError):
    """A folder does not hold the wanted run: it is of another case, has other entries, or is no run at all."""


def path_of(case):
    """The folder of a case given as a path or as a haff.Case. FileNotFoundError where it is no case."""
    path = getattr(case, "path", case)
    if not os.path.isfile(os.path.join(path, "system", "controlDict")):
        raise FileNotFoundError(f"{path} is no case directory (it has no system/controlDict)")
    return os.path.abspath(path)


def control(case, entry, default=None):
    """An entry of system/controlDict as text."""
    try:
        value = entries.get(os.path.join(case, "system", "controlDict"), entry)
    except entries.EntryError:
        return default
    return entries.as_text(value)


def number(text, default=None):
    try:
        return float(text)
    except (TypeError, ValueError):
        return default


def start(case):
    """The time folder from which a run that begins anew starts, or None: 0.orig, or there is none."""
    found = times_in(case)
    if control(case, "startFrom") == "startTime":
        at = number(control(case, "startTime"), 0.0)
        found = [n for n in found if float(n) == at]
    if os.path.isdir(os.path.join(case, "0.orig")):
        found = [n for n in found if float(n) != 0] if control(case, "startFrom") == "startTime" else []
    return found[0] if found else None


def reads(case, name):
    """Does a dictionary of the case name another case that lies in it?"""
    for base in ("system", "constant"):
        for folder, _, files in os.walk(os.path.join(case, base), followlinks=True):
            for file in files if "polyMesh" not in folder else ():
                with open(os.path.join(folder, file), "rb") as f:
                    if re.search(rb'\bcase\s+"?(\./)?' + re.escape(name.encode()) + rb'/?"?\s*;', f.read(1 << 20)):
                        return True
    return False


def has_mesh(case):
    """Is constant/polyMesh there, and no older than mesh.geo or mesh.msh?"""
    folder = os.path.join(case, "constant", "polyMesh")
    boundary = [os.path.join(folder, n) for n in ("boundary", "boundary.gz") if os.path.exists(os.path.join(folder, n))]
    sources = [os.path.join(case, n) for n in MESHES if os.path.exists(os.path.join(case, n))]
    return bool(boundary) and not any(os.path.getmtime(s) > os.path.getmtime(boundary[0]) for s in sources[:1])


def files(case, with_mesh):
    """Every file that a run starts from, as paths from the case's folder, in order."""
    first, found = start(case), []
    for name in sorted(os.listdir(case)):
        path = os.path.join(case, name)
        if MADE.fullmatch(name) or UNREAD.fullmatch(name) or (is_time(name) and name != first):
            continue
        if os.path.isfile(os.path.join(path, "system", "controlDict")) and not reads(case, name):
            continue  # a case of its own
        if os.path.isfile(path):
            found.append(name)
        for folder, folders, names in os.walk(path, followlinks=True):
            if not with_mesh and os.path.relpath(folder, case) == "constant":
                folders[:] = [n for n in folders if n != "polyMesh"]
            folders.sort()
            found += [os.path.relpath(os.path.join(folder, n), case) for n in sorted(names) if n != ".haff.lock"]
    return found


def digests(case):
    """{file: SHA-256} of all that a run starts from; without a mesh that can be made from mesh.geo or mesh.msh."""
    made = any(os.path.exists(os.path.join(case, n)) for n in MESHES)
    found = {}
    for name in files(case, not made):
        with open(os.path.join(case, name), "rb") as f:
            found[name] = hashlib.sha256(f.read()).hexdigest()
    return found


def difference(case, was, origin):
    """What is another than it was, in words, or None. was: digests of `origin`."""
    here = digests(case)
    other = sorted(k for k in was.keys() | here.keys() if was.get(k) != here.get(k))
    if not other:
        return None
    what = "has changed" if other[0] in was and other[0] in here else "is new" if other[0] in here else "is gone"
    same = "" if os.path.abspath(origin) == os.path.abspath(case) else f" (it was made from {origin})"
    return f"{os.path.join(case, other[0])} {what} since then{same}" + (f", and {len(other) - 1} more" if other[1:] else "")


def edited(case, changes):
    """{file: its text with the entries set}; the files of `case` stay. EntryError, FileNotFoundError, ValueError."""
    texts = {}
    for file, wanted in (changes or {}).items():
        if not isinstance(wanted, dict):
            raise TypeError(f"changes of {file}: a dictionary {{entry: value}} is needed, not {wanted!r}")
        if os.path.isabs(file) or ".." in file.split("/"):
            raise ValueError(f"{file} is no file of the case: give its path from the case's folder, as constant/granularProperties")
        if file not in files(case, True):
            near = difflib.get_close_matches(file, files(case, False), 1, 0.5)
            raise FileNotFoundError(f"{os.path.join(case, file)} is no file that a run of {case} starts from"
                                    + (f"; did you mean {near[0]}?" if near else ""))
        path = os.path.join(case, file)
        texts[file] = entries.read(path)
        for entry, value in entries.flat(wanted):
            texts[file] = entries.changed(texts[file], path, entry, value)
    return texts


def canonical(changes):
    """Changes as text, to compare them: {file: {path: value}}."""
    return {file: {entries.shown(entry): None if value is None else label(value) for entry, value in entries.flat(wanted)}
            for file, wanted in sorted((changes or {}).items())}


def label(value):
    """A value as text, the same for 10, 10.0 and "10"."""
    text = entries.as_text(value)
    one = number(text)
    if one is None:
        return text
    return str(int(one)) if one == int(one) and abs(one) < 1e15 else repr(one)


def name_of(values):
    """The name of a folder for {name: value}, as restitution=0.9,N=20; with a digest where letters had to go."""
    text = ",".join(f"{name}={label(value)}" for name, value in values.items())
    plain = re.sub(r"[^-+.,=\w]", "_", text)
    if plain == text and len(text) <= 100:
        return text
    return f"{plain[:80]}-{hashlib.sha256(text.encode()).hexdigest()[:8]}"


def numbers_of(text):
    """{name: what stands behind it} of the DefineConstant[..] of a mesh.geo."""
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.S)
    found = {}
    for block in re.findall(r"DefineConstant\s*\[(.*?)\]\s*;", text, re.S):
        found.update(re.findall(r"(\w+)\s*=\s*(\{.*?\}|[^,{}]*)", block, re.S))
    return found


def check_mesh(case, mesh):
    """Refuses numbers for mesh.geo that it does not ask for or that are outside its Min and Max: gmsh would take no notice of the
    ones and go to the end of its range with the others. ValueError, FileNotFoundError."""
    if not mesh:
        return
    path = os.path.join(case, "mesh.geo")
    if not os.path.exists(path):
        raise FileNotFoundError(f"{path} is not there, whose numbers mesh={mesh!r} is to set")
    with open(path, encoding="latin-1") as f:
        text = f.read()
    known = numbers_of(text)
    for name, value in mesh.items():
        if name not in known and not re.search(r"^\s*(Include|Merge)\b", text, re.M):
            near = difflib.get_close_matches(name, known, 1, 0.4)
            raise ValueError(f"{path} has no number '{name}'" + (f"; did you mean {near[0]}?" if near else "")
                             + f" (its DefineConstant has: {', '.join(known) or 'none'})")
        if number(value) is None:
            raise ValueError(f"{path}: {name} = {value!r} is no number")
        for word, wrong in (("Min", lambda end: number(value) < end), ("Max", lambda end: number(value) > end)):
            end = re.search(rf"\b{word}\s+([-+.\deE]+)", known.get(name, ""))
            if end and wrong(float(end[1])):
                raise ValueError(f"{path}: {name} = {label(value)}; allowed by mesh.geo: {word} {end[1]}")


def write_json(path, value):
    """Whole or not at all."""
    with open(path + ".tmp", "w") as f:
        json.dump(value, f, indent=1)
        f.write("\n")
    os.replace(path + ".tmp", path)


def read_json(path):
    """What a file of write_json holds, or None."""
    try:
        with open(path) as f:
            return json.load(f)
    except FileNotFoundError:
        return None
    except ValueError as e:
        raise ChangedCase(f"{path} is no JSON ({e}): remove it, or the whole folder, and the command makes it anew") from None


def notes(folder):
    """What run.json of a folder says, or None."""
    found = read_json(os.path.join(folder, NOTES))
    if found is not None and not (isinstance(found, dict) and {"case", "changes", "mesh", "base", "state"} <= found.keys()):
        raise ChangedCase(f"{os.path.join(folder, NOTES)} does not say of which case and entries the run is: remove it, or the whole folder, and the command makes it anew")
    return found


def keep(folder, **values):
    """Sets entries of run.json."""
    write_json(os.path.join(folder, NOTES), {**notes(folder), **values})


def make(case, folder, changes, mesh, base=None):
    """The copy of a case in `folder`, or the one that stands there. Its mesh is not made. A copy with other changes gives way if
    its run has written nothing. base: digests that the case must have. ChangedCase, where something else stands there; the errors of `edited` and `check_mesh`."""
    check_mesh(case, mesh)
    texts = edited(case, changes)
    wanted = {"changes": canonical(changes), "mesh": {k: label(v) for k, v in (mesh or {}).items()}}
    found = notes(folder)
    if found:
        why = other(case, folder, found, wanted)
        if why and has_results(folder):
            raise ChangedCase(f"{folder} holds a run {why}; name another folder, or remove that one")
        if not why:
            return
        shutil.rmtree(folder)
    if os.path.lexists(folder) and (not os.path.isdir(folder) or os.listdir(folder)):
        raise ChangedCase(f"{folder} is there and is no run of {case} (it has no {NOTES}): name another folder")
    part = os.path.join(os.path.dirname(os.path.abspath(folder)), f".{os.path.basename(os.path.abspath(folder))}.part")
    shutil.rmtree(part, ignore_errors=True)
    meshed = not mesh and has_mesh(case)
    for name in files(case, meshed):
        os.makedirs(os.path.join(part, os.path.dirname(name)), exist_ok=True)
        shutil.copy2(os.path.join(case, name), os.path.join(part, name))
    for name, text in texts.items():
        with open(os.path.join(part, name), "w", encoding="latin-1", newline="") as f:
            f.write(text)
    now = digests(case)
    if base and now != base:
        shutil.rmtree(part)
        raise ChangedCase(f"{difference(case, base, case)}, the begin of the sweep")
    write_json(os.path.join(part, NOTES), {"case": case, **wanted, "base": now, "meshed": meshed, "state": "begun", "seconds": 0.0})
    os.rename(part, folder)


def has_results(folder):
    """Has a run in a copy written more than its start?"""
    return notes(folder)["state"] == "done" or any(t != start(folder) and float(t) != 0 for t in times_in(folder))


def other(case, folder, found, wanted):
    """Why a copy that stands there is not the one that is wanted, in words; None, if it is."""
    for what, value in wanted.items():
        if found.get(what) != value:
            return f"with {what} {found.get(what)}, not {value}"
    why = difference(case, found["base"], found["case"])
    return f"of a case that was another: {why}" if why else None
