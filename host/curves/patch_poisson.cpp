#include "curves/patch_poisson.h"

#include <map>

#include "mesh/border_points.h"
#include "pvg/status.h"

namespace pvg {
namespace {

/// here, zero: per vertex of the part the one that its copies are, and whether that is held at 0. The two sides of a slit are
/// one vertex each, so the edges between them are the two sides of one.
BorderConditions border_conditions(const SlitSurface& part, std::span<const int> here, std::span<const char> zero) {
    const Surface& surface = part.surface;
    const int count = surface.vertex_count();
    BorderConditions border{std::vector<char>(count, 0), std::vector<int>(count, none)};
    for (int v = 0; v < count; ++v) border.fixed[v] = zero[here[v]];
    std::map<std::pair<int, int>, int> by_ends;
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        if (surface.twin(h) != none)
            continue;
        const int from = surface.origin(h), to = surface.target(h);
        if (const auto found = by_ends.find({here[to], here[from]}); found != by_ends.end()) {
            border.other_side[from] = found->second;
            border.other_side[found->second] = from;
        } else {
            by_ends[{here[from], here[to]}] = from;
        }
    }
    return border;
}

}  // namespace

PatchPoisson::PatchPoisson(const SlitSurface& part, int parent_vertices, std::span<const char> zero_halfedges)
    : vertex_(parent_vertices, none) {
    const Surface& surface = part.surface;
    int count = 0;
    here_.resize(surface.vertex_count());
    for (int v = 0; v < surface.vertex_count(); ++v) {
        int& vertex = vertex_[part.vertex_parent[v]];
        if (vertex == none)
            vertex = count++;
        here_[v] = vertex;
    }
    std::vector<char> zero(count, 0);
    faces_ = surface.faces();
    for (int f = 0; f < surface.face_count(); ++f) {
        areas_.push_back(surface.face_area(f));
        for (int& v : faces_[f]) v = here_[v];
        for (int k = 0; k < 3; ++k)
            if (zero_halfedges[3 * part.face_parent[f] + k])
                zero[faces_[f][k]] = zero[faces_[f][(k + 1) % 3]] = 1;
    }

    cut_stiffness_ = surface_stiffness(surface, border_conditions(part, here_, zero));
    unknown_.assign(count, none);
    for (int v = 0; v < count; ++v)
        if (!zero[v])
            unknown_[v] = unknown_count_++;
    std::vector<Eigen::Triplet<double>> all, entries;
    for (int column = 0; column < cut_stiffness_.outerSize(); ++column)
        for (Eigen::SparseMatrix<double>::InnerIterator it(cut_stiffness_, column); it; ++it) {
            const int a = here_[it.row()], b = here_[column];
            all.emplace_back(a, b, it.value());
            if (unknown_[a] != none && unknown_[b] != none)
                entries.emplace_back(unknown_[a], unknown_[b], it.value());
        }
    stiffness_.resize(count, count);
    stiffness_.setFromTriplets(all.begin(), all.end());
    if (unknown_count_ == 0)
        return;
    Eigen::SparseMatrix<double> free(unknown_count_, unknown_count_);
    free.setFromTriplets(entries.begin(), entries.end());
    factor_ = std::make_unique<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>(free);
    if (factor_->info() != Eigen::Success || !(factor_->vectorD().minCoeff() > 0))
        throw Error(ErrorKind::bad_input,
                    "its own problem cannot be solved: a part of it has no border, or its triangles have no area");
}

Eigen::VectorXd PatchPoisson::load_of(std::span<const double> face_value) const {
    Eigen::VectorXd load = Eigen::VectorXd::Zero(vertex_count());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
        if (face_value[f] == 0)
            continue;
        for (int v : faces_[f]) load[v] += face_value[f] * areas_[f] / 3;
    }
    return load;
}

Eigen::VectorXd PatchPoisson::load_of_jump(const Eigen::VectorXd& g) const {
    const Eigen::VectorXd residual = cut_stiffness_ * g;
    Eigen::VectorXd load = Eigen::VectorXd::Zero(vertex_count());
    for (std::size_t v = 0; v < here_.size(); ++v) load[here_[v]] += residual[static_cast<Eigen::Index>(v)];
    return load;
}

Eigen::VectorXd PatchPoisson::solve(const Eigen::VectorXd& load) const {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(vertex_count());
    if (unknown_count_ == 0)
        return u;
    Eigen::VectorXd right(unknown_count_);
    for (int v = 0; v < vertex_count(); ++v)
        if (unknown_[v] != none)
            right[unknown_[v]] = -load[v];
    const Eigen::VectorXd solved = factor_->solve(right);
    for (int v = 0; v < vertex_count(); ++v)
        if (unknown_[v] != none)
            u[v] = solved[unknown_[v]];
    return u;
}

Eigen::VectorXd PatchPoisson::flux(const Eigen::VectorXd& u, const Eigen::VectorXd& load) const {
    Eigen::VectorXd out = stiffness_ * u + load;
    for (int v = 0; v < vertex_count(); ++v)
        if (unknown_[v] != none)
            out[v] = 0;
    return out;
}

Eigen::VectorXd PatchPoisson::harmonic(const Eigen::VectorXd& border) const {
    Eigen::VectorXd u = border;
    for (int v = 0; v < vertex_count(); ++v)
        if (unknown_[v] != none)
            u[v] = 0;
    return u + solve(stiffness_ * u);
}

std::vector<double> PatchPoisson::face_means(const Eigen::VectorXd& u) const {
    std::vector<double> means(faces_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) means[f] = (u[faces_[f][0]] + u[faces_[f][1]] + u[faces_[f][2]]) / 3;
    return means;
}

}  // namespace pvg
