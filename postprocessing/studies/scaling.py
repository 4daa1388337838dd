# SPDX-License-Identifier: GPL-3.0-or-later
"""What a case would take on more ranks than are at hand, from the messages that it sends on a few.

    haff scaling CASE [-ranks 1,2,4,8] [-project 16,64,256,1024] [-latency 2e-6] [-bandwidth 1e10]

A copy of the case runs on each number of `-ranks`, also more than there are cores, with a library between the program and
MPI that counts messages, bytes, reductions and memory of every rank; what the start and the writing take is left out, as the
difference of two runs. The set-up of each rank out of N without the others then gives the largest rank's cells, neighbours and
halo on a lattice for any N; for other meshes they are extrapolated. The time of a step is modelled as

    T(N) = c cells + latency messages + bytes / bandwidth + latency ceil(log2 N) reductions

of the rank that has most of each, with c, the CPU time of a cell and step, measured on one rank. Nothing overlaps in it.
"""
import csv
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass

from haff import command
from haff.case.foam import write_dictionary
from haff.paths import program
from haff.runs import copies
from haff.runs.run import Children, application, error_text, make_mesh

SENDS = "Send Ssend Rsend Bsend Isend Issend Irsend Ibsend Sendrecv".split()
COLLECTIVES = "Barrier Bcast Allreduce Reduce Scan Exscan Gather Gatherv Scatter Scatterv Allgather Allgatherv Alltoall Alltoallv".split()
UNEVEN = 1.03  # of METIS: cells of the largest part over the mean


class Refused(ValueError):
    """What was asked for cannot be done; says why."""


@dataclass
class Rank:
    """What one rank did: in a run, or in a step of it (then numbers are means). seconds: CPU time; memory: the most, in bytes."""
    messages: float = 0.0
    sent: float = 0.0
    reductions: float = 0.0
    seconds: float = 0.0
    memory: float = 0.0

    def add(self, call, size, calls, seconds):
        if call in SENDS:
            self.messages += calls
            self.sent += size * calls
        elif call in COLLECTIVES:
            self.reductions += calls
        elif call == "process":
            self.memory, self.seconds = size, seconds

    def step(self, before, steps):
        part = lambda name: (getattr(self, name) - getattr(before, name)) / steps
        return Rank(part("messages"), part("sent"), part("reductions"), part("seconds"), self.memory)


@dataclass
class Counted:
    """A case on N ranks. ranks: a Rank of each, by step; seconds: a step's wall time."""
    ranks: list
    seconds: float

    def most(self, name):
        return max(getattr(r, name) for r in self.ranks)

    def sum(self, name):
        return sum(getattr(r, name) for r in self.ranks)


@dataclass
class Share:
    """Of the largest rank out of N: cells, neighbours, cells of one layer that it sends; in all: tiles, neighbours, sent."""
    cells: int
    neighbours: int
    sent: int
    tiles: int
    all_neighbours: int
    all_sent: int


def read_table(path, number):
    """The Rank of each rank, from the table that haffmessages.so writes."""
    ranks = [Rank() for _ in range(number)]
    with open(path) as f:
        for row in csv.DictReader(f):
            ranks[int(row["rank"])].add(row["call"], int(row["bytes"]), int(row["calls"]), float(row["seconds"]))
    return ranks


def run(case, ranks, steps):
    """So many steps of a case, whose folder is left as it was: Ranks, wall seconds of the steps, log."""
    with tempfile.TemporaryDirectory() as folder:
        table, here = os.path.join(folder, "messages.csv"), os.path.join(folder, "case")
        changes = {"+stopAt": "nextWrite", "+writeControl": "timeStep", "+writeInterval": steps, "+purgeWrite": 0, "+runTable": "none"}
        if copies.control(case, "functions") is not None:
            changes["functions"] = None
        copies.make(case, here, {"system/controlDict": changes}, None)
        command_line = [program("mpirun"), "-np", str(ranks), "-x", "HAFF_MESSAGES=" + table, "-x", "LD_PRELOAD=" + program("haffmessages.so"),
                        application(here), "-case", here]
        done = subprocess.run(command_line, capture_output=True, text=True, env={"OMP_NUM_THREADS": "1", "OMPI_MCA_mpi_yield_when_idle": "1", **os.environ})
        ended = re.search(r"end at time .*: (\d+) steps in ([\d.]+) s", done.stdout)
        if done.returncode or not ended or int(ended[1]) != steps:
            raise Refused(f"{case} on {ranks} ranks did not take {steps} steps: {error_text(done.stderr or done.stdout)}")
        return read_table(table, ranks), float(ended[2]), done.stdout


