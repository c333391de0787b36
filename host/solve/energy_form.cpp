#include "solve/energy_form.h"

#include <algorithm>
#include <map>

namespace pvg {
namespace {

/// A couple's vertices hang on one another, through others where curves cross.
int coupled_root(const std::vector<int>& follows, int v) {
    while (follows[v] != none) v = follows[v];
    return v;
}

void integrate_sources(const Domain& domain, EnergyForm& form) {
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
    form.load_first.assign(domain.surface.vertex_count() + 1, 0);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const Part& part = parts[i];
        if (i > 0 && parts[i - 1].vertex == part.vertex && parts[i - 1].source == part.source) {
            form.loads.back().second += part.load;
        } else {
            form.loads.emplace_back(part.source, part.load);
            ++form.load_first[part.vertex + 1];
        }
    }
    for (std::size_t v = 1; v < form.load_first.size(); ++v) form.load_first[v] += form.load_first[v - 1];
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

EnergyForm energy_form(const Domain& domain) {
    EnergyForm form{surface_stiffness(domain.surface, border_conditions(domain)), {}, {}};
    integrate_sources(domain, form);
    return form;
}

}  // namespace pvg
