#include "curves/snap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "pvg/status.h"

namespace pvg {
namespace {

constexpr int leaf_faces = 4;
constexpr double clean = 1e-10;  // smaller barycentric coordinates are rounding

double squared_distance(const Point& query, const Point& low, const Point& high) {
    return (low - query).cwiseMax(query - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

Eigen::Vector3d closest_in_triangle(const Point& query, const Point& a, const Point& b, const Point& c) {
    const Point ab = b - a, ac = c - a, ap = query - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0)
        return {1, 0, 0};
    const Point bp = query - b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3)
        return {0, 1, 0};
    const Point cp = query - c;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6)
        return {0, 0, 1};
    const double to_c = d1 * d4 - d3 * d2, to_b = d5 * d2 - d1 * d6, to_a = d3 * d6 - d5 * d4;  // areas times a common factor
    if (to_c <= 0 && d1 >= 0 && d3 <= 0) {
        const double s = d1 / (d1 - d3);
        return {1 - s, s, 0};
    }
    if (to_b <= 0 && d2 >= 0 && d6 <= 0) {
        const double s = d2 / (d2 - d6);
        return {1 - s, 0, s};
    }
    if (to_a <= 0 && d4 >= d3 && d5 >= d6) {
        const double s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return {0, 1 - s, s};
    }
    return Eigen::Vector3d(to_a, to_b, to_c) / (to_a + to_b + to_c);
}

ClosestPointTree::ClosestPointTree(const Surface& surface) : surface_(&surface), order_(surface.face_count()) {
    if (surface.face_count() == 0)
        throw Error(ErrorKind::bad_input, "surface: no faces, so no closest point");
    std::iota(order_.begin(), order_.end(), 0);
    std::vector<Point> centers(surface.face_count());
    for (int f = 0; f < surface.face_count(); ++f) {
        const auto& [a, b, c] = surface.face(f);
        centers[f] = (surface.point(a) + surface.point(b) + surface.point(c)) / 3;
    }
    boxes_.reserve(surface.face_count());
    build(0, surface.face_count(), centers);
}

int ClosestPointTree::build(int begin, int end, const std::vector<Point>& centers) {
    const int number = static_cast<int>(boxes_.size());
    boxes_.emplace_back();
    Box box;
    box.low = Point::Constant(std::numeric_limits<double>::infinity());
    box.high = -box.low;
    Point least = box.low, most = box.high;
    for (int i = begin; i < end; ++i) {
        for (int v : surface_->face(order_[i])) {
            box.low = box.low.cwiseMin(surface_->point(v));
            box.high = box.high.cwiseMax(surface_->point(v));
        }
        least = least.cwiseMin(centers[order_[i]]);
        most = most.cwiseMax(centers[order_[i]]);
    }
    box.begin = begin;
    box.end = end;
    if (end - begin > leaf_faces) {
        int axis = 0;
        (most - least).maxCoeff(&axis);
        const int middle = (begin + end) / 2;
        std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int a, int b) {
            return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
        });
        build(begin, middle, centers);
        box.second = build(middle, end, centers);
    }
    boxes_[number] = box;
    return number;
}

ClosestPoint ClosestPointTree::closest(const Point& query) const {
    double best = std::numeric_limits<double>::infinity();
    SurfacePoint at;
    // The tree halves its faces at each level, so 64 waiting boxes are plenty.
    std::array<int, 64> waiting;
    int count = 0;
    waiting[count++] = 0;
    while (count > 0) {
        const int number = waiting[--count];
        const Box& box = boxes_[number];
        if (squared_distance(query, box.low, box.high) > best)
            continue;
        if (box.second == none) {
            for (int i = box.begin; i < box.end; ++i) {
                const auto& [a, b, c] = surface_->face(order_[i]);
                const Eigen::Vector3d bary =
                    closest_in_triangle(query, surface_->point(a), surface_->point(b), surface_->point(c));
                if (!bary.allFinite())
                    continue;  // a face without area; its edges belong to other faces too
                const double away = (surface_->position({order_[i], bary}) - query).squaredNorm();
                if (away < best || (away == best && order_[i] < at.face)) {
                    best = away;
                    at = {order_[i], bary};
                }
            }
            continue;
        }
        const int first = number + 1;
        const bool first_nearer = squared_distance(query, boxes_[first].low, boxes_[first].high) <=
                                  squared_distance(query, boxes_[box.second].low, boxes_[box.second].high);
        waiting[count++] = first_nearer ? box.second : first;
        waiting[count++] = first_nearer ? first : box.second;
    }
    for (int k = 0; k < 3; ++k)
        if (at.bary[k] < clean)
            at.bary[k] = 0;
    at.bary /= at.bary.sum();
    return {at, std::sqrt(best)};
}

}  // namespace pvg
