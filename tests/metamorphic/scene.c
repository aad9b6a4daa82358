/* scene.c - the scene of a plan under a change, its steps, and its result in the plan's units and
 * axes. SPDX-License-Identifier: BSD-3-Clause */
#include "metamorphic.h"

#include <mps/experimental/pore_water.h>
#include <mps/experimental/settle.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define TRY(call)                                                                                  \
  do {                                                                                             \
    if (status == MPS_OK) status = (call);                                                         \
  } while (0)

const change no_change = {
    .axis = {0, 1, 2}, .sign = {1.0, 1.0, 1.0}, .length = 1.0, .mass = 1.0, .time = 1.0};

typedef struct scene {
  const plan *p;
  const change *by;
  mps_context *context;
  mps_particles *set;
  mps_material *material[2];
  mps_mpm *mpm;
  mps_body *body;
  mps_contact *contact;
  double angle; /* rad, of the body at first */
  double left;  /* most that the sweeps of a step have left; of the last step where several are
                   made at once */
} scene;

/* ---- values under a change ------------------------------------------------------------------- */

static void turn(const change *by, const double *vector, double scale, double *out) {
  for (int c = 0; c < 3; c++) out[by->axis[c]] = by->sign[c] * vector[c] * scale;
}

static void turn_back(const change *by, const double *vector, double scale, double *out) {
  for (int c = 0; c < 3; c++) out[c] = by->sign[c] * vector[by->axis[c]] / scale;
}

static void place(const change *by, const double *x, double *out) {
  turn(by, x, by->length, out);
  for (int c = 0; c < 3; c++) out[c] += by->shift[c] * (CELL * by->length);
}

static void place_back(const change *by, const double *x, double *out) {
  double at[3];
  for (int c = 0; c < 3; c++) at[c] = x[c] - by->shift[c] * (CELL * by->length);
  turn_back(by, at, by->length, out);
}

static double stress_scale(const change *by) {
  return by->mass / (by->length * by->time * by->time);
}

static double density_scale(const change *by) {
  return by->mass / (by->length * by->length * by->length);
}

static int32_t side_number(const change *by, int k) {
  return 2 * by->axis[k / 2] + ((k % 2 == 1) != (by->sign[k / 2] < 0.0));
}

/* ---- materials ------------------------------------------------------------------------------- */

static mps_status make_material(mps_context *context, law kind, double pa, double s,
                                mps_material **out) {
  mps_material_von_mises_def mises = mps_material_von_mises_defaults();
  mps_material_drucker_prager_def cone = mps_material_drucker_prager_defaults();
  mps_material_mohr_coulomb_def mohr = mps_material_mohr_coulomb_defaults();
  mps_material_newtonian_def fluid = mps_material_newtonian_defaults();
  mises.young = cone.young = mohr.young = 1e6 * pa;
  mises.poisson = cone.poisson = mohr.poisson = 0.3;
  mises.yield_stress = 5e3 * pa, mises.hardening = 1e4 * pa;
  cone.friction = 0.5, cone.dilation = 0.1, cone.cohesion = 1e3 * pa;
  mohr.friction = 0.6, mohr.cohesion = 500.0 * pa;
  fluid.bulk_modulus = 5e5 * pa, fluid.viscosity = 10.0 * pa * s;
  switch (kind) {
  case ELASTIC:
    return mps_material_create_linear_elastic(context, 1e6 * pa, 0.3, out);
  case STIFF_ELASTIC:
    return mps_material_create_linear_elastic(context, 5e5 * pa, 0.48, out);
  case NEO_HOOKEAN:
    return mps_material_create_neo_hookean(context, 1e6 * pa, 0.25, out);
  case VON_MISES:
    return mps_material_create_von_mises(context, &mises, out);
  case DRUCKER_PRAGER:
    return mps_material_create_drucker_prager(context, &cone, out);
  case MOHR_COULOMB:
    return mps_material_create_mohr_coulomb(context, &mohr, out);
  case TRESCA:
    mohr.friction = 0.0, mohr.cohesion = 3e3 * pa;
    return mps_material_create_mohr_coulomb(context, &mohr, out);
  default:
    return mps_material_create_newtonian(context, &fluid, out);
  }
}

/* ---- building -------------------------------------------------------------------------------- */

static double spacing_of(const scene *s) { return CELL * s->by->length / s->p->per_cell; }

