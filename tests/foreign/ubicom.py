"""UBICOM frames, from protocol/ubicom.md only, with the Python standard library only."""

SYNC, NODE = 0x80, 0x01
READ, WRITE, POSITION = 0x01, 0x02, 0x03
ACK, NAK = 0x90, 0xA0


def checksum(data):
    return ~sum(data) & 0xFF


def frame(command, payload):
    data = bytes([SYNC, NODE, command]) + len(payload).to_bytes(2, "little") + bytes(payload)
    return data + bytes([checksum(data)])


def take(buffer):
    """Returns the first complete frame and the rest; None while there is none. Bytes outside a frame are dropped."""
    while buffer:
        if buffer[0] != SYNC or (len(buffer) > 1 and buffer[1] != NODE):
            buffer = buffer[1:]
            continue
        if len(buffer) < 5:
            break
        end = 6 + int.from_bytes(buffer[3:5], "little")
        if len(buffer) < end:
            break
        if sum(buffer[:end]) % 256 == 0xFF:
            return buffer[:end], buffer[end:]
        buffer = buffer[1:]
    return None, buffer


def place(number):
    """Returns the register of a global address, as bank (None: direct) and address."""
    if number < 0x40:
        return None, number + 0x40
    return (number - 0x40) // 0x40, (number - 0x40) % 0x40
