/* retain.h - reference counts of the immutable objects that solvers share with the caller. The
 * public destroy function releases. Thread safe.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_RETAIN_H
#define MPSI_RETAIN_H

#include <mps/kernel.h>
#include <mps/signal.h>

mps_kernel *mpsi_kernel_retain(mps_kernel *kernel);
mps_signal *mpsi_signal_retain(mps_signal *signal);

#endif
