"""Puts the sources of the site together: the pages of docs/ at their places, the pages of the repository's root, the
reference of the headers, and the table of equations. Links between pages hold in the repository; here those to files
that are no pages become names of files, which links.py leads to listings."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile

import equations
import headers
import notebooks
import options
import python_reference

ROOT_PAGES = {"CHANGELOG.md": "changelog.md", "CONTRIBUTING.md": "contributing.md", "README.md": "index.md", "LICENSE": "license.md", "examples/README.md": "examples.md",
              "docs/site/index.md": "index.md"}
LINK = re.compile(r"(?<!\!)\[((?:[^\[\]`]|`[^`]*`|\[[^\]]*\])*)\]\(([^():\s#]*)(#[^)\s]*)?\)")


def place_of(path):
    """Where the repository's file `path` stands on the site, or None."""
    if path in ROOT_PAGES:
        return ROOT_PAGES[path]
    if path == "include/mps":
        return "api/index.rst"
    if re.fullmatch(r"include/mps/[\w/]+\.h", path):
        return f"api/{path[len('include/mps/'):-2].replace('/', '-')}.rst"
    if path.startswith("docs/") and path.endswith(".md") and not path.startswith("docs/site/"):
        return path[len("docs/"):]
    return None


ANSWERS = "docs/how.md"  # one page in the repository, on the site one for each question, so that the search finds these


def answer_page(anchor):
    """The page of the question that has this anchor in docs/how.md."""
    return f"how/{anchor.removeprefix('how-do-i-')}.md"


def stage_answers(root, out):
    """The list of questions, and a page for each."""
    text = (root / ANSWERS).read_text()
    groups = re.split(r"^## ", text, flags=re.M)
    first, index = None, groups[0].strip() + "\n"
    for group in groups[1:]:
        title, *questions = re.split(r"^### ", group, flags=re.M)
        pages = []
        for question in questions:
            asked, _, answer = question.partition("\n")
            page = answer_page(re.sub(r"[^\w\- ]", "", asked.lower()).replace(" ", "-"))
            answer = tabs(relink(answer, ANSWERS, page))
            if first and "```python" in answer:
                answer += f"\nWhat a block does not make itself comes from [the first answer]({first}).\n"
            first = first or os.path.basename(page)
            pages.append(page[:-3])
            write(out / page, f"# {asked}\n" + answer)
        index += f"\n## {title.strip()}\n\n```{{toctree}}\n:maxdepth: 1\n\n" + "\n".join(pages) + "\n```\n"
    write(out / "how.md", index)


def relink(text, path, here):
    """The links of the page `path`, which becomes `here`, for the site."""
    def new(match):
        said, target, anchor = match[1], match[2], match[3] or ""
        if not target and path != ANSWERS:
            return match[0]
        file = os.path.normpath(os.path.join(os.path.dirname(path), target)) if target else path
        if file == ANSWERS and anchor:
            return f"[{said}]({os.path.relpath(answer_page(anchor[1:]), os.path.dirname(here) or '.')})"
        page = place_of(file)
        if page:
            return f"[{said}]({os.path.relpath(page, os.path.dirname(here) or '.')}{anchor})"
        if target.endswith((".png", ".gif")):
            return match[0]
        if file.startswith("examples/"):
            return f"`{file}`"  # which links.py leads to its listing
        return f"{said} (`{file}`)" if "`" not in said else said
    parts = re.split(r"(^```.*?^```\s*$)", text, flags=re.S | re.M)
    return "".join(part if k % 2 else LINK.sub(new, part) for k, part in enumerate(parts))


LINES = r"(?:(?!```).*\n)*"  # of one block
TWO = re.compile(rf"^```python\n(?P<python>{LINES})```\n\n```c\n(?P<c>{LINES})```$", re.M)


def tabs(text):
    """A block of Python with the same in C behind it as two tabs; all of a page change together."""
    def two(match):
        items = [f":::{{tab-item}} {said}\n:sync: {kind}\n\n```{kind}\n{match[kind]}```\n:::\n" for said, kind in (("Python", "python"), ("C", "c"))]
        return "::::{tab-set}\n:sync-group: language\n\n" + "\n".join(items) + "::::"
    return TWO.sub(two, text)


