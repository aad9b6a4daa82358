"""Pages of the Python package, from its stubs (python/make_docs.py writes them from the headers): one page for each
object of the library, one for the functions of the module, one for results, one for constants."""

import ast
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap

import headers

PLAIN = ("Warning", "Field", "FieldInfo", "Block", "Edit", "Object", "Result")


def stubs(root):
    """The stubs as a syntax tree."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-B", root / "python/make_docs.py", root, folder], check=True)
        return ast.parse((pathlib.Path(folder) / "__init__.pyi").read_text())


def signature(function):
    """The arguments, those with a default as optional, then those by keyword alone; no types, which the text has."""
    a = function.args
    listed = [arg.arg for arg in a.posonlyargs + a.args]
    for k, default in enumerate(a.defaults, len(listed) - len(a.defaults)):
        listed[k] += f"={ast.unparse(default)}"
    listed = [name for name in listed if name != "self"]
    if a.kwonlyargs:
        listed += ["*", *(f"{arg.arg}={ast.unparse(default)}" if default else arg.arg for arg, default in zip(a.kwonlyargs, a.kw_defaults))]
    return f"({', '.join(listed)})"


def keywords(rows):
    """The rows "name (type): what" below "Keywords" as a list of fields."""
    lines = []
    for row in re.split(r"\n(?=  \S)", rows):
        found = re.match(r"\s*(\w+) \((.*?)\)(?:: (.*))?$", " ".join(row.split()))
        if found:
            lines += [f"* ``{found[1]}`` ({headers.escape(found[2])})" + (f": {headers.escape(found[3])}" if found[3] else "")]
    return lines


def body(text, indent):
    """A docstring as reStructuredText."""
    lines = []
    for part in re.split(r"\n\s*\n", textwrap.dedent(text or "").strip()):
        if part.startswith("Keywords ("):
            head, _, rows = part.partition("\n")
            lines += [headers.escape(head), "", *keywords(rows), ""]
        elif re.match(r"C: ", part):  # of a property that is set, two
            name = re.search(r"\b(mps_\w+)\(", part)
            lines += [f"C: ``{name[1]}``" if name else headers.escape(part), ""]
        else:
            lines += [row.removeprefix("") for row in headers.paragraphs(part, 0)]
    return [" " * indent + line if line else "" for line in lines]


def returned(function):
    said = ast.unparse(function.returns) if function.returns else "None"
    return "" if said == "None" else f" -> {said}"


def function(node, kind, indent):
    lines = [f".. py:{kind}:: {node.name}{signature(node)}{returned(node)}", "", *body(ast.get_docstring(node), 3)]
    return [" " * indent + line if line else "" for line in lines]


def is_property(item):
    return isinstance(item, ast.FunctionDef) and any(isinstance(d, ast.Name) and d.id == "property" for d in item.decorator_list)


def is_method(item):
    return isinstance(item, ast.FunctionDef) and not item.decorator_list and not item.args.vararg and (
        not item.name.startswith("__") or item.name in ("__init__", "__getitem__", "__setitem__", "__delitem__", "__contains__", "__len__", "__iter__"))


def is_member(item):
    """Of an enumeration."""
    return isinstance(item, ast.Assign)


def class_lines(node, indent=0):
    """A class with its attributes and methods."""
    lines = [f".. py:class:: {node.name}", "", *body(ast.get_docstring(node), 3)]
    for k, item in enumerate(node.body):
        if isinstance(item, ast.AnnAssign) and not item.target.id.startswith("_"):
            behind = node.body[k + 1] if k + 1 < len(node.body) else None
            said = behind.value.value if isinstance(behind, ast.Expr) and isinstance(behind.value, ast.Constant) else ""
            lines += [f"   .. py:attribute:: {item.target.id}", f"      :type: {ast.unparse(item.annotation)}", "      :no-contents-entry:", "", *body(said, 6)]
        elif is_property(item):
            lines += [f"   .. py:property:: {item.name}", f"      :type: {ast.unparse(item.returns)}", "      :no-contents-entry:", "",
                      *body(ast.get_docstring(item), 6)]
        elif is_member(item):
            lines += ["   .. py:attribute:: " + item.targets[0].id, "      :no-contents-entry:", ""]
            behind = node.body[k + 1] if k + 1 < len(node.body) else None
            lines += body(behind.value.value, 6) if isinstance(behind, ast.Expr) else []
        elif is_method(item):
            lines += function(item, "method", 3)
    return lines


def titled(title, *lines):
    return "\n".join([title, "=" * len(title), "", ".. py:currentmodule:: libmps", "", *lines]) + "\n"


def made_by(makers):
    """The line that says which calls return an object."""
    return [f"Returned by {', '.join(makers)}.", ""] if makers else []


def constants(tree):
    """(name, what) of the constants of the module."""
    for k, node in enumerate(tree.body):
        if isinstance(node, ast.AnnAssign) and node.target.id.isupper():
            behind = tree.body[k + 1] if k + 1 < len(tree.body) else None
            yield node.target.id, behind.value.value if isinstance(behind, ast.Expr) and isinstance(behind.value, ast.Constant) else ""


#: Modules above the layer, which are Python alone.
MODULES = ("models", "theory", "signals", "files", "plot", "compiled")


def module_lines(root, name):
    """A module of the package: its text, then what it defines for others."""
    tree = ast.parse((root / f"python/libmps/{name}.py").read_text())
    title = f"libmps.{name}"
    lines = [title, "=" * len(title), "", f".. py:module:: libmps.{name}", "", *plain(ast.get_docstring(tree), 0)]
    for node in tree.body:
        if getattr(node, "name", "_").startswith("_"):
            continue
        if isinstance(node, ast.FunctionDef):
            lines += [f".. py:function:: {node.name}{signature(node)}{returned(node)}", "", *plain(ast.get_docstring(node), 3)]
        elif isinstance(node, ast.ClassDef):
            made = next((item for item in node.body if isinstance(item, ast.FunctionDef) and item.name == "__init__"), None)
            lines += [f".. py:class:: {node.name}{signature(made) if made else ''}", "", *plain(ast.get_docstring(node), 3)]
            for item in node.body:
                if isinstance(item, ast.FunctionDef) and not item.name.startswith("_"):
                    kind = "property" if is_property(item) else "method"
                    head = "" if kind == "property" else f"{signature(item)}{returned(item)}"
                    lines += [f"   .. py:{kind}:: {item.name}{head}", "      :no-contents-entry:", "", *plain(ast.get_docstring(item), 6)]
    return "\n".join(lines) + "\n"


def plain(text, indent):
    """A docstring with its lines as they stand: paragraphs, and columns of names or programs as literal blocks."""
    lines = []
    for part in re.split(r"\n\s*\n", (text or "").strip()):
        rows = part.splitlines()
        column = any(re.match(r"\w[\w, ]*\S {2,}\S|\s{2,}\S", row) for row in rows)
        lines += ["::", "", *(f"   {row}" for row in rows), ""] if column else [headers.escape(row) for row in rows] + [""]
    return [" " * indent + line if line else "" for line in lines]


INDEX = """Python reference
================

