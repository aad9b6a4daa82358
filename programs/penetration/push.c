/* push.c - see push.h. SPDX-License-Identifier: BSD-3-Clause */
#include "push.h"

#include <mps/soil.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define INSIDE 1e-6   /* cells: deeper below the surface counts as inside */
#define STIFFNESS 4.0 /* of the contact, over K + 4G/3 and at most over m/dt^2 */

mps_status push_begin(push *p, int64_t capacity, int64_t particles) {
  p->capacity = capacity;
  p->row = calloc((size_t)capacity, sizeof *p->row);
  p->near = calloc((size_t)particles * 3 + 1, sizeof *p->near);
  p->distance = calloc((size_t)particles + 1, sizeof *p->distance);
  p->seen.ratio_min = INFINITY;
  return p->row && p->near && p->distance ? MPS_OK : MPS_ERROR_MEMORY;
}

void push_free(push *p) {
  free(p->row);
  free(p->near);
  free(p->distance);
  free(p->counts.untold);
  p->row = NULL, p->near = p->distance = NULL, p->counts.untold = NULL;
}

int push_up(const push *p) { return mps_particles_dim(p->m->particles) - 1; }

double push_depth(const push *p) {
  mps_body_state state;
  if (mps_body_get_state(p->m->body[0], &state) != MPS_OK) return NAN;
  return p->ground + p->above - state.position[push_up(p)];
}

/* ---- looks ----------------------------------------------------------------------------------- */

static mps_status look_at_volumes(push *p) {
  mps_view volume, mass;
  mps_status status = mps_particles_view(p->m->particles, "volume", &volume);
  if (status == MPS_OK) status = mps_particles_view(p->m->particles, "mass", &mass);
  for (int64_t k = 0; status == MPS_OK && k < volume.shape[0]; k++) {
    const double ratio = p->density * *mps_view_f64(&volume, k, 0) / *mps_view_f64(&mass, k, 0);
    p->seen.ratio_max = fmax(p->seen.ratio_max, ratio);
    p->seen.ratio_min = fmin(p->seen.ratio_min, ratio);
  }
  return status;
}

mps_status push_look_at_speeds(push *p) {
  mps_view v;
  const mps_status status = mps_particles_view(p->m->particles, "velocity", &v);
  for (int64_t k = 0; status == MPS_OK && k < v.shape[0]; k++)
    p->seen.speed = fmax(p->seen.speed, hypot(*mps_view_f64(&v, k, 0), *mps_view_f64(&v, k, 1)));
  return status;
}

/* The body is queried for particles above its lowest point, and as far from the axis as it is. */
static mps_status look_for_intruders(push *p) {
  mps_view x;
  mps_status status = mps_particles_view(p->m->particles, "position", &x);
  if (status != MPS_OK) return status;
  const int up = push_up(p);
  const double tip = p->ground - push_depth(p);
  int64_t count = 0, inside = 0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double at[3] = {*mps_view_f64(&x, k, 0), *mps_view_f64(&x, k, 1),
                          up == 2 ? *mps_view_f64(&x, k, 2) : 0.0};
    const double square = at[0] * at[0] + (up == 2 ? at[1] * at[1] : 0.0);
    if (at[up] < tip || square < p->lower * p->lower || square > p->upper * p->upper) continue;
    for (int c = 0; c <= up; c++) p->near[(up + 1) * count + c] = at[c];
    count++;
  }
  if (count > 0)
    status = mps_body_distance(p->m->body[0], count, p->near, p->distance, NULL, NULL, NULL);
  for (int64_t k = 0; status == MPS_OK && k < count; k++) {
    p->seen.deepest = fmax(p->seen.deepest, -p->distance[k]);
    if (p->distance[k] < -INSIDE * p->cell) inside++;
  }
  return status == MPS_OK ? mpm_counts_note(p->m, &p->counts, inside, &p->seen.inside) : status;
}

mps_status push_look(push *p, bool at_volumes) {
  const mps_status status = look_for_intruders(p);
  return status == MPS_OK && at_volumes ? look_at_volumes(p) : status;
}

mps_status push_note_jitter(push *p, double t) {
  mps_reaction r;
  const mps_status status = mps_body_get_reaction(p->m->body[0], -1, &r);
  const double force = status == MPS_OK ? p->factor * r.force[push_up(p)] : 0.0;
  p->squares += (t - p->last_step) * force * force;
  p->last_step = t;
  return status;
}

mps_status push_join(push *p, mps_status status) {
  push_seen *s = &p->seen;
  double most[] = {s->ratio_max, -s->ratio_min, s->deepest, s->speed};
  mps_domain *domain = p->m->a->domain;
  if (!domain) return status;
  status = mps_domain_agree(domain, status);
  if (status == MPS_OK) status = mps_domain_max(domain, 4, most);
  if (status != MPS_OK) return status;
  s->ratio_max = most[0], s->ratio_min = -most[1], s->deepest = most[2], s->speed = most[3];
  return mpm_counts_join(p->m, &p->counts, &s->inside);
}

/* ---- rows ------------------------------------------------------------------------------------ */

