/* test_mpm.c - what the WLS-MPM solver keeps: partition of unity, linear functions, momentum, also
 * beside bodies and edges; nothing passes through a thin wall.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/random.h"
#include "mpm_scene.h"
#include "test_fixture.h"

#include "mpm/base/mpm_solver.h"

/* A concave polygon with a thin tooth, and a disc, in a square domain full of particles at random
 * places, some of them deep inside the bodies. */
static const double tooth[] = {0.30, 0.20, 0.90, 0.20, 0.90, 0.35, 0.62,
                               0.35, 0.60, 0.75, 0.57, 0.35, 0.30, 0.35};

enum { COUNT = 4000 };

/* Bodies of that scene; in space a thin pin with its end, and a ball. */
static int crowd_bodies(int32_t geometry, mps_body **bodies) {
  mps_body_def body = mps_body_defaults();
  if (geometry == MPS_MPM_GEOMETRY_SPACE) {
    for (int c = 0; c < 3; c++) body.position[c] = 0.05;
    OK(mps_body_create_sphere(context, &body, 0.04, &bodies[0]));
    body.position[0] = 0.13, body.position[1] = 0.11, body.rotation[0] = 0.4;
    OK(mps_body_create_cylinder(context, &body, 0.015, 0.13, &bodies[1]));
    return 2;
  }
  OK(mps_body_create_polygon(context, &body, 7, tooth, &bodies[0]));
  body.position[0] = 0.25, body.position[1] = 0.8;
  OK(mps_body_create_disc(context, &body, 0.15, &bodies[1]));
  return 2;
}

static mpm_scene crowded(int32_t geometry, int32_t spline, bool keep_out) {
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  const double side = dim == 3 ? 0.2 : 1.0;
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.01, 0.0, 0.0, 1e6);
  mps_body *bodies[2] = {NULL};
  const int count = crowd_bodies(geometry, bodies);
  for (int k = 0; k < COUNT;) {
    const double x[] = {uniform(0.0, side), uniform(0.0, side), uniform(0.0, side)};
    double nearest = INFINITY;
    for (int b = 0; b < count; b++) {
      double d;
      OK(mps_body_distance(bodies[b], 1, x, &d, NULL, NULL, NULL));
      nearest = fmin(nearest, d);
    }
    if (keep_out && nearest < 0.0051) continue; /* untouched: no contact force */
    OK(mps_particles_append(s.particles, 1, x));
    k++;
  }
  DEF(mpm, def, .geometry = geometry, .spline = spline, .cell = 0.02);
  def.edge = MPS_MPM_EDGE_FIT; /* mirrors: test_mpm_mirror.c */
  for (int c = 0; c < dim; c++) def.lower[c] = 0.0, def.upper[c] = side;
  mpm_scene_solve(&s, &def);
  const mpsi_boundary_setup boundaries = mpsi_boundary_setup_of(s.mpm);
  OK(mpsi_mpm_update_boundaries(&boundaries, "test", MPS_OK));
  for (int b = 0; b < count; b++) {
    DEF(contact, contact, .inside = MPS_CONTACT_INSIDE_PUSH);
    OK(mps_mpm_add_contact(s.mpm, bodies[b], &contact, NULL));
    s.mpm->contact.handle[b]->thin = false; /* all cut supports here: unit/across */
    mps_body_destroy(&bodies[b]);
  }
  return s;
}

/* sum phi = 1, sum phi (x_i - x_p) = 0, sum grad phi = 0, sum (x_i - x_p) grad phi = 1. */
static void check_sums(int dim, double h, const mpsi_stencil *at, const mpsi_shape_values *f) {
  double one = 0.0, first[3] = {0}, g[3] = {0}, unit[3][3] = {{0}};
  for (int n = 0; n < MPSI_STENCIL; n++) {
    const double x[3] = {at->s[0][n % 4], at->s[1][n / 4 % 4], at->s[2][n / 16]};
    one += f->phi[n];
    for (int c = 0; c < dim; c++) {
      first[c] += f->phi[n] * x[c];
      g[c] += f->gradient[c][n] * h;
      for (int d = 0; d < dim; d++) unit[c][d] += f->gradient[c][n] * h * x[d];
    }
  }
  NEAR(one, 1.0, 1e-13);
  for (int c = 0; c < dim; c++) {
    NEAR(first[c], 0.0, 1e-13);
    NEAR(g[c], 0.0, 1e-13);
    for (int d = 0; d < dim; d++) NEAR(unit[c][d], c == d, 1e-13);
  }
}

