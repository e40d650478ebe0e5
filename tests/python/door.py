"""What docs/python.md does not show of the Python package: its errors, its views, its runs and studies."""

import copy
import gc
import json
import os
import pathlib
import sys
import tempfile
import unittest

import numpy

import mpm_sandbox as mpm

SOURCE = pathlib.Path(sys.argv.pop(1))

SCENE = {
    "title": "A block",
    "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]},
    "shape": {"type": "bspline_quadratic"},
    "transfer": {"type": "apic"},
    "materials": {"rubber": {"type": "neo_hookean", "youngs_modulus": 1e4, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "block", "material": "rubber",
                "geometry": {"type": "box", "lower": [0.3, 0.3], "upper": [0.7, 0.7]}, "velocity": ["0.1*y", "-x"]}],
    "solver": {"time_step": 0.001, "end_time": 0.05},
}


def scene(**changes):
    changed = copy.deepcopy(SCENE)
    changed.update(changes)
    return changed


class Door(unittest.TestCase):
    def test_every_mistake_of_a_file_comes_at_once_with_its_place(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "bad.json"
            file.write_text(json.dumps(scene(transfer={"type": "apicc"}, gravty=[0, 1]), indent=1))
            with self.assertRaises(mpm.InputError) as caught:
                mpm.load(file)
        text = str(caught.exception)
        self.assertRegex(text, r'bad\.json:\d+:\d+: /transfer/type: unknown transfer "apicc"')
        self.assertRegex(text, r'bad\.json:\d+:\d+: /gravty: ')
        self.assertIsInstance(caught.exception, ValueError)

    def test_a_missing_file_is_an_input_error(self):
        with self.assertRaisesRegex(mpm.InputError, "nowhere.json"):
            mpm.load("nowhere.json")

    def test_a_start_that_cannot_be_is_refused_as_by_run(self):
        bad = scene()
        bad["bodies"][0]["velocity"] = ["log(x-0.5)", 0]
        with self.assertRaisesRegex(mpm.InputError, "not a finite number at particle"):
            mpm.load(bad).start()

    def test_particles_begin_with_the_velocity_of_the_file(self):
        block = mpm.load(SCENE).start().particles("block")
        self.assertEqual(len(block), 64)
        numpy.testing.assert_allclose(block.velocity[:, 0], 0.1 * block.position[:, 1], rtol=1e-14)
        numpy.testing.assert_allclose(block.mass.sum(), 0.16 * 1000, rtol=1e-14)
        numpy.testing.assert_allclose(block.volume.sum(), 0.16, rtol=1e-14)
        self.assertEqual(block.body, "block")

    def test_arrays_outlive_what_they_came_from_and_cannot_be_written(self):
        simulation = mpm.load(SCENE).start()
        block = simulation.particles("block")
        position, first = block.position, block.position[0, 0]
        del simulation, block
        gc.collect()
        self.assertEqual(position[0, 0], first)
        with self.assertRaises(ValueError):
            position[0, 0] = 0

    def test_unknown_names_are_key_errors_that_list_what_there_is(self):
        simulation = mpm.load(SCENE).start()
        block = simulation.particles("block")
        for wrong in (lambda: simulation.particles("blok"), lambda: block.quantity("speeed"), lambda: block.state("F"),
                      lambda: block.initial_position):
            self.assertRaises(KeyError, wrong)
        with self.assertRaisesRegex(KeyError, "did you mean"):
            simulation.particles("blok")

    def test_stepping_gives_what_a_recorded_run_gives(self):
        experiment = mpm.load(SCENE)
        simulation = experiment.start()
        simulation.step(10**6)
        self.assertTrue(simulation.finished)
        self.assertEqual(simulation.steps, 50)
        with tempfile.TemporaryDirectory() as folder:
            run = experiment.run(pathlib.Path(folder) / "run")
            recorded, now = run.metrics, simulation.metrics()
            self.assertEqual(set(recorded), set(now))
            for name, values in recorded.items():
                self.assertEqual(values[-1], now[name], name)
            self.assertEqual(run.outcome["exit_code"], 0)
            self.assertEqual(run.experiment["title"], "A block")
            self.assertEqual(mpm.Run(run.folder).summary, run.summary)

    def test_as_many_steps_are_taken_as_are_asked_for(self):
        simulation = mpm.load(SCENE).start()
        simulation.step()
        self.assertEqual(simulation.steps, 1)
        simulation.step(3)
        self.assertEqual(simulation.steps, 4)
        length = simulation.time / 4  # all steps of this scene are as long
        simulation.run_until(9.5 * length)
        self.assertEqual(simulation.steps, 10)

    def test_a_run_that_fails_says_where_why_and_what_to_do(self):
        bad = scene()
        bad["grid"]["boundaries"] = {"all": "free"}
        bad["bodies"][0]["velocity"] = [40, 0]
        with self.assertRaisesRegex(mpm.RunFailed, r'step \d+, t = .*particle \d+ of body "block".*left the domain') as caught:
            mpm.load(bad).start().step(1000)
        self.assertIn("remedy: ", str(caught.exception))
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaises(mpm.RunFailed) as recorded:
                mpm.load(bad).run(pathlib.Path(folder) / "run")
        self.assertIn(str(caught.exception), str(recorded.exception))

    def test_a_folder_without_a_run_or_a_study_is_an_input_error(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertRaises(mpm.InputError, mpm.Run, folder)
            self.assertRaises(mpm.InputError, mpm.read_study, folder)

    def test_a_simulation_restores_only_what_is_its_own(self):
        simulation = mpm.load(SCENE).start()
        self.assertRaises(mpm.ArchiveError, simulation.restore, b"nothing of the kind")

    def test_threads_change_no_bit(self):
        one, two = (mpm.load(SCENE).start(threads=threads) for threads in (1, 2))
        one.step(20)
        two.step(20)
        self.assertTrue(numpy.array_equal(one.particles("block").position, two.particles("block").position))

    def test_every_shipped_lesson_loads(self):
        for file in sorted((SOURCE / "experiments" / "lessons").glob("*.json")):
            self.assertGreater(len(mpm.load(file).bodies), 0, file)

    def test_a_study_runs_and_is_read(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "block.json").write_text(json.dumps(SCENE))
            (folder / "study.json").write_text(json.dumps({
                "base": "block.json",
                "axes": {"transfer": {"values": [{"label": name, "set": {"/transfer/type": name}}
                                                 for name in ("pic", "apic")]}},
                "measure": {"energy": {"value": "/energy/total/final_over_initial"}},
            }))
            study = mpm.run_study(folder / "study.json", folder / "out", jobs=1)
            self.assertEqual([row["transfer"] for row in study.rows], ["pic", "apic"])
            self.assertLess(study.rows[0]["energy"], study.rows[1]["energy"])
            self.assertEqual(mpm.read_study(folder / "out").rows, study.rows)


if __name__ == "__main__":
    os.chdir(tempfile.gettempdir())
    unittest.main()
