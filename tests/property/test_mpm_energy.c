/* test_mpm_energy.c - the energy budget of WLS-MPM closes wherever particles lie: beside sides
 * where nodes end, where shape functions of the fit give nodes a negative mass, and with bodies
 * that move freely, whose work is minus that of the particles on them.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

static double uniform(uint64_t *seed) { /* 0 to 1: SplitMix64 */
  uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* The residual as a part of the sizes of all terms. */
static double open_part(mpm_scene *s, double start) {
  mps_mpm_energy_report l;
  OK(mps_mpm_get_energy_report(s->mpm, &l));
  const mps_totals t = mpm_scene_totals(s);
  const double size = fabs(t.kinetic - start) + fabs(t.strain) + fabs(t.work_loads) +
                      fabs(t.work_boundaries) + fabs(t.work_bodies) + fabs(l.laws) +
                      fabs(l.boundaries) + fabs(l.bodies) + fabs(l.damping) + fabs(l.transfer) +
                      fabs(l.stepping) + fabs(l.strain);
  assert_true(size > 0.0);
  return fabs(l.residual) / size;
}

enum { CELLS = 8 };

/* Particles anywhere between the sides, the outermost at less than a tenth of a cell. */
static void scatter(mpm_scene *s, int32_t geometry, uint64_t *seed) {
  const int dim = mps_particles_dim(s->particles);
  OK(mps_particles_add_field(s->particles, "velocity", 0));
  EDIT(x, s->particles, "position")
    for (int64_t k = 0; k < x.view.shape[0]; k++)
      for (int c = 0; c < dim; c++) {
        const double place = k % 3 == 0 ? 0.1 * uniform(seed) : CELLS * uniform(seed);
        const bool lower = geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && c == 0 ? false : k % 2 == 0;
        *mps_edit_f64(&x, k, c) = 1.0 + 0.1 * (lower ? place : CELLS - place);
      }
  EDIT(v, s->particles, "velocity")
    for (int64_t k = 0; k < v.view.shape[0]; k++)
      for (int c = 0; c < dim; c++) *mps_edit_f64(&v, k, c) = 0.4 * (uniform(seed) - 0.5);
}

static double run_scattered(int32_t geometry, int32_t spline, int32_t walls, uint64_t seed) {
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  scoped_mpm_scene s = mpm_scene_begin_in(context, dim, 0.1, 1.0, 1.0, 1e5);
  const double lo[] = {1.0, 1.0, 1.0}, hi[] = {1.8, 1.8, dim == 3 ? 1.3 : 1.8};
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  scatter(&s, geometry, &seed);
  DEF(mpm, def, .geometry = geometry, .spline = spline, .edge = walls, .cell = 0.1, .budget = 1,
      .courant = 0.2, .gravity[1] = -9.81);
  for (int c = 0; c < dim; c++) def.lower[c] = 1.0, def.upper[c] = 1.8;
  mpm_scene_solve(&s, &def);
  for (int32_t side = 0; side < 2 * dim; side++)
    if (walls == MPS_MPM_EDGE_MIRROR || side % 2 == 1)
      mpm_scene_side(&s, side, MPS_BOUNDARY_FREE, 0.0);
  const double start = mpm_scene_totals(&s).kinetic;
  double most = 0.0;
  for (int step = 0; step < 6; step++) {
    if (mps_mpm_step(s.mpm, 1) != MPS_OK) break; /* one has left by a free edge */
    most = fmax(most, open_part(&s, start));
  }
  return most;
}

TEST(closes_beside_free_sides) {
  for (int32_t geometry = MPS_MPM_GEOMETRY_PLANE_STRAIN; geometry <= MPS_MPM_GEOMETRY_SPACE;
       geometry++)
    for (int32_t spline = 2; spline <= 3; spline++)
      for (int32_t walls = MPS_MPM_EDGE_MIRROR; walls <= MPS_MPM_EDGE_FIT; walls++) {
        double most = 0.0;
        const int seeds = geometry == MPS_MPM_GEOMETRY_SPACE ? 4 : 16;
        for (int seed = 0; seed < seeds; seed++)
          most = fmax(most, run_scattered(geometry, spline, walls, (uint64_t)seed));
        print_message("geometry %d, spline %d, walls %d: open part %.2g\n", geometry, spline, walls,
                      most);
        assert_true(most < 1e-12);
      }
}

/* A disc falls on soil and rolls: what the particles do on it is minus what it does on them. */
TEST(works_between_soil_and_bodies_cancel) {
  for (int32_t method = MPS_CONTACT_METHOD_IMPULSE; method <= MPS_CONTACT_METHOD_PENALTY; method++)
    for (uint64_t seed = 0; seed < 3; seed++) {
      scoped_mpm_scene s = mpm_scene_begin(context, 0.02, 0.0, 0.0, 1e6);
      mps_material_destroy(&s.material);
      USING(material_mohr_coulomb, mps_material_create_mohr_coulomb(context, &given, &s.material),
            .young = 1e6, .friction = 0.5, .dilation = 0.2, .cohesion = 2e3);
      mpm_scene_box(&s, 0.0, 0.0, 0.8, 0.2);
      DEF(mpm, def, .cell = 0.04, .budget = 1, .gravity[1] = -9.81);
      def.volumetric = (int32_t)seed; /* each option */
      def.lower[0] = def.lower[1] = 0.0, def.upper[0] = 0.8, def.upper[1] = 1.0;
      mpm_scene_solve(&s, &def);
      uint64_t state_of = seed;
      scoped_body *body = NULL;
      DEF(body, disc, .motion = MPS_BODY_MOTION_FREE, .mass = 20.0 + 20.0 * uniform(&state_of),
          .inertia[2] = 0.1, .position[0] = 0.3 + 0.2 * uniform(&state_of), .position[1] = 0.305,
          .velocity[0] = uniform(&state_of), .velocity[1] = -1.0,
          .spin[2] = 4.0 * uniform(&state_of) - 2.0, .gravity[1] = -9.81,
          .damping[0] = disc.damping[1] = seed == 2 ? 1.0 : 0.0);
      OK(mps_body_create_disc(context, &disc, 0.1, &body));
      DEF(contact, contact, .method = method, .friction = 0.4);
      OK(mps_mpm_add_contact(s.mpm, body, &contact, NULL));
      mps_body_totals b;
      OK(mps_body_get_totals(body, &b));
      const double start = mpm_scene_totals(&s).kinetic + b.kinetic;
      OK(mps_mpm_run(s.mpm, 0.08, 1, NULL, NULL));
      const mps_totals t = mpm_scene_totals(&s);
      OK(mps_body_get_totals(body, &b));
      const double sum = t.work_bodies + b.work_contacts;
      const double all = t.kinetic + t.strain + t.dissipated + b.kinetic + b.dissipated -
                         t.work_loads - t.work_boundaries - b.work_loads;
      print_message(
          "on the disc %.6g J, on the soil %.6g J, sum %.2g; soil and disc %.2g of %.4g\n",
          b.work_contacts, t.work_bodies, sum, all - start, start);
      assert_true(fabs(b.work_contacts) > 1.0); /* the disc was stopped */
      assert_true(fabs(sum) < 1e-12 * fabs(b.work_contacts));
      assert_true(fabs(all - start) < 1e-11 * start);
      assert_true(open_part(&s, 0.0) < 1e-12);
    }
}
