// The diagram is the lower envelope, in every face, of the distances from the unfolded images of the knots (Mount, "On
// finding shortest paths on convex polyhedra", 1985; Liu, Chen and Tang, "Construction of iso-contours, bisectors and
// Voronoi diagrams on triangulated surfaces", TPAMI 33(8), 2011).
#include "solve/voronoi.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "pvg/status.h"
#include "solve/face_partition.h"
#include "solve/knot_windows.h"

namespace pvg {
namespace {

using Vector2 = Eigen::Vector2d;

/// Common borders shorter than this part of the distance between the knots are rounding of cells that meet in a point.
constexpr double touching = 1e-9;

/// A piece of the common border of two cells.
struct Segment {
    int a, b;  // a < b
    double length;
    double distance;  // between the images on both sides
};

/// A stretch of a halfedge that belongs to one cell.
struct Stretch {
    double begin, end;
    int knot;
};

class Diagram {
public:
    Diagram(const Domain& domain, const Knots& knots)
        : surface_(domain.surface), knots_(knots), windows_(knot_windows(surface_, knots.vertex)) {}

    Voronoi build() {
        const int faces = surface_.face_count();
        face_knot_.assign(faces, none);
        stretch_first_.assign(3 * static_cast<std::size_t>(faces) + 1, 0);
        for (int f = 0; f < faces; ++f) divide(f);
        stretch_first_.back() = stretches_.size();
        match_edges();
        Voronoi result;
        result.cell = std::move(windows_.knot);
        result.distance = std::move(windows_.distance);
        result.direction = std::move(windows_.direction);
        result.area.assign(knots_.vertex.size(), 0.0);
        for (const CellPiece& piece : pieces_) result.area[piece.cell] += piece.area;
        result.pieces = std::move(pieces_);
        connect(result);
        return result;
    }

private:
    struct FaceFrame {
        std::array<Vector2, 3> corners;
        std::array<Vector2, 3> along;  // unit, of halfedge k
        std::array<double, 3> length;
    };

    FaceFrame frame_of(int face) const {
        const auto& [a, b, c] = surface_.face(face);
        const Point edge = surface_.point(b) - surface_.point(a), to = surface_.point(c) - surface_.point(a);
        FaceFrame frame;
        const double length = edge.norm();
        frame.corners = {Vector2(0, 0), Vector2(length, 0), Vector2(edge.dot(to) / length, edge.cross(to).norm() / length)};
        for (int k = 0; k < 3; ++k) {
            const Vector2 step = frame.corners[(k + 1) % 3] - frame.corners[k];
            frame.length[k] = step.norm();
            frame.along[k] = step / frame.length[k];
        }
        return frame;
    }

    /// All images that may own a part of the face. Returns the common knot, or none when they belong to several.
    int gather(int face, std::vector<KnotImage>& images, const FaceFrame* frame) const {
        images.clear();
        int common = -2;
        const auto see = [&](int knot) { common = common == -2 || common == knot ? knot : none; };
        for (int k = 0; k < 3; ++k) {
            const int v = surface_.face(face)[k];
            if (windows_.knot[v] != none && (windows_.distance[v] == 0 || windows_.pseudo_source[v])) {
                see(windows_.knot[v]);
                if (frame) {
                    images.emplace_back();
                    images.back().knot = windows_.knot[v];
                    images.back().at = frame->corners[k];
                    images.back().offset = windows_.distance[v];
                }
            }
            for (std::size_t i = windows_.first[3 * face + k]; i < windows_.first[3 * face + k + 1]; ++i) {
                const KnotWindow& window = windows_.windows[i];
                see(window.knot);
                if (frame)
                    images.push_back(image_of(window, *frame, k));
            }
        }
        if (common == -2)
            throw Error(ErrorKind::bad_input,
                        "Voronoi diagram: no knot reaches face " + std::to_string(face) + "; every component needs one");
        return common;
    }

