/* window.h - volumes, pair stiffnesses, and the part of the body that a rank has.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* Volumes and pair stiffnesses from cuts and material. */
void mpsi_elastic_measure(mps_elastic *e);
/* The window of the rank where all ranks of the domain solve together with the present solver, else
 * the whole body. */
mps_status mpsi_elastic_choose_window(mps_elastic *e, const char *function);
