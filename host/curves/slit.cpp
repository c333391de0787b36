#include "curves/slit.h"

#include <utility>

namespace pvg {

SlitSurface slit_surface(const Surface& parent, std::span<const char> slit, std::span<const char> keep) {
    const auto kept = [&](int face) { return keep.empty() || keep[face]; };
    const auto cut = [&](int h) {
        const int twin = parent.twin(h);
        if (twin == none)
            return true;
        return (!slit.empty() && (slit[h] || slit[twin])) || kept(h / 3) != kept(twin / 3);
    };

    // Per corner (the halfedge that leaves the vertex): its sector's copy.
    std::vector<int> copy(parent.halfedge_count(), none);
    std::vector<int> fan;
    std::vector<int> sector;
    struct Further {
        int vertex;
        std::vector<int> corners;
    };
    std::vector<Further> further;
    SlitSurface result;
    std::vector<Point> points;
    for (int v = 0; v < parent.vertex_count(); ++v) {
        fan.clear();
        int h = parent.outgoing(v);
        const int start = h;
        while (h != none) {
            fan.push_back(h);
            h = parent.twin(Surface::prev(h));
            if (h == start)
                break;
        }
        const bool around = !fan.empty() && h == start;
        // The edge between corners i and i + 1 is the outgoing edge of corner i + 1.
        sector.assign(fan.size(), 0);
        int sectors = fan.empty() ? 0 : 1;
        for (std::size_t i = 1; i < fan.size(); ++i) {
            if (cut(fan[i]))
                ++sectors;
            sector[i] = sectors - 1;
        }
        if (around && sectors > 1 && !cut(fan[0])) {
            const int last = --sectors;
            for (int& s : sector)
                if (s == last)
                    s = 0;
        }
        bool first = true;
        if (fan.empty() && keep.empty()) {
            points.push_back(parent.point(v));
            result.vertex_parent.push_back(v);
        }
        for (int s = 0; s < sectors; ++s) {
            std::vector<int> corners;
            for (std::size_t i = 0; i < fan.size(); ++i)
                if (sector[i] == s && kept(fan[i] / 3))
                    corners.push_back(fan[i]);
            if (corners.empty())
                continue;
            if (!first) {
                further.push_back({v, std::move(corners)});
                continue;
            }
            first = false;
            for (int corner : corners) copy[corner] = static_cast<int>(points.size());
            points.push_back(parent.point(v));
            result.vertex_parent.push_back(v);
        }
    }
    for (const Further& extra : further) {
        for (int corner : extra.corners) copy[corner] = static_cast<int>(points.size());
        points.push_back(parent.point(extra.vertex));
        result.vertex_parent.push_back(extra.vertex);
    }

    std::vector<Face> faces;
    for (int f = 0; f < parent.face_count(); ++f) {
        if (!kept(f))
            continue;
        faces.push_back({copy[3 * f], copy[3 * f + 1], copy[3 * f + 2]});
        result.face_parent.push_back(f);
    }
    result.surface = Surface(std::move(points), std::move(faces));
    return result;
}

}  // namespace pvg