    static KnotImage image_of(const KnotWindow& window, const FaceFrame& frame, int k) {
        const Vector2 x = frame.along[k], y(-x.y(), x.x());
        KnotImage image;
        image.knot = window.knot;
        image.at = frame.corners[k] + window.source.x() * x + window.source.y() * y;
        image.offset = window.offset;
        const auto bound = [&](double end, double sign) {
            const Vector2 ray = frame.corners[k] + end * x - image.at;
            const double length = ray.norm();
            if (!(length > 0))
                return;
            const Vector2 normal = sign / length * Vector2(ray.y(), -ray.x());
            image.side[image.sides] = normal;
            image.level[image.sides++] = normal.dot(image.at);
        };
        if (window.bounded) {
            bound(window.begin, 1);
            bound(window.end, -1);
        }
        return image;
    }

    void divide(int face) {
        for (int k = 0; k < 3; ++k) stretch_first_[3 * static_cast<std::size_t>(face) + k] = stretches_.size();
        const int common = gather(face, images_, nullptr);
        if (common != none) {
            face_knot_[face] = common;
            pieces_.push_back({face, common, surface_.face_area(face)});
            return;
        }
        const FaceFrame frame = frame_of(face);
        gather(face, images_, &frame);
        sort_images(frame);
        partition_.start(frame.corners);
        for (int i = 0; i < static_cast<int>(images_.size()); ++i) partition_.insert(images_, i);
        partition_.close(images_);
        collect_pieces(face);
        if (face_knot_[face] != none)
            return;
        collect_segments();
        collect_stretches(face, frame);
    }

    /// Nearest to the middle first: it takes most of the face at once, and few others find anything to win.
    void sort_images(const FaceFrame& frame) {
        const Vector2 middle = (frame.corners[0] + frame.corners[1] + frame.corners[2]) / 3;
        order_.clear();
        for (int i = 0; i < static_cast<int>(images_.size()); ++i)
            order_.push_back({FacePartition::distance(images_[i], middle), i});
        std::sort(order_.begin(), order_.end());
        sorted_.clear();
        for (const auto& [distance, i] : order_) sorted_.push_back(images_[i]);
        images_.swap(sorted_);
    }

    int knot_of(int polygon) const { return images_[partition_.polygon(polygon).image].knot; }

    void collect_pieces(int face) {
        const std::size_t first = pieces_.size();
        double sum = 0;
        for (int i = 0; i < partition_.polygon_count(); ++i) {
            const double area = std::max(0.0, partition_.area(partition_.polygon(i)));
            sum += area;
            const int knot = knot_of(i);
            std::size_t at = first;
            while (at < pieces_.size() && pieces_[at].cell != knot) ++at;
            if (at == pieces_.size())
                pieces_.push_back({face, knot, 0});
            pieces_[at].area += area;
        }
        const double area = surface_.face_area(face);
        for (std::size_t i = first; i < pieces_.size(); ++i)
            pieces_[i].area = sum > 0 ? pieces_[i].area * (area / sum) : area / static_cast<double>(pieces_.size() - first);
        std::sort(pieces_.begin() + static_cast<std::ptrdiff_t>(first), pieces_.end(),
                  [](const CellPiece& a, const CellPiece& b) { return a.cell < b.cell; });
        if (pieces_.size() == first + 1)
            face_knot_[face] = pieces_[first].cell;
    }

    /// How far apart two knots are as seen from a point of their bisector: exact in flat parts, where their images stand.
    static double apart(const Vector2& from_a, double distance_a, const Vector2& from_b, double distance_b) {
        const double na = from_a.norm(), nb = from_b.norm();
        if (!(na > 0) || !(nb > 0))
            return distance_a + distance_b;
        return (distance_a / na * from_a - distance_b / nb * from_b).norm();
    }

    void add_segment(int a, int b, double length, double distance) {
        if (length > 0 && distance > 0)
            segments_.push_back({std::min(a, b), std::max(a, b), length, distance});
    }

