#include "curves/strip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "curves/level_outside.h"
#include "curves/offset.h"
#include "curves/region.h"
#include "curves/slit.h"
#include "pvg/status.h"
#include "scene/scene.h"

namespace pvg {
namespace {

enum Side : int { left_side, right_side, tip };

/// The surface cut along the curve, with sources on both sides of the cut. Their positions are arc lengths along the curve.
struct CutCurve {
    SlitSurface cut;
    std::vector<SourceEdge> edges;
    std::vector<double> arc;  ///< per chain vertex, and the total at the end
    std::vector<int> seeds;   ///< faces along the curve
};

CutCurve cut_curve(const Surface& surface, const CurveChain& curve) {
    CutCurve result;
    std::vector<char> slit(surface.halfedge_count(), 0);
    mark_chain(surface, curve, slit);
    result.cut = slit_surface(surface, slit);
    result.arc.push_back(0);
    for (const ChainEdge& edge : chain_edges(surface, curve)) {
        const double from = result.arc.back(), to = from + surface.length(edge.left != none ? edge.left : edge.right);
        result.arc.push_back(to);
        if (edge.left != none)
            result.edges.push_back({edge.left, from, to, left_side});
        if (edge.right != none)
            result.edges.push_back({edge.right, to, from, right_side});
    }
    for (const SourceEdge& edge : result.edges) result.seeds.push_back(edge.halfedge / 3);
    return result;
}

CurveSources curve_sources(const CutCurve& curve, const CurveChain& chain, double spacing) {
    CurveSources sources = sources_along(curve.cut.surface, curve.edges, spacing);
    // An end that the cut does not divide belongs to neither side.
    if (!chain.closed)
        for (const std::size_t end : {std::size_t{0}, chain.vertices.size() - 1}) {
            const int copies =
                static_cast<int>(std::count(curve.cut.vertex_parent.begin(), curve.cut.vertex_parent.end(), chain.vertices[end]));
            if (copies != 1)
                continue;
            for (std::size_t s = 0; s < sources.sources.size(); ++s)
                if (sources.vertex[s] != none && curve.cut.vertex_parent[sources.vertex[s]] == chain.vertices[end])
                    sources.label[s] = tip;
        }
    return sources;
}

double parameter_at(const CutCurve& curve, const CurveChain& chain, double arc) {
    const auto next = std::upper_bound(curve.arc.begin() + 1, curve.arc.end() - 1, arc);
    const std::size_t i = static_cast<std::size_t>(next - curve.arc.begin());
    const double from = curve.arc[i - 1], to = curve.arc[i];
    // The closing edge of a closed curve ends at t = 1 (more by the seam's own parameter).
    const double t1 = i < chain.t.size() ? chain.t[i] : 1.0 + chain.t[0];
    return chain.t[i - 1] + (to > from ? (arc - from) / (to - from) : 0.0) * (t1 - chain.t[i - 1]);
}

}  // namespace

std::vector<SurfacePath> strip_borders(const Surface& drawn, const CurveChain& curve, double width) {
    const CutCurve cut = cut_curve(drawn, curve);
    const CurveSources sources = curve_sources(cut, curve, 0.1 * width);
    GeodesicOptions options;
    options.keep_windows = true;
    options.max_distance = 1.5 * width;
    const GeodesicField field = geodesic_distances(cut.cut.surface, sources.sources, options);
    return level_set(cut.cut.surface, field, sources.sources, width, 0.005 * width);
}

std::vector<std::vector<std::pair<int, double>>> strip_profiles(const Surface& imprinted, const CurveChain& curve,
                                                                const std::vector<CurveChain>& borders, double width,
                                                                const std::vector<double>& stops) {
    const CutCurve cut = cut_curve(imprinted, curve);
    const Surface& surface = cut.cut.surface;
    const CurveSources sources = curve_sources(cut, curve, 0.1 * width);
    GeodesicOptions options;
    options.max_distance = 1.5 * width;
    const GeodesicField field = geodesic_distances(surface, sources.sources, options);

    std::vector<char> barrier(imprinted.halfedge_count(), 0);
    for (const CurveChain& border : borders) mark_chain(imprinted, border, barrier);
    const std::vector<char> within = flood_faces(surface, barrier, cut.seeds);

    struct StripFace {
        int face;
        double arc;
        int side;
        double area;
        double moment;
    };
    std::vector<StripFace> faces;
    for (int f = 0; f < surface.face_count(); ++f) {
        if (!within[f])
            continue;
        const auto& [a, b, c] = surface.face(f);
        const double mean = (field.distance[a] + field.distance[b] + field.distance[c]) / 3;
        if (!(mean <= 1.05 * width))
            continue;  // beyond a border that snapping left a gap in
        const Point centroid = (surface.point(a) + surface.point(b) + surface.point(c)) / 3;
        const std::array<int, 3> roots{field.root[a], field.root[b], field.root[c]};
        const int root = nearest_of(surface, sources.sources, roots, centroid);
        if (root == none || sources.label[root] == tip)
            continue;
        const double area = surface.face_area(f);
        faces.push_back({f, sources.position[root], sources.label[root], area, area * mean});
    }

    // Pieces about half a strip long; one that lacks a side joins the next one.
    const double total = cut.arc.back();
    const int count = std::max(1, static_cast<int>(std::floor(total / (0.5 * width))));
    const auto piece_of = [&](double arc) { return std::clamp(static_cast<int>(arc / total * count), 0, count - 1); };
    struct Piece {
        std::array<double, 2> area{0, 0};
        std::array<double, 2> moment{0, 0};
        double begin = 0, end = 0;
    };
    std::vector<Piece> pieces(count);
    for (int i = 0; i < count; ++i) {
        pieces[i].begin = total * i / count;
        pieces[i].end = total * (i + 1) / count;
    }
    for (const StripFace& face : faces) {
        Piece& piece = pieces[piece_of(face.arc)];
        piece.area[face.side] += face.area;
        piece.moment[face.side] += face.moment;
    }
    std::vector<int> joined(count);
    std::vector<Piece> whole;
    const auto join = [](Piece& into, const Piece& other) {
        for (int side = 0; side < 2; ++side) {
            into.area[side] += other.area[side];
            into.moment[side] += other.moment[side];
        }
        into.begin = std::min(into.begin, other.begin);
        into.end = std::max(into.end, other.end);
    };
    const auto is_whole = [](const Piece& piece) { return piece.area[left_side] > 0 && piece.area[right_side] > 0; };
    bool open = false;
    for (int i = 0; i < count; ++i) {
        if (open)
            join(whole.back(), pieces[i]);
        else
            whole.push_back(pieces[i]);
        joined[i] = static_cast<int>(whole.size()) - 1;
        open = !is_whole(whole.back());
    }
    if (open && whole.size() > 1) {
        join(whole[whole.size() - 2], whole.back());
        whole.pop_back();
        for (int& piece : joined) piece = std::min(piece, static_cast<int>(whole.size()) - 1);
    }
    if (!is_whole(whole.back()))
        throw Error(ErrorKind::bad_input, "the curve has no surface on one of its sides, so nothing can step across it");

    std::vector<std::array<double, 2>> laplacian;
    for (const Piece& piece : whole) {
        const double length = piece.end - piece.begin;
        const double ratio = piece.area[left_side] / piece.area[right_side];
        const double f_left = -length / (piece.moment[left_side] + piece.moment[right_side] * ratio);
        laplacian.push_back({f_left, -f_left * ratio});
    }
    // One profile a stop, its hat function along the curve; what the pieces leave over is levelled against the sharp jump of the
    // same height.
    std::vector<char> keep(imprinted.face_count(), 0);
    for (int f = 0; f < imprinted.face_count(); ++f) {
        const auto& [a, b, c] = surface.face(f);
        keep[f] = within[f] && (field.distance[a] + field.distance[b] + field.distance[c]) / 3 <= 1.05 * width;
    }
    std::vector<char> slit(imprinted.halfedge_count(), 0);
    mark_chain(imprinted, curve, slit);
    const SlitSurface band = slit_surface(imprinted, slit, keep);
    const PatchPoisson own(band, imprinted.vertex_count(), barrier);
    std::vector<int> band_face(imprinted.face_count(), none);
    for (int f = 0; f < band.surface.face_count(); ++f) band_face[band.face_parent[f]] = f;
    std::vector<char> adjustable(band.surface.face_count(), 0);
    for (const StripFace& face : faces) adjustable[band_face[face.face]] = 1;

    // An end that the cut does not divide has no sides to jump between.
    const auto is_tip = [&](int v) {
        const int parent = band.vertex_parent[v];
        return !curve.closed && (parent == curve.vertices.front() || parent == curve.vertices.back()) &&
               !imprinted.is_border_vertex(parent);
    };
    std::vector<std::vector<std::pair<int, double>>> profiles;
    for (std::size_t k = 0; k < stops.size(); ++k) {
        Stops<double> hat{stops, std::vector<double>(stops.size(), 0.0)};
        hat.value[k] = 1;
        std::vector<double> value(band.surface.face_count(), 0.0);
        for (const StripFace& face : faces) {
            const Piece& piece = whole[joined[piece_of(face.arc)]];
            const double t = parameter_at(cut, curve, 0.5 * (piece.begin + piece.end));
            value[band_face[face.face]] = laplacian[joined[piece_of(face.arc)]][face.side] * evaluate_stops(hat, t, curve.closed);
        }
        Eigen::VectorXd jump = Eigen::VectorXd::Zero(band.surface.vertex_count());
        for (const SourceEdge& edge : cut.edges) {
            if (edge.label != left_side || band_face[edge.halfedge / 3] == none)
                continue;
            const int h = 3 * band_face[edge.halfedge / 3] + edge.halfedge % 3;
            for (const auto& [v, arc] :
                 {std::pair{band.surface.origin(h), edge.at_origin}, std::pair{band.surface.target(h), edge.at_target}})
                if (!is_tip(v))
                    jump[v] =
                        -evaluate_stops(hat, curve.closed && arc >= total ? 0.0 : parameter_at(cut, curve, arc), curve.closed);
        }
        const Eigen::VectorXd load = own.load_of(value) + own.load_of_jump(jump);
        // Forces of this size leave at most a thousandth of the jump outside (cpu_reference/ACCURACY.md).
        constexpr double most_force = 1.5e-3;
        const std::vector<double> change = level_outside(own, width, adjustable, load, most_force);
        double sum = 0, area = 0;
        for (int f = 0; f < band.surface.face_count(); ++f) {
            if (!adjustable[f])
                continue;
            value[f] += change[f];
            sum += value[f] * band.surface.face_area(f);
            area += band.surface.face_area(f);
        }
        std::vector<std::pair<int, double>> profile;
        for (int f = 0; f < band.surface.face_count(); ++f)
            if (adjustable[f])
                profile.emplace_back(band.face_parent[f], value[f] - sum / area);
        profiles.push_back(std::move(profile));
    }
    return profiles;
}

}  // namespace pvg
