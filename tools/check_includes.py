#!/usr/bin/env python3
"""Checks what no compiler does: domains include only what stands in their row, public headers hold no heavy library,
files stay short. Exit code 1 with one line per finding."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ALLOWED = {
    "core": [],
    "model": ["core"],
    "mechanism": ["core"],
    "navigation": ["core", "model"],
    "wbc": ["core", "model", "navigation"],
    "interaction": ["core", "model"],
    "estimation": ["core", "model", "mechanism"],
    "plant": ["core", "model", "mechanism"],
    "planning": ["core", "model", "navigation", "wbc", "interaction", "estimation"],
    "mission": ["core", "model", "navigation", "wbc", "interaction", "estimation", "planning"],
    "log": ["core"],
    "scenario": ["core", "model", "mechanism", "navigation", "wbc", "interaction", "estimation", "planning", "plant", "mission"],
    "report": ["core", "log"],
}
HEAVY = re.compile(r'#include [<"](mujoco|pinocchio|coal|toml|nlohmann|CLI|fmt|spdlog|eiquadprog)')
LINES = {".hpp": 250, ".cpp": 400}


def main() -> int:
    findings = []
    for base in ("include/ajar", "src", "adapters", "apps", "tests"):
        for path in sorted((ROOT / base).rglob("*.[ch]pp")):
            text = path.read_text()
            name = path.relative_to(ROOT)
            count = text.count("\n")
            if count > LINES[path.suffix]:
                findings.append(f"{name}: {count} lines, at most {LINES[path.suffix]}")
            if base == "include/ajar" and HEAVY.search(text):
                findings.append(f"{name}: a heavy library in a public header")
            parts = path.relative_to(ROOT / base).parts
            domain = parts[0]
            if base not in ("include/ajar", "src") or domain not in ALLOWED:
                continue
            for other in re.findall(r'#include "ajar/(\w+)/', text):
                if other != domain and other not in ALLOWED[domain]:
                    findings.append(f"{name}: {domain} may not include {other}")
    print("\n".join(findings) if findings else "includes: ok")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
