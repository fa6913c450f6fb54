"""Qt Quick 3D under Xvfb draws nine spheres (spheres.qml) from `welkin bake --for qt`'s file.

    qt_live.py WELKIN WORK_DIR [--balsam] [--record]

Compared with the same scene lit by files that have each sphere's own roughness in all mips (the truth), and with what Qt
draws of the same image's bake by its own `balsam`. That takes minutes of software rendering, so its picture is on
record (balsam.png); --balsam bakes and draws it again. measured.json has the differences, of which half as much again is
allowed, and 0.005; --record writes both anew. Exit code 77 where Qt Quick 3D or Xvfb is missing, which it says.
"""

import json
import math
import os
import shutil
import struct
import subprocess
import sys
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
FACES = 256
MIPS = 7
ROUGHNESS = (0.2, 0.5, 0.8)
SPHERES = [(roughness, metalness) for metalness in (1, 0.5, 0) for roughness in ROUGHNESS]
QT = next((folder for folder in ("/usr/lib/qt6/bin", "/usr/lib/x86_64-linux-gnu/qt6/bin", "/usr/lib/aarch64-linux-gnu/qt6/bin")
           if os.path.exists(folder + "/qml")), "")
QML_FOLDERS = ("/usr/lib/x86_64-linux-gnu/qt6/qml", "/usr/lib/aarch64-linux-gnu/qt6/qml", "/usr/lib/qt6/qml")


def skip(reason):
    print("SKIPPED: " + reason)
    sys.exit(77)


