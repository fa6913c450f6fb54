#!/usr/bin/env python3
"""snippets_test.py SOURCE COMPILER...: the C++ code of the pages for users compiles (its syntax and its names).

Code is that of ```cpp blocks. A block with a main function is compiled as it is. Any other becomes the body of a
function, after the blocks of its page that SHARED names, with what the reader's program has: PARAMETERS of all blocks,
and of single pages.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

PROGRAM = """
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <vector>
#include <glm/glm.hpp>
#include <welkin/bake.h>
#include <welkin/bake_file.h>
#include <welkin/engines.h>
#include <welkin/environment_file.h>
#include <welkin/requests.h>
#include <welkin/sky_light.h>
#include <welkin/spherical_harmonics.h>
#include <welkin/bake_file.h>
#include <welkin/worker.h>
std::span<std::byte> map(std::uint64_t bytes);  // the reader's
template <class... T> void upload(T&&...);
template <class... T> void shade(T&&...);
template <class... T> void shade_with(T&&...);
template <class... T> void report(T&&...);
template <class... T> void log(T&&...);
template <class... T> void copy_to_texture(T&&...);
template <class... T> void copy_image(T&&...);
template <class... T> void set_light(T&&...);
template <class... T> void add_light(T&&...);
void simulate_and_render();
welkin::PrecomputeSky my_sky(double);
struct Slot { std::span<std::byte> staging; };
struct Probe { void set(const welkin::SphericalHarmonics&); };
struct Archive { std::vector<std::byte> load(const char*); };
"""
EVERYWHERE = """void* px, void* nx, void* py, void* ny, void* pz, void* nz, int size, std::shared_ptr<const void> owner,
double elevation_degrees, double azimuth_degrees, double seconds_since_last_frame"""
# Page: parameters of its blocks beyond EVERYWHERE, and numbers of the blocks that later ones go on from.
PAGES = {
    "README.md": ("", ()),
    "docs/tutorials/cpp_engine.md": ("const welkin::CubemapView& view", (1,)),
    "docs/guides/runtime_probes.md": (
        "std::ptrdiff_t row_stride_bytes, welkin::SphericalHarmonics radiance, std::shared_ptr<Slot> slot,"
        "std::span<const welkin::CubemapView> probes, std::vector<std::span<std::byte>> memory_of_probes", (0, 3, 6, 8)),
    "docs/guides/worker.md": (
        "welkin::Cubemap image, double sun, std::vector<Probe> probes", ()),
    "docs/guides/install.md": (
        "const void* pixels, int width, int height, std::ptrdiff_t row_stride_bytes", (0,)),
    "docs/guides/moving_sky.md": ("", ()),
    "docs/guides/scene_needs.md": ("welkin::LatLongView panorama, welkin::BakeOptions options", ()),
    "docs/guides/path_tracer.md": (
        "welkin::LatLongView panorama, welkin::dvec3 radiance_sum, double cosine, double (*random)(),"
        "welkin::dvec3 (*radiance)(welkin::dvec3)",
        ()),
    "docs/guides/probe_grids.md": (
        "std::vector<welkin::CubemapView> cubes, std::vector<welkin::DepthView> depths, welkin::dvec3 position,"
        "welkin::dvec3 normal", (0,)),
    "docs/guides/sun.md": ("welkin::LatLongImage (*load)()", ()),
    "docs/reference/files.md": ("Archive archive", ()),
}
# Blocks that need what a page declares elsewhere: page and number, with the declaration.
BEFORE = {
    ("docs/guides/worker.md", 1): "welkin::Worker worker; const welkin::CubemapView view{};",
    ("docs/guides/worker.md", 2): "welkin::Worker worker;",
    ("docs/guides/worker.md", 3): "welkin::Worker worker; auto image_of_reader = std::make_shared<welkin::Cubemap>();",
}


def program(source):
    """One translation unit of all blocks, and blocks that are programs of their own."""
    text, includes, whole = [], [], []
    for page, (parameters, shared) in PAGES.items():
        blocks = re.findall(r"```cpp\n(.*?)```", (source / page).read_text(encoding="utf-8"), re.S)
        assert blocks, f"{page} has no code"
        stripped = []
        for block in blocks:
            includes += re.findall(r"^#include.*$", block, re.M)
            stripped.append(re.sub(r"^#include.*\n", "", block, flags=re.M).replace("\n...\n", "\n"))
        for number, block in enumerate(stripped):
            if "int main()" in block:
                whole.append(blocks[number])
                continue
            before = "".join(stripped[k] for k in shared if k < number)
            before += BEFORE.get((page, number), "")
            if "[image]" in block:
                block = block.replace("[image]", "[image = image_of_reader]")
            name = re.sub(r"\W", "_", page) + f"_{number}"
            given = EVERYWHERE + (", " + parameters if parameters else "")
            text.append(f"void {name}({given}) {{\n{before}\n{{\n{block}\n}}\n}}\n")
    return PROGRAM + "\n".join(dict.fromkeys(includes)) + "\n" + "\n".join(text), whole


def main():
    source = pathlib.Path(sys.argv[1]).resolve()
    unit, whole = program(source)
    with tempfile.TemporaryDirectory() as folder:
        for number, code in enumerate([unit, *whole]):
            file = pathlib.Path(folder) / f"pages_{number}.cpp"
            file.write_text(code, encoding="utf-8")
            made = subprocess.run([*sys.argv[2:], "-std=c++20", "-fsyntax-only", "-I", str(source / "include"), str(file)],
                                  capture_output=True, text=True)
            if made.returncode:
                errors = [line for line in made.stderr.split("\n") if "error" in line]
                sys.exit("code of the pages does not compile:\n" + "\n".join(errors[:20]))
    print(f"{unit.count('void docs_') + unit.count('void README') + len(whole)} pieces of code compile")


if __name__ == "__main__":
    main()
