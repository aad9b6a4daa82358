/* filter.c - the filter of the mean stress of frictional laws, and of the pressure of fluids.
 *
 * Sand that has flowed bears its weight by half of its particles: the others are open, at no stress
 * at all, and the nodes, which see sums, do not notice. What is filtered, every eighth step, is e =
 * p + K gap, the mean stress that an open particle would have if its grains still held together:
 * below 0 they are closed. p alone would not do: the law puts it back to 0 wherever there is a gap.
 * With the operator S of the means by node, (S e)_p = sum w_ip (sum w_iq V_q e_q/sum w_iq V_q),
 *
 *   r = a (e - S e), a = min(1, 8 dt BETA c/h), but at most 8 S(K dg) in size,   e' = e - (r - S
 * r),
 *
 * dg being the plastic strain of the step: roughness is what plastic strains leave behind, each at
 * most K times its own size of mean stress, in the particles that yield and in their neighbours,
 * whose nodes share it out. So ground that stays elastic is left alone, whatever its loads do, as
 * its true gradients would be filtered for ever; and how smooth flowed sand is does not depend on
 * its stiffness. The filter's own returns are not in dg, else they would keep it going. The form is
 * such that sum V e is kept whatever r is from particle to particle, a smooth field to the fourth
 * order too, and what S does not see decays.
 * At a wall or a surface all particles of a node lie on one side of it. So e goes to the nodes and
 * back along the slope that it has in ground at rest (closed_stress), and stays as it is there.
 *
 * Where sand flows so slowly that its grains are at rest with one another, gaps are no roughness:
 * ground that heaves beside a footing is open, and opens on, and would take the load off the ground
 * under the edge. So K gap counts up to rho (h dg/dt/I)^2, I an inertial number.
 *
 * p' is e' where that is closed, else what is left of p, the gap the rest; the deviatoric stress
 * stays; then the law's own return, without strain. V follows the elastic volume strain of p' - p.
 *
 * A fluid remembers no more than its volume, so that what the filter does to a true gradient does
 * not add up: its pressure is back by a wave over a cell. So for it a = 1 without bound, every
 * fourth step, and V/V0 is that of p'. Velocities do not change. The elastic energy that goes is
 * counted as spent (energy.h).
 *
 * Both passes have loops of their own for each kind of law, dimension and degree, and for blocks
 * beside thin bodies. SPDX-License-Identifier: BSD-3-Clause */
#include "means.h"

#include "material/state_equation.h"
#include "mpm/water/water.h"

#include <string.h>

#define BETA 0.06
#define QUASI_STATIC 0.005 /* I: .001 takes a tenth off a footing, .01 leaves noise in heaps */
enum { EVERY = 8, EVERY_OF_FLUID = 4 }; /* steps */

/* Sand and fluids are filtered each by themselves: a mean over both would be of neither. */
typedef enum filtered_kind { SAND, FLUID } filtered_kind;

static filtered_kind kind_of(const mpsi_law_use *law) { return law->gap < 0 ? FLUID : SAND; }

/* Whether this step filters that kind, of which there is some law. Saturated sand is left alone
 * where pore pressures follow the volumes of the particles: these would follow the filter's changes
 * of volume too, K_w/(n K) times as large as those of the filtered stress, and feed it, until sand
 * on quadratic weights bursts. Means over cells keep the pressures of the water smooth. */
static bool filters(const mpsi_columns *p, const mpsi_water *water, const mpsi_run *run,
                    filtered_kind kind) {
  bool any = false;
  if (run->steps % (kind == FLUID ? EVERY_OF_FLUID : EVERY) != 0) return false;
  if (kind == SAND && mpsi_pore_responds(water)) return false;
  for (int32_t k = 0; k < p->laws.count; k++)
    any = any || (p->laws.law[k].filtered && kind_of(&p->laws.law[k]) == kind);
  return any;
}

bool mpsi_mpm_filters(const mpsi_columns *p, const struct mpsi_water *water, const mpsi_run *run) {
  return p->laws.some_filtered && (filters(p, water, run, SAND) || filters(p, water, run, FLUID));
}

/* ---- particles ------------------------------------------------------------------------------- */

MPSI_INLINE bool is_filtered(const mpsi_columns *p, int64_t k, filtered_kind kind) {
  const mpsi_law_use *law = mpsi_law_of(p, k);
  return law->filtered && kind_of(law) == kind;
}

