# style.gp - the look of all pictures. A template NAME.gp sets `width` and `height` in pixels and then
# loads this file; the program puts variables of its run in front and leaves the whole as NAME.gp
# beside the results, where `gnuplot NAME.gp` draws it again.
set terminal pngcairo size width,height enhanced font 'DejaVu Sans,15' linewidth 1.5
set output picture
set encoding utf8
set datafile separator ','
set datafile missing NaN
set datafile columnheaders
set border linecolor rgb '#333333'
set tics nomirror out
set grid linecolor rgb '#dddddd' linetype 1 linewidth 0.6
set key outside bottom center horizontal reverse Left samplen 2.5 height 1 # covers nothing
set xlabel offset 0,0.5
set samples 400

# Line types, told apart by lightness too: result, reference, then further results. Dashes are for
# references: theories, experiments, formulas.
blue = '#1f4e8c'; red = '#c0392b'; green = '#2e8b57'; orange = '#e08214'; purple = '#6c3483'; grey = '#888888'
set linetype 1 linecolor rgb blue linewidth 1.3 pointtype 7
set linetype 2 linecolor rgb red linewidth 1.3 pointtype 6
set linetype 3 linecolor rgb green linewidth 1.3 pointtype 5
set linetype 4 linecolor rgb orange linewidth 1.3 pointtype 9
set linetype 5 linecolor rgb purple linewidth 1.3 pointtype 13
set linetype 6 linecolor rgb grey linewidth 1 pointtype 4

# A title of two lines, the second one small.
named(first, second) = first."\n{/*0.85 ".second.'}'

# Colour maps, monotonic in lightness but for `signed`, whose middle is the lightest.
sand = "set palette defined (0 '#f3e3bd', 0.4 '#c98f4a', 1 '#5b2c12')"
water = "set palette defined (0 '#2c3e8f', 0.35 '#4aa3c7', 0.7 '#b7e0a5', 1 '#f4d03f')"
blues = "set palette defined (0 '#e6ebf1', 0.15 '#c6dbef', 0.4 '#6baed6', 0.7 '#2171b5', 1 '#08306b')"
heat = "set palette defined (0 '#f7fbff', 0.35 '#9ecae1', 0.6 '#fdd49e', 0.8 '#ef6548', 1 '#7f0000')"
signed = "set palette defined (0 '#2c3e90', 0.5 '#e8e4d8', 1 '#b03020')"

# 1, 2 or 5 times a power of ten, at least or at most `v`; distance of at most `n` tics.
lead(v) = v/10.0**floor(log10(v))
round_up(v) = 10.0**floor(log10(v))*(lead(v) > 5 ? 10 : lead(v) > 2 ? 5 : lead(v) > 1 ? 2 : 1)
round_down(v) = 10.0**floor(log10(v))*(lead(v) >= 5 ? 5 : lead(v) >= 2 ? 2 : 1)
tics_of(length, n) = round_up(length/(n > 1.0 ? n*1.0 : 1.0))

# The scale of colours from cb_least to cb_most, taken to round numbers: `eval colours`. An end is
# marked where values from cb_lowest to cb_highest lie beyond it.
cb_mark(k) = k == cb_0 && cb_lowest < (k - 1e-6)*cb_step ? '≤ ' : k == cb_1 && cb_highest > (k + 1e-6)*cb_step ? '≥ ' : ''
colours = 'if (!(cb_most > cb_least)) { cb_most = cb_least + 1.0 }; cb_step = round_up((cb_most - cb_least)/6.0); '. \
  'cb_0 = int(floor(cb_least/cb_step + 1e-6)); cb_1 = int(ceil(cb_most/cb_step - 1e-6)); '. \
  "set cbrange [cb_0*cb_step:cb_1*cb_step]; set cbtics ('' cb_0*cb_step); ". \
  'do for [cb_k=cb_0:cb_1] { set cbtics add (sprintf("%s%.6g", cb_mark(cb_k), cb_k*cb_step) cb_k*cb_step) }'

# Frame k of a file of images, from the variables that the program writes: `eval "plot ".frame(NAME, NAME_bytes, k)`.
frame(image, bytes, k) = sprintf('%s skip=%d using 1 with image notitle', image, k*bytes)


