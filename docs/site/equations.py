"""Where each equation of the papers is computed: the sources name equations behind the words that say what they are,
as in "Nakamura (34)"; this collects them."""

import pathlib
import re

PAPERS = {"Yoshida": "explicit elastodynamics", "Nakamura": "WLS-MPM with contact", "Chikazawa": "implicit elasticity"}
NAMED = re.compile(r"\b(Yoshida|Nakamura|Chikazawa)((?:,? (?:and |to )?\(A?\d+[a-z]?\)(?:-\(A?\d+\))?)+)")
FUNCTION = re.compile(r"^[A-Za-z_][\w\s\*]*?\b(\w+)\s*\([^;{}]*\)\s*\{", re.M)


def numbers(text):
    """"(28) to (34)", "(31)-(34)" and "(49), (50)" as single numbers."""
    found = re.findall(r"(to |-)?\((A?)(\d+)([a-z]?)\)", text)
    out = []
    for joined, letter, number, tail in found:
        if joined and out and out[-1][0] == letter:
            out += [(letter, k, "") for k in range(out[-1][1] + 1, int(number))]
        out.append((letter, int(number), tail))
    return out


def code_of(root):
    """Source files that hold equations."""
    return [p for folder in ("src", "programs") for p in sorted((root / folder).rglob("*.[ch]"))]


def owner(text, place):
    """The function in which `place` lies, or before which it stands; "" at the head of a file."""
    behind = None
    if place < text.find("*/"):
        return ""
    for match in FUNCTION.finditer(text):
        line = text.find("\n", match.end())
        end = line if "}" in text[match.end():line] else text.find("\n}", match.end())
        if match.start() <= place < end:
            return match[1]
        if match.start() > place:
            between = text[place:match.start()]
            behind = match[1] if between.count("*/") == 1 and "\n\n" not in between.split("*/", 1)[1].rstrip("\n") else None
            break
    return behind or ""


def mentions(text):
    """(paper, number, place) of all equations that the comments of a file name. Where its first comment names one paper
    alone, numbers without a name are of that paper too."""
    text = re.sub(r"\n \* ", "\n   ", text)
    for match in NAMED.finditer(text):
        yield from ((match[1], number, match.start()) for number in numbers(match[2]))
    papers = set(NAMED.findall(text[:text.find("*/")])) if text.startswith("/*") else set()
    papers = {paper for paper, _ in papers}
    if len(papers) == 1:
        for comment in re.finditer(r"/\*.*?\*/", text[text.find("*/") + 2:], re.S):
            start = text.find("*/") + 2 + comment.start()
            for match in re.finditer(r"(?<![\w(])(?:\(A?\d+\)(?:-\(A?\d+\))?)", comment[0]):
                yield from ((papers.copy().pop(), number, start + match.start()) for number in numbers(match[0]) if number[0] or number[1] > 1)


def collect(root):
    """(paper, number) -> places, each a file and the function; a file alone where only its head or a declaration names it."""
    found = {}
    for path in code_of(root):
        text = path.read_text()
        for paper, number, place in mentions(text):
            entry = (path.relative_to(root).as_posix(), owner(text, place).replace("main", ""))
            places = found.setdefault((paper, number), [])
            if entry not in places:
                places.append(entry)
    for key, places in found.items():
        inside = {file for file, function in places if function}
        found[key] = [place for place in places if place[1] or place[0] not in inside]
    return found


def label(number):
    return f"({number[0]}{number[1]}{number[2]})"


def page(root):
    """The table as reStructuredText."""
    root = pathlib.Path(root)
    found = collect(root)
    lines = ["Equations and where they are computed", "=" * 37, "",
             "Each equation that a comment in the sources names, with the function that computes it, or the file whose head names",
             "it. The papers are listed in :doc:`/references`. Collected from the sources when this site was built.", ""]
    for paper, what in PAPERS.items():
        rows = sorted(k for k in found if k[0] == paper)
        lines += [f"{paper}: {what}", "-" * (len(paper) + len(what) + 2), "",
                  ".. list-table::", "   :header-rows: 1", "   :widths: 12 88", "", "   * - equation", "     - function or file"]
        for key in rows:
            places = found[key]
            listed = ", ".join(f"``{p[1]}`` in ``{p[0]}``" if p[1] else f"``{p[0]}``" for p in places)
            lines += [f"   * - \\{label(key[1])}", f"     - {listed}"]
        lines.append("")
    return "\n".join(lines) + "\n"
