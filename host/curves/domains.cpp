#include "curves/arrangement.h"

#include <algorithm>
#include <string>
#include <utility>

#include "curves/controls.h"
#include "curves/drawing.h"
#include "curves/group.h"
#include "curves/slit.h"

namespace pvg {
namespace {

/// Mean length of the edges at each vertex (0 where there is none).
std::vector<double> mean_edge_lengths(const Surface& surface) {
    std::vector<double> sum(surface.vertex_count(), 0.0);
    std::vector<int> count(surface.vertex_count(), 0);
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        if (surface.twin(h) != none && surface.twin(h) < h)
            continue;
        const double length = surface.length(h);
        for (const int v : {surface.origin(h), surface.target(h)}) {
            sum[v] += length;
            ++count[v];
        }
    }
    for (std::size_t v = 0; v < sum.size(); ++v)
        if (count[v] > 0)
            sum[v] /= count[v];
    return sum;
}

/// A sum over one group's controls as one over a domain's, in which they begin at `first`.
ControlSum shifted(ControlSum sum, int first) {
    for (ControlTerm& term : sum) term.control += first;
    return sum;
}

/// The columns of one or two groups; the same profile of the same primitive is one column. first: each group's first control.
std::vector<GroupSource> merged_sources(const std::vector<const Group*>& groups, const std::vector<int>& first) {
    std::vector<GroupSource> all;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const std::size_t earlier = all.size();
        for (const GroupSource& source : groups[g]->sources) {
            const auto end = all.begin() + static_cast<std::ptrdiff_t>(earlier);
            const auto same = std::find_if(
                all.begin(), end, [&](const GroupSource& s) { return s.drawn == source.drawn && s.profile == source.profile; });
            if (same != end)
                add_scaled(same->value, shifted(source.value, first[g]), 1);
            else
                all.push_back({source.drawn, source.profile, shifted(source.value, first[g])});
        }
    }
    return all;
}

/// The groups' controls in their order, values over all channels. Returns the number of each group's first one.
std::vector<int> take_controls(const std::vector<const Group*>& groups, Domain& domain) {
    std::vector<int> first;
    int channel = 0;
    for (const Group* group : groups) {
        first.push_back(static_cast<int>(domain.controls.size()));
        for (const Control& control : group->controls) {
            domain.controls.push_back(control);
            domain.controls.back().value = Eigen::MatrixXd::Zero(control.value.rows(), domain.channels);
            domain.controls.back().value.middleCols(channel, group->channels) = control.value;
        }
        channel += group->channels;
    }
    return first;
}

/// The reached part of groups that agree in slits and held vertices; channels in the order of the groups.
Domain make_domain(const Drawing& drawing, const std::vector<const Group*>& groups, const std::vector<double>& edge_length) {
    const Group& first = *groups.front();
    Domain domain;
    for (const Group* group : groups) domain.channels += group->channels;
    const std::vector<int> first_control = take_controls(groups, domain);

    SlitSurface part = slit_surface(drawing.imprinted.surface, first.slit, first.reached);
    std::vector<int> vertex_of_cut(first.cut.surface.vertex_count(), none);
    std::vector<int> cut_of_vertex(part.surface.vertex_count(), none);
    std::vector<int> face_of_parent(drawing.imprinted.surface.face_count(), none);
    for (int f = 0; f < part.surface.face_count(); ++f) {
        face_of_parent[part.face_parent[f]] = f;
        for (int k = 0; k < 3; ++k) {
            const int cut = first.cut.surface.face(part.face_parent[f])[k];
            vertex_of_cut[cut] = part.surface.face(f)[k];
            cut_of_vertex[part.surface.face(f)[k]] = cut;
        }
    }

    const int count = part.surface.vertex_count();
    domain.dirichlet.resize(count);
    domain.dirichlet_value = Eigen::MatrixXd::Zero(count, domain.channels);
    domain.on_curve.assign(count, 0);
    domain.feature.assign(count, 0);
    domain.edge_length.resize(count);
    for (int v = 0; v < count; ++v) {
        const int parent = part.vertex_parent[v];
        domain.edge_length[v] = edge_length[parent];
        domain.dirichlet[v] = first.dirichlet[cut_of_vertex[v]];
        for (const Group* group : groups) {
            domain.on_curve[v] |= group->on_curve[parent];
            domain.feature[v] |= group->feature[parent];
        }
    }
    for (std::size_t c = 0; c < first.couplings.size(); ++c) {
        const GroupCoupling& coupling = first.couplings[c];
        domain.couplings.push_back({vertex_of_cut[coupling.left], vertex_of_cut[coupling.right], {}});
        ControlSum& jump = domain.jumps.emplace_back();
        for (std::size_t g = 0; g < groups.size(); ++g)
            add_scaled(jump, shifted(groups[g]->couplings[c].jump, first_control[g]), 1);
    }
    for (std::size_t i = 0; i < first.held.size(); ++i) {
        const int v = vertex_of_cut[first.held[i].first];
        if (v == none)
            continue;
        ControlSum& value = domain.held.emplace_back(v, ControlSum{}).second;
        for (std::size_t g = 0; g < groups.size(); ++g)
            add_scaled(value, shifted(groups[g]->held[i].second, first_control[g]), 1);
    }
    std::sort(domain.held.begin(), domain.held.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (GroupSource& source : merged_sources(groups, first_control)) {
        SourceColumn column{drawing.primitives[source.drawn].primitive->name(), {}, {}};
        for (const auto& [face, laplacian] : source.profile) column.profile.emplace_back(face_of_parent[face], laplacian);
        domain.sources.push_back(std::move(column));
        domain.source_values.push_back(std::move(source.value));
    }
    apply_controls(domain);
    domain.surface = std::move(part.surface);
    domain.vertex_parent = std::move(part.vertex_parent);
    domain.face_parent = std::move(part.face_parent);
    return domain;
}

/// Groups that may share a domain: everything that the matrix depends on is the same.
bool agree(const Group& a, const Group& b) {
    const auto same_pair = [](const GroupCoupling& x, const GroupCoupling& y) { return x.left == y.left && x.right == y.right; };
    return a.slit == b.slit && a.dirichlet == b.dirichlet && a.reached == b.reached &&
           std::equal(a.couplings.begin(), a.couplings.end(), b.couplings.begin(), b.couplings.end(), same_pair);
}

/// The travel's direction along an edge that a group slits, as the halfedge whose face lies on the left.
int left_halfedge(const Drawing& drawing, const Group& group, int h) {
    const int twin = drawing.imprinted.surface.twin(h);
    if (group.side[h].drawn != none)
        return group.side[h].left ? h : twin;
    return std::min(h, twin);
}

}  // namespace

