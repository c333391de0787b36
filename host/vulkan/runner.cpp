#include "vulkan/runner.h"

#include <algorithm>
#include <cstring>
#include <set>
#include <string>

#include "kernels/shared.h"

namespace pvg::vulkan {
namespace {

using Texel = std::array<std::uint32_t, 4>;
using Vector = std::array<float, 4>;

// Bindings start at multiples of 256 bytes: no device may ask for a larger alignment of storage or texel buffers.
constexpr std::uint64_t binding_align = 256;
// More ranges than this mean that texel buffers are too small for the program; then storage buffers are tried.
constexpr std::size_t most_texel_ranges = 256;

std::vector<Vector> padded(const std::vector<std::array<float, 3>>& points) {
    std::vector<Vector> result(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) result[i] = {points[i][0], points[i][1], points[i][2], 0};
    return result;
}

struct Plan {
    std::vector<Range> ranges;
    bool texel = false;
};

/// Texel buffers where they serve, else storage buffers, else Error(device). random: elements and bytes of the largest array
/// that a dispatch reads anywhere.
Plan plan(const char* what, std::uint64_t count, std::uint64_t item_bytes, const std::vector<OwnedElements>& arrays,
          const Limits& limits, bool texel_allowed, std::uint64_t random_elements, std::uint64_t random_bytes) {
    if (texel_allowed && random_elements <= limits.texels) {
        auto ranges = plan_ranges(count, item_bytes, arrays, limits, true);
        if (ranges && ranges->size() <= most_texel_ranges)
            return {std::move(*ranges), true};
    }
    if (random_bytes > limits.storage_bytes) {
        throw Error(ErrorKind::device, std::string("Vulkan: ") + what + " take " + std::to_string(random_bytes) +
                                           " bytes, the device reads at most " + std::to_string(limits.storage_bytes) +
                                           " at once; evaluate on the CPU");
    }
    auto ranges = plan_ranges(count, item_bytes, arrays, limits, false);
    if (!ranges) {
        throw Error(ErrorKind::device, std::string("Vulkan: ") + what + " do not fit the " +
                                           std::to_string(limits.storage_bytes) +
                                           " bytes that the device reads at once; evaluate on the CPU");
    }
    return {std::move(*ranges), false};
}

OwnedElements by_first(const std::vector<std::uint32_t>& first, std::uint64_t bytes) {
    return {[&first](std::uint64_t i) { return first[i]; }, [&first](std::uint64_t i) { return first[i + 1]; }, bytes,
            binding_align / bytes};
}

}  // namespace

Runner::Runner(const Device& device, const RunnerOptions& options)
    : device_(device), texel_allowed_(!options.storage_only), pipelines_(device) {
    const auto lower = [](std::uint64_t own, std::uint64_t wanted) { return wanted ? std::min(own, wanted) : own; };
    limits_.texels = lower(device.limits.maxTexelBufferElements, options.max_texels);
    limits_.storage_bytes = lower(device.limits.maxStorageBufferRange, options.max_storage_bytes);
    limits_.workgroups = lower(device.limits.maxComputeWorkGroupCount[0], options.max_workgroups);
}

Buffer Runner::make_input(const void* data, std::size_t bytes, const Upload& upload) const {
    Buffer buffer(
        device_, bytes,
        VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
        Buffer::Memory::device);
    if (data && bytes)
        upload(buffer, data, bytes);
    return buffer;
}

void Runner::clear() {
    dispatches_.clear();
    views_.clear();
    pool_ = {};
    fields_.clear();
    for (Buffer* buffer :
         {&base_, &directions_, &first_term_, &terms_, &positions_, &first_corner_, &corners_, &normals_, &readback_}) {
        *buffer = {};
    }
    vertex_count_ = normal_count_ = 0;
}

void Runner::load(const Program& program, const Upload& upload) {
    clear();
    try {
        for (const Field& field : program.fields) load_field(field, upload);
        load_displacement(program, upload);
        load_normals(program, upload);
        VkDeviceSize bytes = 0;
        for (FieldBuffers& field : fields_) {
            field.readback_offset = bytes;
            bytes += field.values_bytes;
        }
        positions_offset_ = bytes;
        bytes += vertex_count_ * sizeof(Vector);
        normals_offset_ = bytes;
        bytes += normal_count_ * sizeof(Vector);
        readback_ = Buffer(device_, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, Buffer::Memory::readback);
        bind_sets();
    } catch (...) {
        clear();
        throw;
    }
}

void Runner::load_field(const Field& field, const Upload& upload) {
    const Table& table = field.table;
    if (table.channels != 1 && table.channels != 4 && table.channels != 5) {
        throw Error(ErrorKind::bad_input,
                    "Vulkan: a field has " + std::to_string(table.channels) + " channels, expected 1, 4 or 5");
    }
    FieldBuffers& buffers = fields_.emplace_back();
    buffers.channels = table.channels;
    buffers.row_count = table.row_count;
    buffers.coefficient_size = field.coefficients.size();

    // A header a row costs 16 bytes. On lavapipe it is as fast as the chain row, cell, header, and 2 to 3 times faster than a
    // workgroup of 8 for each cell, whose few rows leave most of it idle.
    std::vector<Texel> rows(table.row_count);
    for (std::uint32_t cell = 0; cell < table.cell_count; ++cell) {
        const std::uint32_t list = table.cell_first_index[cell] / 4;
        const std::uint32_t length = (table.cell_first_index[cell + 1] - table.cell_first_index[cell]) / 4;
        std::uint32_t block = table.cell_first_weight[cell] / 4;
        for (std::uint32_t row = table.cell_first_row[cell]; row < table.cell_first_row[cell + 1]; ++row, block += length) {
            rows[row] = {list, block, length, 0};
        }
    }
    buffers.rows = make_input(rows.data(), rows.size() * sizeof(Texel), upload);
    buffers.indices = make_input(table.indices.data(), table.indices.size() * sizeof(std::uint32_t), upload);
    buffers.weights = make_input(table.weights.data(), table.weights.size() * sizeof(float), upload);
    buffers.values_bytes = std::uint64_t(table.row_count) * table.channels * sizeof(float);
    buffers.values =
        Buffer(device_, buffers.values_bytes,
               VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
               Buffer::Memory::device);
    const std::uint64_t color_bytes = table.channels >= 4 ? std::uint64_t(table.coefficient_count) * sizeof(Vector) : 0;
    const std::uint64_t scalar_bytes = table.channels != 4 ? std::uint64_t(table.coefficient_count) * sizeof(float) : 0;
    buffers.colors = make_input(nullptr, color_bytes, upload);
    buffers.scalars = make_input(nullptr, scalar_bytes, upload);
    set_coefficients(fields_.size() - 1, field.coefficients, upload);
    if (!table.row_count)
        return;

    const OwnedElements indices{[&](std::uint64_t r) { return rows[r][0]; },
                                [&](std::uint64_t r) { return rows[r][0] + rows[r][2]; }, sizeof(Texel),
                                binding_align / sizeof(Texel)};
    const OwnedElements weights{[&](std::uint64_t r) { return rows[r][1]; },
                                [&](std::uint64_t r) { return rows[r][1] + rows[r][2]; }, sizeof(Vector),
                                binding_align / sizeof(Vector)};
    const std::uint64_t item_bytes = std::max<std::uint64_t>(sizeof(Texel), table.channels * sizeof(float));
    const Plan planned = plan("coefficients", table.row_count, item_bytes, {indices, weights}, limits_, texel_allowed_,
                              table.coefficient_count, std::max(color_bytes, scalar_bytes));
    const Kernel kernel = table.channels == 1   ? Kernel::evaluate_1
                          : table.channels == 4 ? Kernel::evaluate_4
                                                : Kernel::evaluate_5;
    for (const Range& range : planned.ranges) {
        kernels::EvaluateRange push{};
        push.row_count = static_cast<std::uint32_t>(range.last - range.first);
        push.index_base = static_cast<std::uint32_t>(indices.base(range.first));
        push.weight_base = static_cast<std::uint32_t>(weights.base(range.first));
        const std::uint64_t count = push.row_count;
        const auto part = [&](std::uint32_t binding, const Buffer& buffer, VkFormat format, std::uint64_t first,
                              std::uint64_t last) {
            return Binding{binding, buffer.handle(), format, first * sizeof(Texel), (last - first) * sizeof(Texel)};
        };
        std::vector<Binding> bindings{
            part(PVG_EVALUATE_ROWS, buffers.rows, VK_FORMAT_R32G32B32A32_UINT, range.first, range.last),
            part(PVG_EVALUATE_INDICES, buffers.indices, VK_FORMAT_R32G32B32A32_UINT, push.index_base,
                 indices.last(range.last - 1)),
            part(PVG_EVALUATE_WEIGHTS, buffers.weights, VK_FORMAT_R32G32B32A32_SFLOAT, push.weight_base,
                 weights.last(range.last - 1)),
            {PVG_EVALUATE_COLORS, buffers.colors.handle(), VK_FORMAT_R32G32B32A32_SFLOAT, 0, color_bytes},
            {PVG_EVALUATE_SCALARS, buffers.scalars.handle(), VK_FORMAT_R32_SFLOAT, 0, scalar_bytes},
            {PVG_EVALUATE_VALUES, buffers.values.handle(), VK_FORMAT_UNDEFINED, range.first * table.channels * sizeof(float),
             count * table.channels * sizeof(float)}};
        add_dispatch(kernel, planned.texel, std::move(bindings), &push, count, false);
    }
}

void Runner::set_coefficients(std::size_t index, const std::vector<float>& coefficients, const Upload& upload) {
    const FieldBuffers& field = fields_[index];
    if (coefficients.empty())
        return;
    if (field.channels != 5) {
        upload(field.channels == 1 ? field.scalars : field.colors, coefficients.data(), coefficients.size() * sizeof(float));
        return;
    }
    const std::size_t count = coefficients.size() / 5;
    std::vector<Vector> colors(count);
    std::vector<float> scalars(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::copy_n(&coefficients[5 * i], 4, colors[i].begin());
        scalars[i] = coefficients[5 * i + 4];
    }
    upload(field.colors, colors.data(), count * sizeof(Vector));
    upload(field.scalars, scalars.data(), count * sizeof(float));
}

void Runner::load_displacement(const Program& program, const Upload& upload) {
    vertex_count_ = program.base.size();
    positions_ =
        Buffer(device_, vertex_count_ * sizeof(Vector),
               VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
               Buffer::Memory::device);
    if (!vertex_count_)
        return;
    const std::vector<std::uint32_t>& first = program.height_first;
    base_ = make_input(padded(program.base).data(), vertex_count_ * sizeof(Vector), upload);
    directions_ = make_input(padded(program.normal).data(), vertex_count_ * sizeof(Vector), upload);
    first_term_ = make_input(first.data(), first.size() * sizeof(std::uint32_t), upload);
    std::vector<std::array<std::uint32_t, 2>> terms(program.height_terms.size());
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const HeightTerm& term = program.height_terms[i];
        terms[i] = {term.field, term.row * fields_[term.field].channels + term.channel};
    }
    terms_ = make_input(terms.data(), terms.size() * sizeof(terms[0]), upload);