    void collect_segments() {
        const std::size_t points = partition_.point_count();
        if (polygon_left_of_.size() < points * points)
            polygon_left_of_.assign(4 * points * points, none);
        const auto each_edge = [&](const auto& visit) {
            for (int i = 0; i < partition_.polygon_count(); ++i) {
                const std::vector<int>& corners = partition_.polygon(i).points;
                for (std::size_t e = 0; e < corners.size(); ++e)
                    visit(i, corners[e], corners[e + 1 < corners.size() ? e + 1 : 0]);
            }
        };
        each_edge([&](int i, int from, int to) { polygon_left_of_[from * points + to] = i; });
        each_edge([&](int i, int from, int to) {
            const int j = polygon_left_of_[to * points + from];
            if (j <= i || knot_of(i) == knot_of(j))
                return;
            const KnotImage &a = images_[partition_.polygon(i).image], &b = images_[partition_.polygon(j).image];
            const Vector2 middle = (partition_.point(from) + partition_.point(to)) / 2;
            const double d = a.offset == 0 && b.offset == 0 ? (a.at - b.at).norm()
                                                            : apart(middle - a.at, FacePartition::distance(a, middle),
                                                                    middle - b.at, FacePartition::distance(b, middle));
            add_segment(a.knot, b.knot, (partition_.point(to) - partition_.point(from)).norm(), d);
        });
        each_edge([&](int, int from, int to) { polygon_left_of_[from * points + to] = none; });
    }

    /// Which cells lie along the face's own edges. Corners are points 0, 1, 2 of the partition.
    void collect_stretches(int face, const FaceFrame& frame) {
        for (int k = 0; k < 3; ++k) {
            const std::size_t first = stretches_.size();
            stretch_first_[3 * static_cast<std::size_t>(face) + k] = first;
            const double size = *std::max_element(frame.length.begin(), frame.length.end());
            const auto on_edge = [&](int p) {
                if (p < 3)
                    return p == k || p == (k + 1) % 3;
                const Vector2 to = partition_.point(p) - frame.corners[k];
                return std::abs(frame.along[k].x() * to.y() - frame.along[k].y() * to.x()) <= 1e-12 * size;
            };
            for (int i = 0; i < partition_.polygon_count(); ++i) {
                const std::vector<int>& points = partition_.polygon(i).points;
                for (std::size_t e = 0; e < points.size(); ++e) {
                    const int from = points[e], to = points[(e + 1) % points.size()];
                    if (!on_edge(from) || !on_edge(to))
                        continue;
                    const double begin = frame.along[k].dot(partition_.point(from) - frame.corners[k]);
                    const double end = frame.along[k].dot(partition_.point(to) - frame.corners[k]);
                    if (begin < end)
                        stretches_.push_back({begin, end, knot_of(i)});
                }
            }
            std::sort(stretches_.begin() + static_cast<std::ptrdiff_t>(first), stretches_.end(),
                      [](const Stretch& a, const Stretch& b) { return a.begin < b.begin; });
        }
    }

    /// Cells that meet exactly along a mesh edge (knots mirrored in it, as on regular grids) have no segment inside a face.
    void match_edges() {
        std::vector<Stretch> here, there;
        const auto stretches_of = [&](int h, std::vector<Stretch>& out) {
            const int face = h / 3;
            out.clear();
            if (face_knot_[face] != none)
                out.push_back({0, surface_.length(h), face_knot_[face]});
            else
                out.assign(stretches_.begin() + static_cast<std::ptrdiff_t>(stretch_first_[h]),
                           stretches_.begin() + static_cast<std::ptrdiff_t>(stretch_first_[h + 1]));
        };
        for (int h = 0; h < surface_.halfedge_count(); ++h) {
            const int other = surface_.twin(h);
            if (other == none || other < h)
                continue;
            if (face_knot_[h / 3] != none && face_knot_[h / 3] == face_knot_[other / 3])
                continue;
            stretches_of(h, here);
            stretches_of(other, there);
            const double length = surface_.length(h);
            for (const Stretch& mine : here)
                for (const Stretch& theirs : there) {
                    if (mine.knot == theirs.knot)
                        continue;
                    const double begin = std::max(mine.begin, length - theirs.end),
                                 end = std::min(mine.end, length - theirs.begin);
                    if (end - begin > 1e-9 * length)
                        add_segment(mine.knot, theirs.knot, end - begin,
                                    apart_across(h, (begin + end) / 2, mine.knot, theirs.knot));
                }
        }
    }

