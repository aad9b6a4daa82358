"""How long the arrays are that C reads and writes, as the headers say it: a shorter one is refused before
C sees it.

A length is a formula of other arguments (members) by name, and of

    dim, particles     of the particle set among the arguments, or of the solver's
    components(name)   of the field `name` of that set
    size               of the coupling
    nodes(number)      of a wall of the fluid
    MPS_...            a constant

Every array of the headers stands here: tests/python looks for missing ones. An array given as a table must have as
many columns as the formula says: 2 of `2 * vertices`. A number that a formula has, such as `vertices`, is no argument in
Python: the array says it."""

import re

#: name of the function: {parameter: length}
FUNCTIONS = {
    "mps_signal_create_table": {"times": "count", "values": "count"},
    "mps_body_create_polygon": {"xy": "2 * vertices"},
    "mps_body_create_half_plane": {"normal": "2"},
    "mps_body_create_half_space": {"normal": "3"},
    "mps_body_create_revolution": {"rz": "2 * vertices"},
    "mps_body_create_mesh": {"xyz": "3 * vertices", "corner": "3 * triangles"},
    "mps_body_set_load": {"force": "3", "moment": "3"},
    "mps_body_distance": {"x": "dim * count", "distance": "count", "normal": "dim * count",
                          "foot": "dim * count", "face": "count"},
    "mps_contact_get_particles": {"ids": "capacity", "gap": "capacity", "normal": "3 * capacity",
                                  "force": "3 * capacity", "foot": "3 * capacity"},
    "mps_coupling_begin": {"start": "size", "guess": "size"},
    "mps_coupling_next": {"answer": "size", "guess": "size"},
    "mps_coupling_get_memory": {"values": "capacity"},
    "mps_coupling_set_memory": {"values": "count"},
    "mps_particles_append": {"positions": "dim * count"},
    "mps_particles_fill_box": {"lo": "dim", "hi": "dim"},
    "mps_particles_fill_polygon": {"xy": "2 * vertices"},
    "mps_particles_fill_ball": {"centre": "dim"},
    "mps_particles_fill_where": {"lo": "dim", "hi": "dim"},
    "mps_particles_remove": {"ids": "count"},
    "mps_solver_get_numbers": {"numbers": "capacity"},
    "mps_particles_select_box": {"lo": "dim", "hi": "dim", "ids": "capacity"},
    "mps_particles_nearest": {"x": "dim"},
    "mps_particles_set_material": {"ids": "count"},
    "mps_domain_max": {"values": "count"},
    "mps_history_create": {"columns": "count", "units": "count"},
    "mps_history_record": {"values": "count"},
    "mps_domain_gather_fields": {"names": "count"},
    "mps_domain_get_field": {"ids": "count", "values": "count * components(name)"},
    "mps_material_point_drive": {"gradient": "9"},
    "mps_particles_set_table": {"positions": "dim * count", "values": "components * count"},
    "mps_particles_set_array": {"values": "count if component >= 0 else count * components(name)"},
    "mps_particles_set_profile": {"depth": "count", "value": "count"},
    "mps_material_point_control": {"gradient": "9", "target": "6", "found": "9"},
    "mps_dynamics_set_material": {"ids": "count"},
    "mps_elastic_set_material": {"ids": "count"},
    "mps_elastic_cut": {"ids": "count"},
    "mps_elastic_select_facets": {"lo": "dim", "hi": "dim", "facets": "capacity"},
    "mps_elastic_get_facets": {"facets": "count"},
    "mps_elastic_get_load_resultant": {"about": "3", "force": "3", "moment": "3"},
    "mps_elastic_solve_cases": {"loads": "3 * count * particles",
                                "displacements": "3 * count * particles"},
    "mps_elastic_get_section": {"about": "3", "force": "3", "moment": "3"},
    "mps_elastic_modes": {"omega": "count", "shapes": "3 * count * particles"},
    "mps_fluid_set_boundary_motion": {"displacement": "max(1, nodes(number))",
                                  "velocity": "max(1, nodes(number))"},
    "mps_fluid_get_segments": {"force": "3 * capacity", "moment": "capacity"},
    "mps_fluid_get_boundary_points": {"x": "3 * capacity", "pressure": "capacity"},
    "mps_fluid_get_pressure": {"x": "3 * count", "pressure": "count"},
    "mps_fluid_get_body_pressure": {"x": "3 * count", "pressure": "count"},
    "mps_fluid_get_levels": {"station": "count", "level": "count"},
    "mps_mpm_set_material": {"ids": "count"},
    "mps_neighbours_lists": {"offsets": "count + 1", "indices": "last(offsets)"},
    "mps_mpm_set_pore_level": {"point": "dim"},
    "mps_waves_get_components": {"frequency": "capacity", "amplitude": "capacity", "phase": "capacity"},
    "mps_waves_get_levels": {"t": "count", "linear": "count", "level": "count"},
    "mps_waves_get_piston": {"t": "count", "displacement": "count", "velocity": "count",
                             "acceleration": "count", "level": "count"},
    "mps_absorber_get_memory": {"values": "MPS_ABSORBER_MEMORY"},
    "mps_absorber_set_memory": {"values": "MPS_ABSORBER_MEMORY"},
    "mps_separation_find": {"frequency": "capacity", "incident": "capacity", "reflected": "capacity"},
    "mps_overtopping_find": {"thin": "capacity"},
    "mps_grid_get_nodes": {"position": "3 * capacity", "mass": "capacity",
                           "velocity": "3 * capacity", "force": "3 * capacity"},
    "mps_grid_evaluate": {"points": "3 * count", "states": "count",
                          "values": "count if component >= 0 else count * components(field)"},
}

