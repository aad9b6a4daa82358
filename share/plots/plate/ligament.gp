# ligament.gp - ligament.csv beside Kirsch.   second: line of the title; radius, end: of y (m)
width = 900; height = 600
load 'style.gp'
set title named('Stress {/Symbol s}_x above the hole', second)
set xlabel 'distance y from the centre of the hole (m)'
set ylabel 'stress {/Symbol s}_x along the tension (Pa)'
set xrange [radius:end]
plot 'ligament.csv' using 'y_m':'xx_exact_Pa' with lines linetype 2 dashtype '--' title 'theory of an infinite plate, Kirsch', \
  '' using 'y_m':'xx_Pa' with points linetype 1 pointsize 0.8 title 'particles'
