/* test_material_umat.c - laws written as Abaqus UMATs: linear elastic and von Mises against the
 * library's own, along paths and in the solver; the arguments; refusals.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_allocator.h"

#include "material_paths.h"

#define E 1e7
#define NU 0.3

/* A UMAT's arguments; unused ones are named by (void). */
#define UMAT(name)                                                                                 \
  static void name(                                                                                \
      double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd,       \
      double *rpl, double *ddsddt, double *drplde, double *drpldt, const double *stran,            \
      const double *dstran, const double *time, const double *dtime, const double *temp,           \
      const double *dtemp, const double *predef, const double *dpred, const char *cmname,          \
      const int32_t *ndi, const int32_t *nshr, const int32_t *ntens, const int32_t *nstatv,        \
      const double *props, const int32_t *nprops, const double *coords, const double *drot,        \
      double *pnewdt, const double *celent, const double *dfgrd0, const double *dfgrd1,            \
      const int32_t *noel, const int32_t *npt, const int32_t *layer, const int32_t *kspt,          \
      const int32_t *kstep, const int32_t *kinc, size_t cmname_length)
#define UNUSED_ENERGIES (void)sse, (void)spd, (void)scd, (void)rpl, (void)ddsddt, (void)drplde
#define UNUSED_FIELDS (void)drpldt, (void)temp, (void)dtemp, (void)predef, (void)dpred
#define UNUSED_PLACE (void)coords, (void)noel, (void)npt, (void)layer, (void)kspt, (void)kstep
#define UNUSED_MOTION                                                                              \
  (void)time, (void)dtime, (void)drot, (void)dfgrd0, (void)dfgrd1, (void)celent, (void)kinc
#define UNUSED_NAMES (void)cmname, (void)cmname_length, (void)nprops, (void)nstatv

/* s += C:e, with the matrix of Abaqus' convention. */
static void add_elastic(const double *props, int32_t ndi, int32_t ntens, const double *e,
                        double *ddsdde, double *stress) {
  const double shear = props[0] / (2.0 * (1.0 + props[1]));
  const double lambda = 2.0 * shear * props[1] / (1.0 - 2.0 * props[1]);
  for (int32_t i = 0; i < ntens; i++)
    for (int32_t j = 0; j < ntens; j++) {
      double *c = &ddsdde[i + ntens * j];
      *c = i < ndi && j < ndi ? lambda : 0.0;
      if (i == j) *c += i < ndi ? 2.0 * shear : shear;
    }
  for (int32_t i = 0; i < ntens; i++)
    for (int32_t j = 0; j < ntens; j++) stress[i] += ddsdde[i + ntens * j] * e[j];
}

UMAT(elastic_umat) {
  UNUSED_ENERGIES, UNUSED_FIELDS, UNUSED_PLACE, UNUSED_MOTION, UNUSED_NAMES;
  (void)statev, (void)nshr, (void)stran, (void)pnewdt;
  add_elastic(props, *ndi, *ntens, dstran, ddsdde, stress);
}

/* The total strain, as laws of small strain do. */
UMAT(total_umat) {
  UNUSED_ENERGIES, UNUSED_FIELDS, UNUSED_PLACE, UNUSED_MOTION, UNUSED_NAMES;
  (void)statev, (void)nshr, (void)pnewdt;
  double e[6];
  for (int32_t c = 0; c < *ntens; c++) e[c] = stran[c] + dstran[c], stress[c] = 0.0;
  add_elastic(props, *ndi, *ntens, e, ddsdde, stress);
}

