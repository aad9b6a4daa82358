/* test_mpm_cut.c - particles whose support bodies and sides cut give to the nodes and take from
 * them, four of one stencil at once (src/mpm/transfer/cut_scatter.c, cut_gather.c), what a
 * reference gives and takes particle by particle and node by node from their shape functions: to
 * round-off, in all geometries, with both kernels, at fitted and mirrored walls, beside thin walls
 * and in corners, and with one to four particles a stencil. SPDX-License-Identifier: BSD-3-Clause
 */
#define MPSI_LEVEL                                                                                 \
  1 /* of what is inline in the headers; nothing in them depends on it for memory */
#include "kit/random.h"
#include "mpm_scene.h"
#include "test_fixture.h"

#include "mpm_cut_reference.h"

/* ---- the functions of the level that the context has ----------------------------------------- */

typedef bool (*scatter_fn)(const mpsi_transfer *, const mpsi_segment *);
typedef bool (*gather_fn)(const mpsi_transfer *, const mpsi_segment *, mpsi_gathered *);
typedef struct functions {
  scatter_fn scatter;
  gather_fn gather;
} functions;

/* Weak: those of a level that this library does not have are NULL. */
#define DECLARE(level)                                                                             \
  bool mpsi_mpm_scatter_cut_v##level(const mpsi_transfer *, const mpsi_segment *)                  \
      __attribute__((weak));                                                                       \
  bool mpsi_mpm_gather_cut_v##level(const mpsi_transfer *, const mpsi_segment *, mpsi_gathered *)  \
      __attribute__((weak));