#: name of the struct: {member: length}
STRUCTS = {
    "mps_material_user_def": {"history": "history_count", "history_initial": "history_count"},
    "mps_material_umat_def": {"props": "props_count", "statev_names": "statev_count",
                     "statev_initial": "statev_count"},
    "mps_dynamics_boundary_def": {"ids": "id_count"},
    "mps_dynamics_load_def": {"ids": "id_count"},
    "mps_elastic_boundary_def": {"ids": "id_count",
                                  "values": "id_count if kind == MPS_BOUNDARY_ROLLER else 3 * id_count"},
    "mps_elastic_load_def": {"ids": "id_count",
                             "values": "id_count if kind == MPS_ELASTIC_LOAD_PRESSURE else 3 * id_count"},
    "mps_elastic_facet_arrays": {"particle": "count", "centre": "3 * count", "normal": "3 * count",
                                 "extent": "3 * count", "area": "count",
                                 "displacement": "3 * count", "velocity": "3 * count"},
    "mps_fluid_boundary_def": {"nodes": "3 * node_count", "corners": "3 * corner_count"},
    "mps_fluid_rock_def": {"corners": "3 * corner_count"},
    "mps_fluid_load_def": {"ids": "id_count"},
    "mps_geostatic_def": {"layers": "layer_count", "surface_line": "2 * surface_points"},
    "mps_consolidation_def": {"ids": "count"},
    "mps_mpm_boundary_def": {"ids": "id_count"},
    "mps_overtopping_def": {"times": "samples", "heads": "samples", "volumes": "samples"},
    "mps_separation_def": {"position": "gauges", "times": "samples", "levels": "samples * gauges"},
    "mps_waves_def": {"frequency": "count", "density": "count", "times": "samples",
                      "levels": "samples"},
    "mps_mpm_load_def": {"ids": "id_count", "area": "id_count"},
}

#: Numbers where no array says them: a property of the object, or a formula.
WITHOUT = {
    ("mps_elastic_get_facets", "count"): "facet_count",
    ("mps_overtopping_find", "capacity"): "samples",
}

