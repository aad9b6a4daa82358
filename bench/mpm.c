/* create.c - benchmark of the WLS-MPM step: ns per particle-step of the library beside the anchor
 * of mpm_anchor.h, a bare step of the same equations for full supports. All contenders are timed in
 * turn, in rounds, in one process; minima are compared, so that the ratios hold when the machine's
 * speed drifts.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "measure.h"
#include "mpm_anchor.h"

#include <mps/mpm.h>
#include <mps/experimental/pore_water.h>
#include <mps/soil.h>
#include <mps/experimental/soil.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DENSITY 1600.0 /* kg/m3 */
#define YOUNG 1e7      /* Pa */
#define POISSON 0.3
#define SPEED 0.02 /* m/s, of the waves in the block: Drucker-Prager particles yield in part */
#define WAVE 0.3   /* rad/m */
#define LARGE 2000000

typedef struct options {
  int dim, spline; /* 0: both */
  int rounds;
  int only;                  /* a kind, -1: all */
  int32_t instruction_level; /* of the library; 0: the processor's */
  int64_t particles;         /* 0: 1e4, 1e5 and 1e6 */
} options;

/* ---- the anchor ------------------------------------------------------------------------------ */

static anchor make_anchor(int dim, int spline, int64_t side) {
  const double wave =
      sqrt(YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON)) / DENSITY);
  return anchor_create(dim, spline, side, 1.0, DENSITY, YOUNG, POISSON, 0.3 / wave);
}

static void anchor_waves(anchor *a) {
  for (int c = 0; c < a->dim; c++)
    for (int64_t p = 0; p < a->count; p++)
      a->column[ANCHOR_V + c][p] = SPEED * sin(WAVE * a->column[ANCHOR_X + (c + 1) % a->dim][p]);
}

/* The anchor is a yardstick only if it does the work: an affine velocity comes back from the grid,
 * and a vibrating block keeps its momentum while its stresses do work. */
static void check_anchor(int dim, int spline) {
  anchor a = make_anchor(dim, spline, 9);
  double affine = 0.0, before[3] = {0}, after[3] = {0}, sum = 0.0, drift = 0.0, stress = 0.0;
  for (int64_t p = 0; p < a.count; p++)
    for (int i = 0; i < dim; i++) {
      a.column[ANCHOR_V + i][p] = 0.1 * (i + 1);
      for (int j = 0; j < dim; j++) {
        a.column[ANCHOR_L + 3 * i + j][p] = 0.01 * (1 + i) * (2 - j);
        a.column[ANCHOR_V + i][p] += 0.01 * (1 + i) * (2 - j) * a.column[ANCHOR_X + j][p];
      }
    }
  anchor b = make_anchor(dim, spline, 9); /* to know the velocities before the step */
  memcpy(b.memory, a.memory, (size_t)((char *)a.node - (char *)a.memory));
  anchor_step(&a, 1);
  for (int64_t p = 0; p < a.count; p++)
    for (int i = 0; i < dim; i++) {
      affine = fmax(affine, fabs(a.column[ANCHOR_V + i][p] - b.column[ANCHOR_V + i][p]));
      for (int j = 0; j < dim; j++)
        affine = fmax(affine, fabs(a.column[ANCHOR_L + 3 * i + j][p] - 0.01 * (1 + i) * (2 - j)));
    }
  anchor_free(&b);
  anchor_free(&a);
  a = make_anchor(dim, spline, 9);
  anchor_waves(&a);
  for (int64_t p = 0; p < a.count; p++)
    for (int c = 0; c < dim; c++) {
      before[c] += a.column[ANCHOR_MASS][p] * a.column[ANCHOR_V + c][p];
      sum += a.column[ANCHOR_MASS][p] * fabs(a.column[ANCHOR_V + c][p]);
    }
  anchor_step(&a, 200);
  for (int64_t p = 0; p < a.count; p++) {
    stress = fmax(stress, fabs(a.column[ANCHOR_S + 3][p]));
    for (int c = 0; c < dim; c++) after[c] += a.column[ANCHOR_MASS][p] * a.column[ANCHOR_V + c][p];
  }
  for (int c = 0; c < dim; c++) drift = fmax(drift, fabs(after[c] - before[c]) / sum);
  printf("# anchor %dD, spline %d: affine field to %.1e, momentum after 200 steps to %.1e, largest "
         "shear stress then %.3g Pa\n",
         dim, spline, affine, drift, stress);
  anchor_free(&a);
  if (affine < 1e-12 && drift < 1e-12 && stress > 1.0 && stress < 1e6) return;
  fprintf(stderr, "bench: the anchor is wrong\n");
  exit(1);
}

