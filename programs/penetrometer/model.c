/* model.c - the box of soil, the solver, and the tip above the ground or in it.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "penetrometer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define START 4.0   /* diameters */
#define INDEX 100.0 /* G/su */
#define RATE 0.25   /* m/s */
#define SLOW 0.0114 /* of the velocity of shear waves, */
#define FALLS 0.253 /* of (g D)^1/2 */

/* ---- settings -------------------------------------------------------------------------------- */

double pen_radius(const penetrometer *p) { return 0.5 * p->s.diameter; }

double pen_shoulder(const penetrometer *p) {
  return pen_radius(p) / tan(0.5 * p->s.angle * PUSH_PI / 180.0);
}

double pen_gap(const penetrometer *p) {
  return p->s.start > 0.0 ? 0.0 : fmin(0.5 * p->s.h, 0.2 * p->s.depth);
}

double pen_path(const penetrometer *p) { return pen_gap(p) + p->s.depth - p->s.start; }

int pen_up(const pen_run *r) { return r->geometry == MPS_MPM_GEOMETRY_SPACE ? 2 : 1; }

/* s: the speed rises over it, so that the ground around the tip is not hit. */
static double ramp_of(const penetrometer *p) {
  return p->s.start > 0.0 ? 0.1 * pen_path(p) / p->s.rate : 0.0;
}

/* m: radius of the tip's part below the surface at the end. */
static double radius_below(const pen_settings *s) {
  const double R = 0.5 * s->diameter, d = fmin(s->depth, R);
  return s->tip == PEN_SPHERE ? sqrt(d * (2.0 * R - d)) : R;
}

static const char *check_tip(const pen_settings *s) {
  if ((s->tip == PEN_STL) != (s->mesh != NULL)) return "--tip stl and --mesh belong together";
  if (s->tip == PEN_STL && (s->model == PEN_AXIAL || s->both))
    return "--symmetry axial and --also-axisymmetric are for --tip cone and sphere";
  if (s->model == PEN_AXIAL && s->both)
    return "--symmetry axial and --also-axisymmetric exclude each other";
  if (s->diameter < s->h * (4.0 - 1e-9)) return "--diameter must be at least 4 cells of --cell";
  return NULL;
}

/* The same part of the velocity of shear waves in all softer clay, and of (g D)^1/2 in sand around
 * thinner tips: inertia counts by that. */
static double rate_of(const pen_settings *s) {
  const double waves = sqrt(0.5 * s->young / (1.0 + s->poisson) / s->density);
  if (s->law == PEN_CLAY || s->law == PEN_TRESCA) return fmin(RATE, SLOW * waves);
  const bool heavy = s->law == PEN_SAND && s->gravity > 0.0;
  return heavy ? fmin(RATE, FALLS * sqrt(s->gravity * s->diameter)) : RATE;
}

/* Where soil flows around the tip, what transfers take from it in each step would be a part of the
 * resistance that grows with the speed and the cell: docs/theory/transfers.md. The steps of ground
 * with undrained water are a quarter as long, so that the same time would keep more noise. */
static double flip_time_of(const pen_settings *s) {
  const double share = s->law == PEN_CAM_CLAY ? 160.0 : 40.0;
  return s->law == PEN_ELASTIC ? 0.0 : s->diameter / (share * s->rate);
}

/* 0.75 cells: with it cones of 30 to 150 degrees change least from grid to grid
 * (docs/verification/textbook.md). */
static const char *settle_edges(pen_settings *s, const option *table) {
  const double usual = s->model == PEN_AXIAL && s->law != PEN_ELASTIC ? 0.75 : 0.0;
  if (s->inset > 0.0 && s->model != PEN_AXIAL) return "--inset is for --symmetry axial";
  return mpm_model_settle_edges(table, s->contact, usual, &s->corner, &s->inset);
}

/* Without a place of its own the cone is deep in clay without stress, where its resistance is
 * known: it begins in a hole of START diameters, far from all sides. */
static void choose_place(pen_settings *s, const option *table) {
  const bool placed = options_given(table, "depth") || options_given(table, "start") ||
                      options_given(table, "soil") || s->surcharge > 0.0 || s->gravity > 0.0;
  const bool space = s->tip == PEN_STL || s->both;
  if (space && !options_given(table, "symmetry")) s->model = PEN_QUARTER;
  const bool deep = !placed && s->model == PEN_AXIAL && s->tip == PEN_CONE &&
                    (s->law == PEN_CLAY || s->law == PEN_TRESCA);
  const double D = s->diameter;
  if (deep) s->start = START * D;
  if (deep && !options_given(table, "sides")) s->sides = PEN_FREE;
  if (deep && isnan(s->ir) && !options_given(table, "young")) s->ir = INDEX;
  if (isnan(s->depth)) s->depth = deep ? (START + 1.7) * D : 1.5 * D;
  s->width = s->breadth = (deep ? 12.0 : 6.0) * D, s->height = (deep ? 9.0 : 4.0) * D;
}

