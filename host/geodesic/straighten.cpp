// Locally shortest paths. A strip of faces found by best-first search is unfolded into the plane and pulled straight by the
// funnel algorithm (Lee and Preparata 1984); where the path then bends at a vertex that it could pass on its other side at less
// than pi, the strip is led around that side, until no such vertex is left (Xin and Wang, "Efficiently determining a locally
// exact shortest path on polyhedral surfaces", CAD 2007; the search and the funnel on a strip as in Mancinelli et al., "b/Surf",
// TVCG 2022). Memory is proportional to the faces visited.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <string>
#include <vector>

#include "geodesic/metric.h"
#include "geodesic/paths.h"
#include "pvg/status.h"

namespace pvg {
namespace {

constexpr double straight = 1e-9;      // radians below pi that make a detour worthwhile
constexpr double search_weight = 1.1;  // paths over edge midpoints are longer than straight ones by about this factor

using Vector2 = Eigen::Vector2d;

double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }
double angle(const Vector2& a, const Vector2& b) { return std::atan2(std::abs(cross(a, b)), a.dot(b)); }

double corner_angle(const Surface& surface, int halfedge) {
    const HalfedgeFrame frame = halfedge_frame(surface, halfedge);
    return std::atan2(frame.apex_y, frame.apex_x);
}

/// From face numbers to small numbers in order of first visit: open addressing, grows by doubling.
class FaceNumbers {
public:
    FaceNumbers() : slots_(128, {none, none}) {}
    /// The number of the face; `fresh` when it is new.
    int operator()(int face, bool& fresh) {
        if (2 * (count_ + 1) > static_cast<int>(slots_.size()))
            grow();
        Slot& slot = find(face);
        fresh = slot.face == none;
        if (fresh)
            slot = {face, count_++};
        return slot.number;
    }

private:
    struct Slot {
        int face;
        int number;
    };
    Slot& find(int face) {
        const std::size_t mask = slots_.size() - 1;
        std::size_t at = (static_cast<std::size_t>(face) * 0x9e3779b97f4a7c15ull >> 32) & mask;
        while (slots_[at].face != none && slots_[at].face != face) at = (at + 1) & mask;
        return slots_[at];
    }
    void grow() {
        std::vector<Slot> old(2 * slots_.size(), {none, none});
        old.swap(slots_);
        for (const Slot& slot : old)
            if (slot.face != none)
                find(slot.face) = slot;
    }
    std::vector<Slot> slots_;
    int count_ = 0;
};

bool lies_on(const Surface& surface, const SurfacePoint& at, const Place& place, int face) {
    if (at.face == face)
        return true;
    if (place.vertex != none) {
        const Face& f = surface.face(face);
        return f[0] == place.vertex || f[1] == place.vertex || f[2] == place.vertex;
    }
    return place.halfedge != none && surface.twin(place.halfedge) != none && surface.twin(place.halfedge) / 3 == face;
}

/// A strip: the first face and the halfedges through which it leaves face after face.
struct Strip {
    int first = none;
    std::vector<int> exits;
};

/// Best-first search over faces; a path through a face is measured from the midpoint of the edge it came in by.
Strip search(const Surface& surface, const SurfacePoint& from, const Place& from_place, const SurfacePoint& to,
             const Place& to_place) {
    struct Node {
        int face;
        int parent;  ///< node
        int exit;    ///< halfedge of the parent's face
        double cost;
        Point entry;
        bool done;
    };
    struct Entry {
        double estimate;
        int node;
        bool operator<(const Entry& other) const {
            return estimate != other.estimate ? estimate > other.estimate : node > other.node;
        }
    };
    const Point start = surface.position(from), goal = surface.position(to);
    FaceNumbers numbers;
    std::vector<Node> nodes;
    std::vector<Entry> storage;
    storage.reserve(64);
    nodes.reserve(64);
    std::priority_queue<Entry> queue(std::less<Entry>(), std::move(storage));
    const auto visit = [&](int face, int parent, int exit, double cost, const Point& entry) {
        bool fresh = false;
        const int node = numbers(face, fresh);
        if (fresh) {
            nodes.push_back({face, parent, exit, cost, entry, false});
        } else {
            if (nodes[node].done || nodes[node].cost <= cost)
                return;
            nodes[node] = {face, parent, exit, cost, entry, false};
        }
        queue.push({cost + search_weight * (goal - entry).norm(), node});
    };
    if (from_place.vertex != none) {
        const int first = surface.outgoing(from_place.vertex);
        int h = first;
        while (h != none) {
            visit(h / 3, none, none, 0, start);
            h = surface.twin(Surface::prev(h));
            if (h == first)
                break;
        }
    } else {
        visit(from.face, none, none, 0, start);
        if (from_place.halfedge != none && surface.twin(from_place.halfedge) != none)
            visit(surface.twin(from_place.halfedge) / 3, none, none, 0, start);
    }
    while (!queue.empty()) {
        const int at = queue.top().node;
        queue.pop();
        if (nodes[at].done)
            continue;
        nodes[at].done = true;
        const Node node = nodes[at];
        if (lies_on(surface, to, to_place, node.face)) {
            Strip strip;
            int n = at;
            while (nodes[n].parent != none) {
                strip.exits.push_back(nodes[n].exit);
                n = nodes[n].parent;
            }
            strip.first = nodes[n].face;
            std::reverse(strip.exits.begin(), strip.exits.end());
            return strip;
        }
        for (int h = 3 * node.face; h < 3 * node.face + 3; ++h) {
            const int twin = surface.twin(h);
            if (twin == none)
                continue;
            const Point middle = 0.5 * (surface.point(surface.origin(h)) + surface.point(surface.target(h)));
            visit(twin / 3, at, h, node.cost + (middle - node.entry).norm(), middle);
        }
    }
    throw Error(ErrorKind::bad_input, "path: the points in faces " + std::to_string(from.face) + " and " +
                                          std::to_string(to.face) + " are on different components of the surface");
}

/// A strip in the plane and the shortest path inside it.
class Funnel {
public:
    Funnel(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to)
        : surface_(surface), from_(from), to_(to), from_place_(place_of(surface, from)), to_place_(place_of(surface, to)) {
        strip_ = search(surface, from, from_place_, to, to_place_);
    }

