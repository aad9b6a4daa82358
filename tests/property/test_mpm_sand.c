/* test_mpm_sand.c - dilatant sand under a rigid strip with every volumetric option: motion and
 * force stay bounded, the energy budget closes, and what is smoothed by node does not depend on
 * threads, restarts or the sides of a thin wall. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "pthread_executor.h"
#include "test_fixture.h"

#define DEGREE 0.017453292519943295

typedef struct sand {
  int32_t dim, volumetric, spline;
  double dilation; /* degrees */
  bool cone;       /* Drucker-Prager's law in place of Mohr-Coulomb's */
  bool layer;      /* elastic ground below */
} sand;

static mps_material *make_sand(mps_context *own, const sand *c) {
  mps_material *out = NULL;
  if (c->cone) {
    USING(material_drucker_prager, mps_material_create_drucker_prager(own, &given, &out),
          .young = 1e8, .friction = 30.0 * DEGREE, .dilation = c->dilation * DEGREE,
          .cohesion = 1e4);
    return out;
  }
  USING(material_mohr_coulomb, mps_material_create_mohr_coulomb(own, &given, &out), .young = 1e8,
        .friction = 30.0 * DEGREE, .dilation = c->dilation * DEGREE, .cohesion = 1e4);
  return out;
}

/* A strip, in 3D a ball, is driven into the sand at 0.1 m/s. */
static mpm_scene begin(mps_context *own, const sand *c, mps_body **strip) {
  const double h = c->dim == 3 ? 0.1 : 0.05;
  mpm_scene s = mpm_scene_begin_in(own, c->dim, 0.5 * h, 0.0, 0.0, 1e8);
  const double lo[] = {0.0, 0.0, 0.0}, hi[] = {1.0, 0.5, 0.2};
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  DEF(mpm, def, .cell = h, .volumetric = c->volumetric, .spline = c->spline, .budget = 1,
      .geometry = c->dim == 3 ? MPS_MPM_GEOMETRY_SPACE : MPS_MPM_GEOMETRY_PLANE_STRAIN);
  const double top[] = {1.0, 0.8, 0.2};
  for (int a = 0; a < c->dim; a++) def.lower[a] = 0.0, def.upper[a] = top[a];
  mps_material *law = make_sand(own, c), *at_first = c->layer ? s.material : law;
  OK(mps_mpm_create(own, s.particles, at_first, &def, &s.mpm));
  if (c->layer) { /* the sand lies on elastic ground */
    int64_t ids[800], count = 0;
    mps_view x = mpm_scene_view(&s, "position"), id = mpm_scene_view(&s, "id");
    for (int64_t k = 0; k < x.shape[0] && count < 800; k++)
      if (*mps_view_f64(&x, k, 1) > 0.25) ids[count++] = *mps_view_i64(&id, k, 0);
    OK(mps_mpm_set_material(s.mpm, law, ids, count));
  }
  mps_material_destroy(&law);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  DEF(body, body, .position[1] = c->dim == 3 ? 0.65 : 0.55, .position[2] = c->dim == 3 ? 0.1 : 0.0);
  const double corners[] = {-0.15, -0.05, 0.15, -0.05, 0.15, 0.05, -0.15, 0.05};
  if (c->dim == 3)
    OK(mps_body_create_sphere(own, &body, 0.15, strip));
  else
    OK(mps_body_create_polygon(own, &body, 4, corners, strip));
  const double t[] = {0.0, 1.0}, v[] = {-0.1, -0.1};
  MAKE(signal, down, create_table, own, MPS_SIGNAL_QUANTITY_VELOCITY, 2, t, v);
  OK(mps_body_drive(*strip, 1, down, 1.0));
  mpm_scene_contact(&s, *strip, 0.5);
  return s;
}

static void end(mpm_scene *s, mps_body **strip) {
  mpm_scene_end(s);
  mps_body_destroy(strip);
}

