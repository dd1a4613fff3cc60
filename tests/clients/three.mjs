// Renders every .glb and .gltf in three.js in headless Chromium: values by attribute, and the pixels of
// every look compared with the palette's colours. usage: node three.mjs FOLDER [CHROMIUM]
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { extname, join, normalize } from "node:path";
import { packages, say } from "./packages.mjs";

const require = createRequire(join(packages, "package.json"));
const puppeteer = (await import(require.resolve("puppeteer-core"))).default;
const folder = process.argv[2];
const files = JSON.parse(await readFile(join(folder, "manifest.json")));
const version = JSON.parse(await readFile(join(packages, "node_modules/three/package.json"))).version;
const client = `three.js r${version.split(".")[1]}`;

const KINDS = { ".js": "text/javascript", ".html": "text/html", ".json": "application/json", ".png": "image/png" };
const PAGE = `<!doctype html><script type="importmap">{"imports":{"three":"/three/build/three.module.js",
  "three/addons/":"/three/examples/jsm/"}}</script><canvas id="c" width="512" height="512"></canvas>
  <script type="module" src="/page.mjs"></script>`;

const server = createServer(async (request, response) => {
  const path = normalize(decodeURIComponent(request.url.split("?")[0]));
  try {
    const body =
      path === "/" ? PAGE
      : path === "/page.mjs" ? await readFile(new URL("./three_page.mjs", import.meta.url))
      : path.startsWith("/three/") ? await readFile(join(packages, "node_modules", path))
      : await readFile(join(folder, path));
    const kind = path === "/" ? "text/html" : path.endsWith(".mjs") ? "text/javascript" : KINDS[extname(path)];
    response.writeHead(200, { "content-type": kind ?? "application/octet-stream" }).end(body);
  } catch {
    response.writeHead(404).end();
  }
}).listen(0, "127.0.0.1");
await new Promise((done) => server.once("listening", done));

const browser = await puppeteer.launch({
  executablePath: process.argv[3] ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
});
const page = await browser.newPage();
const complaints = [];
page.on("console", (message) => ["error", "warn"].includes(message.type()) && complaints.push(message.text()));
page.on("pageerror", (error) => complaints.push(`${error}`));
await page.goto(`http://127.0.0.1:${server.address().port}/`);
await page.waitForFunction("window.ready");

// Red, green and blue of every face of an annotated PLY, as in results.py.
async function colorsOf(name) {
  const data = await readFile(join(folder, name));
  const end = data.indexOf("end_header\n") + 11;
  const sizes = { char: 1, uchar: 1, float: 4, double: 8 };
  let [where, vertices, faces, stride, row, red] = ["", 0, 0, 0, 0, 0];
  for (const line of data.subarray(0, end).toString().split("\n")) {
    const word = line.split(" ");
    if (word[0] === "element") {
      where = word[1];
      if (where === "vertex") vertices = Number(word[2]);
      else faces = Number(word[2]);
    } else if (word[0] === "property" && where === "vertex") stride += sizes[word[1]];
    else if (word[0] === "property") {
      if (word[2] === "red") red = row;
      row += word[1] === "list" ? 13 : sizes[word[1]];
    }
  }
  const rows = end + vertices * stride;
  return Array.from({ length: faces }, (_, f) => [...data.subarray(rows + f * row + red, rows + f * row + red + 3)]);
}

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
      const wanted = await colorsOf(file.colors[shown]);
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
