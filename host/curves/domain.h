// The domain of one Poisson problem: the part of the imprinted surface that its diffusion curves reach, slit along
// them (diffusion curves and sharp Poisson curves are cut open), with all data of the problem on it. It is what curves hand to
// the solver, and all that the finite-element oracle gets to see.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "mesh/surface.h"

namespace pvg {

/// What a control gives the values of: a diffusion curve's side, a Poisson curve's jump, or a Poisson region.
enum class ControlPart { left, right, jump, region };
enum class Quantity { color, height };

/// Values that the scene gives, as an editor turns them: stops along a curve (a region has one). Everything that a domain holds
/// is linear in its controls' values: the domain says where on which control each number is read and with which weight, so that
/// new values ask for no new geometry.
struct Control {
    std::string pointer;  ///< the primitive's place in the scene
    ControlPart part = ControlPart::left;
    Quantity quantity = Quantity::color;
    bool closed = false;    ///< the curve's parameter is periodic
    std::vector<double> t;  ///< stops, ascending in [0, 1]
    Eigen::MatrixXd value;  ///< stops x C: colours in the space of diffusion, heights; 0 in channels of the other quantity
    bool reached = true;    ///< false: part of it lies where no diffusion curve reaches, so its values may only be 0
};

/// weight times a control's value: that of one stop, or the one at parameter t.
struct ControlTerm {
    int control = none;
    int stop = none;  ///< none: at t
    double t = 0;
    double weight = 0;
    auto place() const { return std::tuple(control, stop, t); }
};
/// A sum over places on controls, each at most once, ascending.
using ControlSum = std::vector<ControlTerm>;

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

    /// What the numbers above are made of. A domain without controls has its values given directly.
    std::vector<Control> controls;
    std::vector<std::pair<int, ControlSum>> held;  ///< (Dirichlet vertex, its value), ascending
    std::vector<ControlSum> jumps;                 ///< as many as couplings
    std::vector<ControlSum> source_values;         ///< as many as sources

    std::vector<char>
        on_curve;  ///< V: 1 on any imprinted curve of this problem (DC, PC, region border, ring, strip): becomes a knot
    std::vector<char> feature;  ///< V: 1 where DCs cross, meet or end (grade towards these)
    std::vector<double>
        edge_length;  ///< V: the INPUT mesh's local edge length (mean at the parent's vertices), for the sizing field
};

/// Writes what the controls say now into dirichlet_value, the couplings' jumps and the sources' values. Requires controls.
void apply_controls(Domain& domain);

}  // namespace pvg
