/* free_field_step.c - a step of the columns of free-field sides, in the order of that of the solver
 * (step/step.c), and the tractions that they have on the nodes of their sides. See free_field.h.
 *
 * Shape functions, forces and transfers are those of the solver along y: B-splines, or at a side
 * that is not a mirror the fit of transfer/wall_support.h; ghosts beyond mirrors are folded as in
 * mirror.h. Each particle has its own change of volume. SPDX-License-Identifier: BSD-3-Clause */
#include "free_field.h"

#include "corners.h"
#include "kinds.h"
#include "mpm/base/kernels.h"
#include "mpm/water/water.h"

#include <stdlib.h>
#include <string.h>

enum { Y = 1 };
#define AT_SIDE 1e-9 /* cells: a particle so near to a side has been stopped there (g2p.c) */

/* ---- shape functions along y ----------------------------------------------------------------- */

/* Of one particle, at the nodes from number `at` of the column on. */
typedef struct places {
  int64_t at;
  double value[4];      /* phi */
  double s[4];          /* (y_i - y_p)/h */
  double slope[4];      /* 1/m, derivative of the fit: forces and transfers */
  double derivative[4]; /* 1/m, as the laws see it */
  double along[4];      /* weights of derivatives along x */
} places;

/* Fits at a side that is not a mirror, over the nodes of the domain. */
static void fit(const mpsi_grid *grid, int64_t base, places *out) {
  double M0 = 0.0, M1 = 0.0, M2 = 0.0, w[4];
  for (int i = 0; i < 4; i++) {
    const int64_t n = base + i;
    w[i] = n >= grid->use_low[Y] && n <= grid->use_high[Y] ? out->value[i] : 0.0;
    M0 += w[i], M1 += w[i] * out->s[i], M2 += w[i] * out->s[i] * out->s[i];
  }
  const double inverse = 1.0 / (M0 * M2 - M1 * M1);
  for (int i = 0; i < 4; i++) {
    out->value[i] = w[i] * (M2 - M1 * out->s[i]) * inverse;
    out->slope[i] = w[i] * (M0 * out->s[i] - M1) * inverse * grid->inverse;
    out->derivative[i] = out->slope[i];
    out->along[i] = w[i] / M0;
  }
}

/* False where the nodes are outside those of the column. */
static bool place(const mpsi_grid *grid, const mpsi_free_field *f, double y, places *out) {
  const double at = mpsi_grid_at(grid, Y, y), lowest = mpsi_base(grid->spline, at);
  double w[4], slope[4];
  if (!(lowest >= (double)f->first && lowest + grid->spline < (double)(f->first + f->nodes)))
    return false; /* or not finite */
  const int64_t base = (int64_t)lowest;
  out->at = base - f->first;
  mpsi_weights(grid->spline, at - lowest, w);
  mpsi_slopes(grid->spline, at - lowest, slope);
  if (grid->spline == 2) slope[3] = 0.0;
  const double scale = mpsi_inverse_moment(grid->spline) * grid->inverse;
  for (int i = 0; i < 4; i++) {
    out->s[i] = (double)i - (at - lowest);
    out->value[i] = out->along[i] = w[i];
    out->slope[i] = scale * w[i] * out->s[i];
    out->derivative[i] = grid->inverse * slope[i];
  }
  if (base < grid->use_low[Y] || base + grid->spline > grid->use_high[Y]) fit(grid, base, out);
  return true;
}

static mps_status refuse_place(mps_context *context, const mpsi_run *run, const char *function,
                               int32_t number, double y) {
  return mpsi_fail(context, function, MPS_ERROR_DIVERGED,
                   "step %lld: ground at y = %g m has left the nodes of the free-field column at "
                   "%s: set the side again, which makes the column of the present ground",
                   (long long)run->steps, y, mpsi_name_of("mps_side", number).text);
}

/* ---- water ----------------------------------------------------------------------------------- */

