/* calls_body.c - rigid bodies of all shapes, also from damaged files: motion, distance, reactions.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls.h"

#include "body/body_internal.h"

#include <float.h>

#include <mps/body.h>

#include <stdio.h>
#include <stdlib.h>

/* A body below, above or within the particles' box. */
static void draw_def(api *a, mps_body_def *def, int dim) {
  *def = mps_body_defaults();
  def->struct_size = api_struct_size(a, sizeof *def);
  def->motion = !a->latest && api_chance(a, 40) ? api_choice(a, "motion", 2) : 0;
  const double height = api_chance(a, 50) ? -0.3 : 0.9;
  const bool free_body = def->motion == MPS_BODY_MOTION_FREE;
  api_vector(a, "position", dim, 0.3, 0.2, def->position);
  if (a->mood != API_ABSURD) def->position[dim - 1] = height;
  if (dim == 2) def->rotation[2] = api_chance(a, 70) ? 0.0 : api_near(a, "rotation", 0.0, 1.0);
  if (dim == 3 && api_chance(a, 30)) api_vector(a, "rotation", 3, 0.0, 1.0, def->rotation);
  if (!free_body) return;
  api_vector(a, "velocity", dim, 0.0, 0.5, def->velocity);
  def->spin[2] = api_near(a, "spin", 0.0, 1.0);
  def->mass = api_real(a, "mass", 1e-30, 1e30, 20.0);
  for (int c = dim == 2 ? 2 : 0; c < 3; c++)
    def->inertia[c] = api_real(a, "inertia", 1e-30, 1e30, 1.0);
  def->gravity[dim - 1] = api_near(a, "gravity", -9.81, 0.1);
  for (int c = 0; c < 2; c++) def->damping[c] = api_real(a, "damping", 0.0, 1e300, 0.0);
}

static double size_of(api *a, const char *name) { return api_real(a, name, 1e-9, 1e9, 0.3); }

static bool made_body(api *a, mps_status status, mps_body **made) {
  return api_end_made(a, status, API_BODY, *made, NULL);
}

/* Shapes of one or two lengths. */
#define SIMPLE(name, dim, lengths, call)                                                           \
  static void body_create_##name(api *a) {                                                         \
    mps_body *made = NULL;                                                                         \
    mps_body_def def;                                                                              \
    mps_context *context = api_context(a);                                                         \
    draw_def(a, &def, dim);                                                                        \
    double x[2] = {0};                                                                             \
    for (int k = 0; k < (lengths); k++) x[k] = size_of(a, "length");                               \
    const mps_body_def *given = &def;                                                              \
    mps_body **out = api_null(a, "out") ? NULL : &made;                                            \
    (void)x;                                                                                       \
    (void)made_body(a, call, &made);                                                               \
  }
SIMPLE(box, 2, 2, mps_body_create_box(context, given, x[0], x[1], out))
SIMPLE(disc, 2, 1, mps_body_create_disc(context, given, x[0], out))
SIMPLE(sphere, 3, 1, mps_body_create_sphere(context, given, x[0], out))
SIMPLE(cylinder, 3, 2, mps_body_create_cylinder(context, given, x[0], x[1], out))

static void half(api *a, int dim) {
  mps_body *made = NULL;
  mps_body_def def;
  double normal[3];
  mps_context *context = api_context(a);
  draw_def(a, &def, dim);
  api_vector(a, "normal", dim, 0.0, 0.3, normal);
  if (a->mood != API_ABSURD) normal[dim - 1] = def.position[dim - 1] > 0.5 ? -1.0 : 1.0;
  const double *given = api_null(a, "normal") ? NULL : normal;
  mps_body **out = api_null(a, "out") ? NULL : &made;
  const mps_status status = dim == 2 ? mps_body_create_half_plane(context, &def, given, out)
                                     : mps_body_create_half_space(context, &def, given, out);
  (void)made_body(a, status, &made);
}

static void body_create_half_plane(api *a) { half(a, 2); }
static void body_create_half_space(api *a) { half(a, 3); }

static void ring(api *a, int dim) {
  mps_body *made = NULL;
  mps_body_def def;
  double x[8];
  mps_context *context = api_context(a);
  draw_def(a, &def, dim);
  const double corners[] = {0.0, -0.15, 0.3, -0.15, 0.3, 0.15, 0.0, 0.15};
  const int64_t vertices = api_least(a, "vertices", 3, 4);
  for (int k = 0; k < 8; k++) {
    if (k >= 2 * vertices) a->mood = API_VALID;
    x[k] = dim == 3 && corners[k] == 0.0 ? 0.0 : api_near(a, "", corners[k], 0.05);
  }
  const double *given = api_null(a, "xy") ? NULL : x;
  const mps_status status = dim == 2
                                ? mps_body_create_polygon(context, &def, vertices, given, &made)
                                : mps_body_create_revolution(context, &def, vertices, given, &made);
  (void)made_body(a, status, &made);
}

static void body_create_polygon(api *a) { ring(a, 2); }
static void body_create_revolution(api *a) { ring(a, 3); }

/* ---- meshes ---------------------------------------------------------------------------------- */

