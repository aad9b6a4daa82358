# surface.gp - surface.csv, spectrum.csv and amplification.csv.   end (s); outcrop: the input is that of the half space;
#   highest (Hz); long: amplification.csv has rows; exact: of a layered linear ground
width = 1100; height = 900
load 'style.gp'
set multiplot
set size 1,0.48
set origin 0,0.52
set xrange [0:end]
set xlabel 'time t (s)'
set ylabel 'acceleration (m/s^2)'
plot 'surface.csv' using 1:2 with lines linetype 1 title 'surface', '' using 1:5 with lines linetype 2 title outcrop ? 'outcrop of the half space' : 'base'
set size 0.5,0.52
set origin 0,0
set logscale x
set xrange [0.5/highest:*]
set xtics (0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5)
set yrange [0:*]
set xlabel 'period (s)'
set ylabel 'spectral acceleration, 5 % damping (m/s^2)'
plot 'spectrum.csv' using 1:2 with lines linetype 1 title 'surface', '' using 1:3 with lines linetype 2 title 'input'
if (long) {
  set origin 0.5,0
  unset logscale
  set xrange [0:*]
  set xtics autofreq
  set xlabel 'frequency (Hz)'
  set ylabel 'Fourier amplitude of the surface over the input'
  plot 'amplification.csv' using 1:2 with lines linetype 1 title 'libmps', '' using 1:(exact ? $3 : NaN) with lines linetype 2 dashtype 2 title exact ? 'exact' : ''
}
unset multiplot
