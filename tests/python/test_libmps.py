"""The Python package: values against theory, errors as exceptions, arrays that know when they are stale,
callbacks, and that every function and definition of the C headers is reachable."""

import copy
import gc
import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import types
import unittest
import warnings
from pathlib import Path

import numpy as np

import libmps as mps
from libmps import _cdef, _shapes
from libmps._call import Call, ffi, signature


def block(context, spacing=0.1):
    sand = context.particles_create(spacing=spacing)
    sand.fill_box([0.0, 5.0], [1.0, 6.0])
    sand.set("density", 0, 1800.0)
    return sand


def falling(context, sand, **more):
    law = context.material_create_linear_elastic(1e6, 0.3)
    return context.mpm_create(sand, law, **{"cell": 0.2, "gravity": [0, -9.81, 0], "dt": 1e-3, **more})


class Values(unittest.TestCase):
    def test_free_fall(self):
        context = mps.Context(threads=2)
        sand = block(context)
        solver = falling(context, sand)
        times = []
        solver.run(0.1, 10, lambda s: times.append(s.time()))
        np.testing.assert_allclose(times, 0.01 * np.arange(11), atol=1e-12)
        np.testing.assert_allclose(sand["velocity"][:, 1], -0.981, rtol=1e-12)
        totals = solver.get_totals()
        self.assertAlmostEqual(totals.mass, 1800.0, delta=1e-9)
        self.assertAlmostEqual(totals.linear[1], -0.981 * 1800.0, delta=1e-8)
        self.assertEqual(solver.get_def().cell, 0.2)

    def test_the_grid_is_lent(self):
        context = mps.Context()
        sand = block(context)
        solver = falling(context, sand)
        solver.step(1)
        grid = solver.grid()
        self.assertEqual(grid.kind, "grid")
        del solver
        gc.collect()
        self.assertEqual(grid.get_info().cell, 0.2)  # the grid keeps its solver
        count = grid.get_nodes(0, None, None, None, None)
        mass = np.zeros(count)
        grid.get_nodes(mass.size, None, mass, None, None)
        self.assertAlmostEqual(mass.sum(), 1800.0, delta=1e-9)
        v = np.zeros(2)
        grid.evaluate("velocity", -1, 1, [0.5, 5.5, 0.0], v, None)
        self.assertAlmostEqual(v[1], -9.81e-3, delta=1e-14)
        grid.close()

    def test_the_way_back_is_the_same_bit_for_bit(self):
        context = mps.Context(executor=mps.CONTEXT_EXECUTOR_SERIAL)
        sand = block(context)
        solver = falling(context, sand)
        solver.step(20)
        snapshot = solver.snapshot()
        solver.step(30)
        once = np.array(sand["position"])
        solver.rollback(snapshot)
        self.assertEqual(solver.steps(), 20)
        solver.step(30)
        self.assertTrue(np.array_equal(once, sand["position"]))

    @unittest.skipUnless(mps.library_has(mps.FEATURE_HDF5), "checkpoints need HDF5")
    def test_a_file_is_the_way_on_bit_for_bit(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "run.h5")
            context = mps.Context(executor=mps.CONTEXT_EXECUTOR_SERIAL)
            sand = block(context)
            solver = falling(context, sand)
            solver.step(20)
            solver.save(path, {"user_key": "mine"})
            solver.step(30)
            other = block(context)
            second = falling(context, other)
            info = second.restore(path)
            self.assertEqual((info.step, info.user_key, second.steps()), (20, "mine", 20))
            with self.assertRaisesRegex(ValueError, "'user_key' is 'x+': a text of less than 64 bytes"):
                solver.save(path, {"user_key": "x" * 64})
            with self.assertRaisesRegex(TypeError, "'info' is {'user_key': 7}"):
                solver.save(path, {"user_key": 7})
            self.assertEqual(context.checkpoint_info(path).step, 20)
            second.step(30)
            self.assertTrue(np.array_equal(sand["position"], other["position"]))

    def test_a_law_in_python(self):
        """Linear elasticity moves the particles as the library's own does, and counts its steps."""
        bulk, shear = 1e7 / 3.0 / (1 - 2 * 0.3), 1e7 / 2.0 / 1.3

        def update(block):
            rate = [[mps.column(block.gradient[3 * i + j], block.count) for j in range(2)]
                    for i in range(2)]
            stress = [mps.column(p, block.count) for p in block.stress[:4]]
            volume = block.dt * (rate[0][0] + rate[1][1])
            for i, d in enumerate((block.dt * rate[0][0], block.dt * rate[1][1], 0.0)):
                stress[i] += (bulk - 2.0 * shear / 3.0) * volume + 2.0 * shear * d
            stress[3] += shear * block.dt * (rate[0][1] + rate[1][0])
            mps.column(block.history[0], block.count)[:] += 1.0

        places = []
        for own in (False, True):
            context = mps.Context(threads=2)
            sand = block(context)
            law = context.material_create_user(
                update=update, name="python", history=["steps"], history_count=1,
                wave_modulus=bulk + 4.0 * shear / 3.0) if own else \
                context.material_create_linear_elastic(1e7, 0.3)
            sand.add_field("velocity", 0)
            with sand.edit("velocity") as v:
                v[:] = np.sin(3.0 * np.array(sand["position"]))
            solver = context.mpm_create(sand, law, cell=0.2, dt=2e-4)
            solver.step(50)
            places.append(np.array(sand["position"])[np.argsort(np.array(sand["id"]))])
        self.assertTrue(np.all(sand["python.steps"] == 50.0))
        np.testing.assert_allclose(places[0], places[1], rtol=0, atol=1e-13)
        self.assertGreater(np.abs(np.diff(places[0][:, 0])).max(), 0.1)

    def test_the_step_follows_the_moduli_of_a_law_in_python(self):
        """A law that stiffens by 99 times in 20 ms: the limit of the step falls to a tenth."""

        def update(block):
            g, s, stiffness = block.gradient, block.stress, 1e6 * (1 + 99 * block.history[0]) * block.dt
            s[:3] += stiffness / 3 * (g[0] + g[4])  # lambda = G = a third of K + 4G/3
            s[0] += 2 * stiffness / 3 * g[0]
            s[1] += 2 * stiffness / 3 * g[4]
            s[3] += stiffness / 3 * (g[1] + g[3])
            block.history[0] = min(1.0, block.time / 0.02)

        def made(moduli):
            context = mps.Context()
            law = context.material_create_user(update=update, history=["stiff"], history_count=1, wave_modulus=1e6,
                                               bulk_modulus=5e5, shear_modulus=1e6 / 3, moduli=moduli)
            return context.mpm_create(block(context), law, cell=0.2, gravity=[0, -9.81, 0])

        solver = made(lambda block: 1e6 * (1 + 99 * block.history[0]))
        first = solver.limit()
        solver.run(0.03, 1000000, None)
        self.assertAlmostEqual(first / solver.limit(), 10.0, delta=0.02)
        with self.assertRaisesRegex(TypeError, "returns K . 4G/3 of each particle"):
            made(lambda block: None).step(1)

    def test_a_struct_is_a_mapping_or_a_result(self):
        context = mps.Context()
        body = context.body_create_disc(0.1, position=[1.0, 2.0])
        body.set_motion({"velocity": [0.5, 0.0, 0.0]})
        self.assertEqual(list(body.get_state().velocity), [0.5, 0.0, 0.0])
        body.set_motion(types.MappingProxyType({"velocity": [0.25, 0.0, 0.0]}))
        self.assertEqual(list(body.get_state().velocity), [0.25, 0.0, 0.0])
        body.set_motion(mps.BodyMotion(velocity=[0.0, 3.0, 0.0]))
        state = body.get_state()
        self.assertEqual((list(state.velocity), list(state.position[:2])), ([0.0, 3.0, 0.0], [1.0, 2.0]))
        with self.assertRaisesRegex(TypeError, "no member 'velocty' .is it 'velocity'"):
            body.set_motion(mps.BodyMotion(velocty=[0.0, 3.0, 0.0]))

    def test_layers_are_dictionaries_and_hooks_are_functions(self):
        """Stress at rest under two layers; a warning through the log hook."""
        said = []
        context = mps.Context(threads=1, log=lambda level, text: said.append((level, text)))
        ground = context.particles_create(spacing=0.5)
        ground.fill_box([0, 0], [2, 4])
        ground.set_geostatic(gravity=10.0, surface=4.0, layer_count=2, layers=[
            {"thickness": 2.0, "k0": 0.5, "density": 1800.0},
            {"thickness": 2.0, "k0": 0.4, "density": 2000.0}])
        depth = 4.0 - ground["position"][:, 1]
        exact = np.where(depth < 2, 18e3 * depth, 36e3 + 20e3 * (depth - 2))
        np.testing.assert_allclose(ground["stress"][:, 1], -exact, rtol=1e-12)
        np.testing.assert_allclose(ground["stress"][:, 0],
                                   -np.where(depth < 2, 0.5, 0.4) * exact, rtol=1e-12)
        ground.set("shear_velocity", 0, 100.0)
        ground.set("pressure_velocity", 0, 200.0)
        ground.set("density", 0, 1800.0)
        solver = context.dynamics_create(ground)
        self.assertEqual(said, [])
        solver.set_dt(2.0 * solver.limit())
        self.assertEqual([level for level, _ in said], [mps.CONTEXT_LOG_WARNING])
        self.assertIn("limit", said[0][1])
        later = []
        context.set_log(lambda level, text: later.append(text))
        solver.set_dt(3.0 * solver.limit())
        self.assertEqual((len(said), len(later)), (1, 1))

    def test_a_record_is_read_by_its_header(self):
        context = mps.Context()
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "quake.csv")
            with open(path, "w", encoding="utf-8") as file:
                file.write("N-S [g];E-W [g];time [ms]\n0;0;0\n,1;,2;10\n0;0;20\n".replace(",", "0,"))
            record = context.signal_create_record(path, column="E-W", baseline=mps.SIGNAL_BASELINE_NONE)
            read = record.get_record()
            self.assertEqual((read.unit, read.count), ("g", 3))
            np.testing.assert_allclose((read.peak, read.step), (0.2 * 9.80665, 0.01), rtol=1e-12)
            np.testing.assert_allclose(record.acceleration(0.01), 0.2 * 9.80665, rtol=1e-12)
            with self.assertRaisesRegex(mps.Error, "which column is wanted"):
                context.signal_create_record(path)

    def test_a_driven_base(self):
        context = mps.Context()
        sand = block(context)
        sand.set("shear_velocity", 0, 100.0)
        sand.set("pressure_velocity", 0, 200.0)
        solver = context.dynamics_create(sand)
        sine = context.signal_create_sine(mps.SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.01, 0.0)
        number = solver.add_boundary(kind=mps.BOUNDARY_DRIVEN, lower=[-1, 4.9, 0],
                                     upper=[2, 5.1, 0], signal=[sine, None, None])
        self.assertEqual(number, 0)
        solver.run(0.25, 100, None)
        moved = sand["displacement"][sand["position"][:, 1] < 5.1, 0]
        np.testing.assert_allclose(moved, 0.01, rtol=1e-9)
        self.assertGreater(abs(solver.get_reaction(number).impulse[0]), 0.0)


