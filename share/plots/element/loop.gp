# loop.gp - path.csv as loops.   law: line of the title; triaxial; widest: strain; curved: a backbone g0*x/(1 + (|x|/reference)^curvature)
#   of g0 (kPa a %), reference (%)
width = 900; height = 640
load 'style.gp'
set title named('Loops of stress and strain', law)
set xlabel (triaxial ? 'axial' : 'shear').' strain (%)'
set ylabel (triaxial ? 'deviator' : 'shear').' stress (kPa)'
set zeroaxis
set xrange [-105*widest:105*widest]
set offsets 0, 0, graph 0.05, graph 0.05
plot curved ? g0*x/(1 + (abs(x)/reference)**curvature) : NaN dashtype '--' linecolor rgb red title curved ? 'backbone' : '', \
  'path.csv' using (100*column('strain')):((triaxial ? column('sxx') - column('szz') : column('sxy'))/1e3) with lines linetype 1 title 'path'
