/* test_hdf5_history.c - histories (mps/history.h) go along with all solvers: snapshots,
 * checkpoints, ranks; their files survive what happens to programs and disks.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "domain_threads.h"
#include "solver_scenes.h"
#include "test_fixture.h"

#include <errno.h>
#include <locale.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char path[] = TEST_TMP "/history.csv", state_path[] = TEST_TMP "/history.h5";
static const char *const names[] = {"settlement", "force, \"upper\""}, *const units[] = {"m",
                                                                                         "kN/m2"};

static mps_history *history_of(mps_solver *solver, const char *name) {
  mps_history *made = NULL;
  OK(mps_history_create(solver, name, names, units, 2, &made));
  return made;
}

static void record(mps_history *h, double a, double b) {
  OK(mps_history_record(h, NAN, (const double[]){a, b}, 2));
}

static double value(const mps_history *h, const char *column, int64_t row) {
  mps_view view;
  OK(mps_history_view(h, column, &view));
  assert_true(row < view.shape[0]);
  return *mps_view_f64(&view, row, 0);
}

static char *text_of(const char *file) {
  static char text[1 << 16];
  FILE *in = fopen(file, "r");
  assert_non_null(in);
  text[fread(text, 1, sizeof text - 1, in)] = '\0';
  fclose(in);
  return text;
}

static int64_t lines_of(const char *file) {
  int64_t lines = 0;
  const char *text = text_of(file);
  assert_true(text[strlen(text) - 1] == '\n');
  for (; *text; text++) lines += *text == '\n';
  return lines;
}

/* ---- the state ------------------------------------------------------------------------------- */

TEST(rows_go_along_with_the_state_of_every_solver) {
  for (int k = 0; k < KINDS; k++) {
    scene s = kinds[k].make(context), other = kinds[k].make(context);
    mps_history *one = history_of(s.solver, "one"), *two = history_of(s.solver, "two");
    mps_snapshot *snapshot = NULL;
    OK(mps_solver_step(s.solver, 2));
    record(one, 1.0, NAN);
    record(two, 1.5, INFINITY);
    const double at = mps_solver_time(s.solver);
    OK(mps_solver_snapshot(s.solver, &snapshot));
    OK(mps_solver_save(s.solver, state_path, NULL));
    OK(mps_solver_step(s.solver, 2));
    record(one, 2.0, 2.0);
    record(one, 3.0, 3.0);
    assert_int_equal(mps_history_count(one), 3);
    OK(mps_solver_rollback(s.solver, snapshot));
    assert_int_equal(mps_history_count(one), 1);
    assert_int_equal(mps_history_count(two), 1);
    assert_true(value(one, "t", 0) == at && value(one, "settlement", 0) == 1.0);
    assert_true(isnan(value(one, names[1], 0)) && value(two, names[1], 0) == INFINITY);

    /* a solver with one of these histories, and one that the file lacks */
    mps_history *same = history_of(other.solver, "two");
    mps_history *late = history_of(other.solver, "late");
    record(late, 7.0, 7.0);
    OK(mps_solver_restore(other.solver, state_path, NULL));
    assert_int_equal(mps_history_count(late), 0);
    assert_int_equal(mps_history_count(same), 1);
    assert_true(value(same, "t", 0) == at && value(same, "settlement", 0) == 1.5);

    /* one made after the snapshot, and one destroyed since */
    mps_history *after = history_of(s.solver, "after");
    record(after, 1.0, 1.0);
    mps_history_destroy(&two);
    OK(mps_solver_rollback(s.solver, snapshot));
    assert_int_equal(mps_history_count(after), 0);
    assert_int_equal(mps_history_count(one), 1);
    mps_history_destroy(&one), mps_history_destroy(&after);
    mps_history_destroy(&same), mps_history_destroy(&late);
    mps_snapshot_destroy(&snapshot);
    drop(&s), drop(&other);
  }
}

