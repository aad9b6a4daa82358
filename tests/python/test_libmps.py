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
from libmps._call import Call, functions
from libmps._library import ffi


def block(context, spacing=0.1):
    sand = mps.Particles(spacing=spacing, context=context)
    sand.fill_box([0.0, 5.0], [1.0, 6.0])
    sand["density"] = 1800.0
    return sand


def falling(context, sand, **more):
    law = mps.LinearElastic(1e6, 0.3)
    return mps.Mpm(sand, law, **{"cell": 0.2, "gravity": [0, -9.81, 0], "dt": 1e-3, **more})


class Values(unittest.TestCase):
    def test_free_fall(self):
        context = mps.Context(threads=2)
        sand = block(context)
        solver = falling(context, sand)
        times = []
        solver.run(0.1, every=10, callback=lambda s: times.append(s.time))
        np.testing.assert_allclose(times, 0.01 * np.arange(11), atol=1e-12)
        np.testing.assert_allclose(sand["velocity"][:, 1], -0.981, rtol=1e-12)
        totals = solver.totals
        self.assertAlmostEqual(totals.mass, 1800.0, delta=1e-9)
        self.assertAlmostEqual(totals.linear[1], -0.981 * 1800.0, delta=1e-8)
        self.assertEqual(solver.definition.cell, 0.2)

    def test_the_grid_is_lent(self):
        context = mps.Context()
        sand = block(context)
        solver = falling(context, sand)
        solver.step(1)
        grid = solver.grid
        self.assertIsInstance(grid, mps.Grid)
        self.assertIs(type(solver), mps.Mpm)
        self.assertIsInstance(solver, mps.Solver)
        del solver
        gc.collect()
        self.assertEqual(grid.info.cell, 0.2)  # the grid keeps its solver
        nodes = grid.nodes
        self.assertEqual(nodes.velocity.shape, (len(nodes.mass), 3))
        self.assertAlmostEqual(nodes.mass.sum(), 1800.0, delta=1e-9)
        v = grid.evaluate("velocity", [[0.5, 5.5, 0.0]]).values
        self.assertEqual(v.shape, (1, 2))
        self.assertAlmostEqual(v[0, 1], -9.81e-3, delta=1e-14)
        grid.close()

    def test_the_way_back_is_the_same_bit_for_bit(self):
        context = mps.Context(executor="serial")
        sand = block(context)
        solver = falling(context, sand)
        solver.step(20)
        snapshot = solver.snapshot()
        solver.step(30)
        once = np.array(sand["position"])
        solver.rollback(snapshot)
        self.assertEqual(solver.steps, 20)
        solver.step(30)
        self.assertTrue(np.array_equal(once, sand["position"]))

    @unittest.skipUnless(mps.library_has("hdf5"), "checkpoints need HDF5")
    def test_a_file_is_the_way_on_bit_for_bit(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "run.h5")
            context = mps.Context(executor="serial")
            sand = block(context)
            solver = falling(context, sand)
            solver.step(20)
            solver.save(path, user_key="mine")
            solver.step(30)
            other = block(context)
            second = falling(context, other)
            info = second.restore(path)
            self.assertEqual((info.step, info.user_key, second.steps), (20, "mine", 20))
            with self.assertRaisesRegex(ValueError, "'user_key' is 'x+': a text of less than 64 bytes"):
                solver.save(path, user_key="x" * 64)
            with self.assertRaisesRegex(TypeError, "expected str, bytes or os.PathLike object, not int"):
                solver.save(path, user_key=7)
            self.assertEqual(mps.checkpoint_info(path, context=context).step, 20)
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
            law = mps.UserMaterial(
                update=update, name="python", history=["steps"],
                wave_modulus=bulk + 4.0 * shear / 3.0) if own else \
                mps.LinearElastic(1e7, 0.3)
            sand.add_field("velocity", 0)
            with sand.edit("velocity") as v:
                v[:] = np.sin(3.0 * np.array(sand["position"]))
            solver = mps.Mpm(sand, law, cell=0.2, dt=2e-4)
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
            law = mps.UserMaterial(update=update, history=["stiff"], wave_modulus=1e6,
                                               bulk_modulus=5e5, shear_modulus=1e6 / 3, moduli=moduli)
            return mps.Mpm(block(context), law, cell=0.2, gravity=[0, -9.81, 0])

        solver = made(lambda block: 1e6 * (1 + 99 * block.history[0]))
        first = solver.limit
        solver.run(0.03)
        self.assertAlmostEqual(first / solver.limit, 10.0, delta=0.02)
        with self.assertRaisesRegex(TypeError, "must return K . 4G/3 of each of the 64 particles"):
            made(lambda block: None).step(1)

    def test_a_struct_is_a_mapping_or_a_result(self):
        context = mps.Context()
        body = mps.Disc(0.1, position=[1.0, 2.0], context=context)
        body.set_motion(velocity=[0.5, 0.0, 0.0])
        self.assertEqual(list(body.state.velocity), [0.5, 0.0, 0.0])
        body.set_motion(types.MappingProxyType({"velocity": [0.25, 0.0, 0.0]}))
        self.assertEqual(list(body.state.velocity), [0.25, 0.0, 0.0])
        body.set_motion(mps.BodyMotion(velocity=[0.0, 3.0, 0.0]))
        state = body.state
        self.assertEqual((list(state.velocity), list(state.position[:2])), ([0.0, 3.0, 0.0], [1.0, 2.0]))
        with self.assertRaisesRegex(TypeError, "no member 'velocty' .is it 'velocity'"):
            body.set_motion(mps.BodyMotion(velocty=[0.0, 3.0, 0.0]))

    def test_layers_are_dictionaries_and_hooks_are_functions(self):
        """Stress at rest under two layers; a warning through the log hook."""
        said = []
        context = mps.Context(threads=1, log=lambda level, text: said.append((level, text)))
        ground = mps.Particles(spacing=0.5, context=context)
        ground.fill_box([0, 0], [2, 4])
        ground.set_geostatic(gravity=10.0, surface=4.0, layers=[
            {"thickness": 2.0, "k0": 0.5, "density": 1800.0},
            {"thickness": 2.0, "k0": 0.4, "density": 2000.0}])
        depth = 4.0 - ground["position"][:, 1]
        exact = np.where(depth < 2, 18e3 * depth, 36e3 + 20e3 * (depth - 2))
        np.testing.assert_allclose(ground["stress"][:, 1], -exact, rtol=1e-12)
        np.testing.assert_allclose(ground["stress"][:, 0],
                                   -np.where(depth < 2, 0.5, 0.4) * exact, rtol=1e-12)
        ground["shear_velocity"] = 100.0
        ground["pressure_velocity"] = 200.0
        ground["density"] = 1800.0
        solver = mps.Dynamics(ground)
        self.assertEqual(said, [])
        solver.dt = 2.0 * solver.limit
        self.assertEqual([level for level, _ in said], [mps.ContextLog.WARNING])
        self.assertIn("limit", said[0][1])
        later = []
        context.set_log(lambda level, text: later.append(text))
        solver.dt = 3.0 * solver.limit
        self.assertEqual((len(said), len(later)), (1, 1))

    def test_a_record_is_read_by_its_header(self):
        context = mps.Context()
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "quake.csv")
            with open(path, "w", encoding="utf-8") as file:
                file.write("N-S [g];E-W [g];time [ms]\n0;0;0\n,1;,2;10\n0;0;20\n".replace(",", "0,"))
            record = mps.Record(path, column="E-W", baseline="none", context=context)
            read = record.record
            self.assertEqual((read.unit, read.count), ("g", 3))
            np.testing.assert_allclose((read.peak, read.step), (0.2 * 9.80665, 0.01), rtol=1e-12)
            np.testing.assert_allclose(record.acceleration(0.01), 0.2 * 9.80665, rtol=1e-12)
            with self.assertRaisesRegex(mps.Error, "which column is wanted"):
                mps.Record(path, context=context)

    def test_a_driven_base(self):
        context = mps.Context()
        sand = block(context)
        sand["shear_velocity"] = 100.0
        sand["pressure_velocity"] = 200.0
        solver = mps.Dynamics(sand)
        sine = mps.Sine("displacement", 1.0, 0.01, 0.0, context=context)
        number = solver.add_boundary(kind="driven", box=([-1, 4.9], [2, 5.1]), signal=[sine, None, None])
        self.assertEqual(number, 0)
        solver.run(0.25)
        moved = sand["displacement"][sand["position"][:, 1] < 5.1, 0]
        np.testing.assert_allclose(moved, 0.01, rtol=1e-9)
        self.assertGreater(abs(solver.get_reaction(number).impulse[0]), 0.0)


