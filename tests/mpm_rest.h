/* mpm_rest.h - ground that starts at rest beside edges of every kind: a block of elastic ground
 * under its weight with the stress K0 sigma_v across, between smooth walls, on a smooth floor,
 * whose grid is shifted by a part of a cell and, but at sides of the domain, turned. That stress
 * balances the weight at each smooth vertical or level face, so nothing may move and no force may
 * drift. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MPM_REST_H
#define MPS_TEST_MPM_REST_H

#include "mpm_scene.h"

#define REST_CELL 0.02 /* m */
#define REST_YOUNG 1e6
#define REST_K0 (0.3 / 0.7)
#define REST_DENSITY 2000.0
#define REST_GRAVITY 10.0
enum { REST_COLUMNS = 24, REST_ROWS = 20 }; /* of particles, two a cell */

typedef enum rest_edge {
  REST_WALLS,      /* half planes */
  REST_PLATE,      /* a plate of half a cell from above the ground to the floor */
  REST_FINE_PLATE, /* of a tenth of a cell */
  REST_WIDE_PLATE, /* of 1.5 cells */
  REST_TIP,        /* a plate of one column of particles that ends at half the depth */
  REST_BOX,        /* a box of 3 x 4 cells on the floor, all its corners but two in the ground */
  REST_ROLLER,     /* sides of the domain: floor and left wall */
  REST_FRICTIONAL, /* the same, rough, below a free side */
  REST_FIT,        /* rollers with fitted weights */
  REST_EDGES
} rest_edge;

static const char *const rest_names[] = {"walls",      "plate",       "fine plate",
                                         "wide plate", "plate's tip", "box",
                                         "rollers",    "rough sides", "fitted sides"};

typedef struct rest_case {
  rest_edge edge;
  int32_t spline;
  double shift; /* of the grid, cells */
  double angle; /* by which the ground is turned against the grid, rad */
  double inset; /* of the body in the ground, cells */
} rest_case;

/* Relative deviations from theory, of the mean over the last steps. */
typedef struct rest_result {
  double wall[2], floor, body; /* forces; body: along the ground's y, of a box or tip */
  double across, along;        /* mean stresses over the initial ones, less 1 */
  double kinetic;              /* over the elastic energy at the start */
} rest_result;

typedef struct rest_scene {
  mpm_scene s;
  const rest_case *c;
  double dx, width, height, gap; /* m; gap: thickness of a plate */
  double row[REST_ROWS + 1];     /* m, the levels between rows from the floor up */
  double removed;                /* m2 of ground that a box or tip replaces */
  double turn[2];                /* cos, sin */
  mps_body *body[4];             /* floor, left, right, in the ground */
} rest_scene;

static inline bool rest_at_sides(const rest_case *c) { return c->edge >= REST_ROLLER; }

static inline bool rest_is_plate(const rest_case *c) {
  return c->edge == REST_PLATE || c->edge == REST_FINE_PLATE || c->edge == REST_WIDE_PLATE;
}

/* Whether the floor is a side of the domain, a mirror through which plates continue. */
static inline bool rest_on_side(const rest_case *c) {
  return rest_at_sides(c) || (rest_is_plate(c) && c->angle == 0.0);
}

/* Ground's coordinates, whose y is up, to those of the grid. */
static inline void rest_place(const rest_scene *r, double x, double y, double *out) {
  out[0] = r->turn[0] * x - r->turn[1] * y;
  out[1] = r->turn[1] * x + r->turn[0] * y;
}

/* Row at the plate's tip, rows beside the box and half its width in columns. */
enum { REST_TIP_ROW = 10, REST_BOX_ROWS = 8, REST_BOX_COLUMNS = 3 };

/* Whether the body in the ground stands at the particle's place. */
static inline bool rest_taken(const rest_scene *r, int i, int j) {
  const int from = i - REST_COLUMNS / 2;
  if (r->c->edge == REST_BOX)
    return from >= -REST_BOX_COLUMNS && from < REST_BOX_COLUMNS && j < REST_BOX_ROWS;
  return r->c->edge == REST_TIP && from == 0 && j >= REST_TIP_ROW;
}

