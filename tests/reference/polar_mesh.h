// Disks, annuli and bands with known vertices, for problems with known solutions.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "cpu_reference/finite_elements.h"

namespace pvg::test {

/// Rings of vertices around a centre. Vertex (ring, column) has the polar coordinates radius[ring] and angle.
struct PolarMesh {
    FemProblem problem;
    int columns = 0;
    bool closed = true;          ///< the last column is glued to the first; else columns run from -pi to pi and stay apart
    bool centre = false;         ///< vertex 0 is the centre
    std::vector<double> radius;  ///< of each vertex
    std::vector<double> angle;   ///< of each vertex

    int vertex(int ring, int column) const { return (centre ? 1 : 0) + ring * columns + (closed ? column % columns : column); }
    int rings() const { return (static_cast<int>(radius.size()) - (centre ? 1 : 0)) / columns; }
};

/// radii ascending; a first radius of 0 is the centre. place maps (r, angle) to space.
inline PolarMesh polar_mesh(std::vector<double> radii, int columns, bool closed,
                            const std::function<Eigen::Vector3d(double, double)>& place) {
    PolarMesh mesh;
    mesh.columns = closed ? columns : columns + 1;
    mesh.closed = closed;
    mesh.centre = radii.front() == 0;
    const auto add = [&](double r, double angle) {
        mesh.radius.push_back(r);
        mesh.angle.push_back(angle);
        mesh.problem.points.push_back(place(r, angle));
    };
    if (mesh.centre) {
        add(0, 0);
        radii.erase(radii.begin());
    }
    for (double r : radii) {
        for (int k = 0; k < mesh.columns; ++k) add(r, -std::numbers::pi + 2 * std::numbers::pi * k / columns);
    }
    for (int k = 0; k < columns; ++k) {
        if (mesh.centre)
            mesh.problem.faces.push_back({0, mesh.vertex(0, k), mesh.vertex(0, k + 1)});
        for (int ring = 0; ring + 1 < static_cast<int>(radii.size()); ++ring) {
            const int a = mesh.vertex(ring, k), b = mesh.vertex(ring + 1, k), c = mesh.vertex(ring + 1, k + 1),
                      d = mesh.vertex(ring, k + 1);
            if ((ring + k) % 2) {
                mesh.problem.faces.push_back({a, b, c});
                mesh.problem.faces.push_back({a, c, d});
            } else {
                mesh.problem.faces.push_back({a, b, d});
                mesh.problem.faces.push_back({b, c, d});
            }
        }
    }
    return mesh;
}

inline Eigen::Vector3d in_the_plane(double r, double angle) { return {r * std::cos(angle), r * std::sin(angle), 0}; }
inline Eigen::Vector3d on_the_unit_sphere(double theta, double angle) {
    return {std::sin(theta) * std::cos(angle), std::sin(theta) * std::sin(angle), std::cos(theta)};
}

/// low, ..., high in n steps; a power above 1 grades towards low.
inline std::vector<double> steps(double low, double high, int n, double power = 1) {
    std::vector<double> result;
    for (int i = 0; i <= n; ++i) result.push_back(low + (high - low) * std::pow(double(i) / n, power));
    return result;
}

inline Eigen::RowVectorXd row(double value) { return Eigen::RowVectorXd::Constant(1, value); }

/// The known solution at the vertices.
inline Eigen::MatrixXd sampled(const PolarMesh& mesh, const std::function<double(double, double)>& u) {
    Eigen::MatrixXd result(static_cast<Eigen::Index>(mesh.radius.size()), 1);
    for (std::size_t v = 0; v < mesh.radius.size(); ++v)
        result(static_cast<Eigen::Index>(v), 0) = u(mesh.radius[v], mesh.angle[v]);
    return result;
}

/// Dirichlet values from u on one ring.
inline void fix_ring(PolarMesh& mesh, int ring, const std::function<double(double, double)>& u) {
    for (int k = 0; k < mesh.columns; ++k) {
        const int v = mesh.vertex(ring, k);
        mesh.problem.dirichlet.emplace_back(v, row(u(mesh.radius[v], mesh.angle[v])));
    }
}

}  // namespace pvg::test
