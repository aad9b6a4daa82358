"""Runs the programs on the pages of the tutorial and of the worked jobs, and compares what they print with the page.

usage: programs.py BUILD OUT [--update] [PAGE...]

A page's blocks marked sh, python and c are run in their order, in a folder of their own below OUT/runs: sh by bash with
the programs of BUILD on the path; python in one interpreter, so that a block knows the names of those before; the c blocks
of a page together are one program, compiled and run where the last of them stands. Files of examples/ that sh blocks name are
copied there. Of the guides (GUIDES) the python blocks alone run: those in C are parts of programs, or run by tests/install. A block marked text behind a block
that ran is what that printed: words must agree, numbers within 1 % (or one of the last digit shown). Pictures of the page that a
program draws (docs/images/NAME.png as NAME.png in the folder) go to OUT/pictures. With --update pages and docs/images take
what was printed and drawn.

A page whose blocks, libmps and programs are those of the last run is not run again.
"""

import contextlib
import hashlib
import io
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def library(build):
    found = sorted((build / "src").glob("libmps.so.*.*.*")) or sorted((build / "src").glob("libmps.so*"))
    if not found:
        sys.exit(f"docs: {build} has no src/libmps.so: cmake --build {build} first")
    return found[-1].resolve()


def environment(build):
    """Variables under which the programs of a page find this build."""
    path = f"{build / 'programs'}{os.pathsep}{os.environ['PATH']}"
    return {"PATH": path, "PYTHONPATH": str(build / "python"), "LIBMPS_LIBRARY": str(library(build)), "MPLBACKEND": "Agg",
            "LD_LIBRARY_PATH": str(build / "src"), "OMP_WAIT_POLICY": "passive", "PYTHONDONTWRITEBYTECODE": "1"}


GUIDES = ("bodies", "coupling", "dynamics", "elastic", "fluid", "materials", "mpm", "output", "pore-water", "signals", "waves")


class Page:
    """A page and its programs."""

    def __init__(self, name):
        self.name, self.path = name, ROOT / "docs" / f"{name}.md"
        self.text = self.path.read_text()
        self.blocks = [(m[1], m[2], m.span(2)) for m in BLOCK.finditer(self.text)]
        self.pictures = re.findall(r"\]\((?:\.\./)*images/([\w-]+\.(?:png|gif))\)", self.text)

    def examples(self):
        """Files of examples/ that its sh blocks name."""
        return [ROOT / name for name in sorted(set(re.findall(r"\bexamples/[\w.]+\w", " ".join(b[1] for b in self.blocks if b[0] == "sh"))))]

    def digest(self, build):
        """Changes with the blocks, libmps, its package and the programs that the page runs."""
        sha = hashlib.sha256(repr([b[:2] for b in self.blocks]).encode())
        sha.update(library(build).read_bytes())
        programs = sorted(set(re.findall(r"\bmps-[a-z-]+", " ".join(b[1] for b in self.blocks if b[0] in ("sh", "python")))))
        for file in [build / "programs" / p for p in programs] + sorted((build / "python/libmps").glob("*.py")) + self.examples():
            if file.is_file():
                sha.update(file.read_bytes())
        return sha.hexdigest()


def run_shell(text):
    """What the commands print, to stdout; what they report on the way goes to a file."""
    with open("progress.txt", "a") as progress:
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], stdout=subprocess.PIPE, stderr=progress, text=True)
    if done.returncode:
        raise SystemExit(f"exit status {done.returncode} of\n{text}{pathlib.Path('progress.txt').read_text()[-2000:]}")
    return done.stdout