static double mean_stress(const mpsi_columns *p, int64_t k) {
  return (p->s[0][k] + p->s[1][k] + p->s[2][k]) * (1.0 / 3.0);
}

static double *gap_of(const mpsi_law_use *law, int64_t k) { return law->history[law->gap] + k; }

/* K, Pa. */
static double bulk_of(const mpsi_columns *p, int64_t k) {
  return mpsi_law_of(p, k)->bulk * mpsi_mpm_stiffness(p, k);
}

/* dg: plastic strain of this step. */
static double flow_of(const mpsi_columns *p, int64_t k) {
  return fmax(0.0, mpsi_law_of(p, k)->history[mpsi_law_of(p, k)->strain][k] - p->rough[k]);
}

/* e, Pa, and its slope (per cell along each axis) in ground at rest, compressed by its weight
 * without lateral strain; none where it is open. */
MPSI_INLINE double closed_stress(const mpsi_grid *grid, const mpsi_columns *p,
                                 const mps_mpm_def *def, double dt, filtered_kind kind, int64_t k,
                                 double *slope) {
  const mpsi_law_use *law = mpsi_law_of(p, k);
  const double gap = kind == FLUID ? 0.0 : *gap_of(law, k), density = p->m[k] / p->V[k];
  const double weight = gap > 0.0 ? 0.0 : density * law->bulk / law->modulus * grid->cell;
  for (int c = 0; c < 3; c++) slope[c] = c < grid->dim ? -weight * def->gravity[c] : 0.0;
  if (!(gap > 0.0)) return mean_stress(p, k);
  const double speed = grid->cell * flow_of(p, k) / (dt * QUASI_STATIC);
  return mean_stress(p, k) + fmin(bulk_of(p, k) * gap, density * speed * speed);
}

/* K dg, Pa: the mean stress that the plastic strain of this step can have made. */
static double made_stress(const mpsi_columns *p, int64_t k) {
  return bulk_of(p, k) * flow_of(p, k);
}

/* r: of the difference `off` from the nodes' mean; `made`, the nodes' mean of K dg. */
MPSI_INLINE double find_rough_part(const mpsi_grid *grid, const mpsi_columns *p, double dt,
                                   filtered_kind kind, int64_t k, double off, double made) {
  if (kind == FLUID) return off;
  const double modulus = mpsi_law_of(p, k)->modulus * mpsi_mpm_stiffness(p, k);
  const double wave = sqrt(modulus * p->V[k] / p->m[k]);
  const double decay = fmin(1.0, EVERY * BETA * wave * grid->inverse * dt);
  return copysign(fmin(decay * fabs(off), EVERY * made), off);
}

/* ---- supports -------------------------------------------------------------------------------- */

/* Along each axis the nodes of the block's tile, those beyond a mirror by their partners: where
 * they are, in cells, and as offsets into the tile. */
typedef struct axes {
  double place[3][MPSI_TILE_SIDE];
  int offset[3][MPSI_TILE_SIDE];
} axes;

static void find_axes(const mpsi_grid *grid, const mpsi_cell_block *cells, axes *out) {
  for (int c = 0, stride = 1; c < 3; c++, stride *= MPSI_TILE_SIDE)
    for (int i = 0; i < MPSI_TILE_SIDE; i++) {
      const int partner = c < grid->dim ? mpsi_mpm_mirror_partner(grid, cells, c, i) : i;
      out->place[c][i] = partner;
      out->offset[c][i] = stride * partner;
    }
}

typedef struct support {
  const int *at[3];           /* offsets of its nodes along each axis */
  double w[3][4], away[3][4]; /* weights; cells from the particle to the node */
  uint64_t across;            /* bit 16 k + 4 j + i: the node's values across (thin_bodies.h) */
} support;

/* Stencil of a particle as G2P found it. */
MPSI_INLINE void find_support(const mps_mpm *mpm, const mpsi_cell_block *cells, const axes *all,
                              int dim, int spline, bool thin, int64_t k, support *out) {
  int base[3];
  mpsi_unravel(mpsi_stencil_node(mpm->p.stencil[k]), MPSI_TILE_SIDE, base);
  for (int c = 0; c < dim; c++) {
    const double t = mpm->p.t[c][k];
    mpsi_weights(spline, t, out->w[c]);
    for (int i = 0; i <= spline; i++) out->away[c][i] = all->place[c][base[c] + i] - (base[c] + t);
    out->at[c] = all->offset[c] + base[c];
  }
  out->across = 0;
  if (!thin) return;
  double x[3];
  mpsi_former_place(&mpm->grid, &mpm->p, cells, base, k, x);
  out->across = mpsi_mpm_find_parted(&mpm->grid, &mpm->contact, cells, base, x).across;
}

