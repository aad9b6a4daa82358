"""The package as Python: keywords, classes, one default context, names of choices, texts with units, properties, errors by
kind, selections, tables of other packages."""

import contextlib
import copy
import gc
import importlib.util
import inspect
import io
import os
import pathlib
import pickle
import re
import subprocess
import sys
import tempfile
import types
import unittest
import warnings
from unittest import mock

import numpy as np

import libmps as mps
from libmps import _quantities, _tables


def block(**more):
    sand = mps.Particles(spacing="100 mm", **more)
    sand.fill_box(lo=[0, 0], hi=[1, 1])
    sand["density"] = 1800
    return sand


def resting(sand, **more):
    return mps.Mpm(sand, mps.LinearElastic(young="10 MPa", poisson=0.3), **{"cell": 0.2, "lower": [0, 0], "gravity": [0, -9.81, 0], **more})


class Calls(unittest.TestCase):
    def test_keywords_and_their_defaults(self):
        solver, seen = resting(block()), []
        solver.step()
        solver.step(count=2)
        self.assertEqual(solver.steps, 3)
        solver.run(t_end="20 ms", callback=lambda s: seen.append(s.steps))
        self.assertEqual(seen, list(range(3, solver.steps + 1)))
        self.assertEqual(solver.time, 0.02)
        self.assertEqual(str(inspect.signature(mps.Fluid.run)), "(self, t_end: float | str, every: int = 1, callback: "
                         "Callable[..., Any] | None = None, *, progress: bool = False) -> None")

    def test_one_context_for_what_is_given_none(self):
        sand, other = block(), mps.Context(threads=1)
        self.assertIs(sand.context, mps.default_context())
        self.assertIs(mps.Disc(0.1).context, mps.default_context())
        self.assertIs(block(context=other).context, other)
        self.assertIs(resting(block(context=other)).context, other)  # that of the set
        before = mps.default_context()
        after = mps.default_context(threads=1)
        self.assertEqual((after.threads, mps.Disc(0.1).context), (1, after))
        self.assertIs(sand.context, before)
        with self.assertRaisesRegex(TypeError, "'context' is 3, must be a Context"):
            mps.Disc(0.1, context=3)
        other.close()
        with self.assertRaises(mps.StateError):
            mps.Disc(0.1, context=other)

    def test_classes(self):
        self.assertTrue(issubclass(mps.MohrCoulomb, mps.Material) and issubclass(mps.Elastic, mps.Solver))
        law = mps.MohrCoulomb(young="20 MPa", friction="30 deg", cohesion="5 kPa")
        self.assertEqual(law.name, "mohr_coulomb")
        for kind, ways in ((mps.Material, "ByField, CamClay"), (mps.Contact, "a method of another"), (mps.Body, "Box, Cylinder")):
            with self.assertRaisesRegex(TypeError, f"is made by {ways}"):
                kind()

    def test_a_class_of_your_own(self):
        class Named(mps.Mpm):
            def __init__(self, name, *values, **keywords):
                super().__init__(*values, **keywords)
                self.name = name

        solver = Named("first", block(), mps.LinearElastic(1e6, 0.3), cell=0.2)
        solver.run(0.01, callback=lambda s: self.assertIs(s, solver))
        self.assertEqual((solver.name, repr(solver)[:14]), ("first", "<libmps Named:"))

    def test_lengths_and_selections(self):
        sand = block()
        self.assertEqual(sand.fill_polygon([[2, 0], [3, 0], [3, 1]]), sand.count - 100)
        sand["density"] = 1800
        solver = resting(sand)
        by_box = solver.add_boundary(box=([0, 0], [1, "200 mm"]), kind="held")
        by_all = solver.add_boundary(all=True, kind="held")
        by_ids = solver.add_boundary(ids=sand.select_box([0, 0], [0.3, 0.3]), kind="held", dofs="x")
        found = solver.get_boundary(by_ids)
        np.testing.assert_array_equal(found.ids, sand.select_box([0, 0], [0.3, 0.3]))
        self.assertEqual(list(solver.get_numbers("boundary")[-3:]), [by_box, by_all, by_ids])
        solver.set_boundary(by_ids, found)  # as it is
        self.assertEqual(solver.get_boundary(by_ids).dofs, mps.Dof.X)
        self.assertEqual(list(solver.get_boundary(by_box).upper[:2]), [1.0, 0.2])
        with self.assertRaisesRegex(ValueError, "'box' .*must be two corners"):
            solver.add_boundary(box=[[0, 0]])
        law = mps.NeoHookean(young=1e6, poisson=0.3)
        solver.set_material(law, ids=[1, 2])
        solver.set_material(law, box=([None, None], [0.5, 0.5]))
        self.assertEqual(len(solver._held["set_material"]), 1)
        solver.set_material(law)
        with self.assertRaisesRegex(ValueError, "one of 'ids', 'box' and 'all' selects"):
            solver.set_material(law, ids=[1], all=True)
        sand.remove(box=([2, None], None))
        self.assertEqual(len(sand), 100)
        sand.remove(all=True)
        self.assertEqual(len(sand), 0)

    def test_a_number_is_no_array(self):
        beam = mps.Particles(spacing=0.1)
        beam.fill_box([0, 0], [1, 0.5])
        beam["young"], beam["poisson"] = 1e7, 0.3
        solver = mps.Elastic(beam)
        top = solver.select_facets("y_upper")
        for call, name in ((lambda: beam.remove(3), "'ids' is 3"), (lambda: mps.Table("displacement", 0, [0, 1]), "'times' is 0"),
                           (lambda: solver.add_load(kind="pressure", ids=top, values=1e4), "'values' is 10000.0")):
            with self.assertRaisesRegex(TypeError, f"{name}: a list or an array is wanted"):
                call()
        self.assertEqual(len(beam), 50)

    def test_what_c_stores_stays(self):
        """A signal of Python that only the solver has."""
        solver, asked = resting(block()), []
        for k in range(3):
            solver.set_boundary("y_lower", kind="driven", signal=[None, mps.UserSignal("displacement", lambda t, k=k: asked.append(k) or (0, 0, 0)), None])
        gc.collect()
        [bytearray(10000) for _ in range(100)]
        solver.step(2)
        self.assertEqual(set(asked[-2:]), {2})
        self.assertLessEqual(len(solver._held), 2)


