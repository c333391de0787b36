#include "solve/patch_space.h"

#include <algorithm>
#include <map>

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

/// A couple's vertices hang on one another, through others where curves cross.
int coupled_root(const std::vector<int>& follows, int v) {
    while (follows[v] != none) v = follows[v];
    return v;
}

}  // namespace

BorderConditions border_conditions(const Domain& domain) {
    const Surface& surface = domain.surface;
    BorderConditions border{domain.dirichlet, std::vector<int>(surface.vertex_count(), none)};
    if (domain.couplings.empty())
        return border;
    std::vector<int> follows(surface.vertex_count(), none);
    for (const Coupling& coupling : domain.couplings)
        if (coupling.left != coupling.right)
            follows[coupling.left] = coupling.right;
    const auto coupled = [&](int v, int w) { return v != w && coupled_root(follows, v) == coupled_root(follows, w); };
    std::map<std::pair<int, int>, int> by_parents;
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        if (surface.twin(h) != none)
            continue;
        const int from = surface.origin(h), to = surface.target(h);
        const int parent_from = domain.vertex_parent[from], parent_to = domain.vertex_parent[to];
        const auto found = by_parents.find({parent_to, parent_from});
        if (found == by_parents.end()) {
            by_parents[{parent_from, parent_to}] = from;
            continue;
        }
        // At its ends the Poisson curve is one vertex, or meets a diffusion curve with a value on each side; a diffusion curve's
        // own edges have such ends only.
        const int other_from = found->second, other_to = surface.target(surface.outgoing(other_from));
        const auto faces = [&](int v, int w) { return v == w || coupled(v, w) || (domain.dirichlet[v] && domain.dirichlet[w]); };
        if (faces(from, other_to) && faces(to, other_from) && (coupled(from, other_to) || coupled(to, other_from))) {
            border.other_side[from] = other_from;
            border.other_side[other_from] = from;
        }
    }
    return border;
}

PatchSpace::PatchSpace(const Domain& domain_, const Knots& knots_, const Voronoi& voronoi)
    : EnergyForm{surface_stiffness(domain_.surface, border_conditions(domain_)), {}, {}},
      domain(domain_),
      knots(knots_),
      partner(coupled_partners(domain)),
      right(domain.surface.vertex_count(), none),
      log_map(domain.surface, partner) {
    for (const Coupling& coupling : domain.couplings) right[coupling.left] = coupling.right;
    join_cells(voronoi);
    sort_vertices(voronoi);
    integrate_sources();
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

void PatchSpace::integrate_sources() {
    struct Part {
        int vertex, source;
        double load;
    };
    std::vector<Part> parts;
    for (std::size_t s = 0; s < domain.sources.size(); ++s)
        for (const auto& [face, laplacian] : domain.sources[s].profile) {
            // Exact for a profile that is constant on the face.
            const double third = laplacian * domain.surface.face_area(face) / 3;
            for (int v : domain.surface.face(face)) parts.push_back({v, static_cast<int>(s), third});
        }
    std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
        return a.vertex != b.vertex ? a.vertex < b.vertex : a.source < b.source;
    });
    load_first.assign(domain.surface.vertex_count() + 1, 0);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const Part& part = parts[i];
        if (i > 0 && parts[i - 1].vertex == part.vertex && parts[i - 1].source == part.source) {
            loads.back().second += part.load;
        } else {
            loads.emplace_back(part.source, part.load);
            ++load_first[part.vertex + 1];
        }
    }
    for (std::size_t v = 1; v < load_first.size(); ++v) load_first[v] += load_first[v - 1];
}

}  // namespace pvg