def first_program(root, text):
    """The start page with the program of README.md, in Python and C."""
    blocks = [re.search(rf"^```{kind}\n.*?^```$", (root / "README.md").read_text(), re.M | re.S)[0] for kind in ("python", "c")]
    return text.replace("{first program}", "\n\n".join(blocks))


# Pages that lead to pages of their own folder: what is behind them in the navigation.
TREES = {"verification/README.md": "wls-mpm soil liquefaction textbook pore-water explicit-mps implicit-elastic fluid programs ranks", "verification/wls-mpm.md": "wls-mpm/*",
         "verification/fluid.md": "fluid/*"}


def tree(here):
    """The hidden list of the pages behind the page `here`."""
    listed = TREES.get(here, "").split()
    return "\n```{toctree}\n:hidden:\n:glob:\n\n" + "\n".join(listed) + "\n```\n" if listed else ""


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def stage_pages(root, out):
    """Pages and pictures."""
    pages = [p.relative_to(root).as_posix() for p in sorted((root / "docs").rglob("*.md"))]
    for path in [*pages, "CHANGELOG.md", "CONTRIBUTING.md", "docs/site/index.md", "examples/README.md"]:
        here = place_of(path)
        if path == ANSWERS:
            stage_answers(root, out)
        elif here:
            write(out / here, tabs(first_program(root, relink((root / path).read_text(), path, here))) + tree(here))
    for picture in sorted(p for p in (root / "docs").rglob("*") if p.suffix in (".png", ".gif")):
        target = out / picture.relative_to(root / "docs")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(picture, target)
    write(out / "license.md", "# Licence\n\n```text\n" + (root / "LICENSE").read_text().strip() + "\n```\n")
    given = (root / "CITATION.cff").read_text().strip()
    write(out / "cite.md", f"# How to cite\n\nlibmps, and the paper of the method that you used. For LaTeX:\n\n```bibtex\n{bibtex(given)}```\n\nThe file "
          f"`CITATION.cff` in the root of the sources, as reference managers read it:\n\n```yaml\n{given}\n```\n")


def bibtex(text):
    """The entries of a CITATION.cff for BibTeX: the software, then the papers of its methods."""
    import yaml  # here, as tests of the rest need no package
    cff, entries = yaml.safe_load(text), []
    for entry in [cff, *cff.get("references", [])]:
        software = entry is cff
        authors = " and ".join("{" + a["name"] + "}" if "name" in a else f"{a['family-names']}, {a['given-names']}" for a in entry["authors"])
        year = entry.get("year") or str(entry.get("date-released", ""))[:4]
        key = "libmps" if software else f"{entry['authors'][0]['family-names'].lower()}{year}"
        fields = {"author": authors, "title": "{" + entry["title"] + "}", "year": year, "version": entry.get("version"),
                  "journal": entry.get("journal"), "institution": entry.get("institution", {}).get("name"), "number": entry.get("number"),
                  "volume": entry.get("volume"), "pages": f"{entry['start']}--{entry['end']}" if "start" in entry else None,
                  "note": f"{entry['license']} licence" if software else entry.get("notes")}
        kind = {"software": "software", "report": "techreport"}.get(entry["type"], "article" if entry.get("journal") else "misc")
        rows = "".join(f"  {name} = {{{value}}},\n" for name, value in fields.items() if value)
        entries.append(f"@{kind}{{{key},\n{rows}}}\n")
    return "\n".join(entries)


# Parts of pictures for the start page: left, top, right, bottom as fractions.
CARDS = {"card-pile.png": ("pile.png", 0.585, 0.105, 0.975, 0.915), "card-earthquake.png": ("slope.png", 0.08, 0.18, 0.85, 0.78),
         "card-seawall.png": ("seawall-waves.png", 0.5, 0.025, 0.9, 0.29), "card-footing.png": ("footing.png", 0.107, 0.064, 0.842, 0.882),
         "card-cone.png": ("penetrometer.png", 0.07, 0.12, 0.425, 0.885), "card-columns.png": ("column-collapse.png", 0.4967, 0.0467, 0.6942, 0.2734)}


def stage_cards(out):
    """The pictures of the start page, cut out of those of the programs."""
    from PIL import Image  # here, as tests of the rest need no package
    for name, (picture, *box) in CARDS.items():
        with Image.open(out / "images" / picture) as whole:
            size = (whole.width, whole.height) * 2
            part = whole.convert("RGB").crop([round(f * s) for f, s in zip(box, size)])
        part.thumbnail((640, 640))
        part.save(out / "images" / name)


