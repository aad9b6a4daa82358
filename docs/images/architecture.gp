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
eval text(60, 57.8, 'examples/, and yours: they see include/mps/ only, and link one library')
k = 2
do for [i = 1:4] {
  x = 2 + (i - 1)*29.5
  eval box(k, x, 42, 27.5, 9.5, '#cfe2f3')
  eval arrow(x + 13.75, 56, x + 13.75, 51.6)
  eval arrow(x + 13.75, 42, x + 13.75, 38.1)
  k = k + 1
}
eval head(15.75, 49, 'mpm')
eval text(15.75, 46.3, 'soil on a grid that follows')
eval text(15.75, 44, 'the particles')
eval head(45.25, 49, 'dynamics')
eval text(45.25, 46.3, 'explicit: waves through')
eval text(45.25, 44, 'ground, step by step')
eval head(74.75, 49, 'implicit')
eval text(74.75, 46.3, 'elastic structures: one')
eval text(74.75, 44, 'matrix, statics to modes')
eval head(104.25, 49, 'fluid')
eval text(104.25, 46.3, 'water with a free')
eval text(104.25, 44, 'surface')
eval box(k, 2, 28, 27.5, 10, '#d9ead3'); k = k + 1
eval head(15.75, 35.6, 'material')
eval text(15.75, 33, 'laws on blocks of particles,')
eval text(15.75, 30.7, 'stress of ground at rest')
eval box(k, 31.5, 28, 27.5, 10, '#d9ead3'); k = k + 1
eval head(45.25, 35.6, 'contact, body')
eval text(45.25, 33, 'rigid bodies: shape, motion;')
eval text(45.25, 30.7, 'forces at their surface')
eval box(k, 61, 28, 27.5, 10, '#d9ead3'); k = k + 1
eval head(74.75, 35.6, 'signal')
eval text(74.75, 33, 'functions of time,')
eval text(74.75, 30.7, 'recorded motions')
eval box(k, 90.5, 28, 27.5, 10, '#d9ead3'); k = k + 1
eval head(104.25, 35.6, 'io')
eval text(104.25, 33, 'frames for ParaView,')
eval text(104.25, 30.7, 'checkpoint files')
do for [i = 1:4] { eval arrow(15.75 + (i - 1)*29.5, 28, 15.75 + (i - 1)*29.5, 23.6) }
eval box(k, 2, 12, 116, 11.5, '#fff2cc'); k = k + 1
eval head(60, 21, 'core')
eval text(60, 18.2, 'context: errors, memory, threads, log, cancel  •  particles: named fields, fills, order')
eval text(60, 15, 'state: snapshots  •  weight functions, neighbours  •  definition structs, instruction levels')
eval text(15.75, 7.6, 'Embree: meshes (body)')
eval text(45.25, 7.6, 'HDF5: files (io)')
eval text(79, 7.6, 'CHOLMOD, LAPACK, ARPACK (implicit)')
eval text(108, 7.6, 'OpenMP (core)')
eval text(60, 3.2, "Each of them stays behind its layer, and no public header names it. Calls go down the arrows only.")
plot NaN

# ---- one step ---------------------------------------------------------------------------------
reset
unset border; unset tics; unset key
set lmargin 0; set rmargin 0; set tmargin 0; set bmargin 0
set terminal pngcairo size 1200,900 enhanced font 'DejaVu Sans'
set output 'architecture-step.png'
set xrange [0:120]
set yrange [0:90]
eval box(1, 1, 5, 25, 83, '#fff2cc')
eval head(13.5, 85.3, 'particles')
eval text(13.5, 82.4, 'owned by the set: fields')
eval text(13.5, 80.1, 'that the caller may read')
eval box(2, 84, 5, 35, 83, '#d9ead3')
eval head(101.5, 85.3, 'nodes, bodies, boundaries')
eval text(101.5, 82.4, 'nodes and boundaries owned by the')
eval text(101.5, 80.1, 'solver; bodies shared with the caller')
eval head(55, 86, 'one step of WLS-MPM')
array stage[8] = ["order and blocks", "pairs of blocks and bodies", "forces on particles", "particles to nodes", "motion of the nodes", "nodes to particles", "laws", "bodies, results of the step"]
array how[8] = ["only when a particle has left its block", "and which nodes lie inside a body", "loads; motions of walls and boxes by their signals", "splines, or their fit near a body; contact (28)", "forces, friction (31)-(34), walls", "velocity, its gradient, place (41)-(43)", "stress from strain and spin (44)-(48)", "reactions, free bodies move; speed for dt (49)"]
array split[8] = ["chunks of particles", "blocks", "chunks of particles", "blocks of cells, so that no two write the same node", "blocks of nodes", "blocks of cells", "blocks of cells, while they are in the cache", "sums in a fixed order"]
do for [i = 1:8] {
  y = 84 - 9.7*i
  eval box(2 + i, 31, y, 48, 8.1, i >= 4 && i <= 7 ? '#cfe2f3' : '#eef2f7')
  eval head(55, y + 6.5, sprintf("%d  %s", i, stage[i]))
  eval text(55, y + 4.1, how[i])
  eval sprintf("set label \"{/:Italic %s}\" at 55,%g center font ',12' textcolor rgb '#9c3d10'", split[i], y + 1.7)
  if (i < 8) { eval arrow(55, y, 55, y - 1.6) }
}
mid(i) = 88 - 9.7*i
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
eval to(5); eval R(5, 1.3, 'velocity; impulses of walls,'); eval R(5, -1.3, 'boxes and bodies')
eval out(6); eval L(6, 1.3, 'position, velocity,'); eval L(6, -1.3, 'gradient')
eval from(6); eval R(6, 0, 'velocity')
eval out(7); eval L(7, 1.3, 'stress, volume,'); eval L(7, -1.3, 'history of the law')
eval to(8); eval R(8, 1.3, 'reactions by part, pose,'); eval R(8, -1.3, 'spin; time, steps')
eval text(60, 2.2, "Blue: one pass over the blocks. Results leave between steps: views, reactions, totals, frames, snapshots, checkpoints.")
plot NaN
