# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences of README.md and the user guide: short ones, without the constructions that made readers stop."""
import os
import re
import unittest

from tests.cases import harness

PAGES = ("README.md", "docs/userGuide.md", "docs/install.md")
LONGEST, MOST = 35, 3  # words; longer sentences of a page
# Constructions in which it is not clear who does what.
HARD = re.compile(r"\b(in place of|told apart|of now|so many|is told|are told|is asked|are asked|what is given|who does without|nobody|to no more|as ever|hardly meant)\b", re.I)


def sentences(page):
    """The sentences of the running text of a page: blocks of code and pictures are left out, `code` is a word; cells of tables count, each by itself."""
    with open(os.path.join(harness.SOURCE, page), encoding="utf-8") as file:
        text = re.sub(r"^```.*?^```|<!--.*?-->", "", file.read(), flags=re.M | re.S)
    text = re.sub(r"^ {4}.*$|!\[[^\]]*\]\([^)]*\)", "", text, flags=re.M)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"`[^`\n]+`", "code", text))
    parts = re.split(r"\n\s*\n|\n(?=[-#|] ?)|(?<!\\)\|", text)
    found = [s for part in parts for s in re.split(r"(?<=[.!?])[*_)]*\s+(?=[A-Z*(\"]|code)", " ".join(part.split()))]
    return [s for s in found if len(words(s)) > 1]


def words(sentence):
    return re.findall(r"[\w'^/+.-]*\w[\w'^/+.-]*", sentence)


class Sentences(unittest.TestCase):
    def test_are_short(self):
        for page in PAGES:
            long = [f"{len(words(s))} words: {s}" for s in sentences(page) if len(words(s)) > LONGEST]
            self.assertLessEqual(len(long), MOST, "\n".join([page, *long]))

    def test_say_who_does_what(self):
        for page in PAGES:
            self.assertEqual([], [s for s in sentences(page) if HARD.search(s)], page)

    def test_counts(self):
        """The pages have sentences, and long and hard ones are found."""
        for page in PAGES:
            self.assertGreater(len(sentences(page)), 40, page)
        self.assertEqual(len(words("A `code` of 3 words, 1e-3 m/s.")), 7)
        self.assertTrue(HARD.search("It counts in place of `0.orig`."))


if __name__ == "__main__":
    unittest.main()
