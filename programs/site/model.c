/* model.c - ground of mps-site-response: a strip of level layers, four cells wide, between
 * free-field sides on a base, in the frame that moves with the input (motion.c), and its run.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include <mps/soil.h>
#include <mps/experimental/settle.h>
#include <mps/experimental/pore_water.h>

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FOR_EVER 1e6 /* s */

bool site_refuse(mpm_model *m, const char *format, ...) {
  va_list args;
  va_start(args, format);
  (void)vsnprintf(m->why, sizeof m->why, format, args);
  va_end(args);
  return false;
}

/* ---- particles ------------------------------------------------------------------------------- */

/* Values of a field by the layer of each particle; `offset`: of the number in the layer. */
static mps_status set_by_layer(simulation *sim, const char *field, size_t offset) {
  mps_particles *set = sim->m.particles;
  mps_view x;
  mps_edit edit;
  mps_status status = mps_particles_add_field(set, field, 0);
  if (status == MPS_OK) status = mps_particles_view(set, "position", &x);
  if (status == MPS_OK) status = mps_particles_edit(set, field, &edit);
  if (status != MPS_OK) return status;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double depth = sim->height + sim->below - *mps_view_f64(&x, k, 1);
    const site_layer *l = site_layer_at(&sim->ground, depth);
    memcpy(&*mps_edit_f64(&edit, k, 0), (const char *)l + offset, sizeof(double));
  }
  return mps_particles_commit(set, &edit);
}

/* Effective stresses at rest: buoyant layers where there is water. */
static mps_status set_stress(const simulation *sim) {
  static mps_geostatic_layer layer[SITE_LAYERS + 1];
  const site_ground *g = &sim->ground;
  for (int64_t i = 0; i < g->count; i++)
    layer[i] =
        (mps_geostatic_layer){.thickness = i + 1 < g->count ? g->layer[i].thickness : INFINITY,
                              .k0 = g->layer[i].k0,
                              .density = g->layer[i].density - (sim->wet ? SITE_WATER : 0.0)};
  mps_geostatic_def def = mps_geostatic_defaults();
  def.layer_count = (int32_t)g->count, def.layers = layer;
  def.gravity = SITE_GRAVITY;
  def.surface = sim->height + sim->below;
  return mps_particles_set_geostatic(sim->m.particles, &def);
}

static mps_status fill(mps_context *context, simulation *sim) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {sim->width, sim->height + sim->below};
  mps_particles_def def = mps_particles_defaults();
  def.spacing = sim->spacing;
  mps_status status = mpm_model_particles(&sim->m, context, &def);
  if (status == MPS_OK) status = mps_particles_fill_box(sim->m.particles, lo, hi, NULL);
  if (status == MPS_OK) status = set_by_layer(sim, "density", offsetof(site_layer, density));
  if (status == MPS_OK && sim->wet)
    status = set_by_layer(sim, "porosity", offsetof(site_layer, porosity));
  if (status == MPS_OK && sim->flows)
    status = set_by_layer(sim, "permeability", offsetof(site_layer, permeability));
  return status == MPS_OK ? set_stress(sim) : status;
}

/* ---- laws, water, motion --------------------------------------------------------------------- */

/* The laws of the layers, and elastic ones of the same moduli, in which the ground comes to rest.
 */
static mps_status make_laws(mps_context *context, simulation *sim) {
  mps_status status = MPS_OK;
  for (int64_t i = 0; i < sim->ground.count && status == MPS_OK; i++) {
    site_layer elastic = sim->ground.layer[i];
    elastic.law = SITE_ELASTIC;
    status = site_make_law(context, &sim->ground.layer[i], &sim->law[i]);
    if (status == MPS_OK) status = site_make_law(context, &elastic, &sim->elastic[i]);
    if (status != MPS_OK)
      site_refuse(&sim->m, "%.150s:%lld: %.200s", sim->s.layers, (long long)i + 1,
                  mps_context_error(context)->message);
  }
  if (status == MPS_OK) { /* of the model, which destroys it */
    sim->m.material = sim->elastic[0];
    sim->elastic[0] = NULL;
  }
  return status;
}