static const double tetrahedron[] = {-0.2, -0.2, -0.2, 0.3,  -0.2, -0.2,
                                     -0.2, 0.3,  -0.2, -0.2, -0.2, 0.3};
static const int32_t faces[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};

static void body_create_mesh(api *a) {
  mps_body *made = NULL;
  mps_body_def def;
  double xyz[12];
  int32_t corner[12];
  mps_context *context = api_context(a);
  draw_def(a, &def, 3);
  memcpy(corner, faces, sizeof corner);
  for (int k = 0; k < 12; k++) xyz[k] = api_near(a, "", tetrahedron[k], 0.05);
  if (a->mood == API_ABSURD && api_chance(a, 40)) {
    const int32_t values[] = {-1, 4, INT32_MAX, 0};
    corner[api_below(a, 12)] = values[api_below(a, 4)];
    api_say(a, "another corner, ");
  }
  const mps_status status = mps_body_create_mesh(context, &def, 4, api_null(a, "xyz") ? NULL : xyz,
                                                 4, api_null(a, "corner") ? NULL : corner, &made);
  (void)made_body(a, status, &made);
}

static size_t write_text(char *text, size_t room) {
  size_t length = (size_t)snprintf(text, room, "solid t\n");
  for (int t = 0; t < 4; t++) {
    length += (size_t)snprintf(text + length, room - length, "facet normal 0 0 0\nouter loop\n");
    for (int k = 0; k < 3; k++) {
      const double *x = tetrahedron + 3 * faces[3 * t + k];
      length +=
          (size_t)snprintf(text + length, room - length, "vertex %g %g %g\n", x[0], x[1], x[2]);
    }
    length += (size_t)snprintf(text + length, room - length, "endloop\nendfacet\n");
  }
  return length + (size_t)snprintf(text + length, room - length, "endsolid t\n");
}

static void body_create_stl(api *a) {
  char text[1200], path[300];
  mps_body *made = NULL;
  mps_body_def def;
  mps_context *context = api_context(a);
  draw_def(a, &def, 3);
  size_t length = write_text(text, sizeof text);
  if (a->mood == API_ABSURD) {
    for (uint32_t n = api_below(a, 3); n > 0; n--)
      text[api_below(a, (uint32_t)length)] = (char)api_below(a, 256);
    if (api_chance(a, 40)) length = api_below(a, (uint32_t)length);
  }
  snprintf(path, sizeof path, "%s/body.stl", a->folder);
  FILE *file = fopen(path, "wb");
  if (file) {
    (void)!fwrite(text, 1, length, file);
    (void)fclose(file);
    api_record_file(path, text, length);
  }
  const double scale = api_real(a, "scale", 5e-324, 1e300, 1.0);
  const mps_status status =
      mps_body_create_stl(context, &def, api_null(a, "path") ? NULL : path, scale, &made);
  (void)made_body(a, status, &made);
}

/* ---- motion ---------------------------------------------------------------------------------- */

API_DESTROY(body_destroy, API_BODY)
API_QUERY(body_dim, API_BODY)

static void body_drive(api *a) {
  mps_body *body = api_any(a, API_BODY)->handle;
  const int32_t component = api_choice(a, "component", 6);
  mps_signal *signal = api_signal(a, false);
  const double factor = api_near(a, "factor", 1.0, 0.5);
  api_arm(a);
  (void)api_end(a, mps_body_drive(body, component, signal, factor));
}

static void body_set_motion(api *a) {
  mps_body *body = api_any(a, API_BODY)->handle;
  const int dim = mps_body_dim(body) == 3 ? 3 : 2;
  mps_body_motion motion = mps_body_motion_defaults();
  motion.struct_size = api_struct_size(a, sizeof motion);
  if (api_chance(a, 50)) {
    mps_body_state state;
    memset(&state, 0, sizeof state);
    (void)!mps_body_get_state(body, &state);
    for (int c = 0; c < dim; c++) {
      const int before = a->wrong;
      motion.position[c] = api_near(a, "position", state.position[c], 0.02);
      if (isnan(motion.position[c])) a->wrong = before; /* stays where it is */
    }
  }
  api_vector(a, "velocity", dim, 0.0, 0.2, motion.velocity);
  motion.spin[2] = api_near(a, "spin", 0.0, 0.5);
  (void)api_end(a, mps_body_set_motion(body, a->wrong == 0 && api_chance(a, 10) ? NULL : &motion));
}

static void body_load(api *a) {
  double force[3] = {0}, moment[3] = {0};
  mps_body *body = api_any(a, API_BODY)->handle;
  const int dim = mps_body_dim(body) == 3 ? 3 : 2;
  api_vector(a, "force", dim, 0.0, 50.0, force);
  const int before = a->wrong;
  moment[2] = api_near(a, "moment", 0.0, 5.0);
  const bool given = api_chance(a, 80);
  if (!given) a->wrong = before;
  (void)api_end(a, mps_body_set_load(body, force, given ? moment : NULL));
}

