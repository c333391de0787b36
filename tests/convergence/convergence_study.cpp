// How errors fall with the mesh and with the knots, as a table and a plot. Two sweeps of each closed form:
//   mesh     finer meshes, knots a fixed number of edges apart; errors against the closed form
//   spacing  knots ever denser on the finest mesh, beside curves too (grading in proportion); errors against the
//            finite-element solution on the same vertices, which is all that knots can reach
// Five ways to a field: finite elements; the cell system's and the energy-optimal lambda, at the knots alone; the local basis
// with either. Writes convergence.csv and, where gnuplot is found, convergence.png to the folder that PVG_CONVERGENCE names.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "convergence/measured.h"

namespace pvg::fixtures {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> methods = {"fem", "lambda_cell", "lambda_energy", "basis_cell", "basis_energy"};
const std::string header =
    "problem,sweep,method,vertices,knots,h,spacing,l2_percent,mean_percent,max_percent,h1_percent,seconds,order_l2,order_h1";

/// Edges between knots at the default density on a mesh of 20,000 vertices.
constexpr double default_edges = 4;

struct Row {
    int vertices = 0;
    std::size_t knots = 0;
    double h = 0, spacing = 0;
    Norms norms;
    double seconds = 0;
};

/// Of one method in one sweep, from coarse to fine.
struct Series {
    std::string problem, sweep, method;
    std::vector<Row> rows;

    double order(double Norms::*norm) const {
        std::vector<double> size, error;
        for (const Row& row : rows) {
            size.push_back(sweep == "mesh" ? row.h : row.spacing);
            error.push_back(row.norms.*norm);
        }
        return fitted_order(size, error);
    }
};

struct Study {
    std::string name;
    std::function<AnalyticProblem(int)> at;
    std::vector<int> levels;
    bool smooth = true;
};

/// The five methods on one mesh with one spacing; knots so many edges apart.
std::vector<Row> measure(const AnalyticProblem& problem, const FemProblem& fem, const Eigen::VectorXd& solution,
                         double fem_seconds, const Eigen::VectorXd& reference, double edges, double grading) {
    const double h = mean_edge(problem.domain);
    const LocalSolution local(problem.domain, edges * h, grading);
    const std::size_t knots = local.knots.vertex.size();
    const auto row = [&](const Norms& norms, double seconds) {
        return Row{problem.domain.surface.vertex_count(), knots, h, edges * h, norms, seconds};
    };
    return {row(field_norms(fem, reference, solution), fem_seconds),
            row(local.knot_norms(reference, local.cell_lambda), local.cell_seconds),
            row(local.knot_norms(reference, local.energy_lambda), local.energy_seconds),
            row(field_norms(fem, reference, local.field(local.cell_lambda)), local.basis_seconds),
            row(field_norms(fem, reference, local.field(local.energy_lambda)), local.energy_seconds)};
}

std::vector<Series> run(const Study& study) {
    std::vector<Series> all;
    for (const char* sweep : {"mesh", "spacing"})
        for (const std::string& method : methods)
            if (std::string(sweep) == "mesh" || method != "fem")
                all.push_back({study.name, sweep, method, {}});
    const auto add = [&](const std::string& sweep, const std::vector<Row>& rows) {
        for (Series& series : all)
            if (series.sweep == sweep)
                series.rows.push_back(rows[std::find(methods.begin(), methods.end(), series.method) - methods.begin()]);
    };
    for (int level : study.levels) {
        const AnalyticProblem problem = study.at(level);
        const FemProblem fem = fem_problem(problem.domain);
        const Stopwatch watch;
        const Eigen::VectorXd solution = solve_finite_elements(fem).col(0);
        const double seconds = watch.seconds();
        add("mesh", measure(problem, fem, solution, seconds, problem.truth, default_edges, 1));
        if (level == study.levels.back())
            for (double edges : {10.0, 7.0, 5.0, 3.5, 2.5})
                add("spacing", measure(problem, fem, solution, seconds, solution, edges, edges / default_edges));
    }
    return all;
}

std::string csv_of(const std::vector<Series>& all) {
    std::ostringstream csv;
    csv << header << "\n";
    for (const Series& s : all)
        for (const Row& row : s.rows)
            csv << s.problem << "," << s.sweep << "," << s.method << "," << row.vertices << "," << row.knots << "," << row.h
                << "," << row.spacing << "," << row.norms.l2 << "," << row.norms.mean << "," << row.norms.max << ","
                << row.norms.h1 << "," << row.seconds << "," << s.order(&Norms::l2) << "," << s.order(&Norms::h1) << "\n";
    return csv.str();
}

/// Rows of the file with all their columns, every number finite and positive.
int complete_rows(const fs::path& file) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    EXPECT_EQ(line, header);
    int rows = 0;
    while (std::getline(stream, line)) {
        std::istringstream cells(line);
        int column = 0;
        for (std::string cell; std::getline(cells, cell, ','); ++column) {
            if (column < 3)
                continue;
            const double number = std::strtod(cell.c_str(), nullptr);
            EXPECT_TRUE(std::isfinite(number) && (column > 11 || number >= 0)) << line;
        }
        EXPECT_EQ(column, 14) << line;
        ++rows;
    }
    return rows;
}

