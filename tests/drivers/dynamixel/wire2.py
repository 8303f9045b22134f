"""Packets of protocol 2.0, written from the manual for tests alone; shares no code with the driver."""


def crc(data: bytes) -> int:
    """Bit by bit, as the manual's page on the CRC describes it."""
    value = 0
    for byte in data:
        for bit in range(7, -1, -1):
            out = value >> 15 & 1 ^ byte >> bit & 1
            value = value << 1 & 0xFFFF ^ (0x8005 if out else 0)
    return value


def framed2(id_: int, instruction: int, *parameters: int) -> bytes:
    body = [instruction]
    for byte in parameters:
        body.append(byte)
        if body[-3:] == [0xFF, 0xFF, 0xFD]:
            body.append(0xFD)
    length = len(body) + 2
    head = bytes((0xFF, 0xFF, 0xFD, 0, id_, length % 256, length // 256, *body))
    return head + crc(head).to_bytes(2, "little")


def status2(id_: int, *parameters: int, error: int = 0) -> bytes:
    return framed2(id_, 0x55, error, *parameters)


def long(value: int) -> bytes:
    return value.to_bytes(4, "little", signed=True)
