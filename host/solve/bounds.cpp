#include "solve/bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pvg {

std::vector<int> number_parts(const Domain& domain, int& count) {
    const Surface& surface = domain.surface;
    const int vertices = surface.vertex_count();
    std::vector<int> first(vertices + 1, 0), to;
    const auto each_edge = [&](const auto& visit) {
        for (int h = 0; h < surface.halfedge_count(); ++h) {
            visit(surface.origin(h), surface.target(h));
            visit(surface.target(h), surface.origin(h));
        }
        for (const Coupling& c : domain.couplings) {
            visit(c.left, c.right);
            visit(c.right, c.left);
        }
    };
    each_edge([&](int from, int) { ++first[from + 1]; });
    for (int v = 0; v < vertices; ++v) first[v + 1] += first[v];
    to.resize(first[vertices]);
    std::vector<int> end(first.begin(), first.end() - 1);
    each_edge([&](int from, int target) { to[end[from]++] = target; });

    std::vector<int> part(vertices, none), stack;
    count = 0;
    for (int seed = 0; seed < vertices; ++seed) {
        if (part[seed] != none || surface.outgoing(seed) == none)
            continue;
        part[seed] = count;
        stack.assign(1, seed);
        while (!stack.empty()) {
            const int v = stack.back();
            stack.pop_back();
            for (int i = first[v]; i < first[v + 1]; ++i)
                if (part[to[i]] == none) {
                    part[to[i]] = count;
                    stack.push_back(to[i]);
                }
        }
        ++count;
    }
    return part;
}

PartBounds part_bounds(const Domain& domain) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const Surface& surface = domain.surface;
    int count = 0;
    PartBounds bounds;
    bounds.part = number_parts(domain, count);
    bounds.low = Eigen::MatrixXd::Constant(count, domain.channels, infinity);
    bounds.high = Eigen::MatrixXd::Constant(count, domain.channels, -infinity);
    for (int v = 0; v < surface.vertex_count(); ++v)
        if (domain.dirichlet[v] && bounds.part[v] != none) {
            const int p = bounds.part[v];
            bounds.low.row(p) = bounds.low.row(p).cwiseMin(domain.dirichlet_value.row(v));
            bounds.high.row(p) = bounds.high.row(p).cwiseMax(domain.dirichlet_value.row(v));
        }
    const auto open = [&](int p, int channel) {
        bounds.low(p, channel) = -infinity;
        bounds.high(p, channel) = infinity;
    };
    const auto open_all = [&](int vertex, const Eigen::RowVectorXd& values) {
        for (int c = 0; c < domain.channels; ++c)
            if (values[c] != 0)
                open(bounds.part[vertex], c);
    };
    for (const SourceColumn& source : domain.sources)
        for (const auto& [face, laplacian] : source.profile)
            if (laplacian != 0)
                open_all(surface.face(face)[0], source.value);
    for (const Coupling& coupling : domain.couplings)
        if (bounds.part[coupling.left] != none)
            open_all(coupling.left, coupling.jump);
    for (int p = 0; p < count; ++p)
        for (int c = 0; c < domain.channels; ++c)
            if (bounds.low(p, c) > bounds.high(p, c))
                open(p, c);
    return bounds;
}

double keep_between_bounds(const Domain& domain, const Knots& knots, Eigen::MatrixXd& lambda) {
    const PartBounds bounds = part_bounds(domain);
    double moved = 0;
    for (Eigen::Index j = 0; j < lambda.rows(); ++j) {
        const int p = bounds.part[knots.vertex[j]];
        if (p == none)
            continue;
        for (Eigen::Index c = 0; c < lambda.cols(); ++c) {
            const double kept = std::clamp(lambda(j, c), bounds.low(p, c), bounds.high(p, c));
            moved = std::max(moved, std::abs(kept - lambda(j, c)));
            lambda(j, c) = kept;
        }
    }
    return moved;
}

}  // namespace pvg
