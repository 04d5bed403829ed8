#!/usr/bin/env python3
"""Writes a glTF tile of one material: round knobs on a wavy ground, one period, lying flat along x and z.

usage: metal_tile.py OUT.gltf R,G,B METALLIC ROUGHNESS"""
import base64
import json
import math
import struct
import sys

SIDE = 192


def height(u, v):
    h = 0.02 * math.cos(2 * math.pi * u) * math.cos(2 * math.pi * v)
    for cu, cv, r in ((0.25, 0.3, 0.16), (0.72, 0.22, 0.12), (0.62, 0.7, 0.2), (0.15, 0.78, 0.11)):
        du = (u - cu + 0.5) % 1 - 0.5
        dv = (v - cv + 0.5) % 1 - 0.5
        d = (du * du + dv * dv) / (r * r)
        if d < 1:
            h += 0.75 * r * (1 - d) ** 1.5
    return h


def main():
    out, metallic, roughness = sys.argv[1], float(sys.argv[3]), float(sys.argv[4])
    color = [float(channel) for channel in sys.argv[2].split(",")]
    positions, uvs, indices = [], [], []
    for j in range(SIDE + 1):
        for i in range(SIDE + 1):
            u, v = i / SIDE, j / SIDE
            positions.append((u, height(u, v), -v))
            uvs.append((u, 1 - v))
    for j in range(SIDE):
        for i in range(SIDE):
            a = j * (SIDE + 1) + i
            b, c, d = a + 1, a + SIDE + 1, a + SIDE + 2
            indices += [a, b, d, a, d, c]
    normals = []
    for j in range(SIDE + 1):
        for i in range(SIDE + 1):
            e = 1 / SIDE / 4
            u, v = i / SIDE, j / SIDE
            gx = (height(u + e, v) - height(u - e, v)) / (2 * e)
            gy = (height(u, v + e) - height(u, v - e)) / (2 * e)
            n = math.sqrt(gx * gx + gy * gy + 1)
            normals.append((-gx / n, 1 / n, gy / n))
    data = b"".join(struct.pack("<3f", *p) for p in positions)
    normal_at = len(data)
    data += b"".join(struct.pack("<3f", *p) for p in normals)
    uv_at = len(data)
    data += b"".join(struct.pack("<2f", *p) for p in uvs)
    index_at = len(data)
    data += struct.pack("<%dI" % len(indices), *indices)
    count = len(positions)
    low = [min(p[k] for p in positions) for k in range(3)]
    high = [max(p[k] for p in positions) for k in range(3)]
    material = {"baseColorFactor": color + [1.0], "metallicFactor": metallic, "roughnessFactor": roughness}
    gltf = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3,
                                    "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": material}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3", "min": low, "max": high},
            {"bufferView": 1, "componentType": 5126, "count": count, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5126, "count": count, "type": "VEC2"},
            {"bufferView": 3, "componentType": 5125, "count": len(indices), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": end - at} for at, end in
                        ((0, normal_at), (normal_at, uv_at), (uv_at, index_at), (index_at, len(data)))],
        "buffers": [{"byteLength": len(data),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}
    with open(out, "w") as file:
        json.dump(gltf, file)


main()
