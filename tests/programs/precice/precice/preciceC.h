/* preciceC.h - the functions of preCICE's C interface (version 3) that mps-precice calls, for the
 * stand-in of the tests. SPDX-License-Identifier: BSD-3-Clause */
#ifndef TESTS_PRECICE_C_H
#define TESTS_PRECICE_C_H

void precicec_createParticipant(const char *name, const char *config, int index, int size);
void precicec_initialize(void);
void precicec_advance(double dt);
void precicec_finalize(void);
int precicec_requiresInitialData(void);
int precicec_requiresWritingCheckpoint(void);
int precicec_requiresReadingCheckpoint(void);
int precicec_getMeshDimensions(const char *mesh);
int precicec_getDataDimensions(const char *mesh, const char *data);
int precicec_isCouplingOngoing(void);
int precicec_isTimeWindowComplete(void);
double precicec_getMaxTimeStepSize(void);
void precicec_setMeshVertices(const char *mesh, int size, const double *positions, int *ids);
void precicec_writeData(const char *mesh, const char *data, int size, const int *ids,
                        const double *values);
void precicec_readData(const char *mesh, const char *data, int size, const int *ids, double time,
                       double *values);

#endif
