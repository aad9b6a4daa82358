/* water.c - the other side of a coupling with mps-precice by preCICE: a tank of water (mps/fluid.h)
 * whose right wall is the left side of the flap, and bends with it (wall.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/options.h"
#include "common/output.h"
#include "precice/wall.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { BED, FAR, FLAP }; /* numbers of the walls */

typedef struct settings {
  wall_def coupling;
  double length, depth, spacing; /* m */
  double x;                      /* m: of the flap's side */
  int64_t threads;
  const char *out;
} settings;

typedef struct tank {
  app *a;
  mps_particles *water;
  mps_fluid *fluid;
  double *nodes; /* 3 a node: the middle of each spacing of the depth */
  output table;
  double force; /* N: of the last window */
} tank;

static const char purpose[] =
    "A tank of water as a participant of a preCICE coupling (version 3): its right wall bends as "
    "another code says,\n"
    "and that receives the forces of the water. The defaults are those of "
    "programs/precice/water-config.xml.";

static int parse(settings *s, int argc, char **argv) {
  *s = (settings){.coupling = {.config = "water-config.xml",
                               .name = "Fluid",
                               .mesh = "Fluid-Mesh",
                               .displacement = "Displacement",
                               .velocity = "Velocity",
                               .force = "Force",
                               .number = FLAP,
                               .bends = 1,
                               .normal = {-1.0, 0.0, 0.0},
                               .dt = 0.002},
                  .length = 1.5,
                  .depth = 0.9,
                  .spacing = 0.05,
                  .x = -0.05};
  option table[] = {
      OPTION_HEADING("Water"),
      OPTION_NUMBER("length", &s->length, "rounded to whole spacings"),
      OPTION_NUMBER("depth", &s->depth, "rounded to whole spacings"),
      OPTION_NUMBER("x", &s->x, "the right wall"),
      OPTION_NUMBER("spacing", &s->spacing, NULL),
      OPTION_HEADING("Coupling"),
      LOOP_OPTIONS(s->coupling),
      OPTION_TEXT("displacement", &s->coupling.displacement, "that are read"),
      OPTION_TEXT("velocity", &s->coupling.velocity, "that are read"),
      OPTION_TEXT("force", &s->coupling.force, "that are written"),
      OPTION_NUMBER("dt", &s->coupling.dt, "at most; preCICE may ask for shorter ones"),
      OPTION_HEADING("Running"),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {"precice-water", purpose, table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  options_whole("length", &s->length, "--spacing", s->spacing);
  options_whole("depth", &s->depth, "--spacing", s->spacing);
  const double columns = nearbyint(s->length / s->spacing), rows = nearbyint(s->depth / s->spacing);
  if (!(columns * rows <= 1e6))
    return options_refuse(&program,
                          "--length and --depth hold more than a million particles of --spacing");
  s->coupling.count = (int64_t)rows;
  s->coupling.area = s->spacing;
  return -1;
}

static mps_status fill(mps_context *context, const settings *s, mps_particles **out) {
  const double lo[2] = {s->x - s->length, 0.0}, hi[2] = {s->x, s->depth};
  mps_particles_def def = mps_particles_defaults();
  def.spacing = s->spacing;
  def.origin[0] = lo[0], def.origin[1] = lo[1];
  mps_status status = mps_particles_create(context, &def, out);
  return status == MPS_OK ? mps_particles_fill_box(*out, lo, hi, NULL) : status;
}

static mps_status add_wall(tank *t, double x, double y, double nx, double ny, int64_t nodes) {
  mps_fluid_boundary_def wall = mps_fluid_boundary_defaults();
  wall.kind = MPS_BOUNDARY_ROLLER;
  wall.point[0] = x, wall.point[1] = y, wall.normal[0] = nx, wall.normal[1] = ny;
  if (nodes > 0) wall.nodes = t->nodes, wall.node_count = nodes;
  return mps_fluid_add_boundary(t->fluid, &wall, NULL);
}

/* Water at rest, up to `depth`. */
static bool make(app *a, const settings *s, tank *t) {
  mps_fluid_def def = mps_fluid_defaults();
  const int64_t n = s->coupling.count;
  def.level = s->depth;
  if (!(t->nodes = calloc(3 * (size_t)n, sizeof *t->nodes))) return app_no_memory(a);
  for (int64_t k = 0; k < n; k++)
    t->nodes[3 * k] = s->x, t->nodes[3 * k + 1] = ((double)k + 0.5) * s->spacing;
  mps_status status = fill(a->context, s, &t->water);
  if (status == MPS_OK) status = mps_fluid_create(a->context, t->water, &def, &t->fluid);
  if (status == MPS_OK) status = add_wall(t, s->x, 0.0, 0.0, 1.0, 0);
  if (status == MPS_OK) status = add_wall(t, s->x - s->length, 0.0, 1.0, 0.0, 0);
  if (status == MPS_OK) status = add_wall(t, s->x, 0.0, -1.0, 0.0, n);
  return app_check(a, status);
}

/* A time window is complete. */
static bool each(void *user, mps_fluid *fluid) {
  tank *t = user;
  mps_reaction r;
  if (!app_check(t->a, mps_fluid_get_reaction(fluid, FLAP, &r))) return false;
  t->force = -r.force[0];
  const double row[2] = {mps_fluid_time(fluid), t->force};
  csv_row(&t->table, 2, row);
  return true;
}

static bool run(app *a, settings *s) {
  tank t = {.a = a};
  participant_result result = {0};
  bool good = output_directory(a, s->out) && make(a, s, &t) &&
              output_open(&t.table, a, s->out, "force.csv");
  if (good) {
    csv_header(&t.table, "t_s,force_N");
    s->coupling.x = t.nodes;
    s->coupling.each = each, s->coupling.user = &t;
    good = wall_run(a, t.fluid, &s->coupling, &result);
    good = output_close(&t.table) && good;
  }
  if (good) {
    app_tell_results(a, s->out);
    printf("%lld particles, %lld time windows, %lld steps, %lld of them repeated; force on the "
           "wall %.5g N at the end, %.5g N of still water\n",
           (long long)mps_particles_count(t.water), (long long)result.windows,
           (long long)result.steps, (long long)result.repeats, t.force,
           0.5 * 1000.0 * 9.81 * s->depth * s->depth);
  }
  mps_fluid_destroy(&t.fluid);
  mps_particles_destroy(&t.water);
  free(t.nodes);
  return good;
}

int main(int argc, char **argv) {
  settings s;
  app a;
  const int code = parse(&s, argc, argv);
  if (code >= 0) return code;
  if (!app_start(&a, "precice-water", s.threads)) return app_finish(&a, APP_FAILED);
  return app_finish(&a, run(&a, &s) ? APP_OK : APP_FAILED);
}
