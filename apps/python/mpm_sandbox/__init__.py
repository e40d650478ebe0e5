"""The MPM Sandbox from Python: load, check, change, run and step experiments; read run folders and studies.

    import mpm_sandbox as mpm

    experiment = mpm.load("experiments/quickstart.json", {"/transfer/type": "pic"})
    simulation = experiment.start()
    simulation.step(100)
    print(simulation.particles("left").position.mean(axis=0))

Mistakes raise InputError with the words that `mpm check` prints; a run that fails raises RunFailed. docs/python.md has
the whole tour.
"""

import csv
import json
import os
import pathlib
import subprocess
import tempfile

import numpy

_here = pathlib.Path(__file__).resolve().parent
# An installed package has the program and its plugins beside it; in a build folder they are two levels up.
_root = _here if (_here / "plugins").is_dir() else _here.parent.parent
_program = _root / "mpm" if _root == _here else _root / "bin" / "mpm"
os.environ["MPM_PLUGIN_PATH"] = os.pathsep.join(
    [folder for folder in [os.environ.get("MPM_PLUGIN_PATH")] if folder] + [str(_root / "plugins")]
)

from . import _core  # noqa: E402  (it looks for plugins where the lines above say)
from ._core import ArchiveError, InputError, MachineError, Particles, PluginError, RunFailed  # noqa: E402

__all__ = [
    "ArchiveError", "Experiment", "InputError", "MachineError", "Particles", "PluginError", "Run", "RunFailed",
    "Simulation", "Study", "load", "read_study", "run_study",
]


def _overrides(changes):
    return [f"{pointer}={json.dumps(value)}" for pointer, value in (changes or {}).items()]


class Experiment:
    """A checked experiment. `load` makes one from a file or a dictionary; `changed` makes another from it."""

    def __init__(self, source, changes):
        self._source, self._changes = source, dict(changes or {})
        if isinstance(source, dict):
            self._checked = _core.read_text(json.dumps(source, indent=1), "experiment", _overrides(self._changes))
        else:
            self._checked = _core.read_file(os.fspath(source), _overrides(self._changes))

    title = property(lambda self: self._checked.title)
    dimension = property(lambda self: self._checked.dimension)
    bodies = property(lambda self: self._checked.bodies, doc="Names of the bodies.")

    @property
    def resolved(self):
        """The experiment as a dictionary, with every default filled in."""
        return json.loads(self._checked.resolved_text)

    def changed(self, changes):
        """The same experiment with other values, {"/json/pointer": value}. InputError."""
        return Experiment(self._source, {**self._changes, **changes})

    def start(self, threads=1):
        """A Simulation at the experiment's first moment; threads=0 takes as many as are fastest. InputError."""
        return Simulation(self._checked, threads)

    def run(self, out=None, threads=0, replace=False):
        """Runs as `mpm run` does, into the folder `out` (default runs/<name of the file>), and returns the Run.

        RunFailed where it became unstable: what was recorded is in the folder. A failed expectation or a broken limit
        raises nothing; see Run.outcome.
        """
        with tempfile.TemporaryDirectory() as folder:
            file = self._source
            if isinstance(file, dict):
                file = pathlib.Path(folder) / "experiment.json"
                file.write_text(json.dumps(self._source))
            place = pathlib.Path(out) if out else pathlib.Path("runs") / pathlib.Path(file).stem
            arguments = ["run", os.fspath(file), "--out", os.fspath(place)]
            for override in _overrides(self._changes):
                arguments += ["--set", override]
            if threads > 0:
                arguments += ["--threads", str(threads)]
            if replace:
                arguments += ["--replace"]
            _call(arguments, good=(0, 4))
        return Run(place)


class Simulation(_core.Simulation):
    """A run that is stepped from Python and writes no folder; it is made by Experiment.start()."""

    def metrics(self):
        """The columns of metrics.csv, by their headings, as they would stand now."""
        return dict(super().metrics())


class Run:
    """A run folder: its experiment, summary and metrics."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.experiment = self._json("experiment.json")
        self.summary = self._json("summary.json")
        self.outcome = self.summary["outcome"]

    def _json(self, name):
        try:
            return json.loads((self.folder / name).read_text())
        except FileNotFoundError:
            raise InputError(f"{self.folder} is no finished run: it holds no {name}") from None

    @property
    def metrics(self):
        """The columns of metrics.csv as arrays, by their headings."""
        return read_csv(self.folder / "metrics.csv")


class Study:
    """A study folder: the table of its combinations, a dictionary a row, and study.json."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        try:
            self.json = json.loads((self.folder / "study.json").read_text())
        except FileNotFoundError:
            raise InputError(f"{self.folder} holds no study.json: run the study first") from None
        with open(self.folder / "table.csv", newline="") as file:
            self.rows = [{name: _number(text) for name, text in row.items()} for row in csv.DictReader(file)]


def load(source, changes=None):
    """Reads and checks an experiment: a file, or a dictionary. `changes` are {"/json/pointer": value}.

    InputError names every mistake with its place, as `mpm check` does.
    """
    return Experiment(source, changes)


def run_study(file, out=None, jobs=0):
    """Runs a study as `mpm study` does and returns it; combinations that ran before are not run again. InputError."""
    place = pathlib.Path(out) if out else pathlib.Path("runs") / pathlib.Path(file).stem
    arguments = ["study", os.fspath(file), "--out", os.fspath(place)]
    _call(arguments + (["--jobs", str(jobs)] if jobs > 0 else []), good=(0, 4))
    return Study(place)


def read_study(folder):
    """Reads the folder of a study."""
    return Study(folder)


def read_csv(file):
    """The columns of a CSV file of numbers as arrays, by their headings."""
    with open(file, newline="") as text:
        rows = list(csv.reader(text))
    values = numpy.array([[float(cell) if cell else numpy.nan for cell in row] for row in rows[1:]])
    return {name: values[:, column] for column, name in enumerate(rows[0])}


def _number(text):
    try:
        return float(text)
    except ValueError:
        return text


def _call(arguments, good):
    """Runs the program; its errors become exceptions with its words."""
    done = subprocess.run([os.fspath(_program), *arguments], text=True, capture_output=True, check=False)
    if done.returncode in good:
        return
    words = done.stderr.strip()
    if done.returncode == 2:
        raise InputError(words)
    if done.returncode == 3:
        start = words.find("the run failed: ")
        raise RunFailed(words[start:] if start >= 0 else words)
    if done.returncode == 130:
        raise KeyboardInterrupt
    raise MachineError(words)