/* Rows that the weight above has compressed from `dy`, as the particles' sizes at a body say. */
static inline void rest_levels(rest_scene *r, double dy) {
  const double M = REST_YOUNG * 0.7 / (1.3 * 0.4), by = REST_DENSITY * REST_GRAVITY / M;
  double depth = 0.0;
  for (int j = REST_ROWS; j > 0; j--) {
    r->row[j] = depth;
    depth += dy * (1.0 - by * (depth + 0.5 * dy));
  }
  r->height = depth, r->row[0] = 0.0;
  for (int j = REST_ROWS; j > 0; j--) r->row[j] = depth - r->row[j];
}

static inline void rest_fill(rest_scene *r) {
  for (int j = 0; j < REST_ROWS; j++)
    for (int i = 0; i < REST_COLUMNS; i++) {
      const double x = (i + 0.5) * r->dx, y = 0.5 * (r->row[j] + r->row[j + 1]);
      double at[3] = {0.0};
      if (rest_taken(r, i, j)) continue;
      rest_place(r, x + (i < REST_COLUMNS / 2 ? 0.0 : r->gap), y, at);
      OK(mps_particles_append(r->s.particles, 1, at));
    }
  OK(mps_particles_set(r->s.particles, "density", 0, REST_DENSITY));
  OK(mps_particles_add_field(r->s.particles, "volume", 0));
  OK(mps_particles_add_field(r->s.particles, "stress", 0));
  mps_view x = mpm_scene_view(&r->s, "position");
  mps_edit stress = mpm_scene_edit(&r->s, "stress"), volume = mpm_scene_edit(&r->s, "volume");
  const double c = r->turn[0], s = r->turn[1];
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double y = c * *mps_view_f64(&x, k, 1) - s * *mps_view_f64(&x, k, 0);
    const double up = -REST_DENSITY * REST_GRAVITY * (r->height - y), level = REST_K0 * up;
    *mps_edit_f64(&stress, k, 0) = c * c * level + s * s * up;
    *mps_edit_f64(&stress, k, 1) = s * s * level + c * c * up;
    *mps_edit_f64(&stress, k, 2) = level;
    *mps_edit_f64(&stress, k, 3) = c * s * (level - up);
    int j = 0;
    while (j < REST_ROWS - 1 && r->row[j + 1] < y) j++;
    *mps_edit_f64(&volume, k, 0) = r->dx * (r->row[j + 1] - r->row[j]);
  }
  mpm_scene_commit(&r->s, &volume);
  mpm_scene_commit(&r->s, &stress);
}

static inline void rest_touch(rest_scene *r, mps_body *body, double offset) {
  USING(contact, mps_mpm_add_contact(r->s.mpm, body, &given, NULL), .offset = offset,
        .inset = body == r->body[3] ? r->c->inset * REST_CELL : 0.0);
}

static inline mps_body *rest_half(rest_scene *r, double x, double y, double nx, double ny) {
  double at[3] = {0.0}, normal[3] = {0.0};
  mps_body *body = NULL;
  rest_place(r, x, y, at), rest_place(r, nx, ny, normal);
  DEF(body, def, .position[0] = at[0], .position[1] = at[1]);
  OK(mps_body_create_half_plane(r->s.context, &def, normal, &body));
  return body;
}

/* The box [x0, x1] x [y0, y1] of the ground's coordinates. */
static inline mps_body *rest_box(rest_scene *r, double x0, double x1, double y0, double y1) {
  mps_body_def def = mps_body_defaults();
  double corner[8];
  rest_place(r, x0, y0, corner), rest_place(r, x1, y0, corner + 2);
  rest_place(r, x1, y1, corner + 4), rest_place(r, x0, y1, corner + 6);
  MAKE_KEPT(body, body, create_polygon, r->s.context, &def, 4, corner);
  return body;
}

static inline void rest_add_bodies(rest_scene *r) {
  const double top = r->height + 2.0 * REST_CELL, half = 0.5 * r->width;
  const double low = rest_on_side(r->c) ? -2.0 * REST_CELL : 0.0;
  if (!rest_on_side(r->c)) {
    r->body[0] = rest_half(r, 0.0, 0.0, 0.0, 1.0), rest_touch(r, r->body[0], 0.5 * r->dx);
  }
  if (!rest_at_sides(r->c)) {
    r->body[1] = rest_half(r, 0.0, 0.0, 1.0, 0.0), rest_touch(r, r->body[1], 0.5 * r->dx);
  }
  r->body[2] = rest_half(r, r->width + r->gap, 0.0, -1.0, 0.0);
  rest_touch(r, r->body[2], 0.5 * r->dx);
  if (r->gap > 0.0) r->body[3] = rest_box(r, half, half + r->gap, low, top);
  if (r->c->edge == REST_TIP)
    r->body[3] = rest_box(r, half, half + r->dx, r->row[REST_TIP_ROW], top);
  if (r->c->edge == REST_BOX)
    r->body[3] = rest_box(r, half - REST_BOX_COLUMNS * r->dx, half + REST_BOX_COLUMNS * r->dx, low,
                          r->row[REST_BOX_ROWS]);
  if (r->body[3]) rest_touch(r, r->body[3], 0.5 * r->dx);
  if (r->c->edge == REST_FRICTIONAL) {
    for (int side = MPS_SIDE_X_LOWER; side <= MPS_SIDE_Y_LOWER; side += 2)
      mpm_scene_side(&r->s, side, MPS_BOUNDARY_FRICTIONAL, 0.5);
    mpm_scene_side(&r->s, MPS_SIDE_Y_UPPER, MPS_BOUNDARY_FREE, 0.0);
  }
}

