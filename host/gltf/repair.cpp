#include "gltf/repair.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "gltf/accessor.h"
#include "gltf/influences.h"

namespace pvg::gltf {
namespace {

/// Accessors that must have bounds.
std::vector<char> bounded_accessors(const Document& document) {
    std::vector<char> bounded(document.model.accessors.size(), 0);
    const auto mark = [&](const tinygltf::Primitive& primitive, auto&& attributes) {
        (void)primitive;
        if (const auto position = attributes.find("POSITION"); position != attributes.end())
            bounded[static_cast<std::size_t>(position->second)] = 1;
    };
    for (const tinygltf::Mesh& mesh : document.model.meshes)
        for (const tinygltf::Primitive& primitive : mesh.primitives) {
            mark(primitive, primitive.attributes);
            for (const auto& target : primitive.targets) mark(primitive, target);
        }
    if (document.json.contains("animations"))
        for (const Json& animation : document.json["animations"])
            if (animation.contains("samplers") && animation["samplers"].is_array())
                for (const Json& sampler : animation["samplers"])
                    if (sampler.is_object() && sampler.contains("input") && sampler["input"].is_number_unsigned() &&
                        sampler["input"].get<std::size_t>() < bounded.size())
                        bounded[sampler["input"].get<std::size_t>()] = 1;
    return bounded;
}

bool readable(const Document& document, std::size_t index) {
    const tinygltf::Accessor& accessor = document.model.accessors[index];
    const auto has_data = [&](int view) { return document.has_data[document.model.bufferViews[view].buffer] != 0; };
    if (element_components(document.json["accessors"][index]["type"].get<std::string>()) == 0 ||
        accessor.count > 3 * most_elements)
        return false;
    if (accessor.bufferView >= 0 && !has_data(accessor.bufferView))
        return false;
    if (accessor.bufferView < 0 && accessor.count > most_zeros)
        return false;
    return !accessor.sparse.isSparse ||
           (has_data(accessor.sparse.indices.bufferView) && has_data(accessor.sparse.values.bufferView));
}

bool same_bounds(const Json& accessor, const char* key, const std::vector<double>& right, bool is_float) {
    if (!accessor.contains(key))
        return false;
    for (std::size_t c = 0; c < right.size(); ++c) {
        const double value = accessor[key][c].get<double>();
        if ((is_float ? static_cast<double>(static_cast<float>(value)) : value) != right[c])
            return false;
    }
    return true;
}

}  // namespace

void repair_bounds(const Document& document, Json& json, Warnings& warnings) {
    const std::vector<char> bounded = bounded_accessors(document);
    std::size_t repaired = 0;
    std::string first;
    // Accessors may share their bytes, so a small file can ask for any amount of reading: past this much, what is left stays as
    // it is.
    constexpr std::size_t most_read = 300'000'000;
    std::size_t read = 0;
    for (std::size_t a = 0; a < bounded.size() && read < most_read; ++a) {
        const Json& given = document.json["accessors"][a];
        const bool has_both = given.contains("min") && given.contains("max");
        if (has_both && document.model.accessors[a].bufferView < 0 && !document.model.accessors[a].sparse.isSparse)
            continue;  // no data to disagree with
        if ((!given.contains("min") && !given.contains("max") && !bounded[a]) || !readable(document, a))
            continue;
        const std::vector<double> numbers = read_numbers(document, a);
        read += numbers.size();
        const std::size_t components = element_components(given["type"].get<std::string>());
        std::vector<double> least(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(components)), most = least;
        bool finite = true;
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            finite = finite && std::isfinite(numbers[i]);
            least[i % components] = std::min(least[i % components], numbers[i]);
            most[i % components] = std::max(most[i % components], numbers[i]);
        }
        if (!finite)
            continue;
        const bool is_float = document.model.accessors[a].componentType == TINYGLTF_COMPONENT_TYPE_FLOAT;
        for (const bool upper : {false, true}) {
            const char* key = upper ? "max" : "min";
            const std::vector<double>& right = upper ? most : least;
            if ((!given.contains(key) && !bounded[a]) || same_bounds(given, key, right, is_float))
                continue;
            Json values = Json::array();
            for (double value : right) values.push_back(is_float ? Json(value) : Json(static_cast<std::int64_t>(value)));
            json["accessors"][a][key] = std::move(values);
            if (repaired++ == 0)
                first = "/accessors/" + std::to_string(a) + "/" + key;
        }
    }
    if (repaired > 0)
        warnings.push_back(document.file + ": " + first + ": does not hold or is missing" +
                           (repaired > 1 ? ", and so are " + std::to_string(repaired - 1) + " more min and max" : "") +
                           "; repaired");
}

