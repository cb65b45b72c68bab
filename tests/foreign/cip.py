"""EtherNet/IP frames and CIP messages on the side of a target, from the project's reference (protocol/hiperdrive.md,
section 7) only, with the Python standard library only."""

import struct

HEADER = struct.Struct("<HHII8sI")
REGISTER, UNREGISTER, LIST_IDENTITY, SEND_RR = 0x65, 0x66, 0x63, 0x6F
GET_ALL, GET, SET, FORWARD_OPEN, FORWARD_CLOSE = 0x01, 0x0E, 0x10, 0x54, 0x4E
OK, CONNECTION, PATH_UNKNOWN, NO_SERVICE, INVALID, STATE = 0x00, 0x01, 0x05, 0x08, 0x09, 0x0C
NOT_SETTABLE, TOO_SHORT, NO_ATTRIBUTE, TOO_LONG = 0x0E, 0x13, 0x14, 0x15


class Refused(Exception):
    """A request that is refused."""

    def __init__(self, status, *extended):
        super().__init__(status)
        self.status, self.extended = status, extended


def frame(command, session, context, data=b"", status=0):
    return HEADER.pack(command, len(data), session, status, context, 0) + data


def take(buffer):
    """Returns the next complete frame: command, session, context, data; None if there is none yet."""
    if len(buffer) < HEADER.size:
        return None
    command, length, session, _status, context, _options = HEADER.unpack(buffer[:HEADER.size])
    if len(buffer) < HEADER.size + length:
        return None
    data = bytes(buffer[HEADER.size:HEADER.size + length])
    del buffer[:HEADER.size + length]
    return command, session, context, data


def items(*pairs):
    listed = b"".join(struct.pack("<HH", kind, len(data)) + data for kind, data in pairs)
    return struct.pack("<H", len(pairs)) + listed


def parse_items(data):
    (count,), at, found = struct.unpack_from("<H", data), 2, {}
    for _ in range(count):
        kind, length = struct.unpack_from("<HH", data, at)
        found[kind] = data[at + 4:at + 4 + length]
        at += 4 + length
    return found


def parse_request(message):
    """Returns service, {class, instance, attribute}, data."""
    service, words = message[0], message[1]
    path, data = message[2:2 + 2 * words], message[2 + 2 * words:]
    numbers, at = {}, 0
    names = {0x20: "class", 0x24: "instance", 0x30: "attribute", 0x2C: "point"}
    while at < len(path):
        kind = path[at] & 0xFE
        if path[at] & 1:
            numbers[names[kind]] = struct.unpack_from("<H", path, at + 2)[0]
            at += 4
        else:
            numbers[names[kind]] = path[at + 1]
            at += 2
    return service, numbers, data


def reply(service, data=b"", status=OK, extended=()):
    words = b"".join(struct.pack("<H", word) for word in extended)
    return bytes([service | 0x80, 0, status, len(extended)]) + words + data


def socket_address(port, address="0.0.0.0"):
    return struct.pack(">HH4s8x", 2, port, bytes(int(part) for part in address.split(".")))


def identity(vendor, product, serial, name):
    """Returns attributes 1 to 7 of the identity object."""
    name = name.encode("ascii")
    return struct.pack("<HHHBBHI", vendor, 0x2B, product, 1, 2, 0x0030, serial) + bytes([len(name)]) + name
