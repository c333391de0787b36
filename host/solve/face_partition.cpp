#include "solve/face_partition.h"

#include <algorithm>
#include <cmath>

namespace pvg {
namespace {

using Vector2 = Eigen::Vector2d;

double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Distances that differ by less than this part of the face's size are equal: ties stay with the first owner.
constexpr double tie = 1e-12;
/// Hyperbola arcs are cut into chords that span at most this angle, seen from their focus.
constexpr double chord_angle = 0.12;

}  // namespace

void FacePartition::start(const std::array<Vector2, 3>& corners) {
    points_.assign(corners.begin(), corners.end());
    count_ = 0;
    size_ = std::sqrt(std::max({(corners[1] - corners[0]).squaredNorm(), (corners[2] - corners[1]).squaredNorm(),
                                (corners[0] - corners[2]).squaredNorm()}));
    Polygon& whole = polygons_[add_polygon()];
    whole.points.assign({0, 1, 2});
}

int FacePartition::add_polygon() {
    if (count_ == static_cast<int>(polygons_.size()))
        polygons_.emplace_back();
    polygons_[count_].points.clear();
    polygons_[count_].image = -1;
    return count_++;
}

double FacePartition::area(const Polygon& polygon) const {
    double doubled = 0;
    const Vector2& origin = points_[polygon.points[0]];
    for (std::size_t i = 1; i + 1 < polygon.points.size(); ++i)
        doubled += cross(points_[polygon.points[i]] - origin, points_[polygon.points[i + 1]] - origin);
    return doubled / 2;
}

bool FacePartition::restrict(const Polygon& polygon, const KnotImage& image) {
    region_.clear();
    for (int v : polygon.points) region_.push_back(points_[v]);
    for (int s = 0; s < image.sides; ++s) {
        const auto inside = [&](const Vector2& p) { return image.side[s].dot(p) - image.level[s] - tie * size_; };
        clipped_.clear();
        Vector2 before = region_.back();
        double value_before = inside(before);
        for (const Vector2& p : region_) {
            const double value = inside(p);
            if ((value > 0) != (value_before > 0))
                clipped_.push_back(before + value_before / (value_before - value) * (p - before));
            if (value > 0)
                clipped_.push_back(p);
            before = p;
            value_before = value;
        }
        region_.swap(clipped_);
        if (region_.size() < 3)
            return false;
    }
    return true;
}

bool FacePartition::wins(const KnotImage& taker, const KnotImage& owner) const {
    const double margin = tie * size_;
    if (taker.offset == owner.offset) {  // the bisector is straight: it shows at a corner
        for (const Vector2& p : region_)
            if ((p - owner.at).squaredNorm() > (p - taker.at).squaredNorm() + 2 * margin * (p - taker.at).norm())
                return true;
        return false;
    }
    for (const Vector2& p : region_)
        if (distance(taker, p) < distance(owner, p) - margin)
            return true;
    const double ahead = taker.offset - owner.offset + margin;
    // The taker's part is the outside of a convex set, so it would show at a corner; or it is empty.
    if (ahead <= 0 || (taker.at - owner.at).squaredNorm() <= ahead * ahead)
        return false;
    // It is the inside of a hyperbola branch, and the nearer to the focus the better: it would show on an edge. On the edge
    // p = from + t step the taker wins where excess(t) = |p - owner|^2 - |p - taker|^2 - ahead^2 is above 2 ahead |p -
    // taker|.
    for (std::size_t i = 0; i < region_.size(); ++i) {
        const Vector2& from = region_[i];
        const Vector2 step = region_[(i + 1) % region_.size()] - from;
        const double excess0 = (from - owner.at).squaredNorm() - (from - taker.at).squaredNorm() - ahead * ahead;
        const double excess1 = 2 * step.dot(taker.at - owner.at);
        const double a = excess1 * excess1 - 4 * ahead * ahead * step.squaredNorm();
        const double b = 2 * excess0 * excess1 - 8 * ahead * ahead * step.dot(from - taker.at);
        const double c = excess0 * excess0 - 4 * ahead * ahead * (from - taker.at).squaredNorm();
        if (!(a < 0))
            continue;  // a ray of the line, whose end would hold a corner
        const double t = -b / (2 * a);
        if (t > 0 && t < 1 && excess0 + t * excess1 > 0 && c + t * (b + t * a) > 0)
            return true;
    }
    return false;
}

int FacePartition::split_edge(int polygon, std::size_t edge, double t) {
    std::vector<int>& points = polygons_[polygon].points;
    const int from = points[edge], to = points[(edge + 1) % points.size()];
    const int fresh = static_cast<int>(points_.size());
    points_.push_back(points_[from] + t * (points_[to] - points_[from]));
    points.insert(points.begin() + static_cast<std::ptrdiff_t>(edge) + 1, fresh);
    for (int other = 0; other < count_; ++other) {
        if (other == polygon)
            continue;
        std::vector<int>& theirs = polygons_[other].points;
        for (std::size_t i = 0; i < theirs.size(); ++i)
            if (theirs[i] == to && theirs[(i + 1) % theirs.size()] == from) {
                theirs.insert(theirs.begin() + static_cast<std::ptrdiff_t>(i) + 1, fresh);
                return fresh;
            }
    }
    return fresh;
}

template <typename Value>
int FacePartition::cut(int polygon, double tolerance, const Value& value) {
    const auto evaluate = [&] {
        const std::vector<int>& points = polygons_[polygon].points;
        values_.resize(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            values_[i] = value(points_[points[i]]);
            if (std::abs(values_[i]) <= tolerance)
                values_[i] = 0;
        }
    };
    evaluate();
    const auto [low, high] = std::minmax_element(values_.begin(), values_.end());
    if (*high <= 0)
        return -1;
    if (*low >= 0)
        return polygon;
    // Points where edges cross the line; then every sign change is at a zero.
    for (std::size_t i = 0; i < values_.size(); ++i) {
        const double here = values_[i], there = values_[(i + 1) % values_.size()];
        if (!(here * there < 0))
            continue;
        split_edge(polygon, i, here / (here - there));
        values_.insert(values_.begin() + static_cast<std::ptrdiff_t>(i) + 1, 0.0);
    }
    // The longest run of positives, from the zero before it to the zero after it. Rounding on nearly collinear points may leave
    // others: they stay.
    const std::size_t n = values_.size();
    std::size_t best = n, best_length = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (!(values_[i] > 0) || values_[(i + n - 1) % n] > 0)
            continue;
        std::size_t run = 0;
        while (values_[(i + run) % n] > 0) ++run;
        if (run > best_length) {
            best = i;
            best_length = run;
        }
    }
    const std::size_t before = (best + n - 1) % n, after = (best + best_length) % n;
    if (before == after)
        return -1;
    const int fresh = add_polygon();
    std::vector<int>& mine = polygons_[polygon].points;
    std::vector<int>& theirs = polygons_[fresh].points;
    polygons_[fresh].image = polygons_[polygon].image;
    for (std::size_t i = before;; i = (i + 1) % n) {
        theirs.push_back(mine[i]);
        if (i == after)
            break;
    }
    rest_.clear();
    for (std::size_t i = after;; i = (i + 1) % n) {
        rest_.push_back(mine[i]);
        if (i == before)
            break;
    }
    mine.swap(rest_);
    return fresh;
}

