/* laws.c - the materials' laws on the particles of a block, Nakamura (45)-(48): a law is called
 * with runs of particles that have it. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/water/water.h"

#include <stdio.h>

void mpsi_mpm_begin_block(mps_material_block *block) {
  *block = (mps_material_block){.struct_size = sizeof *block};
}

/* Columns of particles [begin, end) as the law sees them: all members but its outputs. `flags` has
 * room for a chunk. */
static void find_columns(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_run *run,
                         const mpsi_law_use *law, int64_t begin, int64_t end, int64_t *flags,
                         mps_material_block *block) {
  static const int planar[5] = {0, 1, 3, 4, 8};
  block->dim = grid->dim;
  block->count = end - begin;
  block->dt = run->dt;
  block->time = run->time + run->dt;
  block->ids = p->laws.ids + begin;
  block->volume_ratio = (law->reads_volume ? p->J : p->V) + begin;
  memset(flags, 0, (size_t)(end - begin) * sizeof *flags);
  block->flags = flags;
  const int tensors = grid->dim == 3 ? 9 : 5;
  for (int c = 0; c < tensors; c++) {
    const int to = grid->dim == 3 ? c : planar[c];
    if (grid->geometry != MPS_MPM_GEOMETRY_PLANE_STRAIN || c < 4)
      block->gradient[to] = p->L[c] + begin;
    block->deformation[to] = law->needs_deformation ? p->F[c] + begin : NULL;
  }
  for (int c = 0; c < 2 * grid->dim; c++) block->stress[c] = p->s[c] + begin;
  for (int c = 0; c < grid->dim; c++) block->position[c] = p->x[c] + begin;
  if (p->laws.temperature) block->temperature = p->laws.temperature + begin;
}

/* The end of the particles from `begin` that obey its law, at most `end`. */
static int64_t end_of_run(const int64_t *law, int64_t begin, int64_t end) {
  if (!law) return end;
  int64_t k = begin + 1;
  while (k < end && law[k] == law[begin]) k++;
  return k;
}

/* Refusals are rare: threads wait for one another. */
static void note_refusal(mpsi_columns *p, const mpsi_cell_block *cells,
                         const mps_material *material, mps_status status, int64_t particle,
                         const char *message) {
  mpsi_refusal *r = &p->laws.refusal;
  while (atomic_flag_test_and_set_explicit(&r->busy, memory_order_acquire)) continue;
  if (!r->cells || cells < r->cells) {
    r->cells = cells;
    r->material = material;
    r->status = status;
    r->particle = particle;
    (void)snprintf(r->message, sizeof r->message, "%s", message);
  }
  atomic_flag_clear_explicit(&r->busy, memory_order_release);
}

static void apply_law(mpsi_columns *p, const mpsi_cell_block *cells, const mpsi_law_use *law,
                      mps_material_block *block, int64_t begin) {
  double *history[MPSI_MATERIAL_COLUMNS];
  char message[MPSI_MATERIAL_MESSAGE];
  int64_t refused = -1;
  message[0] = message[sizeof message - 1] = '\0';
  for (int32_t h = 0; h < law->columns; h++) history[h] = law->history[h] + begin;
  block->history = history;
  block->history_count = law->columns;
  block->message = message;
  block->message_size = sizeof message - 1;
  block->refused = &refused;
  const mps_status status = mpsi_material_apply(law->material, block);
  if (status == MPS_OK) return;
  const bool there = refused >= 0 && refused < block->count;
  note_refusal(p, cells, law->material, status, there ? begin + refused : -1, message);
}

/* Gives the law the derivatives D of its particles from the `first` on in place of L. */
static void take_strains(const mpsi_grid *grid, double *const *D, int64_t first,
                         mps_material_block *block) {
  for (int a = 0; a < grid->dim; a++)
    for (int b = 0; b < grid->dim; b++) block->gradient[3 * a + b] = D[grid->dim * a + b] + first;
}

/* The particles from `begin` on; `first` is its place in the columns D and the means. */
static void apply_run(const mpsi_law_block *laws, int64_t begin, int64_t end, double *const *D,
                      double (*mean)[MPSI_CHUNK], int64_t first) {
  mpsi_columns *p = laws->p;
  mps_material_block *seen = laws->seen;
  const mpsi_law_use *law = mpsi_law_of(p, begin);
  const bool counts = laws->energy->counts;
  int64_t flags[MPSI_CHUNK];
  find_columns(laws->grid, p, laws->run, law, begin, end, flags, seen);
  take_strains(laws->grid, D, first, seen);
  for (int c = 0; mean && c < 3; c++) seen->gradient[4 * c] = mean[c] + first;
  for (int64_t k = begin; law->filtered && law->strain >= 0 && k < end; k++)
    p->rough[k] = law->history[law->strain][k]; /* filter.c subtracts it from the new one */
  mpsi_before_law before;
  if (counts) mpsi_mpm_energy_before_law(laws->grid, p, begin, end, &before);
  /* Where the law works on J, V stands for V0 meanwhile. */
  for (int64_t k = begin; law->reads_volume && k < end; k++) p->V[k] /= p->J[k];
  apply_law(p, laws->cells, law, seen, begin);
  for (int64_t k = begin; law->reads_volume && k < end; k++) p->V[k] *= p->J[k];
  if (counts)
    mpsi_mpm_energy_law(laws->grid, p, laws->energy, laws->cells, law, seen, &before, begin);
}

