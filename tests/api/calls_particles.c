/* calls_particles.c - sets: filling, fields, editing, selection.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls.h"

#include <float.h>

#include <mps/soil.h>
#include <mps/material.h>
#include <mps/experimental/soil.h>

#include <stdlib.h>

static void particles_create(api *a) {
  mps_particles *made = NULL;
  mps_context *context = api_context(a);
  mps_particles_def def = mps_particles_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.dim = a->latest || api_chance(a, 85) ? a->dim : (int32_t)api_whole(a, "dim", 2, 3);
  def.spacing = api_real(a, "spacing", 1e-12, 1e12, 0.1);
  if (!a->latest && api_chance(a, 30)) api_vector(a, "origin", 3, 0.0, 0.1, def.origin);
  const mps_status status = mps_particles_create(context, api_null(a, "def") ? NULL : &def,
                                                 api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_SET, made, NULL);
}

API_DESTROY(particles_destroy, API_SET)
API_QUERY(particles_count, API_SET)
API_QUERY(particles_dim, API_SET)
API_QUERY(particles_spacing, API_SET)
API_QUERY(particles_epoch, API_SET)
API_QUERY(particles_field_count, API_SET)

/* ---- filling --------------------------------------------------------------------------------- */

void api_box(api *a, double size, double *lo, double *hi) {
  const api_mood mood = a->mood;
  if (mood == API_EDGE) a->mood = API_VALID;
  const double from = a->latest ? 0.0 : 0.25;
  api_vector(a, "lo", 3, from, from, lo);
  api_vector(a, "hi", 3, from + size, a->latest ? 0.0 : 0.5 * size, hi);
  a->mood = mood;
}

/* Sets stay small: a full one gets a particle or four. */
static double room(const mps_particles *set) {
  if (mps_particles_count(set) >= API_MOST) return 0.15;
  return mps_particles_dim(set) == 3 ? 0.35 : 0.6;
}

static void particles_fill_box(api *a) {
  double lo[3], hi[3];
  int64_t added = -1;
  mps_particles *set = api_any(a, API_SET)->handle;
  api_box(a, room(set), lo, hi);
  if (mps_particles_dim(set) == 2 && a->wrong == 1) a->wrong = isnan(lo[0]) || isnan(lo[1]);
  const bool no_lo = api_null(a, "lo"), no_hi = api_null(a, "hi");
  const mps_status status =
      mps_particles_fill_box(set, no_lo ? NULL : lo, no_hi ? NULL : hi, &added);
  if (status == MPS_OK && added < 0) api_broken(a, "added %d", (int)added);
  (void)api_end(a, status);
}

static void particles_fill_ball(api *a) {
  double centre[3];
  mps_particles *set = api_any(a, API_SET)->handle;
  api_vector(a, "centre", 3, 0.5, 0.3, centre);
  const bool third = mps_particles_dim(set) == 2 && a->wrong == 1 && !isfinite(centre[2]) &&
                     isfinite(centre[0]) && isfinite(centre[1]);
  if (third) a->wrong = 0;
  const api_mood mood = a->mood;
  if (mood == API_EDGE) a->mood = API_VALID;
  const double radius = api_real(a, "radius", 5e-324, DBL_MAX, 0.5 * room(set));
  a->mood = mood;
  (void)api_end(a, mps_particles_fill_ball(set, api_null(a, "centre") ? NULL : centre, radius,
                                           api_chance(a, 50) ? &(int64_t){0} : NULL));
}

static void particles_fill_polygon(api *a) {
  double xy[12];
  mps_particles *set = api_any(a, API_SET)->handle;
  const double size = room(set);
  const int64_t vertices = api_least(a, "vertices", 3, 4);
  const double corners[] = {0, 0, size, 0, size, size, 0, size};
  for (int k = 0; k < 4; k++) api_vector(a, "", 2, 0.0, 0.1 * size, xy + 2 * k);
  for (int k = 0; k < 8; k++) xy[k] += corners[k];
  if (vertices == 3) a->wrong = 0;
  (void)api_end(a, mps_particles_fill_polygon(set, vertices, api_null(a, "xy") ? NULL : xy, NULL));
}

