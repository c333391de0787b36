// From a scene to the problems it poses: all curves imprinted, regions, rings and strips found, the surface slit for each
// group, Dirichlet values, jumps and sources in place.
#pragma once

#include <array>
#include <vector>

#include "curves/domain.h"
#include "mesh/surface.h"
#include "mesh/surface_map.h"
#include "pvg/status.h"
#include "scene/scene.h"

namespace pvg {

/// Which domain and which of its channels carry a layer's colour (4 channels from color_channel) and height.
struct LayerFields {
    int color_domain = none;  ///< none: no diffusion curve of the layer has a colour
    int color_channel = 0;
    int height_domain = none;
    int height_channel = 0;
};

/// An edge of the output surface where a diffusion curve slits the heights: the same edge (from, to along travel) by the output
/// vertices of its left and of its right side. At a tip or on an undivided vertex the two are equal.
struct SlitEdge {
    std::array<int, 2> left{none, none};
    std::array<int, 2> right{none, none};
    int left_face = none;  ///< output face on that side, or none (border)
    int right_face = none;
};

/// Everything decided about curves. Faces of `output` are those of `imprinted` (same numbers, same corner order).
struct Arrangement {
    RefinedSurface imprinted;        ///< unslit, with its map to the base surface
    Surface output;                  ///< slit along the union of all groups' slits
    std::vector<int> output_parent;  ///< output vertex -> vertex of imprinted.surface

    std::vector<Domain> domains;  ///< groups whose diffusion curves agree (same slits, same fixed vertices) share one
    std::vector<std::vector<int>>
        domain_vertex;                ///< per domain: output vertex -> vertex of the domain's surface, or none where not reached
    std::vector<LayerFields> layers;  ///< per layer of the scene
    std::vector<SlitEdge> height_slits;  ///< where heights may differ (walls)
};

/// base: the welded, subdivided surface. raw_face_of_base, raw_to_welded: to resolve scene points given by face of the file.
struct BaseSurface {
    Surface surface;                                       ///< what curves are drawn on
    SurfaceMap map;                                        ///< to the welded surface
    Surface welded;                                        ///< the input
    std::vector<int> face_raw;                             ///< per welded face: raw face
    std::vector<std::array<Point, 2>> non_manifold_edges;  ///< of the welded input, for messages
};

/// Lengths of the scene times this are mesh units (the scene's length_unit).
double length_unit(const Scene& scene, const Surface& welded);

/// Throws Error(bad_input) "FILE: POINTER: ..." when a rule of scenes/FORMAT.md ("Where curves meet, end and overlap") is broken.
Arrangement arrange(const Scene& scene, const BaseSurface& base, Warnings& warnings);

}  // namespace pvg