static inline rest_scene rest_begin(mps_context *context, const rest_case *c) {
  static const double gaps[REST_EDGES] = {
      [REST_PLATE] = 0.5, [REST_FINE_PLATE] = 0.1, [REST_WIDE_PLATE] = 1.5};
  const double stretch = rest_at_sides(c) ? c->shift : 0.0, h = REST_CELL;
  rest_scene r = {.s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, REST_YOUNG), .c = c};
  r.width = (REST_COLUMNS / 2 + stretch) * h, r.dx = r.width / REST_COLUMNS;
  rest_levels(&r, (REST_ROWS / 2 + stretch) * h / REST_ROWS);
  r.gap = gaps[c->edge] * h;
  r.turn[0] = cos(c->angle), r.turn[1] = sin(c->angle);
  if (c->edge == REST_TIP) r.removed = (r.height - r.row[REST_TIP_ROW]) * r.dx;
  if (c->edge == REST_BOX) r.removed = 2.0 * REST_BOX_COLUMNS * r.dx * r.row[REST_BOX_ROWS];
  rest_fill(&r);
  DEF(mpm, def, .cell = h, .spline = c->spline, .gravity[0] = REST_GRAVITY * r.turn[1],
      .gravity[1] = -REST_GRAVITY * r.turn[0]);
  if (rest_at_sides(c)) {
    def.lower[0] = def.lower[1] = 0.0;
    if (c->edge == REST_FRICTIONAL) def.upper[1] = (REST_ROWS / 2 + 1) * h;
    if (c->edge == REST_FIT) def.edge = MPS_MPM_EDGE_FIT;
  } else {
    def.origin[0] = c->shift * h;
    if (rest_on_side(c))
      def.lower[1] = 0.0;
    else
      def.origin[1] = 0.5 * c->shift * h;
  }
  OK(mps_mpm_create(context, r.s.particles, r.s.material, &def, &r.s.mpm));
  rest_add_bodies(&r);
  return r;
}

static inline void rest_end(rest_scene *r) {
  mpm_scene_end(&r->s);
  for (int b = 0; b < 4; b++) mps_body_destroy(&r->body[b]);
}

/* Volume means of the stresses across and along the ground's y. */
static inline void rest_stress(rest_scene *r, double *mean) {
  mps_view s = mpm_scene_view(&r->s, "stress"), V = mpm_scene_view(&r->s, "volume");
  const double c = r->turn[0], d = r->turn[1];
  double sum = 0.0;
  mean[0] = mean[1] = 0.0;
  for (int64_t k = 0; k < s.shape[0]; k++) {
    const double v = *mps_view_f64(&V, k, 0), xx = *mps_view_f64(&s, k, 0);
    const double yy = *mps_view_f64(&s, k, 1), xy = *mps_view_f64(&s, k, 3);
    mean[0] += v * (c * c * xx + d * d * yy + 2.0 * c * d * xy);
    mean[1] += v * (d * d * xx + c * c * yy - 2.0 * c * d * xy);
    sum += v;
  }
  mean[0] /= sum, mean[1] /= sum;
}

/* Impulses so far (N s) on the left and right wall outwards, on the floor and the body downwards.
 */