/* M is far from singular and phi hardly negative whatever the bodies cut off. */
static void check_shapes(mps_mpm *mpm, int64_t *fitted) {
  double least_phi = 1.0, least_determinant = 1.0;
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    const mpsi_transfer work = mpsi_transfer_of(mpm, b, 0);
    const mpsi_cell_block *cells = work.cells;
    mpsi_mpm_find_states(&work);
    for (int64_t k = cells->begin; k < cells->end; k++) {
      mpsi_stencil at;
      mpsi_shape_values f;
      mpm->kernels->fit(&work, k, &at, &f);
      check_sums(mpm->grid.dim, mpm->grid.cell, &at, &f);
      double weight = 0.0;
      for (int n = 0; n < MPSI_STENCIL; n++) {
        weight += f.w[n];
        least_phi = fmin(least_phi, f.phi[n]);
      }
      *fitted += fabs(weight - 1.0) > 1e-9;
      least_determinant = fmin(least_determinant, f.determinant);
    }
  }
  print_message("%dD, spline %d: least phi %.4f, least det(M)/M00^n %.4f\n", mpm->grid.dim,
                mpm->grid.spline, least_phi, least_determinant);
  assert_true(least_phi >= -0.05);
  if (mpm->grid.dim == 2 && mpm->grid.spline == 3) assert_true(least_determinant >= 0.0256);
  assert_true(least_determinant > 1e-3);
}

TEST(shapes_are_a_partition) {
  for (int variant = 0; variant < 4; variant++) {
    scoped_mpm_scene s =
        crowded(variant < 2 ? MPS_MPM_GEOMETRY_PLANE_STRAIN : MPS_MPM_GEOMETRY_SPACE,
                2 + variant % 2, false);
    int64_t fitted = 0;
    OK(mpsi_mpm_find_near(s.mpm, "test", MPS_OK));
    check_shapes(s.mpm, &fitted);
    assert_true(fitted > COUNT / 10);
  }
}

/* To the nodes and back; nothing else acts. */
static void there_and_back(mps_mpm *mpm, int geometry, int spline) {
  for (int64_t g = 0; g < mpm->grid.node_count; g++) mpsi_mpm_clear_nodes(mpm, g, 0);
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    const mpsi_transfer work = mpsi_transfer_of(mpm, b, 0);
    mpm->kernels->p2g[geometry][spline](&work);
  }
  for (int64_t g = 0; g < mpm->grid.node_count; g++) mpsi_mpm_update_nodes(mpm, g, 0);
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    const mpsi_transfer work = mpsi_transfer_of(mpm, b, 0);
    mpm->kernels->g2p[geometry][spline](&work);
  }
}

/* A linear velocity field goes to the nodes and back unchanged, twice: first as written, then with
 * the spin beside bodies that the nodes' moment has left (mpm/spin.h). The bodies and the walls
 * must not act: particles keep off the ones, and the step ends before the others. */
TEST(affine_round_trip) {
  const double v0[] = {0.3, -0.2, 0.1};
  const double plane[] = {1.1, -0.7, 0.4, 0.9};
  const double space[] = {1.1, -0.7, 0.3, 0.4, 0.9, -0.5, -0.2, 0.6, 0.8};
  for (int variant = 0; variant < 6; variant++) {
    const int geometry = variant / 2, spline = variant % 2,
              dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
    const double *L = dim == 3 ? space : plane;
    scoped_mpm_scene s = crowded(geometry, 2 + spline, true);
    mps_mpm *mpm = s.mpm;
    mpm_scene_affine(&s, v0, L);
    OK(mpsi_mpm_find_near(mpm, "test", MPS_OK));
    mpm->run.dt = 1e-30;
    assert_false(mpm->run.moments);
    int64_t turned = 0;
    for (int trip = 0; trip < 2; trip++, mpm->run.moments = true) {
      there_and_back(mpm, geometry, spline);
      mps_view x = mpm_scene_view(&s, "position"), v = mpm_scene_view(&s, "velocity");
      mps_view g = mpm_scene_view(&s, "velocity_gradient");
      for (int64_t k = 0; k < COUNT; k++)
        for (int c = 0; c < dim; c++) {
          double exact = v0[c];
          for (int d = 0; d < dim; d++) {
            exact += L[dim * c + d] * *mps_view_f64(&x, k, d);
            const double one = *mps_view_f64(&g, k, dim * c + d);
            const double other = *mps_view_f64(&g, k, dim * d + c);
            NEAR(one + other, L[dim * c + d] + L[dim * d + c], 2e-10);
            turned += fabs(one - L[dim * c + d]) > 1e-10;
          }
          NEAR(*mps_view_f64(&v, k, c), exact, 1e-11);
        }
    }
    assert_true((turned > 0) == (geometry != MPS_MPM_GEOMETRY_AXISYMMETRIC));
  }
}

/* What a node should get of the particles by the general fit: mass, momentum; excess mass, force.
 */