/* Masses and wave velocities of the particles that were copied, while they are there: the column
 * may be older than the water. Pressures only where the caller has written them. */
static void take_water(const mpsi_boundary_setup *setup, mpsi_free_field *f) {
  const mpsi_columns *p = setup->p;
  for (int64_t k = 0; p->u && k < f->count; k++) {
    const int64_t from = mps_particles_index(p->set, f->id[k]);
    double wave, shear;
    if (from < 0) continue;
    mpsi_mpm_saturated(p, from, &wave, &shear);
    f->m[k] = p->m[from];
    f->cp[k] = sqrt(wave * f->V[k] / f->m[k]);
    if (p->u[from] == f->seen[k]) continue;
    f->u[k] = p->u[from] + p->g[Y][from] * (f->y[k] - p->x[Y][from]);
    f->g[k] = p->g[Y][from];
    f->seen[k] = p->u[from];
  }
}

/* Pa, with what the water's viscosity adds (P2G). */
static double water_pressure(const mpsi_boundary_setup *setup, const mpsi_free_field *f,
                             int64_t k) {
  return setup->water ? f->u[k] - setup->water->viscosity * f->slope[Y][k] : 0.0;
}

/* Pressures follow the mean change of volume of the particles with one stencil, as in
 * mpsi_pore_respond. */
static void respond(const mpsi_boundary_setup *setup, mpsi_free_field *f) {
  const mpsi_columns *p = setup->p;
  if (!setup->water) return;
  for (int64_t n = 0; n < f->nodes; n++) f->node[n].volume = f->node[n].strain = 0.0;
  for (int64_t k = 0; k < f->count; k++) {
    mpsi_field_node *node = &f->node[f->lowest[k]];
    node->volume += f->former[k];
    node->strain += f->V[k] - f->former[k];
  }
  for (int64_t k = 0; k < f->count; k++) {
    const mpsi_field_node *node = &f->node[f->lowest[k]];
    const int64_t from = mps_particles_index(p->set, f->id[k]);
    if (from >= 0 && node->volume > 0.0)
      f->u[k] -= setup->water->def.bulk / p->n[from] * (node->strain / node->volume);
  }
}

/* ---- traction of the column's stresses ------------------------------------------------------- */

static void find_row_stresses(const mpsi_boundary_setup *setup, mpsi_free_field *f) {
  memset(f->row, 0, (size_t)f->rows * sizeof *f->row);
  for (int64_t k = 0; k < f->count; k++) {
    double *row = f->row[f->row_of[k]];
    row[0] += f->V[k] * f->y[k];
    row[1] += f->V[k] * (f->s[0][k] - water_pressure(setup, f, k));
    row[2] += f->V[k] * f->s[3][k];
    row[3] += f->V[k];
  }
  for (int64_t r = 0; r < f->rows; r++)
    for (int c = 0; c < 3; c++) f->row[r][c] /= f->row[r][3];
}

/* (sigma_xx, sigma_xy), total stresses, of the column at the height y; beyond its ends those of its
 * last row. */
static void stress_at(const mpsi_free_field *f, double y, double *out) {
  int64_t low = 0, high = f->rows - 1;
  while (high - low > 1) {
    const int64_t middle = low + (high - low) / 2;
    if (f->row[middle][0] <= y)
      low = middle;
    else
      high = middle;
  }
  const double *a = f->row[low], *b = f->row[high], step = b[0] - a[0];
  const double share = step > 0.0 ? fmin(fmax((y - a[0]) / step, 0.0), 1.0) : 0.0;
  for (int c = 0; c < 2; c++) out[c] = (1.0 - share) * a[1 + c] + share * b[1 + c];
}

/* Derivatives along x of the shape functions of the nodes in the planes at the side, where
 * velocities are mirrored: those of nodes beyond it are added to their partners. */
