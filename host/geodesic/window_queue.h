// A priority queue of numbered items: a heap with four children a node, shallow and kind to the cache. Equal keys leave it in an
// order that depends on the calls only, so the propagation is deterministic.
#pragma once

#include <cstddef>
#include <vector>

namespace pvg {

class WindowQueue {
public:
    struct Item {
        double key;
        int index;
    };

    bool empty() const { return heap_.empty(); }

    void push(double key, int index) {
        std::size_t at = heap_.size();
        heap_.push_back({key, index});
        while (at > 0) {
            const std::size_t parent = (at - 1) / 4;
            if (!(key < heap_[parent].key))
                break;
            heap_[at] = heap_[parent];
            at = parent;
        }
        heap_[at] = {key, index};
    }

    /// The item with the smallest key; only when not empty.
    Item pop() {
        const Item top = heap_.front(), last = heap_.back();
        heap_.pop_back();
        const std::size_t count = heap_.size();
        if (count == 0)
            return top;
        std::size_t at = 0;
        while (true) {
            const std::size_t child = 4 * at + 1;
            if (child >= count)
                break;
            std::size_t least = child;
            const std::size_t stop = child + 4 < count ? child + 4 : count;
            for (std::size_t c = child + 1; c < stop; ++c)
                if (heap_[c].key < heap_[least].key)
                    least = c;
            if (!(heap_[least].key < last.key))
                break;
            heap_[at] = heap_[least];
            at = least;
        }
        heap_[at] = last;
        return top;
    }

private:
    std::vector<Item> heap_;
};

}  // namespace pvg
