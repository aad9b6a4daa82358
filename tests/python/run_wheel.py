"""run_wheel.py SOURCE WORK: makes a source archive of the package, and a wheel from it (scripts/wheel --fast --sdist), installs
that into a bare virtual environment, asks all programs for their help, and runs a small job there: a block on a roller under its own weight, whose mean vertical stress is
-density * g * height / 2. Exit status 77, with a line, where pip reaches no registry."""

import pathlib
import subprocess
import sys
import venv
import zipfile

JOB = r"""
import sys
import libmps as mps

assert "dist-packages/libmps" not in mps.__file__, mps.__file__
assert mps.__version__ == mps.version(), (mps.__version__, mps.version())
height, density, g = 2.0, 1800.0, 9.81
mps.default_context(threads=1)
sand = mps.Particles(spacing=0.1)
sand.fill_box([0, 0], [1, height])
sand["density"] = density
sand.add_field("stress", 0)
law = mps.LinearElastic(1e7, 0.0)
solver = mps.Mpm(sand, law, cell=0.2, lower=[0, 0, 0], upper=[1, 4, 0], gravity=[0, -g, 0],
                            local_damping=0.7)
solver.run(0.5)
mean, theory = sand["stress"][:, 1].mean(), -density * g * height / 2
print(f"{sys.version.split()[0]}: mean stress {mean:.1f} Pa, theory {theory:.1f}")
assert abs(mean / theory - 1) < 0.01
beam = mps.Particles(spacing=0.1)  # CHOLMOD and HDF5 are in the wheel too
beam.fill_box([0, 0], [1, 0.3])
beam["young"] = 1e7
beam["poisson"] = 0.0
elastic = mps.Elastic(beam)
elastic.add_boundary(box=([0, 0], [0.1, 0.3]), kind="held")
solver.save("job.h5")
from libmps import files, theory
assert files.read_summary("wave")["outcome"] == "finished" and theory.prandtl() > 5
"""


def call(*command, **keywords):
    return subprocess.run([str(c) for c in command], **keywords)


def main():
    source, work = map(pathlib.Path, sys.argv[1:3])
    work.mkdir(parents=True, exist_ok=True)
    reached = call(sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--retries", 0, "--timeout", 20, "-d",
                   work / "reached", "wheel", capture_output=True, text=True)
    if reached.returncode:
        print("skipped: pip reaches no registry:", (reached.stderr.strip().splitlines() or ["no pip"])[-1])
        sys.exit(77)
    made = call(sys.executable, source / "scripts/wheel", "--fast", "--sdist", "--address", "https://example.org/libmps/", "--out", work, stdout=subprocess.PIPE, text=True,
                check=True).stdout.split()[-1]
    wheel = zipfile.ZipFile(made)
    names = wheel.namelist()
    metadata = wheel.read(next(name for name in names if name.endswith(".dist-info/METADATA"))).decode()
    if "https://example.org/libmps/issues" not in metadata or ".invalid" in metadata:
        sys.exit(f"{made}: the address of the project is not in place:\n{metadata[:2000]}")
    for wanted in ("libmps/py.typed", "libmps/__init__.pyi", "licenses/LIBRARIES.md", "licenses/LICENSE", "libmps/theory.py",
                   "libmps/share/libmps/models/caisson.yaml",
                   "libmps/share/libmps/plots/style.gp", "libmps/share/libmps/paraview_libmps.py"):
        if not any(name.endswith(wanted) for name in names):
            sys.exit(f"{made} lacks {wanted}")
    if "-py3-none-manylinux" not in made:
        sys.exit(f"{made} is no manylinux wheel for all versions of Python")
    bare = work / "bare"
    venv.create(bare, with_pip=True, clear=True)
    call(bare / "bin/python", "-m", "pip", "install", "-q", made, check=True)
    package = next(bare.glob("lib/python3*/site-packages/libmps"))
    binaries = [*package.glob("libmps.so.*"), *package.glob("libmps-*/*.so")]
    if len(binaries) < 2:
        sys.exit(f"the modules for HDF5 and meshes are missing: {binaries}")
    inside = "".join(call("ldd", binary, capture_output=True, text=True).stdout for binary in binaries)
    outside = [line.split()[0] for line in inside.splitlines() if ("=> /" in line or "not found" in line) and "site-packages" not in line]
    system = ("libc.so", "libm.so", "libpthread", "libdl", "librt", "libgcc_s", "libstdc++", "libresolv", "libz.so",
              "libexpat", "ld-linux", "libutil")
    strangers = [name for name in outside if not name.startswith(system)]
    if strangers:
        sys.exit(f"the installed library needs {strangers} of the system")
    programs = sorted(path.name for path in bare.glob("lib/python3*/site-packages/libmps/bin/mps-*"))
    scripts = sorted(path.name for path in (bare / "bin").glob("mps-*"))
    if programs != scripts or len(programs) < 15:
        sys.exit(f"the programs are {programs}, and those that can be called {scripts}")
    for name in scripts:
        told = call(bare / "bin" / name, "--help", capture_output=True, text=True, env={"PATH": "/usr/bin:/bin"})
        if told.returncode or name not in told.stdout:
            sys.exit(f"{name} --help: {told.returncode}\n{told.stderr}")
    call(bare / "bin/mps-wave", "--width", 4, "--height", 10, "--duration", 0.1, "--frames", 0, "--out", work / "wave", check=True,
         stdout=subprocess.DEVNULL)
    done = call(bare / "bin/python", "-c", JOB, cwd=work, env={"PATH": "/usr/bin:/bin", "HOME": str(work)})
    sys.exit(done.returncode)


main()
