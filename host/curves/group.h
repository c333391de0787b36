// One group, a layer's colour or its height, on the imprinted surface: which edges its curves slit, what each copy of a
// vertex is held at, which copies jump, what the sources are and which faces a diffusion curve reaches.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "curves/domain.h"
#include "curves/drawing.h"
#include "curves/slit.h"

namespace pvg {

/// Which primitive's side faces a halfedge: edge `edge` of the chain of primitives[drawn], seen from its left or right.
struct CurveSide {
    int drawn = none;
    int edge = none;
    bool left = false;
};

/// profile over faces of the imprinted surface, as in SourceColumn, times a sum of controls.
struct GroupSource {
    int drawn = none;
    std::vector<std::pair<int, double>> profile;
    ControlSum value;
};

/// A Coupling whose jump is a sum of controls.
struct GroupCoupling {
    int left = none;
    int right = none;
    ControlSum jump;
};

struct Group {
    int layer = none;
    Quantity quantity = Quantity::color;
    int channels = 0;               ///< 4 or 1
    bool bounded = false;           ///< some diffusion curve gives it a value; if not, all below is empty
    std::vector<char> slit;         ///< per halfedge of the imprinted surface: its edge is cut (both twins flagged)
    std::vector<CurveSide> side;    ///< per halfedge: the diffusion curve along it, or drawn none
    SlitSurface cut;                ///< all faces, cut along slit
    std::vector<Control> controls;  ///< values over the group's own channels
    std::vector<char> dirichlet;    ///< per vertex of cut
    std::vector<std::pair<int, ControlSum>> held;  ///< (vertex of cut that is Dirichlet, its value), ascending
    std::vector<GroupCoupling> couplings;          ///< over vertices of cut
    std::vector<GroupSource> sources;
    std::vector<char> reached;   ///< per face: in a part with a Dirichlet vertex (couplings join parts)
    std::vector<char> on_curve;  ///< per vertex of the imprinted surface
    std::vector<char> feature;   ///< per vertex of the imprinted surface
};

/// Throws Error(bad_input) naming the primitive when a source or jump lies where no diffusion curve of the group reaches.
Group make_group(const Drawing& drawing, int layer, Quantity quantity, ColorSpace space, Warnings& warnings);

}  // namespace pvg
