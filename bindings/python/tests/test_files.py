"""Files in and out."""
import pathlib

import numpy as np
import pytest

import truth
import welkin


def test_a_picture_comes_back(image, faces, tmp_path):
    for name in ("sky.pfm", "sky.exr"):
        welkin.write(tmp_path / name, image, type="float")
        found = welkin.read(str(tmp_path / name))
        assert (found.pixels == image).all() and np.shares_memory(np.asarray(found), found.pixels)
    assert found.info["format"] == "OpenEXR" and (found.info["width"], found.info["height"]) == (64, 32)
    report = welkin.write(tmp_path / "cube.exr", faces, "vertical-strip", type="float")
    assert report == {"files": [tmp_path / "cube.exr"], "values_clamped": 0}
    assert (welkin.read(tmp_path / "cube.exr").pixels == faces).all()


def test_bytes_are_files(image, tmp_path):
    bytes_ = welkin.encode("sky.hdr", image)
    (tmp_path / "sky.hdr").write_bytes(bytes_)
    assert (welkin.read(bytes_).pixels == welkin.read(tmp_path / "sky.hdr").pixels).all()
    streamed = welkin.project(bytes_).radiance.coefficients
    assert (streamed == welkin.project(welkin.read(bytes_)).radiance.coefficients).all()
    light = welkin.bake(tmp_path / "sky.hdr", specular={"size": 16}, read={"layout": "lat-long"})
    assert truth.relative(light.radiance.coefficients, streamed) < 1e-12
    assert welkin.inspect(bytes_)["format"] == "Radiance"
    assert welkin.measure(bytes_)["texels"] == 64 * 32
    plan = welkin.plan(tmp_path / "sky.hdr", needs={"glossy": False})
    assert welkin.bake(tmp_path / "sky.hdr", plan=plan).specular is None


def test_textures_come_back(image, tmp_path):
    chain = welkin.prefilter(image, size=16)
    for name in ("sky.ktx2", "sky.dds"):
        welkin.write_texture(tmp_path / name, chain, format="rgba32f")
        found = welkin.read_texture(tmp_path / name)
        assert all((a == b).all() for a, b in zip(found.levels, chain.levels)) and len(found) == len(chain)
    welkin.write_texture(tmp_path / "list.ktx2", chain.levels, supercompression="zstd", metadata={"who": "me"})
    found = welkin.read_texture(tmp_path / "list.ktx2")
    assert found.metadata["who"] == "me" and "zstd" in found.format
    welkin.write_texture(tmp_path / "brdf.ktx2", welkin.brdf_table())
    whole = welkin.prefilter(image, size=16, mips=5)
    welkin.write_env(tmp_path / "sky.env", whole, welkin.project(image).radiance)
    assert welkin.inspect(tmp_path / "sky.env")["format"] == "Babylon.js .env"


def test_errors_have_codes(image, tmp_path):
    with pytest.raises(FileNotFoundError) as caught:
        welkin.read(tmp_path / "none.hdr")
    assert isinstance(caught.value, welkin.FileAccess) and caught.value.code == "file_access"
    assert caught.value.errno == 2 and "none.hdr" in str(caught.value)
    with pytest.raises(welkin.UnsupportedFile):
        welkin.read(b"nothing that is a picture")
    whole = welkin.encode("sky.pfm", image)
    with pytest.raises(welkin.CorruptFile) as caught:
        welkin.read(whole[: len(whole) // 2])
    assert caught.value.code == "corrupt_file"
    with pytest.raises(welkin.LimitExceeded):
        welkin.read(whole, memory_limit=100)
    with pytest.raises(welkin.FileAccess):
        welkin.write(tmp_path / "no" / "folder.exr", image)
    with pytest.raises(welkin.UnsupportedFile):
        welkin.write(tmp_path / "sky.bmp", image)
    with pytest.raises(TypeError, match="path or bytes"):
        welkin.read(7)


def test_every_code_of_the_librarys_has_an_exception():
    codes = welkin._welkin._error_codes
    assert len(set(codes)) == len(codes) == 10 and "rejected_pixel" in codes
    assert {kind.code for kind in welkin.Error.__subclasses__()} == set(codes)
    for code in codes:
        error = welkin._errors.error_of(code, "the reason")
        assert type(error).code == code and str(error) == "the reason"


def test_paths_with_other_letters(image, tmp_path):
    path = tmp_path / "Himmel über Köln 空.pfm"
    welkin.write(path, image)
    assert (welkin.read(path).pixels == image).all() and welkin.read(path).info["path"] == pathlib.Path(path)
