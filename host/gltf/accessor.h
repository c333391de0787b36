// Accessors: typed arrays over buffer views, strided, normalized and sparse (glTF 2.0, 3.6.2).
#pragma once

#include <string_view>

#include "gltf/document.h"

namespace pvg::gltf {

/// Bytes of a component type, 0 for a number that is none.
std::size_t component_size(int component_type);
/// Components of SCALAR ... MAT4, 0 for any other text.
std::size_t element_components(std::string_view type);
/// Bytes of one element; columns of matrices start at multiples of 4.
std::size_t element_bytes(std::string_view type, std::size_t component_bytes);
/// The same without the padding of the last column, which may lie past the end of the data.
std::size_t element_extent(std::string_view type, std::size_t component_bytes);

/// count x components numbers, row-major by element, as stored. Of a checked accessor; sparse indices are checked here. Fails
/// where the accessor lies in a buffer without data, or has more elements than most_elements.
std::vector<double> read_numbers(const Document& document, std::size_t accessor);
/// The same, normalized integers mapped to [0, 1] or [-1, 1], as float. Fails at the first number that is not finite, naming the
/// element.
std::vector<float> read_floats(const Document& document, std::size_t accessor);
/// Of an unsigned SCALAR accessor, each below `limit` (a number of vertices).
std::vector<std::uint32_t> read_indices(const Document& document, std::size_t accessor, std::size_t limit);

}  // namespace pvg::gltf
