// main.cpp - a C++ program on mps/mps.hpp: a block of sand falls freely, its values against theory;
// handles that move and end, errors as exceptions, an exception out of a callback, stale arrays.
// SPDX-License-Identifier: BSD-3-Clause
#include "block.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <vector>

static mps::particles ground(const mps::context &context) {
  mps::particles sand = block(context);
  mps::call(sand, mps_particles_set, "density", 0, 1800.0);
  return sand;
}

static mps::mpm falling(const mps::context &context, const mps::particles &sand) {
  const mps::material law = mps::create(context, mps_material_create_linear_elastic, 1e6, 0.3);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.2;
  def.gravity[1] = -9.81;
  def.dt = 1e-3;
  return mps::create(context, mps_mpm_create, sand, law, def); // keeps law and set alive
}

static void free_fall(const mps::context &context) {
  const mps::particles sand = ground(context);
  const mps::mpm solver = falling(context, sand);
  EXPECT(mps_mpm_particles(solver) == sand.get());
  int calls = 0;
  mps::run(solver, mps_mpm_run, 0.1, 10, [&](mps_mpm *s) {
    EXPECT(std::fabs(mps_mpm_time(s) - 0.01 * calls) < 1e-12);
    calls++;
  });
  EXPECT(calls == 11);
  const mps::array<double> v = mps::view(sand, "velocity");
  EXPECT(v.size() == 100 && v.components() == 2 && !v.stale());
  for (int64_t i = 0; i < v.size(); i++) EXPECT(std::fabs(v(i, 1) + 0.981) < 1e-12);
  const mps_mpm_def used = mps::get<mps_mpm_def>(solver, mps_mpm_get_def);
  EXPECT(used.cell == 0.2);

  // Back in time, and the same again.
  const mps::snapshot before = [&] {
    mps_snapshot *made = nullptr;
    mps::call(solver, mps_mpm_snapshot, &made);
    return mps::snapshot(made, context);
  }();
  mps::call(solver, mps_mpm_step, 5);
  mps::call(solver, mps_mpm_rollback, before);
  EXPECT(std::fabs(mps_mpm_time(solver) - 0.1) < 1e-12);
}

static void writing(const mps::context &context) {
  const mps::particles sand = ground(context);
  const mps::array<int64_t> ids = mps::view<int64_t>(sand, "id");
  {
    mps::call(sand, mps_particles_add_field, "velocity", 0);
    mps::edit v(sand, "velocity");
    for (int64_t i = 0; i < v.size(); i++) v(i, 0) = double(ids(i));
    v(7, 1) = std::nan("");
    try {
      v.commit();
      EXPECT(!"a NaN was taken");
    } catch (const mps::error &e) {
      EXPECT(e.status() == MPS_ERROR_ARGUMENT);
      EXPECT(std::strstr(e.what(), "mps_particles_commit: ") == e.what());
      EXPECT(std::strstr(e.what(), "nan") != nullptr);
    }
    v(7, 1) = 0.0;
    v.commit();
    EXPECT(v.data()[5] == double(ids(5))); // to be read still
    try {
      v(7, 1) = 1.0;
      EXPECT(!"written after the commit");
    } catch (const mps::error &e) {
      EXPECT(e.status() == MPS_ERROR_STATE);
      EXPECT(std::strstr(e.what(), "'velocity' has been committed") != nullptr);
    }
  }
  EXPECT(mps::view(sand, "velocity")(99, 0) == double(ids(99)));
  const int64_t gone[1] = {ids(3)};
  EXPECT(!ids.stale());
  mps::call(sand, mps_particles_remove, gone, 1);
  EXPECT(ids.stale());
  try {
    mps::view(sand, "id");
    EXPECT(!"integers were given as numbers");
  } catch (const mps::error &e) {
    EXPECT(e.status() == MPS_ERROR_FIELD);
  }
}

static void ranges(const mps::context &context) {
  const mps::particles sand = ground(context);
  mps::call(sand, mps_particles_add_field, "velocity", 0);
  {
    mps::edit v(sand, "velocity");
    double next = 0.0;
    for (double &speed : v.column(1)) speed = next++;
    auto x = v.column(0);
    std::fill(x.begin(), x.end(), 3.0);
    x[5] = 4.0;
    v.commit();
  }
  const mps::array<double> v = mps::view(sand, "velocity");
  const auto x = v.column(0), y = v.column(1);
  EXPECT(y.size() == 100 && y.end() - y.begin() == 100);
  EXPECT(std::accumulate(y.begin(), y.end(), 0.0) == 4950.0);
  EXPECT(std::max_element(x.begin(), x.end()) - x.begin() == 5);
  EXPECT(*std::lower_bound(y.begin(), y.end(), 41.5) == 42.0);
  EXPECT(y.begin()[7] == v(7, 1) && *(y.begin() + 7) == 7.0 && *--y.end() == 99.0);
  for (const int64_t id : mps::view<int64_t>(sand, "id").column()) EXPECT(id >= 0 && id < 100);
}

