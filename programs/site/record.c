/* record.c - what mps-site-response records of the rows of particles: the history of the surface
 * and of one depth, largest values by depth, and a file to restart from.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Means over the particles of a row, in the frame of the input. */
typedef struct means {
  double x, y, v;            /* m, m, m/s */
  double volume;             /* m3 in all, with the gaps between grains, which water fills */
  double shear, vertical, u; /* Pa: tau, effective compression, water */
  double borne;              /* Pa: tau that accelerates the ground above, of find_borne */
} means;

/* Position of particle `id` along x, as if it had not passed the sides: ground that leaves at one
 * comes in at the other. */
static double place_of(const simulation *sim, int64_t id, double x) {
  const double first = ((double)(id % sim->across) + 0.5) * sim->spacing;
  const double moved = sim->row[id / sim->across].last_displacement;
  return x + sim->width * round((first + moved - x) / sim->width);
}

/* Particles have their ids by rows from below. */
static mps_status find_means(const simulation *sim, means *out) {
  mps_particles *set = sim->m.particles;
  mps_view id, x, v, stress, volume, gap = {0}, u = {0};
  mps_status status = mps_particles_view(set, "id", &id);
  if (status == MPS_OK) status = mps_particles_view(set, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(set, "velocity", &v);
  if (status == MPS_OK) status = mps_particles_view(set, "stress", &stress);
  if (status == MPS_OK) status = mps_particles_view(set, "volume", &volume);
  if (status == MPS_OK && sim->opens) status = mps_particles_view(set, "opening", &gap);
  if (status == MPS_OK && sim->wet) status = mps_particles_view(set, "pore_pressure", &u);
  if (status != MPS_OK) return status;
  const double share = 1.0 / (double)sim->across;
  memset(out, 0, (size_t)sim->rows * sizeof *out);
  for (int64_t k = 0; k < id.shape[0]; k++) {
    const int64_t own = *mps_view_i64(&id, k, 0);
    means *row = &out[own / sim->across];
    row->x += share * place_of(sim, own, *mps_view_f64(&x, k, 0));
    row->y += share * *mps_view_f64(&x, k, 1);
    row->v += share * *mps_view_f64(&v, k, 0);
    row->volume +=
        *mps_view_f64(&volume, k, 0) * (1.0 + (sim->opens ? *mps_view_f64(&gap, k, 0) : 0.0));
    row->shear += share * *mps_view_f64(&stress, k, 3);
    row->vertical -= share * *mps_view_f64(&stress, k, 1);
    if (sim->wet) row->u += share * *mps_view_f64(&u, k, 0);
  }
  return MPS_OK;
}

mps_status site_begin_record(simulation *sim) {
  sim->across = llround(sim->width / sim->spacing);
  sim->rows = mps_particles_count(sim->m.particles) / sim->across;
  sim->row = calloc((size_t)sim->rows, sizeof *sim->row);
  sim->sample = calloc((size_t)sim->samples + 1, sizeof *sim->sample);
  sim->loop_row = -1;
  if (!sim->row || !sim->sample) return MPS_ERROR_MEMORY;
  for (int64_t r = 0; r < sim->rows; r++) {
    sim->row[r].depth = sim->height + sim->below - ((double)r + 0.5) * sim->spacing;
    if (!isnan(sim->s.loop) &&
        (sim->loop_row < 0 ||
         fabs(sim->row[r].depth - sim->s.loop) < fabs(sim->row[sim->loop_row].depth - sim->s.loop)))
      sim->loop_row = r;
  }
  return MPS_OK;
}

/* The rows as they are when the motion begins. */
static void note_rest(simulation *sim, const means *now) {
  for (int64_t r = 0; r < sim->rows; r++) {
    sim->row[r].x = now[r].x, sim->row[r].y = now[r].y;
    sim->row[r].vertical = now[r].vertical, sim->row[r].pressure = now[r].u;
    sim->row[r].volume = now[r].volume;
  }
}

/* Engineering shear strain by the displacements of the rows above and below. */
static double strain_of(const simulation *sim, const means *now, int64_t r) {
  const int64_t a = r > 0 ? r - 1 : r, b = r + 1 < sim->rows ? r + 1 : r;
  return (now[b].x - sim->row[b].x - now[a].x + sim->row[a].x) / (sim->row[b].y - sim->row[a].y);
}

double site_slope(const double v[5], double step) {
  return (8.0 * (v[3] - v[1]) - (v[4] - v[0])) / (12.0 * step);
}

/* tau of a row beyond the ends: at the surface it is 0, with opposite images; the base bears on. */
static double shear_at(const simulation *sim, const means *now, int64_t r) {
  const int64_t last = sim->rows - 1;
  return r < 0 ? now[-1 - r].shear : r > last ? -now[2 * last + 1 - r].shear : now[r].shear;
}

/* Half of the sum of h grad(phi_j) over the nodes above the middle of a cell, at rows of particles
 * a quarter, three and five quarters of h from it: phi_j, grad(phi_j) of docs/theory/wls-mpm.md. */
static const double quadratic[3] = {27.0 / 64.0, 5.0 / 64.0, 0.0};
static const double cubic[3] = {185.0 / 512.0, 135.0 / 1024.0, 7.0 / 1024.0};

/* The force of the stresses on the nodes above the middle of cell k over its area. It is what
 * accelerates the ground above, whatever single particles bear at interfaces of layers. */
static double borne_by_cell(const simulation *sim, const means *now, int64_t k) {
  const double *weight = sim->s.spline == 1 ? cubic : quadratic;
  double sum = 0.0;
  for (int64_t i = 0; i < 3; i++)
    sum += weight[i] * (shear_at(sim, now, 2 * k - i) + shear_at(sim, now, 2 * k + 1 + i));
  return sum;
}

/* Rows lie a quarter of a cell off the middle of their cell. */
static void find_borne(const simulation *sim, means *now) {
  for (int64_t r = 0; r < sim->rows; r++) {
    const int64_t k = r / 2, other = r % 2 ? k + 1 : k > 0 ? k - 1 : 0;
    now[r].borne = 0.75 * borne_by_cell(sim, now, k) + 0.25 * borne_by_cell(sim, now, other);
  }
}

static void update_row(const simulation *sim, const means *now, int64_t r, double t) {
  site_row *row = &sim->row[r];
  const double step = sim->s.sample, middle = t - 2.0 * step;
  const double moved = now[r].x - row->x;
  memmove(row->v, row->v + 1, 4 * sizeof *row->v);
  row->v[4] = now[r].v;
  if (sim->count >= 4)
    row->acceleration =
        fmax(row->acceleration, fabs(site_slope(row->v, step) + site_input(sim, middle)));
  row->velocity = fmax(row->velocity, fabs(now[r].v + mps_signal_velocity(sim->motion, t)));
  row->displacement = fmax(row->displacement, fabs(moved));
  const site_layer *l = site_layer_at(&sim->ground, row->depth);
  const double strain =
      l->law == SITE_ELASTIC ? now[r].borne / (l->density * l->vs * l->vs) : strain_of(sim, now, r);
  row->strain = fmax(row->strain, fabs(strain));
  row->stress = fmax(row->stress, fabs(now[r].borne));
  row->last_ru = sim->wet ? (now[r].u - row->pressure) / row->vertical : 0.0;
  memmove(row->u, row->u + 1, 4 * sizeof *row->u);
  row->u[4] = row->last_ru;
  if (sim->count >= 4) /* pressure waves are shorter */
    row->ru = fmax(row->ru, 0.2 * (row->u[0] + row->u[1] + row->u[2] + row->u[3] + row->u[4]));
  row->sunk = row->y - now[r].y;
  row->last_displacement = moved;
}

/* Of level ground: by what the ground between a row and the lowest has lost of its volume. Places
 * of particles in sand that flows, which has no stiffness to hold them, drift by some millimetres
 * against their volumes. */
static void find_settlements(simulation *sim, const means *now) {
  double sum = sim->row[0].sunk, below = 0.0;
  for (int64_t r = 0; r < sim->rows; r++) {
    const double lost = 0.5 * (sim->row[r].volume - now[r].volume) / sim->width;
    if (r > 0) sum += below + lost;
    sim->row[r].settlement = sum;
    below = lost;
  }
}

mps_status site_take_sample(simulation *sim) {
  means *now = malloc((size_t)sim->rows * sizeof *now);
  const mps_status status = now ? find_means(sim, now) : MPS_ERROR_MEMORY;
  if (status == MPS_OK) {
    const double t = sim->s.sample * (double)sim->count;
    if (sim->count == 0) note_rest(sim, now);
    find_borne(sim, now);
    for (int64_t r = 0; r < sim->rows; r++) update_row(sim, now, r, t);
    find_settlements(sim, now);
    const site_row *top = &sim->row[sim->rows - 1];
    site_sample *sample = &sim->sample[sim->count];
    *sample = (site_sample){
        .t = t, .v = top->v[4], .u = top->last_displacement, .settlement = top->settlement};
    if (sim->loop_row >= 0) {
      sample->strain = strain_of(sim, now, sim->loop_row);
      sample->stress = now[sim->loop_row].shear;
      sample->ru = sim->row[sim->loop_row].last_ru;
    }
    sim->m.samples = ++sim->count;
  }
  free(now);
  return status;
}

/* The layers and the record stand in files that may have changed: they must be those of the start.
 */
void site_pass(void *user, resume_bytes *b) {
  simulation *sim = user;
  const double record[3] = {sim->record_end, sim->record_peak, sim->duration};
  const bool same = resume_same(b, &sim->ground, sizeof sim->ground) &&
                    resume_same(b, record, sizeof record) &&
                    resume_same(b, &sim->rows, sizeof sim->rows);
  resume_pass(b, &sim->count, sizeof sim->count);
  if (!mpm_course_same(&sim->course, b, same, "the layers or the record have") ||
      resume_wrong(b, sim->count < 0 || sim->count > sim->samples + 1)) {
    sim->count = 0;
    return;
  }
  resume_pass(b, sim->row, (size_t)sim->rows * sizeof *sim->row);
  resume_pass(b, sim->sample, (size_t)sim->count * sizeof *sim->sample);
}