DECLARE(3)
DECLARE(4)
#define FUNCTIONS(level)                                                                           \
  (functions) { mpsi_mpm_scatter_cut_v##level, mpsi_mpm_gather_cut_v##level }

static functions functions_of(const mps_mpm *mpm) {
  if (mpm->kernels == mpsi_mpm_kernels(1)) return FUNCTIONS(1);
  return mpm->kernels == mpsi_mpm_kernels(3) ? FUNCTIONS(3) : FUNCTIONS(4);
}

/* ---- scenes ---------------------------------------------------------------------------------- */

#define CELL 0x1p-6 /* m: places on edges of cells are exact */
enum { CELLS = 20 };

/* A tooth of less than a cell between two gaps in which few nodes are active, and a ball; both cut
 * by the left wall or close to it. */
static void add_bodies(mps_mpm *mpm, int dim) {
  static const double comb[] = {0.02, 0.02, 0.20, 0.02, 0.20, 0.05, 0.13,
                                0.05, 0.12, 0.16, 0.11, 0.05, 0.02, 0.05};
  mps_body_def def = mps_body_defaults();
  mps_body *bodies[2] = {NULL};
  if (dim == 3) {
    for (int c = 0; c < 3; c++) def.position[c] = 0.07;
    def.rotation[0] = 0.4;
    OK(mps_body_create_cylinder(context, &def, 0.012, 0.12, &bodies[0]));
    def.position[0] = 0.01, def.position[1] = 0.17;
    OK(mps_body_create_sphere(context, &def, 0.05, &bodies[1]));
  } else {
    OK(mps_body_create_polygon(context, &def, 7, comb, &bodies[0]));
    def.position[0] = 0.05, def.position[1] = 0.22;
    OK(mps_body_create_disc(context, &def, 0.06, &bodies[1]));
  }
  for (int b = 0; b < 2; b++) {
    DEF(contact, contact, .inside = MPS_CONTACT_INSIDE_PUSH);
    OK(mps_mpm_add_contact(mpm, bodies[b], &contact, NULL));
    mpm->contact.handle[b]->thin = false; /* cuts supports, as thick bodies do */
    mps_body_destroy(&bodies[b]);
  }
}

/* A third at random places, a third on edges of cells or in their corners, a third where others
 * are, so that stencils have up to some four. Some are inside the bodies, as after a hard blow. */
static void add_particles(mpm_scene *s, int dim, int count) {
  double last[3] = {0.1, 0.1, 0.1};
  for (int k = 0; k < count; k++) {
    double x[3];
    bool taken = false; /* corners: no two particles share a place */
    for (int c = 0; c < 3; c++) {
      x[c] = uniform(0.01, 0.99) * CELLS * CELL;
      if (k % 3 == 1 && (c == k % dim || k % 2 == 0))
        x[c] = fmax(round(x[c] / CELL), c == 0) * CELL; /* off the axis */
      if (k % 3 == 2) x[c] = last[c] + (last[c] < 0.15 ? 0.1 : -0.1) * CELL;
      last[c] = x[c];
    }
    const mps_view all = mpm_scene_view(s, "position");
    for (int64_t i = 0; i < all.shape[0] && !taken; i++) {
      double apart = 0.0;
      for (int c = 0; c < dim; c++) apart = fmax(apart, fabs(*mps_view_f64(&all, i, c) - x[c]));
      taken = apart < 1e-9;
    }
    const double moved = 1e-5 * CELL * (1 + k % 1009);
    for (int c = 0; c < dim && taken; c++) x[c] += x[c] < 0.15 ? moved : -moved;
    OK(mps_particles_append(s->particles, 1, x));
  }
}

static mpm_scene scene_of(int32_t geometry, int32_t spline, int32_t walls) {
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.5 * CELL, 0.0, 0.0, 1e6);
  add_particles(&s, dim, dim == 2 ? 700 : 8000);
  DEF(mpm, def, .geometry = geometry, .spline = spline, .cell = CELL, .edge = walls);
  for (int c = 0; c < dim; c++) def.lower[c] = 0.0, def.upper[c] = CELLS * CELL;
  mpm_scene_solve(&s, &def);
  const mpsi_boundary_setup boundaries = mpsi_boundary_setup_of(s.mpm);
  OK(mpsi_mpm_update_boundaries(&boundaries, "test", MPS_OK));
  add_bodies(s.mpm, dim);
  const int64_t n = s.mpm->p.count;
  for (int64_t k = 0; k < n; k++) {
    s.mpm->p.m[k] *= uniform(0.5, 1.5);
    for (int c = 0; c < dim; c++) s.mpm->p.v[c][k] = uniform(-1.0, 1.0);
    for (int c = 0; c < dim * dim; c++) s.mpm->p.L[c][k] = uniform(-9.0, 9.0);
    for (int c = 0; c < 2 * dim; c++) s.mpm->p.s[c][k] = uniform(-1e3, 1e3);
  }
  s.mpm->def.gravity[1] = -9.81;
  OK(mpsi_mpm_find_near(s.mpm, "test", MPS_OK));
  s.mpm->run.dt = 1e-4;
  return s;
}

/* ---- a stencil ------------------------------------------------------------------------------- */

typedef struct compared {
  int64_t batches[5]; /* by the number of their particles */
  int64_t full;       /* stencils whose particles use all nodes */
  int64_t sides;      /* that sides alone cut */
  double scatter, gather, feet;
} compared;

static void clear_tiles(const mps_mpm *mpm, const mpsi_worker *worker) {
  memset(worker->tile, 0, (size_t)mpm->grid.tile_nodes * sizeof *worker->tile);
  memset(worker->force, 0, (size_t)mpm->grid.tile_nodes * sizeof *worker->force);
}

/* Largest difference of two tiles, of masses (kg) over that of a particle, and of the rest over the
 * largest value. */
static double difference(const mps_mpm *mpm, double (*one)[4], double (*other)[4]) {
  double mass = 0.0, rest = 0.0, size = 0.0;
  for (int64_t n = 0; n < mpm->grid.tile_nodes; n++) {
    mass = fmax(mass, fabs(one[n][0] - other[n][0]));
    for (int c = 1; c < 4; c++) {
      rest = fmax(rest, fabs(one[n][c] - other[n][c]));
      size = fmax(size, fabs(one[n][c]));
    }
  }
  return fmax(mass / mpm->p.m[0], size > 0.0 ? rest / size : rest);
}