def run_python(text, names, label):
    """What a block prints; `names` are kept from block to block. Progress and warnings go to a file."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), open("progress.txt", "a") as progress, contextlib.redirect_stderr(progress):
        exec(compile(text, label, "exec"), names)
    return printed.getvalue()


def run_c(text, build):
    """Compiles and runs the program that the blocks make together."""
    pathlib.Path("program.c").write_text(text)
    compiler = os.environ.get("CC", "cc")
    command = [compiler, "-std=c11", "-O1", "-Wall", "-Wextra", "-Werror", "program.c", "-I", ROOT / "include", "-L", build / "src", "-lmps",
               f"-Wl,-rpath,{build / 'src'}", "-lm", "-o", "program"]
    subprocess.run(command, check=True)
    return run_shell("./program")


def agree(said, printed):
    """The first line in which page and program differ, or None."""
    a, b = said.rstrip().splitlines(), printed.rstrip().splitlines()
    for k in range(max(len(a), len(b))):
        left, right = (a[k] if k < len(a) else "nothing"), (b[k] if k < len(b) else "nothing")
        if NUMBER.sub("#", left).split() != NUMBER.sub("#", right).split():
            return left, right
        for x, y in zip(NUMBER.findall(left), NUMBER.findall(right)):
            last = 10.0 ** -len(x.partition("e")[0].partition(".")[2])
            if abs(float(x) - float(y)) > max(0.01 * abs(float(x)), 1.001 * last):
                return left, right
    return None


def execute(page, build, update):
    """Runs the blocks; returns the page's text with what was printed, and complaints."""
    names = {"__name__": "__main__"}
    runs = ("python",) if page.name in GUIDES else ("python", "sh", "c")
    last_c = max((k for k, b in enumerate(page.blocks) if b[0] == "c"), default=-1)
    printed, changes, wrong = None, [], []
    for k, (kind, text, span) in enumerate(page.blocks):
        if kind not in (*runs, "text"):
            continue
        if kind == "sh":
            printed = run_shell(text)
        elif kind == "python":
            printed = run_python(text, names, f"{page.name}:{k}")
        elif kind == "c" and k == last_c:
            printed = run_c("".join(b[1] for b in page.blocks if b[0] == "c"), build)
        elif kind == "text" and printed is not None:
            differ = agree(text, printed)
            if differ and not update:
                wrong.append(f"{page.path.relative_to(ROOT)} says\n  {differ[0]}\nand its program prints\n  {differ[1]}")
            if differ:
                changes.append((span, printed.rstrip("\n") + "\n"))
            printed = None
    for span, new in reversed(changes):
        page.text = page.text[:span[0]] + new + page.text[span[1]:]
    return wrong


def run(page, build, out, update):
    """One page, unless nothing has changed since it last ran; complaints."""
    folder, digest = out / "runs" / page.name, page.digest(build)
    stamp = folder / "digest"
    if not update and stamp.exists() and stamp.read_text() == digest:
        return []
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    os.chdir(folder)
    for file in page.examples():
        pathlib.Path("examples").mkdir(exist_ok=True)
        shutil.copy(file, "examples")
    start = time.monotonic()
    wrong = execute(page, build, update)
    print(f"docs: {page.name} took {time.monotonic() - start:.0f} s", flush=True)
    drawn = [p for p in page.pictures if (folder / p).exists()]
    programs = any(kind in ("sh", "python", "c") for kind, _, _ in page.blocks)
    if programs and page.pictures and not drawn and page.name not in GUIDES:
        wrong.append(f"{page.path.relative_to(ROOT)}: its programs draw none of its pictures ({', '.join(page.pictures)})")
    for picture in drawn:
        shutil.copyfile(folder / picture, out / "pictures" / picture)
        if update:
            shutil.copyfile(folder / picture, ROOT / "docs/images" / picture)
    if update:
        page.path.write_text(page.text)
        page = Page(page.name)
    if not wrong:
        stamp.write_text(page.digest(build))
    return wrong


def main():
    words = [word for word in sys.argv[1:] if word != "--update"]
    build, out = pathlib.Path(words[0]).resolve(), pathlib.Path(words[1]).resolve()
    pages = words[2:] or ["extend", "gallery", "how", *GUIDES] + [p.relative_to(ROOT / "docs").with_suffix("").as_posix()
                          for folder in ("tutorial", "jobs") for p in sorted((ROOT / "docs" / folder).glob("*.md"))]
    variables = environment(build)
    os.environ.update(variables)
    sys.path.insert(0, variables["PYTHONPATH"])
    (out / "pictures").mkdir(parents=True, exist_ok=True)
    wrong = [line for name in pages for line in run(Page(name), build, out, "--update" in sys.argv)]
    print("".join(f"docs: {line}\n" for line in wrong), end="")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
