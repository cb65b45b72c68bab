#!/usr/bin/env python3
"""Licences of the crates in the program, for Linux and Windows.

    tools/licences.py list             writes assets/crates.txt, which the dialog About shows
    tools/licences.py check            fails if assets/crates.txt is not up to date
    tools/licences.py texts FILE       writes the licences and copyright notices that a package has to contain
"""

import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIST = ROOT / "assets/crates.txt"
FONTS = ROOT / "assets/fonts/LICENCES.txt"
TARGETS = ["x86_64-unknown-linux-gnu", "x86_64-pc-windows-gnu"]
NOTICE = re.compile(r"(licen[cs]e|copying|copyright|notice|unlicense)", re.IGNORECASE)


def cargo(*arguments):
    return subprocess.run(["cargo", *arguments, "--locked"], cwd=ROOT, check=True, capture_output=True, text=True).stdout


def crates():
    """Returns name, version, licence and folder of each crate that the program contains, by name."""
    linked = set()
    for target in TARGETS:
        for line in cargo("tree", "-e", "normal", "--target", target, "--prefix", "none", "-f", "{p}").splitlines():
            name, version = line.split()[:2]
            linked.add((name, version.removeprefix("v")))
    for package in json.loads(cargo("metadata", "--format-version", "1"))["packages"]:
        if package["source"] and (package["name"], package["version"]) in linked:
            licence = (package["license"] or "see its file").replace("/", " OR ")
            folder = pathlib.Path(package["manifest_path"]).parent
            yield package["name"], package["version"], licence, folder


def listed():
    lines = [f"    {name}: {licence}\n" for name, licence in sorted({(name, licence) for name, _, licence, _ in crates()})]
    return "".join(["Rust crates in this program and their licences:\n", *lines, "\nSQLite is in the public domain.\n"])


def notices(licence, folder):
    """Returns the files of a crate with licences and notices. Of alternatives, MIT is taken."""
    files = sorted(path for path in folder.iterdir() if path.is_file() and NOTICE.match(path.name))
    mit = [path for path in files if "MIT" in path.name.upper()]
    return mit if mit and " OR " in licence and "MIT" in licence else files


def texts():
    """Returns the texts, each once, with the crates that it is for."""
    users, without = {}, []
    for name, version, licence, folder in sorted(crates()):
        files = notices(licence, folder)
        if not files:
            without.append(f"{name} {version} ({licence})")
        for path in files:
            text = path.read_text(encoding="utf-8", errors="replace").replace("\r\n", "\n").strip("\n")
            users.setdefault(" ".join(text.split()), (text, []))[1].append(f"{name} {version} ({licence})")
    rule = "\n" + "-" * 78 + "\n"
    parts = [listed(), "\nCrates without a file of their licence, whose text is among those below:\n"]
    parts += [f"    {crate}\n" for crate in without]
    for text, names in users.values():
        parts += [rule, "\n".join(names), "\n\n", text, "\n"]
    return "".join([*parts, rule, FONTS.read_text(encoding="utf-8")])


def main():
    match sys.argv[1:]:
        case ["list"]:
            LIST.write_text(listed(), encoding="utf-8")
        case ["check"]:
            if LIST.read_text(encoding="utf-8") != listed():
                sys.exit("assets/crates.txt is not up to date: tools/licences.py list")
        case ["texts", path]:
            pathlib.Path(path).write_text(texts(), encoding="utf-8")
        case _:
            sys.exit(__doc__)


main()