    // Where every vertex names its fields in ascending order, one pass a field keeps the order of the sum; else there is a
    // pass for each number of a term and each field that stands there.
    struct Pass {
        std::uint32_t term_first, term_last, field;
    };
    bool ascending = true;
    std::set<std::uint32_t> used;
    std::set<std::pair<std::uint32_t, std::uint32_t>> used_at;
    for (std::size_t i = 0; i < vertex_count_; ++i) {
        for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
            used.insert(terms[k][0]);
            used_at.insert({k - first[i], terms[k][0]});
            ascending = ascending && (k == first[i] || terms[k - 1][0] <= terms[k][0]);
        }
    }
    std::vector<Pass> passes;
    if (ascending) {
        for (std::uint32_t field : used) passes.push_back({0, ~0u, field});
    } else {
        for (const auto& [number, field] : used_at) passes.push_back({number, number + 1, field});
    }
    if (passes.empty())
        passes.push_back({0, 0, ~0u});

    std::uint64_t most_values = 0;
    for (std::uint32_t field : used) most_values = std::max(most_values, fields_[field].row_count * fields_[field].channels);
    const OwnedElements owned_terms = by_first(first, sizeof(terms[0]));
    const Plan planned = plan("height values", vertex_count_, sizeof(Vector), {owned_terms}, limits_, texel_allowed_, most_values,
                              most_values * sizeof(float));
    for (const Pass& pass : passes) {
        for (const Range& range : planned.ranges) {
            kernels::DisplaceRange push{};
            push.vertex_count = static_cast<std::uint32_t>(range.last - range.first);
            push.term_base = static_cast<std::uint32_t>(owned_terms.base(range.first));
            push.field = pass.field;
            push.term_first = pass.term_first;
            push.term_last = pass.term_last;
            push.start = &pass == &passes.front();
            push.unit = program.unit;
            const std::uint64_t count = push.vertex_count;
            // Where no vertex has a term the values are never read; any buffer stands in.
            const Buffer& values = used.empty() ? base_ : fields_[pass.field].values;
            const VkDeviceSize values_bytes = used.empty() ? 0 : fields_[pass.field].values_bytes;
            std::vector<Binding> bindings{
                {PVG_DISPLACE_BASE, base_.handle(), VK_FORMAT_R32G32B32A32_SFLOAT, range.first * sizeof(Vector),
                 count * sizeof(Vector)},
                {PVG_DISPLACE_NORMAL, directions_.handle(), VK_FORMAT_R32G32B32A32_SFLOAT, range.first * sizeof(Vector),
                 count * sizeof(Vector)},
                {PVG_DISPLACE_FIRST, first_term_.handle(), VK_FORMAT_R32_UINT, range.first * sizeof(std::uint32_t),
                 (count + 1) * sizeof(std::uint32_t)},
                {PVG_DISPLACE_TERMS, terms_.handle(), VK_FORMAT_R32G32_UINT, push.term_base * sizeof(terms[0]),
                 (owned_terms.last(range.last - 1) - push.term_base) * sizeof(terms[0])},
                {PVG_DISPLACE_VALUES, values.handle(), VK_FORMAT_R32_SFLOAT, 0, values_bytes},
                {PVG_DISPLACE_POSITIONS, positions_.handle(), VK_FORMAT_UNDEFINED, range.first * sizeof(Vector),
                 count * sizeof(Vector)}};
            add_dispatch(Kernel::displace, planned.texel, std::move(bindings), &push, count, range.first == 0);
        }
    }
}