class Errors(unittest.TestCase):
    def test_a_failed_call_is_an_exception_with_the_record(self):
        context = mps.Context()
        sand = block(context)
        with self.assertRaisesRegex(mps.Error, "mps_mpm_create: cell is -1 m") as caught:
            falling(context, sand, cell=-1.0)
        self.assertEqual(caught.exception.status, mps.ERROR_ARGUMENT)
        with self.assertRaisesRegex(mps.Error, "threads is -1"):
            mps.Context(threads=-1)

    def test_wrong_words(self):
        context = mps.Context()
        sand = block(context)
        def refused(start, function, *values, **members):
            with self.assertRaisesRegex(TypeError, "^" + re.escape(start)):
                function(*values, **members)

        call = "Context.mpm_create()"
        refused(call + " has no keyword 'cel' (is it 'cell'?): it has geometry, ", falling, context, sand, cel=0.2)
        refused(call + " lacks 'material': mpm_create(particles: Particles | None, material: Material | None, **definition)",
                context.mpm_create, sand)
        refused("Particles.set_profile() takes 'count' by its place, not by its name: set_profile(field: ",
                sand.set_profile, "strength_factor", count=1, depth=[0], value=[1])
        refused(call + ": 'material' is [1]: [1] is no Material", context.mpm_create, sand, [1], cell=0.2)
        refused("Particles.set() has too many arguments, 2.0 is one: set(name: ", sand.set, "density", 0, 1.0, 2.0)
        refused("Particles.fill_box() has too many arguments, 3 is one: fill_box(lo: ArrayLike, hi: ArrayLike)",
                sand.fill_box, [0, 0], [1, 1], 3)
        refused("Particles.set(): 'value' is 'x': ", sand.set, "density", 0, "x")
        refused("Particles.set(): 'value' is None: ", sand.set, "density", 0, None)
        refused("Particles.remove(): 'count' is [1]: ", sand.remove, [1], [1])
        refused("Particles.remove(): 'count' is array([  0,  ...97, 498, 499]): ", sand.remove, [1], np.arange(500))
        refused("Particles.count() takes no keyword, and was given only: count()", sand.count, only=1)
        refused("'layers' is [{'thicknes': 2}]: row 0 has no member 'thicknes' (is it 'thickness'?): it has thickness, ",
                sand.set_geostatic, layers=[{"thicknes": 2}])
        refused("status_text() takes 1 arguments, and was given 0: status_text(status: int)", mps.status_text)
        with self.assertRaisesRegex(AttributeError, "mpm of libmps has no 'stepp'"):
            falling(context, sand).stepp
        with self.assertRaises(AttributeError):
            mps.nonsense

    def test_values_of_the_wrong_kind_are_named(self):
        context = mps.Context()
        sand = block(context)
        law = context.material_create_linear_elastic(1e6, 0.3)
        other = context.particles_create(spacing=0.1)
        other.close()
        for call, kind, text in [
                (lambda: context.mpm_create(law, sand, cell=0.2), TypeError, "'particles' is .*a Material is no Particles"),
                (lambda: context.mpm_create(sand, law, cell=0.2, kernel=law), TypeError, "'kernel' is .*Material is no Kernel"),
                (lambda: context.mpm_create(sand, law, cell=law), TypeError, "'cell' is .*no number"),
                (lambda: context.mpm_create(sand, law, cell=0.2, gravity=9.81), TypeError, "'gravity' is 9.81: up to 3 numbers"),
                (lambda: context.mpm_create(sand, law, cell=0.2, lower=[0, "a"]), ValueError, "'lower' is .*up to 3 numbers"),
                (lambda: context.mpm_create(other, law, cell=0.2), ValueError, "'particles' is .*it is closed"),
                (lambda: mps.Context(thread=2), TypeError, r"Context\(\) has no keyword 'thread' \(is it 'threads'\?\)"),
                (lambda: mps.Context(threads=-3), mps.Error, "^mps_context_create: threads is -3"),
                (lambda: copy.copy(sand), TypeError, "a Particles is neither copied nor pickled"),
                (lambda: pickle.dumps(law), TypeError, "a Material is neither copied nor pickled")]:
            with self.assertRaisesRegex(kind, text):
                call()

    def test_an_exception_in_a_callback_comes_out(self):
        context = mps.Context()
        sand = block(context)
        solver = falling(context, sand)

        def stop(s):
            if s.steps() == 3:
                raise ZeroDivisionError("enough")

        with self.assertRaisesRegex(ZeroDivisionError, "enough"):
            solver.run(1.0, 1, stop)
        self.assertEqual(solver.steps(), 3)

    def test_arrays_that_c_writes_must_be_numpy(self):
        context = mps.Context()
        sand = block(context)
        ids = np.zeros(200, np.int64)
        self.assertEqual(sand.select_box([0, 5], [0.2, 5.2], 200, ids), 4)
        with self.assertRaisesRegex(TypeError, "give a NumPy array"):
            sand.select_box([0, 5], [0.2, 5.2], 4, [0, 0, 0, 0])
        with self.assertRaisesRegex(TypeError, "of int64"):
            sand.select_box([0, 5], [0.2, 5.2], 4, np.zeros(4))

    def test_arrays_that_c_reads_hold_numbers_of_its_type(self):
        """A mask would be taken for the ids 0 and 1, and 1.5 for 1."""
        context = mps.Context()
        sand = block(context)
        for wrong in ([1.5], np.array([True, False]), np.array([1j])):
            with self.assertRaises(TypeError):
                sand.remove(wrong, len(wrong))
        with self.assertRaises(TypeError):
            sand.append(1, np.array([0.5 + 1j, 0.5]))
        self.assertEqual(len(sand), 100)
        sand.remove([3.0, 4.0], 2)
        sand.remove([], 0)
        self.assertEqual(len(sand), 98)

    def test_names_are_taken_whole(self):
        """No null character ends a name early; a path may be bytes."""
        context = mps.Context()
        sand = block(context)
        with self.assertRaisesRegex(ValueError, "null character"):
            sand["density\0x"]
        self.assertEqual(sand[b"density"][0], 1800.0)

    def test_a_wrong_member_is_named(self):
        context = mps.Context()
        with self.assertRaisesRegex(TypeError, "'spacing' is 'a'"):
            context.particles_create(spacing="a")
        with self.assertRaisesRegex(TypeError, "'spacing' is None"):
            context.particles_create(spacing=None)

    def test_a_read_array_cannot_be_made_writeable(self):
        context = mps.Context()
        sand = block(context)
        density = sand["density"]
        density.flags.writeable = True
        with self.assertRaises(ValueError):
            density[0] = 5.0
        with self.assertRaises(AttributeError):
            density.setflags(write=True)
        self.assertEqual(sand["density"][0], 1800.0)

    def test_a_dropped_edit_is_abandoned(self):
        context = mps.Context()
        sand = block(context)
        edit = sand.edit("density")
        edit.array[:] = 1.0
        with self.assertWarnsRegex(RuntimeWarning, "the edit of 'density' was dropped"):
            del edit
            gc.collect()
        self.assertEqual(sand["density"][0], 1800.0)
        sand.fill_box([2.0, 5.0], [3.0, 6.0])

    def test_what_is_closed_says_so(self):
        context = mps.Context()
        sand = block(context)
        solver = falling(context, sand)
        solver.close()
        solver.close()
        with self.assertRaisesRegex(ValueError, "the mpm is closed"):
            solver.step(1)
        falling(context, sand).step(1)  # the set is free again


