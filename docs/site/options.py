"""Pages of the programs, one each: what --help says as an entry an option, the examples of the manual page, and the
program's part of the gallery. --help, manual pages and completion all come from the table of options of the program."""

import os
import pathlib
import re
import subprocess

RANGE = re.compile(r"\s*\(((?:in [\[(]|default ).*)\)$")


class Option:
    """One row: its name, the value that it takes, what it means, and range and default."""

    def __init__(self, name, value):
        self.name, self.value, self.help, self.range = name, value, "", ""

    def finish(self):
        found = RANGE.search(self.help)
        if found:
            self.help, self.range = self.help[:found.start()], found[1]
        return self


def rows_of(lines):
    """The options in lines of --help: a name, a value, and the help behind two spaces or on the next lines."""
    rows = []
    for line in lines:
        start = re.match(r"  (--[\w-]+)(?: (\S.*?))?(?:\s{2,}(\S.*))?$", line)
        if start:
            rows.append(Option(start[1], start[2] or ""))
        rows[-1].help = f"{rows[-1].help} {(start[3] or '') if start else line.strip()}".strip()
    return [row.finish() for row in rows]


def parse(text):
    """--help as (usage, what the program is, [(heading, [Option])], what it says besides)."""
    blocks = [block.splitlines() for block in re.split(r"\n\s*\n", text.strip())]
    sections, notes = [], []
    for lines in blocks[1:]:
        heading = "Options" if lines[0].startswith("  --") else lines.pop(0).strip() if lines[1:] and lines[1].startswith("  --") else ""
        if heading:
            sections.append((heading, rows_of(lines)))
        else:
            notes.append(" ".join(line.strip() for line in lines))
    return blocks[0][0].removeprefix("Usage: "), " ".join(line.strip() for line in blocks[0][1:]), sections, " ".join(notes)


def run_help(build, name):
    """What --help of a program prints, or None where the build has no such program."""
    for path in (build / "programs" / name, build / "tests/programs" / f"{name}-mock"):
        if path.is_file() and os.access(path, os.X_OK):
            done = subprocess.run([path, "--help"], capture_output=True, text=True, check=True)
            return done.stdout.replace(f"{name}-mock", name)
    return None


def examples(root, name):
    """(what, command) of the manual page."""
    text = (root / "programs/manual" / f"{name}.h2m").read_text().partition("[EXAMPLES]")[2].partition("\n[")[0]
    found = []
    for said, commands in re.findall(r"^\.TP\n(.*?)\n((?:^\.(?:nh|hy|B|BR|I) ?.*\n?)+)", text, re.M):
        command = "\n".join(line.removeprefix(".B ").replace("\\-", "-").replace("\\e", "\\") for line in commands.splitlines() if line.startswith(".B "))
        found.append((said.rstrip(":").replace("\\-", "-"), command))
    return found


def gallery(root, name):
    """The program's part of the gallery, with links from a folder beside it."""
    text = (root / "docs/gallery.md").read_text()
    found = re.search(rf"^## {name}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    part = found[1].strip() if found else ""
    return re.sub(r"\]\((?!https?:|#)([^)]+)\)", r"](../\1)", part)


def plain(text):
    """Text of --help for Markdown: names of options as code, no emphasis by accident."""
    text = re.sub(r"([\\`*_\[\]<>$|])", r"\\\1", text)
    return re.sub(r"(?<![\w-])(--[a-z][\w-]*)", r"`\1`", text)


def first_sentence(text):
    return re.match(r".*?(?:\.(?=\s|$)|$)", text)[0].rstrip(".")


def page(root, name, text):
    """The page of a program, as Markdown."""
    usage, what, sections, notes = parse(text)
    lines = [f"# {name}", "", plain(what), "", "## Picture and command", "", gallery(root, name), "", "## Examples", ""]
    for said, command in examples(root, name):
        lines += [plain(said) + ":", "", "```console", *(f"$ {line}" for line in command.splitlines()), "```", ""]
    lines += ["## Options", "", f"`{usage}`. {plain(notes)}", "", f"```{{program}} {name}", "```", ""]
    for heading, rows in sections:
        lines += [f"### {heading}", ""]
        for row in rows:
            lines += [f"````{{option}} {row.name} {row.value}".rstrip(), "", plain(row.help) + ("." if not row.help.endswith((".", ";")) else ""), ""]
            lines += [f"{plain(row.range[:1].upper() + row.range[1:])}.", ""] if row.range else []
            lines += ["````", ""]
    lines += ["Files and exit statuses are those of [all programs](index.md).", ""]
    return "\n".join(lines)


INDEX = """# Programs and their options

Each program has a page with its picture, the command that drew it, examples and every option with unit, range and default.
The same is shown by `--help` and by the manual pages, and the shells bash and zsh complete it: all are made from one table a
program. A number has the unit shown, or one of its own: `10MPa`, `5mm/s`, `18kN/m3`, `0.5g`, `30deg`.

{table}

## Files

All results are written below the directory of `--out`.

| file | what |
|---|---|
| `summary.json` | program, version, options, derived numbers, warnings and outcome of the run |
| `*.csv` | tables, with a unit in each heading |
| `index.html` | pictures, numbers, command line and links to the files, to be read in a browser |
| `*.png`, `*.gif` | pictures, drawn by gnuplot where it is installed |
| `*.gp` | script of each picture: variables of the run, then its template and style; `gnuplot NAME.gp` draws it again |
| `*.vtkhdf`, `*.xdmf` | the particles for ParaView ([how](../paraview.md)) |
| `checkpoint.h5` | the state from which `--restart` continues, of programs that have that option |

Templates and the common `style.gp` lie in `share/libmps/plots`. A file of the same name in the folder of the environment variable
`MPS_PLOTS` takes precedence.

## Exit status

| status | meaning |
|---|---|
| 0 | the run was completed and its results are written |
| 1 | the run failed, a file could not be written, or a result is missing |
| 2 | a wrong option or combination of options; nothing was computed |
| 130 | ended by Ctrl-C; results of what was computed are written |
"""


def stage(root, build, write):
    """Writes all pages; returns the names of the programs that have one."""
    names = sorted(p.stem for p in (root / "programs").glob("mps-*.c"))
    texts = {name: run_help(pathlib.Path(build), name) for name in names} if build else {}
    shown = [name for name in names if texts.get(name)]
    rows = []
    for name in shown:
        write(f"programs/{name}.md", page(root, name, texts[name]))
        rows.append(f"| [{name}]({name}.md) | {plain(first_sentence(parse(texts[name])[1]))} |")
    table = "| program | what |\n|---|---|\n" + "\n".join(rows) if rows else \
        "This copy of the site was built without the programs, so it has no pages of them: `PROGRAM --help` lists the options."
    tree = "\n```{toctree}\n:hidden:\n\n" + "\n".join(shown) + "\n```\n" if shown else ""
    write("programs/index.md", INDEX.format(table=table) + tree)
    return shown
