/* xit.c - the subroutine XIT for an Abaqus UMAT in Fortran that libmps calls. In Abaqus XIT ends the analysis;
 * here it ends the UMAT's call: the step fails with MPS_ERROR_NUMERIC and a message that names the particle, and
 * the program goes on. Compile it with the UMAT, and give mps_material_umat_def.umat = umat_with_xit:
 *
 *   gfortran -O2 -frecursive -I DIR -c umat.f && cc -c DIR/xit.c $(pkg-config --cflags libmps)
 *
 * XIT leaves the UMAT by longjmp. That is safe where the UMAT and what it calls hold nothing that must be given
 * back: an ALLOCATABLE array of the call in which XIT stands is lost, and units stay open. Threads each have
 * their own place to return to.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/material_law.h>

#include <setjmp.h>
#include <stddef.h>

static _Thread_local jmp_buf *place; /* of the running UMAT of this thread; NULL: none */

extern MPS_MATERIAL_UMAT(umat_); /* the UMAT, as gfortran names it */
MPS_MATERIAL_UMAT(umat_with_xit);
void xit_(void);

void xit_(void) {
  if (place) longjmp(*place, 1);
}

MPS_MATERIAL_UMAT(umat_with_xit) {
  jmp_buf here;
  if (setjmp(here) == 0) {
    place = &here;
    umat_(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp,
          dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent,
          dfgrd0, dfgrd1, noel, npt, layer, kspt, kstep, kinc, cmname_length);
  } else {
    *pnewdt = 0.0; /* libmps takes it for XIT */
  }
  place = NULL;
}
