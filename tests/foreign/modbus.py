"""Modbus/TCP frames, both sides, for the gateway and the master of these tests. Python standard library only."""

import socket
import struct

ILLEGAL_FUNCTION, ILLEGAL_ADDRESS, ILLEGAL_VALUE, NO_ANSWER = 1, 2, 3, 0x0B
READ_HOLDING, READ_INPUT, WRITE_ONE, WRITE_MANY = 3, 4, 6, 16


class Refused(Exception):
    """An exception with its code."""

    def __init__(self, code):
        super().__init__(f"exception {code:02X}")
        self.code = code


def frame(transaction, unit, pdu):
    return struct.pack(">HHHB", transaction, 0, len(pdu) + 1, unit) + pdu


def take(buffer):
    """Removes a frame from the beginning of a bytearray: transaction, unit, PDU; returns None if it is not complete."""
    if len(buffer) < 7:
        return None
    transaction, protocol, length, unit = struct.unpack(">HHHB", buffer[:7])
    if protocol != 0 or not 2 <= length <= 254:
        raise ValueError(f"no Modbus frame: {bytes(buffer).hex(' ')}")
    if len(buffer) < 6 + length:
        return None
    pdu = bytes(buffer[7:6 + length])
    del buffer[:6 + length]
    return transaction, unit, pdu


def parse(pdu):
    """Returns function, first register, count, values (None for reading)."""
    function, rest = pdu[0], pdu[1:]
    if function in (READ_HOLDING, READ_INPUT):
        if len(rest) != 4 or not 1 <= (count := int.from_bytes(rest[2:4], "big")) <= 125:
            raise Refused(ILLEGAL_VALUE)
        return function, int.from_bytes(rest[:2], "big"), count, None
    if function == WRITE_ONE:
        if len(rest) != 4:
            raise Refused(ILLEGAL_VALUE)
        return function, int.from_bytes(rest[:2], "big"), 1, [int.from_bytes(rest[2:4], "big")]
    if function == WRITE_MANY:
        count = int.from_bytes(rest[2:4], "big") if len(rest) > 4 else 0
        if not 1 <= count <= 123 or rest[4] != 2 * count or len(rest) != 5 + 2 * count:
            raise Refused(ILLEGAL_VALUE)
        return function, int.from_bytes(rest[:2], "big"), count, list(struct.unpack(f">{count}H", rest[5:]))
    raise Refused(ILLEGAL_FUNCTION)


class Client:
    """A master's connection to a gateway."""

    def __init__(self, address, unit=1):
        host, port = address.rsplit(":", 1)
        self.socket = socket.create_connection((host, int(port)), timeout=5)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.unit, self.transaction, self.buffer = unit, 0, bytearray()

    def ask(self, pdu):
        """Returns the part of the reply after the function."""
        self.transaction = self.transaction % 0xFFFF + 1
        self.socket.sendall(frame(self.transaction, self.unit, pdu))
        while (reply := take(self.buffer)) is None:
            data = self.socket.recv(4096)
            if not data:
                raise ConnectionError("the gateway has closed the connection")
            self.buffer += data
        transaction, unit, answer = reply
        if (transaction, unit) != (self.transaction, self.unit):
            raise ValueError(f"a reply to {transaction} of unit {unit}")
        if answer[0] == pdu[0] | 0x80:
            raise Refused(answer[1])
        if answer[0] != pdu[0]:
            raise ValueError(f"function {answer[0]} for {pdu[0]}")
        return answer[1:]

    def read(self, function, first, count):
        reply = self.ask(struct.pack(">BHH", function, first, count))
        if reply[0] != 2 * count or len(reply) != 1 + 2 * count:
            raise ValueError("not as many registers as asked for")
        return list(struct.unpack(f">{count}H", reply[1:]))

    def write(self, first, values):
        head = struct.pack(">BHHB", WRITE_MANY, first, len(values), 2 * len(values))
        if self.ask(head + struct.pack(f">{len(values)}H", *values)) != head[1:5]:
            raise ValueError("another write is acknowledged")
