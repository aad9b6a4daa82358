/* kernel_table.c - the table of the solver's inner loops. Compiled once for each instruction set.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/loops.h"

extern const mpsi_transfer_fn MPSI_LEVELLED(mpsi_mpm_p2g)[3][2], MPSI_LEVELLED(mpsi_mpm_tile)[3][2],
    MPSI_LEVELLED(mpsi_mpm_g2p)[3][2];

extern const mpsi_kernels MPSI_LEVELLED(mpsi_mpm_kernels);
const mpsi_kernels MPSI_LEVELLED(mpsi_mpm_kernels) = {
    .p2g = MPSI_LEVELLED(mpsi_mpm_p2g),
    .tile = MPSI_LEVELLED(mpsi_mpm_tile),
    .flush = MPSI_LEVELLED(mpsi_mpm_flush),
    .g2p = MPSI_LEVELLED(mpsi_mpm_g2p),
    .speed = MPSI_LEVELLED(mpsi_mpm_speed),
    .pore_sum = MPSI_LEVELLED(mpsi_pore_sum),
    .pore_give = MPSI_LEVELLED(mpsi_pore_give),
    .pore_begin_block = MPSI_LEVELLED(mpsi_pore_begin_block),
    .pore_respond = MPSI_LEVELLED(mpsi_pore_respond),
    .pore_strain = MPSI_LEVELLED(mpsi_pore_strain),
    .pore_advance = MPSI_LEVELLED(mpsi_pore_advance),
    .pore_slopes = MPSI_LEVELLED(mpsi_pore_slopes),
    .fit = MPSI_LEVELLED(mpsi_mpm_fit),
    .foot = MPSI_LEVELLED(mpsi_mpm_foot),
    .fastest = MPSI_LEVELLED(mpsi_mpm_fastest),
    .next_near = MPSI_LEVELLED(mpsi_mpm_next_near),
    .next_in = MPSI_LEVELLED(mpsi_mpm_next_in),
    .warm = MPSI_LEVELLED(mpsi_mpm_warm),
    .release = MPSI_LEVELLED(mpsi_mpm_release),
    .sweep = MPSI_LEVELLED(mpsi_mpm_sweep),
    .foot_velocity = MPSI_LEVELLED(mpsi_mpm_foot_velocity),
};
