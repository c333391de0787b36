#include "curves/imprint.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_set>
#include <utility>

#include "curves/split_mesh.h"
#include "pvg/status.h"

namespace pvg {
namespace {

constexpr double snap_to_vertex = 0.05;  // of the vertex's shortest incident edge
constexpr double snap_to_edge = 1e-3;    // of the length of an edge that stays: thinner triangles would stay too
constexpr double snap_to_free = 1e-7;    // of the length of an edge that can be flipped away
constexpr double snap_of_curve = 0.02;   // of the curve's length, at most: a small curve keeps its shape in a coarse triangle
constexpr double snap_floor = 1e-8;      // of the parent face's longest edge: shorter edges are not made, however curves crowd
constexpr double on_edge = 1e-10;        // a smaller barycentric coordinate means 0

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorKind::bad_input, "imprint: " + what); }

/// Exact zeros where a coordinate is only rounding, sum 1.
SurfacePoint cleaned(const Surface& surface, SurfacePoint at, std::size_t index) {
    const auto where = [&] { return "path point " + std::to_string(index); };
    if (at.face < 0 || at.face >= surface.face_count())
        refuse(where() + ": no face " + std::to_string(at.face) + " on the surface");
    if (!at.bary.allFinite() || at.bary.minCoeff() < -1e-6 || std::abs(at.bary.sum() - 1) > 1e-6)
        refuse(where() + ": barycentric coordinates must not be negative and must sum to 1");
    for (int k = 0; k < 3; ++k)
        if (at.bary[k] < on_edge)
            at.bary[k] = 0;
    at.bary /= at.bary.sum();
    return at;
}

struct Chain {
    std::vector<int> vertices;
    std::vector<double> t;
    double t_end = 1;  ///< of the closing edge
    bool closed = false;
};

}  // namespace

struct Imprinter::State {
    explicit State(const Surface& parent) : mesh(parent) {}

    SplitMesh mesh;
    std::vector<Chain> chains;
    double farthest_snap = 0;  ///< of the curve that is being imprinted

    Point place(int parent_face, const Eigen::Vector3d& bary) const { return mesh.parent().position({parent_face, bary}); }

    double snap_radius(int parent_face, int vertex) {
        const Surface& parent = mesh.parent();
        const double longest =
            std::max({parent.length(3 * parent_face), parent.length(3 * parent_face + 1), parent.length(3 * parent_face + 2)});
        const double shortest = mesh.shortest_edge(vertex);
        return std::isinf(shortest) ? snap_floor * longest
                                    : std::max(std::min(snap_to_vertex * shortest, farthest_snap), snap_floor * longest);
    }
    bool snaps(int parent_face, int vertex, const Point& at) {
        return (mesh.points()[vertex] - at).norm() < snap_radius(parent_face, vertex);
    }

    /// Signed area of (from, to, at), the same but for the sign from both sides of the edge.
    double side(int parent_face, int halfedge, const Eigen::Vector3d& at) const {
        const int u = mesh.from(halfedge), w = mesh.to(halfedge);
        const double area = orientation(mesh.bary(parent_face, std::min(u, w)), mesh.bary(parent_face, std::max(u, w)), at);
        return u < w ? area : -area;
    }

    int locate(int parent_face, const Eigen::Vector3d& at, int start) const;
    int edge_on_border(int parent_face, int k, const Eigen::Vector3d& at) const;
    int insert(int parent_face, const Eigen::Vector3d& at, int near_vertex);
    int facing(int parent_face, int from, const Eigen::Vector3d& end) const;
    int advance(int parent_face, int from, int target);
    int connect(int parent_face, int from, int to, std::vector<std::pair<int, int>>& crossed);
    int split_crossing(int halfedge, int parent_face, int from, int to);
    std::vector<int> walk(int parent_face, int from, int to);
};