typedef double node_sums[8];

static void add_by_fit(const mps_mpm *mpm, const mpsi_transfer *work, int64_t k, node_sums *sums) {
  const mpsi_cell_block *cells = work->cells;
  static const int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  const mpsi_columns *p = &mpm->p;
  const int dim = mpm->grid.dim;
  const double m = p->m[k], h = mpm->grid.cell;
  mpsi_stencil at;
  mpsi_shape_values f;
  mpm->kernels->fit(work, k, &at, &f);
  for (int n = 0; n < MPSI_STENCIL; n++) {
    if (f.w[n] == 0.0) continue;
    const int i = n % 4, j = n / 4 % 4, l = n / 16;
    const double s[3] = {at.s[0][i], at.s[1][j], at.s[2][l]};
    double *to = sums[mpsi_node_under(&mpm->grid, cells, at.at[0] + i, at.at[1] + j, at.at[2] + l)];
    to[0] += m * f.phi[n];
    to[4] += m * (f.w[n] - f.phi[n]);
    for (int c = 0; c < dim; c++) {
      double v = p->v[c][k], force = f.phi[n] * m * mpm->def.gravity[c];
      for (int d = 0; d < dim; d++) {
        v += p->L[dim * c + d][k] * h * s[d];
        force -= p->V[k] * p->s[symmetric[c][d]][k] * f.gradient[d][n];
      }
      if (mpm->grid.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && c == 0)
        force -= f.phi[n] * p->V[k] * p->s[2][k] / p->x[0][k];
      to[1 + c] += m * f.phi[n] * v;
      to[5 + c] += force;
    }
  }
}

/* The nodes have those sums, apart in split blocks and without excess where all supports are full.
 */
static void check_nodes(const mps_mpm *mpm, node_sums *sums) {
  double largest[8] = {0.0};
  for (int64_t n = 0; n < mpm->grid.node_count * mpm->grid.block_nodes; n++)
    for (int c = 0; c < 8; c++) largest[c] = fmax(largest[c], fabs(sums[n][c]));
  const double mass = 1e-13 * largest[0], force = 1e-13 * fmax(largest[5], largest[6]);
  for (int64_t n = 0; n < mpm->grid.node_count * mpm->grid.block_nodes; n++) {
    const mpsi_node_block *nodes = &mpm->grid.nodes[n / mpm->grid.block_nodes];
    const double *side =
        nodes->side < 0
            ? NULL
            : mpm->grid.side[mpsi_first_node(&mpm->grid, nodes->side) + n % mpm->grid.block_nodes];
    NEAR(mpm->grid.node[n][0], sums[n][0], mass);
    NEAR(side ? side[0] : 0.0, sums[n][4], mass);
    for (int c = 1; c <= mpm->grid.dim; c++) {
      const double with = nodes->split ? 0.0 : mpm->run.dt * sums[n][4 + c];
      NEAR(mpm->grid.node[n][c], sums[n][c] + with, 10.0 * mass + mpm->run.dt * force);
      if (nodes->split) NEAR(side[c], sums[n][4 + c], force);
    }
  }
}

static bool near_bodies(const mps_mpm *mpm, const double *x) {
  bool near = false;
  for (int b = 0; b < mpm->contact.bodies; b++)
    near = near || mpsi_body_foot(mpm->contact.body[b], x).distance < 0.0;
  return near;
}

/* Velocity and gradient that a particle should get by the general fit; beside bodies, in the plane
 * and in space, with the spin by the nodes' moment about it. */
static void gather_by_fit(const mps_mpm *mpm, const mpsi_transfer *work, int64_t k, double *out) {
  const mpsi_cell_block *cells = work->cells;
  const int dim = mpm->grid.dim;
  mpsi_stencil at;
  mpsi_shape_values f;
  mpm->kernels->fit(work, k, &at, &f);
  memset(out, 0, 12 * sizeof *out);
  double moment[3][3] = {{0.0}};
  const double h = mpm->grid.cell, full = h * h / (mpm->grid.spline == 3 ? 3.0 : 4.0);
  const int32_t first[3] = {cells->at[0], cells->at[1], cells->at[2]};
  bool beside = false;
  for (int n = 0; n < MPSI_STENCIL; n++) {
    const int own[3] = {n % 4, n / 4 % 4, n / 16};
    double x[3] = {0.0};
    if (own[0] > mpm->grid.spline || own[1] > mpm->grid.spline || own[2] > mpm->grid.spline)
      continue;
    if (own[2] > 0 && dim == 2) continue;
    for (int c = 0; c < dim; c++) x[c] = h * (first[c] * MPSI_SIDE + at.at[c] + own[c]);
    beside = beside || near_bodies(mpm, x);
    if (f.w[n] == 0.0) continue;
    const double *v = mpm->grid.node[mpsi_node_under(&mpm->grid, cells, at.at[0] + n % 4,
                                                     at.at[1] + n / 4 % 4, at.at[2] + n / 16)];
    for (int c = 0; c < dim; c++) {
      out[c] += f.phi[n] * v[1 + c];
      for (int d = 0; d < dim; d++) out[3 + dim * c + d] += f.gradient[d][n] * v[1 + c];
      for (int d = 0; d < dim; d++) moment[d][c] += f.phi[n] * h * at.s[d][own[d]] * v[1 + c];
    }
  }
  for (int c = 0; c < dim && beside && mpm->grid.geometry != MPS_MPM_GEOMETRY_AXISYMMETRIC; c++)
    for (int d = 0; d < c; d++) {
      double *one = out + 3 + dim * c + d, *other = out + 3 + dim * d + c;
      const double sum = *one + *other, spin = (moment[d][c] - moment[c][d]) / full;
      *one = 0.5 * (sum + spin), *other = 0.5 * (sum - spin);
    }
}

