# deflection.gp - deflection.csv.   second: line of the title; reference: its name
width = 900; height = 600
load 'style.gp'
set title named('Deflection of the axis', second)
set xlabel 'x from the loaded end (m)'
set ylabel 'deflection v (m)'
plot 'deflection.csv' using 'x_m':'v_reference_m' with lines linetype 2 dashtype '--' title reference, \
  '' using 'x_m':'v_m' with points linetype 1 title 'particles'