static void find_planes(const mpsi_grid *grid, int64_t wall, double x, double *out) {
  const double at = mpsi_grid_at(grid, 0, x), lowest = mpsi_base(grid->spline, at);
  const double scale = mpsi_inverse_moment(grid->spline) * grid->inverse;
  double w[4];
  mpsi_weights(grid->spline, at - lowest, w);
  memset(out, 0, MPSI_FIELD_PLANES * sizeof *out);
  for (int i = 0; i <= grid->spline; i++) {
    const int64_t plane = llabs((int64_t)lowest + i - wall);
    if (plane < MPSI_FIELD_PLANES) out[plane] += scale * w[i] * ((double)i - (at - lowest));
  }
}

static mps_status add_traction(const mpsi_boundary_setup *setup, const char *function,
                               int32_t number, mpsi_free_field *f, int64_t k) {
  const mpsi_columns *p = setup->p;
  double planes[MPSI_FIELD_PLANES], stress[2];
  places along;
  const int64_t wall = number == MPS_SIDE_X_LOWER ? setup->grid->low[0] : setup->grid->high[0];
  find_planes(setup->grid, wall, p->x[0][k], planes);
  if (planes[0] == 0.0 && planes[1] == 0.0) return MPS_OK;
  if (!place(setup->grid, f, p->x[1][k], &along))
    return refuse_place(setup->context, setup->run, function, number, p->x[1][k]);
  stress_at(f, p->x[1][k], stress);
  for (int i = 0; i <= setup->grid->spline; i++)
    for (int q = 0; q < MPSI_FIELD_PLANES; q++)
      for (int c = 0; c < 2; c++)
        f->node[along.at + i].traction[q][c] += p->V[k] * planes[q] * along.along[i] * stress[c];
  return MPS_OK;
}

/* Over the particles within reach of the planes at the side. */
static mps_status find_traction(const mpsi_boundary_setup *setup, const char *function,
                                int32_t number, mpsi_free_field *f) {
  const mpsi_grid *grid = setup->grid;
  mps_status status = MPS_OK;
  find_row_stresses(setup, f);
  for (int64_t b = 0; b < grid->cell_count && status == MPS_OK; b++) {
    const mpsi_cell_block *cells = &grid->cells[b];
    const int64_t low = (int64_t)cells->at[0] * MPSI_SIDE + cells->low[0];
    const int64_t high = (int64_t)cells->at[0] * MPSI_SIDE + cells->high[0];
    if (number == MPS_SIDE_X_LOWER ? low >= grid->low[0] + MPSI_FIELD_PLANES
                                   : high <= grid->high[0] - MPSI_FIELD_PLANES)
      continue;
    for (int64_t k = cells->begin; k < cells->end && status == MPS_OK; k++)
      status = add_traction(setup, function, number, f, k);
  }
  return status;
}

/* ---- particles to nodes ---------------------------------------------------------------------- */

static void scatter_particle(const mpsi_boundary_setup *setup, mpsi_free_field *f, int64_t k,
                             const places *w) {
  const mpsi_grid *grid = setup->grid;
  const mpsi_columns *p = setup->p;
  const int64_t from = p->f[0] ? mps_particles_index(p->set, f->id[k]) : -1;
  const double per_area = f->m[k] * grid->inverse;
  f->lowest[k] = w->at;
  for (int i = 0; i <= grid->spline; i++) {
    mpsi_field_node *node = &f->node[w->at + i];
    node->mass += f->m[k] * w->value[i];
    node->across += per_area * f->cp[k] * w->value[i];
    node->along += per_area * f->cs[k] * w->value[i];
    for (int c = 0; c < 2; c++) {
      const double stress = c == Y ? f->s[1][k] - water_pressure(setup, f, k) : f->s[3][k];
      const double load = f->m[k] * setup->def->gravity[c] + (from >= 0 ? p->f[c][from] : 0.0);
      node->v[c] += f->m[k] * w->value[i] * (f->v[c][k] + f->slope[c][k] * grid->cell * w->s[i]);
      node->force[c] += w->value[i] * load - f->V[k] * stress * w->slope[i];
    }
  }
}

