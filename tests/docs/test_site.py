"""The parts of the site (docs/site) that need no package: headers, links, equations, programs on pages."""

import json
import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "docs/site"))

import equations  # noqa: E402
import headers  # noqa: E402
import notebooks  # noqa: E402
import options  # noqa: E402
import programs  # noqa: E402
import python_reference  # noqa: E402
import stage  # noqa: E402


class Headers(unittest.TestCase):
    """What the reference has of the headers."""

    TEXT = """/* mps/x.h - what x is. More of it.
 * SPDX-License-Identifier: BSD-3-Clause */
typedef struct mps_x mps_x;
/** A choice. */
typedef enum mps_x_kind { MPS_X_ONE = 1, /* the first */ MPS_X_TWO = 2 /* the second: a*b */ } mps_x_kind;
typedef struct mps_x_def {
  double mass, volume; /* kg, m3 */
  /** In: a list. */
  const double *list[3];
  mps_status (*call)(void *user, int32_t n); /* asked */
} mps_x_def;
/** Makes it: x - 1 pieces
 *  - 2 of `count`. MPS_ERROR_ARGUMENT: NULL. */
MPS_API MPS_NODISCARD mps_status mps_x_make(mps_x *x,
                                            int32_t count);
#define MPS_X_MOST 7 /* pieces */
"""

    def test_entries(self):
        introduction, entries = headers.parse(self.TEXT)
        self.assertTrue(introduction.startswith("mps/x.h - what x is."))
        self.assertEqual([(e.kind, e.name) for e in entries],
                         [("type", "mps_x"), ("enum", "mps_x_kind"), ("struct", "mps_x_def"), ("function", "mps_x_make"), ("macro", "MPS_X_MOST")])
        self.assertEqual(entries[1].members, [("MPS_X_ONE", "MPS_X_ONE = 1", "the first"), ("MPS_X_TWO", "MPS_X_TWO = 2", "the second: a*b")])
        self.assertEqual([(n, c) for n, _, c in entries[2].members], [("mass", "kg, m3"), ("volume", "kg, m3"), ("list", "In: a list."), ("call", "asked")])
        self.assertEqual(entries[3].signature, "mps_status mps_x_make(mps_x *x, int32_t count)")

    def test_definitions_have_a_table_of_their_members(self):
        tables = stage.definitions(ROOT)
        text = "".join(path.read_text() for path in (ROOT / "include/mps").rglob("*.h"))
        for name, value in re.findall(r"\b(MPS_\w+) \((\d+)\)", str(tables)):
            self.assertRegex(text, rf"\b{name} *=\s*{value}\b|#define {name} {value}\b")
        for path in sorted((ROOT / "include/mps").rglob("*.h")):
            for entry in headers.parse(path.read_text())[1]:
                if entry.name in tables:
                    self.assertEqual([row[0] for row in tables.pop(entry.name)], [n for n, _, _ in entry.members if n != "struct_size"])
        self.assertEqual(tables, {})
        text, _ = headers.page("x.h", self.TEXT, {"mps_x_def": [["mass", "kg", "unset", "in 0 to 1", ["above volume"]]]})
        self.assertIn("   .. list-table::\n      :header-rows: 1\n\n      * - member\n        - unit\n        - default\n"
                      "        - allowed\n      * - ``mass``\n        - kg\n        - ``unset``\n        - in 0 to 1; above volume\n", text)

    def test_a_minus_at_the_start_of_a_line_is_no_list(self):
        lines = headers.paragraphs("x is a\n- b of `c`.", 0)
        self.assertEqual(lines[0], "x is a - b of ``c``.")
        self.assertEqual(headers.paragraphs("two:\n- one\n- other", 0)[:4], ["two:", "", "- one", "- other"])

    def test_all_declarations_of_the_library_have_an_entry(self):
        found = {}
        for path in sorted((ROOT / "include/mps").rglob("*.h")):
            for entry in headers.parse(path.read_text())[1]:
                found[entry.name] = entry
                for name, _, _ in entry.members:
                    found.setdefault(name, entry)
        text = "".join(p.read_text() for p in (ROOT / "include/mps").rglob("*.h"))
        code = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
        functions = set(re.findall(r"^MPS_(?:PETSC_)?API\b[^;(]*?\b(mps_\w+)\s*\(", code, re.M))
        self.assertGreater(len(functions), 200)
        self.assertEqual(functions - set(found), set())
        self.assertEqual({n for n in functions if not found[n].comment}, set())
        enumerators = set(re.findall(r"^\s+(MPS_[A-Z0-9_]+)\s*=\s*[-\w]+\s*,?", code, re.M))
        self.assertGreater(len(enumerators), 100)
        self.assertEqual({n for n in enumerators - set(found) if not n.endswith("FORCE_32BIT")}, set())