static mps_status append(scene *s, int64_t count, const double (*x)[3]) {
  double *flat = malloc((size_t)count * 3 * sizeof *flat);
  for (int64_t k = 0; k < count; k++) {
    double at[3];
    place(s->by, x[k], at);
    for (int c = 0; c < s->p->dim; c++) flat[k * s->p->dim + c] = at[c];
  }
  const mps_status status = mps_particles_append(s->set, count, flat);
  free(flat);
  return status;
}

static mps_status make_set(scene *s) {
  const plan *p = s->p;
  mps_particles_def def = mps_particles_defaults();
  mps_edit v;
  def.dim = p->dim, def.spacing = spacing_of(s);
  mps_status status = mps_particles_create(s->context, &def, &s->set);
  TRY(append(s, p->count, p->x));
  TRY(mps_particles_set(s->set, "density", 0, 2000.0 * density_scale(s->by)));
  TRY(mps_particles_add_field(s->set, "velocity", 0));
  TRY(mps_particles_edit(s->set, "velocity", &v));
  for (int64_t k = 0; status == MPS_OK && k < p->count; k++) {
    double w[3];
    turn(s->by, p->v[k], s->by->length / s->by->time, w);
    for (int c = 0; c < p->dim; c++) *mps_edit_f64(&v, k, c) = w[c];
  }
  TRY(mps_particles_commit(s->set, &v));
  return status;
}

static mps_mpm_def method_of(const scene *s) {
  const plan *p = s->p;
  const change *by = s->by;
  mps_mpm_def def = mps_mpm_defaults();
  def.geometry = p->geometry, def.spline = p->spline, def.volumetric = p->volumetric;
  def.edge = p->walls, def.budget = p->budget, def.courant = p->courant;
  def.flip_time = 5e-3 * p->flip_time * by->time;
  def.viscous_damping = p->viscous / by->time, def.local_damping = p->local;
  def.cell = CELL * by->length;
  if (p->geometry == MPS_MPM_GEOMETRY_PLANE_STRAIN) def.measure = by->length;
  for (int c = 0; c < p->dim; c++) {
    const int a = by->axis[c];
    const bool mirrored = by->sign[c] < 0.0;
    def.lower[a] = def.cell * ((mirrored ? -p->high[c] : p->low[c]) + by->shift[a]);
    def.upper[a] = def.cell * ((mirrored ? -p->low[c] : p->high[c]) + by->shift[a]);
  }
  turn(by, p->gravity, by->length / (by->time * by->time), def.gravity);
  return def;
}

static mps_status set_side(scene *s, int k, const side *from, mps_signal *signal) {
  mps_mpm_boundary_def def = mps_mpm_boundary_defaults();
  def.kind = from->kind, def.friction = from->friction, def.settle = from->settle * s->by->time;
  for (int c = 0; c < s->p->dim; c++)
    if (from->moves[c])
      def.signal[s->by->axis[c]] = signal, def.factor[s->by->axis[c]] = s->by->sign[c] * (1 + c);
  return mps_mpm_set_boundary(s->mpm, side_number(s->by, k), &def);
}

static mps_status make_sides(scene *s) {
  const plan *p = s->p;
  mps_signal *signal = NULL;
  mps_status status = mps_signal_create_sine(s->context, MPS_SIGNAL_QUANTITY_DISPLACEMENT,
                                             p->frequency / s->by->time,
                                             p->amplitude * s->by->length, p->phase, &signal);
  for (int k = 2 * p->dim - 1; k >= 0; k--) TRY(set_side(s, k, &p->side[k], signal));
  mps_signal_destroy(&signal);
  return status;
}

static mps_status make_water(scene *s) {
  mps_pore_water_def def = mps_pore_water_defaults();
  def.porosity = 0.4;
  if (s->p->flows) def.permeability = 1e-4 * s->by->time;
  def.bulk = 2e6 * stress_scale(s->by);
  def.density = 1000.0 * density_scale(s->by);
  return mps_mpm_add_pore_water(s->mpm, &def);
}

static mps_status add_load(scene *s, double factor, int64_t first, int64_t stride) {
  int64_t ids[MOST], count = 0;
  mps_mpm_load_def def = mps_mpm_load_defaults();
  for (int64_t id = first; id < s->p->count; id += stride) ids[count++] = id;
  if (count == 0) return MPS_OK;
  def.ids = ids, def.id_count = count;
  turn(s->by, s->p->traction, factor * stress_scale(s->by), def.traction);
  return mps_mpm_add_load(s->mpm, &def, NULL);
}

