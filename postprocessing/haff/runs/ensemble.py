# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a case of granularMD several times, each time with another seed, and writes the means over these runs with their standard errors.

    case = haff.ensemble("cases/faradayMD", 8, cores=2)
    case.field("alpha", "20"), case.field("alphaError", "20")

Member k is a copy of the case with the seed k in CASE/ensemble/seed=k. The time folders of the case get the means: fields of the usual
names, as if the windows of all members were one, and their standard errors: alphaError, alphaError.big of alpha.big. The columns of grains.dat
get theirs, too: case.table("grains"), case.table("grainsError").
"""
import os
import re
import shutil

import numpy as np

from haff.case import foam
from haff.case.case import Case
from haff.case.foam import times_in
from haff.runs import copies
from haff.runs.run import RunError, application
from haff.runs.sweep import sweep

PROPERTIES, CONTROL = "constant/particleProperties", "system/controlDict"
NOTE = os.path.join("uniform", "ensemble")


def kind_of(name):
    """The suffix of a field of one kind of grains, as .big of alpha.big, or "". The weight of U and T is rho, or that kind's alpha."""
    return name[name.index("."):] if "." in name else ""


def pooled(f, name, dim):
    """The field as if the windows of all members were one: U and T are of all grains that were there, T about the common U.
    f: {name: [members][cells] or [members][cells][components]}."""
    kind = kind_of(name)
    base = name[:len(name) - len(kind)]
    if base not in ("U", "T", "TComponents", "p"):
        return f[name].mean(axis=0)
    weight = f["alpha" + kind if kind else "rho"][..., None]
    total = weight.sum(axis=0)

    def mean(v):
        return np.divide((weight * v).sum(axis=0), total, out=np.zeros(v.shape[1:]), where=total > 0)
    u = mean(f["U" + kind])
    spread = mean((f["U" + kind] - u) ** 2)
    if base == "U":
        return u
    if base == "TComponents":
        return mean(f[name]) + spread
    T = mean(f["T" + kind][..., None])[:, 0] + spread.sum(axis=1) / dim
    return T if base == "T" else (f["p"] - f["rho"] * f["T"]).mean(axis=0) + f["rho"].mean(axis=0) * T


def mean_and_error(f, name, dim):
    """The pooled field and its standard error by the jackknife, which for a plain mean is the usual one."""
    n = len(f[name])
    needed = {k: v for k, v in f.items() if kind_of(k) == kind_of(name)}
    without = np.array([pooled({k: np.delete(v, i, axis=0) for k, v in needed.items()}, name, dim) for i in range(n)])
    return pooled(f, name, dim), np.sqrt((n - 1) / n * ((without - without.mean(axis=0)) ** 2).sum(axis=0))


def write_field(like, path, name, values, patches):
    """A field file in the format of another, `like`; patches: are its patch entries kept? Else those of empty and cyclic patches."""
    f = like.file
    values = np.ascontiguousarray(values, f.scalar)
    head = bytes(f.data[:len(f.data) - len(f.view)]) + f.part(0, like.entry.start())
    head = re.sub(rb"(\bobject\s+)[^;]*;", rb"\g<1>" + name.encode() + b";", head)
    tail = f.part(like.internal[1], len(f.view))
    if not patches:
        tail = b";\n\nboundaryField\n{\n" + b"".join(
            b"    %s\n    {\n        type            %s;\n    }\n" % (patch.encode(), (p.type if p.type in ("empty", "cyclic") else "zeroGradient").encode())
            for patch, p in like.patches().items()) + b"}\n"
    kind = "scalar" if like.components == 1 else "vector"
    if f.binary:
        body = values.tobytes()
    else:
        rows = values.reshape(len(values), -1)
        body = "\n".join(("(%s)" if like.components > 1 else "%s") % " ".join(map(repr, map(float, row))) for row in rows).encode()
    with open(path, "wb") as out:
        out.write(head + f"internalField   nonuniform List<{kind}>\n{len(values)}\n(".encode() + body + b")" + tail)


def write_time(case, members, time):
    """One time of the case: the means over the members, whole or not at all."""
    part, end = os.path.join(case.path, f".{time}.part"), os.path.join(case.path, time)
    shutil.rmtree(part, ignore_errors=True)
    os.makedirs(os.path.join(part, "uniform"))
    names = members[0].fields(time)
    f = {name: np.array([m.field(name, time) for m in members]) for name in names}
    dim = 3 - ("empty" in {p.type for p in foam.Field(members[0]._field_path("U", time)).patches().values()})
    for name in names:
        like = foam.Field(members[0]._field_path(name, time))
        mean, error = mean_and_error(f, name, dim)
        kind = kind_of(name)
        error_name = name[:len(name) - len(kind)] + "Error" + kind
        write_field(like, os.path.join(part, name), name, mean, True)
        write_field(like, os.path.join(part, error_name), error_name, error, False)
    with open(os.path.join(part, NOTE), "w") as out:
        out.write(foam.header("dictionary", "ensemble", f"{time}/uniform") + f"\nmembers {len(members)};\n")
    shutil.copy2(os.path.join(members[0].path, time, "uniform", "time"), os.path.join(part, "uniform", "time"))
    shutil.rmtree(end, ignore_errors=True)
    os.rename(part, end)