static void particles_fill_where(api *a) {
  double lo[3], hi[3];
  mps_particles *set = api_any(a, API_SET)->handle;
  const api_mood mood = a->mood;
  a->mood = API_VALID; /* 2^31 calls take long */
  api_box(a, room(set), lo, hi);
  a->mood = mood;
  if (mood == API_ABSURD && api_chance(a, 30)) hi[0] = NAN, api_wrong(a, "hi");
  api_arm(a);
  (void)api_end(a, mps_particles_fill_where(set, lo, hi,
                                            api_null(a, "inside") ? NULL : api_inside_disc,
                                            &a->plan, NULL));
}

static void particles_append(api *a) {
  double x[12];
  mps_particles *set = api_any(a, API_SET)->handle;
  const int32_t dim = mps_particles_dim(set);
  const int64_t count = api_least(a, "count", 0, 3);
  const api_mood mood = a->mood;
  if (count <= 0) a->mood = API_VALID;
  for (int k = 0; k < 4; k++) {
    if (k >= count) a->mood = API_VALID;
    api_vector(a, "", dim > 0 ? dim : 2, 0.5, 0.5, x + 3 * k);
    if (dim == 2) memmove(x + 2 * k, x + 3 * k, 2 * sizeof *x);
  }
  a->mood = mood;
  const bool none = count != 0 && api_null(a, "positions");
  (void)api_end(a, mps_particles_append(set, count, none ? NULL : x));
}

static void particles_remove(api *a) {
  int64_t ids[4] = {0};
  mps_particles *set = api_any(a, API_SET)->handle;
  const int64_t count = api_ids(a, set, 1 + api_below(a, 3), ids);
  const bool none = count > 0 && api_null(a, "ids");
  (void)api_end(a, mps_particles_remove(set, none ? NULL : ids, count));
}

/* ---- fields ---------------------------------------------------------------------------------- */

static void particles_add_field(api *a) {
  mps_particles *set = api_any(a, API_SET)->handle;
  const char *name = api_field(a, set);
  int32_t components = 0;
  if (strcmp(name, "user.my_field") == 0) components = (int32_t)api_whole(a, "components", 1, 16);
  if (a->mood == API_ABSURD && api_chance(a, 20)) components = -1, api_wrong(a, "components");
  (void)api_end(a, mps_particles_add_field(set, api_null(a, "name") ? NULL : name, components));
}

static void particles_has_field(api *a) {
  api_begin(a, "mps_particles_has_field");
  const mps_particles *set = api_any(a, API_SET)->handle;
  const char *name = api_field(a, (mps_particles *)set);
  const int32_t there = mps_particles_has_field(set, api_null(a, "name") ? NULL : name);
  if (there != 0 && (there != 1 || a->wrong > 0)) api_broken(a, "answers %d", (int)there);
  api_end_query(a);
}

static void particles_remove_field(api *a) {
  api_begin(a, "mps_particles_remove_field");
  mps_particles *set = api_any(a, API_SET)->handle;
  const char *name = api_field(a, set);
  const uint64_t epoch = mps_particles_epoch(set);
  const bool none = api_null(a, "name");
  if (!a->latest && api_chance(a, 60)) name = "user.my_field", api_say(a, "or \"%s\", ", name);
  const mps_status status = mps_particles_remove_field(set, none ? NULL : name);
  if (status == MPS_OK && mps_particles_epoch(set) == epoch) api_broken(a, "keeps the epoch");
  if (status == MPS_OK) a->wrong = 0;
  (void)api_end(a, status);
}

static void particles_view(api *a) {
  mps_view view;
  mps_particles *set = api_any(a, API_SET)->handle;
  const char *name = api_field(a, set);
  const mps_status status = mps_particles_view(set, name, api_null(a, "out") ? NULL : &view);
  if (status == MPS_OK && (view.shape[0] != mps_particles_count(set) || view.shape[1] < 1 ||
                           view.epoch != mps_particles_epoch(set)))
    api_broken(a, "a view of another shape or epoch");
  a->reads = true;
  (void)api_end(a, status);
}

