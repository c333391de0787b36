#include <algorithm>
#include <cmath>

#include "scene/scene.h"

namespace pvg {
namespace {

template <typename Value>
Value evaluate(const Stops<Value>& stops, double t, bool closed) {
    const auto [stop, weight] = stop_weights(stops.t, t, closed);
    if (weight[1] == 0)
        return stops.value[stop[0]];
    return weight[0] * stops.value[stop[0]] + weight[1] * stops.value[stop[1]];
}

}  // namespace

StopWeights stop_weights(const std::vector<double>& stops, double t, bool closed) {
    const std::size_t count = stops.size(), last = count - 1;
    if (closed)
        t -= std::floor(t);  // t = 1 is t = 0
    if (count == 1)
        return {};
    // The first stop after t; the stop before it is at or before t.
    const std::size_t after = static_cast<std::size_t>(std::upper_bound(stops.begin(), stops.end(), t) - stops.begin());
    if (after > 0 && after < count) {
        const double s = (t - stops[after - 1]) / (stops[after] - stops[after - 1]);
        return {{after - 1, after}, {1 - s, s}};
    }
    if (!closed)
        return after == 0 ? StopWeights{} : StopWeights{{last, last}, {1, 0}};
    // Across the seam, from the last stop to the first one of the next turn.
    const double gap = stops.front() + 1 - stops.back();
    if (gap <= 0)
        return {};
    const double s = (t - stops.back() + (after == 0 ? 1 : 0)) / gap;
    return {{last, 0}, {1 - s, s}};
}

Color evaluate_stops(const Stops<Color>& stops, double t, bool closed) { return evaluate(stops, t, closed); }
double evaluate_stops(const Stops<double>& stops, double t, bool closed) { return evaluate(stops, t, closed); }

}  // namespace pvg