/* Full supports and those at one wall have loops of their own: they do what the fit over all active
 * nodes would. Any velocities and stresses; bodies and walls, with and without friction. */
TEST(transfers_agree_with_the_fit) {
  static double got[COUNT][12];
  for (int variant = 0; variant < 12; variant++) {
    const int geometry = variant / 4, spline = variant % 2;
    scoped_mpm_scene s = crowded(geometry, 2 + spline, true);
    mps_mpm *mpm = s.mpm;
    const int dim = mpm->grid.dim;
    for (int b = 0; b < mpm->contact.bodies; b++)
      mpm->contact.handle[b]->def.friction = variant % 4 < 2 ? 0.0 : 0.3;
    for (int64_t k = 0; k < COUNT; k++) {
      for (int c = 0; c < dim; c++) mpm->p.v[c][k] = uniform(-1.0, 1.0);
      for (int c = 0; c < dim * dim; c++) mpm->p.L[c][k] = uniform(-9.0, 9.0);
      for (int c = 0; c < 2 * dim; c++) mpm->p.s[c][k] = uniform(-1e3, 1e3);
    }
    mpm->def.gravity[1] = -9.81;
    OK(mpsi_mpm_find_near(mpm, "test", MPS_OK));
    mpm->run.dt = 1e-4;
    node_sums *sums =
        test_calloc((size_t)(mpm->grid.node_count * mpm->grid.block_nodes), sizeof *sums);
    for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
      const mpsi_transfer work = mpsi_transfer_of(mpm, b, 0);
      mpsi_mpm_find_states(&work);
      for (int64_t k = mpm->grid.cells[b].begin; k < mpm->grid.cells[b].end; k++)
        add_by_fit(mpm, &work, k, sums);
    }
    for (int64_t g = 0; g < mpm->grid.node_count; g++) mpsi_mpm_clear_nodes(mpm, g, 0);
    for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
      const mpsi_transfer work = mpsi_transfer_of(mpm, b, 0);
      mpm->kernels->p2g[geometry][spline](&work);
    }
    check_nodes(mpm, sums);
    test_free(sums);
    for (int64_t g = 0; g < mpm->grid.node_count; g++) mpsi_mpm_update_nodes(mpm, g, 0);
    for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
      const mpsi_transfer work = mpsi_transfer_of(mpm, b, 0);
      mpsi_mpm_find_states(&work);
      for (int64_t k = mpm->grid.cells[b].begin; k < mpm->grid.cells[b].end; k++)
        gather_by_fit(mpm, &work, k, got[k]);
    }
    for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
      const mpsi_transfer work = mpsi_transfer_of(mpm, b, 0);
      mpm->kernels->g2p[geometry][spline](&work);
    }
    for (int64_t k = 0; k < COUNT; k++)
      for (int c = 0; c < dim; c++) {
        NEAR(mpm->p.v[c][k], got[k][c], 1e-13);
        for (int d = 0; d < dim; d++)
          NEAR(mpm->p.L[dim * c + d][k], got[k][3 + dim * c + d], 1e-10);
      }
  }
}

static double length(const double *a) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