/// The face of the parent face that contains a point: a walk that leaves each face through an edge that has the point behind it.
int Imprinter::State::locate(int parent_face, const Eigen::Vector3d& at, int start) const {
    int face = start;
    for (int step = 0; step < 200; ++step) {
        int leave = none;
        for (int i = 0; i < 3 && leave == none; ++i) {
            const int h = 3 * face + (i + step) % 3;  // another first edge each time, so that the walk does not run in circles
            if (mesh.inside_parent(h) && side(parent_face, h, at) < 0)
                leave = h;
        }
        if (leave == none)
            return face;
        face = mesh.twin(leave) / 3;
    }
    // The walk is long, or rounding has it running in circles: look at all faces of the parent face.
    std::unordered_set<int> seen{start};
    std::vector<int> stack{start};
    int best = start;
    double best_depth = -std::numeric_limits<double>::infinity();
    while (!stack.empty()) {
        const int f = stack.back();
        stack.pop_back();
        double depth = std::numeric_limits<double>::infinity();
        for (int h = 3 * f; h < 3 * f + 3; ++h) depth = std::min(depth, side(parent_face, h, at));
        if (depth > best_depth) {
            best_depth = depth;
            best = f;
        }
        if (depth >= 0)
            break;
        for (int h = 3 * f; h < 3 * f + 3; ++h)
            if (mesh.inside_parent(h) && seen.insert(mesh.twin(h) / 3).second)
                stack.push_back(mesh.twin(h) / 3);
    }
    return best;
}

/// The piece of the parent's edge opposite corner k on which a point lies, as a halfedge in the parent face.
int Imprinter::State::edge_on_border(int parent_face, int k, const Eigen::Vector3d& at) const {
    const int ahead = (k + 2) % 3;
    int vertex = mesh.parent().face(parent_face)[(k + 1) % 3];
    for (;;) {
        // Along the border with the face on the left: the first halfedge of the fan.
        const std::vector<int> fan = mesh.fan(vertex, parent_face);
        int along = none;
        for (int h : fan)
            if (mesh.bary(parent_face, mesh.to(h))[k] == 0 &&
                mesh.bary(parent_face, mesh.to(h))[ahead] > mesh.bary(parent_face, vertex)[ahead])
                along = h;
        if (along == none)
            refuse("internal: a border of face " + std::to_string(parent_face) + " is broken");
        vertex = mesh.to(along);
        const double reached = mesh.bary(parent_face, vertex)[ahead];
        if (reached >= at[ahead] || reached == 1)
            return along;
    }
}

