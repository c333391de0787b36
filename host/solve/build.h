// From a scene and a mesh to a program that evaluators run: all stages of the pipeline in their order.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "curves/arrangement.h"
#include "mesh/weld.h"
#include "pvg/program.h"
#include "pvg/status.h"
#include "scene/scene.h"
#include "solve/field.h"
#include "solve/galerkin_matrix.h"
#include "solve/knots.h"
#include "solve/system.h"
#include "solve/voronoi.h"

namespace pvg {

/// The selected mesh as a triangle soup: raw vertices, not welded.
struct MeshInput {
    std::span<const Point> points;
    std::span<const Point> normals;  ///< as many as points, or empty: none in the file
    std::span<const Face> faces;
};

struct BuildOptions {
    int threads = 0;          ///< 0: all cores; the result does not depend on it
    bool keep_forms = false;  ///< SolvedDomain::matrix and unbounded are kept, for editing values (solve/responses.h)
    /// Called at the start of each stage with its name ("curves", "knots", "voronoi", "system", "basis").
    std::function<void(const std::string&)> on_stage;
    /// Within the stage "basis" where that takes long: the part of a domain's columns that is done, 0 to 1. Called, as on_stage,
    /// on the thread that builds.
    std::function<void(double)> on_progress = {};
};

/// One domain's solution.
struct SolvedDomain {
    Knots knots;
    Voronoi voronoi;
    System system;
    Eigen::MatrixXd cell_lambda;  ///< knots x channels: control coefficients of the cell system
    Eigen::MatrixXd lambda;       ///< knots x channels: those that the program evaluates with (solve/field.h)
    Eigen::MatrixXd unbounded;    ///< knots x channels: lambda before it was put between the curves' values; empty: not kept
    GalerkinMatrix matrix;        ///< empty: not kept
};

/// Everything from the welded input to the evaluators' program.
struct Build {
    WeldedMesh welded;
    SurfaceMap base_map;  ///< from the surface that curves are drawn on to the welded one
    double unit = 1;      ///< mesh units of one length unit
    Arrangement arrangement;
    SurfaceMap map;  ///< from the imprinted surface to the welded one
    std::vector<SolvedDomain> domains;

    Program program;                  ///< one field a domain; output vertices are arrangement.output's
    std::vector<Face> corner_normal;  ///< per output face and corner: shading normal of the program, or none: nothing moves there
    std::vector<std::pair<std::string, double>> seconds;  ///< per stage, in order
};

/// The scene's own basis.
BasisChoice basis_choice(const Scene& scene);

/// Throws Error(bad_input) that names the scene's file and place.
Build build(const Scene& scene, const MeshInput& mesh, const BuildOptions& options, Warnings& warnings);

}  // namespace pvg
