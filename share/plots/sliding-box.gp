# sliding-box.gp - forces.csv beside the confined block.   second: line of the title; exact (N/m), mu
width = 1000; height = 640
load 'style.gp'
set title named('Forces on the lower plate', second)
set xlabel 'time t (s)'
set ylabel 'force (N/m)'
set yrange [-0.05*exact:1.15*exact]
plot 'forces.csv' using 't_s':'Fy_N_m' with lines linetype 1 title 'normal force F_y', \
  '' using 't_s':'Fx_N_m' with lines linetype 2 title 'friction F_x', \
  exact dashtype '--' linecolor rgb blue title 'F_y of a confined block without friction', \
  mu*exact dashtype '--' linecolor rgb red title '{/Symbol m} times it'