/* Radial return with linear hardening; STATEV(1) is the plastic strain. */
UMAT(mises_umat) {
  UNUSED_ENERGIES, UNUSED_FIELDS, UNUSED_PLACE, UNUSED_MOTION, UNUSED_NAMES;
  (void)nshr, (void)stran, (void)pnewdt;
  add_elastic(props, *ndi, *ntens, dstran, ddsdde, stress);
  const double shear = props[0] / (2.0 * (1.0 + props[1]));
  const double mean = (stress[0] + stress[1] + stress[2]) / 3.0;
  double square = 0.0;
  for (int32_t c = 0; c < *ntens; c++) {
    const double s = c < *ndi ? stress[c] - mean : stress[c];
    square += c < *ndi ? 1.5 * s * s : 3.0 * s * s;
  }
  const double mises = sqrt(square), f = mises - (props[2] + props[3] * statev[0]);
  if (f <= 0.0) return;
  const double strain = f / (3.0 * shear + props[3]), keep = 1.0 - 3.0 * shear * strain / mises;
  for (int32_t c = 0; c < *ntens; c++) {
    const double m = c < *ndi ? mean : 0.0;
    stress[c] = m + keep * (stress[c] - m);
  }
  statev[0] += strain;
}

static const double constants[4] = {E, NU, 2e4, 1e6};

static mps_material_umat_def umat_of(mps_material_umat_fn call, int32_t statev_count) {
  DEF(material_umat, def, .umat = call, .statev_count = statev_count, .props = constants,
      .props_count = 4, .wave_modulus = E * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU)));
  return def;
}

static mps_material *make_umat(mps_material_umat_fn call, int32_t statev_count) {
  const mps_material_umat_def def = umat_of(call, statev_count);
  MAKE_KEPT(material, material, create_umat, context, &def);
  return material;
}

static mps_material *make_own(bool mises) {
  DEF(material_von_mises, def, .young = E, .poisson = NU, .yield_stress = 2e4, .hardening = 1e6);
  mps_material *material = NULL;
  OK(mises ? mps_material_create_von_mises(context, &def, &material)
           : mps_material_create_linear_elastic(context, E, NU, &material));
  return material;
}

/* ---- against the library's laws -------------------------------------------------------------- */

#define COUNT 40

/* Columns of a block, with random state and rates; in plane strain (kind 0), axisymmetry (1) or
 * 3D (2). */
typedef struct state {
  double gradient[9][COUNT], stress[6][COUNT], history[32][COUNT];
  double volume[COUNT], *column[32];
  int64_t flags[COUNT];
} state;

static mps_material_block block_of(state *s, const mps_material *material, int kind) {
  const int32_t dim = kind == 2 ? 3 : 2;
  uint64_t seed = 3;
  mps_material_block block = {.struct_size = sizeof block, .dim = dim, .count = COUNT, .dt = 1e-3};
  memset(s, 0, sizeof *s);
  for (int c = 0; c < 9; c++) {
    const bool there = kind == 2 || c == 0 || c == 1 || c == 3 || c == 4 || (c == 8 && kind == 1);
    for (int k = 0; k < COUNT; k++) s->gradient[c][k] = 2.0 * noise(&seed);
    if (there) block.gradient[c] = s->gradient[c];
  }
  for (int c = 0; c < 2 * dim; c++) {
    for (int k = 0; k < COUNT; k++) s->stress[c][k] = 1e3 * noise(&seed);
    block.stress[c] = s->stress[c];
  }
  for (int k = 0; k < COUNT; k++) s->volume[k] = 1.0;
  for (int c = 0; c < 32; c++) s->column[c] = s->history[c];
  block.history = s->column, block.history_count = mps_material_history_count(material);
  block.volume_ratio = s->volume;
  block.flags = s->flags;
  return block;
}

TEST(umats_agree_with_the_librarys_laws) {
  for (int mises = 0; mises < 2; mises++)
    for (int kind = 0; kind < 3; kind++) {
      scoped_material *umat = make_umat(mises ? mises_umat : elastic_umat, mises);
      scoped_material *own = make_own(mises);
      static state a, b;
      const mps_material_block x = block_of(&a, umat, kind), y = block_of(&b, own, kind);
      int plastic = 0;
      for (int step = 0; step < 50; step++) {
        OK(mps_material_update(context, umat, &x));
        OK(mps_material_update(context, own, &y));
      }
      for (int k = 0; k < COUNT; k++) {
        for (int c = 0; c < 2 * x.dim; c++) NEAR(a.stress[c][k], b.stress[c][k], 1e-12 * 1e6);
        NEAR(a.volume[k], b.volume[k], 1e-14);
        if (mises) NEAR(a.history[0][k], b.history[0][k], 1e-13);
        plastic += mises && b.history[0][k] > 0.0;
      }
      assert_true(!mises || plastic > COUNT / 2);
    }
}

