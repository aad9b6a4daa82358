/* mps/mps.h - the stable interface of libmps.
 *
 *   base.h        status codes, version, views of arrays
 *   context.h     errors, memory, threads, hooks
 *   particles.h   sets of particles and their fields
 *   kernel.h      weight functions
 *   signal.h      functions of time, recorded motions
 *   material.h    constitutive laws;  material_law.h  laws of your own
 *   soil.h        stress of ground at rest, Cam-Clay
 *   body.h        rigid bodies
 *   contact.h     contact of particles with bodies
 *   solver.h      what the solvers have in common
 *   history.h     columns of numbers against time, which go along with restarts
 *   mpm.h         WLS-MPM: large deformation and contact
 *   grid.h        its grid: nodes, and fields at any points
 *   dynamics.h    explicit elastodynamics
 *   elastic.h     implicit elasticity: statics, motions, vibration
 *   fluid.h       free-surface flow
 *   io.h          series of results, restart files
 *
 * A program makes a context, a set of particles and its fields, materials and signals, a solver
 * with its boundaries, loads and bodies, and steps it: docs/tutorial has whole programs.
 *
 * Headers under mps/experimental/ may change in any minor release. A source that includes one
 * defines MPS_EXPERIMENTAL before:
 *
 *   domain.h      several ranks that compute one model
 *   petsc.h       the ranks of MPI and PETSc (a library of its own)
 *   pore_water.h  water in the pores of the ground of WLS-MPM
 *   settle.h      static equilibrium of WLS-MPM
 *   mpm_energy.h  where the energy of a run goes
 *   soil.h        small-strain stiffness, cyclic sand, consolidated clay, properties by depth
 *   material_point.h   laws at one point
 *   waves.h       seas, wave makers, absorption, reflection
 *   wave_loads.h  loads on walls
 *   fluid_rock.h  rock in a fluid
 *   fluid_parts.h a step of a fluid in parts
 *   coupling.h    implicit coupling of two codes
 *   linear_solver.h   another solver of the linear equations
 *   neighbours.h  pairs of particles that are near one another
 *   dynamics_predict.h   a stable time step without a model
 *   papers.h      variants of the published methods
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
#include "dynamics.h"
#include "elastic.h"
#include "fluid.h"
#include "grid.h"
#include "history.h"
#include "io.h"
#include "kernel.h"
#include "material.h"
#include "material_law.h"
#include "mpm.h"
#include "particles.h"
#include "signal.h"
#include "soil.h"
#include "solver.h"

#endif
