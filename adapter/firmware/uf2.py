#!/usr/bin/env python3
"""Converts an ELF file to UF2, the format of the boot drive: uf2.py IN.elf OUT.uf2

Format: github.com/microsoft/uf2. Blocks of 512 bytes with 256 bytes of the flash each.
"""

import struct
import sys

FLASH, FLASH_END, PAGE = 0x10000000, 0x10200000, 256
FAMILY_RP2040, FAMILY_IS_GIVEN = 0xE48BFF56, 0x2000
MAGIC = 0x0A324655, 0x9E5D5157, 0x0AB16F30


def flash_image(elf):
    """Returns the content of the flash from its start on."""
    assert elf[:6] == b"\x7fELF\x01\x01", "not a 32-bit ELF file"
    header, = struct.unpack_from("<I", elf, 28)
    size, count = struct.unpack_from("<HH", elf, 42)
    image = bytearray()
    for at in range(header, header + count * size, size):
        kind, offset, _, address, length = struct.unpack_from("<5I", elf, at)
        if kind != 1 or length == 0:
            continue
        assert FLASH <= address and address + length <= FLASH_END, f"a segment at {address:08X}"
        start = address - FLASH
        image.extend(b"\xff" * (start + length - len(image)))
        image[start:start + length] = elf[offset:offset + length]
    return bytes(image)


def boot_checksum(boot):
    """Returns CRC-32/MPEG-2, by which the boot loader recognises its second stage."""
    crc = 0xFFFFFFFF
    for byte in boot:
        crc ^= byte << 24
        for _ in range(8):
            crc = (crc << 1 ^ 0x04C11DB7 if crc & 0x80000000 else crc << 1) & 0xFFFFFFFF
    return crc


def uf2(image):
    pages = [image[at:at + PAGE].ljust(PAGE, b"\xff") for at in range(0, len(image), PAGE)]
    blocks = []
    for number, page in enumerate(pages):
        head = struct.pack("<8I", MAGIC[0], MAGIC[1], FAMILY_IS_GIVEN, FLASH + number * PAGE, PAGE, number, len(pages),
                           FAMILY_RP2040)
        blocks.append(head + page.ljust(476, b"\0") + struct.pack("<I", MAGIC[2]))
    return b"".join(blocks)


def main():
    source, target = sys.argv[1:]
    with open(source, "rb") as file:
        image = flash_image(file.read())
    if boot_checksum(image[:252]) != struct.unpack_from("<I", image, 252)[0]:
        sys.exit("the second stage of the boot loader is damaged")
    with open(target, "wb") as file:
        file.write(uf2(image))
    print(f"{target}: {len(image)} bytes of flash")


main()