/* A soft disc or ball that rotates and shakes in empty space keeps both momenta. */
static void keeps_momentum(int dim, int spline, int64_t steps) {
  const double v0[] = {0.4, -0.3, 0.2};
  const double plane[] = {0.5, -6.0, 5.0, -0.8};
  const double space[] = {0.5, -6.0, 2.0, 5.0, -0.8, 3.0, -1.0, -4.0, 0.3};
  scoped_mpm_scene s = mpm_scene_begin_in(context, dim, 0.01, 0.003, -0.001, 1e5);
  const double centre[] = {0.0, 0.0, 0.0};
  OK(mps_particles_fill_ball(s.particles, centre, dim == 3 ? 0.06 : 0.12, NULL));
  mpm_scene_affine(&s, v0, dim == 3 ? space : plane);
  USING(mpm, mpm_scene_solve(&s, &given),
        .geometry = dim == 3 ? MPS_MPM_GEOMETRY_SPACE : MPS_MPM_GEOMETRY_PLANE_STRAIN,
        .spline = spline, .cell = 0.02);
  const mps_totals a = mpm_scene_totals(&s);
  OK(mps_mpm_step(s.mpm, steps));
  const mps_totals b = mpm_scene_totals(&s);
  double linear[3], angular[3];
  for (int c = 0; c < 3; c++) {
    linear[c] = b.linear[c] - a.linear[c];
    angular[c] = b.angular[c] - a.angular[c];
  }
  print_message("%dD, spline %d: linear %.2g, angular %.2g\n", dim, spline,
                length(linear) / length(a.linear), length(angular) / length(a.angular));
  assert_true(length(linear) <= 1e-12 * length(a.linear));
  assert_true(length(angular) <= 1e-12 * length(a.angular));
  NEAR(b.mass, a.mass, 0.0);
  assert_true(b.kinetic < a.kinetic);
}

TEST(free_body_keeps_momentum) {
  for (int spline = 2; spline <= 3; spline++) {
    keeps_momentum(2, spline, 2000);
    keeps_momentum(3, spline, 500);
  }
}

/* Angular and linear momentum of a free body about the origin of space. */
static void body_momentum(mps_body *body, double mass, double inertia, double *out) {
  mps_body_state b;
  OK(mps_body_get_state(body, &b));
  out[0] += mass * b.velocity[0];
  out[1] += mass * b.velocity[1];
  out[2] +=
      inertia * b.spin[2] + mass * (b.position[0] * b.velocity[1] - b.position[1] * b.velocity[0]);
}

/* A lump thrown at two free rough bodies, whose edges are rounded by `corner` or whose faces end
 * `inset` (m) before them: what the particles lose the bodies get, to the last bits of linear and,
 * without flip_time, of angular momentum. */
static void check_momentum(double corner, double inset, double flip_time) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  const double v0[] = {2.0, -0.5}, L[] = {0.0, -3.0, 3.0, 0.0};
  mpm_scene_ball(&s, 0.0, 0.0, 0.1);
  mpm_scene_affine(&s, v0, L);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .flip_time = flip_time);
  mps_body *bodies[2] = {NULL};
  DEF(body, body, .motion = MPS_BODY_MOTION_FREE, .mass = 20.0, .inertia[2] = 0.2,
      .position[0] = 0.2, .position[1] = -0.05, .rotation[2] = 0.4);
  OK(mps_body_create_box(context, &body, 0.1, 0.3, &bodies[0]));
  body.position[0] = 0.1, body.position[1] = -0.2;
  OK(mps_body_create_disc(context, &body, 0.08, &bodies[1]));
  OK(mps_body_name_part(bodies[0], "face", 3, 1, NULL));
  for (int b = 0; b < 2; b++) {
    DEF(contact, contact, .friction = b == 0 ? 0.4 : 0.1, .corner = corner, .inset = inset);
    OK(mps_mpm_add_contact(s.mpm, bodies[b], &contact, NULL));
  }
  /* One step: what is written beside a body is a slope, not yet the moment of nodes. */
  OK(mps_mpm_step(s.mpm, 1));
  const mps_totals start = mpm_scene_totals(&s);
  double before[3] = {start.linear[0], start.linear[1], start.angular[2]};
  for (int b = 0; b < 2; b++) body_momentum(bodies[b], 20.0, 0.2, before);
  OK(mps_mpm_step(s.mpm, 400));
  const mps_totals end = mpm_scene_totals(&s);
  double after[3] = {end.linear[0], end.linear[1], end.angular[2]};
  mps_reaction face, all;
  OK(mps_body_get_reaction(bodies[0], -1, &all));
  OK(mps_body_get_reaction(bodies[0], 1, &face));
  assert_true(all.impulse[0] > 1.0); /* it has hit */
  assert_true(face.impulse[0] > 0.0);
  for (int b = 0; b < 2; b++) body_momentum(bodies[b], 20.0, 0.2, after);
  print_message("corner %g m, inset %g m: linear %.2g %.2g, angular %.2g\n", corner, inset,
                after[0] - before[0], after[1] - before[1], after[2] - before[2]);
  const double scale = hypot(before[0], before[1]);
  for (int c = 0; c < (flip_time > 0.0 ? 2 : 3); c++) NEAR(after[c], before[c], 1e-11 * scale);
  for (int b = 0; b < 2; b++) mps_body_destroy(&bodies[b]);
}

