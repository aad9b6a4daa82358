/* outflow.c - particles that leave the set: at the end of a step those that have passed an open
 * side of the domain; before a step those that lie too deep in a body which takes away what it
 * finds. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/particles/particles.h"

#include <string.h>

static bool takes_away(const mps_contact *contact) {
  return contact->def.inside == MPS_CONTACT_INSIDE_REMOVE;
}

mps_status mpsi_mpm_prepare_outflow(mps_mpm *mpm, const char *function) {
  mpsi_boundaries *b = &mpm->boundaries;
  b->open = 0;
  for (int32_t k = 0; k < MPSI_SIDES; k++)
    if (b->hold[k].kind == MPS_BOUNDARY_OPEN) b->open |= 1u << k;
  bool any = b->open != 0;
  for (int32_t c = 0; c < mpm->contact.bodies; c++) any = any || takes_away(mpm->contact.handle[c]);
  if (!any || mpsi_room_ensure(mpm->context, &mpm->rooms.gone, mpm->p.count, 1)) return MPS_OK;
  return mpsi_fail_memory(mpm->context, function, (size_t)mpm->p.count);
}

/* The open side that the particle has passed, or -1. */
static int32_t passed(const mps_mpm *mpm, int64_t k) {
  for (int c = 0; c < mpm->dim; c++) {
    const double X = mpsi_grid_coordinate(mpm, c, mpm->p.x[c][k]);
    if (mpm->boundaries.open >> (2 * c) & 1 && X < (double)mpm->grid.low[c]) return 2 * c;
    if (mpm->boundaries.open >> (2 * c + 1) & 1 && X > (double)mpm->grid.high[c]) return 2 * c + 1;
  }
  return -1;
}

/* What a particle carries out is taken from those that stay, as by an impulse. */
static void carry_out(mps_mpm *mpm, int64_t k, mpsi_boundary *hold) {
  const mpsi_columns *p = &mpm->p;
  const double m = p->m[k], h = mpm->def.cell;
  const double second = mpm->standard ? 0.0 : h * h / (mpm->def.spline == 3 ? 3.0 : 4.0);
  double x[3] = {0.0}, v[3] = {0.0}, L[3][3] = {{0.0}}, kinetic = 0.0;
  double impulse[3], moment[3];
  for (int c = 0; c < mpm->dim; c++) {
    x[c] = p->x[c][k], v[c] = p->v[c][k];
    for (int d = 0; d < mpm->dim; d++) L[c][d] = p->L[mpm->dim * c + d][k];
  }
  for (int c = 0; c < 3; c++) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    const double spin = m * (x[a] * v[b] - x[b] * v[a] + second * (L[b][a] - L[a][b]));
    impulse[c] = -m * v[c];
    moment[c] = -spin;
    kinetic += 0.5 * m * v[c] * v[c];
  }
  mpsi_mpm_boundary_add_impulse(hold, impulse, moment, -kinetic, 1);
  mpsi_mpm_energy_add_at_once(mpm, MPSI_ENERGY_BOUNDARIES, -kinetic);
  mpsi_mpm_energy_add_at_once(mpm, MPSI_ENERGY_KINETIC, -kinetic);
}

static int64_t through_sides(mps_mpm *mpm, uint8_t *gone) {
  int64_t count = 0;
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[b];
    for (int64_t k = cells->begin; k < cells->end && cells->gone; k++) {
      const int32_t side = passed(mpm, k);
      if (side < 0) continue;
      mpsi_boundary *hold = &mpm->boundaries.hold[side];
      carry_out(mpm, k, hold);
      hold->removed++;
      mpsi_exact_add(&hold->sums->all[MPSI_BOUNDARY_MASS], mpm->p.m[k]);
      gone[k] = 1;
      count++;
    }
  }
  return count;
}

static double *place_of(const mps_mpm *mpm, int64_t k, double *x) {
  for (int c = 0; c < 3; c++) x[c] = c < mpm->dim ? mpm->p.x[c][k] : 0.0;
  return x;
}

/* Marks particles [begin, end) that lie deeper than `depth` below the surface. */
static int64_t into_body(const mps_mpm *mpm, const mps_contact *contact, double depth,
                         int64_t begin, int64_t end, uint8_t *gone, uint8_t mark) {
  int64_t count = 0;
  for (int64_t k = begin; k < end; k++) {
    double x[3];
    if (gone[k] || !mpsi_body_reaches(contact->body, place_of(mpm, k, x), 0.0)) continue;
    if (!(mpsi_body_foot(contact->body, x).distance < -depth)) continue;
    gone[k] = mark;
    count++;
  }
  return count;
}

