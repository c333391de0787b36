#include "gltf/output_attributes.h"

#include <algorithm>
#include <cmath>

#include "gltf/influences.h"

namespace pvg::gltf {
namespace {

constexpr int float_type = TINYGLTF_COMPONENT_TYPE_FLOAT;
/// The Khronos validator's limit for how far a unit vector's length may be off.
constexpr double unit_tolerance = 0.00674;

OutputAttribute empty_like(const std::string& name, const std::string& type, std::size_t components, std::size_t count) {
    OutputAttribute out;
    out.name = name;
    out.type = type;
    out.components = components;
    out.values.reserve(components * count);
    return out;
}

/// Linear in the origin's weights; a raw vertex's own numbers stay bit for bit.
OutputAttribute interpolated(const Attribute& attribute, const std::vector<OutputVertex>& vertices) {
    OutputAttribute out = empty_like(attribute.name, attribute.type, attribute.components, vertices.size());
    for (const OutputVertex& vertex : vertices)
        for (std::size_t c = 0; c < attribute.components; ++c) {
            if (vertex.is_raw()) {
                out.values.push_back(attribute.at(vertex.raw[0])[c]);
                continue;
            }
            double sum = 0;
            for (int i = 0; i < 3 && vertex.raw[i] != none; ++i) sum += vertex.weight[i] * attribute.at(vertex.raw[i])[c];
            out.values.push_back(static_cast<float>(sum));
        }
    return out;
}

/// Integers that are not normalized name things (features, materials): a new vertex takes those of the nearest corner.
OutputAttribute nearest(const Attribute& attribute, const std::vector<OutputVertex>& vertices) {
    OutputAttribute out = empty_like(attribute.name, attribute.type, attribute.components, vertices.size());
    out.component_type = attribute.component_type;
    for (const OutputVertex& vertex : vertices) {
        int best = 0;
        for (int i = 1; i < 3 && vertex.raw[i] != none; ++i)
            if (vertex.weight[i] > vertex.weight[best])
                best = i;
        out.values.insert(out.values.end(), attribute.at(vertex.raw[best]),
                          attribute.at(vertex.raw[best]) + attribute.components);
    }
    return out;
}

Point blended(const Attribute& attribute, const OutputVertex& vertex) {
    Point sum = Point::Zero();
    for (int i = 0; i < 3 && vertex.raw[i] != none; ++i) {
        const float* at = attribute.at(vertex.raw[i]);
        sum += vertex.weight[i] * Point(at[0], at[1], at[2]);
    }
    return sum;
}

Point point_of(const OutputAttribute& attribute, std::size_t vertex) {
    const float* at = attribute.values.data() + vertex * attribute.components;
    return {at[0], at[1], at[2]};
}

void push(OutputAttribute& attribute, const Point& p) {
    for (int c = 0; c < 3; ++c) attribute.values.push_back(static_cast<float>(p[c]));
}

OutputAttribute positions(const AttributeContext& context) {
    const DecoratedMesh& mesh = *context.mesh;
    const Attribute& raw = *context.primitive->find("POSITION");
    OutputAttribute out = empty_like("POSITION", "VEC3", 3, context.output->vertices.size());
    for (const OutputVertex& vertex : context.output->vertices) {
        const bool kept = vertex.vertex == none || (vertex.is_raw() && vertex.wall == none && !mesh.moved[vertex.vertex]);
        const float* at = kept ? raw.at(vertex.raw[0]) : mesh.position[vertex.vertex].data();
        for (int c = 0; c < 3; ++c)
            if (!std::isfinite(at[c]))
                throw Error(ErrorKind::bad_input, context.place + ": a displaced position is not finite");
        out.values.insert(out.values.end(), at, at + 3);
    }
    return out;
}

/// Sums of the adjacent triangles' area vectors, for vertices that nobody gives a normal.
std::vector<Point> area_vectors(const OutputPrimitive& output, const OutputAttribute& position) {
    std::vector<Point> sums(output.vertices.size(), Point::Zero());
    for (const auto& t : output.triangles) {
        const Point a = point_of(position, t[0]), b = point_of(position, t[1]), c = point_of(position, t[2]);
        for (std::uint32_t v : t) sums[v] += (b - a).cross(c - a);
    }
    return sums;
}

/// Whether a vertex shows the input's own normal bits.
bool keeps_normal(const DecoratedMesh& mesh, const OutputVertex& vertex) {
    if (vertex.wall != none || !vertex.is_raw())
        return false;
    return vertex.vertex == none || vertex.normal == none || !mesh.decorated[vertex.vertex];
}

/// Nothing where neither the input nor the decorated mesh has normals.
std::optional<OutputAttribute> normals(const AttributeContext& context, const OutputAttribute& position) {
    const DecoratedMesh& mesh = *context.mesh;
    const std::vector<OutputVertex>& vertices = context.output->vertices;
    const Attribute* raw = context.primitive->find("NORMAL");
    const bool given =
        std::any_of(vertices.begin(), vertices.end(), [](const OutputVertex& v) { return v.normal != none || v.wall != none; });
    if (!raw && !given)
        return std::nullopt;
    OutputAttribute out = empty_like("NORMAL", "VEC3", 3, vertices.size());
    std::vector<Point> fallback;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        const OutputVertex& vertex = vertices[v];
        Point normal = Point::Zero();
        if (raw && keeps_normal(mesh, vertex)) {
            const float* at = raw->at(vertex.raw[0]);
            const double length = Point(at[0], at[1], at[2]).norm();
            if (std::abs(length - 1) > unit_tolerance)
                throw Error(ErrorKind::bad_input, context.place + "/attributes/NORMAL: the normal of vertex " +
                                                      std::to_string(vertex.raw[0]) + " has length " + std::to_string(length) +
                                                      "; expected unit vectors");
            out.values.insert(out.values.end(), at, at + 3);
            continue;
        }
        if (vertex.wall != none)
            normal =
                Point(mesh.walls[vertex.wall].normal[0], mesh.walls[vertex.wall].normal[1], mesh.walls[vertex.wall].normal[2]);
        else if (vertex.normal != none)
            normal = Point(mesh.normals[vertex.normal][0], mesh.normals[vertex.normal][1], mesh.normals[vertex.normal][2]);
        else if (raw)
            normal = blended(*raw, vertex);
        if (!(normal.norm() > 1e-12) || !normal.allFinite()) {
            if (fallback.empty())
                fallback = area_vectors(*context.output, position);
            normal = fallback[v];
        }
        if (!(normal.norm() > 0) || !normal.allFinite())
            normal = Point(0, 0, 1);
        push(out, normal.normalized());
    }
    return out;
}

/// Directions of growing u, orthonormal to the normal; the sign of the bitangent is the input's. Undecorated vertices keep
/// theirs.
OutputAttribute tangents(const AttributeContext& context, const OutputAttribute& position, const OutputAttribute& normal,
                         const OutputAttribute& texcoord) {
    const DecoratedMesh& mesh = *context.mesh;
    const std::vector<OutputVertex>& vertices = context.output->vertices;
    const Attribute& raw = *context.primitive->find("TANGENT");
    std::vector<Point> along_u(vertices.size(), Point::Zero());
    for (const auto& t : context.output->triangles) {
        const Point a = point_of(position, t[0]), e1 = point_of(position, t[1]) - a, e2 = point_of(position, t[2]) - a;
        const float *ta = &texcoord.values[2 * t[0]], *tb = &texcoord.values[2 * t[1]], *tc = &texcoord.values[2 * t[2]];
        const double u1 = tb[0] - ta[0], v1 = tb[1] - ta[1], u2 = tc[0] - ta[0], v2 = tc[1] - ta[1];
        // dP/du up to a positive factor, weighted by the triangle's area on the surface.
        const double determinant = u1 * v2 - u2 * v1;
        const Point direction = (e1 * v2 - e2 * v1) * (determinant < 0 ? -1.0 : 1.0);
        if (determinant == 0 || !(direction.norm() > 0))
            continue;
        for (std::uint32_t v : t) along_u[v] += direction.normalized() * e1.cross(e2).norm();
    }
    OutputAttribute out = empty_like("TANGENT", "VEC4", 4, vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        const OutputVertex& vertex = vertices[v];
        int nearest_corner = 0;
        for (int i = 1; i < 3 && vertex.raw[i] != none; ++i)
            if (vertex.weight[i] > vertex.weight[nearest_corner])
                nearest_corner = i;
        const float sign = raw.at(vertex.raw[nearest_corner])[3] < 0 ? -1.0f : 1.0f;
        if (keeps_normal(mesh, vertex)) {
            const float* at = raw.at(vertex.raw[0]);
            if (std::abs(Point(at[0], at[1], at[2]).norm() - 1) <= unit_tolerance && std::abs(at[3]) == 1) {
                out.values.insert(out.values.end(), at, at + 4);
                continue;
            }
        }
        const Point n = point_of(normal, v);
        Point tangent = Point::Zero();
        const Point axis = Point::Unit(std::abs(n[0]) < 0.6 ? 0 : 1);
        for (const Point& candidate : {along_u[v], blended(raw, vertex), axis}) {
            tangent = candidate - n * n.dot(candidate);
            if (tangent.norm() > 1e-6 * candidate.norm() && tangent.norm() > 0)
                break;
        }
        push(out, tangent.normalized());
        out.values.push_back(sign);
    }
    return out;
}

/// COLOR_0: the decoration's RGB where colour is reached, else the input's times the old base colour factor; the alpha is the
/// input's.
OutputAttribute colors(const AttributeContext& context) {
    const DecoratedMesh& mesh = *context.mesh;
    const Attribute* raw = context.primitive->find("COLOR_0");
    OutputAttribute out = empty_like("COLOR_0", "VEC4", 4, context.output->vertices.size());
    out.component_type = context.fields ? float_type : TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    out.normalized = !context.fields;
    for (const OutputVertex& vertex : context.output->vertices) {
        std::array<double, 4> rgba{1, 1, 1, 1};
        if (raw)
            for (std::size_t c = 0; c < raw->components; ++c) {
                rgba[c] = 0;
                for (int i = 0; i < 3 && vertex.raw[i] != none; ++i)
                    rgba[c] += (vertex.is_raw() ? 1.0 : vertex.weight[i]) * raw->at(vertex.raw[i])[c];
            }
        if (context.output->decorated) {
            const bool reached = vertex.vertex != none && mesh.color_decorated[vertex.vertex];
            for (int c = 0; c < 3; ++c) rgba[c] = reached ? mesh.color[vertex.vertex][c] : rgba[c] * context.base_color[c];
        }
        for (double value : rgba) {
            if (!std::isfinite(value))
                throw Error(ErrorKind::bad_input, context.place + ": a colour is not finite");
            const double clamped = std::clamp(value, 0.0, 1.0);
            out.values.push_back(static_cast<float>(context.fields ? clamped : std::round(clamped * 65535)));
        }
    }
    return out;
}

}  // namespace