TEST(contact_keeps_momentum) {
  check_momentum(0.0, 0.0, 0.0);
  check_momentum(0.012, 0.0, 0.0);
  check_momentum(0.012, 0.0, 0.005);
  check_momentum(0.0, 0.012, 0.0);
  check_momentum(0.0, 0.012, 0.005);
}

/* The same in space: a ball of particles against a free rough sphere and a free rough plane. */
TEST(contact_in_space_keeps_momentum) {
  scoped_mpm_scene s = mpm_scene_begin_in(context, 3, 0.01, 0.0, 0.0, 1e5);
  const double v0[] = {2.0, -0.5, 0.3}, L[] = {0.0, -3.0, 2.0, 3.0, 0.0, 1.0, -2.0, -1.0, 0.0};
  const double centre[3] = {0.0, 0.0, 0.0}, normal[] = {0.2, 1.0, 0.1};
  OK(mps_particles_fill_ball(s.particles, centre, 0.05, NULL));
  mpm_scene_affine(&s, v0, L);
  USING(mpm, mpm_scene_solve(&s, &given), .geometry = MPS_MPM_GEOMETRY_SPACE, .cell = 0.02);
  mps_body *bodies[2] = {NULL};
  DEF(body, body, .motion = MPS_BODY_MOTION_FREE, .mass = 2.0);
  for (int c = 0; c < 3; c++) body.inertia[c] = 0.002 + 0.001 * c;
  body.position[0] = 0.12, body.position[1] = -0.01;
  OK(mps_body_create_sphere(context, &body, 0.06, &bodies[0]));
  body.position[0] = 0.0, body.position[1] = -0.06;
  OK(mps_body_create_half_space(context, &body, normal, &bodies[1]));
  for (int b = 0; b < 2; b++) mpm_scene_contact(&s, bodies[b], 0.4);
  OK(mps_mpm_step(s.mpm, 1)); /* as above */
  const mps_totals start = mpm_scene_totals(&s);
  double lost[3], turned[3], spin = 0.0;
  for (int c = 0; c < 3; c++) lost[c] = start.linear[c], turned[c] = start.angular[c];
  for (int b = 0; b < 2; b++) {
    mps_body_totals now;
    OK(mps_body_get_totals(bodies[b], &now));
    for (int c = 0; c < 3; c++) lost[c] += now.linear[c], turned[c] += now.angular[c];
  }
  OK(mps_mpm_step(s.mpm, 200));
  const mps_totals end = mpm_scene_totals(&s);
  for (int c = 0; c < 3; c++) lost[c] -= end.linear[c], turned[c] -= end.angular[c];
  for (int b = 0; b < 2; b++) {
    mps_body_totals now;
    mps_body_state at;
    mps_reaction all;
    OK(mps_body_get_state(bodies[b], &at));
    OK(mps_body_get_totals(bodies[b], &now));
    OK(mps_body_get_reaction(bodies[b], -1, &all));
    assert_true(length(all.impulse) > 0.05); /* it has hit */
    for (int c = 0; c < 3; c++) lost[c] -= now.linear[c], turned[c] -= now.angular[c];
    spin += length(at.spin);
    mps_body_destroy(&bodies[b]);
  }
  print_message("in space: linear %.2g of %.2g, angular %.2g\n", length(lost), length(start.linear),
                length(turned));
  assert_true(length(lost) <= 1e-12 * length(start.linear));
  assert_true(length(turned) <= 1e-12 * length(start.linear));
  assert_true(spin > 0.1); /* friction */
}

/* Two lumps on the two sides of a wall two cells thick: one strikes it, the other must not move at
 * all, however the wall lies in the grid. */
