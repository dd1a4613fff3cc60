// Reads every file with metadata in CesiumJS in headless Chromium: the table's values by row, and those of
// the faces that are under some pixels. usage: node cesium.mjs FOLDER [CHROMIUM]
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { launch, serve } from "./browser.mjs";
import { packages, say } from "./packages.mjs";

const folder = process.argv[2];
const files = JSON.parse(await readFile(join(folder, "manifest.json"))).filter((file) => file.way === "metadata.glb");
const version = JSON.parse(await readFile(join(packages, "node_modules/cesium/package.json"))).version;
const client = `CesiumJS ${version}`;

const PAGE = `<!doctype html><script>window.CESIUM_BASE_URL = "/Cesium/";</script><script src="/Cesium/Cesium.js"></script>
  <div id="view" style="width:512px;height:512px"></div><script type="module" src="/page.mjs"></script>`;

const { server, address } = await serve({
  page: PAGE,
  module: new URL("./cesium_page.mjs", import.meta.url),
  library: "/Cesium/",
  root: join(packages, "node_modules/cesium/Build"),
  folder,
});
const browser = await launch(process.argv[3]);
const page = await browser.newPage();
await page.goto(address);
await page.waitForFunction("window.ready", { timeout: 120000 });

const COLUMNS = ["face", "class", "k_max", "k_min", "mean", "gauss", "coverage", "confidence"];

async function rows(csv) {
  const lines = (await readFile(join(folder, csv), "utf8")).trim().split("\n").map((line) => line.split(","));
  const at = COLUMNS.map((name) => lines[0].indexOf(name));
  return lines.slice(1).map((fields) => at.map((i) => Math.fround(Number(fields[i] || 0))));
}

// An enumeration arrives as the name of its value.
const CLASSES = { not_estimated: -1, flat: 0, parabolic: 1, elliptic: 2, umbilic: 3, hyperbolic: 4 };
const plain = (value) => (typeof value === "string" ? CLASSES[value] : value);

// What CesiumJS says of scenes that it cannot take.
const KNOWN = [
  ["Too many attributes", "takes 16 attributes of a vertex at most; fewer with --attributes"],
  ["Unsupported glTF Extension", "does not read the input either: an extension it requires"],
];

for (const file of files) {
  try {
    const wanted = await rows(file.csv);
    const same = (row, values) => values.every((value, i) => plain(value) === wanted[row][i]);
    const { table, picked } = await page.evaluate((name, columns) => window.load(name, columns), file.file, COLUMNS);
    const whole = table.length === wanted.length && table.every((values, row) => same(row, values));
    say(client, file.file, "values", whole ? "right" : "wrong", whole ? "" : "the table");
    const hit = picked.length > 20 && picked.every(([row, values]) => same(row, values));
    say(client, file.file, "faces under the mouse", hit ? "right" : "wrong", hit ? "" : `${picked.length} pixels`);
  } catch (error) {
    const why = `${error.message ?? error}`;
    const known = KNOWN.find(([words]) => why.includes(words));
    say(client, file.file, "values", known ? "absent" : "wrong", known ? known[1] : why.slice(0, 300));
  }
}
await browser.close();
server.close();
