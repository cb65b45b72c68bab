"""Recordings of turning SSI encoders, for the search for the layout: fifteen encoders in the style of different makers,
each with an uneven shaft, noise and disturbed frames. From protocol/ssi.md (sections 1 to 4) only, with the Python
standard library only; nothing of the program is used. Run as a program it writes tests/vectors/ssi_find/*.txt again,
always the same.

A line of a recording: the bits of a frame in clock order, the intended position, a - for a disturbed frame."""

import math
import pathlib
import random

from ssi import gray


def bits(number, width):
    return [number >> (width - 1 - at) & 1 for at in range(width)]


def excess(steps):
    """Returns the bits of a Gray excess word, and the number of position 0 (section 2)."""
    width = (steps - 1).bit_length()
    return width, (2**width - steps) // 2


def shaft(rng, frames, speed, start, noise):
    """Returns positions of a shaft whose speed changes slowly, in steps, without the wrap at the end of the range."""
    angle, phase, positions = float(start), rng.random() * math.tau, []
    for at in range(frames):
        angle += speed * (1 + 0.25 * math.sin(phase + at / 90))
        positions.append(round(angle + rng.gauss(0, noise)))
    return positions


def bcd(number, digits):
    return [bit for digit in str(number).rjust(digits, "0") for bit in bits(int(digit), 4)]


def parity(word, even):
    return word + [sum(word) % 2 if even else 1 - sum(word) % 2]


def inverted(word):
    return [1 - bit for bit in word]


def gray_bits(position, width):
    return bits(gray(position), width)


def excess_bits(position, steps, clocks):
    width, offset = excess(steps)
    return [0] * (clocks - width) + bits(gray(position + offset), width)


# Name, parts of a frame, positions in all, steps per frame, first position, noise in steps.
ENCODERS = [
    ("ahm36_gray", lambda p: gray_bits(p, 26) + [0], 2**26, 2.3, 9_000_000, 0.4),
    ("tree_8_8_gray", lambda p: [0] * 4 + gray_bits(p, 16) + [0] * 5, 2**16, 1.7, 30_000, 0.4),
    ("error_active_low", lambda p: gray_bits(p, 24) + [1], 2**24, 3.1, 5_000_000, 0.5),
    ("start_bit", lambda p: [1] + gray_bits(p, 13), 2**13, 11.0, 100, 1.0),
    ("power_good_first", lambda p: [1, 0] + bits(p, 24), 2**24, 5.2, 7_340_000, 0.7),
    ("wires_exchanged_gray", lambda p: inverted(gray_bits(p, 25)), 2**25, 1.4, 11_000_000, 0.4),
    ("wires_exchanged_binary", lambda p: inverted(bits(p, 13) + [0, 0, 0]), 2**13, 7.7, 4000, 0.8),
    ("twice_with_gap", lambda p: gray_bits(p, 25) + [0] + gray_bits(p, 25), 2**25, 2.9, 20_000_000, 0.4),
    ("twice_binary", lambda p: bits(p, 12) + bits(p, 12), 2**12, 3.3, 50, 0.5),
    ("excess_360_fast", lambda p: excess_bits(p, 360, 9), 360, 47.0, 17, 0.6),
    ("excess_3600_right", lambda p: excess_bits(p, 3600, 24) + [0], 3600, 130.0, 900, 1.5),
    ("gray_even_parity", lambda p: parity(gray_bits(p, 24), True), 2**24, 2.6, 3_000_000, 0.5),
    ("binary_odd_parity", lambda p: parity(bits(p, 17), False), 2**17, 23.0, 60_000, 2.0),
    ("reversed_linear", lambda p: bits(p, 24) + [0, 0], 2**24, -6.1, 8_000_000, 0.7),
    ("three_thousand_six_hundred_steps", lambda p: bcd(p, 4), 3600, 5.5, 3000, 0.6),
]
FRAMES = 900


def recording(name, frame, whole, speed, start, noise):
    """Returns the lines of a recording: of a hundred frames, about two are disturbed: single bits, or all of it."""
    rng = random.Random(name)
    lines = []
    for position in shaft(rng, FRAMES, speed, start, noise):
        position %= whole
        word, meant = frame(position), str(position)
        if rng.random() < 0.02:
            spoilt = range(len(word)) if rng.random() < 0.3 else rng.sample(range(len(word)), rng.randint(1, 3))
            word, meant = [bit ^ (at in spoilt and rng.random() < 0.7) for at, bit in enumerate(word)], "-"
        lines.append("".join(map(str, word)) + " " + meant)
    return lines


if __name__ == "__main__":
    folder = pathlib.Path(__file__).parent.parent / "vectors" / "ssi_find"
    for encoder in ENCODERS:
        text = "# made by tests/foreign/ssi_recordings.py: frame, position\n" + "\n".join(recording(*encoder)) + "\n"
        (folder / f"{encoder[0]}.txt").write_text(text)
