/* test_io.c - the definition structs of mps/io.h, and a libmps without HDF5: every function is
 * there and says so. What the files hold: test_hdf5_*.c. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

TEST(definitions_start_from_their_defaults) {
  const mps_recorder_def def = mps_recorder_defaults();
  const mps_checkpoint info = mps_checkpoint_defaults();
  assert_int_equal(def.struct_size, sizeof def);
  assert_int_equal(def.compression, 0);
  assert_null(def.path);
  assert_null(def.fields);
  assert_int_equal(info.struct_size, sizeof info);
  assert_int_equal(info.step, 0);
  assert_string_equal(info.user_key, "");
  mps_recorder_def small;
  mps_checkpoint short_info;
  assert_int_equal(mps_def_init(MPS_DEF_RECORDER, NULL, sizeof small), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_def_init(MPS_DEF_RECORDER, &small, sizeof small - 8), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_def_init(MPS_DEF_CHECKPOINT, NULL, sizeof short_info), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_def_init(MPS_DEF_CHECKPOINT, &short_info, sizeof short_info - 1),
                   MPS_ERROR_ARGUMENT);
}

TEST(without_hdf5_every_function_says_so) {
  DEF(particles, set_def, .spacing = 1.0);
  mps_checkpoint info = mps_checkpoint_defaults();
  scoped_recorder *recorder = (mps_recorder *)&recorder;
  MAKE(particles, set, create, context, &set_def);
  DEF(recorder, def, .path = TEST_TMP "/io.vtkhdf");
  const mps_status status = mps_recorder_create(context, set, &def, &recorder);
  if (status == MPS_OK) {
    mps_recorder_destroy(&recorder);
    mps_particles_destroy(&set);
    skip(); /* this libmps has HDF5 */
  }
  assert_null(recorder);
#define UNSUPPORTED(call) FAILS(call, MPS_ERROR_UNSUPPORTED, "without HDF5")
  UNSUPPORTED(mps_recorder_create(context, set, &def, &recorder));
  UNSUPPORTED(mps_checkpoint_read(set, TEST_TMP "/io.h5", &info));
  UNSUPPORTED(mps_checkpoint_info(context, TEST_TMP "/io.h5", &info));
  assert_int_equal(mps_mpm_save(NULL, TEST_TMP "/io.h5", &info), MPS_ERROR_UNSUPPORTED);
  assert_int_equal(mps_mpm_restore(NULL, TEST_TMP "/io.h5", &info), MPS_ERROR_UNSUPPORTED);
#undef UNSUPPORTED
  assert_int_equal(mps_recorder_write(NULL, 0.0), MPS_ERROR_UNSUPPORTED);
  OK(mps_recorder_close(&recorder));
}