mps_status push_impulses(const push *p, double *up) {
  const mps_body *body = p->m->body[0];
  mps_reaction r;
  mps_status status = mps_body_get_reaction(body, -1, &r);
  for (int k = 0; k < PUSH_FORCES; k++) up[k] = 0.0;
  up[PUSH_TOTAL] = up[0] = p->factor * r.impulse[push_up(p)];
  for (int k = 0; k < PUSH_PARTS && status == MPS_OK; k++) {
    const int32_t part = p->part[k] ? mps_body_find_part(body, p->part[k]) : -1;
    if (part < 0) continue;
    status = mps_body_get_reaction(body, part, &r);
    up[k] = p->factor * r.impulse[push_up(p)];
  }
  return status;
}

mps_status push_end_row(push *p, double t, push_row **row) {
  double up[PUSH_FORCES];
  const double span = t - p->last_time;
  const mps_status status = push_impulses(p, up);
  *row = NULL;
  if (status != MPS_OK || !(span > 0.0) || p->rows == p->capacity) return status;
  push_row *now = *row = &p->row[p->rows++];
  *now = (push_row){.depth = push_depth(p), .plug = NAN};
  for (int k = 0; k < PUSH_FORCES; k++) {
    now->force[k] = (up[k] - p->last_impulse[k]) / span;
    p->last_impulse[k] = up[k];
  }
  const double mean = now->force[PUSH_TOTAL];
  now->jitter = sqrt(fmax(0.0, p->squares / span - mean * mean));
  p->last_time = t;
  p->squares = 0.0;
  p->m->samples = p->rows;
  return MPS_OK;
}

void push_smooth(push *p, int64_t half, int64_t least) {
  for (int64_t i = 0; i < p->rows; i++) {
    int64_t reach = half < i ? half : i; /* as far to either side: no lag on a slope */
    if (reach > p->rows - 1 - i) reach = p->rows - 1 - i;
    if (reach < least) reach = least; /* but at the ends */
    const int64_t first = i < reach ? 0 : i - reach;
    const int64_t last = i + reach < p->rows ? i + reach : p->rows - 1;
    for (int k = 0; k < PUSH_FORCES; k++) {
      double sum = 0.0;
      for (int64_t j = first; j <= last; j++) sum += p->row[j].force[k];
      p->row[i].smooth[k] = sum / (double)(last - first + 1);
    }
  }
}

void push_pass(push *p, resume_bytes *b) {
  resume_pass(b, &p->rows, sizeof p->rows);
  if (resume_wrong(b, p->rows < 0 || p->rows > p->capacity)) {
    p->rows = 0;
    return;
  }
  resume_pass(b, p->row, (size_t)p->rows * sizeof *p->row);
  resume_pass(b, p->last_impulse, sizeof p->last_impulse);
  double *const values[] = {&p->last_time, &p->last_step, &p->squares};
  for (size_t k = 0; k < sizeof values / sizeof *values; k++)
    resume_pass(b, values[k], sizeof *values[k]);
  resume_pass(b, &p->seen, sizeof p->seen);
}

/* ---- soil and contact ------------------------------------------------------------------------ */

mps_status push_set_stress(push *p, double gravity, double k0, double surface, double surcharge) {
  const mps_geostatic_layer layer = {.thickness = INFINITY, .k0 = k0, .density = NAN};
  mps_geostatic_def def = mps_geostatic_defaults();
  def.layers = &layer, def.layer_count = 1;
  def.gravity = gravity;
  def.surface = surface;
  def.surcharge = surcharge;
  return mps_particles_set_geostatic(p->m->particles, &def);
}

mps_status push_make_sand(mps_context *context, const push_sand *s, mps_material **out) {
  const double radian = PUSH_PI / 180.0;
  mps_material_drucker_prager_def sand = mps_material_drucker_prager_defaults();
  sand.cone = s->cone;
  sand.young = s->young, sand.poisson = s->poisson;
  sand.friction = s->phi * radian, sand.dilation = s->psi * radian;
  sand.cohesion = s->cohesion;
  sand.void_ratio = s->voids.e0, sand.max_void_ratio = s->voids.e_max;
  return mps_material_create_drucker_prager(context, &sand, out);
}

double push_penalty(const push *p) {
  const double spacing = mps_particles_spacing(p->m->particles), dt = mps_mpm_dt(p->m->mpm);
  const double limit = p->density * spacing * spacing / (dt * dt);
  const double k = STIFFNESS * fmin(mps_material_wave_modulus(p->m->material), limit);
  return push_up(p) == 2 ? k * spacing : k;
}

mps_status push_add_contact(push *p, int method, double corner, double inset, double penalty,
                            mps_contact_def *contact) {
  contact->method = method;
  if (method == MPS_CONTACT_METHOD_IMPULSE) contact->corner = corner * p->cell;
  contact->inset = inset * p->cell;
  if (method == MPS_CONTACT_METHOD_PENALTY) contact->penalty = penalty;
  return mps_mpm_add_contact(p->m->mpm, p->m->body[0], contact, NULL);
}

/* ---- pictures -------------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

double push_most(int64_t count, const double *value, double share) {
  double *copy = malloc((size_t)(count + 1) * sizeof *copy);
  if (!copy || count == 0) {
    free(copy);
    return NAN;
  }
  memcpy(copy, value, (size_t)count * sizeof *copy);
  qsort(copy, (size_t)count, sizeof *copy, ascending);
  const double most = copy[(int64_t)(share * (double)(count - 1))];
  free(copy);
  return most;
}