static mps_status drive(scene *s, int32_t component, double speed) {
  const double t[2] = {0.0, 16.0 * s->by->time}, v[2] = {speed, speed};
  mps_signal *signal = NULL;
  mps_status status =
      mps_signal_create_table(s->context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, t, v, &signal);
  TRY(mps_body_drive(s->body, component, signal, 1.0));
  mps_signal_destroy(&signal);
  return status;
}

/* A ball, or a box whose first axis is turned with the scene. */
static mps_status make_body(scene *s) {
  const plan *p = s->p;
  const change *by = s->by;
  const double speed = by->length / by->time, r = p->size * by->length;
  const double along[3] = {cos(p->angle), sin(p->angle), 0.0};
  mps_body_def def = mps_body_defaults();
  mps_contact_def contact = mps_contact_defaults();
  double axis[3], v[3], mass = 300.0 * by->mass;
  turn(by, along, 1.0, axis);
  place(by, p->place, def.position);
  turn(by, p->velocity, speed, v);
  const bool straight = by->axis[0] == 0 && by->sign[0] > 0.0 && by->sign[1] > 0.0;
  if (p->body == 2) s->angle = straight ? p->angle : atan2(axis[1], axis[0]);
  def.rotation[2] = s->angle;
  if (p->free_body) {
    def.motion = MPS_BODY_MOTION_FREE, def.mass = mass;
    for (int c = 0; c < 3; c++) def.inertia[c] = p->dim == 3 || c == 2 ? 0.3 * mass * r * r : 0.0;
    memcpy(def.velocity, v, sizeof v);
    def.spin[2] = sense_of_turns(by) * p->spin / by->time;
    turn(by, p->gravity, speed / by->time, def.gravity);
    if (p->dim == 2) def.gravity[2] = 0.0;
  }
  mps_status status = p->body == 2
                          ? mps_body_create_box(s->context, &def, 2.6 * r, 1.8 * r, &s->body)
                      : p->dim == 3 ? mps_body_create_sphere(s->context, &def, r, &s->body)
                                    : mps_body_create_disc(s->context, &def, r, &s->body);
  for (int c = 0; c < p->dim && !p->free_body; c++)
    if (v[c] != 0.0) TRY(drive(s, c, v[c]));
  if (!p->free_body && p->spin != 0.0 && p->dim == 2)
    TRY(drive(s, 5, sense_of_turns(by) * p->spin / by->time));
  contact.friction = p->friction;
  if (p->penalty) contact.method = MPS_CONTACT_METHOD_PENALTY;
  if (!p->penalty) contact.sweeps = p->sweeps, contact.tolerance = p->tolerance;
  contact.inset = p->inset * CELL * by->length;
  contact.inside = MPS_CONTACT_INSIDE_PUSH;
  TRY(mps_mpm_add_contact(s->mpm, s->body, &contact, &s->contact));
  return status;
}

static mps_status set_second_law(scene *s) {
  int64_t ids[MOST], count = 0;
  for (int64_t id = 0; id < s->p->count; id += 3) ids[count++] = id;
  return mps_mpm_set_material(s->mpm, s->material[1], ids, count);
}

static mps_status build(scene *s) {
  const plan *p = s->p;
  const double pa = stress_scale(s->by);
  const mps_mpm_def def = method_of(s);
  mps_status status = make_set(s);
  TRY(make_material(s->context, p->law[0], pa, s->by->time, &s->material[0]));
  TRY(make_material(s->context, p->law[1], pa, s->by->time, &s->material[1]));
  TRY(mps_mpm_create(s->context, s->set, s->material[0], &def, &s->mpm));
  if (p->two) TRY(set_second_law(s));
  if (p->water) TRY(make_water(s));
  TRY(make_sides(s));
  if (p->load) TRY(add_load(s, 1.0, 0, 5));
  if (p->body) TRY(make_body(s));
  return status;
}

static void drop(scene *s) {
  mps_contact_destroy(&s->contact);
  mps_body_destroy(&s->body);
  mps_mpm_destroy(&s->mpm);
  mps_particles_destroy(&s->set);
  for (int k = 0; k < 2; k++) mps_material_destroy(&s->material[k]);
}

/* ---- running --------------------------------------------------------------------------------- */

