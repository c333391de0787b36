// Bad scenes: each by its whole message, and whether the published schema refuses it too. Where it does not, the
// fault is one that JSON Schema cannot see, and the case says so.
#include <filesystem>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "scene/json_text.h"
#include "scene/scene.h"
#include "scene/schema.h"

namespace pvg {
namespace {

using nlohmann::json;

enum class Schema { refuses, cannot_see };

struct BadScene {
    const char* patch;    ///< JSON Patch (RFC 6902) of the good scene below
    const char* message;  ///< after "bad.pvg.json: "
    Schema schema = Schema::refuses;
};

const char* good = R"({
  "pvg": 1,
  "mesh": {"file": "m.glb"},
  "layers": [{"name": "logo", "primitives": [
    {"kind": "diffusion_curve", "id": "dc", "path": {"type": "polyline", "points": [[0, 0, 0], [1, 0, 0], [1, 1, 0]]},
     "left": {"color": "#ff0000", "height": 0}, "right": [{"t": 0, "height": 1}, {"t": 0.5, "height": 2}]},
    {"kind": "poisson_curve", "id": "pc", "path": {"type": "bspline", "points": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]}, "jump": {"height": 1}},
    {"kind": "poisson_region", "id": "pr", "path": {"type": "circle", "center": [0, 0, 0], "radius": 0.1}, "rise": {"height": 1}},
    {"kind": "poisson_region", "id": "pb", "path": {"type": "bezier", "closed": true, "points": [[0, 0, 0], [1, 0, 0], [1, 1, 0]]}, "laplacian": {"height": 1}}
  ]}]
})";

