/* model.c - ground and water of mps-consolidation, and the run.
 *
 * A load q on a drained surface is given by its difference: all pressures, and so the total
 * stresses, are less q. The surface is then free, its water has the pressure -q, and the ground
 * begins without stress; effective stresses and u = p + q are those under the load. Cam-Clay begins
 * with an effective stress s0, and all pressures are less q + s0. The plates of
 * Mandel and Barron move as the exact solutions, and begin with the stresses of the undrained load.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "consolidation.h"

#include "common/ranks.h"

#include <mps/experimental/settle.h>
#include <mps/soil.h>
#include <mps/experimental/pore_water.h>
#include <mps/experimental/soil.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define DENSITY 2000.0 /* kg/m3, of grains and water */
#define WATER 1000.0
#define STRIP_WIDTHS 10 /* half widths B of the ground, each way */
#define FASTEST 0.99e-3 /* m/s: the inertia of the water, which is left out, counts above */

enum { PLATE_POINTS = 2000 };

/* ---- settings -------------------------------------------------------------------------------- */

static const char *read_times(simulation *sim, const option *table) {
  const char *text = sim->s.times;
  char number[64];
  if (sim->s.kase == STRIP) {
    if (options_given(table, "times") || options_given(table, "time-unit"))
      return "--times and --time-unit are not for --case strip, which is undrained";
    sim->time[0] = 0.0;
    sim->times = 1;
    return NULL;
  }
  if (!text) text = sim->s.kase == CRYER ? "0.01,0.05,0.1,0.2" : "0.05,0.1,0.2,0.5,1";
  for (sim->times = 0; *text || sim->times == 0; sim->times++) {
    const size_t length = strcspn(text, ",");
    if (sim->times == MOST_TIMES) return "--times must be at most 64 numbers";
    if (length >= sizeof number) return "--times must be numbers with commas between them";
    memcpy(number, text, length);
    number[length] = '\0';
    double *T = &sim->time[sim->times];
    if (!options_number(number, T) || !(*T >= 1e-4 && *T <= 10.0))
      return "--times must be numbers from 1e-4 to 10 with commas between them";
    if (sim->times > 0 && !(*T > T[-1])) return "--times must ascend";
    text += length + (text[length] == ',');
    if (text[-1] == ',' && !*text) return "--times must not end with a comma";
  }
  return NULL;
}

/* Has a rigid plate that moves as the exact solution. */
static bool has_plate(const settings *s) { return s->kase == MANDEL || s->kase == BARRON; }

/* Options of one kind of ground alone. */
static const char *check_clay(const settings *s, const option *table) {
  static const char *const clay[] = {"M", "lambda", "kappa", "e0", "initial"};
  for (size_t k = 0; k < sizeof clay / sizeof *clay && s->kase != MCC; k++)
    if (options_given(table, clay[k]))
      return "--M, --lambda, --kappa, --e0 and --initial are for --case mcc alone";
  if (s->kase == MCC && options_given(table, "young"))
    return "--young is not for --case mcc, whose stiffness follows --kappa and the pressure";
  if (s->kase == MCC && !(s->kappa < s->lambda)) return "--kappa must be below --lambda";
  return NULL;
}

static double softest(const simulation *sim) {
  double least = INFINITY;
  for (int i = 0; i < sim->ground.count; i++) least = fmin(least, sim->ground.layer[i].modulus);
  return least * sim->modulus;
}

static double stiffest(const simulation *sim) {
  double most = 0.0;
  for (int i = 0; i < sim->ground.count; i++) most = fmax(most, sim->ground.layer[i].modulus);
  return most * sim->modulus;
}

/* Of the fastest layer over the mean, and of Cam-Clay before the load over that of the end. */
static double fastest(const simulation *sim) {
  const settings *s = &sim->s;
  double most = 0.0;
  for (int i = 0; i < sim->ground.count; i++) most = fmax(most, sim->ground.layer[i].k);
  return s->kase == MCC ? sim->modulus * s->lambda / ((1.0 + s->e0) * s->initial) : most;
}

/* Large strains make the ground swing as its surface passes from cell to cell, which counts most
 * beside a load that is still small. */
