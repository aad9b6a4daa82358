"""The Python package as people use it: docstrings and stubs from the headers, what objects show, laws on arrays and
compiled laws against the library's own, exceptions with their traceback, arrays that C fills, pictures."""

import ast
import builtins
import importlib.util
import inspect
import pathlib
import re
import tempfile
import traceback
import unittest

import numpy as np

import libmps as mps

YOUNG, POISSON = 1e6, 0.3
LAMBDA = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
SHEAR = YOUNG / 2 / (1 + POISSON)


def has(name):
    return importlib.util.find_spec(name) is not None


class NullTest(unittest.TestCase):
    def test_every_function_names_what_is_null(self):
        """Of C: what is called with zeros alone has a record on the thread, by its public name."""
        from libmps import _cdef
        from libmps._library import ffi, library
        tried = 0
        for name in sorted(_cdef.PARAMETERS):
            function = getattr(library, name, None)
            if name == "mps_def_init" or name.startswith("mps_petsc") or function is None or ffi.typeof(function).result.kind != "enum":
                continue
            zeros = [0 if kind.kind in ("primitive", "enum") else ffi.NULL for kind in ffi.typeof(function).args]
            library.mps_context_clear_error(ffi.NULL)
            status, record = function(*zeros), library.mps_context_error(ffi.NULL)
            if status == 0:
                self.assertEqual(name, "mps_recorder_close")  # which accepts NULL, as what destroys does
                continue
            tried += 1
            self.assertEqual(record.status, status, name)
            self.assertIn("NULL", ffi.string(record.message).decode(), name)
            said = name.removesuffix("_sized")  # of a solver that is NULL the kind is not known
            shared = re.sub("^mps_(mpm|dynamics|elastic|fluid)_", "mps_solver_", said)
            shared = re.sub("_(add|set|remove|get)_(boundary|load)$", r"_\1", shared)
            self.assertIn(ffi.string(record.function).decode(), (said, shared))
        self.assertGreater(tried, 200)


def block(context, spacing=0.1):
    sand = mps.Particles(spacing=spacing, context=context)
    sand.fill_box([0.0, 5.0], [1.0, 6.0])
    sand["density"] = 1800.0
    sand.add_field("velocity", 0)
    with sand.edit("velocity") as v:
        v[:, 0] = np.sin(3 * np.array(sand["position"])[:, 1])
        v[:, 1] = np.cos(2 * np.array(sand["position"])[:, 0])
    return sand


def stress_after(law_of, steps=20, threads=1):
    context = mps.Context(threads=threads)
    sand = block(context)
    solver = mps.Mpm(sand, law_of(context), cell=0.2, dt=5e-4)
    solver.step(steps)
    return np.array(sand["stress"])[np.argsort(sand["id"])]


def own(context):
    return mps.LinearElastic(YOUNG, POISSON)