/* A value of the size that scenes have. */
static double typical(api *a, const char *name) {
  static const struct {
    const char *name;
    double value;
  } table[] = {{"density", 1000.0},
               {"young", 1e6},
               {"poisson", 0.3},
               {"shear_velocity", 20.0},
               {"pressure_velocity", 40},
               {"damping", 0.02},
               {"volume", 0.01},
               {"temperature", 300.0},
               {"mass", 10.0}};
  for (int k = 0; k < API_COUNT(table); k++)
    if (strcmp(name, table[k].name) == 0)
      return api_real(a, "value", 1e-300, 1e300, table[k].value);
  return api_near(a, "value", 0.0, 0.2);
}

static void particles_set(api *a) {
  mps_particles *set = api_any(a, API_SET)->handle;
  const char *name = api_field(a, set);
  const int32_t component = (int32_t)(api_chance(a, 80) ? 0 : api_whole(a, "component", 0, 15));
  const int before = a->wrong;
  const double value = typical(a, name);
  if (strcmp(name, "stress") == 0) api_loosen(a);
  api_rewrite(a, name);
  if (isfinite(value)) a->wrong = before; /* each field has a range of its own */
  (void)api_end(a, mps_particles_set(set, api_null(a, "name") ? NULL : name, component, value));
}

static void particles_set_array(api *a) {
  api_begin(a, "mps_particles_set_array");
  mps_particles *set = api_any(a, API_SET)->handle;
  const char *name = api_field(a, set);
  const int32_t component = (int32_t)api_whole(a, "component", -1, api_chance(a, 80) ? 0 : 15);
  if (component >= 0 && component < 16) a->wrong -= a->wrong > 0; /* a field may have so many */
  const int before = a->wrong;
  int64_t count = mps_particles_count(set);
  const double value = typical(a, name);
  double *values = malloc((size_t)(16 * count + 1) * sizeof *values);
  for (int64_t k = 0; values && k < 16 * count; k++) values[k] = k == 0 ? value : floor(value);
  const bool position = strcmp(name, "position") == 0;
  if (isfinite(value) || count == 0) a->wrong = before; /* each field has a range of its own */
  if (a->mood == API_ABSURD && api_chance(a, 20)) count += 1, api_wrong(a, "count");
  const bool none = count > 0 && api_null(a, "values");
  if (strcmp(name, "stress") == 0) api_loosen(a);
  api_rewrite(a, name);
  if (!position || component != -1) /* all particles in one place */
    (void)api_end(a, mps_particles_set_array(set, api_null(a, "name") ? NULL : name, component,
                                             none ? NULL : values, count));
  else
    (void)api_end(a, mps_particles_set_array(set, NULL, component, none ? NULL : values, count));
  free(values);
}

static void particles_copy(api *a) {
  api_begin(a, "mps_particles_copy");
  mps_particles *made = NULL;
  const mps_particles *set = api_any(a, API_SET)->handle;
  const mps_status status = mps_particles_copy(set, api_null(a, "out") ? NULL : &made);
  if (status == MPS_OK && (mps_particles_count(made) != mps_particles_count(set) ||
                           mps_particles_field_count(made) != mps_particles_field_count(set)))
    api_broken(a, "copies other numbers");
  (void)api_end_made(a, status, API_SET, made, NULL);
}

static void particles_field_sized(api *a) {
  const mps_particles *set = api_any(a, API_SET)->handle;
  const int32_t most = mps_particles_field_count(set);
  const int32_t index = (int32_t)api_whole(a, "index", 0, most > 0 ? most - 1 : 0);
  API_SIZED(a, mps_particles_field_info, size, out);
  const mps_status status =
      mps_particles_get_field_info_sized(set, index, api_null(a, "out") ? NULL : out, size);
  API_SIZED_END(a, status, size, out, true);
}

/* ---- editing --------------------------------------------------------------------------------- */

static int free_edit(const api_object *o) {
  for (int k = 0; k < API_EDITS; k++)
    if (!o->edits[k].data) return k;
  return -1;
}