double consolidation_duration(const simulation *sim) {
  const settings *s = &sim->s;
  const double waves = has_plate(s) ? 1000.0 : s->kase == LARGE && s->ramp > 0.0 ? 2000.0 : 300.0;
  const double slow = WATER * MPS_PORE_GRAVITY * fastest(sim) / (sim->modulus * FASTEST);
  return fmax(waves / sqrt(sim->modulus / DENSITY), slow);
}

const char *consolidation_settle(simulation *sim, const option *table) {
  settings *s = &sim->s;
  const char *unused = check_clay(s, table);
  if (unused) return unused;
  sim->modulus = s->young * (1.0 - s->nu) / ((1.0 + s->nu) * (1.0 - 2.0 * s->nu));
  unused = column_settle(sim, table);
  if (unused) return unused;
  if (s->kase != BARRON && options_given(table, "drain-ratio"))
    return "--drain-ratio is for --case barron alone";
  unused = column_choose_cells(sim);
  if (unused) return unused;
  if (s->solver != 0 && s->scheme != IMPLICIT)
    return "--solver multigrid and direct are for --scheme implicit, whose pressures are solved "
           "for";
  if (s->kase == MCC) {
    if (isnan(s->load)) s->load = s->initial;
    if (!(s->e0 - s->lambda * log(1.0 + s->load / s->initial) > 0.05))
      return "--load must leave pores: e0 - lambda ln(1 + load/initial) above 0.05";
    sim->modulus = (1.0 + s->e0) * (s->initial + s->load) / s->lambda; /* along K0, at the end */
  }
  if (isnan(s->load)) s->load = sim->modulus * (s->kase == LARGE ? 0.5 : 1e-3);
  if (s->kase == LARGE && !(exp(-s->load / sim->modulus) > 0.41))
    return "--load must leave pores: at most 0.89 of the modulus M' = E (1 - nu)/((1 + nu)(1 - 2 "
           "nu))";
  if (s->kase != LARGE && s->kase != MCC && !(s->load <= 0.02 * softest(sim)))
    return s->layers
               ? "--load must be small, at most 0.02 of the modulus of the softest layer: the "
                 "exact solution is of small strains"
               : "--load must be small, at most 0.02 of the modulus M' = E (1 - nu)/((1 + "
                 "nu)(1 - 2 nu)): the exact solution is of small strains";
  if (isnan(s->damping)) s->damping = 0.5 * sqrt(sim->modulus / DENSITY);
  if (isnan(s->duration)) s->duration = consolidation_duration(sim);
  unused = read_times(sim, table);
  return unused ? unused : column_finish_settings(sim);
}

/* ---- ground ---------------------------------------------------------------------------------- */

static double porosity_of(const settings *s) {
  return s->kase == MCC ? s->e0 / (1.0 + s->e0) : s->kase == LARGE ? 0.6 : 0.4;
}
static double cell_of(const settings *s) { return 1.0 / s->cells; }
static double drain_radius(const settings *s) { return s->kase == BARRON ? 1.0 / s->ratio : 0.0; }

/* The vertical effective stress before the load, Pa. */
static double start_of(const settings *s) { return s->kase == MCC ? s->initial : 0.0; }

static mps_status make_ground(mps_context *context, const settings *s, mpm_model *m) {
  const double h = cell_of(s), size = s->kase == STRIP ? STRIP_WIDTHS : 1.0;
  const double lo[2] = {drain_radius(s), 0.0};
  const double hi[2] = {is_column(s) ? h : size, s->kase == BARRON ? h : size};
  mps_particles_def def = mps_particles_defaults();
  def.spacing = 0.5 * h;
  mps_status status = mpm_model_particles(m, context, &def);
  if (status == MPS_OK)
    status = s->kase == CRYER ? mps_particles_fill_ball(m->particles, lo, 1.0, NULL)
                              : mps_particles_fill_box(m->particles, lo, hi, NULL);
  return status == MPS_OK ? mps_particles_set(m->particles, "density", 0, DENSITY) : status;
}

