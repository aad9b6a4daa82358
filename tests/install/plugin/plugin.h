/* plugin.h - what the plug-in offers its host. SPDX-License-Identifier: BSD-3-Clause */
#ifndef PLUGIN_H
#define PLUGIN_H

#include <mps/base.h>

typedef void (*plugin_function)(void);

#define PLUGIN_API __attribute__((visibility("default")))
PLUGIN_API mps_status plugin_fill(double spacing, int64_t *added);
PLUGIN_API const char *plugin_last_error(void);
PLUGIN_API plugin_function plugin_address(void); /* of its mps_particles_create */

#endif