/* What the body has taken away, on all ranks. */
static mps_status count_out(mps_mpm *mpm, const char *function, mps_contact *contact,
                            const uint8_t *gone, uint8_t mark) {
  mpsi_exact mass[MPS_BODY_MAX_PARTS];
  int64_t count[MPS_BODY_MAX_PARTS] = {0};
  const int32_t parts = contact->body->parts;
  mps_status status = MPS_OK;
  memset(mass, 0, sizeof mass);
  for (int64_t k = 0; k < mpm->p.count; k++) {
    double x[3];
    if (gone[k] != mark) continue;
    const mpsi_foot foot = mpsi_body_foot(contact->body, place_of(mpm, k, x));
    const int32_t part = contact->body->part_of[foot.face];
    mpsi_exact_add(&mass[part], mpm->p.m[k]);
    count[part]++;
  }
  if (mpm->partition) status = mpsi_domain_sum(mpm->partition->domain, function, parts, count);
  if (mpm->partition && status == MPS_OK)
    status = mpsi_domain_sum_exact(mpm->partition->domain, function, parts, mass);
  for (int32_t part = 0; status == MPS_OK && part < parts; part++) {
    contact->source.reaction[part].removed += count[part];
    contact->source.reaction[part].removed_mass += mpsi_exact_value(&mass[part]);
  }
  return status;
}

static void begin_marks(const mps_mpm *mpm) {
  if (mpm->p.count > 0) memset(mpm->rooms.gone.item, 0, (size_t)mpm->p.count);
}

void mpsi_mpm_remove_leaving(mps_mpm *mpm) {
  bool any = false;
  for (int64_t b = 0; b < mpm->grid.cell_count && mpm->boundaries.open && !any; b++)
    any = mpm->grid.cells[b].gone;
  if (!any) return;
  begin_marks(mpm);
  if (through_sides(mpm, mpm->rooms.gone.item) > 0)
    mpsi_particles_take_out(mpm->particles, mpm->rooms.gone.item);
}

/* Marks of what lies in bodies: the number of the contact and 1. */
static int64_t mark_inside(mps_mpm *mpm) {
  uint8_t *gone = mpm->rooms.gone.item;
  int64_t count = 0;
  begin_marks(mpm);
  for (int64_t t = 0; t < mpm->contact.cell_pair_count; t++) {
    const mpsi_cell_pair *pair = &mpm->contact.cell_pair[t];
    const mps_contact *contact = mpm->contact.handle[pair->body];
    const mpsi_cell_block *cells = &mpm->grid.cells[pair->cells];
    if (!takes_away(contact)) continue;
    count += into_body(mpm, contact, contact->def.depth, cells->begin, cells->end, gone,
                       (uint8_t)(pair->body + 1));
  }
  return count;
}

mps_status mpsi_mpm_clear_bodies(mps_mpm *mpm, const char *function, mps_status status,
                                 bool *cleared) {
  bool wanted = false;
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    wanted = wanted || takes_away(mpm->contact.handle[b]);
  if (!wanted) return status;
  const int64_t count = status == MPS_OK ? mark_inside(mpm) : 0;
  double any = (double)count;
  if (mpm->partition)
    status = mpsi_domain_agree_max(mpm->partition->domain, function, status, 1, &any);
  if (status != MPS_OK || any == 0.0) return status;
  for (int32_t b = 0; b < mpm->contact.bodies && status == MPS_OK; b++)
    if (takes_away(mpm->contact.handle[b]))
      status =
          count_out(mpm, function, mpm->contact.handle[b], mpm->rooms.gone.item, (uint8_t)(b + 1));
  if (status == MPS_OK && count > 0) mpsi_particles_take_out(mpm->particles, mpm->rooms.gone.item);
  *cleared = status == MPS_OK;
  return status;
}

mps_status mpsi_mpm_clear_body(mps_mpm *mpm, const char *function, mps_contact *contact) {
  if (!takes_away(contact)) return MPS_OK;
  uint8_t *gone = mpsi_alloc(mpm->context, mpm->p.count, 1);
  mps_status status = MPS_OK;
  if (!gone) status = mpsi_fail_memory(mpm->context, function, (size_t)mpm->p.count);
  status = mpsi_mpm_agree(mpm, function, status);
  int64_t count = 0;
  if (status == MPS_OK) {
    count = into_body(mpm, contact, 0.0, 0, mpm->p.count, gone, 1);
    status = count_out(mpm, function, contact, gone, 1);
  }
  if (status == MPS_OK && count > 0) mpsi_particles_take_out(mpm->particles, gone);
  mpsi_free(mpm->context, gone);
  return status;
}
