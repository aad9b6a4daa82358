# Draws the two pictures of docs/architecture.md: gnuplot architecture.gp, in this folder.
set encoding utf8
unset border; unset tics; unset key
set lmargin 0; set rmargin 0; set tmargin 0; set bmargin 0
box(n, x, y, w, h, c) = sprintf("set object %d rectangle from %g,%g to %g,%g fillcolor rgb '%s' fillstyle solid border linecolor rgb '#44546a'", n, x, y, x + w, y + h, c)
head(x, y, t) = sprintf("set label \"{/:Bold %s}\" at %g,%g center font ',15'", t, x, y)
text(x, y, t) = sprintf("set label \"%s\" at %g,%g center font ',13'", t, x, y)
left(x, y, t) = sprintf("set label \"%s\" at %g,%g left font ',13'", t, x, y)
arrow(x, y, u, v) = sprintf("set arrow from %g,%g to %g,%g head filled size 1,20 linewidth 1.4 linecolor rgb '#44546a'", x, y, u, v)

# ---- the layers -------------------------------------------------------------------------------
set terminal pngcairo size 1200,640 enhanced font 'DejaVu Sans'
set output 'architecture-layers.png'
set xrange [0:120]
set yrange [0:64]
eval box(1, 2, 56, 116, 6.5, '#eef2f7')
eval head(60, 60.6, 'programs')
eval text(60, 57.8, 'programs/, and yours: they see include/mps/ only, and link one library')
array upper[5] = ["mpm", "dynamics", "implicit", "fluid", "couple"]
array upper1[5] = ["soil on a grid that", "explicit: waves through", "elastic structures:", "water with a", "two codes that act on"]
array upper2[5] = ["follows the particles", "ground, step by step", "statics, steps, modes", "free surface", "one another in a step"]
array lower[5] = ["material", "contact, body", "signal, waves", "io", "domain"]
array lower1[5] = ["laws on blocks of par-", "rigid bodies, forces", "functions of time,", "frames for ParaView,", "one model on several"]
array lower2[5] = ["ticles, ground at rest", "at their surface", "records, seas, makers", "checkpoint files", "ranks, by a transport"]
do for [i = 1:5] {
  x = 2 + (i - 1)*23.6
  m = x + 10.8
  eval box(2*i, x, 42, 21.6, 9.5, '#cfe2f3')
  eval box(2*i + 1, x, 28, 21.6, 10, '#d9ead3')
  eval arrow(m, 56, m, 51.6); eval arrow(m, 42, m, 38.1); eval arrow(m, 28, m, 23.6)
  eval head(m, 49, upper[i]); eval text(m, 46.3, upper1[i]); eval text(m, 44, upper2[i])
  eval head(m, 35.6, lower[i]); eval text(m, 33, lower1[i]); eval text(m, 30.7, lower2[i])
}
k = 12
eval box(k, 2, 12, 116, 11.5, '#fff2cc'); k = k + 1
eval head(60, 21, 'core')
eval text(60, 18.2, 'context: errors, memory, threads, log, cancel  •  particles: named fields, fills, order')
eval text(60, 15, 'state: snapshots  •  weight functions, neighbours  •  definition structs, instruction levels')
eval text(13, 7.6, 'Embree: meshes (body)')
eval text(34.5, 7.6, 'HDF5: files (io)')
eval text(61, 7.6, 'CHOLMOD, LAPACK, ARPACK (implicit)')
eval text(89, 7.6, 'OpenMP (core)')
eval text(108, 7.6, 'MPI, PETSc (petsc)')
eval text(60, 3.2, "Each stays behind its layer, and no public header names it. MPI and PETSc are of a library of their own. Calls go down only.")
plot NaN

