// A step for glTF-Transform that has Osculate annotate the document: curvature of every face as attributes, and its
// colours as a material variant beside the look that is there.
//
//   import { curvature } from "./curvature.mjs";
//   await document.transform(resample(), curvature({ io, options: ["--color-by", "gauss"] }));
//
// Take it last: steps that join vertices (weld, simplify) undo the vertices that every face has of its own.
//
// As a program:   node curvature.mjs IN OUT [OPTION...]        with the options of `osculate annotate`
import { spawn } from "node:child_process";
import { pathToFileURL } from "node:url";
import { NodeIO } from "@gltf-transform/core";
import { ALL_EXTENSIONS } from "@gltf-transform/extensions";
import { mergeDocuments } from "@gltf-transform/functions";

// The GLB that Osculate makes of a GLB. Nothing touches the disk.
async function annotate(glb, program, options) {
  const child = spawn(program, ["annotate", "-", "-o", "-", "--format", "glb", "-q", ...options]);
  const [written, messages] = [[], []];
  child.stdout.on("data", (part) => written.push(part));
  child.stderr.on("data", (part) => messages.push(part));
  const ended = new Promise((resolve, reject) => child.once("error", reject).once("close", resolve));
  child.stdin.on("error", () => {}); // It may end before it has read all; its message says why.
  child.stdin.end(glb);
  const code = await ended;
  // 3: written, and the mesh has defects.
  if (code !== 0 && code !== 3) throw new Error(Buffer.concat(messages).toString().trim() || `osculate ended with ${code}`);
  return Buffer.concat(written);
}

/**
 * Annotates the whole document. Every mesh, node and material is replaced by the one that comes back.
 * `io` writes and reads the document, so that it must know its extensions.
 */
export function curvature({ io, program = process.env.OSCULATE ?? "osculate", options = [] }) {
  return async function curvature(document) {
    const annotated = await io.readBinary(await annotate(await io.writeBinary(document), program, options));
    const root = document.getRoot();
    root.listMeshes().flatMap((mesh) => mesh.listPrimitives()).forEach((primitive) => primitive.dispose());
    for (const list of ["Scenes", "Nodes", "Meshes", "Materials", "Textures", "Animations", "Skins", "Cameras", "Accessors", "Buffers"]) {
      root[`list${list}`]().forEach((property) => property.dispose());
    }
    // What was registered for the old properties has nothing left to do.
    root.listExtensionsUsed().forEach((extension) => extension.dispose());
    const map = mergeDocuments(document, annotated);
    root.setDefaultScene(map.get(annotated.getRoot().getDefaultScene()) ?? null);
    root.setExtras(annotated.getRoot().getExtras());
  };
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  const [input, output, ...options] = process.argv.slice(2);
  const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
  const document = await io.read(input);
  await document.transform(curvature({ io, options }));
  await io.write(output, document);
}