void Runner::load_normals(const Program& program, const Upload& upload) {
    normal_count_ = program.corner_first.empty() ? 0 : program.corner_first.size() - 1;
    normals_ = Buffer(device_, normal_count_ * sizeof(Vector),
                      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Buffer::Memory::device);
    if (!normal_count_)
        return;
    const std::vector<std::uint32_t>& first = program.corner_first;
    std::vector<Texel> corners(program.corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        corners[i] = {program.corners[i][0], program.corners[i][1], program.corners[i][2], 0};
    }
    first_corner_ = make_input(first.data(), first.size() * sizeof(std::uint32_t), upload);
    corners_ = make_input(corners.data(), corners.size() * sizeof(Texel), upload);
    const OwnedElements owned_corners = by_first(first, sizeof(Texel));
    const Plan planned = plan("positions", normal_count_, sizeof(Vector), {owned_corners}, limits_, texel_allowed_, vertex_count_,
                              vertex_count_ * sizeof(Vector));
    for (const Range& range : planned.ranges) {
        kernels::NormalsRange push{};
        push.normal_count = static_cast<std::uint32_t>(range.last - range.first);
        push.corner_base = static_cast<std::uint32_t>(owned_corners.base(range.first));
        const std::uint64_t count = push.normal_count;
        std::vector<Binding> bindings{
            {PVG_NORMALS_FIRST, first_corner_.handle(), VK_FORMAT_R32_UINT, range.first * sizeof(std::uint32_t),
             (count + 1) * sizeof(std::uint32_t)},
            {PVG_NORMALS_CORNERS, corners_.handle(), VK_FORMAT_R32G32B32A32_UINT, push.corner_base * sizeof(Texel),
             (owned_corners.last(range.last - 1) - push.corner_base) * sizeof(Texel)},
            {PVG_NORMALS_POSITIONS, positions_.handle(), VK_FORMAT_R32G32B32A32_SFLOAT, 0, vertex_count_ * sizeof(Vector)},
            {PVG_NORMALS_NORMALS, normals_.handle(), VK_FORMAT_UNDEFINED, range.first * sizeof(Vector), count * sizeof(Vector)}};
        add_dispatch(Kernel::normals, planned.texel, std::move(bindings), &push, count, range.first == 0);
    }
}

