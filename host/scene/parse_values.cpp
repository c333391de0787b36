#include "scene/parse_values.h"

#include <cmath>

#include "scene/color.h"

namespace pvg {
namespace {

/// Linear intensities far beyond white are more likely 0-255 numbers than light.
constexpr NumberRange intensity{-100, 100, false, false, "a linear intensity (1 is full)"};
constexpr NumberRange opacity{0, 1, false, false, "an opacity"};
constexpr NumberRange difference{-1e9, 1e9, false, false, "a number"};
constexpr NumberRange curve_position{0, 1, false, false, "a number"};
constexpr const char* color_forms = "\"#rrggbb\" or [r,g,b]";

int hex_digit(char c) {
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    return -1;
}

Color color_from_text(const JsonNode& node) {
    const auto& text = node.value().get_ref<const std::string&>();
    if ((text.size() != 7 && text.size() != 9) || text[0] != '#')
        node.expected(color_forms);
    Color color(0, 0, 0, 1);
    for (std::size_t c = 0; 2 * c + 1 < text.size(); ++c) {
        const int high = hex_digit(text[2 * c + 1]);
        const int low = hex_digit(text[2 * c + 2]);
        if (high < 0 || low < 0)
            node.expected(color_forms);
        const double coded = (16 * high + low) / 255.0;
        color[static_cast<Eigen::Index>(c)] = c < 3 ? linear_from_srgb(coded) : coded;
    }
    return color;
}

/// Calls add(t, node) for the only value (t = 0) or for each stop of a list, whose t must ascend.
template <typename Add>
void for_each_stop(const JsonNode& node, const char* what, Add add) {
    if (node.value().is_object()) {
        node.check_object({}, {"color", "height"});
        if (node.size() == 0)
            node.expected("\"color\" or \"height\"");
        add(0.0, node);
        return;
    }
    if (!node.value().is_array() || node.size() == 0)
        node.expected(what);
    double before = -1;
    for (std::size_t i = 0; i < node.size(); ++i) {
        const JsonNode stop = node.element(i);
        stop.check_object({"t"}, {"color", "height"});
        const double t = stop.member("t").number(curve_position);
        if (t <= before)
            stop.member("t").expected("ascending t, more than " + nlohmann::json(before).dump());
        if (stop.size() == 1)
            stop.fail("expected \"color\" or \"height\" at the stop, found only \"t\"");
        add(t, stop);
        before = t;
    }
}

constexpr const char* stop_forms = "{\"color\", \"height\"} or a list of stops [{\"t\", \"color\", \"height\"}, ...]";

}  // namespace

Color parse_color(const JsonNode& node) {
    if (node.value().is_string())
        return color_from_text(node);
    if (!node.value().is_array() || (node.size() != 3 && node.size() != 4))
        node.expected(color_forms);
    Color color(0, 0, 0, 1);
    for (std::size_t c = 0; c < node.size(); ++c) {
        color[static_cast<Eigen::Index>(c)] = node.element(c).number(c < 3 ? intensity : opacity);
    }
    return color;
}

Eigen::Vector4d parse_color_difference(const JsonNode& node) {
    if (!node.value().is_array() || node.size() != 3)
        node.expected("[r,g,b], differences in the space of diffusion");
    Eigen::Vector4d color = Eigen::Vector4d::Zero();
    for (std::size_t c = 0; c < 3; ++c) color[static_cast<Eigen::Index>(c)] = node.element(c).number(difference);
    return color;
}

double parse_height(const JsonNode& node) { return node.number(difference); }

SideValues parse_side(const JsonNode& node) {
    SideValues side;
    for_each_stop(node, stop_forms, [&](double t, const JsonNode& stop) {
        if (stop.has("color")) {
            side.color.t.push_back(t);
            side.color.value.push_back(parse_color(stop.member("color")));
        }
        if (stop.has("height")) {
            side.height.t.push_back(t);
            side.height.value.push_back(parse_height(stop.member("height")));
        }
    });
    return side;
}

JumpValues parse_jump(const JsonNode& node) {
    JumpValues jump;
    for_each_stop(node, stop_forms, [&](double t, const JsonNode& stop) {
        if (stop.has("color")) {
            jump.color.t.push_back(t);
            jump.color.value.push_back(parse_color_difference(stop.member("color")));
        }
        if (stop.has("height")) {
            jump.height.t.push_back(t);
            jump.height.value.push_back(parse_height(stop.member("height")));
        }
    });
    return jump;
}

ScenePoint parse_point(const JsonNode& node) {
    ScenePoint point;
    point.pointer = node.pointer();
    if (node.value().is_array()) {
        if (node.size() != 3)
            node.expected("a surface point [x,y,z]");
        for (std::size_t c = 0; c < 3; ++c) point.position[static_cast<Eigen::Index>(c)] = node.element(c).number();
        return point;
    }
    if (!node.value().is_object())
        node.expected("a surface point [x,y,z] or {\"face\", \"bary\"}");
    node.check_object({"face", "bary"}, {});
    point.on_face = true;
    point.face = node.member("face").integer(0, std::numeric_limits<int>::max());
    const JsonNode bary = node.member("bary");
    if (!bary.value().is_array() || bary.size() != 3)
        bary.expected("three barycentric coordinates");
    for (std::size_t c = 0; c < 3; ++c) {
        point.bary[static_cast<Eigen::Index>(c)] = bary.element(c).number({0, 1e30, false, false, "a barycentric coordinate"});
    }
    // Written with six digits or in single precision a sum is off by some 1e-6.
    if (std::abs(point.bary.sum() - 1) > 1e-5)
        bary.expected("barycentric coordinates whose sum is 1");
    point.bary /= point.bary.sum();
    return point;
}

ScenePath parse_path(const JsonNode& node, bool must_close) {
    ScenePath path;
    path.pointer = node.pointer();
    if (!node.value().is_object())
        node.expected("a path {\"type\", \"points\"}");
    if (!node.has("type"))
        node.fail("expected the key \"type\", found none");
    constexpr PathKind kinds[] = {PathKind::polyline, PathKind::bspline, PathKind::bezier, PathKind::circle};
    path.kind = kinds[node.member("type").choice({"polyline", "bspline", "bezier", "circle"})];
    const bool circle = path.kind == PathKind::circle;
    if (circle)
        node.check_object({"type", "center", "radius"}, {"start", "closed", "parameter", "snap"});
    else
        node.check_object({"type", "points"}, {"closed", "degree", "parameter", "snap"});
    if (node.has("parameter"))
        path.parameter_curve = node.member("parameter").choice({"arc", "curve"}) == 1;
    if (node.has("snap"))
        path.snap_any = node.member("snap").choice({"near", "any"}) == 1;

    if (circle) {
        path.closed = true;
        if (node.has("closed") && !node.member("closed").boolean())
            node.member("closed").expected("true, as a circle is closed");
        path.center = parse_point(node.member("center"));
        path.radius = node.member("radius").number({0, 1e30, true, false, "a radius"});
        if (node.has("start"))
            path.start = parse_point(node.member("start"));
        return path;
    }

    if (node.has("closed"))
        path.closed = node.member("closed").boolean();
    if (must_close && !path.closed) {
        if (node.has("closed"))
            node.member("closed").expected("true, as a region's path is closed");
        node.fail("expected \"closed\": true, as a region's path is closed");
    }
    if (node.has("degree"))
        path.degree = node.member("degree").integer(1, 8);
    const JsonNode points = node.member("points");
    points.check_array("an array of surface points");
    for (std::size_t i = 0; i < points.size(); ++i) path.points.push_back(parse_point(points.element(i)));

    const int count = static_cast<int>(path.points.size());
    const int degree = path.degree;
    const auto found = [&](const std::string& what) { points.fail("expected " + what + ", found " + std::to_string(count)); };
    const std::string shape = path.closed ? "closed " : "open ";
    const int least = path.closed ? 3 : 2;
    if (path.kind == PathKind::bezier) {
        const int chain = path.closed ? count : count - 1;
        if (chain < degree || chain % degree != 0) {
            const std::string rule = path.closed ? "n * " + std::to_string(degree) : "n * " + std::to_string(degree) + " + 1";
            found(rule + " points (" + shape + "bezier chain of n segments of degree " + std::to_string(degree) + ")");
        }
    }
    if (path.kind == PathKind::bspline && count < degree + 1) {
        found("at least " + std::to_string(degree + 1) + " points (" + shape + "bspline of degree " + std::to_string(degree) +
              ")");
    }
    if (count < least)
        found("at least " + std::to_string(least) + " points (" + shape + "path)");
    return path;
}

}  // namespace pvg
