# SPDX-License-Identifier: GPL-3.0-or-later
"""What each patch of a mesh is, by its name: a wall, an inlet, .., and what the fields do there."""
import difflib
import re

KINDS = {"wall": "a wall", "body": "a wall, whose forces are measured",
         "rough": "a wall that grains rub on (Johnson & Jackson)", "inlet": "the stream comes in",
         "outlet": "an open side: the flow leaves as it comes, under gravity into a void",
         "open": "an open side: what flows in is as at the start", "symmetry": "a mirror", "periodic": "one half of a periodic pair", "empty": "the axis is not solved"}
# Words in the names of patches. Of several words of a name the one in the first of these lists counts.
WORDS = [("wall", "wall walls noslip slip"), ("empty", "empty"), ("symmetry", "symmetry symmetric symmetryplane mirror symm sym"), ("periodic", "periodic cyclic"),
         ("inlet", "inlet inflow in feed entrance source"), ("outlet", "outlet outflow out exit drain"),
         ("open", "open opening farfield far freestream ambient atmosphere"),
         ("body", "body cylinder sphere ball obstacle cube step wedge ramp block bump airfoil blade prism cone pillar post object"),
         ("sides", "front back frontandback"),
         ("wall", "floor lid roof ceiling ground plate base bed bottom top left right low high lower upper side sides end ends piston hopper silo pipe tube channel "
                  "drum north south east west outer inner x y z box")]


def words(name):
    """The words of a name: "farField_2" has "farfield", "far" and "field"."""
    parts = [part.lower() for part in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", name)]
    return {*parts, "".join(parts), *(a + b for a, b in zip(parts, parts[1:]))}


def kind_of(name):
    """The kind that a name speaks of, or None."""
    said = words(name)
    for kind, known in WORDS:
        if said & set(known.split()):
            return kind
    longer = [w for kind, known in WORDS for w in known.split() if len(w) > 3 and name.lower().startswith(w)]
    return next((kind for kind, known in WORDS if longer and longer[0] in known.split()), None)


def is_one_layer(geometry, sides):
    """Is the mesh one cell thick between the patches that are called front and back?"""
    return sum(p.faces for p in sides) == 2 * geometry.cells


def given_kinds(entries, names):
    """{name: kind} of NAME=KIND. ValueError."""
    found = {}
    for entry in entries:
        name, equals, kind = entry.partition("=")
        if not equals:
            raise ValueError(f"-patch {entry}: NAME=KIND is wanted, as top=outlet; kinds are {', '.join(KINDS)}")
        for word, known, what in ((name, names, "patch"), (kind, KINDS, "kind")):
            if word not in known:
                near = difflib.get_close_matches(word, known, 1, 0.5)
                raise ValueError(f"-patch {entry}: there is no {what} '{word}'{f'; did you mean {near[0]}?' if near else ''} (there are {', '.join(known)})")
        found[name] = kind
    return found


def kinds(geometry, given, pairs):
    """({name: kind}, names that say nothing and are taken for walls) of all patches. pairs: those that are periodic."""
    names = [p.name for p in geometry.patches]
    chosen = given_kinds(given, names)
    for pair in pairs:
        for name in pair:
            if name not in names:
                raise ValueError(f"-periodic {','.join(pair)}: there is no patch '{name}'; there are {', '.join(names)}")
        chosen.update({name: "periodic" for name in pair})
    found, unknown = {}, []
    sides = [p for p in geometry.patches if kind_of(p.name) == "sides" and p.type != "empty"]
    for p in geometry.patches:
        kind = "empty" if p.type == "empty" else chosen.get(p.name) or kind_of(p.name)
        if kind == "sides":
            kind = "empty" if is_one_layer(geometry, sides) else "wall"
        if kind is None:
            unknown.append(p.name)
        found[p.name] = kind or "wall"
    return found, unknown


def partners(geometry, kind, pairs):
    """{name: name of the other half} of the periodic patches: the given pairs, else by equal area and opposite normals. ValueError."""
    found = {a: b for pair in pairs for a, b in (pair, pair[::-1])}
    rest = [p for p in geometry.patches if kind[p.name] == "periodic" and p.name not in found]
    while rest:
        p = rest.pop(0)
        fitting = [q for q in rest if q.faces == p.faces and abs(q.area - p.area) < 1e-6 * p.area and (abs(q.normal + p.normal) < 1e-6).all()]
        if len(fitting) != 1:
            raise ValueError(f"patch {p.name} is periodic by its name, and {len(fitting) or 'no'} other periodic patch{'es' if len(fitting) > 1 else ''} may be its other "
                             "half: say which with  -periodic NAME,NAME")
        found[p.name], found[fitting[0].name] = fitting[0].name, p.name
        rest.remove(fitting[0])
    return found


def on_axis(geometry):
    """What the patches on the x axis are in a body of revolution about it: mirrors. ValueError where the mesh does not lie beside it."""
    if geometry.axes != [0, 1] or geometry.low[1] < -1e-9 * geometry.size[1]:
        raise ValueError("-round: the mesh must lie in the plane of x and y, and above the axis y = 0")
    below = geometry.low[1] < 1e-9 * geometry.size[1]
    return [f"{p.name}=symmetry" for p in geometry.patches if below and p.plane and p.normal[1] < -1 + 1e-6 and p.low[1] < 1e-9 * geometry.size[1]]


def mesh_type(patch, kind):
    """The type of a patch in the polyMesh."""
    if kind == "symmetry":
        return "symmetryPlane" if patch.plane else "symmetry"
    return {"wall": "wall", "body": "wall", "rough": "wall", "periodic": "cyclic", "empty": "empty"}.get(kind, "patch")


def rules(patch, kind, flow):
    """What alpha, U and T do on a patch: three texts for the dictionary of the patch."""
    alpha, velocity, T = flow.alpha_text, flow.velocity_text, flow.T_text
    if kind == "inlet":
        return tuple(f"type fixedValue; value uniform {x};" for x in (alpha, velocity, T))
    if kind == "outlet":
        # Packed gas that leaves has no pressure but that of the gas outside. With its own, it would lean on nothing, and be pushed back in.
        void = "type fixedValue; value uniform 1e-6;"
        return void if flow.g.any() else "type zeroGradient;", "type zeroGradient;", "type zeroGradient;"
    if kind == "open":
        return tuple(f"type inletOutlet; inletValue uniform {x}; value uniform {x};" for x in (alpha, velocity, T))
    if kind == "rough":
        rubs = "type JohnsonJacksonSlip; specularityCoefficient 0.6; restitutionCoefficient 0.7; "
        return "type zeroGradient;", rubs + "value uniform (0 0 0);", rubs + f"value uniform {T};"
    if kind in ("wall", "body"):
        if flow.sticky:
            return "type zeroGradient;", "type noSlip;", f"type granularWall; restitution {flow.restitution:g}; value uniform {T};"
        return "type zeroGradient;", "type slip;", "type zeroGradient;"
    return (f"type {mesh_type(patch, kind)};",) * 3