class Pages(unittest.TestCase):
    def test_links_to_pages_and_to_other_files(self):
        self.assertEqual(stage.relink("[a](mpm.md#b)", "docs/fluid.md", "fluid.md"), "[a](mpm.md#b)")
        self.assertEqual(stage.relink("[a](../CHANGELOG.md)", "docs/fluid.md", "fluid.md"), "[a](changelog.md)")
        self.assertEqual(stage.relink("[a](../mpm.md)", "docs/site/index.md", "index.md"), "[a](mpm.md)")
        self.assertEqual(stage.relink("[a](cases/x.ini)", "docs/verification/wls-mpm.md", "verification/wls-mpm.md"),
                         "a (`docs/verification/cases/x.ini`)")
        kept = "```c\n[a](../CHANGELOG.md)\n```\n"
        self.assertEqual(stage.relink(kept, "docs/fluid.md", "fluid.md"), kept)

    def test_each_question_has_a_page_of_its_own_and_links_lead_there(self):
        self.assertEqual(stage.relink("[a](how.md#how-do-i-cite-it)", "docs/fluid.md", "fluid.md"), "[a](how/cite-it.md)")
        self.assertEqual(stage.relink("[a](#how-do-i-cite-it)", "docs/how.md", "how/begin.md"), "[a](cite-it.md)")
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder)
            stage.stage_answers(ROOT, out)
            index = (out / "how.md").read_text()
            asked = re.findall(r"^### (.*)$", (ROOT / "docs/how.md").read_text(), re.M)
            pages = {page.stem: page.read_text() for page in (out / "how").glob("*.md")}
            self.assertEqual(sorted(text.partition("\n")[0][2:] for text in pages.values()), sorted(asked))
            for name, text in pages.items():
                self.assertIn(f"how/{name}\n", index)
                for link in re.findall(r"\]\(([\w-]+\.md)\)", text):
                    self.assertTrue((out / "how" / link).exists(), link)

    def test_python_and_c_side_by_side_are_tabs(self):
        made = stage.tabs("a\n\n```python\nx = 1\n```\n\n```c\nint x = 1;\n```\n\nb\n")
        self.assertEqual(made.count(":::{tab-item}"), 2)
        self.assertLess(made.index(":sync: python\n\n```python\nx = 1\n```\n:::"), made.index(":sync: c\n\n```c\nint x = 1;\n```\n:::"))
        apart = "```python\nx = 1\n```\n\nIn C:\n\n```c\nint x = 1;\n```\n"
        self.assertEqual(stage.tabs(apart), apart)
        between = "```python\nx = 1\n```\n\n## Next\n\n```python\ny = 1\n```\n\n```c\nint y = 1;\n```\n"
        self.assertTrue(stage.tabs(between).startswith("```python\nx = 1\n```\n\n## Next\n\n::::{tab-set}"))
        for path in sorted((ROOT / "docs").rglob("*.md")):  # no heading within a tab
            for item in re.findall(r"^:::\{tab-item\}.*?^:::$", stage.tabs(path.read_text()), re.M | re.S):
                self.assertNotRegex(item, r"(?m)^## ")

    def test_a_program_without_a_place_in_the_gallery_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "docs").mkdir()
            (root / "programs").mkdir()
            (root / "programs/mps-new.c").touch()
            (root / "docs/gallery.md").write_text("# Gallery\n\n## mps-old\n")
            with self.assertRaisesRegex(SystemExit, "without a place.*mps-new"):
                stage.check_gallery(root)
            (root / "docs/gallery.md").write_text("# Gallery\n\n## mps-new\n\n```console\n$ mps-new\n```\n")
            with self.assertRaisesRegex(SystemExit, "without a command or a picture.*mps-new"):
                stage.check_gallery(root)
            (root / "docs/gallery.md").write_text("# Gallery\n\n## mps-new\n\n![new](images/new.png)\n\n```console\n$ mps-new\n```\n")
            stage.check_gallery(root)

    def test_the_citation_names_this_version(self):
        header = (ROOT / "include/mps/base.h").read_text()
        version = "{}.{}.{}{}".format(*re.findall(r'#define MPS_VERSION_(?:MAJOR|MINOR|PATCH|SUFFIX) "?([^"\s]*)', header))
        self.assertIn(f"\nversion: {version}\n", (ROOT / "CITATION.cff").read_text())

    def test_every_page_is_in_the_navigation(self):
        index = (ROOT / "docs/site/index.md").read_text()
        listed = set(re.findall(r"^(?:.* <)?([\w/-]+)>?$", "".join(re.findall(r"```\{toctree\}(.*?)```", index, re.S)), re.M))
        for path in (ROOT / "docs").rglob("*.md"):
            here = stage.place_of(path.relative_to(ROOT).as_posix())
            if here and here != "index.md" and not here.startswith("verification/"):
                self.assertIn(here[:-3], listed)


    def test_blocks_that_do_not_run_on_the_page_of_answers_stand_where_they_run(self):
        page = (ROOT / "docs/how.md").read_text()
        clients = (ROOT / "docs/clients.md").read_text()  # whose blocks install/clients runs
        blocks = re.findall(r"^```(\w+)\n(.*?)^```$", page, re.M | re.S)
        self.assertGreater(sum(kind in ("python", "sh", "c") for kind, _ in blocks), 40)
        for kind, text in blocks:
            if kind not in ("python", "sh", "c", "text"):
                self.assertIn(f"```{kind}\n{text}```", clients)

    def test_every_question_has_a_short_answer_with_code(self):
        answers = re.split(r"^### ", (ROOT / "docs/how.md").read_text(), flags=re.M)[1:]
        self.assertGreaterEqual(len(answers), 30)
        for answer in answers:
            self.assertRegex(answer, r"^How do I [^\n]+\?\n")
            self.assertIn("\n```", answer)
            for kind, text in re.findall(r"^```(\w+)\n(.*?)^```$", answer, re.M | re.S):
                self.assertLessEqual(len(text.splitlines()), 12, answer[:60])


