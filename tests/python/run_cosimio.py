"""run_cosimio.py PROGRAM: examples/cosimio.py as two processes, by CoSimIO where python3 finds it, else by the
stand-in in this folder: the frequency is that of potential flow to 1 %. SPDX-License-Identifier: BSD-3-Clause"""
import importlib.util
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

program = Path(sys.argv[1]).resolve()
path = os.environ.get("PYTHONPATH", "")
real = importlib.util.find_spec("CoSimIO") is not None
if not real:
    path = f"{Path(__file__).resolve().parent / 'stand_in'}:{path}"
with tempfile.TemporaryDirectory() as work:
    sides = [
        subprocess.Popen([sys.executable, program, role], cwd=work, env={**os.environ, "PYTHONPATH": path},
                         stdout=subprocess.PIPE, text=True)
        for role in ("water", "wall")
    ]
    try:
        said = "".join(side.communicate(timeout=100)[0] for side in sides)
    finally:
        for side in sides:
            side.kill()
print("CoSimIO" if real else "stand-in of CoSimIO", said, sep="\n")
omega = float(re.search(r"omega ([0-9.]+) rad/s", said)[1])
assert all(side.returncode == 0 for side in sides), [side.returncode for side in sides]
assert abs(omega / 60.37 - 1.0) < 0.01, omega
wrong = subprocess.run([sys.executable, program, "air"], capture_output=True, text=True,
                       env={**os.environ, "PYTHONPATH": path})
assert wrong.returncode == 1 and "usage" in wrong.stderr, wrong