static inline void rest_impulses(rest_scene *r, double *out) {
  double x[4] = {0.0}, y[4] = {0.0};
  for (int b = 0; b < 4; b++) {
    mps_reaction f;
    const bool side = !r->body[b] && b < 2; /* what it does to the ground */
    if (side)
      OK(mps_mpm_get_reaction(r->s.mpm, b == 0 ? 2 : 0, &f));
    else if (r->body[b])
      OK(mps_body_get_reaction(r->body[b], -1, &f));
    else
      continue;
    const double sign = side ? -1.0 : 1.0;
    x[b] = sign * (r->turn[0] * f.impulse[0] + r->turn[1] * f.impulse[1]);
    y[b] = sign * (r->turn[0] * f.impulse[1] - r->turn[1] * f.impulse[0]);
  }
  out[0] = -x[1], out[1] = x[2], out[2] = -y[0], out[3] = -y[3];
}

/* Takes the steps, the last of which are averaged over. */
static inline rest_result rest_run(mps_context *context, const rest_case *c, int64_t steps,
                                   int64_t last) {
  SCOPED(rest_end) rest_scene r = rest_begin(context, c);
  rest_result out = {.floor = 0.0};
  double from[4], to[4], first[2], mean[2];
  const double weight = REST_DENSITY * REST_GRAVITY, H = r.height;
  rest_stress(&r, first);
  OK(mps_mpm_step(r.s.mpm, steps - last));
  const double begin = mps_mpm_time(r.s.mpm);
  rest_impulses(&r, from);
  OK(mps_mpm_step(r.s.mpm, last));
  rest_impulses(&r, to);
  const double time = mps_mpm_time(r.s.mpm) - begin;
  for (int k = 0; k < 4; k++) to[k] = (to[k] - from[k]) / time;
  const double across = 0.5 * REST_K0 * weight * H * H;
  const double beside = 2.0 * REST_BOX_COLUMNS * r.dx; /* width of the box */
  const double borne = c->edge == REST_TIP   ? weight * r.removed
                       : c->edge == REST_BOX ? weight * beside * (H - r.row[REST_BOX_ROWS])
                                             : 0.0;
  const double all = weight * (r.width * H - r.removed);
  for (int k = 0; k < 2; k++) out.wall[k] = to[k] / across - 1.0;
  /* A tip is supported by the holder of the plate; a box stands beside the floor. */
  const double on_floor = c->edge == REST_TIP ? all + borne : all - borne;
  out.floor = to[2] / on_floor - 1.0;
  out.body = borne > 0.0 ? fabs(to[3]) / borne - 1.0 : to[3] / across;
  rest_stress(&r, mean);
  out.across = mean[0] / first[0] - 1.0, out.along = mean[1] / first[1] - 1.0;
  const double M = REST_YOUNG * 0.7 / (1.3 * 0.4);
  out.kinetic =
      mpm_scene_totals(&r.s).kinetic / (weight * weight * H * H * H * r.width / (6.0 * M));
  print_message("%s, spline %d, shift %.2f, turned by %.0f degrees, inset %.1f: walls %+.3f %+.3f, "
                "floor %+.3f, "
                "body %+.3f; stress %+.3f %+.3f %%; motion %.1e\n",
                rest_names[c->edge], (int)c->spline, c->shift, c->angle * 57.29578, c->inset,
                100.0 * out.wall[0], 100.0 * out.wall[1], 100.0 * out.floor, 100.0 * out.body,
                100.0 * out.across, 100.0 * out.along, out.kinetic);
  return out;
}

/* Bars. Stresses and forces: half a percent of theory. Where a thin plate stands on another body,
 * as it does on a turned grid, ground sees ground past its end through nodes in that body: 2.5 %.
 * At an edge in the ground the grid shows the body wider, by less than a cell in all: that is what
 * the box and the tip may bear besides, and what the ground under a driven tip is pressed by. */
static inline void rest_check(mps_context *context, const rest_case *c, int64_t steps) {
  const rest_result r = rest_run(context, c, steps, 100);
  const bool tip = c->edge == REST_TIP, box = c->edge == REST_BOX;
  const double tip_width = 0.5, box_width = 3.0; /* cells */
  const double most = tip                                    ? 0.05
                      : box                                  ? 0.01
                      : rest_is_plate(c) && !rest_on_side(c) ? 0.025
                                                             : 0.005;
  for (int k = 0; k < 2; k++) assert_true(fabs(r.wall[k]) < most);
  assert_true(fabs(r.floor) < most);
  assert_true(fabs(r.across) < most && fabs(r.along) < most);
  assert_true(fabs(r.body) < (tip ? 1.0 / tip_width : box ? 0.15 / box_width : 1e-4));
  assert_true(r.kinetic < (tip ? 1e-3 : 1e-4));
}

#endif