TEST(a_state_with_other_columns_is_refused_and_changes_nothing) {
  static const char *const others[] = {"settlement", "moment"};
  scene s = make_mpm(context), other = make_mpm(context);
  mps_history *h = history_of(s.solver, "load"), *moved = NULL;
  record(h, 1.0, 2.0);
  OK(mps_solver_save(s.solver, state_path, NULL));
  OK(mps_history_create(other.solver, "load", others, units, 2, &moved));
  OK(mps_solver_step(other.solver, 3));
  record(moved, 5.0, 6.0);
  FAILS(mps_solver_restore(other.solver, state_path, NULL), MPS_ERROR_ARGUMENT,
        "t [s], settlement [m], force, \"upper\" [kN/m2]");
  assert_int_equal(mps_solver_steps(other.solver), 3);
  assert_true(value(moved, "moment", 0) == 6.0);
  mps_history_destroy(&h), mps_history_destroy(&moved);
  drop(&s), drop(&other);
}

/* ---- columns --------------------------------------------------------------------------------- */

static mps_status steps_of(void *user, mps_solver *solver, double *out) {
  ++*(int *)user;
  *out = (double)mps_solver_steps(solver);
  return *out > 3.0 ? MPS_ERROR_CANCELLED : MPS_OK;
}

static void count_release(void *user) { *(int *)user += 1000; }

static mps_history *nested;
static mps_status meddle(void *user, mps_solver *solver, double *out) {
  mps_context *c = user;
  mps_history *h = nested;
  (void)out;
  FAILS_ON(c, mps_history_record(h, NAN, (const double[]){0.0}, 1), MPS_ERROR_STATE, "source");
  FAILS_ON(c, mps_solver_step(solver, 1), MPS_ERROR_STATE, "source of a column");
  mps_history_destroy(&h);
  assert_non_null(h);
  return MPS_OK;
}

TEST(a_column_may_have_a_source) {
  int calls = 0;
  scene s = make_mpm(context);
  mps_history *h = history_of(s.solver, "load");
  FAILS(mps_history_set_source(h, "t", steps_of, &calls, count_release), MPS_ERROR_ARGUMENT,
        "settlement [m]");
  OK(mps_history_set_source(h, "settlement", steps_of, &calls, count_release));
  FAILS(mps_history_record(h, NAN, (const double[]){0.0, 0.0}, 2), MPS_ERROR_ARGUMENT, "must be 1");
  OK(mps_solver_step(s.solver, 3));
  OK(mps_history_record(h, 0.25, (const double[]){8.0}, 1));
  assert_true(value(h, "t", 0) == 0.25 && value(h, "settlement", 0) == 3.0);
  assert_true(value(h, names[1], 0) == 8.0);
  OK(mps_solver_step(s.solver, 1));
  FAILS(mps_history_record(h, NAN, (const double[]){8.0}, 1), MPS_ERROR_CANCELLED,
        "the source of a column");
  assert_int_equal(mps_history_count(h), 1);
  nested = h;
  OK(mps_history_set_source(h, "settlement", meddle, context, NULL));
  assert_int_equal(calls, 1002);
  OK(mps_history_record(h, NAN, (const double[]){8.0}, 1));
  assert_true(isnan(value(h, "settlement", 1)));
  OK(mps_history_set_source(h, "settlement", steps_of, &calls, count_release));
  mps_history_destroy(&h);
  assert_int_equal(calls, 2002);
  drop(&s);
}

