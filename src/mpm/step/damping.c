/* damping.c - see damping.h. Local damping opposes the motion by a fraction of the unbalanced force
 * (Cundall 1987), viscous damping by the momentum times a rate. Neither acts on components that a
 * boundary prescribes, and both are applied after all other forces, so that the forces of
 * boundaries and bodies do not depend on them. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "core/base/room_array.h"

#include <string.h>

void mpsi_mpm_damp_nodes(const mpsi_grid *grid, const mps_mpm_def *def, double dt, int64_t g,
                         const uint8_t *fixed) {
  const mpsi_node_block *nodes = &grid->nodes[g];
  mpsi_node *node = grid->node + mpsi_first_node(grid, g);
  const mpsi_node *side =
      nodes->side < 0 ? NULL : (const mpsi_node *)(grid->side + mpsi_first_node(grid, nodes->side));
  const double local = def->local_damping;
  const double keeps = 1.0 / (1.0 + def->viscous_damping * dt);
  for (int k = 0; k < grid->block_nodes; k++) {
    if (!(node[k][MPSI_MASS] > 0.0)) continue;
    for (int c = 0; c < grid->dim; c++) {
      double *v = &node[k][MPSI_VECTOR + c];
      if (fixed[k] >> c & 1) continue;
      if (local > 0.0) { /* at most until the velocity is 0 */
        const double change = local * fabs(*v - side[k][MPSI_VECTOR + c]);
        *v = *v > 0.0 ? fmax(*v - change, 0.0) : fmin(*v + change, 0.0);
      }
      *v *= keeps;
    }
  }
}

/* ---- unbalanced force ------------------------------------------------------------------------ */

/* Sum of the magnitudes of gravity and loads on the particles of a block, N. */
static double applied_to_particles(const mpsi_grid *grid, const mpsi_columns *p,
                                   const mps_mpm_def *def, const mpsi_cell_block *cells) {
  double sum = 0.0;
  for (int64_t k = cells->begin; k < cells->end; k++) {
    double square = 0.0;
    for (int c = 0; c < grid->dim; c++) {
      const double f = p->m[k] * def->gravity[c] + (p->f[c] ? p->f[c][k] : 0.0);
      square += f * f;
    }
    sum += sqrt(square);
  }
  return sum;
}

mps_status mpsi_mpm_begin_balance(mps_context *context, const mpsi_grid *grid,
                                  const mpsi_columns *p, mpsi_settling *s, const mps_mpm_def *def,
                                  const char *function) {
  if (!s->on) return MPS_OK;
  if (!MPSI_ENSURE(context, s, nodes, mpsi_all_nodes(grid)))
    return mpsi_fail_memory(context, function, (size_t)mpsi_all_nodes(grid) * sizeof *s->nodes);
  memset(&s->applied, 0, sizeof s->applied);
  for (int64_t b = 0; b < grid->cell_count; b++)
    if (!grid->cells[b].ghost)
      mpsi_exact_add(&s->applied, applied_to_particles(grid, p, def, &grid->cells[b]));
  return MPS_OK;
}

static double magnitude_of(const double *v) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Sum of the magnitudes of penalty contact forces on node k, N. */
static double contact_force(const mpsi_grid *grid, const mpsi_contacts *contacts,
                            const mpsi_node_block *nodes, int k) {
  double sum = 0.0;
  const int32_t pairs = contacts->penalty_bodies > 0 ? nodes->pairs : 0;
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + pairs; t++) {
    const mpsi_node_pair *pair = &contacts->node_pair[t];
    const mpsi_contact_node *at = &contacts->node[(int64_t)t * grid->block_nodes + k];
    sum += magnitude_of(at->force);
    if (contacts->handle[pair->body]->def.friction > 0.0 && pair->mass != 0.0)
      sum += fabs(at->mass) * magnitude_of(at->slip);
  }
  return sum;
}

void mpsi_mpm_measure_balance(const mpsi_grid *grid, const mpsi_contacts *contacts,
                              const mpsi_settling *settling, double dt, int64_t g,
                              const uint8_t *fixed, const mpsi_node *held) {
  const mpsi_node_block *nodes = &grid->nodes[g];
  const mpsi_node *node = (const mpsi_node *)(grid->node + mpsi_first_node(grid, g));
  const mpsi_node *side = (const mpsi_node *)(grid->side + mpsi_first_node(grid, nodes->side));
  mpsi_node_balance sum = {0};
  for (int k = 0; k < grid->block_nodes; k++) {
    const double m = node[k][MPSI_MASS];
    double free[3] = {0.0}, by_boundary[3] = {0.0};
    if (!(m > 0.0)) continue;
    for (int c = 0; c < grid->dim; c++) {
      const double v = node[k][MPSI_VECTOR + c];
      by_boundary[c] = v - held[k][MPSI_VECTOR + c];
      if (!(fixed[k] >> c & 1)) free[c] = v - side[k][MPSI_VECTOR + c];
      sum.kinetic += 0.5 * m * v * v;
    }
    sum.unbalanced += m * magnitude_of(free) / dt;
    sum.applied += m * magnitude_of(by_boundary) / dt + contact_force(grid, contacts, nodes, k);
  }
  settling->nodes[g] = sum;
}
