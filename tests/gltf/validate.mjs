// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// node validate.mjs FILE.glb ...: runs the Khronos glTF validator, prints errors and warnings, and ends with 1 on any
// error. The folder of node_modules may be given in NODE_MODULES.

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const folder = process.env.NODE_MODULES;
const require = createRequire(folder ? `${folder}/` : import.meta.url);
const validator = require('gltf-validator');

const severities = ['error', 'warning', 'information', 'hint'];
const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node validate.mjs FILE.glb ...');
  process.exit(2);
}
let failed = false;
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 100 });
  const { numErrors, numWarnings, messages } = report.issues;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings`);
  for (const message of messages) {
    if (message.severity > 1) continue;
    console.log(`  ${severities[message.severity]} ${message.code} at ${message.pointer}: ${message.message}`);
  }
  failed ||= numErrors > 0;
}
process.exit(failed ? 1 : 0);
