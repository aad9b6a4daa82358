/* mps/mps.h - all of libmps but mps/experimental.h.
 *
 *   base.h        status codes, version, views of arrays
 *   context.h     errors, memory, threads, hooks
 *   particles.h   sets of particles and their fields
 *   neighbours.h  pairs of particles that are near one another
 *   kernel.h      weight functions
 *   signal.h      functions of time, recorded motions
 *   material.h    constitutive laws
 *   geostatic.h   stress of ground at rest
 *   body.h        rigid bodies
 *   solver.h      what the solvers have in common
 *   mpm.h         WLS-MPM: large deformation and contact
 *   dynamics.h    explicit elastodynamics
 *   elastic.h     implicit elasticity
 *   io.h          series of results, restart files
 *
 * Another library of this name, MPSolve (Debian's libmps), has a header mps/mps.h too. One program
 * may use both, one source file not: put the directory of the one that it includes first.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_MPS_H
#define LIBMPS_MPS_H

#include <mps/base.h>
#include <mps/body.h>
#include <mps/context.h>
#include <mps/dynamics.h>
#include <mps/elastic.h>
#include <mps/geostatic.h>
#include <mps/io.h>
#include <mps/kernel.h>
#include <mps/material.h>
#include <mps/mpm.h>
#include <mps/neighbours.h>
#include <mps/particles.h>
#include <mps/signal.h>
#include <mps/solver.h>

#endif
