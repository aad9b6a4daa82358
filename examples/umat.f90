! umat.f90 - an Abaqus UMAT as its author would write it: von Mises plasticity with linear isotropic
! hardening, backward Euler (radial return). It knows nothing of libmps; umat.c is the program.
! PROPS: Young's modulus, Poisson's ratio, yield stress, hardening modulus. STATEV: plastic strain.
! SPDX-License-Identifier: BSD-3-Clause
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, &
                time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, &
                nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, &
                kstep, kinc)
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep, kinc
  real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl
  real(dp) :: ddsddt(ntens), drplde(ntens), drpldt, stran(ntens), dstran(ntens), time(2), dtime
  real(dp) :: temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), drot(3, 3), pnewdt
  real(dp) :: celent, dfgrd0(3, 3), dfgrd1(3, 3)
  real(dp) :: shear, bulk, yield, mises, mean, rise, deviator(ntens)

  shear = props(1) / (2.0_dp * (1.0_dp + props(2)))
  bulk = props(1) / (3.0_dp * (1.0_dp - 2.0_dp * props(2)))
  ! elastic trial; shear strains are engineering ones
  mean = sum(stress(1:ndi)) / 3.0_dp
  deviator = stress
  deviator(1:ndi) = deviator(1:ndi) - mean
  deviator(1:ndi) = deviator(1:ndi) + 2.0_dp * shear * (dstran(1:ndi) - sum(dstran(1:ndi)) / 3.0_dp)
  deviator(ndi + 1:ntens) = deviator(ndi + 1:ntens) + shear * dstran(ndi + 1:ntens)
  mean = mean + bulk * sum(dstran(1:ndi))
  mises = sqrt(1.5_dp * (sum(deviator(1:ndi)**2) + 2.0_dp * sum(deviator(ndi + 1:ntens)**2)))
  ! radial return
  yield = props(3) + props(4) * statev(1)
  if (mises > yield) then
    rise = (mises - yield) / (3.0_dp * shear + props(4))
    deviator = deviator * (1.0_dp - 3.0_dp * shear * rise / mises)
    statev(1) = statev(1) + rise
  end if
  stress = deviator
  stress(1:ndi) = stress(1:ndi) + mean
end subroutine umat
