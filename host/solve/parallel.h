// Work on independent items by several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace pvg {

/// Threads for `items` pieces of work: `wanted`, or one a core where it is 0.
inline int thread_count(int wanted, int items) {
    const int threads = wanted > 0 ? wanted : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    return std::max(1, std::min(threads, items));
}

/// Calls work(thread, item) for every item on threads of its own. Which thread takes an item is open; results may not depend on
/// it. Thread 0 is the caller's own.
template <typename Work>
void for_each_parallel(int count, int threads, const Work& work) {
    std::atomic<int> next{0};
    std::exception_ptr failure;
    std::mutex failure_lock;
    const auto run = [&](int thread) {
        try {
            for (int item = next++; item < count; item = next++) work(thread, item);
        } catch (...) {
            const std::lock_guard lock(failure_lock);
            if (!failure)
                failure = std::current_exception();
            next = count;
        }
    };
    {
        std::vector<std::jthread> others;
        for (int t = 1; t < threads; ++t) others.emplace_back(run, t);
        run(0);
    }
    if (failure)
        std::rethrow_exception(failure);
}

}  // namespace pvg
