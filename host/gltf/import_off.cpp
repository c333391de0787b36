// Geomview's .off in text: OFF, and with normals (N), colours (C) and texture coordinates (ST) at the vertices.
#include "gltf/import_mesh.h"
#include "gltf/import_text.h"

namespace pvg::gltf {

ImportedMesh read_off(const std::string& file, std::string_view text, Warnings&) {
    TextLines lines(file, text, '#');
    if (!lines.next_filled())
        throw Error(ErrorKind::bad_input, file + ": the file is empty; an .off file starts with \"OFF\"");
    std::string_view kind = lines.words[0];
    if (!kind.ends_with("OFF"))
        lines.fail("an .off file starts with \"OFF\", found \"" + TextLines::shown(kind) + "\"");
    kind.remove_suffix(3);
    bool textured = false, colored = false, with_normals = false;
    if (kind.starts_with("ST"))
        textured = true, kind.remove_prefix(2);
    if (kind.starts_with("C"))
        colored = true, kind.remove_prefix(1);
    if (kind.starts_with("N"))
        with_normals = true, kind.remove_prefix(1);
    if (!kind.empty())
        lines.fail("\"" + TextLines::shown(lines.words[0]) + "\": only OFF with ST, C and N before it can be read");
    lines.words.erase(lines.words.begin());
    if (!lines.words.empty() && lines.words[0] == "BINARY")
        lines.fail("a binary .off cannot be read; store it as text");
    if (lines.words.empty() && !lines.next_filled())
        lines.fail("the numbers of vertices and faces are missing");
    const long long vertex_count = lines.integer(0), face_count = lines.integer(1);
    // Every vertex needs a line of at least 6 bytes, every face one of at least 8.
    const auto size = static_cast<long long>(text.size());
    if (vertex_count < 0 || face_count < 0 || vertex_count > size / 5 || face_count > size / 7)
        lines.fail(std::to_string(vertex_count) + " vertices and " + std::to_string(face_count) + " faces do not fit a file of " +
                   std::to_string(size) + " bytes");
    ImportedMesh mesh;
    for (long long v = 0; v < vertex_count; ++v) {
        if (!lines.next_filled())
            lines.fail("the file ends after " + std::to_string(v) + " of " + std::to_string(vertex_count) + " vertices");
        std::size_t at = 3;
        mesh.points.push_back(lines.vector(0));
        if (with_normals) {
            mesh.normals.push_back(lines.vector(at));
            at += 3;
        }
        if (colored) {
            // Whole numbers are of 255, others of 1; the alpha may be missing.
            const std::size_t tail = textured ? 2 : 0;
            const std::size_t parts = lines.words.size() > at + 3 + tail ? 4 : 3;
            bool whole = true;
            for (std::size_t k = 0; k < parts; ++k)
                whole = whole && at + k < lines.words.size() &&
                        lines.words[at + k].find_first_not_of("0123456789") == std::string_view::npos;
            std::array<float, 4> color{1, 1, 1, 1};
            for (std::size_t k = 0; k < parts; ++k) {
                const double value = lines.number(at + k) / (whole ? 255.0 : 1.0);
                color[k] = k < 3 ? linear_from_srgb(value) : static_cast<float>(value);
            }
            mesh.colors.push_back(color);
            at += parts;
        }
        if (textured)
            mesh.texcoords.push_back({static_cast<float>(lines.number(at)), static_cast<float>(1 - lines.number(at + 1))});
    }
    for (long long f = 0; f < face_count; ++f) {
        if (!lines.next_filled())
            lines.fail("the file ends after " + std::to_string(f) + " of " + std::to_string(face_count) + " faces");
        const long long corners = lines.integer(0);
        if (corners < 1 || corners >= static_cast<long long>(lines.words.size()))
            lines.fail("a face of " + std::to_string(corners) + " corners, the line has " +
                       std::to_string(lines.words.size() - 1) + " numbers");
        std::vector<int> polygon;
        for (long long k = 0; k < corners; ++k) {
            const long long vertex = lines.integer(static_cast<std::size_t>(k + 1));
            if (vertex < 0 || vertex >= vertex_count)
                lines.fail("vertex " + std::to_string(vertex) + ": there are " + std::to_string(vertex_count) +
                           ", counted from 0");
            polygon.push_back(static_cast<int>(vertex));
        }
        for (std::size_t k = 1; k + 1 < polygon.size(); ++k) mesh.faces.push_back({polygon[0], polygon[k], polygon[k + 1]});
    }
    return mesh;
}

}  // namespace pvg::gltf