TEST(thin_wall_lets_nothing_pass) {
  for (int offset = 0; offset < 4; offset++) {
    const double h = 0.02, shift = 0.25 * h * offset;
    scoped_mpm_scene s = mpm_scene_begin(context, 0.01, shift, 0.0, 1e5);
    mpm_scene_box(&s, shift - 0.2, -0.1, shift, 0.1);
    mpm_scene_box(&s, shift + 2.0 * h, -0.1, shift + 0.2, 0.1);
    OK(mps_particles_add_field(s.particles, "velocity", 0));
    mps_view x = mpm_scene_view(&s, "position");
    mps_edit v = mpm_scene_edit(&s, "velocity");
    for (int64_t k = 0; k < x.shape[0]; k++)
      if (*mps_view_f64(&x, k, 0) < shift) *mps_edit_f64(&v, k, 0) = 1.0;
    mpm_scene_commit(&s, &v);
    USING(mpm, mpm_scene_solve(&s, &given), .cell = h);
    mps_body_def body = mps_body_defaults();
    body.position[0] =
        shift + h - 0.0005; /* off the lump at rest, which would be in contact by round-off */
    MAKE(body, wall, create_box, context, &body, 2.0 * h, 1.0);
    mpm_scene_contact(&s, wall, 0.3);
    OK(mps_mpm_step(s.mpm, 100));
    mps_reaction reaction;
    OK(mps_body_get_reaction(wall, -1, &reaction));
    assert_true(reaction.impulse[0] > 1.0);
    x = mpm_scene_view(&s, "position"), v.view = mpm_scene_view(&s, "velocity");
    for (int64_t k = 0; k < x.shape[0]; k++)
      if (*mps_view_f64(&x, k, 0) > shift + h)
        for (int c = 0; c < 2; c++) NEAR(*mps_view_f64(&v.view, k, c), 0.0, 0.0);
  }
}

/* ---- a node of hardly any mass --------------------------------------------------------------- */

/* A particle at (x, y) between two discs and, of `count` 2, one elsewhere, without contact, moving
 * at v: an empty step. */
static mpm_scene between_discs(int count, const double *at, const double *angle, const double *v,
                               double flip_time) {
  mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 1e5);
  const double L[] = {0.0, 0.0, 0.0, 0.0};
  OK(mps_particles_append(s.particles, count, at));
  mpm_scene_affine(&s, v, L);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.1, .dt = 1e-12, .flip_time = flip_time);
  for (int b = 0; b < 2; b++) {
    const double radius = 0.25, far = radius + 0.03; /* beyond the reach of the contact */
    DEF(body, disc, .position[0] = at[0] + far * cos(angle[b]),
        .position[1] = at[1] + far * sin(angle[b]));
    MAKE(body, body, create_disc, context, &disc, radius);
    USING(contact, mps_mpm_add_contact(s.mpm, body, &given, NULL), .offset = 0.0);
  }
  return s;
}

static bool has_light_nodes(const mps_mpm *mpm) {
  bool any = false;
  for (int64_t g = 0; g < mpm->grid.node_count; g++) any = any || mpm->grid.nodes[g].light;
  return any;
}

/* Momentum in a gap of 0.6 cells between two bodies: kept, also by nodes of negative mass and by
 * those to which the shape functions give hardly any. */
TEST(small_masses_keep_momentum) {
  int light = 0;
  double worst = 0.0;
  for (int k = 0; k < 1000; k++) {
    const double at[] = {uniform(0.5, 0.6), uniform(0.5, 0.6)};
    const double first = uniform(0.0, 6.2831853), apart = uniform(2.4, 3.14159);
    const double angle[] = {first, first + apart}, v[] = {0.6, -0.8};
    scoped_mpm_scene s = between_discs(1, at, angle, v, k % 2 ? 1e-9 : 0.0);
    OK(mps_mpm_step(s.mpm, 1));
    mps_view velocity = mpm_scene_view(&s, "velocity");
    for (int c = 0; c < 2; c++) worst = fmax(worst, fabs(*mps_view_f64(&velocity, 0, c) - v[c]));
    light += has_light_nodes(s.mpm);
  }
  print_message(
      "one particle between two discs: velocity kept to %.2g, light nodes in %d of 1000\n", worst,
      light);
  assert_true(worst <= 1e-13 && light > 10);
}

/* The same with a particle aside whose support nothing cuts, and a thin plate in the same block:
 * nothing lies across it, whatever did in an earlier step. */
TEST(thin_plates_elsewhere_change_nothing) {
  int light = 0;
  double worst = 0.0, lost = 0.0;
  for (int k = 0; k < 200; k++) {
    const double first = uniform(0.8, 2.3), apart = uniform(2.6, 3.14159), x = uniform(0.5, 0.6);
    const double aside = first + 0.5 * apart, v[] = {0.6, -0.8};
    const double at[] = {x, x, x + 0.4 * cos(aside), x + 0.4 * sin(aside)};
    const double angle[] = {first, first + apart};
    scoped_mpm_scene s = between_discs(2, at, angle, v, 0.0);
    scoped_body *body = NULL;
    DEF(body, plate, .position[0] = plate.position[1] = 0.05);
    OK(mps_body_create_box(context, &plate, 0.02, 0.06, &body));
    mpm_scene_contact(&s, body, 0.0);
    OK(mps_mpm_step(s.mpm, 1));
    assert_non_null(s.mpm->contact.across);
    for (int i = 0; i < 2; i++) s.mpm->contact.across[i] = (mpsi_parted){UINT64_MAX, UINT64_MAX};
    OK(mps_mpm_step(s.mpm, 1));
    mps_view velocity = mpm_scene_view(&s, "velocity");
    for (int c = 0; c < 2; c++) {
      const double one = *mps_view_f64(&velocity, 0, c), other = *mps_view_f64(&velocity, 1, c);
      worst = fmax(worst, fmax(fabs(one - v[c]), fabs(other - v[c])));
      lost = fmax(lost, fabs(one + other - 2.0 * v[c]));
    }
    light += has_light_nodes(s.mpm);
  }
  print_message(
      "beside a thin plate: momentum kept to %.2g, velocities to %.2g, light nodes in %d of "
      "200\n",
      lost, worst, light);
  assert_true(lost <= 1e-13 && worst <= 1e-4 && light > 2); /* a node's rest goes by weights */
}

