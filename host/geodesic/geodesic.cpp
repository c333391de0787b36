// Window propagation. Chen and Han, "Shortest paths on a polyhedron" (1990): one angle, one split. Xin and Wang, "Improving Chen
// and Han's algorithm on the discrete geodesic problem" (2009): a queue ordered by distance, and a filter by the three vertices
// of the face that a window left.
#include "geodesic/geodesic.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "geodesic/metric.h"
#include "geodesic/window_queue.h"
#include "pvg/status.h"

namespace pvg {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

// All tolerances are relative. A ray that misses a vertex by the angle e is wrong about its distance by e^2 / 2 of it, so angles
// may be looser: a vertex is a pseudo-source when its angle exceeds 2 pi (pi) by more than saddle_excess, and what then falls
// between two windows is caught by letting a window reach vertices that are up to reach_angle outside.
constexpr double saddle_excess = 1e-8;
constexpr double reach_angle = 4e-8;
constexpr double wedge_slack = 1e-9;     // pseudo-source bundles are that much wider than their shadow
constexpr double filter_margin = 1e-14;  // ties survive the filter: rounding must not kill the only window
constexpr double tie = 1e-14;            // distances this close are equal: the lower index wins

/// One cache line.
struct Window {
    double begin, end;
    double x, y;  // source in the halfedge's frame, y <= 0
    double offset;
    double rotation;
    int halfedge;
    int root;
    int via;
    int side;  // where the third vertex of the face it comes from lies: left of the bundle (+1), right of it (-1), or it is the
               // source (0)
};

/// The best window so far that reaches an angle of a face through the opposite edge.
struct Occupant {
    double distance = infinity;
    double crossing = 0;  // where its ray to the apex crosses the edge
    double x = 0, y = 0;
};

class Propagation {
public:
    Propagation(const Surface& s, std::span<const GeodesicSource> from, const GeodesicOptions& o)
        : surface_(s), sources_(from), options_(o), metric_(s), occupant_(s.halfedge_count()) {
        const std::size_t n = s.vertex_count();
        field_.distance.assign(n, infinity);
        field_.root.assign(n, none);
        field_.direction.assign(n, 0);
        field_.arrival.assign(n, 0);
        field_.via.assign(n, none);
        field_.is_source.assign(n, 0);
        field_.is_pseudo_source.assign(n, 0);
        for (const SurfacePoint& target : options_.targets) {
            check_point(surface_, target, "geodesic target");
            pending_.push_back({target, place_of(surface_, target).vertex, infinity});
        }
    }

    GeodesicField run() {
        for (int i = 0; i < static_cast<int>(sources_.size()); ++i) start(i);
        const bool all = pending_.empty();
        while (!queue_.empty()) {
            const WindowQueue::Item item = queue_.pop();
            if (item.key > options_.max_distance)
                break;
            if (!all && targets_done(item.key))
                break;
            if (item.index < 0) {
                expand(~item.index, item.key);
                continue;
            }
            Window window = pool_[item.index];
            free_.push_back(item.index);
            if (dominated(window))
                continue;
            if (options_.keep_windows && item.key + metric_.perimeter(window.halfedge / 3) >= options_.keep_beyond)
                kept_.push_back(window);
            if (!all)
                reach_targets(window);
            propagate(window);
        }
        finish();
        return std::move(field_);
    }

private:
    // ---- sources ----

    void start(int index) {
        const GeodesicSource& source = sources_[index];
        check_point(surface_, source.at, "geodesic source");
        if (!std::isfinite(source.distance))
            throw Error(ErrorKind::bad_input, "geodesic source " + std::to_string(index) + ": its distance must be finite");
        const Place place = place_of(surface_, source.at);
        if (place.vertex != none) {
            const int v = place.vertex;
            if (source.distance >= field_.distance[v])
                return;
            field_.distance[v] = source.distance;
            field_.root[v] = index;
            field_.direction[v] = field_.arrival[v] = 0;
            field_.via[v] = none;
            field_.is_source[v] = 1;
            queue_.push(source.distance, ~v);
            return;
        }
        int h = 3 * source.at.face;
        Eigen::Vector2d at = to_frame(metric_.frame(h), h, source.at.bary);
        double angle = 0;  // of the halfedge, measured as the log map's directions are
        for (int k = 0; k < 3; ++k) {
            start_corner(h, at, angle, index);
            if (h != place.halfedge)
                start_edge(h, at, angle, index);
            advance(h, at, angle);
        }
        const int twin = place.halfedge == none ? none : surface_.twin(place.halfedge);
        if (twin == none)
            return;
        while (h != place.halfedge) advance(h, at, angle);
        at = {metric_.frame(h).length - at.x(), 0};
        angle += pi;
        h = twin;
        for (int k = 0; k < 3; ++k) {
            start_corner(h, at, angle, index);
            if (h != twin)
                start_edge(h, at, angle, index);
            advance(h, at, angle);
        }
    }