/* The weights at a foot, by the fits that the scatter has kept. */
static void compare_feet(const mps_mpm *mpm, const mpsi_transfer *work, int64_t begin, int64_t end,
                         compared *out) {
  const mpsi_cell_block *cells = work->cells;
  for (int64_t p = begin; p < end; p++) {
    const double d[3] = {uniform(-CELL, CELL), uniform(-CELL, CELL), uniform(-CELL, CELL)};
    mpsi_foot_weights foot;
    mpsi_stencil at;
    mpsi_shape_values f;
    assert_true(mpm->grid.fitted[cells->first_fit + p - cells->begin] != 0);
    mpm->kernels->foot(work, p, d, &foot);
    mpm->kernels->fit(work, p, &at, &f);
    for (int n = 0; n < MPSI_STENCIL; n++) {
      double psi = f.phi[n];
      for (int a = 0; a < mpm->grid.dim; a++) psi += f.gradient[a][n] * d[a];
      const bool active = foot.active >> n & 1; /* or at the edge of a full support */
      assert_true(active || f.w[n] == 0.0);
      if (active) out->feet = fmax(out->feet, fabs(foot.psi[n] - psi));
    }
    assert_memory_equal(foot.at, at.at, sizeof at.at);
  }
}

static uint32_t held_by(const mps_mpm *mpm, const mpsi_places *places, int k) {
  return mpsi_support_state(&mpm->grid.workers[0], mpm->grid.dim, mpm->grid.spline,
                            places->first[k]) &
         (MPSI_IMPULSE | MPSI_PENALTY);
}

/* Whether a particle sees nodes in bodies: some of its stencil that have weight for it. */
static bool is_beside(const mps_mpm *mpm, const mpsi_stencil *at) {
  double w[3][4] = {{1.0}, {1.0}, {1.0}}; /* outside the domain too */
  bool beside = false;
  for (int c = 0; c < mpm->grid.dim; c++) mpsi_weights(mpm->grid.spline, -at->s[c][0], w[c]);
  REFERENCE_NODES(n, i, j, k) {
    (void)n;
    if (!(fmin(w[0][i], fmin(w[1][j], w[2][k])) > 0x1p-60)) continue; /* perhaps beyond the tile */
    const int t = mpsi_tile_index(at->at[0] + i, at->at[1] + j, at->at[2] + k);
    const uint32_t state = mpm->grid.workers[0].state[t];
    beside = beside || (state & (MPSI_INSIDE | MPSI_IMPULSE | MPSI_PENALTY)) > MPSI_INSIDE;
  }
  return beside;
}

/* Whether a particle keeps its moment. */
static bool spins(const mps_mpm *mpm, bool beside) {
  return beside && mpm->grid.geometry != MPS_MPM_GEOMETRY_AXISYMMETRIC;
}

static void compare_scatter(mps_mpm *mpm, const mpsi_transfer *work, const mpsi_segment *segment,
                            compared *out) {
  static double batch[2][MPSI_TILE_SIDE * MPSI_TILE_SIDE * MPSI_TILE_SIDE][4];
  const mpsi_worker *worker = work->worker;
  const int64_t nodes = mpm->grid.tile_nodes, chunk = segment->places->chunk;
  const int begin = segment->begin, end = segment->end;
  const uint32_t held = held_by(mpm, segment->places, begin);
  clear_tiles(mpm, worker);
  if (!functions_of(mpm).scatter(work, segment)) {
    /* the kept fit says so; by themselves they have the same */
    compare_feet(mpm, work, chunk + begin, chunk + end, out);
    out->full++;
    return;
  }
  memcpy(batch[0], worker->tile, (size_t)nodes * sizeof *worker->tile);
  memcpy(batch[1], worker->force, (size_t)nodes * sizeof *worker->force);
  clear_tiles(mpm, worker);
  for (int k = begin; k < end; k++) {
    mpsi_stencil at;
    mpsi_shape_values f;
    mpm->kernels->fit(work, chunk + k, &at, &f);
    reference_scatter(mpm, &at, &f, chunk + k, mpm->run.moments && spins(mpm, is_beside(mpm, &at)),
                      worker->tile, worker->force);
  }
  out->scatter = fmax(out->scatter, difference(mpm, worker->tile, batch[0]));
  out->scatter = fmax(out->scatter, difference(mpm, worker->force, batch[1]));
  if (work->cells->first_fit >= 0) compare_feet(mpm, work, chunk + begin, chunk + end, out);
  out->sides += !held;
  out->batches[end - begin < 4 ? end - begin : 4]++;
}