static void body_advance(api *a) {
  mps_body *body = api_any(a, API_BODY)->handle;
  const double dt = api_real(a, "dt", 5e-324, DBL_MAX, 1e-3);
  api_arm(a);
  (void)api_end(a, mps_body_advance(body, dt));
}

/* ---- questions ------------------------------------------------------------------------------- */

#define GETTER(name, type)                                                                         \
  static void body_##name##_sized(api *a) {                                                        \
    mps_body *body = api_any(a, API_BODY)->handle;                                                 \
    API_SIZED(a, type, size, out);                                                                 \
    const mps_status status =                                                                      \
        mps_body_##name##_sized(body, api_null(a, "out") ? NULL : out, size);                      \
    API_SIZED_END(a, status, size, out, true);                                                     \
  }
GETTER(get_state, mps_body_state)
GETTER(get_totals, mps_body_totals)
GETTER(get_def, mps_body_def)

static void body_get_reaction_sized(api *a) {
  mps_body *body = api_any(a, API_BODY)->handle;
  const int32_t parts = body ? body->parts : 0;
  const int32_t part = (int32_t)api_whole(a, "part", -1, parts > 0 ? parts - 1 : -1);
  API_SIZED(a, mps_reaction, size, out);
  const mps_status status = mps_body_get_reaction_sized(body, part, out, size);
  API_SIZED_END(a, status, size, out, true);
}

static void body_distance(api *a) {
  double x[6], distance[2] = {NAN, NAN}, normal[6], foot[6];
  int64_t face[2];
  mps_body *body = api_any(a, API_BODY)->handle;
  const int64_t count = api_least(a, "count", 0, 2);
  const api_mood mood = a->mood;
  if (count <= 0) a->mood = API_VALID;
  api_vector(a, "x", 2, 0.3, 1.0, x);
  a->mood = API_VALID;
  api_vector(a, "x", 4, 0.3, 1.0, x + 2);
  a->mood = mood;
  const mps_status status = mps_body_distance(
      body, count, x, api_chance(a, 80) ? distance : NULL, api_chance(a, 80) ? normal : NULL,
      api_chance(a, 80) ? foot : NULL, api_chance(a, 80) ? face : NULL);
  a->reads = true;
  (void)api_end(a, status);
}

static void body_name_part(api *a) {
  static const char *const good[] = {"tip", "side", "rest_2"};
  mps_body *body = api_any(a, API_BODY)->handle;
  const char *name = good[api_below(a, 3)];
  if (a->mood == API_ABSURD && api_chance(a, 20)) name = "not good", api_wrong(a, "name");
  const int64_t first = api_whole(a, "first", 0, 3);
  const int before = a->wrong;
  const int64_t count = api_whole(a, "count", 1, 3);
  if (count == 4) a->wrong = before; /* of the four edges of a box */
  int32_t part = -1;
  (void)api_end(a, mps_body_name_part(body, name, first, count, api_chance(a, 80) ? &part : NULL));
}

static void body_part(api *a) {
  const mps_body *body = api_any(a, API_BODY)->handle;
  const int32_t part = mps_body_find_part(body, api_null(a, "name") ? NULL : "tip");
  if (part < -1 || part >= 16) api_broken(a, "part %d", part);
  api_end_query(a);
}

static const api_call calls[] = {
    {"mps_body_create_polygon", 2, API_CONTEXT, body_create_polygon},
    {"mps_body_create_box", 4, API_CONTEXT, body_create_box},
    {"mps_body_create_disc", 2, API_CONTEXT, body_create_disc},
    {"mps_body_create_half_plane", 3, API_CONTEXT, body_create_half_plane},
    {"mps_body_create_sphere", 2, API_CONTEXT, body_create_sphere},
    {"mps_body_create_half_space", 3, API_CONTEXT, body_create_half_space},
    {"mps_body_create_cylinder", 1, API_CONTEXT, body_create_cylinder},
    {"mps_body_create_revolution", 1, API_CONTEXT, body_create_revolution},
    {"mps_body_create_mesh", 1, API_CONTEXT, body_create_mesh},
    {"mps_body_create_stl", 1, API_CONTEXT, body_create_stl},
    {"mps_body_destroy", 1, API_BODY, destroy_body_destroy},
    {"mps_body_dim", 1, API_BODY, query_body_dim},
    {"mps_body_drive", 3, API_BODY, body_drive},
    {"mps_body_set_motion", 3, API_BODY, body_set_motion},
    {"mps_body_set_load", 3, API_BODY, body_load},
    {"mps_body_advance", 4, API_BODY, body_advance},
    {"mps_body_get_state_sized", 1, API_BODY, body_get_state_sized},
    {"mps_body_get_totals_sized", 1, API_BODY, body_get_totals_sized},
    {"mps_body_get_def_sized", 1, API_BODY, body_get_def_sized},
    {"mps_body_get_reaction_sized", 2, API_BODY, body_get_reaction_sized},
    {"mps_body_distance", 4, API_BODY, body_distance},
    {"mps_body_name_part", 2, API_BODY, body_name_part},
    {"mps_body_find_part", 1, API_BODY, body_part},
};
const api_table api_body_calls = API_TABLE(calls);