    /// From the frame of a halfedge to that of the next one in its face.
    void advance(int& h, Eigen::Vector2d& at, double& angle) {
        const HalfedgeFrame& frame = metric_.frame(h);
        const int next = Surface::next(h);
        const double inverse = metric_.frame(next).inverse;
        const Eigen::Vector2d axis((frame.apex_x - frame.length) * inverse, frame.apex_y * inverse),
            d(at.x() - frame.length, at.y());
        at = {d.dot(axis), axis.x() * d.y() - axis.y() * d.x()};
        angle += pi - metric_.corner_angle(next);
        h = next;
    }

    void start_corner(int h, const Eigen::Vector2d& at, double angle, int index) {
        const int v = surface_.origin(h);
        const double d = sources_[index].distance + at.norm();
        if (!better(v, d, index))
            return;
        reach(v, d, index, none, angle + std::atan2(-at.y(), -at.x()), metric_.fan_angle(h) + std::atan2(at.y(), at.x()), 2 * pi,
              true);
    }

    void start_edge(int h, const Eigen::Vector2d& at, double angle, int index) {
        const double length = metric_.frame(h).length;
        push(surface_.twin(h), 0, length, length - at.x(), -at.y(), sources_[index].distance, angle - pi, index, none, 0);
    }

    // ---- vertices ----

    bool better(int v, double d, int index) const {
        return d < field_.distance[v] * (1 - tie) || (index < field_.root[v] && d <= field_.distance[v] * (1 + tie));
    }

    bool can_bend(int v) { return metric_.angle_sum(v) > (surface_.is_border_vertex(v) ? pi : 2 * pi) + saddle_excess; }

    void reach(int v, double d, int index, int via, double direction, double arrival, double turn, bool closed) {
        const bool nearer = d < field_.distance[v];
        if (nearer)
            field_.distance[v] = d;
        field_.root[v] = index;
        field_.via[v] = via;
        field_.direction[v] = reduced(direction, turn, closed);
        field_.arrival[v] = reduced(arrival, metric_.angle_sum(v), !surface_.is_border_vertex(v));
        field_.is_source[v] = 0;
        if (can_bend(v)) {
            field_.is_pseudo_source[v] = 1;
            if (nearer)
                queue_.push(d, ~v);
        }
    }

    static double reduced(double angle, double turn, bool closed) {
        if (!closed)
            return std::clamp(angle, 0.0, turn);
        angle = std::fmod(angle, turn);
        if (angle < 0)
            angle += turn;
        return angle < turn ? angle : 0.0;
    }

    /// Direction range at a source: a whole turn inside faces and on edges, the fan at a vertex.
    void reach_from_source(int v, double d, int index, int via, double direction, double arrival) {
        const int at = place_of(surface_, sources_[index].at).vertex;
        if (at == none)
            reach(v, d, index, via, direction, arrival, 2 * pi, true);
        else
            reach(v, d, index, via, direction, arrival, metric_.angle_sum(at), !surface_.is_border_vertex(at));
    }

