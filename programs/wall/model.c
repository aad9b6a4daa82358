/* model.c - ground, wall and the run of mps-wall. The wall is x <= 0, the ground behind it x > 0;
 * it moves away from the ground (active) or into it (passive), as a whole or about its toe or top.
 * With a base ground lies below the toe and in front of the wall; without one the wall
 * stands on a smooth bed. Ground beside a toe shares its nodes with the ground below, which stays:
 * so a wall with a base goes down some cells further (`sheet`), and pressures count from the ground
 * in front upwards. SPDX-License-Identifier: BSD-3-Clause */
#include "wall.h"

#include <mps/soil.h>
#include <mps/mpm.h>

#include <math.h>
#include <stdlib.h>

#define RAMP 0.05  /* of the path: up to the full speed */
#define THICK 0.25 /* of the height */
#define ABOVE 0.5  /* of the height: the wall reaches above the ground, which rises */

/* Whole cells, which the particles in front of the wall leave free. */
double wall_thickness(const settings *s) { return s->h * ceil(THICK * s->height / s->h - 1e-9); }

/* ---- ground ---------------------------------------------------------------------------------- */

/* The ground in front of the wall does not bear the surcharge. */
static mps_status unload_front(const settings *s, mps_particles *set) {
  mps_view x;
  mps_edit stress;
  mps_status status = mps_particles_view(set, "position", &x);
  if (status == MPS_OK) status = mps_particles_edit(set, "stress", &stress);
  if (status != MPS_OK) return status;
  for (int64_t k = 0; k < x.shape[0]; k++)
    for (int c = 0; c < 3 && *mps_view_f64(&x, k, 0) < 0.0; c++)
      *mps_edit_f64(&stress, k, c) += s->surcharge * (c == 1 ? 1.0 : s->k0);
  return mps_particles_commit(set, &stress);
}

static mps_status set_stress(const settings *s, mps_particles *set) {
  const mps_geostatic_layer layer = {.thickness = INFINITY, .k0 = s->k0, .density = NAN};
  const double step = 1e-6 * s->height;
  const double line[] = {-step, s->base, step, s->base + s->height};
  mps_geostatic_def def = mps_geostatic_defaults();
  def.layers = &layer, def.layer_count = 1;
  def.gravity = s->gravity;
  def.surcharge = s->surcharge;
  if (s->base > 0.0)
    def.surface_line = line, def.surface_points = 2;
  else
    def.surface = s->height;
  const mps_status status = mps_particles_set_geostatic(set, &def);
  return status == MPS_OK && s->surcharge > 0.0 && s->base > 0.0 ? unload_front(s, set) : status;
}

static mps_status make_ground(mps_context *context, settings *s, mpm_model *m) {
  const double thick = wall_thickness(s);
  const double lo[] = {0.0, 0.0}, hi[] = {s->length, s->base + s->height};
  const double before_lo[] = {-s->front, 0.0};
  const double before_hi[] = {s->sheet > 0.0 ? -thick : 0.0, s->base};
  const double below_lo[] = {-thick, 0.0}, below_hi[] = {0.0, s->base - s->sheet};
  mps_particles_def set = mps_particles_defaults();
  set.spacing = s->h / sqrt((double)s->ppc);
  mps_status status = mpm_model_particles(m, context, &set);
  if (status == MPS_OK) status = mps_particles_fill_box(m->particles, lo, hi, NULL);
  if (status == MPS_OK && s->base > 0.0)
    status = mps_particles_fill_box(m->particles, before_lo, before_hi, NULL);
  if (status == MPS_OK && s->sheet > 0.0)
    status = mps_particles_fill_box(m->particles, below_lo, below_hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(m->particles, "density", 0, s->density);
  if (status != MPS_OK) return status;
  return wall_is_plain(s) ? set_stress(s, m->particles) : wall_set_ground(s, m->particles);
}

static bool is_above(const void *level, const double *x) { return x[1] > *(const double *)level; }

/* The surcharge is a load on the uppermost particles, which it follows. */
static mps_status press(const settings *s, mpm_model *m) {
  const double top = s->base + s->height - mps_particles_spacing(m->particles);
  mps_mpm_load_def load = mps_mpm_load_defaults();
  int64_t *ids;
  mps_status status = mpm_model_list(m, is_above, &top, &load.id_count, &ids);
  load.ids = ids;
  load.traction[1] = -s->surcharge;
  if (status == MPS_OK) status = mps_mpm_add_load(m->mpm, &load, NULL);
  free(ids);
  return status;
}

/* ---- wall ------------------------------------------------------------------------------------ */

/* The path, a length at the end that moves most, over time. */
static mps_status make_path(mps_context *context, simulation *sim, mps_signal **out) {
  const settings *s = &sim->s;
  sim->ramp = 2.0 * RAMP * s->path / s->rate;
  sim->t_end = s->path / s->rate + 0.5 * sim->ramp;
  const double t[] = {0.0, sim->ramp, sim->t_end + 1.0}, v[] = {0.0, s->rate, s->rate};
  return mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, t, v, out);
}

