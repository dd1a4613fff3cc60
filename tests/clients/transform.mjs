// Passes every .glb through glTF-Transform: `optimize` must keep the attributes and their values.
// usage: node transform.mjs FOLDER
import { execFileSync } from "node:child_process";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";
import { packages, say } from "./packages.mjs";

const require = createRequire(join(packages, "package.json"));
const folder = process.argv[2];
const cli = join(packages, "node_modules", ".bin", "gltf-transform");
const { NodeIO } = await import(require.resolve("@gltf-transform/core"));
const { ALL_EXTENSIONS } = await import(require.resolve("@gltf-transform/extensions"));
const { MeshoptDecoder } = await import(require.resolve("meshoptimizer"));
await MeshoptDecoder.ready;
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({ "meshopt.decoder": MeshoptDecoder });
const version = JSON.parse(await readFile(join(packages, "node_modules/@gltf-transform/cli/package.json"))).version;
const client = `glTF-Transform ${version}`;

// For each face number the values of its corners, in whatever order the faces now are.
function faces(document) {
  const found = new Map();
  for (const mesh of document.getRoot().listMeshes()) {
    for (const primitive of mesh.listPrimitives()) {
      const names = primitive.listSemantics().filter((name) => name.startsWith("_"));
      const indices = primitive.getIndices();
      const count = indices ? indices.getCount() : primitive.getAttribute("POSITION").getCount();
      for (let corner = 0; corner < count; corner++) {
        const vertex = indices ? indices.getScalar(corner) : corner;
        const values = names.sort().map((name) => `${name}=${primitive.getAttribute(name).getScalar(vertex)}`);
        const face = primitive.getAttribute("_FACE_ID")?.getScalar(vertex);
        found.set(face, new Set([...(found.get(face) ?? []), values.join()]));
      }
    }
  }
  return found;
}

// Values of a compressed file are those of the CSV to 16 bits.
async function near(found, file) {
  const rows = (await readFile(join(folder, file.csv), "utf8")).trim().split("\n").map((line) => line.split(","));
  const columns = { _FACE_ID: "face", _CURVATURE_MAX: "k_max", _CURVATURE_GAUSS: "gauss", _COVERAGE: "coverage" };
  for (const [face, corners] of found) {
    for (const pair of [...corners][0].split(",")) {
      const [name, value] = pair.split("=");
      if (!(name in columns)) continue;
      const wanted = Math.fround(Number(rows[face + 1][rows[0].indexOf(columns[name])] || 0));
      const allowed = Math.max(Math.abs(wanted), name === "_COVERAGE" ? 1 : 0) / 65536;
      if (Math.abs(value - wanted) > allowed) throw new Error(`${name} of face ${face}: ${value}, not ${wanted}`);
    }
  }
}

for (const file of JSON.parse(await readFile(join(folder, "manifest.json")))) {
  if (!file.file.endsWith(".glb")) continue;
  try {
    const input = join(folder, file.file);
    const output = join(folder, `optimized-${file.file}`);
    execFileSync(cli, ["inspect", input], { stdio: "pipe" });
    execFileSync(cli, ["optimize", input, output, "--compress", "false", "--texture-compress", "false",
      "--simplify", "false"], { stdio: "pipe" });
    if (file.layout === "indexed") {
      const kept = (await readFile(output)).includes("OSCULATE_face_values");
      say(client, file.file, "values", kept ? "right" : "absent", kept ? "" : "unknown extensions are dropped");
      continue;
    }
    const [before, after] = [faces(await io.read(input)), faces(await io.read(output))];
    if (file.way === "meshopt.glb") await near(before, file);
    const same = [...before].every(([face, values]) => {
      const now = after.get(face);
      return values.size === 1 && (now === undefined || (now.size === 1 && [...now][0] === [...values][0]));
    });
    // Faces without area are taken out by it.
    const lost = before.size - after.size;
    const right = same && (lost === 0 || file.file.includes("degenerate"));
    say(client, file.file, "values", right ? "right" : "wrong", lost ? `${lost} faces gone` : "after optimize");
  } catch (error) {
    say(client, file.file, "values", "wrong", `${error.message ?? error}`.slice(0, 300));
  }
}
