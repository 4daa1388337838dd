# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/words.md: each word occurs in the file that defines it, as an identifier or in a comment; words stand once and in order, on one page."""
import re
import unittest

from tests.structure.test_rooms import text_of, tracked

PAGE = "docs/words.md"
MOST_ROWS = 80  # two screens


def rows_of(page):
    """(words, meaning, file) of each row of the table."""
    return [(words.split(", "), meaning, file) for words, meaning, file in re.findall(r"^\| (.+?) \| (.+?) \| `(\S+)` \|$", page, re.M)]


def occurs(word, source):
    """Is the word, or its plural, one of those that identifiers and comments are made of? Texts do not count; a symbol of one letter keeps its case."""
    source = re.sub(r'"(?:\\.|[^"\\\n])*"', '""', re.sub(r"\s*\n\s*\*?\s*", " ", re.sub(r"^ *#include.*$", "", source, flags=re.M)))
    return re.search(rf"(?<![A-Za-z]){re.escape(word)}s?(?![A-Za-z])", source, re.I if len(word) > 1 else 0) is not None


def wrong_rows(rows, sources):
    wrong = []
    for words, _, file in rows:
        if file not in sources:
            wrong.append(f"{', '.join(words)}: {file} is not there")
        else:
            wrong += [f"{file} lacks {word}" for word in words if not occurs(word, sources[file])]
    firsts = [words[0].lower() for words, _, _ in rows]
    wrong += [f"{later} stands behind {word}" for word, later in zip(firsts, firsts[1:]) if later <= word]
    every = [word for words, _, _ in rows for word in words]
    return wrong + [f"{word} stands twice" for word in sorted(set(every)) if every.count(word) > 1]


class Page(unittest.TestCase):
    maxDiff = None

    def test_words_are_in_their_files(self):
        page = text_of(PAGE)
        rows = rows_of(page)
        self.assertEqual(len(rows), page.count("\n| ") - 1, "a row has no file")
        self.assertLessEqual(len(rows), MOST_ROWS)
        self.assertEqual([], wrong_rows(rows, {path: text_of(path) for path in tracked("*.[ch]", "*.py")}))


class Rule(unittest.TestCase):
    def test_of_words(self):
        rows = rows_of("| word | meaning | file |\n|---|---|---|\n| big box | a box | `a.h` |\n| q | a sum | `a.h` |\n")
        self.assertEqual([["big box"], ["q"]], [words for words, _, _ in rows])
        self.assertEqual([], wrong_rows(rows, {"a.h": "/* The big\n * boxes, or so: a big box */ double *q;"}))
        self.assertEqual(["a.h lacks big box", "a.h lacks q"], wrong_rows(rows, {"a.h": '#include "q"\nchar *s = "big box"; int Q, bigbox;'}))
        self.assertEqual(["big box: a.h is not there", "q: a.h is not there"], wrong_rows(rows, {}))
        self.assertEqual(["b stands behind c"], wrong_rows([(["c"], "", "a.h"), (["b"], "", "a.h")], {"a.h": "b c"}))
        self.assertEqual(1, len(wrong_rows([(["b"], "", "a.h"), (["c", "b"], "", "a.h")], {"a.h": "b c"})))


if __name__ == "__main__":
    unittest.main()