/* The tile that a node of a support has its value in. */
MPSI_INLINE mpsi_node *tile_of(const mpsi_worker *worker, bool thin, const support *s, int node) {
  return thin && (s->across >> node & 1) ? worker->across_tile : worker->tile;
}

/* Adds {V, V value} by the weights, the value prolonged along its slope (per cell), and V made. No
 * slope (NULL): the value alone. */
MPSI_INLINE void give(const mpsi_worker *worker, int dim, int spline, bool thin, const support *s,
                      double V, double value, const double *slope, double made) {
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const double weight = V * s->w[1][j] * (dim == 3 ? s->w[2][k] : 1.0);
      const int from = s->at[1][j] + (dim == 3 ? s->at[2][k] : 0);
      double row = value;
      if (slope) row += slope[1] * s->away[1][j] + (dim == 3 ? slope[2] * s->away[2][k] : 0.0);
      for (int i = 0; i <= spline; i++) {
        double *to = tile_of(worker, thin, s, 16 * k + 4 * j + i)[from + s->at[0][i]];
        const double w = weight * s->w[0][i];
        to[MPSI_SUM_VOLUME] += w;
        if (slope) to[MPSI_SUM_FLOW] += w * made;
        to[MPSI_SUM_VALUE] += w * (slope ? row + slope[0] * s->away[0][i] : row);
      }
    }
}

/* How far the mean of the nodes' places is from the particle, along the slope: 0 but at mirrors. */
MPSI_INLINE double rise(int dim, int spline, const support *s, const double *slope) {
  double sum = 0.0;
  for (int c = 0; c < dim; c++)
    for (int i = 0; i <= spline; i++) sum += slope[c] * (s->w[c][i] * s->away[c][i]);
  return sum;
}

/* The mean of the nodes' means of one of the sums, which are in the tile. All nodes of the support
 * have some volume, this particle's, so that the weights add up to 1. */
MPSI_INLINE double take(const mpsi_worker *worker, int dim, int spline, bool thin, const support *s,
                        int which) {
  double sum = 0.0;
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const int from = s->at[1][j] + (dim == 3 ? s->at[2][k] : 0);
      double row = 0.0;
      for (int i = 0; i <= spline; i++)
        row += s->w[0][i] * tile_of(worker, thin, s, 16 * k + 4 * j + i)[from + s->at[0][i]][which];
      sum += row * s->w[1][j] * (dim == 3 ? s->w[2][k] : 1.0);
    }
  return sum;
}

/* The means of the nodes under a block, to the tile of the worker. */
static void gather_means(const mpsi_grid *grid, const mpsi_cell_block *cells,
                         const mpsi_worker *worker) {
  for (int across = 0; across < (cells->thin ? 2 : 1); across++)
    for (int k = cells->low[2]; k < cells->high[2]; k++)
      for (int j = cells->low[1]; j < cells->high[1]; j++)
        for (int i = cells->low[0]; i < cells->high[0]; i++) {
          const double *from = mpsi_sums_at(grid, cells, NULL, across != 0, i, j, k);
          const double volume = from[MPSI_SUM_VOLUME];
          double *to = mpsi_sums_at(grid, cells, worker, across != 0, i, j, k);
          for (int c = MPSI_SUM_VALUE; c < MPSI_SUMS; c++)
            to[c] = volume > 0.0 ? from[c] / volume : 0.0;
        }
}

/* ---- the four loops -------------------------------------------------------------------------- */

typedef enum loop {
  SUM_STRESS, /* e and K dg to the tile */
  FIND_ROUGH, /* r by their means */
  SUM_ROUGH,  /* r to the tile */
  FIND_SMOOTH /* r - S r by the means of r */
} loop;