Arrangement arrange_drawing(const Scene& scene, const Surface& base, Drawing drawing, Warnings& warnings) {
    Arrangement result;
    const Surface& surface = drawing.imprinted.surface;
    std::vector<double> edge_length(surface.vertex_count(), 0.0);
    const std::vector<double> base_length = mean_edge_lengths(base);
    for (int v = 0; v < surface.vertex_count(); ++v) {
        const VertexOrigin& origin = drawing.imprinted.map.vertex[v];
        for (int i = 0; i < 3 && origin.vertex[i] != none; ++i)
            edge_length[v] += origin.weight[i] * base_length[origin.vertex[i]];
    }

    std::vector<char> output_slit(surface.halfedge_count(), 0);
    std::vector<int> wall(surface.halfedge_count(),
                          0);  // 1: a height may differ across the edge, and this halfedge's face is on the left
    for (std::size_t l = 0; l < scene.layers.size(); ++l) {
        const Group color = make_group(drawing, static_cast<int>(l), Quantity::color, scene.color_space, warnings);
        const Group height = make_group(drawing, static_cast<int>(l), Quantity::height, scene.color_space, warnings);
        LayerFields fields;
        const auto add = [&](const std::vector<const Group*>& groups) {
            result.domains.push_back(make_domain(drawing, groups, edge_length));
            return static_cast<int>(result.domains.size()) - 1;
        };
        if (color.bounded && height.bounded && agree(color, height)) {
            fields.color_domain = fields.height_domain = add({&color, &height});
            fields.height_channel = color.channels;
        } else {
            if (color.bounded)
                fields.color_domain = add({&color});
            if (height.bounded)
                fields.height_domain = add({&height});
        }
        result.layers.push_back(fields);
        for (const Group* group : {&color, &height})
            if (group->bounded)
                for (int h = 0; h < surface.halfedge_count(); ++h) output_slit[h] |= group->slit[h];
        if (height.bounded)
            for (int h = 0; h < surface.halfedge_count(); ++h)
                if (height.slit[h] && !wall[h] && !wall[surface.twin(h)])
                    wall[left_halfedge(drawing, height, h)] = 1;
    }

    SlitSurface output = slit_surface(surface, output_slit);
    for (const Domain& domain : result.domains) {
        std::vector<int> vertex(output.surface.vertex_count(), none);
        for (int f = 0; f < domain.surface.face_count(); ++f)
            for (int k = 0; k < 3; ++k) vertex[output.surface.face(domain.face_parent[f])[k]] = domain.surface.face(f)[k];
        result.domain_vertex.push_back(std::move(vertex));
    }
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        if (!wall[h])
            continue;
        const int twin = surface.twin(h);
        result.height_slits.push_back({{output.surface.origin(h), output.surface.target(h)},
                                       {output.surface.target(twin), output.surface.origin(twin)},
                                       h / 3,
                                       twin / 3});
    }
    result.output = std::move(output.surface);
    result.output_parent = std::move(output.vertex_parent);
    result.imprinted = std::move(drawing.imprinted);
    return result;
}

}  // namespace pvg
