/* model.c - soil at rest under its own weight, and the pile above it (Nakamura, Figure 22).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pile.h"

#include <mps/mpm.h>

#include <math.h>
#include <stdlib.h>

#define FOOT 0.5    /* of the wall's thickness */
#define CHATTER 6.0 /* over m/dt^2: a stiffer contact throws particles back and forth */

/* ---- settings -------------------------------------------------------------------------------- */

static const struct {
  mps_material_cone cone;
  const char *name;
} cones[] = {{MPS_MATERIAL_CONE_INSCRIBED, "inscribed"},
             {MPS_MATERIAL_CONE_CIRCUMSCRIBED, "circumscribed"},
             {MPS_MATERIAL_CONE_PLANE_STRAIN, "planestrain"}};

mps_material_cone pile_cone(const pile_settings *s) { return cones[s->cone].cone; }
const char *pile_cone_name(const pile_settings *s) { return cones[s->cone].name; }

const char *pile_check(pile_settings *s) {
  double *const sides[] = {&s->width, &s->height};
  if (!options_lengths(s->soil, "m", 2, sides))
    return "--soil must be two lengths in m, WxH, such as 0.4x3";
  options_whole("soil", &s->width, "--cell", s->h);
  options_whole("soil", &s->height, "--cell", s->h);
  if (s->contact == MPS_CONTACT_METHOD_PENALTY && s->wall < s->h * (2.0 - 1e-9))
    return "--wall-thickness must be at least 2 cells of --cell by --contact penalty: particles on "
           "both its "
           "sides would share nodes";
  if (s->inner_diameter < 4.0 * s->h) return "--inner-diameter must be at least 4 cells of --cell";
  if (0.5 * s->inner_diameter + s->wall > s->width - 4.0 * s->h)
    return "--soil must be at least 4 cells of --cell wider than the pile's radius";
  if (s->depth > s->height - 4.0 * s->h)
    return "--depth must end 4 cells of --cell above the bottom of the soil";
  const char *large = mpm_model_too_large(s->width * s->height / (s->h * s->h) * (double)s->ppc);
  if (large) return large;
  const double modulus =
      s->young * (1.0 - s->poisson) / ((1.0 + s->poisson) * (1.0 - 2.0 * s->poisson));
  if (s->k > CHATTER * modulus / ((double)s->ppc * s->courant * s->courant))
    return "--k must be at most 6 (K + 4G/3)/(ppc courant^2), 6 m/dt^2: stiffer contact chatters";
  if (s->psi > s->phi) return "--psi must be at most --phi";
  if (sand_check(&s->voids)) return sand_check(&s->voids);
  if (s->density * PILE_GRAVITY * s->height > 0.5 * s->young)
    return "--young must be at least twice the stress at the bottom of the soil, density g height";
  return NULL;
}

/* ---- soil ------------------------------------------------------------------------------------ */

static mps_status make_soil(mps_context *context, pile *p) {
  const pile_settings *s = &p->s;
  const double lo[2] = {0.0, 0.0}, hi[2] = {s->width, s->height};
  const push_sand sand = {.young = s->young,
                          .poisson = s->poisson,
                          .phi = s->phi,
                          .psi = s->psi,
                          .cohesion = s->cohesion,
                          .voids = s->voids,
                          .cone = pile_cone(s)};
  mps_particles_def set = mps_particles_defaults();
  set.spacing = s->h / sqrt((double)s->ppc);
  p->k0 = isnan(s->k0) ? s->poisson / (1.0 - s->poisson) : s->k0;
  mps_status status = mpm_model_particles(&p->m, context, &set);
  if (status == MPS_OK) status = mps_particles_fill_box(p->m.particles, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(p->m.particles, "density", 0, s->density);
  if (status == MPS_OK) status = push_set_stress(&p->push, PILE_GRAVITY, p->k0, s->height, 0.0);
  return status == MPS_OK ? push_make_sand(context, &sand, &p->m.material) : status;
}

/* ---- pile ------------------------------------------------------------------------------------ */

/* The section of the wall, its tip at the body's own z = 0; driven at constant speed. The tip's
 * part goes up both faces by FOOT of the wall, at least a cell: particles on either side of a
 * corner share their nodes, so that tip and face may exert opposite forces of any size there. */
static mps_status make_pile(mps_context *context, pile *p) {
  const pile_settings *s = &p->s;
  const double length = 2.0 * s->depth + 2.0 * p->outer; /* beyond all soil that it may lift */
  const double foot = FOOT * s->wall;
  const double corner[12] = {p->inner, foot, p->inner, 0.0,    p->outer, 0.0,
                             p->outer, foot, p->outer, length, p->inner, length};
  static const struct {
    const char *name;
    int64_t edge, edges;
  } part[PUSH_PARTS] = {{"tip", 0, 3}, {"inside", 5, 1}, {"outside", 3, 1}};
  const double t[] = {p->t_start, p->t_end + 1.0}, v[] = {s->rate, s->rate};
  mps_signal *down = NULL;
  mps_body_def def = mps_body_defaults();
  def.position[1] = s->height + s->h;
  mps_status status =
      mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, t, v, &down);
  if (status == MPS_OK) status = mps_body_create_polygon(context, &def, 6, corner, &p->m.body[0]);
  for (int k = 0; k < PUSH_PARTS && status == MPS_OK; k++)
    status = mps_body_name_part(p->m.body[0], part[k].name, part[k].edge, part[k].edges, NULL);
  if (status == MPS_OK) status = mps_body_drive(p->m.body[0], 1, down, -1.0);
  mps_signal_destroy(&down);
  return status;
}

