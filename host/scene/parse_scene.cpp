#include <limits>
#include <map>

#include "scene/assign.h"
#include "scene/json_node.h"
#include "scene/json_text.h"
#include "scene/parse_values.h"
#include "scene/scene.h"
#include "scene/schema.h"

namespace pvg {
namespace {

using nlohmann::json;

DiffusionCurve parse_diffusion_curve(const JsonNode& node) {
    node.check_object({"kind", "path"}, {"left", "right", "both", "id", "enabled"});
    DiffusionCurve curve;
    curve.path = parse_path(node.member("path"), false);
    if (node.has("both")) {
        if (node.has("left") || node.has("right")) {
            node.member("both").fail("expected either \"both\" or \"left\" and \"right\", found both forms");
        }
        curve.left = curve.right = parse_side(node.member("both"));
        return curve;
    }
    if (node.has("left"))
        curve.left = parse_side(node.member("left"));
    if (node.has("right"))
        curve.right = parse_side(node.member("right"));
    if (!node.has("left") && !node.has("right")) {
        node.fail("expected \"left\", \"right\" or \"both\", as a diffusion curve without values does nothing, found none");
    }
    return curve;
}

PoissonCurve parse_poisson_curve(const JsonNode& node) {
    node.check_object({"kind", "path", "jump"}, {"width", "id", "enabled"});
    PoissonCurve curve;
    curve.path = parse_path(node.member("path"), false);
    JumpValues jump = parse_jump(node.member("jump"));
    curve.color_jump = std::move(jump.color);
    curve.height_jump = std::move(jump.height);
    if (node.has("width"))
        curve.width = node.member("width").number({0, 1e30, false, false, "a width"});
    return curve;
}

PoissonRegion parse_poisson_region(const JsonNode& node) {
    node.check_object({"kind", "path"}, {"laplacian", "rise", "ring", "id", "enabled"});
    PoissonRegion region;
    region.path = parse_path(node.member("path"), true);
    if (node.has("rise") == node.has("laplacian")) {
        if (node.has("rise"))
            node.member("rise").fail("expected either \"rise\" or \"laplacian\", found both");
        node.fail("expected \"rise\" or \"laplacian\", found none");
    }
    region.by_rise = node.has("rise");
    const JsonNode value = node.member(region.by_rise ? "rise" : "laplacian");
    value.check_object({}, {"color", "height"});
    if (value.size() == 0)
        value.expected("\"color\" or \"height\"");
    if (value.has("color"))
        region.color = parse_color_difference(value.member("color"));
    // A Laplacian is per squared length: on a small region it is large.
    if (value.has("height"))
        region.height = region.by_rise ? parse_height(value.member("height")) : value.member("height").number();
    if (node.has("ring")) {
        const JsonNode ring = node.member("ring");
        if (ring.value().is_string() && ring.value() == "none")
            region.ring.reset();
        else
            region.ring = ring.number({0, 1, true, true, "\"none\" or a number"});
    }
    return region;
}

Primitive parse_primitive(const JsonNode& node) {
    Primitive primitive;
    primitive.pointer = node.pointer();
    if (!node.value().is_object())
        node.expected("a primitive, an object with \"kind\"");
    if (!node.has("kind"))
        node.fail("expected the key \"kind\", found none");
    const JsonNode kind = node.member("kind");
    for (const char* later : {"stamp", "tile", "scatter"}) {
        if (kind.value() == later)
            kind.fail(
                std::string("\"") + later +
                "\" is not supported by this version; expected \"diffusion_curve\", \"poisson_curve\" or \"poisson_region\"");
    }
    switch (kind.choice({"diffusion_curve", "poisson_curve", "poisson_region"})) {
        case 0:
            primitive.shape = parse_diffusion_curve(node);
            break;
        case 1:
            primitive.shape = parse_poisson_curve(node);
            break;
        default:
            primitive.shape = parse_poisson_region(node);
            break;
    }
    if (node.has("id"))
        primitive.id = node.member("id").text("an id, a string that is not empty");
    if (node.has("enabled"))
        primitive.enabled = node.member("enabled").boolean();
    return primitive;
}

Layer parse_layer(const JsonNode& node) {
    node.check_object({"primitives"}, {"name", "on", "blend"});
    Layer layer;
    layer.pointer = node.pointer();
    if (node.has("name"))
        layer.name = node.member("name").text("a name, a string that is not empty");
    if (node.has("on")) {
        const JsonNode on = node.member("on");
        layer.on_displaced = on.choice({"base", "displaced"}) == 1;
        if (layer.on_displaced)
            on.fail("\"displaced\" is not supported by this version; expected \"base\"");
    }
    if (node.has("blend")) {
        constexpr BlendMode modes[] = {BlendMode::over, BlendMode::multiply, BlendMode::add};
        layer.blend = modes[node.member("blend").choice({"over", "multiply", "add"})];
    }
    const JsonNode primitives = node.member("primitives");
    primitives.check_array("an array of primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) layer.primitives.push_back(parse_primitive(primitives.element(i)));
    return layer;
}

void parse_mesh(const JsonNode& node, Scene& scene) {
    node.check_object({"file"}, {"select", "max_edge", "subdivide"});
    scene.mesh_file = scene.file.parent_path() / node.member("file").text("a file name");
    if (node.has("select")) {
        const JsonNode select = node.member("select");
        if (select.value().is_string()) {
            scene.mesh_select = select.text("a mesh or node name or a mesh index");
        } else {
            if (!select.value().is_number_integer())
                select.expected("a mesh or node name or a mesh index");
            scene.mesh_select = std::to_string(select.integer(0, std::numeric_limits<int>::max()));
        }
    }
    if (node.has("max_edge") && node.has("subdivide")) {
        node.member("subdivide").fail("expected either \"max_edge\" or \"subdivide\", found both");
    }
    if (node.has("max_edge"))
        scene.max_edge = node.member("max_edge").number({0, 1e30, true, false, "a length"});
    if (node.has("subdivide"))
        scene.subdivide = node.member("subdivide").integer(0, 12);
}

void check_unique_ids(const JsonNode& layers, const Scene& scene) {
    std::map<std::string, std::string> seen;
    for (std::size_t l = 0; l < scene.layers.size(); ++l) {
        for (std::size_t p = 0; p < scene.layers[l].primitives.size(); ++p) {
            const Primitive& primitive = scene.layers[l].primitives[p];
            if (primitive.id.empty())
                continue;
            const auto [first, added] = seen.emplace(primitive.id, primitive.pointer);
            if (added)
                continue;
            const JsonNode id = layers.element(l).member("primitives").element(p).member("id");
            id.fail("expected a unique id, found " + describe_json(id.value()) + ", which " + first->second + " has too");
        }
    }
}

Scene parse_document(const JsonNode& root, const std::filesystem::path& file) {
    Scene scene;
    scene.file = file;
    if (!root.value().is_object())
        root.expected("a scene, an object with \"pvg\", \"mesh\" and \"layers\"");
    // A file of another version may differ in everything else.
    if (!root.has("pvg"))
        root.fail("expected the key \"pvg\" with the format's version 1, found none");
    const JsonNode version = root.member("pvg");
    if (!version.value().is_number_integer() || version.value() != 1)
        version.expected("1, the format's version");
    root.check_object({"pvg", "mesh", "layers"}, {"$schema", "length_unit", "color_space", "knots", "basis"});
    if (root.has("$schema"))
        root.member("$schema").text("the address of a schema");

    parse_mesh(root.member("mesh"), scene);
    if (root.has("length_unit"))
        scene.unit_is_bbox = root.member("length_unit").choice({"bbox", "mesh"}) == 0;
    if (root.has("color_space")) {
        constexpr ColorSpace spaces[] = {ColorSpace::linear, ColorSpace::srgb, ColorSpace::oklab};
        scene.color_space = spaces[root.member("color_space").choice({"linear", "srgb", "oklab"})];
    }
    if (root.has("knots")) {
        const JsonNode knots = root.member("knots");
        knots.check_object({}, {"spacing", "grading"});
        if (knots.has("spacing"))
            scene.knot_spacing = knots.member("spacing").number({0, 1e30, true, false, "a length"});
        if (knots.has("grading"))
            scene.knot_grading = knots.member("grading").number({0, 1e30, true, false, "a number"});
    }
    if (root.has("basis")) {
        const JsonNode basis = root.member("basis");
        basis.check_object({}, {"kind", "rings", "normalize"});
        constexpr BasisKind kinds[] = {BasisKind::local, BasisKind::green, BasisKind::exact};
        if (basis.has("kind"))
            scene.basis = kinds[basis.member("kind").choice({"local", "green", "exact"})];
        if (basis.has("rings"))
            scene.basis_rings = basis.member("rings").integer(1, 16);
        if (basis.has("normalize"))
            scene.basis_normalize = basis.member("normalize").boolean();
    }

    const JsonNode layers = root.member("layers");
    if (!layers.value().is_array() || layers.size() == 0)
        layers.expected("an array of layers, at least one");
    for (std::size_t i = 0; i < layers.size(); ++i) scene.layers.push_back(parse_layer(layers.element(i)));
    check_unique_ids(layers, scene);
    return scene;
}

}  // namespace

std::string Primitive::name() const { return id.empty() ? pointer : '"' + id + '"'; }

Scene parse_scene(const json& document, const std::filesystem::path& file, const std::vector<std::string>& assignments) {
    json edited = document;
    for (const std::string& assignment : assignments) apply_assignment(edited, assignment, file.string());
    const std::string name = file.string();
    Scene scene = parse_document(JsonNode(edited, name), file);
    // The checks above are the stricter ones and word their messages for people; the published schema must not disagree with
    // them.
    if (const auto violation = schema_violation(edited))
        throw Error(ErrorKind::bad_input, name + ": " + *violation);
    scene.document = std::move(edited);
    return scene;
}

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& assignments) {
    return parse_scene(parse_json_text(read_text_file(file), file.string()), file, assignments);
}

}  // namespace pvg