def definitions(root):
    """What the tables of src/core/definition say of each struct, by a program that prints them."""
    with tempfile.TemporaryDirectory() as folder:
        program = pathlib.Path(folder) / "definitions"
        # enumerators.c reads what the build has made of the headers: names in messages, which are not printed here
        sources = sorted(path for path in (root / "src/core/definition").glob("*.c") if path.name != "enumerators.c")
        subprocess.run([os.environ.get("CC", "cc"), "-DMPS_EXPERIMENTAL", "-D_GNU_SOURCE", f"-I{root / 'include'}", f"-I{root / 'src'}", "-o",
                        program, root / "docs/site/definitions.c", *sources, "-lm"], check=True)
        return json.loads(subprocess.run([program], check=True, capture_output=True, text=True).stdout)


def stage_reference(root, out):
    """A page for each header; every exported name must be on one."""
    names, rows, pages = set(), [], []
    tables = definitions(root)
    for path in (p for pattern in ("*.h", "*/*.h") for p in sorted((root / "include/mps").glob(pattern))):
        header = str(path.relative_to(root / "include/mps"))
        pages.append(header[:-2].replace("/", "-"))
        text, entries = headers.page(header, path.read_text(), tables)
        names |= {entry.name for entry in entries}
        write(out / "api" / f"{pages[-1]}.rst", text)
        first = headers.summary(path.read_text())
        rows.append(f"* - :doc:`mps/{header} <{pages[-1]}>`\n  - {first}\n  - {sum(e.kind == 'function' for e in entries)}")
    exported = set(re.findall(r"^\s+(mps_\w+);", "".join(p.read_text() for p in (root / "src").rglob("*.map")), re.M))
    if exported - names:
        raise SystemExit(f"docs: exported, and on no page of the reference: {', '.join(sorted(exported - names))}")
    head = (root / "docs/site/reference.rst").read_text()
    table = ".. list-table::\n   :header-rows: 1\n   :widths: 24 66 10\n\n   * - header\n     - what\n     - functions\n"
    table += "\n".join("   " + row.replace("\n", "\n   ") for row in rows)
    tree = ".. toctree::\n   :hidden:\n\n" + "\n".join(f"   {page}" for page in pages)
    write(out / "api" / "index.rst", f"{head}\n{table}\n\n{tree}\n")


WITHOUT_PICTURE = ("mps-info", "mps-precice")  # one shows text, the other needs a second code


def check_gallery(root):
    """Every program has its place in the gallery, with a command and a picture."""
    shown = (root / "docs/gallery.md").read_text()
    parts = {part.partition("\n")[0]: part for part in re.split(r"^## ", shown, flags=re.M)}
    names = [p.stem for p in sorted((root / "programs").glob("mps-*.c"))]
    missing = [name for name in names if name not in parts]
    if missing:
        raise SystemExit(f"docs: programs without a place in docs/gallery.md: {', '.join(missing)}")
    bare = [name for name in names if not re.search(rf"^(?:\$ )?{name} ?", parts[name].partition("```")[2], re.M)
            or ("](images/" not in parts[name] and name not in WITHOUT_PICTURE)]
    if bare:
        raise SystemExit(f"docs: programs without a command or a picture in docs/gallery.md: {', '.join(bare)}")


def stage(root, out, pictures, build=None):
    """All sources of the site, in `out`; files in `pictures` take the places of those in docs/images, and programs of
    `build` say what their options are."""
    root, out = pathlib.Path(root), pathlib.Path(out)
    shutil.rmtree(out, ignore_errors=True)
    check_gallery(root)
    stage_pages(root, out)
    notebooks.stage(root, out)
    stage_reference(root, out)
    write(out / "theory" / "equations.rst", equations.page(root))
    python_reference.stage(root, lambda name, text: write(out / name, text))
    if not options.stage(root, build, lambda name, text: write(out / name, text)):
        print("docs: no pages of the programs: --build DIR names a build that has them")
    for picture in sorted(pathlib.Path(pictures).glob("*.*")) if pictures else []:
        shutil.copyfile(picture, out / "images" / picture.name)
    stage_cards(out)