class Arrays(unittest.TestCase):
    def test_a_field_is_the_memory_itself(self):
        context = mps.Context()
        sand = block(context)
        sand.add_field("velocity", 0)
        v = sand["velocity"]
        with self.assertRaises(ValueError):
            v[0, 0] = 1.0
        with sand.edit("velocity") as w:
            w[:, 0] = np.arange(100.0)
        self.assertEqual(v[99, 0], 99.0)
        self.assertEqual(float((v + 1.0).max()), 100.0)
        self.assertNotIsInstance(v + 1.0, type(v))
        self.assertEqual(sand["id"].dtype, np.int64)
        self.assertEqual(sand["density"].shape, (100,))

    def test_arrays_set_fields_that_come_and_go(self):
        sand = block(mps.Context())
        n = len(sand)
        self.assertNotIn("user.dose", sand)
        with self.assertRaisesRegex(mps.Error, "for a field of your own write user.dose"):
            sand.add_field("dose", 2)
        sand.add_field("user.dose", 2)
        self.assertIn("user.dose", sand)
        rows = np.arange(2.0 * n).reshape(n, 2)
        sand["user.dose"] = rows
        np.testing.assert_array_equal(sand["user.dose"], rows)
        sand["velocity"] = -rows  # a field of the library is added
        sand.set_array("velocity", 1, rows[:, 0], n)
        np.testing.assert_array_equal(sand["velocity"], np.stack([-rows[:, 0], rows[:, 0]], axis=1))
        sand["group"] = np.arange(n)
        self.assertEqual(sand["group"][n - 1], n - 1)
        twin = sand.copy()
        del sand["user.dose"]
        self.assertNotIn("user.dose", sand)
        np.testing.assert_array_equal(twin["user.dose"], rows)
        np.testing.assert_array_equal(twin["id"], sand["id"])
        for wrong in (lambda: sand.set_array("velocity", -1, rows[:, 0], n), lambda: sand.set_array("stress", -1, rows, n),
                      lambda: sand.set_array("velocity", -1, np.zeros((n, 3)), n)):
            with self.assertRaisesRegex(ValueError, "'values' has "):
                wrong()
        for wrong, what in ((lambda: sand.set_array("velocity", 0, rows[:-1, 0], n - 1), "count is 99, must be the number"),
                            (lambda: sand.set_array("velocty", -1, rows, n), "is 'velocity' meant"),
                            (lambda: sand.remove_field("position"), "every set has the field"),
                            (lambda: sand.remove_field("user.dose"), "no field 'user.dose'")):
            with self.assertRaisesRegex(mps.Error, what):
                wrong()

    def test_a_stale_array_refuses(self):
        context = mps.Context()
        sand = block(context)
        x = sand["position"]
        corner = x[:5]
        copy = np.array(x)
        self.assertFalse(x.stale)
        sand.remove([int(sand["id"][0])], 1)
        self.assertTrue(x.stale and corner.stale)
        for use in (lambda: x[0], lambda: x + 1, lambda: corner.sum(), lambda: np.concatenate([x, x]),
                    lambda: x.mean(axis=0)):
            with self.assertRaises(mps.StaleError):
                use()
        self.assertEqual(repr(x), "Field(stale)")
        self.assertEqual(copy.shape, (100, 2))
        self.assertEqual(sand["position"].shape, (99, 2))

    def test_a_value_out_of_range_can_be_mended(self):
        context = mps.Context()
        sand = block(context)
        solver = falling(context, sand)
        edit = sand.edit("density")
        edit.array[7] = -1.0
        with self.assertRaisesRegex(mps.Error, "density"):
            edit.commit()
        with self.assertRaisesRegex(mps.Error, "edit"):
            solver.step(1)
        edit.array[7] = 1800.0
        edit.commit()
        solver.step(1)

    def test_an_edit_left_by_an_exception_was_none(self):
        context = mps.Context()
        sand = block(context)
        solver = falling(context, sand)
        density = np.array(sand["density"])
        with self.assertRaises(KeyError):
            with sand.edit("density") as d:
                d[:] = 1.0
                raise KeyError
        with self.assertRaisesRegex(mps.Error, "density"):
            with sand.edit("density") as d:
                d[3] = -1.0
        np.testing.assert_array_equal(sand["density"], density)
        solver.step(1)

    def test_no_array_outlives_the_memory(self):
        """What NumPy makes of a field are copies, or fields; ways to the memory itself are closed."""
        context = mps.Context()
        sand = block(context)
        x = sand["position"]
        plain = np.asarray(x)
        kept = x[:, 0]
        whole = np.array(x)
        self.assertIs(type(plain), np.ndarray)
        self.assertFalse(plain.flags.writeable)
        self.assertTrue(whole.flags.writeable)
        turned = [x.T, np.transpose(x), kept.reshape(2, -1), np.reshape(kept, (2, -1)), kept[::2],
                  np.atleast_2d(kept), *x]
        for part in turned:
            self.assertIsInstance(part, type(x))
        for _ in range(20):
            sand.fill_box([2.0 + 40 * _, 0], [40.0 + 40 * _, 5])
        for part in [x, kept, *turned]:
            self.assertTrue(part.stale)
            for use in (lambda: np.asarray(part), part.__len__, lambda: part.tolist(), lambda: part.copy(),
                        lambda: part.astype(int), lambda: part.view(np.int64), lambda: list(part),
                        lambda: part == 1, lambda: copy.deepcopy(part)):
                with self.assertRaises(mps.StaleError):
                    use()
        np.testing.assert_array_equal(plain, whole)
        fresh = sand["position"]
        with self.assertRaises(TypeError):
            memoryview(fresh)
        for raw in ("data", "ctypes", "base", "flat", "__array_interface__"):
            with self.assertRaises(AttributeError):
                getattr(fresh, raw)
        self.assertEqual(fresh.view(np.int64).dtype, np.int64)
        self.assertIs(type(pickle.loads(pickle.dumps(kept_of(sand)))), np.ndarray)

    def test_an_edit_ends_for_all_its_parts(self):
        context = mps.Context()
        sand = block(context)
        sand.add_field("velocity", 0)
        with sand.edit("velocity") as v:
            v += 1.0
            part = v[:, 1]
            part *= 3.0
            np.copyto(v[0], [5.0, 6.0])
            v.fill(2.0)
            np.add(v, 1.0, out=v)
        np.testing.assert_array_equal(sand["velocity"], 3.0)
        for late in (v, part):
            with self.assertRaisesRegex(mps.StaleError, "has been committed"):
                late[0] = 1.0
        with self.assertRaises(ValueError):
            sand["velocity"][0] = 1.0

    def test_arrays_that_are_too_short_are_refused(self):
        context = mps.Context(threads=1)
        sand = block(context)
        solver = falling(context, sand)
        strip = context.body_create_polygon(3, [0, 0, 1, 0, 0, 1.0])
        short = [
            lambda: sand.append(3, [0.5, 0.5]),
            lambda: sand.remove([0], 2),
            lambda: sand.fill_box([0.0], [1.0, 1.0]),
            lambda: sand.fill_polygon(3, [0, 0, 1, 0, 0]),
            lambda: sand.nearest([0.5]),
            lambda: sand.select_box([0, 0], [1, 1], 3, np.zeros(2, np.int64)),
            lambda: sand.set_geostatic(layer_count=2, layers=[{"thickness": 1.0}]),
            lambda: context.signal_create_table(mps.SIGNAL_QUANTITY_DISPLACEMENT, 3, [0, 1, 2], [0, 1]),
            lambda: context.body_create_polygon(4, [0, 0, 1, 0, 0, 1]),
            lambda: strip.distance(2, [0, 0, 1], np.zeros(2), None, None, None),
            lambda: strip.distance(2, [0, 0, 1, 1], np.zeros(2), np.zeros(3), None, None),
            lambda: solver.add_load(id_count=2, ids=[0, 1], area=[1.0], traction=[1, 0, 0]),
            lambda: solver.grid().evaluate("velocity", -1, 2, np.zeros(6), np.zeros(3), None),
            lambda: solver.grid().get_nodes(5, None, np.zeros(4), None, None),
            lambda: context.coupling_create(size=4).begin(None, np.zeros(3)),
            lambda: context.material_create_user(update=print, wave_modulus=1e6, history_count=2,
                                          history=["one"]),
        ]
        for k, call in enumerate(short):
            with self.assertRaisesRegex(ValueError, r"has \d+ values, and must have \d+", msg=str(k)):
                call()
        with self.assertRaisesRegex(ValueError, "'gravity' has 4 values, and takes at most 3"):
            falling(context, sand, gravity=[0, 0, 0, 0])
        self.assertEqual(sand.count(), 100)

    def test_points_have_as_many_columns_as_the_set_dimensions(self):
        """Rows of three numbers would be read as rows of two."""
        context = mps.Context(threads=1)
        sand = block(context)
        flat = np.arange(12.0)
        disc = context.body_create_disc(0.5)
        elastic = context.particles_create(spacing=0.1)
        elastic.fill_box([0, 0], [1, 1])
        elastic.set("young", 0, 1e7)
        elastic.set("poisson", 0, 0.3)
        solid = context.elastic_create(elastic)
        wrong = [
            lambda: sand.append(4, flat.reshape(4, 3)),
            lambda: sand.append(6, flat.reshape(2, 6)),
            lambda: sand.fill_polygon(4, flat.reshape(4, 3)),
            lambda: sand.set_table("density", 6, flat.reshape(4, 3), 1, np.ones(6)),
            lambda: disc.distance(4, flat.reshape(4, 3), np.zeros(4), None, None, None),
            lambda: context.body_create_polygon(4, flat.reshape(4, 3)),
            lambda: context.body_create_mesh(4, flat.reshape(6, 2), 4, np.arange(12)),
            lambda: solid.add_load(kind=mps.ELASTIC_LOAD_FORCE, ids=[0, 1, 2], values=flat[:10].reshape(5, 2)),
            lambda: sand.remove(np.arange(4).reshape(2, 2), 4),
        ]
        for k, call in enumerate(wrong):
            with self.assertRaisesRegex((ValueError, TypeError), r"has the shape \(\d, \d\), and must be (rows of|a list)",
                                        msg=str(k)):
                call()
        self.assertEqual(len(sand), 100)
        for call in (lambda: sand.fill_box([0, 0, 0], [1, 1, 1]), lambda: sand.nearest([0, 5, 0]),
                     lambda: sand.select_box([0, 0, 0], [1, 1, 1]),
                     lambda: context.body_create_half_plane([0, 1, 0])):
            with self.assertRaisesRegex(ValueError, "has 3 values, and must have 2"):
                call()
        sand.append(2, np.array([[2.0, 2.0], [3.0, 3.0]]))
        sand.append(2, [4.0, 4.0, 5.0, 5.0])
        np.testing.assert_array_equal(sand["position"][100:, 0], [2, 3, 4, 5])

    def test_a_field_is_stale_after_each_step(self):
        """Not only after those that have sorted the particles."""
        context = mps.Context(threads=1)
        sand = block(context)
        solver = falling(context, sand)
        other = block(context)
        kept, elsewhere, copied = sand["velocity"], other["density"], np.array(sand["velocity"])
        solver.time(), solver.get_totals()
        start = solver.snapshot()
        self.assertFalse(kept.stale)
        solver.step(1)
        with self.assertRaisesRegex(mps.StaleError, "a solver has stepped since: take the field again"):
            kept.mean()
        self.assertEqual((copied.max(), elsewhere.max()), (0.0, 1800.0))
        inside = []
        solver.run(0.01, 2, lambda s: inside.append(sand["velocity"]))
        self.assertGreater(len(inside), 2)
        self.assertTrue(all(field.stale for field in inside))
        late = sand["velocity"]
        solver.rollback(start)
        self.assertTrue(late.stale)
        self.assertTrue((sand["velocity"] == 0).all())

    def test_results_come_in_the_order_of_c(self):
        coupling = mps.Context(threads=1).coupling_create(size=2, method=mps.COUPLING_METHOD_AITKEN)
        self.assertEqual(coupling.begin(None).tolist(), [0.0, 0.0])
        guess, done = coupling.next([0.5, 1.0])  # an array, then a number, as its docstring says
        self.assertEqual(guess.shape, (2,))
        self.assertEqual(done, 0)

    def test_an_array_keeps_its_set_alive(self):
        context = mps.Context()
        x = block(context)["position"]
        del context
        gc.collect()
        self.assertAlmostEqual(float(x[:, 1].max()), 5.95, delta=1e-12)