    double apart_across(int h, double at, int mine, int theirs) {
        Vector2 from[2];
        double distance[2] = {0, 0};
        for (int side = 0; side < 2; ++side) {
            const int halfedge = side == 0 ? h : surface_.twin(h), k = halfedge % 3;
            const FaceFrame frame = frame_of(halfedge / 3);
            gather(halfedge / 3, images_, &frame);
            const Vector2 x = frame.along[k], y(-x.y(), x.x());
            const Vector2 p = frame.corners[k] + (side == 0 ? at : frame.length[k] - at) * x;
            const KnotImage* best = nullptr;
            for (const KnotImage& image : images_)
                if (image.knot == (side == 0 ? mine : theirs) &&
                    (!best || FacePartition::distance(image, p) < FacePartition::distance(*best, p)))
                    best = &image;
            if (!best)
                return 0;
            distance[side] = FacePartition::distance(*best, p);
            const Vector2 to = p - best->at;
            from[side] = (side == 0 ? 1 : -1) * Vector2(x.dot(to), y.dot(to));
        }
        return apart(from[0], distance[0], from[1], distance[1]);
    }

    void connect(Voronoi& result) {
        std::stable_sort(segments_.begin(), segments_.end(),
                         [](const Segment& s, const Segment& t) { return s.a != t.a ? s.a < t.a : s.b < t.b; });
        for (std::size_t i = 0; i < segments_.size();) {
            CellEdge edge{segments_[i].a, segments_[i].b, 0, 0, segments_[i].distance};
            for (; i < segments_.size() && segments_[i].a == edge.a && segments_[i].b == edge.b; ++i) {
                edge.length += segments_[i].length;
                edge.weight += segments_[i].length / segments_[i].distance;
                edge.distance = std::min(edge.distance, segments_[i].distance);
            }
            if (edge.length > touching * edge.distance)
                result.edges.push_back(edge);
        }
        const std::size_t n = knots_.vertex.size();
        result.neighbour_first.assign(n + 1, 0);
        for (const CellEdge& edge : result.edges) {
            ++result.neighbour_first[edge.a + 1];
            ++result.neighbour_first[edge.b + 1];
        }
        for (std::size_t i = 0; i < n; ++i) result.neighbour_first[i + 1] += result.neighbour_first[i];
        result.neighbours.resize(2 * result.edges.size());
        std::vector<int> end(result.neighbour_first.begin(), result.neighbour_first.end() - 1);
        // Sorted by (a, b): first each cell's lower neighbours, then its higher ones, both ascending.
        for (const CellEdge& edge : result.edges) result.neighbours[end[edge.b]++] = edge.a;
        for (const CellEdge& edge : result.edges) result.neighbours[end[edge.a]++] = edge.b;
    }

    const Surface& surface_;
    const Knots& knots_;
    KnotWindows windows_;
    std::vector<KnotImage> images_, sorted_;
    std::vector<std::pair<double, int>> order_;
    FacePartition partition_;
    std::vector<int> polygon_left_of_;  // from x points + to; none between faces
    std::vector<int> face_knot_;        // F: the only cell in the face, or none
    std::vector<CellPiece> pieces_;
    std::vector<Segment> segments_;
    std::vector<Stretch> stretches_;
    std::vector<std::size_t> stretch_first_;
};

}  // namespace

Voronoi geodesic_voronoi(const Domain& domain, const Knots& knots) { return Diagram(domain, knots).build(); }

}  // namespace pvg