MPSI_INLINE void run_loop(mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_worker *worker,
                          int dim, int spline, bool thin, filtered_kind kind, loop which) {
  double *rough = mpm->p.rough;
  double slope[3];
  axes all;
  support s;
  find_axes(&mpm->grid, cells, &all);
  for (int64_t k = cells->begin; k < cells->end; k++) {
    if (!is_filtered(&mpm->p, k, kind)) continue;
    find_support(mpm, cells, &all, dim, spline, thin, k, &s);
    const double closed =
        which == SUM_STRESS || which == FIND_ROUGH
            ? closed_stress(&mpm->grid, &mpm->p, &mpm->def, mpm->run.dt, kind, k, slope)
            : 0.0;
    if (which == SUM_STRESS)
      give(worker, dim, spline, thin, &s, mpm->p.V[k], closed, slope,
           kind == FLUID ? 0.0 : made_stress(&mpm->p, k));
    else if (which == SUM_ROUGH)
      give(worker, dim, spline, thin, &s, mpm->p.V[k], rough[k], NULL, 0.0);
    else if (which == FIND_ROUGH)
      rough[k] =
          find_rough_part(&mpm->grid, &mpm->p, mpm->run.dt, kind, k,
                          closed + rise(dim, spline, &s, slope) -
                              take(worker, dim, spline, thin, &s, MPSI_SUM_VALUE),
                          kind == FLUID ? 0.0 : take(worker, dim, spline, thin, &s, MPSI_SUM_FLOW));
    else
      rough[k] -= take(worker, dim, spline, thin, &s, MPSI_SUM_VALUE);
  }
}

MPSI_INLINE void choose_loop(mps_mpm *mpm, int64_t b, int32_t number, filtered_kind kind,
                             loop which) {
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  const mpsi_worker *worker = &mpm->grid.workers[number];
  const int dim = mpm->grid.dim, spline = mpm->grid.spline;
  if (dim == 2 && !cells->thin && spline == 2)
    run_loop(mpm, cells, worker, 2, 2, false, kind, which);
  else if (dim == 2 && !cells->thin)
    run_loop(mpm, cells, worker, 2, 3, false, kind, which);
  else if (dim == 3 && !cells->thin && spline == 2)
    run_loop(mpm, cells, worker, 3, 2, false, kind, which);
  else if (dim == 3 && !cells->thin)
    run_loop(mpm, cells, worker, 3, 3, false, kind, which);
  else
    run_loop(mpm, cells, worker, dim, spline, true, kind, which);
}

/* ---- stresses -------------------------------------------------------------------------------- */

/* Ratio of volumes after a volume strain, as the law takes it: to the third order, so that strains
 * to and fro leave the volume as it was; exactly where the law reads V/V0. */
static double growth_of(const mpsi_law_use *law, double strain) {
  if (law->reads_volume) return exp(strain);
  return (1.0 + 0.5 * strain) / (1.0 - 0.5 * strain);
}

/* e' = e - (r - S r), in p and the gap. */
static void change_stress(const mpsi_columns *p, int64_t k) {
  const mpsi_law_use *law = mpsi_law_of(p, k);
  double *gap = gap_of(law, k);
  const double bulk = bulk_of(p, k), was = mean_stress(p, k);
  const double closed = was + bulk * *gap - p->rough[k];
  const double now =
      *gap > 0.0 || closed > 0.0 ? fmin(closed, fmax(was, 0.0)) : closed; /* open or not */
  *gap = fmax(0.0, (closed - now) / bulk);
  for (int c = 0; c < 3; c++) p->s[c][k] += now - was;
  const double growth = growth_of(law, (now - was) / bulk);
  p->V[k] *= growth;
  if (law->reads_volume) p->J[k] *= growth; /* of the same V0 */
}

/* The same for a fluid, whose state is its volume. One without tension bears none. */
static void change_pressure(const mpsi_columns *p, mpsi_water *water, int64_t k) {
  const mpsi_law_use *law = mpsi_law_of(p, k);
  const double was = mean_stress(p, k);
  const double now = fmin(was - p->rough[k], fmax(was, 0.0));
  const double J = mpsi_material_fluid_volume(law->material, -now);
  if (!(J > 0.0 && isfinite(J))) return; /* tension that no volume has */
  for (int c = 0; c < 3; c++) p->s[c][k] += now - was;
  const double former = p->V[k];
  p->V[k] *= J / p->J[k];
  p->J[k] = J;
  if (mpsi_pore_responds(water)) mpsi_pore_follow(p, water, k, former);
}