class Names(unittest.TestCase):
    def test_choices_by_name(self):
        solver = resting(block(), geometry="Plane Strain", volumetric="POINT")
        self.assertEqual(solver.definition.volumetric, mps.MpmVolumetric.POINT)
        solver.set_boundary(mps.Side.Y_LOWER, kind=mps.BoundaryKind.FRICTIONAL, friction=0.5)
        self.assertEqual(solver.get_boundary("y_lower").kind, mps.BoundaryKind.FRICTIONAL)
        with self.assertRaisesRegex(mps.ArgumentError, r"'kind' is 'frictionl', must be one of held, driven, .*\(is it 'frictional'\?\)"):
            solver.set_boundary("y_lower", kind="frictionl")
        with self.assertRaisesRegex(ValueError, "'number' is 'top', must be one of any, x_lower"):
            solver.set_boundary("top")
        with self.assertRaisesRegex(ValueError, "'kind' is 'frictional', must be one of held, roller"):  # not of a fluid's contact
            mps.Fluid(block(), level=1.0).add_contact(mps.Disc(0.1, position=[5, 5]), kind="frictional")

    def test_sides_by_name_are_bits(self):
        def pressures(sides):
            ground = mps.Particles(spacing=0.1)
            ground.fill_box([0, 0], [0.4, 1])
            ground["density"] = 2000.0
            solver = mps.Mpm(ground, mps.LinearElastic("1 MPa", 0.3), cell=0.2, lower=[0, 0, 0], upper=[0.4, 2, 0], gravity=[0, -9.81, 0])
            solver.add_pore_water(porosity=0.4, permeability=1e-3)
            solver.add_pore_face(kind="drained", sides=sides)
            solver.step(40)
            return np.array(ground["pore_pressure"])[np.argsort(np.array(ground["id"]))]

        top, across = pressures(1 << 3), pressures(3)
        self.assertGreater(abs(top - across).max(), 10.0)
        for sides in ("y_upper", mps.Side.Y_UPPER, ["y_upper"], (mps.Side.Y_UPPER,)):
            np.testing.assert_array_equal(pressures(sides), top)
        for sides in (["x_lower", "x_upper"], "X_LOWER X_UPPER".split()):
            np.testing.assert_array_equal(pressures(sides), across)
        np.testing.assert_array_equal(pressures("any"), pressures(0))
        with self.assertRaisesRegex(mps.ArgumentError, "'sides' is 'top', must be one of any, x_lower"):
            pressures("top")
        with self.assertRaisesRegex(TypeError, "names of sides are wanted"):
            pressures(8.0)

    def test_every_choice_has_its_number(self):
        for name, (_, prefix, constants, _) in _tables.ENUMS.items():
            members = getattr(mps, name).__members__
            self.assertEqual([int(m) for m in members.values()], [getattr(mps.library, c) for c in constants], name)
            self.assertFalse([m for m in members if m.startswith("MPS_")])
        self.assertGreater(len(_tables.ENUMS), 40)
        self.assertEqual(mps.Dof.X | mps.Dof.Y, 3)

    def test_messages_have_the_names_of_python(self):
        with self.assertRaises(mps.ArgumentError) as caught:
            resting(block()).set_boundary("y_lower", kind="roller", friction=0.5)
        self.assertIn("BoundaryKind.FRICTIONAL", str(caught.exception))
        self.assertNotIn("mps_", str(caught.exception))


