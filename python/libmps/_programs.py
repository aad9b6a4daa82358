"""The programs mps-... of a wheel: executables in the package, one of which takes the place of this process."""

import os
import sys
from pathlib import Path


def main():
    name = Path(sys.argv[0]).name
    program = Path(__file__).resolve().parent / "bin" / name
    if not program.exists():
        sys.exit(f"{name}: the programs come with a wheel of libmps, or by cmake --install; {program} is not there")
    os.execv(program, [str(program), *sys.argv[1:]])