/// The vertex for a path point: one that is there and near enough, or a new one.
int Imprinter::State::insert(int parent_face, const Eigen::Vector3d& at, int near_vertex) {
    const Face& corners = mesh.parent().face(parent_face);
    int zeros = 0, zero = none;
    for (int k = 0; k < 3; ++k) {
        if (at[k] == 0) {
            ++zeros;
            zero = k;
        }
        if (at[k] == 1)
            return corners[k];
    }
    const Point place_at = place(parent_face, at);
    const int start = near_vertex == none ? parent_face : mesh.fan(near_vertex, parent_face).front() / 3;
    const int face = locate(parent_face, at, start);

    // A point of a parent edge belongs to a second parent face too: it may only snap along that edge.
    // And a point on an edge that a curve holds stays on that curve.
    int held = none;
    for (int h = 3 * face; h < 3 * face + 3; ++h) {
        if (!mesh.fixed(h))
            continue;
        const Point &u = mesh.points()[mesh.from(h)], &w = mesh.points()[mesh.to(h)];
        const double s = std::clamp((place_at - u).dot(w - u) / (w - u).squaredNorm(), 0.0, 1.0);
        if ((u + s * (w - u) - place_at).norm() <= snap_to_free * (w - u).norm())
            held = h;
    }
    int nearest = none;
    double nearest_ratio = 1;
    const auto offer = [&](int vertex) {
        if (zeros == 1 && mesh.bary(parent_face, vertex)[zero] != 0)
            return;
        if (held != none && vertex != mesh.from(held) && vertex != mesh.to(held))
            return;
        const double ratio = (mesh.points()[vertex] - place_at).norm() / snap_radius(parent_face, vertex);
        if (ratio < nearest_ratio) {
            nearest_ratio = ratio;
            nearest = vertex;
        }
    };
    for (int h = 3 * face; h < 3 * face + 3; ++h) {
        offer(mesh.from(h));
        if (mesh.inside_parent(h))
            offer(mesh.apex(mesh.twin(h)));
    }
    if (nearest != none)
        return nearest;

    int split = zeros == 0 ? held : none;
    double split_ratio = split == none ? 1 : 0;
    for (int h = 3 * face; h < 3 * face + 3; ++h) {
        const Point &u = mesh.points()[mesh.from(h)], &w = mesh.points()[mesh.to(h)];
        const double s = (place_at - u).dot(w - u) / (w - u).squaredNorm();
        if (zeros == 1) {
            const bool on_border =
                mesh.bary(parent_face, mesh.from(h))[zero] == 0 && mesh.bary(parent_face, mesh.to(h))[zero] == 0;
            if (on_border && s > 0 && s < 1)
                split = h;
            continue;
        }
        const double edge = (w - u).norm();
        const double radius = mesh.stays(h) ? std::min(snap_to_edge * edge, 0.1 * farthest_snap) : snap_to_free * edge;
        const double ratio = (u + std::clamp(s, 0.0, 1.0) * (w - u) - place_at).norm() / radius;
        if (ratio < split_ratio) {
            split_ratio = ratio;
            split = h;
        }
    }
    if (zeros == 1) {
        if (split == none) {
            split = edge_on_border(parent_face, zero, at);
            for (int v : {mesh.from(split), mesh.to(split)})
                if (snaps(parent_face, v, place_at))
                    return v;
        }
        return mesh.split_edge(split, at);
    }
    if (split == none)
        return mesh.split_face(face, at);

    const int u = mesh.from(split), w = mesh.to(split);
    const Point along = mesh.points()[w] - mesh.points()[u];
    const double s = (place_at - mesh.points()[u]).dot(along) / along.squaredNorm();
    const Point foot = mesh.points()[u] + std::clamp(s, 0.0, 1.0) * along;
    if (snaps(parent_face, u, foot))
        return u;
    if (snaps(parent_face, w, foot))
        return w;
    return mesh.split_edge(split, (1 - s) * mesh.bary(parent_face, u) + s * mesh.bary(parent_face, w));
}

int Imprinter::State::split_crossing(int halfedge, int parent_face, int from, int to) {
    const int u = mesh.from(halfedge), w = mesh.to(halfedge);
    const Eigen::Vector3d at_u = mesh.bary(parent_face, u), at_w = mesh.bary(parent_face, w);
    const Eigen::Vector3d begin = mesh.bary(parent_face, from), end = mesh.bary(parent_face, to);
    const double right = std::abs(orientation(begin, end, at_u)), left = std::abs(orientation(begin, end, at_w));
    const double s = right + left > 0 ? right / (right + left) : 0.5;
    return mesh.split_edge(halfedge, (1 - s) * at_u + s * at_w);
}

/// The edge opposite `from` in the face of its fan that looks towards a point; by the largest margin, so that rounding cannot
/// leave none.
int Imprinter::State::facing(int parent_face, int from, const Eigen::Vector3d& end) const {
    const Eigen::Vector3d begin = mesh.bary(parent_face, from);
    int across = none;
    double best = -std::numeric_limits<double>::infinity();
    for (int h : mesh.fan(from, parent_face)) {
        const Eigen::Vector3d right = mesh.bary(parent_face, mesh.to(h)), left = mesh.bary(parent_face, mesh.apex(h));
        const double margin = std::min(orientation(begin, right, end) / (right - begin).norm(),
                                       -orientation(begin, left, end) / (left - begin).norm());
        if (margin > best) {
            best = margin;
            across = Surface::next(h);
        }
    }
    if (across == none)
        refuse("internal: vertex " + std::to_string(from) + " is not on face " + std::to_string(parent_face));
    return across;
}

