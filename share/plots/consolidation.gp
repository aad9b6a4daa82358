# consolidation.gp - profile.csv, rows of `points` lines each.   first: title; y_name; rows; points; column: of T; array names[rows]
width = 900; height = 700
load 'style.gp'
set title first
set xlabel 'excess pore pressure u/u_0'
set ylabel y_name
set yrange [*:*] reverse
set xrange [0:*]
set key outside right top vertical
set palette defined (0 '#440154', 0.33 '#31688e', 0.66 '#35b779', 1 '#e0c41e') # early to late, told apart by lightness
set cbrange [1:rows > 1 ? rows : 2]
unset colorbox
every_from(r) = (r - 1)*points
plot for [r=1:rows] 'profile.csv' every ::every_from(r)::every_from(r) + points - 1 using column + 2:column + 1:(r) with points pointtype 7 pointsize 0.8 linecolor palette title names[r], \
  for [r=1:rows] '' every ::every_from(r)::every_from(r) + points - 1 using column + 3:column + 1:(r) with lines linecolor palette notitle, NaN with lines linecolor black title 'lines: exact'
