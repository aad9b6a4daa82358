/* section.c - --section: stresses and plastic strain over the depth on a vertical line at the end
 * of the run, as the grid has them, and the vertical stress of an elastic half space under the same
 * pressure (Boussinesq). SPDX-License-Identifier: BSD-3-Clause */
#include "common/plot.h"
#include "footing.h"

#include <mps/grid.h>

#include <math.h>
#include <stdlib.h>

enum { PER_CELL = 2, STRESSES = 4, NUMBERS = STRESSES + 1 };

mps_status footing_take_section(simulation *sim) {
  const settings *s = &sim->s;
  const mps_grid *grid = mps_mpm_grid(sim->m.mpm);
  mps_grid_info info;
  if (isnan(s->section)) return MPS_OK;
  mps_status status = mps_grid_get_info(grid, &info);
  if (status != MPS_OK) return status;
  const int64_t count = (int64_t)ceil(PER_CELL * s->depth / info.cell);
  double *point = calloc((size_t)count * (3 + NUMBERS), sizeof *point);
  status = app_settle(sim->m.a, point ? MPS_OK : MPS_ERROR_MEMORY);
  if (status != MPS_OK) {
    free(point);
    return status;
  }
  double *stress = point + 3 * count, *strain = stress + STRESSES * count;
  for (int64_t k = 0; k < count; k++) {
    point[3 * k] = s->section;
    point[3 * k + 1] = s->depth - ((double)k + 0.5) * s->depth / (double)count;
  }
  status = mps_grid_evaluate(grid, "stress", -1, count, point, stress, NULL);
  if (status == MPS_OK)
    status = mps_grid_evaluate(grid, "plastic_strain", 0, count, point, strain, NULL);
  sim->profile = point, sim->points = count;
  return status;
}

/* Vertical stress (Pa) at a depth below a strip under the pressure q on an elastic half space. */
static double boussinesq(const settings *s, double q, double depth) {
  const double left = atan((s->section + s->half_width) / depth);
  const double right = atan((s->section - s->half_width) / depth);
  return q / 3.14159265358979323846 * (left - right + 0.5 * (sin(2.0 * left) - sin(2.0 * right)));
}

static bool write(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  const double q = footing_row_of(sim, footing_rows(sim) - 1)->q;
  output f;
  if (!csv_open(&f, a, s->out, "section.csv",
                "depth_m,vertical_kPa?,horizontal_kPa?,shear_kPa?,plastic_strain?,elastic_kPa?"))
    return false;
  for (int64_t k = 0; k < sim->points; k++) {
    const double *stress = sim->profile + 3 * sim->points + STRESSES * k;
    const double depth = s->depth - sim->profile[3 * k + 1];
    CSV_LINE(&f, depth, -1e-3 * stress[1], -1e-3 * stress[0], 1e-3 * stress[3],
             sim->profile[(3 + STRESSES) * sim->points + k],
             s->shape == STRIP ? 1e-3 * (boussinesq(s, q, depth) + s->density * s->gravity * depth)
                               : NAN);
  }
  return output_close(&f);
}

static bool draw(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  return plot_draw(a, s->out, "section", "footing/section",
                   "first = 'Stresses at x = %g m after a settlement of %.3g mm'\nsecond = '%s, "
                   "half width %g m, "
                   "h = %g m'\ndepth = %.9g; strip = %d",
                   s->section, 1e3 * footing_row_of(sim, footing_rows(sim) - 1)->path,
                   s->shape == STRIP ? "strip" : "circle", s->half_width, s->h, s->depth,
                   s->shape == STRIP);
}

bool footing_write_section(app *a, const simulation *sim) {
  return !sim->profile || (write(a, sim) && draw(a, sim));
}
