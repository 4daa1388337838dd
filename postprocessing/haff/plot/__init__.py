# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures, by matplotlib, which takes longer to load than most commands take: what draws is loaded when it is first used."""
import importlib.util
import sys


def later(name):
    """A module that is loaded when something of it is first used."""
    spec = importlib.util.find_spec(name)
    spec.loader = importlib.util.LazyLoader(spec.loader)
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


figures, picture, scale = map(later, ("haff.plot.figures", "haff.plot.picture", "haff.plot.scale"))