TEST(wrong_calls_are_refused_by_name) {
  static const char *const twice[] = {"a", "a"}, *const time[] = {"t"}, *const broken[] = {"a\nb"};
  static const char *const none[] = {"a", NULL};
  char longest[200];
  memset(longest, 'x', sizeof longest);
  longest[64] = '\0';
  const char *const too_long[] = {longest};
  mps_context *c = context;
  scene s = make_mpm(c);
  mps_solver *v = s.solver;
  mps_history *h = NULL;
  mps_view view;
  FAILS_ON(c, mps_history_create(v, "a b", names, NULL, 2, &h), MPS_ERROR_ARGUMENT, "a b");
  FAILS_ON(c, mps_history_create(v, "", names, NULL, 2, &h), MPS_ERROR_ARGUMENT, "1 to 31");
  FAILS_ON(c, mps_history_create(v, longest, names, NULL, 2, &h), MPS_ERROR_ARGUMENT, "31");
  FAILS_ON(c, mps_history_create(v, "h", names, NULL, 0, &h), MPS_ERROR_ARGUMENT, "4096");
  FAILS_ON(c, mps_history_create(v, "h", NULL, NULL, 2, &h), MPS_ERROR_ARGUMENT, "NULL");
  FAILS_ON(c, mps_history_create(v, "h", twice, NULL, 2, &h), MPS_ERROR_ARGUMENT, "another");
  FAILS_ON(c, mps_history_create(v, "h", time, NULL, 1, &h), MPS_ERROR_ARGUMENT, "another");
  FAILS_ON(c, mps_history_create(v, "h", broken, NULL, 1, &h), MPS_ERROR_ARGUMENT, "line");
  FAILS_ON(c, mps_history_create(v, "h", none, NULL, 2, &h), MPS_ERROR_ARGUMENT, "[1]");
  FAILS_ON(c, mps_history_create(v, "h", too_long, NULL, 1, &h), MPS_ERROR_ARGUMENT, "63");
  FAILS_ON(c, mps_history_create(v, "h", names, too_long, 1, &h), MPS_ERROR_ARGUMENT, "units");
  assert_int_equal(mps_history_create(NULL, "h", names, NULL, 2, &h), MPS_ERROR_ARGUMENT);
  assert_null(h);
  h = history_of(v, "h");
  mps_history *again = NULL;
  FAILS_ON(c, mps_history_create(v, "h", names, NULL, 2, &again), MPS_ERROR_ARGUMENT, "'h'");
  const double row[2] = {0.0, 0.0};
  FAILS_ON(c, mps_history_record(h, NAN, row, 1), MPS_ERROR_ARGUMENT, "must be 2");
  FAILS_ON(c, mps_history_record(h, NAN, row, 3), MPS_ERROR_ARGUMENT, "must be 2");
  FAILS_ON(c, mps_history_record(h, NAN, NULL, 2), MPS_ERROR_ARGUMENT, "NULL");
  FAILS_ON(c, mps_history_record(h, INFINITY, row, 2), MPS_ERROR_ARGUMENT, "finite");
  FAILS_ON(c, mps_history_view(h, "force", &view), MPS_ERROR_ARGUMENT, "settlement [m]");
  FAILS_ON(c, mps_history_flush(h), MPS_ERROR_STATE, "mps_history_open");
  FAILS_ON(c, mps_history_open(h, path, 0), MPS_ERROR_ARGUMENT, ">= 1");
  assert_int_equal(mps_history_count(h), 0);
  mps_history_destroy(&h);
  drop(&s);
}

TEST(a_history_outlives_its_solver) {
  scene s = make_mpm(context);
  mps_history *h = history_of(s.solver, "load");
  unlink(path);
  OK(mps_history_open(h, path, 100));
  record(h, 1.0, 2.0);
  drop(&s);
  FAILS(mps_history_record(h, NAN, (const double[]){1.0, 2.0}, 2), MPS_ERROR_STATE, "destroyed");
  assert_true(value(h, "settlement", 0) == 1.0);
  mps_history_destroy(&h);
  mps_history_destroy(&h);
  assert_int_equal(lines_of(path), 2);
}

/* ---- files ----------------------------------------------------------------------------------- */

TEST(a_file_has_names_in_quotes_and_numbers_to_the_last_bit) {
  scene s = make_mpm(context);
  mps_history *h = history_of(s.solver, "load");
  const bool german = setlocale(LC_ALL, "de_DE.UTF-8") != NULL; /* where there is one */
  OK(mps_history_record(h, 0.1, (const double[]){1.0 / 3.0, NAN}, 2));
  OK(mps_history_record(h, 0.2, (const double[]){-INFINITY, 1e-300}, 2));
  OK(mps_history_write(h, path));
  setlocale(LC_ALL, "C");
  (void)german;
  assert_string_equal(text_of(path), "t_s,settlement_m,\"force, \"\"upper\"\"_kN_m2\"\n"
                                     "0.1,0.3333333333333333,\n"
                                     "0.2,-inf,1e-300\n");
  mps_history_destroy(&h);
  drop(&s);
}