def kept_of(sand):
    return sand["position"][:, 0]


class Callbacks(unittest.TestCase):
    def test_arrays_come_in_and_values_are_returned(self):
        context = mps.Context(threads=1)
        disc = context.particles_create(spacing=0.1)
        self.assertEqual(disc.fill_where([0, 0], [1, 1], lambda x: x @ x < 1), 79)
        def stress(x):
            return [-1e3 * x[1], -2e3 * x[1], 0.0, 5.0]
        disc.set_stress(stress)
        y = disc["position"][:, 1]
        np.testing.assert_array_equal(disc["stress"][:, 1], -2e3 * y)
        np.testing.assert_array_equal(disc["stress"][:, 3], 5.0)
        motion = context.signal_create_user(mps.SIGNAL_QUANTITY_DISPLACEMENT, lambda t: (t * t, 2 * t, 2.0))
        self.assertEqual(motion.displacement(3.0), 9.0)

        beam = context.particles_create(spacing=0.05)
        beam.fill_box([0, 0], [0.4, 0.4])
        beam.set("young", 0, 1e7)
        beam.set("poisson", 0, 0.3)
        solid = context.elastic_create(beam)
        solid.add_boundary(lower=[0, 0], upper=[0.4, 0.05])
        points = []

        def traction(x, normal):
            points.append((np.array(x), np.array(normal)))
            return 1e3 * normal  # a suction: in balance, but for the held bottom

        solid.add_load(kind=mps.ELASTIC_LOAD_FUNCTION, ids=np.arange(solid.facet_count()), function=traction)
        force = solid.get_load_resultant([0, 0, 0])[0]
        np.testing.assert_allclose(force, 0.0, atol=1e-9)
        self.assertGreater(len(points), 3)
        self.assertTrue(all(x.shape == n.shape == (2,) and abs(n @ n - 1) < 1e-12 for x, n in points))

    def test_another_solver_of_equations(self):
        """The matrix and the right side come as arrays, the solution is returned: the displacements of the library's."""
        found = []
        for foreign in (False, True):
            context = mps.Context(threads=1)
            beam = context.particles_create(spacing=0.1)
            beam.fill_box([0, 0], [0.8, 0.4])
            beam.set("young", 0, 1e7)
            beam.set("poisson", 0, 0.3)
            solid = context.elastic_create(beam, bending=0)
            solid.add_boundary(lower=[0, 0], upper=[0.1, 0.4])
            solid.add_load(kind=mps.ELASTIC_LOAD_VOLUME, all=1, force=[0, -1e4])
            matrices = []

            def matrix(a):
                full = np.zeros((a["rows"], a["all"]))
                for i in range(a["rows"]):
                    row = slice(a["start"][i], a["start"][i + 1])
                    full[i, a["column"][row]] = a["value"][row]
                matrices.append(full)

            if foreign:
                solid.solver().set_linear_solver(mps.LINEAR_EQUATION_STIFFNESS, matrix=matrix,
                                                 solve=lambda b, tolerance, x: np.linalg.solve(matrices[-1], b))
            solid.solve()
            self.assertEqual(len(matrices), int(foreign))
            found.append(np.array(beam["displacement"]))
        np.testing.assert_allclose(found[1], found[0], rtol=1e-6, atol=1e-12)

    def test_a_wrong_answer_names_the_callback(self):
        context = mps.Context(threads=1)
        sand = block(context)
        solver = falling(context, sand)
        for call, text in [
                (lambda: solver.run(0.1, 10, lambda s: True), r"'callback' returned True: must return None, or a status"),
                (lambda: solver.run(0.1, 10, lambda s: "x"), r"'callback' returned 'x'"),
                (lambda: solver.run(0.1, 10, lambda s, t: None), r"'callback' .* it is called as callback\(mpm\): missing"),
                (lambda: sand.fill_where([0, 0], [1, 1], lambda x: None), r"inside\(x\) .*returned None: must return True or"),
                (lambda: sand.set_stress(lambda x: [1.0, 2.0]), r"stress\(x\) .* returned \[1.0, 2.0\]: must return 4 numbers"),
                (lambda: sand.set_stress(lambda x: ["a"] * 4), r"returned \['a'")]:
            with self.assertRaisesRegex(TypeError, text):
                call()
        with self.assertRaises(mps.Error) as caught:
            solver.run(1.0, 10, lambda s: mps.ERROR_CANCELLED)
        self.assertEqual(caught.exception.status, mps.ERROR_CANCELLED)

    def test_warnings_are_those_of_python(self):
        context = mps.Context(threads=1)
        ground = block(context)
        ground.set("shear_velocity", 0, 100.0)
        ground.set("pressure_velocity", 0, 200.0)
        solver = context.dynamics_create(ground)
        with self.assertWarnsRegex(mps.MpsWarning, "limit") as caught:
            solver.set_dt(2.0 * solver.limit())
        self.assertEqual(caught.filename, __file__)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaisesRegex(mps.MpsWarning, "limit"):
                solver.set_dt(3.0 * solver.limit())
            said = []
            context.set_log(lambda level, text: said.append(text))
            solver.set_dt(4.0 * solver.limit())
            self.assertEqual(len(said), 1)
        context.set_log(None)
        with self.assertWarns(mps.MpsWarning):
            solver.set_dt(5.0 * solver.limit())

    def test_a_script_with_a_mesh_ends(self):
        """Embree's threads run on after the last line: the library's code must stay."""
        script = ("import libmps as mps\nc = mps.Context(threads=1)\n"
                  "c.body_create_mesh(4, [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1], 4, [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2])\n")
        for _ in range(3):
            done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
            if "UNSUPPORTED" in done.stderr or "Embree" in done.stderr:
                self.skipTest("built without Embree")
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_hooks_stay_alive(self):
        context = mps.Context(threads=1)
        sand = block(context)
        solver = falling(context, sand)
        seen = []
        context.set_progress(lambda progress: seen.append(progress))
        context.set_cancel(lambda: 0)
        context.set_log(lambda level, text: seen.append(text))
        gc.collect()
        list(range(100000))
        solver.run(0.05, 10, None)
        self.assertTrue(seen)
        context.set_cancel(lambda: 1)
        gc.collect()
        with self.assertRaises(mps.Error) as caught:
            solver.run(0.1, 10, None)
        self.assertEqual(caught.exception.status, mps.ERROR_CANCELLED)
        context.set_cancel(None)
        solver.run(0.1, 10, None)

    def test_exceptions_of_laws_and_signals_come_out(self):
        for threads in (1, 2):
            context = mps.Context(threads=threads)
            sand = block(context)

            def update(block):
                raise ZeroDivisionError("a law")

            law = context.material_create_user(update=update, name="bad", wave_modulus=1e7)
            solver = context.mpm_create(sand, law, cell=0.2, dt=1e-4)
            with self.assertRaisesRegex(ZeroDivisionError, "a law"):
                solver.step(1)
            with self.assertRaisesRegex(ZeroDivisionError, "a law"):
                solver.step(1)
            self.assertEqual(solver.steps(), 0)

        def motion(t):
            raise KeyError("a signal")

        context = mps.Context()
        sand = block(context)
        solver = falling(context, sand)
        with self.assertRaisesRegex(KeyError, "a signal"):
            solver.add_boundary(ids=sand["id"], id_count=100, kind=mps.BOUNDARY_DRIVEN,
                                signal=[context.signal_create_user(mps.SIGNAL_QUANTITY_DISPLACEMENT, motion), None, None])
            solver.step(1)
        self.assertEqual(solver.steps(), 0)

    def test_a_signal_of_another_arity_is_an_error(self):
        context = mps.Context()
        with self.assertRaisesRegex(TypeError, r"'fn' .* it is called as fn\(t\) -> motion \(3 numbers\): missing"):
            context.signal_create_user(mps.SIGNAL_QUANTITY_DISPLACEMENT, lambda t, out: 0)
        with self.assertRaisesRegex(TypeError, r"fn\(t\) .* returned 0: must return 3 numbers"):
            context.signal_create_user(mps.SIGNAL_QUANTITY_DISPLACEMENT, lambda t: 0).displacement(1.0)

    def test_interrupt_ends_a_run_within_a_step(self):
        context = mps.Context(threads=1)
        sand = block(context)
        solver = falling(context, sand)
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        handler = signal.signal(signal.SIGALRM, signal.default_int_handler)
        try:
            with self.assertRaises(KeyboardInterrupt):
                solver.step(10**9)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, handler)
        self.assertLess(solver.steps(), 10**9)
        solver.step(1)

    def test_what_a_hook_of_no_answer_raises_ends_the_run(self):
        for cancel in (None, lambda: 0):
            calls = []

            def progress(_progress):
                calls.append(1)
                if len(calls) == 3:
                    raise KeyboardInterrupt  # as Ctrl-C does while the hook runs

            context = mps.Context(threads=1, cancel=cancel, progress=progress)
            solver = falling(context, block(context))
            with self.assertRaises(KeyboardInterrupt):
                solver.run(1000.0, 10**9, None)
            self.assertLess(solver.time(), 500.0)
            solver.step(1)

    def test_a_closed_context_says_so(self):
        with mps.Context() as context:
            sand = block(context)
        with self.assertRaisesRegex(ValueError, "the context of the particles is closed"):
            sand.count()
        with self.assertRaisesRegex(ValueError, "the context is closed"):
            context.particles_create(spacing=1.0)

    def test_a_contact_belongs_to_its_solver(self):
        """Sand falls on a strip whose contact nobody holds; closed, it ends."""
        left = []
        for closed in (False, True):
            context = mps.Context(threads=1)
            sand = block(context)
            solver = falling(context, sand)
            strip = context.body_create_polygon(4, [-1.0, 4.0, 2.0, 4.0, 2.0, 4.8, -1.0, 4.8])
            solver.add_contact(strip, friction=0.5)
            gc.collect()
            if closed:
                solver._alive[-1].close()
            solver.run(0.4, 100, None)
            left.append(float(sand["position"][:, 1].min()))
        self.assertGreater(left[0], 4.75)
        self.assertLess(left[1], 4.4)


