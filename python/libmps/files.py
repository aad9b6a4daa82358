"""Results of runs and programs as arrays: CSV files, summary.json, series of frames (.vtkhdf) and checkpoints (.h5).

    from libmps import files

    table = files.read_csv("out/wall/pressure.csv")      # table["path"], table.units["path"], table.to_pandas()
    q = files.read_summary("out/footing/summary.json")["q_over_c"]
    with files.Series("pile.vtkhdf") as series:           # h5py
        frame = series[-1]                                # frame["velocity"], frame.time
        data = series.to_xarray("velocity")               # over time and particle
        cloud = frame.to_pyvista()
    state = files.read_checkpoint("pile.h5")              # arrays by their path in the file
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterator, Mapping
from os import PathLike, fspath
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy

from . import _tables
from ._history import Rows, wanted

if TYPE_CHECKING:
    from . import Array

#: Units as the ends of names in CSV files have them: "_" for "/" and " ".
_UNITS = {re.sub(r"[/ ]", "_", unit): unit for _, units in _tables.UNITS.values() for unit in units if re.fullmatch(r"[\w/ ]+", unit)}
_UNITS.update({"N_m": "N/m", "N_s": "N s", "Nm": "N m", "W_m": "W/m", "J_m": "J/m", "1": ""})


class Table(Rows):
    """Named columns with units: table["t"], table.units["t"], table.values, table.to_pandas(), table.to_xarray()."""

    def __init__(self, columns: Mapping[str, Any], units: Mapping[str, str] | None = None) -> None:
        self._arrays = {name: numpy.asarray(values) for name, values in columns.items()}
        self.columns = tuple(self._arrays)
        self.units = {name: (units or {}).get(name, "") for name in self._arrays}

    def _column(self, name: str) -> Array:
        return self._arrays[name].copy()

    def __len__(self) -> int:
        return len(next(iter(self._arrays.values()), ()))

    def __repr__(self) -> str:
        said = ", ".join(f"{name} ({self.units[name]})" if self.units[name] else name for name in self.columns)
        return f"<libmps Table: {len(self)} rows of {said}>"


def _name_and_unit(word: str) -> tuple[str, str]:
    """("force_x", "N") of force_x_N: the longest end that is a unit."""
    parts = word.split("_")
    for k in range(1, len(parts)):
        end = "_".join(parts[k:])
        if end in _UNITS:
            return "_".join(parts[:k]), _UNITS[end]
    return word, ""


def read_csv(path: str | PathLike[str]) -> Table:
    """A CSV file of libmps or its programs: a line of names with units behind them (t_s, force_N), then numbers. Empty cells
    are NaN; columns with words are texts. ValueError: a line of another length, or no header."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if not rows or not rows[0]:
        raise ValueError(f"{fspath(path)}:1: a line of names is wanted")
    for k, row in enumerate(rows[1:], 2):
        if len(row) != len(rows[0]):
            raise ValueError(f"{fspath(path)}:{k}: {len(row)} values, and the header has {len(rows[0])} names")
    named = [_name_and_unit(word.strip()) for word in rows[0]]
    if len({name for name, _ in named}) < len(named):  # sigma_Pa and sigma_kPa: their whole names
        named = [(word.strip(), unit) for word, (_, unit) in zip(rows[0], named)]
    columns: dict[str, Any] = {}
    for k, (name, _) in enumerate(named):
        cells = [row[k] for row in rows[1:]]
        try:
            columns[name] = numpy.array([float(cell) if cell.strip() else numpy.nan for cell in cells])
        except ValueError:
            columns[name] = numpy.array(cells)
    return Table(columns, dict(named))


def read_summary(path: str | PathLike[str]) -> dict[str, Any]:
    """A summary.json of a program, or of the folder that has one, as a dictionary. null is None."""
    where = Path(path)
    found = json.loads((where / "summary.json" if where.is_dir() else where).read_text(encoding="utf-8"))
    if not isinstance(found, dict):
        raise ValueError(f"{where} is no summary: an object of JSON is wanted")
    return found


def _opened(path: str | PathLike[str], method: str) -> Any:
    return wanted("h5py", method).File(path, "r")


