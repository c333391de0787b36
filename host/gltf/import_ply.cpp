// Stanford .ply, text and binary of either byte order (Greg Turk, "The PLY polygon file format", 1994).
#include <algorithm>
#include <bit>
#include <cstring>

#include "gltf/import_mesh.h"
#include "gltf/import_text.h"

namespace pvg::gltf {
namespace {

enum class Number { i8, u8, i16, u16, i32, u32, f32, f64 };

std::size_t width(Number type) {
    switch (type) {
        case Number::i8:
        case Number::u8:
            return 1;
        case Number::i16:
        case Number::u16:
            return 2;
        case Number::f64:
            return 8;
        default:
            return 4;
    }
}

struct Property {
    std::string name;
    Number type = Number::f32;
    bool is_list = false;
    Number count_type = Number::u8;
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
    int find(std::initializer_list<const char*> names) const {
        for (std::size_t p = 0; p < properties.size(); ++p)
            for (const char* wanted : names)
                if (properties[p].name == wanted)
                    return static_cast<int>(p);
        return none;
    }
};

struct Header {
    bool ascii = true, swap = false;
    std::vector<Element> elements;
};

Number number_type(const TextLines& lines, std::string_view word) {
    constexpr std::array<std::pair<std::string_view, Number>, 16> names{{{"char", Number::i8},
                                                                         {"int8", Number::i8},
                                                                         {"uchar", Number::u8},
                                                                         {"uint8", Number::u8},
                                                                         {"short", Number::i16},
                                                                         {"int16", Number::i16},
                                                                         {"ushort", Number::u16},
                                                                         {"uint16", Number::u16},
                                                                         {"int", Number::i32},
                                                                         {"int32", Number::i32},
                                                                         {"uint", Number::u32},
                                                                         {"uint32", Number::u32},
                                                                         {"float", Number::f32},
                                                                         {"float32", Number::f32},
                                                                         {"double", Number::f64},
                                                                         {"float64", Number::f64}}};
    for (const auto& [name, type] : names)
        if (name == word)
            return type;
    lines.fail("\"" + TextLines::shown(word) + "\" is no type of number");
}

Header read_header(const std::string& file, std::string_view text) {
    TextLines lines(file, text, '\0');
    Header header;
    bool has_format = false;
    if (!lines.next() || lines.words.size() != 1 || lines.words[0] != "ply")
        lines.fail("a .ply file starts with \"ply\"");
    while (lines.next()) {
        const auto& words = lines.words;
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info")
            continue;
        if (words[0] == "end_header") {
            if (!has_format)
                lines.fail("the header has no format");
            return header;
        }
        if (words[0] == "format") {
            if (words.size() < 2)
                lines.fail("the format's name is missing");
            header.ascii = words[1] == "ascii";
            const bool little = words[1] == "binary_little_endian", big = words[1] == "binary_big_endian";
            if (!header.ascii && !little && !big)
                lines.fail("unknown format \"" + TextLines::shown(words[1]) +
                           "\"; ascii, binary_little_endian and binary_big_endian can be read");
            header.swap = big != (std::endian::native == std::endian::big);
            if (header.ascii)
                header.swap = false;
            has_format = true;
        } else if (words[0] == "element") {
            if (words.size() != 3)
                lines.fail("expected \"element NAME COUNT\"");
            const long long count = lines.integer(2);
            if (count < 0)
                lines.fail("a negative number of elements");
            header.elements.push_back({std::string(words[1]), static_cast<std::uint64_t>(count), {}});
        } else if (words[0] == "property") {
            if (header.elements.empty())
                lines.fail("a property before any element");
            Property property;
            if (words.size() == 5 && words[1] == "list") {
                property = {std::string(words[4]), number_type(lines, words[3]), true, number_type(lines, words[2])};
                if (property.count_type == Number::f32 || property.count_type == Number::f64)
                    lines.fail("a list's length should be an integer");
            } else if (words.size() == 3) {
                property = {std::string(words[2]), number_type(lines, words[1]), false, Number::u8};
            } else {
                lines.fail("expected \"property TYPE NAME\" or \"property list TYPE TYPE NAME\"");
            }
            header.elements.back().properties.push_back(property);
        } else {
            lines.fail("unknown keyword \"" + TextLines::shown(words[0]) + "\"");
        }
    }
    lines.fail("the header has no end_header");
}

/// Numbers of the body, one after another.
class Body {
public:
    Body(const std::string& file, std::string_view text, std::size_t at, const Header& header)
        : file_(&file), text_(text), at_(at), header_(&header) {}

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorKind::bad_input, *file_ + ": byte " + std::to_string(at_) + ": " + what);
    }
    std::size_t left() const { return text_.size() - at_; }

