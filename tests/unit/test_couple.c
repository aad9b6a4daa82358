/* test_couple.c - the coupling on linear problems x = b - A x whose solutions are known: how many
 * repeats each method takes, guesses, what is learnt and kept, refusals.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"
#include "test_journal.h"

enum { N = 24 };

/* A is symmetric, with the eigenvalues 9, 4, 1 and 0.25 on smooth shapes and 0 across them: an
 * added mass that is heavier than the structure for the first shapes. */
static void apply(const double *x, double *y) {
  static const double value[] = {9.0, 4.0, 1.0, 0.25};
  for (int i = 0; i < N; i++) y[i] = 0.0;
  for (int k = 0; k < 4; k++) {
    double share = 0.0;
    for (int i = 0; i < N; i++) share += sin(3.14159265358979 * (k + 1) * (i + 0.5) / N) * x[i];
    for (int i = 0; i < N; i++)
      y[i] += value[k] * share * 2.0 / N * sin(3.14159265358979 * (k + 1) * (i + 0.5) / N);
  }
}

/* The solution of step k, and H(x) = exact + A (exact - x). */
static void exact_at(int step, double *exact) {
  for (int i = 0; i < N; i++) exact[i] = sin(0.1 * step + 0.3 * i) + 0.05 * i * cos(0.07 * step);
}

static void answer_to(const double *exact, const double *x, double *answer) {
  double difference[N], pulled[N];
  for (int i = 0; i < N; i++) difference[i] = exact[i] - x[i];
  apply(difference, pulled);
  for (int i = 0; i < N; i++) answer[i] = exact[i] + pulled[i];
}

static mps_coupling *make(int32_t method, int64_t size) {
  DEF(coupling, def, .method = method, .size = size, .tolerance = 1e-8);
  MAKE_KEPT(coupling, c, create, context, &def);
  return c;
}

/* Repeats that a step takes; the values agreed on are right. */
static int take_step(mps_coupling *c, int step, double *x) {
  double exact[N], answer[N];
  int32_t done = 0;
  exact_at(step, exact);
  OK(mps_coupling_begin(c, NULL, x));
  while (!done) {
    answer_to(exact, x, answer);
    OK(mps_coupling_next(c, answer, x, &done));
  }
  OK(mps_coupling_accept(c));
  for (int i = 0; i < N; i++) NEAR(x[i], exact[i], 1e-6);
  mps_coupling_report report;
  OK(mps_coupling_get_report(c, &report));
  return report.repeats;
}

TEST(one_value_takes_three_repeats_then_two) {
  scoped_coupling *c = make(MPS_COUPLING_METHOD_AITKEN, 1);
  for (int step = 0; step < 4;
       step++) { /* x = 5 + step - 20 x: by fixed-point iteration it diverges */
    double x, answer;
    int32_t done = 0;
    int repeats = 0;
    OK(mps_coupling_begin(c, NULL, &x));
    while (!done) {
      answer = 5.0 + step * step - 20.0 * x;
      OK(mps_coupling_next(c, &answer, &x, &done));
      repeats++;
    }
    OK(mps_coupling_accept(c));
    NEAR(x, (5.0 + step * step) / 21.0, 1e-7);
    assert_true(repeats <= (step == 0 ? 3 : 2));
  }
}

/* Four eigenvalues besides zero: what they do is known after five differences. */
TEST(a_field_is_agreed_on_after_as_many_repeats_as_it_has_shapes) {
  double x[N];
  scoped_coupling *c = make(MPS_COUPLING_METHOD_QUASI_NEWTON, N);
  const int first = take_step(c, 0, x);
  assert_in_range(first, 4, 8);
  int later = 0;
  for (int step = 1; step <= 10; step++) later += take_step(c, step, x);
  print_message("%d repeats, then %.1f a step\n", first, later / 10.0);
  assert_true(later <= 35); /* what was learnt serves again */
}

TEST(a_field_by_one_factor_takes_more) {
  double x[N], y[N];
  mps_coupling *newton = make(MPS_COUPLING_METHOD_QUASI_NEWTON, N),
               *aitken = make(MPS_COUPLING_METHOD_AITKEN, N);
  int counts[2] = {0, 0};
  for (int step = 0; step < 5; step++) {
    counts[0] += take_step(newton, step, x);
    counts[1] += take_step(aitken, step, y);
  }
  print_message("quasi-Newton %d repeats, Aitken %d\n", counts[0], counts[1]);
  assert_true(counts[1] > 2 * counts[0]);
  mps_coupling_destroy(&newton);
  mps_coupling_destroy(&aitken);
}

