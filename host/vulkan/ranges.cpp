#include "vulkan/ranges.h"

#include <algorithm>

#include "kernels/shared.h"

namespace pvg::vulkan {

std::optional<std::vector<Range>> plan_ranges(std::uint64_t count, std::uint64_t item_bytes,
                                              const std::vector<OwnedElements>& arrays, const Limits& limits, bool texel) {
    const auto fits = [&](std::uint64_t elements, std::uint64_t bytes) {
        return elements * bytes <= limits.storage_bytes && (!texel || elements <= limits.texels);
    };
    const auto allowed = [&](std::uint64_t first, std::uint64_t last) {
        const std::uint64_t items = last - first;
        if ((items + PVG_LOCAL_SIZE - 1) / PVG_LOCAL_SIZE > limits.workgroups || !fits(items + 1, item_bytes))
            return false;
        return std::all_of(arrays.begin(), arrays.end(), [&](const OwnedElements& array) {
            return fits(array.last(last - 1) - array.base(first), array.bytes);
        });
    };
    std::vector<Range> ranges;
    for (std::uint64_t first = 0; first < count;) {
        std::uint64_t last = first;
        while (last < count) {
            const std::uint64_t next = std::min(last + PVG_LOCAL_SIZE, count);
            if (!allowed(first, next))
                break;
            last = next;
        }
        if (last == first)
            return std::nullopt;
        ranges.push_back({first, last});
        first = last;
    }
    return ranges;
}

}  // namespace pvg::vulkan