static int open_edit(api *a, const api_object *o) {
  const int from = (int)api_below(a, API_EDITS);
  for (int k = 0; k < API_EDITS; k++)
    if (o->edits[(from + k) % API_EDITS].data) return (from + k) % API_EDITS;
  return -1;
}

/* Positions by a little, others to what is usual; absurd: anything. */
static void write_field(api *a, const mps_edit *edit, const char *name) {
  if (edit->view.dtype.code != 2 || edit->view.shape[0] == 0) return;
  const int64_t first = (int64_t)api_below(a, (uint32_t)edit->view.shape[0]);
  const bool position = strcmp(name, "position") == 0;
  for (int64_t i = first; i < edit->view.shape[0] && i < first + 5; i++)
    for (int64_t c = 0; c < edit->view.shape[1]; c++) {
      double *at = mps_edit_f64(edit, i, c);
      const double shift = 0.02 * (api_unit(a) - 0.5);
      *at = position ? *at + shift : typical(a, name);
      if (position && a->mood == API_ABSURD && api_chance(a, 10)) *at = api_near(a, "x", 0.5, 9.0);
    }
}

static void particles_edit(api *a) {
  mps_edit edit;
  api_object *o = api_any(a, API_SET);
  const char *name = api_field(a, o->handle);
  const mps_status status = mps_particles_edit(o->handle, api_null(a, "name") ? NULL : name,
                                               api_null(a, "out") ? NULL : &edit);
  if (status == MPS_OK) {
    const int k = free_edit(o);
    a->wrong = 0; /* of the values that follow */
    if (k < 0 || !edit.data) {
      (void)!mps_particles_abandon(o->handle, &edit);
    } else {
      write_field(a, &edit, name);
      o->edits[k] = edit;
      strncpy(o->edited[k], name, sizeof o->edited[k] - 1);
      a->wrong = 0;
    }
  }
  (void)api_end(a, status);
}

/* Some set with a field that is open, if there is one. */
static api_object *editing(api *a) {
  for (int k = 0; k < API_SLOTS; k++) {
    api_object *o = &a->objects[API_SET][k];
    if (o->handle && open_edit(a, o) >= 0 && a->mood != API_ABSURD) {
      a->context = o->context;
      a->picked = true;
      api_say(a, "set%d, ", k);
      return o;
    }
  }
  return api_any(a, API_SET);
}

static void end_edit(api *a, bool commit) {
  api_loosen(a);
  api_object *o = editing(a);
  const int k = open_edit(a, o);
  mps_edit none;
  memset(&none, 0, sizeof none);
  mps_edit *edit = k >= 0 ? &o->edits[k] : &none;
  if (k >= 0) api_rewrite(a, o->edited[k]);
  if (k >= 0) api_say(a, "\"%s\", ", o->edited[k]);
  if (k < 0) api_wrong(a, "edit");
  if (api_null(a, "edit")) edit = NULL;
  const mps_status status =
      commit ? mps_particles_commit(o->handle, edit) : mps_particles_abandon(o->handle, edit);
  if (status == MPS_OK && edit && edit->data) api_broken(a, "leaves data");
  (void)api_end(a, status);
}

static void particles_commit(api *a) { end_edit(a, true); }
static void particles_abandon(api *a) { end_edit(a, false); }

/* ---- selection ------------------------------------------------------------------------------- */

static void particles_select_box(api *a) {
  double lo[3], hi[3];
  int64_t ids[66], count = -1;
  mps_particles *set = api_any(a, API_SET)->handle;
  const api_mood mood = a->mood;
  if (mood == API_ABSURD) a->mood = API_EDGE;
  api_box(a, 0.5, lo, hi);
  a->mood = mood;
  if (api_chance(a, 20)) hi[0] = INFINITY;
  if (mood == API_ABSURD && api_chance(a, 20)) lo[0] = NAN, api_wrong(a, "lo");
  int64_t capacity = (int64_t)api_below(a, 65);
  if (mood == API_ABSURD && api_chance(a, 20)) capacity = -1, api_wrong(a, "capacity");
  ids[capacity < 0 ? 0 : capacity] = -7;
  const bool none = capacity > 0 && api_null(a, "ids");
  const mps_status status = mps_particles_select_box(
      set, lo, hi, capacity, api_null(a, "count") ? NULL : &count, none ? NULL : ids);
  if (ids[capacity < 0 ? 0 : capacity] != -7) api_broken(a, "writes behind the capacity");
  a->reads = true;
  (void)api_end(a, status);
}