void Runner::add_dispatch(Kernel kernel, bool texel, std::vector<Binding> bindings, const void* push, std::uint64_t items,
                          bool after_all) {
    Dispatch dispatch;
    dispatch.pipeline = &pipelines_.get(kernel, texel);
    dispatch.bindings = std::move(bindings);
    static_assert(sizeof(kernels::DisplaceRange) <= sizeof(dispatch.push) &&
                  sizeof(kernels::EvaluateRange) <= sizeof(dispatch.push) &&
                  sizeof(kernels::NormalsRange) <= sizeof(dispatch.push));
    std::memcpy(dispatch.push.data(), push, dispatch.pipeline->push_bytes);
    dispatch.groups = static_cast<std::uint32_t>((items + PVG_LOCAL_SIZE - 1) / PVG_LOCAL_SIZE);
    dispatch.after_all = after_all;
    dispatches_.push_back(std::move(dispatch));
}

void Runner::bind_sets() {
    if (dispatches_.empty())
        return;
    const DeviceFunctions& vk = device_.functions;
    VkDescriptorPoolSize sizes[2] = {{VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, 1}, {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1}};
    for (const Dispatch& dispatch : dispatches_) {
        const Pipeline& pipeline = *dispatch.pipeline;
        sizes[0].descriptorCount += pipeline.texel ? pipeline.bindings - 1 : 0;
        sizes[1].descriptorCount += pipeline.texel ? 1 : pipeline.bindings;
    }
    auto pool = typed<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
    pool.maxSets = static_cast<std::uint32_t>(dispatches_.size());
    pool.poolSizeCount = 2;
    pool.pPoolSizes = sizes;
    VkDescriptorPool raw = VK_NULL_HANDLE;
    check(vk.CreateDescriptorPool(device_.handle, &pool, nullptr, &raw), "creating a descriptor pool");
    pool_ = Owned<VkDescriptorPool>(device_.handle, vk.DestroyDescriptorPool, raw);

    for (Dispatch& dispatch : dispatches_) {
        const Pipeline& pipeline = *dispatch.pipeline;
        const VkDescriptorSetLayout layout = pipeline.set_layout.get();
        auto allocate = typed<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
        allocate.descriptorPool = raw;
        allocate.descriptorSetCount = 1;
        allocate.pSetLayouts = &layout;
        check(vk.AllocateDescriptorSets(device_.handle, &allocate, &dispatch.set), "allocating a descriptor set");
        for (const Binding& binding : dispatch.bindings) {
            // An empty array is never read; its buffer has 16 bytes.
            const VkDeviceSize bytes = std::max<VkDeviceSize>(binding.bytes, 16);
            const VkDeviceSize offset = binding.bytes ? binding.offset : 0;
            const bool texel = pipeline.texel && binding.binding + 1 < pipeline.bindings;
            auto write = typed<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
            write.dstSet = dispatch.set;
            write.dstBinding = binding.binding;
            write.descriptorCount = 1;
            VkBufferView view = VK_NULL_HANDLE;
            const VkDescriptorBufferInfo info{binding.buffer, offset, binding.bytes ? binding.bytes : bytes};
            if (texel) {
                views_.push_back(
                    make_buffer_view(device_, binding.buffer, binding.format, offset, binding.bytes ? binding.bytes : bytes));
                view = views_.back().get();
                write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
                write.pTexelBufferView = &view;
            } else {
                write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
                write.pBufferInfo = &info;
            }
            vk.UpdateDescriptorSets(device_.handle, 1, &write, 0, nullptr);
        }
    }
}

