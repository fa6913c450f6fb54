"""`python -m welkin ARGUMENT...`: the welkin command, which wheels bring along; else the one on the path."""
import os
import pathlib
import shutil
import subprocess
import sys


def program():
    """The path of the command, or None."""
    name = "welkin.exe" if os.name == "nt" else "welkin"
    brought = pathlib.Path(__file__).parent / "bin" / name
    return str(brought) if brought.exists() else shutil.which(name)


def main():
    command = program()
    if command is None:
        sys.exit("welkin: this package was built without the command, and there is none on the path")
    if os.name == "nt":  # where exec returns to the shell at once
        sys.exit(subprocess.run([command, *sys.argv[1:]], check=False).returncode)
    os.execv(command, [command, *sys.argv[1:]])


if __name__ == "__main__":
    main()