class Documents(unittest.TestCase):
    def test_help_tells_units_shapes_and_errors(self):
        text = inspect.getdoc(mps.Mpm.step)
        self.assertIn("DivergedError", text)
        self.assertIn("mps_mpm_step", text)
        self.assertEqual(str(inspect.signature(mps.Mpm.step)), "(self, count: int = 1) -> None")
        create = inspect.getdoc(mps.Mpm)
        self.assertRegex(create, r"gravity \(Sequence.*\): m/s2, default 0")
        found = inspect.signature(mps.Mpm).parameters
        self.assertEqual((found["geometry"].default, found["courant"].default, found["budget"].default), ("plane_strain", 0.5, 0))
        self.assertEqual(inspect.signature(mps.Fluid).parameters["gravity"].default, (0.0, -9.81, 0.0))
        self.assertIn("Creates a solver", create)
        self.assertIn("Time (s)", mps.Solver.time.__doc__)

    def test_every_method_has_a_docstring_of_its_header(self):
        count = 0
        for made in mps._objects.classes.values():
            for name, found in vars(made).items():
                if getattr(getattr(found, "fget", found), "__module__", "") == "libmps" and not inspect.isclass(found) and name[0] != "_":
                    self.assertIn("C: ", found.__doc__, f"{made.__name__}.{name}")
                    self.assertGreater(len(found.__doc__.split("C: ")[0].split()), 1, f"{made.__name__}.{name}")
                    count += 1
        self.assertGreater(count, 230)

    def test_completion_has_methods_and_constants(self):
        self.assertIn("add_contact", dir(mps.Mpm))
        self.assertLess({"Dof", "Mpm", "Particles", "Error", "MpmGeometry", "MohrCoulomb", "__version__"}, set(dir(mps)))

    def test_version(self):
        self.assertEqual(mps.__version__, mps.version())

    def test_stubs_agree_with_the_package(self):
        """Each name and class of the stubs exists and has the methods that they name, and the other way round."""
        stubs = ast.parse(pathlib.Path(mps.__file__).with_name("__init__.pyi").read_text())
        classes = {node.name: node for node in stubs.body if isinstance(node, ast.ClassDef)}
        named = {node.target.id for node in stubs.body if isinstance(node, ast.AnnAssign)}
        named |= {node.name for node in stubs.body if isinstance(node, ast.FunctionDef)} | set(classes)
        self.assertEqual((set(dir(mps)) - named, named - set(dir(mps))), (set(), set()))
        for name, made in {m.__name__: m for m in mps._objects.classes.values()}.items():
            stubbed = {n.name for n in classes[name].body if isinstance(n, ast.FunctionDef)}
            there = {n for n, f in vars(made).items() if inspect.isfunction(f) and f.__module__ == "libmps"}
            self.assertLessEqual({n for n in stubbed if not n.startswith("__")}, set(dir(made)), name)
            self.assertEqual(there - stubbed, set(), name)
        for name in classes:
            self.assertTrue(inspect.isclass(getattr(mps, name)), name)
        self.assertTrue(pathlib.Path(mps.__file__).with_name("py.typed").exists())

    def test_stubs_name_nothing_that_they_lack(self):
        stubs = ast.parse(pathlib.Path(mps.__file__).with_name("__init__.pyi").read_text())
        known = set(dir(builtins))
        for node in ast.walk(stubs):
            if isinstance(node, ast.ClassDef):
                known.add(node.name)
            elif isinstance(node, (ast.Import, ast.ImportFrom)):
                known.update(name.asname or name.name for name in node.names)
            elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                known.add(node.target.id)
            elif isinstance(node, ast.Assign):
                known.update(target.id for target in node.targets if isinstance(target, ast.Name))
        setters = {id(d.value) for node in ast.walk(stubs) if isinstance(node, ast.FunctionDef) for d in node.decorator_list
                   if isinstance(d, ast.Attribute)}
        named = {node.id for node in ast.walk(stubs) if isinstance(node, ast.Name) and id(node) not in setters}
        self.assertGreater(len(named), 30)
        self.assertEqual(named - known, set())


class Shown(unittest.TestCase):
    def test_objects_say_what_they_are(self):
        context = mps.Context(threads=1)
        sand = block(context)
        solver = mps.Mpm(sand, own(context), cell=0.2, dt=1e-3)
        solver.step(3)
        self.assertEqual(repr(solver), "<libmps Mpm: 100 particles, t = 0.003 s, 3 steps>")
        self.assertRegex(repr(sand), r"^<libmps Particles: 100 particles in 2D, spacing 0.1 m, fields id, position")
        self.assertRegex(repr(solver.totals), r"^Totals\(")
        html = sand._repr_html_()
        self.assertIn("<td style='text-align:left'>1800 to 1800</td>", html)
        self.assertIn("kg/m3", html)
        table = solver.totals._repr_html_()
        self.assertIn("<td style='text-align:left'>mass</td><td style='text-align:left'>1800</td>", table)
        self.assertEqual(repr(context), f"<libmps Context: libmps {mps.version()}, 1 thread>")
        edit = sand.edit("velocity")
        self.assertEqual(repr(edit), "<libmps Edit of 'velocity': open>")
        edit.abandon()
        self.assertIn("abandoned", repr(edit))
        self.assertEqual(repr(mps.Kernel("mps", 0.25, context=context)), "<libmps Kernel: radius 0.25 m>")
        solver.close()
        self.assertEqual(repr(solver), "<libmps Mpm, closed>")
        self.assertIn("closed", solver._repr_html_())


