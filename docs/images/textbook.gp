# Draws the pictures of docs/verification/textbook.md from what scripts/verify --page textbook has left in out/verify:
# gnuplot docs/images/textbook.gp, in the root of the sources.
block = 'out/verify/test-verify-textbook_block/'
wave = 'out/verify/test-verify-textbook_rayleigh/'
bar = 'out/verify/test-verify-textbook_taylor/'
folder(name) = system("ls -td out/verify/".name."* 2>/dev/null | head -1").'/'

# ---- motion ---------------------------------------------------------------------------------
width = 1200; height = 900; picture = 'docs/images/textbook-motion.png'
load 'share/plots/style.gp'
set multiplot layout 2,2
set title "Newmark's block, one pulse of 0.4 g"
set xlabel 't (s)'; set ylabel 'slip (m)'
plot block.'block_pulse.csv' using 1:3 with lines lc rgb blue title 'WLS-MPM', 0.122625 dashtype '--' lc rgb red title 'closed form, at the end'
set title "Newmark's block, five cycles of 0.35 g down 15°"
plot block.'block_cycles.csv' using 1:3 with lines lc rgb blue title 'WLS-MPM', 0.231714 dashtype '--' lc rgb red title 'rigid block, at the end'
set title 'Surface wave, explicit MPS, 40 particles a wavelength'
set ylabel 'velocity of the surface (mm/s)'
plot [0:3.3] wave.'rayleigh_particles.csv' using 1:($3*1e3) with lines lc rgb blue title 'vertical', '' using 1:($2*1e3) with lines lc rgb red title 'horizontal'
set title "Taylor's bar after 80 µs: plastic strain"
set xlabel 'r (mm)'; set ylabel 'z (mm)'; set size ratio -1
eval blues
plot [-9:9] [0:24] bar.'taylor.csv' using ($1*1e3):($2*1e3):3 with points pt 7 ps 0.22 palette notitle, '' using (-$1*1e3):($2*1e3):3 with points pt 7 ps 0.22 palette notitle, 21.4 dashtype '--' lc rgb red title '21.4 mm'
unset multiplot

# ---- bearing capacity ------------------------------------------------------------------------
reset
width = 1200; height = 820; picture = 'docs/images/textbook-bearing.png'
load 'share/plots/style.gp'
nq = folder('mps-footing_--law_druckerprager_--gravity_0')
smooth = folder('mps-footing_--law_druckerprager_--cohesion_0_--soil_2x0.8')
rough = folder('mps-footing_--law_druckerprager_--cohesion_0_--soil_3x1.2')
thin = folder('mps-footing_--half-width_1_--soil_3x0.5')
set multiplot layout 2,2
set xlabel 'settlement (mm)'
set title 'Surcharge, {/Symbol f} = 30°, h = 0.05 m'; set ylabel 'pressure over the surcharge'
plot [0:*] [0:*] nq.'pressure.csv' using 1:($2/10) with lines lc rgb blue title 'WLS-MPM', 18.401 dashtype '--' lc rgb red title 'N_q, Prandtl and Reissner'
set title 'Weight, {/Symbol f} = 30°, smooth'; set ylabel 'pressure over {/Symbol r} g B/2'
plot [0:*] [0:*] smooth.'pressure.csv' using 1:($2/4.905) with lines lc rgb blue title 'WLS-MPM, pressed slowly', 7.653 dashtype '--' lc rgb red title 'N_{/Symbol g}, Martin'
set title 'Weight, {/Symbol f} = 30°, rough'
plot [0:*] [0:*] rough.'pressure.csv' using 1:($2/4.905) with lines lc rgb blue title 'WLS-MPM, pressed slowly', 14.75 dashtype '--' lc rgb red title 'N_{/Symbol g}, Martin'
set title 'Thin layer of clay, B = 4 H, rough'; set ylabel 'pressure over c'
plot [0:*] [0:*] thin.'pressure.csv' using 1:3 with lines lc rgb blue title 'WLS-MPM', 6.1416 dashtype '--' lc rgb red title '{/Symbol p} + 1 + B/(2 H)'
unset multiplot

