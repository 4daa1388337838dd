# SPDX-License-Identifier: GPL-3.0-or-later
"""What a conversion took, changed and dropped, line by line; and the refusal of what cannot be converted."""

VERBS = ("took", "changed", "dropped", "added")


class Refused(ValueError):
    """The case has no counterpart; says where, why and what would help."""


class Report:
    """Lines (verb, place, text). A line that was said already is not said again."""

    def __init__(self):
        self.lines = []

    def say(self, verb, place, text):
        assert verb in VERBS
        if (verb, place, text) not in self.lines:
            self.lines.append((verb, place, text))

    def took(self, place, text):
        self.say("took", place, text)

    def changed(self, place, text):
        self.say("changed", place, text)

    def dropped(self, place, text):
        self.say("dropped", place, text)

    def added(self, place, text):
        self.say("added", place, text)

    def text(self):
        return "\n".join(f"{verb:<8} {place}: {text}" for verb, place, text in self.lines) + "\n"
