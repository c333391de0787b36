// The closest point of a surface: what turns positions of a scene into surface points. A tree of boxes over the faces, all in
// double (C. Ericson, "Real-Time Collision Detection", 2005, 5.1.5 for the closest point of a triangle).
#pragma once

#include <vector>

#include "mesh/surface.h"

namespace pvg {

struct ClosestPoint {
    SurfacePoint at;      ///< at a vertex or on an edge with coordinates that are exactly 1 or 0
    double distance = 0;  ///< from the query point
};

/// Built once for a surface, which must outlive it; then O(log F) a query. Thread-safe queries.
class ClosestPointTree {
public:
    /// Throws Error(bad_input) for a surface without faces.
    explicit ClosestPointTree(const Surface& surface);
    /// Ties go to the lowest face.
    ClosestPoint closest(const Point& query) const;

private:
    struct Box {
        Point low, high;
        int begin = 0, end = 0;  ///< of order_, in a leaf
        int second = none;       ///< the second child; the first one follows its parent; none in a leaf
    };
    int build(int begin, int end, const std::vector<Point>& centers);

    const Surface* surface_;
    std::vector<int> order_;
    std::vector<Box> boxes_;
};

/// The closest point of one triangle, by its barycentric coordinates.
Eigen::Vector3d closest_in_triangle(const Point& query, const Point& a, const Point& b, const Point& c);

}  // namespace pvg