const BadScene bad_scenes[] = {
    // The document
    {R"([{"op": "replace", "path": "", "value": []}])",
     R"(expected a scene, an object with "pvg", "mesh" and "layers", found [])"},
    {R"([{"op": "remove", "path": "/pvg"}])", R"(expected the key "pvg" with the format's version 1, found none)"},
    {R"([{"op": "replace", "path": "/pvg", "value": 2}])", R"(/pvg: expected 1, the format's version, found 2)"},
    {R"([{"op": "replace", "path": "/pvg", "value": "1"}])", R"(/pvg: expected 1, the format's version, found "1")"},
    {R"([{"op": "add", "path": "/layer", "value": []}])", R"(/layer: unknown key, did you mean "layers"?)"},
    {R"([{"op": "add", "path": "/a~1b~0c", "value": []}])",
     R"(/a~1b~0c: unknown key; the keys here are "pvg", "mesh", "layers", "$schema", "length_unit", "color_space", "knots" or "basis")"},
    {R"([{"op": "remove", "path": "/mesh"}])", R"(expected the key "mesh", found none)"},
    {R"([{"op": "remove", "path": "/layers"}])", R"(expected the key "layers", found none)"},
    {R"([{"op": "replace", "path": "/layers", "value": []}])", R"(/layers: expected an array of layers, at least one, found [])"},
    {R"([{"op": "add", "path": "/length_unit", "value": "metre"}])", R"(/length_unit: expected "bbox" or "mesh", found "metre")"},
    {R"([{"op": "add", "path": "/color_space", "value": "rgb"}])",
     R"(/color_space: expected "linear", "srgb" or "oklab", found "rgb")"},
    {R"([{"op": "add", "path": "/knots", "value": {"spacing": 0}}])", R"(/knots/spacing: expected a length > 0, found 0)"},
    {R"([{"op": "add", "path": "/knots", "value": {"grading": -1}}])", R"(/knots/grading: expected a number > 0, found -1)"},
    {R"([{"op": "add", "path": "/knots", "value": {"spaceing": 1}}])",
     R"(/knots/spaceing: unknown key, did you mean "spacing"?)"},
    {R"([{"op": "add", "path": "/knots", "value": 3}])", R"(/knots: expected an object, found 3)"},
    {R"([{"op": "add", "path": "/basis", "value": {"kind": "fem"}}])",
     R"(/basis/kind: expected "local", "green" or "exact", found "fem")"},
    {R"([{"op": "add", "path": "/basis", "value": {"rings": 0}}])",
     R"(/basis/rings: expected a whole number from 1 to 16, found 0)"},
    {R"([{"op": "add", "path": "/basis", "value": {"rings": 1.5}}])",
     R"(/basis/rings: expected a whole number from 1 to 16, found 1.5)"},
    {R"([{"op": "add", "path": "/basis", "value": {"normalize": "yes"}}])",
     R"(/basis/normalize: expected true or false, found "yes")"},
    {R"([{"op": "add", "path": "/basis", "value": {"normalise": true}}])",
     R"(/basis/normalise: unknown key, did you mean "normalize"?)"},
    // The mesh
    {R"([{"op": "replace", "path": "/mesh", "value": "m.glb"}])", R"(/mesh: expected an object, found "m.glb")"},
    {R"([{"op": "remove", "path": "/mesh/file"}])", R"(/mesh: expected the key "file", found none)"},
    {R"([{"op": "replace", "path": "/mesh/file", "value": ""}])", R"(/mesh/file: expected a file name, found "")"},
    {R"([{"op": "replace", "path": "/mesh/file", "value": "a\u0000b"}])",
     R"(/mesh/file: expected a file name without a NUL character, found "a\u0000b")", Schema::cannot_see},
    {R"([{"op": "add", "path": "/mesh/select", "value": -1}])", R"(/mesh/select: expected a whole number >= 0, found -1)"},
    {R"([{"op": "add", "path": "/mesh/select", "value": true}])",
     R"(/mesh/select: expected a mesh or node name or a mesh index, found true)"},
    {R"([{"op": "add", "path": "/mesh/max_edge", "value": 0}])", R"(/mesh/max_edge: expected a length > 0, found 0)"},
    {R"([{"op": "add", "path": "/mesh/subdivide", "value": 13}])",
     R"(/mesh/subdivide: expected a whole number from 0 to 12, found 13)"},
    {R"([{"op": "add", "path": "/mesh/subdivide", "value": 1}, {"op": "add", "path": "/mesh/max_edge", "value": 1}])",
     R"(/mesh/subdivide: expected either "max_edge" or "subdivide", found both)"},
    // Layers
    {R"([{"op": "remove", "path": "/layers/0/primitives"}])", R"(/layers/0: expected the key "primitives", found none)"},
    {R"([{"op": "add", "path": "/layers/0/blend", "value": "screen"}])",
     R"(/layers/0/blend: expected "over", "multiply" or "add", found "screen")"},
    {R"([{"op": "add", "path": "/layers/0/on", "value": "displaced"}])",
     R"(/layers/0/on: "displaced" is not supported by this version; expected "base")"},
    {R"([{"op": "add", "path": "/layers/0/on", "value": "top"}])",
     R"(/layers/0/on: expected "base" or "displaced", found "top")"},
    // Primitives
    {R"([{"op": "replace", "path": "/layers/0/primitives/1", "value": 5}])",
     R"(/layers/0/primitives/1: expected a primitive, an object with "kind", found 5)"},
    {R"([{"op": "remove", "path": "/layers/0/primitives/1/kind"}])",
     R"(/layers/0/primitives/1: expected the key "kind", found none)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/1/kind", "value": "stamp"}])",
     R"(/layers/0/primitives/1/kind: "stamp" is not supported by this version; expected "diffusion_curve", "poisson_curve" or "poisson_region")"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/1/kind", "value": "tile"}])",
     R"(/layers/0/primitives/1/kind: "tile" is not supported by this version; expected "diffusion_curve", "poisson_curve" or "poisson_region")"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/1/kind", "value": "scatter"}])",
     R"(/layers/0/primitives/1/kind: "scatter" is not supported by this version; expected "diffusion_curve", "poisson_curve" or "poisson_region")"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/1/kind", "value": "curve"}])",
     R"(/layers/0/primitives/1/kind: expected "diffusion_curve", "poisson_curve" or "poisson_region", found "curve")"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/1/id", "value": "dc"}])",
     R"(/layers/0/primitives/1/id: expected a unique id, found "dc", which /layers/0/primitives/0 has too)", Schema::cannot_see},
    {R"([{"op": "replace", "path": "/layers/0/primitives/1/id", "value": ""}])",
     R"(/layers/0/primitives/1/id: expected an id, a string that is not empty, found "")"},
    {R"([{"op": "add", "path": "/layers/0/primitives/1/enabled", "value": 1}])",
     R"(/layers/0/primitives/1/enabled: expected true or false, found 1)"},
    // Diffusion curves
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/left/color", "value": "redd"}])",
     R"(/layers/0/primitives/0/left/color: expected "#rrggbb" or [r,g,b], found "redd")"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/left/color", "value": "#ff00f"}])",
     R"(/layers/0/primitives/0/left/color: expected "#rrggbb" or [r,g,b], found "#ff00f")"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/left/color", "value": "#ff00fg"}])",
     R"(/layers/0/primitives/0/left/color: expected "#rrggbb" or [r,g,b], found "#ff00fg")"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/left/color", "value": [1, 2]}])",
     R"(/layers/0/primitives/0/left/color: expected "#rrggbb" or [r,g,b], found [1,2])"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/left/color", "value": [255, 128, 0]}])",
     R"(/layers/0/primitives/0/left/color/0: expected a linear intensity (1 is full) >= -100 and <= 100, found 255)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/left/color", "value": [1, 1, 1, 2]}])",
     R"(/layers/0/primitives/0/left/color/3: expected an opacity >= 0 and <= 1, found 2)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/left/height", "value": "high"}])",
     R"(/layers/0/primitives/0/left/height: expected a number >= -1e+09 and <= 1e+09, found "high")"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/left/height", "value": 1e10}])",
     R"(/layers/0/primitives/0/left/height: expected a number >= -1e+09 and <= 1e+09, found 10000000000.0)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/left", "value": {}}])",
     R"(/layers/0/primitives/0/left: expected "color" or "height", found {})"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/left", "value": []}])",
     R"(/layers/0/primitives/0/left: expected {"color", "height"} or a list of stops [{"t", "color", "height"}, ...], found [])"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/left", "value": "#ff0000"}])",
     R"(/layers/0/primitives/0/left: expected {"color", "height"} or a list of stops [{"t", "color", "height"}, ...], found "#ff0000")"},
    {R"([{"op": "add", "path": "/layers/0/primitives/0/left/colour", "value": "#ff0000"}])",
     R"(/layers/0/primitives/0/left/colour: unknown key, did you mean "color"?)"},
    {R"([{"op": "add", "path": "/layers/0/primitives/0/both", "value": {"height": 1}}])",
     R"(/layers/0/primitives/0/both: expected either "both" or "left" and "right", found both forms)"},
    {R"([{"op": "remove", "path": "/layers/0/primitives/0/left"}, {"op": "remove", "path": "/layers/0/primitives/0/right"}])",
     R"(/layers/0/primitives/0: expected "left", "right" or "both", as a diffusion curve without values does nothing, found none)"},
    {R"([{"op": "add", "path": "/layers/0/primitives/0/lfet", "value": {}}])",
     R"(/layers/0/primitives/0/lfet: unknown key, did you mean "left"?)"},
    {R"([{"op": "remove", "path": "/layers/0/primitives/0/path"}])",
     R"(/layers/0/primitives/0: expected the key "path", found none)"},
    // Stops
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/right/1/t", "value": 1.5}])",
     R"(/layers/0/primitives/0/right/1/t: expected a number >= 0 and <= 1, found 1.5)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/right/0/t", "value": 0.75}])",
     R"(/layers/0/primitives/0/right/1/t: expected ascending t, more than 0.75, found 0.5)", Schema::cannot_see},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/right/0/t", "value": 0.5}])",
     R"(/layers/0/primitives/0/right/1/t: expected ascending t, more than 0.5, found 0.5)", Schema::cannot_see},
    {R"([{"op": "remove", "path": "/layers/0/primitives/0/right/1/t"}])",
     R"(/layers/0/primitives/0/right/1: expected the key "t", found none)"},
    {R"([{"op": "remove", "path": "/layers/0/primitives/0/right/1/height"}])",
     R"(/layers/0/primitives/0/right/1: expected "color" or "height" at the stop, found only "t")"},
    // Points
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points/1", "value": [0, 0]}])",
     R"(/layers/0/primitives/0/path/points/1: expected a surface point [x,y,z], found [0,0])"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points/1", "value": "origin"}])",
     R"(/layers/0/primitives/0/path/points/1: expected a surface point [x,y,z] or {"face", "bary"}, found "origin")"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points/1/0", "value": null}])",
     R"(/layers/0/primitives/0/path/points/1/0: expected a number, found null)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points/1/0", "value": 1e300}])",
     R"(/layers/0/primitives/0/path/points/1/0: expected a number between -1e30 and 1e30, found 1e+300)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points/1", "value": {"face": -1, "bary": [1, 0, 0]}}])",
     R"(/layers/0/primitives/0/path/points/1/face: expected a whole number >= 0, found -1)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points/1", "value": {"face": 99999999999, "bary": [1, 0, 0]}}])",
     R"(/layers/0/primitives/0/path/points/1/face: expected a whole number >= 0, found 99999999999)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points/1", "value": {"face": 1}}])",
     R"(/layers/0/primitives/0/path/points/1: expected the key "bary", found none)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points/1", "value": {"face": 1, "bary": [1, 1]}}])",
     R"(/layers/0/primitives/0/path/points/1/bary: expected three barycentric coordinates, found [1,1])"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points/1", "value": {"face": 1, "bary": [1.5, -0.5, 0]}}])",
     R"(/layers/0/primitives/0/path/points/1/bary/1: expected a barycentric coordinate >= 0, found -0.5)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points/1", "value": {"face": 1, "bary": [0.5, 0.25, 0]}}])",
     R"(/layers/0/primitives/0/path/points/1/bary: expected barycentric coordinates whose sum is 1, found [0.5,0.25,0])",
     Schema::cannot_see},
    // Paths
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path", "value": []}])",
     R"(/layers/0/primitives/0/path: expected a path {"type", "points"}, found [])"},
    {R"([{"op": "remove", "path": "/layers/0/primitives/0/path/type"}])",
     R"(/layers/0/primitives/0/path: expected the key "type", found none)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/type", "value": "spline"}])",
     R"(/layers/0/primitives/0/path/type: expected "polyline", "bspline", "bezier" or "circle", found "spline")"},
    {R"([{"op": "add", "path": "/layers/0/primitives/0/path/radius", "value": 1}])",
     R"(/layers/0/primitives/0/path/radius: unknown key; the keys here are "type", "points", "closed", "degree", "parameter" or "snap")"},
    {R"([{"op": "add", "path": "/layers/0/primitives/0/path/degree", "value": 9}])",
     R"(/layers/0/primitives/0/path/degree: expected a whole number from 1 to 8, found 9)"},
    {R"([{"op": "add", "path": "/layers/0/primitives/0/path/parameter", "value": "time"}])",
     R"(/layers/0/primitives/0/path/parameter: expected "arc" or "curve", found "time")"},
    {R"([{"op": "add", "path": "/layers/0/primitives/0/path/snap", "value": "far"}])",
     R"(/layers/0/primitives/0/path/snap: expected "near" or "any", found "far")"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points", "value": [[0, 0, 0]]}])",
     R"(/layers/0/primitives/0/path/points: expected at least 2 points (open path), found 1)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/points", "value": {}}])",
     R"(/layers/0/primitives/0/path/points: expected an array of surface points, found {})"},
    {R"([{"op": "add", "path": "/layers/0/primitives/0/path/closed", "value": true}, {"op": "remove", "path": "/layers/0/primitives/0/path/points/2"}])",
     R"(/layers/0/primitives/0/path/points: expected at least 3 points (closed path), found 2)", Schema::cannot_see},
    {R"([{"op": "replace", "path": "/layers/0/primitives/0/path/type", "value": "bezier"}])",
     R"(/layers/0/primitives/0/path/points: expected n * 3 + 1 points (open bezier chain of n segments of degree 3), found 3)",
     Schema::cannot_see},
    {R"([{"op": "add", "path": "/layers/0/primitives/3/path/points/1", "value": [0, 0, 0]}])",
     R"(/layers/0/primitives/3/path/points: expected n * 3 points (closed bezier chain of n segments of degree 3), found 4)",
     Schema::cannot_see},
    {R"([{"op": "add", "path": "/layers/0/primitives/1/path/degree", "value": 4}])",
     R"(/layers/0/primitives/1/path/points: expected at least 5 points (open bspline of degree 4), found 4)", Schema::cannot_see},
    {R"([{"op": "replace", "path": "/layers/0/primitives/2/path/radius", "value": 0}])",
     R"(/layers/0/primitives/2/path/radius: expected a radius > 0, found 0)"},
    {R"([{"op": "remove", "path": "/layers/0/primitives/2/path/center"}])",
     R"(/layers/0/primitives/2/path: expected the key "center", found none)"},
    {R"([{"op": "add", "path": "/layers/0/primitives/2/path/closed", "value": false}])",
     R"(/layers/0/primitives/2/path/closed: expected true, as a circle is closed, found false)"},
    // Poisson curves and regions
    {R"([{"op": "remove", "path": "/layers/0/primitives/1/jump"}])",
     R"(/layers/0/primitives/1: expected the key "jump", found none)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/1/jump", "value": {"color": "#ff0000"}}])",
     R"(/layers/0/primitives/1/jump/color: expected [r,g,b], differences in the space of diffusion, found "#ff0000")"},
    {R"([{"op": "add", "path": "/layers/0/primitives/1/width", "value": -1}])",
     R"(/layers/0/primitives/1/width: expected a width >= 0, found -1)"},
    {R"([{"op": "add", "path": "/layers/0/primitives/2/laplacian", "value": {"height": 1}}])",
     R"(/layers/0/primitives/2/rise: expected either "rise" or "laplacian", found both)"},
    {R"([{"op": "remove", "path": "/layers/0/primitives/2/rise"}])",
     R"(/layers/0/primitives/2: expected "rise" or "laplacian", found none)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/2/rise", "value": {}}])",
     R"(/layers/0/primitives/2/rise: expected "color" or "height", found {})"},
    {R"([{"op": "add", "path": "/layers/0/primitives/2/ring", "value": 0}])",
     R"(/layers/0/primitives/2/ring: expected "none" or a number > 0 and < 1, found 0)"},
    {R"([{"op": "add", "path": "/layers/0/primitives/2/ring", "value": 1}])",
     R"(/layers/0/primitives/2/ring: expected "none" or a number > 0 and < 1, found 1)"},
    {R"([{"op": "add", "path": "/layers/0/primitives/2/ring", "value": "nun"}])",
     R"(/layers/0/primitives/2/ring: expected "none" or a number > 0 and < 1, found "nun")"},
    {R"([{"op": "remove", "path": "/layers/0/primitives/3/path/closed"}])",
     R"(/layers/0/primitives/3/path: expected "closed": true, as a region's path is closed)"},
    {R"([{"op": "replace", "path": "/layers/0/primitives/3/path/closed", "value": false}])",
     R"(/layers/0/primitives/3/path/closed: expected true, as a region's path is closed, found false)"},
};

