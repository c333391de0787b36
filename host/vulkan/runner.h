// A program on a device: its buffers, and the commands that evaluate it. Knows nothing of instances and queues, so the same
// code can record into anyone's command buffer.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "pvg/program.h"
#include "vulkan/pipelines.h"
#include "vulkan/ranges.h"

namespace pvg::vulkan {

/// Limits lower than the device's own; 0 keeps the device's.
struct RunnerOptions {
    std::uint64_t max_texels = 0;
    std::uint64_t max_storage_bytes = 0;
    std::uint64_t max_workgroups = 0;
    bool storage_only = false;  ///< never texel buffers
};

class Runner {
public:
    /// Copies bytes to a buffer; done when it returns, and visible to compute shaders.
    using Upload = std::function<void(const Buffer& target, const void* data, std::size_t bytes)>;

    /// The Device must outlive the runner.
    Runner(const Device& device, const RunnerOptions& options);

    /// Requires validate(program). Makes buffers and uploads to them; replaces what was loaded before. When it throws
    /// Error(device), nothing is loaded any more.
    void load(const Program& program, const Upload& upload);
    /// Requires a loaded field with as many coefficients.
    void set_coefficients(std::size_t field, const std::vector<float>& coefficients, const Upload& upload);
    std::size_t field_count() const { return fields_.size(); }
    std::size_t coefficient_size(std::size_t field) const { return fields_[field].coefficient_size; }

    /// Records everything from the coefficients to the readback buffer. Before it, uploads must be visible to compute
    /// shaders; after it, results are visible to the host. The commands may be submitted again when they have finished.
    void record(VkCommandBuffer commands) const;
    /// The same without the readback.
    void record_dispatches(VkCommandBuffer commands) const;
    /// What the last finished submission wrote.
    Evaluation read() const;

    /// Dispatches that read through texel buffers, and all of them.
    std::size_t texel_dispatch_count() const;
    std::size_t dispatch_count() const { return dispatches_.size(); }

private:
    /// Part of a buffer at a binding. format: of its texel view, unused where the binding is a storage buffer.
    struct Binding {
        std::uint32_t binding;
        VkBuffer buffer;
        VkFormat format;
        VkDeviceSize offset, bytes;
    };
    struct Dispatch {
        const Pipeline* pipeline = nullptr;
        std::vector<Binding> bindings;
        std::array<std::byte, 32> push{};
        std::uint32_t groups = 0;
        bool after_all = false;  ///< waits for every dispatch before it
        VkDescriptorSet set = VK_NULL_HANDLE;
    };
    struct FieldBuffers {
        std::uint32_t channels = 0;
        std::uint64_t row_count = 0;
        std::size_t coefficient_size = 0;
        Buffer rows, indices, weights, colors, scalars, values;
        VkDeviceSize values_bytes = 0, readback_offset = 0;
    };

    /// A buffer that shaders read; filled unless data is null.
    Buffer make_input(const void* data, std::size_t bytes, const Upload& upload) const;
    void load_field(const Field& field, const Upload& upload);
    void load_displacement(const Program& program, const Upload& upload);
    void load_normals(const Program& program, const Upload& upload);
    void bind_sets();
    void barrier(VkCommandBuffer commands, VkPipelineStageFlags before, VkAccessFlags from, VkPipelineStageFlags after,
                 VkAccessFlags to) const;
    void add_dispatch(Kernel kernel, bool texel, std::vector<Binding> bindings, const void* push, std::uint64_t items,
                      bool after_all);
    void clear();

    const Device& device_;
    Limits limits_;
    bool texel_allowed_;
    Pipelines pipelines_;

    std::vector<FieldBuffers> fields_;
    Buffer base_, directions_, first_term_, terms_, positions_;
    Buffer first_corner_, corners_, normals_;
    std::uint64_t vertex_count_ = 0, normal_count_ = 0;
    Buffer readback_;
    VkDeviceSize positions_offset_ = 0, normals_offset_ = 0;
    std::vector<Dispatch> dispatches_;
    Owned<VkDescriptorPool> pool_;
    std::vector<Owned<VkBufferView>> views_;
};

}  // namespace pvg::vulkan