TEST(a_file_follows_the_rows_through_rollbacks) {
  scene s = make_mpm(context);
  mps_history *h = history_of(s.solver, "load");
  mps_snapshot *snapshot = NULL;
  unlink(path);
  OK(mps_history_open(h, path, 2));
  record(h, 1.0, 1.0);
  assert_int_equal(access(path, F_OK), -1); /* a block has two rows */
  record(h, 2.0, 2.0);
  assert_int_equal(lines_of(path), 3);
  OK(mps_solver_snapshot(s.solver, &snapshot));
  for (int trial = 0; trial < 3; trial++) {
    for (int k = 0; k < 5; k++) record(h, 100.0 * trial + k, 0.0);
    if (trial < 2) OK(mps_solver_rollback(s.solver, snapshot));
  }
  OK(mps_history_flush(h));
  const double t = mps_solver_time(s.solver);
  char expected[400];
  snprintf(expected, sizeof expected,
           "%g,1,1\n%g,2,2\n%g,200,0\n%g,201,0\n%g,202,0\n%g,203,0\n%g,204,0\n", t, t, t, t, t, t,
           t);
  assert_string_equal(strchr(text_of(path), '\n') + 1, expected);
  OK(mps_history_open(h, NULL, 1));
  FAILS(mps_history_flush(h), MPS_ERROR_STATE, "no open file");
  mps_snapshot_destroy(&snapshot);
  mps_history_destroy(&h);
  drop(&s);
}

TEST(places_that_are_no_files_are_refused) {
  scene s = make_mpm(context);
  mps_history *h = history_of(s.solver, "load");
  unlink(path);
  OK(mps_history_open(h, path, 1));
  static const char *const bad[] = {"/dev/full", TEST_TMP, TEST_TMP "/nowhere/at/all.csv"};
  for (int k = 0; k < 3; k++) {
    FAILS(mps_history_write(h, bad[k]), MPS_ERROR_IO, bad[k]);
    FAILS(mps_history_open(h, bad[k], 1), MPS_ERROR_IO, bad[k]);
  }
  const char link[] = TEST_TMP "/history-link.csv.part";
  unlink(link);
  assert_int_equal(symlink("/dev/full", link), 0);
  FAILS(mps_history_write(h, TEST_TMP "/history-link.csv"), MPS_ERROR_IO, ".part");
  unlink(link);
  record(h, 1.0, 2.0); /* the former file continues */
  assert_int_equal(lines_of(path), 2);
  mps_history_destroy(&h);
  drop(&s);
}

