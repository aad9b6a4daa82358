# rolling-disc.gp - the path of the disc from motion.csv.   first, second: title
width = 1000; height = 640
load 'style.gp'
set title named(first, second)
set xlabel 'time t (s)'
set ylabel "path of the centre along the slope (m)"
plot 'motion.csv' using 't_s':'x_theory_m' with lines linetype 2 title "theory of a rigid disc, Nakamura (51)", \
  '' every 4 using 't_s':'x_m' with points linetype 1 pointtype 6 title 'WLS-MPM'