class Filled(unittest.TestCase):
    def test_arrays_that_c_fills_are_returned(self):
        context = mps.Context(threads=1)
        sand = block(context)
        ids = sand.select_box([0, 5], [0.3, 5.2])
        x = np.array(sand["position"])
        np.testing.assert_array_equal(ids, np.flatnonzero((x[:, 0] <= 0.3) & (x[:, 1] <= 5.2)))
        self.assertEqual(len(sand.select_box([7, 7], [8, 8])), 0)
        disc = mps.Disc(1.0, context=context)
        distance, normal, foot, face = disc.distance([[3.0, 0.0], [0.0, 0.5]])
        np.testing.assert_allclose(distance, [2.0, -0.5], atol=1e-12)
        np.testing.assert_allclose(normal, [[1, 0], [0, 1]], atol=1e-12)
        self.assertEqual((foot.shape, face.shape, face.dtype), ((2, 2), (2,), np.int64))

    def test_ids_say_how_many_they_are(self):
        context = mps.Context(threads=1)
        sand = block(context)
        solver = mps.Mpm(sand, own(context), cell=0.2, dt=1e-3)
        solver.add_boundary(ids=sand["id"])
        solver.step(10)
        self.assertEqual(float(abs(sand["velocity"]).max()), 0.0)
        with self.assertRaisesRegex(TypeError, "has no keyword 'id_count'"):
            solver.add_boundary(ids=sand["id"], id_count=101)