/* STRAN turns with the particle: a strained body that is then turned has the turned stress. */
TEST(total_strain_turns_with_the_particle) {
  scoped_material *umat = make_umat(total_umat, 0), *own = make_own(false);
  mps_material_point a = point_under(umat, 0.0), b = point_under(own, 0.0);
  const double strain[9] = {1e-3, 4e-4, 0, 2e-4, -5e-4, 0, 1e-4, 0, 2e-4};
  const double spin[9] = {0, -0.8, 0.3, 0.8, 0, 0.5, -0.3, -0.5, 0};
  for (int turn = 0; turn < 2; turn++) {
    OK(mps_material_point_drive(context, umat, &a, turn ? spin : strain, 1, 9));
    OK(mps_material_point_drive(context, own, &b, turn ? spin : strain, 1, 9));
    for (int c = 0; c < 6; c++) NEAR(a.stress[c], b.stress[c], 1e-12 * 1e4);
  }
}

/* A bar that strikes a wall, 100 steps of the solver: the same motion, and history in fields. */
TEST(a_umat_works_in_the_solver) {
  mps_view x[2];
  mpm_scene s[2];
  for (int own = 0; own < 2; own++) {
    const double v0[2] = {0.0, -2.0}, still[4] = {0};
    s[own] = mpm_scene_begin(context, 0.05, 0.0, 0.0, E);
    mps_material_destroy(&s[own].material);
    s[own].material = own ? make_own(true) : make_umat(mises_umat, 1);
    mpm_scene_box(&s[own], 0.4, 0.0, 0.8, 1.0);
    mpm_scene_affine(&s[own], v0, still);
    DEF(mpm, def, .cell = 0.1);
    def.volumetric = MPS_MPM_VOLUMETRIC_POINT; /* by law von Mises takes means */
    def.flip_time = 0.0;                       /* von Mises has a default of its own */
    def.lower[1] = 0.0;
    mpm_scene_solve(&s[own], &def);
    OK(mps_mpm_step(s[own].mpm, 100));
    x[own] = mpm_scene_view(&s[own], "position");
  }
  mps_view strain = mpm_scene_view(&s[0], "umat.statev_1"),
           steps = mpm_scene_view(&s[0], "umat.umat_steps");
  mps_view time = mpm_scene_view(&s[0], "umat.umat_time"),
           own = mpm_scene_view(&s[1], "plastic_strain");
  double largest = 0.0;
  for (int64_t k = 0; k < x[0].shape[0]; k++) {
    for (int c = 0; c < 2; c++) NEAR(*mps_view_f64(&x[0], k, c), *mps_view_f64(&x[1], k, c), 1e-11);
    NEAR(*mps_view_f64(&strain, k, 0), *mps_view_f64(&own, k, 0), 1e-10);
    NEAR(*mps_view_f64(&steps, k, 0), 100.0, 0.0);
    NEAR(*mps_view_f64(&time, k, 0), mps_mpm_time(s[0].mpm), 1e-12);
    largest = fmax(largest, *mps_view_f64(&strain, k, 0));
  }
  assert_true(largest > 1e-3);
  mpm_scene_end(&s[0]);
  mpm_scene_end(&s[1]);
}

/* ---- arguments ------------------------------------------------------------------------------- */