static mps_status insert(scene *s) {
  double x[3][3] = {{0.0}};
  const plan *p = s->p;
  mps_edit density;
  for (int k = 0; k < 3; k++) {
    x[k][0] = CELL * (0.25 + 0.5 * (k - (p->low[0] < 0)));
    x[k][1] = CELL * (p->high[1] - 1.25);
    x[k][2] = 0.25 * CELL;
  }
  mps_status status = append(s, 3, (const double(*)[3])x);
  TRY(mps_particles_edit(s->set, "density", &density));
  for (int64_t k = 0; status == MPS_OK && k < density.view.shape[0]; k++)
    if (*mps_edit_f64(&density, k, 0) == 0.0)
      *mps_edit_f64(&density, k, 0) = 2000.0 * density_scale(s->by);
  TRY(mps_particles_commit(s->set, &density));
  return status;
}

static mps_status take_away(scene *s) {
  const int64_t ids[3] = {1, s->p->count / 2, s->p->count - 1};
  mps_status status = MPS_OK;
  for (int k = 0; k < 3; k++)
    if (mps_particles_index(s->set, ids[k]) >= 0) TRY(mps_particles_remove(s->set, &ids[k], 1));
  return status;
}

static mps_status settle(scene *s) {
  mps_mpm_settle_def def = mps_mpm_settle_defaults();
  def.max_steps = 60;
  const mps_status status = mps_mpm_settle(s->mpm, &def, NULL);
  return status == MPS_ERROR_NUMERIC ? MPS_OK : status;
}

/* `anew`: in a solver that is to be restored, what of it is not in the file. */
static mps_status make_event(scene *s, bool anew) {
  const side rough = {.kind = MPS_BOUNDARY_FRICTIONAL, .friction = 0.3};
  switch (s->p->event) {
  case INSERTS:
    return anew ? MPS_OK : insert(s);
  case REMOVES:
    return anew ? MPS_OK : take_away(s);
  case SETTLES:
    return anew ? MPS_OK : settle(s);
  case SETS_SIDE:
    return set_side(s, (int)(2 + s->p->seed % 2), &rough, NULL);
  case ADDS_LOAD:
    return add_load(s, -0.5, 1, 4);
  default:
    return MPS_OK;
  }
}

static mps_status roll_back(scene *s, int64_t steps) {
  mps_snapshot *snapshot = NULL;
  mps_status status = mps_mpm_snapshot(s->mpm, &snapshot);
  TRY(mps_mpm_step(s->mpm, steps));
  TRY(mps_mpm_rollback(s->mpm, snapshot));
  mps_snapshot_destroy(&snapshot);
  return status;
}

static mps_status restore(scene *s, const char *folder) {
  char path[400];
  snprintf(path, sizeof path, "%s/metamorphic-%d.h5", folder, (int)getpid());
  mps_status status = mps_mpm_save(s->mpm, path, NULL);
  if (status != MPS_OK) return status;
  drop(s);
  status = build(s);
  TRY(make_event(s, true));
  TRY(mps_mpm_restore(s->mpm, path, NULL));
  (void)remove(path);
  return status;
}

static mps_status make_steps(scene *s, int64_t count) {
  const bool at_once = s->by->way == AT_ONCE;
  mps_status status = MPS_OK;
  mps_mpm_report usage;
  for (int64_t k = 0; k < count; k += at_once ? count : 1) {
    TRY(mps_mpm_step(s->mpm, at_once ? count : 1));
    TRY(mps_mpm_get_report(s->mpm, &usage));
    if (status == MPS_OK) s->left = fmax(s->left, usage.left);
  }
  return status;
}

static mps_status run(scene *s, const char *folder) {
  const plan *p = s->p;
  mps_status status = build(s);
  TRY(make_steps(s, p->steps[0]));
  TRY(make_event(s, false));
  TRY(make_steps(s, p->steps[1]));
  if (s->by->way == ROLLED_BACK) TRY(roll_back(s, p->steps[2]));
  if (s->by->way == RESTORED) TRY(restore(s, folder));
  TRY(make_steps(s, p->steps[2]));
  return status;
}

/* ---- results --------------------------------------------------------------------------------- */

static void turn_tensor_back(const change *by, double T[3][3], double scale, double (*out)[3]) {
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      out[a][b] = by->sign[a] * by->sign[b] * T[by->axis[a]][by->axis[b]] / scale;
}

static bool view(scene *s, const char *name, mps_view *out) {
  return mps_particles_view(s->set, name, out) == MPS_OK;
}

