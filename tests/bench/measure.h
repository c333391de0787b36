// Times as medians, verified results.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

namespace pvg::bench {

/// Seconds of one call.
template <typename Work>
double seconds_of(const Work& work) {
    const auto started = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

/// Each work's median, the works taken in turn so that a drift of the machine meets all alike. One round warms up.
inline std::vector<double> medians_in_turn(int rounds, const std::vector<std::function<void()>>& works) {
    std::vector<std::vector<double>> seconds(works.size());
    for (int round = -1; round < rounds; ++round)
        for (std::size_t w = 0; w < works.size(); ++w) {
            const double spent = seconds_of(works[w]);
            if (round >= 0)
                seconds[w].push_back(spent);
        }
    std::vector<double> medians;
    for (std::vector<double>& list : seconds) {
        std::sort(list.begin(), list.end());
        medians.push_back(list[list.size() / 2]);
    }
    return medians;
}

}  // namespace pvg::bench