/* Particles between two depths get the law of their layer; NULL: they keep the one they have. */
static mps_status set_laws(simulation *sim, mps_material *const *law) {
  const int64_t most = mps_particles_count(sim->m.particles);
  const double surface = sim->height + sim->below;
  int64_t *ids = malloc((size_t)most * sizeof *ids), count;
  double top = 0.0;
  mps_status status = ids ? MPS_OK : MPS_ERROR_MEMORY;
  for (int64_t i = 0; i < sim->ground.count && status == MPS_OK; i++) {
    const double bottom =
        i + 1 < sim->ground.count ? top + sim->ground.layer[i].thickness : surface + 1.0;
    const double from[2] = {-1.0, surface - bottom}, to[2] = {sim->width + 1.0, surface - top};
    status = mps_particles_select_box(sim->m.particles, from, to, most, &count, ids);
    if (status == MPS_OK && law[i] && count > 0)
      status = mps_mpm_set_material(sim->m.mpm, law[i], ids, count);
    top = bottom;
  }
  free(ids);
  return status;
}

static mps_status add_water(simulation *sim) {
  const double level[2] = {0.0, sim->height + sim->below};
  mps_pore_water_def water = mps_pore_water_defaults();
  water.density = SITE_WATER;
  water.bulk = sim->s.bulk;
  const mps_status status = mps_mpm_add_pore_water(sim->m.mpm, &water);
  return status == MPS_OK ? mps_mpm_set_pore_level(sim->m.mpm, level) : status;
}

/* The force of the frame on each particle: its mass times the load's signal. */
static mps_status add_load(simulation *sim) {
  mps_view mass, id;
  mps_status status = mps_particles_view(sim->m.particles, "mass", &mass);
  if (status == MPS_OK) status = mps_particles_view(sim->m.particles, "id", &id);
  if (status != MPS_OK) return status;
  const int64_t count = mass.shape[0];
  int64_t *ids = malloc((size_t)count * sizeof *ids);
  double *masses = malloc((size_t)count * sizeof *masses);
  for (int64_t k = 0; ids && masses && k < count; k++)
    ids[k] = *mps_view_i64(&id, k, 0), masses[k] = *mps_view_f64(&mass, k, 0);
  mps_mpm_load_def load = mps_mpm_load_defaults();
  load.ids = ids, load.id_count = count, load.area = masses;
  load.traction[0] = 1.0;
  load.signal[0] = sim->load;
  status = ids && masses ? mps_mpm_add_load(sim->m.mpm, &load, NULL) : MPS_ERROR_MEMORY;
  free(ids);
  free(masses);
  return status;
}

/* The base; an absorbing one is held for `settle` (s), and takes the mean of its forces. */
static mps_status set_base(simulation *sim, double settle) {
  mps_mpm_boundary_def base = mps_mpm_boundary_defaults();
  base.kind = sim->s.base == SITE_COMPLIANT ? MPS_BOUNDARY_ABSORBING : MPS_BOUNDARY_HELD;
  base.settle = sim->s.base == SITE_COMPLIANT ? settle : 0.0;
  return mps_mpm_set_boundary(sim->m.mpm, MPS_SIDE_Y_LOWER, &base);
}

/* Between rollers, in elastic laws, on a base that is held: the stress of geostatics is not quite
 * that of the grid's equilibrium, and under the rest an absorbing base would sink. Ground whose
 * water flows cannot settle so: its base is held for twenty periods of a pressure wave before the
 * motion. */
static mps_status come_to_rest(simulation *sim) {
  mps_mpm_settle_def rest = mps_mpm_settle_defaults();
  rest.tolerance = 1e-6;
  mps_status status = set_base(sim, sim->flows ? sim->start : FOR_EVER);
  if (status != MPS_OK || sim->flows) return status;
  status = mps_mpm_settle(sim->m.mpm, &rest, NULL);
  return status == MPS_OK ? set_base(sim, 0.0) : status;
}

/* Twenty times 4 H/c_p. */
static double rest_time(const simulation *sim) {
  double sum = 0.0;
  for (int64_t i = 0; i < sim->ground.count; i++) {
    const site_layer *l = &sim->ground.layer[i];
    const double shear = l->density * l->vs * l->vs;
    const double wave =
        2.0 * shear * (1.0 - l->poisson) / (1.0 - 2.0 * l->poisson) + sim->s.bulk / l->porosity;
    sum += (i + 1 < sim->ground.count || !sim->ground.has_half_space ? l->thickness : sim->below) /
           sqrt(wave / l->density);
  }
  return 20.0 * 4.0 * sum;
}

