// u(row) = sum over the cell's list of weight * coefficient, in list order, for 1, 4 or 5 channels.
// Compiled once for each count (PVG_CHANNELS) and each access path (PVG_TEXEL).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

layout(local_size_x = PVG_LOCAL_SIZE) in;
layout(push_constant) uniform Push { EvaluateRange range; };

#if PVG_TEXEL
layout(set = 0, binding = PVG_EVALUATE_ROWS) uniform usamplerBuffer rows;
layout(set = 0, binding = PVG_EVALUATE_INDICES) uniform usamplerBuffer indices;
layout(set = 0, binding = PVG_EVALUATE_WEIGHTS) uniform samplerBuffer weights;
layout(set = 0, binding = PVG_EVALUATE_COLORS) uniform samplerBuffer colors;
layout(set = 0, binding = PVG_EVALUATE_SCALARS) uniform samplerBuffer scalars;
#define ROW(i) texelFetch(rows, int(i))
#define INDEX(i) texelFetch(indices, int(i))
#define WEIGHT(i) texelFetch(weights, int(i))
#define COLOR(i) texelFetch(colors, int(i))
#define SCALAR(i) texelFetch(scalars, int(i)).x
#else
layout(set = 0, binding = PVG_EVALUATE_ROWS, std430) readonly buffer Rows { uvec4 rows[]; };
layout(set = 0, binding = PVG_EVALUATE_INDICES, std430) readonly buffer Indices { uvec4 indices[]; };
layout(set = 0, binding = PVG_EVALUATE_WEIGHTS, std430) readonly buffer Weights { vec4 weights[]; };
layout(set = 0, binding = PVG_EVALUATE_COLORS, std430) readonly buffer Colors { vec4 colors[]; };
layout(set = 0, binding = PVG_EVALUATE_SCALARS, std430) readonly buffer Scalars { float scalars[]; };
#define ROW(i) rows[i]
#define INDEX(i) indices[i]
#define WEIGHT(i) weights[i]
#define COLOR(i) colors[i]
#define SCALAR(i) scalars[i]
#endif
layout(set = 0, binding = PVG_EVALUATE_VALUES, std430) writeonly buffer Values { float values[]; };

void main() {
    uint row = gl_GlobalInvocationID.x;
    if (row >= range.row_count) return;
    uvec4 header = ROW(row);
    uint list = header.x - range.index_base;
    uint block = header.y - range.weight_base;
#if PVG_CHANNELS >= 4
    precise vec4 color = vec4(0.0);
#endif
#if PVG_CHANNELS != 4
    precise float scalar = 0.0;
#endif
    for (uint k = 0u; k < header.z; ++k) {
        uvec4 j = INDEX(list + k);
        vec4 w = WEIGHT(block + k);
#if PVG_CHANNELS >= 4
        color = color + w.x * COLOR(j.x);
        color = color + w.y * COLOR(j.y);
        color = color + w.z * COLOR(j.z);
        color = color + w.w * COLOR(j.w);
#endif
#if PVG_CHANNELS != 4
        scalar = scalar + w.x * SCALAR(j.x);
        scalar = scalar + w.y * SCALAR(j.y);
        scalar = scalar + w.z * SCALAR(j.z);
        scalar = scalar + w.w * SCALAR(j.w);
#endif
    }
    uint first = row * PVG_CHANNELS;
#if PVG_CHANNELS >= 4
    values[first] = color.x;
    values[first + 1u] = color.y;
    values[first + 2u] = color.z;
    values[first + 3u] = color.w;
#endif
#if PVG_CHANNELS != 4
    values[first + PVG_CHANNELS - 1u] = scalar;
#endif
}
