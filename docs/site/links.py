"""Code on the pages that names something becomes a link: a name of the interface leads to the reference, a function or
file of the sources to its listing, a program to the gallery. Listings are pages made of the files that are named."""

import html
import pathlib
import re

import pygments
from docutils import nodes
from pygments.formatters import HtmlFormatter
from pygments.lexers import get_lexer_for_filename
from pygments.lexers.special import TextLexer
from pygments.util import ClassNotFound

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DEFINITION = re.compile(r"^(?!typedef|return|else)(?:[A-Za-z_][\w\s\*]*?[\s\*])(\w+)\s*\([^;{}()]*(?:\([^()]*\)[^;{}()]*)*\)\s*\{", re.M)
FOLDERS = ("src", "include", "programs", "examples", "tests", "bench", "scripts", "python", "cmake", "docs")


class Sources:
    """What the sources define and where."""

    def __init__(self):
        self.functions, self.basenames, self.used = {}, {}, set()
        for path in sorted([*(ROOT / "src").rglob("*.[ch]"), *(ROOT / "programs").rglob("*.[ch]")]):
            name, text = path.relative_to(ROOT).as_posix(), path.read_text()
            self.basenames.setdefault(path.name, []).append(name)
            for match in DEFINITION.finditer(text):
                line = text.count("\n", 0, match.start(1)) + 1
                self.functions.setdefault(match[1], []).append((name, line))

    def file(self, text):
        """The file that `text` names: by its path, or by a name that only one file has."""
        if re.fullmatch(r"[\w.-]+(?:/[\w.-]+)+", text):
            if text.split("/")[0] in FOLDERS and (ROOT / text).is_file():
                return text
            kind, _, name = text.partition("/")
            test = next(iter(sorted((ROOT / "tests" / kind).glob(f"test_{name}.c"))), None) if kind.isalpha() and name else None
            return test.relative_to(ROOT).as_posix() if test else None
        found = self.basenames.get(text, [])
        return found[0] if len(found) == 1 else None

    def function(self, name, near):
        """The one definition of `name`, or the one in the first of the files `near` that has one."""
        places = self.functions.get(name, [])
        for file in near if len(places) > 1 else ():
            here = [place for place in places if place[0] == file]
            if here:
                return here[0] if len(here) == 1 else None
        library = [place for place in places if place[0].startswith("src/")]
        chosen = places if len(places) == 1 else library
        return chosen[0] if len(chosen) == 1 else None


def reference_of(app):
    """Names of the interface: (page, anchor)."""
    found = {}
    for name, _, kind, page, anchor, _ in app.env.get_domain("c").get_objects():
        if kind != "functionParam":
            found.setdefault(name, (page, anchor))
            if kind == "enumerator":
                found.setdefault(name.split(".")[-1], (page, anchor))
    return found


def python_of(app):
    """Names of the Python package, whole (mps.Waves) and by their last word where only one class has it: (page, anchor)."""
    found = {}
    for name, _, _, page, anchor, _ in app.env.get_domain("py").get_objects():
        for said in ("mps." + name.removeprefix("libmps."), name.split(".")[-1]):
            found.setdefault(said, set()).add((page, anchor))
    return {said: next(iter(places)) for said, places in found.items() if len(places) == 1}


PYTHON_PAGES = ("how", "coming-from", "python")  # where names are those of the Python package


def target_of(app, text, near, page):
    """Where a piece of code leads: ("page", page, anchor), ("listing", file, line), or None."""
    name = re.sub(r"\(\)$|\(.*\)$", "", text.strip())
    known = app.mps_reference.get(name) or (app.mps_python.get(name) if name.startswith("mps.") or page.split("/")[0] in PYTHON_PAGES else None)
    if known:
        return ("page", *known)
    header = re.fullmatch(r"(?:include/)?mps/(\w+)\.h", name)
    if header and f"api/{header[1]}" in app.env.all_docs:
        return ("page", f"api/{header[1]}", "")
    program = re.match(r"mps-[a-z-]+", text)
    if program and program[0] in app.mps_programs:
        own = f"programs/{program[0]}"
        return ("page", own, "") if own in app.env.all_docs else ("page", "gallery", program[0])
    file = app.mps_sources.file(name)
    if file:
        return ("listing", file, 0)
    # Of words without an underscore only those of theory pages are functions; elsewhere they are fields and options.
    if re.fullmatch(r"[a-z_]\w*", name) and ("_" in name or page.startswith("theory/")) and page.split("/")[0] not in PYTHON_PAGES:
        place = app.mps_sources.function(name, near)
        if place:
            return ("listing", *place)
    return None


def listing_page(file):
    return f"listing/{file}"


def link_code(app, doctree, page):
    """Wraps literals in references."""
    if app.builder.format != "html":
        return
    if not hasattr(app, "mps_reference"):
        app.mps_reference, app.mps_python, app.mps_sources = reference_of(app), python_of(app), Sources()
        app.mps_programs = {p.stem for p in (ROOT / "programs").glob("mps-*.c")}
    literals = [n for n in doctree.findall(nodes.literal)]
    files = [(n.parent, app.mps_sources.file(n.astext())) for n in literals]
    for literal in literals:
        parent = literal.parent
        while parent is not None and not isinstance(parent, (nodes.reference, nodes.title)):
            parent = parent.parent
        if parent is not None:
            continue
        index = next(k for k, other in enumerate(literals) if other is literal)
        block = literal.parent  # files that its own paragraph names behind it, before it, then all others
        near = [f for p, f in files[index:] if f and p is block] + [f for p, f in files[index::-1] if f and p is block]
        near += [f for _, f in files if f]
        target = target_of(app, literal.astext(), near, page)
        if not target or (target[0] == "page" and target[1] == page and not target[2]):
            continue
        if target[0] == "page":
            uri = app.builder.get_relative_uri(page, target[1]) + (f"#{target[2]}" if target[2] else "")
        else:
            app.mps_sources.used.add(target[1])
            uri = app.builder.get_relative_uri(page, listing_page(target[1])) + (f"#L-{target[2]}" if target[2] else "")
        reference = nodes.reference("", "", internal=True, refuri=uri)
        literal.replace_self(reference)
        reference += literal


def listings(app):
    """The listings of all files that are named."""
    for file in sorted(getattr(app, "mps_sources", None).used if hasattr(app, "mps_sources") else ()):
        text = (ROOT / file).read_text(errors="replace")
        try:
            lexer = get_lexer_for_filename(file)
        except ClassNotFound:
            lexer = TextLexer()
        shown = HtmlFormatter(linenos="inline", lineanchors="L", anchorlinenos=True, cssclass="highlight")
        body = pygments.highlight(text, lexer, shown)
        title = html.escape(file)
        yield listing_page(file), {"title": title, "body": f"<h1>{title}</h1><div class='listing'>{body}</div>"}, "page.html"




def setup(app):
    app.connect("doctree-resolved", link_code)
    app.connect("html-collect-pages", listings)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": False}
