#!/usr/bin/env python3
"""Reads a .loden file by material/FORMAT.md alone and prints all that it says, one line per field.

Needs the zstd command. Floats are printed as their bits, textures as the XXH3-64 of their bytes."""

import math
import struct
import subprocess
import sys

from xxh3 import xxh3_64

MAGIC = bytes.fromhex("AB4C4F44454E31BB0D0A1A0A")
TEXEL_BYTES = {38: 4, 37: 4, 92: 8, 97: 8, 109: 16, 91: 8, 78: 4}
SURFACE_FORMATS = (38, 37, 38, 38, 97, 38)  # normal, color, ambient, shadow, shadow table, indirect


def require(holds, text):
    if not holds:
        sys.exit("invalid: " + text)


class Record:
    """Fields from the front of a byte string."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        require(self.at + count <= len(self.data), "record ends early")
        self.at += count
        return self.data[self.at - count:self.at]

    def u32(self, count=None):
        values = struct.unpack("<%dI" % (count or 1), self.take(4 * (count or 1)))
        return list(values) if count else values[0]

    def bits(self, count, width=8):
        return " ".join("%0*x" % (width, v) for v in struct.unpack("<%d%s" % (count, "IQ"[width == 16]),
                                                                   self.take(count * width // 2)))


def read_chunks(data):
    require(data[:12] == MAGIC, "magic")
    major, minor, count, reserved, table_hash = struct.unpack_from("<HHIIQ", data, 12)
    require(major == 1 and 1 <= count <= 84 and reserved == 0, "preamble")
    end = 32 + 48 * count
    require(xxh3_64(data[:24] + data[32:end]) == table_hash, "checksum of the table")
    chunks = []
    for i in range(count):
        kind, flags, codec, reserved, offset, stored, raw, chunk_hash = struct.unpack_from(
            "<4sIIIQQQQ", data, 32 + 48 * i)
        start = (end + 63) // 64 * 64
        require(offset == start and not any(data[end:start]) and reserved == 0, "place of chunk %d" % i)
        end = start + stored
        payload = data[start:end]
        require(xxh3_64(payload) == chunk_hash, "checksum of chunk %d" % i)
        require(codec in (0, 1) and flags in (0, 1) and raw <= 1000 * stored, "entry of chunk %d" % i)
        if codec == 1:
            payload = subprocess.run(["zstd", "-dc"], input=payload, stdout=subprocess.PIPE,
                                     check=True).stdout
        require(len(payload) == raw, "raw size of chunk %d" % i)
        chunks.append((kind.decode(), payload))
    require(end == len(data), "trailing bytes")
    return chunks


def texture(kind, width, height, depth, mips):
    """(format, extents, bytes) of a texture."""
    texels = sum(max(1, width >> m) * max(1, height >> m) * depth for m in range(mips))
    return (kind, (width, height, depth, mips), texels * TEXEL_BYTES[kind])


def read_directions(head, name):
    kind, side, count = head.u32(3)
    print(name, kind, side, count, head.bits(3 * count, 16) if count else "")


def read_band(head, place):
    print("band", place, *head.u32(3), head.bits(5))
    y_quads, chroma_quads, ratio, lead = head.u32(4)
    weights, table = head.u32(5), head.u32(4)
    quads = y_quads + chroma_quads
    print("quads", y_quads, chroma_quads, ratio, lead, head.bits(4), head.bits(6 * quads))
    if lead == 0:
        return [("BAND", [texture(*weights), texture(*table, 1)])]
    rest = quads - lead
    shares = [(lead, lead + ratio), (rest, weights[3] - lead - ratio)]  # quads, and layers of the weights
    return [("BAND", [("weights", (), texture(*weights[:3], layers, weights[4])[2]),
                      ("table", (), texture(*table[:3], table[3] // quads * share, 1)[2])])
            for share, layers in shares]


def read_surface(head):
    print("surface", *head.u32(2), end=" ")
    first, ambient_first = struct.unpack_from("<2f", head.data, head.at + 4)
    print(head.bits(5), end=" ")
    tail = head.u32()
    print(tail)
    maps = [(kind, *head.u32(4)) for kind in SURFACE_FORMATS]
    there = [extents for extents in maps if extents[1] > 0]
    if tail == 0:
        return [("SURF", [texture(*extents) for extents in there])]
    coarser = math.floor(first + tail - ambient_first + 0.5)
    tails = (tail, tail, coarser, coarser, 0, coarser)
    cuts = [min(max(mip, 0), extents[4] - 1) for mip, extents in zip(tails, maps) if extents[1] > 0]
    whole = [texture(*extents)[2] for extents in there]
    fine = [texture(*extents[:4], mip)[2] for extents, mip in zip(there, cuts)]
    return [("SURF", [("map", (), w - f) for w, f in zip(whole, fine)]),
            ("SURF", [("map", (), f) for f in fine])]


def read_head(head):
    """Prints HEAD, and the textures of each chunk behind it, or the share that it has, in file order."""
    print("mode", head.u32())
    print("side", head.u32())
    print("levels", head.bits(2))
    print("value_scale", head.bits(1), head.u32())
    print("theta_max", head.bits(1))
    print("tile", head.bits(2))
    print("mean", head.bits(6), head.u32())
    parts = head.u32()
    read_directions(head, "lights")
    read_directions(head, "views")
    bands, domains = [], []
    for place in range(head.u32()):
        domains.append(struct.unpack_from("<I", head.data, head.at)[0])
        bands.append(read_band(head, place))
    maps, surface = [], []
    if parts & 1:
        side = head.u32()
        print("geometry", side, head.bits(3), *head.u32(3))
        maps.append(("GEOM", [texture(91, side, side, 1, 1)]))
    if parts & 2:
        side, zeniths, azimuths = head.u32(3)
        print("vdim", side, zeniths, azimuths, head.bits(2))
        maps.append(("VDIM", [texture(78, side, side, 1, 1),
                              texture(92, side * azimuths, side * zeniths, 1, 1)]))
    if parts & 4:
        surface = read_surface(head)
    print("name", head.take(head.u32()).decode())
    require(head.at == len(head.data), "bytes behind HEAD")
    first = 1 if domains and domains[0] == 0 else 0
    return sum(bands[:first], []) + maps + sum(bands[first:], []) + surface


def main():
    with open(sys.argv[1], "rb") as file:
        chunks = read_chunks(file.read())
    require(chunks[0][0] == "HEAD", "first chunk")
    expected = read_head(Record(chunks[0][1]))
    for (kind, textures), (actual, data) in zip(expected, chunks[1:]):
        require(kind == actual, "order of chunks")
        texels = Record(data)
        for number, extents, count in textures:
            print(kind, number, *(extents or (count,)), "%016x" % xxh3_64(texels.take(count)))
        require(texels.at == len(data), "bytes behind the texels")
    for kind, data in chunks[1 + len(expected):]:
        require(kind == "META", "order of chunks")
        print("META", "%016x" % xxh3_64(data))


main()