OutputAttributes output_attributes(const AttributeContext& context, Warnings& warnings) {
    const RawPrimitive& primitive = *context.primitive;
    const std::vector<OutputVertex>& vertices = context.output->vertices;
    OutputAttributes out;
    const OutputAttribute position = positions(context);
    const std::optional<OutputAttribute> normal = normals(context, position);
    out.attributes.push_back(position);
    if (normal)
        out.attributes.push_back(*normal);

    bool drop_tangents = false;
    if (primitive.find("TANGENT")) {
        const Attribute* texcoord = primitive.find("TEXCOORD_" + std::to_string(context.tangent_texcoord));
        if (texcoord && normal) {
            out.attributes.push_back(tangents(context, position, *normal, interpolated(*texcoord, vertices)));
        } else {
            drop_tangents = true;
            warnings.push_back(context.place +
                               ": tangents are left out: there are no texture coordinates to recompute them from");
        }
    }
    const bool colored = context.output->decorated || primitive.find("COLOR_0");
    if (colored)
        out.attributes.push_back(colors(context));
    for (const Attribute& attribute : primitive.attributes) {
        const std::string& name = attribute.name;
        if (name == "POSITION" || name == "NORMAL" || name == "TANGENT" || name == "COLOR_0" || is_set_of(name, "JOINTS_") ||
            is_set_of(name, "WEIGHTS_"))
            continue;
        if (is_set_of(name, "_PVG_"))
            continue;  // of an earlier decoration
        const bool integers = attribute.component_type != float_type && !attribute.normalized;
        out.attributes.push_back(name[0] == '_' && integers ? nearest(attribute, vertices) : interpolated(attribute, vertices));
        if (is_set_of(name, "COLOR_"))
            for (float& value : out.attributes.back().values) value = std::clamp(value, 0.0f, 1.0f);
    }
    for (OutputAttribute& attribute : influences(primitive, vertices, context.joint_count, context.place, warnings))
        out.attributes.push_back(std::move(attribute));
    if (context.fields)
        for (OutputAttribute& attribute : field_attributes(context)) out.attributes.push_back(std::move(attribute));
    for (const auto& target : primitive.targets) {
        out.targets.emplace_back();
        for (const Attribute& delta : target)
            if (!(delta.name == "TANGENT" && drop_tangents))
                out.targets.back().push_back(interpolated(delta, vertices));
    }
    return out;
}