    /// Shortens the strip until its shortest path is locally shortest on the surface. False when that takes too long.
    bool straighten() {
        // Where a way over a vertex is as long as one beside it, rerouting could go back and forth: a few rounds without gain end
        // it.
        double shortest = std::numeric_limits<double>::infinity();
        int idle = 0;
        for (int round = 0; round < 500; ++round) {
            trim();
            unfold();
            pull();
            double now = 0;
            for (std::size_t b = 0; b + 1 < bends_.size(); ++b) now += (bends_[b + 1].at - bends_[b].at).norm();
            idle = now < shortest * (1 - 1e-14) ? 0 : idle + 1;
            shortest = std::min(shortest, now);
            if ((idle > 3 && now <= shortest * (1 + 1e-14)) || !reroute())
                return true;
        }
        return false;
    }

    SurfacePath path() const;

private:
    int face_after(int k) const { return surface_.twin(strip_.exits[k]) / 3; }
    int face_at(int k) const { return k == 0 ? strip_.first : face_after(k - 1); }
    int count() const { return static_cast<int>(strip_.exits.size()); }
    // Seen along the strip an exit's origin is on the right, its target on the left.
    int vertex(int portal, bool left) const {
        return left ? surface_.target(strip_.exits[portal]) : surface_.origin(strip_.exits[portal]);
    }

    void trim();
    void unfold();
    void pull();
    bool reroute();

    struct Portal {
        Vector2 right, left;
        Vector2 behind;  ///< the third vertex of the face before it
        Vector2 beyond;  ///< and of the face after it
    };
    /// A vertex of the path: where it bends; -1 and count() stand for its ends.
    struct Bend {
        int portal;
        bool left;
        int vertex;
        Vector2 at;
    };