/* ---- the library ----------------------------------------------------------------------------- */

typedef enum kind {
  ELASTIC,
  TWO_THREADS,
  MIXED,
  BODY,
  DRUCKER_PRAGER,
  UNDRAINED,
  SEEPAGE,
  CAM_CLAY,
  SMALL_STRAIN,
  KINDS
} kind;
static const char *const kind_name[KINDS] = {"elastic",        "two",       "mixed",   "body",
                                             "drucker-prager", "undrained", "seepage", "cam-clay",
                                             "small-strain"};

/* In the plane the body is that of MIXED. */
static int is_there(const options *o, int dim, kind k) {
  return (k != BODY || dim == 3) && (o->only < 0 || (int)k == o->only);
}

typedef struct contender {
  mps_context *context;
  mps_particles *particles;
  mps_material *material;
  mps_body *body;
  mps_mpm *mpm; /* NULL: not available */
  double best;  /* s a particle-step */
} contender;

#define CONFINED 100e3 /* Pa: first pressure of Cam-Clay, which is as stiff as YOUNG then */

/* Strengths of the waves' order of stress, so that particles yield in part. */
static mps_material *make_material(mps_context *context, kind k) {
  mps_material *material = NULL;
  mps_material_drucker_prager_def cone = mps_material_drucker_prager_defaults();
  cone.young = YOUNG, cone.poisson = POISSON, cone.friction = 0.5, cone.cohesion = 500.0;
  mps_material_cam_clay_def clay = mps_material_cam_clay_defaults();
  clay.critical_slope = 0.92, clay.compression = 0.12, clay.swelling = 0.0288;
  clay.void_ratio = 1.4, clay.preconsolidation = CONFINED;
  mps_material_small_strain_def small = mps_material_small_strain_defaults();
  small.shear_modulus = 0.5 * YOUNG / (1.0 + POISSON), small.reference_strain = 1e-4;
  if (k == CAM_CLAY)
    check(context, mps_material_create_cam_clay(context, &clay, &material), "material");
  else if (k == SMALL_STRAIN)
    check(context, mps_material_create_small_strain(context, &small, &material), "material");
  else if (k == DRUCKER_PRAGER)
    check(context, mps_material_create_drucker_prager(context, &cone, &material), "material");
  else
    check(context, mps_material_create_linear_elastic(context, YOUNG, POISSON, &material),
          "material");
  return material;
}

static void add_water(contender *c, kind k) {
  mps_pore_water_def def = mps_pore_water_defaults();
  def.porosity = 0.4;
  if (k == SEEPAGE) def.permeability = 1e-4;
  check(c->context, mps_mpm_add_pore_water(c->mpm, &def), "pore water");
}

