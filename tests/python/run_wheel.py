"""run_wheel.py SOURCE WORK [aarch64]: makes a source archive of the package, and a wheel from it (scripts/wheel --fast --sdist),
installs that into a bare virtual environment, asks all programs for their help, and runs a small job there: a block on a
roller under its own weight, whose mean vertical stress is -density * g * height / 2. With `aarch64` the wheel is for 64-bit
ARM, and the programs and the job run emulated, with Python and NumPy of the root that it was built against. Exit status 77,
with a line, where pip reaches no registry or that root cannot be had."""

import os
import pathlib
import shutil
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
elastic.add_load(kind="pressure", ids=elastic.select_facets("x_upper"), force=[-1e4])
elastic.solve()
along = [beam["displacement"][beam.index(beam.nearest([x, 0.15])), 0] for x in (0.45, 0.95)]
print(f"strain {(along[1] - along[0]) / 0.5:.3e}, theory {1e4 / 1e7:.3e}")
assert abs((along[1] - along[0]) / 0.5 / 1e-3 - 1) < 0.01
solver.save("job.h5")
from libmps import files, theory
assert files.read_summary("wave")["outcome"] == "finished" and theory.prandtl() > 5
"""


def call(*command, **keywords):
    return subprocess.run([str(c) for c in command], **keywords)


SYSTEM = ("libc.so", "libm.so", "libpthread", "libdl", "librt", "libgcc_s", "libstdc++", "libresolv", "libz.so", "libexpat", "ld-linux",
          "libutil")
WAVE = ["--width", 4, "--height", 10, "--duration", 0.1, "--frames", 1]


def call(*command, **keywords):
    return subprocess.run([str(c) for c in command], **keywords)


def make(source, work, arch):
    """The wheel; ends where pip reaches no registry."""
    reached = call(sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--retries", 0, "--timeout", 20, "-d",
                   work / "reached", "wheel", capture_output=True, text=True)
    if reached.returncode:
        print("skipped: pip reaches no registry:", (reached.stderr.strip().splitlines() or ["no pip"])[-1])
        sys.exit(77)
    which = ["--arch", arch] if arch else ["--sdist"]
    done = call(sys.executable, source / "scripts/wheel", "--fast", *which, "--address", "https://example.org/libmps/", "--out", work,
                stdout=subprocess.PIPE, text=True)
    if done.returncode:
        sys.exit(done.returncode)
    return done.stdout.split()[-1]


def look(made, arch):
    """What is in the wheel, and what it says of itself."""
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
    if "-py3-none-manylinux" not in made or not made.endswith(f"_{arch or os.uname().machine}.whl"):
        sys.exit(f"{made} is no manylinux wheel for all versions of Python")


def binaries_of(package):
    binaries = [*package.glob("libmps.so.*"), *package.glob("libmps-*/*.so")]
    if len(binaries) < 3:
        sys.exit(f"the modules for HDF5 and meshes are missing: {binaries}")
    return binaries


def alone(loaded, inside):
    """Refuses a list of loaded libraries (ldd) with one outside the folder `inside` that not every system has."""
    strangers = {line.split()[0] for line in loaded.splitlines() if ("=> /" in line or "not found" in line) and inside not in line}
    strangers = sorted(name for name in strangers if not name.startswith(SYSTEM))
    if strangers:
        sys.exit(f"the installed library needs {strangers} of the system")


def help_of(programs, *before):
    for program in programs:
        given = call(*before, program, "--help", capture_output=True, text=True, env={"PATH": "/usr/bin:/bin"})
        if given.returncode or program.name not in given.stdout:
            sys.exit(f"{program.name} --help: {given.returncode}\n{given.stderr}")


def installed(made, work):
    """The wheel of this machine in a bare virtual environment."""
    bare = work / "bare"
    venv.create(bare, with_pip=True, clear=True)
    call(bare / "bin/python", "-m", "pip", "install", "-q", made, check=True)
    package = next(bare.glob("lib/python3*/site-packages/libmps"))
    alone("".join(call("ldd", binary, capture_output=True, text=True).stdout for binary in binaries_of(package)), "site-packages")
    programs = sorted(path.name for path in package.glob("bin/mps-*"))
    scripts = sorted((bare / "bin").glob("mps-*"))
    if programs != [script.name for script in scripts] or len(programs) < 15:
        sys.exit(f"the programs are {programs}, and those that can be called {scripts}")
    help_of(scripts)
    call(bare / "bin/mps-wave", *WAVE, "--out", work / "wave", check=True, stdout=subprocess.DEVNULL)
    return call(bare / "bin/python", "-c", JOB, cwd=work, env={"PATH": "/usr/bin:/bin", "HOME": str(work)}).returncode


def emulated(made, root, work):
    """The wheel for ARM, unpacked, by qemu-user on the libraries of that system."""
    if not shutil.which("qemu-aarch64"):
        print("skipped: qemu-aarch64 is not there (Debian: qemu-user)")
        return 77
    shutil.rmtree(work / "unpacked", ignore_errors=True)
    zipfile.ZipFile(made).extractall(work / "unpacked")
    package = work / "unpacked/libmps"
    programs = sorted((package / "bin").glob("mps-*"))
    for path in (*programs, *binaries_of(package)):
        path.chmod(0o755)
    emulator = ["qemu-aarch64", "-L", root]
    traced = [*emulator, "-E", "LD_TRACE_LOADED_OBJECTS=1"]
    loader = root / "lib/ld-linux-aarch64.so.1"
    loaded = [call(*traced, *([] if binary in programs else [loader]), binary, capture_output=True, text=True).stdout
              for binary in (*programs, *binaries_of(package))]
    if not all("libmps.libs" in text for text in loaded[len(programs):]):
        sys.exit(f"the libraries inside are not found:\n{loaded[-1]}")
    alone("".join(loaded), "unpacked")
    help_of(programs, *emulator)
    call(*emulator, package / "bin/mps-wave", *WAVE, "--out", work / "wave", check=True, stdout=subprocess.DEVNULL)
    return call(*emulator, root / "usr/bin/python3", "-c", JOB, cwd=work, env={
        "PATH": "/usr/bin:/bin", "HOME": str(work), "PYTHONPATH": f"{work}/unpacked:{root}/usr/lib/python3/dist-packages"}).returncode


def main():
    source, work, arch = *(pathlib.Path(word).resolve() for word in sys.argv[1:3]), "".join(sys.argv[3:])
    work.mkdir(parents=True, exist_ok=True)
    made = make(source, work, arch)
    look(made, arch)
    sys.exit(emulated(made, source / "build/arm64-root", work) if arch else installed(made, work))


main()