/* Its reference point is its toe or, where it turns about that, the ground's level behind it. */
static mps_status make_wall(mps_context *context, simulation *sim) {
  const settings *s = &sim->s;
  const bool top = s->motion == TURNS_ABOUT_TOP;
  const double foot = top ? -s->height : s->base > 0.0 ? 0.0 : -ABOVE * s->height;
  const double low = top && s->base == 0.0 ? foot - ABOVE * s->height : foot;
  const double head = (top ? 0.0 : s->height) + ABOVE * s->height, thick = wall_thickness(s);
  const double corners[] = {0.0, low, 0.0, head, -thick, head, -thick, low};
  const double deep = foot - s->sheet;
  const double sheet[] = {0.0, deep, 0.0, foot, 0.0, head, -thick, head, -thick, deep};
  mps_signal *path = NULL;
  mps_body_def def = mps_body_defaults();
  def.position[1] = s->base + (top ? s->height : 0.0);
  mps_status status = make_path(context, sim, &path);
  if (status == MPS_OK)
    status = s->sheet > 0.0 ? mps_body_create_polygon(context, &def, 5, sheet, &sim->m.body[0])
                            : mps_body_create_polygon(context, &def, 4, corners, &sim->m.body[0]);
  if (status == MPS_OK)
    status = mps_body_name_part(sim->m.body[0], "face", s->sheet > 0.0 ? 1 : 0, 1, &sim->face);
  const double away = s->pressure == ACTIVE ? 1.0 : -1.0;
  if (status == MPS_OK && s->motion == TRANSLATES)
    status = mps_body_drive(sim->m.body[0], 0, path, -away);
  if (status == MPS_OK && s->motion != TRANSLATES)
    status = mps_body_drive(sim->m.body[0], 5, path, (top ? -away : away) / s->height);
  mps_signal_destroy(&path);
  return status;
}

/* ---- the model ------------------------------------------------------------------------------- */

/* The layers stand in a file, and must be those of the start. */
static void pass(void *user, resume_bytes *b) {
  simulation *sim = user;
  const settings *s = &sim->s;
  if (!s->layers_file) return;
  const bool same = resume_same(b, &s->layers, sizeof s->layers) &&
                    resume_same(b, s->layer, (size_t)s->layers * sizeof *s->layer);
  mpm_course_same(&sim->course, b, same, "the layers have");
}