/* A few particles at random between two free bodies, each with a velocity of its own, stress and
 * weight; `steps` of them, with contact. What the weight has given is known, the rest is kept. */
enum { FEW = 3 };
static int few_between_bodies(int dim, int spline, double *worst) {
  scoped_mpm_scene s = mpm_scene_begin_in(context, dim, 0.05, 0.0, 0.0, 1e5);
  const double zero[9] = {0.0}, r = 0.25, first = uniform(0.0, 6.2831853);
  const double angle[] = {first, first + uniform(2.4, 3.14159)}; /* to the bodies */
  double middle[3] = {0.0}, total = 0.0;
  int light = 0;
  for (int c = 0; c < dim; c++) middle[c] = uniform(0.5, 0.6);
  for (int k = 0; k < FEW; k++) {
    double x[3] = {0.0};
    for (int c = 0; c < dim; c++) x[c] = middle[c] + uniform(-0.01, 0.01);
    OK(mps_particles_append(s.particles, 1, x));
  }
  mpm_scene_affine(&s, zero, zero);
  EDIT(v, s.particles, "velocity")
    for (int k = 0; k < FEW; k++)
      for (int c = 0; c < dim; c++) *mps_edit_f64(&v, k, c) = uniform(-0.1, 0.1);
  DEF(mpm, def, .geometry = dim == 3 ? MPS_MPM_GEOMETRY_SPACE : MPS_MPM_GEOMETRY_PLANE_STRAIN,
      .spline = spline, .cell = 0.1, .dt = 5e-4, .gravity[1] = -1.0);
  mpm_scene_solve(&s, &def);
  mps_body *bodies[2] = {NULL};
  for (int b = 0; b < 2; b++) {
    DEF(body, ball, .motion = MPS_BODY_MOTION_FREE, .mass = 10.0);
    for (int c = dim == 3 ? 0 : 2; c < 3; c++) ball.inertia[c] = 0.2;
    for (int c = 0; c < dim; c++) ball.position[c] = middle[c];
    ball.position[0] += (r + 0.03) * cos(angle[b]);
    ball.position[1] += (r + 0.03) * sin(angle[b]);
    OK(dim == 3 ? mps_body_create_sphere(context, &ball, r, &bodies[b])
                : mps_body_create_disc(context, &ball, r, &bodies[b]));
    mpm_scene_contact(&s, bodies[b], 0.3);
  }
  for (int k = 0; k < 10; k++) {
    const double start = mps_mpm_time(s.mpm);
    double lost[3] = {0.0};
    for (int side = 1; side >= -1; side -= 2) { /* before, after */
      const mps_totals all = mpm_scene_totals(&s);
      total = all.mass;
      for (int c = 0; c < dim; c++) lost[c] += side * all.linear[c];
      for (int b = 0; b < 2; b++) {
        mps_body_totals now;
        OK(mps_body_get_totals(bodies[b], &now));
        for (int c = 0; c < dim; c++) lost[c] += side * now.linear[c];
      }
      if (side > 0) OK(mps_mpm_step(s.mpm, 1));
    }
    lost[1] += total * def.gravity[1] * (mps_mpm_time(s.mpm) - start);
    *worst = fmax(*worst, length(lost) / total);
    light += has_light_nodes(s.mpm);
  }
  for (int b = 0; b < 2; b++) mps_body_destroy(&bodies[b]);
  return light;
}

TEST(few_particles_keep_momentum) {
  for (int variant = 0; variant < 4; variant++) {
    const int dim = 2 + variant / 2, spline = 2 + variant % 2;
    double worst = 0.0;
    int light = 0;
    for (int k = 0; k < 40; k++) light += few_between_bodies(dim, spline, &worst);
    print_message(
        "%dD, spline %d, three particles between two free bodies: light nodes in %d of 400 "
        "steps, velocity of all lost %.2g m/s\n",
        dim, spline, light, worst);
    assert_true((light > 4 || spline == 2) && worst <= 1e-13);
  }
}