/* The kinetic energy and the force at a path of 6 mm. */
static void press(const sand *c, double *kinetic, double *force) {
  mps_body *strip = NULL;
  mpm_scene s = begin(context, c, &strip);
  mps_reaction r;
  mps_mpm_energy_report l;
  OK(mps_mpm_run(s.mpm, 0.06, 1, NULL, NULL));
  OK(mps_body_get_reaction(strip, -1, &r));
  OK(mps_mpm_get_energy_report(s.mpm, &l));
  const mps_totals t = mpm_scene_totals(&s);
  *kinetic = t.kinetic, *force = r.force[1];
  print_message("%dD psi %g, cone %d, volumetric %d, spline %d: %.4g J, %.4g N; V %.6g; residual "
                "%.2g J of %.4g\n",
                c->dim, c->dilation, c->cone, c->volumetric, c->spline, t.kinetic, r.force[1],
                t.volume, l.residual, t.work_bodies);
  assert_true(fabs(l.residual) < 1e-11 * (fabs(t.work_bodies) + fabs(t.strain)));
  end(&s, &strip);
}

/* Every option against each particle's own change of volume. */
static void compare_options(sand c) {
  enum { OWN = MPS_MPM_VOLUMETRIC_POINT, OPTIONS = MPS_MPM_VOLUMETRIC_NODES + 1 };
  double kinetic[OPTIONS], force[OPTIONS];
  for (c.volumetric = 0; c.volumetric < OPTIONS; c.volumetric++)
    press(&c, &kinetic[c.volumetric], &force[c.volumetric]);
  for (int option = 0; option < OPTIONS; option++) {
    assert_true(kinetic[option] < 1.2 * kinetic[OWN]);
    assert_true(force[option] > 0.85 * force[OWN] && force[option] < 1.1 * force[OWN]);
  }
}

TEST(dilatant_sand_stays_bounded) {
  static const double dilations[] = {0.0, 10.0, 30.0};
  for (int32_t law = 0; law < 3; law++) /* the third: Mohr-Coulomb with cubic splines */
    for (int k = 0; k < 3; k++) {
      const sand c = {2, MPS_MPM_VOLUMETRIC_POINT, law == 2 ? 3 : 2, dilations[k], law == 1, false};
      compare_options(c);
    }
}

TEST(dilatant_sand_stays_bounded_in_space) {
  const sand c = {3, MPS_MPM_VOLUMETRIC_POINT, 2, 30.0, false, false};
  compare_options(c);
}

static void same_field(mpm_scene *a, mpm_scene *b, const char *name) {
  mps_view va = mpm_scene_view(a, name), vb = mpm_scene_view(b, name);
  assert_int_equal(va.shape[0], vb.shape[0]);
  for (int64_t k = 0; k < va.shape[0]; k++)
    for (int64_t c = 0; c < va.shape[1]; c++)
      assert_memory_equal(mps_view_f64(&va, k, c), mps_view_f64(&vb, k, c), 8);
}

/* The bits are those of one thread, and of a run that was taken back between two smoothings. */
TEST(threads_and_restarts_change_nothing) {
  static const char *const fields[] = {"position", "velocity", "stress",
                                       "volume",   "opening",  "plastic_strain"};
  for (int layer = 0; layer < 2; layer++) {
    const sand c = {2, MPS_MPM_VOLUMETRIC_NODES, 2, 10.0, false, layer == 1};
    mps_body *strip[2] = {NULL, NULL};
    scoped_context *other = test_context(MPS_CONTEXT_EXECUTOR_THREADS, 3);
    mpm_scene one = begin(context, &c, &strip[0]), three = begin(other, &c, &strip[1]);
    scoped_snapshot *snapshot = NULL;
    OK(mps_mpm_step(one.mpm, 93));
    OK(mps_mpm_step(three.mpm, 43)); /* 43 = 5 x 8 + 3 */
    OK(mps_mpm_snapshot(three.mpm, &snapshot));
    OK(mps_mpm_step(three.mpm, 30));
    OK(mps_mpm_rollback(three.mpm, snapshot));
    OK(mps_mpm_step(three.mpm, 50));
    for (int f = 0; f < 6; f++) same_field(&one, &three, fields[f]);
    end(&one, &strip[0]);
    end(&three, &strip[1]);
  }
}