# ---- cones -----------------------------------------------------------------------------------
width = 900; height = 520; picture = 'docs/images/textbook-cones.png'
load 'share/plots/style.gp'
set title 'Smooth cone of 60° in deep clay (Tresca), D/8, from a hole 4 D deep'
set xlabel 'penetration over D'; set ylabel 'N_{kt}'
cone(ir) = folder('mps-penetrometer_--law_tresca_--ir_'.ir.'_*0.0125').'force.csv'
lu(ir) = 3.4 + 1.6*log(ir)
plot [0:1.7] [0:14] for [k=0:2] cone(word('50 100 200', k + 1)) using (($1 - 0.4)/0.1):10 with lines lc rgb word(green.' '.blue.' '.grey, k + 1) title 'Ir = '.word('50 100 200', k + 1), \
  lu(50) dashtype '--' lc rgb green notitle, lu(100) dashtype '--' lc rgb blue notitle, lu(200) dashtype '--' lc rgb grey title 'Lu et al. (2004)'

# ---- walls and sand --------------------------------------------------------------------------
width = 1200; height = 420; picture = 'docs/images/textbook-sand.png'
load 'share/plots/style.gp'
set multiplot layout 1,2
set title 'Wall that leaves sand, {/Symbol y} = {/Symbol f}, ground below the toe'
set xlabel 'path over height'; set ylabel 'K'
walls = 'out/verify/mps-wall_--below-toe_0.5_--psi_30_--cell_'
plot [0:0.01] [0:0.6] walls.'0.125/pressure.csv' every ::1 using 1:3 with lines lc rgb grey title 'h = H/8', walls.'0.0625/pressure.csv' every ::1 using 1:3 with lines lc rgb green title 'h = H/16', walls.'0.03125/pressure.csv' every ::1 using 1:3 with lines lc rgb blue title 'h = H/32', 1.0/3 dashtype '--' lc rgb red title 'Rankine'
set title 'Cylinders of sand, run-out over time'
set xlabel 't (s)'; set ylabel '(L - L_0)/L_0'
columns = 'out/verify/mps-column-collapse_--axisymmetric_--aspect_'
plot [0:*] [0:3.6] columns.'1_--flip-time_10ms_--frames_0_--cell_0.005/front_column.csv' using 1:2 with lines lc rgb blue title 'a = 1', columns.'3_--frames_0_--cell_0.005/front_column.csv' using 1:2 with lines lc rgb green title 'a = 3', 1.24 dashtype '--' lc rgb blue title 'Lube et al., a = 1', 2.771 dashtype '--' lc rgb green title 'a = 3'
unset multiplot

# ---- spheres on grains -----------------------------------------------------------------------
width = 900; height = 480; picture = 'docs/images/textbook-crater.png'
load 'share/plots/style.gp'
set title 'Spheres of 25 mm dropped on glass beads, D/20'
set xlabel 't after impact (s)'; set ylabel 'depth of the lowest point (mm)'
balls = 'out/verify/test-verify-textbook_crater_20/'
ball = 'crater_steel crater_glass_high crater_glass crater_wood'
said = '"steel, 0.1 m" "glass, 0.4 m" "glass, 0.1 m" "wood, 0.1 m"'
depth = '30.57 24.04 15.59 8.61'
shade = grey.' '.green.' '.blue.' '.'#d95f02'
plot [0:0.2] [0:36] for [k=1:4] balls.word(ball, k).'.csv' using 1:($2*1e3) with lines lc rgb word(shade, k) title word(said, k), \
  for [k=1:4] word(depth, k) + 0 dashtype '--' lc rgb word(shade, k) title (k == 4 ? 'Uehara et al. (2003)' : '')