class Laws(unittest.TestCase):
    def test_a_law_on_arrays_is_the_librarys_own(self):
        shapes = set()

        def update(block):
            shapes.add((block.gradient.shape[0], block.stress.shape[0], block.dim))
            g, s, dt = block.gradient, block.stress, block.dt
            s[:3] += LAMBDA * dt * (g[0] + g[4] + g[8])
            s[0] += 2 * SHEAR * dt * g[0]
            s[1] += 2 * SHEAR * dt * g[4]
            s[3] += SHEAR * dt * (g[1] + g[3])

        def law(context):
            return mps.UserMaterial(update=update, name="mine", shear_modulus=SHEAR,
                                                bulk_modulus=LAMBDA + 2 * SHEAR / 3)

        expected = stress_after(own)
        self.assertGreater(abs(expected).max(), 1e3)
        for threads in (1, 2):
            np.testing.assert_allclose(stress_after(law, threads=threads), expected, atol=1e-9 * abs(expected).max())
        self.assertEqual(shapes, {(9, 4, 2)})

    def test_wrong_moduli_name_the_callback(self):
        for wrong in (None, "stiff", np.zeros(3)):
            with self.assertRaisesRegex(TypeError, "'moduli' of a law returned .*: must return K . 4G/3 of each of the"):
                stress_after(lambda c: mps.UserMaterial(update=lambda b: None, moduli=lambda b: wrong, name="m", bulk_modulus=YOUNG,
                                                        shear_modulus=SHEAR), steps=2)

    def test_arrays_of_a_block_outlive_the_law(self):
        kept = []

        def update(block):
            kept.append((block.stress, block.gradient, block.ids))

        stress_after(lambda c: mps.UserMaterial(update=update, name="keep", wave_modulus=1e6), steps=2)
        for stress, gradient, ids in kept:
            self.assertTrue(stress.base is None and stress.flags.owndata)
            self.assertTrue(np.isfinite(gradient).all() and (ids >= 0).all())

    def test_a_block_that_is_kept_gives_nothing_more(self):
        kept = []

        def update(b):
            if len(kept) == 1:
                kept.append(b)
                raise ZeroDivisionError
            kept.append(b)
            b.stress[0] += 0.0

        context = mps.Context(threads=1)
        solver = mps.Mpm(block(context), mps.UserMaterial(
            update=update, name="kept", bulk_modulus=YOUNG, shear_modulus=SHEAR), cell=0.2, dt=5e-4)
        with self.assertRaises(ZeroDivisionError):
            solver.step(1)
        for b in kept[:2]:  # one has returned, the other raised
            self.assertGreater(b.count, 0)
            for name in ("gradient", "ids", "history", "position", "volume_ratio", "flags"):
                with self.assertRaises(mps.StaleError, msg=name):
                    getattr(b, name)
        stress = kept[0].stress  # taken in the law
        self.assertEqual(stress.shape, (4, kept[0].count))
        before = stress.copy()
        for name in ("stress", "history", "volume_ratio", "flags"):
            with self.assertRaises(mps.StaleError, msg=name):
                setattr(kept[0], name, 1)
        np.testing.assert_array_equal(stress, before)

    def test_history_and_assignment(self):
        def update(block):
            block.history[0] += block.dt
            block.stress = 7.0
            block.stress[3] = 0.0

        context = mps.Context(threads=1)
        sand = block(context)
        law = mps.UserMaterial(update=update, name="clock", history=["age"],
                                           wave_modulus=1e6)
        solver = mps.Mpm(sand, law, cell=0.2, dt=1e-3)
        solver.step(5)
        np.testing.assert_allclose(sand["clock.age"], 5e-3, rtol=1e-12)
        np.testing.assert_array_equal(sand["stress"][:, 1], 7.0)

    def test_an_exception_has_the_lines_of_the_law(self):
        def update(block):
            depth = 0
            return 1 / depth

        lines = ""
        try:
            stress_after(lambda c: mps.UserMaterial(update=update, name="bad", wave_modulus=1e6))
        except ZeroDivisionError as caught:
            lines = "".join(traceback.format_tb(caught.__traceback__))
        self.assertIn("return 1 / depth", lines)
        self.assertIn("in update", lines)

    @unittest.skipUnless(has("numba"), "numba is not installed")
    def test_a_compiled_law_is_the_librarys_own(self):
        from libmps import compiled

        @compiled.law
        def elastic(dt, gradient, stress, volume_ratio, history):
            for k in range(len(volume_ratio)):
                spherical = LAMBDA * dt * (gradient[0][k] + gradient[4][k])
                stress[0][k] += spherical + 2 * SHEAR * dt * gradient[0][k]
                stress[1][k] += spherical + 2 * SHEAR * dt * gradient[4][k]
                stress[2][k] += spherical
                stress[3][k] += SHEAR * dt * (gradient[1][k] + gradient[3][k])

        @compiled.law(history=1)
        def refusing(dt, gradient, stress, volume_ratio, history):
            for k in range(len(volume_ratio)):
                history[0][k] += 1
                if history[0][k] == 3:
                    return k

        expected = stress_after(own)
        for threads in (1, 2):
            computed = stress_after(lambda c: mps.UserMaterial(
                update=elastic, name="mine", shear_modulus=SHEAR, bulk_modulus=LAMBDA + 2 * SHEAR / 3), 20, threads)
            np.testing.assert_allclose(computed, expected, atol=1e-9 * abs(expected).max())
        with self.assertRaisesRegex(mps.Error, "refused particle"):
            stress_after(lambda c: mps.UserMaterial(update=refusing, name="no", history=["n"],
                                                          wave_modulus=1e6))


