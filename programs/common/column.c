/* column.c - the paper's soil column on the public API.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "column.h"

#include "parts.h"

#include <math.h>
#include <stdlib.h>

/* ---- particles ------------------------------------------------------------------------------- */

static mps_status fill(const column *c) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {c->width, c->height};
  if (!c->def.sloped) return mps_particles_fill_box(c->particles, lo, hi, NULL);
  const double *s = c->def.slope;
  const double corners[] = {0.0,  0.0,  c->width, 0.0,       c->width, s[2],
                            s[1], s[2], s[0],     c->height, 0.0,      c->height};
  return mps_particles_fill_polygon(c->particles, 6, corners, NULL);
}

/* The ground of the row of particles at height y: a layer that lies within it counts too. */
static layer ground_of(const column *c, double y) {
  const double depth = c->height - y, half = 0.5 * c->spacing;
  return layers_mean(c->def.ground, depth - half, depth + half);
}

/* Dashpots are at the centres of the lowest row, and the half space begins half a spacing below, at
 * its face. Above an open base that row stands for the face, 1.5 D below the second one. Of its own
 * mass it keeps 2/3, which has the same first moment about the face, and the second row takes the
 * rest. Its mu (SOFT) and lambda, with 4/5 of lambda in the second row, are such that a uniform
 * stress strains the two spans above it as 1.5 D and D of ground, on the lattice of re = 1.5 D. */
static layer open_ground(const column *c, double y) {
  const double SOFT = 0.3839154; /* with the row's spins, which have neighbours on one side */
  layer l = ground_of(c, y);
  const double s2 = l.vs * l.vs, lambda = l.vp * l.vp - 2.0 * s2; /* over the density */
  if (y < c->spacing) {
    const double pair = 2.0 * SOFT / (1.0 + SOFT);
    const double below = 4.0 / 3.0 * lambda + 16.0 / 3.0 * (1.0 - 1.5 * pair) * s2;
    l.unit_weight *= 2.0 / 3.0;
    l.vs = sqrt(1.5 * SOFT * s2);
    l.vp = sqrt(1.5 * (below + 2.0 * SOFT * s2));
  } else if (y < 2.0 * c->spacing) {
    const double own = l.unit_weight;
    l.unit_weight += ground_of(c, y - c->spacing).unit_weight / 3.0;
    l.vs = sqrt(own / l.unit_weight * s2);
    l.vp = sqrt(own / l.unit_weight * (0.8 * lambda + 2.0 * s2));
  }
  return l;
}

static mps_status set_materials(const column *c) {
  static const char *const names[] = {"density", "shear_velocity", "pressure_velocity", "damping"};
  mps_view position;
  mps_edit field[4];
  for (int k = 0; k < 4; k++) {
    const mps_status status = mps_particles_add_field(c->particles, names[k], 0);
    if (status != MPS_OK) return status;
  }
  mps_status status = mps_particles_view(c->particles, "position", &position);
  for (int k = 0; k < 4 && status == MPS_OK; k++)
    status = mps_particles_edit(c->particles, names[k], &field[k]);
  for (int64_t i = 0; i < position.shape[0] && status == MPS_OK; i++) {
    const double y = *mps_view_f64(&position, i, 1);
    const layer l = c->def.open ? open_ground(c, y) : ground_of(c, y);
    *mps_edit_f64(&field[0], i, 0) = layers_density(&l);
    *mps_edit_f64(&field[1], i, 0) = l.vs;
    *mps_edit_f64(&field[2], i, 0) = l.vp;
    *mps_edit_f64(&field[3], i, 0) = l.damping;
  }
  for (int k = 0; k < 4 && status == MPS_OK; k++)
    status = mps_particles_commit(c->particles, &field[k]);
  return status;
}

mps_status column_create(mps_context *context, const column_def *def, column *out) {
  const double d = 2.0 * def->radius;
  *out = (column){.def = *def, .context = context, .spacing = d};
  out->nx = (int64_t)round(def->width / d);
  out->ny = (int64_t)round(def->height / d);
  out->width = (double)out->nx * d;
  out->height = (double)out->ny * d;
  mps_particles_def particles = mps_particles_defaults();
  particles.spacing = d;
  mps_status status = parts_create(context, def->domain, &particles, &out->particles);
  if (status == MPS_OK) status = fill(out);
  if (status == MPS_OK) status = set_materials(out);
  if (status != MPS_OK) column_destroy(out);
  return status;
}

void column_destroy(column *c) { mps_particles_destroy(&c->particles); }

double column_surface(const column *c, double x) {
  const double *s = c->def.slope;
  if (!c->def.sloped || x <= s[0]) return c->height;
  if (x >= s[1]) return s[2];
  return c->height + (s[2] - c->height) * (x - s[0]) / (s[1] - s[0]);
}

double column_level(const column *c, double y) { return c->def.open && y < c->spacing ? 0.0 : y; }

/* ---- boundaries ------------------------------------------------------------------------------ */

int32_t column_component(char wave) { return wave == 'S' ? 0 : 1; }

/* The degree of freedom across the wave, which rollers constrain. */
static uint32_t across(char wave) { return wave == 'S' ? MPS_DOF_Y : MPS_DOF_X; }

/* Adds a boundary on the particles between x0 and x1 and below y1. */
static mps_status add(mps_dynamics *dynamics, mps_dynamics_boundary_def *def, double x0, double x1,
                      double y1) {
  int32_t number;
  def->lower[0] = x0, def->lower[1] = -INFINITY;
  def->upper[0] = x1, def->upper[1] = y1;
  return mps_dynamics_add_boundary(dynamics, def, &number);
}

mps_status column_hold_sides(const column *c, mps_dynamics *dynamics, char wave) {
  mps_dynamics_boundary_def def = mps_dynamics_boundary_defaults();
  def.dofs = across(wave);
  mps_status status = add(dynamics, &def, -INFINITY, c->spacing, INFINITY);
  if (status == MPS_OK) status = add(dynamics, &def, c->width - c->spacing, INFINITY, INFINITY);
  return status;
}

/* The base is the bottom row, with that of the free-field columns beside. */
mps_status column_drive_base(const column *c, mps_dynamics *dynamics, char wave,
                             mps_signal *signal) {
  mps_dynamics_boundary_def def = mps_dynamics_boundary_defaults();
  def.kind = MPS_BOUNDARY_DRIVEN;
  def.dofs = across(wave);
  def.signal[column_component(wave)] = signal;
  return add(dynamics, &def, -INFINITY, INFINITY, c->spacing);
}

mps_status column_viscous_base(const column *c, mps_dynamics *dynamics, char wave,
                               mps_signal *signal, const layer *half_space) {
  mps_dynamics_boundary_def def = mps_dynamics_boundary_defaults();
  def.kind = MPS_BOUNDARY_ABSORBING;
  def.density = layers_density(half_space);
  def.shear_velocity = half_space->vs;
  def.pressure_velocity = half_space->vp;
  def.signal[column_component(wave)] = signal;
  return add(dynamics, &def, -INFINITY, INFINITY, c->spacing);
}