class Errors(unittest.TestCase):
    def test_a_failed_call_is_an_exception_with_the_record(self):
        context = mps.Context()
        sand = block(context)
        with self.assertRaisesRegex(mps.ArgumentError, r"^Mpm\(\): cell is -1 m") as caught:
            falling(context, sand, cell=-1.0)
        self.assertEqual(caught.exception.status, mps.Status.ARGUMENT)
        self.assertIsInstance(caught.exception, ValueError)
        self.assertIsInstance(caught.exception, mps.Error)
        with self.assertRaisesRegex(mps.Error, "threads is -1"):
            mps.Context(threads=-1)

    def test_wrong_words(self):
        context = mps.Context()
        sand = block(context)
        def refused(start, function, *values, **members):
            with self.assertRaisesRegex(TypeError, "^" + re.escape(start)):
                function(*values, **members)

        call = "Mpm()"
        refused(call + " has no keyword 'cel' (is it 'cell'?): it has geometry, ", falling, context, sand, cel=0.2)
        refused(call + " lacks 'material': Mpm(particles, material, **definition)", mps.Mpm, sand)
        refused("Particles.set_profile() lacks 'value': set_profile(field, depth, value, **definition)", sand.set_profile,
                "strength_factor", depth=[0])
        refused("Mpm() has no keyword 'count'", mps.Mpm, sand, mps.LinearElastic(1e6, 0.3), count=2)
        refused(call + ": 'material' is [1]: [1] is no Material", mps.Mpm, sand, [1], cell=0.2)
        refused("Particles.fill_box() has too many arguments, 3 is one: fill_box(lo, hi)", sand.fill_box, [0, 0], [1, 1], 3)
        refused("Particles.fill_box() has two values for 'lo'", sand.fill_box, [0, 0], lo=[1, 1])
        refused("Particles.fill_ball(): 'radius' is None: ", sand.fill_ball, [0, 0], None)
        refused("Particles.fill_ball() has no keyword 'radus' (is it 'radius'?): it has centre, radius", sand.fill_ball, [0, 0], radus=1)
        refused("Particles.copy() takes no keyword, and was given only: copy()", sand.copy, only=1)
        refused("Particles.set_geostatic(): 'layers' is [{'thicknes': 2}]: row 0 has no member 'thicknes' (is it 'thickness'?): it has thickness, ",
                sand.set_geostatic, layers=[{"thicknes": 2}])
        refused("status_text() lacks 'status': status_text(status)", mps.status_text)
        with self.assertRaisesRegex(AttributeError, "Mpm of libmps has no 'stepp' .is it 'step'"):
            falling(context, sand).stepp
        with self.assertRaisesRegex(AttributeError, "Disc of libmps has no 'position' .is it 'state.position'"):
            mps.Disc(0.1).position
        with self.assertRaisesRegex(AttributeError, "Particles of libmps has no 'spacng' .is it 'spacing'"):
            sand.spacng = 1.0
        with self.assertRaises(AttributeError):
            mps.nonsense

    def test_values_of_the_wrong_kind_are_named(self):
        context = mps.Context()
        sand = block(context)
        law = mps.LinearElastic(1e6, 0.3)
        other = mps.Particles(spacing=0.1, context=context)
        other.close()
        for call, kind, text in [
                (lambda: mps.Mpm(law, sand, cell=0.2), TypeError, "'particles' is .*a LinearElastic is no Particles"),
                (lambda: mps.Mpm(sand, law, cell=0.2, kernel=law), TypeError, "'kernel' is .*LinearElastic is no Kernel"),
                (lambda: mps.Mpm(sand, law, cell=law), TypeError, "'cell' is .*no number"),
                (lambda: mps.Mpm(sand, law, cell=0.2, gravity=9.81), TypeError, "'gravity' is 9.81: up to 3 numbers"),
                (lambda: mps.Mpm(sand, law, cell=0.2, lower=[0, "a"]), ValueError, "'lower' is 'a': a number in m is wanted"),
                (lambda: mps.Mpm(other, law, cell=0.2), mps.StateError, "the Particles is closed"),
                (lambda: mps.Context(thread=2), TypeError, r"Context\(\) has no keyword 'thread' \(is it 'threads'\?\)"),
                (lambda: mps.Context(threads=-3), mps.Error, r"^Context\(\): threads is -3"),
                (lambda: copy.copy(sand), TypeError, "a Particles is neither copied nor pickled"),
                (lambda: pickle.dumps(law), TypeError, "a LinearElastic is neither copied nor pickled")]:
            with self.assertRaisesRegex(kind, text):
                call()

    def test_an_exception_in_a_callback_comes_out(self):
        context = mps.Context()
        sand = block(context)
        solver = falling(context, sand)

        def stop(s):
            if s.steps == 3:
                raise ZeroDivisionError("enough")

        with self.assertRaisesRegex(ZeroDivisionError, "enough"):
            solver.run(1.0, every=1, callback=stop)
        self.assertEqual(solver.steps, 3)

    def test_what_c_changes_is_returned(self):
        sand = block(mps.Context())
        self.assertEqual(len(sand.select_box([0, 5], [0.2, 5.2])), 4)
        law, lists = mps.LinearElastic(1e6, 0.0), mps.Neighbours(radius=0.11)
        point = law.point_init()
        law.point_drive(point, gradient=[0.1, 0, 0, 0, 0, 0, 0, 0, 0], duration=1.0, steps=10)
        np.testing.assert_allclose(point.stress, [1e5, 0, 0, 0, 0, 0], rtol=1e-12, atol=1e-9)
        point = law.point_init()
        found = law.point_control(point, gradient=np.zeros(9), controlled="xx", target=[1e5, 0, 0, 0, 0, 0], duration=1.0, steps=10)
        np.testing.assert_allclose(found.reshape(3, 3)[0, 0], 0.1, rtol=1e-9)
        lists.build(np.array(sand["position"]))
        count, offsets, indices = lists.lists()
        self.assertEqual((count, len(offsets), len(indices)), (100, 101, 360))

    def test_arrays_that_c_reads_hold_numbers_of_its_type(self):
        """A mask would be taken for the ids 0 and 1, and 1.5 for 1."""
        context = mps.Context()
        sand = block(context)
        for wrong in ([1.5], np.array([True, False]), np.array([1j])):
            with self.assertRaises(TypeError):
                sand.remove(wrong)
        with self.assertRaises(TypeError):
            sand.append(np.array([0.5 + 1j, 0.5]))
        self.assertEqual(len(sand), 100)
        sand.remove([3.0, 4.0])
        sand.remove([])
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
        with self.assertRaisesRegex(ValueError, "'spacing' is 'a': a number in m is wanted"):
            mps.Particles(spacing="a", context=context)
        with self.assertRaisesRegex(TypeError, "'spacing' is"):
            mps.Particles(spacing=context, context=context)
        with self.assertRaisesRegex(mps.ArgumentError, "spacing is"):
            mps.Particles(spacing=None, context=context)  # as if it were not given

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
        with self.assertRaisesRegex(mps.StateError, "the Mpm is closed"):
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
        sand["velocity", 1] = rows[:, 0]
        np.testing.assert_array_equal(sand["velocity"], np.stack([-rows[:, 0], rows[:, 0]], axis=1))
        sand["group"] = np.arange(n)
        self.assertEqual(sand["group"][n - 1], n - 1)
        twin = sand.copy()
        del sand["user.dose"]
        self.assertNotIn("user.dose", sand)
        np.testing.assert_array_equal(twin["user.dose"], rows)
        np.testing.assert_array_equal(twin["id"], sand["id"])
        for name, values in (("velocity", rows[:, 0]), ("stress", rows), ("velocity", np.zeros((n, 3))), (("velocity", 0), rows[:-1, 0])):
            with self.assertRaisesRegex(ValueError, "must have .*broadcasts to it"):
                sand[name] = values
        with self.assertRaisesRegex(mps.FieldError, "is 'velocity' meant"):
            sand["velocty"] = rows[:, 0]
        for name, what in (("position", "every set has the field"), ("user.dose", "no field 'user.dose'")):
            with self.assertRaisesRegex(mps.Error, what):
                del sand[name]
        sand["density"] = "1.7 t/m3"
        sand["velocity"] = ["10 mm/s", 0]
        self.assertEqual((sand["density"][3], sand["velocity"][5].tolist()), (1700.0, [0.01, 0.0]))
        np.testing.assert_array_equal(sand["velocity", 0], 0.01)
        with self.assertRaisesRegex(ValueError, "'density' is '3 m': a density is wanted"):
            sand["density"] = "3 m"
        self.assertEqual(list(sand)[:2], ["id", "position"])
        self.assertEqual((sand.fields["velocity"].unit, sand.fields["velocity"].components), ("m/s", 2))

    def test_a_stale_array_refuses(self):
        context = mps.Context()
        sand = block(context)
        x = sand["position"]
        corner = x[:5]
        copy = np.array(x)
        self.assertFalse(x.stale)
        sand.remove([int(sand["id"][0])])
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
        strip = mps.Polygon([0, 0, 1, 0, 0, 1.0], context=context)
        short = [
            lambda: sand.fill_box([0.0], [1.0, 1.0]),
            lambda: sand.fill_polygon([0, 0, 1, 0, 0]),
            lambda: sand.nearest([0.5]),
            lambda: mps.Table("displacement", [0, 1, 2], [0, 1], context=context),
            lambda: mps.Polygon([0, 0, 1, 0, 0], context=context),
            lambda: strip.distance([0, 0, 1]),
            lambda: solver.add_load(ids=[0, 1], area=[1.0], traction=[1, 0, 0]),
            lambda: solver.grid.evaluate("velocity", np.zeros(5)),
            lambda: mps.Coupling(size=4, context=context).begin(np.zeros(3)),
            lambda: mps.UserMaterial(update=print, wave_modulus=1e6, history=["one"], history_initial=[1.0, 2.0]),
            lambda: sand.set_profile("strength_factor", depth=[0, 1], value=[1]),
        ]
        for k, call in enumerate(short):
            with self.assertRaisesRegex(ValueError, r"has \d+ values, and must have \d+", msg=str(k)):
                call()
        with self.assertRaisesRegex(ValueError, "'gravity' has 4 values, and takes at most 3"):
            falling(context, sand, gravity=[0, 0, 0, 0])
        self.assertEqual(sand.count, 100)

    def test_points_have_as_many_columns_as_the_set_dimensions(self):
        """Rows of three numbers would be read as rows of two."""
        context = mps.Context(threads=1)
        sand = block(context)
        flat = np.arange(12.0)
        disc = mps.Disc(0.5, context=context)
        elastic = mps.Particles(spacing=0.1, context=context)
        elastic.fill_box([0, 0], [1, 1])
        elastic["young"] = 1e7
        elastic["poisson"] = 0.3
        solid = mps.Elastic(elastic)
        wrong = [
            lambda: sand.append(flat.reshape(4, 3)),
            lambda: sand.append(flat.reshape(2, 6)),
            lambda: sand.fill_polygon(flat.reshape(4, 3)),
            lambda: sand.set_table("density", flat.reshape(4, 3), np.ones(6)),
            lambda: disc.distance(flat.reshape(4, 3)),
            lambda: mps.Polygon(flat.reshape(4, 3), context=context),
            lambda: mps.Mesh(flat.reshape(6, 2), np.arange(12), context=context),
            lambda: solid.add_load(kind="force", ids=[0, 1, 2], values=flat[:10].reshape(5, 2)),
            lambda: sand.remove(np.arange(4).reshape(2, 2)),
        ]
        for k, call in enumerate(wrong):
            with self.assertRaisesRegex((ValueError, TypeError), r"has the shape \(\d, \d\), and must be (rows of|a list)",
                                        msg=str(k)):
                call()
        self.assertEqual(len(sand), 100)
        for call in (lambda: sand.fill_box([0, 0, 0], [1, 1, 1]), lambda: sand.nearest([0, 5, 0]),
                     lambda: sand.select_box([0, 0, 0], [1, 1, 1]),
                     lambda: mps.HalfPlane([0, 1, 0], context=context)):
            with self.assertRaisesRegex(ValueError, "has 3 values, and must have 2"):
                call()
        sand.append([[2.0, 2.0], [3.0, 3.0]])
        sand.append([4.0, 4.0, 5.0, 5.0])
        np.testing.assert_array_equal(sand["position"][100:, 0], [2, 3, 4, 5])

    def test_a_field_is_stale_after_each_step(self):
        """Not only after those that have sorted the particles."""
        context = mps.Context(threads=1)
        sand = block(context)
        solver = falling(context, sand)
        other = block(context)
        kept, elsewhere, copied = sand["velocity"], other["density"], np.array(sand["velocity"])
        solver.time, solver.totals
        start = solver.snapshot()
        self.assertFalse(kept.stale)
        solver.step(1)
        with self.assertRaisesRegex(mps.StaleError, "a solver has stepped since: take the field again"):
            kept.mean()
        self.assertEqual((copied.max(), elsewhere.max()), (0.0, 1800.0))
        inside = []
        solver.run(0.01, every=2, callback=lambda s: inside.append(sand["velocity"]))
        self.assertGreater(len(inside), 2)
        self.assertTrue(all(field.stale for field in inside))
        late = sand["velocity"]
        solver.rollback(start)
        self.assertTrue(late.stale)
        self.assertTrue((sand["velocity"] == 0).all())

    def test_results_come_in_the_order_of_c(self):
        coupling = mps.Coupling(size=2, method="aitken", context=mps.Context(threads=1))
        self.assertEqual(coupling.begin().tolist(), [0.0, 0.0])
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
        disc = mps.Particles(spacing=0.1, context=context)
        self.assertEqual(disc.fill_where([0, 0], [1, 1], lambda x: x @ x < 1), 79)
        def stress(x):
            return [-1e3 * x[1], -2e3 * x[1], 0.0, 5.0]
        disc.set_stress(stress)
        y = disc["position"][:, 1]
        np.testing.assert_array_equal(disc["stress"][:, 1], -2e3 * y)
        np.testing.assert_array_equal(disc["stress"][:, 3], 5.0)
        motion = mps.UserSignal("displacement", lambda t: (t * t, 2 * t, 2.0), context=context)
        self.assertEqual(motion.displacement(3.0), 9.0)

        beam = mps.Particles(spacing=0.05, context=context)
        beam.fill_box([0, 0], [0.4, 0.4])
        beam["young"] = 1e7
        beam["poisson"] = 0.3
        solid = mps.Elastic(beam)
        solid.add_boundary(box=([0, 0], [0.4, 0.05]))
        points = []

        def traction(x, normal):
            points.append((np.array(x), np.array(normal)))
            return 1e3 * normal  # a suction: in balance, but for the held bottom

        solid.add_load(kind="function", ids=np.arange(solid.facet_count), function=traction)
        force = solid.get_load_resultant([0, 0, 0])[0]
        np.testing.assert_allclose(force, 0.0, atol=1e-9)
        self.assertGreater(len(points), 3)
        self.assertTrue(all(x.shape == n.shape == (2,) and abs(n @ n - 1) < 1e-12 for x, n in points))

    def test_another_solver_of_equations(self):
        """The matrix and the right side come as arrays, the solution is returned: the displacements of the library's."""
        found = []
        for foreign in (False, True):
            context = mps.Context(threads=1)
            beam = mps.Particles(spacing=0.1, context=context)
            beam.fill_box([0, 0], [0.8, 0.4])
            beam["young"] = 1e7
            beam["poisson"] = 0.3
            solid = mps.Elastic(beam, bending=0)
            solid.add_boundary(box=([0, 0], [0.1, 0.4]))
            solid.add_load(kind="volume", all=True, force=[0, -1e4])
            matrices = []

            def matrix(a):
                full = np.zeros((a["rows"], a["all"]))
                for i in range(a["rows"]):
                    row = slice(a["start"][i], a["start"][i + 1])
                    full[i, a["column"][row]] = a["value"][row]
                matrices.append(full)

            if foreign:
                solid.set_linear_solver("stiffness", matrix=matrix,
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
                (lambda: solver.run(0.1, every=10, callback=lambda s: True), r"'callback' returned True: must return None, or a Status"),
                (lambda: solver.run(0.1, every=10, callback=lambda s: "x"), r"'callback' returned 'x'"),
                (lambda: solver.run(0.1, 10, lambda s, t: None), r"'callback' .* it is called as callback\(mpm\): missing"),
                (lambda: sand.fill_where([0, 0], [1, 1], lambda x: None), r"inside\(x\) .*returned None: must return True or"),
                (lambda: sand.set_stress(lambda x: [1.0, 2.0]), r"stress\(x\) .* returned \[1.0, 2.0\]: must return 4 numbers"),
                (lambda: sand.set_stress(lambda x: ["a"] * 4), r"returned \['a'")]:
            with self.assertRaisesRegex(TypeError, text):
                call()
        with self.assertRaises(mps.Error) as caught:
            solver.run(1.0, every=10, callback=lambda s: mps.Status.CANCELLED)
        self.assertEqual(caught.exception.status, mps.Status.CANCELLED)

    def test_warnings_are_those_of_python(self):
        context = mps.Context(threads=1)
        ground = block(context)
        ground["shear_velocity"] = 100.0
        ground["pressure_velocity"] = 200.0
        solver = mps.Dynamics(ground)
        with self.assertWarnsRegex(mps.Warning, "limit") as caught:
            solver.dt = 2.0 * solver.limit
        self.assertEqual(caught.filename, __file__)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaisesRegex(mps.Warning, "limit"):
                solver.dt = 3.0 * solver.limit
            said = []
            context.set_log(lambda level, text: said.append(text))
            solver.dt = 4.0 * solver.limit
            self.assertEqual(len(said), 1)
        context.set_log(None)
        with self.assertWarns(mps.Warning):
            solver.dt = 5.0 * solver.limit

    def test_a_script_with_a_mesh_ends(self):
        """Embree's threads run on after the last line: the library's code must stay."""
        script = ("import libmps as mps\nc = mps.Context(threads=1)\n"
                  "mps.Mesh([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1], [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2], context=c)\n")
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
        solver.run(0.05)
        self.assertTrue(seen)
        context.set_cancel(lambda: 1)
        gc.collect()
        with self.assertRaises(mps.Error) as caught:
            solver.run(0.1)
        self.assertEqual(caught.exception.status, mps.Status.CANCELLED)
        context.set_cancel(None)
        solver.run(0.1)

    def test_exceptions_of_laws_and_signals_come_out(self):
        for threads in (1, 2):
            context = mps.Context(threads=threads)
            sand = block(context)

            def update(block):
                raise ZeroDivisionError("a law")

            law = mps.UserMaterial(update=update, name="bad", wave_modulus=1e7)
            solver = mps.Mpm(sand, law, cell=0.2, dt=1e-4)
            with self.assertRaisesRegex(ZeroDivisionError, "a law"):
                solver.step(1)
            with self.assertRaisesRegex(ZeroDivisionError, "a law"):
                solver.step(1)
            self.assertEqual(solver.steps, 0)

        def motion(t):
            raise KeyError("a signal")

        context = mps.Context()
        sand = block(context)
        solver = falling(context, sand)
        with self.assertRaisesRegex(KeyError, "a signal"):
            solver.add_boundary(ids=sand["id"], kind="driven",
                                signal=[mps.UserSignal("displacement", motion, context=context), None, None])
            solver.step(1)
        self.assertEqual(solver.steps, 0)

    def test_a_signal_of_another_arity_is_an_error(self):
        context = mps.Context()
        with self.assertRaisesRegex(TypeError, r"'fn' .* it is called as fn\(t\) -> motion \(3 numbers\): missing"):
            mps.UserSignal("displacement", lambda t, out: 0, context=context)
        with self.assertRaisesRegex(TypeError, r"fn\(t\) .* returned 0: must return 3 numbers"):
            mps.UserSignal("displacement", lambda t: 0, context=context).displacement(1.0)

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
        self.assertLess(solver.steps, 10**9)
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
                solver.run(1000.0)
            self.assertLess(solver.time, 500.0)
            solver.step(1)

    def test_a_closed_context_says_so(self):
        with mps.Context() as context:
            sand = block(context)
        with self.assertRaisesRegex(mps.StateError, "the Context of the Particles is closed"):
            sand.count
        with self.assertRaisesRegex(mps.StateError, "the Context is closed"):
            mps.Particles(spacing=1.0, context=context)

    def test_a_contact_belongs_to_its_solver(self):
        """Sand falls on a strip whose contact nobody holds; closed, it ends."""
        left = []
        for closed in (False, True):
            context = mps.Context(threads=1)
            sand = block(context)
            solver = falling(context, sand)
            strip = mps.Polygon([-1.0, 4.0, 2.0, 4.0, 2.0, 4.8, -1.0, 4.8], context=context)
            solver.add_contact(strip, friction=0.5)
            gc.collect()
            if closed:
                solver._alive[-1].close()
            solver.run(0.4)
            left.append(float(sand["position"][:, 1].min()))
        self.assertGreater(left[0], 4.75)
        self.assertLess(left[1], 4.4)


