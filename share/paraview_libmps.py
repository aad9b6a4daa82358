"""Opens a series of libmps in ParaView as particles coloured by the field that shows most; as a script of pvpython
it writes a picture.

In ParaView: Macros, Import new macro, this file; File, Open the .xdmf file ("XDMF Reader"), Apply, and then the macro
shows what is selected in the pipeline. In the Python shell or a script:

    import paraview_libmps
    paraview_libmps.open_series("out/pile.xdmf", "plastic_strain")

As a program (on a machine without a screen: xvfb-run -a pvpython ...):

    pvpython paraview_libmps.py SERIES [--field NAME] [--component K] [--time S] [--png FILE]

SERIES is the .xdmf file beside the series (every ParaView from 5.9 on), or the .vtkhdf itself (5.12 and newer).
Without --field it is that of the program that wrote the file, or the first of FIELDS that is there.
"""

import argparse
import os
import sys

import numpy
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy

#: What an engineer looks at first: by the beginning of the file's name, (field, component or "Magnitude").
PROGRAMS = {
    "pile": ("plastic_strain", 0), "footing": ("plastic_strain", 0), "soil": ("plastic_strain", 0),
    "column": ("plastic_strain", 0), "ground": ("plastic_strain", 0), "wave": ("acceleration", "Magnitude"), "plate": ("von_mises", 0),
    "cantilever": ("von_mises", 0), "wall": ("von_mises", 0), "water": ("pressure", 0), "tank": ("pressure", 0),
    "dam": ("pressure", 0), "fluid": ("pressure", 0),
}
FIELDS = ("pressure", "plastic_strain", "von_mises", "displacement", "velocity", "stress")


def reader_of(path):
    """The reader of a file; of a series of VTKHDF that this ParaView cannot read the .xdmf file beside it."""
    version = simple.GetParaViewVersion()
    if path.endswith(".vtkhdf") and (version.major, version.minor) < (5, 12):
        path = path[:-len(".vtkhdf")] + ".xdmf"
    if not os.path.exists(path):
        raise FileNotFoundError(f"{path} is not there: ParaView {version} reads a series by its .xdmf file")
    if path.endswith(".vtkhdf"):
        return simple.VTKHDFReader(FileName=path)
    return simple.XDMFReader(FileNames=[path])


def field_of(path, arrays):
    """(name, component) to colour by."""
    name = os.path.basename(path)
    for beginning, (field, component) in PROGRAMS.items():
        if name.startswith(beginning) and field in arrays:
            return field, component
    for field in FIELDS:
        if field in arrays:
            return field, 0 if arrays[field] == 1 else "Magnitude"
    return "id", 0


def spacing_of(reader, time):
    """The distance of neighbours at a time: the median over some particles of that to the nearest one."""
    reader.UpdatePipeline(time)
    points = vtk_to_numpy(servermanager.Fetch(reader).GetPoints().GetData())
    distances = []
    for k in range(0, len(points), max(1, len(points) // 100)):
        square = ((points - points[k]) ** 2).sum(axis=1)
        square[k] = numpy.inf
        distances.append(square.min() ** 0.5)
    found = float(numpy.median(distances))
    return found if numpy.isfinite(found) and found > 0 else 1.0


def open_series(path, field=None, component=None, time=None):
    """Opens the series and shows it in the active view. Returns (reader, display, view)."""
    return show(reader_of(path), path, field, component, time)


def show(reader, path, field=None, component=None, time=None):
    """Shows a reader's particles in the active view; `path` says which program wrote them."""
    reader.UpdatePipelineInformation()
    times = list(reader.TimestepValues or [])
    view = simple.GetActiveViewOrCreate("RenderView")
    simple.GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
    view.ViewTime = time if time is not None else (times[-1] if times else 0.0)
    spacing = spacing_of(reader, times[0] if times else 0.0)
    reader.UpdatePipeline(view.ViewTime)
    data = reader.GetPointDataInformation()
    arrays = {data.GetArray(k).Name: data.GetArray(k).GetNumberOfComponents()
              for k in range(data.GetNumberOfArrays())}
    if field is None:
        field, component = field_of(path, arrays)
    elif field not in arrays:
        raise ValueError(f"no field {field!r}: the series has {', '.join(sorted(arrays))}")
    if component is None:
        component = 0 if arrays[field] == 1 else "Magnitude"
    display = simple.Show(reader, view)
    display.SetRepresentationType("Point Gaussian")
    display.GaussianRadius = 0.6 * spacing
    display.ShaderPreset = "Plain circle"
    simple.ColorBy(display, ("POINTS", field, *([] if component == "Magnitude" else [str(component)])))
    display.RescaleTransferFunctionToDataRange(False, True)
    display.SetScalarBarVisibility(view, True)
    view.Background = [1, 1, 1]
    view.UseColorPaletteForBackground = 0
    bar = simple.GetScalarBar(simple.GetColorTransferFunction(field), view)
    bar.TitleColor = bar.LabelColor = [0, 0, 0]
    bar.TitleFontSize = bar.LabelFontSize = 12
    bar.WindowLocation, bar.Position, bar.ScalarBarLength = "Any Location", [0.8, 0.3], 0.4
    if reader.GetDataInformation().GetBounds()[4] == reader.GetDataInformation().GetBounds()[5]:
        view.InteractionMode = "2D"
    simple.ResetCamera(view)
    view.GetActiveCamera().Zoom(0.8)  # room for the colour bar
    simple.Render(view)
    return reader, display, view


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("series")
    parser.add_argument("--field")
    parser.add_argument("--component", type=int)
    parser.add_argument("--time", type=float)
    parser.add_argument("--png")
    given = parser.parse_args()
    reader, _, view = open_series(given.series, given.field, given.component, given.time)
    times = list(reader.TimestepValues or [])
    print(f"{given.series}: {max(1, len(times))} frames, "
          f"{reader.GetDataInformation().GetNumberOfPoints()} particles in this one")
    if given.png:
        simple.SaveScreenshot(given.png, view, ImageResolution=[1200, 800])


def as_macro():
    """In ParaView's window: shows the series that is selected in the pipeline."""
    reader = simple.GetActiveSource()
    if reader is None:
        raise RuntimeError("select a series in the pipeline browser first (File, Open: the .xdmf file)")
    named = getattr(reader, "FileNames", None) or getattr(reader, "FileName", None) or "series"
    show(reader, named if isinstance(named, str) else named[0])


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main()
    else:
        as_macro()
