"""Shows a series of libmps in ParaView as an engineer looks at it: particles as discs (spheres in space) of their size,
coloured by the field that says most, with its unit, the time, and magnified displacements where these are small.

In ParaView: Macros, Import new macro, this file; File, Open the .xdmf file ("XDMF Reader"), Apply, and then the macro
shows what is selected in the pipeline. In the Python shell or a script:

    import paraview_libmps
    paraview_libmps.open_series("out/pile.xdmf", "plastic_strain")

As a program (on a machine without a screen: xvfb-run -a pvpython ...):

    pvpython paraview_libmps.py SERIES [--field NAME] [--component K] [--time S] [--warp FACTOR]
                                [--png FILE] [--frames FOLDER] [--state FILE.pvsm]

SERIES is the .xdmf file beside the series (every ParaView from 5.9 on), or the .vtkhdf itself (5.12 and newer).
Without --field it is that of the program that wrote the file (VIEWS), or the first of FIELDS that is there.
--png writes a picture, --frames one of each frame (FOLDER/0000.png, ...) with the same colours and view, --state a state that ParaView opens by File,
Load State. --warp magnifies the field `displacement`; 1 shows it as it is, 0 leaves it out.
"""

import argparse
import os
import sys

import numpy
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy

#: What to look at first: (beginning of the file's name, field, component or "Magnitude"); the first row whose field is there.
VIEWS = (
    ("pile", "plastic_strain", 0), ("soil", "plastic_strain", 0), ("column", "plastic_strain", 0),
    ("ground", "pore_pressure", 0), ("ground", "plastic_strain", 0), ("wave", "acceleration", "Magnitude"),
    ("plate", "von_mises", 0), ("cantilever", "von_mises", 0), ("wall", "displacement", "Magnitude"),
    ("flap", "displacement", "Magnitude"), ("water", "pressure", 0), ("block", "stress", 1), ("disc", "velocity", "Magnitude"),
)
FIELDS = ("pressure", "plastic_strain", "von_mises", "displacement", "velocity", "stress")
#: Units of the fields, as mps-info lists them.
UNITS = {
    "acceleration": "m/s2", "density": "kg/m3", "displacement": "m", "mass": "kg", "pore_pressure": "Pa", "pressure": "Pa",
    "principal": "Pa", "reaction": "N", "reduced_pressure": "Pa", "stress": "Pa", "velocity": "m/s", "volume": "m3",
    "von_mises": "Pa", "young": "Pa",
}
COMPONENTS = {3: ("x", "y", "z"), 4: ("xx", "yy", "zz", "xy"), 6: ("xx", "yy", "zz", "xy", "zx", "yz")}
SMALL, LARGE = 0.02, 1.0  # displacements outside of these parts of the body's size are shown as about 5 SMALL of it
SIZE = (1200, 800)


def reader_of(path):
    """The reader of a file; of a series of VTKHDF that this ParaView cannot read the .xdmf file beside it."""
    version = simple.GetParaViewVersion()
    if path.endswith(".vtkhdf") and (version.major, version.minor) < (5, 12):
        path = path[:-len(".vtkhdf")] + ".xdmf"
    if not os.path.exists(path):
        raise FileNotFoundError(f"{path} is not there: ParaView {version} reads a series by its .xdmf file")
    path = os.path.abspath(path)  # a state that is written finds the file from anywhere
    if path.endswith(".vtkhdf"):
        return simple.VTKHDFReader(FileName=path)
    return simple.XDMFReader(FileNames=[path])


def field_of(path, arrays):
    """(name, component) to colour by."""
    name = os.path.basename(path)
    for beginning, field, component in VIEWS:
        if name.startswith(beginning) and field in arrays:
            return field, component
    for field in FIELDS:
        if field in arrays:
            return field, 0 if arrays[field] == 1 else "Magnitude"
    return "id", 0


def checked(field, component, arrays):
    """The field and component that were asked for, or an error that lists what there is."""
    if field not in arrays:
        raise ValueError(f"no field {field!r}: the series has {', '.join(sorted(arrays))}")
    count = arrays[field]
    if component is None:
        component = 0 if count == 1 else "Magnitude"
    if component != "Magnitude" and not 0 <= component < count:
        raise ValueError(f"component {component} of {field}: it has the components 0 to {count - 1}")
    return field, component