void mpsi_mpm_apply_law(const mpsi_law_block *laws, int64_t begin, int64_t end, double *const *D,
                        double (*mean)[MPSI_CHUNK]) {
  for (int64_t k = begin, next; k < end; k = next) {
    next = end_of_run(laws->p->law, k, end);
    apply_run(laws, k, next, D, mean, k - begin);
  }
}

void mpsi_mpm_follow_motion(const mpsi_columns *p, double dt, const double *const *rate,
                            int64_t begin, int n, double *former) {
  if (!p->laws.some_open) return;
  for (int k = 0; k < n; k++) {
    const int64_t own = begin + k;
    if (mpsi_law_of(p, own)->opening < 0) continue;
    const double growth = dt * (rate[0][k] + rate[1][k] + (rate[2] ? rate[2][k] : 0.0));
    former[k] = p->V[own] / (1.0 + growth * (1.0 + 0.5 * growth));
  }
}

void mpsi_mpm_return_stress(const mpsi_grid *grid, mpsi_columns *p, const mpsi_run *run,
                            const mpsi_cell_block *cells, int64_t begin, int64_t end) {
  static const double rest[MPSI_CHUNK] = {0.0};
  for (int64_t k = begin, next; k < end; k = next) {
    next = end_of_run(p->law, k, end);
    const mpsi_law_use *law = mpsi_law_of(p, k);
    mps_material_block block;
    int64_t flags[MPSI_CHUNK];
    if (!law->filtered || law->gap < 0) continue;
    mpsi_mpm_begin_block(&block);
    find_columns(grid, p, run, law, k, next, flags, &block);
    for (int c = 0; c < 9; c++)
      if (block.gradient[c]) block.gradient[c] = rest;
    apply_law(p, cells, law, &block, k);
  }
}

/* A viscous law requires dt <= rho h^2/(4 dim viscosity) too: the modulus whose wave gives that. */
static void raise_to_viscous(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_law_use *law,
                             int64_t begin, int64_t end, double *moduli) {
  const double v = 4.0 * grid->dim * mpsi_material_viscosity(law->material) * grid->inverse;
  for (int64_t k = begin; v > 0.0 && k < end; k++)
    moduli[k - begin] = fmax(moduli[k - begin], v * v * p->V[k] / p->m[k]);
}

/* Waves go through the water too, unless its pressures are implicit. Where it flows, its pressures
 * have the limit 0.3 h^2/(2 dim D), D = k K_w/(n rho_w g), whatever the fraction of the limit that
 * a step takes: cells at a surface, half full, need that. */
static mpsi_pore_speeds stiffen_by_water(const mpsi_grid *grid, const mpsi_columns *p,
                                         mpsi_water *pores, const mps_mpm_def *def, int64_t begin,
                                         int64_t end, double *moduli) {
  const mps_pore_water_def *water = &pores->def;
  const double v = 2.0 * grid->dim * def->courant / 0.3 * grid->inverse *
                   (water->bulk / (water->density * MPS_PORE_GRAVITY));
  const double *n = p->n + begin, *V = p->V + begin, *m = p->m + begin;
  double most = 0.0, square = 0.0;
  if (!p->k) {
    for (int64_t k = 0; k < end - begin; k++) moduli[k] += water->bulk / n[k];
    return (mpsi_pore_speeds){0.0, 0.0};
  }
  for (int64_t k = 0; k < end - begin; k++) {
    const double inverse = 1.0 / n[k], c = v * inverse * p->k[begin + k];
    const double waves = moduli[k] + water->bulk * inverse, flow = c * c * (m[k] / V[k]);
    const double dry = moduli[k] * (V[k] / m[k]);
    square = dry > square ? dry : square;
    moduli[k] = waves > flow ? waves : flow;
    most = c > most ? c : most;
  }
  return (mpsi_pore_speeds){most, sqrt(square)};
}

void mpsi_mpm_find_moduli(const mpsi_grid *grid, const mpsi_columns *p, mpsi_water *water,
                          const mpsi_run *run, const mps_mpm_def *def, int64_t begin, int64_t end,
                          double *moduli, mpsi_pore_speeds *pores) {
  for (int64_t k = begin, next; k < end; k = next) {
    next = end_of_run(p->law, k, end);
    const mpsi_law_use *law = mpsi_law_of(p, k);
    if (mpsi_material_stiffens(law->material)) {
      mps_material_block block;
      mpsi_mpm_begin_block(&block);
      int64_t flags[MPSI_CHUNK];
      double *history[MPSI_MATERIAL_COLUMNS];
      find_columns(grid, p, run, law, k, next, flags, &block);
      for (int32_t h = 0; h < law->columns; h++) history[h] = law->history[h] + k;
      block.history = history;
      block.history_count = law->columns;
      mpsi_material_wave_moduli(law->material, &block, moduli + (k - begin));
    } else {
      for (int64_t q = k; q < next; q++) moduli[q - begin] = law->modulus;
    }
    raise_to_viscous(grid, p, law, k, next, moduli + (k - begin));
  }
  *pores = (mpsi_pore_speeds){0.0, 0.0};
  if (mpsi_pore_responds(water)) *pores = stiffen_by_water(grid, p, water, def, begin, end, moduli);
}