/* Last arguments of the UMAT. C has no other way out of a UMAT: it has no pointer of its user. */
static struct spied {
  double stress[6], drot[9], f0[9], f1[9], dstran[6], stran[6], time[2], dtime, temp, celent;
  int32_t ndi, nshr, ntens, nstatv, nprops, kstep, kinc;
  char cmname[81];
} spied;

UMAT(spy_umat) {
  UNUSED_ENERGIES, (void)drpldt, (void)dtemp, (void)predef, (void)dpred, (void)ddsdde;
  (void)coords, (void)noel, (void)npt, (void)layer, (void)kspt;
  memcpy(spied.stress, stress, (size_t)*ntens * sizeof *stress);
  memcpy(spied.drot, drot, sizeof spied.drot);
  memcpy(spied.f0, dfgrd0, sizeof spied.f0);
  memcpy(spied.f1, dfgrd1, sizeof spied.f1);
  memcpy(spied.dstran, dstran, (size_t)*ntens * sizeof *dstran);
  memcpy(spied.stran, stran, (size_t)*ntens * sizeof *stran);
  memcpy(spied.time, time, sizeof spied.time);
  memcpy(spied.cmname, cmname, cmname_length);
  spied.dtime = *dtime, spied.temp = *temp, spied.celent = *celent;
  spied.ndi = *ndi, spied.nshr = *nshr, spied.ntens = *ntens;
  spied.nstatv = *nstatv, spied.nprops = *nprops, spied.kstep = *kstep, spied.kinc = *kinc;
  if (props[0] == 1.0) *pnewdt = 0.5;
  if (props[0] == 2.0) stress[1] = NAN;
  statev[1] += 1.0;
}

static void multiply(const double *a, const double *b, bool transpose, double *out) {
  for (int i = 0; i < 3; i++) /* by columns: (i, j) at i + 3 j */
    for (int j = 0; j < 3; j++) {
      out[i + 3 * j] = 0.0;
      for (int k = 0; k < 3; k++)
        out[i + 3 * j] += a[i + 3 * k] * (transpose ? b[j + 3 * k] : b[k + 3 * j]);
    }
}