    /// Sends bundles out of a source vertex, or into the shadow of a pseudo-source.
    void expand(int v, double key) {
        if (key != field_.distance[v] || !(field_.is_source[v] || field_.is_pseudo_source[v]))
            return;  // reached on a shorter way since
        const int first = surface_.outgoing(v), index = field_.root[v];
        const bool whole = field_.is_source[v] != 0, border = surface_.is_border_vertex(v);
        const double sum = metric_.angle_sum(v);
        const int via = whole ? none : v;
        int h = first;
        do {
            const int across = Surface::next(h), back = Surface::prev(h);
            expand_edge(v, surface_.origin(across), metric_.frame(h).length, metric_.fan_angle(h),
                        metric_.fan_angle(across) + metric_.corner_angle(across));
            const int twin = surface_.twin(across);
            const double corner = metric_.corner_angle(h);
            if (twin != none) {
                if (whole) {
                    push_wedge(h, twin, 0, corner, key, index, via);
                } else if (border) {
                    const double in = field_.arrival[v], low = metric_.fan_angle(h);
                    const double right = in - pi + wedge_slack, left = in + pi - wedge_slack;
                    if (low < right)
                        push_wedge(h, twin, 0, std::min(corner, right - low), key, index, via);
                    if (low + corner > left)
                        push_wedge(h, twin, std::max(0.0, left - low), corner, key, index, via);
                } else {
                    double low = metric_.fan_angle(h) - field_.arrival[v];
                    if (low < 0)
                        low += sum;
                    const double right = std::max(low, pi - wedge_slack), left = std::min(low + corner, sum - pi + wedge_slack);
                    if (right < left)
                        push_wedge(h, twin, right - low, left - low, key, index, via);
                }
            }
            const int following = surface_.twin(back);
            if (following == none)
                expand_edge(v, surface_.origin(back), metric_.frame(back).length, metric_.fan_angle(h) + corner,
                            metric_.fan_angle(back));
            h = following;
        } while (h != none && h != first);
    }

    void expand_edge(int v, int to, double length, double direction, double arrival) {
        const int index = field_.root[v];
        const double d = field_.distance[v] + length;
        if (!better(to, d, index))
            return;
        if (field_.is_source[v])
            reach(to, d, index, none, direction, arrival, metric_.angle_sum(v), !surface_.is_border_vertex(v));
        else
            reach(to, d, index, v, field_.direction[v], arrival, infinity, false);
    }

    /// Directions [from, to] out of the corner of halfedge h, as a window on the opposite edge's other side.
    void push_wedge(int h, int twin, double from, double to, double offset, int index, int via) {
        const int across = Surface::next(h);
        const HalfedgeFrame& frame = metric_.frame(across);
        const double x = frame.length - frame.apex_x, y = -frame.apex_y;
        const double right_angle = metric_.corner_angle(across);  // of the ray to the near end of the edge, in the window's frame
        double begin = 0, end = frame.length;
        const auto crossing = [&](double angle) {
            const double s = std::sin(right_angle + angle);
            return s > 0 ? std::clamp(x - y * std::cos(right_angle + angle) / s, 0.0, frame.length)
                         : (angle > pi / 2 ? 0.0 : frame.length);
        };
        if (from > 0)
            end = crossing(from);
        if (to < metric_.corner_angle(h))
            begin = crossing(to);
        const double rotation = via == none ? metric_.fan_angle(h) - right_angle : field_.direction[surface_.origin(h)];
        push(twin, begin, end, x, y, offset, rotation, index, via, 0);
    }

    // ---- windows ----

    void push(int h, double begin, double end, double x, double y, double offset, double rotation, int root, int via, int side) {
        if (h == none)
            return;
        if (!(end > begin))
            return;  // thin ones stay: near a source that stands close to the edge they may span a large angle
        const Window window{begin, end, x, std::min(y, 0.0), offset, rotation, h, root, via, side};
        if (dominated(window))
            return;
        const double nearest = std::clamp(x, begin, end) - x;
        const double key = offset + std::sqrt(nearest * nearest + y * y);
        if (key > options_.max_distance || astray(key, h, begin, end))
            return;
        int index;
        if (free_.empty()) {
            index = static_cast<int>(pool_.size());
            pool_.push_back(window);
        } else {
            index = free_.back();
            free_.pop_back();
            pool_[index] = window;
        }
        queue_.push(key, index);
    }

    /// Whether no path through this interval can be short enough for the one target: space is never longer than the surface.
    bool astray(double key, int h, double begin, double end) {
        if (!options_.toward)
            return false;
        const Point &from = surface_.point(surface_.origin(h)), &to = surface_.point(surface_.target(h));
        const Point along = (to - from) * metric_.frame(h).inverse;
        const double nearest = std::clamp((*options_.toward - from).dot(along), begin, end);
        return key + (from + nearest * along - *options_.toward).norm() > options_.max_distance;
    }

