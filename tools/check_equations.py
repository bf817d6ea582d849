#!/usr/bin/env python3
"""Checks that every law cited in the code, docs/equations.md#tag or (#tag) in a comment, has a heading with that tag, and that
links inside the document lead somewhere. Exit code 1 with one line per finding."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ("include", "src", "adapters", "apps", "examples", "bench", "tests")
DOCUMENT = "docs/equations.md"
FULL = re.compile(r"equations\.md#([A-Za-z0-9_-]+)")
SHORT = re.compile(r"[(, ]#([a-z][a-z0-9-]+)\b")  # the second tag of a list, or one alone in brackets
DIRECTIVES = {"include", "pragma", "define", "undef", "if", "ifdef", "ifndef", "else", "elif", "endif", "error"}


def tags_of(text: str) -> set[str]:
    anchors = re.findall(r'^#+ <a id="([^"]+)"></a>', text, re.M)
    plain = re.findall(r"^#+ ([a-z0-9_-]+)\s*$", text, re.M)
    return set(anchors) | set(plain)


def cited(line: str) -> set[str]:
    comment = line.partition("//")[2]
    found = set(FULL.findall(line))
    return found | {tag for tag in SHORT.findall(comment) if tag not in DIRECTIVES}


def findings_of(root: pathlib.Path) -> list[str]:
    document = root / DOCUMENT
    if not document.exists():
        return [f"{DOCUMENT}: missing"]
    text = document.read_text()
    tags = tags_of(text)
    findings = []
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.[ch]pp")):
            for number, line in enumerate(path.read_text().split("\n"), 1):
                for tag in sorted(cited(line) - tags):
                    findings.append(f"{path.relative_to(root)}:{number}: #{tag} is no heading of {DOCUMENT}")
    for number, line in enumerate(text.split("\n"), 1):
        for tag in re.findall(r"\]\(#([^)]+)\)", line):
            if tag not in tags:
                findings.append(f"{DOCUMENT}:{number}: link to #{tag}, which is no heading")
    for tag in sorted(tags):
        if len(re.findall(rf'<a id="{re.escape(tag)}">', text)) > 1:
            findings.append(f"{DOCUMENT}: #{tag} stands twice")
    return findings


def main() -> int:
    findings = findings_of(ROOT)
    print("\n".join(findings) if findings else "equations: ok")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