# ---- one step ---------------------------------------------------------------------------------
reset
unset border; unset tics; unset key
set lmargin 0; set rmargin 0; set tmargin 0; set bmargin 0
set terminal pngcairo size 1200,1100 enhanced font 'DejaVu Sans'
set output 'architecture-step.png'
set xrange [0:120]
set yrange [0:110]
eval box(1, 1, 5, 25, 103, '#fff2cc')
eval head(13.5, 105.3, 'particles')
eval text(13.5, 102.4, 'owned by the set: fields')
eval text(13.5, 100.1, 'that the caller may read')
eval box(2, 84, 5, 35, 103, '#d9ead3')
eval head(101.5, 105.3, 'nodes, bodies, boundaries')
eval text(101.5, 102.4, 'nodes and boundaries owned by the')
eval text(101.5, 100.1, 'solver; bodies shared with the caller')
eval head(55, 106, 'one step of WLS-MPM')
array stage[10] = ["order and blocks", "contact search", "forces on particles", "particles to nodes", "motion of the nodes", "impulses of contacts", "walls, boxes, friction", "nodes to particles", "laws", "bodies, results of the step"]
array how[10] = ["only when a particle has left its block", "blocks near bodies, nodes inside, candidates", "loads; motions of walls and boxes by their signals", "splines; mirrors at walls, fit at bodies; penalty (28)", "velocities before and after the forces (26)", "Gauss-Seidel sweeps over the active contacts", "prescribed nodes; penalty friction (31)-(34)", "velocity, its gradient, position (41)-(43)", "stress from strain and spin (44)-(48)", "reactions, free bodies move; speed for dt (49)"]
array split[10] = ["chunks of particles", "blocks", "chunks of particles", "blocks of cells, so that no two write the same node", "blocks of nodes", "blocks of one colour; beside a free body, one thread", "blocks of nodes", "blocks of cells", "blocks of cells, while they are in the cache", "sums in a fixed order"]
do for [i = 1:10] {
  y = 104 - 9.7*i
  eval box(2 + i, 31, y, 48, 8.1, i >= 4 && i <= 9 && i != 6 ? '#cfe2f3' : '#eef2f7')
  eval head(55, y + 6.5, sprintf("%d  %s", i, stage[i]))
  eval text(55, y + 4.1, how[i])
  eval sprintf("set label \"{/:Italic %s}\" at 55,%g center font ',12' textcolor rgb '#9c3d10'", split[i], y + 1.7)
  if (i < 10) { eval arrow(55, y, 55, y - 1.6) }
}
mid(i) = 108 - 9.7*i
in(i) = arrow(26, mid(i), 30.8, mid(i))
out(i) = arrow(30.8, mid(i), 26, mid(i))
to(i) = arrow(79.2, mid(i), 83.8, mid(i))
from(i) = arrow(83.8, mid(i), 79.2, mid(i))
L(i, d, t) = left(2.5, mid(i) + d, t)
R(i, d, t) = left(86, mid(i) + d, t)
eval in(1); eval L(1, -2.5, 'position')
eval to(1); eval R(1, -2.5, 'blocks of nodes that exist')
eval from(2); eval R(2, 0, 'surface: distance and normal')
eval out(3); eval L(3, 0, 'force')
eval from(3); eval R(3, 0, 'signals')
eval in(4); eval L(4, 1.3, 'mass, velocity, gradient,'); eval L(4, -1.3, 'stress, force')
eval to(4); eval R(4, 0, 'mass, momentum, force')
eval to(5); eval R(5, 0, 'velocity')
eval to(6); eval R(6, 1.3, 'impulses on nodes and bodies,'); eval R(6, -1.3, 'kept for the next step')
eval to(7); eval R(7, 0, 'velocity; impulses of walls, boxes')
eval out(8); eval L(8, 1.3, 'position, velocity,'); eval L(8, -1.3, 'gradient')
eval from(8); eval R(8, 0, 'velocity')
eval out(9); eval L(9, 1.3, 'stress, volume,'); eval L(9, -1.3, 'history of the law')
eval to(10); eval R(10, 1.3, 'reactions by part, pose,'); eval R(10, -1.3, 'spin; time, steps')
eval text(60, 2.2, "Blue: one pass over the blocks, in two parts where there is contact. Results leave between steps: views, reactions, totals, files.")
plot NaN
