#!/usr/bin/env python3
"""Runs an exported SSI decoder of 32 bits, as structured text or as SCL: structured_text.py FILE, frames in hex on standard
input, one a line. Prints position, turns, steps and valid of each. Words are cut to 32 bits, as a controller does."""
import re
import sys

MASK = 0xFFFFFFFF


def SHL(IN, N):
    assert 0 < N < 32, N
    return IN << N & MASK


def SHR(IN, N):
    assert 0 < N < 32, N
    assert 0 <= IN <= MASK, IN
    return IN >> N


def expression(text):
    text = re.sub(r"\bDWORD#16#([0-9A-F]+)", r"0x\1", text)
    text = re.sub(r"\bUDINT#(\d+)", r"\1", text)
    text = text.replace("#", "")
    text = re.sub(r"\bDWORD_TO_UDINT\b", "", text)
    text = text.replace(":=", "\0").replace("<>", "!=")
    text = re.sub(r"(?<![<>!])=", "==", text).replace("\0", "=")
    text = text.replace("/", "//").replace(" MOD ", " % ")
    # AND and OR join words and truths alike; Python's words do for both, since truths are numbers there.
    return text.replace(" XOR ", " ^ ").replace(" AND ", " & ").replace(" OR ", " | ")


def negated(text):
    """`NOT x` as `(1 - x)`, where x is what stands in the next parentheses."""
    while "NOT (" in text:
        at = text.index("NOT (")
        depth, end = 0, at + 4
        while True:
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            end += 1
            if depth == 0:
                break
        text = text[:at] + "(1 - " + text[at + 4 : end] + ")" + text[end:]
    return text


def statement(line):
    condition = re.fullmatch(r"IF (.*) THEN (.*) END_IF;", line)
    if condition:
        return f"if {expression(negated(condition[1]))}:\n    " + statement(condition[2])
    name, value = line.rstrip(";").split(" := ", 1)
    value = expression(negated(value))
    # A number of 32 bits wraps.
    return f"{name.lstrip('#')} = int({value}) & MASK"


def program(text):
    declared = set(re.findall(r"^\s*(\w+) : (?:DWORD|DWord|UDINT|UDInt|BOOL|Bool);$", text, re.M))
    body = text[text.rindex("END_VAR") + len("END_VAR") :]
    lines = [line.strip() for line in body.splitlines()]
    lines = [line for line in lines if line and not line.startswith(("//", "(*", "BEGIN", "END_FUNCTION_BLOCK"))]
    for name in re.findall(r"\b[a-z][a-z_]*\b", "\n".join(lines)):
        assert name in declared, f"{name} is not declared"
    return "\n".join(map(statement, lines)), declared


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        code, declared = program(file.read())
    code = compile(code, sys.argv[1], "exec")
    for line in sys.stdin:
        frame = int(line, 16)
        own = {"SHL": SHL, "SHR": SHR, "MASK": MASK, "TRUE": 1, "FALSE": 0}
        if "frame" in declared:
            own["frame"] = frame & MASK
        else:
            own["frame_high"], own["frame_low"] = frame >> 32, frame & MASK
        exec(code, own)
        print(own["position"], own["turns"], own["steps"], own["valid"])


main()