/* The fill makes the whole section of the ball: three of its four quarters are removed. */
static mps_status cut_ball(mps_particles *set) {
  mps_view x, id;
  mps_status status = mps_particles_view(set, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(set, "id", &id);
  if (status != MPS_OK) return status;
  int64_t count = 0, *gone = malloc((size_t)(x.shape[0] + 1) * sizeof *gone);
  if (!gone) return MPS_ERROR_MEMORY;
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (*mps_view_f64(&x, k, 0) < 0.0 || *mps_view_f64(&x, k, 1) < 0.0)
      gone[count++] = *mps_view_i64(&id, k, 0);
  if (count > 0) status = mps_particles_remove(set, gone, count);
  free(gone);
  return status;
}

/* Particles of the profile: the lowest row of the ground or its first column. */
static mps_status list_profile(simulation *sim, mps_particles *whole) {
  const settings *s = &sim->s;
  mps_view x, id;
  mps_status status = mps_particles_view(whole, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(whole, "id", &id);
  const int along = has_plate(s) || s->kase == CRYER ? 0 : 1;
  const double size = s->kase == STRIP ? STRIP_WIDTHS : 1.0;
  for (int64_t k = 0; status == MPS_OK && k < x.shape[0]; k++) {
    const double place = *mps_view_f64(&x, k, along), across = *mps_view_f64(&x, k, 1 - along);
    const double depth = size - place;
    if (across > 0.5 * cell_of(s) || (s->kase == STRIP && depth > 4.0)) continue;
    int i = sim->points++; /* by depth */
    for (; i > 0 && sim->at[i - 1] > depth; i--)
      sim->at[i] = sim->at[i - 1], sim->id[i] = sim->id[i - 1];
    sim->at[i] = depth;
    sim->id[i] = *mps_view_i64(&id, k, 0);
  }
  return status;
}

/* On several ranks rank 0 lists them, and all know their number and depths. */
static mps_status find_profile(simulation *sim) {
  mps_particles *whole;
  mps_status status = mpm_model_whole(&sim->m, &whole);
  if (status == MPS_OK && whole) status = list_profile(sim, whole);
  double points = sim->points;
  status = mpm_model_tell(&sim->m, status, 1, &points);
  sim->points = (int)points;
  return status == MPS_OK ? mpm_model_tell(&sim->m, status, sim->points, sim->at) : status;
}

/* u/u0 of the profile, on all ranks. */
static mps_status read_profile(simulation *sim, instant *now) {
  const settings *s = &sim->s;
  const double unit = reference_load(sim, now->step);
  const double load = is_column(s) ? column_load(sim, now->step, now->T) : s->load;
  const double shift = is_column(s) || s->kase == CRYER ? load + start_of(s) : 0.0;
  mps_particles *whole;
  mps_view u;
  mps_status status = mpm_model_whole(&sim->m, &whole);
  if (status == MPS_OK && whole) status = mps_particles_view(whole, "pore_pressure", &u);
  for (int k = 0; status == MPS_OK && whole && k < sim->points; k++)
    now->u[k] = (*mps_view_f64(&u, mps_particles_index(whole, sim->id[k]), 0) + shift) / unit;
  return mpm_model_tell(&sim->m, status, sim->points, now->u);
}

/* ---- water and loads ------------------------------------------------------------------------- */

/* By layers; the mean is that of c_v = 1 m2 over the duration. */
static mps_status set_permeability(simulation *sim, double mean) {
  mps_particles *set = sim->m.particles;
  mps_view x;
  mps_edit k;
  mps_status status = mps_particles_add_field(set, "permeability", 0);
  if (status == MPS_OK) status = mps_particles_view(set, "position", &x);
  if (status == MPS_OK) status = mps_particles_edit(set, "permeability", &k);
  if (status != MPS_OK) return status;
  for (int64_t i = 0; i < x.shape[0]; i++)
    *mps_edit_f64(&k, i, 0) = mean * column_layer(sim, 1.0 - *mps_view_f64(&x, i, 1))->k;
  return mps_particles_commit(set, &k);
}

static mps_status add_water(simulation *sim) {
  const settings *s = &sim->s;
  mps_pore_water_def water = mps_pore_water_defaults();
  water.density = WATER;
  if (s->scheme == IMPLICIT) water.scheme = MPS_PORE_SCHEME_IMPLICIT;
  water.porosity = porosity_of(s);
  water.bulk = s->stiffness * stiffest(sim) * water.porosity;
  if (s->kase != STRIP) /* c_v = 1 m2 over the duration */
    water.permeability = WATER * MPS_PORE_GRAVITY / (sim->modulus * s->duration);
  if (s->kase == LARGE) water.exponent = 2.0;
  if (s->kase == MCC) { /* k0 of the initial stress; see exact.c */
    water.permeability *= fastest(sim);
    water.exponent = 1.0;
    water.ratio_slope = s->lambda;
  }
  mps_status status = MPS_OK;
  if (s->layers) {
    status = set_permeability(sim, water.permeability);
    water.permeability = NAN;
  }
  return status == MPS_OK ? mps_mpm_add_pore_water(sim->m.mpm, &water) : status;
}

/* Choices of --solver after the first are those of mps_petsc_method. */
static mps_status choose_solver(simulation *sim) {
  mpm_model *m = &sim->m;
  if (sim->s.solver == 0 || ranks_solve(mps_mpm_solver(m->mpm), MPS_LINEAR_EQUATION_PORE_PRESSURE,
                                        sim->s.solver - 1, &m->a->equations, m->why, sizeof m->why))
    return MPS_OK;
  return MPS_ERROR_UNSUPPORTED;
}

static mps_pore_face_def drains_of(const simulation *sim, double load) {
  const settings *s = &sim->s;
  mps_pore_face_def face = mps_pore_face_defaults();
  face.kind = MPS_PORE_FACE_DRAINED;
  face.pressure = -load - start_of(s);
  if (s->drained != DRAINED_BOTTOM) face.sides |= 1u << MPS_SIDE_Y_UPPER;
  if (s->drained != DRAINED_TOP) face.sides |= 1u << MPS_SIDE_Y_LOWER;
  if (s->kase == CRYER) face.sides |= 1u << MPS_SIDE_X_UPPER;
  return face;
}

static mps_status add_drains(simulation *sim) {
  const settings *s = &sim->s;
  const mps_pore_face_def face = drains_of(sim, is_column(s) ? column_load(sim, 0, 0.0) : s->load);
  mps_pore_face_def sealed = mps_pore_face_defaults(); /* the free surface else drains */
  sealed.sides = 1u << MPS_SIDE_Y_UPPER;
  mps_status status = MPS_OK;
  if (s->drained == DRAINED_BOTTOM) status = mps_mpm_add_pore_face(sim->m.mpm, &sealed, NULL);
  return status == MPS_OK ? mps_mpm_add_pore_face(sim->m.mpm, &face, &sim->drain) : status;
}

/* Undrained between the plates: u0 = F/(2 a), vertical effective stress -u0, horizontal u0. */
static mps_status begin_mandel(simulation *sim) {
  mps_particles *set = sim->m.particles;
  mps_status status = mps_particles_set(set, "pore_pressure", 0, sim->s.load);
  if (status == MPS_OK) status = mps_particles_set(set, "stress", 0, sim->s.load);
  return status == MPS_OK ? mps_particles_set(set, "stress", 1, -sim->s.load) : status;
}

/* Undrained under the plate: u0, without strain. The drain is the inner side of the domain. */
static mps_status begin_barron(simulation *sim) {
  mps_pore_face_def drain = mps_pore_face_defaults();
  drain.kind = MPS_PORE_FACE_DRAINED;
  drain.sides = 1u << MPS_SIDE_X_LOWER;
  const mps_status status = mps_particles_set(sim->m.particles, "pore_pressure", 0, sim->s.load);
  return status == MPS_OK ? mps_mpm_add_pore_face(sim->m.mpm, &drain, NULL) : status;
}

/* m at T since the load was applied. */
static double plate_at(const simulation *sim, double T) {
  const settings *s = &sim->s;
  const double way =
      s->kase == MANDEL ? exact_plate(s->nu, T) : exact_drain(s->ratio, T) * cell_of(s);
  return way * s->load / sim->modulus;
}

/* The plate is the upper side of the domain with the velocity of the exact solution; the side stays
 * in place, as its displacement is small beside a cell. */
static mps_status drive_plate(mps_context *context, simulation *sim) {
  const settings *s = &sim->s;
  static double t[PLATE_POINTS], w[PLATE_POINTS];
  const double end = 1.01 * s->duration * sim->time[sim->times - 1];
  for (int k = 0; k < PLATE_POINTS; k++) {
    const double part = (double)k / (PLATE_POINTS - 1);
    t[k] = end * part * part; /* it begins as the root of time */
    w[k] = plate_at(sim, t[k] / s->duration);
  }
  mps_signal *down = NULL;
  mps_mpm_boundary_def plate = mps_mpm_boundary_defaults();
  mps_status status =
      mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, PLATE_POINTS, t, w, &down);
  plate.kind = MPS_BOUNDARY_ROLLER;
  plate.signal[1] = down;
  plate.factor[1] = -1.0;
  if (status == MPS_OK) status = mps_mpm_set_boundary(sim->m.mpm, MPS_SIDE_Y_UPPER, &plate);
  mps_signal_destroy(&down);
  return status;
}

/* Particles under the strip x < B in the highest row, or those below it: their ids. */
static mps_status list_row(const simulation *sim, mps_particles *whole, int layer, double *ids,
                           double *count) {
  const double spacing = 0.5 * cell_of(&sim->s);
  mps_view x, id;
  mps_status status = mps_particles_view(whole, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(whole, "id", &id);
  for (int64_t k = 0; status == MPS_OK && k < x.shape[0]; k++) {
    const double depth = STRIP_WIDTHS - *mps_view_f64(&x, k, 1);
    if (*mps_view_f64(&x, k, 0) < 1.0 && (int)floor(depth / spacing) == layer)
      ids[(int)(*count)++] = (double)*mps_view_i64(&id, k, 0);
  }
  return status;
}

/* Pressure q on the strip x < B: 3/2 of it on the highest row of particles less 1/2 on the next,
 * whose resultant acts at the surface. All ranks give the whole rows. */
static mps_status load_strip(simulation *sim) {
  mps_particles *whole;
  mps_status status = mpm_model_whole(&sim->m, &whole);
  for (int layer = 0; layer < 2 && status == MPS_OK; layer++) {
    double listed[2 * MOST_CELLS], count = 0.0;
    int64_t ids[2 * MOST_CELLS];
    mps_mpm_load_def load = mps_mpm_load_defaults();
    if (whole) status = list_row(sim, whole, layer, listed, &count);
    status = mpm_model_tell(&sim->m, status, 1, &count);
    if (status == MPS_OK) status = mpm_model_tell(&sim->m, status, (int)count, listed);
    if (status != MPS_OK) return status;
    for (int k = 0; k < (int)count; k++) ids[k] = (int64_t)listed[k];
    load.ids = ids, load.id_count = (int64_t)count;
    load.traction[1] = sim->s.load * (layer == 0 ? -1.5 : 0.5);
    status = mps_mpm_add_load(sim->m.mpm, &load, NULL);
  }
  return status;
}

static mps_status add_case(mps_context *context, simulation *sim) {
  mps_status status = add_water(sim);
  if (status == MPS_OK) status = choose_solver(sim);
  if (status != MPS_OK) return status;
  if (sim->s.kase == STRIP) return load_strip(sim);
  if (sim->s.kase == MCC)
    status = mps_particles_set(sim->m.particles, "pore_pressure", 0, -sim->s.initial);
  if (status != MPS_OK) return status;
  if (!has_plate(&sim->s)) return add_drains(sim);
  status = sim->s.kase == MANDEL ? begin_mandel(sim) : begin_barron(sim);
  return status == MPS_OK ? drive_plate(context, sim) : status;
}

/* ---- building -------------------------------------------------------------------------------- */

static mps_mpm_def solver_of(const settings *s) {
  mps_mpm_def def = mps_mpm_defaults();
  def.geometry = s->kase == CRYER || s->kase == BARRON ? MPS_MPM_GEOMETRY_AXISYMMETRIC
                                                       : MPS_MPM_GEOMETRY_PLANE_STRAIN;
  def.cell = cell_of(s);
  def.courant = !isnan(s->courant) ? s->courant : s->scheme == IMPLICIT ? 0.5 : 0.7;
  def.lower[0] = def.lower[1] = 0.0;
  if (is_column(s)) def.upper[0] = def.cell;
  if (s->kase == BARRON) {
    def.lower[0] = drain_radius(s), def.upper[0] = 1.0;
    def.upper[1] = def.cell;
  }
  if (s->kase == MANDEL) def.upper[1] = 1.0;
  if (s->kase == STRIP) def.upper[0] = STRIP_WIDTHS;
  if (s->kase != STRIP) def.viscous_damping = s->damping; /* which settles by itself */
  return def;
}

/* Of a layer, by its modulus of compression. */
static double young_of(const simulation *sim, const stratum *layer) {
  const double nu = sim->s.nu;
  if (!sim->s.layers) return sim->s.young;
  return layer->modulus * sim->modulus * (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu);
}

/* The law of a layer below the first. */
static mps_status set_layer(mps_context *context, simulation *sim, const stratum *layer) {
  mps_particles *set = sim->m.particles;
  mps_material *law = NULL;
  mps_view x, id;
  int64_t count = 0, *ids = malloc((size_t)(mps_particles_count(set) + 1) * sizeof *ids);
  mps_status status = ids ? mps_particles_view(set, "position", &x) : MPS_ERROR_MEMORY;
  if (status == MPS_OK) status = mps_particles_view(set, "id", &id);
  for (int64_t k = 0; status == MPS_OK && k < x.shape[0]; k++)
    if (column_layer(sim, 1.0 - *mps_view_f64(&x, k, 1)) == layer)
      ids[count++] = *mps_view_i64(&id, k, 0);
  if (status == MPS_OK)
    status = mps_material_create_linear_elastic(context, young_of(sim, layer), sim->s.nu, &law);
  int64_t all = count;
  if (status == MPS_OK) status = mpm_model_sum(&sim->m, &all);
  if (status == MPS_OK && all > 0) status = mps_mpm_set_material(sim->m.mpm, law, ids, count);
  mps_material_destroy(&law);
  free(ids);
  return status;
}

/* Cam-Clay that has been loaded to the initial stress without moving sideways; else elastic. */
static mps_status make_law(mps_context *context, simulation *sim) {
  const settings *s = &sim->s;
  if (s->kase != MCC)
    return mps_material_create_linear_elastic(context, young_of(sim, &sim->ground.layer[0]), s->nu,
                                              &sim->m.material);
  mps_particles *set = sim->m.particles;
  mps_material_cam_clay_def clay = mps_material_cam_clay_defaults();
  mps_consolidation_def state = mps_consolidation_defaults();
  clay.critical_slope = s->M;
  clay.compression = s->lambda;
  clay.swelling = s->kappa;
  clay.poisson = s->nu;
  clay.void_ratio = s->e0;
  clay.preconsolidation = s->initial; /* that of the particles follows */
  mps_status status = mps_material_create_cam_clay(context, &clay, &sim->m.material);
  if (status == MPS_OK) status = mps_particles_add_field(set, "stress", 0);
  if (status == MPS_OK) status = mps_particles_set(set, "stress", 1, -s->initial);
  return status == MPS_OK ? mps_particles_set_consolidation(set, sim->m.material, &state) : status;
}

mps_status consolidation_build(mps_context *context, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  sim->course =
      mpm_course_of(&s->course, &sim->m, s->out, "mps-consolidation 1", consolidation_pass, sim);
  sim->course.what = "ground";
  sim->course.duration = s->duration * sim->time[sim->times - 1] * sim->steps;
  mps_mpm_def def = solver_of(s);
  mps_totals totals;
  mps_status status = mpm_course_peek(&sim->course, context);
  if (status == MPS_OK) status = make_ground(context, s, &sim->m);
  if (status == MPS_OK && s->kase == CRYER) status = cut_ball(sim->m.particles);
  if (status == MPS_OK) status = find_profile(sim);
  if (status == MPS_OK) status = make_law(context, sim);
  status = mpm_model_create(&sim->m, context, status, &def);
  if (status == MPS_OK && s->kase == STRIP)
    status = mps_mpm_set_side(sim->m.mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  for (int i = 1; i < sim->ground.count && status == MPS_OK; i++)
    status = set_layer(context, sim, &sim->ground.layer[i]);
  if (status == MPS_OK) status = add_case(context, sim);
  if (status == MPS_OK) status = mps_mpm_get_totals(sim->m.mpm, &totals);
  if (status == MPS_OK) sim->volume = totals.volume;
  if (status == MPS_OK) status = mpm_course_begin(&sim->course, context, true);
  sim->m.samples = sim->rows;
  return status;
}

/* ---- running --------------------------------------------------------------------------------- */

/* Force of the plate over the exact one: the load on its area, of Mandel's block twice that. */
static double force_over_exact(const settings *s, const mps_reaction *plate) {
  const double b = drain_radius(s);
  const double surface = s->kase == MANDEL ? 2.0 : PI * (1.0 - b * b);
  return fabs(plate->force[1]) / (surface * s->load);
}

/* Mean of 1 - u/u0 over the cylinder, from its profile. */
static double degree_of(const simulation *sim, const instant *now) {
  double sum = 0.0, all = 0.0;
  for (int k = 0; k < sim->points; k++) {
    const double r = 1.0 - sim->at[k];
    sum += r * (1.0 - now->u[k]);
    all += r;
  }
  return sum / all;
}

static mps_status measure(simulation *sim) {
  const settings *s = &sim->s;
  instant *now = &sim->row[sim->rows];
  mps_totals totals;
  mps_pore_budget water;
  mps_reaction plate = {0};
  *now = (instant){.step = sim->rows / sim->times, .T = sim->time[sim->rows % sim->times]};
  mps_status status = read_profile(sim, now);
  if (status == MPS_OK) status = mps_mpm_get_totals(sim->m.mpm, &totals);
  if (status == MPS_OK) status = mps_mpm_get_pore_budget(sim->m.mpm, &water);
  if (status == MPS_OK && has_plate(s))
    status = mps_mpm_get_reaction(sim->m.mpm, MPS_SIDE_Y_UPPER, &plate);
  if (status != MPS_OK) return status;
  const double lost = 1.0 - totals.volume / sim->volume;
  now->settlement = is_column(s) ? lost : s->kase == CRYER ? lost / 3.0 : NAN;
  now->settlement_exact = is_column(s)       ? column_settlement(sim, now->step, now->T)
                          : s->kase == CRYER ? exact_sphere(s->nu, s->load / sim->modulus, now->T)
                                             : NAN;
  now->U = is_column(s) ? column_degree(sim, now->step, now->settlement) : NAN;
  now->U_exact = is_column(s) ? column_degree(sim, now->step, now->settlement_exact) : NAN;
  now->force = has_plate(s) ? force_over_exact(s, &plate) : NAN;
  now->degree = s->kase == BARRON ? degree_of(sim, now) : NAN;
  now->degree_equal = s->kase == BARRON ? exact_drain_equal(s->ratio, now->T) : NAN;
  now->water = water;
  sim->m.samples = ++sim->rows;
  return MPS_OK;
}

/* To the time of the next row. The load on a column is that of the middle of each interval in which
 * it is constant. */
static mps_status advance(simulation *sim) {
  const settings *s = &sim->s;
  const int step = sim->rows / sim->times, last = sim->rows % sim->times;
  const double before = step * sim->time[sim->times - 1], end = sim->time[last];
  mps_status status = MPS_OK;
  double T = last > 0 ? sim->time[last - 1] : 0.0;
  while (T < end && status == MPS_OK) {
    const double next = is_column(s) ? fmin(end, column_next(sim, T)) : end;
    if (s->duration * (before + next) <= mps_mpm_time(sim->m.mpm)) { /* passed before a restart */
      T = next;
      continue;
    }
    if (is_column(s)) {
      const mps_pore_face_def face = drains_of(sim, column_load(sim, step, 0.5 * (T + next)));
      status = mps_mpm_set_pore_face(sim->m.mpm, sim->drain, &face);
    }
    if (status == MPS_OK)
      status = mpm_model_advance(&sim->m, s->duration * (before + next), INT64_MAX, NULL, NULL);
    T = next;
  }
  return status;
}

mps_status consolidation_march(void *user) {
  simulation *sim = user;
  mps_particles *whole;
  const int rows = sim->times * sim->steps;
  mps_status status = MPS_OK;
  if (sim->s.kase != STRIP) progress_part(&sim->m.a->bar, 0.0, 1.0, 0.0, sim->course.duration);
  if (sim->rows == 0) status = mpm_course_sample(&sim->course, 0, rows);
  while (sim->rows < rows && status == MPS_OK) {
    mps_mpm_settle_def rest = mps_mpm_settle_defaults();
    rest.max_steps = 200000;
    status = sim->s.kase == STRIP ? mps_mpm_settle(sim->m.mpm, &rest, NULL) : advance(sim);
    if (status == MPS_OK) status = measure(sim);
    if (status == MPS_OK) status = mpm_course_sample(&sim->course, sim->rows, rows);
  }
  status = mpm_course_end(&sim->course, status);
  const mps_status brought = mpm_model_whole(&sim->m, &whole);
  return status == MPS_OK ? brought : status;
}
