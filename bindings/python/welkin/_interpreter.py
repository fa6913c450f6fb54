"""Refuses to be imported in a subinterpreter: pybind11 2.10 asks there for the main one's lock, and waits forever."""
from importlib import import_module

for _name in ("_interpreters", "_xxsubinterpreters"):  # the former from Python 3.13 on
    try:
        _interpreters = import_module(_name)
    except ImportError:
        continue
    if _interpreters.get_current() != _interpreters.get_main():
        raise ImportError("welkin works in Python's main interpreter alone, and not in subinterpreters")
    break