class Garbage(unittest.TestCase):
    def test_objects_in_cycles_go_whenever_python_looks(self):
        context = mps.Context(threads=2)
        sand = block(context)
        solver = falling(context, sand)

        def leave_garbage(_solver):
            cycle = [context.signal_create_sine(mps.SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.01, 0.0)]
            cycle.append(cycle)

        threshold = gc.get_threshold()
        gc.set_threshold(5)  # nearly everywhere
        try:
            solver.run(0.05, 1, leave_garbage)
            for _ in range(50):
                leave_garbage(None)
        finally:
            gc.set_threshold(*threshold)
        gc.collect()
        self.assertEqual(solver.steps(), 50)
        self.assertFalse(context._late)


class Whole(unittest.TestCase):
    def test_every_function_has_its_parameters(self):
        for name in _cdef.PARAMETERS:
            function = getattr(mps.library, name)
            self.assertEqual(len(ffi.typeof(function).args), len(_cdef.PARAMETERS[name]), name)
        self.assertGreater(len(_cdef.PARAMETERS), 200)
        self.assertEqual(signature("particles_set_geostatic", "set_geostatic"), "set_geostatic(**definition)")
        self.assertEqual(signature("mpm_step", "step"), "step(count: int)")

    def test_a_table_of_points_sets_a_field(self):
        particles = mps.Context().particles_create(spacing=0.1)
        particles.fill_box([0.0, 0.0], [1.0, 1.0])
        points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.4, 0.6]])
        values = 3.0 * points[:, 0]
        self.assertEqual(particles.set_table("pore_pressure", 5, points, 1, values, interpolation=1), 0)
        np.testing.assert_allclose(particles["pore_pressure"], 3.0 * particles["position"][:, 0],
                                      atol=1e-12)
        with self.assertRaises(ValueError):
            particles.set_table("pore_pressure", 5, points[:4], 1, values)

    def test_every_array_has_a_length(self):
        """Pointers to numbers in the headers: one result, or an array whose length is known."""
        single = {"added", "angle", "apart", "columns", "count", "done", "end", "number", "out", "outside", "part",
                  "strain", "stabilising", "start", "index", "indices", "offsets", "progressive",
                  "evanescent", "reflection"}
        of_one = {"mps_absorber_advance: displacement", "mps_absorber_advance: velocity",
                  "mps_mpm_get_pore_flow: rate", "mps_mpm_get_pore_flow: mass"}
        lacking = []
        for function, listed in re.findall(r"(mps_\w+)\(([^()]*)\);", _cdef.TEXT):
            for parameter in listed.split(","):
                name = re.search(r"(\w+)(\[\d*\])?\s*$", parameter)
                if re.search(r"(double|int64_t|int32_t)\s*\*|\[", parameter) and \
                        name[1] not in _shapes.FUNCTIONS.get(function.removesuffix("_sized"), {}) and \
                        name[1] not in single and f"{function}: {name[1]}" not in of_one:
                    lacking.append(f"{function}: {name[1]}")
        for kind, members in re.findall(r"typedef struct (mps_\w+_def) \{(.*?)\}", _cdef.TEXT, re.S):
            for name in re.findall(r"(?:double|int64_t|int32_t)\s*\*\s*(\w+);", members):
                if name not in _shapes.STRUCTS.get(kind, {}):
                    lacking.append(f"{kind}: {name}")
        self.assertEqual(lacking, [])
        for function in _shapes.FUNCTIONS:
            self.assertTrue(function in _cdef.PARAMETERS or function + "_sized" in _cdef.PARAMETERS, function)

    def test_every_definition_has_defaults(self):
        made = 0
        for name in re.findall(r"typedef struct (mps_\w+_def) \{", _cdef.TEXT):
            kind = ffi.typeof(name)
            self.assertEqual(Call().struct(kind, {}).struct_size, ffi.sizeof(kind), name)
            made += 1
        self.assertGreaterEqual(made, 30)

    def test_every_object_can_be_destroyed(self):
        for name in _cdef.PARAMETERS:
            if name.endswith("_destroy"):
                kind = name.removesuffix("_destroy")
                getattr(mps.library, name)(ffi.new(f"{kind} *[1]"))  # NULL is accepted


if __name__ == "__main__":
    unittest.main()
