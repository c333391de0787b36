#include "geodesic/face_cones.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pvg/status.h"

namespace pvg {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

bool Cone::covers(const Eigen::Vector2d& p, double angle) const {
    if (!wedge)
        return true;
    const Eigen::Vector2d l = left - center, r = right - center, d = p - center;
    const double of_left = cross(l, d), of_right = cross(r, d);
    if (of_left > 0 && of_left > angle * l.norm() * d.norm())
        return false;
    return !(of_right < 0 && -of_right > angle * r.norm() * d.norm());
}

double fan_angle(const Surface& surface, int halfedge) {
    double sum = 0;
    for (int h = surface.outgoing(surface.origin(halfedge)); h != halfedge; h = surface.twin(Surface::prev(h))) {
        const HalfedgeFrame frame = halfedge_frame(surface, h);
        sum += std::atan2(frame.apex_y, frame.apex_x);
    }
    return sum;
}

FaceCones::FaceCones(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources)
    : surface_(surface), field_(field), sources_(sources) {
    if (field.window_first.size() != static_cast<std::size_t>(surface.halfedge_count()) + 1)
        throw Error(ErrorKind::bad_input, "geodesic field: distances between vertices need the field computed with keep_windows");
    for (int i = 0; i < static_cast<int>(sources.size()); ++i) {
        const Place place = place_of(surface, sources[i].at);
        if (place.vertex != none)
            continue;
        inner_.emplace_back(sources[i].at.face, i);
        const int twin = place.halfedge == none ? none : surface.twin(place.halfedge);
        if (twin != none)
            inner_.emplace_back(twin / 3, i);
    }
    std::sort(inner_.begin(), inner_.end());
}

void FaceCones::lay_out(int face) {
    for (int k = 0; k < 3; ++k) frame_[k] = halfedge_frame(surface_, 3 * face + k);
    corners_ = {Eigen::Vector2d(0, 0), Eigen::Vector2d(frame_[0].length, 0), Eigen::Vector2d(frame_[0].apex_x, frame_[0].apex_y)};
    turn_[0] = 0;
    for (int k : {1, 2}) turn_[k] = turn_[k - 1] + std::numbers::pi - std::atan2(frame_[k].apex_y, frame_[k].apex_x);
}

bool FaceCones::reached(int face) const {
    for (int v : surface_.face(face))
        if (std::isfinite(field_.distance[v]))
            return true;
    if (field_.window_first[3 * face] != field_.window_first[3 * face + 3])
        return true;
    const auto inner = std::lower_bound(inner_.begin(), inner_.end(), std::pair(face, 0));
    return inner != inner_.end() && inner->first == face;
}

const std::vector<Cone>& FaceCones::at(int face) {
    if (face == face_)
        return cones_;
    face_ = face;
    lay_out(face);
    cones_.clear();
    for (int k = 0; k < 3; ++k) {
        const int h = 3 * face + k;
        const Eigen::Vector2d origin = corners_[k];
        const Eigen::Vector2d axis = (corners_[(k + 1) % 3] - origin) * frame_[k].inverse, up(-axis.y(), axis.x());
        for (std::size_t i = field_.window_first[h]; i < field_.window_first[h + 1]; ++i) {
            const GeodesicWindow& w = field_.windows[i];
            Cone cone;
            cone.center = origin + w.source.x() * axis + w.source.y() * up;
            cone.offset = w.offset;
            cone.root = w.root;
            cone.vertex = w.via != none ? w.via : place_of(surface_, sources_[w.root].at).vertex;
            cone.straight = w.via == none;
            cone.rotation = w.via == none ? w.rotation - turn_[k] : w.rotation;
            cone.wedge = true;
            cone.left = origin + w.begin * axis;
            cone.right = origin + w.end * axis;
            cone.halfedge = h;
            cones_.push_back(cone);
        }
        const int v = surface_.origin(h);
        if (!(field_.is_source[v] || field_.is_pseudo_source[v]))
            continue;
        Cone cone;
        cone.center = origin;
        cone.offset = field_.distance[v];
        cone.root = field_.root[v];
        cone.vertex = v;
        cone.straight = field_.is_source[v] != 0;
        cone.rotation = cone.straight ? fan_angle(surface_, h) - turn_[k] : field_.direction[v];
        cones_.push_back(cone);
    }
    for (auto it = std::lower_bound(inner_.begin(), inner_.end(), std::pair(face, 0)); it != inner_.end() && it->first == face;
         ++it) {
        const GeodesicSource& source = sources_[it->second];
        Cone cone;
        cone.offset = source.distance;
        cone.root = it->second;
        cone.straight = true;
        if (source.at.face == face) {
            cone.center = to_frame(frame_[0], 3 * face, source.at.bary);
        } else {
            const int there = place_of(surface_, source.at).halfedge, here = surface_.twin(there), k = here % 3;
            const Eigen::Vector2d axis = (corners_[(k + 1) % 3] - corners_[k]) * frame_[k].inverse;
            cone.center = corners_[k] + axis * (frame_[k].length * source.at.bary[there % 3]);
            double turn = 0;  // of the edge in the source's own face
            for (int h = 3 * source.at.face; h != there; ++h) {
                const HalfedgeFrame frame = halfedge_frame(surface_, h + 1);
                turn += std::numbers::pi - std::atan2(frame.apex_y, frame.apex_x);
            }
            cone.rotation = turn + std::numbers::pi - turn_[k];
        }
        cones_.push_back(cone);
    }
    return cones_;
}

int FaceCones::nearest(int face, const Eigen::Vector2d& p, double* value) const {
    int best = none;
    double least = std::numeric_limits<double>::infinity();
    if (face == face_)
        for (int i = 0; i < static_cast<int>(cones_.size()); ++i) {
            const double d = cones_[i].value(p);
            if (d < least && cones_[i].covers(p, slack)) {
                least = d;
                best = i;
            }
        }
    if (value)
        *value = least;
    return best;
}

}  // namespace pvg