@unittest.skipUnless(has("matplotlib"), "matplotlib is not installed")
class Pictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        import matplotlib

        matplotlib.use("Agg")

    def tearDown(self):
        import matplotlib.pyplot

        matplotlib.pyplot.close("all")

    def drawn(self, ax):
        """The picture as an array of pixels, RGB."""
        ax.figure.canvas.draw()
        return np.asarray(ax.figure.canvas.buffer_rgba())[:, :, :3].astype(int)

    def test_particles_cover_their_area_in_the_colours_of_a_field(self):
        from libmps import plot

        context = mps.Context(threads=1)
        sand = block(context)
        ax = plot.particles(sand, np.array(sand["position"])[:, 0], limits=(0, 1), cmap="gray")
        pixels = self.drawn(ax)
        to_pixel = ax.transData.transform
        for x in (0.25, 0.75):
            for y in (5.25, 5.75):
                column, row = to_pixel((x + 0.001, y + 0.001))
                seen = pixels[pixels.shape[0] - 1 - int(row), int(column)]
                self.assertAlmostEqual(seen[0] / 255, round(x * 10 + 0.5) / 10 - 0.05, delta=0.02)
        column, row = to_pixel((1.04, 5.5))
        self.assertEqual(pixels[pixels.shape[0] - 1 - int(row), int(column)].tolist(), [255, 255, 255])

    def test_neighbours_that_move_apart_leave_no_white_lines(self):
        """Squares whose edges round to other pixels than their neighbours' do, in a block that has been strained a little."""
        from libmps import plot

        context = mps.Context(threads=1)
        sand = block(context, spacing=0.05)
        solver = mps.Mpm(sand, own(context), cell=0.1, dt=5e-4)
        solver.step(40)
        ax = plot.particles(sand, "velocity")
        pixels = self.drawn(ax)
        x = np.array(sand["position"])
        (left, low), (right, high) = (ax.transData.transform(x[k]) for k in (x.sum(axis=1).argmin(), x.sum(axis=1).argmax()))
        margin = 0.1 * (right - left)
        rows = slice(int(pixels.shape[0] - high + margin), int(pixels.shape[0] - low - margin))
        inside = pixels[rows, int(left + margin):int(right - margin)]
        self.assertGreater(inside.size, 10000)
        self.assertEqual(int((inside.min(axis=2) == 255).sum()), 0)

    def test_squares_are_deformed(self):
        """A homogeneous simple shear: the parallelograms have the corners of F times the square."""
        from libmps import plot

        context = mps.Context(threads=1)
        sand = block(context)
        context_law = mps.NeoHookean(1e5, 0.3)
        mps.Mpm(sand, context_law, cell=0.2)
        with sand.edit("deformation_gradient") as f:
            f[:] = [1, 0.5, 0, 1, 1]
        corners = plot.particles(sand).collections[0].get_paths()[0].vertices[:4]
        edges = np.diff(corners, axis=0)
        np.testing.assert_allclose(edges[:2], [[0.1, 0.0], [0.05, 0.1]], atol=1e-12)

    def test_bodies_planes_and_curves(self):
        from libmps import plot

        context = mps.Context(threads=1)
        ball = mps.Particles(dim=3, spacing=0.2, context=context)
        ball.fill_ball([0, 0, 0], 1.0)
        sphere = mps.Sphere(0.5, position=[0, 0, 1.0], context=context)
        pixels = self.drawn(plot.particles(ball, plane=("y", 0.1), bodies=[sphere]))
        grey = (abs(pixels - 191) <= 1).all(axis=2).sum()
        blue = (pixels == [31, 119, 180]).all(axis=2).sum()
        self.assertGreater(grey, 1000)
        self.assertGreater(blue, 4 * grey)
        ax = plot.curve([0, 1, 2], [0, 1, np.nan], theory=0.5, label="computed")
        self.assertEqual([line.get_label() for line in ax.lines], ["computed", "theory"])
        for wrong in (lambda: plot.particles(ball), lambda: plot.particles(ball, plane=("y", 9)),
                      lambda: plot.particles(ball, [1.0], plane=("y", 0.1)),
                      lambda: plot.particles(ball, ("position", 3), plane=("y", 0.1)),
                      lambda: plot.curve([0, 1], [0]), lambda: plot.curve([0, 1], [0, 1], theory=[1])):
            with self.assertRaises(ValueError):
                wrong()
        with self.assertRaises(mps.Error):
            plot.particles(ball, "no_such_field", plane=("y", 0.1))

    def test_an_animation_has_its_frames(self):
        from PIL import Image

        from libmps import plot

        context = mps.Context(threads=1)
        sand = block(context)
        solver = mps.Mpm(sand, own(context), cell=0.2, dt=1e-3)
        with tempfile.TemporaryDirectory() as folder:
            path = f"{folder}/fall.gif"
            plot.animation(path, solver, 0.02, 3, lambda ax: plot.particles(sand, "velocity", ax=ax), size=(3, 3))
            with Image.open(path) as picture:
                self.assertEqual(picture.n_frames, 3)
            self.assertAlmostEqual(solver.time, 0.02, delta=1e-12)
            with self.assertRaisesRegex(ValueError, "must end in .gif or .mp4"):
                plot.animation(f"{folder}/fall.png", solver, 0.03, 3, print)


if __name__ == "__main__":
    unittest.main()
