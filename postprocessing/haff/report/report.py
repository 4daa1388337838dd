# SPDX-License-Identifier: GPL-3.0-or-later
"""A report of a run as one HTML file, to be read without a server or a network, mailed or archived.

    haff report CASE                    CASE/postProcessing/report.html; prints its path
    haff report CASE -follow            made anew while the run goes on; the page in the browser renews itself
    haff report CASE OTHER              two cases beside each other, as a gas and grains: CASE/postProcessing/report-OTHER.html
    haff report FOLDER                  of haff sweep: a table of its runs with pictures, FOLDER/report.html
    haff report CASE -frames 40 -o run.html

It holds what was run, warnings of the log, pictures of the fields with a slider over the written times, profiles, plots of the run and of its function
objects, the verdict of expected.json, and the provenance. Exit code: 2 for a wrong command line, 1 for a case of which there is nothing to tell.
"""
import os
import sys
import time

from haff import command
from haff.case.case import Case
from haff.plot import options, runlog
from haff.plot.quantity import CannotDraw
from haff.report import onecase, page, pairs, sweeps
from haff.report.onecase import FRAMES


def main():
    parser = options.parser(__doc__)
    parser.add_argument("case", metavar="CASE")
    parser.add_argument("other", metavar="OTHER", nargs="?")
    parser.add_argument("-follow", action="store_true", help="make it anew while the run goes on; ends with the run")
    parser.add_argument("-every", type=float, default=10.0, metavar="SECONDS", help="between two pages of -follow: 10")
    parser.add_argument("-frames", type=int, metavar="N", help=f"written times in films and profiles: {FRAMES}, fewer of large cases; 1: the last")
    parser.add_argument("-o", metavar="FILE", help="written; .html")
    o = parser.parse_args()
    if o.o and not o.o.lower().endswith((".html", ".htm")):
        parser.error(f"-o {o.o}: a report is .html")
    if not 1 <= o.every <= 86400:
        parser.error(f"-every {o.every:g}: 1 to 86400 seconds")
    if o.frames is not None and not 1 <= o.frames <= 1000:
        parser.error(f"-frames {o.frames}: 1 to 1000")
    if o.follow and o.other:
        parser.error("-follow is for one case")
    return command.ended("haff report", lambda: work(o))


def report_of(o):
    """Returns the report of a case, of two cases or of a sweep. CannotDraw: there is neither a case nor a sweep."""
    if o.other:
        return pairs.Report(case_in(o.case), case_in(o.other), o.frames)
    if sweeps.is_sweep(o.case):
        return sweeps.Report(o.case, o.frames)
    return onecase.Report(case_in(o.case), o.frames)


def case_in(path):
    if not os.path.isdir(path):
        raise CannotDraw(f"{path} is not there; give the folder of a case")
    if not os.path.isdir(os.path.join(path, "system")):
        raise CannotDraw(f"{path} is no case directory (it has no folder 'system') and no folder of a sweep (it has no sweep.csv); give the folder of a case: "
                         "haff report CASE")
    return Case(path)


def target(o):
    """The path that is written; its folder is made if it is that of the case for results."""
    if o.o:
        return o.o
    if sweeps.is_sweep(o.case):
        return os.path.join(o.case, "report.html")
    folder = os.path.join(o.case, "postProcessing")
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as e:
        raise CannotDraw(f"{folder} cannot be made ({e.strerror}); -o FILE.html writes elsewhere") from None
    return os.path.join(folder, f"report-{os.path.basename(os.path.abspath(o.other))}.html" if o.other else "report.html")


def work(o):
    made = report_of(o)
    if not o.follow:
        finished = made.make()
        path = target(o)
        page.write(finished, path)
        warn(finished.told)
        print(path)
        return
    told, warned = False, []
    while True:
        going = runlog.locked(o.case)
        try:
            finished = made.make(every=o.every if going else 0)
        except CannotDraw:
            if not going:
                raise
            time.sleep(o.every)
            continue
        path = target(o)
        page.write(finished, path)
        if not told:
            print(path, flush=True)
            told = True
        warn([text for text in finished.told if text not in warned])
        warned = finished.told
        if not going:
            return
        time.sleep(o.every)


def warn(texts):
    for text in texts:
        print(f"haff report: warning: {text}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
