/* umat.c - a law written as an Abaqus UMAT: its arguments particle by particle from a block's
 * columns, and the values kept between steps. It is a user's law (user.c) that owns its data.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"
#include "tensor.h"

#include <stdio.h>

/* Columns of history after those of STATEV. */
enum { TIME, STEPS, STRAIN, KEPT = STRAIN + 6 };
static const char *const kept_names[KEPT] = {"umat_time",      "umat_steps",     "umat_strain_11",
                                             "umat_strain_22", "umat_strain_33", "umat_strain_12",
                                             "umat_strain_13", "umat_strain_23"};

enum { STATEV_MOST = 1000 }; /* with the values kept, within the most columns of a law */
_Static_assert(STATEV_MOST + KEPT <= MPSI_MATERIAL_COLUMNS, "columns of a law");

#define CMNAME_LENGTH 80

typedef struct umat_law {
  mps_material_umat_fn call;
  char name[CMNAME_LENGTH]; /* padded with blanks */
  double temperature, length;
  int32_t statev_count, props_count;
  bool keeps_strain, needs_deformation;
  double props[]; /* props_count, and behind them, for comparison, temperature and length */
} umat_law;

/* ---- arguments --------------------------------------------------------------------------------
 * Matrices are Fortran's: element (i, j) at i + 3 j. Symmetric tensors are 11, 22, 33, 12, 13, 23,
 * which is the order of our columns; strains have engineering shear. */

/* Arguments that differ between particles. */
typedef struct umat_point {
  double stress[6], statev[STATEV_MOST], strain[6], increment[6];
  double rotation[9], before[9], after[9]; /* DROT, DFGRD0, DFGRD1 */
  double time, temperature, at[3];         /* s, K, m */
  int32_t step, number;                    /* KINC, NOEL */
} umat_point;

static void unit_matrix(double *m) {
  for (int c = 0; c < 9; c++) m[c] = c % 4 == 0 ? 1.0 : 0.0;
}

/* Q = (1 - w/2)^-1 (1 + w/2), as mpsi_turn has it. */
static void rotation_of(mpsi_spin w, double *q) {
  const double x[3][3] = {{0.0, w.xy, -w.zx}, {-w.xy, 0.0, w.yz}, {w.zx, -w.yz, 0.0}};
  const double r = 1.0 / (1.0 + 0.25 * (w.xy * w.xy + w.yz * w.yz + w.zx * w.zx));
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const double square = x[i][0] * x[0][j] + x[i][1] * x[1][j] + x[i][2] * x[2][j];
      q[i + 3 * j] = (i == j ? 1.0 : 0.0) + r * (x[i][j] + 0.5 * square);
    }
}

/* The deformation gradient after the step, and before it: (1 + dt L)^-1 F. */
static void deformations(const mps_material_block *block, int64_t k, umat_point *point) {
  double g[9], f[9], inverse[9];
  unit_matrix(g);
  unit_matrix(f);
  for (int c = 0; c < 9; c++) {
    if (block->gradient[c]) g[c] += block->dt * block->gradient[c][k];
    if (block->deformation[c]) f[c] = block->deformation[c][k];
  }
  for (int c = 0; c < 9; c++) { /* adjugate, by cyclic indices */
    const int i = c / 3, j = c % 3, i1 = (j + 1) % 3, i2 = (j + 2) % 3, j1 = (i + 1) % 3,
              j2 = (i + 2) % 3;
    inverse[c] = g[3 * i1 + j1] * g[3 * i2 + j2] - g[3 * i1 + j2] * g[3 * i2 + j1];
  }
  const double det = g[0] * inverse[0] + g[1] * inverse[3] + g[2] * inverse[6];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      point->after[i + 3 * j] = f[3 * i + j];
      point->before[i + 3 * j] =
          (inverse[3 * i] * f[j] + inverse[3 * i + 1] * f[3 + j] + inverse[3 * i + 2] * f[6 + j]) /
          det;
    }
}