def count(case, ranks, steps, after, repeats=1):
    """A case on that number of ranks over `steps` steps behind the first `after`, times as medians of the repeats; and its log."""
    several = []
    for _ in range(repeats):
        before, early, _ = run(case, ranks, after)
        ranks_of, late, log = run(case, ranks, after + steps)
        several.append(Counted([r.step(b, steps) for r, b in zip(ranks_of, before)], (late - early) / steps))
    found = several[0]
    found.seconds = statistics.median(c.seconds for c in several)
    for i, r in enumerate(found.ranks):
        r.seconds = statistics.median(c.ranks[i].seconds for c in several)
    return found, log


def with_mesh(case, folder):
    """The case, or a copy with its mesh where it has none."""
    if os.path.isfile(os.path.join(case, "system", "blockMeshDict")) or copies.has_mesh(case):
        return case
    copies.make(case, folder, None, None)
    make_mesh(folder, None, Children())
    return folder


def shares(case, ranks, even=False):
    """The Share of the largest of N ranks on the lattice of a case, by their set-up without each other. even: tiles as with transport."""
    done = subprocess.run([program("bench_setup"), "-case", case, str(ranks), "-all", *["even"] * even], capture_output=True, text=True)
    if done.returncode:
        raise Refused(error_text(done.stderr))
    rows = [{k: int(v) for k, v in row.items()} for row in csv.DictReader(done.stdout.splitlines())]
    column = lambda name: [row[name] for row in rows]
    return Share(max(column("cells")), max(column("neighbours")), max(column("sent")), sum(column("tiles")), sum(column("neighbours")), sum(column("sent")))


class Lattice:
    """Messages on any number of ranks: exchanges with every neighbour, and bytes for every cell of a layer, as in a run that was counted."""

    def __init__(self, case, counted, number, even=False):
        self.case, self.from_ranks, self.even, share = case, number, even, shares(case, number, even)
        if not share.all_neighbours:
            raise Refused(f"on {number} ranks no rank has a neighbour: the lattice has too few tiles")
        self.exchanges = counted.sum("messages") / share.all_neighbours
        self.width = counted.sum("sent") / share.all_sent
        self.reductions = counted.most("reductions")

    def rank(self, ranks, case=None):
        """Cells and a Rank that has most of everything."""
        if ranks == 1:
            return shares(case or self.case, 1, self.even).cells, Rank()
        share = shares(case or self.case, ranks, self.even)
        return share.cells, Rank(self.exchanges * share.neighbours, self.width * share.sent, self.reductions)


class Other:
    """The same for meshes whose partition must be made by all ranks together: beyond the largest number that was counted, messages
    stay and bytes go with the surface of a part. parts: tiles or blocks of cells, which are dealt as wholes."""

    def __init__(self, cells, dim, parts, counted):
        self.cells, self.dim, self.parts, self.counted = cells, dim, parts, counted

    def rank(self, ranks):
        known = max(n for n in self.counted if n <= ranks)
        c, shrunk = self.counted[known], (known / ranks) ** ((self.dim - 1) / self.dim)
        cells = self.cells * max(UNEVEN ** (ranks > 1) / ranks, math.ceil(self.parts / ranks) / self.parts)
        return cells, Rank(c.most("messages"), c.most("sent") * shrunk, c.most("reductions"))


def seconds(ranks, cells, rank, per_cell, latency, bandwidth):
    """The model: seconds of a step."""
    return (per_cell * cells + latency * rank.messages + rank.sent / bandwidth
            + latency * math.ceil(math.log2(ranks)) * rank.reductions)


def memory_fit(counted):
    """a and b of a + b/N through the memory of the largest rank, by least squares; nan where one number was counted."""
    x, y = [1 / n for n in counted], [c.most("memory") for c in counted.values()]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    spread = sum((v - mean_x) ** 2 for v in x)
    b = sum((v - mean_x) * (w - mean_y) for v, w in zip(x, y)) / spread if spread else math.nan
    return mean_y - b * mean_x, b


def split(ranks, dim):
    """Boxes along each axis, as even as they can be, of that total number."""
    parts, rest, factor = [1] * dim, ranks, 2
    factors = []
    while rest > 1:
        while rest % factor == 0:
            factors.append(factor)
            rest //= factor
        factor += 1
    for f in reversed(factors):
        parts[parts.index(min(parts))] *= f
    return sorted(parts, reverse=True)


