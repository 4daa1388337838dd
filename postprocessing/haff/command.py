# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of every command: one look, `-help` everywhere, and files only where one is told to."""
import argparse


def parser(text, **others):
    """An argparse.ArgumentParser whose help is `text`, by -help, -h or --help; options are written out."""
    made = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter, add_help=False, allow_abbrev=False,
                                   **others)
    made.add_argument("-help", "-h", "--help", action="help", help="this text")
    return made
