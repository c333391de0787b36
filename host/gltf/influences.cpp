#include "gltf/influences.h"

#include <algorithm>
#include <cmath>

namespace pvg::gltf {
namespace {

struct Influence {
    int joint;
    double weight;
};

void add(std::vector<Influence>& list, int joint, double weight) {
    for (Influence& known : list)
        if (known.joint == joint) {
            known.weight += weight;
            return;
        }
    list.push_back({joint, weight});
}

}  // namespace

std::vector<OutputAttribute> influences(const RawPrimitive& primitive, const std::vector<OutputVertex>& vertices,
                                        std::size_t joint_count, const std::string& place, Warnings& warnings) {
    std::vector<OutputAttribute> out;
    std::vector<const Attribute*> joints, weights;
    for (int set = 0;; ++set) {
        const std::string number = std::to_string(set);
        const Attribute *joint = primitive.find("JOINTS_" + number), *weight = primitive.find("WEIGHTS_" + number);
        if (!joint || !weight)
            break;
        joints.push_back(joint);
        weights.push_back(weight);
        out.push_back({"JOINTS_" + number, "VEC4", joint->component_type, false, 4, {}});
        out.push_back({"WEIGHTS_" + number, "VEC4", TINYGLTF_COMPONENT_TYPE_FLOAT, false, 4, {}});
    }
    const std::size_t sets = joints.size();
    if (sets == 0)
        return out;
    // All sets of one type, since an influence may move from one to another.
    int type = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    for (const Attribute* joint : joints)
        if (joint->component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)
            type = TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    for (std::size_t s = 0; s < sets; ++s) out[2 * s].component_type = type;

    std::size_t repaired = 0;
    std::vector<Influence> list;
    for (const OutputVertex& vertex : vertices) {
        list.clear();
        bool valid = vertex.is_raw();
        double sum = 0;
        std::size_t used = 0;
        for (int i = 0; i < 3 && vertex.raw[i] != none; ++i)
            for (std::size_t s = 0; s < sets; ++s)
                for (int k = 0; k < 4; ++k) {
                    const int joint = static_cast<int>(joints[s]->at(vertex.raw[i])[k]);
                    const double weight = weights[s]->at(vertex.raw[i])[k];
                    if (weight < 0)
                        throw Error(ErrorKind::bad_input, place + "/attributes/" + weights[s]->name + ": vertex " +
                                                              std::to_string(vertex.raw[i]) + " has a negative weight");
                    if (weight == 0)
                        continue;
                    if (static_cast<std::size_t>(joint) >= joint_count)
                        throw Error(ErrorKind::bad_input, place + "/attributes/" + joints[s]->name + ": vertex " +
                                                              std::to_string(vertex.raw[i]) + " follows joint " +
                                                              std::to_string(joint) + ", the skin has " +
                                                              std::to_string(joint_count));
                    const std::size_t before = list.size();
                    add(list, joint, weight * vertex.weight[i]);
                    if (vertex.is_raw() && list.size() == before)
                        valid = false;
                    sum += weight * vertex.weight[i];
                    ++used;
                }
        if (valid && !(std::abs(sum - 1) <= weight_sum_tolerance * static_cast<double>(used)))
            valid = false;
        if (valid) {
            for (std::size_t s = 0; s < sets; ++s)
                for (int k = 0; k < 4; ++k) {
                    const float weight = weights[s]->at(vertex.raw[0])[k], joint = joints[s]->at(vertex.raw[0])[k];
                    out[2 * s].values.push_back(static_cast<std::size_t>(joint) < joint_count ? joint : 0.0f);
                    out[2 * s + 1].values.push_back(weight);
                }
            continue;
        }
        if (vertex.is_raw())
            ++repaired;
        if (list.empty())
            list.push_back({0, 1.0});
        // Largest first; ties by joint, so that the result does not depend on the order of corners.
        std::sort(list.begin(), list.end(), [](const Influence& a, const Influence& b) {
            return a.weight != b.weight ? a.weight > b.weight : a.joint < b.joint;
        });
        list.resize(std::min(list.size(), 4 * sets));
        double total = 0;
        for (const Influence& influence : list) total += influence.weight;
        for (std::size_t s = 0; s < sets; ++s)
            for (std::size_t k = 0; k < 4; ++k) {
                const bool there = 4 * s + k < list.size();
                out[2 * s].values.push_back(there ? static_cast<float>(list[4 * s + k].joint) : 0.0f);
                out[2 * s + 1].values.push_back(there ? static_cast<float>(list[4 * s + k].weight / total) : 0.0f);
            }
    }
    if (repaired > 0)
        warnings.push_back(place + ": the joint weights of " + std::to_string(repaired) +
                           " vertices did not sum to 1; renormalised");
    return out;
}

}  // namespace pvg::gltf
