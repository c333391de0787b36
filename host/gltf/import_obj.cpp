// Wavefront .obj: v, vt, vn and f; everything else is passed over.
#include <map>
#include <unordered_map>

#include "gltf/import_mesh.h"
#include "gltf/import_text.h"

namespace pvg::gltf {
namespace {

/// One corner: numbers of position, texture coordinate and normal, from 0; none where absent.
using Corner = std::array<int, 3>;

struct CornerHash {
    std::size_t operator()(const Corner& corner) const {
        std::uint64_t h = 0x9e3779b97f4a7c15ull;
        for (int part : corner) {
            h ^= static_cast<std::uint32_t>(part);
            h *= 0xff51afd7ed558ccdull;
            h ^= h >> 32;
        }
        return static_cast<std::size_t>(h);
    }
};

Corner read_corner(const TextLines& lines, std::string_view word, const std::array<std::size_t, 3>& counts) {
    constexpr std::array names{"vertex", "texture coordinate", "normal"};
    Corner corner{none, none, none};
    std::size_t at = 0;
    for (int part = 0; part < 3 && at <= word.size(); ++part) {
        const std::size_t end = std::min(word.find('/', at), word.size());
        const std::string_view digits = word.substr(at, end - at);
        if (!digits.empty()) {
            const long long number = lines.integer(digits), count = static_cast<long long>(counts[part]);
            if (number == 0 || number > count || number < -count)
                lines.fail(std::string(names[part]) + " " + std::to_string(number) + ": there are " + std::to_string(count) +
                           " so far, counted from 1 (or -1 backwards)");
            corner[part] = static_cast<int>(number > 0 ? number - 1 : count + number);
        } else if (part == 0) {
            lines.fail("a corner without a vertex: \"" + TextLines::shown(word) + "\"");
        }
        at = end + 1;
    }
    return corner;
}

}  // namespace

ImportedMesh read_obj(const std::string& file, std::string_view text, Warnings&) {
    TextLines lines(file, text, '#');
    std::vector<std::array<float, 3>> points, normals, colors;
    std::vector<std::array<float, 2>> texcoords;
    std::vector<Corner> corners;
    std::unordered_map<Corner, int, CornerHash> numbers;
    ImportedMesh mesh;
    std::vector<std::string_view> joined;
    while (lines.next_filled()) {
        // A line that ends in a backslash goes on in the next.
        while (lines.words.back() == "\\") {
            joined = lines.words;
            joined.pop_back();
            if (!lines.next())
                break;
            lines.words.insert(lines.words.begin(), joined.begin(), joined.end());
            if (lines.words.empty())
                break;
        }
        if (lines.words.empty())
            continue;
        const std::string_view key = lines.words[0];
        if (key == "v") {
            points.push_back(lines.vector(1));
            // Colours as an extension many tools write: all vertices have one, or it is not used.
            if (lines.words.size() >= 7) {
                colors.resize(points.size() - 1, {1, 1, 1});
                colors.push_back(lines.vector(4));
            }
            if (points.size() > most_elements)
                lines.fail("more than " + std::to_string(most_elements) + " vertices");
        } else if (key == "vt") {
            const double v = lines.words.size() > 2 ? lines.number(2) : 0.0;
            texcoords.push_back({static_cast<float>(lines.number(1)), static_cast<float>(1 - v)});
        } else if (key == "vn") {
            normals.push_back(lines.vector(1));
        } else if (key == "f") {
            if (lines.words.size() < 4)
                lines.fail("a face has at least three corners, found " + std::to_string(lines.words.size() - 1));
            std::vector<int> polygon;
            for (std::size_t i = 1; i < lines.words.size(); ++i) {
                const Corner corner = read_corner(lines, lines.words[i], {points.size(), texcoords.size(), normals.size()});
                const auto [at, fresh] = numbers.emplace(corner, static_cast<int>(corners.size()));
                if (fresh)
                    corners.push_back(corner);
                polygon.push_back(at->second);
            }
            for (std::size_t i = 1; i + 1 < polygon.size(); ++i) mesh.faces.push_back({polygon[0], polygon[i], polygon[i + 1]});
            if (corners.size() > most_elements || mesh.faces.size() > most_elements)
                lines.fail("more than " + std::to_string(most_elements) + " vertices or triangles");
        }
    }
    bool all_textured = !corners.empty(), all_normal = !corners.empty();
    for (const Corner& corner : corners) {
        all_textured = all_textured && corner[1] != none;
        all_normal = all_normal && corner[2] != none;
    }
    const bool all_colored = !colors.empty() && colors.size() == points.size();
    for (const Corner& corner : corners) {
        mesh.points.push_back(points[corner[0]]);
        if (all_textured)
            mesh.texcoords.push_back(texcoords[corner[1]]);
        if (all_normal)
            mesh.normals.push_back(normals[corner[2]]);
        if (all_colored) {
            const auto& c = colors[corner[0]];
            mesh.colors.push_back({linear_from_srgb(c[0]), linear_from_srgb(c[1]), linear_from_srgb(c[2]), 1});
        }
    }
    return mesh;
}

}  // namespace pvg::gltf
