// Shading normals of the displaced surface: normalised sum over a normal's corners (a; b, c) of
// cross(b - a, c - a) / (|b - a|^2 |c - a|^2).
// Source: N. Max, "Weights for computing vertex normals from facet normals", Journal of Graphics Tools 4(2), 1999.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

layout(local_size_x = PVG_LOCAL_SIZE) in;
layout(push_constant) uniform Push { NormalsRange range; };

#if PVG_TEXEL
layout(set = 0, binding = PVG_NORMALS_FIRST) uniform usamplerBuffer first_corner;
layout(set = 0, binding = PVG_NORMALS_CORNERS) uniform usamplerBuffer corners;
layout(set = 0, binding = PVG_NORMALS_POSITIONS) uniform samplerBuffer positions;
#define FIRST(i) texelFetch(first_corner, int(i)).x
#define CORNER(i) texelFetch(corners, int(i)).xyz
#define POSITION(i) texelFetch(positions, int(i)).xyz
#else
layout(set = 0, binding = PVG_NORMALS_FIRST, std430) readonly buffer FirstCorner { uint first_corner[]; };
layout(set = 0, binding = PVG_NORMALS_CORNERS, std430) readonly buffer Corners { uvec4 corners[]; };
layout(set = 0, binding = PVG_NORMALS_POSITIONS, std430) readonly buffer Positions { vec4 positions[]; };
#define FIRST(i) first_corner[i]
#define CORNER(i) corners[i].xyz
#define POSITION(i) positions[i].xyz
#endif
layout(set = 0, binding = PVG_NORMALS_NORMALS, std430) writeonly buffer Normals { vec4 normals[]; };

float largest(vec3 v) { return max(max(abs(v.x), abs(v.y)), abs(v.z)); }

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= range.normal_count) return;
    uint last = FIRST(i + 1u) - range.corner_base;
    precise vec3 sum = vec3(0.0);
    for (uint k = FIRST(i) - range.corner_base; k < last; ++k) {
        uvec3 corner = CORNER(k);
        vec3 a = POSITION(corner.x);
        precise vec3 d = POSITION(corner.y) - a;
        precise vec3 e = POSITION(corner.z) - a;
        precise float dd = d.x * d.x + d.y * d.y + d.z * d.z;
        precise float ee = e.x * e.x + e.y * e.y + e.z * e.z;
        if (!(dd >= PVG_EDGE_MIN && dd <= PVG_EDGE_MAX && ee >= PVG_EDGE_MIN && ee <= PVG_EDGE_MAX)) continue;
        float inverse_d = inverse_square_root(dd);
        float inverse_e = inverse_square_root(ee);
        precise vec3 c = vec3(d.y * e.z - d.z * e.y, d.z * e.x - d.x * e.z, d.x * e.y - d.y * e.x);
        c = c * inverse_d * inverse_e;
        if (!(largest(c) >= PVG_SINE_MIN)) continue;
        c = c * inverse_d * inverse_e;
        sum = sum + c;
    }
    precise vec3 n = vec3(0.0);
    float m = largest(sum);
    if (m >= PVG_SUM_MIN) {
        precise vec3 s = sum * inverse_power_of_two(m);
        precise float ss = s.x * s.x + s.y * s.y + s.z * s.z;
        n = s * inverse_square_root(ss);
    }
    normals[i] = vec4(n, 0.0);
}
