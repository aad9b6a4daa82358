/* kernels.c - chooses the solver's inner loops for the processor at run time.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#include "core/context/levels.h"

#define DECLARE(level)                                                                             \
  extern const mpsi_mpm_task mpsi_mpm_p2g_v##level[3][2], mpsi_mpm_tile_v##level[3][2],            \
      mpsi_mpm_g2p_v##level[3][2];                                                                 \
  void mpsi_mpm_flush_v##level(mps_mpm *mpm, int64_t b, int32_t worker);                           \
  void mpsi_mpm_speed_v##level(mps_mpm *mpm, int64_t b, int32_t worker);                           \
  void mpsi_mpm_fit_v##level(const mps_mpm *mpm, const mpsi_cell_block *cells,                     \
                             const mpsi_worker *worker, int64_t particle, mpsi_stencil *stencil,   \
                             mpsi_shape_values *out);                                              \
  void mpsi_mpm_foot_v##level(const mps_mpm *mpm, const mpsi_cell_block *cells,                    \
                              const mpsi_worker *worker, int64_t particle, const double *d,        \
                              mpsi_foot_weights *out);                                             \
  double mpsi_mpm_fastest_v##level(const mps_mpm *mpm, int64_t begin, int64_t end);                \
  int64_t mpsi_mpm_next_near_v##level(const mps_mpm *mpm, const mpsi_far *far, int64_t begin,      \
                                      int64_t end);                                                \
  int64_t mpsi_mpm_next_in_v##level(const mps_mpm *mpm, const mpsi_cell_block *cells,              \
                                    const int *low, const int *high, int64_t begin);               \
  void mpsi_mpm_warm_v##level(mps_mpm *mpm, const mpsi_constraint_block *block);                   \
  void mpsi_mpm_sweep_v##level(mps_mpm *mpm, mpsi_constraint_block *block, bool back);             \
  void mpsi_mpm_foot_velocity_v##level(const mps_mpm *mpm, int64_t constraint, double *v);
#define KERNELS(level)                                                                             \
  {                                                                                                \
    mpsi_mpm_p2g_v##level, mpsi_mpm_tile_v##level, mpsi_mpm_flush_v##level, mpsi_mpm_g2p_v##level, \
        mpsi_mpm_speed_v##level, mpsi_mpm_fit_v##level, mpsi_mpm_foot_v##level,                    \
        mpsi_mpm_fastest_v##level, mpsi_mpm_next_near_v##level, mpsi_mpm_next_in_v##level,         \
        mpsi_mpm_warm_v##level, mpsi_mpm_sweep_v##level, mpsi_mpm_foot_velocity_v##level           \
  }

DECLARE(1)
static const mpsi_kernels plain = KERNELS(1);
#ifdef MPSI_X86_LEVELS
DECLARE(3)
DECLARE(4)
static const mpsi_kernels avx2 = KERNELS(3), avx512 = KERNELS(4);
#endif

const mpsi_kernels *mpsi_mpm_kernels(int32_t isa) {
#ifdef MPSI_X86_LEVELS
  const int32_t level = mpsi_level(isa);
  if (level == 4) return &avx512;
  if (level == 3) return &avx2;
#else
  (void)isa;
#endif
  return &plain;
}