static mps_status scatter(const mpsi_boundary_setup *setup, const char *function, int32_t number,
                          mpsi_free_field *f) {
  for (int64_t k = 0; k < f->count; k++) {
    places w;
    if (!place(setup->grid, f, f->y[k], &w))
      return refuse_place(setup->context, setup->run, function, number, f->y[k]);
    scatter_particle(setup, f, k, &w);
  }
  return MPS_OK;
}

/* ---- mirrors across y ------------------------------------------------------------------------ */

/* R and (I - R) v_w of side `number`; false: it is not a mirror. */
static bool find_mirror(const mpsi_boundary_setup *setup, int32_t number, double *keeps,
                        double *carried) {
  if (!mpsi_is_mirror(setup->mirrors, number)) return false;
  const mpsi_boundary *boundary = &setup->boundaries->boundary[number];
  for (int c = 0; c < 2; c++) {
    const bool turns = mpsi_side_turns(boundary, Y, c);
    keeps[c] = turns ? -1.0 : 1.0;
    carried[c] = turns ? 2.0 * boundary->v[c] : 0.0;
  }
  return true;
}

/* Number of the node `layer` beyond a side, and of its partner; false: not in the column. */
static bool find_couple(const mpsi_boundary_setup *setup, const mpsi_free_field *f, int32_t number,
                        int64_t layer, int64_t *ghost, int64_t *partner) {
  const int64_t upper = number % 2, wall = upper ? setup->grid->high[Y] : setup->grid->low[Y];
  *ghost = wall + (upper ? layer : -layer) - f->first;
  *partner = wall - (upper ? layer : -layer) - f->first;
  return *ghost >= 0 && *ghost < f->nodes && *partner >= 0 && *partner < f->nodes;
}

static void fold(const mpsi_boundary_setup *setup, mpsi_free_field *f, int32_t number) {
  double keeps[2], carried[2];
  int64_t ghost, partner;
  if (!find_mirror(setup, number, keeps, carried)) return;
  for (int64_t layer = 1; find_couple(setup, f, number, layer, &ghost, &partner); layer++) {
    mpsi_field_node *from = &f->node[ghost], *to = &f->node[partner];
    to->mass += from->mass;
    to->across += from->across, to->along += from->along;
    for (int c = 0; c < 2; c++) {
      to->v[c] += keeps[c] * from->v[c] + from->mass * carried[c];
      to->force[c] += keeps[c] * from->force[c];
      for (int q = 0; q < MPSI_FIELD_PLANES; q++)
        to->traction[q][c] += keeps[c] * from->traction[q][c];
    }
    memset(from, 0, sizeof *from);
  }
}

static void unfold(const mpsi_boundary_setup *setup, mpsi_free_field *f, int32_t number) {
  double keeps[2], carried[2];
  int64_t ghost, partner;
  if (!find_mirror(setup, number, keeps, carried)) return;
  for (int64_t layer = 1; find_couple(setup, f, number, layer, &ghost, &partner); layer++)
    for (int c = 0; c < 2; c++) {
      f->node[ghost].v[c] = keeps[c] * f->node[partner].v[c] + carried[c];
      f->node[ghost].before[c] = keeps[c] * f->node[partner].before[c] + carried[c];
    }
}

/* ---- nodes ----------------------------------------------------------------------------------- */

static void update(const mpsi_boundary_setup *setup, mpsi_free_field *f) {
  for (int64_t n = 0; n < f->nodes; n++) {
    mpsi_field_node *node = &f->node[n];
    for (int c = 0; c < 2; c++) {
      node->before[c] = node->mass > 0.0 ? node->v[c] / node->mass : 0.0;
      node->v[c] =
          node->mass > 0.0 ? node->before[c] + setup->run->dt * (node->force[c] / node->mass) : 0.0;
    }
    node->across = fmax(node->across, 0.0); /* the shape functions of a fit can be negative */
    node->along = fmax(node->along, 0.0);
  }
}