void FacePartition::insert(const std::vector<KnotImage>& images, int number) {
    const KnotImage& taker = images[number];
    const int existing = count_;
    for (int i = 0; i < existing; ++i) {
        const int owner = polygons_[i].image;
        if (!restrict(polygons_[i], taker) || (owner != -1 && !wins(taker, images[owner])))
            continue;
        int target = i;
        for (int s = 0; s < taker.sides && target != -1; ++s)
            target = cut(target, tie * size_, [&](const Vector2& p) { return taker.side[s].dot(p) - taker.level[s]; });
        if (target != -1)
            take(images, number, target);
    }
}

void FacePartition::take(const std::vector<KnotImage>& images, int taker, int polygon) {
    const int owner = polygons_[polygon].image;
    if (owner != -1) {
        const KnotImage &a = images[taker], &b = images[owner];
        if (a.offset != b.offset) {
            take_curved(images, taker, polygon);
            return;
        }
        const Vector2 apart = a.at - b.at;
        const double gap = apart.norm();
        if (gap <= tie * size_)
            return;
        const Vector2 normal = apart / gap;
        const double level = normal.dot(a.at + b.at) / 2;
        polygon = cut(polygon, tie * size_, [&](const Vector2& p) { return normal.dot(p) - level; });
    }
    if (polygon != -1)
        polygons_[polygon].image = taker;
}

