#include "solve/knot_windows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "solve/surface_graph.h"

namespace pvg {
namespace {

using Vector2 = Eigen::Vector2d;
constexpr double pi = std::numbers::pi;
/// Angles this near to straight are straight; the wedge they leave out is filled by the neighbouring bundle.
constexpr double angle_tolerance = 1e-9;
/// Filters must not lose a bundle to rounding.
constexpr double slack = 1 + 1e-11;
/// A vertex this little outside a bundle (an angle) is reached by it: unfolding across a needle's short edge turns what
/// follows by rounding, and a path along a border must not lose its vertices to that. The length is wrong by the square
/// only.
constexpr double grazing = 1e-7;
/// Distances on the graph are longer than geodesics by less than this.
constexpr double graph_slack = 0.8;

double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Where the ray from the origin meets the segment's line, as a fraction from a to b.
double meet(const Vector2& ray, const Vector2& a, const Vector2& b) {
    const double from = cross(ray, a), to = cross(ray, b);
    const double apart = from - to;
    return apart != 0 ? std::clamp(from / apart, 0.0, 1.0) : 0.5;
}

/// A bundle on its way, in the frame of its source: the source at 0, directions relative to the first edge of the fan it left
/// through.
struct Beam {
    int halfedge;  // entered; a and b are its ends, a to the left seen from the source
    Vector2 a, b;
    Vector2 left, right;  // limiting rays
};

class Propagation {
public:
    Propagation(const Surface& surface, std::span<const int> knots) : surface_(surface), knots_(knots) { prepare(); }

