/* state_equation.h - the volume of a fluid by its pressure. SPDX-License-Identifier: BSD-3-Clause
 */
#pragma once

#include <mps/material.h>

/* V/V0 of a Newtonian fluid at the pressure p (Pa; Tait: above -K/7, linear: above -K), with
 * tension or without. */
double mpsi_material_fluid_volume(const mps_material *material, double p);