/* STRAN: the sum of the previous steps, rotated with the particle. */
static void turned_strain(int geometry, double *const *column, int64_t k, mpsi_spin w,
                          double *strain) {
  mpsi_sym e = {.xx = column[0][k], .yy = column[1][k], .zz = column[2][k]};
  e.xy = 0.5 * column[3][k], e.zx = 0.5 * column[4][k], e.yz = 0.5 * column[5][k];
  e = mpsi_turn(geometry, e, w);
  const double turned[6] = {e.xx, e.yy, e.zz, 2.0 * e.xy, 2.0 * e.zx, 2.0 * e.yz};
  for (int c = 0; c < 6; c++) strain[c] = turned[c];
}

static void gather(const umat_law *law, const mps_material_block *block,
                   const mpsi_law_columns *columns, int64_t k, umat_point *point) {
  const int geometry = block->dim == 3 ? MPSI_SPACE : block->gradient[8] ? MPSI_AXIAL : MPSI_PLANE;
  const mpsi_sym d = mpsi_strain(geometry, columns, k, block->dt);
  const mpsi_spin w = mpsi_spin_of(geometry, columns, k, block->dt);
  const double increment[6] = {d.xx, d.yy, d.zz, 2.0 * d.xy, 2.0 * d.zx, 2.0 * d.yz};
  double *const *kept = block->history + law->statev_count;
  for (int c = 0; c < 2 * block->dim; c++) point->stress[c] = block->stress[c][k];
  for (int c = 0; c < 6; c++) point->increment[c] = increment[c];
  for (int c = 0; c < law->statev_count; c++) point->statev[c] = block->history[c][k];
  if (law->keeps_strain) turned_strain(geometry, kept + STRAIN, k, w, point->strain);
  rotation_of(w, point->rotation);
  if (law->needs_deformation) deformations(block, k, point);
  point->time = kept[TIME][k];
  point->temperature = block->temperature ? block->temperature[k] : law->temperature;
  for (int c = 0; c < 3; c++) point->at[c] = block->position[c] ? block->position[c][k] : 0.0;
  point->number = block->ids && block->ids[k] < INT32_MAX ? (int32_t)block->ids[k] + 1 : 1;
  point->step = (int32_t)fmin(kept[STEPS][k] + 1.0, (double)INT32_MAX);
}

static void scatter(const umat_law *law, const mps_material_block *block, int64_t k,
                    const umat_point *point) {
  double *const *kept = block->history + law->statev_count;
  for (int c = 0; c < 2 * block->dim; c++) block->stress[c][k] = point->stress[c];
  for (int c = 0; c < law->statev_count; c++) block->history[c][k] = point->statev[c];
  for (int c = 0; c < 6 && law->keeps_strain; c++)
    kept[STRAIN + c][k] = point->strain[c] + point->increment[c];
  kept[TIME][k] = point->time + block->dt;
  kept[STEPS][k] += 1.0;
}

/* ---- the call -------------------------------------------------------------------------------- */

/* One particle. Arguments that do not apply to a mechanical step are zero. Returns the text of an
 * error, or NULL. */
static const char *call_umat(const umat_law *law, const mps_material_block *block,
                             umat_point *point) {
  const int32_t ndi = 3, nshr = block->dim == 3 ? 3 : 1, ntens = ndi + nshr, one = 1;
  const int32_t step[4] = {1, 0, 1, 0}; /* JSTEP: the first step, large deformation */
  const double zero[3] = {0.0}, time[2] = {point->time, point->time};
  double energy[3] = {0.0}, thermal[14] = {0.0}, tangent[36] = {0.0}, factor = 1e36;
  law->call(point->stress, point->statev, tangent, &energy[0], &energy[1], &energy[2], &thermal[0],
            &thermal[1], &thermal[7], &thermal[13], point->strain, point->increment, time,
            &block->dt, &point->temperature, zero, zero, zero, law->name, &ndi, &nshr, &ntens,
            &law->statev_count, law->props, &law->props_count, point->at, point->rotation, &factor,
            &law->length, point->before, point->after, &point->number, &one, &one, &one, step,
            &point->step, sizeof law->name);
  if (factor == 0.0) return "the UMAT has ended the analysis (XIT, or a PNEWDT of 0)";
  if (factor < 1.0) return "the UMAT requests a smaller step (PNEWDT)";
  double sum = 0.0;
  for (int c = 0; c < ntens; c++) sum += fabs(point->stress[c]);
  for (int c = 0; c < law->statev_count; c++) sum += fabs(point->statev[c]);
  return isfinite(sum) ? NULL : "STRESS or STATEV is not finite";
}