TEST(what_does_not_agree_is_an_error_and_can_begin_again) {
  double x = 0.0, answer = 0.0;
  int32_t done = 0;
  DEF(coupling, def, .method = MPS_COUPLING_METHOD_CONSTANT, .size = 1, .relaxation = 0.5,
      .repeats = 7);
  MAKE(coupling, c, create, context, &def);
  OK(mps_coupling_begin(c, NULL, &x));
  mps_status status = MPS_OK;
  for (int k = 0; k < 7 && status == MPS_OK; k++) {
    answer = 1.0 - 9.0 * x;
    status = mps_coupling_next(c, &answer, &x, &done);
  }
  FAILS(status, MPS_ERROR_NUMERIC, "does not agree after 7 repeats");
  FAILS(mps_coupling_accept(c), MPS_ERROR_STATE, "not agreed on");
  const double start = 0.25;
  OK(mps_coupling_begin(c, &start, &x));
  assert_true(x == start);
  answer = start;
  OK(mps_coupling_next(c, &answer, &x, &done));
  assert_int_equal(done, 1);
  OK(mps_coupling_accept(c));
}

TEST(guesses_lie_on_a_line_through_the_last_steps) {
  scoped_coupling *c = make(MPS_COUPLING_METHOD_QUASI_NEWTON, 1);
  for (int step = 0; step < 4; step++) {
    double x, answer = 2.0 + 3.0 * step;
    int32_t done;
    OK(mps_coupling_begin(c, step ? NULL : &answer, &x));
    if (step != 1) NEAR(x, answer, 1e-12);
    if (step == 1) OK(mps_coupling_begin(c, &answer, &x));
    OK(mps_coupling_next(c, &answer, &x, &done));
    assert_int_equal(done, 1);
    OK(mps_coupling_accept(c));
  }
}

/* Memory put into another object: both continue bit for bit. */
TEST(what_is_learnt_can_be_kept) {
  double x[N], y[N], memory[4000];
  int64_t count = 0, again = 0;
  mps_coupling *c = make(MPS_COUPLING_METHOD_QUASI_NEWTON, N),
               *d = make(MPS_COUPLING_METHOD_QUASI_NEWTON, N);
  for (int step = 0; step < 5; step++) take_step(c, step, x);
  OK(mps_coupling_get_memory(c, 0, &count, NULL));
  assert_in_range(count, 1, 4000);
  OK(mps_coupling_get_memory(c, 4000, &again, memory));
  assert_int_equal(count, again);
  OK(mps_coupling_set_memory(d, count, memory));
  for (int step = 5; step < 9; step++) {
    assert_int_equal(take_step(c, step, x), take_step(d, step, y));
    assert_memory_equal(x, y, sizeof x);
  }
  memory[1] = 3.0;
  FAILS(mps_coupling_set_memory(d, count, memory), MPS_ERROR_FORMAT,
        "not the memory of a coupling of 24 values");
  mps_coupling_destroy(&c);
  mps_coupling_destroy(&d);
}

/* Warnings of 300 accepted steps of two values: `large` cos(w n) about a mean of 5, waves of .04
 * rad a step and an amplitude of 1, and `noise`. */
static int warnings(journal *j, double large, double w, double noise) {
  uint64_t seed = 7;
  *j = (journal){0};
  DEF(coupling, def, .size = 2, .floor = 1e-3);
  mps_context_set_log(context, journal_note, j, NULL);
  MAKE(coupling, c, create, context, &def);
  for (int n = 0; n < 300; n++) {
    double x[2];
    int32_t done;
    for (int i = 0; i < 2; i++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      x[i] = 5.0 + cos(0.04 * n) + large * cos(w * n + i) +
             noise * ((double)(seed >> 11) * 0x1p-52 - 1.0);
    }
    OK(mps_coupling_begin(c, x, x));
    OK(mps_coupling_next(c, x, x, &done));
    assert_true(done);
    OK(mps_coupling_accept(c));
  }
  mps_context_set_log(context, NULL, NULL, NULL);
  return j->count;
}

/* Only a swing that dominates is one: noise and waves, however large, say nothing of the step. */
TEST(a_step_too_long_for_what_swings_is_warned_of) {
  journal j;
  assert_int_equal(warnings(&j, 1.0, 0.5, 0.0), 1);
  assert_non_null(strstr(j.last, "oscillate by 0.50 rad a step"));
  assert_int_equal(warnings(&j, 1.0, 1.6, 0.0), 1);
  assert_int_equal(warnings(&j, 1.0, 0.5, 0.02), 1);
  assert_int_equal(warnings(&j, 1.0, 0.28, 0.0), 0);
  assert_int_equal(warnings(&j, 0.0, 0.5, 0.0), 0);
  assert_int_equal(warnings(&j, 0.0, 0.5, 1.0), 0);
  assert_int_equal(warnings(&j, 0.0, 0.5, 0.01), 0);
}

TEST(bad_input_is_refused) {
  scoped_coupling *c = make(MPS_COUPLING_METHOD_QUASI_NEWTON, 2);
  double x[2] = {0.0, 0.0}, answer[2] = {1.0, NAN};
  int32_t done;
  FAILS(mps_coupling_next(c, x, x, &done), MPS_ERROR_STATE, "begin");
  OK(mps_coupling_begin(c, NULL, x));
  FAILS(mps_coupling_next(c, answer, x, &done), MPS_ERROR_NUMERIC,
        "answer 1 at repeat 1 of the coupling is nan");
  REFUSES(mps_coupling_begin(c, answer, x), "start value 1");
  mps_coupling_destroy(&c);
}