const char *pen_check(penetrometer *p, const option *table) {
  pen_settings *s = &p->s;
  choose_place(s, table);
  const char *reason = check_tip(s);
  if (!reason) reason = settle_edges(s, table);
  if (reason) return reason;
  double *const sides[] = {&s->width, &s->breadth, &s->height};
  if (s->soil && !options_lengths(s->soil, "m", 3, sides))
    return "--soil must be three lengths in m, WxWxH, such as 0.6x0.6x0.4";
  for (int k = 0; k < 3 && s->soil; k++) /* half of it is, in a quarter */
    options_whole("soil", sides[k], k < 2 ? "2 cells" : "--cell", k < 2 ? 2.0 * s->h : s->h);
  if (fmin(s->width, s->breadth) < 2.0 * radius_below(s) + (8.0 - 1e-9) * s->h)
    return "--soil must be at least 8 cells of --cell wider than what is pushed in";
  if (s->depth > s->height - (4.0 - 1e-9) * s->h)
    return "--depth must end 4 cells of --cell above the bottom of the soil";
  const double cells = s->width * s->breadth * s->height / (s->h * s->h * s->h);
  const char *large = mpm_model_too_large(cells * (double)s->ppc);
  if (large && s->model != PEN_AXIAL) return large;
  const double edge = nearbyint(cbrt((double)s->ppc));
  if (edge * edge * edge != (double)s->ppc) return "--ppc must be a cube: 1, 8, 27 or 64";
  if (s->psi > s->phi) return "--psi must be at most --phi";
  if (isnan(s->e0)) s->e0 = s->law == PEN_SAND ? SAND_E0 : 1.4;
  if (s->law == PEN_SAND && s->e0 > s->e_max) return "--emax must be at least --e0";
  reason = pen_check_soil(p, table);
  if (reason) return reason;
  if (isnan(s->rate)) s->rate = rate_of(s);
  if (isnan(s->flip_time)) s->flip_time = flip_time_of(s);
  if (s->alpha > 0.0 && s->contact == MPS_CONTACT_METHOD_PENALTY)
    return "--adhesion asks for --contact impulse";
  if (s->alpha > 0.0 && s->cohesion == 0.0) return "--adhesion asks for a --cohesion > 0";
  p->stride = fmin(0.2 * s->h, (s->depth - s->start) / 200.0);
  p->hold = pen_vertical(p, s->start) > 0.0 ? ramp_of(p) : 0.0;
  p->t_end = p->hold + pen_path(p) / s->rate + 0.5 * ramp_of(p);
  p->runs = s->both ? 2 : 1;
  p->run[0].geometry =
      s->model == PEN_AXIAL ? MPS_MPM_GEOMETRY_AXISYMMETRIC : MPS_MPM_GEOMETRY_SPACE;
  p->run[1].geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC;
  return NULL;
}

/* ---- soil ------------------------------------------------------------------------------------ */

/* Whole cells; in axisymmetry a cylinder with the section of the box. */
static void find_size(const penetrometer *p, pen_run *r) {
  const pen_settings *s = &p->s;
  const double asked[3] = {0.5 * s->width, 0.5 * s->breadth, s->height};
  for (int c = 0; c < 3; c++) r->size[c] = s->h * ceil(asked[c] / s->h - 1e-6);
  r->push.factor = s->model == PEN_QUARTER ? 4.0 : 1.0;
  if (r->geometry == MPS_MPM_GEOMETRY_SPACE) return;
  r->size[0] = s->h * nearbyint(sqrt(4.0 * r->size[0] * r->size[1] / PUSH_PI) / s->h);
  r->size[1] = r->size[2];
  r->push.factor = 1.0;
}

/* Lower end of the box across axis c: on the axis where the model is cut there. */
static double lower_of(const penetrometer *p, const pen_run *r, int c) {
  const bool whole = r->geometry == MPS_MPM_GEOMETRY_SPACE && p->s.model == PEN_WHOLE;
  return whole && c < 2 ? -r->size[c] : 0.0;
}

/* Cam-Clay whose pores are full of water hardly changes its volume around a tip: with each
 * particle's own change it would lock, as clay does, and particles beside the tip swell and shrink
 * by tenths. */
static int32_t volumetric_of(const pen_settings *s) {
  const bool by_law = s->volumetric == MPS_MPM_VOLUMETRIC_BY_LAW;
  return by_law && s->law == PEN_CAM_CLAY ? MPS_MPM_VOLUMETRIC_CELL : s->volumetric;
}