static mps_status update(void *user, const mps_material_block *block) {
  const umat_law *law = user;
  const mpsi_law_columns columns = mpsi_columns_of(block);
  umat_point point;
  memset(point.strain, 0, sizeof point.strain);
  unit_matrix(point.before);
  unit_matrix(point.after);
  for (int64_t k = 0; k < block->count; k++) {
    gather(law, block, &columns, k, &point);
    const char *wrong = call_umat(law, block, &point);
    if (wrong) {
      (void)snprintf(block->message, (size_t)block->message_size, "%s", wrong);
      *block->refused = k;
      return MPS_ERROR_NUMERIC;
    }
    scatter(law, block, k, &point);
  }
  return MPS_OK;
}

/* ---- creation -------------------------------------------------------------------------------- */

static void fill_law(const mps_material_umat_def *def, umat_law *law) {
  law->call = def->umat;
  memset(law->name, ' ', sizeof law->name);
  memcpy(law->name, def->name, strlen(def->name)); /* a name has at most 47 characters */
  law->temperature = def->temperature;
  law->length = def->length;
  law->statev_count = def->statev_count;
  law->props_count = def->props_count;
  law->keeps_strain = def->keeps_strain == 1;
  law->needs_deformation = def->needs_deformation == 1;
  for (int32_t c = 0; c < def->props_count; c++) law->props[c] = def->props[c];
  law->props[def->props_count] = def->temperature;
  law->props[def->props_count + 1] = def->length;
}

/* Names and first values of the columns of history. */
typedef struct columns {
  const char *names[STATEV_MOST + KEPT];
  char numbered[STATEV_MOST][24];
  double initial[STATEV_MOST + KEPT];
} columns;

/* The user's law that `update` is, with its columns of history: checks the names. */
static mps_status make_law(mps_context *context, const char *function,
                           const mps_material_umat_def *def, mps_material **out) {
  columns *c = mpsi_alloc(context, 1, sizeof *c);
  if (!c) return mpsi_fail_memory(context, function, sizeof *c);
  mps_material_user_def law = mps_material_user_defaults();
  law.history_count = def->statev_count + (def->keeps_strain ? KEPT : STRAIN);
  law.update = update;
  law.name = def->name;
  law.history = c->names;
  law.history_initial = c->initial;
  law.wave_modulus = def->wave_modulus;
  law.bulk_modulus = def->bulk_modulus;
  law.shear_modulus = def->shear_modulus;
  law.needs_deformation = def->needs_deformation;
  for (int32_t k = 0; k < law.history_count; k++) {
    if (k >= def->statev_count) {
      c->names[k] = kept_names[k - def->statev_count];
      continue;
    }
    (void)snprintf(c->numbered[k], sizeof c->numbered[k], "statev_%d", (int)k + 1);
    c->names[k] = def->statev_names ? def->statev_names[k] : c->numbered[k];
    if (def->statev_initial) c->initial[k] = def->statev_initial[k];
  }
  const mps_status status = mpsi_material_make_user(context, function, &law, out);
  mpsi_free(context, c);
  return status;
}

mps_status mps_material_create_umat(mps_context *context, const mps_material_umat_def *user_def,
                                    mps_material **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_material_umat_def def = mps_material_umat_defaults();
  mps_material *material = NULL;
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_material_umat_def, user_def, &def));
  MPSI_TRY(make_law(context, __func__, &def, &material));
  const size_t size = sizeof(umat_law) + ((size_t)def.props_count + 2) * sizeof(double);
  umat_law *law = mpsi_alloc(context, 1, size);
  if (!law) {
    mps_material_destroy(&material);
    return mpsi_fail_memory(context, __func__, size);
  }
  fill_law(&def, law);
  material->law.user = material->owned = law;
  material->release = def.release;
  material->release_user = def.user;
  material->owned_constants = law->props;
  material->owned_count = law->props_count + 2;
  *out = material;
  return MPS_OK;
}