/// One step from a vertex straight towards another of the same parent face: to the next vertex on the line, which is the target,
/// a vertex near the line, or a new one where the line crosses a fixed edge. Makes the edge and returns that vertex.
int Imprinter::State::advance(int parent_face, int from, int target) {
    int goal = target;
    std::vector<std::pair<int, int>> crossed;
    for (int attempt = 0;; ++attempt) {
        const bool may_snap = attempt < 32;
        crossed.clear();
        if (mesh.edge_between(from, goal) != none)
            return goal;
        const Eigen::Vector3d begin = mesh.bary(parent_face, from), end = mesh.bary(parent_face, goal);
        int across = facing(parent_face, from, end);
        int snapped = none;
        for (;;) {
            const int u = mesh.from(across), w = mesh.to(across);
            const double right = std::max(-orientation(begin, end, mesh.bary(parent_face, u)), 0.0);
            const double left = std::max(orientation(begin, end, mesh.bary(parent_face, w)), 0.0);
            const double s = right + left > 0 ? right / (right + left) : 0.5;
            const Point &at_u = mesh.points()[u], &at_w = mesh.points()[w], &at_goal = mesh.points()[goal];
            const Point crossing = at_u + s * (at_w - at_u);
            const double left_over = (mesh.points()[from] - at_goal).norm();
            double nearest = std::numeric_limits<double>::infinity();
            for (int v : {u, w}) {
                const double away = (mesh.points()[v] - crossing).norm();
                const bool nearer = (mesh.points()[v] - at_goal).norm() < left_over;
                if (v != from && nearer && away < nearest && ((may_snap && snaps(parent_face, v, crossing)) || away == 0)) {
                    nearest = away;
                    snapped = v;
                }
            }
            if (snapped != none)
                break;
            if (mesh.stays(across)) {
                const int n = split_crossing(across, parent_face, from, goal);
                return connect(parent_face, from, n, crossed);
            }
            crossed.emplace_back(u, w);
            const int inward = mesh.twin(across);  // w -> u, the apex beyond
            const int q = mesh.apex(inward);
            if (q == goal)
                return connect(parent_face, from, goal, crossed);
            across = orientation(begin, end, mesh.bary(parent_face, q)) > 0 ? Surface::next(inward) : Surface::prev(inward);
        }
        goal = snapped;
    }
}

/// Makes the edge from - to by flipping away the free edges that cross it, and returns `to`. Where rounding leaves no room for a
/// flip, the first edge in the way is split instead, and the vertex there is returned.
int Imprinter::State::connect(int parent_face, int from, int to, std::vector<std::pair<int, int>>& crossed) {
    const Eigen::Vector3d begin = mesh.bary(parent_face, from), end = mesh.bary(parent_face, to);
    std::size_t head = 0, stuck = 0, flips = 0;
    const std::size_t enough = 100 + crossed.size() * crossed.size();
    while (head < crossed.size() && stuck <= crossed.size() - head && flips < enough) {
        const auto [u, w] = crossed[head++];
        const int h = mesh.edge_between(u, w);
        if (h == none)
            continue;
        const int o = mesh.apex(h), p = mesh.twin(h) == none ? none : mesh.apex(mesh.twin(h));
        if (!mesh.flip(h)) {
            crossed.emplace_back(u, w);
            ++stuck;
            continue;
        }
        stuck = 0;
        ++flips;
        if (o == from || o == to || p == from || p == to)
            continue;
        const double side_o = orientation(begin, end, mesh.bary(parent_face, o)),
                     side_p = orientation(begin, end, mesh.bary(parent_face, p));
        if ((side_o > 0) != (side_p > 0))
            crossed.emplace_back(o, p);
    }
    if (mesh.edge_between(from, to) != none)
        return to;
    return split_crossing(facing(parent_face, from, end), parent_face, from, to);
}