class Options(unittest.TestCase):
    """Pages of the programs, from what --help says."""

    HELP = """Usage: mps-x [options]
A program: more
of it. And this.

Soil
  --young [Pa]                    Young's modulus E (in [0.001, 1e16]; default 1 MPa)
  --cone inscribed|planestrain
                                  how the cone meets phi (of a plane), else
                                  otherwise (default inscribed)

Numbers are in the unit shown.

Help
  --help                          show this text
"""

    def test_sections_options_ranges_and_notes(self):
        usage, what, sections, notes = options.parse(self.HELP)
        self.assertEqual((usage, what, notes), ("mps-x [options]", "A program: more of it. And this.", "Numbers are in the unit shown."))
        self.assertEqual([heading for heading, _ in sections], ["Soil", "Help"])
        young, cone = sections[0][1]
        self.assertEqual((young.name, young.value, young.help, young.range),
                         ("--young", "[Pa]", "Young's modulus E", "in [0.001, 1e16]; default 1 MPa"))
        self.assertEqual((cone.name, cone.value, cone.help, cone.range),
                         ("--cone", "inscribed|planestrain", "how the cone meets phi (of a plane), else otherwise", "default inscribed"))

    def test_options_without_a_heading(self):
        _, _, sections, _ = options.parse("Usage: x FILE\nShows.\n\n  --json    as JSON\n")
        self.assertEqual([(heading, [row.name for row in rows]) for heading, rows in sections], [("Options", ["--json"])])

    def test_every_program_has_examples_of_its_manual_page(self):
        for path in sorted((ROOT / "programs").glob("mps-*.c")):
            found = options.examples(ROOT, path.stem)
            self.assertTrue(found, path.stem)
            self.assertTrue(all(command.startswith(path.stem) for _, command in found), found)

    def test_links_of_the_gallery_lead_out_of_the_folder(self):
        part = options.gallery(ROOT, "mps-pile")
        self.assertIn("](../jobs/pile.md)", part)
        self.assertIn("](../images/pile.png)", part)