/* Dashpots of an absorbing side across y (absorb.c). */
static void absorb(const mpsi_boundary_setup *setup, mpsi_free_field *f, int32_t number,
                   mpsi_field_node *node, double *dashpot) {
  double *rest = f->rest + 3 * (number % 2), v[3];
  mpsi_boundary boundary = setup->boundaries->boundary[number];
  boundary.finds = boundary.finds || rest[2] != 0.0;
  if (boundary.finds) boundary.found += setup->run->dt;
  if (!setup->boundaries->boundary[number].finds) boundary.settle = 0.0;
  mpsi_dashpot of = {dashpot[0], dashpot[1], {rest[0], rest[1], 0.0}};
  const double values[4] = {node->mass, node->v[0], node->v[1], 0.0};
  mpsi_mpm_apply_dashpot(setup->grid, setup->run->dt, &boundary, &of, values, node->before, v);
  for (int c = 0; c < 2; c++) node->v[c] = v[c], rest[c] = of.rest[c];
  rest[2] = 0.0;
}

/* Coefficients of the dashpots at side `number`: sums over the particles in the cells there. */
static void find_dashpot(const mpsi_boundary_setup *setup, const mpsi_free_field *f, int32_t number,
                         double *out) {
  out[0] = out[1] = 0.0;
  for (int64_t k = 0; k < f->count; k++) {
    const double at = mpsi_grid_at(setup->grid, Y, f->y[k]);
    const double part = mpsi_mpm_part_at_side(setup->grid, number, at);
    if (!(part > 0.0)) continue;
    out[0] += part * f->m[k] * setup->grid->inverse * f->cp[k];
    out[1] += part * f->m[k] * setup->grid->inverse * f->cs[k];
  }
}

/* Applies side `number` to its node; `fixed`: bits of the components that it prescribes. */
static void prescribe_node(const mpsi_boundary_setup *setup, mpsi_free_field *f, int32_t number,
                           int64_t *at, unsigned *fixed) {
  const mpsi_boundary *boundary = &setup->boundaries->boundary[number];
  const int64_t wall = number % 2 ? setup->grid->high[Y] : setup->grid->low[Y];
  *at = wall - f->first;
  *fixed = 0;
  if (*at < 0 || *at >= f->nodes) return;
  mpsi_field_node *node = &f->node[*at];
  double dashpot[2];
  for (int c = 0; c < 2; c++) {
    if (!mpsi_side_turns(boundary, Y, c)) continue;
    node->v[c] = boundary->v[c];
    *fixed |= 1u << c;
  }
  if (mpsi_kind_of(boundary)->absorbs && node->mass > 0.0) {
    find_dashpot(setup, f, number, dashpot);
    absorb(setup, f, number, node, dashpot);
  }
}

/* Damping as in step/damping.c. */
static void damp(const mpsi_boundary_setup *setup, mpsi_free_field *f, const int64_t *wall,
                 const unsigned *fixed) {
  const double local = setup->def->local_damping;
  const double keeps = 1.0 / (1.0 + setup->def->viscous_damping * setup->run->dt);
  if (!(local > 0.0) && !(setup->def->viscous_damping > 0.0)) return;
  for (int64_t n = 0; n < f->nodes; n++) {
    mpsi_field_node *node = &f->node[n];
    for (int c = 0; c < 2; c++) {
      double *v = &node->v[c];
      if ((n == wall[0] && fixed[0] >> c & 1) || (n == wall[1] && fixed[1] >> c & 1)) continue;
      if (local > 0.0) {
        const double change = local * fabs(*v - node->before[c]);
        *v = *v > 0.0 ? fmax(*v - change, 0.0) : fmin(*v + change, 0.0);
      }
      *v *= keeps;
    }
  }
}

