// What Khronos' validator says about GLB files: `node validate_glb.mjs FILE...`. A line
// for each error and warning. Exit status: 0 none, 1 some, 77 the validator is not
// installed (npm ci in web/).
import { existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const web = new URL('../../../web/', import.meta.url);
if (!existsSync(new URL('node_modules/gltf-validator', web))) process.exit(77);
const validator = createRequire(web)('gltf-validator');

// The validator does not know this extension's bytes, and says so.
const KNOWN = ['UNSUPPORTED_EXTENSION'];
const [ERROR, WARNING] = [0, 1];

let failed = false;
for (const path of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(path)));
  for (const issue of report.issues.messages) {
    if (issue.severity !== ERROR && (issue.severity !== WARNING || KNOWN.includes(issue.code)))
      continue;
    console.log(`${path}: ${issue.code} ${issue.message} ${issue.pointer ?? ''}`);
    failed = true;
  }
  const { totalVertexCount, totalTriangleCount } = report.info;
  console.log(`${path}: ${totalVertexCount} vertices, ${totalTriangleCount} triangles`);
}
process.exit(failed ? 1 : 0);
