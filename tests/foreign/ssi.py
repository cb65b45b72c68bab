"""Frames of an SSI encoder, from protocol/ssi.md (sections 1 to 4) only, with the Python standard library only: turns and
steps one after the other, left-aligned, in binary or Gray, followed by error bits outside the code."""


def gray(number):
    return number ^ number >> 1


def ungray(word):
    number = 0
    while word:
        number ^= word
        word >>= 1
    return number


assert [gray(number) for number in (1000, 12345, 0xABCDEF)] == [0x21C, 0x2825, 0xFE2B18]  # section 8
assert ungray(0xFFFFFE) == 0xAAAAAB


class Format:
    """Parses multiturn bits, singleturn bits, code, error bits: "12,13,gray,0"."""

    def __init__(self, text):
        multiturn, singleturn, self.code, errors = text.split(",")
        self.multiturn, self.singleturn, self.errors = int(multiturn), int(singleturn), int(errors)
        self.bits = self.multiturn + self.singleturn + self.errors

    def frame(self, turns, part, of_bits, errors=0):
        """Returns the frame of a shaft at a number of turns and of parts of 2^of_bits of one, right-justified."""
        steps = part << self.singleturn >> of_bits
        number = (turns & (1 << self.multiturn) - 1) << self.singleturn | steps
        return (gray(number) if self.code == "gray" else number) << self.errors | errors

    def read(self, word, clocks):
        """Returns position and error bits of a word with a number of clocks."""
        frame = word >> clocks - self.bits if clocks >= self.bits else word << self.bits - clocks
        number = frame >> self.errors
        return ungray(number) if self.code == "gray" else number, frame & (1 << self.errors) - 1


_ahm36 = Format("12,14,gray,1").frame(0x123, 0x2A5B, 14)
assert _ahm36 == 0x0D93EEC and Format("12,14,gray,1").read(_ahm36, 27) == (0x123 << 14 | 0x2A5B, 0)  # section 8