static void particles_index(api *a) {
  int64_t id[1] = {-1};
  const mps_particles *set = api_any(a, API_SET)->handle;
  if (api_ids(a, (mps_particles *)set, 1, id) == 0) id[0] = 0;
  const int64_t index = mps_particles_index(set, id[0]);
  if (index < -1 || index >= mps_particles_count(set))
    if (set) api_broken(a, "index %d", (int)index);
  api_end_query(a);
}

static void particles_nearest(api *a) {
  double x[3];
  const mps_particles *set = api_any(a, API_SET)->handle;
  api_vector(a, "x", 3, 0.5, 1.0, x);
  const int64_t id = mps_particles_nearest(set, api_null(a, "x") ? NULL : x);
  if (id != -1 && mps_particles_index(set, id) < 0) api_broken(a, "id %d", (int)id);
  api_end_query(a);
}

/* ---- stress ---------------------------------------------------------------------------------- */

static void particles_set_geostatic(api *a) {
  mps_particles *set = api_any(a, API_SET)->handle;
  mps_geostatic_layer layers[3];
  const double line[] = {0.0, 1.0, 0.5, 1.1, 1.0, 1.2};
  mps_geostatic_def def = mps_geostatic_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.layer_count = (int32_t)api_least(a, "layer_count", 1, 3);
  for (int k = 0; k < 3; k++) {
    if (k >= def.layer_count) a->mood = API_VALID;
    layers[k].thickness = api_real(a, "thickness", 1e-9, 1e9, 2.0);
    if (isinf(layers[k].thickness)) a->wrong = 0;
    layers[k].k0 = api_real(a, "k0", 0.0, 1e300, 0.5);
    layers[k].density = api_real(a, "density", 1e-9, 1e9, 1000.0);
    if (isnan(layers[k].density)) a->wrong = 0;
  }
  def.layers = layers;
  def.gravity = api_real(a, "gravity", 5e-324, 1e300, 9.81);
  def.surcharge = api_real(a, "surcharge", 0.0, 1e300, 10.0);
  if (api_chance(a, 30))
    def.surface = api_near(a, "surface", 1.0, 0.5), a->wrong -= isnan(def.surface);
  if (api_chance(a, 20)) def.surface_line = line, def.surface_points = 3, api_say(a, "line, ");
  if (api_chance(a, 30)) def.surface_level = api_flat, def.user = &a->plan, api_say(a, "level, ");
  if (api_chance(a, 20)) def.vertical = (int32_t)api_whole(a, "vertical", -1, 2);
  api_arm(a);
  api_loosen(a);
  (void)api_end(a, mps_particles_set_geostatic(set, &def));
}

static void particles_set_consolidation(api *a) {
  mps_particles *set = api_any(a, API_SET)->handle;
  const mps_material *material = api_any(a, API_MATERIAL)->handle;
  mps_consolidation_def def = mps_consolidation_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.ocr = api_real(a, "ocr", 1.0, 1000.0, 2.0);
  def.pop = api_real(a, "pop", 0.0, 1e18, 0.0);
  api_loosen(a);
  (void)api_end(a, mps_particles_set_consolidation(set, material, &def));
}

static void particles_set_profile(api *a) {
  mps_particles *set = api_any(a, API_SET)->handle;
  double depth[2] = {api_near(a, "depth", 0.5, 0.5), 2.0}, value[2] = {0.5, 1.5};
  value[0] = api_near(a, "value", 0.5, 0.4);
  api_loosen(a);
  (void)api_end(a, mps_particles_set_profile(set, "strength_factor", 2, depth, value, NULL));
}

static void particles_set_stress(api *a) {
  mps_particles *set = api_any(a, API_SET)->handle;
  api_arm(a);
  api_loosen(a);
  (void)api_end(
      a, mps_particles_set_stress(set, api_null(a, "stress") ? NULL : api_some_stress, &a->plan));
}