    double next(Number type) { return header_->ascii ? next_word() : next_binary(type); }

private:
    double next_word() {
        while (at_ < text_.size() && static_cast<unsigned char>(text_[at_]) <= ' ') ++at_;
        std::size_t end = at_;
        while (end < text_.size() && static_cast<unsigned char>(text_[end]) > ' ') ++end;
        if (end == at_)
            fail("the file ends in the middle of its data");
        std::string_view word = text_.substr(at_, end - at_);
        if (word.size() > 1 && word[0] == '+')
            word.remove_prefix(1);
        double value = 0;
        const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (stop != word.data() + word.size() || (error != std::errc() && error != std::errc::result_out_of_range))
            fail("expected a number, found \"" + TextLines::shown(word) + "\"");
        at_ = end;
        return value;
    }

    double next_binary(Number type) {
        const std::size_t size = width(type);
        if (left() < size)
            fail("the file ends in the middle of its data");
        std::array<unsigned char, 8> bytes{};
        std::memcpy(bytes.data(), text_.data() + at_, size);
        if (header_->swap)
            std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
        at_ += size;
        const auto as = [&]<typename T>(T value) {
            std::memcpy(&value, bytes.data(), sizeof(T));
            return static_cast<double>(value);
        };
        switch (type) {
            case Number::i8:
                return as(std::int8_t{});
            case Number::u8:
                return as(std::uint8_t{});
            case Number::i16:
                return as(std::int16_t{});
            case Number::u16:
                return as(std::uint16_t{});
            case Number::i32:
                return as(std::int32_t{});
            case Number::u32:
                return as(std::uint32_t{});
            case Number::f32:
                return as(float{});
            default:
                return as(double{});
        }
    }

    const std::string* file_;
    std::string_view text_;
    std::size_t at_;
    const Header* header_;
};

/// One element's numbers: scalars by property, and one list.
struct Row {
    std::vector<double> scalar;
    std::vector<double> list;
};

void read_row(Body& body, const Element& element, int list_property, Row& row) {
    row.scalar.assign(element.properties.size(), 0);
    row.list.clear();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const Property& property = element.properties[p];
        if (!property.is_list) {
            row.scalar[p] = body.next(property.type);
            continue;
        }
        const double count = body.next(property.count_type);
        if (!(count >= 0) || count > static_cast<double>(body.left()))
            body.fail("a list of " + std::to_string(count) + " entries does not fit the file");
        for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i) {
            const double value = body.next(property.type);
            if (static_cast<int>(p) == list_property)
                row.list.push_back(value);
        }
    }
}

