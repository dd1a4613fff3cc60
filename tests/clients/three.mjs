// Renders every .glb and .gltf in three.js in headless Chromium: values by attribute, and the pixels of
// every look compared with the palette's colours. usage: node three.mjs FOLDER [CHROMIUM]
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { launch, serve } from "./browser.mjs";
import { packages, say } from "./packages.mjs";
import { colors } from "./tables.mjs";

const folder = process.argv[2];
const files = JSON.parse(await readFile(join(folder, "manifest.json")));
const version = JSON.parse(await readFile(join(packages, "node_modules/three/package.json"))).version;
const client = `three.js r${version.split(".")[1]}`;

const PAGE = `<!doctype html><script type="importmap">{"imports":{"three":"/three/build/three.module.js",
  "three/addons/":"/three/examples/jsm/"}}</script><canvas id="c" width="512" height="512"></canvas>
  <script type="module" src="/page.mjs"></script>`;

const { server, address } = await serve({
  page: PAGE,
  module: new URL("./three_page.mjs", import.meta.url),
  library: "/three/",
  root: join(packages, "node_modules"),
  folder,
});
const browser = await launch(process.argv[3]);
const page = await browser.newPage();
const complaints = [];
page.on("console", (message) => ["error", "warn"].includes(message.type()) && complaints.push(message.text()));
page.on("pageerror", (error) => complaints.push(`${error}`));
await page.goto(address);
await page.waitForFunction("window.ready");

async function column(csv, name) {
  const lines = (await readFile(join(folder, csv), "utf8")).trim().split("\n").map((line) => line.split(","));
  const at = lines[0].indexOf(name);
  return lines.slice(1).map((fields) => Math.fround(Number(fields[at] || 0)));
}

// Values of a compressed file are rounded to 16 bits, shares to 1/32768.
function near(wanted, value, name, file) {
  const allowed = file.way === "meshopt.glb" ? Math.max(Math.abs(wanted), name === "coverage" ? 1 : 0) / 65536 : 0;
  return Math.abs(wanted - value) <= allowed;
}

for (const file of files.filter((file) => !file.file.endsWith(".ply"))) {
  complaints.length = 0;
  try {
    const values = await page.evaluate((name) => window.load(name), file.file);
    if (file.layout === "indexed") {
      say(client, file.file, "values", "absent", "the extension is kept in userData");
      continue;
    }
    let right = true;
    for (const [attribute, name] of [["_face_id", "face"], ["_curvature_max", "k_max"], ["_coverage", "coverage"]]) {
      const wanted = await column(file.csv, name);
      right &&= values[attribute].length === wanted.length && wanted.every((value, i) => near(value, values[attribute][i], name, file));
    }
    say(client, file.file, "values", right ? "right" : "wrong");
    if (file.carrier === "vertex-srgb") {
      say(client, file.file, "colours", "absent", "too bright: made for MeshLab");
      continue;
    }
    let [worst, pixels] = [0, 0];
    for (const shown of file.shown) {
      const wanted = await colors(join(folder, file.colors[shown]));
      const seen = await page.evaluate((v) => window.show(v), file.scene || file.shown.length > 1 ? shown : null);
      for (const [face, r, g, b] of seen) {
        pixels++;
        worst = Math.max(worst, ...[r, g, b].map((c, i) => Math.abs(c - wanted[face][i])));
      }
    }
    // Linear light in 8 bits: dark colours lose steps.
    const allowed = file.carrier === "vertex" ? 8 : 1;
    const check = file.shown.length > 1 ? "colours, switched" : "colours";
    const fine = worst <= allowed && pixels > 1000 * file.shown.length && complaints.length === 0;
    say(client, file.file, check, fine ? "right" : "wrong", `${pixels} pixels within ${worst} of 255 ${complaints.join()}`.trim());
  } catch (error) {
    say(client, file.file, "values", "wrong", `${error.message ?? error} ${complaints.join()}`.slice(0, 300));
  }
}
await browser.close();
server.close();