/* Contact stiffness (N/m per unit thickness). Nakamura (58) with the particle's mass and the step
 * as they are at the start gives k = (1 - xi) 2 m/dt^2, 0.8 of K + 4G/3 with the paper's xi: the
 * overlap reaches d0, and sand enters the wall, where the pressure below the tip is half of k. */
static double penalty_of(const pile *p) {
  const pile_settings *s = &p->s;
  const double spacing = mps_particles_spacing(p->m.particles);
  if (!isnan(s->k)) return s->k;
  if (isnan(s->xi)) return push_penalty(&p->push);
  return 2.0 * (1.0 - s->xi) * s->density * spacing * spacing / (p->dt * p->dt);
}

static mps_status add_contact(pile *p) {
  const pile_settings *s = &p->s;
  mps_contact_def contact = mps_contact_defaults();
  p->penalty = penalty_of(p);
  contact.friction = s->friction;
  return push_add_contact(&p->push, s->contact, s->corner, s->inset, p->penalty, &contact);
}

static void pass(void *user, resume_bytes *b) {
  pile *p = user;
  push_pass(&p->push, b);
  if (b->status == MPS_OK) pile_pass_frames(p, b);
}

static void prepare(pile *p) {
  const pile_settings *s = &p->s;
  p->inner = 0.5 * s->inner_diameter, p->outer = p->inner + s->wall;
  p->t_start = s->rest, p->t_end = s->rest + (s->h + s->depth) / s->rate;
  p->stride = s->h / PILE_ROWS;
  p->push = (push){.m = &p->m,
                   .part = {"tip", "inside", "outside"},
                   .ground = s->height,
                   .lower = p->inner,
                   .upper = p->outer,
                   .density = s->density,
                   .cell = s->h,
                   .factor = 1.0};
  p->course = mpm_course_of(&s->course, &p->m, s->out, "mps-pile 5", pass, p);
  p->course.what = "pile";
  p->course.duration = p->t_end;
}

mps_status pile_build(mps_context *context, void *user) {
  pile *p = user;
  const pile_settings *s = &p->s;
  prepare(p);
  mps_status status = mpm_course_peek(&p->course, context);
  if (status == MPS_OK) status = make_soil(context, p);
  mps_mpm_def def = mps_mpm_defaults();
  def.geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC;
  def.cell = s->h;
  def.spline = s->spline + 2;
  def.courant = s->courant;
  def.flip_time = s->flip_time;
  def.volumetric = s->volumetric;
  mpm_method_define(&s->method, &def);
  def.lower[0] = def.lower[1] = 0.0;
  def.upper[0] = s->width;
  def.gravity[1] = -PILE_GRAVITY;
  if (status == MPS_OK) status = make_pile(context, p);
  status = mpm_model_create(&p->m, context, status, &def);
  status = mpm_method_choose(&s->method, p->m.mpm, status);
  p->particles = mps_particles_count(p->m.particles);
  if (status == MPS_OK) status = mpm_model_sum(&p->m, &p->particles);
  if (status != MPS_OK) return status;
  p->dt = mps_mpm_dt(p->m.mpm);
  status = push_begin(&p->push, (int64_t)((s->depth + s->h) / p->stride) + 2, p->particles);
  status = app_settle(p->m.a, status);
  if (status == MPS_OK) status = add_contact(p);
  return status == MPS_OK ? mpm_course_begin(&p->course, context, true) : status;
}

void pile_free(pile *p) {
  pile_free_frames(p);
  push_free(&p->push);
}