static void keep_tensors(scene *s, int64_t k, int64_t id, const mps_view *stress,
                         const mps_view *gradient, result *out) {
  const int dim = s->p->dim;
  const change *by = s->by;
  double T[3][3] = {{0.0}}, L[3][3] = {{0.0}};
  for (int c = 0; c < 3; c++) T[c][c] = *mps_view_f64(stress, k, c);
  T[0][1] = T[1][0] = *mps_view_f64(stress, k, 3);
  if (dim == 3) T[0][2] = T[2][0] = *mps_view_f64(stress, k, 4);
  if (dim == 3) T[1][2] = T[2][1] = *mps_view_f64(stress, k, 5);
  for (int a = 0; a < dim; a++)
    for (int b = 0; b < dim; b++) L[a][b] = *mps_view_f64(gradient, k, dim * a + b);
  if (dim == 2) L[2][2] = *mps_view_f64(gradient, k, 4);
  turn_tensor_back(by, T, stress_scale(by), out->stress[id]);
  turn_tensor_back(by, L, 1.0 / by->time, out->gradient[id]);
}

static void keep_particles(scene *s, result *out) {
  static const char *const names[] = {"volume", "mass", "plastic_strain", "pore_pressure"};
  const change *by = s->by;
  const double L3 = by->length * by->length * by->length;
  const bool ring = s->p->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  const double scale[] = {L3, by->mass, 1.0, stress_scale(by)};
  mps_view x, v, stress, gradient, id, scalar[4];
  bool has[4];
  (void)ring;
  if (!view(s, "position", &x) || !view(s, "velocity", &v) || !view(s, "stress", &stress) ||
      !view(s, "velocity_gradient", &gradient) || !view(s, "id", &id))
    abort();
  for (int c = 0; c < 4; c++) has[c] = view(s, names[c], &scalar[c]);
  out->count = x.shape[0];
  for (int64_t k = 0; k < out->count; k++) {
    const int64_t i = *mps_view_i64(&id, k, 0);
    double at[3] = {0.0}, w[3] = {0.0};
    if (i < 0 || i >= 2 * MOST) abort();
    out->here[i] = true;
    for (int c = 0; c < s->p->dim; c++)
      at[c] = *mps_view_f64(&x, k, c), w[c] = *mps_view_f64(&v, k, c);
    place_back(by, at, out->position[i]);
    turn_back(by, w, by->length / by->time, out->velocity[i]);
    keep_tensors(s, k, i, &stress, &gradient, out);
    for (int c = 0; c < 4; c++)
      out->scalar[c][i] = has[c] ? *mps_view_f64(&scalar[c], k, 0) / scale[c] : 0.0;
  }
}

static void keep_others(scene *s, result *out) {
  const change *by = s->by;
  const double impulse = by->mass * by->length / by->time;
  mps_reaction r;
  for (int k = 0; k < 2 * s->p->dim; k++)
    if (mps_mpm_get_reaction(s->mpm, side_number(by, k), &r) == MPS_OK)
      turn_back(by, r.impulse, impulse, out->impulse[k]);
  if (!s->body) return;
  mps_body_state b;
  if (mps_body_get_state(s->body, &b) != MPS_OK) abort();
  place_back(by, b.position, out->body[0]);
  turn_back(by, b.velocity, by->length / by->time, out->body[1]);
  out->turn[0] = s->p->dim == 2 ? sense_of_turns(by) * (b.rotation[2] - s->angle) : 0.0;
  out->turn[1] = s->p->dim == 2 ? sense_of_turns(by) * b.spin[2] * by->time : 0.0;
  if (mps_body_get_reaction(s->body, -1, &r) == MPS_OK) turn_back(by, r.impulse, impulse, out->hit);
}

void run_plan(const plan *p, const change *by, const char *folder, result *out) {
  scene s = {.p = p, .by = by};
  mps_context_def def = mps_context_defaults();
  char why[200];
  memset(out, 0, sizeof *out);
  def.executor = by->threads > 0 ? MPS_CONTEXT_EXECUTOR_THREADS : MPS_CONTEXT_EXECUTOR_SERIAL;
  def.threads = by->threads > 0 ? by->threads : 1;
  if (mps_context_create(&def, &s.context, why, sizeof why) != MPS_OK) {
    fprintf(stderr, "%s\n", why);
    exit(2);
  }
  out->status = run(&s, folder);
  if (out->status != MPS_OK)
    snprintf(out->message, sizeof out->message, "%.190s", mps_context_error(s.context)->message);
  if (s.mpm) out->time = mps_mpm_time(s.mpm) / by->time, out->steps = mps_mpm_steps(s.mpm);
  out->left = s.left;
  if (out->status == MPS_OK) {
    keep_particles(&s, out);
    keep_others(&s, out);
  }
  drop(&s);
  mps_context_destroy(&s.context);
}
