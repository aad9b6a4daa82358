// block.hpp - a block of particles for the C++ programs here, and a check that counts its failures.
// SPDX-License-Identifier: BSD-3-Clause
#include <mps/mps.hpp>

#include <cstdio>

static int failures = 0;
#define EXPECT(condition)                                                                          \
  do {                                                                                             \
    if (!(condition)) {                                                                            \
      std::printf("line %d: not so: %s\n", __LINE__, #condition);                                  \
      failures++;                                                                                  \
    }                                                                                              \
  } while (0)

// 10 x 10 squares of 0.1 m, from x = 0 and y = 5.
static mps::particles block(const mps::context &context) {
  mps_particles_def def = mps_particles_defaults();
  def.spacing = 0.1;
  mps::particles sand = mps::create(context, mps_particles_create, def);
  const double lo[2] = {0.0, 5.0}, hi[2] = {1.0, 6.0};
  mps::call(sand, mps_particles_fill_box, lo, hi, nullptr);
  return sand; // moves
}