static void particles_set_table(api *a) {
  mps_particles *set = api_any(a, API_SET)->handle;
  double positions[12], values[4];
  for (int k = 0; k < 12; k++) positions[k] = 0.4 * (k % 3) + 0.3 * (k % 2) + 0.01 * k;
  for (int k = 0; k < 4; k++) values[k] = 100.0 * k;
  positions[3] = api_near(a, "positions", 0.5, 0.5);
  values[2] = api_near(a, "values", 100.0, 50.0);
  mps_table_def def = mps_table_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.interpolation = (int32_t)api_whole(a, "interpolation", 0, 1);
  if (api_chance(a, 30)) def.reach = 1e6;
  int64_t outside = 0;
  const double *places = api_null(a, "positions") ? NULL : positions;
  api_loosen(a);
  (void)api_end(a, mps_particles_set_table(set, "pore_pressure", 4, places, 1, values, &def,
                                           api_chance(a, 20) ? NULL : &outside));
}

static void particles_set_material(api *a) {
  int64_t ids[8] = {0};
  mps_particles *set = api_any(a, API_SET)->handle;
  const mps_material *material = api_any(a, API_MATERIAL)->handle;
  const double density = api_real(a, "density", 1e-9, 1e9, 1000.0);
  const int64_t count = !a->latest && api_chance(a, 40) ? api_ids(a, set, 8, ids) : 0;
  (void)api_end(a, mps_particles_set_material(set, material, density, count ? ids : NULL, count));
}

static const api_call calls[] = {
    {"mps_particles_create", 3, API_CONTEXT, particles_create},
    {"mps_particles_destroy", 1, API_SET, destroy_particles_destroy},
    {"mps_particles_count", 1, API_SET, query_particles_count},
    {"mps_particles_dim", 1, API_SET, query_particles_dim},
    {"mps_particles_spacing", 1, API_SET, query_particles_spacing},
    {"mps_particles_epoch", 1, API_SET, query_particles_epoch},
    {"mps_particles_append", 5, API_SET, particles_append},
    {"mps_particles_fill_box", 5, API_SET, particles_fill_box},
    {"mps_particles_fill_polygon", 3, API_SET, particles_fill_polygon},
    {"mps_particles_fill_ball", 3, API_SET, particles_fill_ball},
    {"mps_particles_fill_where", 3, API_SET, particles_fill_where},
    {"mps_particles_remove", 5, API_SET, particles_remove},
    {"mps_particles_add_field", 4, API_SET, particles_add_field},
    {"mps_particles_has_field", 1, API_SET, particles_has_field},
    {"mps_particles_remove_field", 2, API_SET, particles_remove_field},
    {"mps_particles_view", 3, API_SET, particles_view},
    {"mps_particles_edit", 6, API_SET, particles_edit},
    {"mps_particles_commit", 10, API_SET, particles_commit},
    {"mps_particles_abandon", 4, API_SET, particles_abandon},
    {"mps_particles_set", 8, API_SET, particles_set},
    {"mps_particles_set_array", 4, API_SET, particles_set_array},
    {"mps_particles_copy", 1, API_SET, particles_copy},
    {"mps_particles_field_count", 1, API_SET, query_particles_field_count},
    {"mps_particles_get_field_info_sized", 2, API_SET, particles_field_sized},
    {"mps_particles_select_box", 3, API_SET, particles_select_box},
    {"mps_particles_index", 2, API_SET, particles_index},
    {"mps_particles_nearest", 2, API_SET, particles_nearest},
    {"mps_particles_set_table", 3, API_SET, particles_set_table},
    {"mps_particles_set_profile", 1, API_SET, particles_set_profile},
    {"mps_particles_set_consolidation", 1, API_SET, particles_set_consolidation},
    {"mps_particles_set_geostatic", 4, API_SET, particles_set_geostatic},
    {"mps_particles_set_stress", 4, API_SET, particles_set_stress},
    {"mps_particles_set_material", 4, API_MATERIAL, particles_set_material},
};
const api_table api_particles_calls = API_TABLE(calls);
