# section.gp - displacement and plastic strain in the section through the axis.   first: title; x_name; quantities
#   array images[], lowest[], highest[], most[]; cover(k); the variables of maps.gp
panel = 560.0*(x1 - x0)/(y1 - y0)
width = int(quantities*(panel + 240)); height = 800
load 'style.gp'
set multiplot title first font ',18'
eval blues
unset grid
set xlabel x_name
set xrange [x0:x1]
set yrange [y0:y1]
set xtics tics_of(x1 - x0, panel/60)
set tmargin at screen 0.87
set bmargin at screen 0.87 - 560.0/height
eval cover(0)
do for [k=1:quantities] {
  from = 125.0 + (k - 1)*(panel + 240)
  set lmargin at screen from/width
  set rmargin at screen (from + panel)/width
  set ylabel (k == 1 ? 'z (m)' : '')
  set title (k == 1 ? 'Displacement (m)' : 'Plastic strain (-)')
  set colorbox user origin screen (from + panel + 18)/width, screen 0.3 size screen 16.0/width, screen 0.4
  cb_least = 0; cb_most = most[k]; cb_lowest = lowest[k]; cb_highest = highest[k]
  eval colours
  eval 'plot '.frame(images[k], image_bytes, 0)
}
unset multiplot
