// The domain of one Poisson problem: the part of the imprinted surface that its diffusion curves reach, slit along
// them (diffusion curves and sharp Poisson curves are cut open), with all data of the problem on it. It is what curves hand to
// the solver, and all that the finite-element oracle gets to see.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "mesh/surface.h"

namespace pvg {

/// One column of sources: a fixed profile over faces, scaled by one coefficient per channel.
/// The Laplacian on face t is sum over columns of profile(t) * value(channel); f < 0 raises a bump.
struct SourceColumn {
    std::string primitive;                        ///< the primitive's name in messages
    std::vector<std::pair<int, double>> profile;  ///< (face of Domain::surface, Laplacian per unit coefficient), ascending
    Eigen::RowVectorXd value;                     ///< C
};

/// A sharp Poisson curve's two copies of one vertex: u(left) = u(right) + jump. Where curves cross, all further copies of a
/// vertex stand against the same `right`.
struct Coupling {
    int left = none;          ///< vertex of Domain::surface
    int right = none;         ///< vertex of Domain::surface
    Eigen::RowVectorXd jump;  ///< C
};

/// V vertices, F faces, C channels. Lengths are in the mesh's own units; values in the scene's.
struct Domain {
    Surface surface;                 ///< slit: the two sides of a slit edge have no twin and own vertices
    std::vector<int> vertex_parent;  ///< V: the vertex of the imprinted surface
    std::vector<int> face_parent;    ///< F: the face of the imprinted surface (corner order kept), ascending

    int channels = 0;
    std::vector<char> dirichlet;      ///< V: 1 where a diffusion curve fixes the value
    Eigen::MatrixXd dirichlet_value;  ///< V x C; rows of free vertices are 0
    std::vector<Coupling>
        couplings;  ///< each vertex is `left` in at most one, and then `right` in none; neither copy is Dirichlet
    std::vector<SourceColumn> sources;

    std::vector<char>
        on_curve;  ///< V: 1 on any imprinted curve of this problem (DC, PC, region border, ring, strip): becomes a knot
    std::vector<char> feature;  ///< V: 1 where DCs cross, meet or end (grade towards these)
    std::vector<double>
        edge_length;  ///< V: the INPUT mesh's local edge length (mean at the parent's vertices), for the sizing field
};

}  // namespace pvg
