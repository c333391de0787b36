// One face divided among the images of its knots: the lower envelope of distances |p - image| + offset, each valid in the
// bundle of geodesics that makes it. The face starts as one convex polygon; every image cuts its part out of the polygons
// that exist, so the parts always add up to the face, whatever the rounding.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace pvg {

/// A knot or pseudo-source unfolded into the plane of the face.
struct KnotImage {
    int knot = -1;
    Eigen::Vector2d at{0, 0};
    double offset = 0;
    /// Half planes side . p >= level outside which the image does not count; only the first `sides` are set.
    std::array<Eigen::Vector2d, 2> side;
    std::array<double, 2> level{0, 0};
    int sides = 0;
};

class FacePartition {
public:
    struct Polygon {
        std::vector<int> points;  ///< counter-clockwise, convex; collinear points allowed
        int image = -1;
    };

    /// Corners counter-clockwise.
    void start(const std::array<Eigen::Vector2d, 3>& corners);
    /// Image `number` of `images` takes what is nearer to it than to the owners so far.
    void insert(const std::vector<KnotImage>& images, int number);
    /// Gives what no image claimed (slivers between bundles) to the image nearest by straight distance.
    void close(const std::vector<KnotImage>& images);

    int polygon_count() const { return count_; }
    const Polygon& polygon(int i) const { return polygons_[i]; }
    std::size_t point_count() const { return points_.size(); }
    const Eigen::Vector2d& point(int i) const { return points_[i]; }
    double area(const Polygon& polygon) const;

    static double distance(const KnotImage& image, const Eigen::Vector2d& p) { return image.offset + (p - image.at).norm(); }

private:
    using Vector2 = Eigen::Vector2d;

    /// Whether the taker is nearer than the owner anywhere in the convex polygon `region_`; exact.
    bool wins(const KnotImage& taker, const KnotImage& owner) const;
    /// Sets region_ to the part of the polygon where the image counts. False when nothing is left.
    bool restrict(const Polygon& polygon, const KnotImage& image);
    /// Cuts a polygon along value(p) = 0 and returns the polygon on the positive side (-1: nothing is there). The rest
    /// keeps the number `polygon`, unless all of it is positive, when `polygon` itself is returned.
    template <typename Value>
    int cut(int polygon, double tolerance, const Value& value);
    void take(const std::vector<KnotImage>& images, int taker, int polygon);
    void take_curved(const std::vector<KnotImage>& images, int taker, int polygon);
    int split_edge(int polygon, std::size_t edge, double t);
    int add_polygon();

    std::vector<Vector2> points_;
    std::vector<Polygon> polygons_;  // the first count_ are in use; the others keep their memory
    int count_ = 0;
    double size_ = 0;             // of the face
    std::vector<double> values_;  // scratch of cut
    std::vector<int> rest_;
    std::vector<Vector2> region_, clipped_;
};

}  // namespace pvg
