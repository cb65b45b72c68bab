#!/usr/bin/env python3
"""Prints how many colours the screen of an Xvfb shows, whose option -fbdir keeps it in a file in the format XWD."""

import struct
import sys

with open(sys.argv[1], "rb") as file:
    screen = file.read()
# The header is a row of numbers: its own size first, the height at 5, the bytes a line at 12, the colours of the map at 19.
header = struct.unpack(">25I", screen[:100])
begin = header[0] + header[19] * 12
pixels = screen[begin:begin + header[5] * header[12]]
print(len(set(struct.unpack(f"{len(pixels) // 4}I", pixels))))