/* ---- nodes to particles ---------------------------------------------------------------------- */

static void gather(const mpsi_boundary_setup *setup, mpsi_free_field *f) {
  const mpsi_grid *grid = setup->grid;
  const double keep = mpsi_kept_fraction(setup->def, setup->p, setup->run->dt,
                                         mpsi_wave_time(setup->run, grid->cell));
  for (int64_t k = 0; k < f->count; k++) {
    places w;
    if (!place(grid, f, f->y[k], &w)) continue; /* refused in scatter */
    double moves[2];
    for (int c = 0; c < 2; c++) {
      double v = 0.0, before = 0.0, slope = 0.0, derivative = 0.0;
      for (int i = 0; i <= grid->spline; i++) {
        const double of = f->node[w.at + i].v[c];
        v += w.value[i] * of, slope += w.slope[i] * of, derivative += w.derivative[i] * of;
        before += w.value[i] * f->node[w.at + i].before[c];
      }
      moves[c] = v;
      f->v[c][k] = v + keep * (f->v[c][k] - before);
      f->slope[c][k] = slope;
      f->derivative[c][k] = grid->strain_by_fit ? slope : derivative;
    }
    f->y[k] += setup->run->dt * moves[Y];
    const double low = grid->origin[Y] + grid->cell * (double)grid->low[Y];
    const double high = grid->origin[Y] + grid->cell * (double)grid->high[Y];
    f->y[k] = fmin(fmax(f->y[k], low), high);
  }
}

/* The law of the particles [begin, begin + n) of one material. */
static mps_status apply_law(const mpsi_boundary_setup *setup, const char *function,
                            mpsi_free_field *f, int64_t begin, int64_t n) {
  static const double none[MPSI_CHUNK] = {0.0};
  const mpsi_law_use *law = &setup->p->laws.law[f->law[begin]];
  double *history[MPSI_MATERIAL_COLUMNS];
  char message[MPSI_MATERIAL_MESSAGE] = "";
  int64_t flags[MPSI_CHUNK] = {0}, refused = -1;
  mps_material_block block;
  static const int planar[5] = {0, 1, 3, 4, 8};
  mpsi_mpm_begin_block(&block);
  block.dim = 2;
  block.count = n;
  block.dt = setup->run->dt;
  block.time = setup->run->time + setup->run->dt;
  block.ids = f->id + begin;
  block.flags = flags;
  block.volume_ratio = (law->reads_volume ? f->J : f->V) + begin;
  block.gradient[0] = block.gradient[3] = none;
  block.gradient[1] = f->derivative[0] + begin;
  block.gradient[4] = f->derivative[Y] + begin;
  for (int c = 0; c < 5; c++)
    block.deformation[planar[c]] = law->needs_deformation ? f->F[c] + begin : NULL;
  for (int c = 0; c < 4; c++) block.stress[c] = f->s[c] + begin;
  block.position[0] = f->x + begin, block.position[Y] = f->y + begin;
  if (setup->p->laws.temperature) block.temperature = f->temperature + begin;
  for (int32_t h = 0; h < law->columns; h++) history[h] = f->history + h * f->count + begin;
  block.history = history;
  block.history_count = law->columns;
  block.message = message;
  block.message_size = sizeof message - 1;
  block.refused = &refused;
  for (int64_t k = begin; law->reads_volume && k < begin + n; k++) f->V[k] /= f->J[k];
  const mps_status status = mpsi_material_apply(law->material, &block);
  for (int64_t k = begin; law->reads_volume && k < begin + n; k++) f->V[k] *= f->J[k];
  if (status == MPS_OK) return status;
  const bool there = refused >= 0 && refused < n;
  return mpsi_material_refused(setup->context, function, law->material, status, message,
                               there ? f->id[begin + refused] : -1, setup->run->steps);
}