class Frame(Mapping[str, Any]):
    """One frame of a series: a copy of its fields by name, `position` among them, as they are in the set."""

    def __init__(self, time: float, fields: dict[str, Any], units: dict[str, str]) -> None:
        self.time, self._fields, self.units = time, fields, units

    def __getitem__(self, name: str) -> Array:
        return self._fields[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._fields)

    def __len__(self) -> int:
        """The number of fields; that of particles is len(frame["id"])."""
        return len(self._fields)

    def __repr__(self) -> str:
        return f"<libmps Frame: t = {self.time:.6g} s, {len(self._fields['id'])} particles, fields {', '.join(self)}>"

    def to_pandas(self) -> Any:
        """A pandas.DataFrame: a row for each particle by its id, a column for each component (velocity_x, stress_0)."""
        pandas = wanted("pandas", "to_pandas")
        columns = {}
        for name, values in self._fields.items():
            labels = "xyz" if values.ndim > 1 and values.shape[1] in (2, 3) else None
            for k in range(1 if values.ndim == 1 else values.shape[1]):
                label = name if values.ndim == 1 else f"{name}_{labels[k] if labels else k}"
                if name != "id":
                    columns[label] = values if values.ndim == 1 else values[:, k]
        made = pandas.DataFrame(columns, index=pandas.Index(self._fields["id"], name="id"))
        made.attrs["time"] = self.time
        return made

    def to_xarray(self, *names: str) -> Any:
        """An xarray.Dataset over particle, with units, ids and the time."""
        xarray = wanted("xarray", "to_xarray")
        found = {}
        for name in names or [n for n in self if n != "id"]:
            values = self._fields[name]
            axes = ("particle",) if values.ndim == 1 else ("particle", "axis" if name == "position" or values.shape[1] == self.dim
                                                             else f"{name}_component")
            found[name] = (axes, values, {"units": self.units.get(name, "")})
        return xarray.Dataset(found, coords={"id": ("particle", self._fields["id"]), "time": self.time})

    @property
    def dim(self) -> int:
        return int(self._fields["position"].shape[1])

    @property
    def spacing(self) -> float:
        """m: of the particles' volumes, in a slab of 1 m in 2D, where the file has them; else the least distance of two."""
        if "volume" in self and len(self["volume"]):
            return float(self["volume"].mean() ** (1 / self.dim))
        x = self["position"][:500]
        apart = numpy.sqrt(((x[:, None] - x) ** 2).sum(axis=-1)) + numpy.where(numpy.eye(len(x)), numpy.inf, 0.0)
        return float(numpy.median(apart.min(axis=0))) if len(x) > 1 else 1.0

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData of the particles, in 2D with a third coordinate 0, with the fields as its arrays."""
        pyvista = wanted("pyvista", "to_pyvista")
        points = numpy.zeros((len(self._fields["id"]), 3))
        points[:, :self.dim] = self._fields["position"]
        cloud = pyvista.PolyData(points)
        for name, values in self._fields.items():
            if name != "position":
                cloud[name] = values
        return cloud


class Series:
    """Frames of a file that a Recorder or a program has written (*.vtkhdf), read as they are asked for: series[0], series[-1],
    series.at(1.5), `for frame in series`, len(series), series.times (s). Third components, which VTK
    wants, are left out where z is 0: `dim` is 2 then. Needs h5py."""

    def __init__(self, path: str | PathLike[str]) -> None:
        self._file = _opened(path, "Series")
        try:
            self._root = self._file["VTKHDF"]
            self.times: Array = self._root["Steps/Values"][:]
            self._first = self._root["Steps/PointOffsets"][:]
            counts, parts = self._root["NumberOfPoints"][:], self._root["Steps/PartOffsets"][:]
            self._counts = counts[parts]
        except KeyError as error:
            self._file.close()
            raise ValueError(f"{fspath(path)} is no series of frames: {error}") from error
        self.dim = 3 if any(self._points(k)[:, 2].any() for k in range(min(1, len(self)))) else 2
        #: Names of the fields, and their units.
        self.fields: tuple[str, ...] = tuple(self._root["PointData"])
        self.units = {name: self._unit(data) for name, data in self._root["PointData"].items()} | {"position": "m"}

    @staticmethod
    def _unit(data: Any) -> str:
        unit = data.attrs.get("unit", "")
        return unit.decode() if isinstance(unit, bytes) else str(unit)

    def _points(self, k: int) -> Array:
        return self._root["Points"][self._first[k]:self._first[k] + self._counts[k]]

    def __len__(self) -> int:
        return len(self.times)

    def __iter__(self) -> Iterator[Frame]:
        return (self[k] for k in range(len(self)))

    def __getitem__(self, k: int) -> Frame:
        if not -len(self) <= k < len(self):
            raise IndexError(f"frame {k} of {len(self)}")
        k %= len(self)
        rows = slice(int(self._first[k]), int(self._first[k] + self._counts[k]))
        fields = {"id": numpy.asarray(self._root["PointData/id"][rows]), "position": self._points(k)[:, :self.dim]}
        for name in self.fields:
            if name not in fields:
                values = self._root["PointData"][name][rows]
                flat = values.ndim > 1 and values.shape[1] == 3 and self.dim == 2 and not values[:, 2].any()
                fields[name] = values[:, :2] if flat else values
        return Frame(float(self.times[k]), fields, self.units)

    def at(self, time: float) -> Frame:
        """The frame whose time is nearest to `time` (s)."""
        return self[int(abs(self.times - time).argmin())]

    def to_xarray(self, *names: str) -> Any:
        """Fields of these names, or all, as an xarray.Dataset over time and id: particles that a frame lacks are NaN there."""
        xarray = wanted("xarray", "to_xarray")
        frames = [frame.to_xarray(*names).swap_dims(particle="id").sortby("id") for frame in self]
        return xarray.concat(frames, "time", join="outer", coords="minimal", compat="override")

    def to_pandas(self) -> Any:
        """All frames as one pandas.DataFrame by time and id."""
        pandas = wanted("pandas", "to_pandas")
        return pandas.concat({frame.time: frame.to_pandas() for frame in self}, names=["time"])

    def close(self) -> None:
        self._file.close()

    def __enter__(self) -> Series:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def __repr__(self) -> str:
        if not self._file:
            return "<libmps Series, closed>"
        return f"<libmps Series: {len(self)} frames, fields {', '.join(self.fields)}>"


def read_checkpoint(path: str | PathLike[str]) -> dict[str, Any]:
    """All that a checkpoint holds, to look at, by its path in the file: numbers, texts and arrays, "time", "fields/velocity"
    (particles, components), "fields/velocity/unit". A run continues from it by solver.restore(path). Needs h5py."""
    found: dict[str, Any] = {}
    with _opened(path, "read_checkpoint") as file:

        def note(name: str, item: Any) -> None:
            for word, value in item.attrs.items():
                plain = value.item() if numpy.ndim(value) == 0 and hasattr(value, "item") else value
                found[f"{name}/{word}" if name else word] = plain.decode() if isinstance(plain, bytes) else plain
            if hasattr(item, "shape"):
                values = item[()]
                if name.startswith("fields/"):  # a row a component there
                    values = values[0] if len(values) == 1 else values.T
                found[name] = values

        note("", file)
        file.visititems(note)
    return found