TEST(BadScenes, TheGoodOneIsGood) {
    const json document = json::parse(good);
    EXPECT_EQ(parse_scene(document, "good.pvg.json").layers[0].primitives.size(), 4u);
    EXPECT_EQ(schema_violation(document), std::nullopt);
}

TEST(BadScenes, FailWithTheirMessageAndAgainstTheSchema) {
    for (const BadScene& bad : bad_scenes) {
        const json document = json::parse(good).patch(json::parse(bad.patch));
        try {
            parse_scene(document, "bad.pvg.json");
            ADD_FAILURE() << bad.patch << " passed";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input) << bad.patch;
            EXPECT_EQ(error.what(), std::string("bad.pvg.json: ") + bad.message);
        }
        EXPECT_EQ(schema_violation(document).has_value(), bad.schema == Schema::refuses) << bad.patch;
    }
}

TEST(BadScenes, NumbersOfAnEmbeddedSceneMayNotBeInfinite) {
    for (const auto& [value, name] :
         {std::pair{std::numeric_limits<double>::quiet_NaN(), "NaN"}, {std::numeric_limits<double>::infinity(), "infinity"}}) {
        json document = json::parse(good);
        document["layers"][0]["primitives"][2]["path"]["radius"] = value;
        try {
            parse_scene(document, "bad.pvg.json");
            ADD_FAILURE() << name;
        } catch (const Error& error) {
            EXPECT_EQ(error.what(),
                      std::string("bad.pvg.json: /layers/0/primitives/2/path/radius: expected a radius > 0, found ") + name);
        }
    }
}