/* The present temperatures of the particles that were copied, while they are there. */
static void update_temperatures(const mpsi_columns *p, mpsi_free_field *f) {
  for (int64_t k = 0; p->laws.temperature && k < f->count; k++) {
    const int64_t from = mps_particles_index(p->set, f->id[k]);
    if (from >= 0) f->temperature[k] = p->laws.temperature[from];
  }
}

static mps_status apply_laws(const mpsi_boundary_setup *setup, const char *function,
                             mpsi_free_field *f) {
  mps_status status = MPS_OK;
  update_temperatures(setup->p, f);
  memcpy(f->former, f->V, (size_t)f->count * sizeof *f->V);
  for (int64_t k = 0, n; k < f->count && status == MPS_OK; k += n) {
    for (n = 1; n < MPSI_CHUNK && k + n < f->count && f->law[k + n] == f->law[k];) n++;
    status = apply_law(setup, function, f, k, n);
  }
  if (status != MPS_OK) return status;
  for (int64_t k = 0; k < f->count; k++) { /* mpsi_mpm_follow_motion */
    const double growth = setup->run->dt * f->derivative[Y][k];
    if (setup->p->laws.law[f->law[k]].opening >= 0)
      f->former[k] = f->V[k] / (1.0 + growth * (1.0 + 0.5 * growth));
  }
  respond(setup, f);
  return status;
}

/* ---- a step ---------------------------------------------------------------------------------- */

static mps_status step(const mpsi_boundary_setup *setup, const char *function, int32_t number,
                       mpsi_free_field *f) {
  int64_t wall[2];
  unsigned fixed[2];
  memset(f->node, 0, (size_t)f->nodes * sizeof *f->node);
  take_water(setup, f);
  MPSI_TRY(find_traction(setup, function, number, f));
  MPSI_TRY(scatter(setup, function, number, f));
  for (int32_t k = MPS_SIDE_Y_LOWER; k <= MPS_SIDE_Y_UPPER; k++) fold(setup, f, k);
  update(setup, f);
  for (int32_t k = 0; k < 2; k++)
    prescribe_node(setup, f, MPS_SIDE_Y_LOWER + k, &wall[k], &fixed[k]);
  damp(setup, f, wall, fixed);
  for (int32_t k = MPS_SIDE_Y_UPPER; k >= MPS_SIDE_Y_LOWER; k--) unfold(setup, f, k);
  gather(setup, f);
  return apply_laws(setup, function, f);
}

mps_status mpsi_mpm_move_free_fields(const mpsi_boundary_setup *setup, const char *function) {
  mps_status status = MPS_OK;
  if (!mpsi_mpm_has_free_field(setup->boundaries)) return status;
  if (setup->water && !mpsi_pore_responds(setup->water))
    return mpsi_fail(setup->context, function, MPS_ERROR_STATE,
                     "a side is of kind MPS_BOUNDARY_FREE_FIELD, whose column has no implicit pore "
                     "pressures: choose MPS_PORE_SCHEME_EXPLICIT, or the kind MPS_BOUNDARY_ROLLER "
                     "or MPS_BOUNDARY_ABSORBING");
  for (int32_t k = 0; k < 2; k++) {
    mpsi_free_field *f = setup->boundaries->boundary[k].field;
    if (f) memcpy(f->kept, f->state, (size_t)f->doubles * sizeof *f->state);
  }
  for (int32_t k = 0; k < 2 && status == MPS_OK; k++)
    if (setup->boundaries->boundary[k].field)
      status = step(setup, function, k, setup->boundaries->boundary[k].field);
  if (status != MPS_OK) mpsi_mpm_return_free_fields(setup->boundaries);
  return status;
}

void mpsi_mpm_return_free_fields(const mpsi_boundaries *boundaries) {
  for (int32_t k = 0; k < 2; k++) {
    mpsi_free_field *f = boundaries->boundary[k].field;
    if (f) memcpy(f->state, f->kept, (size_t)f->doubles * sizeof *f->state);
  }
}

