# maps.gp - frames of the area of the particles as panels, coloured by one quantity.
#   maps, image, image_bytes, x0, x1, y0, y1, cb_lowest, cb_highest: of the file of images
#   titles[]: of the panels; '' leaves one empty
#   heading, x_name, y_name, cb_name, palette, cb_least, cb_most
#   frame_of(k): number of the frame in panel k
#   cover(k): commands before panel k, 0 to maps - 1, that draw bodies; '' for none
# A panel fits a box of 400 x 560 pixels, wider than 4 heights one of 800; as many stand beside one another
# as fit 880.
ratio = (x1 - x0)*1.0/(y1 - y0)
box = maps > 1 && ratio < 4.0 ? 400.0 : 800.0
across = box < 560*ratio ? box : 560*ratio
gap = 40
columns = int((880.0 + gap)/(across + gap))
if (columns > maps) { columns = maps }
lines = int(ceil(maps/(columns*1.0)))
high = across/ratio
left = 115; above = strlen(heading) > 0 ? 75 : 40; foot = 75; line = high + (maps > 1 ? 50 : 0)
right = 170
width = int(left + columns*(across + gap) - gap + right)
if (width < 620) { left = left + (620 - width)/2; right = right + (620 - width)/2; width = 620 }
height = int(above + lines*line + foot - (maps > 1 ? 50 : 0))
load 'style.gp'
eval value(palette)
eval colours
unset grid
set xrange [x0:x1]
set yrange [y0:y1]
set xtics tics_of(x1 - x0, across/60)
set ytics tics_of(y1 - y0, high/45)
set cblabel cb_name offset 1
fit = lines*line < 420 ? 1 : 420.0/(lines*line)
set colorbox user origin screen 1 - (right - 15.0)/width, screen 0.5 - 0.3*fit size screen 15.0/width, screen 0.6*fit
set multiplot title heading
do for [k=0:maps-1] {
  i = k % columns; j = k/columns
  set lmargin at screen (left + i*(across + gap))/width
  set rmargin at screen (left + i*(across + gap) + across)/width
  set tmargin at screen 1 - (above + j*line)/height
  set bmargin at screen 1 - (above + j*line + high)/height
  if (k == 1) { unset colorbox }
  set title titles[k + 1] offset 0,-0.6
  last = k + columns >= maps
  set xlabel (last ? x_name : '') offset 0,0.5
  set ylabel (i == 0 ? y_name : '')
  set format x (last ? '%h' : '')
  set format y (i == 0 ? '%h' : '')
  if (strlen(titles[k + 1]) > 0 || maps == 1) {
    eval cover(k)
    eval 'plot '.frame(image, image_bytes, frame_of(k))
  }
}
unset multiplot