class Garbage(unittest.TestCase):
    def test_objects_in_cycles_go_whenever_python_looks(self):
        context = mps.Context(threads=2)
        sand = block(context)
        solver = falling(context, sand)

        def leave_garbage(_solver):
            cycle = [mps.Sine("displacement", 1.0, 0.01, 0.0, context=context)]
            cycle.append(cycle)

        threshold = gc.get_threshold()
        gc.set_threshold(5)  # nearly everywhere
        try:
            solver.run(0.05, every=1, callback=leave_garbage)
            for _ in range(50):
                leave_garbage(None)
        finally:
            gc.set_threshold(*threshold)
        gc.collect()
        self.assertEqual(solver.steps, 50)
        self.assertFalse(context._late)


class Whole(unittest.TestCase):
    def test_every_function_has_its_parameters(self):
        for name in _cdef.PARAMETERS:
            function = getattr(mps.library, name)
            self.assertEqual(len(ffi.typeof(function).args), len(_cdef.PARAMETERS[name]), name)
        self.assertGreater(len(_cdef.PARAMETERS), 200)
        self.assertEqual(functions["particles_set_geostatic"].signature(), "set_geostatic(**definition)")
        self.assertEqual(functions["mpm_step"].signature(), "step(count=1)")

    def test_a_table_of_points_sets_a_field(self):
        particles = mps.Particles(spacing=0.1)
        particles.fill_box([0.0, 0.0], [1.0, 1.0])
        points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.4, 0.6]])
        values = 3.0 * points[:, 0]
        self.assertEqual(particles.set_table("pore_pressure", points, values, interpolation="linear"), 0)
        np.testing.assert_allclose(particles["pore_pressure"], 3.0 * particles["position"][:, 0],
                                      atol=1e-12)
        with self.assertRaises(ValueError):
            particles.set_table("pore_pressure", points[:4], values)

    @staticmethod
    def definitions():
        return [name for name in ffi.list_types()[0] if name.endswith("_def")]

    def test_every_array_has_a_length(self):
        """Pointers to numbers in the headers: one result, or an array whose length is known."""
        single = {"added", "angle", "apart", "columns", "count", "done", "end", "number", "out", "outside", "part",
                  "strain", "stabilising", "start", "index", "progressive", "evanescent", "reflection"}
        of_one = {"mps_absorber_advance: displacement", "mps_absorber_advance: velocity",
                  "mps_mpm_get_pore_flow: rate", "mps_mpm_get_pore_flow: mass"}
        lacking = []

        def of_numbers(kind):
            return kind.kind == "pointer" and kind.item.cname in ("double", "int64_t", "int32_t")

        for function, parameters in _cdef.PARAMETERS.items():
            for kind, parameter in zip(ffi.typeof(getattr(mps.library, function)).args, parameters):
                name = parameter.split()[-1]
                if of_numbers(kind) and name not in _shapes.FUNCTIONS.get(function.removesuffix("_sized"), {}) and \
                        name not in single and f"{function}: {name}" not in of_one:
                    lacking.append(f"{function}: {name}")
        for kind in self.definitions():
            for name, field in ffi.typeof(kind).fields:
                if of_numbers(field.type) and name not in _shapes.STRUCTS.get(kind, {}):
                    lacking.append(f"{kind}: {name}")
        self.assertEqual(lacking, [])
        for function in _shapes.FUNCTIONS:
            self.assertTrue(function in _cdef.PARAMETERS or function + "_sized" in _cdef.PARAMETERS, function)

    def test_every_definition_has_defaults(self):
        made = 0
        for name in self.definitions():
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