class Quantities(unittest.TestCase):
    def test_units_are_those_of_the_programs(self):
        for text, unit, value in (("10MPa", "Pa", 1e7), ("5 mm", "m", 5e-3), ("180deg", "rad", np.pi), ("2 g/cm3", "kg/m3", 2000.0),
                                  ("1 psi", "Pa", 6894.757293168361), ("3", "m", 3.0), ("-1e3 kPa", "Pa", -1e6), ("30 %", "", 0.3),
                                  ("2 kg m2", "kg m2", 2.0), ("inf", "Pa", np.inf)):
            self.assertAlmostEqual(_quantities.si(text, unit, "x") if value != np.inf else 1.0, value if value != np.inf else 1.0,
                                   delta=1e-12 * abs(value) if value != np.inf else 0, msg=text)
        self.assertEqual(_quantities.si("inf", "Pa", "x"), np.inf)
        for text, unit, what in (("10 mm", "Pa", "a pressure is wanted .Pa, kPa"), ("3 Mpa", "Pa", "a pressure"), ("x", "m", "a number in m"),
                                 ("2 m", "", "a number without a unit"), ("1 m", "kg m2", "its unit is kg m2"), ("", "m", "a number in m")):
            with self.assertRaisesRegex(ValueError, what):
                _quantities.si(text, unit, "x")

    def test_everywhere(self):
        sand = mps.Particles(spacing="10 cm", origin=["5 mm", 0])
        with self.assertWarnsRegex(mps.Warning, "Particles.fill_box: the box asked for"):
            sand.fill_box([0, "0 m"], ["1 m", 1])
        sand.fill_ball(centre=["3 m", 0], radius="300 mm")
        self.assertEqual(sand.spacing, 0.1)
        sand["density"] = "1.8 t/m3"
        solver = mps.Mpm(sand, mps.LinearElastic("10 MPa", 0.3), cell="20 cm", gravity=[0, "-1 g", 0])
        self.assertEqual(solver.definition.gravity[1], -9.80665)
        solver.dt = "0.1 ms"
        self.assertEqual(solver.definition.dt, 1e-4)
        solver.dt = None
        self.assertTrue(np.isnan(solver.definition.dt))
        with self.assertRaisesRegex(mps.ArgumentError, r"^Mpm\(\): 'cell' is '2 s': a length is wanted \(m, mm, cm"):
            mps.Mpm(sand, mps.LinearElastic("10 MPa", 0.3), cell="2 s")


