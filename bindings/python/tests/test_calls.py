"""What happens while a call runs: other threads, progress, Ctrl-C."""
import inspect
import os
import signal
import threading
import time

import numpy as np
import pytest

import welkin

LONG = {"size": 16, "method": "reference"}  # minutes, if nobody stops it


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


def test_other_threads_run_meanwhile(large):
    done = threading.Event()
    counts = []

    def count():
        number = 0
        while not done.is_set():
            number += 1
            time.sleep(0.001)
        counts.append(number)

    other = threading.Thread(target=count)
    other.start()
    start = time.monotonic()
    welkin.bake(large, specular={"size": 256})
    took = time.monotonic() - start
    done.set()
    other.join()
    assert counts[0] > 0.1 * took / 0.001


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


def test_everything_has_a_docstring_and_a_signature():
    for name in welkin.__all__:
        each = getattr(welkin, name)
        assert each.__doc__, name
        if inspect.isbuiltin(each):
            assert inspect.signature(each) is not None, name
