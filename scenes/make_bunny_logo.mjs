// Lays a rosette out on the bunny's thigh and writes scenes/bunny.pvg.json.
//   node scenes/make_bunny_logo.mjs NODE_MODULES [OUT.pvg.json [X Y RADIUS]]
// X, Y, RADIUS: where the badge is, seen from +z, as fractions of the diagonal.
// The layout is drawn in polar coordinates (radius 1: the badge's rim). Each of its points is carried to the surface by rays along the thigh's mean
// normal, stepping outwards until the arc length on the surface is the wanted radius, so that shapes keep their size on the curved thigh.
import { createRequire } from 'node:module';
import { writeFileSync } from 'node:fs';
import { dirname, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const [modules, out = resolve(here, 'bunny.pvg.json'), ...where] = process.argv.slice(2);
if (!modules || (where.length !== 0 && where.length !== 3) || !where.every((number) => Number.isFinite(Number(number)))) {
    console.error('usage: node make_bunny_logo.mjs NODE_MODULES [OUT.pvg.json [X Y RADIUS]]');
    process.exit(2);
}
const bunny = createRequire(import.meta.url)(resolve(modules, 'bunny'));

const [x = 0.08, y = 0.19, radius = 0.165] = where.map(Number);
const place = { x, y, radius };
const smallest_gap = 0.012; // between any two curves, fraction of the diagonal

const add = (a, b) => a.map((v, k) => v + b[k]);
const sub = (a, b) => a.map((v, k) => v - b[k]);
const scale = (a, s) => a.map((v) => v * s);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.hypot(...a);
const unit = (a) => scale(a, 1 / norm(a));

const points = bunny.positions.map((p) => p.map(Math.fround));
const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k])));
const high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p[k])));
const diagonal = norm(sub(high, low));

/// The first hit of a ray from outside, with the face's normal (Moeller and Trumbore 1997).
function cast(origin, direction) {
    let best = null;
    for (const [i, j, k] of bunny.cells) {
        const e = sub(points[j], points[i]);
        const f = sub(points[k], points[i]);
        const h = cross(direction, f);
        const det = dot(e, h);
        if (det <= 1e-12) continue; // seen from behind or edge-on
        const s = sub(origin, points[i]);
        const u = dot(s, h) / det;
        const q = cross(s, e);
        const v = dot(direction, q) / det;
        if (u < 0 || v < 0 || u + v > 1) continue;
        const t = dot(f, q) / det;
        if (t > 0 && (!best || t < best.t)) best = { t, point: add(origin, scale(direction, t)), normal: unit(cross(e, f)) };
    }
    if (!best) throw new Error('a ray misses the bunny');
    return best;
}

// The mean normal around the centre, over rays along -z.
const first = cast([place.x * diagonal, place.y * diagonal, 20], [0, 0, -1]).point;
let normal = [0, 0, 0];
for (let i = 0; i < 200; ++i) {
    const r = place.radius * diagonal * Math.sqrt((i + 0.5) / 200) * 0.9;
    const a = i * Math.PI * (3 - Math.sqrt(5));
    normal = add(normal, cast([first[0] + r * Math.cos(a), first[1] + r * Math.sin(a), 20], [0, 0, -1]).normal);
}
normal = unit(normal);
const right = unit(cross([0, 1, 0], normal));
const up = cross(normal, right);
const center = cast(add(first, scale(normal, 5)), scale(normal, -1)).point;

let steepest = 1;
/// The surface point at a radius (of the badge) and an angle (counter-clockwise from the right, seen from outside).
function on_surface(radius, angle) {
    const wanted = radius * place.radius * diagonal;
    const along = add(scale(right, Math.cos(angle)), scale(up, Math.sin(angle)));
    const step = 0.002 * diagonal;
    let at = center;
    let length = 0;
    for (let k = 1; length < wanted; ++k) {
        const hit = cast(add(add(center, scale(along, k * step)), scale(normal, 5)), scale(normal, -1));
        const piece = norm(sub(hit.point, at));
        steepest = Math.min(steepest, dot(hit.normal, normal));
        if (length + piece >= wanted) return add(at, scale(sub(hit.point, at), (wanted - length) / piece));
        length += piece;
        at = hit.point;
    }
    return center;
}
const polar = ([x, y]) => on_surface(Math.hypot(x, y), Math.atan2(y, x)).map((v) => Number(v.toFixed(5)));
const turned = ([x, y], a) => [x * Math.cos(a) - y * Math.sin(a), x * Math.sin(a) + y * Math.cos(a)];
const rounded = (v) => Number((v * place.radius).toFixed(6));

// Curves of the layout, for the gaps: name and points on the curve.
const drawn = [];
function circle_points(x, y, radius) {
    return Array.from({ length: 96 }, (_, i) => [x + radius * Math.cos((i * Math.PI) / 48), y + radius * Math.sin((i * Math.PI) / 48)]);
}
function bezier_points(control, closed) {
    const curve = [];
    for (let s = 0; s < control.length - (closed ? 0 : 1); s += 3) {
        const [a, b, c, d] = [0, 1, 2, 3].map((k) => control[(s + k) % control.length]);
        for (let i = 0; i < 48; ++i) {
            const t = i / 48;
            curve.push([0, 1].map((k) => (1 - t) ** 3 * a[k] + 3 * t * (1 - t) ** 2 * b[k] + 3 * t * t * (1 - t) * c[k] + t ** 3 * d[k]));
        }
    }
    return curve;
}
function bspline_points(control) {
    const curve = [];
    for (let s = 0; s < control.length; ++s) {
        const [a, b, c, d] = [0, 1, 2, 3].map((k) => control[(s + k) % control.length]);
        for (let i = 0; i < 24; ++i) {
            const t = i / 24;
            const w = [(1 - t) ** 3, 3 * t ** 3 - 6 * t ** 2 + 4, -3 * t ** 3 + 3 * t ** 2 + 3 * t + 1, t ** 3];
            curve.push([0, 1].map((k) => (w[0] * a[k] + w[1] * b[k] + w[2] * c[k] + w[3] * d[k]) / 6));
        }
    }
    return curve;
}

