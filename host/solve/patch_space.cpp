#include "solve/patch_space.h"

#include <algorithm>

namespace pvg {
namespace {

std::vector<int> coupled_partners(const Domain& domain) {
    std::vector<int> partner(domain.surface.vertex_count(), none);
    // Where curves cross, several left copies share a right one: each is put into its ring.
    for (const Coupling& coupling : domain.couplings) {
        partner[coupling.left] = partner[coupling.right] == none ? coupling.right : partner[coupling.right];
        partner[coupling.right] = coupling.left;
    }
    return partner;
}

}  // namespace

PatchSpace::PatchSpace(const Domain& domain_, const Knots& knots_, const Voronoi& voronoi)
    : EnergyForm(energy_form(domain_)),
      domain(domain_),
      knots(knots_),
      partner(coupled_partners(domain)),
      right(domain.surface.vertex_count(), none),
      log_map(domain.surface, partner) {
    for (const Coupling& coupling : domain.couplings) right[coupling.left] = coupling.right;
    join_cells(voronoi);
    sort_vertices(voronoi);
}

void PatchSpace::join_cells(const Voronoi& voronoi) {
    const int cells = static_cast<int>(knots.vertex.size());
    std::vector<std::pair<int, int>> touching;
    for (const Coupling& coupling : domain.couplings) {
        const int a = knots.knot_of_vertex[coupling.left], b = knots.knot_of_vertex[coupling.right];
        if (a == none || b == none)
            continue;
        touching.emplace_back(a, b);
        touching.emplace_back(b, a);
    }
    for (int c = 0; c < cells; ++c)
        for (int e = voronoi.neighbour_first[c]; e < voronoi.neighbour_first[c + 1]; ++e)
            touching.emplace_back(c, voronoi.neighbours[e]);
    // Curves can be much finer than the mesh around: their cells are strips, and a coarse vertex in one of them has its
    // neighbours in strips far along. Cells that an edge joins without even a common neighbour are such.
    const auto near = [&](int a, int b) {
        const auto begin = [&](int c) { return voronoi.neighbours.begin() + voronoi.neighbour_first[c]; };
        const auto end = [&](int c) { return voronoi.neighbours.begin() + voronoi.neighbour_first[c + 1]; };
        if (std::binary_search(begin(a), end(a), b))
            return true;
        for (auto i = begin(a), j = begin(b); i != end(a) && j != end(b);) {
            if (*i == *j)
                return true;
            if (*i < *j)
                ++i;
            else
                ++j;
        }
        return false;
    };
    for (int v = 0; v < S.outerSize(); ++v)
        for (Eigen::SparseMatrix<double>::InnerIterator entry(S, v); entry; ++entry) {
            const int a = voronoi.cell[v], b = voronoi.cell[entry.row()];
            if (a != b && a != none && b != none && !near(a, b))
                touching.emplace_back(a, b);
        }
    std::sort(touching.begin(), touching.end());
    touching.erase(std::unique(touching.begin(), touching.end()), touching.end());
    neighbour_first.assign(cells + 1, 0);
    for (const auto& [a, b] : touching) {
        ++neighbour_first[a + 1];
        neighbours.push_back(b);
    }
    for (int c = 0; c < cells; ++c) neighbour_first[c + 1] += neighbour_first[c];
}

void PatchSpace::sort_vertices(const Voronoi& voronoi) {
    const int cells = static_cast<int>(knots.vertex.size()), vertices = domain.surface.vertex_count();
    cell_first.assign(cells + 1, 0);
    for (int v = 0; v < vertices; ++v)
        if (voronoi.cell[v] != none)
            ++cell_first[voronoi.cell[v] + 1];
    for (int c = 0; c < cells; ++c) cell_first[c + 1] += cell_first[c];
    cell_vertices.resize(cell_first[cells]);
    std::vector<int> fill(cell_first.begin(), cell_first.end() - 1);
    for (int v = 0; v < vertices; ++v)
        if (voronoi.cell[v] != none)
            cell_vertices[fill[voronoi.cell[v]]++] = v;
}

}  // namespace pvg
