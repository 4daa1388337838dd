# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of the channels of disks that are shipped, changed."""
import os

from tests.cases import harness

POLYHEDRAL = ("system/fvSchemes", "fluxScheme  common;", "fluxScheme  common; meshEngine polyhedral;")


def replace(case, file, old, new):
    path = os.path.join(case, file)
    with open(path) as f:
        text = f.read()
    assert old in text, f"{path} has no {old}"
    with open(path, "w") as f:
        f.write(text.replace(old, new))


GRAVITY = """FoamFile {{ version 2.0; format ascii; class uniformDimensionedVectorField; object g; }}
dimensions [0 1 -2 0 0 0 0];
value      ({!r} 0 0);
"""


def spheres(restitution, gravity=0.0):
    """Returns a change of a channel to one of inelastic spheres, whose heat flux follows the density, with gravity along x."""
    def change(case):
        for old, new in (("TorquatoDisks", "TorquatoSpheres"), ("Haff", "GarzoDufty"), ("JenkinsRichman", "GarzoDufty")):
            replace(case, "constant/granularProperties", old, new)
        harness.edit(case, "constant/granularProperties", restitution=restitution)
        if gravity:
            with open(os.path.join(case, "constant", "g"), "w") as f:
                f.write(GRAVITY.format(gravity))
    return change


def friction(case, floor=(-2, 0.6, 0.9), lid=(2, 1, 0.97)):
    """Gives couetteDisks walls of Johnson & Jackson: velocity, specularity, restitution of each; starts near its flow."""
    for patch, old, (u, phi, e) in (("floor", "-2", floor), ("lid", "2", lid)):
        wall = f"type JohnsonJacksonSlip; specularityCoefficient {phi!r}; restitutionCoefficient {e!r}; value uniform "
        replace(case, "0.orig/U", f"type translatingWallVelocity; U ({old} 0 0);", f"{wall}({u!r} 0 0);")
        replace(case, "0.orig/T", f"{patch:<16} {{ type fixedValue; value uniform 1; }}", f"{patch:<16} {{ {wall}1; }}")
    replace(case, "0.orig/T", "internalField   uniform 1;", "internalField   uniform 0.34;")
    replace(case, "0.orig/U", "0.2*(y - 10)", "0.15*(y - 10) + 0.14")