void repair_scenes(const Document& document, Json& json, Warnings& warnings) {
    if (!json.contains("scenes") || !json.contains("nodes"))
        return;
    const std::size_t node_count = json["nodes"].size();
    std::vector<std::size_t> parent(node_count, node_count);
    for (std::size_t n = 0; n < node_count; ++n)
        if (json["nodes"][n].contains("children"))
            for (const Json& child : json["nodes"][n]["children"]) parent[child.get<std::size_t>()] = n;
    for (std::size_t s = 0; s < json["scenes"].size(); ++s) {
        Json& scene = json["scenes"][s];
        if (!scene.contains("nodes"))
            continue;
        std::vector<char> listed(node_count, 0);
        bool wrong = false;
        for (const Json& node : scene["nodes"]) {
            const auto n = node.get<std::size_t>();
            wrong = wrong || parent[n] != node_count || listed[n];
            listed[n] = 1;
        }
        if (!wrong)
            continue;
        Json roots = Json::array();
        std::vector<char> kept(node_count, 0);
        std::string moved;
        for (const Json& node : scene["nodes"]) {
            const auto n = node.get<std::size_t>();
            std::size_t root = n;
            bool below_listed = false;
            while (parent[root] != node_count) {
                root = parent[root];
                below_listed = below_listed || listed[root];
            }
            if (root != n || kept[n])
                moved += (moved.empty() ? "" : ", ") + std::to_string(n);
            if (below_listed || kept[root])
                continue;
            kept[root] = 1;
            roots.push_back(root);
        }
        scene["nodes"] = std::move(roots);
        warnings.push_back(document.file + ": /scenes/" + std::to_string(s) +
                           "/nodes: only root nodes belong to a scene, each once; repaired at node " + moved);
    }
}

void repair_weights(const Document& document, Edition& edition, Warnings& warnings) {
    Json& json = edition.json;
    const std::size_t original = document.model.accessors.size();
    // Primitives that share their accessors share the repaired ones.
    std::map<std::vector<std::size_t>, std::vector<std::size_t>> known;
    std::size_t repaired = 0;
    std::string first;
    for (std::size_t m = 0; m < json["meshes"].size(); ++m)
        for (std::size_t p = 0; p < json["meshes"][m]["primitives"].size(); ++p) {
            Json& attributes = json["meshes"][m]["primitives"][p]["attributes"];
            std::vector<std::size_t> sets;
            for (std::string name; name = "WEIGHTS_" + std::to_string(sets.size()), attributes.contains(name);)
                sets.push_back(attributes[name].get<std::size_t>());
            const bool ours = std::all_of(sets.begin(), sets.end(), [&](std::size_t a) {
                return a < original && readable(document, a) && document.json["accessors"][a]["type"] == "VEC4" &&
                       document.model.accessors[a].count == document.model.accessors[sets[0]].count;
            });
            if (sets.empty() || !ours)
                continue;
            const auto [at, fresh] = known.emplace(sets, sets);
            if (fresh) {
                std::vector<std::vector<float>> weights;
                for (std::size_t a : sets) weights.push_back(read_floats(document, a));
                std::size_t wrong = 0;
                for (std::size_t v = 0; v < weights[0].size() / 4; ++v) {
                    double sum = 0;
                    std::size_t used = 0;
                    for (const auto& set : weights)
                        for (std::size_t k = 0; k < 4; ++k) {
                            sum += set[4 * v + k];
                            used += set[4 * v + k] != 0;
                        }
                    if (!(sum > 0) || std::abs(sum - 1) <= weight_sum_tolerance * static_cast<double>(used))
                        continue;
                    ++wrong;
                    for (auto& set : weights)
                        for (std::size_t k = 0; k < 4; ++k) set[4 * v + k] = static_cast<float>(set[4 * v + k] / sum);
                }
                if (wrong > 0) {
                    for (std::size_t s = 0; s < sets.size(); ++s)
                        at->second[s] = edition.add_attribute(weights[s], "VEC4", TINYGLTF_COMPONENT_TYPE_FLOAT, false, false);
                    if (repaired == 0)
                        first = "/meshes/" + std::to_string(m) + "/primitives/" + std::to_string(p) + "/attributes";
                    repaired += wrong;
                }
            }
            for (std::size_t s = 0; s < sets.size(); ++s) attributes["WEIGHTS_" + std::to_string(s)] = at->second[s];
        }
    if (repaired > 0)
        warnings.push_back(document.file + ": " + first + ": the joint weights of " + std::to_string(repaired) +
                           " vertices do not sum to 1; repaired");
}

}  // namespace pvg::gltf
