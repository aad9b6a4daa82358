"""Pages whose programs run, as notebooks of Jupyter: text, sh blocks by %%bash, python blocks, and what they printed. A page
with blocks in C has none."""

import json
import re

BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)
PICTURE = re.compile(r"^!\[[^\]]*\]\([^)]*\)\n", re.M)
LINK = re.compile(r"\[([^\]]+)\]\((?!https?:)[^)]+\)")


def _cell(kind, text):
    lines = text.strip("\n").splitlines(keepends=True)
    cell = {"cell_type": kind, "metadata": {}, "source": lines}
    return cell if kind == "markdown" else {**cell, "execution_count": None, "outputs": []}


def notebook(text):
    """The notebook of a page as a dictionary (nbformat 4); None where it has a program in C or no program in Python."""
    blocks = [(m[1], m[2], m.span()) for m in BLOCK.finditer(text)]
    if any(kind == "c" for kind, _, _ in blocks) or not any(kind == "python" for kind, _, _ in blocks):
        return None
    cells, end = [], 0

    def prose(part):
        part = LINK.sub(r"\1", PICTURE.sub("", part)).strip()
        if part:
            cells.append(_cell("markdown", part))

    for kind, inside, (start, stop) in blocks:
        if kind not in ("sh", "python", "text"):
            continue
        prose(text[end:start])
        end = stop
        if kind != "text":
            cells.append(_cell("code", ("%%bash\n" if kind == "sh" else "") + inside))
        elif cells and cells[-1]["cell_type"] == "code":
            cells[-1]["outputs"] = [{"output_type": "stream", "name": "stdout", "text": inside.splitlines(keepends=True)}]
    prose(text[end:])
    language = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}, "language_info": {"name": "python"}}
    return {"cells": cells, "metadata": language, "nbformat": 4, "nbformat_minor": 4}


def stage(root, out):
    """Writes the notebooks of the worked jobs and of the tutorial beside their pages, and a line on each page; returns
    the names of the pages."""
    made = []
    for page in sorted([*(root / "docs/jobs").glob("*.md"), root / "docs/tutorial/python.md"]):
        found, staged = notebook(page.read_text()), out / page.relative_to(root / "docs")
        if found is None or not staged.exists():
            continue
        staged.with_suffix(".ipynb").write_text(json.dumps(found, indent=1) + "\n")
        staged.write_text(staged.read_text() + f"\n{{download}}`This page as a notebook <{page.stem}.ipynb>`\n")
        made.append(page.relative_to(root / "docs").with_suffix("").as_posix())
    return made