TEST(arguments_are_those_of_abaqus) {
  static const char *const names[] = {"void_ratio", "calls"};
  static const double initial[] = {0.7, 0.0};
  mps_material_umat_def def = umat_of(spy_umat, 2);
  def.name = "Clay_1", def.statev_names = names, def.statev_initial = initial;
  def.needs_deformation = 1, def.length = 0.25, def.temperature = 20.0;
  MAKE(material, material, create_umat, context, &def);
  assert_string_equal(mps_material_name(material), "Clay_1");
  assert_int_equal(mps_material_history_count(material), 10);
  assert_string_equal(mps_material_history_name(material, 0), "void_ratio");
  assert_string_equal(mps_material_history_name(material, 2), "umat_time");
  mps_material_point point = point_under(material, -1e3);
  point.stress[0] = 5e3, point.stress[3] = 2e3, point.stress[4] = -1e3, point.stress[5] = 700.0;
  const double gradient[9] = {0.1, 0.5, -0.3, -0.2, 0.05, 0.4, 0.6, -0.1, -0.2};
  OK(mps_material_point_drive(context, material, &point, gradient, 0.5, 1));
  const mps_material_point before = point;
  OK(mps_material_point_drive(context, material, &point, gradient, 0.25, 1));
  /* STRESS comes turned by DROT */
  const double *s = before.stress;
  const double old[9] = {s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2]};
  double turned[9], half[9], unit[9], step[9], now[9];
  multiply(spied.drot, old, false, half);
  multiply(half, spied.drot, true, turned);
  multiply(spied.drot, spied.drot, true, unit);
  static const int at[6] = {0, 4, 8, 3, 6, 7}; /* 11, 22, 33, 12, 13, 23 by columns */
  for (int c = 0; c < 6; c++) NEAR(spied.stress[c], turned[at[c]], 1e-11);
  for (int c = 0; c < 9; c++) NEAR(unit[c], c % 4 == 0, 1e-15);
  /* DFGRD1 = (1 + dt L) DFGRD0, which are those of the point */
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      step[i + 3 * j] = (i == j) + 0.25 * gradient[3 * i + j];
      NEAR(spied.f0[i + 3 * j], before.deformation[3 * i + j], 1e-15);
      NEAR(spied.f1[i + 3 * j], point.deformation[3 * i + j], 0.0);
    }
  multiply(step, spied.f0, false, now);
  for (int c = 0; c < 9; c++) NEAR(spied.f1[c], now[c], 1e-15);
  const double dstran[6] = {0.1, 0.05, -0.2, 0.3, 0.3, 0.3}; /* shear: sums of both */
  for (int c = 0; c < 6; c++) NEAR(spied.dstran[c], 0.25 * dstran[c], 1e-16);
  NEAR(spied.stran[0] + spied.stran[1] + spied.stran[2], 0.5 * (0.1 + 0.05 - 0.2), 1e-16);
  assert_true(spied.time[0] == 0.5 && spied.time[1] == 0.5 && spied.dtime == 0.25);
  assert_true(spied.temp == 20.0 && spied.celent == 0.25);
  assert_true(spied.ndi == 3 && spied.nshr == 3 && spied.ntens == 6);
  assert_true(spied.nstatv == 2 && spied.nprops == 4 && spied.kstep == 1 && spied.kinc == 2);
  assert_true(strncmp(spied.cmname, "Clay_1  ", 8) == 0 && spied.cmname[79] == ' ');
  assert_true(point.history[0] == 0.7 && point.history[1] == 2.0);
  static state flat;
  const mps_material_block block = block_of(&flat, material, 1);
  mps_material_block deformed = block;
  for (int c = 0; c < 9; c++)
    if (c == 8 || block.gradient[c]) deformed.deformation[c] = flat.history[20 + c];
  for (int c = 0; c < 9; c += 4)
    for (int k = 0; k < COUNT; k++) flat.history[20 + c][k] = 1.0; /* no strain yet */
  OK(mps_material_update(context, material, &deformed));
  assert_true(spied.ndi == 3 && spied.nshr == 1 && spied.ntens == 4);
}

/* ---- refusals -------------------------------------------------------------------------------- */

TEST(a_umat_may_refuse) {
  for (int what = 1; what <= 2; what++) {
    const double props[] = {what}, gradient[9] = {1.0};
    mps_material_umat_def def = umat_of(spy_umat, 2);
    def.props = props, def.props_count = 1;
    MAKE(material, material, create_umat, context, &def);
    mps_material_point point = point_under(material, 0.0), before = point;
    FAILS(mps_material_point_drive(context, material, &point, gradient, 1.0, 1), MPS_ERROR_NUMERIC,
          what == 1 ? "smaller step (PNEWDT)" : "STRESS or STATEV is not finite");
    assert_memory_equal(&point, &before, sizeof point);
  }
}

TEST(bad_definitions_are_refused) {
  static const char *const twice[] = {"a", "umat_time"};
#define REFUSED(member, value, text)                                                               \
  do {                                                                                             \
    mps_material_umat_def def = umat_of(spy_umat, 2);                                              \
    mps_material *m = NULL;                                                                        \
    def.member = value;                                                                            \
    REFUSES(mps_material_create_umat(context, &def, &m), text);                                    \
    assert_null(m);                                                                                \
  } while (0)
  REFUSED(statev_names, twice, "are both 'umat_time'");
  REFUSED(name, "a b", "name is 'a b'");
}

static mps_status make_and_destroy(mps_context *own, int what) {
  const mps_material_umat_def def = umat_of(mises_umat, what);
  scoped_material *material = NULL;
  const mps_status status = mps_material_create_umat(own, &def, &material);
  assert_true((material != NULL) == (status == MPS_OK));
  return status;
}

TEST(refused_memory_leaves_nothing_behind) { test_allocator_sweep(make_and_destroy, 1); }