void Runner::barrier(VkCommandBuffer commands, VkPipelineStageFlags before, VkAccessFlags from, VkPipelineStageFlags after,
                     VkAccessFlags to) const {
    auto memory = typed<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
    memory.srcAccessMask = from;
    memory.dstAccessMask = to;
    device_.functions.CmdPipelineBarrier(commands, before, after, 0, 1, &memory, 0, nullptr, 0, nullptr);
}

void Runner::record_dispatches(VkCommandBuffer commands) const {
    const DeviceFunctions& vk = device_.functions;
    for (const Dispatch& dispatch : dispatches_) {
        if (dispatch.after_all) {
            barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                    VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
        }
        const Pipeline& pipeline = *dispatch.pipeline;
        vk.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.pipeline.get());
        vk.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.layout.get(), 0, 1, &dispatch.set, 0,
                                 nullptr);
        vk.CmdPushConstants(commands, pipeline.layout.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, pipeline.push_bytes,
                            dispatch.push.data());
        vk.CmdDispatch(commands, dispatch.groups, 1, 1);
    }
}

void Runner::record(VkCommandBuffer commands) const {
    const DeviceFunctions& vk = device_.functions;
    record_dispatches(commands);
    barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
            VK_ACCESS_TRANSFER_READ_BIT);
    const auto copy = [&](const Buffer& source, VkDeviceSize offset, VkDeviceSize bytes) {
        const VkBufferCopy region{0, offset, bytes};
        if (bytes)
            vk.CmdCopyBuffer(commands, source.handle(), readback_.handle(), 1, &region);
    };
    for (const FieldBuffers& field : fields_) copy(field.values, field.readback_offset, field.values_bytes);
    copy(positions_, positions_offset_, vertex_count_ * sizeof(Vector));
    copy(normals_, normals_offset_, normal_count_ * sizeof(Vector));
    barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT,
            VK_ACCESS_HOST_READ_BIT);
}