mps_status wall_build(mps_context *context, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  static const rows_column columns[] = {{"path", "m", 0},      {"across", "N/m", 0},
                                        {"along", "N/m", 0},   {"moment", "N", 0},
                                        {"impulse", "N s", 3}, {0}};
  sim->course = mpm_course_of(&s->course, &sim->m, s->out, "mps-wall 2", pass, sim);
  sim->course.what = "ground";
  sim->course.duration = s->path / s->rate;
  sim->course.columns = columns;
  mps_status status = mpm_course_peek(&sim->course, context);
  if (status == MPS_OK) status = make_ground(context, &sim->s, &sim->m);
  if (status == MPS_OK) status = wall_make_law(context, s, 0, &sim->m.material);
  if (status == MPS_OK) status = make_wall(context, sim);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = s->h;
  def.courant = s->courant;
  def.spline = s->spline + 2;
  def.flip_time = s->flip_time;
  def.gravity[1] = -s->gravity;
  def.lower[0] = -s->front, def.lower[1] = 0.0;
  def.upper[0] = s->length;
  status = mpm_model_create(&sim->m, context, status, &def);
  if (status == MPS_OK && s->layers > 1) status = wall_set_laws(context, s, &sim->m);
  if (status == MPS_OK && s->base > 0.0)
    status = mps_mpm_set_side(sim->m.mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  if (status == MPS_OK && s->surcharge > 0.0) status = press(s, &sim->m);
  mps_contact_def contact = mps_contact_defaults();
  contact.friction = s->friction;
  contact.corner = s->corner * s->h;
  contact.inset = s->inset * s->h;
  if (status == MPS_OK) status = mps_mpm_add_contact(sim->m.mpm, sim->m.body[0], &contact, NULL);
  return status == MPS_OK ? mpm_course_begin(&sim->course, context, true) : status;
}

/* ---- running --------------------------------------------------------------------------------- */

static double moved(const simulation *sim, const mps_body_state *now) {
  const settings *s = &sim->s;
  return s->motion == TRANSLATES ? fabs(now->position[0]) : fabs(now->rotation[2]) * s->height;
}

/* The mean force since the last sample. */
static mps_status take_sample(simulation *sim) {
  mps_reaction r;
  mps_body_state now;
  mps_status status = mps_body_get_reaction(sim->m.body[0], sim->face, &r);
  if (status == MPS_OK) status = mps_body_get_state(sim->m.body[0], &now);
  if (status != MPS_OK) return status;
  const int rows = wall_rows(sim);
  const wall_row last = rows > 0 ? *wall_row_of(sim, rows - 1) : (wall_row){0};
  wall_row row = {.t = mps_mpm_time(sim->m.mpm),
                  .path = moved(sim, &now),
                  .sums = {r.impulse[0], r.impulse[1], r.moment_impulse[2]}};
  const double span = row.t - last.t;
  row.across = -(row.sums[0] - last.sums[0]) / span;
  row.along = (row.sums[1] - last.sums[1]) / span;
  row.moment = (row.sums[2] - last.sums[2]) / span;
  return mpm_course_add(&sim->course, &row);
}

mps_status wall_march(void *user) {
  simulation *sim = user;
  mps_status status = MPS_OK;
  progress_part(&sim->m.a->bar, 0.0, 1.0, 0.0, sim->t_end);
  if (wall_rows(sim) == 0) status = mpm_course_sample(&sim->course, 0, WALL_SAMPLES);
  while (wall_rows(sim) < WALL_SAMPLES && status == MPS_OK) {
    const double t = sim->t_end * (wall_rows(sim) + 1) / WALL_SAMPLES;
    status = mpm_model_advance(&sim->m, t, INT64_MAX, NULL, NULL);
    if (status == MPS_OK) status = take_sample(sim);
    if (status == MPS_OK) status = mpm_course_sample(&sim->course, wall_rows(sim), WALL_SAMPLES);
  }
  const mps_status taken = wall_rows(sim) > 0 ? mpm_snapshot_take(&sim->m, mps_mpm_time(sim->m.mpm),
                                                                  "plastic_strain", &sim->shot)
                                              : MPS_OK;
  return mpm_course_end(&sim->course, status == MPS_OK ? taken : status);
}
