// client.cpp - a C++20 program on mps.hpp: what it computes, as lines "client quantity: numbers".
// SPDX-License-Identifier: BSD-3-Clause
#include <mps/mps.hpp>

#include <cstdio>

int main() try {
  mps::context context = mps::create_context();
  mps_particles_def def = mps_particles_defaults();
  def.spacing = 0.1;
  auto set = mps::create(context, mps_particles_create, def);
  const double lower[2] = {0.0, 0.0}, upper[2] = {1.0, 0.5};
  mps::call(set, mps_particles_fill_box, lower, upper, nullptr);
  mps::call(set, mps_particles_set, "density", 0, 2000.0);
  auto law = mps::create(context, mps_material_create_linear_elastic, 1e6, 0.3);
  mps_mpm_def solver_def = mps_mpm_defaults();
  solver_def.cell = 0.2;
  solver_def.lower[1] = 0.0;
  solver_def.gravity[1] = -9.81;
  auto solver = mps::create(context, mps_mpm_create, set, law, solver_def);
  int calls = 0;
  mps::run(solver, mps_mpm_run, 0.02, 1000, [&](mps_mpm *) { calls++; });
  const mps_totals totals = mps::get<mps_totals>(solver, mps_mpm_get_totals);
  std::printf("client calls and mass: %d %.12g\n", calls, totals.mass);
  std::printf("client energies: %.12g %.12g %.12g\nclient height:", totals.kinetic, totals.strain, totals.work_loads);
  double mean = 0.0;
  for (double y : mps::view(set, "position").column(1)) mean += y / 50.0;
  std::printf(" %.12g\n", mean);
  try {
    mps::call(set, mps_particles_set, "density", 0, -1.0);
  } catch (const mps::error &error) {
    std::printf("client refusal: %d\n", static_cast<int>(error.status()));
  }
} catch (const std::exception &error) {
  std::printf("client: %s\n", error.what());
  return 1;
}
