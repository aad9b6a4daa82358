"""Written by make_cdef.py."""

SONAME = 'libmps.so.0.2'
PARAMETERS = {
    'mps_status_text': ('status',),
    'mps_version': (),
    'mps_version_number': (),
    'mps_library_has': ('feature',),
    'mps_library_feature_name': ('feature',),
    'mps_library_has_level': ('level',),
    'mps_context_def_init': ('def', 'size'),
    'mps_context_create': ('const def', 'out', 'error_text', 'error_size'),
    'mps_context_destroy': ('context',),
    'mps_context_error': ('const context',),
    'mps_context_clear_error': ('context',),
    'mps_context_set_log': ('context', 'log', 'user'),
    'mps_context_set_progress': ('context', 'progress', 'user'),
    'mps_context_set_cancel': ('context', 'cancel', 'user'),
    'mps_context_instruction_level': ('const context',),
    'mps_context_threads': ('const context',),
    'mps_context_parallel_for': ('context', 'count', 'task', 'data'),
    'mps_signal_ricker': ('context', 'frequency', 'peak_time', 'amplitude', 'out'),
    'mps_signal_sine': ('context', 'frequency', 'amplitude', 'phase', 'out'),
    'mps_signal_ramp': ('context', 'start', 'duration', 'amplitude', 'out'),
    'mps_signal_table': ('context', 'quantity', 'count', 'const times', 'const values', 'out'),
    'mps_signal_user': ('context', 'fn', 'user', 'out'),
    'mps_signal_record_def_init': ('def', 'size'),
    'mps_signal_record': ('context', 'const path', 'const def', 'out'),
    'mps_signal_destroy': ('signal',),
    'mps_signal_displacement': ('const signal', 't'),
    'mps_signal_velocity': ('const signal', 't'),
    'mps_signal_acceleration': ('const signal', 't'),
    'mps_signal_span': ('const signal', 'start', 'end'),
    'mps_signal_peak_acceleration': ('const signal',),
    'mps_snapshot_destroy': ('snapshot',),
    'mps_body_def_init': ('def', 'size'),
    'mps_body_create_polygon': ('context', 'const def', 'vertices', 'const xy', 'out'),
    'mps_body_create_box': ('context', 'const def', 'width', 'height', 'out'),
    'mps_body_create_disc': ('context', 'const def', 'radius', 'out'),
    'mps_body_create_half_plane': ('context', 'const def', 'const normal', 'out'),
    'mps_body_create_sphere': ('context', 'const def', 'radius', 'out'),
    'mps_body_create_half_space': ('context', 'const def', 'const normal', 'out'),
    'mps_body_create_cylinder': ('context', 'const def', 'radius', 'length', 'out'),
    'mps_body_create_revolution': ('context', 'const def', 'vertices', 'const rz', 'out'),
    'mps_body_create_mesh': ('context', 'const def', 'vertices', 'const xyz', 'triangles', 'const corner', 'out'),
    'mps_body_create_stl': ('context', 'const def', 'const path', 'scale', 'out'),
    'mps_body_destroy': ('body',),
    'mps_body_dim': ('const body',),
    'mps_body_drive': ('body', 'component', 'signal', 'factor'),
    'mps_body_motion_init': ('motion', 'size'),
    'mps_body_set_motion': ('body', 'const motion'),
    'mps_body_load': ('body', 'const force', 'const moment'),
    'mps_body_advance': ('body', 'dt'),
    'mps_body_get_state_sized': ('body', 'out', 'size'),
    'mps_body_get_totals_sized': ('body', 'out', 'size'),
    'mps_body_distance': ('body', 'count', 'const x', 'distance', 'normal', 'foot', 'face'),
    'mps_body_name_part': ('body', 'const name', 'first', 'count', 'part'),
    'mps_body_part_count': ('const body',),
    'mps_body_part': ('const body', 'const name'),
    'mps_body_get_reaction_sized': ('body', 'part', 'out', 'size'),
    'mps_contact_def_init': ('def', 'size'),
    'mps_contact_destroy': ('contact',),
    'mps_contact_body': ('const contact',),
    'mps_contact_get_reaction_sized': ('contact', 'part', 'out', 'size'),
    'mps_contact_get_particles': ('contact', 'capacity', 'count', 'ids', 'gap', 'normal', 'force', 'foot'),
    'mps_coupling_def_init': ('def', 'size'),
    'mps_coupling_create': ('context', 'const def', 'out'),
    'mps_coupling_destroy': ('coupling',),
    'mps_coupling_begin': ('coupling', 'const start', 'guess'),
    'mps_coupling_next': ('coupling', 'const answer', 'guess', 'done'),
    'mps_coupling_accept': ('coupling',),
    'mps_coupling_get_report_sized': ('const coupling', 'out', 'size'),
    'mps_coupling_get_memory': ('const coupling', 'capacity', 'values', 'count'),
    'mps_coupling_set_memory': ('coupling', 'count', 'const values'),
    'mps_particles_def_init': ('def', 'size'),
    'mps_particles_create': ('context', 'const def', 'out'),
    'mps_particles_destroy': ('particles',),
    'mps_particles_count': ('const particles',),
    'mps_particles_dim': ('const particles',),
    'mps_particles_spacing': ('const particles',),
    'mps_particles_epoch': ('const particles',),
    'mps_particles_append': ('particles', 'count', 'const positions'),
    'mps_particles_fill_box': ('particles', 'const lo', 'const hi', 'added'),
    'mps_particles_fill_polygon': ('particles', 'vertices', 'const xy', 'added'),
    'mps_particles_fill_ball': ('particles', 'const centre', 'radius', 'added'),
    'mps_particles_fill_where': ('particles', 'const lo', 'const hi', 'inside', 'user', 'added'),
    'mps_particles_remove': ('particles', 'count', 'const ids'),
    'mps_particles_add_field': ('particles', 'const name', 'components'),
    'mps_particles_view': ('particles', 'const name', 'out'),
    'mps_particles_edit': ('particles', 'const name', 'out'),
    'mps_particles_commit': ('particles', 'view'),
    'mps_particles_set': ('particles', 'const name', 'component', 'value'),
    'mps_particles_field_count': ('const particles',),
    'mps_particles_field_sized': ('const particles', 'index', 'out', 'size'),
    'mps_particles_select_box': ('particles', 'const lo', 'const hi', 'capacity', 'ids', 'count'),
    'mps_particles_index': ('const particles', 'id'),
    'mps_particles_nearest': ('const particles', 'const x'),
    'mps_recorder_def_init': ('def', 'size'),
    'mps_recorder_create': ('context', 'particles', 'const def', 'out'),
    'mps_recorder_write': ('recorder', 'time'),
    'mps_recorder_frames': ('const recorder',),
    'mps_recorder_close': ('recorder',),
    'mps_recorder_destroy': ('recorder',),
    'mps_checkpoint_init': ('info', 'size'),
    'mps_checkpoint_write': ('particles', 'const path', 'const info'),
    'mps_checkpoint_info': ('context', 'const path', 'info'),
    'mps_checkpoint_read': ('particles', 'const path', 'info'),
    'mps_dynamics_def_init': ('def', 'size'),
    'mps_dynamics_create': ('context', 'particles', 'const def', 'out'),
    'mps_dynamics_destroy': ('dynamics',),
    'mps_dynamics_get_def_sized': ('const dynamics', 'out', 'size'),
    'mps_dynamics_particles': ('const dynamics',),
    'mps_dynamics_context': ('const dynamics',),
    'mps_dynamics_pairs': ('const dynamics',),
    'mps_dynamics_boundary_def_init': ('def', 'size'),
    'mps_dynamics_add_boundary': ('dynamics', 'const def', 'number'),
    'mps_dynamics_set_boundary': ('dynamics', 'number', 'const def'),
    'mps_dynamics_remove_boundary': ('dynamics', 'number'),
    'mps_dynamics_get_reaction_sized': ('const dynamics', 'number', 'out', 'size'),
    'mps_dynamics_add_free_field': ('particles', 'side', 'gap'),
    'mps_dynamics_load_def_init': ('def', 'size'),
    'mps_dynamics_add_load': ('dynamics', 'const def', 'number'),
    'mps_dynamics_set_load': ('dynamics', 'number', 'const def'),
    'mps_dynamics_remove_load': ('dynamics', 'number'),
    'mps_dynamics_step': ('dynamics', 'count'),
    'mps_dynamics_run': ('dynamics', 't_end', 'every', 'callback', 'user'),
    'mps_dynamics_restart': ('dynamics', 'time'),
    'mps_dynamics_refresh': ('dynamics',),
    'mps_dynamics_snapshot': ('dynamics', 'snapshot'),
    'mps_dynamics_rollback': ('dynamics', 'const snapshot'),
    'mps_dynamics_save': ('dynamics', 'const path', 'const info'),
    'mps_dynamics_restore': ('dynamics', 'const path', 'info'),
    'mps_dynamics_time': ('const dynamics',),
    'mps_dynamics_steps': ('const dynamics',),
    'mps_dynamics_dt': ('dynamics',),
    'mps_dynamics_set_dt': ('dynamics', 'dt'),
    'mps_dynamics_get_totals_sized': ('dynamics', 'out', 'size'),
    'mps_dynamics_limit': ('const dynamics',),
    'mps_dynamics_find_limit_sized': ('dynamics', 'duration', 'out', 'size'),
    'mps_dynamics_predict_def_init': ('def', 'size'),
    'mps_dynamics_predict_sized': ('context', 'const def', 'out', 'size'),
    'mps_elastic_def_init': ('def', 'size'),
    'mps_elastic_create': ('context', 'particles', 'const def', 'out'),
    'mps_elastic_destroy': ('elastic',),
    'mps_elastic_get_def_sized': ('const elastic', 'out', 'size'),
    'mps_elastic_particles': ('const elastic',),
    'mps_elastic_context': ('const elastic',),
    'mps_elastic_update_material': ('elastic',),
    'mps_elastic_cut': ('elastic', 'axis', 'side', 'count', 'const ids'),
    'mps_elastic_boundary_def_init': ('def', 'size'),
    'mps_elastic_add_boundary': ('elastic', 'const def', 'number'),
    'mps_elastic_set_boundary': ('elastic', 'number', 'const def'),
    'mps_elastic_remove_boundary': ('elastic', 'number'),
    'mps_elastic_get_reaction_sized': ('elastic', 'number', 'out', 'size'),
    'mps_elastic_facet_count': ('const elastic',),
    'mps_elastic_select_facets': ('const elastic', 'axis', 'side', 'const lo', 'const hi', 'capacity', 'facets', 'count'),
    'mps_elastic_get_facets_sized': ('elastic', 'count', 'const facets', 'const arrays', 'size'),
    'mps_elastic_load_def_init': ('def', 'size'),
    'mps_elastic_add_load': ('elastic', 'const def', 'number'),
    'mps_elastic_set_load': ('elastic', 'number', 'const def'),
    'mps_elastic_remove_load': ('elastic', 'number'),
    'mps_elastic_load_resultant': ('elastic', 'const about', 'force', 'moment'),
    'mps_elastic_analyse_sized': ('elastic', 'out', 'size'),
    'mps_elastic_solve': ('elastic',),
    'mps_elastic_solve_cases': ('elastic', 'count', 'const loads', 'displacements'),
    'mps_elastic_get_report_sized': ('const elastic', 'out', 'size'),
    'mps_elastic_stress': ('elastic',),
    'mps_elastic_section': ('elastic', 'axis', 'position', 'const about', 'force', 'moment'),
    'mps_elastic_energy': ('elastic', 'strain', 'stabilising'),
    'mps_elastic_get_totals_sized': ('elastic', 'out', 'size'),
    'mps_elastic_motion_def_init': ('def', 'size'),
    'mps_elastic_start': ('elastic', 'const def'),
    'mps_elastic_step': ('elastic', 'count'),
    'mps_elastic_run': ('elastic', 't_end', 'every', 'callback', 'user'),
    'mps_elastic_time': ('const elastic',),
    'mps_elastic_steps': ('const elastic',),
    'mps_elastic_dt': ('const elastic',),
    'mps_elastic_limit': ('const elastic',),
    'mps_elastic_set_dt': ('elastic', 'dt'),
    'mps_elastic_snapshot': ('elastic', 'snapshot'),
    'mps_elastic_rollback': ('elastic', 'const snapshot'),
    'mps_elastic_save': ('elastic', 'const path', 'const info'),
    'mps_elastic_restore': ('elastic', 'const path', 'info'),
    'mps_elastic_modes': ('elastic', 'count', 'omega', 'shapes'),
    'mps_fluid_def_init': ('def', 'size'),
    'mps_fluid_create': ('context', 'particles', 'const def', 'out'),
    'mps_fluid_destroy': ('fluid',),
    'mps_fluid_boundary_def_init': ('def', 'size'),
    'mps_fluid_add_boundary': ('fluid', 'const def', 'number'),
    'mps_fluid_remove_boundary': ('fluid', 'number'),
    'mps_fluid_set_wall_motion': ('fluid', 'number', 'const displacement', 'const velocity'),
    'mps_fluid_get_reaction_sized': ('fluid', 'number', 'out', 'size'),
    'mps_fluid_get_wall': ('fluid', 'number', 'capacity', 'x', 'pressure', 'count'),
    'mps_fluid_get_pressure': ('fluid', 'number', 'count', 'const x', 'pressure'),
    'mps_fluid_get_levels': ('fluid', 'count', 'const station', 'level'),
    'mps_fluid_step': ('fluid', 'count'),
    'mps_fluid_begin_step': ('fluid', 'dt'),
    'mps_fluid_solve_pressure': ('fluid',),
    'mps_fluid_end_step': ('fluid',),
    'mps_fluid_abandon_step': ('fluid',),
    'mps_fluid_run': ('fluid', 't_end', 'every', 'callback', 'user'),
    'mps_fluid_time': ('const fluid',),
    'mps_fluid_steps': ('const fluid',),
    'mps_fluid_dt': ('const fluid',),
    'mps_fluid_limit': ('const fluid',),
    'mps_fluid_set_dt': ('fluid', 'dt'),
    'mps_fluid_particles': ('const fluid',),
    'mps_fluid_context': ('const fluid',),
    'mps_fluid_get_totals_sized': ('fluid', 'out', 'size'),
    'mps_fluid_get_report_sized': ('const fluid', 'out', 'size'),
    'mps_fluid_snapshot': ('fluid', 'snapshot'),
    'mps_fluid_rollback': ('fluid', 'const snapshot'),
    'mps_fluid_save': ('fluid', 'const path', 'const info'),
    'mps_fluid_restore': ('fluid', 'const path', 'info'),
    'mps_geostatic_def_init': ('def', 'size'),
    'mps_particles_set_geostatic': ('particles', 'const def'),
    'mps_particles_set_stress': ('particles', 'stress', 'user'),
    'mps_kernel_create': ('context', 'kind', 'radius', 'out'),
    'mps_kernel_destroy': ('kernel',),
    'mps_kernel_get_kind': ('const kernel',),
    'mps_kernel_radius': ('const kernel',),
    'mps_kernel_weight': ('const kernel', 'r'),
    'mps_kernel_derivative': ('const kernel', 'r'),
    'mps_kernel_moment': ('context', 'const kernel', 'dim', 'order', 'out'),
    'mps_kernel_density': ('context', 'const kernel', 'dim', 'spacing', 'out'),
    'mps_material_block_init': ('block', 'size'),
    'mps_material_linear_elastic': ('context', 'young', 'poisson', 'out'),
    'mps_material_neo_hookean': ('context', 'young', 'poisson', 'out'),
    'mps_von_mises_def_init': ('def', 'size'),
    'mps_drucker_prager_def_init': ('def', 'size'),
    'mps_mohr_coulomb_def_init': ('def', 'size'),
    'mps_newtonian_def_init': ('def', 'size'),
    'mps_user_law_def_init': ('def', 'size'),
    'mps_umat_def_init': ('def', 'size'),
    'mps_material_von_mises': ('context', 'const def', 'out'),
    'mps_material_drucker_prager': ('context', 'const def', 'out'),
    'mps_material_mohr_coulomb': ('context', 'const def', 'out'),
    'mps_material_newtonian': ('context', 'const def', 'out'),
    'mps_material_user': ('context', 'const def', 'out'),
    'mps_material_umat': ('context', 'const def', 'out'),
    'mps_material_destroy': ('material',),
    'mps_material_name': ('const material',),
    'mps_material_wave_modulus': ('const material',),
    'mps_material_needs_deformation': ('const material',),
    'mps_material_history_count': ('const material',),
    'mps_material_history_name': ('const material', 'index'),
    'mps_material_history_field': ('const material', 'index'),
    'mps_material_history_initial': ('const material', 'index'),
    'mps_moduli_from_elastic_sized': ('context', 'young', 'poisson', 'density', 'out', 'size'),
    'mps_moduli_from_velocities_sized': ('context', 'shear_velocity', 'pressure_velocity', 'density', 'out', 'size'),
    'mps_material_get_moduli_sized': ('const material', 'density', 'out', 'size'),
    'mps_particles_set_material': ('particles', 'const material', 'density', 'count', 'const ids'),
    'mps_material_update': ('context', 'const material', 'const block'),
    'mps_material_point_init': ('context', 'const material', 'point'),
    'mps_material_point_drive': ('context', 'const material', 'point', 'const gradient', 'duration', 'steps'),
    'mps_mpm_def_init': ('def', 'size'),
    'mps_mpm_create': ('context', 'particles', 'material', 'const def', 'out'),
    'mps_mpm_destroy': ('mpm',),
    'mps_mpm_set_material': ('mpm', 'material', 'count', 'const ids'),
    'mps_mpm_add_contact': ('mpm', 'body', 'const def', 'contact'),
    'mps_mpm_get_def_sized': ('mpm', 'out', 'size'),
    'mps_mpm_particles': ('const mpm',),
    'mps_mpm_context': ('const mpm',),
    'mps_mpm_boundary_def_init': ('def', 'size'),
    'mps_mpm_add_boundary': ('mpm', 'const def', 'number'),
    'mps_mpm_set_boundary': ('mpm', 'number', 'const def'),
    'mps_mpm_remove_boundary': ('mpm', 'number'),
    'mps_mpm_get_reaction_sized': ('mpm', 'number', 'out', 'size'),
    'mps_mpm_load_def_init': ('def', 'size'),
    'mps_mpm_add_load': ('mpm', 'const def', 'number'),
    'mps_mpm_set_load': ('mpm', 'number', 'const def'),
    'mps_mpm_remove_load': ('mpm', 'number'),
    'mps_mpm_step': ('mpm', 'count'),
    'mps_mpm_run': ('mpm', 't_end', 'every', 'callback', 'user'),
    'mps_mpm_time': ('const mpm',),
    'mps_mpm_steps': ('const mpm',),
    'mps_mpm_dt': ('const mpm',),
    'mps_mpm_limit': ('const mpm',),
    'mps_mpm_set_dt': ('mpm', 'dt'),
    'mps_mpm_get_totals': ('mpm', 'out'),
    'mps_mpm_snapshot': ('mpm', 'snapshot'),
    'mps_mpm_rollback': ('mpm', 'const snapshot'),
    'mps_mpm_save': ('mpm', 'const path', 'const info'),
    'mps_mpm_restore': ('mpm', 'const path', 'info'),
    'mps_neighbours_def_init': ('def', 'size'),
    'mps_neighbours_create': ('context', 'const def', 'out'),
    'mps_neighbours_destroy': ('neighbours',),
    'mps_neighbours_build': ('neighbours', 'const position'),
    'mps_neighbours_lists': ('const neighbours', 'count', 'const offsets', 'const indices'),
}
TEXT = r"""

typedef enum mps_status {
  MPS_OK = 0, MPS_ERROR_ARGUMENT = 1, MPS_ERROR_STATE = 2, MPS_ERROR_MEMORY = 3, MPS_ERROR_FIELD = 4, MPS_ERROR_IO = 5, MPS_ERROR_FORMAT = 6, MPS_ERROR_DIVERGED = 7, MPS_ERROR_CANCELLED = 8, MPS_ERROR_UNSUPPORTED = 9, MPS_ERROR_NUMERIC = 10, MPS_ERROR_INTERNAL = 11,
      MPS_STATUS_FORCE_32BIT = 0x7fffffff
} mps_status;
 const char *mps_status_text(mps_status status);
 const char *mps_version(void);
 int32_t mps_version_number(void);
enum {
  MPS_FEATURE_OPENMP = 1, MPS_FEATURE_HDF5 = 2, MPS_FEATURE_CHOLMOD = 3, MPS_FEATURE_ARPACK = 4, MPS_FEATURE_EMBREE = 5, MPS_FEATURE_PETSC = 6,
};
 int32_t mps_library_has(int32_t feature);
 const char *mps_library_feature_name(int32_t feature);
 int32_t mps_library_has_level(int32_t level);
typedef struct mps_dtype {
  uint8_t code;
  uint8_t bits;
  uint16_t lanes;
} mps_dtype;
typedef struct mps_view {
  void *data;
  int64_t shape[3];
  int64_t stride[3];
  mps_dtype dtype;
  uint32_t flags;
  uint64_t epoch;
  int32_t device_type;
  int32_t device_id;
} mps_view;




typedef struct mps_context mps_context;
typedef struct mps_error {
  mps_status status;
  int32_t reserved;
  int64_t step;
  int64_t particle;
  char message[512];
  char function[64];
  char object[64];
} mps_error;
typedef void *(*mps_alloc_fn)(void *user, size_t size, size_t alignment);
typedef void (*mps_free_fn)(void *user, void *memory);
typedef void (*mps_task_fn)(void *task, int64_t index, int32_t worker);
typedef void (*mps_parallel_for_fn)(void *user, int64_t count, mps_task_fn task, void *task_data);
typedef enum mps_executor_kind {
  MPS_EXECUTOR_SERIAL = 0,
  MPS_EXECUTOR_OPENMP = 1,
  MPS_EXECUTOR_CALLER = 2,
  MPS_EXECUTOR_THREADS = 3
} mps_executor_kind;
typedef enum mps_log_level {
  MPS_LOG_WARNING = 0,
  MPS_LOG_INFO = 1,
  MPS_LOG_DEBUG = 2
} mps_log_level;
typedef void (*mps_log_fn)(void *user, mps_log_level level, const char *message);
typedef struct mps_progress {
  const char *task;
  int64_t step;
  double time, time_end;
  double fraction;
} mps_progress;
typedef void (*mps_progress_fn)(void *user, const mps_progress *progress);
typedef int32_t (*mps_cancel_fn)(void *user);
typedef struct mps_context_def {
  uint32_t struct_size;
  int32_t executor;
  int32_t threads;
  int32_t instruction_level;
  mps_parallel_for_fn parallel_for;
  void *parallel_user;
  mps_alloc_fn alloc;
  mps_free_fn free;
  void *memory_user;
  mps_log_fn log;
  void *log_user;
  mps_progress_fn progress;
  void *progress_user;
  mps_cancel_fn cancel;
  void *cancel_user;
} mps_context_def;
 mps_status mps_context_def_init(mps_context_def *def, size_t size);

 mps_status mps_context_create(const mps_context_def *def, mps_context **out,
                                                    char *error_text, size_t error_size);
 void mps_context_destroy(mps_context **context);
 const mps_error *mps_context_error(const mps_context *context);
 void mps_context_clear_error(mps_context *context);
 void mps_context_set_log(mps_context *context, mps_log_fn log, void *user);
 void mps_context_set_progress(mps_context *context, mps_progress_fn progress, void *user);
 void mps_context_set_cancel(mps_context *context, mps_cancel_fn cancel, void *user);
 int32_t mps_context_instruction_level(const mps_context *context);
 int32_t mps_context_threads(const mps_context *context);
 mps_status mps_context_parallel_for(mps_context *context, int64_t count,
                                                          mps_task_fn task, void *data);


typedef struct mps_signal mps_signal;
typedef enum mps_signal_quantity {
  MPS_SIGNAL_DISPLACEMENT = 0,
  MPS_SIGNAL_VELOCITY = 1,
  MPS_SIGNAL_ACCELERATION = 2
} mps_signal_quantity;
typedef enum mps_signal_baseline {
  MPS_SIGNAL_BASELINE_NONE = 0,
  MPS_SIGNAL_BASELINE_MEAN = 1,
  MPS_SIGNAL_BASELINE_LINEAR = 2,
  MPS_SIGNAL_BASELINE_QUADRATIC = 3,
  MPS_SIGNAL_BASELINE_CUBIC = 4
} mps_signal_baseline;
 mps_status mps_signal_ricker(mps_context *context, double frequency,
                                                   double peak_time, double amplitude,
                                                   mps_signal **out);
 mps_status mps_signal_sine(mps_context *context, double frequency,
                                                 double amplitude, double phase, mps_signal **out);
 mps_status mps_signal_ramp(mps_context *context, double start,
                                                 double duration, double amplitude,
                                                 mps_signal **out);
 mps_status mps_signal_table(mps_context *context, int32_t quantity,
                                                  int64_t count, const double *times,
                                                  const double *values, mps_signal **out);
typedef mps_status (*mps_signal_fn)(void *user, double t, double motion[3]);
 mps_status mps_signal_user(mps_context *context, mps_signal_fn fn, void *user,
                                                 mps_signal **out);
typedef enum mps_signal_record_format {
  MPS_SIGNAL_RECORD_AUTO = 0,
  MPS_SIGNAL_RECORD_AT2 = 1,
  MPS_SIGNAL_RECORD_KNET = 2,
  MPS_SIGNAL_RECORD_CSV =
      3
} mps_signal_record_format;
typedef struct mps_signal_record_def {
  uint32_t struct_size;
  int32_t format;
  int32_t quantity;
  int32_t baseline;
  double scale;
  double taper;
} mps_signal_record_def;
 mps_status mps_signal_record_def_init(mps_signal_record_def *def, size_t size);

 mps_status mps_signal_record(mps_context *context, const char *path,
                                                   const mps_signal_record_def *def,
                                                   mps_signal **out);
 void mps_signal_destroy(mps_signal **signal);
 double mps_signal_displacement(const mps_signal *signal, double t);
 double mps_signal_velocity(const mps_signal *signal, double t);
 double mps_signal_acceleration(const mps_signal *signal, double t);
 void mps_signal_span(const mps_signal *signal, double *start, double *end);
 double mps_signal_peak_acceleration(const mps_signal *signal);


typedef struct mps_reaction {
  double force[3];
  double moment[3];
  double impulse[3];
  double moment_impulse[3];
  int64_t count;
  double work;
} mps_reaction;
typedef struct mps_totals {
  double mass, volume;
  double linear[3];
  double angular[3];
  double kinetic;
  double strain;
  double dissipated;
  double scheme;
  double work_loads;
  double work_boundaries;
  double work_bodies;
} mps_totals;
typedef struct mps_snapshot mps_snapshot;
 void mps_snapshot_destroy(mps_snapshot **snapshot);


typedef struct mps_body mps_body;
typedef enum mps_body_kind {
  MPS_BODY_MOTION_PRESCRIBED = 0,
  MPS_BODY_MOTION_FREE = 1
} mps_body_kind;
typedef struct mps_body_def {
  uint32_t struct_size;
  int32_t motion;
  double position[3];
  double rotation[3];
  double velocity[3];
  double spin[3];
  double mass;
  double inertia[3];
  double gravity[3];
  double damping[2];
} mps_body_def;
 mps_status mps_body_def_init(mps_body_def *def, size_t size);

 mps_status mps_body_create_polygon(mps_context *context,
                                                         const mps_body_def *def, int64_t vertices,
                                                         const double *xy, mps_body **out);
 mps_status mps_body_create_box(mps_context *context, const mps_body_def *def,
                                                     double width, double height, mps_body **out);
 mps_status mps_body_create_disc(mps_context *context, const mps_body_def *def,
                                                      double radius, mps_body **out);
 mps_status mps_body_create_half_plane(mps_context *context,
                                                            const mps_body_def *def,
                                                            const double *normal, mps_body **out);
 mps_status mps_body_create_sphere(mps_context *context,
                                                        const mps_body_def *def, double radius,
                                                        mps_body **out);
 mps_status mps_body_create_half_space(mps_context *context,
                                                            const mps_body_def *def,
                                                            const double *normal, mps_body **out);
 mps_status mps_body_create_cylinder(mps_context *context,
                                                          const mps_body_def *def, double radius,
                                                          double length, mps_body **out);
 mps_status mps_body_create_revolution(mps_context *context,
                                                            const mps_body_def *def,
                                                            int64_t vertices, const double *rz,
                                                            mps_body **out);
 mps_status mps_body_create_mesh(mps_context *context, const mps_body_def *def,
                                                      int64_t vertices, const double *xyz,
                                                      int64_t triangles, const int32_t *corner,
                                                      mps_body **out);
 mps_status mps_body_create_stl(mps_context *context, const mps_body_def *def,
                                                     const char *path, double scale,
                                                     mps_body **out);
 void mps_body_destroy(mps_body **body);
 int32_t mps_body_dim(const mps_body *body);
 mps_status mps_body_drive(mps_body *body, int32_t component,
                                                mps_signal *signal, double factor);
typedef struct mps_body_motion {
  uint32_t struct_size;
  int32_t reserved;
  double position[3];
  double rotation[3];
  double velocity[3];
  double spin[3];
} mps_body_motion;
 mps_status mps_body_motion_init(mps_body_motion *motion, size_t size);

 mps_status mps_body_set_motion(mps_body *body, const mps_body_motion *motion);
 mps_status mps_body_load(mps_body *body, const double *force,
                                               const double *moment);
 mps_status mps_body_advance(mps_body *body, double dt);
typedef struct mps_body_state {
  double time;
  double position[3];
  double rotation[3];
  double orientation[9];
  double velocity[3];
  double spin[3];
} mps_body_state;
 mps_status mps_body_get_state_sized(mps_body *body, mps_body_state *out,
                                                          size_t size);

typedef struct mps_body_totals {
  double mass;
  double linear[3];
  double angular[3];
  double kinetic;
  double work_contacts;
  double work_loads;
  double dissipated;
} mps_body_totals;
 mps_status mps_body_get_totals_sized(mps_body *body, mps_body_totals *out,
                                                           size_t size);

 mps_status mps_body_distance(mps_body *body, int64_t count, const double *x,
                                                   double *distance, double *normal, double *foot,
                                                   int64_t *face);
 mps_status mps_body_name_part(mps_body *body, const char *name, int64_t first,
                                                    int64_t count, int32_t *part);
 int32_t mps_body_part_count(const mps_body *body);
 int32_t mps_body_part(const mps_body *body, const char *name);
 mps_status mps_body_get_reaction_sized(mps_body *body, int32_t part,
                                                             mps_reaction *out, size_t size);



typedef struct mps_contact mps_contact;
typedef enum mps_contact_mover {
  MPS_CONTACT_MOVER_SOLVER = 0,
  MPS_CONTACT_MOVER_OTHER = 1
} mps_contact_mover;
typedef enum mps_contact_inside {
  MPS_CONTACT_INSIDE_REFUSE = 0,
  MPS_CONTACT_INSIDE_PUSH = 1
} mps_contact_inside;
typedef struct mps_contact_def {
  uint32_t struct_size;
  int32_t mover;
  double friction;
  double penalty;
  double xi;
  double offset;
  double depth;
  int32_t thin;
  int32_t inside;
} mps_contact_def;
 mps_status mps_contact_def_init(mps_contact_def *def, size_t size);

 void mps_contact_destroy(mps_contact **contact);
 mps_body *mps_contact_body(const mps_contact *contact);
 mps_status mps_contact_get_reaction_sized(mps_contact *contact, int32_t part,
                                                                mps_reaction *out, size_t size);

 mps_status mps_contact_get_particles(mps_contact *contact, int64_t capacity,
                                                           int64_t *count, int64_t *ids,
                                                           double *gap, double *normal,
                                                           double *force, double *foot);


typedef struct mps_coupling mps_coupling;
typedef enum mps_coupling_method {
  MPS_COUPLING_QUASI_NEWTON = 0,
  MPS_COUPLING_AITKEN = 1,
  MPS_COUPLING_CONSTANT = 2
} mps_coupling_method;
typedef struct mps_coupling_def {
  uint32_t struct_size;
  int32_t method;
  int64_t size;
  double relaxation;
  double tolerance;
  double floor;
  double filter;
  int32_t repeats;
  int32_t reuse;
  int32_t columns;
  int32_t order;
} mps_coupling_def;
 mps_status mps_coupling_def_init(mps_coupling_def *def, size_t size);

 mps_status mps_coupling_create(mps_context *context,
                                                     const mps_coupling_def *def,
                                                     mps_coupling **out);
 void mps_coupling_destroy(mps_coupling **coupling);
 mps_status mps_coupling_begin(mps_coupling *coupling, const double *start,
                                                    double *guess);
 mps_status mps_coupling_next(mps_coupling *coupling, const double *answer,
                                                   double *guess, int32_t *done);
 mps_status mps_coupling_accept(mps_coupling *coupling);
typedef struct mps_coupling_report {
  int64_t steps;
  int64_t all_repeats;
  int32_t repeats;
  int32_t columns;
  double residual;
} mps_coupling_report;
 mps_status mps_coupling_get_report_sized(const mps_coupling *coupling,
                                                               mps_coupling_report *out,
                                                               size_t size);

 mps_status mps_coupling_get_memory(const mps_coupling *coupling,
                                                         int64_t capacity, double *values,
                                                         int64_t *count);
 mps_status mps_coupling_set_memory(mps_coupling *coupling, int64_t count,
                                                         const double *values);


typedef struct mps_particles mps_particles;
typedef struct mps_particles_def {
  uint32_t struct_size;
  int32_t dim;
  double spacing;
  double origin[3];
} mps_particles_def;
 mps_status mps_particles_def_init(mps_particles_def *def, size_t size);

 mps_status mps_particles_create(mps_context *context,
                                                      const mps_particles_def *def,
                                                      mps_particles **out);
 void mps_particles_destroy(mps_particles **particles);
 int64_t mps_particles_count(const mps_particles *particles);
 int32_t mps_particles_dim(const mps_particles *particles);
 double mps_particles_spacing(const mps_particles *particles);
 uint64_t mps_particles_epoch(const mps_particles *particles);
 mps_status mps_particles_append(mps_particles *particles, int64_t count,
                                                      const double *positions);
 mps_status mps_particles_fill_box(mps_particles *particles, const double *lo,
                                                        const double *hi, int64_t *added);
 mps_status mps_particles_fill_polygon(mps_particles *particles,
                                                            int64_t vertices, const double *xy,
                                                            int64_t *added);
 mps_status mps_particles_fill_ball(mps_particles *particles,
                                                         const double *centre, double radius,
                                                         int64_t *added);
typedef int32_t (*mps_predicate_fn)(void *user, const double *x);
 mps_status mps_particles_fill_where(mps_particles *particles,
                                                          const double *lo, const double *hi,
                                                          mps_predicate_fn inside, void *user,
                                                          int64_t *added);
 mps_status mps_particles_remove(mps_particles *particles, int64_t count,
                                                      const int64_t *ids);
typedef struct mps_field_info {
  const char *name;
  const char *unit;
  const char *meaning;
  mps_dtype dtype;
  int32_t components;
  uint32_t flags;
} mps_field_info;
 mps_status mps_particles_add_field(mps_particles *particles, const char *name,
                                                         int32_t components);
 mps_status mps_particles_view(mps_particles *particles, const char *name,
                                                    mps_view *out);
 mps_status mps_particles_edit(mps_particles *particles, const char *name,
                                                    mps_view *out);
 mps_status mps_particles_commit(mps_particles *particles, mps_view *view);
 mps_status mps_particles_set(mps_particles *particles, const char *name,
                                                   int32_t component, double value);
 int32_t mps_particles_field_count(const mps_particles *particles);
 mps_status mps_particles_field_sized(const mps_particles *particles,
                                                           int32_t index, mps_field_info *out,
                                                           size_t size);
 
 mps_status mps_particles_select_box(mps_particles *particles,
                                                          const double *lo, const double *hi,
                                                          int64_t capacity, int64_t *ids,
                                                          int64_t *count);
 int64_t mps_particles_index(const mps_particles *particles, int64_t id);
 int64_t mps_particles_nearest(const mps_particles *particles, const double *x);


typedef struct mps_recorder mps_recorder;
typedef struct mps_recorder_def {
  uint32_t struct_size;
  int32_t compression;
  const char *path;
  const char *const *fields;
  int64_t field_count;
} mps_recorder_def;
 mps_status mps_recorder_def_init(mps_recorder_def *def, size_t size);

 mps_status mps_recorder_create(mps_context *context, mps_particles *particles,
                                                     const mps_recorder_def *def,
                                                     mps_recorder **out);
 mps_status mps_recorder_write(mps_recorder *recorder, double time);
 int64_t mps_recorder_frames(const mps_recorder *recorder);
 mps_status mps_recorder_close(mps_recorder **recorder);
 void mps_recorder_destroy(mps_recorder **recorder);
typedef struct mps_checkpoint {
  uint32_t struct_size;
  int32_t reserved;
  double time;
  int64_t step;
  double dt;
  char user_key[64];
  void *user_data;
  int64_t user_bytes;
} mps_checkpoint;
 mps_status mps_checkpoint_init(mps_checkpoint *info, size_t size);

 mps_status mps_checkpoint_write(mps_particles *particles, const char *path,
                                                      const mps_checkpoint *info);
 mps_status mps_checkpoint_info(mps_context *context, const char *path,
                                                     mps_checkpoint *info);
 mps_status mps_checkpoint_read(mps_particles *particles, const char *path,
                                                     mps_checkpoint *info);


typedef struct mps_dynamics mps_dynamics;
typedef enum mps_dynamics_integrator {
  MPS_DYNAMICS_INTEGRATOR_VERLET = 0,
  MPS_DYNAMICS_INTEGRATOR_LEAPFROG = 1,
  MPS_DYNAMICS_INTEGRATOR_EULER = 2
} mps_dynamics_integrator;
typedef enum mps_dynamics_rotation {
  MPS_DYNAMICS_ROTATION_MEAN_MATRIX = 0,
  MPS_DYNAMICS_ROTATION_MEAN_ANGLE = 1
} mps_dynamics_rotation;
typedef enum mps_dynamics_damping {
  MPS_DYNAMICS_DAMPING_PAIR = 0,
  MPS_DYNAMICS_DAMPING_PARTICLE = 1
} mps_dynamics_damping;
typedef struct mps_dynamics_def {
  uint32_t struct_size;
  int32_t integrator;
  int32_t rotation;
  int32_t damping;
  double dt;
  double courant;
  double radius_ratio;
  double f1, f2;
  double period_x;
  double divergence;
  double measure;
  int32_t watch_damping;
  int32_t reserved;
} mps_dynamics_def;
 mps_status mps_dynamics_def_init(mps_dynamics_def *def, size_t size);

 mps_status mps_dynamics_create(mps_context *context, mps_particles *particles,
                                                     const mps_dynamics_def *def,
                                                     mps_dynamics **out);
 void mps_dynamics_destroy(mps_dynamics **dynamics);
 mps_status mps_dynamics_get_def_sized(const mps_dynamics *dynamics, mps_dynamics_def *out,
                                              size_t size);

 mps_particles *mps_dynamics_particles(const mps_dynamics *dynamics);
 mps_context *mps_dynamics_context(const mps_dynamics *dynamics);
 int64_t mps_dynamics_pairs(const mps_dynamics *dynamics);
typedef enum mps_dynamics_boundary_kind {
  MPS_DYNAMICS_BOUNDARY_HELD = 0,
  MPS_DYNAMICS_BOUNDARY_DRIVEN = 1,
  MPS_DYNAMICS_BOUNDARY_VISCOUS = 2
} mps_dynamics_boundary_kind;
typedef struct mps_dynamics_boundary_def {
  uint32_t struct_size;
  int32_t kind;
  const int64_t *ids;
  int64_t id_count;
  double lower[3], upper[3];
  uint32_t dofs;
  int32_t normal;
  mps_signal *signal[3];
  double factor[3];
  double density, shear_velocity, pressure_velocity;
} mps_dynamics_boundary_def;
 mps_status mps_dynamics_boundary_def_init(mps_dynamics_boundary_def *def, size_t size);

 mps_status mps_dynamics_add_boundary(mps_dynamics *dynamics,
                                                           const mps_dynamics_boundary_def *def,
                                                           int32_t *number);
 mps_status mps_dynamics_set_boundary(mps_dynamics *dynamics, int32_t number,
                                                           const mps_dynamics_boundary_def *def);
 mps_status mps_dynamics_remove_boundary(mps_dynamics *dynamics,
                                                              int32_t number);
 mps_status mps_dynamics_get_reaction_sized(const mps_dynamics *dynamics,
                                                                 int32_t number, mps_reaction *out,
                                                                 size_t size);

typedef enum mps_dynamics_side {
  MPS_DYNAMICS_SIDE_LEFT = 1,
  MPS_DYNAMICS_SIDE_RIGHT = 2
} mps_dynamics_side;
 mps_status mps_dynamics_add_free_field(mps_particles *particles, int32_t side,
                                                             int32_t gap);
typedef enum mps_dynamics_load_kind {
  MPS_DYNAMICS_LOAD_TRACTION = 0,
  MPS_DYNAMICS_LOAD_BODY = 1
} mps_dynamics_load_kind;
typedef struct mps_dynamics_load_def {
  uint32_t struct_size;
  int32_t kind;
  const int64_t *ids;
  int64_t id_count;
  double lower[3], upper[3];
  double traction[3];
  double acceleration[3];
  double area;
  mps_signal *signal[3];
  double factor[3];
} mps_dynamics_load_def;
 mps_status mps_dynamics_load_def_init(mps_dynamics_load_def *def, size_t size);

 mps_status mps_dynamics_add_load(mps_dynamics *dynamics,
                                                       const mps_dynamics_load_def *def,
                                                       int32_t *number);
 mps_status mps_dynamics_set_load(mps_dynamics *dynamics, int32_t number,
                                                       const mps_dynamics_load_def *def);
 mps_status mps_dynamics_remove_load(mps_dynamics *dynamics, int32_t number);
 mps_status mps_dynamics_step(mps_dynamics *dynamics, int64_t count);
typedef mps_status (*mps_dynamics_fn)(void *user, mps_dynamics *dynamics);
 mps_status mps_dynamics_run(mps_dynamics *dynamics, double t_end,
                                                  int64_t every, mps_dynamics_fn callback,
                                                  void *user);
 mps_status mps_dynamics_restart(mps_dynamics *dynamics, double time);
 mps_status mps_dynamics_refresh(mps_dynamics *dynamics);
 mps_status mps_dynamics_snapshot(mps_dynamics *dynamics,
                                                       mps_snapshot **snapshot);
 mps_status mps_dynamics_rollback(mps_dynamics *dynamics,
                                                       const mps_snapshot *snapshot);
 mps_status mps_dynamics_save(mps_dynamics *dynamics, const char *path,
                                                   const mps_checkpoint *info);
 mps_status mps_dynamics_restore(mps_dynamics *dynamics, const char *path,
                                                      mps_checkpoint *info);
 double mps_dynamics_time(const mps_dynamics *dynamics);
 int64_t mps_dynamics_steps(const mps_dynamics *dynamics);
 double mps_dynamics_dt(mps_dynamics *dynamics);
 mps_status mps_dynamics_set_dt(mps_dynamics *dynamics, double dt);
 mps_status mps_dynamics_get_totals_sized(mps_dynamics *dynamics,
                                                               mps_totals *out, size_t size);

 double mps_dynamics_limit(const mps_dynamics *dynamics);
typedef struct mps_dynamics_linear_limit {
  double dt;
  double omega;
  double residual;
  int64_t iterations;
} mps_dynamics_linear_limit;
 mps_status mps_dynamics_find_limit_sized(mps_dynamics *dynamics,
                                                               double duration,
                                                               mps_dynamics_linear_limit *out,
                                                               size_t size);

typedef struct mps_dynamics_predict_def {
  uint32_t struct_size;
  int32_t integrator;
  double spacing;
  double shear_velocity, pressure_velocity;
  double damping;
  double f1, f2;
  double radius_ratio;
} mps_dynamics_predict_def;
 mps_status mps_dynamics_predict_def_init(mps_dynamics_predict_def *def, size_t size);

typedef struct mps_dynamics_prediction {
  double dt;
  double omega;
} mps_dynamics_prediction;
 mps_status mps_dynamics_predict_sized(mps_context *context,
                                                            const mps_dynamics_predict_def *def,
                                                            mps_dynamics_prediction *out,
                                                            size_t size);



typedef struct mps_elastic mps_elastic;
typedef enum mps_elastic_state {
  MPS_ELASTIC_PLANE_STRESS = 0,
  MPS_ELASTIC_PLANE_STRAIN = 1
} mps_elastic_state;
typedef enum mps_elastic_solver {
  MPS_ELASTIC_AUTO = 0,
  MPS_ELASTIC_LLT = 1,
  MPS_ELASTIC_LDLT = 2,
  MPS_ELASTIC_CG = 3
} mps_elastic_solver;
typedef enum mps_elastic_ordering {
  MPS_ELASTIC_ORDER_BEST = 0,
  MPS_ELASTIC_ORDER_AMD = 1,
  MPS_ELASTIC_ORDER_METIS = 2
} mps_elastic_ordering;
typedef struct mps_elastic_def {
  uint32_t struct_size;
  int32_t state;
  int32_t solver;
  int32_t ordering;
  double radius_ratio;
  double alpha;
  double measure;
  double memory_limit;
  double tolerance;
  int64_t iterations;
  int32_t refinements;
  int32_t blas_threads;
} mps_elastic_def;
 mps_status mps_elastic_def_init(mps_elastic_def *def, size_t size);

 mps_status mps_elastic_create(mps_context *context, mps_particles *particles,
                                                    const mps_elastic_def *def, mps_elastic **out);
 void mps_elastic_destroy(mps_elastic **elastic);
 mps_status mps_elastic_get_def_sized(const mps_elastic *elastic,
                                                           mps_elastic_def *out, size_t size);

 mps_particles *mps_elastic_particles(const mps_elastic *elastic);
 mps_context *mps_elastic_context(const mps_elastic *elastic);
 mps_status mps_elastic_update_material(mps_elastic *elastic);
 mps_status mps_elastic_cut(mps_elastic *elastic, int32_t axis, int32_t side,
                                                 int64_t count, const int64_t *ids);
typedef enum mps_elastic_boundary_kind {
  MPS_ELASTIC_BOUNDARY_PRESCRIBED = 0,
  MPS_ELASTIC_BOUNDARY_ROLLER = 1
} mps_elastic_boundary_kind;
typedef struct mps_elastic_boundary_def {
  uint32_t struct_size;
  int32_t kind;
  const int64_t *ids;
  int64_t id_count;
  double lower[3], upper[3];
  uint32_t dofs;
  int32_t reserved;
  double normal[3];
  const double *values;
  mps_signal *signal[3];
  double factor[3];
} mps_elastic_boundary_def;
 mps_status mps_elastic_boundary_def_init(mps_elastic_boundary_def *def, size_t size);

 mps_status mps_elastic_add_boundary(mps_elastic *elastic,
                                                          const mps_elastic_boundary_def *def,
                                                          int32_t *number);
 mps_status mps_elastic_set_boundary(mps_elastic *elastic, int32_t number,
                                                          const mps_elastic_boundary_def *def);
 mps_status mps_elastic_remove_boundary(mps_elastic *elastic, int32_t number);
 mps_status mps_elastic_get_reaction_sized(mps_elastic *elastic,
                                                                int32_t number, mps_reaction *out,
                                                                size_t size);

 int64_t mps_elastic_facet_count(const mps_elastic *elastic);
 mps_status mps_elastic_select_facets(const mps_elastic *elastic, int32_t axis,
                                                           int32_t side, const double *lo,
                                                           const double *hi, int64_t capacity,
                                                           int64_t *facets, int64_t *count);
typedef struct mps_elastic_facet_arrays {
  int64_t *particle;
  double *centre;
  double *normal;
  double *extent;
  double *area;
  double *displacement;
  double *velocity;
} mps_elastic_facet_arrays;
 mps_status
mps_elastic_get_facets_sized(mps_elastic *elastic, int64_t count, const int64_t *facets,
                             const mps_elastic_facet_arrays *arrays, size_t size);

typedef enum mps_elastic_load_kind {
  MPS_ELASTIC_LOAD_BODY = 0,
  MPS_ELASTIC_LOAD_GRAVITY = 1,
  MPS_ELASTIC_LOAD_FORCE = 2,
  MPS_ELASTIC_LOAD_TRACTION = 3,
  MPS_ELASTIC_LOAD_PRESSURE = 4,
  MPS_ELASTIC_LOAD_FUNCTION = 5
} mps_elastic_load_kind;
typedef mps_status (*mps_traction_fn)(void *user, const double *x, const double *normal,
                                      double *traction);
typedef struct mps_elastic_load_def {
  uint32_t struct_size;
  int32_t kind;
  const int64_t *ids;
  int64_t id_count;
  const double *values;
  double force[3];
  mps_traction_fn function;
  void *user;
  mps_signal *signal[3];
  double factor[3];
} mps_elastic_load_def;
 mps_status mps_elastic_load_def_init(mps_elastic_load_def *def, size_t size);

 mps_status mps_elastic_add_load(mps_elastic *elastic,
                                                      const mps_elastic_load_def *def,
                                                      int32_t *number);
 mps_status mps_elastic_set_load(mps_elastic *elastic, int32_t number,
                                                      const mps_elastic_load_def *def);
 mps_status mps_elastic_remove_load(mps_elastic *elastic, int32_t number);
 mps_status mps_elastic_load_resultant(mps_elastic *elastic,
                                                            const double *about, double *force,
                                                            double *moment);
typedef struct mps_elastic_estimate {
  int64_t unknowns, matrix_nonzeros;
  int64_t factor_nonzeros;
  double factor_flops, factor_bytes;
  int32_t ordering, solver;
} mps_elastic_estimate;
 mps_status mps_elastic_analyse_sized(mps_elastic *elastic,
                                                           mps_elastic_estimate *out, size_t size);

 mps_status mps_elastic_solve(mps_elastic *elastic);
 mps_status mps_elastic_solve_cases(mps_elastic *elastic, int64_t count,
                                                         const double *loads,
                                                         double *displacements);
typedef struct mps_elastic_report {
  int64_t unknowns, matrix_nonzeros, factor_nonzeros;
  double factor_flops;
  double factor_bytes;
  double peak_bytes;
  double residual;
  double condition;
  double seconds_assemble, seconds_analyse, seconds_factor, seconds_solve;
  int64_t analyses, factorisations;
  int64_t iterations;
  int32_t solver, ordering;
} mps_elastic_report;
 mps_status mps_elastic_get_report_sized(const mps_elastic *elastic,
                                                              mps_elastic_report *out, size_t size);

 mps_status mps_elastic_stress(mps_elastic *elastic);
 mps_status mps_elastic_section(mps_elastic *elastic, int32_t axis,
                                                     double position, const double *about,
                                                     double *force, double *moment);
 mps_status mps_elastic_energy(mps_elastic *elastic, double *strain,
                                                    double *stabilising);
 mps_status mps_elastic_get_totals_sized(mps_elastic *elastic, mps_totals *out,
                                                              size_t size);

typedef struct mps_elastic_motion_def {
  uint32_t struct_size;
  int32_t reserved;
  double dt;
  double rho_inf;
  double beta, gamma;
  double mass_damping;
  double stiffness_damping;
  double ratio[2];
  double frequency[2];
} mps_elastic_motion_def;
 mps_status mps_elastic_motion_def_init(mps_elastic_motion_def *def, size_t size);

 mps_status mps_elastic_start(mps_elastic *elastic,
                                                   const mps_elastic_motion_def *def);
 mps_status mps_elastic_step(mps_elastic *elastic, int64_t count);
typedef mps_status (*mps_elastic_fn)(void *user, mps_elastic *elastic);
 mps_status mps_elastic_run(mps_elastic *elastic, double t_end, int64_t every,
                                                 mps_elastic_fn callback, void *user);
 double mps_elastic_time(const mps_elastic *elastic);
 int64_t mps_elastic_steps(const mps_elastic *elastic);
 double mps_elastic_dt(const mps_elastic *elastic);
 double mps_elastic_limit(const mps_elastic *elastic);
 mps_status mps_elastic_set_dt(mps_elastic *elastic, double dt);
 mps_status mps_elastic_snapshot(mps_elastic *elastic,
                                                      mps_snapshot **snapshot);
 mps_status mps_elastic_rollback(mps_elastic *elastic,
                                                      const mps_snapshot *snapshot);
 mps_status mps_elastic_save(mps_elastic *elastic, const char *path,
                                                  const mps_checkpoint *info);
 mps_status mps_elastic_restore(mps_elastic *elastic, const char *path,
                                                     mps_checkpoint *info);
 mps_status mps_elastic_modes(mps_elastic *elastic, int32_t count,
                                                   double *omega, double *shapes);


typedef struct mps_fluid mps_fluid;
typedef struct mps_fluid_def {
  uint32_t struct_size;
  int32_t iterations;
  double density;
  double viscosity;
  double gravity[3];
  double level;
  double measure;
  double dt;
  double radius_ratio;
  double tolerance;
} mps_fluid_def;
 mps_status mps_fluid_def_init(mps_fluid_def *def, size_t size);

 mps_status mps_fluid_create(mps_context *context, mps_particles *particles,
                                                  const mps_fluid_def *def, mps_fluid **out);
 void mps_fluid_destroy(mps_fluid **fluid);
typedef enum mps_fluid_boundary_kind {
  MPS_FLUID_BOUNDARY_SLIP = 0
} mps_fluid_boundary_kind;
typedef struct mps_fluid_boundary_def {
  uint32_t struct_size;
  int32_t kind;
  double point[3];
  double normal[3];
  mps_signal *signal;
  double factor;
  const double *nodes;
  int64_t node_count;
} mps_fluid_boundary_def;
 mps_status mps_fluid_boundary_def_init(mps_fluid_boundary_def *def, size_t size);

 mps_status mps_fluid_add_boundary(mps_fluid *fluid,
                                                        const mps_fluid_boundary_def *def,
                                                        int32_t *number);
 mps_status mps_fluid_remove_boundary(mps_fluid *fluid, int32_t number);
 mps_status mps_fluid_set_wall_motion(mps_fluid *fluid, int32_t number,
                                                           const double *displacement,
                                                           const double *velocity);
 mps_status mps_fluid_get_reaction_sized(mps_fluid *fluid, int32_t number,
                                                              mps_reaction *out, size_t size);

 mps_status mps_fluid_get_wall(mps_fluid *fluid, int32_t number,
                                                    int64_t capacity, double *x, double *pressure,
                                                    int64_t *count);
 mps_status mps_fluid_get_pressure(mps_fluid *fluid, int32_t number,
                                                        int64_t count, const double *x,
                                                        double *pressure);
 mps_status mps_fluid_get_levels(mps_fluid *fluid, int64_t count,
                                                      const double *station, double *level);
 mps_status mps_fluid_step(mps_fluid *fluid, int64_t count);
 mps_status mps_fluid_begin_step(mps_fluid *fluid, double dt);
 mps_status mps_fluid_solve_pressure(mps_fluid *fluid);
 mps_status mps_fluid_end_step(mps_fluid *fluid);
 mps_status mps_fluid_abandon_step(mps_fluid *fluid);
typedef mps_status (*mps_fluid_fn)(void *user, mps_fluid *fluid);
 mps_status mps_fluid_run(mps_fluid *fluid, double t_end, int64_t every,
                                               mps_fluid_fn callback, void *user);
 double mps_fluid_time(const mps_fluid *fluid);
 int64_t mps_fluid_steps(const mps_fluid *fluid);
 double mps_fluid_dt(const mps_fluid *fluid);
 double mps_fluid_limit(const mps_fluid *fluid);
 mps_status mps_fluid_set_dt(mps_fluid *fluid, double dt);
 mps_particles *mps_fluid_particles(const mps_fluid *fluid);
 mps_context *mps_fluid_context(const mps_fluid *fluid);
 mps_status mps_fluid_get_totals_sized(mps_fluid *fluid, mps_totals *out,
                                                            size_t size);

typedef struct mps_fluid_report {
  int64_t ghosts, pairs;
  int64_t surface, apart;
  int64_t iterations;
  int64_t all_iterations;
  int64_t collisions;
  int64_t limited;
  int64_t pushed;
  int64_t bytes;
} mps_fluid_report;
 mps_status mps_fluid_get_report_sized(const mps_fluid *fluid,
                                                            mps_fluid_report *out, size_t size);

 mps_status mps_fluid_snapshot(mps_fluid *fluid, mps_snapshot **snapshot);
 mps_status mps_fluid_rollback(mps_fluid *fluid, const mps_snapshot *snapshot);
 mps_status mps_fluid_save(mps_fluid *fluid, const char *path,
                                                const mps_checkpoint *info);
 mps_status mps_fluid_restore(mps_fluid *fluid, const char *path,
                                                   mps_checkpoint *info);


typedef struct mps_soil_layer {
  double thickness;
  double k0;
  double density;
} mps_soil_layer;
typedef mps_status (*mps_level_fn)(void *user, const double *x, double *level);
typedef struct mps_geostatic_def {
  uint32_t struct_size;
  int32_t layer_count;
  const mps_soil_layer *layers;
  double gravity;
  double surcharge;
  int32_t vertical;
  int32_t surface_points;
  double surface;
  const double *surface_line;
  mps_level_fn surface_level;
  void *user;
} mps_geostatic_def;
 mps_status mps_geostatic_def_init(mps_geostatic_def *def, size_t size);

 mps_status mps_particles_set_geostatic(mps_particles *particles,
                                                             const mps_geostatic_def *def);
typedef mps_status (*mps_stress_fn)(void *user, const double *x, double *stress);
 mps_status mps_particles_set_stress(mps_particles *particles,
                                                          mps_stress_fn stress, void *user);


typedef struct mps_kernel mps_kernel;
typedef enum mps_kernel_kind {
  MPS_KERNEL_MPS = 0,
  MPS_KERNEL_SPLINE2 = 1,
  MPS_KERNEL_SPLINE3 = 2
} mps_kernel_kind;
 mps_status mps_kernel_create(mps_context *context, int32_t kind,
                                                   double radius, mps_kernel **out);
 void mps_kernel_destroy(mps_kernel **kernel);
 int32_t mps_kernel_get_kind(const mps_kernel *kernel);
 double mps_kernel_radius(const mps_kernel *kernel);
 double mps_kernel_weight(const mps_kernel *kernel, double r);
 double mps_kernel_derivative(const mps_kernel *kernel, double r);
 mps_status mps_kernel_moment(mps_context *context, const mps_kernel *kernel,
                                                   int32_t dim, int32_t order, double *out);
 mps_status mps_kernel_density(mps_context *context, const mps_kernel *kernel,
                                                    int32_t dim, double spacing, double *out);


typedef struct mps_material mps_material;
typedef struct mps_material_block {
  uint32_t struct_size;
  int32_t dim;
  int64_t count;
  double dt;
  double time;
  const double *gradient[9];
  double *deformation[9];
  double *volume_ratio;
  double *stress[6];
  double *const *history;
  int32_t history_count;
  int32_t message_size;
  int64_t *flags;
  const int64_t *ids;
  const double *position[3];
  const double *temperature;
  char *message;
  int64_t *refused;
} mps_material_block;
 mps_status mps_material_block_init(mps_material_block *block, size_t size);

 mps_status mps_material_linear_elastic(mps_context *context, double young,
                                                             double poisson, mps_material **out);
 mps_status mps_material_neo_hookean(mps_context *context, double young,
                                                          double poisson, mps_material **out);
typedef struct mps_von_mises_def {
  uint32_t struct_size;
  uint32_t reserved;
  double young;
  double poisson;
  double yield_stress;
  double hardening;
} mps_von_mises_def;
typedef enum mps_cone {
  MPS_MATERIAL_CONE_PLANE_STRAIN = 0,
  MPS_MATERIAL_CONE_CIRCUMSCRIBED = 1,
  MPS_MATERIAL_CONE_INSCRIBED =
      2,
  MPS_MATERIAL_CONE_EXTENSION = 3
} mps_cone;
typedef struct mps_drucker_prager_def {
  uint32_t struct_size;
  int32_t cone;
  double young;
  double poisson;
  double friction;
  double dilation;
  double cohesion;
  double tension;
} mps_drucker_prager_def;
typedef struct mps_mohr_coulomb_def {
  uint32_t struct_size;
  uint32_t reserved;
  double young;
  double poisson;
  double friction;
  double dilation;
  double cohesion;
  double tension;
} mps_mohr_coulomb_def;
typedef enum mps_state_equation {
  MPS_MATERIAL_STATE_LINEAR = 0,
  MPS_MATERIAL_STATE_TAIT = 1
} mps_state_equation;
typedef struct mps_newtonian_def {
  uint32_t struct_size;
  int32_t state;
  double bulk_modulus;
  double viscosity;
  int32_t no_tension;
  int32_t reserved;
} mps_newtonian_def;
typedef mps_status (*mps_material_fn)(void *user, const mps_material_block *block);
typedef struct mps_user_law_def {
  uint32_t struct_size;
  int32_t history_count;
  mps_material_fn update;
  void *user;
  const char *name;
  const char *const *history;
  const double *history_initial;
  double wave_modulus;
  double viscosity;
  int32_t needs_deformation;
  int32_t turns_stress;
} mps_user_law_def;
typedef void (*mps_umat_fn)(double *stress, double *statev, double *ddsdde, double *sse,
                            double *spd, double *scd, double *rpl, double *ddsddt, double *drplde,
                            double *drpldt, const double *stran, const double *dstran,
                            const double *time, const double *dtime, const double *temp,
                            const double *dtemp, const double *predef, const double *dpred,
                            const char *cmname, const int32_t *ndi, const int32_t *nshr,
                            const int32_t *ntens, const int32_t *nstatv, const double *props,
                            const int32_t *nprops, const double *coords, const double *drot,
                            double *pnewdt, const double *celent, const double *dfgrd0,
                            const double *dfgrd1, const int32_t *noel, const int32_t *npt,
                            const int32_t *layer, const int32_t *kspt, const int32_t *kstep,
                            const int32_t *kinc, size_t cmname_length);
typedef struct mps_umat_def {
  uint32_t struct_size;
  int32_t statev_count;
  mps_umat_fn umat;
  const char *name;
  const double *props;
  int32_t props_count;
  int32_t needs_deformation;
  const char *const *statev_names;
  const double *statev_initial;
  double wave_modulus;
  double length;
  double temperature;
  int32_t keeps_strain;
  int32_t reserved;
} mps_umat_def;
 mps_status mps_von_mises_def_init(mps_von_mises_def *def, size_t size);
 mps_status mps_drucker_prager_def_init(mps_drucker_prager_def *def, size_t size);
 mps_status mps_mohr_coulomb_def_init(mps_mohr_coulomb_def *def, size_t size);
 mps_status mps_newtonian_def_init(mps_newtonian_def *def, size_t size);
 mps_status mps_user_law_def_init(mps_user_law_def *def, size_t size);
 mps_status mps_umat_def_init(mps_umat_def *def, size_t size);






 mps_status mps_material_von_mises(mps_context *context,
                                                        const mps_von_mises_def *def,
                                                        mps_material **out);
 mps_status mps_material_drucker_prager(mps_context *context,
                                                             const mps_drucker_prager_def *def,
                                                             mps_material **out);
 mps_status mps_material_mohr_coulomb(mps_context *context,
                                                           const mps_mohr_coulomb_def *def,
                                                           mps_material **out);
 mps_status mps_material_newtonian(mps_context *context,
                                                        const mps_newtonian_def *def,
                                                        mps_material **out);
 mps_status mps_material_user(mps_context *context,
                                                   const mps_user_law_def *def, mps_material **out);
 mps_status mps_material_umat(mps_context *context, const mps_umat_def *def,
                                                   mps_material **out);
 void mps_material_destroy(mps_material **material);
 const char *mps_material_name(const mps_material *material);
 double mps_material_wave_modulus(const mps_material *material);
 int32_t mps_material_needs_deformation(const mps_material *material);
 int32_t mps_material_history_count(const mps_material *material);
 const char *mps_material_history_name(const mps_material *material, int32_t index);
 const char *mps_material_history_field(const mps_material *material, int32_t index);
 double mps_material_history_initial(const mps_material *material, int32_t index);
typedef struct mps_moduli {
  double young, poisson;
  double shear, bulk, lambda;
  double wave;
  double density;
  double shear_velocity;
  double pressure_velocity;
} mps_moduli;
 mps_status mps_moduli_from_elastic_sized(mps_context *context, double young,
                                                               double poisson, double density,
                                                               mps_moduli *out, size_t size);

 mps_status mps_moduli_from_velocities_sized(mps_context *context,
                                                                  double shear_velocity,
                                                                  double pressure_velocity,
                                                                  double density, mps_moduli *out,
                                                                  size_t size);

 mps_status mps_material_get_moduli_sized(const mps_material *material,
                                                               double density, mps_moduli *out,
                                                               size_t size);

 mps_status mps_particles_set_material(mps_particles *particles,
                                                            const mps_material *material,
                                                            double density, int64_t count,
                                                            const int64_t *ids);
 mps_status mps_material_update(mps_context *context,
                                                     const mps_material *material,
                                                     const mps_material_block *block);
typedef struct mps_material_point {
  double stress[6];
  double deformation[9];
  double volume_ratio;
  double history[32];
  int64_t flags;
  double time;
} mps_material_point;
 mps_status mps_material_point_init(mps_context *context,
                                                         const mps_material *material,
                                                         mps_material_point *point);
 mps_status mps_material_point_drive(mps_context *context,
                                                          const mps_material *material,
                                                          mps_material_point *point,
                                                          const double gradient[9], double duration,
                                                          int64_t steps);


typedef struct mps_mpm mps_mpm;
typedef enum mps_mpm_geometry {
  MPS_MPM_PLANE_STRAIN = 0,
  MPS_MPM_AXISYMMETRIC = 1,
  MPS_MPM_SPACE = 2
} mps_mpm_geometry;
typedef enum mps_mpm_transfer {
  MPS_MPM_TRANSFER_SHAPE = 0,
  MPS_MPM_TRANSFER_WEIGHT = 1
} mps_mpm_transfer;
typedef enum mps_mpm_scheme {
  MPS_MPM_SCHEME_WLS = 0,
  MPS_MPM_SCHEME_STANDARD = 1
} mps_mpm_scheme;
typedef enum mps_mpm_step_from {
  MPS_MPM_STEP_FROM_SPEED = 0,
  MPS_MPM_STEP_FROM_WAVE = 1
} mps_mpm_step_from;
typedef enum mps_mpm_volumetric {
  MPS_MPM_VOLUMETRIC_POINT = 0,
  MPS_MPM_VOLUMETRIC_CELL = 1
} mps_mpm_volumetric;
typedef struct mps_mpm_def {
  uint32_t struct_size;
  int32_t geometry;
  int32_t spline;
  int32_t volumetric;
  int32_t transfer;
  int32_t scheme;
  double flip;
  double cell;
  double origin[3];
  double lower[3], upper[3];
  double measure;
  double gravity[3];
  double dt;
  double courant;
  int32_t step_from;
  int32_t reserved;
} mps_mpm_def;
 mps_status mps_mpm_def_init(mps_mpm_def *def, size_t size);

 mps_status mps_mpm_create(mps_context *context, mps_particles *particles,
                                                mps_material *material, const mps_mpm_def *def,
                                                mps_mpm **out);
 void mps_mpm_destroy(mps_mpm **mpm);
 mps_status mps_mpm_set_material(mps_mpm *mpm, mps_material *material,
                                                      int64_t count, const int64_t *ids);
 mps_status mps_mpm_add_contact(mps_mpm *mpm, mps_body *body,
                                                     const mps_contact_def *def,
                                                     mps_contact **contact);
 mps_status mps_mpm_get_def_sized(mps_mpm *mpm, mps_mpm_def *out, size_t size);

 mps_particles *mps_mpm_particles(const mps_mpm *mpm);
 mps_context *mps_mpm_context(const mps_mpm *mpm);
typedef enum mps_mpm_side {
  MPS_MPM_SIDE_X_LOWER = 0,
  MPS_MPM_SIDE_X_UPPER = 1,
  MPS_MPM_SIDE_Y_LOWER = 2,
  MPS_MPM_SIDE_Y_UPPER = 3,
  MPS_MPM_SIDE_Z_LOWER = 4,
  MPS_MPM_SIDE_Z_UPPER = 5
} mps_mpm_side;
typedef enum mps_mpm_boundary_kind {
  MPS_MPM_BOUNDARY_ROLLER = 0,
  MPS_MPM_BOUNDARY_FIXED = 1,
  MPS_MPM_BOUNDARY_FRICTIONAL = 2,
  MPS_MPM_BOUNDARY_ABSORBING =
      3,
  MPS_MPM_BOUNDARY_FREE = 4,
  MPS_MPM_BOUNDARY_PRESCRIBED = 5
} mps_mpm_boundary_kind;
typedef struct mps_mpm_boundary_def {
  uint32_t struct_size;
  int32_t kind;
  double lower[3];
  double upper[3];
  const int64_t *ids;
  int64_t id_count;
  uint32_t dofs;
  int32_t reserved;
  mps_signal
      *signal[3];
  double factor[3];
  double friction;
  double settle;
} mps_mpm_boundary_def;
 mps_status mps_mpm_boundary_def_init(mps_mpm_boundary_def *def, size_t size);

 mps_status mps_mpm_add_boundary(mps_mpm *mpm, const mps_mpm_boundary_def *def,
                                                      int32_t *number);
 mps_status mps_mpm_set_boundary(mps_mpm *mpm, int32_t number,
                                                      const mps_mpm_boundary_def *def);
 mps_status mps_mpm_remove_boundary(mps_mpm *mpm, int32_t number);
 mps_status mps_mpm_get_reaction_sized(mps_mpm *mpm, int32_t number,
                                                            mps_reaction *out, size_t size);


typedef struct mps_mpm_load_def {
  uint32_t struct_size;
  int32_t reserved;
  const int64_t *ids;
  int64_t id_count;
  const double
      *area;
  double traction[3];
  mps_signal
      *signal[3];
  double factor[3];
} mps_mpm_load_def;
 mps_status mps_mpm_load_def_init(mps_mpm_load_def *def, size_t size);

 mps_status mps_mpm_add_load(mps_mpm *mpm, const mps_mpm_load_def *def,
                                                  int32_t *number);
 mps_status mps_mpm_set_load(mps_mpm *mpm, int32_t number,
                                                  const mps_mpm_load_def *def);
 mps_status mps_mpm_remove_load(mps_mpm *mpm, int32_t number);
 mps_status mps_mpm_step(mps_mpm *mpm, int64_t count);
typedef mps_status (*mps_mpm_fn)(void *user, mps_mpm *mpm);
 mps_status mps_mpm_run(mps_mpm *mpm, double t_end, int64_t every,
                                             mps_mpm_fn callback, void *user);
 double mps_mpm_time(const mps_mpm *mpm);
 int64_t mps_mpm_steps(const mps_mpm *mpm);
 double mps_mpm_dt(const mps_mpm *mpm);
 double mps_mpm_limit(const mps_mpm *mpm);
 mps_status mps_mpm_set_dt(mps_mpm *mpm, double dt);
typedef struct mps_mpm_totals {
  double mass, volume;
  double linear[3];
  double angular[3];
  double kinetic;
  int64_t blocks, nodes;
  int64_t bytes;
} mps_mpm_totals;
 mps_status mps_mpm_get_totals(mps_mpm *mpm, mps_mpm_totals *out);
 mps_status mps_mpm_snapshot(mps_mpm *mpm, mps_snapshot **snapshot);
 mps_status mps_mpm_rollback(mps_mpm *mpm, const mps_snapshot *snapshot);
 mps_status mps_mpm_save(mps_mpm *mpm, const char *path,
                                              const mps_checkpoint *info);
 mps_status mps_mpm_restore(mps_mpm *mpm, const char *path,
                                                 mps_checkpoint *info);


typedef struct mps_neighbours mps_neighbours;
typedef struct mps_neighbours_def {
  uint32_t struct_size;
  int32_t dim;
  double radius;
  int32_t half;
  int32_t reserved;
} mps_neighbours_def;
 mps_status mps_neighbours_def_init(mps_neighbours_def *def, size_t size);

 mps_status mps_neighbours_create(mps_context *context,
                                                       const mps_neighbours_def *def,
                                                       mps_neighbours **out);
 void mps_neighbours_destroy(mps_neighbours **neighbours);
 mps_status mps_neighbours_build(mps_neighbours *neighbours,
                                                      const mps_view *position);
 mps_status mps_neighbours_lists(const mps_neighbours *neighbours,
                                                      int64_t *count, const int64_t **offsets,
                                                      const int64_t **indices);

#define MPS_VERSION_MAJOR 0
#define MPS_VERSION_MINOR 2
#define MPS_VERSION_PATCH 0
#define MPS_VIEW_READONLY 1
#define MPS_BODY_MAX_PARTS 16
#define MPS_FLUID_MAX_BOUNDARIES 16
#define MPS_MATERIAL_PLASTIC 1
#define MPS_MATERIAL_APEX 2
#define MPS_MATERIAL_POINT_HISTORY 32
#define MPS_MPM_MAX_MATERIALS 16
#define MPS_MPM_MAX_CONTACTS 32
#define MPS_MPM_MAX_BOUNDARIES 64
#define MPS_DOF_X 1
#define MPS_DOF_Y 2
#define MPS_DOF_Z 4
#define MPS_DOF_ROTATION 8
"""
