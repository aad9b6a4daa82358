# displacement.gp - displacement.csv beside theory.   second: line of the title
width = 900; height = 600
load 'style.gp'
set title named('Displacement of the middle row', second)
set xlabel 'x (m)'
set ylabel 'displacement u along the tension (m)'
plot 'displacement.csv' using 'x_m':'u_exact_m' with lines linetype 2 title 'theory', \
  '' using 'x_m':'u_m' with points linetype 1 pointsize 1.1 title 'particles'