static void values(const mps::context &context) {
  const mps::particles sand = ground(context);
  std::vector<double> dose(200);
  for (size_t k = 0; k < dose.size(); k++) dose[k] = double(k);
  mps::call(sand, mps_particles_add_field, "user.dose", 2);
  mps::set_array(sand, "user.dose", dose);
  mps::particles twin = mps::copy(sand);
  mps::set_array(sand, "user.dose", std::vector<double>(100, -1.0), 0);
  EXPECT(mps::view(sand, "user.dose")(99, 0) == -1.0 &&
         mps::view(sand, "user.dose")(99, 1) == 199.0);
  EXPECT(mps::view(twin, "user.dose")(99, 0) == 198.0);
  mps::call(sand, mps_particles_remove_field, "user.dose");
  EXPECT(!mps_particles_has_field(sand, "user.dose") && mps_particles_has_field(twin, "user.dose"));
  try {
    mps::set_array(twin, "user.dose", std::vector<double>(100));
    EXPECT(!"too few values were taken");
  } catch (const mps::error &e) {
    EXPECT(std::strstr(e.what(), "are 100, must be 200") != nullptr);
  }
}

static void errors(const mps::context &context) {
  const mps::particles sand = ground(context);
  mps::mpm solver = falling(context, sand);
  try {
    (void)falling(context, sand);
    EXPECT(!"two solvers for a set");
  } catch (const mps::error &e) {
    EXPECT(e.status() == MPS_ERROR_STATE && std::strlen(e.record().function) > 0);
  }
  try {
    mps::run(solver, mps_mpm_run, 1.0, 1, [](mps_mpm *s) {
      if (mps_mpm_steps(s) == 3) throw std::runtime_error("enough");
    });
    EXPECT(!"the exception was lost");
  } catch (const std::runtime_error &e) {
    EXPECT(std::strcmp(e.what(), "enough") == 0);
  }
  EXPECT(mps_mpm_steps(solver) == 3);
  mps::mpm moved = std::move(solver);
  EXPECT(!solver && moved);
  moved.reset();
  EXPECT(!moved);
  moved = falling(context, sand); // the set is free again
  EXPECT(mps_mpm_steps(moved) == 0);
  try { // an empty handle is named
    mps::call(mps::mpm(), mps_mpm_step, 1);
    EXPECT(!"a step of nothing");
  } catch (const mps::error &e) {
    EXPECT(std::strcmp(e.what(), "mps_solver_step: solver is NULL") == 0);
  }
  mps_context_def def = mps_context_defaults();
  def.threads = -1;
  try {
    (void)mps::create_context(def);
    EXPECT(!"-1 threads");
  } catch (const mps::error &e) {
    EXPECT(std::strstr(e.what(), "threads is -1") != nullptr);
  }
}

// Laws, signals and hooks that throw, on one thread and on two: the exception comes out, the solver
// is as it was and goes on.
static void callbacks(const mps::context &context) {
  const mps::particles sand = ground(context);
  bool bad = true;
  const mps::callback<mps_material_fn> update(context, [&](const mps_material_block *block) {
    if (bad) throw std::out_of_range("a law");
    for (int64_t i = 0; i < block->count; i++) block->stress[0][i] = 0.0;
  });
  mps_material_user_def law = mps_material_user_defaults();
  law.update = update.function();
  law.user = update.user();
  law.wave_modulus = 1e6;
  const mps::material material = mps::create(context, mps_material_create_user, law);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.2;
  def.dt = 1e-4;
  const mps::mpm solver = mps::create(context, mps_mpm_create, sand, material, def);
  for (int repeat = 0; repeat < 2; repeat++) try {
      mps::call(solver, mps_mpm_step, 1);
      EXPECT(!"the exception was lost");
    } catch (const std::out_of_range &e) {
      EXPECT(std::strcmp(e.what(), "a law") == 0);
    }
  EXPECT(mps_mpm_steps(solver) == 0);
  bad = false;
  mps::call(solver, mps_mpm_step, 3);
  EXPECT(mps_mpm_steps(solver) == 3);

  const mps::callback<mps_signal_fn> motion(context, [](double t, double *out) {
    if (t > 0.5) throw std::runtime_error("a signal");
    out[0] = out[1] = out[2] = 0.0;
  });
  const mps::signal signal =
      mps::create(context, mps_signal_create_user, MPS_SIGNAL_QUANTITY_DISPLACEMENT,
                  motion.function(), motion.user(), nullptr);
  try {
    mps_signal *list[1] = {signal.get()};
    EXPECT(mps_signal_displacement(list[0], 0.25) == 0.0);
    (void)mps_signal_displacement(list[0], 1.0);
    mps::call(sand, mps_particles_set, "density", 0, 1900.0);
    EXPECT(!"the exception was lost");
  } catch (const std::runtime_error &e) {
    EXPECT(std::strcmp(e.what(), "a signal") == 0);
  }

  const mps::callback<mps_context_cancel_fn> cancel(context, []() -> int32_t { throw 7; });
  mps_context_set_cancel(context, cancel.function(), cancel.user(), nullptr);
  try {
    mps::call(solver, mps_mpm_step, 10);
    EXPECT(!"the exception was lost");
  } catch (int number) {
    EXPECT(number == 7);
  }
  mps_context_set_cancel(context, nullptr, nullptr, nullptr);
  mps::call(solver, mps_mpm_step, 1);
}

