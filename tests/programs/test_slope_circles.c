/* test_slope_circles.c - slip circles and spirals of mps-slope against charts, the infinite slope,
 * and what must hold for water. SPDX-License-Identifier: BSD-3-Clause */
#include "test_common.h"

#include "slope/slope.h"

#define DEGREE (3.14159265358979323846 / 180.0)

/* 2 : 1, 10 m, 2000 kg/m3, phi 20 degrees, c = 0.05 gamma H. */
static settings usual(void) {
  return (settings){.height = 10.0,
                    .slope = 2.0,
                    .crest = 30.0,
                    .toe = 30.0,
                    .phi = 20.0,
                    .cohesion = 9810.0,
                    .density = 2000.0,
                    .moist = 2000.0,
                    .gravity = 9.81,
                    .poisson = 0.3,
                    .table = NAN,
                    .drawdown = NAN};
}

static double circles(const settings *s) {
  slope_circle c;
  return slope_circles(s, &c);
}

TEST(clay_is_taylors) {
  settings s = usual();
  s.phi = 0.0;
  s.slope = 0.0;
  s.crest = 20.0;
  NEAR(circles(&s) / 0.05, 3.83, 0.02); /* Fellenius: a vertical cut by circles */
  s.slope = 1.0 / tan(60.0 * DEGREE);
  s.base = 5.0;
  NEAR(circles(&s) / 0.05, 1.0 / 0.191, 0.03); /* Taylor (1937) */
}

static double spirals(const settings *s) {
  slope_circle pole;
  return slope_spirals(s, false, &pole);
}

/* Chen (1975), table 9.1: gamma H/c of slopes that just stand, level behind the crest. */
TEST(spirals_are_chens) {
  static const struct {
    double phi, slope, number;
  } chen[] = {{0.0, 90.0, 3.83},  {10.0, 90.0, 4.58}, {20.0, 90.0, 5.50},  {10.0, 75.0, 5.80},
              {20.0, 75.0, 7.48}, {10.0, 60.0, 7.26}, {20.0, 60.0, 10.39}, {20.0, 45.0, 16.16}};
  for (size_t k = 0; k < sizeof chen / sizeof *chen; k++) {
    settings s = usual();
    s.phi = chen[k].phi;
    s.slope = chen[k].slope < 90.0 ? 1.0 / tan(chen[k].slope * DEGREE) : 0.0;
    s.cohesion = s.density * s.gravity * s.height / chen[k].number;
    NEAR(spirals(&s), 1.0, 0.005);
  }
}

/* The plane through the toe of a vertical face in sand slips whatever the strength (Culmann): the
 * search for the least factor ends, at 0. */
TEST(sand_has_no_vertical_face) {
  const double height[] = {0.3, 10.0, 40.0}, phi[] = {20.0, 30.0, 42.0};
  for (size_t k = 0; k < 3; k++) {
    settings s = usual();
    s.height = height[k], s.slope = 0.0, s.crest = 2.0 * height[k];
    s.phi = phi[k], s.cohesion = 0.0;
    NEAR(circles(&s), 0.0, 1e-12);
    NEAR(spirals(&s), 0.0, 1e-12);
    s.cohesion = 1e-2 * s.density * s.gravity * s.height;
    assert_true(circles(&s) > 0.03 && spirals(&s) > 0.04);
  }
}

/* Sand slides down an infinite slope where sin(phi_F) is tan(slope), the plane on which it does not
 * dilate (Davis 1968). */
TEST(sand_that_does_not_dilate_is_weaker) {
  settings s = usual();
  slope_circle pole;
  s.phi = 35.0, s.cohesion = 1.0;
  NEAR(slope_spirals(&s, true, &pole), tan(35.0 * DEGREE) / tan(30.0 * DEGREE), 0.005);
  s.psi = 35.0;
  NEAR(slope_spirals(&s, true, &pole), spirals(&s), 1e-3);
}

/* Without friction a spiral is a circle, with water too; both have an infinite slope's shallow
 * slip. */
