# stability.gp - Figures 3 to 10 of Yoshida from limits.csv, integrators.csv and regression.csv. Lines are linear
# theory, marks bisection by time stepping.   figure; linear, stepping: what there is; second: line of the title
#   of 8: array h[dampings], a_S[], b_S[], a_P[], b_P[]: dt = a (R/V)^b; of 10: c_S, d_S, c_P, d_P: coefficients of log10 h
width = 1200; height = 680
load 'style.gp'
method = stepping ? 'time stepping' : 'linear theory'
column_of(first) = stepping ? first + 1 : first
array titles[10]
titles[3] = 'Time integration: shear wave, V_S = 100 m/s'
titles[4] = 'Critical time step against damping: shear wave'
titles[5] = 'Critical time step against particle radius: shear wave'
titles[6] = 'Critical time step against R/V'
titles[7] = 'Shear and pressure wave at equal wave velocity'
titles[8] = 'Regression dt = a_1 (R/V)^{a_2} for each damping ratio h'
titles[9] = 'Coefficients of the regression against damping'
titles[10] = 'Critical time step by the regression against that found (h up to 0.22)'
if (figure >= 8) { second = figure == 8 ? 'lines: regression; marks: limits by '.method : figure == 9 ? 'of the limits by '.method : 'grey: within 20 %' }
set multiplot layout 1,2 title named(titles[figure], second)
set key left bottom samplen 2.5 font ',13'
set ylabel 'critical time step (s)'
set format y '10^{%T}'
set logscale xy
radii = '0.25 0.5 1 1.6'
speeds = '25 50 100 200'

# The limits where `where` holds over `x`, the linear ones (column `c`) as a line, the others (the next column) as marks.
at(file, x, c, where) = sprintf("'%s' using %s:((%s) ? $%d : NaN) ", file, x, where, c)
line_of(file, x, c, where, k, w, t) = linear ? at(file, x, c, where).sprintf("with lines linetype %d linewidth %g title '%s', ", k, w, stepping ? '' : t) : ''
marks_of(file, x, c, where, k, t) = stepping ? at(file, x, c + 1, where).sprintf("with points linetype %d pointsize 1.3 title '%s', ", k, t) : ''
both(file, x, c, where, k, w, t) = line_of(file, x, c, where, k, w, t).marks_of(file, x, c, where, k, t)