/// The chain of edges from one vertex to another of the same parent face, the first left out.
std::vector<int> Imprinter::State::walk(int parent_face, int from, int to) {
    std::vector<int> passed;
    int at = from;
    while (at != to) {
        const int next = advance(parent_face, at, to);
        mesh.fix(mesh.edge_between(at, next));
        mesh.make_delaunay();
        passed.push_back(next);
        at = next;
        if (passed.size() > 1000000)
            refuse("internal: a line across face " + std::to_string(parent_face) + " does not end");
    }
    return passed;
}

Imprinter::Imprinter(const Surface& parent) : state_(std::make_unique<State>(parent)) {}
Imprinter::~Imprinter() = default;
Imprinter::Imprinter(Imprinter&&) noexcept = default;
Imprinter& Imprinter::operator=(Imprinter&&) noexcept = default;

int Imprinter::imprint(const SurfacePath& path, const std::vector<double>& t) {
    State& s = *state_;
    const Surface& parent = s.mesh.parent();
    const std::size_t count = path.points.size();
    if (count == 0)
        refuse("a path without points");
    if (t.size() != count)
        refuse("a path with " + std::to_string(count) + " points has " + std::to_string(t.size()) + " parameters");
    for (std::size_t i = 0; i < count; ++i)
        if (!std::isfinite(t[i]) || (i > 0 && t[i] < t[i - 1]))
            refuse("path point " + std::to_string(i) + ": parameters must not descend");
    std::vector<SurfacePoint> points(count);
    for (std::size_t i = 0; i < count; ++i) points[i] = cleaned(parent, path.points[i], i);
    s.farthest_snap = snap_of_curve * length(parent, path);

    Chain chain;
    chain.closed = path.closed;
    chain.t_end = path.closed ? std::max(1.0, t.back()) : t.back();
    const int begin = s.insert(points[0].face, points[0].bary, none);
    s.mesh.make_delaunay();
    chain.vertices.push_back(begin);
    chain.t.push_back(t[0]);
    int at = begin;
    std::vector<int> at_point{begin};  // per path point: its vertex
    const std::size_t pieces = path.closed ? count : count - 1;
    for (std::size_t i = 0; i < pieces; ++i) {
        const std::size_t j = (i + 1) % count;
        const int face = common_face(parent, points[i], points[j]);
        if (face == none)
            refuse("path points " + std::to_string(i) + " and " + std::to_string(j) + " have no common face");
        int to = j == 0 ? begin : none;
        if (!path.closed) {
            // Where it ends on itself there is one vertex, though what is near enough to snap to has changed since it was there.
            const Point place = parent.position(points[j]);
            const double nothing = snap_floor * parent.length(3 * face);
            for (std::size_t k = 0; k < (j + 1 == count ? j : 1); ++k)
                if ((parent.position(points[k]) - place).norm() <= nothing && common_face(parent, points[k], points[j]) != none)
                    to = at_point[k];
        }
        if (to == none)
            to = s.insert(face, bary_in(parent, face, points[j]), at);
        at_point.push_back(to);
        s.mesh.make_delaunay();
        const std::vector<int> passed = s.walk(face, at, to);
        double total = 0;
        int last = at;
        for (int v : passed) {
            total += (s.mesh.points()[v] - s.mesh.points()[last]).norm();
            last = v;
        }
        const double t_to = j == 0 ? chain.t_end : t[j];
        double done = 0;
        last = at;
        for (int v : passed) {
            done += (s.mesh.points()[v] - s.mesh.points()[last]).norm();
            last = v;
            chain.vertices.push_back(v);
            chain.t.push_back(v == to ? t_to : t[i] + (t_to - t[i]) * (done / total));
        }
        at = to;
    }
    if (path.closed)
        while (chain.vertices.size() > 1 && chain.vertices.back() == begin) {
            chain.vertices.pop_back();
            chain.t.pop_back();
        }
    else
        chain.t.back() = t.back();
    const std::size_t least = path.closed ? 3 : 2;
    if (chain.vertices.size() < least)
        refuse("the curve is a point, or too small for the mesh: " + std::to_string(chain.vertices.size()) +
               " vertices of it are left, at least " + std::to_string(least) + " are needed");
    s.chains.push_back(std::move(chain));
    return chain_count() - 1;
}

