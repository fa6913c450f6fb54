"""Objects of the package as Python's own: made once, compared, added, indexed, pickled; and messages that help."""
import copy
import inspect
import pickle
import subprocess
import sys

import numpy as np
import pytest

import welkin

CLASSES = [each for _, each in inspect.getmembers(welkin, inspect.isclass) if not issubclass(each, Exception)]


# In a process of its own: such an object once ended the interpreter.
@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.__name__)
def test_an_object_that_was_never_initialised_is_refused(kind):
    names = [name for name, each in vars(kind).items() if isinstance(each, property)]
    program = (
        f"import welkin; kind = welkin.{kind.__name__}; made = kind.__new__(kind)\n"
        f"for look in [*(lambda name=name: getattr(made, name) for name in {names!r}), lambda: repr(made)]:\n"
        "    try: look()\n"
        "    except TypeError as error: assert 'never initialized' in str(error), error\n"
        "    else: raise SystemExit('accepted')\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, (done.returncode, done.stderr)


def test_a_subinterpreter_is_refused():  # it would wait forever
    program = (
        "try: import _interpreters as them\n"
        "except ImportError: import _xxsubinterpreters as them\n"
        "them.run_string(them.create(), 'try: import welkin\\nexcept ImportError as error: print(error)')"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert "main interpreter alone" in done.stdout, (done.returncode, done.stdout, done.stderr)


def test_an_object_that_was_never_initialised_is_no_argument():
    light = welkin.SphericalHarmonics(3)
    unmade = welkin.SphericalHarmonics.__new__(welkin.SphericalHarmonics)
    for use in (lambda: light.product(unmade), lambda: light + unmade, lambda: welkin.engine_light(unmade, "unity")):
        with pytest.raises(TypeError, match="never initialized"):
            use()
    with pytest.raises(welkin.InvalidArgument):
        unmade.__init__(17)
    with pytest.raises(TypeError, match="never initialized"):
        unmade.bands


def test_an_object_is_initialised_once():
    light = welkin.SphericalHarmonics(3)
    with pytest.raises(TypeError, match="SphericalHarmonics: the object is initialized already"):
        light.__init__(2)
    assert light.bands == 3
    with pytest.raises(TypeError, match="PixelPolicy: the object is initialized already"):
        welkin.PixelPolicy().__init__(clamp=3)
    assert not hasattr(light, "__setstate__")
    for other in (5, "text", object(), welkin.PixelPolicy()):
        with pytest.raises(TypeError, match="SphericalHarmonics.__init__ takes an object of that class"):
            welkin.SphericalHarmonics.__init__(other, 3)


def test_harmonics_are_pickled_and_copied(image):
    class Named(welkin.SphericalHarmonics):
        pass

    light = welkin.project(image).radiance
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(light, protocol)) == light
    assert copy.copy(light) == light and copy.deepcopy([light]) == [light]
    assert light.__reduce__()[0] is welkin.SphericalHarmonics and Named(2).__reduce__()[0] is Named


def test_harmonics_compare_divide_and_add_up(image):
    light = welkin.project(image).radiance
    assert light == copy.copy(light) and light != 2 * light and light != light.resized(2) and light != 3
    with pytest.raises(TypeError, match="unhashable"):
        hash(light)  # their coefficients may be written to
    assert -light == light * -1
    assert ((light / 3).coefficients == light.coefficients / 3).all()
    assert ((light / (1, 2, 3)).coefficients == light.coefficients / (1, 2, 3)).all()
    assert sum([light, light, light]) == light + light + light
    for wrong in (lambda: 1 + light, lambda: light + 1, lambda: light / "a"):
        with pytest.raises((TypeError, welkin.InvalidArgument)):
            wrong()


def test_harmonics_are_a_sequence_of_coefficients(image):
    light = welkin.project(image).radiance
    assert len(light) == 9
    assert (light[3] == light.coefficients[3]).all() and (light[-1] == light.coefficients[8]).all()
    assert light[1:4].shape == (3, 3) and len(list(light)) == 9
    light[0][:] = 7
    assert (light.coefficients[0] == 7).all()
    with pytest.raises(IndexError):
        light[9]


def test_directions_of_any_length_are_normalised_everywhere(image, small_sky):
    light = welkin.project(image).radiance
    table = welkin.importance_table(image)
    calls = {
        "light": light,
        "basis": welkin.basis,
        "direct_irradiance": lambda d: welkin.direct_irradiance(image, d),
        "reference_specular": lambda d: welkin.reference_specular(image, 0.5, d),
        "density": table.density,
        "octahedral_encode": welkin.octahedral_encode,
        "radiance": lambda d: small_sky.radiance(d, (0, 1, 0)),
        "sun": lambda d: small_sky.irradiance(d),
    }
    for name, call in calls.items():
        np.testing.assert_allclose(call((0, 2.5, 0)), call((0, 1, 0)), rtol=1e-6, err_msg=name)
        for wrong in ((0, 0, 0), (0, np.nan, 1), (1, 0, np.inf)):
            with pytest.raises(welkin.InvalidArgument, match="finite and not zero"):
                call(wrong)


def test_chains_have_slices(faces):
    chain = welkin.build_mips(faces)
    assert [each.shape for each in chain[1:3]] == [(6, 8, 8, 3), (6, 4, 4, 3)]
    assert [len(each[0]) for each in chain[::-2]] == [1, 4, 16]
    assert np.shares_memory(chain[np.int64(-1)], chain.levels[-1])
    with pytest.raises(IndexError, match="level 5 of a chain of 5 levels"):
        chain[5]
    with pytest.raises(TypeError, match="numbers or slices, found 'a'"):
        chain["a"]


def test_messages_say_what_would_do(image):
    with pytest.raises(TypeError, match=r'bake\(specular={...}\) takes no "sise" \(did you mean "size"\?\); it takes '):
        welkin.bake(image, specular={"sise": 64})
    with pytest.raises(TypeError, match=r'bake\(specular={"size": ...}\) takes a whole number, found \'256\''):
        welkin.bake(image, specular={"size": "256"})
    with pytest.raises(TypeError, match=r"bake\(brdf=...\) takes True, False or a dictionary of options, found 3"):
        welkin.bake(image, brdf=3)
    with pytest.raises(TypeError, match=r'prefilter\(\) takes no argument "ruoghness" \(did you mean "roughness"\?\)'):
        welkin.prefilter(image, ruoghness=0.5)
    with pytest.raises(welkin.InvalidArgument, match=r'"spectrall" is none of .* \(did you mean "spectral"\?\)'):
        welkin.prefilter(image, method="spectrall")
    with pytest.raises(welkin.InvalidArgument, match=r"found a Projection; pass its \.radiance"):
        welkin.engine_light(welkin.project(image), "unity")
    with pytest.raises(TypeError, match=r"directions of shape \(..., 3\), as in light\(\(0, 1, 0\)\); found 3"):
        welkin.SphericalHarmonics(3)(0, 1, 0)
    light = welkin.SphericalHarmonics(3)
    assert welkin.engine_light(light, "Unity").engine == welkin.engine_light(light, "unity").engine == "unity"
    with pytest.raises(welkin.InvalidArgument, match=r'engine: "unitty" is none of .* \(did you mean "unity"\?\)'):
        welkin.engine_light(light, "unitty")


def test_files_stand_wherever_pixels_do(image, faces, tmp_path):
    path = tmp_path / "sky.pfm"
    welkin.write(path, image)
    cube = tmp_path / "cube.pfm"
    welkin.write(cube, faces, "vertical-strip")
    file = path.read_bytes()
    table = welkin.importance_table(image)
    calls = {
        "prefilter": lambda pixels: welkin.prefilter(pixels, size=8)[1],
        "irradiance": lambda pixels: welkin.irradiance(pixels).harmonics.coefficients,
        "direct_irradiance": lambda pixels: welkin.direct_irradiance(pixels, (0, 1, 0)),
        "reference_specular": lambda pixels: welkin.reference_specular(pixels, 0.5, (0, 1, 0)),
        "importance_table": lambda pixels: welkin.importance_table(pixels).function,
        "variance": lambda pixels: table.variance(pixels),
        "to_cubemap": lambda pixels: welkin.to_cubemap(pixels, 4),
        "to_lat_long": lambda pixels: welkin.to_lat_long(pixels, 4),
        "tone_mapped": lambda pixels: welkin.tone_mapped(pixels, 4),
        "preview": lambda pixels: np.frombuffer(welkin.preview(pixels, 4), np.uint8),
        "encode": lambda pixels: np.frombuffer(welkin.encode("sky.pfm", pixels), np.uint8),
        "project": lambda pixels: welkin.project(pixels).radiance.coefficients,
    }
    for name, call in calls.items():
        for pixels in (path, str(path), file):
            np.testing.assert_array_equal(call(pixels), call(image), err_msg=name)
    np.testing.assert_array_equal(welkin.build_mips(cube)[0], faces)
    np.testing.assert_array_equal(
        welkin.project_many([cube, faces]).coefficients, welkin.project_many([faces, faces]).coefficients
    )
    with pytest.raises(TypeError, match="list of cubemaps"):
        welkin.project_many(str(cube))
    with pytest.raises(welkin.FileNotFound):
        welkin.prefilter(tmp_path / "no.hdr")
    with pytest.raises(welkin.Error):
        welkin.prefilter(path, read={"layout": "vertical-cross"})
    with pytest.raises(TypeError, match='takes no argument "layout"'):
        welkin.prefilter(path, layout="lat-long")