.. py:module:: libmps

Every object, function and constant of the package ``libmps``, with the comments of the C headers: the same that
``help(libmps.Mpm.step)`` shows. The guide is :doc:`/python`.

Objects are made by their classes: ``libmps.Particles(...)``, ``libmps.Mpm(...)``, materials by ``libmps.MohrCoulomb(...)`` and
its like. Arguments behind ``*`` are given by name; one that is not given has the default of its text. A call that fails raises
one of the errors that its text names; all are ``Error``.

{table}

.. toctree::
   :hidden:

   {pages}
"""


def stage(root, write):
    """Writes the pages; returns the number of methods and functions on them."""
    tree = stubs(root)
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
    parent = {node.name: ast.unparse(node.bases[0]) if node.bases else "" for node in classes}
    kinds = [node for node in classes if node.name not in PLAIN and parent[node.name] in ("Object", "Solver")]
    ways = [node for node in classes if parent[node.name] in {kind.name for kind in kinds} - {"Solver"}]
    enums = [node for node in classes if parent[node.name] in ("IntEnum", "IntFlag")]
    results = [node for node in classes if parent[node.name] == "Result" and node.name not in PLAIN]
    base = [node for node in classes if node not in kinds + ways + enums + results]
    objects = kinds
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    count, rows = len(functions), []
    makers = {}  # which methods return an object
    for owner in objects:
        for item in owner.body:
            if isinstance(item, ast.FunctionDef) and item.returns:
                for name in re.findall(r"\w+", ast.unparse(item.returns)):
                    makers.setdefault(name, []).append(f"``{owner.name}.{item.name}``")
    for node in objects:
        of_kind = [node, *(way for way in ways if parent[way.name] == node.name)]
        count += sum(is_method(item) or is_property(item) for way in of_kind for item in way.body)
        makes = [f"``{way.name}``" for way in of_kind[1:]] + makers.get(node.name, [])
        write(f"python-api/{node.name.lower()}.rst", titled(node.name, *made_by(makes), *(line for way in of_kind for line in class_lines(way))))
        own = [item for item in node.body if is_method(item) or is_property(item)]
        rows.append(f"   * - :doc:`{node.name} <{node.name.lower()}>`\n     - {len(own)} methods and properties")
    write("python-api/functions.rst", titled("Functions of the module", *(line for node in functions for line in function(node, "function", 0))))
    write("python-api/results.rst", titled("Results", "Structs that C fills, with members as attributes.", "",
                                           *(line for node in results for line in class_lines(node))))
    write("python-api/enumerations.rst", titled("Enumerations", "Choices: by a member, or by its name as a text, in capitals or not.", "",
                                                *(line for node in enums for line in class_lines(node))))
    write("python-api/base.rst", titled("Errors, fields, edits", *(line for node in base for line in class_lines(node))))
    lines = []
    for name, said in constants(tree):
        lines += [f".. py:data:: {name}", "   :no-contents-entry:", "", *body(said, 3)]
    write("python-api/constants.rst", titled("Constants", *lines))
    for name in MODULES:
        text = module_lines(root, name)
        count += len(re.findall(r"^ *\.\. py:(?:method|property|function)::", text, re.M))
        write(f"python-api/{name}.rst", text)
    rest = [(name, "module of Python above the layer") for name in MODULES] + [("functions", f"{len(functions)} functions without an object"), ("results", f"{len(results)} structs that calls return"),
            ("enumerations", f"{len(enums)} lists of choices"), ("base", "errors, fields of particles, edits, what all objects have"),
            ("constants", "numbers")]
    rows += [f"   * - :doc:`{name}`\n     - {what}" for name, what in rest]
    table = ".. list-table::\n   :header-rows: 1\n   :widths: 40 60\n\n   * - page\n     - what\n" + "\n".join(rows)
    pages = [node.name.lower() for node in objects] + [name for name, _ in rest]
    write("python-api/index.rst", INDEX.format(table=table, pages="\n   ".join(pages)))
    return count