/* A file may grow no further, as on a full disk. */
static void limit_files(rlim_t bytes) {
  const struct rlimit limit = {bytes, RLIM_INFINITY};
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

TEST(a_full_disk_leaves_whole_rows_and_a_later_write_completes_them) {
  scene s = make_mpm(context);
  mps_history *h = history_of(s.solver, "load");
  signal(SIGXFSZ, SIG_IGN);
  unlink(path);
  OK(mps_history_open(h, path, 1));
  limit_files(10); /* not even the header */
  FAILS(mps_history_record(h, 0.0, (const double[]){0.0, 0.0}, 2), MPS_ERROR_IO, "write");
  assert_int_equal(access(path, F_OK), -1);
  assert_int_equal(access(TEST_TMP "/history.csv.part", F_OK), -1);
  limit_files(300);
  mps_status status = MPS_OK;
  int64_t rows = 1;
  for (; status == MPS_OK; rows++)
    status = mps_history_record(h, (double)rows, (const double[]){1.0 / 3.0, 1.0 / 7.0}, 2);
  assert_int_equal(status, MPS_ERROR_IO);
  assert_int_equal(mps_history_count(h), rows);
  assert_int_equal(lines_of(path), rows); /* the header, all but the last */
  FAILS(mps_history_write(h, TEST_TMP "/history-full.csv"), MPS_ERROR_IO, "");
  assert_int_equal(access(TEST_TMP "/history-full.csv", F_OK), -1);
  limit_files(RLIM_INFINITY);
  OK(mps_history_flush(h));
  assert_int_equal(lines_of(path), rows + 1);
  mps_history_destroy(&h);
  drop(&s);
}

/* ---- a run that is killed and continued ---------------------------------------------------- */

static void run(mps_solver *solver, mps_history *h, int64_t steps) {
  for (int64_t k = 0; k < steps; k++) {
    OK(mps_solver_step(solver, 1));
    const double x = (double)mps_solver_steps(solver);
    record(h, x, sin(x));
  }
}

TEST(a_killed_run_goes_on_without_a_double_or_missing_row) {
  const char whole[] = TEST_TMP "/history-whole.csv";
  scene s = make_mpm(context);
  mps_history *h = history_of(s.solver, "load");
  OK(mps_history_open(h, whole, 1));
  run(s.solver, h, 40);
  mps_history_destroy(&h);
  drop(&s);
  unlink(path);
  const pid_t child = fork();
  if (child == 0) {
    s = make_mpm(context);
    h = history_of(s.solver, "load");
    OK(mps_history_open(h, path, 4));
    run(s.solver, h, 18);
    OK(mps_solver_save(s.solver, state_path, NULL));
    run(s.solver, h, 9);
    raise(SIGKILL);
  }
  int status = 0;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  assert_int_equal(lines_of(path), 1 + 24); /* the last full block */
  s = make_mpm(context);
  h = history_of(s.solver, "load");
  OK(mps_history_open(h, path, 4));
  OK(mps_solver_restore(s.solver, state_path, NULL));
  assert_int_equal(lines_of(path), 1 + 24); /* until the first block of this run */
  run(s.solver, h, 22);
  mps_history_destroy(&h);
  drop(&s);
  char *one = strdup(text_of(whole));
  assert_string_equal(text_of(path), one);
  free(one);
}

/* ---- ranks ----------------------------------------------------------------------------------- */

static mps_status rank_value(void *user, mps_solver *solver, double *out) {
  *out = 10.0 + *(int32_t *)user;
  return MPS_OK;
}

/* Where rank 0 cannot write a block of two rows, all ranks try again at the next row. */
static void disk_is_full(mps_history *h, mps_domain *domain, int32_t rank) {
  OK(mps_history_open(h, TEST_TMP "/history-ranks.csv", 2));
  OK(mps_domain_agree(domain, MPS_OK));
  if (rank == 0) limit_files(10);
  OK(mps_domain_agree(domain, MPS_OK));
  for (int k = 0; k < 3; k++)
    assert_int_equal(mps_history_record(h, NAN, (const double[]){1.0}, 1), MPS_ERROR_IO);
  OK(mps_domain_agree(domain, MPS_OK));
  if (rank == 0) limit_files(RLIM_INFINITY);
  OK(mps_history_flush(h));
  assert_int_equal(mps_history_count(h), 4);
}

/* Each rank gives its own numbers: those of rank 0 count, in memory, file and checkpoint. */
static void on_a_rank(void *user, team *t, int32_t rank) {
  scoped_context *c = team_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const mps_domain_def def = team_domain_def(t, rank);
  mps_dynamics_def solver = mps_dynamics_defaults();
  mps_history *h = NULL;
  mps_particles *set = NULL;
  OK(mps_domain_create(c, &def, &solver.domain));
  USING(particles, mps_domain_create_particles(solver.domain, &given, &set), .spacing = 1.0);
  OK(mps_particles_fill_box(set, AT(0.0, 0.0), AT(40.0, 30.0), NULL));
  SET_FIELDS(set, {"density", 1900.0}, {"shear_velocity", 200.0}, {"pressure_velocity", 400.0});
  MAKE_KEPT(dynamics, dynamics, create, c, set, &solver);
  OK(mps_history_create(mps_dynamics_solver(dynamics), "r", names, NULL, 2, &h));
  OK(mps_history_set_source(h, "settlement", rank_value, &rank, NULL));
  OK(mps_history_open(h, path, 1));
  OK(mps_dynamics_step(dynamics, 2));
  const double own = rank == 0 ? NAN : (double)rank;
  OK(mps_history_record(h, NAN, &own, 1));
  OK(mps_dynamics_save(dynamics, state_path, NULL));
  OK(mps_dynamics_step(dynamics, 2));
  OK(mps_history_record(h, NAN, &own, 1));
  FAILS_ON(c, mps_history_record(h, NAN, &own, rank == 1 ? 2 : 1), MPS_ERROR_ARGUMENT, "must be 1");
  OK(mps_dynamics_restore(dynamics, state_path, NULL));
  assert_int_equal(mps_history_count(h), 1);
  assert_true(value(h, "settlement", 0) == 10.0 && isnan(value(h, names[1], 0)));
  disk_is_full(h, solver.domain, rank);
  mps_history_destroy(&h);
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
  mps_domain_destroy(&solver.domain);
}

TEST(ranks_have_the_rows_of_the_first) {
  team t;
  unlink(path);
  signal(SIGXFSZ, SIG_IGN);
  team_begin(&t, 3);
  team_run(&t, on_a_rank, NULL);
  team_end(&t);
  assert_int_equal(lines_of(path), 2);
  assert_int_equal(lines_of(TEST_TMP "/history-ranks.csv"), 5);
}