// A law that the solver alone keeps: neither its lambda nor the handle of the material is there
// when the solver runs, and the lambda ends with it.
struct witness {
  explicit witness(int *n) : ended(n) {}
  witness(const witness &) = delete;
  ~witness() { ++*ended; }
  int *ended;
};

static mps::mpm with_bound_law(const mps::context &context, const mps::particles &sand, int *ended,
                               double pressure) {
  const auto shared = std::make_shared<witness>(ended);
  mps::bound law(context, mps_material_user_defaults());
  law.bind(&mps_material_user_def::update, [shared, pressure](const mps_material_block *block) {
    for (int64_t i = 0; i < block->count; i++)
      for (int c = 0; c < 3; c++) block->stress[c][i] = -pressure;
  });
  try { // what fails leaves the function to the definition
    law.wave_modulus = -1.0;
    (void)mps::create(context, mps_material_create_user, law);
    EXPECT(!"a negative modulus");
  } catch (const mps::error &e) {
    EXPECT(e.status() == MPS_ERROR_ARGUMENT && *ended == 0);
  }
  law.wave_modulus = 1e6;
  const mps::material material = mps::create(context, mps_material_create_user, law);
  try { // and what succeeds takes it
    (void)mps::create(context, mps_material_create_user, law);
    EXPECT(!"one function for two laws");
  } catch (const mps::error &e) {
    EXPECT(e.status() == MPS_ERROR_STATE);
  }
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.2;
  def.dt = 1e-4;
  return mps::create(context, mps_mpm_create, sand, material, def);
}

static void kept_callbacks() {
  int ended = 0;
  {
    const mps::context context = mps::create_context();
    const mps::particles sand = ground(context);
    mps::mpm solver = with_bound_law(context, sand, &ended, 125.0);
    mps::call(solver, mps_mpm_step, 2);
    for (double s : mps::view(sand, "stress").column(0)) EXPECT(s == -125.0);
    mps::signal signal =
        mps::create_signal(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, [](double t, double *out) {
          out[0] = 3.0 * t * t; // displacement, velocity, acceleration
          out[1] = 6.0 * t;
          out[2] = 6.0;
        });
    EXPECT(std::fabs(mps_signal_displacement(signal, 0.5) - 0.75) < 1e-15);
    EXPECT(ended == 0);
    solver.reset(); // the last that has the law
    EXPECT(ended == 1);
    int signals = 0, hooks = 0;
    (void)mps::create_signal(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT,
                             [w = std::make_shared<witness>(&signals)](double, double *) {});
    EXPECT(signals == 1);
    mps::set_hook(context, mps_context_set_log,
                  [w = std::make_shared<witness>(&hooks)](int32_t, const char *) {});
    mps::set_hook(context, mps_context_set_log, [](int32_t, const char *) {});
    EXPECT(hooks == 1);
  }
  EXPECT(ended == 1);
}

// What a hook of no answer throws ends the run within a step.
static void progress() {
  const mps::context context = mps::create_context();
  int calls = 0;
  mps::set_hook(context, mps_context_set_progress, [&](const mps_context_progress *) {
    if (++calls == 3) throw std::runtime_error("progress");
  });
  const mps::particles sand = ground(context);
  const mps::mpm solver = falling(context, sand);
  for (int with = 0; with < 2; with++) {
    if (with) mps::set_hook(context, mps_context_set_cancel, []() -> int32_t { return 0; });
    calls = 0;
    const double t = mps_mpm_time(solver);
    try {
      mps::call(solver, mps_mpm_run, t + 1000.0, 1000000000, nullptr, nullptr);
      EXPECT(!"the exception was lost");
    } catch (const std::runtime_error &e) {
      EXPECT(std::strcmp(e.what(), "progress") == 0);
    }
    EXPECT(mps_mpm_time(solver) < t + 500.0);
  }
}

// What a hook threw in a call of C's own ends with its context: not one that gets the same address
// later.
static void forgotten() {
  const mps_context *address = nullptr;
  bool same = false;
  for (int n = 0; n < 64 && !same; n++) {
    const mps::context context = mps::create_context();
    same = context.get() == address;
    address = context.get();
    (void)ground(context); // throws what is left of the former
    const mps::signal s =
        mps::create_signal(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, [](double, double *) {
          throw std::runtime_error("of a former context");
        });
    (void)mps_signal_displacement(s, 1.0);
  }
  if (!same) std::printf("no context had the address of another\n");
}

int main() {
  try {
    const mps::context context = mps::create_context();
    free_fall(context);
    writing(context);
    ranges(context);
    values(context);
    errors(context);
    callbacks(context);
    mps_context_def two = mps_context_defaults();
    two.threads = 2;
    callbacks(mps::create_context(two));
    kept_callbacks();
    progress();
    forgotten();
  } catch (const std::exception &e) {
    std::printf("unexpected: %s\n", e.what());
    return 1;
  }
  if (failures == 0) std::printf("ok, libmps %s\n", mps_version());
  return failures > 0;
}