/* `side` cells each way; in 2D, MIXED, without the middle quarter, where a body is. */
static void fill(contender *c, int dim, kind k, int64_t side) {
  const double s = (double)side, a = 0.25 * s, b = 0.75 * s;
  const double around[4][4] = {{0, 0, s, a}, {0, a, a, b}, {b, a, s, b}, {0, b, s, s}};
  const double lo[3] = {0, 0, 0}, hi[3] = {s, s, s};
  mps_particles_def set = mps_particles_defaults();
  set.dim = dim;
  set.spacing = 0.5;
  check(c->context, mps_particles_create(c->context, &set, &c->particles), "particles");
  if (dim == 2 && k == MIXED)
    for (int r = 0; r < 4; r++)
      check(c->context, mps_particles_fill_box(c->particles, around[r], around[r] + 2, NULL),
            "fill");
  else
    check(c->context, mps_particles_fill_box(c->particles, lo, hi, NULL), "fill");
  check(c->context, mps_particles_set(c->particles, "density", 0, DENSITY), "density");
  check(c->context, mps_particles_add_field(c->particles, "velocity", 0), "velocity");
  if (k == CAM_CLAY)
    check(c->context, mps_particles_add_field(c->particles, "stress", 0), "stress");
  for (int d = 0; d < 3 && k == CAM_CLAY; d++)
    check(c->context, mps_particles_set(c->particles, "stress", d, -CONFINED), "stress");
  mps_view x;
  mps_edit v;
  check(c->context, mps_particles_view(c->particles, "position", &x), "position");
  check(c->context, mps_particles_edit(c->particles, "velocity", &v), "velocity");
  for (int d = 0; d < dim; d++)
    for (int64_t p = 0; p < x.shape[0]; p++)
      *mps_edit_f64(&v, p, d) = SPEED * sin(WAVE * *mps_view_f64(&x, p, (d + 1) % dim));
  check(c->context, mps_particles_commit(c->particles, &v), "velocity");
}

/* A box in the hole of the block, a trifle too large: all around it particles are in contact. */
static void add_body(contender *c, int64_t side) {
  mps_body_def def = mps_body_defaults();
  const double s = (double)side;
  def.position[0] = def.position[1] = 0.5 * s;
  mps_contact_def contact = mps_contact_defaults();
  contact.friction = 0.3;
  check(c->context, mps_body_create_box(c->context, &def, 0.5 * s + 2e-4, 0.5 * s + 2e-4, &c->body),
        "body");
  check(c->context, mps_mpm_add_contact(c->mpm, c->body, &contact, NULL), "body");
}

/* A cylinder that stands on the block, a trifle too low: half its upper face is in contact. */
static void add_cylinder(contender *c, int64_t side) {
  mps_body_def def = mps_body_defaults();
  const double s = (double)side;
  def.position[0] = def.position[1] = 0.5 * s;
  def.position[2] = 1.25 * s - 2e-4;
  mps_contact_def contact = mps_contact_defaults();
  contact.friction = 0.3;
  check(c->context, mps_body_create_cylinder(c->context, &def, 0.4 * s, 0.5 * s, &c->body), "body");
  check(c->context, mps_mpm_add_contact(c->mpm, c->body, &contact, NULL), "body");
}

static contender contender_create(const options *o, int dim, int spline, kind k, int64_t side) {
  contender c = {.best = INFINITY};
  char text[256] = "";
  mps_context_def context_def = mps_context_defaults();
  context_def.threads = k == TWO_THREADS ? 2 : 1;
  context_def.instruction_level = o->instruction_level;
  if (k != TWO_THREADS) context_def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  check(NULL, mps_context_create(&context_def, &c.context, text, sizeof text), text);
  c.material = make_material(c.context, k);
  fill(&c, dim, k, side);
  mps_mpm_def def = mps_mpm_defaults();
  def.flip_time = 0.0; /* one transfer for all laws: what it keeps takes half a step more */
  def.cell = 1.0;
  def.geometry = dim == 3 ? MPS_MPM_GEOMETRY_SPACE : MPS_MPM_GEOMETRY_PLANE_STRAIN;
  def.spline = spline;
  if (k == MIXED) /* 2D: four walls and the body; 3D: a floor. Either way about 5 % at 1e5 */
    for (size_t d = 0; d < sizeof def.lower / sizeof *def.lower && (int)d < dim; d++) {
      if (dim == 2 || d == 2) def.lower[d] = 0.0;
      if (dim == 2) def.upper[d] = (double)side;
    }
  const mps_status status = mps_mpm_create(c.context, c.particles, c.material, &def, &c.mpm);
  if (status == MPS_ERROR_UNSUPPORTED) return c;
  check(c.context, status, "solver");
  if (dim == 2 && k == MIXED) add_body(&c, side);
  if (k == BODY) add_cylinder(&c, side);
  if (k == UNDRAINED || k == SEEPAGE) add_water(&c, k);
  return c;
}

