"""Reads a frame log, from core/log/frame_log.md alone."""
import glob
import os
import struct


def crc32c_table():
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = byte >> 1 ^ (0x82F63B78 if byte & 1 else 0)
        table.append(byte)
    return table


TABLE = crc32c_table()


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = crc >> 8 ^ TABLE[(crc ^ byte) & 0xFF]
    return crc ^ 0xFFFFFFFF


checked_crcs = {}  # record bytes are checked once: Python needs half a second for a megabyte


def frames_in_log(folder):
    """How many whole frames there are before the first bad record."""
    number = frames = 0
    for index, path in enumerate(sorted(glob.glob(os.path.join(folder, "segment-*.rlog")))):
        data = open(path, "rb").read()
        if data[:12] != b"HRMFLOG1" + struct.pack("<I", index) or data[12:16] != struct.pack("<I", crc32c(data[:12])):
            return frames
        at = 16
        while at < len(data):
            if at + 24 > len(data):
                return frames
            magic, crc, length, kind, stated = struct.unpack("<4sIIIQ", data[at:at + 24])
            body = data[at + 8:at + 24 + length]
            if magic != b"HRMR" or stated != number or len(body) != 16 + length:
                return frames
            if body not in checked_crcs:
                checked_crcs[body] = crc32c(body)
            if checked_crcs[body] != crc:
                return frames
            number += 1
            frames += kind in (3, 4)
            at += 24 + length
    return frames
