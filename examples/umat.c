/* umat.c - a material routine of Abaqus, in Fortran (umat.f90), used as a law: the same bar of
 * metal is pulled twice by WLS-MPM, once by the UMAT and once by the library's own von Mises law;
 * and one particle is sheared beyond yield, against the closed form.
 *
 * In pure shear strain e (exx = e, eyy = -e) the plastic strain is
 *   p = (2 sqrt(3) G e - yield) / (3 G + H),   sxx = (yield + H p) / sqrt(3).
 * SPDX-License-Identifier: BSD-3-Clause */
#define MPS_EXPERIMENTAL 1
#include <mps/mpm.h>
#include <mps/experimental/material_point.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* umat.f90, as gfortran names it. Its arguments are those of mps_material_umat_fn. */
extern void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd,
                  double *scd, double *rpl, double *ddsddt, double *drplde, double *drpldt,
                  const double *stran, const double *dstran, const double *time,
                  const double *dtime, const double *temp, const double *dtemp,
                  const double *predef, const double *dpred, const char *cmname, const int32_t *ndi,
                  const int32_t *nshr, const int32_t *ntens, const int32_t *nstatv,
                  const double *props, const int32_t *nprops, const double *coords,
                  const double *drot, double *pnewdt, const double *celent, const double *dfgrd0,
                  const double *dfgrd1, const int32_t *noel, const int32_t *npt,
                  const int32_t *layer, const int32_t *kspt, const int32_t *kstep,
                  const int32_t *kinc, size_t cmname_length);

static const double young = 2e8, poisson = 0.3, yield = 1e6, hardening = 2e7; /* Pa */

/* Stops where a call fails, with the library's message. */
static void ok(mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "%s\n", mps_last_error()->message);
  exit(1);
}

static void make_laws(mps_context *context, mps_material **fortran, mps_material **own) {
  static const char *const names[] = {"plastic_strain"};
  const double props[4] = {young, poisson, yield, hardening};
  mps_material_umat_def def = mps_material_umat_defaults();
  def.umat = umat_;
  def.name = "metal";
  def.props = props, def.props_count = 4;
  def.statev_names = names, def.statev_count = 1; /* the field "metal.plastic_strain" */
  def.wave_modulus = young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
  mps_material_von_mises_def same = mps_material_von_mises_defaults();
  same.young = young, same.poisson = poisson, same.yield_stress = yield, same.hardening = hardening;
  ok(mps_material_create_umat(context, &def, fortran));
  ok(mps_material_create_von_mises(context, &same, own));
}

/* One particle in pure shear; the error of stress and plastic strain. */
static void shear(mps_context *context, mps_material *law, double *error) {
  mps_material_point point;
  const double e = 0.05, gradient[9] = {e, 0.0, 0.0, 0.0, -e}; /* over 1 s */
  const double G = young / (2.0 * (1.0 + poisson));
  const double p = (2.0 * sqrt(3.0) * G * e - yield) / (3.0 * G + hardening);
  const double s = (yield + hardening * p) / sqrt(3.0);
  ok(mps_material_point_init(context, law, &point));
  ok(mps_material_point_drive(context, law, &point, gradient, 1.0, 50));
  *error = fmax(fabs(point.stress[0] / s - 1.0), fabs(point.history[0] / p - 1.0));
  printf("pure shear: sxx %.6g Pa, closed form %.6g Pa; plastic strain %.6g, %.6g\n",
         point.stress[0], s, point.history[0], p);
}

/* A bar of 20 x 4 particles whose ends move apart. `length` receives the place of its last one. */
static void pull(mps_context *context, mps_material *law, double *length, double *plastic) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {1.0, 0.2};
  mps_particles_def of_set = mps_particles_defaults();
  mps_particles *set = NULL;
  mps_mpm *mpm = NULL;
  mps_view x, kept;
  mps_edit v;
  mps_mpm_def def = mps_mpm_defaults();
  /* by default a UMAT and von Mises differ in these */
  def.volumetric = MPS_MPM_VOLUMETRIC_POINT, def.flip_time = 0.0;
  of_set.spacing = 0.05;
  def.cell = 0.1;
  ok(mps_particles_create(context, &of_set, &set));
  ok(mps_particles_fill_box(set, lo, hi, NULL));
  ok(mps_particles_set(set, "density", 0, 7800.0));
  ok(mps_particles_set(set, "velocity", 0, 0.0));
  ok(mps_particles_edit(set, "velocity", &v));
  ok(mps_particles_view(set, "position", &x));
  for (int64_t k = 0; k < v.view.shape[0]; k++)
    *mps_edit_f64(&v, k, 0) = 20.0 * (*mps_view_f64(&x, k, 0) - 0.5); /* m/s */
  ok(mps_particles_commit(set, &v));
  ok(mps_mpm_create(context, set, law, &def, &mpm));
  ok(mps_mpm_run(mpm, 5e-3, 1, NULL, NULL));
  ok(mps_particles_view(set, "position", &x));
  const char *column = mps_material_history_name(law, 0);
  char field[100]; /* of the first history column: the library's own laws use fields of its table */
  snprintf(field, sizeof field, "%s.%s", mps_material_name(law), column);
  if (!mps_particles_has_field(set, field)) snprintf(field, sizeof field, "%s", column);
  ok(mps_particles_view(set, field, &kept));
  *length = *plastic = 0.0;
  for (int64_t k = 0; k < kept.shape[0]; k++) {
    *length = fmax(*length, *mps_view_f64(&x, k, 0));
    *plastic = fmax(*plastic, *mps_view_f64(&kept, k, 0));
  }
  printf("%-12s the bar ends at %.9f m, largest plastic strain %.9f\n", mps_material_name(law),
         *length, *plastic);
  mps_mpm_destroy(&mpm);
  mps_particles_destroy(&set);
}

int main(void) {
  mps_context *context = NULL;
  mps_material *fortran = NULL, *own = NULL;
  double error = 1.0, length[2] = {0.0, 1.0}, plastic[2] = {0.0, 1.0};
  ok(mps_context_create(NULL, &context, NULL, 0));
  make_laws(context, &fortran, &own);
  shear(context, fortran, &error);
  pull(context, fortran, &length[0], &plastic[0]);
  pull(context, own, &length[1], &plastic[1]);
  mps_material_destroy(&fortran);
  mps_material_destroy(&own);
  mps_context_destroy(&context);
  return error < 1e-12 && plastic[1] > 1e-3 && fabs(length[0] - length[1]) < 1e-9 &&
                 fabs(plastic[0] - plastic[1]) < 1e-9
             ? 0
             : 1;
}