    /// Xin and Wang's filter: some vertex of the face that the window left reaches all of its interval on a way that is not
    /// longer.
    bool dominated(const Window& w) {
        if (w.via != none && w.offset > field_.distance[w.via])
            return true;
        const HalfedgeFrame& frame = metric_.frame(w.halfedge);
        const double to_begin = w.offset + std::sqrt((w.begin - w.x) * (w.begin - w.x) + w.y * w.y);
        const double to_end = w.offset + std::sqrt((w.end - w.x) * (w.end - w.x) + w.y * w.y);
        constexpr double margin = 1 - filter_margin;
        if (field_.distance[surface_.origin(w.halfedge)] + w.end < to_end * margin)
            return true;
        if (field_.distance[surface_.target(w.halfedge)] + (frame.length - w.begin) < to_begin * margin)
            return true;
        if (w.side == 0)
            return false;
        const int behind = surface_.twin(w.halfedge);
        const HalfedgeFrame& other = metric_.frame(behind);
        const double far = w.side > 0 ? w.end : w.begin, dx = far - (frame.length - other.apex_x);
        return field_.distance[surface_.origin(Surface::prev(behind))] + std::sqrt(dx * dx + other.apex_y * other.apex_y) <
               (w.side > 0 ? to_end : to_begin) * margin;
    }

    void propagate(const Window& w) {
        const int h = w.halfedge, next = Surface::next(h), prev = Surface::prev(h);
        const HalfedgeFrame& frame = metric_.frame(h);
        const double ax = frame.apex_x - w.x, ay = frame.apex_y - w.y;
        // Positive where the apex lies left of the bundle's left (right) ray.
        const double left = (w.begin - w.x) * ay + w.y * ax;
        const double right = (w.end - w.x) * ay + w.y * ax;
        bool to_left = left<0, to_right = right> 0;
        if (left <= 0 && right >= 0) {
            const double d = w.offset + std::sqrt(ax * ax + ay * ay);
            reach_apex(w, d);
            Occupant& best = occupant_[h];
            const double crossing = ay > 0 ? w.x - ax * w.y / ay : std::clamp(w.x, w.begin, w.end);
            if (d < best.distance) {
                best = {d, crossing, w.x, w.y};
            } else if (d * (1 - 1e-12) > best.distance) {
                // The other's ray to the apex shadows the far side, unless the other source stands inside that half of the bundle
                // (one that starts with a distance can be passed on both sides).
                const double bx = best.x - w.x, by = best.y - w.y;
                if (crossing < best.crossing && (w.end - w.x) * by + w.y * bx <= 0)
                    to_right = false;
                if (crossing > best.crossing && (w.begin - w.x) * by + w.y * bx >= 0)
                    to_left = false;
            }
        } else {
            // Just missed: see reach_angle.
            const double k = left > 0 ? left : right, dx = (left > 0 ? w.begin : w.end) - w.x, apex = ax * ax + ay * ay;
            if (k * k <= reach_angle * reach_angle * apex * (dx * dx + w.y * w.y))
                reach_apex(w, w.offset + std::sqrt(apex));
        }
        if (to_right && surface_.twin(next) != none) {
            const HalfedgeFrame& edge = metric_.frame(next);
            const double begin = left > 0 ? edge.length * left / (left + w.y * (w.begin - frame.length)) : 0;
            const double end = edge.length * right / (right + w.y * (w.end - frame.length));
            const double cx = (frame.length - frame.apex_x) * edge.inverse, cy = -frame.apex_y * edge.inverse;
            push(surface_.twin(next), begin, std::min(end, edge.length), -ax * cx - ay * cy, cy * ax - cx * ay, w.offset,
                 w.via == none ? w.rotation - metric_.corner_angle(next) : w.rotation, w.root, w.via, +1);
        }
        if (to_left && surface_.twin(prev) != none) {
            const HalfedgeFrame& edge = metric_.frame(prev);
            const double begin = edge.length * (w.y * w.begin) / (w.y * w.begin + left);
            const double end = right < 0 ? edge.length * (w.y * w.end) / (w.y * w.end + right) : edge.length;
            const double cx = frame.apex_x * edge.inverse, cy = frame.apex_y * edge.inverse;
            push(surface_.twin(prev), std::max(begin, 0.0), end, w.x * cx + w.y * cy, cx * w.y - cy * w.x, w.offset,
                 w.via == none ? w.rotation + metric_.corner_angle(h) : w.rotation, w.root, w.via, -1);
        }
    }