TEST(BadScenes, LongKeysAndValuesAreCutShort) {
    json document = json::parse(good);
    document[std::string(100000, 'k')] = 1;
    document["layers"][0]["primitives"][0]["left"]["color"] = std::string(100000, 'x');
    try {
        parse_scene(document, "bad.pvg.json");
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_LT(std::string(error.what()).size(), 400u);
    }
    document.erase(std::string(100000, 'k'));
    try {
        parse_scene(document, "bad.pvg.json");
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_LT(std::string(error.what()).size(), 400u);
    }
}

TEST(BadText, FailsWithLineAndColumn) {
    const std::pair<std::string, std::string> cases[] = {
        {"", "b: line 1, column 1: syntax error while parsing value - unexpected end of input"},
        {"{\"pvg\": 1,\n \"mesh\": tru}", "b: line 2, column 13: syntax error while parsing value - invalid literal"},
        {"{\"pvg\": 1, // comment\n}", "b: line 1, column 12: syntax error while parsing object key - invalid literal"},
        {"{\"pvg\": 1,\n\n  \"pvg\": 1}", "b: line 3, column 7: the key \"pvg\" appears twice in one object"},
        {"{\"pvg\": NaN}", "b: line 1, column 9: syntax error while parsing value - invalid literal"},
        {"{\"pvg\": 1,\n \"\xC3\xA9\": 1e999}", "b: line 2, column 11: number overflow parsing '1e999'"},
        {"{\"pvg\": \"\xFF\"}", "b: line 1, column 10: syntax error while parsing value - invalid string: ill-formed UTF-8 byte"},
        {"{} {}", "b: line 1, column 4: syntax error while parsing value - unexpected '{'; expected end of input"},
        {std::string(256, '[') + std::string(256, ']'), ""},
        {std::string(257, '[') + std::string(257, ']'), "b: line 1, column 257: objects and arrays nest deeper than 256"},
        {std::string(1000000, '['), "b: line 1, column 257: objects and arrays nest deeper than 256"},
    };
    for (const auto& [text, message] : cases) {
        try {
            parse_json_text(text, "b");
            EXPECT_EQ(message, "") << text.substr(0, 50);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input);
            EXPECT_EQ(std::string(error.what()).substr(0, message.size()), message);
            EXPECT_FALSE(message.empty()) << error.what();
        }
    }
}

TEST(BadText, AMissingFileOrAFolderIsNamed) {
    for (const std::string file : {"/nowhere/no.pvg.json", "/"}) {
        try {
            read_scene(file);
            ADD_FAILURE() << file;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input);
            EXPECT_EQ(std::string(error.what()).rfind(file + ": ", 0), 0u) << error.what();
        }
    }
}

}  // namespace
}  // namespace pvg