static void contender_destroy(contender *c) {
  mps_mpm_destroy(&c->mpm);
  mps_body_destroy(&c->body);
  mps_material_destroy(&c->material);
  mps_particles_destroy(&c->particles);
  mps_context_destroy(&c->context);
}

/* Bytes of all fields of a particle. */
static double particle_bytes(contender *c) {
  double bytes = 0.0;
  for (int32_t f = 0; f < mps_particles_field_count(c->particles); f++) {
    mps_particles_field_info info;
    check(c->context, mps_particles_get_field_info(c->particles, f, &info), "field");
    bytes += 8.0 * info.components;
  }
  return bytes;
}

/* ---- one line of the table ------------------------------------------------------------------- */

static int64_t side_of(int dim, int64_t particles, int hole) {
  const double cells = (double)particles / (dim == 3 ? 8.0 : 4.0) / (hole ? 0.75 : 1.0);
  const int64_t side = llround(pow(cells, 1.0 / dim));
  return hole ? (side + 2) / 4 * 4 : side;
}

/* Of the process: what other programs take of the machine does not count. */
static double processor_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double time_steps(contender *c, int64_t steps, double (*clock_of)(void)) {
  const double start = clock_of();
  check(c->context, mps_mpm_step(c->mpm, steps), "step");
  return (clock_of() - start) / (double)(steps * mps_particles_count(c->particles));
}

static void print_line(anchor *a, double anchor_best, contender *c) {
  mps_mpm_report grid;
  contender *one = c;
  while (!one->mpm) one++;
  check(one->context, mps_mpm_get_report(one->mpm, &grid), "usage");
  printf("%3d %6d %9lld %8.1f", a->dim, a->degree, (long long)a->count, 1e9 * anchor_best);
  for (int k = 0; k < KINDS; k++)
    isfinite(c[k].best) ? printf(" %7.1f", 1e9 * c[k].best) : printf(" %7s", "-");
  for (int k = 0; k < KINDS; k++)
    isfinite(c[k].best) ? printf(" %6.2f", c[k].best / anchor_best) : printf(" %6s", "-");
  printf(" %6.0f %6.0f %7.1f\n", particle_bytes(one), (double)grid.bytes / (double)a->count,
         (double)grid.bytes / (double)grid.nodes);
  fflush(stdout);
}

static void time_size(const options *o, int dim, int spline, int64_t particles) {
  const int rounds = o->rounds;
  const int64_t steps = particles < 20000 ? 96 : particles < 200000 ? 24 : 8; /* of 8: filters */
  const int kinds = particles > LARGE ? 2 : KINDS; /* all at once would not fit the memory */
  contender c[KINDS] = {{0}};
  int available = 1;
  for (int k = 0; k < KINDS; k++) c[k].best = INFINITY;
  for (int k = 0; k < kinds && available; k++) {
    if (!is_there(o, dim, k)) continue;
    c[k] = contender_create(o, dim, spline, k, side_of(dim, particles, dim == 2 && k == MIXED));
    available = c[k].mpm != NULL;
  }
  anchor a = make_anchor(dim, spline, side_of(dim, particles, 0));
  anchor_waves(&a);
  double anchor_best = INFINITY;
  for (int round = 0; round <= rounds; round++) { /* round 0 warms up */
    const double start = processor_seconds();
    anchor_step(&a, steps);
    const double time = (processor_seconds() - start) / (double)(steps * a.count);
    if (round > 0) anchor_best = fmin(anchor_best, time);
    for (int k = 0; k < kinds && available; k++) {
      if (!is_there(o, dim, k)) continue;
      const double own = time_steps(&c[k], steps, k == TWO_THREADS ? seconds : processor_seconds);
      if (round > 0) c[k].best = fmin(c[k].best, own);
    }
  }
  if (available)
    print_line(&a, anchor_best, c);
  else
    printf("%3d %6d %9lld %8.1f  not available in the library\n", dim, spline, (long long)a.count,
           1e9 * anchor_best);
  fflush(stdout);
  anchor_free(&a);
  for (int k = 0; k < KINDS; k++) contender_destroy(&c[k]);
}

