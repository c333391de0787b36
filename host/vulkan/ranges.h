// Dispatches cut into ranges that a device's limits allow.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace pvg::vulkan {

/// What one dispatch may cover.
struct Limits {
    std::uint64_t texels = 0;         ///< elements of a texel buffer view
    std::uint64_t storage_bytes = 0;  ///< bytes of a storage buffer binding
    std::uint64_t workgroups = 0;
};

/// An array that belongs to the items of a dispatch by position: item i owns elements first(i) .. last(i) - 1, both
/// ascending. Its binding starts at an element that is a multiple of `align`.
struct OwnedElements {
    std::function<std::uint64_t(std::uint64_t)> first, last;
    std::uint64_t bytes = 0;  ///< of an element
    std::uint64_t align = 1;

    /// First element that a range starting at item `item` binds.
    std::uint64_t base(std::uint64_t item) const { return first(item) / align * align; }
};

struct Range {
    std::uint64_t first = 0, last = 0;  ///< items
};

/// Cuts count items into ranges, longest first, that start at multiples of PVG_LOCAL_SIZE. item_bytes: bytes an item of
/// the largest array with one element an item (and one more at the end). texel: the texel limit holds too.
/// Nothing when some workgroup alone is over the limits.
std::optional<std::vector<Range>> plan_ranges(std::uint64_t count, std::uint64_t item_bytes,
                                              const std::vector<OwnedElements>& arrays, const Limits& limits, bool texel);

}  // namespace pvg::vulkan
