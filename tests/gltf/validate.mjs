// Khronos gltf-validator over files: node validate.mjs FILE... prints every error and exits 1 when there is one. The module is
// looked for in the node_modules folder PVG_NODE_MODULES.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";

const require = createRequire(join(resolve(process.env.PVG_NODE_MODULES ?? "node_modules"), "..", "anchor.js"));
const validator = require("gltf-validator");

let failed = 0;
for (const file of process.argv.slice(2)) {
    try {
        const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {
            uri: file,
            maxIssues: 100,
            externalResourceFunction: async (uri) => new Uint8Array(readFileSync(join(dirname(file), decodeURIComponent(uri)))),
        });
        for (const message of report.issues.messages)
            if (message.severity === 0) console.log(`${file}: ${message.pointer}: ${message.code}: ${message.message}`);
        if (report.issues.numErrors > 0) failed += 1;
    } catch (error) {
        console.log(`${file}: ${error}`);
        failed += 1;
    }
}
process.exit(failed > 0 ? 1 : 0);