TEST(spirals_and_circles_agree) {
  settings s = usual();
  NEAR(spirals(&s), circles(&s), 0.01);
  s.table = 4.0;
  NEAR(spirals(&s), circles(&s), 0.015);
  s.phi = 0.0;
  s.base = 5.0;
  NEAR(spirals(&s), circles(&s), 0.005);
  s = usual();
  s.cohesion = 1.0, s.ru = 0.25;
  NEAR(spirals(&s), circles(&s), 0.005);
}

TEST(sand_with_cohesion_is_that_of_charts) {
  settings s = usual();
  NEAR(circles(&s), 1.380, 0.01); /* Bishop and Morgenstern (1960) */
}

/* Without cohesion the circle is flat below the surface: F = (1 - r_u/cos^2 b) tan(phi)/tan(b), and
 * with water that flows along the surface F = (1 - gamma_w/gamma) tan(phi)/tan(b). */
TEST(shallow_slips_are_those_of_an_infinite_slope) {
  settings s = usual();
  const double dry = tan(20.0 * DEGREE) / 0.5, steep = 0.8; /* cos^2 */
  s.cohesion = 1e-3;
  NEAR(circles(&s), dry, 0.005 * dry);
  s.ru = 0.3;
  NEAR(circles(&s), (1.0 - 0.3 / steep) * dry, 0.005 * dry);
  s.ru = 0.0;
  s.flow = FLOW_ALONG;
  const double line[] = {-30.0, 10.0, 0.0, 10.0, 20.0, 0.0, 60.0, 0.0};
  s.points = 4;
  for (int k = 0; k < 8; k++) s.line[k] = line[k];
  NEAR(circles(&s), 0.5 * dry, 0.01 * dry);
}

TEST(a_submerged_slope_has_its_buoyant_weight) {
  settings wet = usual(), dry = usual();
  dry.density = dry.moist = 1000.0;
  wet.table = 25.0;
  NEAR(circles(&wet), circles(&dry), 1e-9);
  wet.table = 10.0; /* the pool's depth does not count */
  NEAR(circles(&wet), circles(&dry), 1e-9);
  wet.table = -50.0;
  dry = usual();
  NEAR(circles(&wet), circles(&dry), 1e-12);
}

/* Below the former pool a drawdown leaves r_u = gamma_w/gamma; half of it leaves half of the pool.
 */
TEST(a_drawdown_leaves_the_pressures) {
  settings fallen = usual(), ratio = usual();
  fallen.drawdown = 10.0;
  fallen.table = 0.0;
  ratio.ru = 0.5;
  NEAR(circles(&fallen), circles(&ratio), 1e-9);
  fallen.table = 5.0;
  NEAR(slope_pressure(&fallen, 15.0, 0.0), 1000.0 * 9.81 * 5.0, 1e-6);
  NEAR(slope_pressure(&fallen, 5.0, 0.0), 1000.0 * 9.81 * 7.5, 1e-6);
  NEAR(slope_pressure(&fallen, -10.0, 2.0), 1000.0 * 9.81 * 8.0, 1e-6);
  assert_true(circles(&fallen) > circles(&ratio));
}

/* Ground above the table is lighter: weight, pressure and pool by hand. */
TEST(weights_count_what_is_above) {
  settings s = usual();
  s.moist = 1700.0;
  s.table = 4.0;
  NEAR(slope_overburden(&s, -5.0, 1.0), 9.81 * (6.0 * 1700.0 + 3.0 * 2000.0), 1e-6);
  NEAR(slope_overburden(&s, 16.0, 1.0), 9.81 * (1000.0 * 2.0 + 2000.0 * 1.0), 1e-6);
  NEAR(slope_pressure(&s, 16.0, 1.0), 9.81 * 3000.0, 1e-6);
  NEAR(slope_density(&s, -5.0, 4.1), 1700.0, 0.0);
  NEAR(slope_density(&s, -5.0, 3.9), 2000.0, 0.0);
}