def write_table(case, members):
    """Means and standard errors of the columns of grains.dat, at the times that all members have."""
    tables = [m.table("grains", "grains.dat") for m in members]
    for t in tables[1:]:
        tables[0] = tables[0][np.isin(tables[0][:, 0], t[:, 0])]
    rows = np.array([t[np.isin(t[:, 0], tables[0][:, 0])] for t in tables])
    source = os.path.join(members[0].path, "postProcessing", "grains")
    start = min(times_in(source), key=float)
    with open(os.path.join(source, start, "grains.dat")) as f:
        titles = [line for line in f if line.startswith("# Time")][0]
    error = rows.std(axis=0, ddof=1) / np.sqrt(len(members))
    error[:, 0] = rows[0, :, 0]
    for name, what, values in (("grains", "Means", rows.mean(axis=0)), ("grainsError", "Standard errors of means", error)):
        folder = os.path.join(case.path, "postProcessing", name, start)
        os.makedirs(folder, exist_ok=True)
        np.savetxt(os.path.join(folder, "grains.dat"), values, fmt="%.17g", comments="", header=f"# {what} over {len(members)} members.\n{titles.strip()}")


def check(case):
    """Refuses cases without seeds, starts on which seeds have no effect, and results that means would replace. ValueError, FileNotFoundError."""
    if os.path.basename(application(case)) != "granularMD":
        raise ValueError(f"{os.path.join(case, CONTROL)}: only application granularMD has a seed; other solvers would give the same run again")
    if not os.path.exists(os.path.join(case, PROPERTIES)):
        raise FileNotFoundError(f"{os.path.join(case, PROPERTIES)} is not there, where each member gets its seed: make it, with the entry  seed 1;")
    begin = copies.start(case)
    first = "0.orig" if begin is None else begin
    for given in ("lagrangian/grains/U", "uniform/grains"):
        if any(os.path.exists(os.path.join(case, first, given + end)) for end in ("", ".gz")):
            raise ValueError(f"{os.path.join(case, first, given)}: it says how all grains move, so that every seed gives the same run: start from alpha, U and T")
    for time in times_in(case):
        if time != begin and not os.path.exists(os.path.join(case, time, NOTE)):
            raise ValueError(f"{os.path.join(case, time)} holds results of a single run, which the means would replace: remove or rename it")


def renew(case, folder):
    """Gives the members the controlDict of the case, so that an ensemble goes on to a later endTime; any other change is left for sweep to refuse."""
    now = copies.digests(case)
    places = [os.path.join(folder, n) for n in sorted(os.listdir(folder))] if os.path.isdir(folder) else []
    for place in places:
        found = copies.notes(place) if os.path.isdir(place) else None
        if found and [k for k in now.keys() | found["base"].keys() if now.get(k) != found["base"].get(k)] == [CONTROL]:
            shutil.copy2(os.path.join(case, CONTROL), os.path.join(place, CONTROL))
            copies.keep(place, base=now, state="begun")
    notes = os.path.join(folder, "sweep.json")
    found = copies.read_json(notes)
    if found:
        copies.write_json(notes, {**found, "base": {**found["base"], CONTROL: now[CONTROL]}})


def ensemble(case, members, *, cores=1, progress=True):
    """Runs `members` members (2 or more), `cores` of them at once, and writes their means into the case's time folders; returns the haff.Case.

    The same call goes on with members that were stopped; with a later endTime, or with more members, it adds to what is there. A time
    that not all members have written has no mean.

    RunError: a member failed. ValueError, FileNotFoundError: the case has no seed, or holds results of a single run.
    The errors of haff.sweep.
    """
    case = copies.path_of(case)
    if members != int(members) or members < 2:
        raise ValueError(f"members: {members}; an error needs 2 or more")
    check(case)
    folder = os.path.join(case, "ensemble")
    renew(case, folder)
    table = sweep(case, {PROPERTIES: {"+seed": list(range(1, members + 1))}}, cores=cores, folder=folder, progress=progress)
    failed = [i for i in range(members) if table["state"][i] != "done"]
    if failed:
        log = os.path.join(folder, table["folder"][failed[0]], "log.granularMD")
        raise RunError("granularMD", 1, log, f"error: {table['folder'][failed[0]]}, {len(failed)} of {members} members failed: {table['error'][failed[0]]}")
    found = Case(case)
    runs = [Case(os.path.join(folder, name)) for name in table["folder"]]
    begin = copies.start(case)
    for time in sorted(set.intersection(*[set(r.times) for r in runs]) - {begin}, key=float):
        write_time(found, runs, time)
    write_table(found, runs)
    return found
