# Errors over edge length and over knot spacing, log-log. Called with csv and png set. Titles: the order fitted to the local basis
# with the energy-optimal lambda.
set datafile separator comma
set terminal pngcairo size 1900,1060 enhanced font "DejaVu Sans,13" linewidth 1.4
set output png
set logscale xy
set format y "10^{%T}"
set format x "%g"
set grid xtics ytics lc rgb "#d8d8d8" lw 0.5
set border lc rgb "#606060"
set xtics nomirror (0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3)
set ytics nomirror

problems = "'sphere band' 'disk with source' 'cylinder with jump' 'open slit'"
methods = "fem lambda_cell lambda_energy basis_cell basis_energy"
array label[5] = ["finite elements", "cell system's λ, at knots", "energy-optimal λ, at knots", "local basis, cell system's λ", "local basis, energy-optimal λ"]
array colour[5] = ["#222222", "#e69f00", "#56b4e9", "#d55e00", "#0072b2"]
array shape[5] = [5, 8, 10, 9, 11]

# Columns of the table: 6 h, 7 spacing, 8 L2, 13 fitted order of L2. Rows of other series are left out; those of one stand together.
pick(problem, sweep, method, k) = (strcol(1) eq problem && strcol(2) eq sweep && strcol(3) eq method) ? column(k) : NaN

set multiplot layout 2,4 margins 0.055,0.99,0.125,0.95 spacing 0.045,0.13
do for [row = 1:2] {
    sweep = row == 1 ? "mesh" : "spacing"
    over = row == 1 ? 6 : 7
    do for [p = 1:words(problems)] {
        problem = word(problems, p)
        unset key
        set xlabel (row == 1 ? "mean edge length h (knots 4 h apart)" : "knot spacing (on the finest mesh)")
        set ylabel (p > 1 ? "" : row == 1 ? "L2 error against the closed form, % of range" : "L2 difference from finite elements, % of range")
        if (row == 1) { set xrange [0.02:0.16] } else { set xrange [0.05:0.36] }
        set yrange [*:*]
        stats csv skip 1 using (pick(problem, sweep, "basis_energy", 13)) nooutput name "ORDER"
        set title sprintf("%s: basis of order %.2f", problem, ORDER_mean) font ",15" offset 0,-0.4
        if (row == 1) {
            stats csv skip 1 using (pick(problem, sweep, "fem", over)):(column(8)) nooutput name "FEM"
            order = problem eq "open slit" ? 1 : 2
            set key bottom right samplen 2
            set yrange [FEM_min_y * 0.4:*]  # below it: rounding, where a method is exact at the knots
            plot FEM_max_y * 0.5 * (x / FEM_max_x) ** order with lines dt 2 lw 1.2 lc rgb "#808080" title sprintf("order %d", order), \
                 for [m = 1:5] csv skip 1 using (pick(problem, sweep, word(methods, m), over)):(column(8)) \
                     with linespoints lc rgb colour[m] pt shape[m] ps 1.3 lw (m == 5 ? 2.4 : 1.6) notitle
        } else {
            plot for [m = 2:5] csv skip 1 using (pick(problem, sweep, word(methods, m), over)):(column(8)) \
                     with linespoints lc rgb colour[m] pt shape[m] ps 1.3 lw (m == 5 ? 2.4 : 1.6) notitle
        }
    }
}
# One legend for all panels.
set lmargin at screen 0.02; set rmargin at screen 0.98; set bmargin at screen 0.005; set tmargin at screen 0.05
unset title; unset xlabel; unset ylabel; unset border; unset tics; unset logscale
set xrange [0:1]; set yrange [0:1]
set key center center horizontal maxrows 1 samplen 3 font ",14"
plot NaN notitle, for [m = 1:5] keyentry with linespoints lc rgb colour[m] pt shape[m] ps 1.3 lw (m == 5 ? 2.4 : 1.6) title label[m]
unset multiplot