TEST(ConvergenceStudy, OrdersHoldAndTheTableIsComplete) {
    const std::vector<Study> studies = {{"sphere band", sphere_band_problem, {8, 12, 16, 24, 32}},
                                        {"disk with source", disk_source_problem, {12, 17, 24, 34, 48}},
                                        {"cylinder with jump", cylinder_jump_problem, {8, 12, 16, 24, 32}},
                                        {"open slit", open_slit_problem, {12, 17, 24, 34, 48}, false}};
    std::vector<Series> all;
    for (const Study& study : studies)
        for (Series& series : run(study)) {
            const double l2 = series.order(&Norms::l2), h1 = series.order(&Norms::h1);
            std::printf("%-20s %-8s %-14s order L2 %5.2f  H1 %5.2f   finest: L2 %.5f %%  max %.4f %%  H1 %.3f %%\n",
                        series.problem.c_str(), series.sweep.c_str(), series.method.c_str(), l2, h1, series.rows.back().norms.l2,
                        series.rows.back().norms.max, series.rows.back().norms.h1);
            if (series.sweep == "mesh" && (series.method == "fem" || series.method == "basis_energy")) {
                if (study.smooth) {
                    EXPECT_GE(l2, 1.8) << series.problem << " " << series.method;
                } else {
                    EXPECT_NEAR(l2, 1, 0.1) << series.problem << " " << series.method;
                    EXPECT_NEAR(h1, 0.5, 0.1) << series.problem << " " << series.method;
                }
            }
            all.push_back(std::move(series));
        }
    const char* named = std::getenv("PVG_CONVERGENCE");
    const fs::path folder = named && *named ? fs::path(named) : fs::path(PVG_CONVERGENCE_FOLDER);
    fs::create_directories(folder);
    const fs::path csv = folder / "convergence.csv", png = folder / "convergence.png";
    std::ofstream(csv) << csv_of(all);
    int rows = 0;
    for (const Series& series : all) rows += static_cast<int>(series.rows.size());
    EXPECT_EQ(rows, 4 * 5 * (5 + 4));
    EXPECT_EQ(complete_rows(csv), rows);

    const std::string gnuplot = PVG_GNUPLOT;
    if (gnuplot.empty()) {
        std::printf("no gnuplot (Debian: gnuplot-nox): no plot\n");
        return;
    }
    fs::remove(png);
    const std::string command =
        "'" + gnuplot + "' -e \"csv='" + csv.string() + "'; png='" + png.string() + "'\" '" + std::string(PVG_PLOT_SCRIPT) + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    ASSERT_TRUE(fs::exists(png));
    EXPECT_GT(fs::file_size(png), 20000u);
    std::printf("wrote %s and %s\n", csv.c_str(), png.c_str());
}

}  // namespace
}  // namespace pvg::fixtures
