#!/usr/bin/env python3
"""What the sources can say of a recording or a result, and whether the guide explains it.

    findings_of_sources.py          fails unless docs/guides/why-does-my-calibration-fail.md has all
    findings_of_sources.py --list   the constant parts of every finding, with where they stand

A finding is a text with numbers in it: the longest constant part of it stands for it, and must stand
word for word in the guide.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
GUIDE = ROOT / "docs/guides/why-does-my-calibration-fail.md"
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')
# How a finding begins in the sources: its severity, or a helper that is named like one.
BEGINNING = re.compile(
    r"Severity::k(?:Info|Warn|Inconclusive|Fail),"
    r"|\b(?:Warn|Fail|Inconclusive)\("
    r"|(?<![.>])\b(?:AddRange|Add)\([^,;{]*,"
    r"|std::string what =")
PLACEHOLDER = re.compile(r"%[-+ 0#]*[0-9]*(?:\.[0-9]+)?(?:z|l|ll)?[a-zA-Z%]")


def first_argument(text, begin):
    """From begin to the comma or bracket that ends the expression there; skips literals."""
    depth = 0
    at = begin
    while at < len(text):
        c = text[at]
        if c == '"':
            at = LITERAL.match(text, at).end()
            continue
        if c in "({[":
            depth += 1
        elif c in ")}]":
            if depth == 0:
                return text[begin:at]
            depth -= 1
        elif c in ",;" and depth == 0:
            return text[begin:at]
        at += 1
    return text[begin:]


def fragments(expression):
    """The constant parts of an expression's text, longest first."""
    # Literals that stand beside each other are one.
    joined = re.sub(r'"\s*\n\s*"', "", expression)
    parts = []
    for literal in LITERAL.findall(joined):
        parts += [part.strip(" :;,.()") for part in PLACEHOLDER.split(literal.replace('\\"', '"'))]
    return sorted((p for p in parts if len(p) >= 8), key=len, reverse=True)


def findings():
    for folder in ("diagnosis", "cli"):
        for path in sorted((ROOT / "calibrato" / folder).glob("*.cc")):
            if path.name.endswith("_test.cc"):
                continue
            text = re.sub(r"//[^\n]*", "", path.read_text())
            if "Severity::k" not in text:
                continue
            for match in BEGINNING.finditer(text):
                parts = fragments(first_argument(text, match.end()))
                if parts:
                    yield f"{path.name}:{text.count(chr(10), 0, match.start()) + 1}", parts[0]


def main():
    found = list(findings())
    if "--list" in sys.argv:
        for where, part in found:
            print(f"{where}\t{part}")
        return 0
    page = " ".join(GUIDE.read_text().replace("`", "").split())
    missing = [(where, part) for where, part in found if " ".join(part.split()) not in page]
    for where, part in missing:
        print(f"{where}: the guide does not explain: {part}")
    print(f"{len(found)} findings, {len(missing)} missing")
    return 1 if missing or len(found) < 60 else 0


if __name__ == "__main__":
    sys.exit(main())
