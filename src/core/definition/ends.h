/* ends.h - ends of the ranges of physical quantities, as the tables of definitions take them.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#define MPSI_FARTHEST 1e15 /* coordinates, either sign */
#define MPSI_SPACINGS 1e-12, 1e12
#define MPSI_LENGTHS 1e-9, 1e9
#define MPSI_MODULI 1e-6, 1e18
#define MPSI_STRESSES 1e-9, 1e18
#define MPSI_POISSONS -0.999, 0.49999
#define MPSI_DENSITIES 1e-9, 1e9
#define MPSI_WAVE_VELOCITIES 1e-6, 1e9
#define MPSI_VISCOSITIES 1e-12, 1e18
#define MPSI_ACCELERATIONS 1e-9, 1e9
#define MPSI_STRESS_RATIOS 1e-9, 1e6
#define MPSI_HEIGHTS -1e9, 1e9
#define MPSI_PLACES -MPSI_FARTHEST, MPSI_FARTHEST
/* of bodies: m, m/s, rad, rad/s, m/s2; kg, kg m2, N/m, 1/s */
#define MPSI_BODY_FAR 1e9
#define MPSI_BODY_LIGHT 1e-30
#define MPSI_BODY_HEAVY 1e30