class Properties(unittest.TestCase):
    def test_questions_and_what_is_set(self):
        sand = block()
        solver = resting(sand)
        self.assertEqual((solver.time, solver.steps, len(sand), sand.dim, solver.particles), (0.0, 0, 100, 2, sand))
        self.assertAlmostEqual(solver.totals.mass, 1800.0, delta=1e-9)
        with self.assertRaises(AttributeError):
            solver.time = 1.0
        coupling = mps.Coupling(size=1, method="aitken")
        coupling.begin()
        while not coupling.next([1.0]).done:
            pass
        coupling.accept()
        memory = coupling.memory
        coupling.memory = memory
        np.testing.assert_array_equal(coupling.memory, memory)

    def test_fields_of_a_set(self):
        sand = block()
        self.assertIn("density", sand)
        self.assertNotIn("stress", sand)
        self.assertEqual(list(sand), ["id", "position", "density"])
        sand["velocity"] = [1, 0]
        sand["velocity", 1] = sand["position"][:, 0]
        np.testing.assert_array_equal(sand["velocity", 1], sand["position", 0])
        empty = mps.Particles(spacing=1)
        empty["density"] = 1.0
        self.assertEqual(empty["density"].shape, (0,))

    def test_to_pandas_and_xarray(self):
        sand = block()
        sand["velocity"] = [1, 2]
        for module, method in (("pandas", sand.to_pandas), ("xarray", sand.to_xarray)):
            if importlib.util.find_spec(module) is None:
                with self.assertRaisesRegex(ImportError, f"needs {module}, which is not installed"):
                    method()
                continue
            made = method("velocity", "density")
            if module == "pandas":
                self.assertEqual(list(made), ["velocity_x", "velocity_y", "density"])
                self.assertEqual((len(made), made["velocity_y"].iloc[5], made.index.name), (100, 2.0, "id"))
            else:
                self.assertEqual(made["velocity"].dims, ("particle", "axis"))
                self.assertEqual((made["velocity"].attrs["units"], float(made["velocity"].sel(axis="y").mean())), ("m/s", 2.0))


