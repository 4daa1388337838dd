# SPDX-License-Identifier: GPL-3.0-or-later
"""Words of a page: names and units of figures as plain text, and HTML around them."""
import html
import re

from haff.plot import figures

GREEK = {r"\alpha": "α", r"\rho": "ρ", r"\phi": "φ", r"\omega": "ω", r"\nabla": "∇", r"\Delta": "Δ"}
RAISED = str.maketrans("0123456789-.", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻·")
ESCAPE = html.escape


def plain(text):
    """A text of matplotlib's as plain text: "$U_{x}$ (m s$^{-1}$)" is "U_x (m s⁻¹)"."""
    for name, letter in GREEK.items():
        text = text.replace(name, letter)
    text = re.sub(r"\\mathrm\{(\w+)\}", r"\1", text)
    text = re.sub(r"\^\{?([-\d.]+)\}?", lambda m: m.group(1).translate(RAISED), text)
    return re.sub(r"_\{(\w+)\}", r"_\1", text).replace("$", "").replace("\\", "")


def unit(dimensions, of):
    """The unit of exponents of mass, length, time, as pictures have it: "kg m⁻³"; empty without one."""
    return plain(figures.unit(dimensions, of))


def with_unit(text, dimensions, of):
    found = unit(dimensions, of) if dimensions else ""
    return f"{text} ({found})" if found else text


def symbol(name):
    """The symbol of a field as plain text: α for alpha."""
    return plain(figures.NAMES.get(name, ("", name, ""))[1])


def tag(name, *inside, **attributes):
    """An element: tag("p", "text", id="a"); what is inside is HTML already. class_ is class, data_x is data-x."""
    said = "".join(f' {key.rstrip("_").replace("_", "-")}="{ESCAPE(str(value))}"' for key, value in attributes.items() if value is not None)
    return f"<{name}{said}>" if name == "img" else f"<{name}{said}>{''.join(inside)}</{name}>"


def rows(pairs):
    """A list of names and what they mean."""
    return tag("dl", *(tag("div", tag("dt", ESCAPE(name)), tag("dd", ESCAPE(str(value)))) for name, value in pairs), class_="facts")


def table(heads, lines, caption=None):
    """A table; cells are HTML already. It scrolls by itself where it is wider than the page."""
    head = tag("thead", tag("tr", *(tag("th", h, scope="col") for h in heads)))
    body = tag("tbody", *(tag("tr", *(tag("td", c) for c in line)) for line in lines))
    made = tag("table", tag("caption", ESCAPE(caption)) if caption else "", head, body)
    return tag("div", made, class_="wide", tabindex="0", role="region", aria_label=caption or "table")


def tiles(found):
    """Numbers that are looked for first: (name, value, "" or running, ended, stopped)."""
    one = lambda name, value, kind: tag("div", tag("span", ESCAPE(name), class_="name"), tag("span", ESCAPE(str(value)), class_=f"value {kind}".strip()))
    return tag("div", *(one(*f) for f in found), class_="tiles")


def unfold(summary, *inside, open_=False):
    return f"<details{' open' if open_ else ''}>{tag('summary', ESCAPE(summary))}{''.join(inside)}</details>"
