# stress.gp - stress-axis.csv or stress-section.csv.   file; first: title; along: column of x; x_name
width = 900; height = 600
load 'style.gp'
set title first
set xlabel x_name
set ylabel 'stress (Pa)'
set offsets 0, 0, graph 0.08, graph 0.08
plot file using along:'xx_exact_Pa' with lines linetype 1 dashtype '--' title 'bending stress {/Symbol s}_x, theory', \
  '' using along:'xx_Pa' with points linetype 1 title '{/Symbol s}_x, particles', \
  '' using along:'xy_exact_Pa' with lines linetype 2 dashtype '--' title 'shear stress {/Symbol t}_{xy}, theory', \
  '' using along:'xy_Pa' with points linetype 2 pointtype 5 title '{/Symbol t}_{xy}, particles'