static void compare_gather(mps_mpm *mpm, const mpsi_transfer *work, const mpsi_segment *segment,
                           compared *out) {
  const mpsi_worker *worker = work->worker;
  mpsi_gathered batch;
  for (int64_t n = 0; n < mpm->grid.tile_nodes; n++)
    for (int c = 0; c < 4; c++) worker->tile[n][c] = uniform(-1.0, 1.0);
  if (!functions_of(mpm).gather(work, segment, &batch)) return;
  for (int k = segment->begin; k < segment->end; k++) {
    mpsi_stencil at;
    mpsi_shape_values f;
    mpm->kernels->fit(work, segment->places->chunk + k, &at, &f);
    const bool beside = is_beside(mpm, &at);
    const reference one = reference_gather(mpm, work->cells, &at, &f, beside, spins(mpm, beside),
                                           (const mpsi_node *)worker->tile);
    for (int c = 0; c < mpm->grid.dim; c++) {
      out->gather = fmax(out->gather, fabs(batch.v[c][k] - one.v[c]));
      for (int d = 0; d < mpm->grid.dim; d++) {
        const int to = mpm->grid.dim * c + d;
        const double slope = fabs(batch.slope[to][k] - one.slope[c][d]);
        const double rise = fabs(batch.derivative[to][k] - one.derivative[c][d]);
        out->gather = fmax(out->gather, CELL * fmax(slope, rise));
      }
    }
  }
}

static void compare_block(mps_mpm *mpm, int64_t b, compared *out) {
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, 0);
  const mpsi_cell_block *cells = work.cells;
  const int dim = mpm->grid.dim, spline = mpm->grid.spline;
  mpsi_mpm_find_states(&work);
  for (int64_t chunk = cells->begin; chunk < cells->end; chunk += MPSI_CHUNK) {
    const int n = cells->end - chunk < MPSI_CHUNK ? (int)(cells->end - chunk) : MPSI_CHUNK;
    mpsi_places places;
    mpsi_find_places(&work, dim, spline, 7, 7, chunk, n, &places);
    for (int k = 0, end; k < n; k = end) {
      for (end = k + 1; end < n && places.first[end] == places.first[k];) end++;
      const mpsi_segment segment = {&places, k, end};
      if (mpsi_support_state(work.worker, dim, spline, places.first[k]) == 0) continue;
      compare_scatter(mpm, &work, &segment, out);
      compare_gather(mpm, &work, &segment, out);
    }
  }
}

/* ---- tests ----------------------------------------------------------------------------------- */

