#include "solve/green_operator.h"

#include <string>

#include <Eigen/SparseCholesky>

#include "mesh/border_points.h"
#include "mesh/intrinsic.h"
#include "pvg/status.h"

namespace pvg {

using SparseMatrix = Eigen::SparseMatrix<double>;
using Four = Eigen::Array4d;

struct GreenOperator::Factor {
    Eigen::SimplicialLDLT<SparseMatrix> ldlt;
    Eigen::VectorXd pivots;
};

GreenOperator::GreenOperator(const Surface& surface) : factor_(std::make_unique<Factor>()) {
    const int vertices = surface.vertex_count();
    IntrinsicTriangulation triangulation = intrinsic_triangulation(surface);
    make_delaunay(triangulation);
    lumped_area_ = lumped_areas(triangulation, vertices);
    S_ = surface_stiffness(surface, {});
    int components = 0;
    const std::vector<int> of_face = face_components(surface, &components);
    component_.assign(vertices, none);
    component_area_.assign(components, 0);
    place_.assign(vertices, none);
    std::vector<char> pinned(components, 0);
    int unknowns = 0;
    for (int v = 0; v < vertices; ++v) {
        if (surface.outgoing(v) == none)
            continue;
        const int c = component_[v] = of_face[Surface::face_of(surface.outgoing(v))];
        component_area_[c] += lumped_area_[v];
        if (pinned[c])
            place_[v] = unknowns++;
        pinned[c] = 1;
    }
    if (unknowns == 0)
        return;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(S_.nonZeros());
    for (int column = 0; column < vertices; ++column)
        for (SparseMatrix::InnerIterator entry(S_, column); entry; ++entry)
            if (place_[entry.row()] != none && place_[column] != none)
                entries.emplace_back(place_[entry.row()], place_[column], entry.value());
    SparseMatrix inner(unknowns, unknowns);
    inner.setFromTriplets(entries.begin(), entries.end());
    factor_->ldlt.compute(inner);
    if (factor_->ldlt.info() != Eigen::Success || !(factor_->ldlt.vectorD().minCoeff() > 0))
        throw Error(ErrorKind::bad_input, "Green's functions: the stiffness of " + std::to_string(unknowns) +
                                              " vertices is singular; the surface is too badly triangulated");
    factor_->pivots = factor_->ldlt.vectorD();
    const auto& order = factor_->ldlt.permutationP().indices();
    for (int& place : place_)
        if (place != none && order.size() > 0)
            place = order[place];
}

GreenOperator::~GreenOperator() = default;

void GreenOperator::apply(RowMatrix& columns, RowMatrix& work) const {
    const Eigen::Index width = columns.cols(), vertices = columns.rows(), n = factor_->pivots.size();
    work.resize(n, width);
    for (Eigen::Index v = 0; v < vertices; ++v)
        if (place_[v] != none)
            work.row(place_[v]) = columns.row(v);

    if (n > 0) {
        // matrixL() shows the strict lower triangle of L, column by column.
        const SparseMatrix& L = factor_->ldlt.matrixL().nestedExpression();
        const int* const first = L.outerIndexPtr();
        const int* const row = L.innerIndexPtr();
        const double* const value = L.valuePtr();
        double* const x = work.data();
        for (Eigen::Index k = 0; k < n; ++k) {
            double* const own = x + k * width;
            bool any = false;
            for (Eigen::Index q = 0; q < width && !any; ++q) any = own[q] != 0;
            if (!any)
                continue;  // charges are few: most of the way up there is nothing to hand on
            for (int p = first[k]; p < first[k + 1]; ++p) {
                double* const other = x + row[p] * width;
                for (Eigen::Index q = 0; q < width; q += 4)
                    Eigen::Map<Four>(other + q) -= value[p] * Eigen::Map<const Four>(own + q);
            }
        }
        for (Eigen::Index k = n - 1; k >= 0; --k) {
            double* const own = x + k * width;
            for (Eigen::Index q = 0; q < width; q += 4) {
                Four sum = Eigen::Map<const Four>(own + q) / factor_->pivots[k];
                for (int p = first[k]; p < first[k + 1]; ++p) sum -= value[p] * Eigen::Map<const Four>(x + row[p] * width + q);
                Eigen::Map<Four>(own + q) = sum;
            }
        }
    }
    for (Eigen::Index v = 0; v < vertices; ++v) {
        if (place_[v] != none)
            columns.row(v) = work.row(place_[v]);
        else
            columns.row(v).setZero();
    }
    remove_means(columns);
}

void GreenOperator::remove_means(RowMatrix& columns) const {
    RowMatrix means = RowMatrix::Zero(static_cast<Eigen::Index>(component_area_.size()), columns.cols());
    for (Eigen::Index v = 0; v < columns.rows(); ++v)
        if (component_[v] != none)
            means.row(component_[v]) += lumped_area_[v] * columns.row(v);
    for (std::size_t c = 0; c < component_area_.size(); ++c)
        if (component_area_[c] > 0)
            means.row(static_cast<Eigen::Index>(c)) /= component_area_[c];
    for (Eigen::Index v = 0; v < columns.rows(); ++v)
        if (component_[v] != none)
            columns.row(v) -= means.row(component_[v]);
}

}  // namespace pvg
