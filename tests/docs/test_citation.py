# SPDX-License-Identifier: GPL-3.0-or-later
"""CITATION.cff is of the Citation File Format 1.2.0, and of the version, date and licence that the rest says."""
import os
import re
import unittest

from tests.cases import harness

try:
    import yaml
except ImportError:
    yaml = None

# Of the schema 1.2.0: the keys of the whole, of an author (a person or an entity) and of a reference, those used or likely.
WHOLE = set("abstract authors cff-version commit contact date-released doi identifiers keywords license license-url message preferred-citation references "
            "repository repository-artifact repository-code title type url version".split())
PERSON = set("address affiliation alias city country email family-names fax given-names name-particle name-suffix orcid post-code region tel website".split())
ENTITY = set("address alias city country date-end date-start email fax location name orcid post-code region tel website".split())
REFERENCE = set("abstract authors doi end issn issue journal month notes pages start title type url volume year".split())
NEEDED = {"authors", "cff-version", "message", "title"}


def text(*path):
    with open(os.path.join(harness.SOURCE, *path), encoding="utf-8") as f:
        return f.read()


class Citation(unittest.TestCase):
    def test_version(self):
        version = re.search(r"^version: (.+)$", text("CITATION.cff"), re.M).group(1)
        self.assertEqual(version, re.search(r"project\(haff VERSION ([\d.]+)", text("CMakeLists.txt")).group(1))
        date = re.search(r"^date-released: (.+)$", text("CITATION.cff"), re.M).group(1)
        self.assertIn(f"## {version} ({date})", text("CHANGELOG.md"))

    @unittest.skipUnless(yaml, "python3-yaml is not there")
    def test_format(self):
        whole = yaml.safe_load(text("CITATION.cff"))
        self.assertEqual(sorted(set(whole) - WHOLE), [])
        self.assertEqual(sorted(NEEDED - set(whole)), [])
        self.assertEqual((whole["cff-version"], whole["license"], whole["type"]), ("1.2.0", "GPL-3.0-or-later", "software"))
        self.assertEqual(len(whole["references"]), 4)
        for part in [whole, *whole["references"]]:
            for author in part["authors"]:
                self.assertLessEqual(set(author), ENTITY if "name" in author else PERSON)
        for reference in whole["references"]:
            self.assertLessEqual({"authors", "title", "type"}, set(reference))
            self.assertLessEqual(set(reference), REFERENCE)


if __name__ == "__main__":
    unittest.main()