class Errors(unittest.TestCase):
    def test_kinds(self):
        kinds = {mps.ArgumentError: ValueError, mps.StateError: RuntimeError, mps.OutOfMemoryError: MemoryError, mps.FieldError: KeyError,
                 mps.FileError: OSError, mps.FormatError: ValueError, mps.DivergedError: ArithmeticError,
                 mps.UnsupportedError: NotImplementedError, mps.NumericError: ArithmeticError, mps.StaleError: mps.StateError}
        for kind, of in kinds.items():
            self.assertTrue(issubclass(kind, of) and issubclass(kind, mps.Error), kind)
        self.assertEqual(len(mps.Status) - 1, len({k for k in mps._errors.KINDS}))
        sand = block()
        with self.assertRaises(mps.FieldError) as caught:
            sand["nothing"]
        self.assertEqual(caught.exception.status, mps.Status.FIELD)
        self.assertRegex(str(caught.exception), "^Particles.*no field 'nothing'")
        with self.assertRaises(OSError):
            mps.Record("/nothing/there.csv")
        with self.assertRaisesRegex(mps.DivergedError, "Mpm.step") as caught:
            solver = resting(sand, lower=[0, 0.0], upper=[1, 1])
            sand["velocity"] = [1e3, 0]
            solver.step(10000)
        self.assertIn("position", sand)

    def test_a_name_that_a_result_or_set_lacks(self):
        sand = mps.Particles(spacing=0.1)
        sand.fill_box([0, 0], [0.4, 0.4])
        sand["density"] = 1800.0
        solver = mps.Mpm(sand, mps.LinearElastic("1 MPa", 0.3), cell=0.2)
        with self.assertRaisesRegex(AttributeError, r"^Totals has no 'kinetik' \(is it 'kinetic'\?\): it has mass"):
            print(solver.totals.kinetik)
        self.assertEqual(copy.copy(solver.totals).mass, solver.totals.mass)
        self.assertEqual(pickle.loads(pickle.dumps(solver.totals)).mass, solver.totals.mass)
        with self.assertRaisesRegex(mps.ArgumentError, "^goda_evaluate.*: width is not given .or NaN., must be in"):
            mps.goda_evaluate(height=1, period=5, depth=5, crest=2)
        with self.assertRaisesRegex(mps.FieldError, "no field 'temperature'.*the set has: id, position"):
            solver.record("heat", "temperature", at=[0, 0])

    def test_warnings_may_be_errors(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error", mps.Warning)
            solver = resting(block())
            self.assertIsNone(solver.step())


class Everything(unittest.TestCase):
    """What each kind of object answers, and arrays of all forms."""

    def test_properties_of_all_kinds(self):
        sand = block()
        solver, disc = resting(sand), mps.Disc(0.2, position=[0.5, 1.3])
        contact, waves = solver.add_contact(disc, friction=0.3), mps.Waves(kind="regular", depth=1, height=0.1, period=2)
        solver.step()
        ground = block()
        ground["shear_velocity"], ground["pressure_velocity"] = 100, 200
        kinds = [sand, solver, disc, contact, waves, mps.WavesSignal(waves), mps.Absorber(depth=1, period=2), mps.Kernel("mps", 0.3),
                 mps.Dynamics(ground), solver.grid, sand.context, solver.snapshot(), mps.LinearElastic(1e6, 0.3), mps.Coupling(size=2)]
        asked = 0
        for one in kinds:
            for name, found in inspect.getmembers(type(one), lambda member: isinstance(member, property)):
                try:
                    answer = getattr(one, name)
                except mps.StateError:  # no pore water, no budget, a wave is no record
                    continue
                self.assertFalse(repr(answer).startswith("<cdata"), f"{type(one).__name__}.{name}")
                asked += 1
        self.assertGreater(asked, 40)

    def test_arrays_of_elasticity(self):
        body = block()
        body["young"], body["poisson"] = "10 MPa", 0.3
        solver = mps.Elastic(body)
        solver.add_boundary(box=(None, [1, 0.1]))
        solver.add_load(kind="volume", all=True, force=[0, -1e4])
        solver.solve()
        self.assertAlmostEqual(solver.get_load_resultant().force[1], -1e4, delta=1e-6)
        self.assertAlmostEqual(solver.get_section(axis=1, position=0.5).force[1], -5e3, delta=1e-3)
        every, two = solver.get_facets(), solver.get_facets([0, 1])
        self.assertEqual((every.centre.shape, two.centre.shape), ((solver.facet_count, 3), (2, 3)))
        np.testing.assert_array_equal(two.centre, every.centre[:2])
        modes = solver.modes(3)
        self.assertEqual((modes.omega.shape, modes.shapes.shape), ((3,), (3, 100, 3)))
        loads = np.zeros((2, 100, 3))
        loads[1, 50, 1] = 1.0
        moved = solver.solve_cases(loads)
        self.assertEqual(moved.shape, (2, 100, 3))
        self.assertEqual(float(abs(moved[0]).max()), 0.0)
        self.assertGreater(moved[1, 50, 1], 0.0)

    def test_columns_of_numbers(self):
        solver = resting(block())
        written, asked = mps.History(solver, "mine", ["a", "b"], ["m", "kg"]), mps.History(solver, "other", ["mass"], ["kg"])
        written.record(0.5, [3.0, 4.0])
        self.assertEqual((written.count, written.view("b").tolist()), (1, [4.0]))
        asked.set_source("mass", lambda s: s.totals.mass)
        gc.collect()
        solver.step(2)
        written.close()
        with self.assertRaisesRegex(mps.ArgumentError, r"History\(\): 'units' has 1 values, and must have 2"):
            mps.History(solver, "third", ["a", "b"], ["m"])
        outside = block().set_table("pore_pressure", positions=[[0, 0], [1, 0], [0, 1]], values=[1, 2, 3])
        self.assertEqual(outside, 0)


class Runs(unittest.TestCase):
    def test_progress_is_a_line_and_leaves_the_hook(self):
        context, seen = mps.Context(threads=1), []
        context.set_progress(lambda state: seen.append(state.fraction))
        solver, said = resting(block(context=context)), io.StringIO()
        with mock.patch.dict(sys.modules, {"tqdm": None, "tqdm.auto": None}), contextlib.redirect_stderr(said):
            solver.run(0.01, progress=True)
        self.assertRegex(said.getvalue(), r"100 %, t = 0.01 s *\n$")
        self.assertEqual(seen, [])
        solver.run(0.02)
        self.assertEqual(seen[-1], 1.0)

    def test_progress_by_tqdm(self):
        bars = []

        class Bar:
            def __init__(self, **keywords):
                self.n, self.total = 0, keywords["total"]
                bars.append(self)

            def update(self, by):
                self.n += by

            def set_postfix_str(self, text, refresh):
                self.said = text

            def close(self):
                self.closed = True

        made = types.ModuleType("tqdm.auto")
        made.tqdm = Bar
        with mock.patch.dict(sys.modules, {"tqdm": types.ModuleType("tqdm"), "tqdm.auto": made}):
            resting(block()).run(0.01, progress=True)
        self.assertEqual((bars[0].n, bars[0].said, bars[0].closed), (100, "t = 0.01 s", True))


PROGRAM = """
import libmps as mps

sand = mps.Particles(spacing="10 mm")
sand.fill_box([0, 0], hi=[0.2, 0.4])
sand["density"] = 1600
law: mps.Material = mps.MohrCoulomb(young="1 MPa", friction="33 deg", tension=0)
solver = mps.Mpm(sand, law, cell=0.02, gravity=[0, -9.81, 0])
solver.set_boundary("y_lower", kind=mps.BoundaryKind.FRICTIONAL, friction=0.65)
solver.dt = "0.1 ms"


def seen(s: mps.Mpm) -> None:
    print(s.time, s.totals.kinetic, float(sand["velocity"][:, 1].mean()))


solver.run(t_end=0.6, every=10, callback=seen, progress=True)
solver.set_boundary("y_lower", knd="held")  # wrong
solver.tim  # wrong
"""


class Types(unittest.TestCase):
    @unittest.skipUnless(importlib.util.find_spec("mypy"), "mypy is not installed")
    def test_strict_types(self):
        """The stubs, and a program: its two mistakes, and no other."""
        package = pathlib.Path(mps.__file__).parent.parent
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "program.py")
            path.write_text(PROGRAM)
            done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--no-error-summary", f"--cache-dir={folder}/cache", str(path)],
                                  capture_output=True, text=True, cwd=folder,
                                  env={**{k: v for k, v in os.environ.items() if k != "PYTHONPATH"}, "MYPYPATH": str(package)})
        wrong = [k + 1 for k, line in enumerate(PROGRAM.splitlines()) if line.endswith("# wrong")]
        lines = [line for line in done.stdout.splitlines() if ": error:" in line]
        self.assertEqual([int(line.split(":")[1]) for line in lines], wrong, done.stdout + done.stderr)

    @unittest.skipUnless(importlib.util.find_spec("mypy"), "mypy is not installed")
    def test_programs_on_pages(self):
        """What the package is asked on a page has the types that the stubs say; functions of a page need none."""
        docs = pathlib.Path(__file__).resolve().parents[2] / "docs"
        pages = {"short": docs / "jobs/short.md", "guide": docs / "python.md", "readme": docs.parent / "README.md"}
        pages.update({f"page_{p.stem}": p for p in [docs / "clients.md", docs / "extend.md", docs / "tutorial/python.md", *(docs / "jobs").glob("*.md")]
                      if p.stem != "short"})
        with tempfile.TemporaryDirectory() as folder:
            for name, page in pages.items():
                blocks = re.findall(r"^```python\n(.*?)^```$", page.read_text(), re.M | re.S)
                if name == "short":  # a program each; the last block draws
                    for k, block in enumerate(blocks[:-1]):
                        pathlib.Path(folder, f"short{k}.py").write_text(block)
                elif blocks:  # the guide's first block is a program, the other pages are one together
                    pathlib.Path(folder, f"{name}.py").write_text(blocks[0] if name == "guide" else "\n".join(blocks))
            made = sorted(pathlib.Path(folder).glob("*.py"))
            self.assertGreater(len(made), 10)
            done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--allow-untyped-defs", "--allow-untyped-calls",
                                   "--ignore-missing-imports", "--disable-error-code=var-annotated", "--follow-imports=silent", "--no-error-summary",
                                   f"--cache-dir={folder}/cache", *map(str, made)], capture_output=True, text=True, cwd=folder,
                                  env={**{k: v for k, v in os.environ.items() if k != "PYTHONPATH"},
                                       "MYPYPATH": str(pathlib.Path(mps.__file__).parent.parent)})
        wrong = [line for line in done.stdout.splitlines() if ": error:" in line and "/libmps/" not in line]
        self.assertEqual(wrong, [], done.stderr)


class Import(unittest.TestCase):
    def test_nothing_is_parsed_at_import(self):
        code = "import sys, libmps; print(*[m for m in ('pycparser', 'cffi.cparser', 'matplotlib', 'pandas') if m in sys.modules])"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout.strip(), "")


if __name__ == "__main__":
    unittest.main()
