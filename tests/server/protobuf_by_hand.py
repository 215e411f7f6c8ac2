"""Protobuf by hand: https://protobuf.dev/programming-guides/encoding, and the bodies of proto/scan.proto."""
import struct


def varint(value):
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes(out + bytes([value]))


def field(number, value):
    if isinstance(value, float):
        return varint(number << 3 | 1) + struct.pack("<d", value)
    if isinstance(value, int):
        return varint(number << 3) + varint(value)
    data = value.encode() if isinstance(value, str) else value
    return varint(number << 3 | 2) + varint(len(data)) + data


def read_varint(data, at):
    value = shift = 0
    while True:
        value |= (data[at] & 0x7F) << shift
        shift += 7
        at += 1
        if data[at - 1] < 0x80:
            return value, at


def fields(data):
    """{field number: last value}; 8 and 4 byte values as bytes."""
    out, at = {}, 0
    while at < len(data):
        key, at = read_varint(data, at)
        kind = key & 7
        if kind == 0:
            value, at = read_varint(data, at)
        else:
            length = {1: 8, 5: 4}.get(kind)
            if length is None:
                length, at = read_varint(data, at)
            value, at = data[at:at + length], at + length
        out[key >> 3] = value
    return out


def double(data):
    return struct.unpack("<d", data)[0] if data else 0.0


# Bodies of proto/scan.proto.
HELLO, FRAME, FINISH, VIEWER_ACK, PING = 1, 2, 3, 4, 5
WELCOME, RESULT, CREDIT, CHUNK, POSES, STATE, FINISHED, ERROR, PONG, SNAPSHOT_END, TRAJECTORY, RESUMED = range(1, 13)