    KnotWindows run() {
        for (int k = 0; k < static_cast<int>(knots_.size()); ++k) leave_knot(k);
        for (int v = 0; v < surface_.vertex_count(); ++v)
            if (result_.pseudo_source[v] && result_.knot[v] != none)
                pending_.push({result_.distance[v], v});
        saddles_open_ = true;
        while (!pending_.empty()) {
            const auto [d, v] = pending_.top();
            pending_.pop();
            if (d == result_.distance[v] && !left_[v]) {
                left_[v] = 1;
                leave_pseudo_source(v);
            }
        }
        sort_windows();
        return std::move(result_);
    }

private:
    void prepare() {
        const int vertices = surface_.vertex_count(), halfedges = surface_.halfedge_count();
        apex_.resize(halfedges);
        angle_.resize(halfedges);
        length_.resize(halfedges);
        std::vector<double> sum(vertices, 0.0);
        for (int f = 0; f < surface_.face_count(); ++f) {
            const auto& face = surface_.face(f);
            const Point p[3] = {surface_.point(face[0]), surface_.point(face[1]), surface_.point(face[2])};
            const Point e[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
            const double doubled = e[0].cross(e[1]).norm();
            for (int k = 0; k < 3; ++k) {
                const int h = 3 * f + k;
                const double square = e[k].squaredNorm();
                const double inner = -e[k].dot(e[(k + 2) % 3]);
                length_[h] = std::sqrt(square);
                apex_[h] = {inner / square, doubled / square};
                angle_[h] = std::atan2(doubled, inner);
                sum[face[k]] += angle_[h];
            }
        }
        const double infinite = std::numeric_limits<double>::infinity();
        result_.distance.assign(vertices, infinite);
        result_.knot.assign(vertices, none);
        result_.direction.assign(vertices, 0.0);
        result_.pseudo_source.assign(vertices, 0);
        left_.assign(vertices, 0);
        incoming_.assign(vertices, {none, 0.0});
        for (int v = 0; v < vertices; ++v)
            if (surface_.outgoing(v) != none && sum[v] > (surface_.is_border_vertex(v) ? pi : 2 * pi) + angle_tolerance)
                result_.pseudo_source[v] = 1;
        angle_sum_ = std::move(sum);
        std::vector<char> marked(vertices, 0);
        for (int k = 0; k < static_cast<int>(knots_.size()); ++k) {
            const int v = knots_[k];
            marked[v] = 1;
            result_.distance[v] = 0;
            result_.knot[v] = k;
            result_.pseudo_source[v] = 0;
        }
        const SurfaceGraph graph = surface_graph(surface_, true);
        bound_ = graph_distance(graph, marked);
        saddle_distance_ = graph_distance(graph, result_.pseudo_source);
    }

    /// A path of this length to the vertex, leaving its knot at `direction`. corner and turn tell where it comes from, for
    /// pseudo-sources.
    void reach(int v, double distance, double direction, int corner, double turn) {
        bound_[v] = std::min(bound_[v], distance);
        double& best = result_.distance[v];
        if (distance > best || (distance == best && knot_ >= result_.knot[v]))
            return;
        best = distance;
        result_.knot[v] = knot_;
        result_.direction[v] = direction;
        if (result_.pseudo_source[v]) {
            incoming_[v] = {corner, turn};
            if (saddles_open_)
                pending_.push({distance, v});
        }
    }

    void leave_knot(int k) {
        knot_ = k;
        offset_ = 0;
        clearance_ = graph_slack * saddle_distance_[knots_[k]];
        const int v = knots_[k], begin = surface_.outgoing(v);
        if (begin == none)
            return;
        double base = 0;
        int h = begin;
        do {
            from_pseudo_ = false;
            base_ = base;
            leave_corner(h, 0, angle_[h]);
            base += angle_[h];
            h = surface_.twin(Surface::prev(h));
        } while (h != none && h != begin);
    }

    /// Emits what leaves the corner of h between the angles low and high.
    void leave_corner(int h, double low, double high) {
        const Vector2 p(length_[h], 0);
        const Vector2 q = apex(h, Vector2(0, 0), p);
        const int next = Surface::next(h), prev = Surface::prev(h);
        if (low <= 0)
            reach(surface_.target(h), offset_ + length_[h], direction_of(p), next, angle_[next]);
        // Inside the surface the next corner of the fan reaches that vertex.
        if (high >= angle_[h] && (surface_.twin(prev) == none || from_pseudo_))
            reach(surface_.origin(prev), offset_ + length_[prev], direction_of(q), prev, 0);
        const int entered = surface_.twin(next);
        if (entered == none)
            return;
        const Vector2 right = low <= 0 ? p : Vector2(std::cos(low), std::sin(low));
        const Vector2 left = high >= angle_[h] ? q : Vector2(std::cos(high), std::sin(high));
        stack_.push_back({entered, q, p, left, right});
        while (!stack_.empty()) {
            const Beam beam = stack_.back();
            stack_.pop_back();
            enter(beam);
        }
    }

    void leave_pseudo_source(int v) {
        knot_ = result_.knot[v];
        offset_ = result_.distance[v];
        clearance_ = 0;
        from_pseudo_ = true;
        base_ = result_.direction[v];
        // The angle of the arriving path, counted from outgoing(v).
        double arriving = 0, base = 0;
        const int begin = surface_.outgoing(v);
        int h = begin;
        do {
            if (h == incoming_[v].corner) {
                arriving = base + incoming_[v].turn;
                break;
            }
            base += angle_[h];
            h = surface_.twin(Surface::prev(h));
        } while (h != none && h != begin);
        const double total = angle_sum_[v];
        const bool border = surface_.is_border_vertex(v);
        // Shortest paths go on where both sides measure at least pi; on a border there is only one side.
        std::vector<std::pair<double, double>> wedges;
        if (border) {
            if (arriving - pi > 0)
                wedges.push_back({0, arriving - pi});
            if (arriving + pi < total)
                wedges.push_back({arriving + pi, total});
        } else {
            wedges.push_back({arriving + pi, arriving + total - pi});
            wedges.push_back({arriving + pi - total, arriving - pi});
        }
        base = 0;
        h = begin;
        do {
            for (const auto& [low, high] : wedges) {
                double from = low - base, to = high - base;
                if (from < angle_tolerance)
                    from = 0;
                if (to > angle_[h] - angle_tolerance)
                    to = angle_[h];
                if (from < to)
                    leave_corner(h, from, to);
            }
            base += angle_[h];
            h = surface_.twin(Surface::prev(h));
        } while (h != none && h != begin);
    }

    void enter(const Beam& beam) {
        const int h = beam.halfedge, v_a = surface_.origin(h), v_b = surface_.target(h), v_c = surface_.origin(Surface::prev(h));
        const double t_left = meet(beam.left, beam.a, beam.b), t_right = meet(beam.right, beam.a, beam.b);
        if (!(t_left < t_right))
            return;
        const Vector2 along = beam.b - beam.a;
        const Vector2 left = beam.a + t_left * along, right = beam.a + t_right * along;
        const double to_left = offset_ + left.norm(), to_right = offset_ + right.norm(), size = length_[h];
        if ((bound_[v_a] + t_right * size) * slack < to_right)
            return;
        if ((bound_[v_b] + (1 - t_left) * size) * slack < to_left)
            return;
        const Vector2 unit = along / size, c = apex(h, beam.a, beam.b);
        const double farthest = std::sqrt(std::max({beam.a.squaredNorm(), beam.b.squaredNorm(), c.squaredNorm()}));
        windows_.push_back({h, knot_, t_left * size, t_right * size, Vector2(-beam.a.dot(unit), -cross(unit, beam.a)), offset_,
                            farthest > clearance_});

        const double past_left = cross(beam.left, c), past_right = cross(beam.right, c);  // > 0: c lies left of that ray
        const double far = grazing * c.norm();
        const bool visible = past_left <= far * beam.left.norm() && past_right >= -far * beam.right.norm();
        if (visible) {
            const Vector2 back = beam.a - c;
            reach(v_c, offset_ + c.norm(), direction_of(c), Surface::prev(h), std::atan2(cross(back, -c), back.dot(-c)));
        }
        const bool to_the_left = past_left<0, to_the_right = past_right> 0;  // part of the bundle passes on that side of c
        const bool splits = to_the_left && to_the_right;
        if (to_the_right) {
            const int child = surface_.twin(Surface::next(h));
            if (child != none && !((bound_[v_c] + (right - c).norm()) * slack < to_right))
                stack_.push_back({child, c, beam.b, splits ? c : beam.left, beam.right});
        }
        if (to_the_left) {
            const int child = surface_.twin(Surface::prev(h));
            if (child != none && !((bound_[v_c] + (left - c).norm()) * slack < to_left))
                stack_.push_back({child, beam.a, c, beam.left, splits ? c : beam.right});
        }
    }

    Vector2 apex(int h, const Vector2& a, const Vector2& b) const {
        const Vector2 along = b - a;
        return a + apex_[h].x() * along + apex_[h].y() * Vector2(-along.y(), along.x());
    }

    double direction_of(const Vector2& p) const { return from_pseudo_ ? base_ : base_ + std::atan2(p.y(), p.x()); }

    /// By halfedge, without those that the final distances show to be useless; equal keys stay in order of their making.
    void sort_windows() {
        const int halfedges = surface_.halfedge_count();
        const auto useless = [&](const KnotWindow& w) {
            const double to_end = w.offset + (w.source - Vector2(w.end, 0)).norm(),
                         to_begin = w.offset + (w.source - Vector2(w.begin, 0)).norm();
            return (result_.distance[surface_.origin(w.halfedge)] + w.end) * slack < to_end ||
                   (result_.distance[surface_.target(w.halfedge)] + length_[w.halfedge] - w.begin) * slack < to_begin;
        };
        std::erase_if(windows_, useless);
        result_.first.assign(halfedges + 1, 0);
        for (const KnotWindow& w : windows_) ++result_.first[w.halfedge + 1];
        for (int h = 0; h < halfedges; ++h) result_.first[h + 1] += result_.first[h];
        std::vector<std::size_t> end(result_.first.begin(), result_.first.end() - 1);
        result_.windows.resize(windows_.size());
        for (const KnotWindow& w : windows_) result_.windows[end[w.halfedge]++] = w;
    }

    struct Incoming {
        int corner;   // halfedge that leaves the vertex
        double turn;  // from it to the arriving path, counter-clockwise
    };

    const Surface& surface_;
    std::span<const int> knots_;
    std::vector<Vector2> apex_;   // per halfedge: its apex in units of the edge (along, across)
    std::vector<double> angle_;   // per corner
    std::vector<double> length_;  // per halfedge
    std::vector<double> angle_sum_;
    std::vector<double> bound_;            // V: length of some path to each vertex
    std::vector<double> saddle_distance_;  // V: about, to the nearest pseudo-source
    std::vector<Incoming> incoming_;
    std::vector<char> left_;  // V: pseudo-source done
    std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>> pending_;
    bool saddles_open_ = false;
    int knot_ = none;  // of the bundles under way
    double offset_ = 0;
    double clearance_ = 0;  // no pseudo-source is nearer to the source
    double base_ = 0;
    bool from_pseudo_ = false;
    std::vector<Beam> stack_;
    std::vector<KnotWindow> windows_;
    KnotWindows result_;
};

}  // namespace

KnotWindows knot_windows(const Surface& surface, std::span<const int> knots) { return Propagation(surface, knots).run(); }

}  // namespace pvg
