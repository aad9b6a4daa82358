/* mps/mps.h - all of libmps but mps/experimental.h and mps/petsc.h (a library of its own).
 *
 *   base.h        status codes, version, views of arrays
 *   context.h     errors, memory, threads, hooks
 *   particles.h   sets of particles and their fields
 *   domain.h      several ranks that compute one model
 *   neighbours.h  pairs of particles that are near one another
 *   kernel.h      weight functions
 *   signal.h      functions of time, recorded motions
 *   material.h    constitutive laws;  material_law.h  laws of your own, laws at one point
 *   geostatic.h   stress of ground at rest
 *   soil.h        Cam-Clay, its state at rest, laws along paths of stress and strain
 *   body.h        rigid bodies
 *   contact.h     contact of particles with bodies
 *   solver.h      what the solvers have in common
 *   mpm.h         WLS-MPM: large deformation and contact;  mpm_boundary.h  boundaries, loads
 *   grid.h        its grid: nodes, fields at points
 *   mpm_energy.h  where the energy of a run of WLS-MPM goes
 *   mpm_settle.h  static equilibrium of WLS-MPM
 *   pore_water.h  water in the pores of its ground;  pore_solver.h  the solution for its pressures
 *   dynamics.h    explicit elastodynamics;  dynamics_limit.h  its stable step
 *   elastic.h     implicit elasticity;  elastic_motion.h  its motions, vibration;
 *                 elastic_solver.h  another solver of its equations
 *   fluid.h       free-surface flow;  fluid_boundary.h, fluid_contact.h, fluid_load.h  its walls,
 *                 bodies and loads;  fluid_rock.h  rock in it;
 *                 fluid_solver.h  another solver of its pressure equation
 *   couple.h      implicit coupling of two codes
 *   waves.h       seas, wave makers, absorption, reflection;  wave_loads.h  loads on walls
 *   io.h          series of results, restart files
 *
 * Another library of this name, MPSolve (Debian's libmps), has a header mps/mps.h too. A source may
 * use both: the compiler searches MPSolve's directory first, and the headers listed here are
 * included. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_MPS_H
#define LIBMPS_MPS_H

#include "base.h"
#include "body.h"
#include "contact.h"
#include "context.h"
#include "couple.h"
#include "domain.h"
#include "dynamics.h"
#include "dynamics_limit.h"
#include "elastic.h"
#include "elastic_motion.h"
#include "elastic_solver.h"
#include "fluid.h"
#include "fluid_boundary.h"
#include "fluid_contact.h"
#include "fluid_load.h"
#include "fluid_rock.h"
#include "fluid_solver.h"
#include "geostatic.h"
#include "grid.h"
#include "io.h"
#include "kernel.h"
#include "material.h"
#include "material_law.h"
#include "mpm.h"
#include "mpm_boundary.h"
#include "mpm_energy.h"
#include "mpm_settle.h"
#include "neighbours.h"
#include "particles.h"
#include "pore_solver.h"
#include "pore_water.h"
#include "signal.h"
#include "soil.h"
#include "solver.h"
#include "wave_loads.h"
#include "waves.h"

#endif
