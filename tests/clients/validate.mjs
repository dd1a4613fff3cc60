// Usage: node validate.mjs [--allow-from INPUT] FILE...
// Runs the Khronos glTF validator and prints every message. Exits 1 if there
// is one, of whatever severity: Osculate's files are to give none. What the
// tool was given may have its own messages, so those whose (severity, code)
// INPUT has too do not count. Exits 2 if it could not be run at all.
// The packages are looked for where setup.sh puts them, or in $OSCULATE_NPM.
import { createRequire } from "node:module";
import { readFile } from "node:fs/promises";
import { homedir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { parseArgs } from "node:util";

const cache = process.env.XDG_CACHE_HOME || join(homedir(), ".cache");
const packages = process.env.OSCULATE_NPM || join(cache, "osculate", "npm");
let validateBytes;
try {
  ({ validateBytes } = createRequire(join(packages, "package.json"))("gltf-validator"));
} catch (error) {
  console.error(`gltf-validator not found in ${packages}; run tests/clients/setup.sh\n${error.message}`);
  process.exit(2);
}

const SEVERITY = ["error", "warning", "info", "hint"];

async function messages(file) {
  const report = await validateBytes(new Uint8Array(await readFile(file)), {
    uri: file,
    maxIssues: 0, // no limit
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(resolve(dirname(file), decodeURIComponent(uri)))),
  });
  return report.issues.messages.map((m) => ({ ...m, severity: SEVERITY[m.severity] }));
}

const kind = (m) => `${m.severity} ${m.code}`;

const { values, positionals } = parseArgs({
  options: { "allow-from": { type: "string", multiple: true, default: [] } },
  allowPositionals: true,
});
if (positionals.length === 0) {
  console.error("usage: node validate.mjs [--allow-from INPUT] FILE...");
  process.exit(2);
}

const allowed = new Set();
for (const input of values["allow-from"]) {
  try {
    for (const m of await messages(input)) allowed.add(kind(m));
  } catch (error) {
    console.error(`--allow-from ${input}: ${error.message ?? error}`);
    process.exit(2);
  }
}

for (const file of positionals) {
  let refused;
  try {
    refused = await messages(file);
  } catch (error) {
    refused = [{ severity: "error", code: "NOT_VALIDATED", message: `${error.message ?? error}` }];
  }
  for (const m of refused) {
    const allowance = allowed.has(kind(m)) ? " (in the input too)" : "";
    console.log(`${file}: ${kind(m)}: ${m.message} ${m.pointer ?? ""}${allowance}`);
    if (!allowance) process.exitCode = 1;
  }
}