/* After `status`, that of the rank's own objects. */
static mps_status make_solver(penetrometer *p, pen_run *r, mps_status status) {
  const pen_settings *s = &p->s;
  const int up = pen_up(r);
  mps_mpm_def def = mps_mpm_defaults();
  def.geometry = r->geometry;
  def.cell = s->h;
  def.spline = s->spline + 2;
  def.volumetric = volumetric_of(s);
  def.courant = s->courant;
  def.flip_time = s->flip_time;
  for (int c = 0; c <= up; c++) {
    def.lower[c] = lower_of(p, r, c);
    if (c == up) continue;
    if (s->sides == PEN_ROLLERS)
      def.upper[c] = r->size[c];
    else if (def.lower[c] < 0.0)
      def.lower[c] = -INFINITY; /* no mirror but at the axis */
  }
  def.gravity[up] = -s->gravity;
  status = mpm_model_create(&r->m, p->context, status, &def);
  if (status != MPS_OK) return status;
  return mps_mpm_set_side(r->m.mpm, 2 * up, MPS_BOUNDARY_HELD, 0.0);
}

/* ---- tip ------------------------------------------------------------------------------------- */

/* The cone's apex is the reference point. Corners belong to the tip: its face comes first. In the
 * plane of axisymmetry the section is whole, so that no edge lies on the axis. */
static mps_status make_cone(penetrometer *p, const pen_run *r, const mps_body_def *def,
                            mps_body **out) {
  const double R = pen_radius(p), z = pen_shoulder(p), L = 2.0 * (p->s.depth + p->s.diameter) + z;
  const double half[8] = {0.0, 0.0, R, z, R, L, 0.0, L};
  const double whole[10] = {0.0, 0.0, R, z, R, L, -R, L, -R, z};
  mps_status status = r->geometry == MPS_MPM_GEOMETRY_SPACE
                          ? mps_body_create_revolution(p->context, def, 4, half, out)
                          : mps_body_create_polygon(p->context, def, 5, whole, out);
  if (status == MPS_OK) status = mps_body_name_part(*out, "tip", 0, 1, NULL);
  return status == MPS_OK ? mps_body_name_part(*out, "shaft", 1, 1, NULL) : status;
}

static mps_status make_sphere(penetrometer *p, const pen_run *r, mps_body_def *def,
                              mps_body **out) {
  def->position[pen_up(r)] += pen_radius(p);
  const mps_status status = r->geometry == MPS_MPM_GEOMETRY_SPACE
                                ? mps_body_create_sphere(p->context, def, pen_radius(p), out)
                                : mps_body_create_disc(p->context, def, pen_radius(p), out);
  return status == MPS_OK ? mps_body_name_part(*out, "tip", 0, 1, NULL) : status;
}

/* Extent of the mesh from its origin along an axis (m): from a distance L, where the error is of
 * (extent/L)^2. */
static mps_status find_extent(const pen_run *r, int axis, double sign, double *extent) {
  const double L = 1e3 * (r->size[0] + r->size[1] + r->size[2]);
  mps_body_state state;
  double distance = 0.0;
  mps_status status = mps_body_get_state(r->m.body[0], &state);
  double at[3] = {state.position[0], state.position[1], state.position[2]};
  at[axis] += sign * L;
  if (status == MPS_OK)
    status = mps_body_distance(r->m.body[0], 1, at, &distance, NULL, NULL, NULL);
  *extent = L - distance;
  return status;
}

static mps_status check_mesh(const penetrometer *p, pen_run *r) {
  double across = 0.0, wide = -INFINITY, below = 0.0;
  mps_status status = find_extent(r, 2, -1.0, &below);
  for (int k = 0; k < 4 && status == MPS_OK; k++) {
    double extent = 0.0;
    status = find_extent(r, k / 2, k % 2 ? 1.0 : -1.0, &extent);
    across = fmax(across, 2.0 * extent);
    wide = fmax(wide, extent - r->size[k / 2]);
  }
  if (status != MPS_OK) return status;
  if (across < 3.9 * p->s.h)
    snprintf(r->m.why, sizeof r->m.why,
             "the mesh is %.3g m wide with --scale %g, must be at least 4 cells of --cell: %g m",
             across, p->s.scale, 4.0 * p->s.h);
  else if (wide > -2.0 * p->s.h)
    snprintf(r->m.why, sizeof r->m.why,
             "the mesh is %.3g m wide with --scale %g, the soil of %g m x %g m must be at least 4 "
             "cells of --cell wider",
             across, p->s.scale, 2.0 * r->size[0], 2.0 * r->size[1]);
  else if (fabs(below) > p->s.h)
    snprintf(r->m.why, sizeof r->m.why,
             "the lowest point of the mesh is %.3g m below its origin, must be at it", below);
  return r->m.why[0] ? MPS_ERROR_ARGUMENT : MPS_OK;
}