if (figure == 3) {
  set xlabel 'damping ratio h'
  set xrange [0.0007:1.4]
  do for [R in '0.5 1.6'] {
    set title 'R = '.R.' m'
    plots = ''
    do for [k=1:3] { # Verlet falls into the wide line of leapfrog
      plots = plots.both('integrators.csv', '3', 4, sprintf("strcol(1) eq '%s' && $2 == %s", word('euler leapfrog verlet', k), R), word('4 6 1', k) + 0, k == 2 ? 4 : 1.3, word('Euler Leapfrog Verlet', k))
    }
    eval 'plot '.plots.'NaN notitle'
  }
}
if (figure == 4) {
  set xlabel 'damping ratio h'
  set xrange [0.0007:1.4]
  do for [R in '0.25 1'] {
    set title 'R = '.R.' m'
    plots = ''
    do for [k=1:4] { plots = plots.both('limits.csv', '4', 5, sprintf("strcol(1) eq 'S' && $2 == %s && $3 == %s", R, word(speeds, k)), k, 1.3, 'V_S = '.word(speeds, k).' m/s') }
    eval 'plot '.plots.'NaN notitle'
  }
}
if (figure == 5) {
  set xlabel 'particle radius R (m)'
  set xrange [0.2:2]
  set xtics (0.25, 0.5, 1, 1.6)
  set key right bottom
  do for [h in '0.001 0.048'] {
    set title 'h = '.h
    plots = ''
    do for [k=1:4] { plots = plots.both('limits.csv', '2', 5, sprintf("strcol(1) eq 'S' && $4 == %s && $3 == %s", h, word(speeds, k)), k, 1.3, 'V_S = '.word(speeds, k).' m/s') }
    eval 'plot '.plots.'NaN notitle'
  }
}
# Over R/V, whose values are not in order in the table: the line sorts them.
scaled(wave, h, k, dash, t) = (linear ? sprintf("'limits.csv' using ($2/$3):((strcol(1) eq '%s' && $4 == %s) ? $5 : NaN) smooth unique with lines linetype %d dashtype %d title '%s', ", wave, h, k, dash, stepping ? '' : t) : '').marks_of('limits.csv', '($2/$3)', 5, sprintf("strcol(1) eq '%s' && $4 == %s", wave, h), k, t)
if (figure == 6) {
  set key left top
  set format x '10^{%T}'
  set xrange [2e-4:3e-2]
  do for [wave in 'S P'] {
    set xlabel 'R / V_'.wave.' (s)'
    set title (wave eq 'S' ? 'shear wave' : 'pressure wave')
    plots = ''
    do for [k=1:3] { plots = plots.scaled(wave, word('0.001 0.048 1', k), k, 1, 'h = '.word('0.001 0.048 1', k)) }
    eval 'plot '.plots.'NaN notitle'
  }
}
if (figure == 7) {
  set key left top
  set format x '10^{%T}'
  set xrange [2e-4:3e-2]
  set xlabel 'R / V (s)'
  do for [h in '0.001 0.1'] {
    set title 'h = '.h
    eval 'plot '.scaled('S', h, 1, 1, 'S wave, V = V_S').scaled('P', h, 2, 2, 'P wave, V = V_P').'NaN notitle'
  }
}
if (figure == 8) {
  set format xy '10^{%T}'
  set xrange [0.0002:0.03]
  set key right bottom samplen 1.5
  set palette defined (0 blue, 0.5 green, 1 red)
  unset colorbox
  set cbrange [-3:0]
  do for [wave in 'S P'] {
    set xlabel 'R / V_'.wave.' (s)'
    set title (wave eq 'S' ? 'shear wave' : 'pressure wave')
    plot for [k=1:dampings] (wave eq 'S' ? a_S[k]*x**b_S[k] : a_P[k]*x**b_P[k]) with lines linecolor palette cb log10(h[k]) title sprintf('h = %g', h[k]), \
      'limits.csv' using ($2/$3):(strcol(1) eq wave ? column(column_of(5)) : NaN):(log10($4)) with points pointtype 7 pointsize 0.7 linecolor palette notitle
  }
}
if (figure == 9) {
  set format y '%h'
  unset logscale y
  set xlabel 'damping ratio h'
  set xrange [0.0007:1.4]
  set key left top
  found = stepping ? 'stepping' : 'linear'
  do for [k=1:2] {
    if (k == 1) { set logscale y; set yrange [0.5:300] } else { unset logscale y; set yrange [0.8:2.2] }
    set ylabel sprintf('a_%d', k)
    set title sprintf('a_%d', k)
    plot for [w=1:2] 'regression.csv' using 3:(strcol(1) eq word('S P', w) && strcol(2) eq found ? column(3 + k) : NaN) with points linetype w pointsize 1.3 title word('S P', w).' wave', \
      for [w=1:2] '' using 3:(strcol(1) eq word('S P', w) && strcol(2) eq found ? column(5 + k) : NaN) with lines linetype w title word('S P', w).': own quadratic', \
      for [w=1:2] '' using 3:(strcol(1) eq word('S P', w) && strcol(2) eq found ? column(7 + k) : NaN) with lines linetype w dashtype 2 title word('S P', w).': Table 2 as printed'
  }
}
if (figure == 10) {
  set format xy '10^{%T}'
  set xlabel 'found by '.method.' (s)'
  set ylabel 'by the regression (s)'
  set key right bottom samplen 1.5
  set size square
  set xrange [8e-6:6e-2]
  set yrange [8e-6:6e-2]
  quadratic(a, b, c, h) = 10**(a*log10(h)**2 + b*log10(h) + c)
  a1(wave, h) = wave eq 'S' ? quadratic(c_S[1], c_S[2], c_S[3], h) : quadratic(c_P[1], c_P[2], c_P[3], h)
  a2(wave, h) = wave eq 'S' ? quadratic(d_S[1], d_S[2], d_S[3], h) : quadratic(d_P[1], d_P[2], d_P[3], h)
  do for [wave in 'S P'] {
    set title (wave eq 'S' ? 'shear wave' : 'pressure wave')
    plot '+' using 1:($1/1.2):($1*1.2) with filledcurves fillcolor rgb '#e4e4e4' notitle, '+' using 1:1 with lines linetype 6 notitle, \
      'limits.csv' using (column(column_of(5))):(strcol(1) eq wave && $4 < 0.23 ? $7 : NaN) with points linetype 2 pointtype 4 pointsize 1 title 'Table 2 as printed', \
      '' using (column(column_of(5))):(strcol(1) eq wave && $4 < 0.23 ? a1(wave, $4)*($2/$3)**a2(wave, $4) : NaN) with points linetype 1 pointsize 0.8 title 'own regression'
  }
}
unset multiplot
