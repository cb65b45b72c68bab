"""Packets of the bridge protocol, from protocol/bridge.md only, with the Python standard library only."""

HELLO, SUPPLY = 0x01, 0x02
SSI_CONFIG, SSI_READ, SSI_STREAM = 0x10, 0x11, 0x12
BISS_CONFIG, BISS_READ, REG_READ, REG_WRITE, BISS_STREAM = 0x20, 0x21, 0x22, 0x23, 0x24
ANALOG_CONFIG, ANALOG_STREAM = 0x30, 0x31
UART_CONFIG, UART_TRANSFER = 0x40, 0x41
REPLY, ERROR, SSI_DATA, BISS_DATA = 0x80, 0xFF, 0x93, 0xA5
NOT_SUPPORTED, BAD_ARGUMENT, BUSY, NO_ANSWER, WRONG_ANSWER = 1, 2, 3, 4, 5


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


TABLE = [0] * 256
for _byte in range(256):
    _crc = _byte << 8
    for _ in range(8):
        _crc = (_crc << 1 ^ 0x1021 if _crc & 0x8000 else _crc << 1) & 0xFFFF
    TABLE[_byte] = _crc


def fast_crc16(data):
    """Returns the same as crc16, for streams."""
    crc = 0xFFFF
    for byte in data:
        crc = (crc << 8 & 0xFFFF) ^ TABLE[crc >> 8 ^ byte]
    return crc


assert crc16(b"123456789") == fast_crc16(b"123456789") == 0x29B1  # the catalogue's check value


def stuff(data):
    out = bytearray()
    for block in data.split(b"\x00"):
        while len(block) >= 254:
            out += b"\xff" + block[:254]
            block = block[254:]
        out += bytes([len(block) + 1]) + block
    return bytes(out)


def unstuff(data):
    """Returns None if it is damaged."""
    out, at = bytearray(), 0
    while at < len(data):
        code = data[at]
        if code == 0 or at + code > len(data):
            return None
        out += data[at + 1:at + code]
        at += code
        if code != 0xFF and at < len(data):
            out.append(0)
    return bytes(out)


def emit(seq, op, body=b""):
    content = bytes([seq, op]) + body
    return stuff(content + crc16(content).to_bytes(2, "little")) + b"\x00"


def parse(stuffed):
    """Returns sequence number, operation, body; None if the packet is damaged."""
    data = unstuff(stuffed)
    if data is None or len(data) < 4 or fast_crc16(data[:-2]) != int.from_bytes(data[-2:], "little"):
        return None
    return data[0], data[1], data[2:-2]


def text(words):
    return bytes([len(words)]) + words.encode()


def crc6(data, bits):
    """Returns the CRC of a position frame: x6 + x + 1, from 0 on, sent inverted."""
    crc = 0
    for bit in range(bits - 1, -1, -1):
        feedback = crc >> 5 ^ data >> bit & 1
        crc = (crc << 1 & 0x3F) ^ (0x03 if feedback else 0)
    return crc ^ 0x3F


assert crc6(0x1234 << 19 | 0x18000 << 2 | 3, 35) == 0x0F  # biss.md 2


def frame(multiturn, singleturn, error, warning):
    """Returns the 41 bits of a position, right-justified."""
    data = multiturn << 19 | singleturn << 2 | (not error) << 1 | (not warning)
    return data << 6 | crc6(data, 35)