void read_vertices(Body& body, const Element& element, ImportedMesh& mesh) {
    std::array<int, 3> xyz{element.find({"x"}), element.find({"y"}), element.find({"z"})};
    std::array<int, 3> normal{element.find({"nx"}), element.find({"ny"}), element.find({"nz"})};
    std::array<int, 4> color{element.find({"red", "r", "diffuse_red"}), element.find({"green", "g", "diffuse_green"}),
                             element.find({"blue", "b", "diffuse_blue"}), element.find({"alpha", "a"})};
    std::array<int, 2> texcoord{element.find({"s", "u", "texture_u"}), element.find({"t", "v", "texture_v"})};
    const auto present = [&](auto first, auto last) {
        return std::all_of(first, last, [&](int p) { return p != none && !element.properties[p].is_list; });
    };
    if (!present(xyz.begin(), xyz.end()))
        body.fail("vertices have no x, y and z");
    const bool has_normal = present(normal.begin(), normal.end()), has_color = present(color.begin(), color.begin() + 3),
               has_texcoord = present(texcoord.begin(), texcoord.end());
    Row row;
    for (std::uint64_t v = 0; v < element.count; ++v) {
        read_row(body, element, none, row);
        const auto real = [&](int p) {
            const double value = row.scalar[p];
            if (!std::isfinite(value) || std::abs(value) > 3.4028234e38)
                body.fail("vertex " + std::to_string(v) + " holds a number that is not finite");
            return static_cast<float>(value);
        };
        mesh.points.push_back({real(xyz[0]), real(xyz[1]), real(xyz[2])});
        if (has_normal)
            mesh.normals.push_back({real(normal[0]), real(normal[1]), real(normal[2])});
        if (has_texcoord)
            mesh.texcoords.push_back({real(texcoord[0]), 1 - real(texcoord[1])});
        if (has_color) {
            std::array<float, 4> rgba{1, 1, 1, 1};
            for (int c = 0; c < 4; ++c) {
                if (color[c] == none || element.properties[color[c]].is_list)
                    continue;
                const Number type = element.properties[color[c]].type;
                const double full = type == Number::u8 ? 255 : type == Number::u16 ? 65535 : 1;
                const double value = std::clamp(real(color[c]) / full, 0.0, 1.0);
                rgba[c] = c < 3 ? linear_from_srgb(value) : static_cast<float>(value);
            }
            mesh.colors.push_back(rgba);
        }
    }
}

void read_faces(Body& body, const Element& element, std::uint64_t vertex_count, ImportedMesh& mesh) {
    const int indices = element.find({"vertex_indices", "vertex_index"});
    if (indices == none || !element.properties[indices].is_list)
        body.fail("faces have no list vertex_indices");
    Row row;
    for (std::uint64_t f = 0; f < element.count; ++f) {
        read_row(body, element, indices, row);
        for (double index : row.list)
            if (!(index >= 0) || index >= static_cast<double>(vertex_count) || index != std::floor(index))
                body.fail("face " + std::to_string(f) + " has a corner that is none of the " + std::to_string(vertex_count) +
                          " vertices");
        for (std::size_t k = 1; k + 1 < row.list.size(); ++k)
            mesh.faces.push_back(
                {static_cast<int>(row.list[0]), static_cast<int>(row.list[k]), static_cast<int>(row.list[k + 1])});
        if (mesh.faces.size() > most_elements)
            body.fail("more than " + std::to_string(most_elements) + " triangles");
    }
}

}  // namespace

ImportedMesh read_ply(const std::string& file, std::string_view text, Warnings&) {
    const Header header = read_header(file, text);
    std::size_t at = text.find("end_header");
    // The keyword may also stand in a comment: take the line that is it.
    while (at != std::string_view::npos &&
           !(at > 0 && text[at - 1] == '\n' && at + 10 < text.size() && (text[at + 10] == '\n' || text[at + 10] == '\r')))
        at = text.find("end_header", at + 1);
    if (at == std::string_view::npos)
        throw Error(ErrorKind::bad_input, file + ": the file ends with its header");
    at = text.find('\n', at);
    if (at == std::string_view::npos)
        throw Error(ErrorKind::bad_input, file + ": the file ends with its header");
    Body body(file, text, at + 1, header);
    ImportedMesh mesh;
    bool has_vertices = false;
    Row row;
    for (const Element& element : header.elements) {
        std::uint64_t least = 0;
        for (const Property& property : element.properties)
            least += header.ascii ? 1 : width(property.is_list ? property.count_type : property.type);
        if (least > 0 && element.count > body.left() / least)
            body.fail(std::to_string(element.count) + " elements \"" + TextLines::shown(element.name) + "\" do not fit the file");
        if (element.name == "vertex" && !has_vertices) {
            if (element.count > most_elements)
                body.fail("more than " + std::to_string(most_elements) + " vertices");
            read_vertices(body, element, mesh);
            has_vertices = true;
        } else if (element.name == "face") {
            if (!has_vertices)
                body.fail("faces before vertices");
            read_faces(body, element, mesh.points.size(), mesh);
        } else if (least > 0) {
            for (std::uint64_t i = 0; i < element.count; ++i) read_row(body, element, none, row);
        }
    }
    return mesh;
}

}  // namespace pvg::gltf
