/* retain.h - reference counts of the immutable objects that solvers share with the caller. The
 * public destroy function releases. Thread safe.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/kernel.h>
#include <mps/signal.h>

mps_kernel *mpsi_kernel_retain(mps_kernel *kernel);
/* Interior particle number density n0 = sum over j != i of w(r0_ij) of the infinite square lattice
 * of spacing `spacing` (m): Yoshida (A9). */
double mpsi_kernel_density(const mps_kernel *kernel, double spacing);
mps_signal *mpsi_signal_retain(mps_signal *signal);
