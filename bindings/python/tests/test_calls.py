"""What happens while a call runs: other threads, progress, Ctrl-C."""
import inspect
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import welkin

LONG = {"size": 16, "method": "reference"}  # minutes, unless stopped


@pytest.fixture(scope="module")
def large():
    return np.random.default_rng(1).random((512, 1024, 3), dtype=np.float32)


def test_ctrl_c_stops_a_call(large):
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        welkin.prefilter(large, **LONG)
    assert time.monotonic() - start < 5
    assert welkin.project(large).radiance.bands == 3  # and nothing is left of it


@pytest.mark.parametrize("call", ["prefilter(pixels, size=16, method='reference')",
                                  "prefilter(pixels, size=16, method='reference', threads=1)",
                                  "bake(pixels, specular=dict(size=16, method='reference'), progress=True)",
                                  "sky(heights=32, view_zeniths=128, sun_zeniths=128, orders=50)"])  # fmt: skip
def test_ctrl_c_ends_a_program_as_it_ends_pythons(call):
    program = ("import numpy, signal, welkin; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
               f"pixels = numpy.ones((512, 1024, 3), numpy.float32); print('begun', flush=True); welkin.{call}")  # fmt: skip
    child = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert child.stdout.readline() == "begun\n"
        time.sleep(0.5)
        assert child.poll() is None, child.communicate()
        child.send_signal(signal.SIGINT)
        start = time.monotonic()
        _, said = child.communicate(timeout=20)
        assert child.returncode == -signal.SIGINT and "KeyboardInterrupt" in said, said
        assert time.monotonic() - start < 5
    finally:
        child.kill()
        child.wait()


def test_a_handler_of_the_callers_goes_first(large):
    class Stop(Exception):
        pass

    def handler(number, frame):
        raise Stop

    before = signal.signal(signal.SIGUSR1, handler)
    try:
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGUSR1)).start()
        with pytest.raises(Stop):
            welkin.bake(large, specular=LONG)
    finally:
        signal.signal(signal.SIGUSR1, before)


def during(call, seconds=0.15):
    """Times at which another thread ran while `call` did, as shares of its time; calls that are over soon again."""
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    other = threading.Thread(target=tick)
    other.start()
    spans = []
    begun = time.monotonic()
    while not spans or time.monotonic() - begun < seconds:
        start = time.monotonic()
        call()
        spans.append((start, time.monotonic()))
    done.set()
    other.join()
    # The longest call alone: between calls any thread may run.
    start, end = max(spans, key=lambda span: span[1] - span[0])
    return [(tick - start) / (end - start) for tick in ticks if start < tick < end]


@pytest.fixture(scope="module")
def work(large):
    sky = welkin.sky(heights=8, view_zeniths=32, sun_zeniths=32, orders=2)
    file = welkin.encode("sky.exr", large)
    small = large[::8, :256].copy()
    table = welkin.importance_table(large)
    across, down = np.random.default_rng(3).random((2, 300_000))
    directions = table.sample(across, down)[0]
    probes = np.ones((40, 6, 64, 64, 3), np.float32)
    return {
        "project": lambda: welkin.project(np.ones((2048, 4096, 3), np.float16), bands=16),
        "prefilter": lambda: welkin.prefilter(large, size=256),
        "bake": lambda: welkin.bake(large, specular={"size": 256}),
        "direct_irradiance": lambda: welkin.direct_irradiance(small, [(0, 1, 0)] * 4000),
        "reference_specular": lambda: welkin.reference_specular(small, 0.5, [(0, 1, 0)] * 60),
        "brdf_table": lambda: welkin.brdf_table(width=4096, height=64),
        "sky": lambda: welkin.sky(heights=8, view_zeniths=32, sun_zeniths=32, orders=2),
        "curve": lambda: sky.curve(),
        "sky picture": lambda: sky.lat_long((0, 0.5, 1), 512),
        "sky radiance": lambda: sky.radiance(directions, (0, 0.5, 1)),
        "encode": lambda: welkin.encode("sky.exr", large),
        "read": lambda: welkin.read(file),
        "measure": lambda: welkin.measure(file),
        "to_cubemap": lambda: welkin.to_cubemap(large, 1024),
        "to_octahedral": lambda: welkin.to_octahedral(welkin.project(small, bands=8).radiance, size=1024),
        "sample": lambda: table.sample(across, down),
        "density": lambda: table.density(directions),
        "alias": lambda: table.alias(),
        "bake_many": lambda: welkin.bake_many(probes, size=64),
        "preview": lambda: welkin.preview(large, 1024),
        "harmonics": lambda: welkin.SphericalHarmonics(16)(directions[:100_000]),
        "basis": lambda: welkin.basis(directions[:100_000], 16),
    }


@pytest.mark.parametrize("name", [
    "project", "prefilter", "bake", "direct_irradiance", "reference_specular", "brdf_table", "sky", "curve",
    "sky picture", "sky radiance", "encode", "read", "measure", "to_cubemap", "to_octahedral", "sample", "density",
    "alias", "bake_many", "preview", "harmonics", "basis",
])  # fmt: skip
def test_other_threads_run_meanwhile(work, name):
    # A busy machine may give the other thread no processor during a call; a call that holds the lock never lets it run.
    for _ in range(50):
        ticks = during(work[name])
        if sum(0.2 < tick < 0.8 for tick in ticks) >= 2:
            return
    pytest.fail(f"no other thread ran during 50 calls; the last one's ticks: {ticks}")


def test_calls_run_side_by_side(large):
    expected = welkin.project(large).radiance.coefficients
    found = [None] * 8

    def work(index):
        found[index] = welkin.project(large).radiance.coefficients

    threads = [threading.Thread(target=work, args=(index,)) for index in range(len(found))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all((each == expected).all() for each in found)


def test_progress_rises_to_one_in_the_callers_thread(large):
    shares, threads = [], set()

    def follow(share):
        shares.append(share)
        threads.add(threading.get_ident())

    welkin.prefilter(large, size=4, method="reference", mips=1, roughness=[0.5], progress=follow)
    assert shares[-1] == 1 and shares == sorted(shares) and len(shares) > 1
    assert threads == {threading.get_ident()}


def test_what_progress_raises_ends_the_call(large):
    class Enough(Exception):
        pass

    def follow(share):
        raise Enough

    start = time.monotonic()
    with pytest.raises(Enough):
        welkin.prefilter(large, progress=follow, **LONG)
    assert time.monotonic() - start < 5


def test_a_bar_is_shown(large, capfd):
    pytest.importorskip("tqdm")
    welkin.bake(large, specular={"size": 64}, progress=True)
    assert "bake: 100%" in capfd.readouterr().err
    with pytest.raises(TypeError, match="progress"):
        welkin.project(large, progress="yes")


def test_without_tqdm_there_is_no_bar(large, monkeypatch, capfd):
    for name in ("tqdm", "tqdm.auto"):
        monkeypatch.setitem(sys.modules, name, None)
    welkin.bake(large, specular={"size": 64}, progress=True)
    assert capfd.readouterr().err == ""


def test_everything_has_a_docstring_and_a_signature():
    for name in welkin.__all__:
        each = getattr(welkin, name)
        assert each.__doc__, name
        if inspect.isbuiltin(each):
            assert inspect.signature(each) is not None, name