/* ---- ground that passes a side --------------------------------------------------------------- */

#define LEVEL 0.25 /* cells: how far apart level ground at the two sides may be in height */
#define ALIKE 0.01 /* and in mass, as a part of it */

/* Whether the ground at both sides is the same: columns of particles of the same laws and masses at
 * the same heights. `top` (m): a particle above it is not of that ground, but lies on it. */
static bool is_level(const mpsi_grid *grid, const mpsi_boundaries *boundaries, double *top) {
  const mpsi_free_field *a = boundaries->boundary[0].field, *b = boundaries->boundary[1].field;
  if (a->count != b->count || a->rows != b->rows) return false;
  bool same = true;
  *top = -INFINITY;
  for (int64_t k = 0; k < a->count && same; k++) {
    same = a->law[k] == b->law[k] && fabs(a->y[k] - b->y[k]) < LEVEL * grid->cell &&
           fabs(a->m[k] - b->m[k]) < ALIKE * a->m[k];
    *top = fmax(*top, fmin(a->y[k], b->y[k]) + LEVEL * grid->cell);
  }
  return same;
}

/* The place at a side that is in the domain. */
static double place_at(const mpsi_grid *grid, int32_t number) {
  const double wall = (double)(number == MPS_SIDE_X_LOWER ? grid->low[0] : grid->high[0]);
  const double inwards = number == MPS_SIDE_X_LOWER ? INFINITY : -INFINITY;
  double x = grid->origin[0] + grid->cell * wall;
  while ((mpsi_grid_at(grid, 0, x) - wall) * inwards < 0.0) x = nextafter(x, inwards);
  return x;
}

bool mpsi_mpm_pass_free_fields(const mpsi_boundary_setup *setup) {
  const mpsi_grid *grid = setup->grid;
  const mpsi_columns *p = setup->p;
  const double low = (double)grid->low[0], high = (double)grid->high[0];
  double top = INFINITY;
  bool any = false, asked = false;
  if (!setup->boundaries->boundary[0].field || !setup->boundaries->boundary[1].field) return false;
  for (int64_t b = 0; b < grid->cell_count; b++) {
    const mpsi_cell_block *cells = &grid->cells[b];
    const int64_t first = (int64_t)cells->at[0] * MPSI_SIDE + cells->low[0];
    const int64_t last = (int64_t)cells->at[0] * MPSI_SIDE + cells->high[0];
    if (first > grid->low[0] && last < grid->high[0]) continue;
    for (int64_t k = cells->begin; k < cells->end; k++) {
      const double X = mpsi_grid_at(grid, 0, p->x[0][k]), v = p->v[0][k];
      if (!(X - low < AT_SIDE && v < 0.0) && !(high - X < AT_SIDE && v > 0.0)) continue;
      if (!asked && !is_level(grid, setup->boundaries, &top)) return false;
      asked = true;
      if (p->x[Y][k] > top) continue;
      p->x[0][k] = place_at(grid, v < 0.0 ? MPS_SIDE_X_UPPER : MPS_SIDE_X_LOWER);
      any = true;
    }
  }
  return any;
}

const mpsi_field_node *mpsi_mpm_beside(const mpsi_grid *grid, const mpsi_boundary *boundary,
                                       const int32_t *at, int k, int *plane) {
  int place[3];
  mpsi_unravel(k, MPSI_SIDE, place);
  const int64_t x = (int64_t)at[0] * MPSI_SIDE + place[0];
  const int64_t n = (int64_t)at[Y] * MPSI_SIDE + place[Y] - boundary->field->first;
  *plane = (int)(boundary->first[0] == grid->low[0] ? x - grid->low[0] : grid->high[0] - x);
  return n >= 0 && n < boundary->field->nodes ? &boundary->field->node[n] : NULL;
}