def under_xvfb(words, folder, seconds):
    environment = dict(os.environ, LIBGL_ALWAYS_SOFTWARE="1", QSG_RHI_BACKEND="opengl")
    words = ["xvfb-run", "-a", "-s", "-screen 0 800x600x24", *words]
    done = subprocess.run(words, cwd=folder, env=environment, timeout=seconds, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(" ".join(words) + "\n" + done.stdout + done.stderr)


def png_rows(path):
    """A PNG of 8 bits, RGB or RGBA, not interlaced: rows of channels."""
    with open(path, "rb") as file:
        data = file.read()
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, colours, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            assert bits == 8 and colours in (2, 6) and not interlaced
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    channels = 3 if colours == 2 else 4
    plain, rows, before = zlib.decompress(packed), [], bytearray(width * channels)
    for row in range(height):
        start = row * (1 + width * channels)
        line = bytearray(plain[start + 1 : start + 1 + width * channels])
        for i, value in enumerate(line):
            left = line[i - channels] if i >= channels else 0
            corner = before[i - channels] if i >= channels else 0
            line[i] = (value + predicted(plain[start], left, before[i], corner)) & 255
        rows.append([tuple(line[i : i + 3]) for i in range(0, len(line), channels)])
        before = line
    return rows


def predicted(kind, left, above, corner):
    if kind < 4:
        return (0, left, above, (left + above) // 2)[kind]
    guess = left + above - corner
    return min((left, above, corner), key=lambda one: abs(guess - one))


def bake(welkin, image, folder, *options):
    words = [welkin, "bake", image, "-o", folder, "--for", "qt", "--size", str(FACES), "--no-previews", "-q", *options]
    subprocess.run(words, check=True)
    return os.path.join(folder, "environment.ktx")


def draw(probe, folder):
    """What spheres.qml sees, by sphere: lists of pixels in the circle's inner nine tenths."""
    os.makedirs(folder, exist_ok=True)
    shutil.copy(probe, os.path.join(folder, "probe.ktx"))
    shutil.copy(os.path.join(HERE, "spheres.qml"), folder)
    under_xvfb([QT + "/qml", "spheres.qml"], folder, 300)
    return os.path.join(folder, "spheres.png")


def spheres(path):
    rows = png_rows(path)
    cell = len(rows) / 3
    radius = 0.9 * 0.5 * 120 / 128 * cell
    found = [[] for _ in SPHERES]
    for y, row in enumerate(rows):
        for x, pixel in enumerate(row):
            column, line = int(x / cell), int(y / cell)
            if math.hypot(x + 0.5 - (column + 0.5) * cell, y + 0.5 - (line + 0.5) * cell) < radius:
                found[3 * line + column].append(pixel)
    return found


def differences(ours, other):
    """By sphere: root mean square of the difference over that of the second."""
    result = []
    for mine, theirs in zip(ours, other):
        off = sum((a - b) ** 2 for p, q in zip(mine, theirs) for a, b in zip(p, q))
        result.append(math.sqrt(off / sum(b * b for q in theirs for b in q)))
    return result


def truth(welkin, image, work):
    """Each sphere from a file whose mips all have its roughness, but for the last, which is diffuse light."""
    result = [None] * len(SPHERES)
    for column, roughness in enumerate(ROUGHNESS):
        table = ",".join([str(roughness)] * (MIPS - 1) + ["1"])
        probe = bake(welkin, image, os.path.join(work, "truth"), "--roughness", table)
        drawn = spheres(draw(probe, os.path.join(work, "drawn_truth")))
        for line in range(3):
            result[3 * line + column] = drawn[3 * line + column]
    return result


def main(welkin, work, *flags):
    if not shutil.which("xvfb-run"):
        skip("xvfb-run is not there (Debian: xvfb)")
    if not QT or not any(os.path.exists(folder + "/QtQuick3D/Helpers") for folder in QML_FOLDERS):
        skip("Qt Quick 3D is not there (scripts/install-dependencies --engines installs it)")
    os.makedirs(work, exist_ok=True)
    image = os.path.join(work, "testmap.hdr")
    subprocess.run([welkin, "testmap", "-o", image, "--size", "1024"], check=True, stdout=subprocess.DEVNULL)
    on_record = os.path.join(HERE, "balsam.png")
    if "--balsam" in flags:
        under_xvfb([QT + "/balsam", "-o", "balsam", "testmap.hdr"], work, 3600)
        drawn = draw(os.path.join(work, "balsam", "testmap.ktx"), os.path.join(work, "drawn_balsam"))
        on_record = drawn
        if "--record" in flags:
            shutil.copy(drawn, os.path.join(HERE, "balsam.png"))
    exact = truth(welkin, image, work)
    ours = spheres(draw(bake(welkin, image, os.path.join(work, "ours")), os.path.join(work, "drawn_ours")))
    balsam = spheres(on_record)
    found = {
        "ours - truth": differences(ours, exact),
        "balsam - truth": differences(balsam, exact),
        "ours - balsam": differences(ours, balsam),
    }
    print("| percent | " + " | ".join("%g, metalness %g" % one for one in SPHERES) + " |")
    for name, row in found.items():
        print("| " + name + " | " + " | ".join("%.2f" % (100 * value) for value in row) + " |")
    record = os.path.join(HERE, "measured.json")
    if "--record" in flags:
        with open(record, "w") as file:
            rows = ",\n".join(' "%s": %s' % (name, [round(value, 4) for value in row]) for name, row in found.items())
            file.write("{\n" + rows + "\n}\n")
    with open(record) as file:
        allowed = {name: [1.5 * value + 0.005 for value in row] for name, row in json.load(file).items()}
    failures = [name for name, row in found.items() if not all(a <= b for a, b in zip(row, allowed[name]))]
    # A file that is mirrored, turned, upside down or of other roughness must not pass for ours.
    for how, *options in (
        ("mirrored", "--mirror"),
        ("turned", "--yaw", "90"),
        ("back", "--yaw", "180"),
        ("overhead", "--rotation", "0,0,1,0"),
        ("of balsam's roughness", "--roughness", "0,0.25,0.5,0.75,0.96,1,1"),
    ):
        wrong = spheres(draw(bake(welkin, image, os.path.join(work, "wrong"), *options), os.path.join(work, "drawn_wrong")))
        row = differences(wrong, exact)
        print("| " + how + " - truth | " + " | ".join("%.2f" % (100 * value) for value in row) + " |")
        if all(a <= b for a, b in zip(row, allowed["ours - truth"])):
            failures.append("a file " + how + " is taken for a right one")
    for failure in failures:
        print("FAILED: " + failure)
    return 1 if failures else 0


sys.exit(main(*sys.argv[1:]))
