# Draws the picture of Nakamura's Figures 11, 14, 17 and 20 in docs/papers.md from what scripts/verify --page papers has
# left in out/verify: gnuplot docs/images/papers.gp, in the root of the sources.
if (!exists("runs")) runs = 'out/verify'
if (!exists("picture")) picture = 'docs/images/papers-nakamura.png'
width = 1300; height = 1100
load 'share/plots/style.gp'
box(h, k) = sprintf('%s/mps-sliding-box_--paper_--cell_%s_--k_%dMN_m/forces.csv', runs, h, k)
disc(h, by) = sprintf('%s/mps-rolling-disc_%s_--fill_rings_--cell_%s/motion.csv', runs, by, h)
clay(h, by) = sprintf('%s/mps-footing_%s--soil_3x2_--rate_5mm_s_--cell_%s/pressure.csv', runs, by, h)
sand(size, by, mu) = sprintf('%s/mps-footing_--law_druckerprager_--soil_%s_--rate_5mm_s_%s--friction_%s_--cell_0.1/pressure%s.csv', runs, size, by, mu, by eq '' ? '_deformed' : '')
set grid
set multiplot layout 2,2
set key outside bottom center horizontal maxrows 3

set title "Figure 11: sliding box, h = 0.02 m, springs"
set xlabel 'time t (s)'; set ylabel 'force across the plate (N/m)'
plot [0:2] [0:800] box('0.02', 3) using 't_s':'Fy_N_m' with lines lc rgb green title 'k = 3 MN/m', \
  box('0.02', 2) using 't_s':'Fy_N_m' with lines lc rgb blue title '2 MN/m', \
  box('0.02', 1) using 't_s':'Fy_N_m' with lines lc rgb grey title '1 MN/m', \
  612.61 dashtype '--' lc rgb red title 'exact, with lift-off'

set title "Figure 14: disc rolls, {/Symbol m} = 0.3, rings, springs"
set ylabel 'path (m)'
plot [0:0.5] disc('0.005', '--paper') using 't_s':'x_theory_m' with lines dashtype '--' lc rgb red title 'rigid disc, (51)', \
  disc('0.02', '--paper') every 8 using 't_s':'x_m' with points pointtype 4 lc rgb grey title 'h = 0.4 R', \
  disc('0.01', '--paper') every 8 using 't_s':'x_m' with points pointtype 8 lc rgb green title '0.2 R', \
  disc('0.005', '--paper') every 8 using 't_s':'x_m' with points pointtype 6 lc rgb blue title '0.1 R'

set title "Figure 17: strip footing on clay, 5 mm/s"
set xlabel 'settlement (mm)'; set ylabel 'q/c'
plot [0:0.6] [0:7] clay('0.1', '--paper_') using 1:'q_over_c' with lines lc rgb grey title "paper's method, h = 0.1 m", \
  clay('0.05', '--paper_') using 1:'q_over_c' with lines lc rgb green title '0.05 m', \
  clay('0.05', '') using 1:'q_over_c' with lines lc rgb blue title 'default, 0.05 m', \
  5.1416 dashtype '--' lc rgb red title 'Prandtl'

set title "Figure 20: strip footing on sand with weight"
plot [0:4] [0:60] sand('5x2_--settlement_4mm', '--paper_', '0.6') using 1:'q_over_c' with lines lc rgb grey title "rough, paper's method", \
  sand('5x2_--settlement_4mm', '', '0.6') using 1:'q_over_c' with lines lc rgb blue title 'rough, default', \
  42.64 dashtype '--' lc rgb red title 'characteristics, rough', \
  sand('3x1.5_--settlement_2mm', '--paper_', '0') using 1:'q_over_c' with lines dashtype 2 lc rgb grey title "smooth, paper's method", \
  sand('3x1.5_--settlement_2mm', '', '0') using 1:'q_over_c' with lines dashtype 2 lc rgb blue title 'smooth, default', \
  36.81 dashtype '..' lc rgb red title 'smooth'
unset multiplot
