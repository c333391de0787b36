// Turns the Stanford bunny of the npm package `bunny` into a .glb.
//   node scenes/bunny_glb.mjs NODE_MODULES OUT.glb
import { createRequire } from 'node:module';
import { mkdirSync, writeFileSync } from 'node:fs';
import { dirname, resolve } from 'node:path';

const [modules, out] = process.argv.slice(2);
if (!modules || !out) {
    console.error('usage: node bunny_glb.mjs NODE_MODULES OUT.glb');
    process.exit(2);
}
const require = createRequire(import.meta.url);
const bunny = require(resolve(modules, 'bunny'));

const positions = new Float32Array(bunny.positions.flat());
const indices = new Uint16Array(bunny.cells.flat());
const low = [0, 1, 2].map((k) => Math.min(...bunny.positions.map((p) => Math.fround(p[k]))));
const high = [0, 1, 2].map((k) => Math.max(...bunny.positions.map((p) => Math.fround(p[k]))));

const padded = (buffer, fill) => Buffer.concat([buffer, Buffer.alloc((4 - (buffer.length % 4)) % 4, fill)]);
const chunk = (type, data) => {
    const head = Buffer.alloc(8);
    head.writeUInt32LE(data.length, 0);
    head.write(type, 4, 'latin1');
    return Buffer.concat([head, data]);
};
const positionBytes = Buffer.from(positions.buffer);
const indexBytes = Buffer.from(indices.buffer);
const binary = padded(Buffer.concat([positionBytes, indexBytes]), 0);
const document = {
    asset: { version: '2.0', generator: 'pvg bunny_glb.mjs', copyright: 'Stanford Computer Graphics Laboratory' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, name: 'bunny' }],
    meshes: [{ name: 'bunny', primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [
        { bufferView: 0, componentType: 5126, count: positions.length / 3, type: 'VEC3', min: low, max: high },
        { bufferView: 1, componentType: 5123, count: indices.length, type: 'SCALAR' },
    ],
    bufferViews: [
        { buffer: 0, byteOffset: 0, byteLength: positionBytes.length, target: 34962 },
        { buffer: 0, byteOffset: positionBytes.length, byteLength: indexBytes.length, target: 34963 },
    ],
    buffers: [{ byteLength: binary.length }],
};
const body = Buffer.concat([chunk('JSON', padded(Buffer.from(JSON.stringify(document)), ' ')), chunk('BIN\0', binary)]);
const head = Buffer.alloc(12);
head.write('glTF', 0, 'latin1');
head.writeUInt32LE(2, 4);
head.writeUInt32LE(12 + body.length, 8);
mkdirSync(dirname(resolve(out)), { recursive: true });
writeFileSync(out, Buffer.concat([head, body]));
