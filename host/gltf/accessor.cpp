#include "gltf/accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pvg::gltf {
namespace {

template <typename T>
double load_as(const unsigned char* at) {
    T value;
    std::memcpy(&value, at, sizeof(T));
    return static_cast<double>(value);
}

double load(const unsigned char* at, int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return load_as<std::int8_t>(at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load_as<std::uint8_t>(at);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return load_as<std::int16_t>(at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load_as<std::uint16_t>(at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return load_as<std::uint32_t>(at);
        default:
            return load_as<float>(at);
    }
}

Place place_of(const Document& document, std::size_t accessor) { return document.root().at("accessors").at(accessor); }

/// First byte of a buffer view plus offset.
const unsigned char* bytes_of(const Document& document, const Place& place, int view_index, std::size_t offset) {
    const tinygltf::BufferView& view = document.model.bufferViews[view_index];
    if (!document.has_data[view.buffer])
        place.fail("lies in buffer " + std::to_string(view.buffer) + ", which has no data here");
    return document.model.buffers[view.buffer].data.data() + view.byteOffset + offset;
}

/// Columns and rows of an element; rows of a column are contiguous.
std::pair<std::size_t, std::size_t> shape(std::size_t components, std::string_view type) {
    if (type == "MAT2")
        return {2, 2};
    if (type == "MAT3")
        return {3, 3};
    if (type == "MAT4")
        return {4, 4};
    return {1, components};
}

}  // namespace

std::size_t component_size(int component_type) {
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

std::size_t element_components(std::string_view type) {
    if (type == "SCALAR")
        return 1;
    if (type == "VEC2")
        return 2;
    if (type == "VEC3")
        return 3;
    if (type == "VEC4" || type == "MAT2")
        return 4;
    if (type == "MAT3")
        return 9;
    if (type == "MAT4")
        return 16;
    return 0;
}

std::size_t element_bytes(std::string_view type, std::size_t component_bytes) {
    const auto [columns, rows] = shape(element_components(type), type);
    return columns == 1 ? rows * component_bytes : columns * ((rows * component_bytes + 3) / 4 * 4);
}

std::size_t element_extent(std::string_view type, std::size_t component_bytes) {
    const auto [columns, rows] = shape(element_components(type), type);
    return (columns - 1) * ((rows * component_bytes + 3) / 4 * 4) + rows * component_bytes;
}

std::vector<double> read_numbers(const Document& document, std::size_t index) {
    const Place place = place_of(document, index);
    const tinygltf::Accessor& accessor = document.model.accessors[index];
    const std::string type = place.text("type");
    const std::size_t components = element_components(type), width = component_size(accessor.componentType);
    if (components == 0)
        place.at("type").fail("\"" + type + "\" is no accessor type; SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 and MAT4 are");
    const std::uint64_t count = place.integer("count", 1, UINT64_MAX);
    if (count > 3 * most_elements)
        place.at("count").fail(std::to_string(count) + " elements; at most " + std::to_string(3 * most_elements) +
                               " can be read");
    if (accessor.bufferView < 0 && count > most_zeros)
        place.at("count").fail(std::to_string(count) + " elements without a buffer view; at most " + std::to_string(most_zeros) +
                               " can be read");
    const auto [columns, rows] = shape(components, type);
    const std::size_t column_bytes = columns == 1 ? 0 : (rows * width + 3) / 4 * 4, bytes = element_bytes(type, width);
    std::vector<double> numbers(static_cast<std::size_t>(count) * components, 0.0);
    const auto read_element = [&](const unsigned char* at, std::size_t element) {
        for (std::size_t c = 0; c < columns; ++c)
            for (std::size_t r = 0; r < rows; ++r)
                numbers[element * components + c * rows + r] = load(at + c * column_bytes + r * width, accessor.componentType);
    };
    if (accessor.bufferView >= 0) {
        const std::size_t stride = document.model.bufferViews[accessor.bufferView].byteStride;
        const unsigned char* at = bytes_of(document, place, accessor.bufferView, accessor.byteOffset);
        for (std::size_t i = 0; i < count; ++i) read_element(at + i * (stride ? stride : bytes), i);
    }
    if (accessor.sparse.isSparse) {
        const auto& sparse = accessor.sparse;
        const std::size_t index_width = component_size(sparse.indices.componentType);
        const Place where = place.at("sparse").at("indices");
        const unsigned char* indices = bytes_of(document, where, sparse.indices.bufferView, sparse.indices.byteOffset);
        const unsigned char* values = bytes_of(document, where, sparse.values.bufferView, sparse.values.byteOffset);
        std::int64_t before = -1;
        for (int i = 0; i < sparse.count; ++i) {
            const auto element = static_cast<std::int64_t>(load(indices + i * index_width, sparse.indices.componentType));
            if (element <= before || element >= static_cast<std::int64_t>(count))
                where.fail("index " + std::to_string(i) + " is " + std::to_string(element) +
                           "; indices should rise and stay below " + std::to_string(count));
            before = element;
            read_element(values + i * bytes, static_cast<std::size_t>(element));
        }
    }
    return numbers;
}

std::vector<float> read_floats(const Document& document, std::size_t index) {
    const std::vector<double> numbers = read_numbers(document, index);
    const tinygltf::Accessor& accessor = document.model.accessors[index];
    double scale = 1;
    if (accessor.normalized) {
        switch (accessor.componentType) {
            case TINYGLTF_COMPONENT_TYPE_BYTE:
                scale = 127;
                break;
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                scale = 255;
                break;
            case TINYGLTF_COMPONENT_TYPE_SHORT:
                scale = 32767;
                break;
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                scale = 65535;
                break;
            default:
                break;
        }
    }
    std::vector<float> values(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (!std::isfinite(numbers[i])) {
            const std::size_t components = element_components(place_of(document, index).text("type"));
            place_of(document, index)
                .fail("element " + std::to_string(i / components) + " holds " + (std::isnan(numbers[i]) ? "NaN" : "infinity") +
                      "; expected finite numbers");
        }
        values[i] = static_cast<float>(accessor.normalized ? std::max(numbers[i] / scale, -1.0) : numbers[i]);
    }
    return values;
}

std::vector<std::uint32_t> read_indices(const Document& document, std::size_t index, std::size_t limit) {
    const Place place = place_of(document, index);
    const tinygltf::Accessor& accessor = document.model.accessors[index];
    const bool integers = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                          accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                          accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (!integers || accessor.normalized || place.text("type") != "SCALAR")
        place.fail("indices should be SCALAR unsigned integers, not normalized");
    const std::vector<double> numbers = read_numbers(document, index);
    std::vector<std::uint32_t> indices(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (numbers[i] >= static_cast<double>(limit))
            place.fail("index " + std::to_string(i) + " is " + std::to_string(static_cast<std::uint64_t>(numbers[i])) +
                       ", there are " + std::to_string(limit) + " vertices");
        indices[i] = static_cast<std::uint32_t>(numbers[i]);
    }
    return indices;
}

}  // namespace pvg::gltf
