// One cell's local problem: the vertices of the cells around it, their stiffness cut off from the rest (natural outer
// border), factored once. Its right-hand sides give the vertices of the cell and of the knots around as linear functions of
//   - the Dirichlet values and jumps inside the patch and its sources (Green's columns), and
//   - the flux through the patch's outer border, of the low harmonic polynomials in log-map coordinates (modes).
// Green's third identity needs the field or its flux on that border. The flux meets the diffusion curves that cut the patch at a
// right angle without a singularity; border values would jump there.
#pragma once

#include <array>
#include <complex>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "solve/envelope.h"
#include "solve/patch_space.h"

namespace pvg {

struct PatchOptions {
    int rings = 2;        ///< cells whose knots are fitted
    int outer_rings = 1;  ///< cells beyond them that belong to the patch,
    double reach = 1.2;   ///< as far as this many times the distance in space of the farthest fitted knot
    int degree = 5;       ///< of the harmonic polynomials
    int list = 24;        ///< most coefficients of a list, sources included; a multiple of 4
    int round_down = 16;  ///< lists this long are cut to a multiple of 4
};

/// A solved patch. Rows: the vertices of the list's knots in its order, then the vertices of the cell.
struct Patch {
    std::vector<int>
        list;  ///< coefficients: knots by ring and distance (the cell's own first), then knots.size() + source, ascending
    int list_knots = 0;
    std::vector<int> rows;         ///< vertex of the domain, or none: no edge joins it to the cell's knot
    RowMatrix known;               ///< rows x list: response to Dirichlet values, jumps and sources
    RowMatrix modes;               ///< rows x modes; with free_constant mode 0 is 1 everywhere
    bool free_constant = false;    ///< no Dirichlet value in the list
    std::vector<int> data;         ///< knots of the list (positions) that the modes are fitted to
    std::vector<int> fixed;        ///< knots of the list (positions) with a Dirichlet value; the modes vanish there
    RowMatrix polynomials;         ///< fixed x modes: the harmonic polynomials themselves there
    std::vector<double> distance;  ///< of the list's knots, by the log map
    double radius = 0;             ///< largest of them
};

/// Builds patches, one after another, with its own buffers: one object a thread.
class PatchSolver {
public:
    PatchSolver(const PatchSpace& space, const PatchOptions& options);
    void solve(int cell, Patch& patch);

private:
    using Complex = std::complex<double>;
    struct Candidate {
        int ring;
        double distance;
        int knot;
    };
    struct Anchors {
        std::array<int, 2> vertex{none, none};
        std::array<double, 2> distance{0, 0};
    };

    void gather(int cell);
    void join_edges();
    void choose_list(Patch& patch);
    void spread(std::vector<Candidate>& candidates, int wanted) const;
    void keep_copies_together(std::vector<Candidate>& candidates, int room) const;
    void attach_dirichlet();
    void number_unknowns();
    void open_columns(const Patch& patch);
    void add_offsets();
    void add_equations(const Patch& patch);
    void add_fluxes(const Patch& patch);
    void read_rows(int cell, Patch& patch) const;

    bool fixed(int v) const { return space_.domain.dirichlet[vertices_[v]] != 0; }
    /// The copy inside the patch that a left copy's jump stands against, or none.
    int right_of(int v) const { return space_.right[vertices_[v]] == none ? none : local_[space_.right[vertices_[v]]]; }
    /// Calls visit(copy) for the other copies inside the patch of a vertex on sharp Poisson curves.
    template <typename Visit>
    void for_copies(int v, const Visit& visit) const {
        const int vertex = vertices_[v];
        for (int copy = space_.partner[vertex]; copy != none && copy != vertex; copy = space_.partner[copy])
            if (local_[copy] >= 0)
                visit(local_[copy]);
    }
    std::array<int, 2> along_border(int v) const;
    std::pair<int, int> listed_sides(int left, int right);
    /// 1, Re z, Im z, Re z^2, Im z^2, ... of a vertex, lengths in units of scale_.
    void polynomials(int v, double* values) const;
    double* new_offset(int v);

    const PatchSpace& space_;
    PatchOptions options_;
    int modes_;

    std::vector<int> local_;         ///< V: number in the patch, or none
    std::vector<int> ring_of_cell_;  ///< N
    std::vector<int> cells_;
    std::vector<int> vertices_;  ///< of the domain, by breadth from the knot
    std::vector<Complex> place_;
    std::vector<int> edge_first_;  ///< patch vertices + 1
    std::vector<int> edge_to_;
    std::vector<double> edge_weight_;
    std::vector<char> outer_;       ///< an edge leaves the patch
    std::vector<int> entry_;        ///< position of the vertex's knot in the list, or none
    std::vector<Anchors> anchors_;  ///< Dirichlet vertices: the listed ones whose values they follow; a listed one follows itself
    std::vector<int> unknown_;      ///< none for Dirichlet vertices; both copies on a Poisson curve share one
    std::vector<int> first_column_;
    std::vector<int> offset_of_;  ///< row of offset_ that is added to the vertex's unknown (or is all there is), or none
    std::vector<double> offset_;
    std::vector<int> column_of_;  ///< list position -> right-hand side, or none
    std::vector<int> queue_;
    std::vector<std::pair<int, int>> sides_;
    int unknowns_ = 0, held_ = none, columns_ = 0, width_ = 0, offsets_ = 0;
    double scale_ = 1;
    bool has_dirichlet_ = false, anchored_ = false;
    LogMap::Buffers log_map_;
    EnvelopeCholesky factor_;
    RowMatrix X_;
};

}  // namespace pvg