#: C type of a callback: ({array that it reads: length}, {what it returns: length}). Besides the words above
#:
#:     equation   this rank's rows of the last matrix that a linear solver received
#:
#: A callback that is not here gets numbers, texts and objects, and returns nothing or a status.
CALLBACKS = {
    "mps_particles_predicate_fn": ({"x": "dim"}, {"inside": "1"}),
    "mps_signal_fn": ({}, {"motion": "3"}),
    "mps_geostatic_level_fn": ({"x": "dim"}, {"level": "1"}),
    "mps_geostatic_stress_fn": ({"x": "dim"}, {"stress": "4 if dim == 2 else 6"}),
    "mps_elastic_traction_fn": ({"x": "dim", "normal": "dim"}, {"traction": "dim"}),
    "mps_history_fn": ({}, {"value": "1"}),
    "mps_linear_matrix_fn": ({"matrix": "1"}, {}),
    "mps_linear_solve_fn": ({"b": "equation", "x": "equation"}, {"x": "equation"}),
}



def passed(callback, names):
    """Which parameters of a C callback (without `user`) the Python function is called with."""
    if callback in ("mps_material_fn", "mps_material_moduli_fn"):
        return ["block"]
    reads, returns = CALLBACKS.get(callback, ({}, {}))
    return [name for name in names if name in reads or name not in (*returns, "result")]


def answer(callback):
    """What the Python function of a C callback returns, as " -> traction (dim numbers)"; "" of one that answers nothing
    or a status."""
    if callback == "mps_material_moduli_fn":
        return " -> moduli (one number a particle)"
    returns = CALLBACKS.get(callback, ({}, {}))[1]
    return "".join(f" -> {name} ({'True or False' if name == 'inside' else 'a number' if n == '1' else n + ' numbers'})"
                   for name, n in returns.items())


#: Structs that a callback receives: {member: length}, of other members.
RECEIVED = {
    "mps_linear_matrix": {"start": "rows + 1", "column": "entries", "value": "entries", "mode": "modes * rows"},
}


def length(formula, words):
    """The number that a formula gives; `words` finds the value of a name."""
    return int(eval(formula, {"__builtins__": {}, "max": max}, words))  # formulas of this file alone


def _branch(formula, words):
    """The part of a formula with a condition that holds."""
    choice = re.fullmatch(r"(.+) if (.+) else (.+)", formula)
    return choice[1 if eval(choice[2], {"__builtins__": {}}, words) else 3] if choice else formula


def counts(formula):
    """The numbers by name that a formula multiplies."""
    choice = re.fullmatch(r"(.+) if (.+) else (.+)", formula)
    if choice:
        return counts(choice[1]) | counts(choice[3])
    return {word for word in formula.split(" * ") if re.fullmatch(r"[a-z_]+", word)}


def solve(formula, word, size, words):
    """The value of `word` with which a formula gives `size`; None where others are not known."""
    try:
        factors = _branch(formula, words).split(" * ")
        if word not in factors:
            return None
        factors.remove(word)
        other = length(" * ".join(factors), words) if factors else 1
    except (KeyError, AttributeError):
        return None
    return size // other if other > 0 else None


def _of_row(factor):
    """Whether a factor is the length of a row."""
    return factor.isdigit() or factor == "dim" or factor.startswith("components")


def width(formula, words):
    """How many numbers a row has where the array is given as a table; None: it is a list of single numbers."""
    factors = _branch(formula, words).split(" * ")
    if len(factors) == 1:
        return None
    return length(next(filter(_of_row, factors), factors[-1]), words)


def shape(formula, words):
    """The shape of an array that C fills: a row for each particle, point or instant."""
    factors = _branch(formula, words).split(" * ")
    order = sorted(factors, key=_of_row)  # those of a row are last
    found = tuple(length(factor, words) for factor in order)
    return found[:-1] if len(found) > 1 and found[-1] == 1 else found


def bits(numbers):
    """Places of bits as the number that has them; that of any (-1) is no bit."""
    return sum({1 << number for number in numbers if number >= 0})