BLOCK = """vertices ({vertices});
blocks (hex (0 1 2 3 4 5 6 7) ({n}) simpleGrading (1 1 1));
boundary ({flat} walls {{ type wall; faces ({faces}); }});
"""


def write_box(folder, n):
    """system/blockMeshDict of a box of n cells; of one cell along z: two dimensions."""
    flat = "flat { type empty; faces ((0 3 2 1) (4 5 6 7)); }" if n[2] == 1 else ""
    sides = ["(0 4 7 3)", "(1 2 6 5)", "(0 1 5 4)", "(3 7 6 2)"] + ([] if flat else ["(0 3 2 1)", "(4 5 6 7)"])
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    vertices = " ".join("(%d %d %d)" % tuple(c * k for c, k in zip(corner, n)) for corner in corners)
    write_dictionary(folder, "system", "blockMeshDict", BLOCK.format(vertices=vertices, n="%d %d %d" % tuple(n), flat=flat, faces=" ".join(sides)))


def weak(model, ranks, dim, cells):
    """The largest of N ranks of a box that has about that number of cells for each."""
    a_side = max(round(cells ** (1 / dim)), 1)
    n = [a_side * k for k in split(ranks, dim)] + [1] * (3 - dim)
    with tempfile.TemporaryDirectory() as folder:
        write_box(folder, n)
        return math.prod(n) / ranks, *model.rank(ranks, folder)


def rows_counted(counted, model):
    yield "| ranks | messages | predicted | kB sent | predicted | reductions | memory MB |\n|---|---|---|---|---|---|---|"
    for n, c in counted.items():
        told = ("", "")
        if isinstance(model, Lattice):
            rank = model.rank(n)[1]
            told = ("(from these)",) * 2 if n == model.from_ranks else (f"{rank.messages:.1f}", f"{rank.sent / 1e3:.1f}")
        yield (f"| {n} | {c.most('messages'):.1f} | {told[0]} | {c.most('sent') / 1e3:.1f} | {told[1]} | {c.most('reductions'):.1f} "
               f"| {c.most('memory') / 1e6:.0f} |")


def rows_times(counted, model, per_cell, here):
    """Predicted and measured times of a step on this machine, as far as it has a core for each rank."""
    yield "| ranks | predicted, s a step | wall time measured | CPU time of the rank | predicted over wall time |\n|---|---|---|---|---|"
    for n, c in counted.items():
        if n <= (os.cpu_count() or 1):
            cells, rank = model.rank(n)
            t = seconds(n, cells, rank, per_cell, *here)
            yield f"| {n} | {t:.4g} | {c.seconds:.4g} | {c.most('seconds'):.4g} | {t / c.seconds:.2f} |"


def rows_strong(ranks, model, per_cell, net, memory):
    one = seconds(1, *model.rank(1), per_cell, *net)
    yield "| ranks | cells | messages | kB sent | s a step | speed-up | efficiency | memory MB |\n|---|---|---|---|---|---|---|---|"
    for n in ranks:
        cells, rank = model.rank(n)
        t = seconds(n, cells, rank, per_cell, *net)
        yield (f"| {n} | {cells:.0f} | {rank.messages:.1f} | {rank.sent / 1e3:.1f} | {t:.4g} | {one / t:.4g} | {one / t / n:.2f} "
               f"| {(memory[0] + memory[1] / n) / 1e6:.0f} |")


def rows_weak(ranks, model, dim, cells, per_cell, net):
    yield "| ranks | cells in all | of the largest rank | messages | kB sent | s a step | efficiency |\n|---|---|---|---|---|---|---|"
    for n in ranks:
        mean, most, rank = weak(model, n, dim, cells)
        t = seconds(n, most, rank, per_cell, *net)
        yield f"| {n} | {mean * n:.4g} | {most:.0f} | {rank.messages:.1f} | {rank.sent / 1e3:.1f} | {t:.4g} | {per_cell * mean / t:.2f} |"


def measure_here():
    """Latency and bandwidth between two ranks of this machine."""
    done = subprocess.run([program("mpirun"), "-np", "2", program("bench_latency")], capture_output=True, text=True, check=True)
    return tuple(float(v) for v in re.match(r"latency (\S+) s, bandwidth (\S+) B/s", done.stdout).groups())