/* The sides last: their columns are copies of the ground as it is. */
static mps_status set_sides(simulation *sim) {
  mps_status status = MPS_OK;
  for (int32_t side = MPS_SIDE_X_LOWER; side <= MPS_SIDE_X_UPPER; side++)
    if (status == MPS_OK) status = mps_mpm_set_side(sim->m.mpm, side, MPS_BOUNDARY_FREE_FIELD, 0.0);
  return status;
}

/* ---- building -------------------------------------------------------------------------------- */

/* The cells: whole ones over the layers. Why they do not suit them; NULL: good. */
static bool choose_cells(simulation *sim) {
  const settings *s = &sim->s;
  const site_ground *g = &sim->ground;
  double slowest = INFINITY, h = s->h;
  for (int64_t i = 0; i < g->count; i++) slowest = fmin(slowest, g->layer[i].vs);
  sim->height = site_thickness(g);
  if (isnan(h)) h = slowest / (SITE_PER_WAVE * sim->highest);
  const double cells = fmax(ceil(sim->height / h - 1e-9), 2.0);
  if (cells > SITE_ROWS / 2 - SITE_CELLS)
    return site_refuse(
        &sim->m,
        "%g cells of %g m over the layers, must be at most %d: give --cell or a lower "
        "--max-frequency",
        cells, h, SITE_ROWS / 2 - SITE_CELLS);
  h = sim->height / cells;
  for (int64_t i = 0; i < g->count - g->has_half_space; i++)
    if (g->layer[i].thickness < h * (1.0 - 1e-9))
      return site_refuse(&sim->m,
                         "%s: layer %lld: thickness is %g m, must be at least a cell, %g m: give a "
                         "smaller --cell",
                         s->layers, (long long)i + 1, g->layer[i].thickness, h);
  sim->cell = h;
  sim->spacing = 0.5 * h;
  sim->below = s->base == SITE_COMPLIANT ? SITE_CELLS * h : 0.0;
  sim->width = SITE_CELLS * h;
  return true;
}

static void find_water(simulation *sim) {
  const site_ground *g = &sim->ground;
  for (int64_t i = 0; i < g->count; i++)
    sim->flows = sim->flows || !isnan(g->layer[i].permeability);
  sim->wet = sim->flows || sim->s.undrained;
  for (int64_t i = 0; i < g->count; i++)
    sim->liquefies = sim->liquefies || (sim->wet && g->layer[i].law == SITE_CYCLIC_SAND);
  for (int64_t i = 0; i < g->count; i++)
    sim->opens = sim->opens || g->layer[i].law >= SITE_MOHR_COULOMB;
}

/* The default of --max-frequency. Layers that yield stick and slip, and their accelerations have
 * more of high frequencies; liquefied sand carries none. */
static void choose_frequency(simulation *sim) {
  const site_ground *g = &sim->ground;
  const settings *s = &sim->s;
  bool yields = false;
  for (int64_t i = 0; i < g->count; i++) yields = yields || g->layer[i].law != SITE_ELASTIC;
  sim->highest = yields && !sim->liquefies ? SITE_FREQUENCY_YIELDING : SITE_FREQUENCY;
  if (site_is_pulse(s)) sim->highest = fmax(sim->highest, s->frequency);
  if (!isnan(s->highest)) sim->highest = s->highest;
}

/* Everything from files. */
static mps_status read_input(mps_context *context, simulation *sim) {
  if (sim->m.a->domain) {
    site_refuse(&sim->m, "the columns of free-field sides are for one process");
    return MPS_ERROR_ARGUMENT;
  }
  if (!site_read_ground(&sim->m, &sim->s, &sim->ground)) return MPS_ERROR_ARGUMENT;
  find_water(sim);
  choose_frequency(sim);
  if (!choose_cells(sim)) return MPS_ERROR_ARGUMENT;
  return site_make_motion(context, sim);
}