const circle = (name, x, y, radius) => {
    drawn.push([name, circle_points(x, y, radius)]);
    return { type: 'circle', center: polar([x, y]), radius: rounded(radius) };
};
const bezier = (name, control, closed) => {
    drawn.push([name, bezier_points(control, closed)]);
    return { type: 'bezier', degree: 3, closed, points: control.map(polar) };
};
const bspline = (name, control) => {
    drawn.push([name, bspline_points(control)]);
    return { type: 'bspline', degree: 3, closed: true, points: control.map(polar) };
};

const primitives = [];
// The rim bounds the decorated part: nothing is given outside, so the rest of the bunny keeps its vertices.
primitives.push({
    id: 'rim',
    kind: 'diffusion_curve',
    path: circle('rim', 0, 0, 1),
    left: { color: '#b9781c', height: 0 },
});
// Bulging outwards at the beads. The corners lie outside the curve that they control.
const scallops = Array.from({ length: 12 }, (_, i) => turned([i % 2 === 0 ? 0.93 : 0.87, 0], (Math.PI / 6) * i));
primitives.push({
    id: 'frame',
    kind: 'diffusion_curve',
    path: bspline('frame', scallops),
    left: { color: '#fff3d1', height: 0.006 },
    right: { color: '#e0a526', height: 0.006 },
});
// Petals: ridges that colour their inside only; a vein inside lifts each like a pillow.
const petal = [
    [0.36, 0], [0.36, -0.13], [0.44, -0.23], [0.54, -0.23],
    [0.64, -0.23], [0.72, -0.1], [0.76, 0],
    [0.72, 0.1], [0.64, 0.23], [0.54, 0.23],
    [0.44, 0.23], [0.36, 0.13],
];
const vein = [[0.46, 0], [0.52, 0.03], [0.6, -0.03], [0.66, 0]];
for (let i = 0; i < 6; ++i) {
    const angle = (Math.PI / 3) * i + Math.PI / 6;
    primitives.push({
        id: `petal ${i + 1}`,
        kind: 'diffusion_curve',
        path: bezier(`petal ${i + 1}`, petal.map((p) => turned(p, angle)), true),
        left: { color: i % 2 === 0 ? '#f4a3b5' : '#e63946', height: 0.011 },
        right: { height: 0.011 },
    });
    primitives.push({
        id: `vein ${i + 1}`,
        kind: 'diffusion_curve',
        path: bezier(`vein ${i + 1}`, vein.map((p) => turned(p, angle)), false),
        both: [{ t: 0, color: '#b3334f', height: 0.016 }, { t: 1, color: i % 2 === 0 ? '#d9536b' : '#b3202f', height: 0.019 }],
    });
}
// Beads: coloured inside, raised on both sides.
for (let i = 0; i < 6; ++i) {
    const [x, y] = turned([0.72, 0], (Math.PI / 3) * i);
    primitives.push({
        id: `bead ${i + 1}`,
        kind: 'diffusion_curve',
        path: circle(`bead ${i + 1}`, x, y, 0.055),
        left: { color: '#2a9d8f', height: 0.012 },
        right: { height: 0.012 },
    });
}
// The heart: a region that colours and raises at once, without an edge of its own.
primitives.push({
    id: 'heart',
    kind: 'poisson_region',
    path: circle('heart', 0, 0, 0.27),
    rise: { color: [-0.1, -0.5, -0.55], height: 0.018 },
    ring: 0.5,
});

const gap_of = (a, b) => Math.min(...a.flatMap((p) => b.map((q) => Math.hypot(p[0] - q[0], p[1] - q[1])))) * place.radius;
let narrowest = Infinity;
for (let a = 0; a < drawn.length; ++a) {
    for (let b = a + 1; b < drawn.length; ++b) {
        const gap = gap_of(drawn[a][1], drawn[b][1]);
        narrowest = Math.min(narrowest, gap);
        if (gap < smallest_gap) console.error(`${drawn[a][0]} and ${drawn[b][0]} are ${gap.toFixed(4)} of the diagonal apart, less than ${smallest_gap}`);
    }
}
console.log(`${primitives.length} primitives, narrowest gap ${narrowest.toFixed(4)} of the diagonal`);
console.log(`steepest face ${((Math.acos(steepest) * 180) / Math.PI).toFixed(0)} degrees from the view direction`);
if (narrowest < smallest_gap) process.exit(1);

const head = {
    pvg: 1,
    mesh: { file: 'bunny.glb', max_edge: 0.01 },
    length_unit: 'bbox',
    color_space: 'linear',
    layers: [{ name: 'rosette', primitives }],
};
// One line a point, not one a number.
const text = JSON.stringify(head, null, 2).replace(/\[\s+(-?[\d.e-]+),\s+(-?[\d.e-]+),\s+(-?[\d.e-]+)\s+\]/g, '[$1, $2, $3]');
writeFileSync(out, text + '\n');
console.log(`wrote ${out}`);