    const Surface& surface_;
    const SurfacePoint &from_, &to_;
    Place from_place_, to_place_;
    Strip strip_;
    std::vector<Portal> portals_;
    std::vector<Bend> bends_;
};

/// No face twice; only the last face that holds the first point and the first that then holds the last.
void Funnel::trim() {
    FaceNumbers numbers;
    std::vector<int> exits;  // out of faces numbered 0, 1, ... as they first come; a repeated face drops the loop between
    std::vector<int> faces{strip_.first};
    bool fresh = false;
    numbers(strip_.first, fresh);
    bool repeats = false;
    for (int k = 0; k < count() && !repeats; ++k) {
        numbers(face_after(k), fresh);
        repeats = !fresh;
    }
    if (repeats)
        for (int k = 0; k < count(); ++k) {
            const int face = face_after(k);
            const auto seen = std::find(faces.begin(), faces.end(), face);
            if (seen != faces.end()) {
                exits.resize(seen - faces.begin());
                faces.resize(seen - faces.begin() + 1);
            } else {
                exits.push_back(strip_.exits[k]);
                faces.push_back(face);
            }
        }
    if (repeats)
        strip_.exits = exits;

    int begin = 0;
    for (int k = 1; k <= count(); ++k)
        if (lies_on(surface_, from_, from_place_, face_at(k)))
            begin = k;
    strip_.first = face_at(begin);
    strip_.exits.erase(strip_.exits.begin(), strip_.exits.begin() + begin);
    for (int k = 0; k <= count(); ++k)
        if (lies_on(surface_, to_, to_place_, face_at(k))) {
            strip_.exits.resize(k);
            break;
        }
}

void Funnel::unfold() {
    portals_.resize(count());
    for (int k = 0; k < count(); ++k) {
        const int h = strip_.exits[k];
        Portal& portal = portals_[k];
        if (k == 0) {
            const HalfedgeFrame frame = halfedge_frame(surface_, h);
            portal.right = {0, 0};
            portal.left = {frame.length, 0};
            portal.behind = {frame.apex_x, frame.apex_y};
        } else {
            // The face between was laid out with the portal before.
            const Portal& last = portals_[k - 1];
            const int entered = surface_.twin(strip_.exits[k - 1]);  // runs from the left to the right end of the last portal
            if (h == Surface::next(entered)) {
                portal.right = last.right;
                portal.left = last.beyond;
                portal.behind = last.left;
            } else {
                portal.right = last.beyond;
                portal.left = last.left;
                portal.behind = last.right;
            }
        }
        const HalfedgeFrame frame = halfedge_frame(surface_, surface_.twin(h));
        const Vector2 along = (portal.right - portal.left) * frame.inverse;
        portal.beyond = portal.left + frame.apex_x * along + frame.apex_y * Vector2(-along.y(), along.x());
    }
}

void Funnel::pull() {
    bends_.clear();
    const int n = count();
    if (n == 0)
        return;
    const auto place = [&](const SurfacePoint& at, int halfedge, const Vector2& origin, const Vector2& target,
                           const Vector2& apex) -> Vector2 {
        const Eigen::Vector3d bary = bary_in(surface_, halfedge / 3, at);
        return bary[halfedge % 3] * origin + bary[(halfedge + 1) % 3] * target + bary[(halfedge + 2) % 3] * apex;
    };
    const Portal &first = portals_.front(), &last = portals_.back();
    const Vector2 start = place(from_, strip_.exits.front(), first.right, first.left, first.behind);
    const Vector2 goal = place(to_, surface_.twin(strip_.exits.back()), last.left, last.right, last.beyond);
    bends_.push_back({-1, false, from_place_.vertex, start});

    Vector2 apex = start, right = start, left = start;
    int right_at = -1, left_at = -1;
    bool right_open = false, left_open = false;  // false: that side still is the apex itself
    for (int i = 0; i <= n; ++i) {
        const Vector2 new_right = i < n ? portals_[i].right : goal, new_left = i < n ? portals_[i].left : goal;
        if (!right_open || cross(right - apex, new_right - apex) >= 0) {
            if (right_open && left_open && cross(left - apex, new_right - apex) > 0) {
                bends_.push_back({left_at, true, vertex(left_at, true), left});
                apex = right = left;
                i = right_at = left_at;
                right_open = left_open = false;
                continue;
            }
            if (new_right != apex) {
                right = new_right;
                right_at = i;
                right_open = true;
            }
        }
        if (!left_open || cross(left - apex, new_left - apex) <= 0) {
            if (left_open && right_open && cross(right - apex, new_left - apex) < 0) {
                bends_.push_back({right_at, false, vertex(right_at, false), right});
                apex = left = right;
                i = left_at = right_at;
                right_open = left_open = false;
                continue;
            }
            if (new_left != apex) {
                left = new_left;
                left_at = i;
                left_open = true;
            }
        }
    }
    bends_.push_back({n, false, to_place_.vertex, goal});
}

/// Leads the strip around the other side of the path's vertices where that side's angle is below pi. False when there are none.
bool Funnel::reroute() {
    Strip next{strip_.first, {}};
    int copied = 0;  // exits that are in `next`, as they were or rerouted
    bool changed = false;
    const int n = count();
    for (std::size_t b = 1; b + 1 < bends_.size(); ++b) {
        const Bend& bend = bends_[b];
        const int u = bend.vertex;
        if (surface_.is_border_vertex(u))
            continue;
        int begin = bend.portal, end = bend.portal;  // portals that end in u
        while (begin > 0 && vertex(begin - 1, bend.left) == u) --begin;
        while (end + 1 < n && vertex(end + 1, bend.left) == u) ++end;
        // The path may come or go along one of these portals, from or to a vertex on the other side.
        const Bend &before = bends_[b - 1], &after = bends_[b + 1];
        for (int k = end; k > begin; --k)
            if (before.portal >= 0 && vertex(k, !bend.left) == before.vertex) {
                begin = k;
                break;
            }
        for (int k = begin; k < end; ++k)
            if (after.portal < n && vertex(k, !bend.left) == after.vertex) {
                end = k;
                break;
            }
        if (begin < copied)
            continue;  // touches what was just rerouted: next round

        double around = angle(before.at - bend.at, portals_[begin].behind - bend.at) +
                        angle(after.at - bend.at, portals_[end].beyond - bend.at);
        const int last_face = face_after(end);
        std::vector<int> exits;
        int h = bend.left ? Surface::next(strip_.exits[begin]) : Surface::prev(strip_.exits[begin]);
        bool closed = false;
        while (around < std::numbers::pi - straight) {
            const int twin = surface_.twin(h);
            exits.push_back(h);
            if (twin / 3 == last_face) {
                closed = true;
                break;
            }
            around += bend.left ? corner_angle(surface_, Surface::next(twin)) : corner_angle(surface_, twin);
            h = bend.left ? Surface::next(twin) : Surface::prev(twin);
        }
        if (!closed)
            continue;
        next.exits.insert(next.exits.end(), strip_.exits.begin() + copied, strip_.exits.begin() + begin);
        next.exits.insert(next.exits.end(), exits.begin(), exits.end());
        copied = end + 1;
        changed = true;
    }
    if (!changed)
        return false;
    next.exits.insert(next.exits.end(), strip_.exits.begin() + copied, strip_.exits.end());
    strip_ = std::move(next);
    return true;
}

SurfacePath Funnel::path() const {
    SurfacePath path;
    path.points.push_back(from_);
    int passed = from_place_.vertex;  // the vertex that the path's last point stands on, or none
    const auto add_vertex = [&](int portal, bool left) {
        const int v = vertex(portal, left);
        if (v == passed || v == to_place_.vertex)
            return;
        const int h = strip_.exits[portal];
        SurfacePoint at{h / 3, {0, 0, 0}};
        at.bary[(left ? Surface::next(h) : h) % 3] = 1;
        path.points.push_back(at);
        passed = v;
    };
    for (std::size_t b = 0; b + 1 < bends_.size(); ++b) {
        const Bend &one = bends_[b], &two = bends_[b + 1];
        const Vector2 along = two.at - one.at;
        for (int k = one.portal + 1; k <= two.portal && k < count(); ++k) {
            const int right = vertex(k, false), left = vertex(k, true);
            if ((one.portal >= 0 && (right == one.vertex || left == one.vertex)) ||
                (two.portal < count() && (right == two.vertex || left == two.vertex))) {
                const int v = one.portal >= 0 && (right == one.vertex || left == one.vertex) ? one.vertex : two.vertex;
                add_vertex(k, v == left);
                continue;
            }
            const double to_right = std::max(0.0, -cross(along, portals_[k].right - one.at)),
                         to_left = std::max(0.0, cross(along, portals_[k].left - one.at));
            const double s = to_right + to_left > 0 ? to_right / (to_right + to_left) : 0.5;
            if (s < 1e-12 || s > 1 - 1e-12) {
                add_vertex(k, s > 0.5);
                continue;
            }
            const int h = strip_.exits[k];
            SurfacePoint at{h / 3, {0, 0, 0}};
            at.bary[h % 3] = 1 - s;
            at.bary[Surface::next(h) % 3] = s;
            path.points.push_back(at);
            passed = none;
        }
    }
    path.points.push_back(to_);
    return path;
}

}  // namespace

SurfacePath straightened_path(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to) {
    check_point(surface, from, "path's first point");
    check_point(surface, to, "path's last point");
    if (common_face(surface, from, to) != none)
        return {{from, to}, false};
    Funnel funnel(surface, from, to);
    return funnel.straighten() ? funnel.path() : shortest_path(surface, from, to);
}

}  // namespace pvg
