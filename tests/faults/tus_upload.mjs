// Uploads a file with tus-js-client, as the viewer does but with none of its hooks:
// tus_upload.mjs FILE ADDRESS TOKEN
import fs from 'node:fs';
import path from 'node:path';
import { createRequire } from 'node:module';
import { fileURLToPath } from 'node:url';

const here = path.dirname(fileURLToPath(import.meta.url));
const { Upload } = createRequire(path.join(here, '../../web/package.json'))('tus-js-client');
const [file, address, token] = process.argv.slice(2);

const upload = new Upload(fs.createReadStream(file), {
  endpoint: `${address}/api/v1/uploads`,
  headers: { Authorization: `Bearer ${token}` },
  metadata: { filename: path.basename(file) },
  uploadSize: fs.statSync(file).size,
  chunkSize: 8 * 1024 * 1024,
  retryDelays: Array(60).fill(500),
  onError: (error) => {
    console.error(String(error));
    process.exit(1);
  },
  onSuccess: () => console.log(upload.url),
});
upload.start();