std::vector<OutputAttribute> field_attributes(const AttributeContext& context) {
    const DecoratedMesh& mesh = *context.mesh;
    const std::vector<OutputVertex>& vertices = context.output->vertices;
    const std::size_t n = vertices.size();
    std::vector<OutputAttribute> out{empty_like("_PVG_COLOR", "VEC4", 4, n), empty_like("_PVG_HEIGHT", "SCALAR", 1, n),
                                     empty_like("_PVG_DIRICHLET", "VEC2", 2, n), empty_like("_PVG_CELL", "VEC2", 2, n),
                                     empty_like("_PVG_BASE", "VEC3", 3, n)};
    const Attribute& raw = *context.primitive->find("POSITION");
    for (const OutputVertex& vertex : vertices) {
        const int v = vertex.vertex;
        const auto add = [&](int which, const float* at) {
            out[which].values.insert(out[which].values.end(), at, at + out[which].components);
        };
        constexpr std::array<float, 4> zero{0, 0, 0, 0};
        constexpr std::array<float, 2> no_cell{-1, -1};
        add(0, v == none ? zero.data() : mesh.field_color[v].data());
        add(1, v == none ? zero.data() : &mesh.field_height[v]);
        add(2, v == none ? zero.data() : mesh.dirichlet[v].data());
        add(3, v == none ? no_cell.data() : mesh.cell[v].data());
        add(4, v == none || (vertex.is_raw() && !mesh.moved[v]) ? raw.at(vertex.raw[0]) : mesh.base[v].data());
    }
    for (const OutputAttribute& attribute : out)
        for (float value : attribute.values)
            if (!std::isfinite(value))
                throw Error(ErrorKind::bad_input, context.place + ": " + attribute.name + " is not finite");
    return out;
}

}  // namespace pvg::gltf
