// Domains on good and bad triangulations: squeezed, with open banks, with a sharp Poisson curve.
#pragma once

#include <vector>

#include "fixtures/domains.h"
#include "solve/basis_problems.h"

namespace pvg::fixtures {

/// The domain squeezed in y and sheared: the same chains and numbers, obtuse triangles everywhere.
inline Domain squeezed(Domain domain, double factor) {
    domain.surface = transformed(
        domain.surface, [&](const Point& p) { return Point(p.x() + 0.5 * p.y(), factor * p.y(), 0.1 * std::sin(4 * p.x())); });
    measure_edges(domain);
    return domain;
}

/// The left bank of each diffusion curve is open: natural there.
inline Domain half_open(Domain domain) {
    const Surface& s = domain.surface;
    for (int v = 0; v < s.vertex_count(); ++v)
        if (domain.dirichlet[v] && s.is_border_vertex(v) && !domain.feature[v] &&
            s.point(s.target(s.outgoing(v))).x() > s.point(v).x()) {
            domain.dirichlet[v] = 0;
            domain.dirichlet_value.row(v).setZero();
        }
    return domain;
}

struct NamedDomain {
    const char* name;
    Domain domain;
};

inline std::vector<NamedDomain> bad_domains() {
    std::vector<NamedDomain> all;
    all.push_back({"slit square", slit_square(3000).domain});
    all.push_back({"slit square, open banks", half_open(slit_square(3000).domain)});
    all.push_back({"slit square, squeezed, open banks", half_open(squeezed(slit_square(3000).domain, 0.07))});
    all.push_back({"three curves, not Delaunay", three_curves(50, true, false)});
    all.push_back({"three curves, squeezed, open banks", half_open(squeezed(three_curves(50, true, false), 0.1))});
    all.push_back({"crossings and jump", crossings_and_jump(60)});
    all.push_back({"crossings and jump, squeezed", squeezed(crossings_and_jump(60), 0.15)});
    all.push_back({"sphere band", sphere_band(3000).domain});
    return all;
}

}  // namespace pvg::fixtures
