// The documents that the glTF-Transform step made hold what `osculate annotate` writes, and all that was there before.
// usage: step.mjs INPUT STEP DIRECT...        three files a document
import { createRequire } from "node:module";
import { join } from "node:path";
import { packages } from "../clients/packages.mjs";

const require = createRequire(join(packages, "package.json"));
const { NodeIO } = await import(require.resolve("@gltf-transform/core"));
const { ALL_EXTENSIONS } = await import(require.resolve("@gltf-transform/extensions"));
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);

const KINDS = ["Scenes", "Nodes", "Meshes", "Materials", "Textures", "Animations", "Skins", "Cameras", "Buffers"];
function facts(document) {
  const root = document.getRoot();
  const counts = KINDS.map((kind) => `${kind}: ${root[`list${kind}`]().length}`);
  const extensions = root.listExtensionsUsed().map((extension) => extension.extensionName).sort();
  const nodes = root.listNodes().map((node) => `${node.getName()} ${node.getMatrix()} ${node.listExtensions().map((e) => e.extensionName)}`);
  const meshes = root.listMeshes().map((mesh) => [mesh.getName(), JSON.stringify(mesh.getExtras()), ...mesh.listPrimitives().map((primitive) => {
    const variants = primitive.getExtension("KHR_materials_variants");
    const values = [...primitive.listSemantics().map((name) => [name, primitive.getAttribute(name)]), ["indices", primitive.getIndices()]];
    const looks = variants?.listMappings().map((m) => [m.getMaterial().getName(), ...m.listVariants().map((v) => v.getName())]);
    return [...values.map(([name, accessor]) => `${name} ${accessor?.getType()} ${accessor?.getArray()}`).sort(),
      primitive.listTargets().length, primitive.getMaterial()?.getName(), JSON.stringify(looks)].join("\n");
  })]);
  return { counts, extensions, nodes, meshes, scene: root.getDefaultScene()?.getName(), extras: root.getExtras() };
}

const files = process.argv.slice(2);
for (let i = 0; i < files.length; i += 3) {
  const [input, step, direct] = await Promise.all(files.slice(i, i + 3).map(async (file) => facts(await io.read(file))));
  for (const key of Object.keys(direct)) {
    if (JSON.stringify(step[key]) !== JSON.stringify(direct[key])) throw new Error(`${files[i + 1]}: ${key} differ:\n${JSON.stringify(step[key]).slice(0, 400)}\n${JSON.stringify(direct[key]).slice(0, 400)}`);
  }
  const before = input.nodes.join(), after = step.nodes.join();
  if (before !== after) throw new Error(`${files[i + 1]}: nodes are ${after}, and were ${before}`);
  if (!step.meshes.flat().some((text) => text.includes("_CURVATURE_MEAN SCALAR"))) throw new Error(`${files[i + 1]}: no curvature`);
}
console.log(`${files.length / 3} documents through the glTF-Transform step, none with a difference`);