/// Offsets differ: the image with the larger one owns the inside of a hyperbola branch around itself. Rays from it cut the
/// polygon into sectors, and a chord cuts each sector, so all parts stay convex.
void FacePartition::take_curved(const std::vector<KnotImage>& images, int taker, int polygon) {
    const int owner = polygons_[polygon].image;
    const bool taker_inside = images[taker].offset > images[owner].offset;
    const KnotImage& inner = images[taker_inside ? taker : owner];
    const KnotImage& outer = images[taker_inside ? owner : taker];
    const double ahead = inner.offset - outer.offset;
    const Vector2 between = outer.at - inner.at;
    const double apart = between.norm();
    if (apart <= ahead + tie * size_) {  // the inner image is passed by geodesics from the outer one
        if (!taker_inside)
            polygons_[polygon].image = taker;
        return;
    }
    // Angles around the inner image, from the direction to the polygon's middle.
    Vector2 middle(0, 0);
    for (int v : polygons_[polygon].points) middle += points_[v];
    middle /= static_cast<double>(polygons_[polygon].points.size());
    Vector2 axis = middle - inner.at;
    if (!(axis.norm() > 0))
        return;
    axis.normalize();
    double low = 0, high = 0, reach = 0;
    for (int v : polygons_[polygon].points) {
        const Vector2 to = points_[v] - inner.at;
        reach = std::max(reach, to.norm());
        if (to.norm() <= tie * size_)
            continue;
        const double angle = std::atan2(cross(axis, to), axis.dot(to));
        low = std::min(low, angle);
        high = std::max(high, angle);
    }
    const int sectors = std::max(1, static_cast<int>(std::ceil((high - low) / chord_angle)));
    const auto ray = [&](int i) {
        const double angle = low + (high - low) * i / sectors;
        return Vector2(std::cos(angle) * axis.x() - std::sin(angle) * axis.y(),
                       std::sin(angle) * axis.x() + std::cos(angle) * axis.y());
    };
    const auto boundary = [&](const Vector2& u) {
        const double rate = 2 * (ahead + u.dot(between)), power = apart * apart - ahead * ahead;
        const double far = 2 * reach;  // beyond the polygon, for rays that do not meet the branch
        return power < far * rate ? power / rate : far;
    };
    int sector = polygon;
    for (int i = 0; i < sectors && sector != -1; ++i) {
        const Vector2 from = ray(i), to = ray(i + 1);
        // What lies left of the ray `to` waits for the next sectors.
        int rest = -1;
        if (i + 1 < sectors) {
            rest = cut(sector, tie * size_, [&](const Vector2& p) { return cross(to, p - inner.at); });
            if (rest == sector)
                continue;
        }
        const Vector2 a = inner.at + boundary(from) * from, b = inner.at + boundary(to) * to;
        const Vector2 chord = b - a;
        const double length = chord.norm();
        if (length > 0) {
            const double sign = taker_inside ? 1 : -1;
            const int won = cut(sector, tie * size_, [&](const Vector2& p) { return sign * cross(chord, p - a) / length; });
            if (won != -1)
                polygons_[won].image = taker;
        }
        sector = rest;
    }
}

void FacePartition::close(const std::vector<KnotImage>& images) {
    for (int i = 0; i < count_; ++i) {
        if (polygons_[i].image != -1)
            continue;
        Vector2 middle(0, 0);
        for (int v : polygons_[i].points) middle += points_[v];
        middle /= static_cast<double>(polygons_[i].points.size());
        int best = -1;
        for (int c = 0; c < static_cast<int>(images.size()); ++c)
            if (best == -1 || distance(images[c], middle) < distance(images[best], middle))
                best = c;
        polygons_[i].image = best;
    }
}

}  // namespace pvg