TEST(vectors_do_as_the_reference) {
  for (int variant = 0; variant < 24; variant++) {
    const int32_t geometry = variant / 8, spline = 2 + variant % 2;
    scoped_mpm_scene s =
        scene_of(geometry, spline, variant & 2 ? MPS_MPM_EDGE_MIRROR : MPS_MPM_EDGE_FIT);
    compared c = {.scatter = 0.0};
    s.mpm->run.moments = (variant & 4) != 0; /* spins of particles beside bodies */
    for (int64_t b = 0; b < s.mpm->grid.cell_count; b++)
      if (s.mpm->grid.cells[b].cut) compare_block(s.mpm, b, &c);
    print_message(
        "%d, spline %d, walls %d, moments %d: %lld %lld %lld %lld batches, %lld full, %lld sides, "
        "scatter %.2g, gather %.2g, feet %.2g\n",
        geometry, spline, s.mpm->def.edge, s.mpm->run.moments, (long long)c.batches[1],
        (long long)c.batches[2], (long long)c.batches[3], (long long)c.batches[4],
        (long long)c.full, (long long)c.sides, c.scatter, c.gather, c.feet);
    for (int n = 1; n <= 4; n++) assert_true(c.batches[n] >= 5);
    assert_true(c.full >= 7);
    assert_true(variant & 2 || c.sides >= 5);
    assert_true(c.scatter <= 1e-12);
    assert_true(c.gather <= 1e-13 && c.feet <= 1e-13);
  }
}

/* A block of ground under a heavy body that comes down tilted. */
static mpm_scene pressed(int dim, bool plane) {
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.5 * CELL, 0.0, 0.0, 1e6);
  OK(mps_particles_fill_box(s.particles, AT(0.0),
                            AT(10 * CELL, 10 * CELL, dim == 3 ? 6 * CELL : 0.0), NULL));
  USING(mpm, mpm_scene_solve(&s, &given),
        .geometry = dim == 3 ? MPS_MPM_GEOMETRY_SPACE : MPS_MPM_GEOMETRY_PLANE_STRAIN,
        .cell = CELL);
  scoped_body *made = NULL;
  DEF(body, body, .position[0] = body.position[1] = 5 * CELL,
      .position[dim - 1] = (dim == 3 ? 9.0 : 13.5) * CELL, .rotation[dim == 3 ? 0 : 2] = 0.2,
      .motion = MPS_BODY_MOTION_FREE, .mass = 1e6);
  for (int c = dim == 2 ? 2 : 0; c < 3; c++) body.inertia[c] = 1e6;
  body.velocity[dim - 1] = -3.0;
  if (dim == 3)
    OK(mps_body_create_cylinder(context, &body, 3 * CELL, 4 * CELL, &made));
  else
    OK(mps_body_create_box(context, &body, 5 * CELL, 5 * CELL, &made));
  mpm_scene_contact(&s, made, 0.3);
  assert_true(s.mpm->contact.handle[0]->convex);
  s.mpm->contact.handle[0]->convex = plane;
  return s;
}

/* Nothing changes by what the tangent planes of a convex body leave out of the search. */
TEST(tangent_planes_leave_out_nothing_near) {
  for (int dim = 2; dim <= 3; dim++) {
    scoped_mpm_scene s = pressed(dim, true), other = pressed(dim, false);
    OK(mps_mpm_step(s.mpm, 60));
    OK(mps_mpm_step(other.mpm, 60));
    assert_true(s.mpm->contact.impulses.warm_count > 3);
    assert_int_equal(s.mpm->contact.impulses.warm_count, other.mpm->contact.impulses.warm_count);
    for (int c = 0; c < dim; c++)
      assert_memory_equal(s.mpm->p.v[c], other.mpm->p.v[c], (size_t)s.mpm->p.count * 8);
  }
}

/* A cone with a hollow base, a ring: solids whose meridian is convex, but not they. */
TEST(solids_of_revolution_are_convex_or_not) {
  static const double cylinder[] = {0, 0, 1, 0, 1, 2, 0, 2}, cone[] = {0, 0, 1, 2, 0, 2};
  static const double hollow[] = {0, 1, 1, 0, 1, 2, 0, 2}, ring[] = {1, 0, 2, 0, 2, 1, 1, 1};
  static const struct {
    const double *rz;
    int64_t corners;
    bool convex;
  } cases[] = {{cylinder, 4, true}, {cone, 3, true}, {hollow, 4, false}, {ring, 4, false}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    MAKE(body, body, create_revolution, context, NULL, cases[k].corners, cases[k].rz);
    assert_true(mpsi_body_is_convex(body) == cases[k].convex);
  }
}