/* What follows from ground and motion. */
static bool complete(simulation *sim) {
  const settings *s = &sim->s;
  sim->flip_time = !isnan(s->flip_time) ? s->flip_time : sim->liquefies ? 0.0 : 1.0 / sim->highest;
  sim->volumetric = s->volumetric == MPS_MPM_VOLUMETRIC_BY_LAW && sim->wet ? MPS_MPM_VOLUMETRIC_CELL
                                                                           : s->volumetric;
  sim->start = sim->flows ? rest_time(sim) : 0.0;
  sim->duration =
      isnan(s->duration) ? sim->record_end + 20.0 * site_travel_time(&sim->ground) : s->duration;
  if (sim->duration < sim->record_end * (1.0 - 1e-9))
    app_warn(sim->m.a, "--duration is %g s, the record lasts %g s: the spectra are of a part of it",
             sim->duration, sim->record_end);
  sim->samples = (int64_t)ceil(sim->duration / s->sample - 1e-9);
  if (sim->samples > SITE_SAMPLES)
    return site_refuse(&sim->m, "%lld samples, must be at most %d: give a larger --sample",
                       (long long)sim->samples, SITE_SAMPLES);
  if (!isnan(s->loop) && !(s->loop < sim->height))
    return site_refuse(&sim->m, "--loop is %g m deep, must be within the layers, %g m", s->loop,
                       sim->height);
  return true;
}

mps_status site_build(mps_context *context, void *user) {
  simulation *sim = user;
  sim->course =
      mpm_course_of(&sim->s.course, &sim->m, sim->s.out, "mps-site-response 1", site_pass, sim);
  sim->course.what = "ground";
  mps_status status = mpm_course_peek(&sim->course, context);
  if (status != MPS_OK) return status;
  status = read_input(context, sim);
  if (status == MPS_OK && !complete(sim)) status = MPS_ERROR_ARGUMENT;
  if (status != MPS_OK) return status;
  sim->course.duration = sim->start + sim->duration;
  status = fill(context, sim);
  if (status == MPS_OK) status = make_laws(context, sim);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = sim->cell;
  def.courant = sim->s.courant;
  def.gravity[1] = -SITE_GRAVITY;
  def.lower[0] = def.lower[1] = 0.0, def.upper[0] = sim->width;
  def.flip_time = sim->flip_time;
  def.viscous_damping = sim->s.damping;
  def.volumetric = sim->volumetric;
  def.spline = sim->s.spline + 2;
  status = mpm_model_create(&sim->m, context, status, &def);
  if (status == MPS_OK) status = set_laws(sim, sim->elastic);
  if (status == MPS_OK && sim->wet) status = add_water(sim);
  if (status == MPS_OK) status = come_to_rest(sim);
  if (status == MPS_OK) status = set_laws(sim, sim->law);
  if (status == MPS_OK) status = add_load(sim);
  if (status == MPS_OK) status = set_sides(sim);
  if (status == MPS_OK) status = site_begin_record(sim);
  if (status == MPS_OK) status = mpm_course_begin(&sim->course, context, true);
  sim->m.samples = sim->count;
  return status;
}

void site_free(simulation *sim) {
  for (int i = 0; i <= SITE_LAYERS; i++)
    mps_material_destroy(&sim->law[i]), mps_material_destroy(&sim->elastic[i]);
  mps_signal_destroy(&sim->load);
  mps_signal_destroy(&sim->motion);
  free(sim->row);
  free(sim->sample);
}

/* ---- running --------------------------------------------------------------------------------- */

mps_status site_march(void *user) {
  simulation *sim = user;
  progress_part(&sim->m.a->bar, 0.0, 1.0, 0.0, sim->start + sim->duration);
  mps_status status = MPS_OK;
  while (sim->count <= sim->samples && status == MPS_OK) {
    const int64_t k = sim->count;
    const double t = sim->start + sim->s.sample * (double)k;
    if (t > 0.0) status = mpm_model_advance(&sim->m, t, INT64_MAX, NULL, NULL);
    if (status == MPS_OK) status = site_take_sample(sim);
    if (status == MPS_OK) status = mpm_course_sample(&sim->course, k, sim->samples);
  }
  return mpm_course_end(&sim->course, status);
}