Evaluation Runner::read() const {
    readback_.invalidate(device_);
    Evaluation result;
    const std::byte* data = readback_.mapped();
    for (const FieldBuffers& field : fields_) {
        std::vector<float>& values = result.values.emplace_back(field.values_bytes / sizeof(float));
        if (!values.empty())
            std::memcpy(values.data(), data + field.readback_offset, field.values_bytes);
    }
    result.height.resize(vertex_count_);
    result.position.resize(vertex_count_);
    for (std::size_t i = 0; i < vertex_count_; ++i) {
        Vector v;
        std::memcpy(&v, data + positions_offset_ + i * sizeof(Vector), sizeof(Vector));
        result.position[i] = {v[0], v[1], v[2]};
        result.height[i] = v[3];
    }
    result.normal.resize(normal_count_);
    for (std::size_t i = 0; i < normal_count_; ++i) {
        std::memcpy(&result.normal[i], data + normals_offset_ + i * sizeof(Vector), sizeof(result.normal[i]));
    }
    return result;
}

std::size_t Runner::texel_dispatch_count() const {
    return static_cast<std::size_t>(
        std::count_if(dispatches_.begin(), dispatches_.end(), [](const Dispatch& d) { return d.pipeline->texel; }));
}

}  // namespace pvg::vulkan
