#include <algorithm>
#include <cmath>

#include "scene/scene.h"

namespace pvg {
namespace {

template <typename Value>
Value evaluate(const Stops<Value>& stops, double t, bool closed) {
    const std::size_t count = stops.t.size();
    if (closed)
        t -= std::floor(t);  // t = 1 is t = 0
    if (count == 1)
        return stops.value[0];
    // The first stop after t; the stop before it is at or before t.
    const std::size_t after = static_cast<std::size_t>(std::upper_bound(stops.t.begin(), stops.t.end(), t) - stops.t.begin());
    if (after > 0 && after < count) {
        const double s = (t - stops.t[after - 1]) / (stops.t[after] - stops.t[after - 1]);
        return (1 - s) * stops.value[after - 1] + s * stops.value[after];
    }
    if (!closed)
        return after == 0 ? stops.value.front() : stops.value.back();
    // Across the seam, from the last stop to the first one of the next turn.
    const double gap = stops.t.front() + 1 - stops.t.back();
    if (gap <= 0)
        return stops.value.front();
    const double s = (t - stops.t.back() + (after == 0 ? 1 : 0)) / gap;
    return (1 - s) * stops.value.back() + s * stops.value.front();
}

}  // namespace

Color evaluate_stops(const Stops<Color>& stops, double t, bool closed) { return evaluate(stops, t, closed); }
double evaluate_stops(const Stops<double>& stops, double t, bool closed) { return evaluate(stops, t, closed); }

}  // namespace pvg
