#include "curves/arrangement.h"

#include <algorithm>
#include <string>
#include <utility>

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

Eigen::RowVectorXd joined(const Eigen::RowVectorXd& a, const Eigen::RowVectorXd& b) {
    Eigen::RowVectorXd both(a.size() + b.size());
    both << a, b;
    return both;
}

/// The columns of one or two groups over `channels` channels; the same profile of the same primitive is one column.
std::vector<GroupSource> merged_sources(const std::vector<const Group*>& groups, int channels) {
    std::vector<GroupSource> all;
    int first = 0;
    for (const Group* group : groups) {
        const std::size_t earlier = all.size();
        for (const GroupSource& source : group->sources) {
            Eigen::RowVectorXd value = Eigen::RowVectorXd::Zero(channels);
            value.segment(first, group->channels) = source.value;
            const auto end = all.begin() + static_cast<std::ptrdiff_t>(earlier);
            const auto same = std::find_if(
                all.begin(), end, [&](const GroupSource& s) { return s.drawn == source.drawn && s.profile == source.profile; });
            if (same != end)
                same->value += value;
            else
                all.push_back({source.drawn, source.profile, std::move(value)});
        }
        first += group->channels;
    }
    return all;
}

/// The reached part of groups that agree in slits and held vertices; channels in the order of the groups.
Domain make_domain(const Drawing& drawing, const std::vector<const Group*>& groups, const std::vector<double>& edge_length) {
    const Group& first = *groups.front();
    Domain domain;
    for (const Group* group : groups) domain.channels += group->channels;

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
        int channel = 0;
        for (const Group* group : groups) {
            if (domain.dirichlet[v])
                domain.dirichlet_value.row(v).segment(channel, group->channels) = group->value.row(cut_of_vertex[v]);
            channel += group->channels;
            domain.on_curve[v] |= group->on_curve[parent];
            domain.feature[v] |= group->feature[parent];
        }
    }
    for (std::size_t c = 0; c < first.couplings.size(); ++c) {
        const Coupling& coupling = first.couplings[c];
        Eigen::RowVectorXd jump = coupling.jump;
        if (groups.size() == 2)
            jump = joined(jump, groups[1]->couplings[c].jump);
        domain.couplings.push_back({vertex_of_cut[coupling.left], vertex_of_cut[coupling.right], std::move(jump)});
    }
    for (GroupSource& source : merged_sources(groups, domain.channels)) {
        SourceColumn column{drawing.primitives[source.drawn].primitive->name(), {}, std::move(source.value)};
        for (const auto& [face, laplacian] : source.profile) column.profile.emplace_back(face_of_parent[face], laplacian);
        domain.sources.push_back(std::move(column));
    }
    domain.surface = std::move(part.surface);
    domain.vertex_parent = std::move(part.vertex_parent);
    domain.face_parent = std::move(part.face_parent);
    return domain;
}

/// Groups that may share a domain: everything that the matrix depends on is the same.
bool agree(const Group& a, const Group& b) {
    const auto same_pair = [](const Coupling& x, const Coupling& y) { return x.left == y.left && x.right == y.right; };
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