def model_of(case, counted, log):
    """The model of a case's messages, dimensions and cells: of its lattice if the log says that all of one is computed."""
    find = lambda pattern: int(re.search(pattern, log, re.M)[1])
    dim, cells, parts = find(r"^    (?:lattice|polyhedral), (\d)D"), find(r"^    .* (\d+) cells; checksum"), find(r" (\d+) (?:tiles|blocks?)$")
    several = [n for n in counted if n > 1]
    if not several:
        raise Refused("messages are counted on two ranks or more: give them in -ranks")
    if re.search(r"^    lattice, ", log, re.M) and "are computed\n" not in log:
        even = shares(case, 1).tiles != parts
        return Lattice(case, counted[several[-1]], several[-1], even), dim, cells
    return Other(cells, dim, parts, counted), dim, cells


def report(case, o):
    with tempfile.TemporaryDirectory() as folder:
        case = with_mesh(case, os.path.join(folder, "case"))
        counted, log = {}, ""
        for n in sorted({1, *o.ranks}):
            counted[n], log = count(case, n, o.steps, o.after, o.repeats if n <= (os.cpu_count() or 1) else 1)
        model, dim, cells = model_of(case, counted, log)
        per_cell, here, net = counted[1].most("seconds") / cells, measure_here(), (o.latency, o.bandwidth)
        if per_cell <= 0:
            raise Refused(f"{o.steps} steps are too short to be timed: give more -steps")
        yield (f"{cells} cells, {dim}D, steps {o.after + 1} to {o.after + o.steps}: {1e9 * per_cell:.0f} ns of CPU a cell and step on one rank; "
               f"this machine: latency {here[0]:.2g} s, bandwidth {here[1]:.2g} B/s")
        yield "\nCounted, the largest rank's of a step:\n"
        yield from rows_counted(counted, model)
        yield "\nTime on this machine:\n"
        yield from rows_times(counted, model, per_cell, here)
        memory = memory_fit(counted)
        yield (f"\nMemory of a rank {memory[0] / 1e6:.0f} MB + {memory[1] / 1e6:.0f} MB / N. Projected, latency {net[0]:g} s, bandwidth {net[1]:g} B/s, "
               "this mesh on more ranks:\n")
        yield from rows_strong(o.project, model, per_cell, net, memory)
        if isinstance(model, Lattice):
            each = o.cells or cells
            yield f"\nAs many cells for each rank, boxes of about {each} beside each other:\n"
            yield from rows_weak(o.project, model, dim, each, per_cell, net)


def whole(low):
    """For argparse: whole numbers from `low` on with commas between them."""
    def read(text):
        numbers = [int(word) for word in text.split(",")]
        if min(numbers) < low:
            raise ValueError
        return numbers
    read.__name__ = "list of whole numbers"
    return read


def positive(text):
    value = float(text)
    if not 0 < value < math.inf:
        raise ValueError
    return value


def main():
    parser = command.parser(__doc__)
    parser.add_argument("case", help="its folder, which stays as it is")
    parser.add_argument("-ranks", type=whole(1), default=[1, 2, 4, 8], metavar="N,..", help="on which messages are counted (1,2,4,8)")
    parser.add_argument("-project", type=whole(1), default=[2, 16, 64, 256, 1024], metavar="N,..", help="for which times are told (2,16,64,256,1024)")
    parser.add_argument("-steps", type=whole(1), default=[20], metavar="S", help="that are counted (20)")
    parser.add_argument("-after", type=whole(1), default=[5], metavar="S", help="steps before them (5)")
    parser.add_argument("-repeats", type=whole(1), default=[1], metavar="R", help="of which times on one rank for each core are medians (1)")
    parser.add_argument("-cells", type=whole(1), metavar="C", help="of each rank, where all have as many (those of the case)")
    parser.add_argument("-latency", type=positive, default=2e-6, metavar="s", help="of a message (2e-6)")
    parser.add_argument("-bandwidth", type=positive, default=1e10, metavar="B/s", help="of a rank (1e10)")
    o = parser.parse_args()
    o.steps, o.after, o.repeats, o.cells = o.steps[0], o.after[0], o.repeats[0], o.cells[0] if o.cells else None
    try:
        for line in report(copies.path_of(o.case), o):
            print(line, flush=True)
    except (OSError, ValueError, KeyError) as e:
        sys.exit(f"haff scaling: {e}")


if __name__ == "__main__":
    main()