class PythonReference(unittest.TestCase):
    def test_every_method_function_and_constant_of_the_stubs_is_on_a_page(self):
        pages = {}
        count = python_reference.stage(ROOT, lambda name, text: pages.setdefault(name, text))
        text = "\n".join(pages.values())
        self.assertGreater(count, 250)
        self.assertEqual(count, len(re.findall(r"^ *\.\. py:(?:method|property|function)::", text, re.M))
                         - len(re.findall(r"^ *\.\. py:method::", pages["python-api/base.rst"], re.M)))
        for name in ("py:method:: step(", "py:function:: version(", "py:attribute:: FRICTIONAL", "py:class:: MohrCoulomb",
                     "py:property:: totals", "``courant``"):
            self.assertIn(name, text)
        self.assertNotIn("mps_mpm_def_init", text)


class Equations(unittest.TestCase):
    def test_numbers(self):
        self.assertEqual(equations.numbers(" (28) to (31)"), [("", 28, ""), ("", 29, ""), ("", 30, ""), ("", 31, "")])
        self.assertEqual(equations.numbers(" (49), (50)"), [("", 49, ""), ("", 50, "")])
        self.assertEqual(equations.numbers(" (A8)"), [("A", 8, "")])

    def test_an_equation_is_found_in_the_function_that_computes_it(self):
        found = equations.collect(ROOT)
        place, = {p for p in found[("Nakamura", ("", 31, ""))] if p[0] == "src/contact/friction.c"}
        text = (ROOT / place[0]).read_text()
        self.assertIn("(31)", text[text.index(place[1] + "("):].split("\n}")[0])


class Programs(unittest.TestCase):
    def test_numbers_agree_within_a_percent_and_words_exactly(self):
        self.assertIsNone(programs.agree("force 100.0 N", "force 100.9 N\n"))
        self.assertIsNone(programs.agree("ratio 0.71", "ratio 0.72"))
        self.assertEqual(programs.agree("force 100.0 N", "force 103.0 N"), ("force 100.0 N", "force 103.0 N"))
        self.assertEqual(programs.agree("force 100.0 N", "load 100.0 N"), ("force 100.0 N", "load 100.0 N"))
        self.assertEqual(programs.agree("a 1", "a 1\nb 2"), ("nothing", "b 2"))


class Notebooks(unittest.TestCase):
    def test_pages_become_notebooks(self):
        text = "# A\n\n![p](../images/p.png)\n\nSee [b](b.md), [c](https://c.org).\n\n```sh\nls\n```\n\n```text\nx\n```\n\n```python\na = 1\n```\n\nEnd.\n"
        found = notebooks.notebook(text)
        self.assertEqual([(c["cell_type"], "".join(c["source"])) for c in found["cells"]],
                         [("markdown", "# A\n\n\nSee b, [c](https://c.org)."), ("code", "%%bash\nls"), ("code", "a = 1"), ("markdown", "End.")])
        self.assertEqual(found["cells"][1]["outputs"][0]["text"], ["x\n"])
        self.assertIsNone(notebooks.notebook("```c\nint a;\n```\n```python\n```\n"))

    def test_all_programs_of_the_jobs_are_in_them(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder)
            for page in [*(ROOT / "docs/jobs").glob("*.md"), ROOT / "docs/tutorial/python.md"]:
                (out / page.relative_to(ROOT / "docs")).parent.mkdir(exist_ok=True)
                (out / page.relative_to(ROOT / "docs")).write_text(page.read_text())
            made = notebooks.stage(ROOT, out)
            self.assertIn("jobs/short", made)
            self.assertGreater(len(made), 5)
            for name in made:
                text = (ROOT / "docs" / f"{name}.md").read_text()
                cells = json.loads((out / f"{name}.ipynb").read_text())["cells"]
                code = ["".join(c["source"]) for c in cells if c["cell_type"] == "code"]
                blocks = [(kind, body) for kind, body, _ in programs.Page(name).blocks if kind in ("sh", "python")]
                self.assertEqual(code, [("%%bash\n" if kind == "sh" else "") + body.strip("\n") for kind, body in blocks], name)
                self.assertIn(f"notebook <{name.split('/')[1]}.ipynb>", (out / f"{name}.md").read_text())
                self.assertIn(text.splitlines()[0], "".join(cells[0]["source"]))


if __name__ == "__main__":
    unittest.main()