def title_of(field, component, count):
    """The words at the colour bar."""
    words = field.replace("_", " ")
    if count > 1 and component != "Magnitude":
        names = COMPONENTS.get(count)
        words += f" {names[component] if names else component}"
    return f"{words} ({UNITS[field]})" if field in UNITS else words


def points_of(reader, time):
    """Places of the particles at a time, to which the reader is brought."""
    reader.UpdatePipeline(time)
    points = servermanager.Fetch(reader).GetPoints()
    return vtk_to_numpy(points.GetData()) if points and points.GetNumberOfPoints() else numpy.zeros((0, 3))


def spacing_of(points):
    """The distance of neighbours: the median over some particles of that to the nearest one; 0 where there are none."""
    distances = []
    for k in range(0, len(points), max(1, len(points) // 100)):
        square = ((points - points[k]) ** 2).sum(axis=1)
        square[k] = numpy.inf
        distances.append(square.min() ** 0.5)
    found = float(numpy.median(distances)) if distances else 0.0
    return found if numpy.isfinite(found) else 0.0


def warp_of(points, displacement):
    """A round factor that makes small displacements visible, and those of linear theory under a unit load no larger than the body."""
    extent = float((points.max(axis=0) - points.min(axis=0)).max())
    largest = float(numpy.linalg.norm(displacement, axis=1).max())
    if largest == 0.0 or SMALL * extent <= largest <= LARGE * extent:
        return 1.0
    factor = 5.0 * SMALL * extent / largest
    power = 10.0 ** numpy.floor(numpy.log10(factor))
    return float(power * max(m for m in (1, 2, 5) if m * power <= factor))


def limits_of(values):
    """The ends of the colours: a hundredth of the particles lies outside on either side."""
    low, high = (float(v) for v in numpy.percentile(values, (1.0, 99.0)))
    if high <= low:
        low, high = float(values.min()), float(values.max())
    if high <= low:
        low, high = low - 0.5 * max(-low, 0.0), low + 0.5 * abs(low) + 1e-30
    if low > 0.0 and low < 0.2 * high:
        low = 0.0
    return low, high


def open_series(path, field=None, component=None, time=None, warp=None, film=False):
    """Opens the series and shows it in the active view; of a `film` view and colours fit all frames. Returns (what is
    shown, display, view)."""
    return show(reader_of(path), path, field, component, time, warp, film)


def values_of(data, field, component):
    """The numbers of a field that are coloured by."""
    values = vtk_to_numpy(data.GetPointData().GetArray(field))
    if values.ndim == 1:
        return values
    return numpy.linalg.norm(values, axis=1) if component == "Magnitude" else values[:, component]


def span_of(reader, source, times, field, component):
    """Ends of the colours and bounds over all frames."""
    ends, bounds = [], []
    for time in times:
        reader.UpdatePipeline(time)
        source.UpdatePipeline(time)
        ends.append(limits_of(values_of(servermanager.Fetch(reader), field, component)))
        bounds.append(source.GetDataInformation().GetBounds())
    low, high = numpy.array(bounds).min(axis=0), numpy.array(bounds).max(axis=0)
    bounds = [f(low[k], high[k]) for k, f in enumerate((lambda a, b: a, lambda a, b: b) * 3)]
    return (min(e[0] for e in ends), max(e[1] for e in ends)), bounds


def show(reader, path, field=None, component=None, time=None, warp=None, film=False):
    """Shows a reader's particles in the active view; `path` says which program wrote them."""
    reader.UpdatePipelineInformation()
    times = list(reader.TimestepValues or [])
    view = simple.GetActiveViewOrCreate("RenderView")
    simple.GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
    view.ViewTime = time if time is not None else (times[-1] if times else 0.0)
    spacing = spacing_of(points_of(reader, times[0])) if times else None  # later frames may be strained
    points = points_of(reader, view.ViewTime)
    spacing = spacing or spacing_of(points) or 1.0
    data = servermanager.Fetch(reader)
    information = reader.GetPointDataInformation()
    arrays = {information.GetArray(k).Name: information.GetArray(k).GetNumberOfComponents()
              for k in range(information.GetNumberOfArrays())}
    if field is None:
        field, component = field_of(path, arrays)
    field, component = checked(field, component, arrays)
    source = reader
    if "displacement" in arrays and not os.path.basename(path).startswith(("wave", "soil")):  # these are where they have moved to
        factor = warp_of(points, vtk_to_numpy(data.GetPointData().GetArray("displacement"))) if warp is None else warp
        if factor != 0.0:
            source = simple.WarpByVector(Input=reader, Vectors=["POINTS", "displacement"], ScaleFactor=factor)
            if factor != 1.0:
                label(view, f"displacements x {factor:g}", "Lower Left Corner")
    elif warp:
        raise ValueError("--warp: the particles of this series are where they have moved to")
    if len(times) > 1:
        stamp = simple.AnnotateTimeFilter(Input=reader, Format="t = {time:.4g} s")
        styled(simple.Show(stamp, view), "Upper Left Corner")
    source.UpdatePipeline(view.ViewTime)  # a warp has no bounds before
    limits, bounds = limits_of(values_of(data, field, component)), source.GetDataInformation().GetBounds()
    if film and len(times) > 1:
        limits, bounds = span_of(reader, source, times, field, component)
    flat = numpy.ptp(points[:, 2]) == 0.0
    display = simple.Show(source, view)
    display.SetRepresentationType("Point Gaussian")
    display.GaussianRadius = (0.65 if flat else 0.6) * spacing
    display.ShaderPreset = "Plain circle" if flat else "Sphere"
    wide = flat and bounds[3] - bounds[2] < 0.6 * (bounds[1] - bounds[0])
    paint(display, view, field, component, arrays[field], limits, wide)
    view.Background = [1, 1, 1]
    view.UseColorPaletteForBackground = 0
    aim(view, flat, bounds)
    return source, display, view


def label(view, words, place):
    text = simple.Text(Text=words)
    styled(simple.Show(text, view), place)


def styled(display, place):
    display.WindowLocation, display.Color, display.FontSize = place, [0, 0, 0], 16


def paint(display, view, field, component, count, limits, wide):
    """Colours by the field, with a bar that says which and in what unit: below what is wide, else to the right."""
    simple.ColorBy(display, ("POINTS", field, *([] if component == "Magnitude" else [str(component)])))
    colours = simple.GetColorTransferFunction(field)
    signed = limits[0] < 0.0 < limits[1]
    colours.ApplyPreset("Cool to Warm" if signed else "Viridis (matplotlib)", True)
    ends = (-max(map(abs, limits)), max(map(abs, limits))) if signed else limits
    colours.RescaleTransferFunction(*ends)
    display.SetScalarBarVisibility(view, True)
    bar = simple.GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle = title_of(field, component, count), ""
    bar.TitleColor = bar.LabelColor = [0, 0, 0]
    bar.TitleFontSize, bar.LabelFontSize = 18, 16
    bar.WindowLocation, bar.Orientation, bar.ScalarBarLength = "Any Location", "Horizontal" if wide else "Vertical", 0.4
    bar.Position = [0.3, 0.04] if wide else [0.82, 0.3]


def aim(view, flat, bounds):
    """Looks at the plane, or in space from the corner at the origin, where cuts of symmetry lie; z is up."""
    if flat:
        view.InteractionMode = "2D"
    else:
        view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [-1.0, -1.6, 0.9], [0, 0, 0], [0, 0, 1]
    simple.ResetCamera(view)
    view.SMProxy.ResetCamera(*bounds)
    camera = view.GetActiveCamera()
    camera.Zoom(0.9)
    simple.Render(view)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("series")
    parser.add_argument("--field")
    parser.add_argument("--component", type=int)
    parser.add_argument("--time", type=float)
    parser.add_argument("--warp", type=float)
    parser.add_argument("--png")
    parser.add_argument("--frames")
    parser.add_argument("--state")
    given = parser.parse_args()
    simple._DisableFirstRenderCameraReset()
    simple.GetActiveViewOrCreate("RenderView").ViewSize = list(SIZE)
    try:
        source, _, view = open_series(given.series, given.field, given.component, given.time, given.warp, bool(given.frames))
    except (FileNotFoundError, ValueError) as error:
        sys.exit(f"paraview_libmps: {error}")
    times = list(simple.GetTimeKeeper().TimestepValues or []) or [view.ViewTime]
    print(f"{given.series}: {len(times)} frames, "
          f"{source.GetDataInformation().GetNumberOfPoints()} particles in this one")
    if given.png:
        simple.SaveScreenshot(given.png, view, ImageResolution=list(SIZE))
    if given.frames:
        os.makedirs(given.frames, exist_ok=True)
        for k, time in enumerate(times):
            view.ViewTime = time
            simple.SaveScreenshot(os.path.join(given.frames, f"{k:04d}.png"), view, ImageResolution=list(SIZE))
    if given.state:
        simple.SaveState(given.state)


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
