// height = sum of a vertex's height terms in order, position = base + height * unit * normal.
// One pass adds the terms that stand in one field; the passes come in the order of the terms.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

layout(local_size_x = PVG_LOCAL_SIZE) in;
layout(push_constant) uniform Push { DisplaceRange range; };

#if PVG_TEXEL
layout(set = 0, binding = PVG_DISPLACE_BASE) uniform samplerBuffer base;
layout(set = 0, binding = PVG_DISPLACE_NORMAL) uniform samplerBuffer normals;
layout(set = 0, binding = PVG_DISPLACE_FIRST) uniform usamplerBuffer first_term;
layout(set = 0, binding = PVG_DISPLACE_TERMS) uniform usamplerBuffer terms;
layout(set = 0, binding = PVG_DISPLACE_VALUES) uniform samplerBuffer values;
#define BASE(i) texelFetch(base, int(i))
#define NORMAL(i) texelFetch(normals, int(i))
#define FIRST(i) texelFetch(first_term, int(i)).x
#define TERM(i) texelFetch(terms, int(i)).xy
#define VALUE(i) texelFetch(values, int(i)).x
#else
layout(set = 0, binding = PVG_DISPLACE_BASE, std430) readonly buffer Base { vec4 base[]; };
layout(set = 0, binding = PVG_DISPLACE_NORMAL, std430) readonly buffer Normals { vec4 normals[]; };
layout(set = 0, binding = PVG_DISPLACE_FIRST, std430) readonly buffer FirstTerm { uint first_term[]; };
layout(set = 0, binding = PVG_DISPLACE_TERMS, std430) readonly buffer Terms { uvec2 terms[]; };
layout(set = 0, binding = PVG_DISPLACE_VALUES, std430) readonly buffer Values { float values[]; };
#define BASE(i) base[i]
#define NORMAL(i) normals[i]
#define FIRST(i) first_term[i]
#define TERM(i) terms[i]
#define VALUE(i) values[i]
#endif
layout(set = 0, binding = PVG_DISPLACE_POSITIONS, std430) buffer Positions { vec4 positions[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= range.vertex_count) return;
    uint first = FIRST(i);
    uint count = FIRST(i + 1u) - first;
    precise float height = 0.0;
    if (range.start == 0u) height = positions[i].w;
    for (uint k = range.term_first; k < min(count, range.term_last); ++k) {
        uvec2 term = TERM(first + k - range.term_base);
        if (term.x == range.field) height = height + VALUE(term.y);
    }
    // A vertex without terms is its base bit for bit, also where a component is -0.
    precise vec3 position = BASE(i).xyz;
    if (count > 0u) {
        precise float offset = height * range.unit;
        position = position + offset * NORMAL(i).xyz;
    }
    positions[i] = vec4(position, height);
}