    void reach_apex(const Window& w, double d) {
        const int prev = Surface::prev(w.halfedge), c = surface_.origin(prev);
        if (!better(c, d, w.root))
            return;
        const HalfedgeFrame& frame = metric_.frame(w.halfedge);
        const double bx = w.x - frame.apex_x, by = w.y - frame.apex_y;  // back from the apex
        const double arrival =
            metric_.fan_angle(prev) + std::atan2(-frame.apex_x * by + frame.apex_y * bx, -frame.apex_x * bx - frame.apex_y * by);
        if (w.via == none)
            reach_from_source(c, d, w.root, none, w.rotation + std::atan2(-by, -bx), arrival);
        else
            reach(c, d, w.root, w.via, w.rotation, arrival, infinity, false);
    }

    // ---- targets ----

    struct Target {
        SurfacePoint at;
        int vertex;
        double bound;
    };

    void reach_targets(const Window& w) {
        for (Target& target : pending_) {
            if (target.vertex != none || target.at.face != w.halfedge / 3)
                continue;
            const HalfedgeFrame& frame = metric_.frame(w.halfedge);
            const Eigen::Vector2d p = to_frame(frame, w.halfedge, target.at.bary);
            const double dx = p.x() - w.x, dy = p.y() - w.y;
            const double left = (w.begin - w.x) * dy + w.y * dx, right = (w.end - w.x) * dy + w.y * dx;
            if (left <= 0 && right >= 0)
                target.bound = std::min(target.bound, w.offset + std::sqrt(dx * dx + dy * dy));
        }
    }

    /// Everything nearer than `key` has been propagated: are all targets within?
    bool targets_done(double key) {
        while (!pending_.empty()) {
            Target& target = pending_.back();
            double bound = target.vertex != none ? field_.distance[target.vertex] : target.bound;
            if (target.vertex == none) {
                for (int k = 0; k < 3; ++k) {
                    const int h = 3 * target.at.face + k;
                    bound = std::min(bound,
                                     field_.distance[surface_.origin(h)] + to_frame(metric_.frame(h), h, target.at.bary).norm());
                }
                for (const GeodesicSource& source : sources_)
                    if (source.at.face == target.at.face)
                        bound = std::min(bound,
                                         source.distance + (surface_.position(source.at) - surface_.position(target.at)).norm());
            }
            if (!(bound < key))
                return false;
            pending_.pop_back();
        }
        return true;
    }

    void finish() {
        for (std::size_t v = 0; v < field_.distance.size(); ++v)
            if (field_.distance[v] > options_.max_distance) {
                field_.distance[v] = infinity;
                field_.root[v] = field_.via[v] = none;
                field_.direction[v] = field_.arrival[v] = 0;
                field_.is_source[v] = field_.is_pseudo_source[v] = 0;
            }
        if (!options_.keep_windows)
            return;
        std::vector<std::size_t>& first = field_.window_first;
        first.assign(surface_.halfedge_count() + 1, 0);
        std::erase_if(kept_, [&](const Window& w) { return dominated(w); });  // by what was found after them
        for (const Window& w : kept_) ++first[w.halfedge + 1];
        for (std::size_t h = 0; h + 1 < first.size(); ++h) first[h + 1] += first[h];
        field_.windows.resize(kept_.size());
        std::vector<std::size_t> place(first.begin(), first.end() - 1);
        for (const Window& w : kept_) {
            GeodesicWindow& out = field_.windows[place[w.halfedge]++];
            out.halfedge = w.halfedge;
            out.begin = w.begin;
            out.end = w.end;
            out.source = {w.x, w.y};
            out.offset = w.offset;
            out.root = w.root;
            out.via = w.via;
            out.rotation = w.rotation;
        }
    }

    const Surface& surface_;
    std::span<const GeodesicSource> sources_;
    const GeodesicOptions& options_;
    SurfaceMetric metric_;
    std::vector<Occupant> occupant_;
    std::vector<Window> pool_;
    std::vector<int> free_;
    WindowQueue queue_;
    std::vector<Window> kept_;
    std::vector<Target> pending_;
    GeodesicField field_;
};

}  // namespace

GeodesicField geodesic_distances(const Surface& surface, std::span<const GeodesicSource> sources,
                                 const GeodesicOptions& options) {
    return Propagation(surface, sources, options).run();
}

SurfacePoint at_vertex(const Surface& surface, int vertex) {
    const int h = vertex >= 0 && vertex < surface.vertex_count() ? surface.outgoing(vertex) : none;
    if (h == none)
        throw Error(ErrorKind::bad_input, "vertex " + std::to_string(vertex) + " is not on a face of the surface");
    SurfacePoint point;
    point.face = h / 3;
    point.bary.setZero();
    point.bary[h % 3] = 1;
    return point;
}

}  // namespace pvg
