# PNG of values from 0 to 1 that are encoded already, by Python's own zlib.
import struct
import zlib

import numpy as np


def write(path, pixels):
    """pixels: (height, width, 3)."""
    height, width = pixels.shape[:2]
    rows = np.round(np.clip(pixels, 0, 1) * 255).astype(np.uint8)
    raw = b"".join(b"\0" + row.tobytes() for row in rows)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)))
        file.write(chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))
