// ranges.cpp - fields as ranges, in C++17 and in C++20: rows against positions in closed form,
// writing by rows, an empty set, standard algorithms, views. SPDX-License-Identifier: BSD-3-Clause
#include "block.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

static void reading(const mps::particles &sand) {
  const mps::array<double> x = mps::view(sand, "position");
  const auto rows = x.rows();
  EXPECT(rows.size() == 100 && rows.end() - rows.begin() == 100);
  double sum[2] = {0.0, 0.0};
  int64_t n = 0;
  for (const auto r : rows) {
    EXPECT(r.size() == 2 && r[0] == x(n, 0) && r[1] == x(n, 1));
    EXPECT(&r[0] == &x(n, 0)); // no copy
    for (int c = 0; c < 2; c++) sum[c] += r[c];
    n++;
  }
  EXPECT(n == 100 && std::fabs(sum[0] - 50.0) < 1e-11 && std::fabs(sum[1] - 550.0) < 1e-11);
  EXPECT(rows[17][1] == x(17, 1) && rows.begin()[17][0] == x(17, 0));
  EXPECT((*(rows.end() - 1))[1] == x(99, 1) && rows.begin() < rows.end());
  EXPECT(std::count_if(rows.begin(), rows.end(), [](const auto &r) { return r[0] < 0.5; }) == 50);
  const auto far = std::max_element(rows.begin(), rows.end(), [](const auto &a, const auto &b) {
    return std::hypot(a[0], a[1]) < std::hypot(b[0], b[1]);
  });
  EXPECT(std::fabs((*far)[0] - 0.95) < 1e-12 && std::fabs((*far)[1] - 5.95) < 1e-12);
  for (const auto id : mps::view<int64_t>(sand, "id").rows()) EXPECT(id.size() == 1 && id[0] >= 0);
}

// A rigid rotation by 2 rad/s about the origin.
static void writing(const mps::particles &sand) {
  {
    const mps::array<double> x = mps::view(sand, "position");
    mps::edit v(sand, "velocity");
    auto from = x.rows().begin();
    for (auto r : v.rows()) {
      r[0] = -2.0 * (*from)[1];
      r[1] = 2.0 * (*from)[0];
      ++from;
    }
    v.commit();
    try {
      (void)v.rows();
      EXPECT(!"rows to write into after the commit");
    } catch (const mps::error &e) {
      EXPECT(e.status() == MPS_ERROR_STATE);
    }
  }
  const mps::array<double> x = mps::view(sand, "position"), v = mps::view(sand, "velocity");
  const double work = std::inner_product(
      x.rows().begin(), x.rows().end(), v.rows().begin(), 0.0, std::plus<>(),
      [](const auto &a, const auto &b) { return std::fabs(a[0] * b[0] + a[1] * b[1]); });
  EXPECT(work == 0.0);
  const auto vy = v.column(1);
  EXPECT(std::fabs(std::accumulate(vy.begin(), vy.end(), 0.0) - 100.0) < 1e-11);
}

static void nothing(const mps::context &context) {
  mps_particles_def def = mps_particles_defaults();
  def.spacing = 0.1;
  const mps::particles none = mps::create(context, mps_particles_create, def);
  const auto x = mps::view(none, "position");
  for (const auto r : x.rows()) EXPECT(r.size() < 0);
  for (const double value : x.column(1)) EXPECT(!(value < 0.0) && !(value >= 0.0));
  EXPECT(x.rows().begin() == x.rows().end() && x.column().begin() == x.column().end());
}

#if defined(MPS_CPP_RANGES)
using column = mps::column_range<const double>;
using rows = mps::row_range<const double>;
static_assert(std::random_access_iterator<mps::strided<double>>);
static_assert(std::sortable<mps::strided<double>>);
static_assert(std::random_access_iterator<mps::row_iterator<double>>);
static_assert(std::ranges::random_access_range<column> && std::ranges::random_access_range<rows>);
static_assert(std::ranges::sized_range<column> && std::ranges::sized_range<rows>);
static_assert(std::ranges::borrowed_range<column> && std::ranges::borrowed_range<rows>);
static_assert(std::ranges::view<column> && std::ranges::view<rows>);

static void views(const mps::particles &sand) {
  const mps::array<double> x = mps::view(sand, "position");
  EXPECT(std::fabs(std::ranges::max(x.column(1)) - 5.95) < 1e-12);
  const auto least =
      std::ranges::min_element(x.column(0)); // of a range that is gone: its iterator is not
  EXPECT(std::fabs(*least - 0.05) < 1e-12);
  auto right = x.rows() | std::views::filter([](const auto &r) { return r[0] > 0.8; }) |
               std::views::transform([](const auto &r) { return r[1]; });
  double sum = 0.0;
  for (const double y : right) sum += y;
  EXPECT(std::fabs(sum - 2 * 55.0) < 1e-11);
  EXPECT(std::ranges::distance(x.column(0) | std::views::drop(90)) == 10);
  {
    mps::edit v(sand, "velocity");
    std::ranges::copy(x.column(1), v.column(0).begin());
    std::ranges::sort(v.column(0), std::ranges::greater());
    v.commit();
  }
  const auto sorted = mps::view(sand, "velocity").column(0);
  EXPECT(std::ranges::is_sorted(sorted, std::ranges::greater()));
  EXPECT(std::fabs(sorted[0] - 5.95) < 1e-12);
}
#else
static void views(const mps::particles &) {}
#endif

int main() {
  try {
    const mps::context context = mps::create_context();
    const mps::particles sand = block(context);
    mps::call(sand, mps_particles_add_field, "velocity", 0);
    reading(sand);
    writing(sand);
    nothing(context);
    views(sand);
  } catch (const std::exception &e) {
    std::printf("unexpected: %s\n", e.what());
    return 1;
  }
  if (failures == 0) std::printf("ok, C++ %ld\n", __cplusplus / 100);
  return failures > 0;
}