static mps_status make_tip(penetrometer *p, pen_run *r) {
  const int up = pen_up(r);
  const double ramp = ramp_of(p), rate = p->s.rate, full = p->hold + ramp;
  const double t[] = {0.0, p->hold, full > 0.0 ? full : p->t_end, p->t_end + 1.0};
  const double v[] = {ramp > 0.0 ? 0.0 : rate, ramp > 0.0 ? 0.0 : rate, rate, rate};
  const int skip = p->hold > 0.0 ? 0 : 1; /* times rise */
  mps_signal *down = NULL;
  mps_body **body = &r->m.body[0];
  mps_body_def def = mps_body_defaults();
  def.position[up] = r->size[up] + pen_gap(p) - p->s.start;
  mps_status status = mps_signal_create_table(p->context, MPS_SIGNAL_QUANTITY_VELOCITY, 4 - skip,
                                              t + skip, v + skip, &down);
  if (status == MPS_OK && p->s.tip == PEN_CONE) status = make_cone(p, r, &def, body);
  if (status == MPS_OK && p->s.tip == PEN_SPHERE) status = make_sphere(p, r, &def, body);
  if (status == MPS_OK && p->s.tip == PEN_STL)
    status = mps_body_create_stl(p->context, &def, p->s.mesh, p->s.scale, body);
  if (status == MPS_OK && p->s.tip == PEN_STL) status = check_mesh(p, r);
  if (status == MPS_OK) status = mps_body_drive(*body, up, down, -1.0);
  mps_signal_destroy(&down);
  return status;
}

static mps_status add_contact(const penetrometer *p, pen_run *r) {
  const pen_settings *s = &p->s;
  mps_contact_def contact = mps_contact_defaults();
  contact.friction = s->friction;
  if (s->alpha > 0.0) contact.strength = s->alpha * s->cohesion;
  r->penalty = push_penalty(&r->push);
  return push_add_contact(&r->push, s->contact, s->corner, s->inset, r->penalty, &contact);
}

/* ---- all ------------------------------------------------------------------------------------- */

static mps_status make_room(const penetrometer *p, pen_run *r) {
  const double R = pen_radius(p);
  push *now = &r->push;
  now->m = &r->m, now->density = p->s.density, now->cell = p->s.h;
  now->part[PEN_TIP] = "tip", now->part[PEN_SHAFT] = "shaft";
  now->ground = r->size[pen_up(r)];
  now->above = p->s.tip == PEN_SPHERE ? R : 0.0;
  now->upper = p->s.tip == PEN_STL ? INFINITY : R;
  r->point = calloc((size_t)r->particles, sizeof *r->point);
  if (!r->point) return MPS_ERROR_MEMORY;
  return push_begin(now, (int64_t)(pen_path(p) / p->stride) + 2, r->particles);
}

/* The history of the first run; one about the axis that may follow it is short, and is repeated. */
static void pass(void *user, resume_bytes *b) {
  pen_run *r = &((penetrometer *)user)->run[0];
  push_pass(&r->push, b);
  resume_pass(b, &r->rest, sizeof r->rest);
}

static void name_course(penetrometer *p) {
  pen_run *r = &p->run[p->now];
  static mpm_course_options frames_only;
  frames_only.frames = p->s.course.frames;
  p->course = mpm_course_of(p->now == 0 ? &p->s.course : &frames_only, &r->m, p->s.out,
                            "mps-penetrometer 3", pass, p);
  p->course.what = p->now == 0 ? "penetration" : "penetration-axisymmetric";
  p->course.duration = p->t_end;
}

mps_status pen_build_run(penetrometer *p, bool restores) {
  pen_run *r = &p->run[p->now];
  name_course(p);
  find_size(p, r);
  double lower[3];
  for (int c = 0; c < 3; c++) lower[c] = lower_of(p, r, c);
  mps_status status = pen_make_soil(p, r, lower);
  if (status == MPS_OK) status = make_tip(p, r);
  if (status == MPS_OK) status = make_room(p, r);
  status = make_solver(p, r, status);
  if (status == MPS_OK) status = pen_load_soil(p, r);
  if (status == MPS_OK) status = add_contact(p, r);
  if (status == MPS_OK) r->dt = mps_mpm_dt(r->m.mpm);
  p->stride = fmax(p->stride, 1.25 * p->s.rate * r->dt); /* a step at least, or rows would lack */
  return status == MPS_OK ? mpm_course_begin(&p->course, p->context, restores) : status;
}

mps_status pen_build(mps_context *context, void *user) {
  penetrometer *p = user;
  p->context = context;
  p->run[1].m.a = p->run[0].m.a;
  name_course(p);
  const mps_status status = mpm_course_peek(&p->course, context);
  return status == MPS_OK ? pen_build_run(p, true) : status;
}

void pen_free(penetrometer *p) {
  for (int k = 0; k < 2; k++) {
    push_free(&p->run[k].push);
    free(p->run[k].point);
  }
}