static void change(mps_mpm *mpm, const mpsi_cell_block *cells, filtered_kind kind, int64_t begin,
                   int64_t end) {
  for (int64_t k = begin; k < end; k++)
    if (is_filtered(&mpm->p, k, kind) && kind == FLUID)
      change_pressure(&mpm->p, mpm->water, k);
    else if (is_filtered(&mpm->p, k, kind))
      change_stress(&mpm->p, k);
  if (kind == SAND) mpsi_mpm_return_stress(&mpm->grid, &mpm->p, &mpm->run, cells, begin, end);
}

static void change_block(mps_mpm *mpm, int64_t b, filtered_kind kind) {
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  for (int64_t begin = cells->begin, end; begin < cells->end; begin = end) {
    end = begin + MPSI_CHUNK < cells->end ? begin + MPSI_CHUNK : cells->end;
    mpsi_before_law before;
    if (mpm->energy.counts) mpsi_mpm_energy_before_law(&mpm->grid, &mpm->p, begin, end, &before);
    change(mpm, cells, kind, begin, end);
    if (mpm->energy.counts)
      mpsi_mpm_energy_smoothed(&mpm->grid, &mpm->p, &mpm->energy, cells, &before, begin, end);
  }
}

/* ---- the passes ------------------------------------------------------------------------------ */

/* The tasks of the four loops over a block, for each kind: all that a pass hands them is the solver
 * and the block. */
#define DEFINE_TASKS(kind, KIND)                                                                   \
  static void sum_stress_of_##kind(void *data, int64_t b, int32_t number) {                        \
    sum(data, b, number, KIND, SUM_STRESS);                                                        \
  }                                                                                                \
  static void sum_rough_of_##kind(void *data, int64_t b, int32_t number) {                         \
    sum(data, b, number, KIND, SUM_ROUGH);                                                         \
  }                                                                                                \
  static void add_stress_of_##kind(void *data, int64_t b, int32_t number) {                        \
    mpsi_add_sums(data, b, number, sum_stress_of_##kind);                                          \
  }                                                                                                \
  static void add_rough_of_##kind(void *data, int64_t b, int32_t number) {                         \
    mpsi_add_sums(data, b, number, sum_rough_of_##kind);                                           \
  }                                                                                                \
  static void find_rough_of_##kind(void *data, int64_t b, int32_t number) {                        \
    find_rough(data, b, number, KIND);                                                             \
  }                                                                                                \
  static void filter_##kind(void *data, int64_t b, int32_t number) {                               \
    filter_stress(data, b, number, KIND);                                                          \
  }

MPSI_INLINE void sum(mps_mpm *mpm, int64_t b, int32_t number, filtered_kind kind, loop which) {
  mpsi_clear_sums(&mpm->grid, b, number);
  choose_loop(mpm, b, number, kind, which);
}

MPSI_INLINE void find_rough(mps_mpm *mpm, int64_t b, int32_t number, filtered_kind kind) {
  gather_means(&mpm->grid, &mpm->grid.cells[b], &mpm->grid.workers[number]);
  choose_loop(mpm, b, number, kind, FIND_ROUGH);
}

MPSI_INLINE void filter_stress(mps_mpm *mpm, int64_t b, int32_t number, filtered_kind kind) {
  gather_means(&mpm->grid, &mpm->grid.cells[b], &mpm->grid.workers[number]);
  choose_loop(mpm, b, number, kind, FIND_SMOOTH);
  change_block(mpm, b, kind);
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, number);
  mpm->kernels->speed(&work);
}

DEFINE_TASKS(sand, SAND)
DEFINE_TASKS(fluid, FLUID)

void mpsi_mpm_filter(mps_mpm *mpm) {
  if (filters(&mpm->p, mpm->water, &mpm->run, SAND)) {
    mpsi_run_sums(mpm, sum_stress_of_sand, add_stress_of_sand, find_rough_of_sand);
    mpsi_run_sums(mpm, sum_rough_of_sand, add_rough_of_sand, filter_sand);
  }
  if (filters(&mpm->p, mpm->water, &mpm->run, FLUID)) {
    mpsi_run_sums(mpm, sum_stress_of_fluid, add_stress_of_fluid, find_rough_of_fluid);
    mpsi_run_sums(mpm, sum_rough_of_fluid, add_rough_of_fluid, filter_fluid);
  }
}
