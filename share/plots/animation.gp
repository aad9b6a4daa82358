# animation.gp - the frames of maps.gp one after the other as a GIF, each shown for `delay` hundredths of a second.
#   variables of maps.gp; wide: pixels of the picture
ratio = (x1 - x0)*1.0/(y1 - y0)
high = (wide - 200.0)/ratio < 70 ? 70.0 : (wide - 200.0)/ratio > 900 ? 900.0 : (wide - 200.0)/ratio
width = wide; height = int(high + 110)
load 'style.gp'
set output
set terminal gif animate delay delay loop 0 optimize size width,height enhanced font 'DejaVu Sans,11'
set output picture
eval value(palette)
eval colours
unset grid
set size ratio -1
set xrange [x0:x1]
set yrange [y0:y1]
set ytics tics_of(y1 - y0, high/26 < 4 ? high/26 : 4)
if (high < 156) { set cbtics tics_of(cb_most - cb_least, high/26) }
set xlabel x_name
set ylabel y_name
set cblabel cb_name offset 1.2
do for [k=0:maps - 1] {
  set title titles[k + 1] offset 0,-0.6
  eval cover(k)
  eval 'plot '.frame(image, image_bytes, frame_of(k))
}
