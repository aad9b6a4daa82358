# Draws the picture of Nakamura's Figures 11, 14, 17 and 20 in docs/papers.md from what scripts/verify --page papers has
# left in out/verify: gnuplot docs/images/papers.gp, in the root of the sources.
if (!exists("runs")) runs = 'out/verify'
set encoding utf8
set datafile separator ','
set grid
blue = '#1f4e8c'; red = '#c0392b'; grey = '#888888'; green = '#2e7d32'
box(h, k) = sprintf('%s/mps-sliding-box_--paper_--cell_%s_--k_%dMN_m/forces.csv', runs, h, k)
disc(h, by) = sprintf('%s/mps-rolling-disc_%s_--fill_rings_--cell_%s/motion.csv', runs, by, h)
clay(h, by) = sprintf('%s/mps-footing_%s--soil_3x2_--rate_5mm_s_--cell_%s/pressure.csv', runs, by, h)
sand(size, by, mu) = sprintf('%s/mps-footing_--law_druckerprager_--soil_%s_--rate_5mm_s_%s--friction_%s_--cell_0.1/pressure.csv', runs, size, by, mu)
set terminal pngcairo size 1200,860 enhanced font 'DejaVu Sans,11'
set output 'docs/images/papers-nakamura.png'
set multiplot layout 2,2

set title "Figure 11: sliding box, h = 0.02 m, springs"
set xlabel 't (s)'; set ylabel 'force across the plate (N/m)'
set key bottom right
plot [0:2] [0:800] box('0.02', 3) every ::1 using 1:3 with lines lc rgb green title 'k = 3 MN/m', \
  box('0.02', 2) every ::1 using 1:3 with lines lc rgb blue title '2 MN/m', \
  box('0.02', 1) every ::1 using 1:3 with lines lc rgb grey title '1 MN/m', \
  612.61 dt '--' lc rgb red title 'exact, with lift-off'

set title "Figure 14: disc rolls, {/Symbol m} = 0.3, rings, springs"
set ylabel 'path (m)'; set key top left
plot [0:0.5] disc('0.005', '--paper') every ::1 using 1:3 with lines dt '--' lc rgb red title 'rigid disc, (51)', \
  disc('0.02', '--paper') every 8::1 using 1:2 with points pt 4 lc rgb grey title 'h = 0.4 R', \
  disc('0.01', '--paper') every 8::1 using 1:2 with points pt 8 lc rgb green title '0.2 R', \
  disc('0.005', '--paper') every 8::1 using 1:2 with points pt 6 lc rgb blue title '0.1 R'

set title "Figure 17: strip footing on clay, 5 mm/s"
set xlabel 'settlement (mm)'; set ylabel 'q/c'; set key bottom right
plot [0:0.6] [0:7] clay('0.1', '--paper_') every ::1 using 1:3 with lines lc rgb grey title "paper's method, h = 0.1 m", \
  clay('0.05', '--paper_') every ::1 using 1:3 with lines lc rgb green title '0.05 m', \
  clay('0.05', '') every ::1 using 1:3 with lines lc rgb blue title 'default, 0.05 m', \
  5.1416 dt '--' lc rgb red title 'Prandtl'

set title "Figure 20: strip footing on sand with weight, 5 mm/s, h = 0.1 m"
plot [0:4] [0:60] sand('5x2_--settlement_4mm', '--paper_', '0.6') every ::1 using 1:3 with lines lc rgb grey title "rough, paper's method", \
  sand('5x2_--settlement_4mm', '', '0.6') every ::1 using 1:3 with lines lc rgb blue title 'rough, default', \
  sand('3x1.5_--settlement_2mm', '--paper_', '0') every ::1 using 1:3 with lines dt 2 lc rgb grey title "smooth, paper's method", \
  sand('3x1.5_--settlement_2mm', '', '0') every ::1 using 1:3 with lines dt 2 lc rgb blue title 'smooth, default', \
  42.64 dt '--' lc rgb red title 'characteristics, rough', 36.81 dt '..' lc rgb red title 'smooth'
unset multiplot
