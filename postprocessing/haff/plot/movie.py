# SPDX-License-Identifier: GPL-3.0-or-later
"""A film of a field, or of grains, through all times of a case, with one range of colours.

    haffMovie CASE alpha                         CASE/postProcessing/figures/alpha.mp4, or alpha.gif where there is no ffmpeg
    haffMovie CASE T -log -fps 10 -o cool.gif    mp4 or gif by the suffix
    haffMovie CASE U -component y -slice z=0.5   what haffPlot draws, at each time
    haffMovie CASE grains                        grains, coloured by speed

mp4 needs ffmpeg (Debian: ffmpeg); gif is made by Pillow. Exit code: 2 for a wrong command line, 1 for a case that cannot be drawn.
"""
import dataclasses
import os
import shutil
import subprocess
import sys
import tempfile

from haff import command
from haff.plot import figures, options, picture, quantity, scale
from haff.plot.wish import times_with_results

FORMATS = (".mp4", ".gif")


def frames(space, wish, folder):
    """Draws all times into numbered files; returns their paths."""
    case = space.case
    times = times_of(case, wish)
    if len(times) < 2:
        raise quantity.CannotDraw(f"{case.path} has {'one time' if times else 'no time'} with {wish.fields[0]}"
                                  f"{' (' + times[0] + ')' if times else ''}; a film needs two: write more often (writeInterval), or use haffPlot")
    if not wish.span:
        wish = dataclasses.replace(wish, span=span(space, wish, times))
    paths, places = [], None
    for k, time in enumerate(times):
        paths.append(os.path.join(folder, f"{k:06d}.png"))
        figure = picture.draw(space, dataclasses.replace(wish, time=time))
        even(figure, wish.dpi)
        figure.set_dpi(wish.dpi)
        if not places:
            figure.draw_without_rendering()
            places = figures.places(figure)
        figures.place(figure, places)
        figure.canvas.print_png(paths[-1])  # savefig draws twice, to find the layout
        figures.plt.close(figure)
        if sys.stderr.isatty():
            print(f"\r{k + 1} of {len(times)}", end="\n" if k + 1 == len(times) else "", file=sys.stderr, flush=True)
    return paths


def even(figure, dpi):
    """Whole, even numbers of pixels, as films want them."""
    figure.set_size_inches(*(2 * round(s * dpi / 2) / dpi for s in figure.get_size_inches()))


def times_of(case, wish):
    """Times at which what is filmed can be read."""
    name = quantity.split(wish.fields[0])[0]
    if name == quantity.GRAINS:
        found = [t for t in case.times if quantity.has_grains(case, t)]
    else:
        found = [t for t in case.times if name in quantity.fields(case, t) and readable(case, wish, t)]
    if not found:
        raise quantity.unknown(case, name, times_with_results(case)[-1])
    return found


def readable(case, wish, time):
    try:
        quantity.read(case, wish.fields[0], time, wish.component)
        return True
    except quantity.CannotDraw:
        if time == case.times[-1]:
            raise
        return False  # a start that is given by an expression


def span(space, wish, times):
    """The range of what is filmed over all times."""
    return scale.common((picture.filmed(space, wish, time) for time in times), wish)


def write(paths, path, fps):
    """The film, under a temporary name first."""
    with command.replacing(path, path[-4:]) as temporary:
        (by_ffmpeg if path.endswith(".mp4") else by_pillow)(paths, temporary, fps)
    print(path)


def by_ffmpeg(paths, path, fps):
    done = subprocess.run(["ffmpeg", "-y", "-loglevel", "error", "-framerate", f"{fps:g}", "-i", os.path.join(os.path.dirname(paths[0]), "%06d.png"),
                           "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "18", "-movflags", "+faststart", path],
                          capture_output=True, text=True)
    if done.returncode:
        raise quantity.CannotDraw(f"ffmpeg failed: {done.stderr.strip()}; -o FILE.gif needs none")


def by_pillow(paths, path, fps):
    try:
        from PIL import Image
    except ImportError:
        raise quantity.CannotDraw("gif needs Pillow (Debian: python3-pil)") from None
    images = []
    for name in paths:
        with Image.open(name) as image:
            images.append(image.convert("RGB").quantize(256, dither=Image.Dither.NONE))
    images[0].save(path, save_all=True, append_images=images[1:], duration=max(round(1000 / fps), 20), loop=0)


def film(case, wish, path, fps):
    space = options.space_of(case)
    suffix = ".mp4" if shutil.which("ffmpeg") else ".gif"
    if path and path.endswith(".mp4") and not shutil.which("ffmpeg"):
        raise quantity.CannotDraw(f"{path}: mp4 needs ffmpeg, which is not there (Debian: ffmpeg); -o {path[:-4]}.gif needs none")
    with tempfile.TemporaryDirectory(prefix="haffMovie") as folder:
        paths = frames(space, wish, folder)
        write(paths, options.output(space.case, path, wish.names(), suffix), fps)


def main():
    parser = options.parser(__doc__)
    parser.add_argument("case", metavar="CASE")
    parser.add_argument("field", metavar="FIELD")
    options.add(parser, times=False)
    parser.add_argument("-fps", type=float, default=8.0, help="pictures per second: 8")
    parser.add_argument("-o", metavar="FILE", help="written; .mp4 or .gif")
    o = options.parse(parser, sys.argv[1:])
    if o.o and not o.o.endswith(FORMATS):
        parser.error(f"-o {o.o}: films are .mp4 or .gif")
    if not 0.1 <= o.fps <= 50:
        parser.error(f"-fps {o.fps:g}: 0.1 to 50")
    wish = options.wish(parser, o, [o.field])
    wish.dpi = o.dpi if o.dpi != 150 or wish.size else 100
    return command.ended("haffMovie", lambda: film(o.case, wish, o.o, o.fps))


if __name__ == "__main__":
    sys.exit(main())