/* ---- program --------------------------------------------------------------------------------- */

static int find_kind(const char *name) {
  int k = KINDS - 1;
  while (k >= 0 && strcmp(name, kind_name[k]) != 0) k--;
  return k;
}

static int read_options(int argc, char **argv, options *o) {
  *o = (options){.rounds = 5, .only = -1};
  for (int k = 1; k < argc; k += 2) {
    if (k + 1 == argc) return 0;
    const double value = atof(argv[k + 1]);
    if (!strcmp(argv[k], "--dim"))
      o->dim = (int)value;
    else if (!strcmp(argv[k], "--spline"))
      o->spline = (int)value;
    else if (!strcmp(argv[k], "--rounds"))
      o->rounds = (int)value;
    else if (!strcmp(argv[k], "--instruction-level"))
      o->instruction_level = (int32_t)value;
    else if (!strcmp(argv[k], "--only") && find_kind(argv[k + 1]) >= 0)
      o->only = find_kind(argv[k + 1]);
    else if (!strcmp(argv[k], "--particles"))
      o->particles = (int64_t)value;
    else
      return 0;
  }
  return (o->dim == 0 || o->dim == 2 || o->dim == 3) &&
         (o->spline == 0 || o->spline == 2 || o->spline == 3) && o->rounds >= 1 &&
         (o->particles == 0 || (o->particles >= 1000 && o->particles <= 20000000));
}

int main(int argc, char **argv) {
  options o;
  if (!read_options(argc, argv, &o)) {
    fprintf(
        stderr,
        "usage: bench-mpm [--dim 2|3] [--spline 2|3] [--rounds N] [--particles N]\n"
        "    [--only "
        "elastic|two|mixed|body|drucker-prager|undrained|seepage|cam-clay|small-strain]\n"
        "    [--instruction-level 0|1|3|4]\n"
        "N particles, 1e3 to 2e7; by default 1e4, 1e5 and 1e6.\n"
        "Other work on the machine disturbs two threads most: OMP_WAIT_POLICY=passive helps.\n");
    return 2;
  }
  for (int dim = 2; dim <= 3; dim++)
    for (int spline = 2; spline <= 3; spline++)
      if ((!o.dim || o.dim == dim) && (!o.spline || o.spline == spline)) check_anchor(dim, spline);
  printf(
      "# minima of %d rounds, ns a particle-step of processor time, for `two` threads of the wall\n"
      "# clock; mixed: walls and a body in contact (3D: a floor); body: a cylinder on the block;\n"
      "# d-p: Drucker-Prager; undr, seep: pore water undrained and flowing; clay: Cam-Clay;\n"
      "# smal: small strain; memory in bytes: fields a particle, grid a particle, grid a node\n"
      "# ns, then ratios to the anchor, then memory\n"
      "#dim spline particles  anchor elastic    two    mixed    body     d-p    undr    seep "
      "   clay    smal elasti    two  mixed   body    d-p   undr   seep   clay   smal fields   "
      "grid    "
      "node\n",
      o.rounds);
  const int64_t sizes[] = {10000, 100000, 1000000};
  for (int dim = 2; dim <= 3; dim++)
    for (int spline = 2; spline <= 3; spline++) {
      if ((o.dim && o.dim != dim) || (o.spline && o.spline != spline)) continue;
      if (o.particles) time_size(&o, dim, spline, o.particles);
      for (size_t k = 0; k < sizeof sizes / sizeof *sizes && !o.particles; k++)
        time_size(&o, dim, spline, sizes[k]);
    }
  return 0;
}