RefinedSurface Imprinter::surface() const {
    const SplitMesh& mesh = state_->mesh;
    return {Surface(mesh.points(), mesh.faces()), {mesh.origins(), mesh.face_parents()}};
}

int Imprinter::chain_count() const { return static_cast<int>(state_->chains.size()); }

CurveChain Imprinter::chain(int number) const {
    const SplitMesh& mesh = state_->mesh;
    const Chain& source = state_->chains.at(number);
    CurveChain chain;
    chain.closed = source.closed;
    const std::size_t count = source.vertices.size();
    struct Piece {
        int to;
        double t;
    };
    std::vector<Piece> ahead;  // a stack: the ends of the pieces still to go, the nearest on top
    for (std::size_t i = 0; i < count; ++i) {
        chain.vertices.push_back(source.vertices[i]);
        chain.t.push_back(source.t[i]);
        if (i + 1 == count && !source.closed)
            break;
        ahead.push_back({source.vertices[(i + 1) % count], i + 1 < count ? source.t[i + 1] : source.t_end});
        while (!ahead.empty()) {
            const int from = chain.vertices.back();
            const auto [to, t_to] = ahead.back();
            const int middle = mesh.split_vertex(from, to);
            if (middle == none) {
                ahead.pop_back();
                if (!ahead.empty()) {
                    chain.vertices.push_back(to);
                    chain.t.push_back(t_to);
                }
                continue;
            }
            const double share =
                (mesh.points()[middle] - mesh.points()[from]).norm() / (mesh.points()[to] - mesh.points()[from]).norm();
            ahead.push_back({middle, chain.t.back() + (t_to - chain.t.back()) * std::min(share, 1.0)});
        }
    }
    return chain;
}

bool Imprinter::is_simple(int number) const {
    const CurveChain all = chain(number);
    std::unordered_set<int> seen;
    return std::all_of(all.vertices.begin(), all.vertices.end(), [&](int v) { return seen.insert(v).second; });
}

SurfacePoint Imprinter::parent_point(int vertex) const {
    const SplitMesh& mesh = state_->mesh;
    const int h = mesh.outgoing(vertex);
    if (h == none)
        return {};
    return {mesh.parent_face(h), mesh.bary(mesh.parent_face(h), vertex)};
}

SurfacePoint to_parent(const Surface& parent, const RefinedSurface& refined, const SurfacePoint& at) {
    const int face = refined.map.face[at.face];
    const Face& corners = parent.face(face);
    Eigen::Vector3d bary(0, 0, 0);
    for (int k = 0; k < 3; ++k) {
        if (at.bary[k] == 0)
            continue;
        const VertexOrigin& origin = refined.map.vertex[refined.surface.face(at.face)[k]];
        for (int i = 0; i < 3 && origin.vertex[i] != none; ++i)
            for (int j = 0; j < 3; ++j)
                if (corners[j] == origin.vertex[i])
                    bary[j] += at.bary[k] * origin.weight[i];
    }
    return {face, bary / bary.sum()};
}

SurfacePath to_parent(const Surface& parent, const RefinedSurface& refined, const SurfacePath& path) {
    SurfacePath lifted;
    lifted.closed = path.closed;
    lifted.points.reserve(path.points.size());
    for (const SurfacePoint& at : path.points) lifted.points.push_back(to_parent(parent, refined, at));
    return lifted;
}

}  // namespace pvg
